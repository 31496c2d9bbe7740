#include "draw/curve/scene.h"

#include <string.h>

/// @file
/// Fills, and strokes of many lines in few paths.

/// A stroke ends after about so many points.
#define PATH_POINTS 8000
/// The allowed errors on the page: of fills, whose outlines the borders cover, and of lines.
#define FILL_TOLERANCE 0.2
#define LINE_TOLERANCE 0.1
/// The most rings of a polygon that are filled together.
#define MAX_RINGS 1024
/// Lines of more points may need a coverage mask, and are stroked alone.
#define LONG_LINE 30000

line_style map_line(const scene_panel *panel, size_t index)
{
    const bat_curve_picture_layer *layer = &panel->drawn->layers[index];
    bool result = layer->role == BAT_CURVE_LAYER_ROLE_CURVE || panel->given_only;
    bool world = panel->space == VIEW_SPHERE && panel->frame.map.projection != BAT_CURVE_PROJECTION_LOCAL;
    if (layer->role == BAT_CURVE_LAYER_ROLE_TRUTH)
        return (line_style){COLOUR_TRUTH, 0.7 * LINE_TRUTH, 4.0, 2.2};
    if (!result)
        return (line_style){COLOUR_GIVEN, world ? 0.7 * LINE_GIVEN : LINE_GIVEN, 0.0, 0.0};
    if (layer->polygon > 0)
        return (line_style){COLOUR_BORDER, world ? 0.7 * LINE_BORDER : LINE_BORDER, 0.0, 0.0};
    line_style line = style_curve(layer->role == BAT_CURVE_LAYER_ROLE_CURVE ? scene_colour(panel->drawn, index) : 1);
    line.width = LINE_ROUTE;
    return line;
}

/// The end of the layers from `first` that are rings of one polygon.
static size_t polygon_end(const bat_curve_picture_panel *panel, size_t first)
{
    size_t end = first + 1;
    while (end < panel->layer_count && panel->layers[end].role == panel->layers[first].role &&
           panel->layers[end].polygon == panel->layers[first].polygon && end - first < MAX_RINGS)
        end++;
    return end;
}

/// Add the area and the perimeter of the present path.
static void measure_path(cairo_t *cairo, double *area, double *perimeter)
{
    cairo_path_t *path = cairo_copy_path(cairo);
    double start[2] = {0}, at[2] = {0}, sum = 0;
    for (int i = 0; i < path->num_data; i += path->data[i].header.length)
    {
        const cairo_path_data_t *data = &path->data[i];
        bool closes = data->header.type == CAIRO_PATH_CLOSE_PATH;
        double x = closes ? start[0] : data[1].point.x, y = closes ? start[1] : data[1].point.y;
        if (data->header.type == CAIRO_PATH_MOVE_TO)
        {
            start[0] = x;
            start[1] = y;
        }
        else
        {
            sum += (at[0] * y - x * at[1]) / 2;
            *perimeter += hypot(x - at[0], y - at[1]);
        }
        at[0] = x;
        at[1] = y;
    }
    cairo_path_destroy(path);
    *area += fabs(sum);
}

/// Fill a polygon, with a clip only where it needs one: SVG files repeat the clip for every path.
static void fill_polygon(cairo_t *cairo, const draw_view *view, const scene_frame *frame, const bat_curve *const *rings,
                         size_t count, double *area, double *perimeter)
{
    view_region region = view_trace_polygon(view, rings, count, cairo);
    measure_path(cairo, area, perimeter);
    if (!region.inside || !region.outside)
    {
        if (region.inside)
            cairo_fill(cairo);
        cairo_new_path(cairo);
        return;
    }
    cairo_path_t *path = cairo_copy_path(cairo);
    cairo_save(cairo);
    cairo_new_path(cairo);
    if (view->kind == VIEW_GLOBE)
    {
        cairo_arc(cairo, view->origin_x, view->origin_y, view->scale, 0.0, ANGLE_TURN);
        cairo_clip(cairo);
    }
    else if (view->kind == VIEW_MAP)
        grid_map_clip(cairo, view);
    else if (view->kind == VIEW_LOCAL)
        grid_local_clip(cairo, view, frame);
    cairo_append_path(cairo, path);
    cairo_fill(cairo);
    cairo_restore(cairo);
    cairo_path_destroy(path);
}

void map_draw_fills(cairo_t *cairo, draw_view *view, const scene_panel *panel)
{
    const bat_curve *rings[MAX_RINGS];
    draw_view coarse = *view;
    coarse.tolerance = FILL_TOLERANCE;
    const bat_curve_picture_panel *drawn = panel->drawn;
    double area = 0, perimeter = 0;
    bool results = false;
    for (size_t i = 0; i < drawn->layer_count; i++)
        results = results || (drawn->layers[i].polygon > 0 && drawn->layers[i].role == BAT_CURVE_LAYER_ROLE_CURVE);
    bat_curve_layer_role role = results ? BAT_CURVE_LAYER_ROLE_CURVE : BAT_CURVE_LAYER_ROLE_CONTROL;
    cairo_fill_rule_t rule = cairo_get_fill_rule(cairo);
    cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_EVEN_ODD);
    for (size_t first = 0, end = 0; first < drawn->layer_count && panel->polygons; first = end)
    {
        end = polygon_end(drawn, first);
        if (drawn->layers[first].polygon == 0 || drawn->layers[first].role != role)
            continue;
        for (size_t i = first; i < end; i++)
            rings[i - first] = drawn->layers[i].curve;
        style_use_colour(cairo, style_fill(panel->network.colours[first]));
        fill_polygon(cairo, &coarse, &panel->frame, rings, end - first, &area, &perimeter);
    }
    // Borders of small polygons are thinner, so that their fills are seen: squares have 4 / s of perimeter.
    static const double SHARE = 0.08, LEAST = 0.2; // of the side of a polygon, and of the usual width
    double side = perimeter > 0 ? 4 * area / perimeter : LINE_BORDER / SHARE;
    view->borders = fmin(fmax(SHARE * side / LINE_BORDER, LEAST), 1);
    cairo_set_fill_rule(cairo, rule);
}

/// A path of several lines of one style.
typedef struct line_group
{
    cairo_t *cairo;
    const draw_view *view;
    line_style line;
    size_t points; ///< in the path, about
} line_group;

static void count_point(void *context, double x, double y, bool begins)
{
    line_group *group = context;
    (begins ? cairo_move_to : cairo_line_to)(group->cairo, x, y);
    group->points++;
}

static void flush(line_group *group)
{
    if (group->points > 0)
        style_stroke(group->cairo, group->line);
    group->points = 0;
}

static void add_line(line_group *group, const double *points, size_t count, bool closed)
{
    path_simplifier path = simplifier_begin((path_sink){count_point, group}, LINE_TOLERANCE);
    view_trace(group->view, points, count, closed, VIEW_FRONT, &path);
    if (group->points > PATH_POINTS)
        flush(group);
}

/// Add the drawn edges of a layer, in runs.
static void add_runs(line_group *group, const bat_curve *curve, const unsigned char *drawn, size_t edges)
{
    size_t dim = curve->space->point_dim;
    for (size_t first = 0; first < edges;)
    {
        size_t end = first;
        while (end < edges && drawn[end] != 0)
            end++;
        bool around = first == 0 && end == curve->count; // all edges of a closed curve
        bool last = end == curve->count && !around;      // up to the edge that ends at the first point
        if (end > first)
            add_line(group, curve->points + first * dim, end - first + (around || last ? 0 : 1), around);
        if (last && end > first && dim <= 3)
        {
            double edge[2 * 3] = {0};
            memcpy(edge, curve->points + (end - 1) * dim, dim * sizeof(double));
            memcpy(edge + dim, curve->points, dim * sizeof(double));
            add_line(group, edge, 2, false);
        }
        first = end + 1;
    }
}

bat_status map_draw_lines(cairo_t *cairo, const draw_view *view, const scene_panel *panel, bat_curve_layer_role role,
                          bat_error *error)
{
    line_group group = {.cairo = cairo, .view = view};
    const map_network *network = &panel->network;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < panel->drawn->layer_count && status == BAT_OK; i++)
    {
        const bat_curve_picture_layer *layer = &panel->drawn->layers[i];
        size_t edges = network->starts[i + 1] - network->starts[i];
        const unsigned char *drawn = network->drawn + network->starts[i];
        if (layer->role != role || edges == 0)
            continue;
        line_style line = map_line(panel, i);
        line.width *= layer->polygon > 0 && view->borders > 0 ? view->borders : 1;
        bool same = style_same_line(&line, &group.line);
        if (!same)
            flush(&group);
        group.line = line;
        if (layer->curve->count > LONG_LINE && memchr(drawn, 0, edges) == NULL)
        {
            drawn_line whole = {view, layer->curve->points, layer->curve->count, layer->curve->closed, VIEW_FRONT};
            flush(&group);
            status = stroke_line(cairo, &whole, line, error);
        }
        else
            add_runs(&group, layer->curve, drawn, edges);
    }
    flush(&group);
    return status;
}
