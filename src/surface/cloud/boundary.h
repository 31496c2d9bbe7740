#pragma once

#include "linalg/vector.h"
#include "surface/cloud/local_plane.h"

/// @file
/// The boundary of a cloud, in three steps: what the cloud is, closed polygons along its edge, the choice of one.

// Detection of boundary loops of a cloud without connectivity: alpha shapes in tangent planes.
//
// A point x is on the boundary of the alpha shape if an empty disc of radius alpha touches it (Edelsbrunner, Kirkpatrick
// and Seidel, "On the shape of a set of points in the plane", 1983). Here each point uses its own tangent plane and a
// radius that follows the local spacing. The disc rolls from point to point along the boundary.

/// An interval of directions from a point in which the centre of an empty disc that touches the point may lie.
typedef struct alpha_boundary_arc
{
    double begin, end; ///< counter-clockwise angles; begin in [-pi, pi], end - begin in (0, 2 pi]
    uint32_t from, to; ///< the points that the disc also touches at begin and at end
} alpha_boundary_arc;

#define ALPHA_BOUNDARY_MAX_ARCS 8

/// The local geometry at a point.
typedef struct alpha_boundary_point
{
    local_plane plane; ///< tangent plane; its normal agrees with the reference
    double spacing;    ///< mean spacing of points in the plane
    double radius;     ///< radius of the disc
    size_t arc_count;
    alpha_boundary_arc arcs[ALPHA_BOUNDARY_MAX_ARCS];
} alpha_boundary_point;

/// A tangent plane that was found, without orientation.
typedef struct alpha_boundary_plane
{
    double axis[3], normal[3]; ///< orthonormal: the direction of largest variance, and the normal
    double deviation;          ///< standard deviation across the plane
    double spacing;            ///< mean spacing of points in the plane; 0: the plane is not known yet
} alpha_boundary_plane;

/// Points with what does not depend on the disc. Both arrays need free().
typedef struct alpha_boundary_cloud
{
    const double *points; ///< count x 3
    const nearest_tree *tree;
    alpha_boundary_plane *planes; ///< count: those of the points that are not in the interior by the quick test
    bool *outer;                  ///< count: points that a disc of scale 1 touches
    size_t outer_count;
    size_t plane_points; ///< least number of points of a plane
} alpha_boundary_cloud;

enum
{
    ALPHA_BOUNDARY_PLANE = 36,      ///< points of a plane by default,
    ALPHA_BOUNDARY_SMALL_PLANE = 16 ///< and for sharp bends
};

/// Find the points that discs touch.
/// @param plane_points least number of points of a plane
/// @param progress may be silent; cancels
/// @return BAT_OK, BAT_CANCELLED or BAT_NO_MEMORY; release `cloud` in all cases
bat_status alpha_boundary_cloud_make(const double *points, const nearest_tree *tree, size_t plane_points,
                                     bat_progress progress, alpha_boundary_cloud *cloud, bat_error *error);

/// The points, and the workspace of a search. Not thread-safe: every thread needs its own.
typedef struct alpha_boundary_search
{
    const double *points; ///< count x 3
    const nearest_tree *tree;
    alpha_boundary_plane *planes; ///< planes that are known; null: none are kept
    size_t plane_points;          ///< least number of points of a plane
    neighbour_list near;
    struct alpha_boundary_blocked *blocked;
    size_t blocked_capacity;
} alpha_boundary_search;

/// A closed polygon along the boundary.
typedef struct alpha_boundary_cycle
{
    uint32_t *points; ///< owned
    size_t count;
    double length;
    double extent; ///< the largest distance of a point from the mean of the points
} alpha_boundary_cycle;

/// All closed polygons, in a deterministic order.
typedef struct alpha_boundary_cycles
{
    alpha_boundary_cycle *cycles;
    size_t count, capacity;
} alpha_boundary_cycles;

/// Find all closed polygons with at least three different points along the boundary.
/// @param scale factor of the radius; traces begin at points that a disc of scale 1 touches
/// @return BAT_OK or BAT_NO_MEMORY; release `cycles` in both cases
bat_status alpha_boundary_cycles_find(const alpha_boundary_cloud *cloud, double scale, alpha_boundary_cycles *cycles,
                                      bat_error *error);

/// bat_cloud_find_boundary() that reports progress and may be cancelled.
/// @param scale factor of the radius of the disc
/// @return as that call, or BAT_CANCELLED; `cloud` is untouched on failure
bat_status cloud_find_boundary(bat_cloud *cloud, double scale, bat_progress progress, bat_error *error);

// Clouds that are not one patch of a surface: a test for each kind. Each returns BAT_NO_CONVERGENCE, with a text that says
// what the cloud is and what to do.

/// Whether the points lie along a straight line.
bat_status diagnose_line(const double *points, size_t count, bat_error *error);
/// Whether the points fill a volume: most neighbourhoods are about as thick as wide, small and large ones.
bat_status diagnose_volume(const double *points, const nearest_tree *tree, bat_error *error);
/// Whether the points lie on two parallel sheets that are closer than their points are: the heights of neighbours above a
/// quadratic polynomial have two modes, which makes their kurtosis small.
/// @param noise    standard deviation of these heights
/// @param spacing  mean spacing of the points
/// @param unit     length of a unit of the points in that of the cloud, for the text
bat_status diagnose_sheets(const double *points, const nearest_tree *tree, double noise, double spacing, double unit,
                           bat_error *error);

/// Whether the cloud has several pieces: components of the graph of near neighbours, without outliers.
/// @param kept  count; receives which points belong to the one piece
/// @param left  receives the number of the others
bat_status diagnose_pieces(const double *points, const nearest_tree *tree, bool *kept, size_t *left, bat_error *error);

// Triangulation of a cloud that is a topological disc: Cohen-Steiner and Da, "A greedy Delaunay-based surface
// reconstruction algorithm" (2004). Triangles of the Delaunay triangulation in space are added one by one at the edge of an
// oriented surface, the most plausible first: those that continue it smoothly with the smallest empty ball through their
// corners.
//
// The surface stays a sphere with holes: it never grows together where that would make a handle. Of its loops, the longest
// remains, and the others are filled. Points that are left over are put into the nearest triangles.

/// How triangles are chosen.
typedef struct advancing_front_options
{
    double scale;     ///< factor of the size of triangles that join points that are on the surface: with a smaller one gaps
                      ///< of the boundary stay open
    bool spares_thin; ///< thin parts, such as ankles, are not closed by small triangles across them
} advancing_front_options;

/// Triangulate a cloud.
/// @param cloud   made in canonical order (spatial_order.h); its boundary and its triangles are not used
/// @param disc    receives a cloud with the same points, a boundary, and triangles
/// @return BAT_OK; BAT_NO_CONVERGENCE without such triangulation; BAT_CANCELLED; BAT_NO_MEMORY; `disc` stays on failure
bat_status advancing_front_triangulate(const bat_cloud *cloud, advancing_front_options options, bat_progress progress,
                                       bat_cloud *disc, bat_error *error);
