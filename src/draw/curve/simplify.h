#ifndef DRAW_CURVE_SIMPLIFY_H
#define DRAW_CURVE_SIMPLIFY_H

#include <stdbool.h>

/// @file
/// Simplification of paths on the page to a visible accuracy.

/// The receiver of a path: `move` begins a sub-path, `line` continues it.
typedef struct path_sink
{
    void (*move)(void *context, double x, double y);
    void (*line)(void *context, double x, double y);
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
    double dx = x - simplifier->considered_x;
    double dy = y - simplifier->considered_y;
    double skip = 0.15 * simplifier->tolerance;
    simplifier->last_x = x;
    simplifier->last_y = y;
    simplifier->pending = true;
    if (dx * dx + dy * dy >= skip * skip)
    {
        simplifier_consider(simplifier, x, y);
    }
}

#endif
