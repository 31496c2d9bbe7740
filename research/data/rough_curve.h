#ifndef RESEARCH_DATA_ROUGH_CURVE_H
#define RESEARCH_DATA_ROUGH_CURVE_H

#include "batten/base.h"

/// @file
/// Random plane curves of every roughness, like those of maps, tracks and drawings: closed curves with a power spectrum from
/// smooth to fractal, open curves whose direction has such a spectrum, polygons with sharp and rounded corners, and outlines
/// of strokes made of lines and arcs.

typedef enum rough_family
{
    ROUGH_RADIAL,    ///< closed: an ellipse with a radius of random spectrum, like an island
    ROUGH_SPECTRAL,  ///< closed: both coordinates of random spectrum
    ROUGH_DIRECTION, ///< open: a direction of random spectrum, like a track, a meander or a shore
    ROUGH_CORNERS,   ///< closed: a polygon, each corner sharp or rounded by a parabola
    ROUGH_STROKE,    ///< closed: the outline of a stroke of lines and arcs with flat ends
    ROUGH_PIECES,    ///< open: straight lines, arcs and rough pieces with corners between them, like a border or a railway
    ROUGH_COUNT
} rough_family;

/// Draw a curve of a family: `count` points, evenly spaced along the curve, of mean 0 and largest norm 1.
/// @param count  at most SIMPLIFY_MAX_POINTS
/// @param points receives count x 2
/// @return whether the curve is closed
bool rough_curve_draw(rough_family family, bat_random *random, size_t count, double *points);

/// Replace a curve by the polyline through `corners` of its points, as maps and recordings are: `count` points of it, evenly
/// spaced, of mean 0 and largest norm 1.
/// @param corners at least 4, at most `count`
void rough_curve_simplify(bat_random *random, bool closed, size_t corners, size_t count, double *points);

#endif
