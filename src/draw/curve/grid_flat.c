#include "draw/common/ticks.h"
#include "draw/curve/scene.h"

#include <string.h>

/// @file
/// Grids of the plane and the box of R^3.

/// The preferred distance of grid lines, in points.
#define SPACING 42.0
/// The height of the text for the labels' common offset and exponent.
#define SCALE_SPACE 10.0

/// The offsets and exponents of both axes: each axis has its own offset; the exponent is common.
static void plane_scales(const scene_frame *frame, tick_scale scales[2])
{
    for (int k = 0; k < 2; k++)
        scales[k] = ticks_scale(frame->low[k], frame->high[k]);
    int exponent = scales[0].exponent > scales[1].exponent ? scales[0].exponent : scales[1].exponent;
    scales[0].exponent = scales[1].exponent = exponent;
}

insets grid_plane_room(const scene_frame *frame)
{
    const double digit_width = 0.64 * TEXT_TICK;
    tick_scale scales[2];
    plane_scales(frame, scales);
    tick_list ticks = ticks_linear(frame->low[1], frame->high[1], 8.0);
    ticks_use_scale(&ticks, scales[1]);
    size_t longest = 2;
    for (size_t i = 0; i < ticks.count; i++)
    {
        char label[TICK_LABEL_SIZE];
        tick_label(&ticks, i, label);
        size_t length = strlen(label);
        longest = length > longest ? length : longest;
    }
    char across[TICK_SCALE_SIZE], upwards[TICK_SCALE_SIZE];
    tick_scale_text(scales[0], across);
    tick_scale_text(scales[1], upwards);
    return (insets){.left = 8.0 + digit_width * (double)longest,
                    .top = *upwards != '\0' ? 5.0 + SCALE_SPACE : 5.0,
                    .right = 8.0,
                    .bottom = *across != '\0' ? 18.0 + SCALE_SPACE : 18.0};
}

static void plane_lines(cairo_t *cairo, const draw_view *view, const tick_list *across, const tick_list *upwards,
                        const double box[4])
{
    for (size_t i = 0; i < across->count; i++)
    {
        cairo_move_to(cairo, view_x(view, across->values[i]), box[1]);
        cairo_rel_line_to(cairo, 0.0, box[3]);
    }
    for (size_t i = 0; i < upwards->count; i++)
    {
        cairo_move_to(cairo, box[0], view_y(view, upwards->values[i]));
        cairo_rel_line_to(cairo, box[2], 0.0);
    }
    style_stroke(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
}

/// Draw the numbers below and to the left, with offset and exponent below the right end and above the top.
static void plane_labels(cairo_t *cairo, const draw_view *view, const tick_list *across, const tick_list *upwards,
                         const double box[4])
{
    char text[TICK_SCALE_SIZE];
    double right = box[0] + box[2], bottom = box[1] + box[3];
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    double widest = 0.0;
    for (size_t i = 0; i < across->count; i++)
        widest = fmax(widest, tick_width(cairo, across, i));
    double every = fmax(1.0, ceil((widest + 5.0) / (view->scale * across->step)));
    for (size_t i = 0; i < across->count; i++)
        if (fmod(round(across->values[i] / across->step), every) == 0.0)
            tick_draw(cairo, across, i, view_x(view, across->values[i]), bottom + 8.0, 0.5);
    for (size_t i = 0; i < upwards->count; i++)
        tick_draw(cairo, upwards, i, box[0] - 4.0, view_y(view, upwards->values[i]), 1.0);
    tick_scale_text(across->scale, text);
    text_draw_middle(cairo, text, right, bottom + 8.0 + SCALE_SPACE, 1.0);
    tick_scale_text(upwards->scale, text);
    text_draw_middle(cairo, text, box[0], box[1] - 0.6 * SCALE_SPACE, 0.0);
}

void grid_plane(cairo_t *cairo, const draw_view *view, const scene_frame *frame, const double box[4])
{
    double low_u = (box[0] - view->origin_x) / view->scale;
    double high_u = (box[0] + box[2] - view->origin_x) / view->scale;
    double low_v = (view->origin_y - box[1] - box[3]) / view->scale;
    double high_v = (view->origin_y - box[1]) / view->scale;
    double wanted = fmax(2.0, fmin(box[2], box[3]) / SPACING);
    double extent = fmin(high_u - low_u, high_v - low_v);
    tick_scale scales[2];
    plane_scales(frame, scales);
    tick_list across = ticks_linear(low_u, high_u, wanted * (high_u - low_u) / extent);
    tick_list upwards = ticks_linear(low_v, high_v, wanted * (high_v - low_v) / extent);
    ticks_use_scale(&across, scales[0]);
    ticks_use_scale(&upwards, scales[1]);
    plane_lines(cairo, view, &across, &upwards, box);
    plane_labels(cairo, view, &across, &upwards, box);
}

/// Both ends of an edge on the page.
static void edge_ends(const draw_view *view, const scene_frame *frame, unsigned from, unsigned to, double ends[4])
{
    double p[3], q[3];
    scene_corner(frame, from, p);
    scene_corner(frame, to, q);
    view_place(view, p, &ends[0], &ends[1]);
    view_place(view, q, &ends[2], &ends[3]);
}

static void box_edge(cairo_t *cairo, const draw_view *view, const scene_frame *frame, unsigned from, unsigned to)
{
    double ends[4];
    edge_ends(view, frame, from, to, ends);
    style_segment(cairo, ends[0], ends[1], ends[2], ends[3]);
}

static void axis_name(cairo_t *cairo, const draw_view *view, const scene_frame *frame, unsigned axis, unsigned from,
                      unsigned to)
{
    static const char *const names[] = {"x", "y", "z"};
    double ends[4];
    edge_ends(view, frame, from, to, ends);
    double dx = ends[2] - ends[0], dy = ends[3] - ends[1];
    double length = hypot(dx, dy);
    double away = axis == 2 ? -7.0 : 9.0; // z to the left of its edge; x and y below theirs
    double side_x = length > 0.0 ? -dy / length : 0.0, side_y = length > 0.0 ? dx / length : 0.0;
    if (axis == 2 ? side_x < 0.0 : side_y < 0.0)
    {
        side_x = -side_x;
        side_y = -side_y;
    }
    text_draw_middle(cairo, names[axis], ends[0] + 0.5 * dx + away * side_x, ends[1] + 0.5 * dy + away * side_y, 0.5);
}

/// The edges at the lowest, farthest corner are solid, the others are fainter. Seen from above at azimuth -62 degrees, x
/// runs to the right on the lower front edge, y backwards on the right, and z upwards on the left.
void grid_solid(cairo_t *cairo, const draw_view *view, const scene_frame *frame)
{
    for (unsigned corner = 0; corner < 8; corner++)
        for (unsigned axis = 0; axis < 3; axis++)
            if ((corner >> axis & 1u) == 0)
                box_edge(cairo, view, frame, corner, corner | 1u << axis);
    style_stroke(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
    box_edge(cairo, view, frame, 0, 1);
    box_edge(cairo, view, frame, 1, 3);
    box_edge(cairo, view, frame, 0, 4);
    style_stroke(cairo, (line_style){COLOUR_STRONG_GRID, LINE_FRAME, 0.0, 0.0});
    text_use(cairo, TEXT_LEGEND, false);
    style_use_colour(cairo, COLOUR_MUTED);
    axis_name(cairo, view, frame, 0, 0, 1);
    axis_name(cairo, view, frame, 1, 1, 3);
    axis_name(cairo, view, frame, 2, 0, 4);
}
