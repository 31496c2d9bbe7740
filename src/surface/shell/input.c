/// @file
/// From points or a mesh to the triangles that layouts are made of; see work.h.

#include "surface/shell/work.h"

#include "batten/mesh_refine.h"
#include "mesh/check.h"
#include "mesh/decimate/map.h"
#include "mesh/labels.h"
#include "mesh/refine/sharpness.h"

#include <string.h>

#define MESH_POINTS 40000 ///< samples of a mesh
#define RELAXATIONS 4
#define CONNECTED_FACES 24000 ///< of the mesh that connects points: grids make slivers, which decimation takes away

/// Factor of the smoothing by the noise in spacings, of which correction hides a part, and its largest value.
static const double NOISE_SLOPE = 3, MIN_NOISE = 0.05, MAX_NOISY = 3;
/// Share of the way to the middle of the neighbours.
static const double RELAXATION = 0.7;
/// Least quality of the triangles of a scaffold with creases or boundaries: flat parts would get slivers.
static const double MIN_QUALITY = 0.3;
/// Noise in spacings, from which creases are not looked for.
static const double MAX_CREASE_NOISE = 0.3;
/// Grid on which points are put to make the mesh: it hides rounding, so that turned points give the same mesh.
static const double ROUNDING = 0x1p-22;

static void set_frame(shell_work *work, const double *points, size_t count)
{
    work->frame =
        (shell_frame){.box = unit_frame_of(points, count), .plane.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .unit = 1};
    work->unit = ldexp(2, -work->frame.box.exponent);
}

/// Turn points to their principal axes, with third moments that are not negative; the farthest gets the distance 1.
static void turn(shell_work *work, double *points)
{
    shell_frame *frame = &work->frame;
    double skew[2] = {0}, farthest = 0;
    frame->plane = local_plane_fit_all(points, work->count);
    for (size_t i = 0; i < work->count; i++)
    {
        double arm[3];
        vector3_subtract(points + 3 * i, frame->plane.centre, arm);
        farthest = fmax(farthest, vector3_length(arm));
        for (size_t k = 0; k < 2; k++)
            skew[k] += pow(vector3_dot(arm, frame->plane.axes[k]), 3);
    }
    frame->unit = farthest > 0 ? farthest : 1;
    work->unit *= frame->unit;
    for (size_t k = 0; k < 6; k++)
        frame->plane.axes[k / 3][k % 3] *= skew[k / 3] < 0 ? -1 : 1;
    vector3_cross(frame->plane.axes[0], frame->plane.axes[1], frame->plane.axes[2]);
    for (size_t i = 0; i < work->count; i++)
    {
        double arm[3];
        vector3_subtract(points + 3 * i, frame->plane.centre, arm);
        for (size_t k = 0; k < 3; k++)
            points[3 * i + k] = vector3_dot(arm, frame->plane.axes[k]) / frame->unit;
    }
}

bat_status shell_take_points(shell_work *work, const double *points, size_t count, bat_error *error)
{
    size_t *order = memory_pool_array(&work->pool, count, sizeof *order);
    double *sorted = memory_pool_array(&work->pool, count, 3 * sizeof *sorted),
           *rounded = memory_pool_array(&work->pool, count, 3 * sizeof *rounded);
    work->points = memory_pool_array(&work->pool, count, 3 * sizeof *work->points);
    bat_status status = memory_pool_check(&work->pool, error);
    for (size_t i = 0; i < 3 * count && status == BAT_OK; i++)
        if (!isfinite(points[i]))
            status = error_set(error, BAT_INVALID_POINT, i / 3, 0, "point %zu is not finite", i / 3);
    if (status == BAT_OK)
        status = canonical_order_find(points, count, order, error);
    if (status != BAT_OK)
        return status;
    work->count = count;
    set_frame(work, points, count);
    for (size_t i = 0; i < count; i++)
        unit_frame_place(&work->frame.box, points + 3 * order[i], sorted + 3 * i);
    turn(work, sorted);
    status = canonical_order_find(sorted, count, order, error);
    for (size_t i = 0; i < 3 * count && status == BAT_OK; i++)
    {
        work->points[i] = sorted[3 * order[i / 3] + i % 3];
        rounded[i] = rint(work->points[i] / ROUNDING) * ROUNDING;
    }
    work->rounded = rounded;
    return status;
}

/// Sample the faces of a mesh evenly by area, at places that depend on the mesh alone.
static bat_status sample_mesh(shell_work *work, bat_error *error)
{
    const bat_mesh *mesh = &work->mesh;
    size_t count = mesh->vertex_count > MESH_POINTS ? mesh->vertex_count : MESH_POINTS;
    work->points = memory_pool_array(&work->pool, count, 3 * sizeof *work->points);
    double *sums = memory_pool_array(&work->pool, mesh->face_count + 1, sizeof *sums);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status != BAT_OK)
        return status;
    sums[0] = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        double normal[3];
        vector3_face(mesh->positions, mesh->faces + 3 * f, normal);
        sums[f + 1] = sums[f] + vector3_length(normal);
    }
    work->report.spacing = sqrt(sums[mesh->face_count] / 2 / (double)count);
    // Places of the additive recurrence with the plastic number, of low discrepancy (Roberts, 2018).
    size_t face = 0;
    for (size_t i = 0; i < count; i++)
    {
        double at = ((double)i + 0.5) / (double)count * sums[mesh->face_count], ignored;
        double u = modf(0.5 + 0.7548776662466927 * (double)i, &ignored),
               v = modf(0.5 + 0.5698402909980532 * (double)i, &ignored);
        while (face + 1 < mesh->face_count && sums[face + 1] <= at)
            face++;
        double root = sqrt(u);
        const bat_mesh_point on = {(uint32_t)face, {1 - root, root * (1 - v), root * v}};
        for (size_t c = 0; c < 3; c++)
            work->points[3 * i + c] = map_value_at(mesh, mesh->positions + c, 3, &on);
    }
    work->count = count;
    return BAT_OK;
}

/// Mark the edges of a mesh without creases beyond an angle as creases.
static bat_status find_creases(bat_mesh *mesh, double angle, bat_error *error)
{
    bat_mesh_connectivity links;
    double *sharpness = NULL;
    bat_status status = bat_mesh_connect(mesh, &links, error);
    if (status != BAT_OK)
        return status;
    const mesh_level level = {.faces = mesh->faces, .links = &links};
    if (mesh->crease_count == 0)
        status = sharpness_of_edges(&level, mesh, angle, &sharpness, error);
    if (sharpness != NULL && (mesh->creases = malloc(links.edge_count * sizeof *mesh->creases)) == NULL)
        status = error_memory(error, links.edge_count * sizeof *mesh->creases);
    for (uint32_t h = 0; h < 3 * mesh->face_count && mesh->creases != NULL && sharpness != NULL; h++)
        if (links.twin[h] != BAT_MESH_NONE && links.twin[h] > h && sharpness[links.edge[h]] > 0)
            mesh->creases[mesh->crease_count++] =
                (bat_mesh_crease){mesh->faces[h], mesh->faces[bat_mesh_next(h)], sharpness[links.edge[h]]};
    free(sharpness);
    bat_mesh_connectivity_free(&links);
    return status;
}

bat_status shell_take_mesh(shell_work *work, const bat_mesh *mesh, bat_error *error)
{
    bat_status status = mesh_check_triangles(mesh, error);
    if (status != BAT_OK)
        return status;
    const bat_mesh bare = {.positions = mesh->positions,
                           .faces = mesh->faces,
                           .vertex_count = mesh->vertex_count,
                           .face_count = mesh->face_count,
                           .creases = mesh->creases,
                           .crease_count = mesh->crease_count};
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_MIDPOINT;
    options.levels = 0;
    for (size_t count = bare.face_count; count < SHELL_MAX_FACES; count *= 4)
        options.levels++;
    status = bat_mesh_refine(&bare, &options, &work->mesh, NULL, error);
    if (status != BAT_OK)
        return status;
    set_frame(work, mesh->positions, mesh->vertex_count);
    for (size_t v = 0; v < work->mesh.vertex_count; v++)
        unit_frame_place(&work->frame.box, work->mesh.positions + 3 * v, work->mesh.positions + 3 * v);
    status = find_creases(&work->mesh, work->options->crease, error);
    if (status == BAT_OK)
        status = sample_mesh(work, error);
    return status;
}

/// Even out the triangles: move vertices to the middle of their neighbours, along tangent planes. Decimation leaves clusters
/// of tiny faces otherwise. Boundaries stay.
static bat_status relax(bat_mesh *mesh, bool *closed, bat_error *error)
{
    bat_mesh_connectivity links;
    bat_status status = bat_mesh_connect(mesh, &links, error);
    if (status != BAT_OK)
        return status;
    *closed = links.boundary_edge_count == 0;
    for (size_t k = 0; k < RELAXATIONS * mesh->vertex_count; k++)
    {
        uint32_t first = links.first[k % mesh->vertex_count], h = first;
        if (first == BAT_MESH_NONE || links.twin[first] == BAT_MESH_NONE)
            continue;
        double *place = mesh->positions + 3 * (k % mesh->vertex_count), sum[3] = {0}, normal[3] = {0}, count = 0;
        do
        {
            const double *next = mesh->positions + 3 * (size_t)mesh->faces[bat_mesh_next(h)];
            double area[3];
            vector3_triangle(place, next, mesh->positions + 3 * (size_t)mesh->faces[bat_mesh_previous(h)], area);
            for (size_t c = 0; c < 3; c++)
            {
                sum[c] += next[c] - place[c];
                normal[c] += area[c];
            }
            count++;
            h = bat_mesh_next_around(&links, h);
        } while (h != first);
        (void)vector3_normalize(normal);
        double out = vector3_dot(sum, normal);
        for (size_t c = 0; c < 3; c++)
            place[c] += RELAXATION * (sum[c] - out * normal[c]) / count;
    }
    bat_mesh_connectivity_free(&links);
    return BAT_OK;
}

/// Coarsen a mesh that connects the points, which is a scaffold for layouts alone.
static bat_status coarsen(const shell_work *work, bat_mesh *mesh, bat_error *error)
{
    bat_mesh coarse;
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.method = BAT_MESH_DECIMATE_METHOD_MEMORYLESS;
    options.faces = CONNECTED_FACES;
    options.min_quality = mesh->crease_count > 0 || !work->closed ? MIN_QUALITY : options.min_quality;
    options.threads = work->options->threads;
    if (mesh->face_count <= CONNECTED_FACES)
        return BAT_OK;
    bat_status status = bat_mesh_decimate(mesh, &options, &coarse, NULL, error);
    if (status == BAT_OK)
    {
        bat_mesh_free(mesh);
        *mesh = coarse;
    }
    return status;
}

static bat_status connect_points(shell_work *work, bat_progress progress, bat_error *error)
{
    nearest_tree tree = {0};
    shell_cloud cloud = {.points = work->rounded, .count = work->count, .tree = &tree, .share = work->share};
    double *normals = memory_pool_array(&work->pool, work->count, 3 * sizeof *normals);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status == BAT_OK)
        status = neighbours_build(cloud.points, cloud.count, &tree, error);
    if (status == BAT_OK)
        status = shell_connect(&cloud, progress, &work->mesh, normals, error);
    if (status == BAT_OK)
        status = shell_open_holes(&cloud, work->options->fill_holes / work->unit, &work->mesh, &work->report, error);
    if (status == BAT_OK)
        status = shell_cut_handles(&cloud, &work->mesh, &work->report, error);
    if (status == BAT_OK)
        status = relax(&work->mesh, &work->closed, error);
    if (status == BAT_OK && work->options->crease > 0 && cloud.noise < MAX_CREASE_NOISE * cloud.spacing)
        status = shell_find_creases(&cloud, normals, work->options->crease, &work->mesh, &work->creased, error);
    nearest_free(&tree);
    if (status == BAT_OK)
        status = coarsen(work, &work->mesh, error);
    if (status == BAT_OK)
        status = coarsen(work, &work->creased, error);
    work->noise = cloud.noise;
    if (!(work->options->tolerance > 0))
        work->stiffness = fmin(1 + NOISE_SLOPE * fmax(cloud.noise / cloud.spacing - MIN_NOISE, 0), MAX_NOISY);
    work->report.spacing = cloud.spacing;
    work->has_share = status == BAT_OK && cloud.cell <= work->share * fmax(cloud.spacing, cloud.noise);
    return status;
}

void shell_restore(const shell_frame *frame, double *points, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        double at[3];
        memcpy(at, frame->plane.centre, sizeof at);
        for (size_t k = 0; k < 3; k++)
            vector_add(3, frame->unit * points[3 * i + k], frame->plane.axes[k], at);
        for (size_t c = 0; c < 3; c++)
            points[3 * i + c] = 2 * (ldexp(at[c], -frame->box.exponent) + frame->box.middle[c] / 2);
    }
}

/// Turn a closed mesh that is inside out.
static bat_status face_outwards(bat_mesh *mesh, bat_error *error)
{
    bat_mesh_summary summary;
    bat_status status = bat_mesh_summarize(mesh, &summary, error);
    for (size_t f = 0; f < mesh->face_count && status == BAT_OK && summary.volume < 0; f++)
        SWAP(mesh->faces[3 * f + 1], mesh->faces[3 * f + 2]);
    return status;
}

/// Give the mesh its normals as channels, so that decimation leaves more faces where it is bent.
static bat_status add_normals(bat_mesh *mesh, bat_error *error)
{
    static const char *const NAMES[] = {"normal", "normal", "normal"};
    double *normals = memory_array(mesh->vertex_count, 3 * sizeof *normals);
    bat_status status = normals == NULL ? error_memory(error, 3 * mesh->vertex_count * sizeof *normals)
                                        : bat_mesh_vertex_normals(mesh, BAT_MESH_NORMALS_ANGLE, normals, error);
    mesh->channels = normals;
    return status != BAT_OK || channels_set_names(mesh, NAMES, 3) ? status : error_memory(error, sizeof NAMES);
}

bat_status shell_make_meshes(shell_work *work, bat_progress progress, bat_error *error)
{
    bat_mesh *meshes[] = {&work->mesh, &work->creased};
    bat_status status = work->mesh.face_count == 0 ? connect_points(work, progress, error) : BAT_OK;
    for (size_t k = 0; k < 2 && status == BAT_OK && meshes[k]->face_count > 0; k++)
    {
        status = face_outwards(meshes[k], error);
        if (status == BAT_OK)
            status = add_normals(meshes[k], error);
    }
    return status == BAT_OK ? shell_steps_save(work, error) : status;
}
