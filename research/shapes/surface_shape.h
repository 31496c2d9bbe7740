#ifndef RESEARCH_SHAPES_SURFACE_SHAPE_H
#define RESEARCH_SHAPES_SURFACE_SHAPE_H

#include "batten/base.h"

/// @file
/// Engineering shapes as formulas: surfaces over the unit square, about 1 long, z upwards. Every formula is smooth; S_u x
/// S_v points out of the body. Another draw gives another member of the family.

/// One side of a ship. The first parameter runs from bow to stern, the second along the stations from keel to deck edge:
/// flat bottom, bilge, side. x points forward, y outwards from the middle plane.
typedef struct hull_form
{
    double half_breadth, depth, sheer;            ///< midships; sheer: how much higher the deck is at the bow
    double entrance, deck_entrance;               ///< the lengths over which the bottom and the deck reach their breadth
    double rake;                                  ///< the overhang of the deck over the stem
    double bilge;                                 ///< the share of a station over which the bilge turns
    double bulb_length, bulb_radius, bulb_height; ///< the height as a share of the station
    double knuckle;                               ///< how far the side turns above the line of the knuckle
    double transom_height, rise_begin;            ///< of the bottom, which rises to the transom
    double transom_breadth;                       ///< as a share of the greatest breadth
} hull_form;

void hull_draw(bat_random *random, hull_form *hull);
void hull_at(const hull_form *hull, const double parameter[2], double point[3]);

/// A blade of a turbine, open at its blunt trailing edge. The first parameter runs from the trailing edge over the suction
/// side, round the leading edge and along the pressure side, the second from root to tip, which is upwards.
typedef struct blade_form
{
    double root_chord, tip_chord;
    double root_thickness, tip_thickness; ///< as shares of the chord
    double root_camber, tip_camber;       ///< likewise
    double root_stagger, tip_stagger;     ///< angles of the chord to the x axis
    double opening;                       ///< half the gap at the trailing edge, as a share of the chord
    double lean, sweep;                   ///< of the tip's middle, across and along
} blade_form;

void blade_draw(bat_random *random, blade_form *blade);
void blade_at(const blade_form *blade, const double parameter[2], double point[3]);

enum
{
    RELIEF_MAX_BUMPS = 24
};

/// A bump of a relief: height exp(-(x / wide)^2 - (y / high)^2) about its middle, in coordinates that run from -1 to 1.
typedef struct relief_bump
{
    double x, y, wide, high, height;
} relief_bump;

/// A mask in relief, which looks along z; its forehead wears a chased band.
typedef struct relief_form
{
    relief_bump bumps[RELIEF_MAX_BUMPS];
    int bump_count;
    double dome, nose;
    double chasing;    ///< the height of the ornament
    int chasing_folds; ///< across the band
} relief_form;

void relief_draw(bat_random *random, relief_form *relief);
void relief_at(const relief_form *relief, const double parameter[2], double point[3]);

/// Any of them.
typedef struct surface_shape
{
    void (*at)(const struct surface_shape *shape, const double parameter[2], double point[3]);
    union
    {
        hull_form hull;
        blade_form blade;
        relief_form relief;
    } form;
} surface_shape;

/// The shape that bat_cloud_shape() samples. False for an unknown name.
/// @param random receives the stream that sampling goes on with
bool surface_shape_make(const char *name, uint64_t seed, surface_shape *shape, bat_random *random);

#endif
