// outside.c as C++, to show that the headers are both.

#include <batten/batten.h>

#include <cstdio>

int main()
{
    const bat_space plane = bat_euclidean(2);
    double corners[] = {0, 0, 16, 0, 16, 16, 0, 16};
    bat_curve square = bat_curve();
    square.space = &plane;
    square.points = corners;
    square.count = 4;
    square.closed = true;

    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.scheme = bat_curve_scheme_linear(bat_mask_chaikin());
    options.levels = 2;

    bat_curve round = bat_curve();
    bat_error error;
    if (bat_curve_refine(&square, &options, &round, &error) != BAT_OK)
    {
        std::fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    std::printf("batten %s: %zu points\n", bat_version(), round.count);
    for (size_t i = 0; i < 4; i++)
        std::printf("%g %g\n", round.points[2 * i], round.points[2 * i + 1]);
    bat_curve_free(&round);
    return 0;
}
