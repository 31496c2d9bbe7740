// A program that knows batten only as an installed package: it rounds the corners of a square and prints the first points.

#include <batten/batten.h>

#include <stdio.h>

int main(void)
{
    const bat_space plane = bat_euclidean(2);
    double corners[] = {0, 0, 16, 0, 16, 16, 0, 16};
    const bat_curve square = {.space = &plane, .points = corners, .count = 4, .closed = true};

    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.scheme = bat_curve_scheme_linear(bat_mask_chaikin());
    options.levels = 2;

    bat_curve round = {0};
    bat_error error;
    if (bat_curve_refine(&square, &options, &round, &error) != BAT_OK)
    {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    printf("batten %s: %zu points\n", bat_version(), round.count);
    for (size_t i = 0; i < 4; i++)
        printf("%g %g\n", round.points[2 * i], round.points[2 * i + 1]);
    bat_curve_free(&round);
    return 0;
}
