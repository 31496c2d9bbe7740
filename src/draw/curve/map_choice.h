#ifndef DRAW_CURVE_MAP_CHOICE_H
#define DRAW_CURVE_MAP_CHOICE_H

#include "batten/curve_picture.h"

/// @file
/// What a picture shows of the sphere.

/// The projection of panels on the sphere and the part of it that is seen.
typedef struct map_choice
{
    bat_curve_projection projection; ///< never BAT_CURVE_PROJECTION_AUTO
    double longitude, latitude;      ///< globe, local and both: the centre
    double meridian;                 ///< map and both: the middle
    double low[2], high[2];          ///< local: the range of u and v
} map_choice;

/// Choose for checked curves on the sphere. `polygons` says whether any of them is a ring.
map_choice map_choose(const bat_curve *const *curves, size_t count, bool polygons, const bat_curve_picture_options *options);

#endif
