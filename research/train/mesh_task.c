#include "research/train/mesh_task.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/mesh_refine.h"
#include "linalg/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    CLASSICAL_SAMPLES = 4000
};
/// Of the power mean of normals' differences: high enough to follow the sharpest twentieth, low enough to be smooth.
static const double ROUGH_POWER = 4;
/// Of the power mean of distances: high enough to follow the largest ones, low enough to be measured by samples.
static const double PEAK_POWER = 4;
/// Added to distances, in mean coarse edges: below it, differences do not matter.
static const double DISTANCE_FLOOR = 1e-4;
/// Added to relative errors of the volume to make their size smooth.
static const double VOLUME_FLOOR = 1e-3;
/// Added to the roughness.
static const double ROUGH_FLOOR = 1e-3;

// Points of surfaces

/// Cumulative areas of faces; returns the sum.
static double sum_areas(const double *positions, const uint32_t *faces, size_t count, double *areas)
{
    double sum = 0;
    for (size_t f = 0; f < count; f++)
    {
        double u[3], v[3], normal[3];
        vector3_subtract(positions + 3 * faces[3 * f + 1], positions + 3 * faces[3 * f], u);
        vector3_subtract(positions + 3 * faces[3 * f + 2], positions + 3 * faces[3 * f], v);
        vector3_cross(u, v, normal);
        sum += 0.5 * sqrt(vector3_dot(normal, normal));
        areas[f] = sum;
    }
    return sum;
}

static size_t find_face(const double *areas, size_t count, double at)
{
    size_t low = 0, high = count - 1;
    while (low < high)
    {
        size_t middle = (low + high) / 2;
        if (areas[middle] > at)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static void draw_barycentric(bat_random *random, double weights[3])
{
    double root = sqrt(bat_random_uniform(random)), other = bat_random_uniform(random);
    weights[0] = 1 - root;
    weights[1] = root * (1 - other);
    weights[2] = root * other;
}

static void point_of(const double *positions, const uint32_t *corner, const double weights[3], double point[3])
{
    for (int c = 0; c < 3; c++)
    {
        point[c] = 0;
        for (int i = 0; i < 3; i++)
            point[c] += weights[i] * positions[3 * corner[i] + (uint32_t)c];
    }
}

static double volume_of(const double *positions, const uint32_t *faces, size_t count)
{
    double sum = 0, product[3];
    for (size_t f = 0; f < count; f++)
    {
        vector3_cross(positions + 3 * faces[3 * f + 1], positions + 3 * faces[3 * f + 2], product);
        sum += vector3_dot(positions + 3 * faces[3 * f], product) / 6;
    }
    return sum;
}

// Targets

bat_status mesh_target_make(bat_mesh *shape, uint64_t seed, mesh_target *target, bat_error *error)
{
    mesh_target made = {.shape = *shape};
    bat_random random = bat_random_seed(seed);
    bat_mesh_connectivity links = {0};
    double *areas = memory_array(shape->face_count, sizeof *areas);
    made.samples = memory_array(MESH_TARGET_SAMPLES, sizeof *made.samples);
    bat_status status =
        areas == NULL || made.samples == NULL ? error_memory(error, shape->face_count * sizeof *areas) : BAT_OK;
    if (status == BAT_OK)
        status = closest_build(shape, 16, &made.tree, error);
    if (status == BAT_OK)
        status = bat_mesh_connect(shape, &links, error);
    if (status == BAT_OK)
    {
        double area = sum_areas(shape->positions, shape->faces, shape->face_count, areas);
        for (size_t s = 0; s < MESH_TARGET_SAMPLES; s++)
        {
            double weights[3];
            size_t face = find_face(areas, shape->face_count, area * bat_random_uniform(&random));
            draw_barycentric(&random, weights);
            point_of(shape->positions, shape->faces + 3 * face, weights, made.samples[s]);
        }
        made.closed = links.boundary_edge_count == 0;
        made.volume = made.closed ? volume_of(shape->positions, shape->faces, shape->face_count) : 0;
        *target = made;
        *shape = (bat_mesh){0};
    }
    else
    {
        closest_free(&made.tree);
        free(made.samples);
    }
    bat_mesh_connectivity_free(&links);
    free(areas);
    return status;
}

void mesh_target_free(mesh_target *target)
{
    bat_mesh_free(&target->shape);
    closest_free(&target->tree);
    free(target->samples);
    *target = (mesh_target){0};
}

// Measures and their gradients

/// Sums over the samples of one direction.
typedef struct one_way
{
    size_t count;
    double *distance;                 ///< count
    uint32_t (*corner)[3];            ///< count: vertices of the refined mesh
    double (*weights)[3], (*unit)[3]; ///< count: barycentric coordinates; direction from the shape to the refined mesh
    double mean, rms, peak;
} one_way;

static bool one_way_make(one_way *way, size_t count)
{
    *way = (one_way){.count = count,
                     .distance = memory_array(count, sizeof *way->distance),
                     .corner = memory_array(count, sizeof *way->corner),
                     .weights = memory_array(count, sizeof *way->weights),
                     .unit = memory_array(count, sizeof *way->unit)};
    return way->distance != NULL && way->corner != NULL && way->weights != NULL && way->unit != NULL;
}

static void one_way_free(one_way *way)
{
    free(way->distance);
    free(way->corner);
    free(way->weights);
    free(way->unit);
}

static void one_way_take(one_way *way, size_t s, const uint32_t *corner, const double weights[3], const double fine[3],
                         const double shape[3])
{
    double away[3];
    vector3_subtract(fine, shape, away);
    double distance = sqrt(vector3_dot(away, away)), factor = distance > 0 ? 1 / distance : 0;
    way->distance[s] = distance;
    memcpy(way->corner[s], corner, sizeof way->corner[s]);
    memcpy(way->weights[s], weights, sizeof way->weights[s]);
    for (int c = 0; c < 3; c++)
        way->unit[s][c] = factor * away[c];
}

static void one_way_end(one_way *way)
{
    double sum = 0, squares = 0;
    for (size_t s = 0; s < way->count; s++)
    {
        sum += way->distance[s];
        squares += way->distance[s] * way->distance[s];
    }
    way->mean = sum / (double)way->count;
    way->rms = sqrt(squares / (double)way->count);
    // Relative to the root mean square, so that no power is too small.
    double powers = 0;
    for (size_t s = 0; s < way->count && way->rms > 0; s++)
        powers += pow(way->distance[s] / way->rms, PEAK_POWER);
    way->peak = way->rms * pow(powers / (double)way->count, 1 / PEAK_POWER);
}

/// The power mean of two.
static double join_peaks(double a, double b)
{
    double most = fmax(a, b);
    return most > 0 ? most * pow(0.5 * (pow(a / most, PEAK_POWER) + pow(b / most, PEAK_POWER)), 1 / PEAK_POWER) : 0;
}

/// The derivative of join_peaks() by a.
static double join_slope(double a, double both)
{
    return both > 0 ? 0.5 * pow(a / both, PEAK_POWER - 1) : 0;
}

/// Add the gradient of `mean_factor` mean + `rms_factor` rms + `peak_factor` peak.
static void one_way_back(const one_way *way, double mean_factor, double rms_factor, double peak_factor, double *gradient)
{
    for (size_t s = 0; s < way->count; s++)
    {
        double slope = mean_factor;
        if (way->rms > 0)
            slope += rms_factor * way->distance[s] / way->rms;
        if (peak_factor != 0 && way->peak > 0)
            slope += peak_factor * pow(way->distance[s] / way->peak, PEAK_POWER - 1);
        double factor = slope / (double)way->count;
        for (int i = 0; i < 3; i++)
            for (int c = 0; c < 3; c++)
                gradient[3 * way->corner[s][i] + (uint32_t)c] += factor * way->weights[s][i] * way->unit[s][c];
    }
}

/// From random points of the refined mesh to the shape.
static bool measure_there(const mesh_task *task, const double *positions, bat_random *random, one_way *way)
{
    size_t faces = task->fine.face_count;
    const uint32_t *corners = task->fine.faces;
    double *areas = memory_array(faces, sizeof *areas);
    if (areas == NULL)
        return false;
    double area = sum_areas(positions, corners, faces, areas), shift = bat_random_uniform(random);
    uint32_t near = 0;
    for (size_t s = 0; s < way->count; s++)
    {
        double weights[3], point[3];
        // Stratified and in order of faces, so that neighbouring queries are near each other.
        size_t face = find_face(areas, faces, area * ((double)s + shift) / (double)way->count);
        draw_barycentric(random, weights);
        point_of(positions, corners + 3 * face, weights, point);
        (void)closest_find(&task->target->tree, point, &near);
        closest_hit hit = closest_point_at(&task->target->tree, point, near);
        one_way_take(way, s, corners + 3 * face, weights, point, hit.point);
    }
    one_way_end(way);
    free(areas);
    return true;
}

/// From points of the shape to the refined mesh.
static bool measure_back(const mesh_task *task, double *positions, bat_random *random, one_way *way)
{
    closest_tree tree;
    bat_mesh view = task->fine;
    view.positions = positions;
    if (closest_build(&view, 16, &tree, NULL) != BAT_OK)
        return false;
    size_t begin = (size_t)((double)(MESH_TARGET_SAMPLES - way->count) * bat_random_uniform(random));
    uint32_t near = 0;
    for (size_t s = 0; s < way->count; s++)
    {
        const double *point = task->target->samples[begin + s];
        (void)closest_find(&tree, point, &near);
        closest_hit hit = closest_point_at(&tree, point, near);
        one_way_take(way, s, task->fine.faces + (size_t)3 * hit.face, hit.barycentric, hit.point, point);
    }
    one_way_end(way);
    closest_free(&tree);
    return true;
}

/// Unit normals of faces; returns false without memory. `lengths` are twice the areas.
static bool face_normals(const mesh_task *task, const double *positions, double (**normals)[3], double **lengths)
{
    size_t faces = task->fine.face_count;
    const uint32_t *corner = task->fine.faces;
    *normals = memory_array(faces, sizeof **normals);
    *lengths = memory_array(faces, sizeof **lengths);
    if (*normals == NULL || *lengths == NULL)
        return false;
    for (size_t f = 0; f < faces; f++, corner += 3)
    {
        double *n = (*normals)[f];
        vector3_triangle(positions + 3 * corner[0], positions + 3 * corner[1], positions + 3 * corner[2], n);
        double length = sqrt(vector3_dot(n, n)), factor = length > 1e-14 ? 1 / length : 0;
        for (int c = 0; c < 3; c++)
            n[c] *= factor;
        (*lengths)[f] = length;
    }
    return true;
}

/// The power mean of |n - m| over the edges between faces of normals n and m. Adds `factor` times its gradient where
/// `gradient` is not null.
static bool measure_roughness(const mesh_task *task, const double *positions, double factor, double *result,
                              double *gradient)
{
    double(*normals)[3], *lengths, (*pull)[3] = NULL, sum = 0;
    size_t faces = task->fine.face_count, count = 0;
    const uint32_t *twin = task->fine_links.twin;
    bool sound = face_normals(task, positions, &normals, &lengths);
    if (sound && gradient != NULL)
    {
        pull = calloc(faces, sizeof *pull);
        sound = pull != NULL;
    }
    for (uint32_t h = 0; h < 3 * faces && sound; h++)
    {
        if (twin[h] == BAT_MESH_NONE || twin[h] < h)
            continue;
        const double *n = normals[h / 3], *m = normals[twin[h] / 3];
        double difference[3];
        vector3_subtract(n, m, difference);
        double square = vector3_dot(difference, difference);
        sum += pow(square, ROUGH_POWER / 2);
        count++;
        for (int c = 0; c < 3 && pull != NULL; c++)
        {
            double of_power = ROUGH_POWER * pow(square, ROUGH_POWER / 2 - 1) * difference[c];
            pull[h / 3][c] += of_power;
            pull[twin[h] / 3][c] -= of_power;
        }
    }
    double share = count > 0 ? 1 / (double)count : 0, mean = share * sum;
    if (sound)
        *result = pow(mean, 1 / ROUGH_POWER);
    double outer = mean > 0 ? factor * share / ROUGH_POWER * pow(mean, 1 / ROUGH_POWER - 1) : 0;
    for (size_t f = 0; f < faces && sound && pull != NULL; f++)
    {
        // d n = (I - n n^T) d(u x v) / |u x v|
        const uint32_t *corner = task->fine.faces + 3 * f;
        double along = vector3_dot(normals[f], pull[f]), g[3], u[3], v[3], du[3], dv[3];
        // Slivers would have unbounded gradients.
        double inverse = lengths[f] > 1e-10 ? outer / lengths[f] : 0;
        for (int c = 0; c < 3; c++)
            g[c] = inverse * (pull[f][c] - along * normals[f][c]);
        vector3_subtract(positions + 3 * corner[1], positions + 3 * corner[0], u);
        vector3_subtract(positions + 3 * corner[2], positions + 3 * corner[0], v);
        vector3_cross(v, g, du);
        vector3_cross(g, u, dv);
        for (uint32_t c = 0; c < 3; c++)
        {
            gradient[3 * corner[1] + c] += du[c];
            gradient[3 * corner[2] + c] += dv[c];
            gradient[3 * corner[0] + c] -= du[c] + dv[c];
        }
    }
    free(normals);
    free(lengths);
    free(pull);
    return sound;
}

/// The relative error of the volume, signed; adds `factor` times its gradient.
static double measure_volume(const mesh_task *task, const double *positions, double factor, double *gradient)
{
    const mesh_target *target = task->target;
    if (!target->closed)
        return 0;
    for (size_t f = 0; f < task->fine.face_count && gradient != NULL; f++)
    {
        const uint32_t *corner = task->fine.faces + 3 * f;
        for (uint32_t i = 0; i < 3; i++)
        {
            double product[3];
            vector3_cross(positions + 3 * corner[(i + 1) % 3], positions + 3 * corner[(i + 2) % 3], product);
            for (uint32_t c = 0; c < 3; c++)
                gradient[3 * corner[i] + c] += factor / (6 * target->volume) * product[c];
        }
    }
    return volume_of(positions, task->fine.faces, task->fine.face_count) / target->volume - 1;
}

/// Measure a refined mesh.
static bool measure(const mesh_task *task, double *positions, size_t samples, bat_random *random, one_way ways[2],
                    mesh_fit *fit)
{
    bool sound = one_way_make(&ways[0], samples);
    sound = one_way_make(&ways[1], samples) && sound;
    if (!sound || !measure_there(task, positions, random, &ways[0]) || !measure_back(task, positions, random, &ways[1]))
        return false;
    fit->mean = 0.5 * (ways[0].mean + ways[1].mean);
    fit->rms = 0.5 * (ways[0].rms + ways[1].rms);
    fit->peak = join_peaks(ways[0].peak, ways[1].peak);
    fit->volume = measure_volume(task, positions, 0, NULL);
    return measure_roughness(task, positions, 0, &fit->roughness, NULL);
}

// Tasks

static bat_status measure_classical(mesh_task *task, bat_error *error)
{
    static const bat_mesh_scheme SCHEMES[] = {BAT_MESH_SCHEME_MIDPOINT, BAT_MESH_SCHEME_BUTTERFLY, BAT_MESH_SCHEME_LOOP};
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.levels = LEARNED_LEVELS_OF_MESH;
    options.threads = 1;
    for (size_t i = 0; i < sizeof SCHEMES / sizeof *SCHEMES; i++)
    {
        bat_mesh fine = {0};
        mesh_fit fit;
        one_way ways[2] = {0};
        bat_random random = bat_random_seed(1);
        options.scheme = SCHEMES[i];
        bat_status status = bat_mesh_refine(&task->coarse, &options, &fine, NULL, error);
        if (status == BAT_OK && i == 0)
        {
            task->fine = fine;
            status = bat_mesh_connect(&fine, &task->fine_links, error);
        }
        if (status == BAT_OK && !measure(task, fine.positions, CLASSICAL_SAMPLES, &random, ways, &fit))
            status = error_memory(error, 0);
        one_way_free(&ways[0]);
        one_way_free(&ways[1]);
        if (i > 0)
            bat_mesh_free(&fine);
        if (status != BAT_OK)
            return status;
        task->best.mean = i == 0 || fit.mean < task->best.mean ? fit.mean : task->best.mean;
        task->best.rms = i == 0 || fit.rms < task->best.rms ? fit.rms : task->best.rms;
        task->best.peak = i == 0 || fit.peak < task->best.peak ? fit.peak : task->best.peak;
        task->best.volume = i == 0 || fabs(fit.volume) < fabs(task->best.volume) ? fit.volume : task->best.volume;
        task->best.roughness = fit.roughness;
    }
    return BAT_OK;
}

static double mean_edge(const bat_mesh *mesh)
{
    double sum = 0;
    for (size_t h = 0; h < 3 * mesh->face_count; h++)
        sum += vector3_distance(mesh->positions + 3 * mesh->faces[h],
                                mesh->positions + 3 * mesh->faces[bat_mesh_next((uint32_t)h)]);
    return sum / (3 * (double)mesh->face_count);
}

bat_status mesh_task_make(const mesh_target *target, coarse_kind kind, size_t vertices, bat_random *random, mesh_task *task,
                          bat_error *error)
{
    mesh_task made = {.target = target};
    bat_mesh_connectivity links = {0};
    bat_status status = coarse_mesh_make(&target->shape, &target->tree, kind, vertices, random, &made.coarse, error);
    if (status == BAT_OK)
        status = bat_mesh_connect(&made.coarse, &links, error);
    if (status == BAT_OK)
        status = mesh_levels_make(made.coarse.faces, &links, LEARNED_LEVELS_OF_MESH, 1, &made.levels, error);
    for (size_t level = 0; level < LEARNED_LEVELS_OF_MESH && status == BAT_OK; level++)
        status = mesh_learned_rows_make(&made.levels.level[level], &made.rows[level], error);
    if (status == BAT_OK)
        status = learned_geometry_make(&made.levels.level[0], made.coarse.positions, &made.geometry, error);
    if (status == BAT_OK)
        status = measure_classical(&made, error);
    bat_mesh_connectivity_free(&links);
    if (status != BAT_OK)
    {
        mesh_task_free(&made);
        return status;
    }
    made.edge = mean_edge(&made.coarse);
    *task = made;
    return BAT_OK;
}

void mesh_task_free(mesh_task *task)
{
    bat_mesh_free(&task->coarse);
    bat_mesh_free(&task->fine);
    bat_mesh_connectivity_free(&task->fine_links);
    mesh_levels_free(&task->levels);
    for (size_t level = 0; level < LEARNED_LEVELS_OF_MESH; level++)
        mesh_learned_rows_free(&task->rows[level]);
    learned_geometry_free(&task->geometry);
    *task = (mesh_task){0};
}

double mesh_task_ratio(const mesh_task *task, const mesh_fit *fit)
{
    double floor = DISTANCE_FLOOR * task->edge;
    return (fit->mean + floor) / (task->best.mean + floor);
}

// The loss

typedef struct task_loss
{
    learn_array *positions, *loss;
    double *gradient; ///< of the loss, vertices x 3
} task_loss;

static void task_loss_back(void *context)
{
    const task_loss *l = context;
    real *to = learn_gradient(l->positions), factor = *l->loss->gradient;
    for (size_t i = 0; i < learn_size(l->positions); i++)
        to[i] += factor * (real)l->gradient[i];
}

/// log(x / best) plus `hinge` times its part above -margin; `slope` receives the derivative.
static double relative(double x, double best, double floor, const mesh_task_weights *weights, double *slope)
{
    double value = log((x + floor) / (best + floor)), above = fmax(value + weights->margin, 0);
    *slope = (above > 0 ? 1 + weights->hinge : 1) / (x + floor);
    return value + weights->hinge * above;
}

static double between(const double ends[2], double fairness)
{
    return ends[0] * pow(ends[1] / ends[0], fairness);
}

learn_array *mesh_task_loss(learn_tape *tape, const mesh_task *task, double fairness, const mesh_task_weights *weights,
                            size_t samples, bat_random *random, mesh_fit *fit)
{
    mesh_learned_input input = {&task->levels, task->rows, task->coarse.positions, &task->geometry};
    learn_array *positions = mesh_learned_refine(tape, &input, fairness);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    size_t numbers = learn_size(positions);
    learn_array *loss = learn_array_make(tape, 1, 1, true);
    double *at = learn_tape_memory(tape, numbers, sizeof *at),
           *gradient = learn_tape_memory(tape, numbers, sizeof *gradient);
    task_loss *context = learn_tape_memory(tape, 1, sizeof *context);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    for (size_t i = 0; i < numbers; i++)
        at[i] = (double)positions->value[i];
    memset(gradient, 0, numbers * sizeof *gradient);
    one_way ways[2] = {0};
    bool sound = measure(task, at, samples, random, ways, fit);
    if (sound)
    {
        double mean_slope, rms_slope, peak_slope, floor = DISTANCE_FLOOR * task->edge;
        double value = relative(fit->mean, task->best.mean, floor, weights, &mean_slope);
        value += weights->rms * relative(fit->rms, task->best.rms, floor, weights, &rms_slope);
        value += weights->peak * relative(fit->peak, task->best.peak, floor, weights, &peak_slope);
        for (int way = 0; way < 2; way++)
            one_way_back(&ways[way], 0.5 * mean_slope, 0.5 * weights->rms * rms_slope,
                         weights->peak * peak_slope * join_slope(ways[way].peak, fit->peak), gradient);
        double rough = between(weights->rough, fairness) / (task->best.roughness + ROUGH_FLOOR), measured;
        value += rough * fit->roughness;
        sound = measure_roughness(task, at, rough, &measured, gradient);
        double error = fit->volume, size = sqrt(error * error + VOLUME_FLOOR * VOLUME_FLOOR),
               full = between(weights->volume, fairness);
        value += full * size;
        (void)measure_volume(task, at, full * error / size, gradient);
        *loss->value = (real)value;
    }
    one_way_free(&ways[0]);
    one_way_free(&ways[1]);
    if (!sound)
    {
        tape->status = BAT_NO_MEMORY;
        return &tape->nothing;
    }
    *context = (task_loss){positions, loss, gradient};
    learn_tape_record(tape, loss, task_loss_back, context);
    return loss;
}
