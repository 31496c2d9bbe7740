#include "batten/curve_measure.h"

#include "base/choice.h"
#include "base/exact_sum.h"
#include "base/option.h"
#include "base/progress.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/measure/metric_tree.h"
#include "curve/polygon.h"
#include "space/builtin.h"

#include <string.h>

/// The power of two that the numbers are summed up with, so that neither sums nor squares leave the range.
static double scale_for(const double *values, size_t count)
{
    double largest = vector_largest(count, values);
    int exponent;
    if (!isfinite(largest))
        return 1;
    (void)frexp(largest, &exponent);
    return ldexp(1, exponent < -1000 ? 1000 : -exponent);
}

bat_status bat_curve_summarize(const double *values, size_t count, bat_curve_summary *summary, bat_error *error)
{
    if (count == 0)
        return ERROR_ARGUMENT(error, "there are no numbers to summarize");
    for (size_t i = 0; i < count; i++)
        if (isnan(values[i]))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "number %zu of the set is not a number", i);
    double sum = 0, squares = 0, scale = scale_for(values, count);
    for (size_t i = 0; i < count; i++)
        sum += values[i] * scale;
    double mean = sum / (double)count;
    for (size_t i = 0; i < count; i++)
        squares += (values[i] * scale - mean) * (values[i] * scale - mean);
    double *sorted = memory_array(count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, count * sizeof *sorted);
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, ascending);
    *summary = (bat_curve_summary){.count = count,
                                   .mean = mean / scale,
                                   .deviation = sqrt(squares / (double)count) / scale,
                                   .median = sorted[(count - 1) / 2] / 2 + sorted[count / 2] / 2,
                                   .least = sorted[0],
                                   .greatest = sorted[count - 1]};
    free(sorted);
    return BAT_OK;
}

/// Spaces multiply the lengths of the two edges on their way to a signed angle; outside of this range they lose digits.
static const double MIN_PRODUCT = 1e-250, MAX_PRODUCT = 1e250;

/// The absolute exterior angle at p between its neighbours; `product` is that of the lengths of its edges.
static bat_status exterior_angle(const bat_space *space, const double *before, const double *p, const double *after,
                                 double product, double *angle)
{
    if (space->exterior_angle != NULL && product >= MIN_PRODUCT && product <= MAX_PRODUCT)
    {
        *angle = fabs(space->exterior_angle(space, before, p, after));
        return BAT_OK;
    }
    return polygon_exterior_angle(space, before, p, after, angle);
}

/// A walk along the vertices that differ from the one before.
typedef struct walk
{
    size_t before, here;  ///< the last two vertices
    double length_before; ///< of the edge between them
    size_t angles;        ///< vertices that had an angle
    double bending, g1;   ///< sum and maximum over them
    double length;        ///< of all edges so far
} walk;

static bat_status edge_length(const bat_curve *curve, size_t i, size_t next, double *length, bat_error *error)
{
    const bat_space *space = curve->space;
    *length = space->distance(space, curve_point(curve, i), curve_point(curve, next));
    if (!isfinite(*length))
        return error_set(error, BAT_INVALID_POINT, next, 0,
                         "the distance of point %zu from point %zu is too large for a double", next, i);
    double tangent[BAT_SPACE_MAX_DIM];
    if (*length >= space->injectivity &&
        space->log(space, curve_point(curve, i), curve_point(curve, next), tangent) != BAT_OK)
        return error_set(error, BAT_CUT_LOCUS, next, 0, "point %zu is antipodal to point %zu", next, i);
    return BAT_OK;
}

/// Go on to a vertex; the one left behind then has both its edges.
static bat_status walk_to(walk *walker, const bat_curve *curve, size_t next, double offset, bat_error *error)
{
    double length, angle;
    bat_status status = edge_length(curve, walker->here, next, &length, error);
    if (status != BAT_OK || length == 0)
        return status;
    walker->length += length;
    if (walker->length_before > 0)
    {
        status = exterior_angle(curve->space, curve_point(curve, walker->before), curve_point(curve, walker->here),
                                curve_point(curve, next), walker->length_before * length, &angle);
        if (status != BAT_OK)
            return error_set(error, status, walker->here, 0, "no unique geodesic at point %zu", walker->here);
        double curvature = angle / (walker->length_before / 2 + length / 2 + offset);
        walker->bending += curvature * curvature;
        walker->g1 = fmax(walker->g1, angle);
        walker->angles++;
    }
    if (!isfinite(walker->length) || !isfinite(walker->bending))
        return error_set(error, BAT_INVALID_POINT, walker->here, 0, "at point %zu the %s becomes too large for a double",
                         walker->here, isfinite(walker->length) ? "bending energy" : "length");
    walker->before = walker->here;
    walker->here = next;
    walker->length_before = length;
    return BAT_OK;
}

/// The first vertex that differs from vertex 0; 0 when there is none.
static size_t second_vertex(const bat_curve *curve)
{
    for (size_t i = 1; i < curve->count; i++)
        if (curve->space->distance(curve->space, curve_point(curve, 0), curve_point(curve, i)) > 0)
            return i;
    return 0;
}

bat_status bat_curve_fairness(const bat_curve *curve, const bat_curve_measure_options *options,
                              bat_curve_fairness_values *fairness, bat_error *error)
{
    double offset = options == NULL ? BAT_CURVE_BENDING_OFFSET : options->bending_offset;
    bat_status status = bat_options_check(&bat_curve_measure_fields, options, error);
    if (status == BAT_OK && curve->count == 0)
        status = ERROR_ARGUMENT(error, "the curve has no points");
    if (status == BAT_OK)
        status = bat_space_check(curve->space, curve->points, curve->count, error);
    walk walker = {0};
    for (size_t i = 1; i < curve->count && status == BAT_OK; i++)
        status = walk_to(&walker, curve, i, offset, error);
    if (curve->closed && status == BAT_OK)
        status = walk_to(&walker, curve, 0, offset, error);
    double total = walker.length;
    if (curve->closed && status == BAT_OK)
        status = walk_to(&walker, curve, second_vertex(curve), offset, error);
    if (status != BAT_OK)
        return status;
    double angles = walker.angles > 0 ? (double)walker.angles : 1;
    *fairness = (bat_curve_fairness_values){.bending = walker.bending / angles, .g1 = walker.g1, .length = total};
    return BAT_OK;
}

/// Queries that a thread takes at a time.
static const size_t BLOCK = 512;

bat_curve_measure_options bat_curve_measure_defaults(void)
{
    return (bat_curve_measure_options){.bending_offset = BAT_CURVE_BENDING_OFFSET};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_curve_measure_options, bending_offset, OPTION_NUMBER, 0, INFINITY),
    OPTION_THREADS(bat_curve_measure_options),
};

const bat_options_table bat_curve_measure_fields = OPTIONS_TABLE(bat_curve_measure_options, FIELDS, NULL);

static const bat_measure FAIRNESS[] = {
    MEASURE(bat_curve_fairness_values, bending, "bending energy", NUMBER),
    MEASURE(bat_curve_fairness_values, g1, "largest exterior angle", NUMBER),
    MEASURE(bat_curve_fairness_values, length, "length", NUMBER),
};

static const bat_measure DISTANCES[] = {
    MEASURE(bat_curve_distance, mean_nn, "mean nearest neighbour, A to B", NUMBER),
    MEASURE(bat_curve_distance, mean_nn_from_second, "mean nearest neighbour, B to A", NUMBER),
    MEASURE(bat_curve_distance, mean_symmetric, "mean nearest neighbour, both ways", NUMBER),
    MEASURE(bat_curve_distance, hausdorff_from_first, "greatest nearest neighbour, A to B", NUMBER),
    MEASURE(bat_curve_distance, hausdorff_from_second, "greatest nearest neighbour, B to A", NUMBER),
    MEASURE(bat_curve_distance, hausdorff, "Hausdorff distance", NUMBER),
    MEASURE(bat_curve_distance, farthest_from_first, "farthest point of A", COUNT),
    MEASURE(bat_curve_distance, farthest_from_second, "farthest point of B", COUNT),
};

bool bat_curve_measures(size_t curves, size_t index, bat_measure *measure)
{
    bool of_one = curves == 1 && index < sizeof FAIRNESS / sizeof *FAIRNESS;
    bool of_two = curves == 2 && index < sizeof DISTANCES / sizeof *DISTANCES;
    if (of_one || of_two)
        *measure = of_one ? FAIRNESS[index] : DISTANCES[index];
    return of_one || of_two;
}

/// What answers for a curve when asked for the nearest of its vertices or edges.
typedef struct finder
{
    const bat_curve *curve;
    bool geodesic;
    bool by_metric;     ///< ask `metric`, else `tree`
    nearest_tree tree;  ///< chordal distance; in the disk with weights that make it monotone in the geodesic one
    metric_tree metric; ///< any other space
} finder;

/// The disk: sinh^2(d(z, w) / 2) = |z - w|^2 / ((1 - |z|^2) (1 - |w|^2)), so that for a fixed z the nearest w is the one of
/// least |z - w|^2 / (1 - |w|^2).
static bat_status disk_tree(const bat_curve *curve, nearest_tree *tree, bat_error *error)
{
    double *weights = memory_array(curve->count, sizeof *weights);
    if (weights == NULL)
        return error_memory(error, curve->count * sizeof *weights);
    for (size_t i = 0; i < curve->count; i++)
        weights[i] = 1 / disk_complement(curve_point(curve, i));
    bat_status status = nearest_build(NEAREST_POINTS, curve->points, weights, curve->count, 2, tree, error);
    free(weights);
    return status;
}

/// The edges as pairs of points; of a single point an edge of length 0.
static bat_status edge_tree(const bat_curve *curve, nearest_tree *tree, bat_error *error)
{
    size_t dim = curve->space->point_dim, bytes = dim * sizeof(double);
    size_t edges = curve->closed || curve->count == 1 ? curve->count : curve->count - 1;
    double *ends = memory_array(edges, 2 * bytes);
    if (ends == NULL)
        return error_memory(error, edges * 2 * bytes);
    for (size_t i = 0; i < edges; i++)
    {
        memcpy(ends + 2 * i * dim, curve_point(curve, i), bytes);
        memcpy(ends + (2 * i + 1) * dim, curve_point(curve, (i + 1) % curve->count), bytes);
    }
    bat_status status = nearest_build(NEAREST_SEGMENTS, ends, NULL, edges, dim, tree, error);
    free(ends);
    return status;
}

static bat_status finder_make(const bat_curve *curve, const bat_curve_measure_options *options, finder *made,
                              bat_error *error)
{
    const bat_space *space = curve->space;
    *made = (finder){.curve = curve, .geodesic = options->geodesic};
    if (options->to_segments)
        return edge_tree(curve, &made->tree, error);
    if (!options->geodesic || space_is_euclidean(space) || space_is_sphere(space))
        return nearest_build(NEAREST_POINTS, curve->points, NULL, curve->count, space->point_dim, &made->tree, error);
    if (space_is_disk(space))
        return disk_tree(curve, &made->tree, error);
    made->by_metric = true;
    return metric_tree_build(space, curve->points, curve->count, &made->metric, error);
}

static double finder_distance(const finder *from, const double *point)
{
    if (from->by_metric)
        return metric_tree_find(&from->metric, point).distance;
    nearest_hit hit = nearest_find(&from->tree, point);
    const bat_space *space = from->curve->space;
    return from->geodesic ? space->distance(space, point, curve_point(from->curve, hit.item)) : hit.distance;
}

/// One way: mean, greatest, and where that is.
typedef struct one_way
{
    double mean, greatest;
    size_t farthest;
} one_way;

/// The mean of numbers from 0 to `greatest`. A power of two keeps their sum in range.
static double mean_of(const double *distances, size_t count, double greatest)
{
    int exponent;
    (void)frexp(greatest, &exponent);
    exponent = exponent < -1000 ? -1000 : exponent;
    double scale = ldexp(1, -exponent);
    exact_sum sum = {0};
    for (size_t i = 0; i < count; i++)
        sum_add(&sum, distances[i] * scale);
    return fmin(ldexp(sum_total(&sum) / (double)count, exponent), greatest);
}

static one_way reduce(const double *distances, size_t count)
{
    one_way result = {.greatest = -1};
    for (size_t i = 0; i < count; i++)
        if (distances[i] > result.greatest)
        {
            result.greatest = distances[i];
            result.farthest = i;
        }
    result.mean = mean_of(distances, count, result.greatest);
    return result;
}

static size_t blocks_of(const bat_curve *curve)
{
    return curve->count / BLOCK + (curve->count % BLOCK > 0);
}

/// The distances of all points; the blocks are the pieces of `work` from `first_piece` on.
static void measure_all(const finder *target, const bat_curve *from, int threads, double *distances, size_t first_piece,
                        shared_work *work)
{
    size_t blocks = blocks_of(from);
    threads = threads_for(threads, blocks);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t block = 0; block < blocks; block++)
    {
        if (!shared_work_wants(work, first_piece + block))
            continue;
        bat_error own;
        bat_status status = BAT_OK;
        size_t begin = block * BLOCK, end = from->count - begin < BLOCK ? from->count : begin + BLOCK;
        for (size_t i = begin; i < end && status == BAT_OK; i++)
        {
            distances[i] = finder_distance(target, curve_point(from, i));
            if (!isfinite(distances[i]))
                status = error_set(&own, BAT_INVALID_POINT, i, 0,
                                   "the distance of point %zu from the other curve is too large for a double", i);
        }
        shared_work_finish(work, first_piece + block, status, &own);
    }
}

/// `result` is filled in unless `work` has failed or is cancelled.
static bat_status compare_one_way(const bat_curve *from, const bat_curve *to, const bat_curve_measure_options *options,
                                  size_t first_piece, shared_work *work, one_way *result, bat_error *error)
{
    size_t end_piece = first_piece + blocks_of(from);
    if (!shared_work_wants(work, end_piece))
        return BAT_OK;
    double *distances = memory_array(from->count, sizeof *distances);
    if (distances == NULL)
        return error_memory(error, from->count * sizeof *distances);
    finder target;
    bat_status status = finder_make(to, options, &target, error);
    if (status == BAT_OK)
    {
        measure_all(&target, from, options->threads, distances, first_piece, work);
        if (shared_work_wants(work, end_piece))
            *result = reduce(distances, from->count);
        nearest_free(&target.tree);
        metric_tree_free(&target.metric);
    }
    free(distances);
    return status;
}

static bat_status check_points(const bat_curve *curve, const char *which, bool geodesic, bat_error *error)
{
    if (curve->count == 0)
        return ERROR_ARGUMENT(error, "the %s curve has no points", which);
    bat_status status = coordinates_check(curve, which, error);
    return status == BAT_OK && geodesic ? bat_space_check(curve->space, curve->points, curve->count, error) : status;
}

static bat_status check_pair(const bat_curve *first, const bat_curve *second, const bat_curve_measure_options *options,
                             bat_error *error)
{
    const bat_space *a = first->space, *b = second->space;
    if (options->geodesic && options->to_segments)
        return ERROR_UNSUPPORTED(error, 0, "distances to edges are chordal, not geodesic");
    if (a->point_dim != b->point_dim)
        return ERROR_ARGUMENT(error, "the first curve has %zu coordinates a point and the second %zu", a->point_dim,
                              b->point_dim);
    if (options->geodesic && (a->distance != b->distance || a->parameters != b->parameters))
        return ERROR_ARGUMENT(error, "the first curve lies in the space %s and the second in %s", a->name, b->name);
    bat_status status = error_operand(error, check_points(first, "first", options->geodesic, error), 0);
    return status == BAT_OK ? error_operand(error, check_points(second, "second", options->geodesic, error), 1) : status;
}

bat_status bat_curve_compare(const bat_curve *first, const bat_curve *second, const bat_curve_measure_options *options,
                             bat_curve_distance *distance, bat_error *error)
{
    bat_curve_measure_options defaults = bat_curve_measure_defaults();
    options = options == NULL ? &defaults : options;
    one_way there = {0}, back = {0};
    bat_status status = bat_options_check(&bat_curve_measure_fields, options, error);
    if (status == BAT_OK)
        status = check_pair(first, second, options, error);
    if (status != BAT_OK)
        return status;
    shared_work work = shared_work_make(blocks_of(first) + blocks_of(second), options->progress);
    status = compare_one_way(first, second, options, 0, &work, &there, error);
    if (status == BAT_OK)
        status = compare_one_way(second, first, options, blocks_of(first), &work, &back, error);
    if (status == BAT_OK)
        status = shared_work_end(&work, error);
    if (status != BAT_OK)
        return status;
    *distance = (bat_curve_distance){.mean_nn = there.mean,
                                     .mean_nn_from_second = back.mean,
                                     .mean_symmetric = there.mean / 2 + back.mean / 2,
                                     .hausdorff_from_first = there.greatest,
                                     .hausdorff_from_second = back.greatest,
                                     .hausdorff = fmax(there.greatest, back.greatest),
                                     .farthest_from_first = there.farthest,
                                     .farthest_from_second = back.farthest};
    return BAT_OK;
}

/// From this many curves for each thread on, threads share curves and not the points of each.
static const size_t CURVES_PER_THREAD = 4;

/// What is to be measured of every curve of a set.
typedef struct set_task
{
    const bat_curve *first, *second;
    bat_curve_measure_options options;
    bat_curve_distance *distances; ///< null for one of the others
    bat_curve_fairness_values *fairness;
    bool *simple;
} set_task;

static bat_status measure_curve(const set_task *task, size_t i, const bat_curve_measure_options *options, bat_error *error)
{
    if (task->simple != NULL)
        return bat_curve_is_simple(&task->first[i], &task->simple[i], error);
    return task->distances != NULL
               ? bat_curve_compare(&task->first[i], &task->second[i], options, &task->distances[i], error)
               : bat_curve_fairness(&task->first[i], options, &task->fairness[i], error);
}

/// One curve after the other, each with all threads.
static bat_status measure_in_turn(const set_task *task, size_t count, bat_error *error)
{
    double share = count > 0 ? 1 / (double)count : 1;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        progress_part part = {task->options.progress, (double)i * share, share};
        bat_curve_measure_options own = task->options;
        own.progress = progress_of_part(&part);
        status = error_curve(error, measure_curve(task, i, &own, error), i);
    }
    return status;
}

/// Threads share the curves.
static bat_status measure_together(const set_task *task, size_t count, bat_error *error)
{
    shared_work work = shared_work_make(count, task->options.progress);
    bat_curve_measure_options own = task->options;
    own.threads = 1;
    own.progress = (bat_progress){0};
    int threads = threads_for(task->options.threads, count);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < count; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error fault;
        bat_status status = error_curve(&fault, measure_curve(task, i, &own, &fault), i);
        shared_work_finish(&work, i, status, &fault);
    }
    return shared_work_end(&work, error);
}

static bat_status measure_set(set_task task, size_t count, const bat_curve_measure_options *options, bat_error *error)
{
    bat_status status = bat_options_check(&bat_curve_measure_fields, options, error);
    if (status != BAT_OK)
        return status;
    task.options = options != NULL ? *options : bat_curve_measure_defaults();
    size_t threads = (size_t)threads_for(task.options.threads, SIZE_MAX);
    return task.distances != NULL && count / CURVES_PER_THREAD < threads ? measure_in_turn(&task, count, error)
                                                                         : measure_together(&task, count, error);
}

bat_status bat_curves_compare(const bat_curve *first, const bat_curve *second, size_t count,
                              const bat_curve_measure_options *options, bat_curve_distance *distances, bat_error *error)
{
    return measure_set((set_task){.first = first, .second = second, .distances = distances}, count, options, error);
}

bat_status bat_curves_fairness(const bat_curve *curves, size_t count, const bat_curve_measure_options *options,
                               bat_curve_fairness_values *fairness, bat_error *error)
{
    return measure_set((set_task){.first = curves, .fairness = fairness}, count, options, error);
}

bat_status bat_curves_are_simple(const bat_curve *curves, size_t count, const bat_curve_measure_options *options,
                                 bool *simple, bat_error *error)
{
    return measure_set((set_task){.first = curves, .simple = simple}, count, options, error);
}

/// So many vertices may be missing: a map joins and drops a few points, other schemes move all.
static const int MAX_MISSED = 16;

/// By how much the way over a point may exceed a straight edge: a middle point is within 1/1400 of its length then.
static const double MAX_EXCESS = 1e-6;

size_t bat_curve_straight_edges(const bat_curve *coarse, const bat_curve *fine)
{
    const bat_space *space = coarse->space;
    size_t dim = space->point_dim, edges = polygon_edges(coarse->count, coarse->closed), straight = 0, row = 0, missed = 0;
    for (size_t j = 0; j < edges; j++)
    {
        const double *p = coarse->points + j * dim, *q = coarse->points + (j + 1) % coarse->count * dim;
        double length = space->distance(space, p, q);
        bool is_straight = true;
        size_t at = row + 1;
        for (; at < fine->count && memcmp(fine->points + at * dim, q, dim * sizeof *q) != 0; at++)
        {
            const double *x = fine->points + at * dim;
            is_straight =
                is_straight && space->distance(space, p, x) + space->distance(space, x, q) <= length * (1 + MAX_EXCESS);
        }
        if (at == fine->count && !(coarse->closed && j + 1 == edges))
        {
            if (++missed > MAX_MISSED)
                return straight;
            continue;
        }
        straight += is_straight;
        row = at;
    }
    return straight;
}
