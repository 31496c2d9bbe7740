// Refinement of curves against the bounds of the machine, measured in turn in one run: filling the result's memory for
// linear schemes, as many bare transcendental functions for the schemes of curved spaces.

#include "timing.h"

#include "base/lanes.h"
#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum
{
    ROUNDS = 9,
    COARSE = 20,
    BLOCK = 4096
};

/// A wavy closed polygon of COARSE points.
static void make_coarse(const bat_space *space, double *points)
{
    for (size_t i = 0; i < COARSE; i++)
    {
        double t = 6.283185307179586 * (double)i / COARSE, r = 0.5 + 0.1 * sin(3 * t);
        double v[3] = {r * cos(t), r * sin(t), 0.3 * sin(2 * t)};
        (void)space->project(space, v, points + i * space->point_dim);
    }
}

/// One scheme refined into a buffer again and again, with the filling of that buffer in between.
typedef struct trial
{
    size_t count;        ///< points made
    double refine, fill; ///< median seconds
} trial;

static bool run_trial(const bat_space *space, const char *scheme, size_t levels, trial *result)
{
    double coarse_points[3 * COARSE], refine[ROUNDS], fill[ROUNDS];
    bat_error error;
    make_coarse(space, coarse_points);
    bat_curve coarse = {.space = space, .points = coarse_points, .count = COARSE, .closed = true};
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = levels;
    options.threads = 1;
    options.simple = BAT_CURVE_SIMPLE_NEVER; // bench_simple measures it
    if (bat_curve_scheme_by_name(scheme, &options.scheme, &error) != BAT_OK ||
        bat_curve_refined_count(&coarse, &options, &result->count, &error) != BAT_OK)
    {
        (void)fprintf(stderr, "%s: %s\n", scheme, error.text);
        return false;
    }
    size_t bytes = result->count * space->point_dim * sizeof(double);
    double *buffer = malloc(bytes);
    if (buffer == NULL)
        return false;
    memset(buffer, 1, bytes);
    for (int round = 0; round < ROUNDS; round++)
    {
        double start = seconds_now();
        memset(buffer, round, bytes);
        double middle = seconds_now();
        if (bat_curve_refine_into(&coarse, &options, buffer, NULL, result->count, &error) != BAT_OK)
            (void)fprintf(stderr, "%s: %s\n", scheme, error.text);
        fill[round] = middle - start;
        refine[round] = seconds_now() - middle;
    }
    free(buffer);
    result->refine = median_of(refine, ROUNDS);
    result->fill = median_of(fill, ROUNDS);
    return true;
}

static void bench_linear(const char *scheme, double floor)
{
    bat_space plane = bat_euclidean(2);
    trial t;
    if (!run_trial(&plane, scheme, 20, &t))
        return;
    (void)printf("%-26s %9zu points: %5.2f of the speed of memset", scheme, t.count, t.fill / t.refine);
    if (floor > 0)
        (void)printf(" (floor %.2f)", floor);
    (void)printf("; memset fills %.1f GB/s\n", (double)(t.count * 2 * sizeof(double)) / t.fill * 1e-9);
}

/// Bare functions on arrays in the first-level cache: seconds per call.
typedef double (*bare_function)(double *x, double *y, size_t count);

LANES_CLONES
static double sum_lane_atan2(double *x, double *y, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        x[i] = lane_atan2(x[i], y[i]);
    for (size_t i = 0; i < count; i++)
        sum += x[i];
    return sum;
}

LANES_CLONES
static double sum_lane_tan(double *x, double *y, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        x[i] = lane_tan(x[i] < 0.7 ? x[i] : y[i]);
    for (size_t i = 0; i < count; i++)
        sum += x[i];
    return sum;
}

LANES_CLONES
static double sum_lane_exp(double *x, double *y, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
    {
        y[i] = lane_cos_root(x[i]);
        x[i] = lane_sinc_root(x[i]);
    }
    for (size_t i = 0; i < count; i++)
        sum += x[i];
    return sum;
}

static double sum_libm_atan2(double *x, double *y, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += atan2(x[i], y[i]);
    return sum;
}

static double sum_libm_tan(double *x, double *y, size_t count)
{
    double sum = 0;
    (void)y;
    for (size_t i = 0; i < count; i++)
        sum += tan(x[i]);
    return sum;
}

static double sum_libm_exp(double *x, double *y, size_t count)
{
    double sum = 0;
    (void)y;
    for (size_t i = 0; i < count; i++)
        sum += cos(x[i]) + sin(x[i]);
    return sum;
}

static double seconds_a_call(bare_function function)
{
    static double x[BLOCK], y[BLOCK];
    double rounds[ROUNDS], sink = 0;
    for (int round = 0; round < ROUNDS; round++)
    {
        double spent = 0;
        for (int repeat = 0; repeat < 50; repeat++)
        {
            for (size_t i = 0; i < BLOCK; i++)
            {
                x[i] = 0.3 + 1e-5 * (double)i;
                y[i] = 0.6 - 1e-5 * (double)i;
            }
            double start = seconds_now();
            sink += function(x, y, BLOCK);
            spent += seconds_now() - start;
        }
        rounds[round] = spent / (50.0 * BLOCK);
    }
    volatile double keep = sink;
    (void)keep;
    return median_of(rounds, ROUNDS);
}

/// What one new point costs in bare functions.
typedef struct recipe
{
    const char *space, *scheme;
    size_t levels;
    double atan2s, tans, exponentials;
} recipe;

/// Seconds a call of the three functions.
typedef struct prices
{
    double atan2_price, tan_price, exponential;
} prices;

static double price_of(const recipe *r, const prices *p)
{
    return r->atan2s * p->atan2_price + r->tans * p->tan_price + r->exponentials * p->exponential;
}

static void bench_curved(const recipe *r, const prices *lanes, const prices *libm)
{
    bat_space space;
    trial t;
    if (bat_space_by_name(r->space, 0, &space, NULL) != BAT_OK || !run_trial(&space, r->scheme, r->levels, &t))
        return;
    double each = t.refine / (double)(t.count - COARSE);
    (void)printf(
        "%-7s %-24s %6.1f million new points a second; %4.2f of the bound by vector functions, %5.2f of that by libm\n",
        r->space, r->scheme, 1e-6 / each, price_of(r, lanes) / each, price_of(r, libm) / each);
}

int main(void)
{
    (void)printf(
        "One thread. Ratios are medians of %d rounds.\n\nLinear schemes in the plane, 20 levels from 20 vertices:\n",
        ROUNDS);
    bench_linear("chaikin", 1.0 / 2);
    bench_linear("four-point", 1.0 / 3);
    bench_linear("six-point", 0);
    bench_linear("lane-riesenfeld:order=3", 0);
    bench_linear("lane-riesenfeld:order=5", 0);

    prices lanes = {seconds_a_call(sum_lane_atan2), seconds_a_call(sum_lane_tan), seconds_a_call(sum_lane_exp)};
    prices libm = {seconds_a_call(sum_libm_atan2), seconds_a_call(sum_libm_tan), seconds_a_call(sum_libm_exp)};
    const recipe recipes[] = {
        {"plane", "angle-4", 20, 1, 1, 0},
        {"sphere", "angle-4", 20, 1, 1, 0},
        {"sphere", "angle-6", 20, 1, 1, 0},
        {"disk", "angle-4", 20, 1, 1, 0},
        {"sphere", "log-exp-4", 19, 3, 0, 1},
        {"sphere", "log-exp-6", 19, 5, 0, 1},
        {"sphere", "angle-4:adaptive=1", 18, 1, 1, 0},
    };
    (void)printf("\nCurved spaces (floor on the sphere: 30 million), and the share of the time that the bare atan2, tan, "
                 "cos and sin\n"
                 "calls would take alone:\n");
    for (size_t i = 0; i < sizeof recipes / sizeof recipes[0]; i++)
        bench_curved(&recipes[i], &lanes, &libm);
    return 0;
}
