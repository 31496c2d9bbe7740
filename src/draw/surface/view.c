#include "draw/surface/scene.h"

#include "linalg/vector.h"
#include "surface/cloud/local_plane.h"

#include <string.h>

/// @file
/// Automatic views of patches from their boundary, centroid and principal axes.

/// The tangents of the angles of the eye above the normal and to its left.
#define ABOVE 0.25
#define BESIDE 0.36
/// A patch is nearly closed when its vector area is below this fraction of a flat patch's area.
#define OPEN_SHARE 0.35
/// A patch bulges when its centroid is farther from its boundary's centroid than this fraction of its size.
#define BULGE_SHARE 0.01
/// A patch is deep where that distance exceeds this fraction of its size, and leans where the offset exceeds the second.
#define DEEP_SHARE 1.5
#define LEAN_SHARE 0.15

/// Orient the normal to the side where the patch bulges.
static void face_bulge(const patch_points *patch, const double bulge[3], double size, double normal[3])
{
    double outwards = vector3_dot(bulge, normal);
    int steepest = fabs(normal[0]) > fabs(normal[1]) ? 0 : 1;
    steepest = fabs(normal[2]) > fabs(normal[steepest]) ? 2 : steepest;
    bool bulges = patch->loop_count > 0 && fabs(outwards) > BULGE_SHARE * size;
    bool away = bulges ? outwards < 0 : patch->loop_count == 0 && normal[steepest] < 0;
    for (int c = 0; c < 3 && away; c++)
        normal[c] = -normal[c];
}

/// Choose the side to which a deep patch leans.
static void face_lean(const double bulge[3], double size, double normal[3])
{
    double deep = vector3_dot(bulge, normal), lean[3];
    for (int c = 0; c < 3; c++)
        lean[c] = bulge[c] - deep * normal[c];
    if (deep < DEEP_SHARE * size || sqrt(vector3_dot(lean, lean)) < LEAN_SHARE * deep || !vector3_normalize(lean))
        return;
    memcpy(normal, lean, sizeof lean);
}

/// Find the direction that the patch faces.
static void find_normal(const patch_points *patch, double normal[3])
{
    local_plane all = local_plane_fit_all(patch->points, patch->count);
    local_plane loop = local_plane_fit_all(patch->points, patch->loop_count);
    double bulge[3];
    normal[0] = normal[1] = normal[2] = 0; // its integral over any surface bounded by the loop
    for (size_t i = 0; i < patch->loop_count; i++)
    {
        double product[3];
        vector3_triangle(loop.centre, patch->points + 3 * i, patch->points + 3 * ((i + 1) % patch->loop_count), product);
        vector_add(3, 0.5, product, normal);
    }
    // A flat rectangle has variances side^2 / 12.
    double flat = 12 * sqrt(all.variance[0]) * sqrt(all.variance[1]);
    if (vector3_length(normal) < OPEN_SHARE * flat || !vector3_normalize(normal))
        memcpy(normal, all.axes[2], sizeof all.axes[2]);
    vector3_subtract(all.centre, loop.centre, bulge);
    face_bulge(patch, bulge, sqrt(all.variance[0]), normal);
    if (patch->loop_count > 0)
        face_lean(bulge, sqrt(all.variance[0]), normal);
}

static bool is_given(const double direction[3])
{
    return direction[0] != 0 || direction[1] != 0 || direction[2] != 0;
}

/// right = up x forward, or another perpendicular direction if both are parallel.
static void find_right(const double up[3], const double forward[3], double right[3])
{
    vector3_cross(up, forward, right);
    for (int axis = 0; axis < 3 && sqrt(vector3_dot(right, right)) < 1e-6 * sqrt(vector3_dot(up, up)); axis++)
    {
        const double other[3] = {axis == 1, axis == 0, axis == 2};
        vector3_cross(other, forward, right);
    }
    (void)vector3_normalize(right);
}

mesh_view surface_view_of(const patch_points *patch, const double direction[3], const double up[3])
{
    double normal[3], right[3], upwards[3], across[3], eye[3];
    find_normal(patch, normal);
    bool turned = is_given(direction), faces_z = fabs(normal[2]) > fabs(normal[1]);
    for (int c = 0; c < 3; c++)
        upwards[c] = is_given(up) ? up[c] : c == (faces_z ? 1 : 2);
    (void)vector3_normalize(upwards);
    // Without a boundary, a surface is not seen from below, but where it faces straight down.
    double below = patch->loop_count == 0 ? fmin(vector3_dot(normal, upwards), 0) : 0;
    if (below > -0.99)
        vector_add(3, -below, upwards, normal);
    (void)vector3_normalize(normal);
    find_right(upwards, normal, right);
    vector3_cross(normal, right, across);
    for (int c = 0; c < 3; c++)
        eye[c] = turned ? direction[c] : normal[c] + ABOVE * across[c] - BESIDE * right[c];
    (void)vector3_normalize(eye);
    find_right(upwards, eye, right);
    vector3_cross(eye, right, across);
    mesh_view view;
    for (int c = 0; c < 3; c++)
    {
        view.rotation[0][c] = right[c];
        view.rotation[1][c] = across[c];
        view.rotation[2][c] = eye[c];
    }
    return view;
}
