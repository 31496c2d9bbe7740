/// @file
/// From points or a mesh to a shell; see batten/shell.h.
///
/// Layouts of 200, 400, ... faces are fitted to nine of ten points, until the distances of the tenth no longer fall by
/// MIN_GAIN, or all points are within the tolerance. The last fit is to all points.

#include "surface/shell/shell.h"

#include "base/option.h"
#include "base/progress.h"
#include "batten/mesh_measure.h"
#include "batten/mesh_refine.h"
#include "mesh/check.h"
#include "mesh/decimate/map.h"
#include "mesh/labels.h"
#include "mesh/refine/sharpness.h"

#include <string.h>

#define MIN_POINTS 300
#define FIRST_FACES 200
#define MAX_FACES 2800       ///< unless a number is given
#define POINTS_PER_CONTROL 2 ///< least number of points for each control point, on average
#define MISSES 2             ///< layouts in a row that bring held-out points no nearer, after which no other is tried
#define HOLD_OUT 10
#define TRIAL_ROUNDS 4
#define ROUNDS 8
#define ANCHORS 3 ///< of a triangle
#define UNFOLD_ROUNDS 2
#define RETRIES 3
#define SPREADS 4 ///< rounds in which residuals spread among neighbours
#define WEIGHED 2 ///< layouts that follow residuals
#define MIN_FACES 40
#define MESH_POINTS 40000 ///< samples of a mesh
#define RELAXATIONS 4
#define CONNECTED_FACES 24000 ///< of the mesh that connects points: grids make slivers, which decimation takes away

/// Least share by which the distances of held-out points fall with twice the faces.
static const double MIN_GAIN = 0.005;
/// With stronger smoothing, the share by which they may rise with more faces, and the factor against weak smoothing.
static const double MAX_LOSS = 0.002, MAX_RISE = 1.015;
/// Weight of normals in the error of the second layout that is tried, and of those that follow residuals.
static const double NORMALS = 0.3, WEIGHED_NORMALS = 1;
/// Largest factor of normals where points are far, and the least share by which it brings held-out points nearer.
static const double MAX_FACTOR = 4, MIN_WEIGHED_GAIN = 0.01;
/// Factor of the smoothing by the noise in spacings, of which correction hides a part, and its largest value.
static const double NOISE_SLOPE = 3, MIN_NOISE = 0.05, MAX_NOISY = 3;
/// Factor of the smoothing where a shell is wrong, or has more folds for each patch than allowed, and the largest distance
/// of its points in that of held-out ones, or in spacings.
static const double STIFFER = 4, MAX_FOLDED[2] = {0.001, 0.003}, FOLDED_STIFFER = 2, MAX_STIFFER = 1.2,
                    STIFFER_SPACINGS = 0.15;
/// Share of the way to the middle of the neighbours.
static const double RELAXATION = 0.7;
/// Least quality of the triangles of a scaffold with creases or boundaries: flat parts would get slivers.
static const double MIN_QUALITY = 0.3;
/// Noise in spacings, from which creases are not looked for, and the least share by which they bring held-out points nearer.
static const double MAX_CREASE_NOISE = 0.3, MIN_CREASE_GAIN = 0.01;
/// Largest number of faces with creases, in the number that was given or is the least for a tolerance, or in the least of
/// all.
static const double MAX_EXCESS = 1.5, LEAST_FACES = 16;
/// Grid on which points are put to make the mesh: it hides rounding, so that turned points give the same mesh.
static const double ROUNDING = 0x1p-22;
static const double CONNECT_SHARE = 0.3, TRIAL_SHARE = 0.4;
/// Size of the cells that connect points, in the greater of spacing and noise; the second is tried where the first fails.
static const double CELLS[2] = {1, 0.8};

bat_shell_reconstruct_options bat_shell_reconstruct_defaults(void)
{
    return (bat_shell_reconstruct_options){.spans = 2, .crease = 0.7};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_shell_reconstruct_options, tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_shell_reconstruct_options, faces, OPTION_SIZE, 0, 1000000),
    OPTION_FIELD(bat_shell_reconstruct_options, spans, OPTION_SIZE, 2, 16),
    OPTION_FIELD(bat_shell_reconstruct_options, crease, OPTION_NUMBER, 0, 3.1415926535897932),
    OPTION_FIELD(bat_shell_reconstruct_options, fill_holes, OPTION_NUMBER, 0, INFINITY),
    OPTION_THREADS(bat_shell_reconstruct_options),
};

const bat_options_table bat_shell_reconstruct_fields = OPTIONS_TABLE(bat_shell_reconstruct_options, FIELDS, NULL);

bool bat_shell_follows(const bat_surface_reconstruct_options *patch, bool outlined, const bat_error *failure,
                       bat_shell_reconstruct_options *options)
{
    options->tolerance = patch->fit.tolerance;
    options->fill_holes = patch->fill_holes;
    options->force = patch->force;
    options->threads = patch->fit.threads;
    options->progress = patch->fit.progress;
    return strcmp(failure->remedy, "shell") == 0 && !outlined && !patch->trim && !patch->published && patch->model == NULL &&
           patch->parameters == BAT_SURFACE_PARAMETERS_AUTO && patch->sides == bat_surface_reconstruct_defaults().sides &&
           patch->fit.functions == 0;
}

/// A layout with its grid and a fit.
typedef struct shell_trial
{
    shell_layout layout;
    shell_grid grid;
    shell_fit fit;
    shell_place *first; ///< places of points and anchors on the layout
    memory_pool pool;
} shell_trial;

/// A frame that turns and grows with the points: x -> axes (x in `box` - centre) / unit.
typedef struct shell_frame
{
    unit_frame box;
    local_plane plane;
    double unit;
} shell_frame;

typedef struct shell_work
{
    const bat_shell_reconstruct_options *options;
    shell_frame frame;
    double unit;           ///< of `frame`, in the unit of the input
    double *points;        ///< count x 3, in the frame, in an order that depends on their places there; then anchors
    const double *rounded; ///< count x 3: the same on a grid of ROUNDING, from which the mesh is made
    size_t count;
    bat_mesh mesh;                   ///< of unit size
    bat_mesh creased;                ///< the same with creases that were found; empty: none
    bat_mesh_closest_point *closest; ///< of the points and anchors on the mesh
    bat_mesh_closest_point *creased_closest;
    double *creased_points; ///< those with the anchors of the other mesh
    bool sharp;             ///< `mesh` is the one with creases
    bool *held;             ///< count
    double *squared;        ///< count: squared distances in the last fit on trial
    bool closed;            ///< the mesh of points
    bool folded;            ///< the first fit
    bool split;             ///< the shell is between two sheets of points
    double share;           ///< of the spacing or the noise in a cell that connects points
    bool has_share;         ///< cells are not larger, as for many points, so that another share would change them
    double noise, stiffness;
    double normals; ///< their weight in the error of the layout
    bat_shell_report report;
    memory_pool pool;
} shell_work;

// Input

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

/// Bring the points into a frame that turns with them, and sort them there.
static bat_status take_points(shell_work *work, const double *points, size_t count, bat_error *error)
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

static bat_status take_mesh(shell_work *work, const bat_mesh *mesh, bat_error *error)
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
    for (size_t count = bare.face_count; count < MAX_FACES; count *= 4)
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

// Trials

static void trial_free(shell_trial *trial)
{
    shell_layout_free(&trial->layout);
    shell_grid_free(&trial->grid);
    memory_pool_free(&trial->pool);
    *trial = (shell_trial){0};
}

/// Control points at bilinear places between the vertices of the layout.
static void place_control(const shell_trial *trial, double *start)
{
    const shell_grid *grid = &trial->grid;
    size_t spans = grid->spans;
    for (size_t q = 0; q < grid->quad_count; q++)
        for (size_t c = 0; c < 4; c++)
        {
            double u = (double)(q % spans + (c == 1 || c == 2)) / (double)spans,
                   v = (double)(q / spans % spans + (c >= 2)) / (double)spans;
            const double weights[4] = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
            const uint32_t *corners = trial->layout.quads + 4 * (q / (spans * spans));
            double *point = start + 3 * (size_t)grid->quads[4 * q + c], sum[3] = {0};
            for (size_t k = 0; k < 4; k++)
                for (size_t d = 0; d < 3; d++)
                    sum[d] += weights[k] * trial->layout.positions[3 * (size_t)corners[k] + d];
            memcpy(point, sum, sizeof sum);
        }
}

/// From a place on a face to one on a patch.
static void place_on_grid(size_t spans, shell_place *place)
{
    double u = place->u * (double)spans, v = place->v * (double)spans;
    size_t i = (size_t)u < spans ? (size_t)u : spans - 1, j = (size_t)v < spans ? (size_t)v : spans - 1;
    *place = (shell_place){(uint32_t)((place->face * spans + j) * spans + i), u - (double)i, v - (double)j};
}

/// Whether the number of faces has a bound: it is given, or the least for a tolerance.
static bool is_bounded(const shell_work *work)
{
    return work->options->faces > 0 || work->options->tolerance > 0;
}

static bat_status trial_make(const shell_work *work, size_t faces, shell_trial *trial, bat_error *error)
{
    shell_fit *fit = &trial->fit;
    bat_status status = shell_layout_make(&work->mesh, faces, is_bounded(work), work->normals, &trial->layout, error);
    if (status == BAT_OK)
        status = shell_grid_make(&trial->layout, work->options->spans, &trial->grid, error);
    if (status != BAT_OK)
        return status;
    size_t all = work->count + ANCHORS * work->mesh.face_count;
    double *start = memory_pool_zeros(&trial->pool, trial->grid.vertex_count, 3 * sizeof *start);
    trial->first = memory_pool_array(&trial->pool, all, sizeof *trial->first);
    *fit = (shell_fit){.grid = &trial->grid,
                       .points = work->points,
                       .count = work->count,
                       .moving = work->count,
                       .places = memory_pool_array(&trial->pool, all, sizeof *fit->places),
                       .start = start,
                       .control = memory_pool_array(&trial->pool, trial->grid.vertex_count, 3 * sizeof *fit->control),
                       .bezier = memory_pool_array(&trial->pool, trial->grid.quad_count, 48 * sizeof *fit->bezier),
                       .squared = memory_pool_array(&trial->pool, work->count, sizeof *fit->squared),
                       .stiff = memory_pool_array(&trial->pool, trial->grid.vertex_count, sizeof *fit->stiff),
                       .stiffness = work->stiffness,
                       .threads = work->options->threads};
    bat_mesh_point *points = memory_pool_array(&trial->pool, all, sizeof *points);
    status = memory_pool_check(&trial->pool, error);
    for (size_t v = 0; v < trial->grid.vertex_count && status == BAT_OK; v++)
        fit->stiff[v] = 1;
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < all; i++)
        points[i] = work->closest[i].at;
    status = shell_layout_places(&trial->layout, points, all, trial->first, error);
    for (size_t i = 0; i < all && status == BAT_OK; i++)
        place_on_grid(trial->grid.spans, &trial->first[i]);
    memcpy(fit->places, trial->first, all * sizeof *fit->places);
    if (status == BAT_OK)
        place_control(trial, start);
    return status;
}

/// The root mean square distance of points that are held out, and the largest of all.
static double distance_of(const shell_work *work, const shell_fit *fit, double *largest)
{
    double sum = 0, most = 0, count = 0;
    for (size_t i = 0; i < work->count; i++)
    {
        sum += work->held[i] ? fit->squared[i] : 0;
        count += work->held[i];
        most = fmax(most, fit->squared[i]);
    }
    *largest = sqrt(most);
    return sqrt(sum / count);
}

/// Fit in two parts: the second takes off the bias of the noise that the first leaves.
static bat_status fit_trial(shell_trial *trial, int rounds, bat_error *error)
{
    shell_fit *fit = &trial->fit;
    bat_status status = shell_fit_run(fit, rounds / 2, error);
    double sum = 0;
    for (size_t i = 0; i < fit->count && status == BAT_OK; i++)
        sum += fit->squared[i];
    fit->unbias = sum / fmax((double)fit->count - fit->trace, 1);
    return status == BAT_OK ? shell_fit_run(fit, rounds - rounds / 2, error) : status;
}

/// Fit a layout to some of the points.
/// @param held    receives the root mean square distance of the others; infinity where creases need far more faces
/// @param largest receives the largest distance of all
static bat_status try_layout(const shell_work *work, size_t faces, double *held, double *largest, bat_error *error)
{
    shell_trial trial = {0};
    bat_status status = trial_make(work, faces, &trial, error);
    trial.fit.held = work->held;
    if (status == BAT_OK)
        status = fit_trial(&trial, TRIAL_ROUNDS, error);
    if (status == BAT_OK)
    {
        *held = distance_of(work, &trial.fit, largest);
        if (work->sharp && is_bounded(work) &&
            (double)trial.layout.face_count > MAX_EXCESS * fmax((double)faces, LEAST_FACES))
            *held = INFINITY;
        memcpy(work->squared, trial.fit.squared, work->count * sizeof *work->squared);
    }
    trial_free(&trial);
    return status;
}

/// Find the number of faces and the least distance of held-out points.
static bat_status find_faces(const shell_work *work, bat_progress progress, size_t *faces, double *best, bat_error *error)
{
    double held, largest, tolerance = work->options->tolerance / work->unit;
    double least = work->stiffness > 1 && work->closed ? -MAX_LOSS : MIN_GAIN;
    size_t limit = work->count / (POINTS_PER_CONTROL * work->options->spans * work->options->spans);
    bool goes_on = true;
    int misses = 0;
    limit = limit < MAX_FACES ? limit : MAX_FACES;
    *best = INFINITY;
    *faces = work->options->faces;
    for (size_t wanted = *faces > 0 ? *faces : FIRST_FACES, k = 0; goes_on;
         wanted = 2 * wanted < limit ? 2 * wanted : limit, k++)
    {
        bat_status status = progress_goes_on(progress, (double)k / 6)
                                ? try_layout(work, wanted, &held, &largest, error)
                                : error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the fit was stopped");
        if (status != BAT_OK)
            return status;
        bool gains = held < (1 - least) * *best;
        *faces = work->options->faces > 0 || gains ? wanted : *faces;
        *best = fmin(held, *best);
        misses = gains ? 0 : misses + 1;
        goes_on = work->options->faces == 0 && !(tolerance > 0 && largest <= tolerance) && wanted < limit &&
                  (misses < MISSES || tolerance > 0);
    }
    return BAT_OK;
}

/// Factors for the normals: the root mean square distance of the points around each vertex in the last fit on trial, in the
/// median of all, from 1 to MAX_FACTOR.
static bat_status find_factors(const shell_work *work, double *factors, bat_error *error)
{
    const bat_mesh *mesh = &work->mesh;
    size_t vertices = mesh->vertex_count, count = 0;
    memory_pool pool = {0};
    double *sums = memory_pool_zeros(&pool, vertices, 2 * sizeof *sums),
           *next = memory_pool_array(&pool, vertices, 2 * sizeof *next);
    bat_status status = memory_pool_check(&pool, error);
    for (size_t i = 0; i < work->count && status == BAT_OK; i++)
        for (size_t c = 0; c < 3; c++)
        {
            const bat_mesh_point *at = &work->closest[i].at;
            double *sum = sums + 2 * (size_t)mesh->faces[3 * (size_t)at->face + c];
            sum[0] += at->barycentric[c] * work->squared[i];
            sum[1] += at->barycentric[c];
        }
    for (int round = 0; round < SPREADS && status == BAT_OK; round++)
    {
        memcpy(next, sums, 2 * vertices * sizeof *next);
        for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
        {
            size_t a = mesh->faces[h], b = mesh->faces[bat_mesh_next(h)];
            vector_add(2, 1.0 / 6, sums + 2 * a, next + 2 * b);
            vector_add(2, 1.0 / 6, sums + 2 * b, next + 2 * a);
        }
        SWAP(sums, next);
    }
    for (size_t v = 0; v < vertices && status == BAT_OK; v++)
    {
        factors[v] = sums[2 * v + 1] > 0 ? sqrt(sums[2 * v] / sums[2 * v + 1]) : 0;
        next[count] = factors[v];
        count += factors[v] > 0;
    }
    double median = count > 0 ? sort_median(next, count) : 1;
    for (size_t v = 0; v < vertices && status == BAT_OK; v++)
        factors[v] = fmin(fmax(factors[v] / median, 1), MAX_FACTOR);
    memory_pool_free(&pool);
    return status;
}

static void set_factors(bat_mesh *mesh, const double *normals, const double *factors)
{
    for (size_t k = 0; k < 3 * mesh->vertex_count; k++)
        mesh->channels[k] = factors[k / 3] * normals[k];
}

/// Try layouts with more faces where the last one left the points far, and keep the best of all. One that fails is left.
static bat_status refine_layout(shell_work *work, size_t faces, double tolerance, bat_progress progress, double *best,
                                bat_error *error)
{
    size_t vertices = work->mesh.vertex_count;
    double held = INFINITY, largest = 0, weight = work->normals,
           *tried = memory_pool_array(&work->pool, vertices, sizeof *tried),
           *kept = memory_pool_array(&work->pool, vertices, sizeof *kept),
           *normals = memory_pool_array(&work->pool, vertices, 3 * sizeof *normals);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status != BAT_OK)
        return status;
    memcpy(normals, work->mesh.channels, 3 * vertices * sizeof *normals);
    for (size_t v = 0; v < vertices; v++)
        kept[v] = 1;
    work->normals = WEIGHED_NORMALS;
    for (int k = 0; k < WEIGHED; k++)
    {
        status = progress_check(progress, 1, error);
        if (status == BAT_OK)
            status = find_factors(work, tried, error);
        if (status != BAT_OK)
            return status;
        set_factors(&work->mesh, normals, tried);
        if (try_layout(work, faces, &held, &largest, NULL) != BAT_OK || !(held < (1 - MIN_WEIGHED_GAIN) * *best) ||
            (tolerance > 0 && largest > tolerance))
            continue;
        *best = held;
        weight = WEIGHED_NORMALS;
        SWAP(tried, kept);
    }
    work->normals = weight;
    set_factors(&work->mesh, normals, kept);
    return BAT_OK;
}

/// Find the number of faces, the smoothing, and whether normals have a part in the layout.
static bat_status find_layout(shell_work *work, bat_progress progress, size_t *faces, bat_error *error)
{
    double best = INFINITY, held = INFINITY, largest = 0, stiffness = work->stiffness,
           tolerance = work->options->tolerance / work->unit;
    bat_status status = find_faces(work, progress, faces, &best, error);
    if (status == BAT_OK && stiffness > 1)
    {
        work->stiffness = 1;
        status = try_layout(work, *faces, &held, &largest, error);
        if (status == BAT_OK && held * MAX_RISE < best)
            status = find_faces(work, progress, faces, &best, error);
        else
            work->stiffness = stiffness;
    }
    if (status != BAT_OK)
        return status;
    work->normals = NORMALS;
    status = try_layout(work, *faces, &held, &largest, error);
    work->normals = held < (1 - MIN_GAIN) * best && !(tolerance > 0 && largest > tolerance) ? NORMALS : 0;
    work->report.held_out = work->normals > 0 ? held : best;
    return status == BAT_OK ? refine_layout(work, *faces, tolerance, progress, &work->report.held_out, error) : status;
}

// The result

/// Give back the scale of the input.
static void restore(const shell_frame *frame, double *points, size_t count)
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

static bat_status make_shell(const shell_trial *trial, bat_shell *shell, bat_error *error)
{
    const shell_grid *grid = &trial->grid;
    bat_mesh *cage = &shell->cage;
    *shell =
        (bat_shell){.face_count = grid->face_count, .spans = grid->spans, .closed = grid->links.boundary_edge_count == 0};
    cage->vertex_count = grid->vertex_count;
    cage->face_count = grid->quad_count;
    cage->positions = malloc(grid->vertex_count * 3 * sizeof *cage->positions);
    cage->faces = malloc(grid->quad_count * 4 * sizeof *cage->faces);
    cage->offsets = sides_offsets(grid->quad_count, 4);
    cage->creases = malloc((4 * grid->quad_count + 1) * sizeof *cage->creases);
    shell->patches = malloc(grid->quad_count * 48 * sizeof *shell->patches);
    if (cage->positions == NULL || cage->faces == NULL || cage->offsets == NULL || cage->creases == NULL ||
        shell->patches == NULL)
        return error_memory(error, grid->quad_count * 48 * sizeof *shell->patches);
    memcpy(cage->positions, trial->fit.control, grid->vertex_count * 3 * sizeof *cage->positions);
    memcpy(cage->faces, grid->quads, grid->quad_count * 4 * sizeof *cage->faces);
    memcpy(shell->patches, trial->fit.bezier, grid->quad_count * 48 * sizeof *shell->patches);
    for (uint32_t h = 0; h < 4 * grid->quad_count; h++)
        if (grid->sharp[h] && grid->links.twin[h] > h && grid->links.twin[h] != BAT_MESH_NONE)
            cage->creases[cage->crease_count++] =
                (bat_mesh_crease){grid->quads[h], grid->quads[h % 4 == 3 ? h - 3 : h + 1], BAT_MESH_SHARP};
    return BAT_OK;
}

/// Lengths and volumes in the unit of the input.
static bat_shell_report restore_report(double unit, const bat_shell_report *report)
{
    bat_shell_report restored = *report;
    double *lengths[] = {&restored.spacing, &restored.noise, &restored.rms, &restored.largest, &restored.held_out};
    for (size_t k = 0; k < sizeof lengths / sizeof *lengths; k++)
        *lengths[k] *= unit;
    restored.volume *= unit * unit * unit;
    restored.mesh_volume *= unit * unit * unit;
    return restored;
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

/// Anchor the patches that fold, and those around, as long as folds get fewer: places of their points begin anew, and points
/// of the mesh, whose places stay, are fitted, too.
/// @param folds receives how many are left
static bat_status unfold(const shell_work *work, shell_trial *trial, size_t *folds, bat_error *error)
{
    shell_fit *fit = &trial->fit, open = *fit;
    const uint32_t *quads = trial->grid.quads;
    size_t all = work->count + ANCHORS * work->mesh.face_count, before = SIZE_MAX;
    bool *marks = memory_pool_zeros(&trial->pool, trial->grid.vertex_count, sizeof *marks),
         *held = memory_pool_array(&trial->pool, all, sizeof *held);
    bat_status status = memory_pool_check(&trial->pool, error);
    if (status == BAT_OK)
        status = shell_find_folds(fit, &work->mesh, marks, folds, error);
    fit->held = held;
    fit->count = all;
    while (status == BAT_OK && *folds > 0 && *folds < before)
    {
        for (size_t i = 0; i < all; i++)
        {
            bool near = false;
            for (size_t c = 0; c < 4; c++)
                near = near || marks[quads[4 * (size_t)fit->places[i].face + c]] ||
                       marks[quads[4 * (size_t)trial->first[i].face + c]];
            held[i] = i >= work->count && !near;
            fit->places[i] = near ? trial->first[i] : fit->places[i];
        }
        before = *folds;
        status = shell_fit_run(fit, UNFOLD_ROUNDS, error);
        if (status == BAT_OK)
            status = shell_find_folds(fit, &work->mesh, marks, folds, error);
    }
    *fit = open;
    return status;
}

/// Refuse a shell that its points contradict at some place.
static bat_status check_places(shell_work *work, const shell_fit *fit, bat_error *error)
{
    static const char *const TEXTS[] = {
        [SHELL_SHEETS] = "the points lie on two sheets near %.4g %.4g %.4g, nearer to each other than their points; more "
                         "points would tell them apart",
        [SHELL_MISSED] = "the shell misses a part of the points near %.4g %.4g %.4g; more points would tell its shape"};
    size_t worst = SIZE_MAX;
    shell_fault fault = SHELL_RIGHT;
    bat_status status = shell_find_fault(fit, &work->report, &fault, &worst, error);
    if (status != BAT_OK || fault == SHELL_RIGHT)
        return status;
    double place[3];
    memcpy(place, fit->points + 3 * worst, sizeof place);
    restore(&work->frame, place, 1);
    work->split = fault == SHELL_SHEETS;
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, TEXTS[fault], place[0], place[1], place[2]);
}

/// Fit a number of faces to all points, and judge the shell.
/// @param strict whether it is wrong where folds stay
static bat_status fit_faces(shell_work *work, size_t faces, bool strict, bat_progress progress, bat_shell *shell,
                            bat_error *error)
{
    shell_trial trial = {0};
    bat_shell made = {0};
    size_t folds = 0;
    bat_status status = trial_make(work, faces, &trial, error);
    trial.fit.progress = progress;
    work->report.turned = 0;
    if (status == BAT_OK)
        status = fit_trial(&trial, ROUNDS, error);
    if (status == BAT_OK)
        status = unfold(work, &trial, &folds, error);
    work->folded = strict && (double)folds > MAX_FOLDED[work->sharp] * (double)trial.grid.quad_count;
    if (status == BAT_OK && work->folded)
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the shell folds at %zu places", folds);
    if (status == BAT_OK)
        status = shell_agree(&trial.grid, trial.fit.bezier, error);
    if (status == BAT_OK)
    {
        shell_fit_correct(&trial.fit);
        status = make_shell(&trial, &made, error);
    }
    if (status == BAT_OK)
        status = shell_measure(&made, &trial.fit, &work->mesh, &work->report, error);
    const bat_shell_report report = restore_report(work->unit, &work->report);
    if (status == BAT_OK && !work->options->force)
        status = shell_judge(&made, &report, work->unit * work->noise, error);
    if (status == BAT_OK && !work->options->force)
        status = check_places(work, &trial.fit, error);
    trial_free(&trial);
    if (status == BAT_OK)
        *shell = made;
    else
        bat_shell_free(&made);
    return status;
}

/// Find the places of the points on the mesh, hold out some, and append anchors.
static bat_status place_on_mesh(shell_work *work, bat_error *error)
{
    const bat_mesh *mesh = &work->mesh;
    size_t count = work->count, all = count + ANCHORS * mesh->face_count;
    double *points = memory_pool_array(&work->pool, all, 3 * sizeof *points);
    work->closest = memory_pool_array(&work->pool, all, sizeof *work->closest);
    work->held = memory_pool_zeros(&work->pool, count, sizeof *work->held);
    work->squared = memory_pool_array(&work->pool, count, sizeof *work->squared);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status == BAT_OK)
        status = bat_mesh_closest(mesh, work->points, count, work->options->threads, work->closest, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = HOLD_OUT / 2; i < count; i += HOLD_OUT)
        work->held[i] = true;
    memcpy(points, work->points, 3 * count * sizeof *points);
    work->points = points;
    for (size_t k = 0; k < all - count; k++)
    {
        bat_mesh_point *at = &work->closest[count + k].at;
        *at = (bat_mesh_point){(uint32_t)(k / ANCHORS), {1.0 / 6, 1.0 / 6, 1.0 / 6}};
        at->barycentric[k % ANCHORS] = 2.0 / 3;
        for (size_t c = 0; c < 3; c++)
            points[3 * (count + k) + c] = map_value_at(mesh, mesh->positions + c, 3, at);
    }
    return BAT_OK;
}

/// Take the mesh with creases, or give it back.
static void swap_creases(shell_work *work)
{
    SWAP(work->mesh, work->creased);
    SWAP(work->points, work->creased_points);
    SWAP(work->closest, work->creased_closest);
    work->sharp = !work->sharp;
}

/// Fit the mesh with creases, where held-out points are nearer with it, by the layout of the nearer ones first.
/// @param fitted receives whether one is right; else `work` is as before
static bat_status fit_creases(shell_work *work, size_t faces, bool strict, bat_progress progress, bat_shell *shell,
                              bool *fitted, bat_error *error)
{
    double held[2] = {INFINITY, INFINITY}, smooth = work->report.held_out, normals = work->normals, largest;
    work->creased_points = work->points;
    swap_creases(work);
    bat_status status = place_on_mesh(work, error);
    for (int k = 0; k < 2 && status == BAT_OK; k++)
    {
        work->normals = k * NORMALS;
        status = try_layout(work, faces, &held[k], &largest, error);
    }
    for (int k = 0; k < 2 && status == BAT_OK && !*fitted; k++)
    {
        int nearer = (held[1] < held[0]) != k;
        if (!(held[nearer] < (1 - MIN_CREASE_GAIN) * smooth))
            break;
        work->normals = nearer * NORMALS;
        work->report.held_out = held[nearer];
        status = fit_faces(work, faces, strict, progress, shell, error);
        *fitted = status == BAT_OK;
        status = status == BAT_NO_CONVERGENCE ? BAT_OK : status;
    }
    if (!*fitted)
    {
        swap_creases(work);
        work->normals = normals;
        work->report.held_out = smooth;
    }
    return status == BAT_NO_CONVERGENCE ? BAT_OK : status;
}

/// Find the number of faces and fit. A shell that is wrong has too many faces for its points at some place: half as many
/// are tried then, with more smoothing (first as many, where it folds or its layout follows distances), and the first
/// failure is told where that fails too.
static bat_status fit_and_judge(shell_work *work, bat_shell *shell, bat_error *error)
{
    progress_part trials = {work->options->progress, CONNECT_SHARE, TRIAL_SHARE},
                  last = {work->options->progress, CONNECT_SHARE + TRIAL_SHARE, 1 - CONNECT_SHARE - TRIAL_SHARE};
    size_t faces = 0;
    bat_status status = place_on_mesh(work, error);
    if (status == BAT_OK)
        status = find_layout(work, progress_of_part(&trials), &faces, error);
    const bool strict = work->options->faces == 0 && faces > MIN_FACES;
    bool fitted = false;
    if (status == BAT_OK && work->creased.face_count > 0)
        status = fit_creases(work, faces, strict, progress_of_part(&last), shell, &fitted, error);
    if (status == BAT_OK && !fitted)
        status = fit_faces(work, faces, strict, progress_of_part(&last), shell, error);
    for (int k = 0; k < RETRIES && status == BAT_NO_CONVERGENCE && !work->split && (strict || work->normals > NORMALS); k++)
    {
        bat_error failure;
        bool weighed = work->normals > NORMALS, again = k == 0 && (work->folded || work->stiffness > 1 || weighed);
        work->normals = weighed ? 0 : work->normals;
        faces = again ? faces : faces / 2;
        work->stiffness = !again ? STIFFER * work->stiffness : work->folded ? FOLDED_STIFFER * work->stiffness : 1;
        status = fit_faces(work, faces, false, progress_of_part(&last), shell, &failure);
        if (status == BAT_OK && !work->options->force &&
            work->report.rms > fmax(MAX_STIFFER * work->report.held_out, STIFFER_SPACINGS * work->report.spacing))
        {
            bat_shell_free(shell);
            status = BAT_NO_CONVERGENCE;
        }
        if (status != BAT_OK && status != BAT_NO_CONVERGENCE)
            return error_copy(error, &failure);
    }
    if (status == BAT_OK)
    {
        restore(&work->frame, shell->patches, shell->cage.face_count * 16);
        restore(&work->frame, shell->cage.positions, shell->cage.vertex_count);
        work->report = restore_report(work->unit, &work->report);
    }
    return status;
}

/// As bat_shell_reconstruct().
/// @param share of the spacing or the noise in a cell that connects points
/// @param again receives whether smaller cells may help
static bat_status reconstruct(const double *points, size_t count, const bat_mesh *mesh,
                              const bat_shell_reconstruct_options *options, double share, bool *again, bat_shell *shell,
                              bat_shell_report *report, bat_error *error)
{
    shell_work work = {.options = options, .share = share, .stiffness = 1, .report = {.held_out = NAN}};
    progress_part first = {options->progress, 0, CONNECT_SHARE};
    bat_status status = mesh != NULL ? take_mesh(&work, mesh, error) : take_points(&work, points, count, error);
    if (status == BAT_OK && mesh == NULL)
        status = connect_points(&work, progress_of_part(&first), error);
    bat_mesh *meshes[] = {&work.mesh, &work.creased};
    for (size_t k = 0; k < 2 && status == BAT_OK && meshes[k]->face_count > 0; k++)
    {
        status = face_outwards(meshes[k], error);
        if (status == BAT_OK)
            status = add_normals(meshes[k], error);
    }
    if (status == BAT_OK)
        status = fit_and_judge(&work, shell, error);
    *again = status == BAT_NO_CONVERGENCE && work.has_share;
    bat_mesh_free(&work.mesh);
    bat_mesh_free(&work.creased);
    memory_pool_free(&work.pool);
    if (status == BAT_OK)
        *report = work.report;
    return status;
}

bat_status bat_shell_reconstruct(const double *points, size_t count, const bat_mesh *mesh,
                                 const bat_shell_reconstruct_options *options, bat_shell *shell, bat_shell_report *report,
                                 bat_error *error)
{
    bat_shell_reconstruct_options wanted = options != NULL ? *options : bat_shell_reconstruct_defaults();
    bat_shell made = {0};
    bat_shell_report measured;
    bat_error failure;
    bool again;
    bat_status status = bat_options_check(&bat_shell_reconstruct_fields, &wanted, error);
    if (status != BAT_OK)
        return status;
    if (mesh != NULL && wanted.fill_holes > 0)
        return error_option(error, "fill_holes", "closes holes of points; close those of a mesh first, as batten mesh does");
    if (mesh == NULL && count < MIN_POINTS)
        return ERROR_ARGUMENT(error, "%zu points are too few: a shell needs %d", count, MIN_POINTS);
    status = reconstruct(points, count, mesh, &wanted, CELLS[0], &again, &made, &measured, error);
    if (again)
    {
        progress_part done = {wanted.progress, 1, 0};
        wanted.progress = progress_of_part(&done);
        bat_status second = reconstruct(points, count, mesh, &wanted, CELLS[1], &again, &made, &measured, &failure);
        // The first failure is told, but for one of the second's that has nothing to do with the points.
        status = second == BAT_OK || second == BAT_NO_CONVERGENCE ? second : error_copy(error, &failure);
    }
    if (status == BAT_OK)
        *shell = made;
    if (status == BAT_OK && report != NULL)
        *report = measured;
    return status;
}
