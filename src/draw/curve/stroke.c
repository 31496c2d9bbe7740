#include "draw/curve/scene.h"

/// @file
/// Strokes through a path simplifier, and coverage masks for lines that remain too long.

bat_status coverage_begin(double low_x, double low_y, double high_x, double high_y, coverage_map *map, bat_error *error)
{
    coverage_map made = {.low_x = low_x, .low_y = low_y, .x = low_x, .y = low_y};
    made.columns = (size_t)((high_x - low_x) / COVERAGE_CELL) + 1;
    made.rows = (size_t)((high_y - low_y) / COVERAGE_CELL) + 1;
    made.stride = made.columns / 64 + 1;
    if (array_zeros(&made.words, made.rows, made.stride * sizeof *made.words, error) != BAT_OK)
        return BAT_NO_MEMORY;
    *map = made;
    return BAT_OK;
}

void coverage_free(coverage_map *map)
{
    free(map->words);
    *map = (coverage_map){0};
}

static void mark(coverage_map *map, double x, double y)
{
    size_t column = (size_t)((x - map->low_x) * (1.0 / COVERAGE_CELL));
    size_t row = (size_t)((y - map->low_y) * (1.0 / COVERAGE_CELL));
    column = column < map->columns ? column : map->columns - 1;
    row = row < map->rows ? row : map->rows - 1;
    map->words[row * map->stride + column / 64] |= (uint64_t)1 << column % 64;
}

/// Lines are marked in steps of a quarter of a cell.
static void mark_to(void *context, double x, double y, bool begins)
{
    coverage_map *map = context;
    double dx = x - map->x, dy = y - map->y;
    double steps = ceil(sqrt(dx * dx + dy * dy) * (4.0 / COVERAGE_CELL));
    double step_x = dx / steps, step_y = dy / steps;
    for (double i = 1.0; i < steps && !begins; i += 1.0)
        mark(map, map->x + i * step_x, map->y + i * step_y);
    mark(map, x, y);
    map->x = x;
    map->y = y;
}

path_sink coverage_sink(coverage_map *map)
{
    return (path_sink){mark_to, map};
}

static void coverage_trace(const coverage_map *map, cairo_t *cairo)
{
    for (size_t row = 0; row < map->rows; row++)
    {
        double y = map->low_y + ((double)row + 0.5) * COVERAGE_CELL;
        for (size_t column = 0; column < map->columns; column++)
        {
            size_t first = column;
            while (column < map->columns && (map->words[row * map->stride + column / 64] >> column % 64 & 1u) != 0)
                column++;
            if (column > first)
                style_segment(cairo, map->low_x + ((double)first + 0.5) * COVERAGE_CELL, y,
                              map->low_x + ((double)column - 0.5) * COVERAGE_CELL, y);
        }
    }
}

/// Lines with more points after simplification are drawn by a coverage mask.
#define MANY_POINTS 30000

/// A sink that appends to cairo's current path, up to MANY_POINTS, and counts and measures all points.
typedef struct bounded_sink
{
    cairo_t *cairo;
    size_t count;
    double low[2], high[2];
} bounded_sink;

static void add_bounded(void *context, double x, double y, bool begins)
{
    bounded_sink *sink = context;
    box_include(2, (const double[2]){x, y}, sink->low, sink->high);
    if (++sink->count <= MANY_POINTS)
        (begins ? cairo_move_to : cairo_line_to)(sink->cairo, x, y);
}

static void trace(const drawn_line *drawn, path_sink sink)
{
    path_simplifier path = simplifier_begin(sink, STROKE_TOLERANCE);
    view_trace(drawn->view, drawn->points, drawn->count, drawn->closed, drawn->side, &path);
}

bat_status stroke_line(cairo_t *cairo, const drawn_line *drawn, line_style line, bat_error *error)
{
    bat_status status = BAT_OK;
    bounded_sink sink = {cairo, 0, {INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    trace(drawn, (path_sink){add_bounded, &sink});
    if (sink.count > MANY_POINTS)
    {
        coverage_map map;
        cairo_new_path(cairo);
        status = coverage_begin(sink.low[0], sink.low[1], sink.high[0], sink.high[1], &map, error);
        if (status != BAT_OK)
            return status;
        trace(drawn, coverage_sink(&map));
        coverage_trace(&map, cairo);
        coverage_free(&map);
        line.dash = 0.0;
    }
    style_stroke(cairo, line);
    return status;
}
