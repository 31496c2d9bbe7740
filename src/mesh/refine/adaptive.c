#include "mesh/refine/plan.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "mesh/labels.h"

/// @file
/// A level holds the faces that are split on the level before, and those that share a vertex with them. Only the first are
/// real: the others make the vertices around them right. So every vertex of a real face has all its faces, and its limit.
///
/// The distance of a face to the limit surface is bounded by second differences M of the control net at the vertices of the
/// faces around, as for splines: M / 6 for a triangle; for a quad M / 4 and a quarter of its twist.

#define MAX_DEPTH 14 ///< levels

/// A level of adaptive refinement.
typedef struct adaptive_level
{
    bat_mesh mesh;
    mesh_sides sides;
    bool borrowed; ///< `mesh`, but its creases and corners, and the arrays of `sides` belong to the caller
    bat_mesh_connectivity links;
    double *limits;     ///< vertex_count x 3
    uint32_t *number;   ///< of each vertex in the result; BAT_MESH_NONE for one that only helps
    bool *real, *split; ///< of each face
    uint32_t *source;   ///< of each face: the coarse face that it comes from
    /// For each half-edge, where its face is refined: the number of the vertex on it, BAT_MESH_NONE where no real face there
    /// is split; and the half-edge in the part that is refined.
    uint32_t *middle, *part;
    mesh_sides part_sides; ///< of the part that is refined
    memory_pool pool;      ///< of all arrays, but of the mesh and the limits
} adaptive_level;

static void level_free(adaptive_level *level)
{
    if (!level->borrowed)
        bat_mesh_free(&level->mesh);
    else
    {
        free(level->mesh.creases);
        free(level->mesh.corners);
    }
    bat_mesh_connectivity_free(&level->links);
    free(level->limits);
    memory_pool_free(&level->pool);
}

typedef struct adaptive_work
{
    const bat_mesh_refine_options *options;
    bat_mesh_refine_options step; ///< one level of the scheme, with the rules of the whole
    adaptive_level levels[MAX_DEPTH + 1];
    size_t depth;
    double *positions; ///< of the vertices of the result
    double *channels;
    size_t channel_count, vertex_count, position_capacity, channel_capacity;
    uint32_t *faces; ///< of the result
    size_t corner_count, corner_capacity;
    uint32_t *offsets;
    size_t face_count, offset_capacity;
    uint32_t *sources; ///< of the faces of the result: coarse faces
    size_t source_capacity;
    size_t max_memory; ///< bytes; 0: no bound is known
    size_t held;       ///< bytes of all levels, about
} adaptive_work;

static bat_status no_memory(const adaptive_work *work, bat_error *error)
{
    return error_memory(error, work->position_capacity * sizeof(double));
}

/// Add a vertex to the result. BAT_MESH_NONE when out of memory.
static uint32_t add_vertex(adaptive_work *work, const double *position, const double *channels)
{
    size_t n = work->vertex_count, dim = work->channel_count;
    if (n >= BAT_MESH_NONE - 1 || !ARRAY_GROW(work->positions, work->position_capacity, 3 * n + 3) ||
        (dim > 0 && !ARRAY_GROW(work->channels, work->channel_capacity, dim * (n + 1))))
        return BAT_MESH_NONE;
    memcpy(work->positions + 3 * n, position, 3 * sizeof *position);
    if (dim > 0 && channels != NULL)
        memcpy(work->channels + dim * n, channels, dim * sizeof *channels);
    work->vertex_count++;
    return (uint32_t)n;
}

/// The length of the second difference of three vertices.
static double second_difference(const double *a, const double *b, const double *c)
{
    double d[3];
    for (int i = 0; i < 3; i++)
        d[i] = a[i] - 2 * b[i] + c[i];
    return sqrt(vector3_dot(d, d));
}

/// The largest second difference at a vertex: of opposite neighbours, or of those along its crease.
static double bend_at(const mesh_level *level, const double *positions, uint32_t vertex)
{
    sharp_vertex sharp;
    sharpness_around(level, vertex, &sharp, NULL, NULL);
    const double *own = positions + 3 * (size_t)vertex;
    if (sharp.kind == SHARP_CORNER)
        return 0;
    if (sharp.kind == SHARP_CREASE)
        return second_difference(positions + 3 * (size_t)sharp.ends[0], own, positions + 3 * (size_t)sharp.ends[1]);
    uint32_t first = level->links->first[vertex], h = first, valence = 0, far;
    do
    {
        valence++;
        h = sides_next_around(level, h);
    } while (h != first);
    for (far = first, valence = valence / 2; valence > 0; valence--)
        far = sides_next_around(level, far);
    double largest = 0;
    do
    {
        largest = fmax(largest, second_difference(positions + 3 * (size_t)level->faces[sides_next(&level->sides, h)], own,
                                                  positions + 3 * (size_t)level->faces[sides_next(&level->sides, far)]));
        h = sides_next_around(level, h);
        far = sides_next_around(level, far);
    } while (h != first);
    return largest;
}

/// The largest value at the vertices of the faces around a face's corners.
static double largest_around(const adaptive_level *now, const mesh_level *level, uint32_t face, const double *bends)
{
    double largest = 0;
    for (uint32_t c = sides_begin(&now->sides, face); c < sides_begin(&now->sides, face + 1); c++)
    {
        uint32_t first = now->links.first[now->mesh.faces[c]], h = first;
        do
        {
            for (uint32_t i = sides_next(&now->sides, h); i != h; i = sides_next(&now->sides, i))
                largest = fmax(largest, bends[now->mesh.faces[i]]);
            largest = fmax(largest, bends[now->mesh.faces[h]]);
            h = sides_next_around(level, h);
        } while (h != BAT_MESH_NONE && h != first);
    }
    return largest;
}

/// Whether a real face is to be split.
static bool needs_split(const adaptive_work *work, const adaptive_level *now, const mesh_level *level, uint32_t face,
                        const double *bends)
{
    uint32_t begin = sides_begin(&now->sides, face);
    bool quads = work->options->scheme == BAT_MESH_SCHEME_CATMULL_CLARK;
    uint32_t size = quads ? 4 : 3;
    const double *corner[4];
    if (sides_begin(&now->sides, face + 1) - begin != size)
        return true;
    for (uint32_t i = 0; i < size; i++)
        corner[i] = now->limits + 3 * (size_t)now->mesh.faces[begin + i];
    for (uint32_t i = 0; i < size && work->options->max_edge > 0; i++)
        if (vector3_distance(corner[i], corner[(i + 1) % size]) > work->options->max_edge)
            return true;
    if (!(work->options->tolerance > 0))
        return false;
    double bend = largest_around(now, level, face, bends), twist[3], bound = bend / 6;
    if (quads)
    {
        for (int i = 0; i < 3; i++)
            twist[i] = corner[0][i] - corner[1][i] + corner[2][i] - corner[3][i];
        bound = bend / 4 + sqrt(vector3_dot(twist, twist)) / 4;
    }
    return bound > work->options->tolerance;
}

/// Choose the faces to split.
static bat_status choose_faces(const adaptive_work *work, adaptive_level *now, size_t *count, bat_error *error)
{
    size_t vertices = now->mesh.vertex_count;
    mesh_level level = {
        .faces = now->mesh.faces, .sides = now->sides, .links = &now->links, .coarse_count = now->mesh.vertex_count};
    double *edges = NULL, *corners = NULL, *bends = memory_array(vertices, sizeof *bends);
    now->split = memory_pool_array(&now->pool, now->mesh.face_count, sizeof *now->split);
    bat_status status = bends != NULL && now->split != NULL ? BAT_OK : no_memory(work, error);
    if (status == BAT_OK)
        status = sharpness_of_edges(&level, &now->mesh, 0, &edges, error);
    if (status == BAT_OK)
        status = sharpness_of_vertices(&level, &now->mesh, false, &corners, error);
    level.edge_sharpness = edges;
    level.vertex_sharpness = corners;
    for (uint32_t v = 0; v < vertices && status == BAT_OK; v++)
        bends[v] = now->number[v] != BAT_MESH_NONE && now->links.first[v] != BAT_MESH_NONE
                       ? bend_at(&level, now->mesh.positions, v)
                       : 0;
    *count = 0;
    for (uint32_t f = 0; f < now->mesh.face_count && status == BAT_OK; f++)
    {
        now->split[f] = now->real[f] && needs_split(work, now, &level, f, bends);
        *count += now->split[f];
    }
    free(edges);
    free(corners);
    free(bends);
    return status;
}

/// Number the vertices of real faces that are new, at their limits.
static bat_status number_vertices(adaptive_work *work, adaptive_level *now, bool *fresh, bat_error *error)
{
    for (size_t v = 0; v < now->mesh.vertex_count; v++)
    {
        if (!fresh[v])
            continue;
        const double *channels = now->mesh.channels != NULL ? now->mesh.channels + work->channel_count * v : NULL;
        now->number[v] = add_vertex(work, now->limits + 3 * v, channels);
        if (now->number[v] == BAT_MESH_NONE)
            return no_memory(work, error);
    }
    return BAT_OK;
}

/// Compute connectivity and limits of a level whose mesh is set.
static bat_status find_limits(const adaptive_work *work, adaptive_level *now, bat_error *error)
{
    bat_mesh_refine_options options = work->step;
    options.levels = 0;
    options.limit = true;
    bat_mesh moved = {0};
    bat_status status =
        sides_connect(&now->sides, now->mesh.faces, now->mesh.face_count, now->mesh.vertex_count, &now->links, error);
    if (status == BAT_OK)
        status = refine_corners(&now->mesh, &now->sides, &options, &moved, error);
    now->limits = moved.positions;
    moved.positions = NULL;
    bat_mesh_free(&moved);
    return status;
}

/// Make the arrays of a level whose mesh is set. `fresh` receives one for each vertex.
static bat_status make_arrays(const adaptive_work *work, adaptive_level *now, bool **fresh, bat_error *error)
{
    now->number = memory_pool_array(&now->pool, now->mesh.vertex_count, sizeof *now->number);
    now->real = memory_pool_array(&now->pool, now->mesh.face_count, sizeof *now->real);
    now->source = memory_pool_array(&now->pool, now->mesh.face_count, sizeof *now->source);
    *fresh = memory_pool_array(&now->pool, now->mesh.vertex_count, sizeof **fresh);
    return now->pool.missing == 0 ? BAT_OK : no_memory(work, error);
}

/// The part of a level that is refined: its mesh, and which vertices and faces of the level it has.
typedef struct level_part
{
    bat_mesh mesh;
    uint32_t *vertex, *face; ///< of the level, for each of the part
    uint32_t *vertex_in;     ///< of the part, for each of the level that a face has which is split
    uint32_t *corner_vertex; ///< of the part, for each corner of the level
    memory_pool pool;        ///< of all arrays but the mesh's
} level_part;

/// Mark faces that share a vertex with one that is split, and count their corners.
static void mark_part(const adaptive_level *now, bool *near_split, bool *in_part, level_part *part, size_t *corners)
{
    memset(near_split, 0, now->mesh.vertex_count * sizeof *near_split);
    for (uint32_t f = 0; f < now->mesh.face_count; f++)
        for (uint32_t c = sides_begin(&now->sides, f); now->split[f] && c < sides_begin(&now->sides, f + 1); c++)
            near_split[now->mesh.faces[c]] = true;
    *corners = 0;
    for (uint32_t f = 0; f < now->mesh.face_count; f++)
    {
        uint32_t begin = sides_begin(&now->sides, f), end = sides_begin(&now->sides, f + 1);
        in_part[f] = false;
        for (uint32_t c = begin; c < end; c++)
            in_part[f] = in_part[f] || near_split[now->mesh.faces[c]];
        if (!in_part[f])
            continue;
        part->face[part->mesh.face_count++] = f;
        *corners += end - begin;
    }
}

/// Give a number to the corners of one fan of the part's faces.
static void number_fan(const adaptive_level *now, const bool *in_part, uint32_t corner, uint32_t number, uint32_t *of_corner)
{
    for (uint32_t h = corner; h != BAT_MESH_NONE && in_part[sides_face(&now->sides, h)] && of_corner[h] != number;)
    {
        of_corner[h] = number;
        h = now->links.twin[sides_previous(&now->sides, h)];
    }
    for (uint32_t twin = now->links.twin[corner]; twin != BAT_MESH_NONE && in_part[sides_face(&now->sides, twin)];)
    {
        uint32_t h = sides_next(&now->sides, twin);
        if (of_corner[h] == number)
            return;
        of_corner[h] = number;
        twin = now->links.twin[h];
    }
}

/// Number the vertices of a part. The part can have several fans of faces at its outermost vertices, which only help. Each
/// fan has a vertex of its own there, so that the part is a manifold.
static void number_part(const adaptive_level *now, const bool *near_split, const bool *in_part, level_part *part)
{
    memset(part->vertex_in, 0xff, now->mesh.vertex_count * sizeof *part->vertex_in);
    memset(part->corner_vertex, 0xff, sides_corners(&now->sides, now->mesh.face_count) * sizeof *part->corner_vertex);
    for (size_t i = 0; i < part->mesh.face_count; i++)
        for (uint32_t c = sides_begin(&now->sides, part->face[i]); c < sides_begin(&now->sides, part->face[i] + 1); c++)
        {
            uint32_t vertex = now->mesh.faces[c], number = (uint32_t)part->mesh.vertex_count;
            if (near_split[vertex] && part->vertex_in[vertex] != BAT_MESH_NONE)
                part->corner_vertex[c] = part->vertex_in[vertex];
            if (part->corner_vertex[c] != BAT_MESH_NONE)
                continue;
            part->vertex[part->mesh.vertex_count++] = vertex;
            if (near_split[vertex])
                part->corner_vertex[c] = part->vertex_in[vertex] = number;
            else
                number_fan(now, in_part, c, number, part->corner_vertex);
        }
}

/// Fill the part's lists of corners and the level's `part`.
static void fill_faces(adaptive_level *now, level_part *part, uint32_t *offsets, uint32_t *face_of)
{
    uint32_t corner = 0;
    for (uint32_t i = 0; i < part->mesh.face_count; i++)
    {
        if (offsets != NULL)
            offsets[i] = corner;
        for (uint32_t c = sides_begin(&now->sides, part->face[i]); c < sides_begin(&now->sides, part->face[i] + 1); c++)
        {
            if (face_of != NULL)
                face_of[corner] = i;
            now->part[c] = corner;
            part->mesh.faces[corner++] = part->corner_vertex[c];
        }
    }
    if (offsets != NULL)
        offsets[part->mesh.face_count] = corner;
}

/// Take along the values at vertices, and the corners.
static void fill_values(const adaptive_level *now, level_part *part)
{
    const bat_mesh *from = &now->mesh;
    bat_mesh *to = &part->mesh;
    size_t dim = from->channel_count;
    for (size_t i = 0; i < to->vertex_count; i++)
    {
        memcpy(to->positions + 3 * i, from->positions + 3 * (size_t)part->vertex[i], 3 * sizeof *to->positions);
        if (dim > 0)
            memcpy(to->channels + dim * i, from->channels + dim * part->vertex[i], dim * sizeof *to->channels);
    }
    for (size_t i = 0; i < from->corner_count; i++)
        if (part->vertex_in[from->corners[i].vertex] != BAT_MESH_NONE)
            to->corners[to->corner_count++] =
                (bat_mesh_corner){part->vertex_in[from->corners[i].vertex], from->corners[i].sharpness};
}

static void fill_creases(const adaptive_level *now, const double *edges, level_part *part)
{
    bat_mesh *to = &part->mesh;
    for (size_t i = 0; edges != NULL && i < to->face_count; i++)
        for (uint32_t c = sides_begin(&now->sides, part->face[i]); c < sides_begin(&now->sides, part->face[i] + 1); c++)
        {
            double sharpness = edges[now->links.edge[c]];
            uint32_t a = part->corner_vertex[c], b = part->corner_vertex[sides_next(&now->sides, c)];
            if (sharpness > 0)
                to->creases[to->crease_count++] = (bat_mesh_crease){a, b, sharpness};
        }
}

/// Cut out the part of a level that is refined.
static bat_status make_part(adaptive_level *now, level_part *part, bat_error *error)
{
    size_t vertices = now->mesh.vertex_count, all = sides_corners(&now->sides, now->mesh.face_count), corners;
    *part = (level_part){0};
    memory_pool scratch = {0}, *pool = &part->pool;
    bool *near_split = memory_pool_array(&scratch, vertices, sizeof *near_split);
    bool *in_part = memory_pool_array(&scratch, now->mesh.face_count, sizeof *in_part);
    part->vertex = memory_pool_array(pool, all, sizeof *part->vertex);
    part->corner_vertex = memory_pool_array(pool, all, sizeof *part->corner_vertex);
    part->face = memory_pool_array(pool, now->mesh.face_count, sizeof *part->face);
    part->vertex_in = memory_pool_array(pool, vertices, sizeof *part->vertex_in);
    now->part = memory_pool_array(&now->pool, all, sizeof *now->part);
    now->middle = memory_pool_array(&now->pool, all, sizeof *now->middle);
    double *edges = NULL;
    mesh_level level = {.faces = now->mesh.faces, .sides = now->sides, .links = &now->links};
    bat_status status = sharpness_of_edges(&level, &now->mesh, 0, &edges, error);
    bool made = scratch.missing == 0 && pool->missing == 0 && now->pool.missing == 0;
    if (status == BAT_OK && made)
    {
        memset(now->part, 0xff, all * sizeof *now->part);
        memset(now->middle, 0xff, all * sizeof *now->middle);
        mark_part(now, near_split, in_part, part, &corners);
        number_part(now, near_split, in_part, part);
        bat_mesh *to = &part->mesh;
        bool mixed = now->sides.offsets != NULL;
        uint32_t *offsets = mixed ? memory_pool_array(&now->pool, to->face_count + 1, sizeof *offsets) : NULL;
        uint32_t *face_of = mixed ? memory_pool_array(&now->pool, corners, sizeof *face_of) : NULL;
        now->part_sides = (mesh_sides){.quads = now->sides.quads, .offsets = offsets, .face = face_of};
        to->channel_count = now->mesh.channel_count;
        to->channel_names = now->mesh.channel_names;
        to->faces = memory_array(corners, sizeof *to->faces);
        to->positions = memory_array(to->vertex_count, 3 * sizeof *to->positions);
        to->channels = to->channel_count > 0 ? memory_array(to->vertex_count, to->channel_count * sizeof(double)) : NULL;
        to->creases = edges != NULL ? memory_array(corners, sizeof *to->creases) : NULL;
        to->corners = now->mesh.corner_count > 0 ? memory_array(now->mesh.corner_count, sizeof *to->corners) : NULL;
        made = to->faces != NULL && to->positions != NULL && (to->channel_count == 0 || to->channels != NULL) &&
               (edges == NULL || to->creases != NULL) && (now->mesh.corner_count == 0 || to->corners != NULL) &&
               now->pool.missing == 0;
        if (made)
        {
            fill_faces(now, part, offsets, face_of);
            fill_values(now, part);
            fill_creases(now, edges, part);
        }
    }
    memory_pool_free(&scratch);
    free(edges);
    return status == BAT_OK && !made ? error_memory(error, all * sizeof *now->part) : status;
}

/// Which vertices and faces of the next level are real, and the numbers of the vertices there are already.
static void inherit(adaptive_level *now, const level_part *part, const bat_mesh_connectivity *links, adaptive_level *next,
                    bool *fresh)
{
    bool quads = next->sides.quads;
    size_t old = part->mesh.vertex_count;
    memset(next->number, 0xff, next->mesh.vertex_count * sizeof *next->number);
    memset(fresh, 0, next->mesh.vertex_count * sizeof *fresh);
    for (size_t v = 0; v < old; v++)
        next->number[v] = now->number[part->vertex[v]];
    for (uint32_t i = 0; i < part->mesh.face_count; i++)
    {
        bool split = now->split[part->face[i]];
        uint32_t begin = sides_begin(&now->part_sides, i), end = sides_begin(&now->part_sides, i + 1);
        for (uint32_t f = quads ? begin : 4 * i; f < (quads ? end : 4 * i + 4); f++)
        {
            next->real[f] = split;
            next->source[f] = now->source[part->face[i]];
        }
        for (uint32_t h = begin; h < end && split; h++)
            fresh[old + links->edge[h]] = true;
        if (quads && split)
            fresh[old + links->edge_count + i] = true;
    }
}

/// Make the next level from the faces that are split.
static bat_status descend(adaptive_work *work, adaptive_level *now, adaptive_level *next, bat_error *error)
{
    level_part part = {0};
    bat_mesh_connectivity links = {0};
    bat_status status = make_part(now, &part, error);
    if (status == BAT_OK)
        status =
            sides_connect(&now->part_sides, part.mesh.faces, part.mesh.face_count, part.mesh.vertex_count, &links, error);
    if (status == BAT_OK)
        status = refine_corners(&part.mesh, &now->part_sides, &work->step, &next->mesh, error);
    next->sides.quads = work->options->scheme == BAT_MESH_SCHEME_CATMULL_CLARK;
    bool *fresh;
    if (status == BAT_OK)
        status = make_arrays(work, next, &fresh, error);
    if (status == BAT_OK)
        status = find_limits(work, next, error);
    if (status == BAT_OK)
    {
        inherit(now, &part, &links, next, fresh);
        status = number_vertices(work, next, fresh, error);
    }
    for (uint32_t h = 0; h < sides_corners(&now->sides, now->mesh.face_count) && status == BAT_OK; h++)
        if (now->part[h] != BAT_MESH_NONE)
            now->middle[h] = next->number[part.mesh.vertex_count + links.edge[now->part[h]]];
    bat_mesh_connectivity_free(&links);
    part.mesh.channel_names = NULL;
    part.mesh.channel_count = 0;
    bat_mesh_free(&part.mesh);
    memory_pool_free(&part.pool);
    return status;
}

/// Add a corner to the face of the result that is being made.
static bool add_corner(adaptive_work *work, uint32_t number)
{
    return work->corner_count < BAT_MESH_NONE - 1 &&
           ARRAY_ADD(work->faces, work->corner_capacity, work->corner_count, number);
}

static bool end_face(adaptive_work *work, uint32_t source)
{
    if (!ARRAY_GROW(work->offsets, work->offset_capacity, work->face_count + 2) ||
        !ARRAY_ADD(work->sources, work->source_capacity, work->face_count, source))
        return false;
    work->offsets[0] = 0;
    work->offsets[work->face_count] = (uint32_t)work->corner_count;
    return true;
}

/// Numbers in an array that grows.
typedef struct number_list
{
    uint32_t *numbers;
    size_t count, capacity;
} number_list;

static bool list_add(number_list *list, uint32_t number)
{
    return ARRAY_ADD(list->numbers, list->capacity, list->count, number);
}

/// List the vertices on a half-edge, of all finer levels.
static bool list_middles(const adaptive_work *work, size_t depth, uint32_t half_edge, number_list *list)
{
    const adaptive_level *now = &work->levels[depth];
    if (depth + 1 >= work->depth || now->middle == NULL || now->middle[half_edge] == BAT_MESH_NONE)
        return true;
    uint32_t h = now->part[half_edge];
    bool quads = work->options->scheme == BAT_MESH_SCHEME_CATMULL_CLARK;
    uint32_t near = quads ? 4 * h : split_near(h);
    uint32_t far = quads ? 4 * sides_next(&now->part_sides, h) + 3 : split_far(h);
    return list_middles(work, depth + 1, near, list) && list_add(list, now->middle[half_edge]) &&
           list_middles(work, depth + 1, far, list);
}

/// Add a triangle whose edge i, from corner i, has the vertices numbers[begin[i]], …, numbers[end[i] - 1] on it: the edge
/// with most of them is halved until there are none.
static bool add_triangle(adaptive_work *work, uint32_t source, const uint32_t corner[3], const uint32_t *numbers,
                         const size_t begin[3], const size_t end[3])
{
    int longest = 0;
    for (int i = 1; i < 3; i++)
        if (end[i] - begin[i] > end[longest] - begin[longest])
            longest = i;
    if (end[longest] == begin[longest])
        return add_corner(work, corner[0]) && add_corner(work, corner[1]) && add_corner(work, corner[2]) &&
               end_face(work, source);
    int a = longest, b = (a + 1) % 3, c = (a + 2) % 3;
    size_t middle = begin[a] + (end[a] - begin[a]) / 2;
    const uint32_t first[3] = {corner[a], numbers[middle], corner[c]}, second[3] = {numbers[middle], corner[b], corner[c]};
    const size_t first_begin[3] = {begin[a], 0, begin[c]}, first_end[3] = {middle, 0, end[c]};
    const size_t second_begin[3] = {middle + 1, begin[b], 0}, second_end[3] = {end[a], end[b], 0};
    return add_triangle(work, source, first, numbers, first_begin, first_end) &&
           add_triangle(work, source, second, numbers, second_begin, second_end);
}

/// Add a face that is not split.
static bool add_leaf(adaptive_work *work, size_t depth, uint32_t face, number_list *list)
{
    const adaptive_level *now = &work->levels[depth];
    uint32_t begin = sides_begin(&now->sides, face), end = sides_begin(&now->sides, face + 1), corner[3] = {0};
    size_t from[3] = {0}, to[3] = {0};
    bool made = true, quads = work->options->scheme == BAT_MESH_SCHEME_CATMULL_CLARK;
    list->count = 0;
    for (uint32_t h = begin; h < end && made; h++)
    {
        uint32_t number = now->number[now->mesh.faces[h]];
        size_t before = list->count + quads;
        made = (!quads || list_add(list, number)) && list_middles(work, depth, h, list);
        if (quads)
            continue;
        corner[h - begin] = number;
        from[h - begin] = before;
        to[h - begin] = list->count;
    }
    if (!quads)
        return made && add_triangle(work, now->source[face], corner, list->numbers, from, to);
    for (size_t i = 0; i < list->count && made; i++)
        made = add_corner(work, list->numbers[i]);
    return made && end_face(work, now->source[face]);
}

static bat_status collect(adaptive_work *work, bat_error *error)
{
    number_list list = {0};
    bool made = true;
    for (size_t depth = 0; depth < work->depth && made; depth++)
        for (uint32_t f = 0; f < work->levels[depth].mesh.face_count && made; f++)
            if (work->levels[depth].real[f] && !work->levels[depth].split[f])
                made = add_leaf(work, depth, f, &list);
    free(list.numbers);
    return made ? BAT_OK : no_memory(work, error);
}

/// Make creases and corners of what is sharp by angles and by the boundary rule, so that parts of the mesh have the same.
static bat_status take_marks(adaptive_work *work, const bat_mesh *coarse, adaptive_level *now, bat_error *error)
{
    mesh_plan plan;
    double *edges = NULL, *vertices = NULL;
    bat_mesh_connectivity links = {0};
    mesh_level level = {.faces = coarse->faces, .sides = now->sides, .links = &links};
    bat_status status = mesh_plan_make(coarse, work->options, &plan, error);
    if (status == BAT_OK && plan.rules.boundary == BAT_MESH_BOUNDARY_NONE)
        status = error_remedy(error, ERROR_UNSUPPORTED(error, 0, "adaptive refinement keeps the faces at the boundary"),
                              "rules.boundary", "edges or corners does, too");
    if (status == BAT_OK)
        status = sides_connect(&now->sides, coarse->faces, coarse->face_count, coarse->vertex_count, &links, error);
    if (status == BAT_OK)
        status = sharpness_of_edges(&level, coarse, plan.options.crease_angle, &edges, error);
    if (status == BAT_OK)
        status = sharpness_of_vertices(&level, coarse, plan.rules.boundary == BAT_MESH_BOUNDARY_CORNERS, &vertices, error);
    bat_mesh *to = &now->mesh;
    to->creases = status == BAT_OK && edges != NULL ? memory_array(links.edge_count, sizeof *to->creases) : NULL;
    to->corners = status == BAT_OK && vertices != NULL ? memory_array(coarse->vertex_count, sizeof *to->corners) : NULL;
    to->crease_count = to->corner_count = 0;
    if (status == BAT_OK && ((edges != NULL && to->creases == NULL) || (vertices != NULL && to->corners == NULL)))
        status = no_memory(work, error);
    for (uint32_t h = 0; status == BAT_OK && edges != NULL && h < sides_corners(&now->sides, coarse->face_count); h++)
        if (mesh_owns(links.twin, h) && edges[links.edge[h]] > 0)
            to->creases[to->crease_count++] =
                (bat_mesh_crease){coarse->faces[h], coarse->faces[sides_next(&now->sides, h)], edges[links.edge[h]]};
    for (uint32_t v = 0; status == BAT_OK && vertices != NULL && v < coarse->vertex_count; v++)
        if (vertices[v] > 0)
            to->corners[to->corner_count++] = (bat_mesh_corner){v, vertices[v]};
    work->step.rules = plan.rules;
    work->step.rules.boundary = BAT_MESH_BOUNDARY_EDGES;
    work->step.crease_angle = 0;
    free(edges);
    free(vertices);
    bat_mesh_connectivity_free(&links);
    return status;
}

/// Set the coarsest level: all faces are real.
static bat_status begin(adaptive_work *work, const bat_mesh *coarse, const mesh_sides *sides, bat_error *error)
{
    adaptive_level *now = &work->levels[0];
    now->mesh = *coarse;
    now->mesh.texture = NULL;
    now->mesh.texture_faces = NULL;
    now->mesh.texture_count = 0;
    now->mesh.rules = (bat_mesh_rules){0};
    mesh_labels_forget(&now->mesh);
    now->sides = *sides;
    now->borrowed = true;
    bat_status status = take_marks(work, coarse, now, error);
    if (status != BAT_OK)
        return status;
    bool *fresh;
    status = make_arrays(work, now, &fresh, error);
    if (status == BAT_OK)
    {
        memset(now->real, true, coarse->face_count * sizeof *now->real);
        for (uint32_t f = 0; f < coarse->face_count; f++)
            now->source[f] = f;
        memset(fresh, true, coarse->vertex_count * sizeof *fresh);
        status = find_limits(work, now, error);
    }
    return status == BAT_OK ? number_vertices(work, now, fresh, error) : status;
}

/// Refuse the level after one with `count` faces to be split where its arrays, the work on them and the result would take
/// more memory than is allowed. The faces beside those are counted, too: all of the level where there are few.
static bat_status check_memory(adaptive_work *work, const adaptive_level *now, size_t depth, size_t count, bat_error *error)
{
    enum
    {
        BESIDE = 9,       ///< faces that a regular face shares vertices with, itself included
        CORNER_WORDS = 16 ///< numbers for each corner of a level: its mesh, links, parts, and those of its refinement
    };
    static const double gigabyte = 1e9;
    bool quads = work->options->scheme == BAT_MESH_SCHEME_CATMULL_CLARK;
    double part = fmin((double)now->mesh.face_count, BESIDE * (double)count);
    double faces = part * (double)sides_corners(&now->sides, now->mesh.face_count) / (double)now->mesh.face_count;
    faces = quads ? faces : 4 * part;
    double corners = (quads ? 4 : 3) * faces, vertices = quads ? faces : faces / 2;
    double level =
        CORNER_WORDS * sizeof(uint32_t) * corners + (10 + 3 * (double)work->channel_count) * sizeof(double) * vertices;
    double result = 2 * (3 + (double)work->channel_count) * sizeof(double) * ((double)work->vertex_count + vertices) +
                    2 * 3 * sizeof(uint32_t) * ((double)work->face_count + faces);
    double bytes = (double)work->held + level + result;
    work->held += (size_t)level;
    if (work->max_memory == 0 || bytes <= (double)work->max_memory)
        return BAT_OK;
    (void)ERROR_TOO_LARGE(error, "level %zu of adaptive refinement takes %.3g GB of memory, more than the %.3g GB %s",
                          depth + 1, bytes / gigabyte, (double)work->max_memory / gigabyte,
                          work->options->max_memory > 0 ? "allowed" : "available");
    return error_remedy(error, BAT_TOO_LARGE, work->options->tolerance > 0 ? "tolerance" : "max_edge", "can be larger");
}

static bat_status run(adaptive_work *work, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t depth = 0; depth <= MAX_DEPTH && status == BAT_OK; depth++)
    {
        size_t count;
        work->depth = depth + 1;
        status = choose_faces(work, &work->levels[depth], &count, error);
        if (status != BAT_OK || count == 0)
            return status;
        if (depth == MAX_DEPTH)
            return ERROR_TOO_LARGE(error, "%d levels do not reach the tolerance or the edge length", MAX_DEPTH);
        status = check_memory(work, &work->levels[depth], depth, count, error);
        if (status == BAT_OK)
            status = descend(work, &work->levels[depth], &work->levels[depth + 1], error);
    }
    return status;
}

bat_status adaptive_refine(const bat_mesh *coarse, const mesh_sides *sides, const bat_mesh_refine_options *options,
                           bat_mesh *fine, bat_error *error)
{
    adaptive_work *work = calloc(1, sizeof *work);
    if (work == NULL)
        return error_memory(error, sizeof *work);
    work->options = options;
    work->channel_count = coarse->channel_count;
    work->step = *options;
    work->step.levels = 1;
    work->step.limit = false;
    work->step.tolerance = work->step.max_edge = 0;
    work->step.limit_normals = NULL;
    work->max_memory = options->max_memory > 0 ? options->max_memory : memory_available();
    bat_status status = begin(work, coarse, sides, error);
    if (status == BAT_OK)
        status = run(work, error);
    if (status == BAT_OK)
        status = collect(work, error);
    for (size_t depth = 0; depth <= MAX_DEPTH; depth++)
        level_free(&work->levels[depth]);
    bat_mesh made = {.positions = work->positions,
                     .faces = work->faces,
                     .offsets = work->offsets,
                     .vertex_count = work->vertex_count,
                     .face_count = work->face_count,
                     .channels = work->channels};
    if (options->scheme != BAT_MESH_SCHEME_CATMULL_CLARK)
    {
        free(made.offsets);
        made.offsets = NULL;
    }
    if (status == BAT_OK)
        status = mesh_labels_carry(coarse, work->sources, 1, &made, error);
    free(work->sources);
    free(work);
    if (status == BAT_OK)
        *fine = made;
    else
        bat_mesh_free(&made);
    return status;
}
