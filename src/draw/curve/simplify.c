#include "draw/curve/view.h"

/// @file
/// The wedge of admissible directions, updated point by point.

path_simplifier simplifier_begin(path_sink sink, double tolerance)
{
    return (path_simplifier){.sink = sink, .tolerance = tolerance};
}

static void set_anchor(path_simplifier *simplifier, double x, double y)
{
    simplifier->anchor_x = x;
    simplifier->anchor_y = y;
    simplifier->wedge = false;
    simplifier->reach = 0.0;
}

void simplifier_flush(path_simplifier *simplifier)
{
    if (simplifier->pending)
    {
        simplifier->sink.add(simplifier->sink.context, simplifier->last_x, simplifier->last_y, false);
        simplifier->pending = false;
    }
}

void simplifier_move(path_simplifier *simplifier, double x, double y)
{
    simplifier_flush(simplifier);
    simplifier->sink.add(simplifier->sink.context, x, y, true);
    simplifier->considered_x = simplifier->last_x = x;
    simplifier->considered_y = simplifier->last_y = y;
    set_anchor(simplifier, x, y);
}

static double cross(double ax, double ay, double bx, double by)
{
    return ax * by - ay * bx;
}

/// Intersect the wedge with the directions from the anchor that pass within `margin` of (dx, dy), which is `distance` away.
static void narrow_wedge(path_simplifier *simplifier, double dx, double dy, double distance, double margin)
{
    double sine = margin / distance, cosine = sqrt(1.0 - sine * sine);
    double left_x = cosine * dx - sine * dy;
    double left_y = sine * dx + cosine * dy;
    double right_x = cosine * dx + sine * dy;
    double right_y = cosine * dy - sine * dx;
    if (!simplifier->wedge || cross(left_x, left_y, simplifier->left_x, simplifier->left_y) > 0.0)
    {
        simplifier->left_x = left_x;
        simplifier->left_y = left_y;
    }
    if (!simplifier->wedge || cross(simplifier->right_x, simplifier->right_y, right_x, right_y) > 0.0)
    {
        simplifier->right_x = right_x;
        simplifier->right_y = right_y;
    }
    simplifier->wedge = true;
}

/// The total error is half the tolerance across the line, 0.3 beyond its end, 0.15 twice for skipped points: below 1.
void simplifier_consider(path_simplifier *simplifier, double x, double y)
{
    double margin = 0.5 * simplifier->tolerance;
    double dx = x - simplifier->anchor_x, dy = y - simplifier->anchor_y;
    double distance = hypot(dx, dy);
    bool inside = !simplifier->wedge || (cross(simplifier->right_x, simplifier->right_y, dx, dy) >= 0.0 &&
                                         cross(dx, dy, simplifier->left_x, simplifier->left_y) >= 0.0);
    bool onwards = distance >= simplifier->reach - 0.3 * simplifier->tolerance;
    bool first = simplifier->reach == 0.0;
    if (!first && (!inside || !onwards || simplifier->tolerance == 0.0))
    {
        simplifier->sink.add(simplifier->sink.context, simplifier->considered_x, simplifier->considered_y, false);
        set_anchor(simplifier, simplifier->considered_x, simplifier->considered_y);
        dx = x - simplifier->anchor_x;
        dy = y - simplifier->anchor_y;
        distance = hypot(dx, dy);
    }
    simplifier->reach = fmax(simplifier->reach, distance);
    if (distance > margin)
        narrow_wedge(simplifier, dx, dy, distance, margin);
    simplifier->considered_x = x;
    simplifier->considered_y = y;
}
