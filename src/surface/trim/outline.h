#ifndef SURFACE_TRIM_OUTLINE_H
#define SURFACE_TRIM_OUTLINE_H

#include "surface/trim/planar_chart.h"

/// @file
/// The outline and the holes of points in a plane: the boundary of an alpha shape (Edelsbrunner, Kirkpatrick and Seidel, "On
/// the shape of a set of points in the plane", 1983), with a radius that follows the local spacing.

/// Closed polygons through points of a chart. Release them with outline_free().
typedef struct outline_loops
{
    uint32_t *corners; ///< points, in the numbers of the chart
    size_t *first;     ///< count + 1: the first corner of each loop
    size_t count;      ///< the outline comes first, counter-clockwise; then holes, clockwise, the largest area first
    bool *filled;      ///< count: whether a hole is to be closed
    double area;       ///< of the surface within, in units of the scaled cloud
} outline_loops;

/// Find the loops.
/// @param fill holes of at most this diameter are to be closed, in units of the scaled cloud
/// @return BAT_OK; BAT_NO_CONVERGENCE for points in several pieces; BAT_NO_MEMORY
bat_status outline_find(const cloud_geometry *geometry, const planar_chart *chart, double fill, outline_loops *loops,
                        bat_error *error);
void outline_free(outline_loops *loops);

#endif
