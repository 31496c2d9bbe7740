#include "draw/curve/scene.h"

#include "base/error.h"

#include <string.h>

/// @file
/// Construction of proxies by sampling geodesics in the original space.

/// The most frames along a control polygon or a path; they are evenly distributed.
#define MAX_FRAMES 32
#define MAX_CURVES (3 + 3 * MAX_FRAMES)
/// The longest step in radians along a geodesic of rotations, whose columns do not follow great circles.
#define COLUMN_STEP 0.05
/// The length of the axes of a rigid motion, relative to the diagonal of all paths.
#define AXIS_SHARE 0.07

/// Allocate one more curve.
static bat_status add_curve(proxy *made, size_t count, bool closed, bat_curve_picture_layer layer, line_style line,
                            bat_error *error)
{
    bat_curve curve = {.space = &made->space, .count = count, .closed = closed};
    curve.points = memory_pool_array(&made->pool, count, made->space.point_dim * sizeof(double));
    if (curve.points == NULL)
        return memory_pool_check(&made->pool, error);
    made->curves[made->count] = curve;
    made->layers[made->count] = layer;
    made->lines[made->count++] = line;
    return BAT_OK;
}

static size_t frames_of(const bat_curve *curve)
{
    return curve->count < MAX_FRAMES ? curve->count : MAX_FRAMES;
}

/// The index of the point with frame `k`.
static size_t frame_index(const bat_curve *curve, size_t k)
{
    size_t frames = frames_of(curve);
    return frames > 1 ? k * (curve->count - 1) / (frames - 1) : 0;
}

static void column_of(const double *quaternion, size_t column, double *direction)
{
    double matrix[9];
    bat_rotation_to_matrix(quaternion, matrix);
    for (size_t row = 0; row < 3; row++)
        direction[row] = matrix[3 * row + column];
}

static size_t edge_count(const bat_curve *curve)
{
    return curve->count - (curve->closed && curve->count > 1 ? 0 : 1);
}

/// The index of the point at the end of edge `i`.
static size_t edge_end(const bat_curve *curve, size_t i)
{
    return i + 1 < curve->count ? i + 1 : 0;
}

static size_t edge_steps(const bat_curve *curve, size_t i)
{
    const double *q = curve->points + 4 * edge_end(curve, i);
    return 1 + (size_t)(curve->space->distance(curve->space, curve->points + 4 * i, q) / COLUMN_STEP);
}

/// Compute the three columns of the rotations along all edges, into the last three curves.
static bat_status fill_columns(proxy *made, const bat_curve *curve, bat_error *error)
{
    bat_curve *columns = made->curves + made->count - 3;
    size_t at = 0;
    for (size_t i = 0; i < edge_count(curve); i++)
    {
        const double *p = curve->points + 4 * i, *q = curve->points + 4 * edge_end(curve, i);
        size_t steps = edge_steps(curve, i);
        for (size_t step = 0; step < steps; step++, at++)
        {
            double between[4];
            bat_status status = bat_space_geodesic(curve->space, p, q, (double)step / (double)steps, between);
            if (status != BAT_OK)
                return error_set(error, status, i, 0,
                                 "points %zu and %zu are half a turn apart: their shortest geodesic is not unique", i,
                                 edge_end(curve, i));
            for (size_t c = 0; c < 3; c++)
                column_of(between, c, columns[c].points + 3 * at);
        }
    }
    for (size_t c = 0; c < 3 && at < columns[c].count; c++)
        column_of(curve->points + 4 * (curve->count - 1), c, columns[c].points + 3 * at);
    return BAT_OK;
}

/// The line of column `c`, paler from the first to the last.
static line_style column_line(bat_curve_layer_role role, draw_colour colour, size_t c)
{
    static const double shades[3] = {1.0, 0.72, 0.48};
    draw_colour shade = style_mix(colour, COLOUR_BACKGROUND, shades[c]);
    if (role == BAT_CURVE_LAYER_ROLE_CONTROL)
        return (line_style){shade, LINE_CONTROL, 3.0, 2.2};
    return role == BAT_CURVE_LAYER_ROLE_TRUTH ? (line_style){shade, LINE_TRUTH, 4.0, 2.2}
                                              : (line_style){shade, LINE_CURVE, 0.0, 0.0};
}

static bat_status add_columns(proxy *made, const bat_curve_picture_layer *layer, draw_colour colour, bat_error *error)
{
    const bat_curve *curve = layer->curve;
    // The triangles at control points are layers with the role of a control polygon.
    bat_curve_layer_role role =
        layer->role == BAT_CURVE_LAYER_ROLE_CURVE ? BAT_CURVE_LAYER_ROLE_CURVE : BAT_CURVE_LAYER_ROLE_TRUTH;
    bool closed = curve->closed && curve->count > 1;
    size_t count = closed ? 0 : 1;
    for (size_t i = 0; i < edge_count(curve); i++)
        count += edge_steps(curve, i);
    bat_status status = BAT_OK;
    for (size_t c = 0; c < 3 && status == BAT_OK; c++)
    {
        bat_curve_picture_layer own = {.role = role, .colour = layer->colour};
        status = add_curve(made, count, closed, own, column_line(layer->role, colour, c), error);
    }
    return status == BAT_OK ? fill_columns(made, curve, error) : status;
}

static bat_status add_triangles(proxy *made, const bat_curve *curve, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t k = 0; k < frames_of(curve) && status == BAT_OK; k++)
    {
        line_style line = {style_mix(COLOUR_CONTROL, COLOUR_BACKGROUND, 0.6), 0.6, 0.0, 0.0};
        status = add_curve(made, 3, true, (bat_curve_picture_layer){.role = BAT_CURVE_LAYER_ROLE_CONTROL}, line, error);
        for (size_t c = 0; c < 3 && status == BAT_OK; c++)
            column_of(curve->points + 4 * frame_index(curve, k), c, made->curves[made->count - 1].points + 3 * c);
    }
    return status;
}

static draw_colour layer_colour(const bat_curve_picture_panel *panel, size_t index)
{
    if (panel->layers[index].role == BAT_CURVE_LAYER_ROLE_CONTROL)
        return COLOUR_CONTROL;
    if (panel->layers[index].role == BAT_CURVE_LAYER_ROLE_TRUTH)
        return COLOUR_TRUTH;
    return style_palette(scene_colour(panel, index));
}

static bat_status add_rotations(proxy *made, const bat_curve_picture_panel *panel, const bat_curve_picture_options *options,
                                bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < panel->layer_count && status == BAT_OK; i++)
    {
        const bat_curve_picture_layer *layer = &panel->layers[i];
        bool control = layer->role == BAT_CURVE_LAYER_ROLE_CONTROL;
        if (!control || options->control_polygon)
            status = add_columns(made, layer, layer_colour(panel, i), error);
        if (control && options->control_points && status == BAT_OK)
            status = add_triangles(made, layer->curve, error);
    }
    return status;
}

/// The diagonal of the bounding box of all translations; 1 if it is a point.
static double paths_extent(const bat_curve_picture_panel *panel)
{
    double low[3], high[3];
    box_clear(3, low, high);
    for (size_t i = 0; i < panel->layer_count; i++)
        for (size_t j = 0; j < panel->layers[i].curve->count; j++)
            box_include(3, panel->layers[i].curve->points + 7 * j, low, high);
    double diagonal = vector3_distance(low, high);
    return diagonal > 0.0 ? diagonal : 1.0;
}

/// Add the body's axes at evenly distributed points, in vermilion, green and blue. Axes of given keyframes are stronger.
static bat_status add_axes(proxy *made, const bat_curve *curve, double length, bool given, bat_error *error)
{
    static const int colours[3] = {2, 3, 1};
    bat_status status = BAT_OK;
    for (size_t k = 0; k < 3 * frames_of(curve) && status == BAT_OK; k++)
    {
        const double *point = curve->points + 7 * frame_index(curve, k / 3);
        draw_colour colour = style_mix(style_palette(colours[k % 3]), COLOUR_BACKGROUND, given ? 1.0 : 0.55);
        line_style line = {colour, given ? 1.7 : 0.7, 0.0, 0.0};
        status = add_curve(made, 2, false, (bat_curve_picture_layer){.role = BAT_CURVE_LAYER_ROLE_CURVE, .colour = 1}, line,
                           error);
        if (status == BAT_OK)
        {
            double *ends = made->curves[made->count - 1].points;
            column_of(point + 3, k % 3, ends + 3);
            for (size_t c = 0; c < 3; c++)
            {
                ends[c] = point[c];
                ends[3 + c] = point[c] + length * ends[3 + c];
            }
        }
    }
    return status;
}

static bat_status add_motions(proxy *made, const bat_curve_picture_panel *panel, const bat_curve_picture_options *options,
                              bat_error *error)
{
    double length = AXIS_SHARE * paths_extent(panel);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < panel->layer_count && status == BAT_OK; i++)
    {
        const bat_curve *curve = panel->layers[i].curve;
        bat_curve_picture_layer own = {.role = panel->layers[i].role, .colour = scene_colour(panel, i)};
        status = add_curve(made, curve->count, curve->closed, own, (line_style){0}, error);
        for (size_t k = 0; k < curve->count && status == BAT_OK; k++)
            memcpy(made->curves[made->count - 1].points + 3 * k, curve->points + 7 * k, 3 * sizeof(double));
        if (status == BAT_OK && panel->layers[i].role == BAT_CURVE_LAYER_ROLE_CURVE)
            status = add_axes(made, panel->layers[i].curve, length, false, error);
    }
    for (size_t i = 0; i < panel->layer_count && status == BAT_OK; i++)
        if (panel->layers[i].role == BAT_CURVE_LAYER_ROLE_CONTROL && options->control_points)
            status = add_axes(made, panel->layers[i].curve, length, true, error);
    return status;
}

/// z = x / (1 + x_0), kept inside the unit circle despite rounding.
static bat_status add_hyperboloids(proxy *made, const bat_curve_picture_panel *panel, bat_error *error)
{
    const double rim = 1.0 - 1e-15;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < panel->layer_count && status == BAT_OK; i++)
    {
        const bat_curve *curve = panel->layers[i].curve;
        bat_curve_picture_layer own = panel->layers[i];
        own.colour = scene_colour(panel, i);
        status = add_curve(made, curve->count, curve->closed, own, (line_style){0}, error);
        for (size_t k = 0; k < curve->count && status == BAT_OK; k++)
        {
            const double *x = curve->points + 3 * k;
            double *z = made->curves[made->count - 1].points + 2 * k;
            double inverse = rim / (1.0 + sqrt(1.0 + x[1] * x[1] + x[2] * x[2]));
            z[0] = inverse * x[1];
            z[1] = inverse * x[2];
        }
    }
    return status;
}

bat_status proxy_make(const bat_curve_picture_panel *panel, const bat_curve_picture_options *options, proxy *made,
                      bat_error *error)
{
    size_t max_count = panel->layer_count * MAX_CURVES;
    view_space shown = view_space_of(panel->layers[0].curve->space);
    *made = (proxy){.space = shown == VIEW_ROTATION ? bat_sphere(2) : shown == VIEW_RIGID ? bat_euclidean(3) : bat_disk()};
    made->curves = memory_pool_array(&made->pool, max_count, sizeof *made->curves);
    made->layers = memory_pool_array(&made->pool, max_count, sizeof *made->layers);
    made->lines = memory_pool_array(&made->pool, max_count, sizeof *made->lines);
    bat_status status = memory_pool_check(&made->pool, error);
    if (status == BAT_OK)
        status = shown == VIEW_ROTATION ? add_rotations(made, panel, options, error)
                 : shown == VIEW_RIGID  ? add_motions(made, panel, options, error)
                                        : add_hyperboloids(made, panel, error);
    for (size_t i = 0; i < made->count; i++)
        made->layers[i].curve = &made->curves[i];
    made->panel = (bat_curve_picture_panel){.layers = made->layers, .layer_count = made->count, .title = panel->title};
    if (status != BAT_OK)
        proxy_free(made);
    return status;
}

void proxy_free(proxy *made)
{
    memory_pool_free(&made->pool);
    *made = (proxy){0};
}
