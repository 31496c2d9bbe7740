// Which scheme keeps a circle? Eight points of the unit circle are refined by several schemes; the results are measured.
//
//     cc compare_schemes.c $(pkg-config --cflags --libs batten) -lm && ./a.out

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double TWO_PI = 6.28318530717958647692;

enum
{
    VERTICES = 8,
    LEVELS = 6,
};

/// The greatest distance of a curve's points from the unit circle.
static double distance_from_circle(const bat_curve *curve)
{
    double greatest = 0;
    for (size_t i = 0; i < curve->count; i++)
        greatest = fmax(greatest, fabs(hypot(curve->points[2 * i], curve->points[2 * i + 1]) - 1));
    return greatest;
}

/// Refine by one scheme and print a line of the table.
static bat_status measure(const bat_curve *coarse, const char *name, double *distance, bat_error *error)
{
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = LEVELS;
    bat_curve fine = {0};
    bat_curve_fairness_values fairness;
    bat_status status = bat_curve_scheme_by_name(name, &options.scheme, error);
    if (status == BAT_OK)
        status = bat_curve_refine(coarse, &options, &fine, error);
    if (status == BAT_OK)
        status = bat_curve_fairness(&fine, NULL, &fairness, error);
    if (status == BAT_OK)
    {
        *distance = distance_from_circle(&fine);
        printf("%-12s %12.3g %14.6f %14.6f\n", name, *distance, fairness.bending, fairness.g1);
    }
    bat_curve_free(&fine);
    return status;
}

int main(void)
{
    const bat_space plane = bat_euclidean(2);
    double points[2 * VERTICES];
    for (size_t i = 0; i < VERTICES; i++)
    {
        points[2 * i] = cos(TWO_PI * (double)i / VERTICES);
        points[2 * i + 1] = sin(TWO_PI * (double)i / VERTICES);
    }
    const bat_curve octagon = {.space = &plane, .points = points, .count = VERTICES, .closed = true};

    const char *names[] = {"angle-4", "four-point", "six-point", "chaikin"};
    double distances[sizeof names / sizeof *names];
    printf("%-12s %12s %14s %14s\n", "scheme", "off circle", "bending", "largest turn");
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    {
        bat_error error;
        if (measure(&octagon, names[k], &distances[k], &error) != BAT_OK)
        {
            fprintf(stderr, "compare_schemes: %s\n", error.text);
            return EXIT_FAILURE;
        }
    }

    // The angle-based scheme keeps circles exactly; of the linear ones six-point comes nearest, and Chaikin cuts the
    // corners.
    bool good = distances[0] < 1e-14 * (1 << LEVELS) && distances[0] < distances[2] && distances[2] < distances[1] &&
                distances[1] < distances[3];
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
