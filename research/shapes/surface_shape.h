#ifndef RESEARCH_SHAPES_SURFACE_SHAPE_H
#define RESEARCH_SHAPES_SURFACE_SHAPE_H

#include "batten/base.h"

/// @file
/// Engineering surfaces as formulas over the unit square, about 1 long, z upwards. All are smooth, and S_u x S_v points out
/// of the body. Random parameters select a member of each family.

/// One side of a ship hull: u from bow to stern, v along the stations from keel to deck edge (flat bottom, bilge, side). x
/// points forward, y outwards from the centre plane.
typedef struct hull_form
{
    double half_breadth, depth, sheer; ///< midship dimensions; sheer: height of the deck at the bow above midships
    double entrance, deck_entrance;    ///< lengths over which bottom and deck reach their breadth
    double rake;                       ///< overhang of the deck over the stem
    double bilge;                      ///< fraction of a station over which the bilge turns
    double bulb_length, bulb_radius, bulb_height; ///< height as a fraction of the station
    double knuckle;                               ///< change of slope of the side above the knuckle line
    double transom_height, rise_begin;            ///< rise of the bottom towards the transom
    double transom_breadth;                       ///< breadth of the transom, as a fraction of the maximum
} hull_form;

void hull_draw(bat_random *random, hull_form *hull);
void hull_at(const hull_form *hull, const double parameter[2], double point[3]);

/// A turbine blade, open at its blunt trailing edge: u from the trailing edge over the suction side, around the leading edge
/// and along the pressure side; v from root to tip, along z.
typedef struct blade_form
{
    double root_chord, tip_chord;
    double root_thickness, tip_thickness; ///< thickness, as fractions of the chord
    double root_camber, tip_camber;       ///< camber, as fractions of the chord
    double root_stagger, tip_stagger;     ///< angles between the chord and the x axis
    double opening;                       ///< half the gap at the trailing edge, as a fraction of the chord
    double lean, sweep;                   ///< displacement of the tip, across and along the chord
} blade_form;

void blade_draw(bat_random *random, blade_form *blade);
void blade_at(const blade_form *blade, const double parameter[2], double point[3]);

enum
{
    RELIEF_MAX_BUMPS = 24
};

/// A bump of a relief: height exp(-(x / wide)^2 - (y / high)^2) about its centre, in coordinates from -1 to 1.
typedef struct relief_bump
{
    double x, y, wide, high, height;
} relief_bump;

/// A face in relief that looks along z, with an ornamental band on its forehead.
typedef struct relief_form
{
    relief_bump bumps[RELIEF_MAX_BUMPS];
    int bump_count;
    double dome, nose;
    double chasing;    ///< height of the ornament
    int chasing_folds; ///< number of folds of the ornament
} relief_form;

void relief_draw(bat_random *random, relief_form *relief);
void relief_at(const relief_form *relief, const double parameter[2], double point[3]);

/// A surface of any family.
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

/// The surface that bat_cloud_shape() samples. False for an unknown name.
/// @param random receives the stream from which sampling continues
bool surface_shape_make(const char *name, uint64_t seed, surface_shape *shape, bat_random *random);

#endif
