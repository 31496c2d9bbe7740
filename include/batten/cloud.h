#ifndef BATTEN_CLOUD_H
#define BATTEN_CLOUD_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Clouds: scattered points that sample a patch of a surface, their boundary, and parameters of the boundary.

/// Points that sample a patch of a surface. Boundary points come first, in order around the loop.
/// Release it with bat_cloud_free().
typedef struct bat_cloud
{
    double *points; ///< count x 3, owned
    size_t count;
    size_t boundary_count; ///< 0 while the boundary is not known; else at least 4
    size_t corners[4];     ///< increasing indices into the loop: the points with parameters (0, 0), (1, 0), (1, 1), (0, 1)
    bool has_corners;
    size_t *order;       ///< count: the index of each point in the input; null: the same order. Owned
    uint32_t *triangles; ///< triangle_count x 3, of a cloud made from a mesh; null for none. Owned
    size_t triangle_count;
    size_t duplicates; ///< points of the input that were left out because they repeat another
} bat_cloud;

/// Free what a cloud owns and make it empty.
BAT_API void bat_cloud_free(bat_cloud *cloud);
/// Copy a cloud with all it owns.
/// @return BAT_OK or BAT_NO_MEMORY; `copy` is untouched on failure
BAT_API bat_status bat_cloud_copy(const bat_cloud *cloud, bat_cloud *copy, bat_error *error);

/// Check the conditions of every call that takes a cloud. Points are finite and distinct. A boundary has at least 4 points.
/// Corners are increasing indices of boundary points. Triangles name existing points.
/// @return BAT_OK; BAT_INVALID_ARGUMENT for no points, a boundary of 1 to 3 points, or wrong corners; BAT_INVALID_POINT with
///         the index in the input of a point that is not finite or repeats another; BAT_NO_MEMORY
BAT_API bat_status bat_cloud_check(const bat_cloud *cloud, bat_error *error);

/// Make a cloud from a mesh with one boundary loop. The loop comes first, and the triangles stay.
/// The loop begins at its vertex of lowest index and has the patch to its left, seen from outside. The other vertices keep
/// their order. Vertices without a face are left out.
/// @return BAT_OK; BAT_UNSUPPORTED for a mesh that is closed or has several loops, several parts or handles; the failures of
///         bat_mesh_connect() and bat_cloud_check(); BAT_NO_MEMORY; `cloud` is untouched on failure
BAT_API bat_status bat_cloud_from_mesh(const bat_mesh *mesh, bat_cloud *cloud, bat_error *error);

/// Find the boundary loop of a cloud without connectivity, and move its points to the front.
/// The loop is the alpha-shape boundary of Edelsbrunner, Kirkpatrick and Seidel (1983) in the tangent plane of each point.
/// The radius is larger than the local spacing of the points. The loop begins at its point of lowest index; all others keep
/// their order. Small gaps and outliers are ignored. Where noise exceeds the spacing, the loop has fewer points. A known
/// boundary and known corners are dropped.
/// @return BAT_OK; BAT_NO_CONVERGENCE for no single loop, with a text that describes what was found; the failures of
///         bat_cloud_check(); BAT_NO_MEMORY; `cloud` is untouched on failure
BAT_API bat_status bat_cloud_find_boundary(bat_cloud *cloud, bat_error *error);

/// Estimate the noise of a cloud: the standard deviation of a coordinate, from residuals of quadratic polynomials that are
/// fitted to local neighbourhoods.
/// @return BAT_OK, the failures of bat_cloud_check() or BAT_NO_MEMORY
BAT_API bat_status bat_cloud_noise(const bat_cloud *cloud, double *sigma, bat_error *error);

/// Find four corners: the points of the loop with the sharpest turns towards the patch, measured in its tangent plane.
/// Turns are measured over chords of about 1/30 of the loop, so that noise does not count. Two corners are at least 1/40 of
/// the loop apart. A loop without corners is split into four parts of equal length.
/// @return BAT_OK, BAT_INVALID_ARGUMENT (no boundary) or BAT_NO_MEMORY
BAT_API bat_status bat_cloud_find_corners(bat_cloud *cloud, bat_error *error);

/// Set the points that are the corners (0, 0), (1, 0), (1, 1), (0, 1). The loop then begins with the first corner. It is
/// reversed where the corners follow each other in the other direction.
/// @param corners indices of points in the input, counted from 0
/// @return BAT_OK; BAT_INVALID_ARGUMENT for points off the boundary or in another order; BAT_NO_MEMORY
BAT_API bat_status bat_cloud_set_corners(bat_cloud *cloud, const size_t corners[4], bat_error *error);

/// The parameterization of the four sides of the boundary.
typedef enum bat_cloud_sides
{
    BAT_CLOUD_SIDES_AUTO,         ///< the default: BAT_CLOUD_SIDES_CHORD_LENGTH
    BAT_CLOUD_SIDES_CHORD_LENGTH, ///< in proportion to distance
    BAT_CLOUD_SIDES_CENTRIPETAL,  ///< in proportion to its square root: Lee (1989)
    BAT_CLOUD_SIDES_UNIFORM       ///< in proportion to the index
} bat_cloud_sides;

/// The choices by name.
extern BAT_API const bat_family bat_cloud_sides_family;

/// Compute parameters of the boundary points: sides of the cloud go to the sides of [0, 1]^2. Missing corners are found
/// first.
/// @param parameters receives boundary_count x 2
/// @return BAT_OK, BAT_INVALID_ARGUMENT (no boundary, no such method) or the failures of bat_cloud_find_corners()
BAT_API bat_status bat_cloud_boundary_parameters(const bat_cloud *cloud, bat_cloud_sides method, double *parameters,
                                                 bat_error *error);

BAT_C_END

#endif
