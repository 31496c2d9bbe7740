// Parameters of clouds: neighbourhoods of each point's own and an iterative solution against the published way, a ball of
// one radius for all, Qhull's triangulation of each and a direct solution; and how time grows with the number of points.
// Everything runs on one thread, in processor time.

#include "timing.h"

#include "batten/cloud_parameterize.h"
#include "batten/research/surface_shapes.h"

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

int main(void)
{
    for (int method = BAT_CLOUD_PARAMETERIZATION_UNIFORM; method < BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE; method++)
    {
        bat_cloud_parameterization chosen = (bat_cloud_parameterization)method;
        double published = median_seconds(POINTS, CLOUDS, chosen, true),
               ours = median_seconds(POINTS, CLOUDS, chosen, false);
        double many = median_seconds(MANY_POINTS, 1, chosen, false);
        (void)printf("%s: %d points in %.2f ms, %.1f times as fast as published (%.1f ms); %d points take %.2f times as "
                     "long for each\n",
                     bat_choice_name(&bat_cloud_parameterization_family, chosen), POINTS, 1e3 * ours, published / ours,
                     1e3 * published, MANY_POINTS, many / MANY_POINTS / (ours / POINTS));
    }
    return 0;
}
