// Parameters of clouds: neighbourhoods of each point's own and an iterative solution against the published way, a ball of
// one radius for all, Qhull's triangulation of each and a direct solution; and how time grows with the number of points.
// With BATTEN_GPL, the direct solution by the multifrontal method against UMFPACK's. Everything runs on one thread, in
// processor time.

#include "timing.h"

#include "batten/cloud_parameterize.h"
#include "batten/research/surface_shapes.h"

#if defined(BATTEN_GPL)
#include "linalg/average_system.h"
#include "surface/parameterize/weights.h"
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum
{
    CLOUDS = 15,
    POINTS = 1000,
    MANY_POINTS = 200000
};

static double seconds_spent(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/// Seconds for one cloud; NAN where it fails, as the published way may.
static double seconds_for(const bat_cloud *cloud, const double *boundary, bat_cloud_parameterization method, bool published,
                          double *parameters)
{
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.method = method;
    options.published = published;
    options.threads = 1;
    double start = seconds_spent();
    if (bat_cloud_parameterize(cloud, boundary, &options, parameters, NULL) != BAT_OK)
        return NAN;
    return seconds_spent() - start;
}

/// The median time over some clouds, in seconds; the clouds where it fails do not count.
static double median_seconds(size_t points, size_t clouds, bat_cloud_parameterization method, bool published)
{
    double times[CLOUDS];
    size_t count = 0;
    bat_random random = bat_random_seed(11);
    bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
    options.interior = points;
    for (size_t k = 0; k < clouds; k++)
    {
        bat_cloud cloud = {0};
        double *truth = NULL, *found = NULL;
        if (bat_cloud_bezier(&options, &random, &cloud, &truth, NULL) == BAT_OK)
            found = malloc(2 * cloud.count * sizeof *found);
        if (found != NULL)
            times[count] = seconds_for(&cloud, truth, method, published, found);
        count += found != NULL && isfinite(times[count]);
        bat_cloud_free(&cloud);
        free(truth);
        free(found);
    }
    return count > 0 ? median_of(times, count) : NAN;
}

#if defined(BATTEN_GPL)
/// The system of a cloud's interior points, whose rows are averages of all points. The rows change.
static bool split_system(const bat_cloud *cloud, const double *parameters, sparse_rows *rows, double **constant)
{
    size_t at = 0, begin = 0, boundary = cloud->boundary_count;
    *constant = calloc(rows->row_count, 2 * sizeof **constant);
    for (size_t i = 0; i < rows->row_count && *constant != NULL; i++)
    {
        size_t end = rows->starts[i + 1];
        for (size_t e = begin; e < end; e++)
            if (rows->columns[e] >= boundary)
            {
                rows->columns[at] = rows->columns[e] - (uint32_t)boundary;
                rows->values[at++] = rows->values[e];
            }
            else
                for (size_t c = 0; c < 2; c++)
                    (*constant)[2 * i + c] += rows->values[e] * parameters[2 * rows->columns[e] + c];
        begin = end;
        rows->starts[i + 1] = at;
    }
    rows->column_count = rows->row_count;
    return *constant != NULL;
}

/// Balls of the published radius, or stars.
static bat_status make_rows(const bat_cloud *cloud, bool balls, sparse_rows *rows)
{
    neighbour_tree tree;
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.threads = 1;
    bat_status status = neighbour_tree_build(cloud->points, cloud->count, &tree, NULL);
    if (status != BAT_OK)
        return status;
    double radius = 3 / sqrt((double)cloud->count) * weights_longest_side(cloud);
    weight_source source = {.cloud = cloud, .tree = &tree, .method = BAT_CLOUD_PARAMETERIZE_UNIFORM, .radius = radius};
    status =
        balls ? weights_build(&source, weights_of_ball, 1, rows, NULL) : weights_make(cloud, &tree, &options, rows, NULL);
    neighbour_tree_free(&tree);
    return status;
}

static void compare_solvers(size_t points, bool balls)
{
    enum
    {
        REPEATS = 5
    };
    double times[2][REPEATS], *truth = NULL, *constant = NULL, *x = malloc(2 * points * sizeof *x);
    bat_cloud cloud = {0};
    sparse_rows rows = {0};
    bat_random random = bat_random_seed(11);
    bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
    options.interior = points;
    bool good = x != NULL && bat_cloud_bezier(&options, &random, &cloud, &truth, NULL) == BAT_OK &&
                make_rows(&cloud, balls, &rows) == BAT_OK && split_system(&cloud, truth, &rows, &constant);
    size_t repeats = points > 10000 && balls ? 1 : REPEATS;
    for (size_t k = 0; k < repeats && good; k++)
        for (int umfpack = 0; umfpack < 2 && good; umfpack++)
        {
            double start = seconds_spent();
            good = (umfpack ? average_solve_umfpack : average_solve_multifrontal)(&rows, constant, x, NULL) == BAT_OK;
            times[umfpack][k] = seconds_spent() - start;
        }
    if (good)
    {
        double ours = median_of(times[0], repeats), umfpack = median_of(times[1], repeats);
        (void)printf("%zu averages of %.1f others: the multifrontal method in %.1f ms, %.2f times as long as UMFPACK\n",
                     points, (double)rows.starts[points] / (double)points, 1e3 * ours, ours / umfpack);
    }
    bat_cloud_free(&cloud);
    sparse_rows_free(&rows);
    free(truth);
    free(constant);
    free(x);
}
#endif

int main(void)
{
    for (int method = 0; method < BAT_CLOUD_PARAMETERIZE_MEAN_VALUE; method++)
    {
        bat_cloud_parameterization chosen = (bat_cloud_parameterization)method;
        double published = median_seconds(POINTS, CLOUDS, chosen, true),
               ours = median_seconds(POINTS, CLOUDS, chosen, false);
        double many = median_seconds(MANY_POINTS, 1, chosen, false);
        (void)printf("%s: %d points in %.2f ms, %.1f times as fast as published (%.1f ms); %d points take %.2f times as "
                     "long for each\n",
                     bat_cloud_parameterization_name(chosen), POINTS, 1e3 * ours, published / ours, 1e3 * published,
                     MANY_POINTS, many / MANY_POINTS / (ours / POINTS));
    }
#if defined(BATTEN_GPL)
    for (size_t points = 1000; points <= 100000; points *= 10)
        for (int balls = 0; balls < 2; balls++)
            compare_solvers(points, balls);
#endif
    return 0;
}
