// A scan without order or boundary becomes a spline surface for CAD.
//
//     cc fit_surface.c $(pkg-config --cflags --libs batten) -lm && ./a.out [IN.xyz [OUT.step [PICTURE.png]]]

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    SCAN_POINTS = 3000, ///< of a scan of our own making, where no file is given
};

static const double TOLERANCE = 0.002; ///< of 95 of 100 points, in units of the cloud

/// Points in no order on a wavy sheet: heights over random places of a square.
static bat_status make_scan(bat_cloud *cloud)
{
    *cloud = (bat_cloud){.points = malloc(3 * SCAN_POINTS * sizeof *cloud->points), .count = SCAN_POINTS};
    if (cloud->points == NULL)
        return BAT_NO_MEMORY;
    bat_random random = bat_random_seed(1);
    for (size_t i = 0; i < cloud->count; i++)
    {
        double x = bat_random_uniform(&random), y = bat_random_uniform(&random);
        cloud->points[3 * i] = x;
        cloud->points[3 * i + 1] = y;
        cloud->points[3 * i + 2] = 0.1 * sin(5 * x) * cos(4 * y) + 0.2 * x * y;
    }
    return BAT_OK;
}

static void print_report(const bat_cloud *cloud, const bat_surface_result *result)
{
    const bat_surface_fit_round *last = &result->report.rounds[result->report.count - 1];
    printf("%zu points, %zu of them on the boundary that was found\n", cloud->count, cloud->boundary_count);
    for (size_t i = 0; i < result->candidate_count; i++)
    {
        const bat_surface_candidate *candidate = &result->candidates[i];
        const char *name = bat_choice_name(&bat_surface_parameters_family, candidate->parameters);
        if (candidate->failure.status == BAT_OK)
            printf("%s parameters: %zu functions, mean squared distance %.3g\n", name, candidate->functions,
                   candidate->mean_squared);
        else
            printf("%s parameters: %s\n", name, candidate->failure.text);
    }
    printf("%s parameters, %zu functions: %.1f %% within the tolerance, largest distance %.3g\n",
           bat_choice_name(&bat_surface_parameters_family, result->chosen), last->functions, 100 * last->within,
           last->largest);
}

static bat_status draw(const char *path, const bat_cloud *cloud, const bat_surface_result *result, bat_error *error)
{
    bat_surface_picture_row panel = {.cloud = cloud,
                                     .surface = &result->surface,
                                     .distances = result->report.distances,
                                     .parameters = result->parameters};
    return bat_surface_picture_write(path, &panel, 1, NULL, error);
}

int main(int argc, char **argv)
{
    bat_cloud cloud = {0};
    bat_surface_result result = {0};
    bat_error error = {.text = "out of memory"};
    bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
    options.fit.tolerance = TOLERANCE;
    options.fit.share = 0.95;
    bat_status status = argc > 1 ? bat_cloud_read(argv[1], NULL, &cloud, &error) : make_scan(&cloud);
    if (status == BAT_OK)
        status = bat_surface_reconstruct(&cloud, &options, &result, &error);
    if (status == BAT_OK)
        print_report(&cloud, &result);
    if (status == BAT_OK && argc > 2)
        status = bat_surface_write(argv[2], &result.surface, NULL, &error);
    if (status == BAT_OK && argc > 3)
        status = draw(argv[3], &cloud, &result, &error);
    if (status != BAT_OK)
        fprintf(stderr, "%s\n", error.text);

    bool good = status == BAT_OK && (argc > 1 || result.report.reached);
    bat_surface_result_free(&result);
    bat_cloud_free(&cloud);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
