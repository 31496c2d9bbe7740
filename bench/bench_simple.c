// What it costs to keep refined curves simple, as a share of refining them by angle-4, in one run: many small rings, and one
// ring of a million new points.

#include "timing.h"

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>

enum
{
    ROUNDS = 9,
    RINGS = 20000,
    RING_POINTS = 10,
    RING_LEVELS = 4,
    LONG_LEVELS = 5,
    LONG_POINTS = 1000000 >> LONG_LEVELS
};

/// Rings of random radii about their centres: blobs, and with much noise stars.
static void make_rings(const bat_space *space, double noise, double *points)
{
    bat_random random = bat_random_seed(1);
    for (size_t i = 0; i < (size_t)RINGS * RING_POINTS; i++)
    {
        double angle = 2 * 3.141592653589793 * (double)(i % RING_POINTS) / RING_POINTS;
        double radius = 0.02 * exp(noise * bat_random_normal(&random));
        double v[3] = {radius * cos(angle), radius * sin(angle), 1};
        (void)space->project(space, v, points + i * space->point_dim);
    }
}

/// A coast: a ring whose radius is the exponential of waves with a falling spectrum, so that it has bays of every size and
/// is simple. It is turned by an angle that grows with the radius.
static void make_coast(const bat_space *space, double *points)
{
    enum
    {
        WAVES = 14
    };
    bat_random random = bat_random_seed(2);
    double phases[WAVES];
    for (int k = 0; k < WAVES; k++)
        phases[k] = 7 * bat_random_uniform(&random);
    for (size_t i = 0; i < LONG_POINTS; i++)
    {
        double t = 2 * 3.141592653589793 * (double)i / LONG_POINTS, height = 0;
        for (int k = 1; k < WAVES; k++)
            height += 0.5 * pow(0.6, k) * cos(pow(2, k) * t + phases[k]);
        double radius = 0.4 * exp(height), angle = t + 2 * height;
        double v[3] = {radius * cos(angle), radius * sin(angle), 1};
        (void)space->project(space, v, points + i * space->point_dim);
    }
}

static double time_refinement(const bat_curve *coarse, size_t count, bat_curve_refine_options *options, bat_curve *fine)
{
    double spent[ROUNDS];
    bat_error error;
    for (int round = 0; round < ROUNDS; round++)
    {
        double start = seconds_now();
        if (bat_curves_refine(coarse, count, options, fine, &error) != BAT_OK)
            (void)fprintf(stderr, "%s\n", error.text);
        spent[round] = seconds_now() - start;
        for (size_t i = 0; i < count; i++)
            bat_curve_free(&fine[i]);
    }
    return median_of(spent, ROUNDS);
}

static void compare(const char *name, const bat_curve *coarse, size_t count, size_t levels, bat_curve *fine)
{
    bat_curve_refine_report report = {0};
    bat_curve_refine_options options = bat_curve_refine_defaults();
    (void)bat_curve_scheme_by_name("angle-4", &options.scheme, NULL);
    options.levels = levels;
    options.threads = 1;
    options.simple = BAT_CURVE_SIMPLE_NEVER;
    double without = time_refinement(coarse, count, &options, fine);
    options.simple = BAT_CURVE_SIMPLE_RINGS;
    options.report = &report;
    double with = time_refinement(coarse, count, &options, fine);
    (void)printf(
        "%-8s %-28s keeping simple costs %.2f of refining; %zu of %zu crossed, %zu given so, %zu edges drawn back\n",
        coarse->space->name, name, with / without - 1, report.crossing, report.checked, report.given_crossing,
        report.drawn_back);
}

int main(void)
{
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    size_t numbers = (size_t)RINGS * RING_POINTS > LONG_POINTS ? (size_t)RINGS * RING_POINTS : LONG_POINTS;
    double *points = malloc(3 * numbers * sizeof *points);
    bat_curve *coarse = malloc(RINGS * sizeof *coarse), *fine = malloc(RINGS * sizeof *fine);
    for (size_t s = 0; s < sizeof spaces / sizeof *spaces && points != NULL && coarse != NULL && fine != NULL; s++)
    {
        const bat_space *space = &spaces[s];
        for (size_t i = 0; i < RINGS; i++)
            coarse[i] = (bat_curve){
                .space = space, .points = points + i * RING_POINTS * space->point_dim, .count = RING_POINTS, .closed = true};
        make_rings(space, 0.1, points);
        compare("20000 blobs of 10 points", coarse, RINGS, RING_LEVELS, fine);
        make_rings(space, 1, points);
        compare("20000 stars of 10 points", coarse, RINGS, RING_LEVELS, fine);
        make_coast(space, points);
        bat_curve coast = {.space = space, .points = points, .count = LONG_POINTS, .closed = true};
        compare("a ring of 10^6 new points", &coast, 1, LONG_LEVELS, fine);
    }
    free(points);
    free(coarse);
    free(fine);
    return EXIT_SUCCESS;
}
