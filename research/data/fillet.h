#ifndef RESEARCH_DATA_FILLET_H
#define RESEARCH_DATA_FILLET_H

#include "batten/research/curve_data.h"

/// @file
/// Random geodesic polygons with corners rounded by arcs of geodesic circles.

enum
{
    FILLET_MAX_VERTICES = 8
};

/// A polygon in geodesic polar coordinates about the origin of the plane or disk, or about (0, 0, 1).
typedef struct fillet_polygon
{
    int count; ///< vertices, 3 … FILLET_MAX_VERTICES
    double radius[FILLET_MAX_VERTICES];
    double angle[FILLET_MAX_VERTICES];
    /// Distance from the corner to the begin of its arc, as a fraction of the shorter adjacent edge; between 0 and 1/2.
    double share[FILLET_MAX_VERTICES];
} fillet_polygon;

/// Draw a polygon with 3 to 7 vertices, at nearly equal angles, and radii from `low` to `high`.
fillet_polygon fillet_draw(bat_random *random, double low, double high);

/// Sample the rounded polygon at `count` points, nearly equally spaced. Edges on the sphere must be shorter than pi.
/// @param points receives count x 2, on the sphere count x 3
void fillet_points(bat_tension_space space, const fillet_polygon *polygon, size_t count, double *points);

#endif
