#include "motion/hermite_average.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "space/builtin.h"

/// The number of points that a thread checks at a time.
static const size_t BLOCK = 1024;

void bat_hermite_free(bat_hermite_curve *curve)
{
    free(curve->points);
    free(curve->tangents);
    free(curve->times);
    *curve = (bat_hermite_curve){.space = curve->space};
}

bat_status hermite_allocate(bat_hermite_curve *curve, bool timed, bat_error *error)
{
    size_t point = curve->space->point_dim * sizeof(double), tangent = curve->space->tangent_dim * sizeof(double);
    curve->points = memory_array(curve->count, point);
    curve->tangents = memory_array(curve->count, tangent);
    curve->times = timed ? memory_array(curve->count, sizeof(double)) : NULL;
    bool whole = curve->points != NULL && curve->tangents != NULL && (curve->times != NULL || !timed);
    return whole ? BAT_OK : error_memory(error, curve->count * (point + tangent));
}

bat_status hermite_check_counts(const bat_hermite_curve *curve, bat_error *error)
{
    size_t minimum = curve->closed ? 3 : 2;
    if (curve->count < minimum)
        return error_operand(error,
                             ERROR_ARGUMENT(error, "%s curve needs at least %zu points, not %zu",
                                            curve->closed ? "a closed" : "an open", minimum, curve->count),
                             0);
    if (curve->points == NULL || curve->tangents == NULL)
        return ERROR_ARGUMENT(error, "a Hermite curve has points and tangents");
    return BAT_OK;
}

/// A vector is tangent at a point exactly when transport from the point to itself leaves it unchanged.
static bool is_tangent(const bat_space *space, const double *point, const double *tangent)
{
    double same[BAT_SPACE_MAX_DIM], largest = 0, change = 0;
    if (space->transport(space, point, point, tangent, same) != BAT_OK)
        return false;
    for (size_t i = 0; i < space->tangent_dim; i++)
    {
        largest = fmax(largest, fabs(tangent[i]));
        change = fmax(change, fabs(same[i] - tangent[i]));
    }
    return change <= BAT_HERMITE_TANGENT_TOLERANCE * largest;
}

static bat_status check_tangent(const bat_hermite_curve *curve, size_t index, bool unit, bat_error *error)
{
    const bat_space *space = curve->space;
    const double *point = hermite_point(curve, index), *tangent = hermite_tangent(curve, index);
    if (!vector_is_finite(space->tangent_dim, tangent))
        return error_set(error, BAT_INVALID_POINT, index, 0, "the tangent of point %zu is not finite", index);
    if (!is_tangent(space, point, tangent))
        return error_set(error, BAT_INVALID_POINT, index, 0, "the tangent of point %zu is not tangent to the %s", index,
                         space->name);
    double length = unit ? sqrt(space->inner(space, point, tangent, tangent)) : 1;
    if (!(fabs(length - 1) <= BAT_HERMITE_TANGENT_TOLERANCE))
        return error_set(error, BAT_INVALID_POINT, index, 0, "the direction of point %zu has length %.12g, not 1", index,
                         length);
    return BAT_OK;
}

static bat_status check_time(const bat_hermite_curve *curve, size_t index, bat_error *error)
{
    if (curve->times == NULL)
        return BAT_OK;
    if (!isfinite(curve->times[index]))
        return error_set(error, BAT_INVALID_POINT, index, 0, "the time of point %zu is not finite", index);
    if (index > 0 && !(curve->times[index] > curve->times[index - 1]))
        return error_set(error, BAT_INVALID_POINT, index, 0, "point %zu is not later than point %zu", index, index - 1);
    return BAT_OK;
}

static bat_status check_edge(const bat_hermite_curve *curve, size_t before, size_t index, bool admissible, bat_error *error)
{
    const bat_space *space = curve->space;
    const double *p = hermite_point(curve, before), *q = hermite_point(curve, index);
    double log[BAT_SPACE_MAX_DIM];
    if (space->log(space, p, q, log) != BAT_OK)
        return error_set(error, BAT_CUT_LOCUS, index, 0, "points %zu and %zu have no unique shortest geodesic", before,
                         index);
    if (!admissible)
        return BAT_OK;
    if (!(space->distance(space, p, q) > 0))
        return error_set(error, BAT_INVALID_POINT, index, 0, "point %zu repeats point %zu", index, before);
    hermite_edge edge;
    if (hermite_edge_measure(space, p, hermite_tangent(curve, before), q, hermite_tangent(curve, index), &edge) != BAT_OK)
        return error_set(error, BAT_INVALID_POINT, index, 0,
                         "the directions of points %zu and %zu turn too much: their angles with the edge sum to more than "
                         "%.4g",
                         before, index, BAT_HERMITE_ANGLE_LIMIT);
    return BAT_OK;
}

/// Check point `index` and, where the options say so, the edge that ends there.
static bat_status check_index(const bat_hermite_curve *curve, size_t index, hermite_check_parts parts, bat_error *error)
{
    const char *fault = curve->space->fault(curve->space, hermite_point(curve, index));
    if (fault != NULL)
        return error_set(error, BAT_INVALID_POINT, index, 0, "point %zu is %s", index, fault);
    bat_status status = check_tangent(curve, index, parts.unit, error);
    if (status == BAT_OK)
        status = check_time(curve, index, error);
    if (status == BAT_OK && parts.edges && index > 0)
        status = check_edge(curve, index - 1, index, parts.admissible, error);
    return status;
}

bat_status hermite_check(const bat_hermite_curve *curve, hermite_check_parts parts, int threads, bat_error *error)
{
    bat_status status = space_check_complete(curve->space, error);
    if (status == BAT_OK)
        status = hermite_check_counts(curve, error);
    if (status != BAT_OK)
        return status;
    shared_work work = shared_work_make((curve->count + BLOCK - 1) / BLOCK, (bat_progress){0});
    threads = threads_for(threads, work.total);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (size_t block = 0; block < work.total; block++)
    {
        bat_error fault;
        bat_status found = BAT_OK;
        size_t end = curve->count - block * BLOCK < BLOCK ? curve->count : (block + 1) * BLOCK;
        for (size_t i = block * BLOCK; i < end && found == BAT_OK; i++)
            found = check_index(curve, i, parts, &fault);
        shared_work_finish(&work, block, found, &fault);
    }
    status = shared_work_end(&work, error);
    if (status == BAT_OK && curve->closed && curve->times != NULL &&
        !(isfinite(curve->closing_time) && curve->closing_time > 0))
        return ERROR_ARGUMENT(error,
                              "a closed curve with times takes a positive time from its last point to its first, not %g",
                              curve->closing_time);
    if (status == BAT_OK && parts.edges && curve->closed)
        status = check_edge(curve, curve->count - 1, 0, parts.admissible, error);
    return status;
}

bat_status hermite_check_velocities(const bat_hermite_curve *curve, bat_error *error)
{
    if (curve->kind == BAT_HERMITE_TANGENTS_DIRECTIONS)
        return ERROR_ARGUMENT(
            error, "the tangents are directions of unit length, not velocities: estimate velocities from points and "
                   "times by bat_hermite_estimate_tangents(), or refine by bat_hermite_refine()");
    if (curve->kind == BAT_HERMITE_TANGENTS_INDEX_DERIVATIVES && curve->times != NULL)
        return ERROR_ARGUMENT(
            error, "the tangents are derivatives by the index, not velocities: divide them by the time between points");
    return BAT_OK;
}

bat_status bat_hermite_check(const bat_hermite_curve *curve, bat_error *error)
{
    return hermite_check(curve, (hermite_check_parts){.edges = true}, 1, error);
}

bat_status bat_hermite_normalize(bat_hermite_curve *curve, bat_error *error)
{
    const bat_space *space = curve->space;
    bat_status status = space_check_complete(space, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < curve->count; i++)
    {
        double *tangent = curve->tangents + i * space->tangent_dim;
        double length = sqrt(space->inner(space, hermite_point(curve, i), tangent, tangent));
        if (!(length > 0) || !isfinite(length))
            return error_set(error, BAT_INVALID_POINT, i, 0, "the tangent of point %zu has no direction", i);
        for (size_t c = 0; c < space->tangent_dim; c++)
            tangent[c] /= length;
    }
    curve->kind = BAT_HERMITE_TANGENTS_DIRECTIONS;
    return BAT_OK;
}
