#ifndef DRAW_CURVE_VIEW_H
#define DRAW_CURVE_VIEW_H

#include "batten/curve.h"
#include "draw/curve/simplify.h"

/// @file
/// From points of a space to points on paper, in closed form and without the space's own functions.

/// The kinds of spaces that have pictures.
typedef enum view_space
{
    VIEW_PLANE, ///< R^n, n >= 2, n != 3; the first two coordinates
    VIEW_SOLID, ///< R^3
    VIEW_SPHERE,
    VIEW_DISK,
    VIEW_TENSOR,     ///< symmetric positive-definite 2 x 2 and 3 x 3 matrices: rows of ellipses and ellipsoids
    VIEW_ROTATION,   ///< by way of VIEW_SPHERE, as the next two by way of others: see proxy.h
    VIEW_RIGID,      ///< by way of VIEW_SOLID
    VIEW_HYPERBOLIC, ///< the hyperboloid in R^3, by way of VIEW_DISK
    VIEW_NOTHING     ///< no picture
} view_space;

typedef enum view_kind
{
    VIEW_FLAT, ///< of VIEW_PLANE and VIEW_SOLID
    VIEW_GLOBE,
    VIEW_MAP,
    VIEW_POINCARE
} view_kind;

/// Which half of a globe.
typedef enum view_side
{
    VIEW_FRONT,
    VIEW_BACK
} view_side;

/// A view turns a point into coordinates (u, v), u to the right and v upwards, and these into paper coordinates
/// (origin_x + scale u, origin_y - scale v). On the globe and the disk u and v run from -1 to 1, on the map they are
/// longitude and latitude.
typedef struct draw_view
{
    view_kind kind;
    view_space space;
    size_t point_dim;
    double rotation[3][3]; ///< globe and solid: rows point to the right, upwards and to the eye
    double scale;
    double origin_x, origin_y;
    double tolerance; ///< allowed error of curved edges on paper
} draw_view;

/// What can be drawn of a space.
view_space view_space_of(const bat_space *space);

/// The rotation of a globe whose middle is at `longitude` and `latitude`.
void view_set_globe(draw_view *view, double longitude, double latitude);
/// The fixed rotation for R^3: x to the right, y into the depth, z upwards, seen from above.
void view_set_solid(draw_view *view);

/// (u, v) of a point.
/// @return whether the point is on the front; always true where there is no back
bool view_project(const draw_view *view, const double *point, double *u, double *v);
/// The place of a point on paper; returns as view_project().
bool view_place(const draw_view *view, const double *point, double *x, double *y);
/// A point in coordinates that point to the right, upwards and to the eye.
static inline void view_rotate(const draw_view *view, const double *point, double *rotated)
{
    for (int i = 0; i < 3; i++)
    {
        const double *row = view->rotation[i];
        rotated[i] = row[0] * point[0] + row[1] * point[1] + row[2] * point[2];
    }
}

static inline double view_x(const draw_view *view, double u)
{
    return view->origin_x + view->scale * u;
}
static inline double view_y(const draw_view *view, double v)
{
    return view->origin_y - view->scale * v;
}

/// Draw the geodesic polyline through `count` points: the part on one side of a globe, cut at the limb; the whole elsewhere,
/// on a map cut at the antimeridian. VIEW_BACK draws nothing where there is no back. `closed` adds the edge from the last
/// point to the first.
void view_trace(const draw_view *view, const double *points, size_t count, bool closed, view_side side,
                path_simplifier *path);

/// @name The parts of view_trace()
/// @{
void view_trace_globe(const draw_view *view, const double *points, size_t count, bool closed, view_side side,
                      path_simplifier *path);
void view_trace_map(const draw_view *view, const double *points, size_t count, bool closed, path_simplifier *path);
void view_trace_disk(const draw_view *view, const double *points, size_t count, bool closed, path_simplifier *path);
/// @}

/// The middle of the globe for curves: see bat_curve_picture_view(). The points must have been checked.
void view_automatic(const bat_curve *const *curves, size_t count, double *longitude, double *latitude);

/// Check that a curve can be drawn. The texts name points by their index.
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT, BAT_CUT_LOCUS or BAT_UNSUPPORTED
bat_status view_check(const bat_curve *curve, bat_error *error);

#endif
