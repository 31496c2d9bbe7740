#ifndef DRAW_CURVE_STROKE_H
#define DRAW_CURVE_STROKE_H

#include "batten/base.h"
#include "draw/common/style.h"
#include "draw/curve/simplify.h"
#include "draw/curve/view.h"

#include <cairo.h>

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

/// @file
/// Lines so rough that they cover paper rather than run across it, by the cells they visit.
///
/// A wide pen that follows a line leaves nearly the same ink as the pen put on every cell of a fine grid that the line
/// visits, however many points the line has.

/// The side of a cell. A point of the line is at most 0.2 points from the middle of a cell that is kept: half a diagonal and
/// half a step along the line, (sqrt(1/2) + 1/8) 0.23.
#define COVERAGE_CELL 0.23

typedef struct coverage_map
{
    double low_x, low_y;
    size_t columns, rows;
    size_t stride; ///< words in a row
    uint64_t *words;
    double x, y; ///< the end of the line so far
} coverage_map;

/// An empty map of the paper from (low_x, low_y) to (high_x, high_y); release it with coverage_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status coverage_begin(double low_x, double low_y, double high_x, double high_y, coverage_map *map, bat_error *error);
/// A sink that marks the cells of a path, which must stay on the map.
path_sink coverage_sink(coverage_map *map);
/// Add the marked cells to cairo's current path, each run along a row as one line, to be stroked with round caps.
void coverage_trace(const coverage_map *map, cairo_t *cairo);
void coverage_free(coverage_map *map);

#endif
