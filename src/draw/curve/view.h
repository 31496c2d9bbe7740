#pragma once

#include "batten/curve.h"
#include "linalg/vector.h"

#include <cairo.h>

/// @file
/// Projections of spaces to the page in closed form.

// Simplification of paths on the page to a visible accuracy.

/// The receiver of a path, point by point; `begins`: the point begins a sub-path.
typedef struct path_sink
{
    void (*add)(void *context, double x, double y, bool begins);
    void *context;
} path_sink;

/// Simplifies a path in one pass with constant memory. The result consists of points of the path, with both ends of each
/// sub-path. No dropped point is farther than `tolerance` from the line drawn in its place.
///
/// From the last kept point, the anchor, the simplifier intersects the wedges of directions that pass all later points
/// within half the tolerance. When a point leaves the wedge or turns back, its predecessor becomes the next anchor (a greedy
/// form of the sector intersection of Imai and Iri).
typedef struct path_simplifier
{
    path_sink sink;
    double tolerance; ///< 0 keeps every point
    double anchor_x, anchor_y;
    double considered_x, considered_y; ///< the last point that was tested against the wedge
    double last_x, last_y;             ///< the last point of the path
    double left_x, left_y;             ///< the wedge is to the right of this direction …
    double right_x, right_y;           ///< … and to the left of this one
    bool wedge;                        ///< whether the wedge is defined
    double reach;                      ///< the largest distance from the anchor
    bool pending;                      ///< the last point is not drawn yet
} path_simplifier;

path_simplifier simplifier_begin(path_sink sink, double tolerance);
void simplifier_move(path_simplifier *simplifier, double x, double y);
void simplifier_consider(path_simplifier *simplifier, double x, double y);
/// Draw the pending point; call it at the end.
void simplifier_flush(path_simplifier *simplifier);

/// Continue the sub-path to (x, y). Points very near to their predecessor, as in dense curves, cost a few instructions.
static inline void simplifier_line(path_simplifier *simplifier, double x, double y)
{
    double dx = x - simplifier->considered_x, dy = y - simplifier->considered_y;
    double skip = 0.15 * simplifier->tolerance;
    simplifier->last_x = x;
    simplifier->last_y = y;
    simplifier->pending = true;
    if (dx * dx + dy * dy >= skip * skip)
        simplifier_consider(simplifier, x, y);
}

/// The spaces by the way they are drawn.
typedef enum view_space
{
    VIEW_PLANE, ///< R^n, n >= 2, n != 3; the first two coordinates
    VIEW_SOLID, ///< R^3
    VIEW_SPHERE,
    VIEW_DISK,
    VIEW_TENSOR,     ///< symmetric positive-definite matrices, 2 x 2 and 3 x 3, as ellipses and ellipsoids
    VIEW_ROTATION,   ///< drawn by a proxy in VIEW_SPHERE (see scene.h)
    VIEW_RIGID,      ///< drawn by a proxy in VIEW_SOLID
    VIEW_HYPERBOLIC, ///< the hyperboloid in R^3, drawn by a proxy in VIEW_DISK
    VIEW_NOTHING     ///< no picture
} view_space;

typedef enum view_kind
{
    VIEW_FLAT, ///< VIEW_PLANE and VIEW_SOLID
    VIEW_GLOBE,
    VIEW_LOCAL, ///< azimuthal equal-area
    VIEW_MAP,   ///< Equal Earth
    VIEW_POINCARE
} view_kind;

typedef enum view_side
{
    VIEW_FRONT,
    VIEW_BACK
} view_side;

/// A view maps a point to coordinates (u, v), to the right and upwards, and these to the page at (origin_x + scale u,
/// origin_y - scale v). On the globe and the disk u and v are in -1 … 1; on maps their unit is the radius of the sphere.
typedef struct draw_view
{
    view_kind kind;
    view_space space;
    size_t point_dim;
    double rotation[3][3]; ///< globe, local and solid: the rows are the directions to the right, upwards and to the eye;
                           ///< map: those of (longitude, latitude) (0, 0), (90, 0) degrees and of the pole
    double scale;
    double origin_x, origin_y;
    double tolerance; ///< the allowed error of curved edges on the page
    double borders;   ///< of a map, the share of the usual width at which borders are drawn; 0 for all of it
} draw_view;

view_space view_space_of(const bat_space *space);

/// Rotate a globe or a local view so that its centre is at `longitude` and `latitude`.
void view_set_globe(draw_view *view, double longitude, double latitude);
/// Rotate a map so that its middle meridian is at `longitude`.
void view_set_map(draw_view *view, double longitude);
/// Set the fixed rotation for R^3, seen from above: x to the right, y backwards, z upwards.
void view_set_solid(draw_view *view);

/// Compute (u, v) of a point.
/// @return whether the point is on the front; always true for views without a back
bool view_project(const draw_view *view, const double *point, double *u, double *v);
/// Compute the position of a point on the page; returns the same as view_project().
bool view_place(const draw_view *view, const double *point, double *x, double *y);
/// Rotate a point into the directions to the right, upwards and to the eye.
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

/// Lambert's azimuthal equal-area projection of a point with the centre at (0, 0, 1): (u, v) has the length
/// 2 sin(angle / 2). The antipode of the centre becomes (2, 0).
void view_equal_area(const double *rotated, double *u, double *v);
/// The point of a local view at (u, v); those beyond the antipode's circle become it.
void view_local_point(const draw_view *view, double u, double v, double *point);
/// The Equal Earth projection; the longitude may be outside of -pi … pi.
void view_equal_earth(double longitude, double latitude, double *u, double *v);
/// Half the width and half the height of the Equal Earth projection.
#define EQUAL_EARTH_HALF_WIDTH 2.7066299836960748
#define EQUAL_EARTH_HALF_HEIGHT 1.3173627591574134

/// Draw the geodesic polyline through `count` points. On a globe only the given side is drawn, cut at the outline; on a map
/// it is cut at the meridian opposite to the middle one. VIEW_BACK draws nothing in views without a back. `closed` adds the
/// edge from the last point to the first.
void view_trace(const draw_view *view, const double *points, size_t count, bool closed, view_side side,
                path_simplifier *path);

/// @name The parts of view_trace()
/// @{
void view_trace_globe(const draw_view *view, const double *points, size_t count, bool closed, view_side side,
                      path_simplifier *path);
/// VIEW_LOCAL and VIEW_MAP.
void view_trace_map(const draw_view *view, const double *points, size_t count, bool closed, path_simplifier *path);
/// @}

/// Where the boundary of a region lies.
typedef struct view_region
{
    bool inside;  ///< a part of it may be in the view
    bool outside; ///< the path leaves the view: the fill needs a clip
} view_region;

/// Append the region that the closed geodesic polylines of a polygon bound to cairo's path, for an even-odd fill, of a view
/// of R^2 or the sphere. Each ring encloses the side of smaller area. The path may leave the globe's outline or the map's
/// frame.
view_region view_trace_polygon(const draw_view *view, const bat_curve *const *rings, size_t count, cairo_t *cairo);

/// The automatic centre of the globe for checked curves on S^2, in radians: the direction of the mean of all points,
/// weighted by length. Where curves surround the sphere and the mean says little, a view that shows the best plane through
/// them obliquely, from the north.
void view_automatic(const bat_curve *const *curves, size_t count, double *longitude, double *latitude);

/// Check that a curve can be drawn. Messages name points by their index.
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT, BAT_CUT_LOCUS or BAT_UNSUPPORTED
bat_status view_check(const bat_curve *curve, bat_error *error);
