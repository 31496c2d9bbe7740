#include "research/data/wave.h"
#include "research/shapes/surface_shape.h"

/// The features of a face; those with x > 0 are there on both sides. Their sizes are drawn anew for every mask.
static const relief_bump FEATURES[] = {
    {0, 0.32, 0.60, 0.07, 0.035},                                        // brow
    {0.33, 0.16, 0.17, 0.11, -0.065},                                    // sockets
    {0.33, 0.14, 0.105, 0.065, 0.040},                                   // eyes
    {0.52, -0.16, 0.20, 0.20, 0.030},                                    // cheeks
    {0.13, -0.12, 0.055, 0.05, 0.032},                                   // wings of the nose
    {0, -0.345, 0.24, 0.042, 0.026},                                     // lips
    {0, -0.455, 0.20, 0.048, 0.026},   {0, -0.400, 0.25, 0.016, -0.022}, // between them
    {0, -0.57, 0.22, 0.05, -0.018},                                      // below
    {0, -0.74, 0.20, 0.12, 0.045},                                       // chin
    {0, -0.25, 0.035, 0.06, -0.006},                                     // groove under the nose
};

static void add_bump(relief_form *relief, relief_bump bump)
{
    relief->bumps[relief->bump_count++] = bump;
}

void relief_draw(bat_random *random, relief_form *relief)
{
    *relief = (relief_form){.dome = draw_between(random, 0.24, 0.3),
                            .nose = draw_between(random, 0.1, 0.13),
                            .chasing = draw_between(random, 0.006, 0.01),
                            .chasing_folds = draw_whole(random, 9, 14)};
    for (size_t i = 0; i < sizeof FEATURES / sizeof FEATURES[0]; i++)
    {
        relief_bump bump = FEATURES[i];
        bump.height *= draw_between(random, 0.8, 1.25);
        bump.wide *= draw_between(random, 0.92, 1.08);
        bump.high *= draw_between(random, 0.92, 1.08);
        add_bump(relief, bump);
        bump.x = -bump.x;
        if (bump.x < 0)
            add_bump(relief, bump);
    }
}

/// From 0 to 1 about x = 0, over a length.
static double soft_step(double x, double length)
{
    return 0.5 + 0.5 * tanh(x / length);
}

/// The nose widens and rises from the brow to its tip.
static double nose_height(double x, double y)
{
    double down = (0.34 - y) / 0.46, below_brow = soft_step(0.34 - y, 0.08), wide = 0.055 + 0.05 * down * below_brow;
    return (0.3 + 0.7 * down) * soft_step(y + 0.15, 0.035) * below_brow * exp(-x * x / (wide * wide));
}

/// A band round the forehead with two rims and a row of folds between them.
static double band_height(const relief_form *relief, double x, double y)
{
    double place = (y - 0.68 + 0.08 * x * x) / 0.11, inside = exp(-pow(place, 8));
    double rims = exp(-pow((place - 1) / 0.18, 2)) + exp(-pow((place + 1) / 0.18, 2));
    return relief->chasing * (0.8 * rims + inside * (0.7 + sin(WAVE_PI * relief->chasing_folds * x + 2.2 * place)));
}

void relief_at(const relief_form *relief, const double parameter[2], double point[3])
{
    double x = 2 * parameter[0] - 1, y = 2 * parameter[1] - 1;
    double height = relief->dome * (1 - 0.75 * x * x) * (1 - 0.3 * y * y);
    height += relief->nose * nose_height(x, y) + band_height(relief, x, y);
    for (int i = 0; i < relief->bump_count; i++)
    {
        const relief_bump *bump = &relief->bumps[i];
        double across = (x - bump->x) / bump->wide, up = (y - bump->y) / bump->high;
        height += bump->height * exp(-across * across - up * up);
    }
    // The outline narrows towards the chin and is rounded above and below.
    double bulge = 1 - x * x;
    point[0] = x * (0.37 - 0.12 * (1 - parameter[1]) * (1 - parameter[1]));
    point[1] = 0.44 * y + bulge * (0.04 * parameter[1] - 0.07 * (1 - parameter[1]));
    point[2] = height;
}
