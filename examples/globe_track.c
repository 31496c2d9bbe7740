// A ship's track from a few positions: refined on the sphere, drawn on a globe, its length in nautical miles.
//
//     cc globe_track.c $(pkg-config --cflags --libs batten) -lm && ./a.out track.svg

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double DEGREE = 0.017453292519943295;
static const double MINUTES_OF_ARC = 60 / DEGREE;

// Longitude and latitude in degrees: from the Channel round the Cape of Good Hope to Java, much as sailing ships went.
static const double positions[][2] = {{-6, 49},   {-20, 33}, {-26, 15}, {-29, -5}, {-30, -22},
                                      {-12, -37}, {20, -39}, {55, -38}, {85, -33}, {101, -15}};

enum
{
    POSITIONS = sizeof positions / sizeof *positions,
    LEVELS = 5,
};

static void unit_vector(const double position[2], double point[3])
{
    double longitude = position[0] * DEGREE, latitude = position[1] * DEGREE;
    point[0] = cos(latitude) * cos(longitude);
    point[1] = cos(latitude) * sin(longitude);
    point[2] = sin(latitude);
}

static double length_in_miles(const bat_curve *curve)
{
    double *lengths = malloc(curve->count * sizeof *lengths);
    if (lengths == NULL)
        return NAN;
    bat_curve_edge_lengths(curve, lengths);
    double sum = 0;
    for (size_t i = 0; i + 1 < curve->count; i++)
        sum += lengths[i];
    free(lengths);
    return sum * MINUTES_OF_ARC;
}

static bat_status draw(const bat_curve *coarse, const bat_curve *fine, const char *path, bat_error *error)
{
    const bat_curve_picture_layer layers[] = {
        {.curve = coarse, .role = BAT_CURVE_LAYER_ROLE_CONTROL, .label = "positions"},
        {.curve = fine, .role = BAT_CURVE_LAYER_ROLE_CURVE, .label = "track"},
    };
    const bat_curve_picture_panel panel = {.layers = layers, .layer_count = 2};
    return bat_curve_picture_write(path, &panel, 1, NULL, error);
}

int main(int argc, char **argv)
{
    const bat_space sphere = bat_sphere(2);
    double points[3 * POSITIONS];
    for (size_t i = 0; i < POSITIONS; i++)
        unit_vector(positions[i], points + 3 * i);
    const bat_curve coarse = {.space = &sphere, .points = points, .count = POSITIONS};

    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = LEVELS;

    bat_curve fine = {0};
    bat_error error;
    bat_curve_fairness_values before, after;
    if (bat_curve_refine(&coarse, &options, &fine, &error) != BAT_OK ||
        bat_curve_fairness(&coarse, NULL, &before, &error) != BAT_OK ||
        bat_curve_fairness(&fine, NULL, &after, &error) != BAT_OK ||
        draw(&coarse, &fine, argc > 1 ? argv[1] : "globe_track.svg", &error) != BAT_OK)
    {
        fprintf(stderr, "globe_track: %s\n", error.text);
        bat_curve_free(&fine);
        return EXIT_FAILURE;
    }

    double straight = length_in_miles(&coarse), curved = length_in_miles(&fine);
    printf("%zu positions, %.0f nautical miles by great circles, largest turn %.1f degrees\n", coarse.count, straight,
           before.g1 / DEGREE);
    printf("%zu points,    %.0f nautical miles along the curve,  largest turn %.1f degrees\n", fine.count, curved,
           after.g1 / DEGREE);

    // A fair curve through the positions is a little longer than the straight way, and turns in small steps.
    bool good =
        bat_curve_check(&fine, NULL) == BAT_OK && curved > straight && curved < 1.05 * straight && after.g1 < before.g1 / 8;
    bat_curve_free(&fine);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
