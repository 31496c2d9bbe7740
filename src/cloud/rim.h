#ifndef CLOUD_RIM_H
#define CLOUD_RIM_H

#include "cloud/local_plane.h"
#include "cloud/neighbours.h"

/// @file
/// Where the rim of a cloud without connectivity runs: by rolling a disc around it in the tangent plane of each point. A point is on the
/// rim when a disc can touch it that has no point inside (Edelsbrunner, Kirkpatrick and Seidel, "On the shape of a set of points in
/// the plane", 1983); the disc's size follows the points' spacing.

/// The directions, seen from a point, in which the centre of an empty disc may lie that touches it.
typedef struct rim_arc
{
    double begin, end; ///< counter-clockwise; begin is between -pi and pi, end above it by at most 2 pi
    uint32_t from, to; ///< the points that the disc touches too at the begin and at the end
} rim_arc;

enum
{
    RIM_MOST_ARCS = 8
};

/// What the cloud looks like around a point.
typedef struct rim_point
{
    local_plane plane; ///< around the point, its normal as a reference asks
    double spacing;    ///< of points in the plane
    double radius;     ///< of the disc
    size_t arc_count;
    rim_arc arcs[RIM_MOST_ARCS];
} rim_point;

/// Points whose rim is sought, and room to work in; every thread needs its own.
typedef struct rim_search
{
    const double *points; ///< rows of 3
    const neighbour_tree *tree;
    neighbour_list near;
    struct rim_shadow *shadows;
    size_t shadow_capacity;
} rim_search;

void rim_search_free(rim_search *search);

/// Look at a point.
/// @param reference the side that the normal shall be on; null for any
/// @param scale     of the disc; 1: as the spacing asks
/// @return BAT_OK or BAT_NO_MEMORY
bat_status rim_point_find(rim_search *search, uint32_t point, const double *reference, double scale, rim_point *found,
                          bat_error *error);

/// Whether a few neighbours show already that no disc can touch a point: where they lie in a plane, all around it.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status rim_point_is_inside(rim_search *search, uint32_t point, bool *inside, bat_error *error);

/// A closed line along the rim.
typedef struct rim_cycle
{
    uint32_t *points; ///< owned
    size_t count;
    double length;
    double extent; ///< the greatest distance of a point from their mean
} rim_cycle;

/// All closed lines, in no order that matters but always the same.
typedef struct rim_cycles
{
    rim_cycle *cycles;
    size_t count, capacity;
} rim_cycles;

void rim_cycles_free(rim_cycles *cycles);

/// Find all closed lines of at least three different points along the rim.
/// @return BAT_OK or BAT_NO_MEMORY; to be freed in any case
bat_status rim_cycles_find(const double *points, const neighbour_tree *tree, rim_cycles *cycles, bat_error *error);

#endif
