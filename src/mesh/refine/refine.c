#include "base/error.h"
#include "base/memory.h"
#include "mesh/check.h"
#include "mesh/labels.h"
#include "mesh/refine/brake.h"
#include "mesh/refine/plan.h"

/// @file
/// Refinement of a mesh level by level: positions, channels, texture, creases and corners.
///
/// Vertices keep their indices. The schemes that split faces in four number the new vertices by edge, so the next level's
/// connectivity follows by arithmetic (see level.h). Square-root-three subdivision numbers them by face. Quads have no
/// offsets until the end.

/// The largest coordinate that is refined: weighted sums of larger ones can overflow.
static const double MAX_COORDINATE = 1e290;

// Faces at the boundary, where a scheme has no surface without rules for boundaries.

/// Whether a crease of the mesh makes an edge sharp for ever.
static bool is_sharp_for_ever(const bat_mesh *mesh, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        const bat_mesh_crease *crease = &mesh->creases[i];
        if (crease->sharpness >= BAT_MESH_SHARP &&
            ((crease->a == a && crease->b == b) || (crease->a == b && crease->b == a)))
            return true;
    }
    return false;
}

/// Mark the ends of boundary edges that no crease makes sharp.
static void mark_boundary(const mesh_level *level, const bat_mesh *mesh, bool *marked)
{
    const bat_mesh_connectivity *links = level->links;
    memset(marked, 0, links->vertex_count * sizeof *marked);
    for (uint32_t h = 0; h < sides_corners(&level->sides, links->face_count); h++)
    {
        uint32_t a = level->faces[h], b = level->faces[sides_next(&level->sides, h)];
        if (mesh_at_boundary(links, h) && !is_sharp_for_ever(mesh, a, b))
            marked[a] = marked[b] = true;
    }
}

static bool has_marked(const mesh_level *level, uint32_t face, const bool *marked)
{
    for (uint32_t c = sides_begin(&level->sides, face); c < sides_begin(&level->sides, face + 1); c++)
        if (marked[level->faces[c]])
            return true;
    return false;
}

/// Number anew what the corners of faces name; the rows of `count` numbers that none names are dropped.
/// @param numbers workspace, one for each row; receives the new numbers, BAT_MESH_NONE for dropped rows
static size_t drop_unused(uint32_t *faces, size_t corners, size_t rows, uint32_t *numbers)
{
    memset(numbers, 0xff, rows * sizeof *numbers);
    for (size_t c = 0; c < corners; c++)
        numbers[faces[c]] = 0;
    uint32_t count = 0;
    for (size_t i = 0; i < rows; i++)
        if (numbers[i] == 0)
            numbers[i] = count++;
    for (size_t c = 0; c < corners; c++)
        faces[c] = numbers[faces[c]];
    return count;
}

/// Keep some faces of a mesh and what they name.
static void keep_faces(const mesh_level *level, const bool *marked, size_t levels, uint32_t sides, bat_mesh *fine,
                       double *normals, uint32_t *numbers)
{
    size_t kept = 0;
    for (uint32_t f = 0; f < fine->face_count; f++)
    {
        uint32_t coarse = sides == 4 ? sides_face(&level->sides, f >> 2 * (levels - 1)) : f >> 2 * levels;
        if (has_marked(level, coarse, marked))
            continue;
        memmove(fine->faces + sides * kept, fine->faces + sides * (size_t)f, sides * sizeof *fine->faces);
        if (fine->texture_faces != NULL)
            memmove(fine->texture_faces + sides * kept, fine->texture_faces + sides * (size_t)f,
                    sides * sizeof *fine->texture_faces);
        if (fine->face_labels != NULL)
            fine->face_labels[kept] = fine->face_labels[f];
        kept++;
    }
    fine->face_count = kept;
    size_t vertices = drop_unused(fine->faces, sides * kept, fine->vertex_count, numbers);
    mesh_move_rows(normals, fine->vertex_count, 3, numbers);
    mesh_renumber(fine, vertices, numbers);
    if (fine->texture_faces == NULL)
        return;
    size_t texture = fine->texture_count;
    fine->texture_count = drop_unused(fine->texture_faces, sides * kept, texture, numbers);
    mesh_move_rows(fine->texture, texture, 2, numbers);
}

/// Find the connectivity of a mesh's texture. Two faces are neighbours where they share an edge of the mesh and both of its
/// texture coordinates. Edges that separate faces only in the texture are seams; they are boundary edges of the texture.
/// `first` remains null.
/// @return BAT_OK or BAT_NO_MEMORY; `seams` is untouched on failure
static bat_status connect_seams(const bat_mesh *mesh, const mesh_sides *sides, const bat_mesh_connectivity *links,
                                bat_mesh_connectivity *seams, bat_error *error)
{
    size_t half_edges = sides_corners(sides, mesh->face_count);
    bat_mesh_connectivity made = {
        .twin = memory_array(half_edges, sizeof *made.twin),
        .edge = memory_array(half_edges, sizeof *made.edge),
        .vertex_count = mesh->texture_count,
        .face_count = mesh->face_count,
    };
    if (made.twin == NULL || made.edge == NULL)
    {
        bat_mesh_connectivity_free(&made);
        return error_memory(error, half_edges * sizeof *made.twin);
    }
    const uint32_t *corner = mesh->texture_faces;
    uint32_t edges = 0;
    for (uint32_t h = 0; h < half_edges; h++)
    {
        uint32_t twin = links->twin[h];
        bool joined = twin != BAT_MESH_NONE && corner[h] == corner[sides_next(sides, twin)] &&
                      corner[twin] == corner[sides_next(sides, h)];
        made.twin[h] = joined ? twin : BAT_MESH_NONE;
        made.edge[h] = mesh_owns(made.twin, h) ? edges++ : made.edge[twin];
        made.boundary_edge_count += !joined;
    }
    made.edge_count = edges;
    *seams = made;
    return BAT_OK;
}

/// A level: the mesh and what the next level needs.
typedef struct refined_level
{
    bat_mesh mesh; ///< without channel names, creases and corners
    mesh_sides sides;
    bat_mesh_connectivity links;
    bool borrowed; ///< the arrays of `mesh` and `links` belong to the caller
    bat_mesh_connectivity texture_links;
    double *edge_sharpness;  ///< null: no edge is sharp
    double *child_sharpness; ///< as in mesh_level
    sharp_list sharp;        ///< all zero: nothing is sharp
} refined_level;

/// The state of a refinement.
typedef struct refinement
{
    const bat_mesh *coarse;
    const mesh_plan *plan;
    const bat_mesh_connectivity *links; ///< the connectivity of the coarse mesh
    refined_level now;
    refined_level before;     ///< the previous level, where its faces were split: faces and links only
    mesh_level parent;        ///< `before` in the form that rules use
    double *vertex_sharpness; ///< one number for each coarse vertex; null: none is sharp
    uint32_t *irregular;      ///< as in mesh_level
    unsigned char *dependent; ///< as in texture_rows
    size_t *fallback;
    double *normals; ///< of the limit surface; null: not wanted, or not yet
    mesh_brake brake;
} refinement;

static void refined_level_free(refined_level *held)
{
    if (!held->borrowed)
    {
        bat_mesh_free(&held->mesh);
        bat_mesh_connectivity_free(&held->links);
    }
    bat_mesh_connectivity_free(&held->texture_links);
    free(held->edge_sharpness);
    free(held->child_sharpness);
    sharp_list_free(&held->sharp);
}

static void refinement_free(refinement *work)
{
    brake_free(&work->brake);
    free(work->normals);
    refined_level_free(&work->now);
    refined_level_free(&work->before);
    free(work->vertex_sharpness);
    free(work->irregular);
    free(work->dependent);
}

static mesh_level level_of(const refinement *work)
{
    return (mesh_level){.faces = work->now.mesh.faces,
                        .sides = work->now.sides,
                        .links = &work->now.links,
                        .edge_sharpness = work->now.edge_sharpness,
                        .child_sharpness = work->now.child_sharpness,
                        .vertex_sharpness = work->vertex_sharpness,
                        .sharp = work->now.sharp.marked != NULL ? &work->now.sharp : NULL,
                        .irregular = work->irregular,
                        .coarse_count = work->coarse->vertex_count,
                        .parent = work->parent.faces != NULL ? &work->parent : NULL};
}

/// Set `irregular`: the number of faces at each coarse vertex, or 0 where that is 6, or 3 on the boundary.
static bat_status find_irregular(refinement *work, bat_error *error)
{
    enum
    {
        REGULAR = 6,
        REGULAR_AT_BOUNDARY = 3
    };
    const bat_mesh *coarse = work->coarse;
    if (array_zeros(&work->irregular, coarse->vertex_count, sizeof *work->irregular, error) != BAT_OK)
        return BAT_NO_MEMORY;
    uint32_t *irregular = work->irregular;
    for (size_t i = 0; i < 3 * coarse->face_count; i++)
        irregular[coarse->faces[i]]++;
    for (size_t v = 0; v < coarse->vertex_count; v++)
    {
        uint32_t first = work->links->first[v];
        bool boundary = first != BAT_MESH_NONE && mesh_at_boundary(work->links, first);
        if (irregular[v] == (boundary ? REGULAR_AT_BOUNDARY : REGULAR))
            irregular[v] = 0;
    }
    return BAT_OK;
}

/// Compute values at the vertices of the next level.
static bat_status refine_rows(const refinement *work, mesh_rule *rule, const double *from, size_t dim, size_t fine_count,
                              double **to, bat_error *error)
{
    if (array_make(to, fine_count, dim * sizeof **to, error) != BAT_OK)
        return BAT_NO_MEMORY;
    mesh_level level = level_of(work);
    mesh_rows rows = {&level, from, *to, dim};
    rule(&rows, work->plan->options.threads);
    return BAT_OK;
}

/// Split the texture faces. Seams are boundaries.
static bat_status split_texture(const refinement *work, const mesh_scheme *scheme, bool last, refined_level *next,
                                bat_error *error)
{
    const refined_level *now = &work->now;
    int threads = work->plan->options.threads;
    const bat_mesh_connectivity *links = &now->texture_links;
    size_t count = links->vertex_count + links->edge_count + (scheme->polygons ? links->face_count : 0);
    size_t corners = sides_corners(&next->sides, next->mesh.face_count);
    next->mesh.texture_count = count;
    next->mesh.texture = memory_array(count, 2 * sizeof *next->mesh.texture);
    next->mesh.texture_faces = memory_array(corners, sizeof *next->mesh.texture_faces);
    if (next->mesh.texture == NULL || next->mesh.texture_faces == NULL)
        return error_memory(error, corners * sizeof *next->mesh.texture_faces);
    mesh_level mesh = level_of(work), level = {.faces = now->mesh.texture_faces, .sides = now->sides, .links = links};
    if (scheme->creases && work->plan->rules.linear != BAT_MESH_LINEAR_ALL)
    {
        texture_rows rows = {.level = &mesh,
                             .seams = links,
                             .corners = level.faces,
                             .from = now->mesh.texture,
                             .to = next->mesh.texture,
                             .linear = work->plan->rules.linear,
                             .smooth = scheme->smooth,
                             .quads = scheme->polygons,
                             .dependent = work->dependent,
                             .dependent_count = work->coarse->texture_count,
                             .first_level = now->borrowed};
        bat_status status = texture_rule(&rows, error);
        if (status != BAT_OK)
            return status;
    }
    else
    {
        mesh_rows rows = {&level, now->mesh.texture, next->mesh.texture, 2};
        if (scheme->polygons)
            catmull_clark_linear_rule(&rows, threads);
        else
            midpoint_rule(&rows, threads);
    }
    const mesh_sides *polygons = scheme->polygons ? &now->sides : NULL;
    split_faces(polygons, level.faces, links, threads, next->mesh.texture_faces);
    return last ? BAT_OK : split_links(polygons, links, threads, &next->texture_links, error);
}

/// Split faces, texture and sharpness. With `last` skip the data that only a further level needs.
static bat_status split_level(const refinement *work, const mesh_scheme *scheme, bool last, refined_level *next,
                              bat_error *error)
{
    const refined_level *now = &work->now;
    int threads = work->plan->options.threads;
    mesh_level level = level_of(work);
    next->sides.quads = scheme->polygons;
    next->mesh.face_count = scheme->polygons ? sides_corners(&now->sides, now->mesh.face_count) : 4 * now->mesh.face_count;
    size_t corners = sides_corners(&next->sides, next->mesh.face_count);
    if (array_make(&next->mesh.faces, corners, sizeof *next->mesh.faces, error) != BAT_OK)
        return BAT_NO_MEMORY;
    const mesh_sides *polygons = scheme->polygons ? &now->sides : NULL;
    split_faces(polygons, now->mesh.faces, &now->links, threads, next->mesh.faces);
    bat_status status = now->mesh.texture_faces != NULL ? split_texture(work, scheme, last, next, error) : BAT_OK;
    if (status == BAT_OK && (!last || work->plan->limit != NULL))
        status = split_links(polygons, &now->links, threads, &next->links, error);
    if (status == BAT_OK && now->edge_sharpness != NULL && next->links.edge != NULL)
        status = sharpness_split(&level, &next->links, &next->edge_sharpness, error);
    return status == BAT_OK && last ? sharpness_write(&level, &next->mesh, error) : status;
}

/// One level of a scheme that splits faces. Learned positions come later, with a share of the butterfly's; channels are
/// interpolated linearly.
static bat_status split_step(const refinement *work, const mesh_scheme *scheme, bool last, refined_level *next,
                             bat_error *error)
{
    const bat_mesh *mesh = &work->now.mesh;
    const bat_mesh_connectivity *links = &work->now.links;
    size_t count = links->vertex_count + links->edge_count + (scheme->polygons ? links->face_count : 0);
    next->mesh.vertex_count = count;
    bat_status status = BAT_OK;
    if (!scheme->learned || work->brake.shared)
        status = refine_rows(work, scheme->learned ? butterfly_rule : scheme->rule, mesh->positions, 3, count,
                             &next->mesh.positions, error);
    if (status == BAT_OK && mesh->channel_count > 0)
        status = refine_rows(work, scheme->rule, mesh->channels, mesh->channel_count, count, &next->mesh.channels, error);
    return status == BAT_OK ? split_level(work, scheme, last, next, error) : status;
}

/// Compute the positions of `next`, the last learned level, of which those of the butterfly scheme have their share.
static bat_status learn_positions(const refinement *work, refined_level *next, bat_error *error)
{
    const bat_mesh_refine_options *options = &work->plan->options;
    bat_mesh *mesh = &next->mesh;
    double strength = 1 - options->fairness * options->fairness, *butterfly = mesh->positions;
    bat_mesh view = {.positions = memory_array(mesh->vertex_count, 3 * sizeof *view.positions),
                     .faces = mesh->faces,
                     .vertex_count = mesh->vertex_count,
                     .face_count = mesh->face_count};
    if (view.positions == NULL)
        return error_memory(error, mesh->vertex_count * 3 * sizeof *view.positions);
    bat_status status = options->rule->refine(options->rule, work->coarse, work->links, work->plan->learned_levels, options,
                                              &view, work->fallback, error);
    for (size_t i = 0; status == BAT_OK && butterfly != NULL && i < 3 * mesh->vertex_count; i++)
        view.positions[i] += strength * work->brake.plain[i / 3 * 4 + 3] * (butterfly[i] - view.positions[i]);
    mesh->positions = view.positions;
    free(butterfly);
    return status;
}

/// Make `next` the current level. With `keep` retain the faces and links of the previous one as the parent.
static void advance(refinement *work, refined_level *next, bool keep)
{
    refined_level *before = &work->before;
    refined_level_free(before);
    *before = work->now;
    work->now = *next;
    work->parent = (mesh_level){0};
    if (!keep)
    {
        refined_level_free(before);
        *before = (refined_level){0};
        return;
    }
    free(before->edge_sharpness);
    free(before->child_sharpness);
    sharp_list_free(&before->sharp);
    bat_mesh_connectivity_free(&before->texture_links);
    before->edge_sharpness = before->child_sharpness = NULL;
    if (!before->borrowed)
    {
        bat_mesh kept = {.faces = before->mesh.faces, .face_count = before->mesh.face_count};
        before->mesh.faces = NULL;
        bat_mesh_free(&before->mesh);
        before->mesh = kept;
    }
    work->parent.faces = before->mesh.faces;
    work->parent.sides = before->sides;
    work->parent.links = &before->links;
}

static bat_status step(refinement *work, size_t level, bat_error *error)
{
    const mesh_plan *plan = work->plan;
    const mesh_scheme *scheme = mesh_plan_scheme(plan, level);
    bool last = level + 1 == plan->options.levels;
    refined_level next = {.mesh.channel_count = work->coarse->channel_count};
    bat_status status = BAT_OK;
    const mesh_level now = level_of(work);
    if (plan->rules.creasing == BAT_MESH_CREASING_CHAIKIN)
        status = sharpness_chaikin(&now, &work->now.child_sharpness, error);
    if (status == BAT_OK && !scheme->turns)
        status = sharp_list_make(&now, &work->now.sharp, error);
    if (status == BAT_OK && scheme->turns)
        status = sqrt3_refine(&work->now.mesh, &work->now.links, level % 2 == 1, plan->options.threads, &next.mesh, error);
    else if (status == BAT_OK)
        status = split_step(work, scheme, last, &next, error);
    if (status == BAT_OK && scheme->turns && !last)
        status = bat_mesh_connect(&next.mesh, &next.links, error);
    if (status == BAT_OK && work->brake.coarse != NULL)
        status = brake_advance(&work->brake, &now, plan->options.threads, error);
    if (status == BAT_OK && level + 1 == plan->learned_levels)
        status = learn_positions(work, &next, error);
    if (status == BAT_OK && work->brake.coarse != NULL && level + 1 >= plan->learned_levels)
        *work->fallback += brake_judge(&work->brake, next.mesh.faces, next.mesh.positions);
    if (status != BAT_OK)
    {
        refined_level_free(&next);
        return status;
    }
    for (size_t v = 0; work->vertex_sharpness != NULL && v < work->coarse->vertex_count; v++)
        work->vertex_sharpness[v] = sharpness_after_level(work->vertex_sharpness[v]);
    advance(work, &next, !scheme->turns && !last);
    return BAT_OK;
}

/// What a refined mesh says about its further refinement: what was asked of it. Faces at a boundary are left out once.
static bat_mesh_rules fine_rules(const bat_mesh *coarse, const mesh_plan *plan)
{
    bat_mesh_rules rules = mesh_rules_or(plan->options.rules, coarse->rules);
    if (plan->rules.boundary == BAT_MESH_BOUNDARY_NONE)
        rules.boundary = BAT_MESH_BOUNDARY_AUTO;
    return rules;
}

/// Compute the normals of the limit surface at the vertices of the last level.
static bat_status find_normals(refinement *work, bat_error *error)
{
    int threads = work->plan->options.threads;
    bat_mesh view = work->now.mesh;
    view.rules = fine_rules(work->coarse, work->plan);
    if (array_make(&work->normals, view.vertex_count, 3 * sizeof *work->normals, error) != BAT_OK)
        return BAT_NO_MEMORY;
    bool quads = mesh_plan_scheme(work->plan, work->plan->options.levels)->polygons;
    return normals_compute(&view, &work->now.sides, quads ? &catmull_clark_normals : &loop_normals, threads, work->normals,
                           error);
}

/// Move the vertices of the last level to their limit positions.
static bat_status move_to_limit(refinement *work, bat_error *error)
{
    bat_mesh *mesh = &work->now.mesh;
    bat_status status = work->plan->options.limit_normals != NULL ? find_normals(work, error) : BAT_OK;
    if (status != BAT_OK)
        return status;
    double *moved = memory_array(mesh->vertex_count, 3 * sizeof *moved);
    if (moved == NULL)
        return error_memory(error, mesh->vertex_count * 3 * sizeof *moved);
    mesh_level level = level_of(work);
    mesh_rows rows = {&level, mesh->positions, moved, 3};
    work->plan->limit(&rows, work->plan->options.threads);
    free(mesh->positions);
    mesh->positions = moved;
    if (work->brake.coarse != NULL)
        *work->fallback += brake_judge(&work->brake, mesh->faces, moved);
    return BAT_OK;
}

static bat_status prepare(refinement *work, bat_error *error)
{
    const bat_mesh *coarse = work->coarse;
    mesh_level level = {.faces = coarse->faces, .sides = work->now.sides, .links = work->links};
    bool corners = work->plan->rules.boundary == BAT_MESH_BOUNDARY_CORNERS;
    bat_status status =
        sharpness_of_edges(&level, coarse, work->plan->options.crease_angle, &work->now.edge_sharpness, error);
    if (status == BAT_OK)
        status = sharpness_of_vertices(&level, coarse, corners, &work->vertex_sharpness, error);
    if (status == BAT_OK && coarse->texture_faces != NULL)
        status = connect_seams(coarse, &level.sides, work->links, &work->now.texture_links, error);
    if (status == BAT_OK)
        status = mesh_plan_check_size(work->plan, coarse, &level.sides, work->links, &work->now.texture_links, error);
    bat_mesh_linear linear = work->plan->rules.linear;
    if (status == BAT_OK && coarse->texture_faces != NULL &&
        (linear == BAT_MESH_LINEAR_CORNERS_PLUS1 || linear == BAT_MESH_LINEAR_CORNERS_PLUS2))
        status = array_zeros(&work->dependent, coarse->texture_count, sizeof *work->dependent, error);
    if (status == BAT_OK && work->plan->learned_levels > 0 && work->plan->options.rule->bounded)
    {
        bool named =
            work->now.edge_sharpness != NULL || work->vertex_sharpness != NULL || work->plan->options.crease_angle > 0;
        level.edge_sharpness = work->now.edge_sharpness;
        status = brake_make(coarse, &level, !named, &work->brake, error);
    }
    bool triangles = !level.sides.quads && level.sides.offsets == NULL;
    return status == BAT_OK && triangles ? find_irregular(work, error) : status;
}

static bat_status run_levels(refinement *work, bat_error *error)
{
    const bat_progress *progress = &work->plan->options.progress;
    bat_status status = BAT_OK;
    for (size_t level = 0; level < work->plan->options.levels && status == BAT_OK; level++)
    {
        if (progress->report != NULL && !progress->report(progress->context, mesh_plan_share(work->plan, level)))
            return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "refinement was stopped");
        status = step(work, level, error);
    }
    if (status == BAT_OK && work->plan->limit != NULL)
        status = move_to_limit(work, error);
    if (status == BAT_OK && progress->report != NULL)
        (void)progress->report(progress->context, 1);
    return status;
}

/// Hand the limit normals to the caller.
static void give_normals(refinement *work)
{
    if (work->normals != NULL)
        *work->plan->options.limit_normals = work->normals;
    work->normals = NULL;
}

/// Give the last level's faces the labels of the coarse faces whose children they are, which follow each other.
static bat_status carry_labels(refinement *work, const mesh_sides *coarse_sides, bat_error *error)
{
    const bat_mesh *coarse = work->coarse;
    bat_mesh *fine = &work->now.mesh;
    uint32_t *sources = NULL;
    if (coarse->face_labels != NULL && work->now.sides.quads)
    {
        size_t each = fine->face_count / sides_corners(coarse_sides, coarse->face_count);
        if (array_make(&sources, fine->face_count, sizeof *sources, error) != BAT_OK)
            return BAT_NO_MEMORY;
        for (size_t f = 0; f < fine->face_count; f++)
            sources[f] = sides_face(coarse_sides, (uint32_t)(f / each));
    }
    bat_status status = mesh_labels_carry(coarse, sources, fine->face_count / coarse->face_count, fine, error);
    free(sources);
    return status;
}

/// Leave out, if the rules say so, the faces that come from coarse faces with a vertex on a boundary that is not sharp for
/// ever, as OpenSubdiv does under VTX_BOUNDARY_NONE. Vertices and texture coordinates of no other face go, too.
/// @return BAT_OK; BAT_UNSUPPORTED where no face is left; BAT_NO_MEMORY
static bat_status leave_out_boundary(refinement *work, const mesh_sides *coarse_sides, bat_error *error)
{
    const bat_mesh *coarse = work->coarse;
    bat_mesh *fine = &work->now.mesh;
    if (work->plan->rules.boundary != BAT_MESH_BOUNDARY_NONE || work->links->boundary_edge_count == 0)
        return BAT_OK;
    mesh_level level = {.faces = coarse->faces, .sides = *coarse_sides, .links = work->links};
    size_t rows = fine->vertex_count > fine->texture_count ? fine->vertex_count : fine->texture_count;
    memory_pool pool = {0};
    bool *marked = memory_pool_array(&pool, coarse->vertex_count, sizeof *marked);
    uint32_t *numbers = memory_pool_array(&pool, rows, sizeof *numbers);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        mark_boundary(&level, coarse, marked);
        keep_faces(&level, marked, work->plan->options.levels, work->now.sides.quads ? 4 : 3, fine, work->normals, numbers);
        if (fine->face_count == 0)
            status = error_remedy(
                error,
                ERROR_UNSUPPORTED(error, 0, "every face is at the boundary, and the boundary rule 'none' leaves those out"),
                "rules.boundary", "edges keeps them");
    }
    memory_pool_free(&pool);
    return status;
}

/// Refine a mesh with known connectivity.
static bat_status refine_connected(const bat_mesh *coarse, const mesh_sides *sides, const bat_mesh_connectivity *links,
                                   const mesh_plan *plan, bat_mesh *fine, size_t *fallback, bat_error *error)
{
    refinement work = {.coarse = coarse,
                       .plan = plan,
                       .links = links,
                       .now = {.mesh = *coarse, .sides = *sides, .links = *links, .borrowed = true},
                       .fallback = fallback};
    bat_status status = prepare(&work, error);
    if (status == BAT_OK)
        status = run_levels(&work, error);
    if (status == BAT_OK)
        status = carry_labels(&work, sides, error);
    if (status == BAT_OK)
        status = leave_out_boundary(&work, sides, error);
    if (status == BAT_OK)
        status = channels_name(coarse, &work.now.mesh, error);
    if (status == BAT_OK)
        channels_bound(coarse, &work.now.mesh);
    size_t faces = work.now.mesh.face_count;
    if (status == BAT_OK && work.now.sides.quads && (work.now.mesh.offsets = sides_offsets(faces, 4)) == NULL)
        status = error_memory(error, (faces + 1) * sizeof(uint32_t));
    if (status == BAT_OK)
    {
        *fine = work.now.mesh;
        fine->rules = fine_rules(coarse, plan);
        work.now.mesh = (bat_mesh){0};
        give_normals(&work);
    }
    refinement_free(&work);
    return status;
}

/// The result for zero levels: a copy, moved to the limit surface if the options ask for it.
static bat_status refine_copy(const bat_mesh *coarse, const mesh_sides *sides, const bat_mesh_connectivity *links,
                              const mesh_plan *plan, bat_mesh *fine, bat_error *error)
{
    refinement work = {
        .coarse = coarse, .plan = plan, .links = links, .now = {.sides = *sides, .links = *links, .borrowed = true}};
    bat_status status = prepare(&work, error);
    if (status == BAT_OK)
        status = bat_mesh_copy(coarse, &work.now.mesh, error);
    if (status == BAT_OK && plan->limit != NULL)
        status = move_to_limit(&work, error);
    if (status == BAT_OK)
    {
        *fine = work.now.mesh;
        give_normals(&work);
    }
    else
        bat_mesh_free(&work.now.mesh);
    refinement_free(&work);
    return status;
}

/// Square-root-three turns edges over, across seams and creases: both are left out.
static bat_mesh without_edges(const bat_mesh *coarse)
{
    bat_mesh plain = *coarse;
    plain.texture = NULL;
    plain.texture_faces = NULL;
    plain.creases = NULL;
    plain.corners = NULL;
    plain.texture_count = plain.crease_count = plain.corner_count = 0;
    plain.rules = (bat_mesh_rules){0};
    return plain;
}

/// Refine a checked mesh by a complete plan.
static bat_status refine_planned(const bat_mesh *coarse, const mesh_sides *sides, const mesh_plan *plan, bat_mesh *fine,
                                 size_t *fallback, bat_error *error)
{
    bat_mesh_connectivity links = {0};
    bat_mesh separate = *coarse;
    separate.texture = NULL;
    separate.texture_faces = NULL;
    size_t corners = sides_corners(sides, coarse->face_count);
    bool smooth = coarse->texture_faces != NULL && plan->rules.linear != BAT_MESH_LINEAR_ALL;
    bat_status status = sides_connect(sides, coarse->faces, coarse->face_count, coarse->vertex_count, &links, error);
    if (status == BAT_OK && smooth)
        status =
            texture_separate(coarse, corners, &separate.texture, &separate.texture_count, &separate.texture_faces, error);
    const bat_mesh *whole = smooth ? &separate : coarse;
    if (status == BAT_OK && plan->options.levels > 0)
        status = refine_connected(whole, sides, &links, plan, fine, fallback, error);
    else if (status == BAT_OK)
        status = refine_copy(whole, sides, &links, plan, fine, error);
    free(separate.texture);
    free(separate.texture_faces);
    bat_mesh_connectivity_free(&links);
    return status;
}

bat_status refine_corners(const bat_mesh *coarse, const mesh_sides *sides, const bat_mesh_refine_options *options,
                          bat_mesh *fine, bat_error *error)
{
    mesh_plan plan;
    bat_status status = mesh_plan_make(coarse, options, &plan, error);
    return status == BAT_OK ? refine_planned(coarse, sides, &plan, fine, NULL, error) : status;
}

static bool is_adaptive(const bat_mesh_refine_options *options)
{
    return options->tolerance > 0 || options->max_edge > 0;
}

/// Refine adaptively, with the names of channels.
static bat_status refine_adaptively(const bat_mesh *coarse, const mesh_sides *sides, const bat_mesh_refine_options *options,
                                    bat_mesh *fine, bat_error *error)
{
    bat_mesh made;
    bat_status status = adaptive_refine(coarse, sides, options, &made, error);
    if (status != BAT_OK)
        return status;
    status = channels_name(coarse, &made, error);
    if (status == BAT_OK)
        *fine = made;
    else
        bat_mesh_free(&made);
    return status;
}

static bat_status check_triangles(const bat_mesh *mesh, bat_mesh_scheme scheme, bat_error *error)
{
    for (size_t f = 0; mesh->offsets != NULL && f < mesh->face_count; f++)
        if (mesh->offsets[f + 1] - mesh->offsets[f] != 3)
            return error_remedy(
                error,
                error_set(error, BAT_UNSUPPORTED, f, 0, "face %zu has %u corners, but the scheme %s refines triangles", f,
                          mesh->offsets[f + 1] - mesh->offsets[f], bat_choice_name(&bat_mesh_scheme_family, (int)scheme)),
                "scheme", "catmull-clark refines polygons as they are");
    return BAT_OK;
}

/// Refine a checked mesh by checked options.
static bat_status refine_checked(const bat_mesh *coarse, const bat_mesh_refine_options *options, bat_mesh *fine,
                                 size_t *fallback, bat_error *error)
{
    mesh_plan plan;
    mesh_sides sides = {0};
    uint32_t *face = NULL;
    bat_mesh plain;
    const bat_mesh *from = coarse;
    bat_status status = BAT_OK;
    if (mesh_scheme_of(options->scheme)->polygons)
        status = sides_of_mesh(coarse, &sides, &face, error);
    else if (coarse->offsets != NULL || options->scheme == BAT_MESH_SCHEME_SQRT3)
    {
        status = check_triangles(coarse, options->scheme, error);
        plain = options->scheme == BAT_MESH_SCHEME_SQRT3 ? without_edges(coarse) : *coarse;
        plain.offsets = NULL;
        from = &plain;
    }
    if (status == BAT_OK)
        status = mesh_plan_make(coarse, options, &plan, error);
    if (status == BAT_OK && is_adaptive(options))
        status = refine_adaptively(from, &sides, options, fine, error);
    else if (status == BAT_OK)
        status = refine_planned(from, &sides, &plan, fine, fallback, error);
    free(face);
    return status;
}

/// Set the scheme of BAT_MESH_SCHEME_AUTO. Adaptive refinement needs a limit surface, with sharp edges as learned finds.
static bat_status choose_scheme(const bat_mesh *mesh, bat_mesh_refine_options *how, bat_error *error)
{
    how->scheme = how->rule != NULL ? BAT_MESH_SCHEME_LEARNED : bat_mesh_scheme_for(mesh);
    if (how->scheme == BAT_MESH_SCHEME_AUTO)
        return error_memory(error, mesh->face_count);
    if (how->rule != NULL || !is_adaptive(how) || mesh_scheme_of(how->scheme)->creases)
        return BAT_OK;
    how->scheme = BAT_MESH_SCHEME_LOOP;
    bool solid = false;
    bat_status status = how->crease_angle == 0 ? bat_mesh_is_solid(mesh, &solid, error) : BAT_OK;
    how->crease_angle = solid ? BRAKE_SHARP : how->crease_angle;
    return status;
}

bat_status bat_mesh_refine(const bat_mesh *coarse, const bat_mesh_refine_options *options, bat_mesh *fine, size_t *fallback,
                           bat_error *error)
{
    bat_mesh_refine_options how = options != NULL ? *options : bat_mesh_refine_defaults();
    bat_mesh_model *model = NULL;
    size_t fallbacks = 0;
    bat_mesh made = {0};
    double *normals = NULL;
    if (how.limit_normals != NULL)
        how.limit_normals = &normals;
    bat_status status = bat_mesh_check(coarse, error);
    if (status == BAT_OK)
        status = bat_options_check(&bat_mesh_refine_fields, &how, error);
    if (status == BAT_OK && (how.levels > 0 || how.limit))
        status = mesh_check_coordinates(coarse, MAX_COORDINATE, error);
    if (status == BAT_OK && how.scheme == BAT_MESH_SCHEME_AUTO)
        status = choose_scheme(coarse, &how, error);
    if (status == BAT_OK && mesh_scheme_of(how.scheme)->learned && how.rule == NULL)
    {
        status = bat_mesh_model_read(NULL, &model, error);
        how.rule = status == BAT_OK ? bat_mesh_model_rule(model) : NULL;
    }
    if (status == BAT_OK)
        status = refine_checked(coarse, &how, &made, &fallbacks, error);
    bat_mesh_model_free(model);
    if (status != BAT_OK)
    {
        free(normals);
        bat_mesh_free(&made);
        return status;
    }
    if (options != NULL && options->limit_normals != NULL)
        *options->limit_normals = normals;
    *fine = made;
    if (fallback != NULL)
        *fallback = fallbacks;
    return BAT_OK;
}
