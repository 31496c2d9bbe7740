#ifndef DRAW_CURVE_SIMPLIFY_H
#define DRAW_CURVE_SIMPLIFY_H

#include <stdbool.h>

/// @file
/// Paths on paper, and thinning them to what an eye can see.

/// The receiver of a path: `move` begins a sub-path, `line` continues it.
typedef struct path_sink
{
    void (*move)(void *context, double x, double y);
    void (*line)(void *context, double x, double y);
    void *context;
} path_sink;

/// Thins a path in one pass with constant memory. Kept points are points of the path; the first and last of every sub-path
/// are kept; no dropped point is farther than `tolerance` from the line drawn in its place.
///
/// From the last kept point (the anchor) the simplifier follows the wedge of directions that pass all points since within
/// half the tolerance. A point that leaves the wedge, or turns back, makes its predecessor the next anchor. (The idea of
/// Imai and Iri's sector intersections, run greedily.)
typedef struct path_simplifier
{
    path_sink sink;
    double tolerance; ///< 0 keeps every point
    double anchor_x, anchor_y;
    double considered_x, considered_y; ///< the last point that went through the wedge
    double seen_x, seen_y;             ///< the last point of all
    double left_x, left_y;             ///< the wedge lies right of this direction …
    double right_x, right_y;           ///< … and left of this one
    bool wedge;                        ///< whether there is one yet
    double reach;                      ///< the largest distance from the anchor
    bool pending;                      ///< a point was seen that is not drawn yet
} path_simplifier;

path_simplifier simplifier_begin(path_sink sink, double tolerance);
void simplifier_move(path_simplifier *simplifier, double x, double y);
void simplifier_consider(path_simplifier *simplifier, double x, double y);
/// Draw what is pending. Call it at the end.
void simplifier_flush(path_simplifier *simplifier);

/// Continue the sub-path to (x, y). Points next to their predecessor, the bulk of a dense curve, cost a few instructions.
static inline void simplifier_line(path_simplifier *simplifier, double x, double y)
{
    double dx = x - simplifier->considered_x;
    double dy = y - simplifier->considered_y;
    double skip = 0.15 * simplifier->tolerance;
    simplifier->seen_x = x;
    simplifier->seen_y = y;
    simplifier->pending = true;
    if (dx * dx + dy * dy >= skip * skip)
    {
        simplifier_consider(simplifier, x, y);
    }
}

#endif
