#pragma once

#include "surface/cloud/spatial_order.h"

/// @file
/// Planes fitted to neighbourhoods of points, by total least squares (principal component analysis), the choice of
/// neighbourhoods, quadratic polynomials over planes, and the noise of a cloud.

/// A plane through the mean of some points, spanned by their two principal axes of largest variance.
typedef struct local_plane
{
    double centre[3];
    double axes[3][3];  ///< orthonormal and right-handed: the two axes in the plane, larger variance first, then the normal
    double variance[3]; ///< variances along the axes, descending
} local_plane;

/// Fit a plane to the listed points, at least one.
/// @param points coordinates, 3 for each point; squares of differences must not overflow
local_plane local_plane_fit(const double *points, const neighbour_list *list);

/// Fit a plane to all points.
local_plane local_plane_fit_all(const double *points, size_t count);

/// Coordinates of the projection of a point to the plane, relative to an origin.
void local_plane_project(const local_plane *plane, const double origin[3], const double point[3], double foot[2]);

/// A translation and a scale by a power of two: x -> ldexp(x / 2 - middle / 2, exponent).
typedef struct unit_frame
{
    double middle[3];
    int exponent;
} unit_frame;

/// The frame in which all coordinates of some points are in [-1, 1].
unit_frame unit_frame_of(const double *points, size_t count);

/// The place of a point in a frame.
void unit_frame_place(const unit_frame *frame, const double point[3], double place[3]);

/// A copy of points, translated and scaled by a power of two so that all coordinates are in [-1, 1]. All axes have the same
/// scale. Release it with free(); null when out of memory.
double *points_to_unit_size(const double *points, size_t count);

enum
{
    NEIGHBOURHOOD_MIN = 16, ///< minimum number of points of a neighbourhood, including its centre
    NEIGHBOURHOOD_MAX = 400 ///< number of points at which the neighbourhood stops growing
};

/// The smallest neighbourhood whose standard deviation across its plane is at most half of the smaller one along it. The
/// number of nearest points is doubled until this holds or NEIGHBOURHOOD_MAX is reached. On a noisy surface, the result is
/// about a disc of four standard deviations of the noise.
/// @param points the points of the tree
/// @param wanted initial number of points, at least NEIGHBOURHOOD_MIN
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbourhood_find(const nearest_tree *tree, const double *points, const double place[3], size_t wanted,
                              neighbour_list *near, local_plane *plane, bat_error *error);

// Quadratic polynomials over tangent planes, by least squares.

#define LOCAL_QUADRATIC_TERMS 6 ///< of a quadratic polynomial of two variables

/// Heights z = t_0 + t_1 x + t_2 y + t_3 x^2 + t_4 x y + t_5 y^2, x and y relative to the centre, in units of `scale`.
typedef struct local_quadratic
{
    local_plane plane;
    double scale;
    double terms[LOCAL_QUADRATIC_TERMS]; ///< those that the points do not determine are 0
} local_quadratic;

/// Fit a polynomial to the listed points.
/// @param plane with positive variance along its first axis
local_quadratic local_quadratic_fit(const double *points, const neighbour_list *near, const local_plane *plane);

/// The height of a point above the polynomial, along the plane's normal.
double local_quadratic_height(const local_quadratic *quadratic, const double point[3]);

// Noise of a cloud, from residuals of local quadratic fits.

/// Estimate the standard deviation of a coordinate. Quadratic polynomials over local tangent planes are fitted to the
/// neighbours of up to 1,000 points. The estimate is the root of the median of their residual variances, divided by the
/// degrees of freedom and by the median of the distribution of chi squared (Wilson and Hilferty, 1931), so that creases and
/// outliers in less than half of the neighbourhoods do not count.
/// @param points of the tree
/// @return BAT_OK or BAT_NO_MEMORY
bat_status noise_estimate(const double *points, const nearest_tree *tree, double *sigma, bat_error *error);

// Consistently oriented tangent planes of a cloud.

typedef struct oriented_planes
{
    local_plane *planes; ///< count: right-handed, with consistent normals about which the boundary runs counter-clockwise
    size_t *reach;       ///< count: number of nearest points in each fit, including the point itself
    size_t conflicts;    ///< pairs of near neighbours with nearly parallel planes that stay turned against each other
} oriented_planes;

/// Fit a plane at each point and orient the normals consistently. Orientation propagates along a minimum spanning forest of
/// the neighbour graph, with the angles between planes as costs (Hoppe, DeRose, Duchamp, McDonald and Stuetzle, "Surface
/// reconstruction from unorganized points", 1992). The boundary, with the patch to its left, determines the sign by
/// majority. Components without boundary points keep an arbitrary sign.
/// @param tree the tree of the cloud's points
/// @return BAT_OK or BAT_NO_MEMORY; all zero on failure
bat_status oriented_planes_make(const bat_cloud *cloud, const nearest_tree *tree, oriented_planes *oriented,
                                bat_error *error);
void oriented_planes_free(oriented_planes *oriented);
