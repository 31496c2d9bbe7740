// The learned curve scheme against angle-4, five levels on one thread, measured in turn in one run: many small rings, and
// one ring of a million new points. The floor is 1/40 of angle-4's speed.

#include "timing.h"

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>

enum
{
    ROUNDS = 5,
    LEVELS = 5,
    RINGS = 20000,
    SMALL = 10,
    LARGE = 31250
};

static const double TURN = 6.28318530717958647693;

/// Star-shaped rings of `size` points each, next to each other in one array.
static bat_curve *make_rings(const bat_space *plane, size_t count, size_t size, double roughness)
{
    bat_random random = bat_random_seed(1);
    bat_curve *rings = calloc(count, sizeof *rings);
    for (size_t i = 0; i < count && rings != NULL; i++)
    {
        rings[i] = (bat_curve){.space = plane, .points = calloc(size, 2 * sizeof(double)), .count = size, .closed = true};
        for (size_t k = 0; k < size && rings[i].points != NULL; k++)
        {
            double angle = TURN * (double)k / (double)size, radius = 1 + roughness * bat_random_uniform(&random);
            rings[i].points[2 * k] = radius * cos(angle);
            rings[i].points[2 * k + 1] = radius * sin(angle);
        }
    }
    return rings;
}

/// Seconds of one refinement of all rings; negative on failure.
static double refine_all(const bat_curve *rings, size_t count, const char *scheme)
{
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = LEVELS;
    options.threads = 1;
    options.simple = BAT_CURVE_SIMPLE_NEVER; // bench_simple measures it
    bat_curve *fine = calloc(count, sizeof *fine);
    bat_error error;
    if (fine == NULL || bat_curve_scheme_by_name(scheme, &options.scheme, &error) != BAT_OK)
        return -1;
    double begin = seconds_now();
    bat_status status = bat_curves_refine(rings, count, &options, fine, &error);
    double seconds = seconds_now() - begin;
    for (size_t i = 0; i < count; i++)
        bat_curve_free(&fine[i]);
    free(fine);
    return status == BAT_OK ? seconds : -1;
}

static void bench(const char *label, size_t count, size_t size, double roughness)
{
    const bat_space plane = bat_euclidean(2);
    bat_curve *rings = make_rings(&plane, count, size, roughness);
    double learned[ROUNDS], classical[ROUNDS];
    if (rings == NULL)
        return;
    for (int round = 0; round < ROUNDS; round++)
    {
        learned[round] = refine_all(rings, count, "learned");
        classical[round] = refine_all(rings, count, "angle-4");
    }
    double made = (double)count * (double)size * ((1 << LEVELS) - 1);
    double slow = median_of(learned, ROUNDS), fast = median_of(classical, ROUNDS);
    (void)printf("%-28s learned %5.1f, angle-4 %6.1f million new points a second: 1/%.1f\n", label, 1e-6 * made / slow,
                 1e-6 * made / fast, slow / fast);
    for (size_t i = 0; i < count; i++)
        bat_curve_free(&rings[i]);
    free(rings);
}

int main(void)
{
    bench("20,000 rings of 10 points", RINGS, SMALL, 0.4);
    bench("one ring of 31,250 points", 1, LARGE, 0.1 / LARGE);
    return 0;
}
