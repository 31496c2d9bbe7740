#include "research/data/wave.h"
#include "research/shapes/surface_shape.h"

#define BLADE_DEGREE (WAVE_PI / 180)
/// The nose of a section takes about this share of the way round.
#define NOSE_SHARE 0.12
/// The blade turns about this share of its chord.
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

/// The root of the place along the chord, 1 at u = 0, 0 at the nose, -1 at u = 1: such that the nose is passed at nearly the
/// speed of the flanks.
static double root_of_chord(double u)
{
    double way = 1 - 2 * u, whole = sqrt(sqrt(1 + NOSE_SHARE * NOSE_SHARE) + NOSE_SHARE);
    return way * whole / sqrt(sqrt(way * way + NOSE_SHARE * NOSE_SHARE) + NOSE_SHARE);
}

/// A section of chord 1 with the nose at 0. Half the thickness is that of a Joukowski aerofoil to first order, sqrt(x) (1 -
/// x), whose nose is a parabola, and the opening; it is laid above and below a parabola of camber.
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
