#include "draw/common/ticks.h"
#include "draw/curve/scene.h"

#include <string.h>

/// @file
/// Grids of the plane, the box of R^3 and the disk.

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
    for (size_t i = 0; i < across.count; i++)
    {
        cairo_move_to(cairo, view_x(view, across.values[i]), box[1]);
        cairo_rel_line_to(cairo, 0.0, box[3]);
    }
    for (size_t i = 0; i < upwards.count; i++)
    {
        cairo_move_to(cairo, box[0], view_y(view, upwards.values[i]));
        cairo_rel_line_to(cairo, box[2], 0.0);
    }
    style_stroke(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
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

// The tiling {5, 4} of the hyperbolic plane: regular right-angled pentagons, four at each vertex (Coxeter, 1957).
//
// Its edges lie on complete geodesics, the images of one pentagon's sides under reflections in these sides. A geodesic is
// given by its unit normal n = (x, y, t) in Minkowski space, x x' + y y' - t t' = 1 with t > 0. In the disk it is an arc
// with centre (x, y) / t and radius 1 / t.

#define SIDES 5
#define MAX_GEODESICS 2048
#define SMALLEST_RADIUS 0.045

typedef struct geodesic
{
    double x, y, t;
} geodesic;

typedef struct tiling
{
    geodesic geodesics[MAX_GEODESICS];
    int count;
} tiling;

/// The reflection g - 2 <g, m> m of a geodesic g in the geodesic m, with t > 0.
static geodesic reflect(geodesic g, geodesic mirror)
{
    double twice = 2.0 * (g.x * mirror.x + g.y * mirror.y - g.t * mirror.t);
    geodesic image = {g.x - twice * mirror.x, g.y - twice * mirror.y, g.t - twice * mirror.t};
    double sign = image.t < 0.0 ? -1.0 : 1.0;
    return (geodesic){sign * image.x, sign * image.y, sign * image.t};
}

static bool is_new(const tiling *made, geodesic g)
{
    for (int i = 0; i < made->count; i++)
    {
        const geodesic *known = &made->geodesics[i];
        if (fabs(known->x - g.x) + fabs(known->y - g.y) + fabs(known->t - g.t) < 1e-6 * (1.0 + g.t))
            return false;
    }
    return true;
}

/// Find all geodesics of the tiling whose arcs have at least the smallest radius, from the centre outwards.
static void make_tiling(tiling *made)
{
    double middle = acosh(cos(ANGLE_TURN / 8.0) /
                          sin(ANGLE_TURN / (2.0 * SIDES))); // the distance from the pentagon's centre to its sides
    made->count = SIDES;
    for (int i = 0; i < SIDES; i++)
    {
        double angle = ANGLE_TURN * (0.25 + (double)i / SIDES);
        made->geodesics[i] = (geodesic){cosh(middle) * cos(angle), cosh(middle) * sin(angle), sinh(middle)};
    }
    for (int i = 0; i < made->count; i++)
        for (int side = 0; side < SIDES && made->count < MAX_GEODESICS; side++)
        {
            geodesic image = reflect(made->geodesics[i], made->geodesics[side]);
            if (image.t * SMALLEST_RADIUS <= 1.0 && is_new(made, image))
                made->geodesics[made->count++] = image;
        }
}

/// Append the arc inside the disk to the path. Seen from its centre (x, y) / t, its ends are at angles of tangent t.
static void add_arc(cairo_t *cairo, const draw_view *view, geodesic g)
{
    double facing = atan2(g.y, -g.x); // towards the origin, on the page, where y points down
    double half = atan(g.t);
    double radius = view->scale / g.t;
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, view_x(view, g.x / g.t), view_y(view, g.y / g.t), radius, facing - half, facing + half);
}

void grid_disk(cairo_t *cairo, const draw_view *view, bool lines)
{
    cairo_arc(cairo, view->origin_x, view->origin_y, view->scale, 0.0, ANGLE_TURN);
    cairo_set_source_rgb(cairo, 0.982, 0.986, 0.991);
    cairo_fill(cairo);
    if (!lines)
        return;
    tiling made;
    make_tiling(&made);
    for (int i = 0; i < made.count; i++)
        add_arc(cairo, view, made.geodesics[i]);
    style_use_line(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
    cairo_stroke(cairo);
}

void grid_disk_circle(cairo_t *cairo, const draw_view *view)
{
    cairo_arc(cairo, view->origin_x, view->origin_y, view->scale, 0.0, ANGLE_TURN);
    style_stroke(cairo, (line_style){COLOUR_FRAME, 1.2 * LINE_FRAME, 0.0, 0.0});
}
