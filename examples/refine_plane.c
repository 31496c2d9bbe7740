// Fair curve through a few points of the plane, as CSV on standard output.
//
//     cc refine_plane.c $(pkg-config --cflags --libs batten) && ./a.out >hull.csv

#include <batten/batten.h>

#include <stdio.h>
#include <stdlib.h>

// Half the deck line of a dinghy, seen from above: length and half breadth in metres, from the bow to the stern.
static double deck_line[] = {0.0, 0.0, 0.6, 0.42, 1.4, 0.74, 2.4, 0.88, 3.3, 0.82, 4.0, 0.62};

enum
{
    POINTS = sizeof deck_line / sizeof *deck_line / 2,
    LEVELS = 4,
};

/// Whether the fine curve passes through every point of the coarse one, where it ought to.
static bool keeps_given_points(const bat_curve *coarse, const bat_curve *fine)
{
    for (size_t i = 0; i < 2 * coarse->count; i++)
    {
        size_t row = i / 2, column = i % 2;
        if (fine->points[2 * (row << LEVELS) + column] != coarse->points[i])
            return false;
    }
    return true;
}

int main(void)
{
    const bat_space plane = bat_euclidean(2);
    const bat_curve coarse = {.space = &plane, .points = deck_line, .count = POINTS};

    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.ends = BAT_CURVE_END_RULE_EXTRAPOLATE;
    options.levels = LEVELS;

    bat_curve fine = {0};
    bat_error error;
    if (bat_curve_refine(&coarse, &options, &fine, &error) != BAT_OK)
    {
        fprintf(stderr, "refine_plane: %s\n", error.text);
        return EXIT_FAILURE;
    }

    puts("x,y");
    for (size_t i = 0; i < fine.count; i++)
        printf("%.6f,%.6f\n", fine.points[2 * i], fine.points[2 * i + 1]);

    bool good = fine.count == ((size_t)(POINTS - 1) << LEVELS) + 1 && keeps_given_points(&coarse, &fine);
    if (!good)
        fputs("refine_plane: the curve leaves the given points\n", stderr);
    bat_curve_free(&fine);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
