#include "research/data/wave.h"
#include "research/shapes/surface_shape.h"

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

/// max(x, 0), rounded over a length: a branch of a hyperbola.
static double soft_ramp(double x, double length)
{
    return 0.5 * (x + sqrt(x * x + length * length));
}

/// The same from 0 at x = 0, with its corner at `from`.
static double ramp_from(double x, double from, double length)
{
    return soft_ramp(x - from, length) - soft_ramp(-from, length);
}

/// 1 at 0, falling like a bell over a length.
static double bell(double x, double length)
{
    return exp(-x * x / (length * length));
}

/// A station: two lines from the keel to the corner of the bilge and on to the deck edge, as half-breadths and heights, and
/// how much of it rounds the corner.
typedef struct hull_station
{
    double keel[2], corner[2], deck[2];
    double rounding;
} hull_station;

/// At the bow the corner moves up the stem to where the flare begins; at the stern the bottom rises to the transom.
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

/// The half-breadth and height at a share of a station: a hyperbola with the two lines as asymptotes, passed at nearly even
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
    // The bulb's waterlines begin on a circle: tanh^2 + sech^2 = 1.
    double bulb = bell(v - hull->bulb_height, 0.13), round = u / 0.03;
    double nose = hull->bulb_length * bulb / cosh(round);
    double swell = hull->bulb_radius * bulb * tanh(v / 0.08) * tanh(round) * bell(u, 0.2);
    // Above the line of the knuckle the flare turns back towards the vertical.
    double turned = ramp_from(v, 0.8, 0.008) * hull->knuckle * tanh(u / 0.04) * bell(u, 0.24);
    double overhang = hull->rake * v * v * v * bell(u, 0.2) - 0.02 * v * pow(u, 8);
    point[0] = 0.5 - u + nose + overhang;
    point[1] = across[0] + swell - turned;
    point[2] = across[1];
}
