#ifndef BATTEN_CLOUD_H
#define BATTEN_CLOUD_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Clouds of scattered points that stand for a patch of surface, their boundary, and its parameters.

/// Points of a patch of surface: boundary points first, in order around the loop. Release it with bat_cloud_free().
typedef struct bat_cloud
{
    double *points; ///< count x 3, owned
    size_t count;
    size_t boundary_count; ///< 0 while the boundary is not known; else at least 4
    size_t corners[4];     ///< rising places in the loop: parameters (0, 0), (1, 0), (1, 1), (0, 1)
    bool has_corners;
    size_t *order;       ///< count: each point's place in the input; null: as they were. Owned
    uint32_t *triangles; ///< triangle_count x 3 where the cloud was a mesh; null for none. Owned
    size_t triangle_count;
} bat_cloud;

BAT_API void bat_cloud_free(bat_cloud *cloud);
BAT_API bat_status bat_cloud_copy(const bat_cloud *cloud, bat_cloud *copy, bat_error *error);

/// Check what every call that takes a cloud relies on: points that are finite and no two of which are the same, a boundary
/// of at least 4 points, rising corners within it, triangles of points that exist.
/// @return BAT_OK; BAT_INVALID_ARGUMENT for no points, a boundary of 1 to 3 or beyond the points, wrong corners;
/// BAT_INVALID_POINT with
///         the point's place in the input that is not finite or repeats another; BAT_NO_MEMORY
BAT_API bat_status bat_cloud_check(const bat_cloud *cloud, bat_error *error);

/// Make a cloud of a mesh with one boundary loop: the loop comes first, the triangles stay.
/// The loop begins at its lowest vertex and has the patch to its left, seen from outside; the others follow in their order.
/// Vertices without a face are left out.
/// @return BAT_OK; BAT_UNSUPPORTED for a mesh that is closed, has several loops, several parts or handles; what
/// bat_mesh_connect()
///         and bat_cloud_check() return; BAT_NO_MEMORY; `cloud` is untouched on failure
BAT_API bat_status bat_cloud_from_mesh(const bat_mesh *mesh, bat_cloud *cloud, bat_error *error);

/// Find the loop of boundary points in a cloud without connectivity, and bring it to the front: a disc, larger than the
/// spacing of the points there, rolls around the cloud in the tangent plane of each point (the alpha shape of Edelsbrunner,
/// Kirkpatrick and Seidel, 1983, in local planes), and the loop is of the points that it touches. It begins at its lowest
/// point; all others keep their order. Small gaps and stray points are passed over. Where noise is thicker than the spacing,
/// the loop is one of fewer points. A boundary that was known is forgotten, as are corners.
/// @return BAT_OK; BAT_NO_CONVERGENCE when no single loop is found, the text saying what was; what bat_cloud_check()
/// returns;
///         BAT_NO_MEMORY; `cloud` is untouched on failure
BAT_API bat_status bat_cloud_find_boundary(bat_cloud *cloud, bat_error *error);

/// Find four corners: the places of the loop where it turns most sharply towards the patch, in the patch's tangent plane and
/// over chords of about a thirtieth of the loop, so that teeth do not count; no two closer than a fortieth of its length. A
/// loop without corners is split in four equal lengths. Corners keep the order of the loop, which is taken as it is.
/// @return BAT_OK, BAT_INVALID_ARGUMENT (no boundary) or BAT_NO_MEMORY
BAT_API bat_status bat_cloud_find_corners(bat_cloud *cloud, bat_error *error);

/// Say which points are the corners (0, 0), (1, 0), (1, 1), (0, 1). The loop is turned so that it begins with the first one,
/// and runs the other way round where that is how the four follow each other.
/// @param corners points by their place in the input, counted from 0
/// @return BAT_OK; BAT_INVALID_ARGUMENT for points off the boundary or in another order; BAT_NO_MEMORY
BAT_API bat_status bat_cloud_set_corners(bat_cloud *cloud, const size_t corners[4], bat_error *error);

/// How points of a side get their parameters.
typedef enum bat_cloud_sides
{
    BAT_CLOUD_SIDES_CHORD_LENGTH, ///< in proportion to distance (default)
    BAT_CLOUD_SIDES_CENTRIPETAL,  ///< to its root: Lee (1989)
    BAT_CLOUD_SIDES_UNIFORM       ///< to their number
} bat_cloud_sides;

/// A choice by name.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names them all
BAT_API bat_status bat_cloud_sides_by_name(const char *name, bat_cloud_sides *value, bat_error *error);
/// The name. Never null.
BAT_API const char *bat_cloud_sides_name(bat_cloud_sides value);
/// The table, row by row; `index` from 0 on.
/// @return false past the last
BAT_API bool bat_cloud_sides_list(size_t index, bat_choice *choice);

/// Parameters of the boundary points: corners go to the corners of [0, 1]^2, sides to its sides. Corners are found where the
/// cloud has none.
/// @param parameters receives boundary_count x 2
BAT_API bat_status bat_cloud_boundary_parameters(const bat_cloud *cloud, bat_cloud_sides method, double *parameters,
                                                 bat_error *error);

BAT_C_END

#endif
