// Refining by the learned schemes: a short curve many times, and a long one once, against the bare products of the network's
// layers in turn in one run.

#include "timing.h"

#include "batten/curve.h"
#include "batten/curve_scheme.h"
#include "batten/research/networks.h"
#include "curve/network/learned_network.h"
#include "learn/blas.h"
#include "research/networks/tension_network.h"

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

/// Seconds to refine into memory that is there.
static double time_refinement(const bat_curve *curve, const bat_curve_refine_options *options, double *fine)
{
    size_t count = curve->count << options->levels;
    double start = seconds_now();
    bat_status status = bat_curve_refine_into(curve, options, fine, NULL, count, NULL);
    return status == BAT_OK ? seconds_now() - start : 1e9;
}

/// A scheme and the shapes of its network's layers.
typedef struct contender
{
    const char *name;
    bat_curve_scheme scheme;
    bool transposed; ///< weights are outputs x inputs, not inputs x outputs
    learn_parameters parameters;
} contender;

/// The products of all layers for as many rows as suit BLAS.
static void run_products(const contender *c, const real *left, const real *right, real *result)
{
    for (size_t i = 0; i < c->parameters.count; i++)
    {
        const learn_parameter *p = &c->parameters.list[i];
        int inputs = (int)(c->transposed ? p->columns : p->rows), outputs = (int)(c->transposed ? p->rows : p->columns);
        if (p->rank == 2 && strcmp(p->name, "geom_embed.weight") != 0)
            REAL_GEMM(CblasRowMajor, CblasNoTrans, c->transposed ? CblasTrans : CblasNoTrans, PRODUCT_ROWS, outputs, inputs,
                      1, left, inputs, right, (int)p->columns, 0, result, outputs);
    }
}

/// The bare rate on one thread in rows a second, over about as long as the refinement takes.
static double product_rate(const contender *c)
{
    enum
    {
        ROUNDS = LONG_POINTS / PRODUCT_ROWS,
        NUMBERS = PRODUCT_ROWS * TENSION_WIDTH
    };
    double rate = 0;
    real *left = calloc(3 * NUMBERS, sizeof *left);
    if (left != NULL)
    {
        for (size_t k = 0; k < 2 * NUMBERS; k++)
            left[k] = (real)(k % 7);
        blas_single_begin();
        double start = seconds_now();
        for (int round = 0; round < ROUNDS; round++)
            run_products(c, left, left + NUMBERS, left + 2 * NUMBERS);
        rate = (double)ROUNDS * PRODUCT_ROWS / (seconds_now() - start);
        blas_single_end();
    }
    free(left);
    return rate;
}

static void time_short(const bat_space *sphere, const contender *c, bat_curve_refine_options options)
{
    double seconds[SHORT_ROUNDS], fine[3 * (SHORT_POINTS << SHORT_LEVELS)];
    bat_curve curve = make_curve(sphere, SHORT_POINTS);
    options.levels = SHORT_LEVELS;
    for (int round = 0; round < SHORT_ROUNDS; round++)
        seconds[round] = time_refinement(&curve, &options, fine);
    (void)printf("%s: %d vertices by %d levels: %.3f ms on one thread\n", c->name, SHORT_POINTS, SHORT_LEVELS,
                 1e3 * median_of(seconds, SHORT_ROUNDS));
    bat_curve_free(&curve);
}

static long resident_peak(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_maxrss : 0;
}

static void time_long(const bat_space *sphere, const contender *c, bat_curve_refine_options options)
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
            rates[round] = product_rate(c);
            seconds[round] = time_refinement(&curve, &options, fine);
        }
        double rate = LONG_POINTS / median_of(seconds, LONG_ROUNDS), bare = median_of(rates, LONG_ROUNDS);
        (void)printf(
            "%s: a million vertices, one level, %d thread%s: %4.0f thousand edges a second, %.2f of bare sgemm on one "
            "(%.0f)\n",
            c->name, threads, threads > 1 ? "s" : "", 1e-3 * rate, rate / bare, 1e-3 * bare);
    }
    (void)printf("%s: peak memory %.2f times the output, the given curve (0.5) and the output itself included\n", c->name,
                 1024.0 * (double)resident_peak() / (double)bytes);
    free(fine);
    bat_curve_free(&curve);
}

int main(void)
{
    bat_space sphere = bat_sphere(2);
    bat_curve_model *published = NULL;
    contender contenders[] = {{.name = "learned", .scheme = bat_curve_scheme_learned(0.5)},
                              {.name = "learned-published", .transposed = true}};
    if (bat_curve_model_read_published(NULL, &published, NULL) != BAT_OK ||
        learned_network_make(&contenders[0].parameters, NULL) != BAT_OK ||
        tension_network_make(&contenders[1].parameters, NULL) != BAT_OK)
        return EXIT_FAILURE;
    contenders[1].scheme = bat_curve_scheme_of_model(published);
    for (size_t i = 0; i < sizeof contenders / sizeof *contenders; i++)
    {
        bat_curve_refine_options options = bat_curve_refine_defaults();
        options.scheme = contenders[i].scheme;
        options.threads = 1;
        options.simple = BAT_CURVE_SIMPLE_NEVER; // bench_simple measures it
        time_short(&sphere, &contenders[i], options);
        time_long(&sphere, &contenders[i], options);
        learn_parameters_free(&contenders[i].parameters);
    }
    bat_curve_model_free(published);
    return EXIT_SUCCESS;
}
