#ifndef DRAW_CURVE_STROKE_H
#define DRAW_CURVE_STROKE_H

#include "batten/base.h"
#include "draw/common/style.h"
#include "draw/curve/simplify.h"
#include "draw/curve/view.h"

#include <cairo.h>

/// @file
/// Strokes of geodesic polylines with any number of points.

/// The allowed error of lines on the page.
#define STROKE_TOLERANCE 0.05

/// A geodesic polyline to be drawn.
typedef struct drawn_line
{
    const draw_view *view;
    const double *points;
    size_t count;
    bool closed;
    view_side side;
} drawn_line;

/// Stroke a polyline. If too many points remain after simplification, its coverage mask is drawn.
bat_status stroke_line(cairo_t *cairo, const drawn_line *drawn, line_style line, bat_error *error);

/// A coverage mask marks the cells of a fine grid that a very rough line visits. Strokes of the marked cells look like a
/// stroke of the line, whatever its number of points.

/// The side of a cell. A point of the line is at most 0.2 points from the centre of a marked cell: half a diagonal plus half
/// a step along the line, (sqrt(1/2) + 1/8) 0.23.
#define COVERAGE_CELL 0.23

typedef struct coverage_map
{
    double low_x, low_y;
    size_t columns, rows;
    size_t stride; ///< words in a row
    uint64_t *words;
    double x, y; ///< the current point of the line
} coverage_map;

/// Make an empty mask for the rectangle from (low_x, low_y) to (high_x, high_y); release it with coverage_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status coverage_begin(double low_x, double low_y, double high_x, double high_y, coverage_map *map, bat_error *error);
/// A sink that marks the cells of a path within the rectangle.
path_sink coverage_sink(coverage_map *map);
/// Append the marked cells to cairo's current path, each run in a row as one line, for strokes with round caps.
void coverage_free(coverage_map *map);

#endif
