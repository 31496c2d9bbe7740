#ifndef DRAW_CURVE_STROKE_H
#define DRAW_CURVE_STROKE_H

#include "draw/common/style.h"
#include "draw/curve/view.h"

/// @file
/// Lines through the points of a space, however many.

/// Allowed error of lines on paper.
#define STROKE_TOLERANCE 0.05

/// A geodesic polyline as it is to be drawn.
typedef struct drawn_line
{
    const draw_view *view;
    const double *points;
    size_t count;
    bool closed;
    view_side side;
} drawn_line;

/// Stroke a line. One so rough that very many points are left is drawn as the ink it leaves.
bat_status stroke_line(cairo_t *cairo, const drawn_line *drawn, line_style line, bat_error *error);

#endif
