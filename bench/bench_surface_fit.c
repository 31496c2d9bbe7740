// Adaptive fits against bounds that any such fit has: one factorization of the last system for small ones, as many
// evaluations of the surface and its derivatives at all points as there are rounds for large ones. With BATTEN_GPL, the
// multifrontal solver against both of CHOLMOD's.
//
//   bench_surface_fit [POINTS FUNCTIONS]...     the default is 1000 0 9000 5000 1000000 20000

#include "timing.h"

#include "batten/surface_fit.h"
#include "surface/fit/fit_solve.h"
#include "surface/fit/system.h"

#include <math.h>
#include <stdio.h>
#include <sys/resource.h>

#if defined(BATTEN_GPL)
#include "base/threads.h"
#include "linalg/blas_single.h"

#include <cholmod.h>
#endif

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

#if defined(BATTEN_GPL)
enum
{
    SOLVERS = 3, ///< supernodal, multifrontal, simplicial
    STEPS = 3,   ///< analysis, factorization, solution for all columns
    REPEATS = 11
};

static bool time_fit_solver(const fit_system *system, fit_factorization factorization, double *x, double seconds[STEPS])
{
    fit_solver *solver = NULL;
    double pivot, start = seconds_now();
    bool good = fit_solver_make_by(&system->pattern, factorization, &solver, NULL) == BAT_OK;
    seconds[0] = seconds_now() - start;
    start = seconds_now();
    good = good && fit_solver_factor(solver, system->plate, &pivot, NULL) == BAT_OK && pivot > 0;
    seconds[1] = seconds_now() - start;
    start = seconds_now();
    good = good && fit_solver_solve(solver, system->columns, x, x, NULL) == BAT_OK;
    seconds[2] = seconds_now() - start;
    fit_solver_free(solver);
    return good;
}

/// CHOLMOD's simplicial factorization, the part of it that is not under the GPL.
static bool time_simplicial(const fit_system *system, double *x, double seconds[STEPS])
{
    const fit_pattern *pattern = &system->pattern;
    size_t count = pattern->functions, columns = system->columns;
    cholmod_sparse matrix = {count,
                             count,
                             (size_t)pattern->first[count],
                             pattern->first,
                             pattern->row,
                             NULL,
                             system->plate,
                             NULL,
                             -1,
                             CHOLMOD_INT,
                             CHOLMOD_REAL,
                             CHOLMOD_DOUBLE,
                             1,
                             1};
    cholmod_dense right = {count, columns, count * columns, count, x, NULL, CHOLMOD_REAL, CHOLMOD_DOUBLE};
    cholmod_common common;
    (void)cholmod_start(&common);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_AMD;
    blas_single_begin();
    int levels = threads_alone_begin();
    double start = seconds_now();
    cholmod_factor *factor = cholmod_analyze(&matrix, &common);
    seconds[0] = seconds_now() - start;
    start = seconds_now();
    bool good = factor != NULL && cholmod_factorize(&matrix, factor, &common) && common.status == CHOLMOD_OK;
    seconds[1] = seconds_now() - start;
    start = seconds_now();
    cholmod_dense *solution = good ? cholmod_solve(CHOLMOD_A, factor, &right, &common) : NULL;
    seconds[2] = seconds_now() - start;
    threads_alone_end(levels);
    blas_single_end();
    good = solution != NULL;
    (void)cholmod_free_dense(&solution, &common);
    (void)cholmod_free_factor(&factor, &common);
    (void)cholmod_finish(&common);
    return good;
}

/// The solvers with the equations of the result, in turn.
static void compare_solvers(const bat_spline_surface *surface)
{
    fit_system system;
    double times[SOLVERS][STEPS][REPEATS], seconds[STEPS];
    bool good = fit_system_make(surface->space, NULL, surface->dimension, true, 0, &system, NULL) == BAT_OK;
    double *x = good ? malloc(system.functions * system.columns * sizeof *x) : NULL;
    for (size_t f = 0; good && f < system.functions; f++)
        system.plate[system.pattern.first[f]] *= 1.001;
    for (size_t k = 0; k < REPEATS && x != NULL && good; k++)
        for (size_t solver = 0; solver < SOLVERS && good; solver++)
        {
            for (size_t i = 0; i < system.functions * system.columns; i++)
                x[i] = (double)(i % 7);
            good = solver == 2 ? time_simplicial(&system, x, seconds)
                               : time_fit_solver(&system, solver == 0 ? FIT_SUPERNODAL : FIT_MULTIFRONTAL, x, seconds);
            for (size_t step = 0; step < STEPS; step++)
                times[solver][step][k] = seconds[step];
        }
    static const char *const names[SOLVERS] = {"supernodal", "multifrontal", "simplicial"};
    for (size_t solver = 0; solver < SOLVERS && x != NULL && good; solver++)
    {
        for (size_t step = 0; step < STEPS; step++)
        {
            seconds[step] = median_of(times[solver][step], REPEATS);
            times[solver][step][0] = seconds[step];
        }
        printf("         %-12s analysis %7.2f ms, factorization %7.2f ms, solution %6.2f ms", names[solver],
               1e3 * seconds[0], 1e3 * seconds[1], 1e3 * seconds[2]);
        printf(": %5.2f %5.2f %5.2f times the supernodal\n", seconds[0] / times[0][0][0], seconds[1] / times[0][1][0],
               seconds[2] / times[0][2][0]);
    }
    free(x);
    fit_system_free(&system);
}
#endif

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
#if defined(BATTEN_GPL)
    compare_solvers(&surface);
#endif
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
