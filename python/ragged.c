// Part of the module batten._native: small calls without structs, many curves whose points lie one behind the other, many
// points of shells, and reports of progress.

#include <math.h>
#include <string.h>
#include <time.h>

/// The function in Python, which cffi defines below.
static bool batten_report(void *context, double fraction);

/// Whether someone sees the progress of the calls of a thread.
static _Thread_local bool batten_eager;

static void batten_set_eager(bool eager)
{
    batten_eager = eager;
}

/// Report to Python, but at most fifty times a second where it is for Ctrl-C alone: a call of Python takes microseconds.
static bool batten_report_seldom(void *context, double fraction)
{
    static _Thread_local double last;
    struct timespec now;
    if (!batten_eager)
    {
        (void)clock_gettime(CLOCK_MONOTONIC, &now);
        double seconds = (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
        if (seconds < last + 0.02)
            return true;
        last = seconds;
    }
    return batten_report(context, fraction);
}

/// A refined curve, and what became of it.
typedef struct batten_refined
{
    bat_curve curve;
    bat_curve_refine_report report;
} batten_refined;

/// bat_curve_refine() with a report, of a curve given by its parts.
static bat_status batten_refine(const bat_space *space, const double *points, size_t count, bool closed,
                                const double *channels, size_t channel_count, const unsigned char *corners,
                                const bat_curve_refine_options *options, batten_refined *refined, bat_error *error)
{
    bat_curve coarse = {.space = space,
                        .points = (double *)points,
                        .count = count,
                        .closed = closed,
                        .channels = (double *)channels,
                        .channel_count = channel_count,
                        .corners = (unsigned char *)corners};
    bat_curve_refine_options how = *options;
    how.report = &refined->report;
    return bat_curve_refine(&coarse, &how, &refined->curve, error);
}

/// bat_motion_spline_sample() at one time.
///
/// @param scalar_last change a quaternion from (w, x, y, z) to (x, y, z, w), normalized by the operations of scipy
static bat_status batten_pose(const bat_motion_spline *spline, double time, bool scalar_last, double *pose, bat_error *error)
{
    bat_status status = bat_motion_spline_sample(spline, &time, 1, pose, NULL, NULL, error);
    if (status != BAT_OK || !scalar_last)
        return status;
    double w = pose[0], x = pose[1], y = pose[2], z = pose[3], norm = sqrt(x * x + y * y + z * z + w * w);
    pose[0] = x / norm;
    pose[1] = y / norm;
    pose[2] = z / norm;
    pose[3] = w / norm;
    return BAT_OK;
}

/// The share of the curves of a part in the progress of all.
typedef struct part_progress
{
    bat_progress whole;
    double begin, share;
} part_progress;

static bool report_part(void *context, double fraction)
{
    const part_progress *part = context;
    return part->whole.report(part->whole.context, part->begin + part->share * fraction);
}

/// Make room for `need` numbers. The room grows to what all curves take if the rest grow as those before.
static bool reserve(double **points, size_t *capacity, size_t need, double share)
{
    if (need <= *capacity)
        return true;
    const double margin = 1.01;
    double guess = margin * (double)need / share;
    size_t room = guess > (double)need && guess < (double)(SIZE_MAX / sizeof **points) ? (size_t)guess : need;
    double *grown = realloc(*points, room * sizeof *grown);
    if (grown == NULL)
        return false;
    *points = grown;
    *capacity = room;
    return true;
}

/// bat_curves_refine() of curves in two arrays: curve i has the points offsets[i] … offsets[i + 1] - 1 of `all`. Parts of
/// the curves are refined one after the other, so that beyond the result memory for one part is needed.
///
/// @param all          the space, all points, and whether each curve is closed
/// @param offsets      count + 1 numbers, the first 0, none below the one before
/// @param points       receives the refined points; release it with free()
/// @param fine_offsets receives count + 1 numbers
/// @return as bat_curves_refine(); `points` is null on failure
static bat_status batten_refine_ragged(const bat_curve *all, const int64_t *offsets, size_t count,
                                       const bat_curve_refine_options *options, double **points, int64_t *fine_offsets,
                                       bat_error *error)
{
    enum
    {
        PART = 2048,
    };
    static bat_curve_refine_report none;
    size_t dim = all->space->point_dim, used = 0, capacity = 0;
    bat_curve *coarse = calloc(PART, sizeof *coarse), *fine = calloc(PART, sizeof *fine);
    bat_status status = coarse == NULL || fine == NULL ? BAT_NO_MEMORY : BAT_OK;
    bat_curve_refine_report sum = none;
    *points = NULL;
    fine_offsets[0] = 0;
    error->curve = BAT_NO_INDEX;
    for (size_t begin = 0; begin < count && status == BAT_OK; begin += PART)
    {
        size_t size = count - begin < PART ? count - begin : PART;
        bat_curve_refine_options how = *options;
        bat_curve_refine_report report = none;
        part_progress part = {options->progress, (double)begin / (double)count, (double)size / (double)count};
        how.report = &report;
        if (how.progress.report != NULL)
            how.progress = (bat_progress){report_part, &part};
        for (size_t i = 0; i < size; i++)
        {
            const int64_t *range = offsets + begin + i;
            coarse[i] = *all;
            coarse[i].points = all->points + (size_t)range[0] * dim;
            coarse[i].count = (size_t)(range[1] - range[0]);
            fine[i] = (bat_curve){0};
        }
        status = bat_curves_refine(coarse, size, &how, fine, error);
        if (status != BAT_OK)
        {
            if (error->curve != BAT_NO_INDEX)
                error->curve += begin;
            break;
        }
        for (size_t i = 0; i < size; i++)
            fine_offsets[begin + i + 1] = fine_offsets[begin + i] + (int64_t)fine[i].count;
        if (!reserve(points, &capacity, (size_t)fine_offsets[begin + size] * dim, (double)(begin + size) / (double)count))
            status = BAT_NO_MEMORY;
        for (size_t i = 0; i < size; i++)
        {
            if (status == BAT_OK)
                memcpy(*points + used, fine[i].points, fine[i].count * dim * sizeof **points);
            used += fine[i].count * dim;
            bat_curve_free(&fine[i]);
        }
        sum.given_crossing += report.given_crossing;
        sum.left_crossing += report.left_crossing;
    }
    free(coarse);
    free(fine);
    if (status == BAT_OK)
    {
        if (options->report != NULL)
            *options->report = sum;
        return status;
    }
    free(*points);
    *points = NULL;
    if (status == BAT_NO_MEMORY && error != NULL)
        *error = (bat_error){.status = status, .index = BAT_NO_INDEX, .text = "out of memory"};
    return status;
}

/// The number of points of all curves of a set, which batten_set_arrays() does not exceed.
static size_t batten_set_points(const bat_curve_set *set)
{
    size_t sum = 0;
    for (size_t i = 0; i < set->count; i++)
        sum += set->curves[i].count;
    return sum;
}

static bool same_place(const double *a, const double *b)
{
    return a[0] == b[0] && a[1] == b[1];
}

/// Leave out positions that are equal to the one before, unless too few of a line or of a ring would remain.
/// @return the number of those that are left
static size_t merged(double *positions, size_t count, bool closed)
{
    size_t end = count, left = 0, least = closed ? 3 : 2;
    while (closed && end > 1 && same_place(positions + 2 * (end - 1), positions))
        end--;
    for (size_t k = 0; k < end; k++)
        left += k == 0 || !same_place(positions + 2 * k, positions + 2 * (k - 1));
    if (left == count || left < least)
        return count;
    size_t to = 1;
    for (size_t k = 1; k < end; k++)
        if (!same_place(positions + 2 * k, positions + 2 * (to - 1)))
        {
            memmove(positions + 2 * to, positions + 2 * k, 2 * sizeof *positions);
            to++;
        }
    return to;
}

/// Copy the curves of a set to arrays.
///
/// @param decimals of longitudes and latitudes in degrees, which points of the sphere become; -1: points stay as they are.
///                 Rounded like those in files (src/space/degrees.h), so that both are equal to the last bit, and merged
///                 where the rounding makes neighbours equal
/// @param points   receives the points of all curves
/// @param offsets  receives count + 1 numbers
/// @param closed   receives a flag for each curve
/// @param polygon  receives the polygon of each curve, feature its feature; -1 for none
static void batten_set_arrays(const bat_curve_set *set, int decimals, double *points, int64_t *offsets, bool *closed,
                              int64_t *polygon, int64_t *feature)
{
    static const double degrees_per_radian = 57.295779513082320876798154814105;
    size_t dim = decimals < 0 ? set->space->point_dim : 2;
    double units = 1;
    for (int i = 0; i < decimals; i++)
        units *= 10;
    offsets[0] = 0;
    for (size_t i = 0; i < set->count; i++)
    {
        const bat_curve *curve = &set->curves[i];
        size_t of[2];
        bool bounds = bat_curve_set_polygon(set, i, &of[0], &of[1]);
        double *out = points + (size_t)offsets[i] * dim;
        if (decimals < 0)
            memcpy(out, curve->points, curve->count * dim * sizeof *points);
        for (size_t k = 0; decimals >= 0 && k < curve->count; k++)
        {
            const double *point = curve->points + 3 * k;
            double across = sqrt(point[0] * point[0] + point[1] * point[1]);
            out[2 * k] = rint(atan2(point[1], point[0]) * (degrees_per_radian * units)) / units;
            out[2 * k + 1] = rint(atan2(point[2], across) * (degrees_per_radian * units)) / units;
        }
        offsets[i + 1] = offsets[i] + (int64_t)(decimals < 0 ? curve->count : merged(out, curve->count, curve->closed));
        closed[i] = curve->closed;
        polygon[i] = bounds ? (int64_t)of[0] : -1;
        feature[i] = bounds ? (int64_t)of[1] : -1;
    }
}

/// bat_shell_evaluate() at many places.
///
/// @param faces   count numbers
/// @param places  count x 2: u and v
/// @param points  receives count x 3
/// @param normals receives count x 3
/// @return as bat_shell_evaluate(); the error has the index of the place
static bat_status batten_shell_evaluate(const bat_shell *shell, const int64_t *faces, const double *places, size_t count,
                                        double *points, double *normals, bat_error *error)
{
    bat_status status = BAT_OK;
    size_t i = 0;
    for (; i < count && status == BAT_OK; i++)
        status = bat_shell_evaluate(shell, faces[i] < 0 ? SIZE_MAX : (size_t)faces[i], places[2 * i], places[2 * i + 1],
                                    points + 3 * i, normals + 3 * i, error);
    if (status != BAT_OK)
        error->index = i - 1;
    return status;
}
