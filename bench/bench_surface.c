// Scans to surfaces: the network against shape-preserving parameters, as published and as ours, and adaptive fits of a small
// and a large cloud. With the name of a model's file, of its network; else of the one that comes with the library.

#include "timing.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

enum
{
    ROUNDS = 11,
    SLOW_ROUNDS = 3,
    POINTS = 1000,
    SCAN_POINTS = 9000,
    SCAN_FUNCTIONS = 5000,
    LARGE_POINTS = 1000000,
    LARGE_FUNCTIONS = 20000
};

static void must(bat_status status, const bat_error *error)
{
    if (status == BAT_OK)
        return;
    (void)fprintf(stderr, "%s\n", error->text);
    exit(EXIT_FAILURE);
}

/// Seconds of this process's work, on all its threads, whatever else the machine does.
static double cpu_now(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double learned_seconds(const bat_surface_model *model, const bat_cloud *cloud, const double *truth, double *found)
{
    bat_error error;
    double begin = cpu_now();
    must(bat_surface_model_parameterize(model, cloud, truth, 1, found, &error), &error);
    return cpu_now() - begin;
}

static double classical_seconds(bool published, const bat_cloud *cloud, const double *truth, double *found)
{
    bat_error error;
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.published = published;
    options.threads = 1;
    double begin = cpu_now();
    must(bat_cloud_parameterize(cloud, truth, &options, found, &error), &error);
    return cpu_now() - begin;
}

/// All three on the same clean cloud, in turns.
static void compare_parameters(const bat_surface_model *model)
{
    bat_error error;
    bat_random random = bat_random_seed(1);
    bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
    options.interior = POINTS;
    bat_cloud cloud;
    double *truth, learned[ROUNDS], published[ROUNDS], own[ROUNDS];
    must(bat_cloud_bezier(&options, &random, &cloud, &truth, &error), &error);
    double *found = calloc(cloud.count, 2 * sizeof *found);
    for (int round = 0; round < ROUNDS && found != NULL; round++)
    {
        learned[round] = learned_seconds(model, &cloud, truth, found);
        published[round] = classical_seconds(true, &cloud, truth, found);
        own[round] = classical_seconds(false, &cloud, truth, found);
    }
    double seconds = median_of(learned, ROUNDS);
    (void)printf("%d points by the network: %.2f ms on one thread; shape-preserving parameters take %.1f times as long as "
                 "published, %.2f times ours\n",
                 POINTS, 1e3 * seconds, median_of(published, ROUNDS) / seconds, median_of(own, ROUNDS) / seconds);
    free(found);
    free(truth);
    bat_cloud_free(&cloud);
}

/// A wavy sheet with noise, at random parameters that are given.
static void make_sheet(size_t count, double **points, double **parameters)
{
    bat_random random = bat_random_seed(2);
    *points = calloc(count, 3 * sizeof **points);
    *parameters = calloc(count, 2 * sizeof **parameters);
    if (*points == NULL || *parameters == NULL)
        exit(EXIT_FAILURE);
    for (size_t i = 0; i < count; i++)
    {
        double u = bat_random_uniform(&random), v = bat_random_uniform(&random);
        (*parameters)[2 * i] = u;
        (*parameters)[2 * i + 1] = v;
        (*points)[3 * i] = u;
        (*points)[3 * i + 1] = v;
        (*points)[3 * i + 2] =
            0.1 * sin(20 * u * (1 + v)) + 0.05 * exp(-2000 * pow(u - v, 2)) + 1e-4 * bat_random_normal(&random);
    }
}

/// One adaptive fit. Returns its seconds on the clock.
static double time_fit(const double *points, const double *start, size_t count, size_t wanted, bat_surface_fit_round *last,
                       double *cpu)
{
    bat_error error;
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.space.degree[0] = options.space.degree[1] = 2;
    options.functions = wanted;
    double *parameters = malloc(count * 2 * sizeof *parameters);
    if (parameters == NULL)
        exit(EXIT_FAILURE);
    memcpy(parameters, start, count * 2 * sizeof *parameters);
    bat_surface_fit_data data = {.points = points, .parameters = parameters, .count = count, .dimension = 3};
    bat_spline_surface surface;
    bat_surface_fit_report report;
    double begin = seconds_now(), work = cpu_now();
    must(bat_surface_fit(&data, &options, &surface, &report, &error), &error);
    double seconds = seconds_now() - begin;
    *cpu = cpu_now() - work;
    *last = report.rounds[report.count - 1];
    bat_surface_fit_report_free(&report);
    bat_spline_surface_free(&surface);
    free(parameters);
    return seconds;
}

static void compare_fits(size_t count, size_t functions, int rounds)
{
    double *points, *parameters, seconds[SLOW_ROUNDS], cpu[SLOW_ROUNDS];
    bat_surface_fit_round last = {0};
    make_sheet(count, &points, &parameters);
    for (int round = 0; round < rounds; round++)
        seconds[round] = time_fit(points, parameters, count, functions, &last, &cpu[round]);
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    (void)printf(
        "adaptive fit of %zu points to %zu functions: %.2f s, %.2f s of work on all threads, root mean square %.2g; "
        "peak memory so far %.2f GiB\n",
        count, last.functions, median_of(seconds, (size_t)rounds), median_of(cpu, (size_t)rounds), last.rms,
        (double)usage.ru_maxrss / (1 << 20));
    free(points);
    free(parameters);
}

int main(int argc, char **argv)
{
    bat_error error;
    bat_surface_model *model;
    must(bat_surface_model_read_published(argc > 1 ? argv[1] : NULL, &model, &error), &error);
    compare_parameters(model);
    bat_surface_model_free(model);
    compare_fits(SCAN_POINTS, SCAN_FUNCTIONS, SLOW_ROUNDS);
    compare_fits(LARGE_POINTS, LARGE_FUNCTIONS, 1);
    return EXIT_SUCCESS;
}
