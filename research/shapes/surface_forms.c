/// @file
/// The formulas of the hull, the blade and the relief; see surface_shape.h.

#include "research/shapes/surface_shape.h"

#include "research/data/wave.h"

void hull_draw(bat_random *random, hull_form *hull)
{
    *hull = (hull_form){.half_breadth = draw_between(random, 0.085, 0.1),
                        .depth = draw_between(random, 0.105, 0.12),
                        .sheer = draw_between(random, 0.022, 0.034),
                        .entrance = draw_between(random, 0.2, 0.25),
                        .deck_entrance = draw_between(random, 0.11, 0.14),
                        .rake = draw_between(random, 0.045, 0.065),
                        .bilge = draw_between(random, 0.06, 0.09),
                        .bulb_length = draw_between(random, 0.04, 0.05),
                        .bulb_radius = draw_between(random, 0.015, 0.019),
                        .bulb_height = draw_between(random, 0.17, 0.21),
                        .knuckle = draw_between(random, 0.09, 0.13),
                        .transom_height = draw_between(random, 0.055, 0.066),
                        .rise_begin = draw_between(random, 0.7, 0.76),
                        .transom_breadth = draw_between(random, 0.84, 0.92)};
}

/// A smooth max(x, 0), a branch of a hyperbola: (x + sqrt(x^2 + length^2)) / 2.
static double soft_ramp(double x, double length)
{
    return 0.5 * (x + sqrt(x * x + length * length));
}

/// The same with its corner at `from`, shifted to be 0 at x = 0.
static double ramp_from(double x, double from, double length)
{
    return soft_ramp(x - from, length) - soft_ramp(-from, length);
}

/// The Gaussian exp(-x^2 / length^2).
static double bell(double x, double length)
{
    return exp(-x * x / (length * length));
}

/// A station: two lines, keel to bilge corner and bilge corner to deck edge, as half-breadths and heights, and the fraction
/// that rounds the corner.
typedef struct hull_station
{
    double keel[2], corner[2], deck[2];
    double rounding;
} hull_station;

/// At the bow, the corner rises to the begin of the flare; at the stern, the bottom rises to the transom.
static hull_station station_at(const hull_form *hull, double u)
{
    double bow = bell(u, 0.17), stern = u * u * u * u * u * u;
    double rise = hull->transom_height * ramp_from(u, hull->rise_begin, 0.08) / ramp_from(1, hull->rise_begin, 0.08);
    double narrowing = 1 - (1 - hull->transom_breadth) * stern;
    double ahead = (1 - u) * (1 - u) * (1 - u) * (1 - u);
    return (hull_station){
        .keel = {0, rise},
        .corner = {0.98 * hull->half_breadth * (1 - bell(u, hull->entrance)) * narrowing * (1 - 0.12 * stern),
                   rise + 0.006 + 0.55 * hull->depth * bow + 0.012 * stern},
        .deck = {hull->half_breadth * tanh(u / hull->deck_entrance) * narrowing,
                 hull->depth + hull->sheer * ahead + 0.2 * hull->sheer * stern},
        .rounding = hull->bilge + 0.22 * bow + 0.05 * stern,
    };
}

/// Half-breadth and height at parameter v of a station: a hyperbola with the two lines as asymptotes, at nearly constant
/// speed.
static void station_point(const hull_station *station, double v, double point[2])
{
    double below = hypot(station->corner[0] - station->keel[0], station->corner[1] - station->keel[1]);
    double above = hypot(station->deck[0] - station->corner[0], station->deck[1] - station->corner[1]);
    double corner = below / (below + above);
    double after = ramp_from(v, corner, station->rounding), all_after = ramp_from(1, corner, station->rounding);
    double first = (v - after) / (1 - all_after), second = after / all_after;
    for (int c = 0; c < 2; c++)
        point[c] = station->keel[c] + first * (station->corner[c] - station->keel[c]) +
                   second * (station->deck[c] - station->corner[c]);
}

void hull_at(const hull_form *hull, const double parameter[2], double point[3])
{
    double u = parameter[0], v = parameter[1], across[2];
    hull_station station = station_at(hull, u);
    station_point(&station, v, across);
    // The waterlines of the bulb begin on a circle: tanh^2 + sech^2 = 1.
    double bulb = bell(v - hull->bulb_height, 0.13), round = u / 0.03;
    double nose = hull->bulb_length * bulb / cosh(round);
    double swell = hull->bulb_radius * bulb * tanh(v / 0.08) * tanh(round) * bell(u, 0.2);
    // Above the knuckle line the flare turns back towards the vertical.
    double turned = ramp_from(v, 0.8, 0.008) * hull->knuckle * tanh(u / 0.04) * bell(u, 0.24);
    double overhang = hull->rake * v * v * v * bell(u, 0.2) - 0.02 * v * pow(u, 8);
    point[0] = 0.5 - u + nose + overhang;
    point[1] = across[0] + swell - turned;
    point[2] = across[1];
}

#define BLADE_DEGREE (WAVE_PI / 180)
/// The leading edge takes about this fraction of a section.
#define NOSE_SHARE 0.12
/// The blade twists about this fraction of its chord.
#define AXIS_SHARE 0.4

void blade_draw(bat_random *random, blade_form *blade)
{
    *blade = (blade_form){.root_chord = draw_between(random, 0.46, 0.52),
                          .tip_chord = draw_between(random, 0.3, 0.36),
                          .root_thickness = draw_between(random, 0.23, 0.27),
                          .tip_thickness = draw_between(random, 0.14, 0.17),
                          .root_camber = draw_between(random, 0.15, 0.19),
                          .tip_camber = draw_between(random, 0.05, 0.08),
                          .root_stagger = draw_between(random, 12, 20) * BLADE_DEGREE,
                          .tip_stagger = draw_between(random, 48, 58) * BLADE_DEGREE,
                          .opening = draw_between(random, 0.05, 0.058),
                          .lean = draw_between(random, 0.03, 0.07),
                          .sweep = draw_between(random, -0.02, 0.05)};
}

/// The square root of the position along the chord, with sign: 1 at u = 0, 0 at the leading edge, -1 at u = 1; the speed is
/// nearly constant.
static double root_of_chord(double u)
{
    double way = 1 - 2 * u, complete = sqrt(sqrt(1 + NOSE_SHARE * NOSE_SHARE) + NOSE_SHARE);
    return way * complete / sqrt(sqrt(way * way + NOSE_SHARE * NOSE_SHARE) + NOSE_SHARE);
}

/// A section of chord 1 with the leading edge at 0. Half the thickness is that of a Joukowski aerofoil to first order,
/// sqrt(x) (1 - x), which has a parabolic leading edge, plus the opening. It is added to a parabolic camber line.
static void section_at(double u, double thickness, double camber, double opening, double at[2])
{
    const double thickest = 0.3849001794597505; // 2 / sqrt(27), at a third of the chord
    double root = root_of_chord(u), x = root * root;
    at[0] = x;
    at[1] = 0.5 * thickness * root * (1 - x) / thickest + opening * root * x + 4 * camber * x * (1 - x);
}

void blade_at(const blade_form *blade, const double parameter[2], double point[3])
{
    double v = parameter[1], at[2], eased = v * (2 - v);
    double chord = blade->root_chord + v * (blade->tip_chord - blade->root_chord);
    double thickness = blade->root_thickness + eased * (blade->tip_thickness - blade->root_thickness);
    double camber = blade->root_camber + eased * (blade->tip_camber - blade->root_camber);
    double stagger = blade->root_stagger + v * (blade->tip_stagger - blade->root_stagger);
    section_at(parameter[0], thickness, camber, blade->opening, at);
    double along = chord * (at[0] - AXIS_SHARE), across = chord * at[1];
    point[0] = along * cos(stagger) - across * sin(stagger) + blade->sweep * v * v;
    point[1] = along * sin(stagger) + across * cos(stagger) + 4 * blade->lean * v * (1 - v);
    point[2] = v;
}

/// The features of a face; those with x > 0 occur on both sides. Their sizes are random.
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

/// A smooth step from 0 to 1 at x = 0.
static double soft_step(double x, double length)
{
    return 0.5 + 0.5 * tanh(x / length);
}

/// The height of the nose, which widens and rises from the brow to its tip.
static double nose_height(double x, double y)
{
    double down = (0.34 - y) / 0.46, below_brow = soft_step(0.34 - y, 0.08), wide = 0.055 + 0.05 * down * below_brow;
    return (0.3 + 0.7 * down) * soft_step(y + 0.15, 0.035) * below_brow * exp(-x * x / (wide * wide));
}

/// The height of the band around the forehead: two rims, with folds between them.
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
    // The outline is narrower at the chin, and rounded above and below.
    double bulge = 1 - x * x;
    point[0] = x * (0.37 - 0.12 * (1 - parameter[1]) * (1 - parameter[1]));
    point[1] = 0.44 * y + bulge * (0.04 * parameter[1] - 0.07 * (1 - parameter[1]));
    point[2] = height;
}
