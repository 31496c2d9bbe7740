// Adaptive fits against bounds that any such fit has: one factorization of the last system for small ones, as many
// evaluations of the surface and its derivatives at all points as there are rounds for large ones.
//
//   bench_surface_fit [POINTS FUNCTIONS]...     the default is 1000 0 9000 5000 1000000 20000

#include "timing.h"

#include "batten/surface_fit.h"
#include "surface/fit/system.h"

#include <math.h>
#include <stdio.h>
#include <sys/resource.h>

static void hills(double u, double v, double *point)
{
    point[0] = u + 0.05 * sin(4 * v);
    point[1] = v;
    point[2] = 0.1 * sin(9 * u * u + 3 * v) + 0.03 * tanh(60 * (u + v * v - 1.1)) + 0.02 * sin(60 * u * v);
}

/// A noisy cloud whose parameters are a little off.
static bool make_cloud(size_t count, bat_surface_fit_data *data, double **points)
{
    bat_random random = bat_random_seed(6);
    *points = malloc(3 * count * sizeof **points);
    double *parameters = malloc(2 * count * sizeof *parameters);
    *data = (bat_surface_fit_data){.points = *points, .parameters = parameters, .count = count, .dimension = 3};
    if (*points == NULL || parameters == NULL)
        return false;
    for (size_t i = 0; i < count; i++)
    {
        double u = bat_random_uniform(&random), v = bat_random_uniform(&random);
        hills(u, v, *points + 3 * i);
        for (size_t k = 0; k < 3; k++)
            (*points)[3 * i + k] += 1e-4 * bat_random_normal(&random);
        parameters[2 * i] = u + 0.05 * u * (1 - u) * sin(9 * v);
        parameters[2 * i + 1] = v + 0.05 * v * (1 - v) * cos(7 * u);
    }
    return true;
}

/// Seconds of one factorization of the equations of the result.
static double seconds_to_factor(const bat_spline_surface *surface)
{
    fit_system system;
    fit_solver *solver = NULL;
    double pivot, start = NAN;
    bat_status status = fit_system_make(surface->space, NULL, surface->dimension, true, 0, &system, NULL);
    if (status == BAT_OK)
        status = fit_solver_make(&system.pattern, &solver, NULL);
    for (size_t f = 0; status == BAT_OK && f < system.functions; f++)
        system.plate[system.pattern.first[f]] *= 1.001;
    if (status == BAT_OK)
    {
        start = seconds_now();
        status = fit_solver_factor(solver, system.plate, &pivot, NULL);
    }
    double seconds = seconds_now() - start;
    fit_solver_free(solver);
    fit_system_free(&system);
    return status == BAT_OK ? seconds : NAN;
}

static double seconds_to_evaluate(const bat_spline_surface *surface, const bat_surface_fit_data *data)
{
    double *values = malloc(18 * data->count * sizeof *values), start = seconds_now();
    if (values == NULL || bat_spline_surface_evaluate(surface, data->parameters, data->count, 2, values, NULL) != BAT_OK)
        start = NAN;
    double seconds = seconds_now() - start;
    free(values);
    return seconds;
}

static double peak_megabytes(void)
{
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss / 1024;
}

static int run(size_t count, size_t functions)
{
    bat_surface_fit_data data;
    double *points;
    bat_error error;
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.space.degree[0] = options.space.degree[1] = 2;
    options.functions = functions;
    bat_spline_surface surface;
    bat_surface_fit_report report;
    if (!make_cloud(count, &data, &points))
        return 1;
    double start = seconds_now();
    if (bat_surface_fit(&data, &options, &surface, &report, &error) != BAT_OK)
    {
        fprintf(stderr, "bench_surface_fit: %s\n", error.text);
        return 1;
    }
    double seconds = seconds_now() - start, peak = peak_megabytes();
    const bat_surface_fit_round *last = &report.rounds[report.count - 1];
    double factor = seconds_to_factor(&surface), evaluate = seconds_to_evaluate(&surface, &data);
    printf("%8zu points to %6zu functions in %zu rounds, rms %.2e: %.2f s, %.0f MB\n", count, last->functions, report.count,
           last->rms, seconds, peak);
    printf("         %6.1f factorizations of the last system\n", seconds / factor);
    printf("         %6.1f evaluations with two derivatives of all points, %.1f a round\n", seconds / evaluate,
           seconds / evaluate / (double)report.count);
    bat_surface_fit_report_free(&report);
    bat_spline_surface_free(&surface);
    free(points);
    free(data.parameters);
    return 0;
}

int main(int argc, char **argv)
{
    int failed = 0;
    for (int k = 1; k + 1 < argc; k += 2)
        failed |= run(strtoul(argv[k], NULL, 10), strtoul(argv[k + 1], NULL, 10));
    if (argc < 3)
        failed = run(1000, 0) | run(9000, 5000) | run(1000000, 20000);
    return failed;
}
