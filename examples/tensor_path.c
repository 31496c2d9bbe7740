// Diffusion tensors along a nerve fibre: six of a file become a smooth path of positive-definite matrices. Means of the
// matrix entries swell in between, which says that water moves more freely there than at either end; the path does not.
//
//     cc tensor_path.c $(pkg-config --cflags --libs batten) -lm && ./a.out data/tensor-path.csv path.csv

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    LEVELS = 4,
    STEPS = 1 << LEVELS,
};

/// Of xx, xy, xz, yy, yz, zz.
static double determinant(const double *a)
{
    return a[0] * (a[3] * a[5] - a[4] * a[4]) - a[1] * (a[1] * a[5] - a[4] * a[2]) + a[2] * (a[1] * a[4] - a[3] * a[2]);
}

/// How much larger the determinant gets between two tensors than the larger of theirs, at most.
static double swelling(const double *a, const double *b, const double *between)
{
    return determinant(between) / fmax(determinant(a), determinant(b)) - 1;
}

static void mean(const double *a, const double *b, double share, double *between)
{
    for (size_t i = 0; i < 6; i++)
        between[i] = (1 - share) * a[i] + share * b[i];
}

int main(int argc, char **argv)
{
    const char *path = argc > 1 ? argv[1] : "examples/data/tensor-path.csv";
    bat_curve_set tensors = {0}, smooth = {0};
    bat_error error;
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.scheme.levels = LEVELS;
    bat_status status = bat_curve_read(path, NULL, &tensors, &error);
    if (status == BAT_OK)
        status = bat_motion_curves(&tensors, &options, &smooth, &error);
    if (status == BAT_OK && argc > 2)
        status = bat_curve_write(argv[2], &smooth, NULL, &error);
    if (status != BAT_OK)
    {
        fprintf(stderr, "%s:%zu: %s\n", path, error.line, error.text);
        bat_curve_set_free(&smooth);
        bat_curve_set_free(&tensors);
        return EXIT_FAILURE;
    }

    const double *given = tensors.curves[0].points, *fine = smooth.curves[0].points;
    double by_mean = 0, by_path = 0;
    for (size_t i = 0; i + 1 < tensors.curves[0].count; i++)
        for (size_t j = 0; j <= STEPS; j++)
        {
            const double *a = given + 6 * i, *b = a + 6;
            double between[6];
            mean(a, b, (double)j / STEPS, between);
            by_mean = fmax(by_mean, swelling(a, b, between));
            by_path = fmax(by_path, swelling(a, b, fine + 6 * (i * STEPS + j)));
        }
    printf("%zu tensors become %zu; the determinant swells by %.1f %% in means of entries, by %.1f %% along the path\n",
           tensors.curves[0].count, smooth.curves[0].count, 100 * by_mean, 100 * by_path);
    bool good = bat_space_check(smooth.space, fine, smooth.curves[0].count, NULL) == BAT_OK && by_path < by_mean / 4;
    bat_curve_set_free(&smooth);
    bat_curve_set_free(&tensors);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
