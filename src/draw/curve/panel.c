#include "draw/curve/scene.h"

/// @file
/// Drawing of one panel: background, lines of all layers, combs, circles at control points, labels.

/// More open circles would hide each other.
#define MANY_RINGS 5000
/// The margin between a curve and its box.
#define FLAT_MARGIN 5.0
#define ALPHA_BOUNDARY_MARGIN 2.0
/// The smallest aspect ratio of a flat drawing, height over width.
#define FLATTEST 0.12
/// The gap between a globe and a map.
#define BETWEEN 10.0

static bool panel_has_scale_bar(const scene_panel *panel, const bat_curve_picture_options *options)
{
    return panel->space == VIEW_PLANE && panel->polygons && !options->axes && text_given(options->unit);
}

static insets flat_insets(const scene_panel *panel, const bat_curve_picture_options *options)
{
    double margin = FLAT_MARGIN;
    if (options->axes && panel->space == VIEW_SOLID)
        margin += GRID_SOLID_MARGIN;
    if (options->axes && panel->space == VIEW_PLANE)
        return grid_plane_room(&panel->frame);
    double below = margin + (panel_has_scale_bar(panel, options) ? GRID_SCALE_HEIGHT : 0.0);
    return (insets){margin, margin, margin, below};
}

static insets globe_insets(const bat_curve_picture_options *options)
{
    double side = options->grid ? GRID_GLOBE_MARGIN : ALPHA_BOUNDARY_MARGIN;
    return (insets){side, ALPHA_BOUNDARY_MARGIN, side, ALPHA_BOUNDARY_MARGIN};
}

static insets map_insets(const bat_curve_picture_options *options)
{
    bool labels = options->grid;
    return (insets){labels ? GRID_MAP_LEFT : ALPHA_BOUNDARY_MARGIN, 4.0, labels ? GRID_MAP_RIGHT : ALPHA_BOUNDARY_MARGIN,
                    labels ? GRID_MAP_BOTTOM : ALPHA_BOUNDARY_MARGIN};
}

/// The height of a box of this width that content of this aspect ratio fills.
static double height_around(insets around, double width, double aspect)
{
    return fmax(10.0, width - around.left - around.right) * aspect + around.top + around.bottom;
}

double panel_height(const scene_panel *panel, const bat_curve_picture_options *options, double tallest, double width)
{
    if (panel->space == VIEW_DISK)
        return width;
    if (panel->space != VIEW_SPHERE)
    {
        double aspect = scene_aspect(&panel->frame);
        return height_around(flat_insets(panel, options), width, fmin(fmax(aspect, FLATTEST), tallest));
    }
    insets globe = globe_insets(options);
    insets map = map_insets(options);
    const map_choice *shown = &panel->frame.map;
    const double earth = EQUAL_EARTH_HALF_WIDTH / EQUAL_EARTH_HALF_HEIGHT;
    if (shown->projection == BAT_CURVE_PROJECTION_LOCAL)
        return height_around(grid_local_room(&panel->frame, options->grid), width,
                             (shown->high[1] - shown->low[1]) / (shown->high[0] - shown->low[0]));
    if (shown->projection == BAT_CURVE_PROJECTION_MAP)
        return height_around(map, width, 1.0 / earth);
    if (shown->projection != BAT_CURVE_PROJECTION_BOTH)
        return height_around(globe, width, 1.0);
    // width = (h - globe.top - globe.bottom + globe.left + globe.right) + BETWEEN + earth (h - map.top - map.bottom) + …
    return (width - BETWEEN + globe.top + globe.bottom - globe.left - globe.right + earth * (map.top + map.bottom) -
            map.left - map.right) /
           (1.0 + earth);
}

/// Scale and centre the range from (low_u, low_v) to (high_u, high_v) in a box without its margins.
static void fit(draw_view *view, const double box[4], insets around, const double low[2], const double high[2])
{
    double width = fmax(1.0, box[2] - around.left - around.right);
    double height = fmax(1.0, box[3] - around.top - around.bottom);
    view->scale = fmin(width / (high[0] - low[0]), height / (high[1] - low[1]));
    view->origin_x = box[0] + around.left + 0.5 * width - view->scale * 0.5 * (low[0] + high[0]);
    view->origin_y = box[1] + around.top + 0.5 * height + view->scale * 0.5 * (low[1] + high[1]);
}

static draw_view make_view(const scene_panel *panel, view_kind kind)
{
    draw_view view = {.kind = kind, .space = panel->space, .point_dim = panel->point_dim, .tolerance = STROKE_TOLERANCE};
    if (kind == VIEW_GLOBE || kind == VIEW_LOCAL)
        view_set_globe(&view, panel->frame.map.longitude, panel->frame.map.latitude);
    if (kind == VIEW_MAP)
        view_set_map(&view, panel->frame.map.meridian);
    if (panel->space == VIEW_SOLID)
        view_set_solid(&view);
    return view;
}

/// The style of a layer, other than on maps.
static line_style plain_line(const bat_curve_picture_panel *panel, size_t index)
{
    if (panel->layers[index].role == BAT_CURVE_LAYER_ROLE_CONTROL)
        return (line_style){COLOUR_CONTROL, LINE_CONTROL, 3.0, 2.2};
    if (panel->layers[index].role == BAT_CURVE_LAYER_ROLE_TRUTH)
        return (line_style){COLOUR_TRUTH, LINE_TRUTH, 4.0, 2.2};
    return style_curve(scene_colour(panel, index));
}

/// The style of a layer. The layers of a proxy have their own.
static line_style layer_line(const scene_panel *panel, size_t index)
{
    bool proxied = panel->drawn == &panel->proxied.panel && panel->proxied.lines[index].width > 0.0;
    if (scene_is_map(panel))
        return map_line(panel, index);
    return proxied ? panel->proxied.lines[index] : plain_line(panel->drawn, index);
}

static bool has_rings(const bat_curve_picture_layer *layer)
{
    return layer->role == BAT_CURVE_LAYER_ROLE_CONTROL && layer->curve->count <= MANY_RINGS;
}

legend_item panel_legend_item(const scene_panel *panel, size_t index, const bat_curve_picture_options *options)
{
    const bat_curve_picture_layer *layer = &panel->source->layers[index];
    bool map = scene_is_map(panel) && panel->drawn == panel->source;
    legend_item item = {layer->label, map ? map_line(panel, index) : plain_line(panel->source, index), LEGEND_NO_MARK};
    if (layer->role == BAT_CURVE_LAYER_ROLE_CONTROL)
    {
        item.line.width = options->control_polygon ? item.line.width : 0.0;
        item.mark = has_rings(layer) && scene_points_shown(panel, options) ? LEGEND_RING : LEGEND_NO_MARK;
    }
    return item;
}

/// The style of a line on the back of a globe: paler and thinner.
static line_style behind(line_style line)
{
    line.colour = style_mix(line.colour, (draw_colour){0.95, 0.96, 0.97}, 0.32);
    line.width *= 0.7;
    return line;
}

static bat_status draw_line(cairo_t *cairo, const draw_view *view, const scene_panel *panel, size_t index, view_side side,
                            bat_error *error)
{
    const bat_curve *curve = panel->drawn->layers[index].curve;
    line_style line = layer_line(panel, index);
    line = side == VIEW_BACK ? behind(line) : line;
    double x, y;
    bool front = view_place(view, curve->points, &x, &y);
    if (curve->count == 1 && front == (side == VIEW_FRONT))
    {
        cairo_arc(cairo, x, y, line.width, 0.0, ANGLE_TURN);
        style_use_colour(cairo, line.colour);
        cairo_fill(cairo);
    }
    drawn_line drawn = {view, curve->points, curve->count, curve->closed && curve->count > 1, side};
    return curve->count > 1 ? stroke_line(cairo, &drawn, line, error) : BAT_OK;
}

/// The radius of open circles, smaller for many points.
static double ring_radius(const draw_view *view, const bat_curve *curve, bool map)
{
    double length = 0.0, last_x, last_y;
    view_place(view, curve->points, &last_x, &last_y);
    for (size_t i = 1; i < curve->count; i++)
    {
        double x, y;
        view_place(view, curve->points + i * view->point_dim, &x, &y);
        length += hypot(x - last_x, y - last_y);
        last_x = x;
        last_y = y;
    }
    double largest = map ? 0.75 * MARKER_RADIUS : MARKER_RADIUS;
    double spacing = curve->count > 1 ? length / (double)(curve->count - 1) : INFINITY;
    return fmin(largest, fmax(0.7, 0.2 * spacing));
}

/// Draw open circles at the points of one side, at least half a radius apart.
static void draw_rings(cairo_t *cairo, const draw_view *view, const bat_curve *curve, view_side side, bool map)
{
    double radius = ring_radius(view, curve, map);
    line_style line = {COLOUR_CONTROL, 1.0, 0.0, 0.0};
    double last_x = INFINITY, last_y = INFINITY;
    for (size_t i = 0; i < curve->count; i++)
    {
        double x, y;
        bool front = view_place(view, curve->points + i * view->point_dim, &x, &y);
        if (front == (side == VIEW_FRONT) && !(hypot(x - last_x, y - last_y) < 0.5 * radius))
        {
            legend_ring(cairo, x, y, side == VIEW_FRONT ? radius : 0.8 * radius,
                        side == VIEW_FRONT ? line.colour : behind(line).colour);
            last_x = x;
            last_y = y;
        }
    }
}

static bat_status draw_role(cairo_t *cairo, const draw_view *view, const scene_panel *panel, bat_curve_layer_role role,
                            view_side side, bat_error *error)
{
    bat_status status = BAT_OK;
    if (panel->polygons)
        return side == VIEW_FRONT ? map_draw_lines(cairo, view, panel, role, error) : BAT_OK;
    for (size_t i = 0; i < panel->drawn->layer_count && status == BAT_OK; i++)
        status = panel->drawn->layers[i].role == role ? draw_line(cairo, view, panel, i, side, error) : BAT_OK;
    return status;
}

static void draw_all_rings(cairo_t *cairo, const draw_view *view, const scene_panel *panel,
                           const bat_curve_picture_options *options, view_side side)
{
    bool hidden = side == VIEW_BACK && panel->polygons;
    for (size_t i = 0; i < panel->drawn->layer_count && scene_points_shown(panel, options) && !hidden; i++)
        if (has_rings(&panel->drawn->layers[i]))
            draw_rings(cairo, view, panel->drawn->layers[i].curve, side, scene_is_map(panel));
}

static bat_status draw_lines(cairo_t *cairo, const draw_view *view, const scene_panel *panel,
                             const bat_curve_picture_options *options, view_side side, bat_error *error)
{
    bat_status status = BAT_OK;
    if (options->control_polygon)
        status = draw_role(cairo, view, panel, BAT_CURVE_LAYER_ROLE_CONTROL, side, error);
    if (status == BAT_OK && options->comb && side == VIEW_FRONT)
        for (size_t i = 0; i < panel->drawn->layer_count && status == BAT_OK; i++)
        {
            draw_colour colour = style_palette(scene_colour(panel->drawn, i));
            if (panel->combs[i].count > 0)
                status = comb_lines_draw(cairo, view, &panel->combs[i], panel->frame.comb_scale, colour, error);
        }
    if (status == BAT_OK)
        status = draw_role(cairo, view, panel, BAT_CURVE_LAYER_ROLE_TRUTH, side, error);
    return status == BAT_OK ? draw_role(cairo, view, panel, BAT_CURVE_LAYER_ROLE_CURVE, side, error) : status;
}

static bat_status draw_layers(cairo_t *cairo, const draw_view *view, const scene_panel *panel,
                              const bat_curve_picture_options *options, view_side side, bat_error *error)
{
    bat_status status = draw_lines(cairo, view, panel, options, side, error);
    draw_all_rings(cairo, view, panel, options, side);
    return status;
}

static bat_status draw_flat(cairo_t *cairo, const scene_panel *panel, const bat_curve_picture_options *options,
                            const double box[4], bat_error *error)
{
    draw_view view = make_view(panel, VIEW_FLAT);
    insets around = flat_insets(panel, options);
    fit(&view, box, around, panel->frame.low, panel->frame.high);
    if (options->axes && panel->space == VIEW_SOLID)
        grid_solid(cairo, &view, &panel->frame);
    if (options->axes && panel->space == VIEW_PLANE)
    {
        double width = view.scale * (panel->frame.high[0] - panel->frame.low[0]) + 2.0 * FLAT_MARGIN;
        double height = view.scale * (panel->frame.high[1] - panel->frame.low[1]) + 2.0 * FLAT_MARGIN;
        double inner[4] = {view_x(&view, panel->frame.low[0]) - FLAT_MARGIN,
                           view_y(&view, panel->frame.high[1]) - FLAT_MARGIN, width, height};
        grid_plane(cairo, &view, &panel->frame, inner);
    }
    map_draw_fills(cairo, &view, panel);
    if (panel_has_scale_bar(panel, options))
    {
        double extent = panel->frame.high[0] - panel->frame.low[0];
        double y = view_y(&view, panel->frame.low[1]) + FLAT_MARGIN + 0.6 * GRID_SCALE_HEIGHT;
        grid_scale_bar(cairo, view_x(&view, panel->frame.low[0]), y, extent * view.scale, extent, options->unit);
    }
    return draw_layers(cairo, &view, panel, options, VIEW_FRONT, error);
}

static bat_status draw_globe(cairo_t *cairo, const scene_panel *panel, const bat_curve_picture_options *options,
                             const double box[4], bat_error *error)
{
    draw_view view = make_view(panel, VIEW_GLOBE);
    fit(&view, box, globe_insets(options), (double[2]){-1.0, -1.0}, (double[2]){1.0, 1.0});
    grid_globe_sphere(cairo, &view, panel->polygons);
    bat_status status = draw_layers(cairo, &view, panel, options, VIEW_BACK, error);
    map_draw_fills(cairo, &view, panel);
    if (options->grid)
        grid_globe_lines(cairo, &view);
    grid_globe_limb(cairo, &view, &panel->frame, options->grid);
    return status == BAT_OK ? draw_layers(cairo, &view, panel, options, VIEW_FRONT, error) : status;
}

static bat_status draw_map(cairo_t *cairo, const scene_panel *panel, const bat_curve_picture_options *options,
                           const double box[4], bat_error *error)
{
    draw_view view = make_view(panel, VIEW_MAP);
    fit(&view, box, map_insets(options), (double[2]){-EQUAL_EARTH_HALF_WIDTH, -EQUAL_EARTH_HALF_HEIGHT},
        (double[2]){EQUAL_EARTH_HALF_WIDTH, EQUAL_EARTH_HALF_HEIGHT});
    grid_map_ground(cairo, &view, panel->polygons);
    map_draw_fills(cairo, &view, panel);
    cairo_save(cairo);
    grid_map_clip(cairo, &view);
    if (options->grid)
        grid_map_lines(cairo, &view);
    bat_status status = draw_lines(cairo, &view, panel, options, VIEW_FRONT, error);
    cairo_restore(cairo);
    draw_all_rings(cairo, &view, panel, options, VIEW_FRONT);
    grid_map_frame(cairo, &view, options->grid);
    return status;
}

static bat_status draw_local(cairo_t *cairo, const scene_panel *panel, const bat_curve_picture_options *options,
                             const double box[4], bat_error *error)
{
    draw_view view = make_view(panel, VIEW_LOCAL);
    fit(&view, box, grid_local_room(&panel->frame, options->grid), panel->frame.map.low, panel->frame.map.high);
    grid_local_ground(cairo, &view, &panel->frame, panel->polygons);
    map_draw_fills(cairo, &view, panel);
    cairo_save(cairo);
    grid_local_clip(cairo, &view, &panel->frame);
    if (options->grid)
        grid_local_lines(cairo, &view, &panel->frame);
    bat_status status = draw_layers(cairo, &view, panel, options, VIEW_FRONT, error);
    cairo_restore(cairo);
    grid_local_frame(cairo, &view, &panel->frame, options->grid);
    return status;
}

static bat_status draw_sphere(cairo_t *cairo, const scene_panel *panel, const bat_curve_picture_options *options,
                              const double box[4], bat_error *error)
{
    bat_curve_projection shown = panel->frame.map.projection;
    if (shown == BAT_CURVE_PROJECTION_LOCAL)
        return draw_local(cairo, panel, options, box, error);
    if (shown == BAT_CURVE_PROJECTION_MAP)
        return draw_map(cairo, panel, options, box, error);
    if (shown != BAT_CURVE_PROJECTION_BOTH)
        return draw_globe(cairo, panel, options, box, error);
    insets globe = globe_insets(options);
    double width = box[3] - globe.top - globe.bottom + globe.left + globe.right; // of a globe as high as the box
    double share = fmin(width, 0.4 * box[2]);
    double left[4] = {box[0], box[1], share, box[3]};
    double right[4] = {box[0] + share + BETWEEN, box[1], box[2] - share - BETWEEN, box[3]};
    bat_status status = draw_globe(cairo, panel, options, left, error);
    return status == BAT_OK ? draw_map(cairo, panel, options, right, error) : status;
}

bat_status panel_draw(cairo_t *cairo, const scene_panel *panel, const bat_curve_picture_options *options,
                      const double box[4], bat_error *error)
{
    if (panel->space == VIEW_SPHERE)
        return draw_sphere(cairo, panel, options, box, error);
    if (panel->space == VIEW_DISK)
    {
        draw_view view = make_view(panel, VIEW_POINCARE);
        insets around = {ALPHA_BOUNDARY_MARGIN, ALPHA_BOUNDARY_MARGIN, ALPHA_BOUNDARY_MARGIN, ALPHA_BOUNDARY_MARGIN};
        fit(&view, box, around, (double[2]){-1.0, -1.0}, (double[2]){1.0, 1.0});
        grid_disk(cairo, &view, options->grid);
        grid_disk_circle(cairo, &view);
        return draw_layers(cairo, &view, panel, options, VIEW_FRONT, error);
    }
    if (panel->space == VIEW_TENSOR)
    {
        draw_view view = make_view(panel, VIEW_FLAT);
        insets around = {FLAT_MARGIN, FLAT_MARGIN, FLAT_MARGIN, FLAT_MARGIN};
        view_set_solid(&view);
        fit(&view, box, around, panel->frame.low, panel->frame.high);
        return tensor_row_draw(cairo, &view, panel, error);
    }
    return draw_flat(cairo, panel, options, box, error);
}
