#include "draw/curve/scene.h"

#include "base/error.h"
#include "linalg/dense.h"

#include <string.h>

/// @file
/// Ellipses and shaded ellipsoids of matrices, in rows.

/// The most tensors in a row.
#define MAX_COLUMNS 13
/// The distance of neighbouring tensors' centres in a row, and of rows, in units of the largest semi-axis.
#define COLUMN_SPACING 2.15
#define ROW_SPACING 2.3
/// The smallest minor axis of a drawn ellipse, in the same unit.
#define THINNEST 2e-3

/// The principal semi-axes of a tensor as vectors, in units of the largest semi-axis. The third is 0 in the plane.
typedef struct ellipsoid
{
    size_t side;
    double axes[3][3];
} ellipsoid;

static bat_status ellipsoid_of(const bat_curve *curve, size_t index, double unit, ellipsoid *made, bat_error *error)
{
    size_t n = curve->space->point_dim == 3 ? 2 : 3;
    const double *packed = curve->points + index * curve->space->point_dim;
    double matrix[9], values[3];
    for (size_t i = 0; i < n; i++)
        for (size_t j = i; j < n; j++)
            matrix[n * i + j] = *packed++ / unit / unit;
    if (decompose_symmetric(n, matrix, values, NULL) != BAT_OK)
        return error_set(error, BAT_NO_CONVERGENCE, index, 0, "point %zu has no eigenvalues to draw", index);
    *made = (ellipsoid){.side = n};
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < n; i++)
            made->axes[k][i] = sqrt(fmax(values[k], THINNEST * THINNEST)) * matrix[n * i + k];
    return BAT_OK;
}

/// The number of tensors of a curve in a row with `columns` columns.
static size_t shown_of(const bat_curve *curve, size_t columns)
{
    return curve->count < columns ? curve->count : columns;
}

static size_t shown_index(const bat_curve *curve, size_t columns, size_t k)
{
    size_t shown = shown_of(curve, columns);
    return shown > 1 ? (k * (curve->count - 1) + (shown - 1) / 2) / (shown - 1) : 0;
}

bat_status tensor_row_include(scene_frame *frame, const bat_curve_picture_panel *panel, bat_error *error)
{
    for (size_t i = 0; i < panel->layer_count; i++)
    {
        const bat_curve *curve = panel->layers[i].curve;
        size_t columns = curve->count < MAX_COLUMNS ? curve->count : MAX_COLUMNS;
        frame->tensor_columns = columns > frame->tensor_columns ? columns : frame->tensor_columns;
        for (size_t k = 0; k < columns; k++)
        {
            ellipsoid drawn;
            // Numbers far from 1 are scaled first.
            double near = sqrt(curve->points[shown_index(curve, columns, k) * curve->space->point_dim]);
            bat_status status = ellipsoid_of(curve, shown_index(curve, columns, k), near, &drawn, error);
            if (status != BAT_OK)
                return status;
            // Eigenvalues are in increasing order.
            frame->tensor_unit = fmax(frame->tensor_unit, near * vector3_length(drawn.axes[drawn.side - 1]));
        }
    }
    frame->low[0] = -1.05;
    frame->high[0] = COLUMN_SPACING * ((double)frame->tensor_columns - 1.0) + 1.05;
    frame->low[1] = fmin(frame->low[1], -ROW_SPACING * ((double)panel->layer_count - 1.0) - 1.05);
    frame->high[1] = 1.05;
    return BAT_OK;
}

/// Rotate the axes of an ellipsoid into the directions to the right, upwards and to the eye.
static void turn(const draw_view *view, ellipsoid *drawn)
{
    for (size_t k = 0; k < drawn->side && drawn->side == 3; k++)
    {
        double rotated[3];
        view_rotate(view, drawn->axes[k], rotated);
        memcpy(drawn->axes[k], rotated, sizeof rotated);
    }
}

/// The symmetric square root of sum_a (a_x, a_y)^T (a_x, a_y) over the semi-axes a. It maps the unit circle to the outline
/// and keeps the upward direction nearly.
static void outline_of(const ellipsoid *drawn, double root[3])
{
    double xx = THINNEST * THINNEST;
    double xy = 0.0;
    double yy = THINNEST * THINNEST;
    for (size_t k = 0; k < drawn->side; k++)
    {
        const double *a = drawn->axes[k];
        xx += a[0] * a[0];
        xy += a[0] * a[1];
        yy += a[1] * a[1];
    }
    double area = sqrt(fmax(xx * yy - xy * xy, xx * yy * 1e-12));
    double scale = 1.0 / sqrt(xx + yy + 2.0 * area);
    root[0] = scale * (xx + area);
    root[1] = scale * xy;
    root[2] = scale * (yy + area);
}

/// The colour of a tensor: paler along the curve.
static draw_colour shade_of(const bat_curve_picture_panel *panel, size_t layer, double share)
{
    if (panel->layers[layer].role == BAT_CURVE_LAYER_ROLE_CONTROL)
        return style_mix(COLOUR_CONTROL, COLOUR_BACKGROUND, 0.75);
    if (panel->layers[layer].role == BAT_CURVE_LAYER_ROLE_TRUTH)
        return COLOUR_TRUTH;
    return style_mix(style_palette(scene_colour(panel, layer)), (draw_colour){0.99, 0.90, 0.62}, 0.95 - 0.65 * share);
}

/// Fill the outline around (x, y), lit from the upper left.
static void fill_outline(cairo_t *cairo, const double root[3], double scale, double x, double y, draw_colour colour)
{
    cairo_matrix_t to_paper = {scale * root[0], -scale * root[1], scale * root[1], -scale * root[2], x, y};
    draw_colour light = style_mix(colour, COLOUR_BACKGROUND, 0.45);
    draw_colour dark = style_mix(colour, COLOUR_FOREGROUND, 0.85);
    cairo_pattern_t *ball = cairo_pattern_create_radial(-0.35, 0.4, 0.0, 0.0, 0.0, 1.0);
    cairo_pattern_add_color_stop_rgb(ball, 0.0, light.red, light.green, light.blue);
    cairo_pattern_add_color_stop_rgb(ball, 0.6, colour.red, colour.green, colour.blue);
    cairo_pattern_add_color_stop_rgb(ball, 1.0, dark.red, dark.green, dark.blue);
    cairo_save(cairo);
    cairo_transform(cairo, &to_paper);
    cairo_new_path(cairo);
    cairo_arc(cairo, 0.0, 0.0, 1.0, 0.0, ANGLE_TURN);
    cairo_close_path(cairo);
    cairo_set_source(cairo, ball);
    cairo_fill_preserve(cairo);
    cairo_restore(cairo);
    cairo_pattern_destroy(ball);
}

/// Draw the front half of the principal ellipse with semi-axes a and b. a cos t + b sin t is on the front where a / |a|^2
/// cos t + b / |b|^2 sin t, the normal, points to the eye.
static void trace_front(cairo_t *cairo, const double *a, const double *b, double scale, double x, double y)
{
    static const int STEPS = 32;
    double of_a = a[2] / (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    double of_b = b[2] / (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    double middle = atan2(of_b, of_a);
    for (int step = 0; step <= STEPS; step++)
    {
        double angle = middle + ANGLE_TURN * (0.5 * step / STEPS - 0.25);
        double u = a[0] * cos(angle) + b[0] * sin(angle), v = a[1] * cos(angle) + b[1] * sin(angle);
        (step == 0 ? cairo_move_to : cairo_line_to)(cairo, x + scale * u, y - scale * v);
    }
}

/// Draw an ellipse with its principal axes, or an ellipsoid with its principal ellipses.
static void draw_ellipsoid(cairo_t *cairo, const ellipsoid *drawn, bool given, double scale, double x, double y,
                           draw_colour colour)
{
    double root[3];
    draw_colour rim = given ? COLOUR_FOREGROUND : style_mix(colour, COLOUR_FOREGROUND, 0.6);
    outline_of(drawn, root);
    fill_outline(cairo, root, scale, x, y, colour);
    style_stroke(cairo, (line_style){rim, given ? 1.3 : 0.7, 0.0, 0.0});
    for (size_t k = 0; k < drawn->side; k++)
    {
        const double *a = drawn->axes[k];
        if (drawn->side == 2)
            style_segment(cairo, x - scale * a[0], y + scale * a[1], x + scale * a[0], y - scale * a[1]);
        else
            trace_front(cairo, a, drawn->axes[(k + 1) % 3], scale, x, y);
    }
    style_stroke(cairo, (line_style){style_mix(rim, colour, 0.6), given ? 0.6 : 0.4, 0.0, 0.0});
}

bat_status tensor_row_draw(cairo_t *cairo, const draw_view *view, const scene_panel *panel, bat_error *error)
{
    const scene_frame *frame = &panel->frame;
    for (size_t layer = 0; layer < panel->source->layer_count; layer++)
    {
        const bat_curve *curve = panel->source->layers[layer].curve;
        double y = view_y(view, -ROW_SPACING * (double)layer);
        size_t edges = curve->closed ? curve->count : curve->count - 1;
        for (size_t k = 0; k < shown_of(curve, frame->tensor_columns); k++)
        {
            size_t index = shown_index(curve, frame->tensor_columns, k);
            double share = edges > 0 ? (double)index / (double)edges : 0.5; // of the way along the curve
            ellipsoid drawn;
            bat_status status = ellipsoid_of(curve, index, frame->tensor_unit, &drawn, error);
            if (status != BAT_OK)
                return status;
            turn(view, &drawn);
            draw_ellipsoid(cairo, &drawn, panel->source->layers[layer].role == BAT_CURVE_LAYER_ROLE_CONTROL, view->scale,
                           view_x(view, COLUMN_SPACING * ((double)frame->tensor_columns - 1.0) * share), y,
                           shade_of(panel->source, layer, share));
        }
    }
    return BAT_OK;
}
