// Prints a digest of the bytes of refined curves, one line for each scheme and space. Programs that differ in nothing but
// the vector width they were compiled for must print the same.

#include "batten/curve.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    VERTICES = 37,
    LEVELS = 6,
};

/// FNV-1a.
static uint64_t digest(const double *values, size_t count)
{
    const unsigned char *bytes = (const unsigned char *)values;
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count * sizeof *values; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

/// Print the digest of a random curve's refinement.
static bool print_digest(const bat_space *space, const char *scheme_name, bool closed)
{
    double points[VERTICES * 4];
    bat_random random = bat_random_seed(7);
    for (size_t i = 0; i < VERTICES; i++)
        space->random_point(space, &random, points + i * space->point_dim);
    const bat_curve coarse = {.space = space, .points = points, .count = VERTICES, .closed = closed};

    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = LEVELS;
    bat_curve fine = {0};
    bat_error error;
    if (bat_curve_scheme_by_name(scheme_name, &options.scheme, &error) != BAT_OK ||
        bat_curve_refine(&coarse, &options, &fine, &error) != BAT_OK)
    {
        (void)fprintf(stderr, "%s in %s: %s\n", scheme_name, space->name, error.text);
        return false;
    }
    (void)printf("%s %s %s %016" PRIx64 "\n", space->name, scheme_name, closed ? "closed" : "open",
                 digest(fine.points, fine.count * space->point_dim));
    bat_curve_free(&fine);
    return true;
}

int main(void)
{
    const bat_space plane = bat_euclidean(2), four = bat_euclidean(4), sphere = bat_sphere(2), disk = bat_disk();
    const char *linear[] = {"chaikin", "four-point", "six-point", "lane-riesenfeld:order=3", "lane-riesenfeld:order=6"};
    const char *curved[] = {"angle-4", "angle-6", "angle:adaptive=1", "log-exp-4", "log-exp-6:base=midpoint"};
    const bat_space *surfaces[] = {&plane, &sphere, &disk};
    bool good = true;
    for (int closed = 0; closed < 2; closed++)
    {
        for (size_t k = 0; k < sizeof linear / sizeof *linear; k++)
            good = print_digest(&plane, linear[k], closed) && print_digest(&four, linear[k], closed) && good;
        for (size_t k = 0; k < sizeof curved / sizeof *curved; k++)
            for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++)
                good = print_digest(surfaces[s], curved[k], closed) && good;
    }
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
