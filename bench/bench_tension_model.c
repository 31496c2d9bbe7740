// Refining by a learned scheme: a short curve many times, and a long one once, against the bare products of its network's layers
// in turn in one run.

#include "timing.h"

#include "batten/curve.h"
#include "batten/tension_model.h"
#include "learn/blas.h"
#include "models/tension_network.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum
{
    SHORT_POINTS = 12,
    SHORT_LEVELS = 4,
    SHORT_ROUNDS = 401,
    LONG_POINTS = 1000000,
    LONG_ROUNDS = 3,
    PRODUCT_ROWS = 512,
};

/// A closed curve on the sphere with all kinds of angles.
static bat_curve make_curve(const bat_space *sphere, size_t count)
{
    bat_curve curve = {.space = sphere, .count = count, .closed = true, .points = malloc(3 * count * sizeof(double))};
    for (size_t i = 0; i < count && curve.points != NULL; i++)
    {
        double t = 6.28318530717958647692 * (double)i / (double)count, height = 0.4 * sin(3 * t) + 0.2 * cos(7 * t);
        double radius = sqrt(1 - height * height);
        curve.points[3 * i] = radius * cos(t);
        curve.points[3 * i + 1] = radius * sin(t);
        curve.points[3 * i + 2] = height;
    }
    return curve;
}

/// A model of random weights, by way of a file.
static bat_tension_model *make_model(void)
{
    char path[] = "/tmp/bench_tension_model_XXXXXX";
    int file = mkstemp(path);
    learn_parameters parameters = {0};
    bat_tension_model *model = NULL;
    if (file < 0)
        return NULL;
    (void)close(file);
    if (tension_network_make(&parameters, NULL) == BAT_OK)
    {
        tension_network_start(&parameters, 1);
        if (learn_parameters_write(&parameters, path, NULL, 0, NULL) == BAT_OK)
            (void)bat_tension_model_read(path, &model, NULL);
    }
    learn_parameters_free(&parameters);
    (void)unlink(path);
    return model;
}

/// Seconds to refine into memory that is there.
static double time_refinement(const bat_curve *curve, const bat_refine_options *options, double *fine)
{
    size_t count = curve->count << options->levels;
    double start = seconds_now();
    bat_status status = bat_curve_refine_into(curve, options, fine, NULL, count, NULL);
    return status == BAT_OK ? seconds_now() - start : 1e9;
}

/// The products of all layers for as many rows as suit BLAS.
static void run_products(const learn_parameters *parameters, const real *left, const real *right, real *result)
{
    for (size_t i = TENSION_AT_INPUT_LINEAR; i < parameters->count; i++)
    {
        const learn_parameter *p = &parameters->list[i];
        if (p->rank == 2)
            REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasTrans, PRODUCT_ROWS, (int)p->rows, (int)p->columns, 1, left,
                      (int)p->columns, right, (int)p->columns, 0, result, (int)p->rows);
    }
}

/// The bare rate on one thread in rows a second, over about as long as the refinement takes.
static double product_rate(void)
{
    enum
    {
        ROUNDS = LONG_POINTS / PRODUCT_ROWS,
        NUMBERS = PRODUCT_ROWS * TENSION_WIDTH
    };
    double rate = 0;
    learn_parameters parameters = {0};
    real *left = calloc(3 * NUMBERS, sizeof *left);
    if (left != NULL && tension_network_make(&parameters, NULL) == BAT_OK)
    {
        for (size_t k = 0; k < 2 * NUMBERS; k++)
            left[k] = (real)(k % 7);
        blas_single_begin();
        double start = seconds_now();
        for (int round = 0; round < ROUNDS; round++)
            run_products(&parameters, left, left + NUMBERS, left + 2 * NUMBERS);
        rate = (double)ROUNDS * PRODUCT_ROWS / (seconds_now() - start);
        blas_single_end();
    }
    free(left);
    learn_parameters_free(&parameters);
    return rate;
}

static void time_short(const bat_space *sphere, bat_refine_options options)
{
    double seconds[SHORT_ROUNDS], fine[3 * (SHORT_POINTS << SHORT_LEVELS)];
    bat_curve curve = make_curve(sphere, SHORT_POINTS);
    options.levels = SHORT_LEVELS;
    for (int round = 0; round < SHORT_ROUNDS; round++)
        seconds[round] = time_refinement(&curve, &options, fine);
    (void)printf("%d vertices by %d levels: %.3f ms\n", SHORT_POINTS, SHORT_LEVELS, 1e3 * median_of(seconds, SHORT_ROUNDS));
    bat_curve_free(&curve);
}

static long resident_peak(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_maxrss : 0;
}

static void time_long(const bat_space *sphere, bat_refine_options options)
{
    const size_t bytes = 2 * 3 * (size_t)LONG_POINTS * sizeof(double);
    bat_curve curve = make_curve(sphere, LONG_POINTS);
    double *fine = malloc(bytes);
    options.levels = 1;
    if (curve.points != NULL && fine != NULL)
        memset(fine, 0, bytes);
    for (int threads = 1; threads <= 2 && curve.points != NULL && fine != NULL; threads++)
    {
        double seconds[LONG_ROUNDS], rates[LONG_ROUNDS];
        options.threads = threads;
        for (int round = 0; round < LONG_ROUNDS; round++)
        {
            rates[round] = product_rate();
            seconds[round] = time_refinement(&curve, &options, fine);
        }
        double rate = LONG_POINTS / median_of(seconds, LONG_ROUNDS), bare = median_of(rates, LONG_ROUNDS);
        (void)printf("a million vertices, one level, %d thread%s: %4.0f thousand edges a second, %.2f of bare sgemm on one "
                     "(%.0f)\n",
                     threads, threads > 1 ? "s" : "", 1e-3 * rate, rate / bare, 1e-3 * bare);
    }
    (void)printf("peak memory %.2f times the output, the given curve (0.5) and the output itself included\n",
                 1024.0 * (double)resident_peak() / (double)bytes);
    free(fine);
    bat_curve_free(&curve);
}

int main(void)
{
    bat_space sphere = bat_sphere(2);
    bat_tension_model *model = make_model();
    if (model == NULL)
        return EXIT_FAILURE;
    bat_refine_options options = bat_refine_defaults();
    options.scheme = bat_scheme_learned(model);
    options.threads = 1;
    time_short(&sphere, options);
    time_long(&sphere, options);
    bat_tension_model_free(model);
    return EXIT_SUCCESS;
}
