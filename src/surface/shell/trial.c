/// @file
/// Layouts on trial; see work.h.
///
/// Layouts of 200, 400, ... faces are fitted to nine of ten points, until the distances of the tenth no longer fall by
/// MIN_GAIN, or all points are within the tolerance.

#include "surface/shell/work.h"

#include "linalg/vector.h"
#include "mesh/decimate/map.h"

#include <string.h>

#define FIRST_FACES 200
#define POINTS_PER_CONTROL 2 ///< least number of points for each control point, on average
#define MISSES 2             ///< layouts in a row that bring held-out points no nearer, after which no other is tried
#define HOLD_OUT 10
#define ROUNDS 4
#define SPREADS 4 ///< rounds in which residuals spread among neighbours
#define WEIGHED 2 ///< layouts that follow residuals

/// Least share by which the distances of held-out points fall with twice the faces.
static const double MIN_GAIN = 0.005;
/// With stronger smoothing, the share by which they may rise with more faces, and the factor against weak smoothing.
static const double MAX_LOSS = 0.002, MAX_RISE = 1.015;
/// Weight of normals in the error of the layouts that follow residuals.
static const double WEIGHED_NORMALS = 1;
/// Largest factor of normals where points are far, and the least share by which it brings held-out points nearer.
static const double MAX_FACTOR = 4, MIN_WEIGHED_GAIN = 0.01;
/// Largest number of faces with creases, in the number that was given or is the least for a tolerance, or in the least of
/// all.
static const double MAX_EXCESS = 1.5, LEAST_FACES = 16;

bat_status shell_place_on_mesh(shell_work *work, bat_error *error)
{
    const bat_mesh *mesh = &work->mesh;
    size_t count = work->count, all = count + SHELL_ANCHORS * mesh->face_count;
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
        *at = (bat_mesh_point){(uint32_t)(k / SHELL_ANCHORS), {1.0 / 6, 1.0 / 6, 1.0 / 6}};
        at->barycentric[k % SHELL_ANCHORS] = 2.0 / 3;
        for (size_t c = 0; c < 3; c++)
            points[3 * (count + k) + c] = map_value_at(mesh, mesh->positions + c, 3, at);
    }
    return BAT_OK;
}

void shell_trial_free(shell_trial *trial)
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

bat_status shell_trial_make(const shell_work *work, size_t faces, shell_trial *trial, bat_error *error)
{
    shell_fit *fit = &trial->fit;
    bat_status status = shell_layout_make(&work->mesh, faces, is_bounded(work), work->normals, &trial->layout, error);
    if (status == BAT_OK)
        status = shell_grid_make(&trial->layout, work->options->spans, &trial->grid, error);
    if (status != BAT_OK)
        return status;
    size_t all = work->count + SHELL_ANCHORS * work->mesh.face_count;
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

bat_status shell_trial_fit(shell_trial *trial, int rounds, bat_error *error)
{
    shell_fit *fit = &trial->fit;
    bat_status status = shell_fit_run(fit, rounds / 2, error);
    double sum = 0;
    for (size_t i = 0; i < fit->count && status == BAT_OK; i++)
        sum += fit->squared[i];
    fit->unbias = sum / fmax((double)fit->count - fit->trace, 1);
    return status == BAT_OK ? shell_fit_run(fit, rounds - rounds / 2, error) : status;
}

bat_status shell_try_layout(const shell_work *work, size_t faces, double *held, double *largest, bat_error *error)
{
    shell_trial trial = {0};
    bat_status status = shell_trial_make(work, faces, &trial, error);
    trial.fit.held = work->held;
    if (status == BAT_OK)
        status = shell_trial_fit(&trial, ROUNDS, error);
    if (status == BAT_OK)
    {
        *held = distance_of(work, &trial.fit, largest);
        if (work->sharp && is_bounded(work) &&
            (double)trial.layout.face_count > MAX_EXCESS * fmax((double)faces, LEAST_FACES))
            *held = INFINITY;
        memcpy(work->squared, trial.fit.squared, work->count * sizeof *work->squared);
    }
    shell_trial_free(&trial);
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
    limit = limit < SHELL_MAX_FACES ? limit : SHELL_MAX_FACES;
    *best = INFINITY;
    *faces = work->options->faces;
    for (size_t wanted = *faces > 0 ? *faces : FIRST_FACES, k = 0; goes_on;
         wanted = 2 * wanted < limit ? 2 * wanted : limit, k++)
    {
        bat_status status = progress_goes_on(progress, (double)k / 6)
                                ? shell_try_layout(work, wanted, &held, &largest, error)
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
        if (shell_try_layout(work, faces, &held, &largest, NULL) != BAT_OK || !(held < (1 - MIN_WEIGHED_GAIN) * *best) ||
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

bat_status shell_find_layout(shell_work *work, bat_progress progress, bat_error *error)
{
    double best = INFINITY, held = INFINITY, largest = 0, stiffness = work->stiffness,
           tolerance = work->options->tolerance / work->unit;
    size_t faces = 0;
    bat_status status = find_faces(work, progress, &faces, &best, error);
    if (status == BAT_OK && stiffness > 1)
    {
        work->stiffness = 1;
        status = shell_try_layout(work, faces, &held, &largest, error);
        if (status == BAT_OK && held * MAX_RISE < best)
            status = find_faces(work, progress, &faces, &best, error);
        else
            work->stiffness = stiffness;
    }
    if (status != BAT_OK)
        return status;
    work->normals = SHELL_NORMALS;
    status = shell_try_layout(work, faces, &held, &largest, error);
    work->normals = held < (1 - MIN_GAIN) * best && !(tolerance > 0 && largest > tolerance) ? SHELL_NORMALS : 0;
    work->report.held_out = work->normals > 0 ? held : best;
    if (status == BAT_OK)
        status = refine_layout(work, faces, tolerance, progress, &work->report.held_out, error);
    work->faces = faces;
    return status == BAT_OK ? shell_steps_save(work, error) : status;
}
