#ifndef RESEARCH_DATA_FILLET_H
#define RESEARCH_DATA_FILLET_H

#include "batten/research/curve_data.h"

/// @file
/// Geodesic polygons whose corners are replaced by arcs of geodesic circles.

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
    /// How far from its corner an arc begins, as a share of the shorter of both edges; above 0 and below 1/2.
    double share[FILLET_MAX_VERTICES];
} fillet_polygon;

/// A random polygon of 3 to 7 vertices, nearly even in angle, with radii from `low` to `high`.
fillet_polygon fillet_draw(bat_random *random, double low, double high);

/// Write `count` points of the rounded polygon, nearly even by length. Edges on the sphere must be shorter than pi.
/// @param points receives count x 2, on the sphere count x 3
void fillet_points(bat_tension_space space, const fillet_polygon *polygon, size_t count, double *points);

#endif
