#ifndef SURFACE_CLOUD_ALPHA_BOUNDARY_H
#define SURFACE_CLOUD_ALPHA_BOUNDARY_H

#include "surface/cloud/local_plane.h"
#include "surface/cloud/neighbours.h"

/// @file
/// Where the rim of a cloud without connectivity runs: by rolling a disc around it in the tangent plane of each point. A
/// point is on the rim when a disc can touch it that has no point inside (Edelsbrunner, Kirkpatrick and Seidel, "On the
/// shape of a set of points in the plane", 1983); the disc's size follows the points' spacing.

/// The directions, seen from a point, in which the centre of an empty disc may lie that touches it.
typedef struct alpha_boundary_arc
{
    double begin, end; ///< counter-clockwise; begin is between -pi and pi, end above it by at most 2 pi
    uint32_t from, to; ///< the points that the disc touches too at the begin and at the end
} alpha_boundary_arc;

enum
{
    ALPHA_BOUNDARY_MAX_ARCS = 8
};

/// What the cloud looks like around a point.
typedef struct alpha_boundary_point
{
    local_plane plane; ///< around the point, its normal as a reference asks
    double spacing;    ///< of points in the plane
    double radius;     ///< of the disc
    size_t arc_count;
    alpha_boundary_arc arcs[ALPHA_BOUNDARY_MAX_ARCS];
} alpha_boundary_point;

/// Points whose rim is sought, and room to work in; every thread needs its own.
typedef struct alpha_boundary_search
{
    const double *points; ///< rows of 3
    const neighbour_tree *tree;
    neighbour_list near;
    struct alpha_boundary_blocked *blocked;
    size_t blocked_capacity;
} alpha_boundary_search;

void alpha_boundary_search_free(alpha_boundary_search *search);

/// Look at a point.
/// @param reference the side that the normal shall be on; null for any
/// @param scale     of the disc; 1: as the spacing asks
/// @return BAT_OK or BAT_NO_MEMORY
bat_status alpha_boundary_point_find(alpha_boundary_search *search, uint32_t point, const double *reference, double scale,
                                     alpha_boundary_point *found, bat_error *error);

/// Whether a few neighbours show already that no disc can touch a point: where they lie in a plane, all around it.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status alpha_boundary_point_is_inside(alpha_boundary_search *search, uint32_t point, bool *inside, bat_error *error);

/// A closed line along the rim.
typedef struct alpha_boundary_cycle
{
    uint32_t *points; ///< owned
    size_t count;
    double length;
    double extent; ///< the greatest distance of a point from their mean
} alpha_boundary_cycle;

/// All closed lines, in no order that matters but always the same.
typedef struct alpha_boundary_cycles
{
    alpha_boundary_cycle *cycles;
    size_t count, capacity;
} alpha_boundary_cycles;

void alpha_boundary_cycles_free(alpha_boundary_cycles *cycles);

/// Find all closed lines of at least three different points along the rim.
/// @return BAT_OK or BAT_NO_MEMORY; to be freed in any case
bat_status alpha_boundary_cycles_find(const double *points, const neighbour_tree *tree, alpha_boundary_cycles *cycles,
                                      bat_error *error);

#endif
