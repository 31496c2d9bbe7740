/// @file
/// Measures of a shell by its points and by the mesh that connects them; see shell.h.

#include "surface/shell/shell.h"

#include "base/error.h"
#include "batten/mesh_measure.h"
#include "linalg/vector.h"
#include "mesh/decimate/map.h"

#include <string.h>

#define JUMP_PLACES 3 ///< of a side
#define GROWTH_PLACES 64
#define MISSED_POINTS 8    ///< of a neighbourhood, and least number of missed points
#define SHEET_POINTS 24    ///< of a neighbourhood
#define SHEET_PLACES 40000 ///< at least half as many are tried where there are more points
#define VOLUME_SAMPLES 6   ///< of a patch

/// Distances of 99 % of the points, in spacings and in standard deviations of the noise.
static const double MAX_SPACINGS = 1.5, MAX_NOISE = 4;
/// Distance of 99 % of the shell, in local spacings, beyond the noise.
static const double MAX_REACH = 4;
/// Root mean square distance, in spacings, from which the points may fill space; and how fast they may grow.
static const double NOISY = 0.4, MAX_GROWTH = 5.3;
/// Where a shell runs between two sheets of points, their signed distances have two values: little mean (squared, in the
/// variance), a kurtosis near 1 (a normal distribution has 3), more variance than elsewhere, and a least size in spacings.
/// The last are the largest agreement of points beside each other, and the largest share of such places.
static const double MAX_MEAN = 0.25, MAX_KURTOSIS = 1.6, MIN_SPREAD = 4, MIN_SHEETS = 0.05, MAX_AGREEMENT = 0.5,
                    MAX_SPLIT = 0.001;
/// Least distance of missed points in the least of such, and largest one from points that are not missed, in spacings.
static const double MIN_MISSED = 1.5, MAX_BESIDE = 3;
/// Share of places with a normal against that of the points, and of the volume.
static const double MAX_TURNED = 0.01, MAX_VOLUME = 0.05;
/// Angle between the normals of neighbouring patches, from which one lies on the other: a right angle.
static const double MAX_ANGLE = 1.5707963267948966;

/// The distance from which a point is missed.
static double far_from(double spacing, double noise)
{
    return fmax(MAX_SPACINGS * spacing, MAX_NOISE * noise);
}

/// The normal at a place of side c of a quad.
static void normal_on_side(const double *bezier, uint32_t half_edge, double t, double normal[3])
{
    uint32_t c = half_edge % 4;
    double u = c == 0 ? t : c == 1 ? 1 : c == 2 ? 1 - t : 0, v = c == 0 ? 0 : c == 1 ? t : c == 2 ? 1 : 1 - t;
    double point[3], along[2][3];
    shell_patch_evaluate(bezier + 48 * (size_t)(half_edge / 4), u, v, point, along);
    vector3_cross(along[0], along[1], normal);
}

double shell_jump(const shell_grid *grid, const double *bezier, uint32_t half_edge, double t)
{
    double first[3], second[3];
    normal_on_side(bezier, half_edge, t, first);
    normal_on_side(bezier, grid->links.twin[half_edge], 1 - t, second);
    return vector3_angle(first, second);
}

static bat_status measure_jumps(const bat_shell *shell, const shell_grid *grid, bat_shell_report *report, bat_error *error)
{
    size_t count = 0;
    double *jumps = memory_array(2 * grid->quad_count, JUMP_PLACES * sizeof *jumps);
    if (jumps == NULL)
        return error_memory(error, 2 * grid->quad_count * JUMP_PLACES * sizeof *jumps);
    for (uint32_t h = 0; h < 4 * grid->quad_count; h++)
    {
        uint32_t twin = grid->links.twin[h];
        if (twin == BAT_MESH_NONE || twin < h || grid->sharp[h])
            continue;
        for (int k = 0; k < JUMP_PLACES; k++)
            jumps[count++] = shell_jump(grid, shell->patches, h, (k + 0.5) / JUMP_PLACES);
    }
    qsort(jumps, count, sizeof *jumps, ascending);
    report->normal_jump[0] = count > 0 ? jumps[count / 2] : 0;
    report->normal_jump[1] = count > 0 ? jumps[count * 99 / 100] : 0;
    report->normal_jump[2] = count > 0 ? jumps[count - 1] : 0;
    free(jumps);
    return BAT_OK;
}

/// Volume, pieces and holes.
static bat_status measure_topology(const bat_shell *shell, const bat_mesh *mesh, bat_shell_report *report, bat_error *error)
{
    bat_mesh sampled = {0}, triangles = {0};
    bat_mesh_summary summary, given;
    bat_status status = bat_shell_tessellate(shell, VOLUME_SAMPLES, &sampled, error);
    if (status == BAT_OK)
        status = bat_mesh_triangulate(&sampled, &triangles, error);
    if (status == BAT_OK)
        status = bat_mesh_summarize(&triangles, &summary, error);
    if (status == BAT_OK)
        status = bat_mesh_summarize(mesh, &given, error);
    bat_mesh_free(&sampled);
    bat_mesh_free(&triangles);
    if (status != BAT_OK)
        return status;
    report->volume = summary.volume;
    report->mesh_volume = given.volume;
    report->pieces = summary.components;
    report->holes = summary.boundary_loops;
    return BAT_OK;
}

/// Places on the shell: their distances from points, in spacings, and their normals against the mesh's.
typedef struct shell_samples
{
    size_t count;
    double *places, *normals; ///< count x 3
    double *reach;            ///< count
    bat_mesh_closest_point *closest;
    memory_pool pool;
} shell_samples;

static bat_status make_samples(const bat_shell *shell, shell_samples *samples, bat_error *error)
{
    static const double AT[2] = {0.25, 0.75};
    size_t quads = shell->cage.face_count;
    samples->count = 4 * quads;
    samples->places = memory_pool_array(&samples->pool, samples->count, 3 * sizeof *samples->places);
    samples->normals = memory_pool_array(&samples->pool, samples->count, 3 * sizeof *samples->normals);
    samples->reach = memory_pool_array(&samples->pool, samples->count, sizeof *samples->reach);
    samples->closest = memory_pool_array(&samples->pool, samples->count, sizeof *samples->closest);
    bat_status status = memory_pool_check(&samples->pool, error);
    for (size_t k = 0; k < samples->count && status == BAT_OK; k++)
    {
        double along[2][3];
        shell_patch_evaluate(shell->patches + 48 * (k / 4), AT[k % 2], AT[k / 2 % 2], samples->places + 3 * k, along);
        vector3_cross(along[0], along[1], samples->normals + 3 * k);
    }
    return status;
}

static bat_status measure_turns(const bat_mesh *mesh, const shell_fit *fit, const shell_samples *samples, bool *marks,
                                size_t *count, bat_error *error)
{
    double *normals = memory_array(mesh->vertex_count, 3 * sizeof *normals);
    if (normals == NULL)
        return error_memory(error, mesh->vertex_count * 3 * sizeof *normals);
    bat_status status = bat_mesh_vertex_normals(mesh, BAT_MESH_NORMALS_ANGLE, normals, error);
    if (status == BAT_OK)
        status = bat_mesh_closest(mesh, samples->places, samples->count, fit->threads, samples->closest, error);
    for (size_t k = 0; k < samples->count && status == BAT_OK; k++)
    {
        double sum = 0;
        for (size_t c = 0; c < 3; c++)
            sum += samples->normals[3 * k + c] * map_value_at(mesh, normals + c, 3, &samples->closest[k].at);
        *count += sum < 0;
        for (size_t c = 0; c < 4 && sum < 0 && marks != NULL; c++)
            marks[fit->grid->quads[k / 4 * 4 + c]] = true;
    }
    free(normals);
    return status;
}

/// How much faster than on a surface the number of points grows with the radius of a ball: the median over places of the
/// number within 2 r over that within r, for r of three standard deviations of the distances. It is 4 on a plane and 8 in
/// space.
static bat_status measure_growth(const shell_fit *fit, const nearest_tree *tree, double rms, double *growth,
                                 bat_error *error)
{
    neighbour_list near = {0};
    double ratios[GROWTH_PLACES];
    bat_status status = BAT_OK;
    for (size_t k = 0; k < GROWTH_PLACES && status == BAT_OK; k++)
    {
        const double *place = fit->points + 3 * (k * fit->count / GROWTH_PLACES);
        status = neighbours_within(tree, place, 3 * rms, &near, error);
        double inner = (double)near.count;
        if (status == BAT_OK)
            status = neighbours_within(tree, place, 6 * rms, &near, error);
        ratios[k] = (double)near.count / inner;
    }
    neighbour_list_free(&near);
    if (status == BAT_OK)
        *growth = sort_median(ratios, GROWTH_PLACES);
    return status;
}

bat_status shell_find_folds(const shell_fit *fit, const bat_mesh *mesh, bool *marks, size_t *count, bat_error *error)
{
    const shell_grid *grid = fit->grid;
    const bat_shell shell = {.cage = {.face_count = grid->quad_count}, .patches = fit->bezier};
    shell_samples samples = {0};
    *count = 0;
    bat_status status = make_samples(&shell, &samples, error);
    if (status == BAT_OK)
        status = measure_turns(mesh, fit, &samples, marks, count, error);
    memory_pool_free(&samples.pool);
    for (uint32_t k = 0; k < 16 * grid->quad_count; k++)
    {
        uint32_t h = k / 4, twin = grid->links.twin[h];
        if (twin == BAT_MESH_NONE || grid->sharp[h] || shell_jump(grid, fit->bezier, h, 0.5) < MAX_ANGLE / 3)
            continue;
        marks[grid->quads[h / 4 * 4 + k % 4]] = true;
        *count += k % 4 == 0 && h < twin;
    }
    return status;
}

bat_status shell_measure(const bat_shell *shell, const shell_fit *fit, const bat_mesh *mesh, bat_shell_report *report,
                         bat_error *error)
{
    shell_samples samples = {0};
    nearest_tree tree = {0};
    double sum = 0, largest = 0;
    for (size_t i = 0; i < fit->count; i++)
    {
        sum += fit->squared[i];
        largest = fmax(largest, fit->squared[i]);
    }
    report->points = fit->count;
    report->rms = sqrt(sum / (double)fit->count);
    report->largest = sqrt(largest);
    report->noise = sqrt(sum / fmax((double)fit->count - fit->trace, 1));
    double far = far_from(report->spacing, report->noise);
    report->missed = 0;
    for (size_t i = 0; i < fit->count; i++)
        report->missed += fit->squared[i] > far * far;
    bat_status status = measure_jumps(shell, fit->grid, report, error);
    if (status == BAT_OK)
        status = shell_count_crossings(shell, &report->crossings, error);
    if (status == BAT_OK)
        status = neighbours_build(fit->points, fit->count, &tree, error);
    if (status == BAT_OK && report->rms > NOISY * report->spacing)
        status = measure_growth(fit, &tree, report->rms, &report->growth, error);
    if (status == BAT_OK)
        status = measure_topology(shell, mesh, report, error);
    if (status == BAT_OK)
        status = make_samples(shell, &samples, error);
    if (status == BAT_OK)
        status = shell_distances(fit->points, &tree, samples.places, samples.count, MAX_NOISE * report->noise,
                                 report->spacing, samples.reach, error);
    if (status == BAT_OK)
    {
        qsort(samples.reach, samples.count, sizeof *samples.reach, ascending);
        report->reach = samples.reach[samples.count * 99 / 100];
        status = measure_turns(mesh, fit, &samples, NULL, &report->turned, error);
    }
    nearest_free(&tree);
    memory_pool_free(&samples.pool);
    return status;
}

/// Signed distances of the points from the shell.
static void measure_heights(const shell_fit *fit, double *heights)
{
    for (size_t i = 0; i < fit->count; i++)
    {
        const shell_place *place = &fit->places[i];
        double point[3], along[2][3], normal[3], arm[3];
        shell_patch_evaluate(fit->bezier + 48 * (size_t)place->face, place->u, place->v, point, along);
        vector3_cross(along[0], along[1], normal);
        (void)vector3_normalize(normal);
        vector3_subtract(fit->points + 3 * i, point, arm);
        heights[i] = vector3_dot(arm, normal);
    }
}

/// How much the heights of points agree with those of the points beside them: 1 where they change slowly, as where patches
/// are too large for a bend, and near 0 where two sheets have a point each beside the other's.
static double agreement_of(const shell_fit *fit, const neighbour_list *near, const double *heights)
{
    double sum = 0, squares = 0;
    for (size_t j = 0; j < near->count; j++)
    {
        uint32_t point = near->entries[j].item, beside = point;
        double least = INFINITY;
        for (size_t k = 0; k < near->count; k++)
        {
            uint32_t other = near->entries[k].item;
            double apart = vector3_distance(fit->points + 3 * (size_t)point, fit->points + 3 * (size_t)other),
                   rise = heights[point] - heights[other], squared = apart * apart - rise * rise;
            if (other == point || squared >= least)
                continue;
            least = squared;
            beside = other;
        }
        sum += heights[point] * heights[beside];
        squares += heights[point] * heights[point];
    }
    return sum / squares;
}

/// Find a point between two sheets. SIZE_MAX: there are too few.
static bat_status find_sheets(const shell_fit *fit, const nearest_tree *tree, double spacing, size_t *worst,
                              bat_error *error)
{
    neighbour_list near = {0};
    memory_pool pool = {0};
    size_t count = 0, step = fit->count / SHEET_PLACES + 1, places = (fit->count - 1) / step + 1;
    double *heights = memory_pool_array(&pool, fit->count, sizeof *heights),
           *squares = memory_pool_array(&pool, places, sizeof *squares),
           *sorted = memory_pool_array(&pool, places, sizeof *sorted), most = 0;
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        measure_heights(fit, heights);
    for (size_t k = 0; k < places && status == BAT_OK; k++)
    {
        double moments[5] = {0};
        status = neighbours_nearest(tree, fit->points + 3 * k * step, SHEET_POINTS, &near, error);
        for (size_t j = 0; j < near.count; j++)
            for (int power = 1; power < 5; power++)
                moments[power] += pow(heights[near.entries[j].item], power) / (double)near.count;
        bool split =
            moments[1] * moments[1] < MAX_MEAN * moments[2] && moments[4] < MAX_KURTOSIS * moments[2] * moments[2] &&
            moments[2] > MIN_SHEETS * MIN_SHEETS * spacing * spacing && agreement_of(fit, &near, heights) < MAX_AGREEMENT;
        sorted[k] = moments[2];
        squares[k] = split ? moments[2] : 0;
    }
    double median = status == BAT_OK ? sort_median(sorted, places) : 0;
    for (size_t k = 0; k < places && status == BAT_OK; k++)
    {
        count += squares[k] > MIN_SPREAD * median;
        *worst = squares[k] > most ? k * step : *worst;
        most = fmax(most, squares[k]);
    }
    *worst = (double)count > MAX_SPLIT * (double)places ? *worst : SIZE_MAX;
    neighbour_list_free(&near);
    memory_pool_free(&pool);
    return status;
}

/// Find the farthest of points that are missed together, beside points that are not: a part, where outliers are alone and
/// debris is by itself. SIZE_MAX: there are too few, or none is far.
static bat_status find_missed(const shell_fit *fit, const nearest_tree *tree, double far, double spacing, size_t *worst,
                              bat_error *error)
{
    neighbour_list near = {0};
    size_t together = 0, beside = 0;
    double most = 0;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < fit->count && status == BAT_OK; i++)
    {
        size_t missed = 0, met = 0;
        if (fit->squared[i] <= far * far)
            continue;
        status = neighbours_nearest(tree, fit->points + 3 * i, MISSED_POINTS, &near, error);
        for (size_t k = 0; k < near.count; k++)
        {
            bool is_missed = fit->squared[near.entries[k].item] > far * far;
            missed += is_missed;
            met += !is_missed && near.entries[k].squared < MAX_BESIDE * MAX_BESIDE * spacing * spacing;
        }
        together += 2 * missed > near.count;
        beside += 2 * missed > near.count && met > 0;
        *worst = 2 * missed > near.count && fit->squared[i] > most ? i : *worst;
        most = *worst == i ? fit->squared[i] : most;
    }
    neighbour_list_free(&near);
    if (together < MISSED_POINTS || beside == 0 || most < MIN_MISSED * MIN_MISSED * far * far)
        *worst = SIZE_MAX;
    return status;
}

bat_status shell_find_fault(const shell_fit *fit, const bat_shell_report *report, shell_fault *fault, size_t *worst,
                            bat_error *error)
{
    nearest_tree tree = {0};
    double far = far_from(report->spacing, report->noise);
    bat_status status = neighbours_build(fit->points, fit->count, &tree, error);
    *fault = SHELL_SHEETS;
    if (status == BAT_OK)
        status = find_sheets(fit, &tree, report->spacing, worst, error);
    if (status == BAT_OK && *worst == SIZE_MAX)
    {
        *fault = SHELL_MISSED;
        status = find_missed(fit, &tree, far, report->spacing, worst, error);
    }
    *fault = *worst == SIZE_MAX ? SHELL_RIGHT : *fault;
    nearest_free(&tree);
    return status;
}

bat_status shell_judge(const bat_shell *shell, const bat_shell_report *report, double noise, bat_error *error)
{
    double far = far_from(report->spacing, noise);
    size_t samples = 4 * shell->cage.face_count;
    if (report->growth > MAX_GROWTH)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the points fill space, rather than a surface: twice as far from a point there are %.2g times as "
                         "many (a surface has 4)",
                         report->growth);
    if (report->rms > far / 2)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the shell misses points: their root mean square distance is %.3g, at a spacing of %.3g and noise "
                         "of %.3g",
                         report->rms, report->spacing, noise);
    if (report->reach > MAX_REACH)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the shell leaves the points: 1 %% of it is farther than %.3g spacings from all points",
                         report->reach);
    if ((double)report->turned > MAX_TURNED * (double)samples)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the shell folds: at %zu of %zu places its normal is against that of the points", report->turned,
                         samples);
    if (report->normal_jump[2] > MAX_ANGLE)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the shell folds: normals of neighbouring patches differ by %.0f degrees",
                         report->normal_jump[2] * 90 / MAX_ANGLE);
    if (shell->closed && !(fabs(report->volume - report->mesh_volume) <= MAX_VOLUME * fabs(report->mesh_volume)))
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the shell has a volume of %.6g, but the points enclose %.6g", report->volume, report->mesh_volume);
    return BAT_OK;
}
