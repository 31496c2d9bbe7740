#include "draw/motion/film.h"

#include "base/error.h"
#include "draw/common/sheet.h"
#include "draw/common/ticks.h"

#include <stdio.h>

/// @file
/// The path of a motion, seen from above, with the axes of its coordinates, its keyframes and frames of the body.

enum
{
    /// Frames at equal times where the options leave it open.
    FRAMES = 24,
    /// More circles would hide each other; beyond it dots are drawn.
    MANY_KEYS = 100,
    /// Circles along a path, but for outliers.
    MAX_RINGS = 200
};

#define FLATTEST 0.3
#define TALLEST 0.85
/// The share of the horizontal extent below which a path is level.
#define LEVEL 0.15
/// The share of the other extents below which a path is flat across a horizontal axis.
#define FLAT 0.2
/// Two horizontal variances nearer than this have no main direction.
#define ROUND 0.6
/// The margin around the path, relative to the largest extent.
#define PADDING 0.06
#define MARGIN_LEFT 66.0
#define MARGIN_RIGHT 34.0
#define MARGIN_TOP 14.0
#define MARGIN_BOTTOM 40.0
#define FRAME_LENGTH 21.0
#define LINE_FRAME_AXIS 1.5
#define TOLERANCE 0.05

static const double TURNED = 25, DEFAULT_AZIMUTH = -62, ELEVATION = 28, LEVEL_ELEVATION = 55;

typedef struct placing
{
    const path_view *view;
    double scale, x, y;
} placing;

/// A point of the space relative to the centre, with z = 0 in the plane.
static void take_point(const film *shown, const path_view *view, const double *point, double *taken)
{
    for (size_t c = 0; c < 3; c++)
        taken[c] = c < 2 || shown->space->point_dim > 2 ? point[c] - view->centre[c] : 0;
}

static double row_of(const path_view *view, int row, const double *point)
{
    const double *r = view->rows[row];
    return r[0] * point[0] + r[1] * point[1] + r[2] * point[2];
}

static void place_point(const placing *at, const double *point, double *x, double *y)
{
    *x = at->x + at->scale * row_of(at->view, 0, point);
    *y = at->y - at->scale * row_of(at->view, 1, point);
}

static void include_point(path_view *view, const double *taken)
{
    box_include(3, taken, view->low, view->high);
}

/// Include all samples and keyframes in a box of the view.
static void include_all(const film *shown, path_view *view, void (*include)(path_view *view, const double *taken))
{
    double taken[3];
    for (size_t k = 0; k < shown->count; k++)
    {
        const film_track *track = &shown->tracks[k];
        for (size_t i = 0; i < track->count + track->key_count; i++)
        {
            const double *points = i < track->count ? track->points : track->given;
            take_point(shown, view, points + (i < track->count ? i : i - track->count) * shown->space->point_dim, taken);
            include(view, taken);
        }
    }
}

static void find_box(const film *shown, path_view *view)
{
    for (int pass = 0; pass < 2; pass++)
    {
        box_clear(3, view->low, view->high);
        include_all(shown, view, include_point);
        for (int c = 0; c < 3 && pass == 0; c++)
            view->centre[c] = view->low[c] + 0.5 * (view->high[c] - view->low[c]);
    }
}

/// The upward axis, and two of a right-handed floor with it. A path flat across y is a camera's, whose y is downwards.
static void choose_up(const film *shown, path_view *view, double *sign)
{
    double extent[3];
    vector_subtract(3, view->high, view->low, extent);
    double others = fmin(fmax(extent[0], extent[1]), fmin(fmax(extent[1], extent[2]), fmax(extent[0], extent[2])));
    view->up = 2;
    for (int c = 0; c < 2; c++)
        if (shown->space->point_dim > 2 && extent[c] < FLAT * others && extent[c] < extent[2] * FLAT &&
            extent[c] < extent[1 - c] * FLAT)
            view->up = c;
    view->floor[0] = view->up == 0 ? 1 : 0;
    view->floor[1] = view->up == 2 ? 1 : 2;
    *sign = view->up == 1 ? -1 : 1;
}

/// The main direction of the path on the floor, in radians from its first axis, or NAN.
static double main_direction(const film *shown, const path_view *view)
{
    const int *floor = view->floor;
    double size = fmax(view->high[floor[0]] - view->low[floor[0]], view->high[floor[1]] - view->low[floor[1]]);
    double xx = 0, xy = 0, yy = 0, x = 0, y = 0, all = 0;
    for (size_t k = 0; k < shown->count && size > 0; k++)
        for (size_t i = 0; i < shown->tracks[k].count; i++)
        {
            double taken[3];
            take_point(shown, view, shown->tracks[k].points + i * shown->space->point_dim, taken);
            double a = taken[floor[0]] / size, b = taken[floor[1]] / size;
            x += a;
            y += b;
            xx += a * a;
            xy += a * b;
            yy += b * b;
            all += 1;
        }
    if (all == 0)
        return NAN;
    xx -= x * x / all;
    xy -= x * y / all;
    yy -= y * y / all;
    double middle = 0.5 * (xx + yy), apart = hypot(0.5 * (xx - yy), xy);
    return middle - apart > ROUND * (middle + apart) ? NAN : 0.5 * atan2(2 * xy, xx - yy);
}

/// Set the directions of the page for an azimuth and an elevation of the eye above the floor.
static void look_from(path_view *view, double sign, double azimuth, double elevation)
{
    const int *floor = view->floor;
    double up[3] = {0}, away[3] = {0}, right[3] = {0};
    up[view->up] = sign;
    away[floor[0]] = cos(azimuth);
    away[floor[1]] = sin(azimuth);
    right[floor[0]] = -sin(azimuth);
    right[floor[1]] = cos(azimuth);
    for (int c = 0; c < 3; c++)
    {
        view->rows[0][c] = right[c];
        view->rows[1][c] = cos(elevation) * up[c] - sin(elevation) * away[c];
        view->rows[2][c] = sin(elevation) * up[c] + cos(elevation) * away[c];
    }
}

/// Widen the box, so that it has an extent in all directions.
static void pad_box(path_view *view)
{
    double largest = 0, size = 1;
    for (int c = 0; c < 3; c++)
    {
        largest = fmax(largest, view->high[c] - view->low[c]);
        size = fmax(size, 1e-9 * fabs(view->centre[c]));
    }
    double pad = largest > 0 ? fmax(PADDING * largest, 1e-14 * size) : 0.5 * size;
    for (int c = 0; c < (view->flat ? 2 : 3); c++)
    {
        view->low[c] -= pad;
        view->high[c] += pad;
    }
}

static void extend_page(path_view *view, const double *relative)
{
    const double place[2] = {row_of(view, 0, relative), row_of(view, 1, relative)};
    box_include(2, place, view->page_low, view->page_high);
}

/// The height of the floor: the end of the box that is lower on the page.
static double floor_of(const path_view *view)
{
    return view->rows[1][view->up] >= 0 ? view->low[view->up] : view->high[view->up];
}

/// Extend the page by the floor and the upright axis at its left.
static void include_floor(path_view *view)
{
    int up = view->up, first = view->floor[0], second = view->floor[1], leftmost = 0;
    double corners[4][3];
    for (int k = 0; k < 4; k++)
    {
        corners[k][up] = floor_of(view);
        corners[k][first] = k & 1 ? view->high[first] : view->low[first];
        corners[k][second] = k & 2 ? view->high[second] : view->low[second];
        leftmost = row_of(view, 0, corners[k]) < row_of(view, 0, corners[leftmost]) ? k : leftmost;
        extend_page(view, corners[k]);
    }
    corners[leftmost][up] = view->rows[1][up] >= 0 ? view->high[up] : view->low[up];
    extend_page(view, corners[leftmost]);
}

void path_view_make(const film *shown, path_view *view)
{
    double sign;
    *view = (path_view){.flat = shown->space->point_dim == 2, .rows = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    find_box(shown, view);
    choose_up(shown, view, &sign);
    if (!view->flat)
    {
        const int *floor = view->floor;
        double along = main_direction(shown, view), height = view->high[view->up] - view->low[view->up];
        double wide = fmax(view->high[floor[0]] - view->low[floor[0]], view->high[floor[1]] - view->low[floor[1]]);
        double azimuth = isnan(along) ? DEFAULT_AZIMUTH * ANGLE_DEGREE : along - (90 - TURNED) * ANGLE_DEGREE;
        look_from(view, sign, azimuth, (height < LEVEL * wide ? LEVEL_ELEVATION : ELEVATION) * ANGLE_DEGREE);
    }
    pad_box(view);
    box_clear(2, view->page_low, view->page_high);
    include_floor(view);
    include_all(shown, view, extend_page);
}

double path_aspect(const path_view *view)
{
    const double *low = view->page_low, *high = view->page_high;
    return fmin(fmax((high[1] - low[1]) / (high[0] - low[0]), FLATTEST), TALLEST);
}

// Axes

/// The ticks of one axis: along an edge of the box, with labels away from the box.
typedef struct box_edge
{
    int axis;
    double at[3];          ///< the beginning of the edge; at[axis] runs
    double away_x, away_y; ///< the direction of the labels on the page
} box_edge;

static tick_list edge_ticks(const placing *at, const box_edge *edge)
{
    const path_view *view = at->view;
    double low = view->low[edge->axis] + view->centre[edge->axis], high = view->high[edge->axis] + view->centre[edge->axis];
    double length = at->scale * (high - low) * hypot(view->rows[0][edge->axis], view->rows[1][edge->axis]);
    tick_list ticks = ticks_linear(low, high, length / 34.0);
    ticks_use_scale(&ticks, ticks_scale(low, high));
    return ticks;
}

static void draw_edge(cairo_t *cairo, const film *shown, const placing *at, const box_edge *edge)
{
    static const char *const names[] = {"x", "y", "z"};
    const path_view *view = at->view;
    tick_list ticks = edge_ticks(at, edge);
    char text[128], scale[TICK_SCALE_SIZE];
    double p[3], x, y, widest = 0;
    memcpy(p, edge->at, sizeof p);
    text_use(cairo, TEXT_TICK, false);
    double align = 0.5 - 0.5 * edge->away_x;
    for (size_t i = 0; i < ticks.count; i++)
    {
        p[edge->axis] = ticks.values[i] - view->centre[edge->axis];
        place_point(at, p, &x, &y);
        style_segment(cairo, x, y, x + 3 * edge->away_x, y + 3 * edge->away_y);
        style_stroke(cairo, (line_style){COLOUR_FRAME, LINE_FRAME, 0, 0});
        style_use_colour(cairo, COLOUR_MUTED);
        if (!ticks.labelled[i])
            continue;
        tick_draw(cairo, &ticks, i, x + 6 * edge->away_x, y + 9 * edge->away_y, align);
        widest = fmax(widest, tick_width(cairo, &ticks, i));
    }
    tick_scale_text(ticks.scale, scale);
    bool unit = shown->length_unit[0] != '\0';
    (void)snprintf(text, sizeof text, "%s%s%.40s%s%s%s%s", names[edge->axis], unit ? " (" : "", shown->length_unit,
                   unit ? ")" : "", scale[0] != '\0' ? " (" : "", scale, scale[0] != '\0' ? ")" : "");
    p[edge->axis] = 0.5 * (view->low[edge->axis] + view->high[edge->axis]);
    place_point(at, p, &x, &y);
    text_use(cairo, TEXT_LEGEND, false);
    style_use_colour(cairo, COLOUR_FOREGROUND);
    double off = 14 + widest * fabs(edge->away_x);
    text_draw_middle(cairo, text, x + edge->away_x * off, y + edge->away_y * (off + 9 * fabs(edge->away_y)), align);
}

/// The floor with a grid at the ticks of both axes.
static void draw_floor(cairo_t *cairo, const placing *at, const box_edge *first, const box_edge *second)
{
    const path_view *view = at->view;
    const box_edge *edges[2] = {first, second};
    double x, y;
    for (int k = 0; k < 2; k++)
    {
        tick_list ticks = edge_ticks(at, edges[k]);
        int along = edges[1 - k]->axis;
        for (size_t i = 0; i < ticks.count + 2; i++)
        {
            double p[3];
            memcpy(p, edges[k]->at, sizeof p);
            p[edges[k]->axis] = i < ticks.count    ? ticks.values[i] - view->centre[edges[k]->axis]
                                : i == ticks.count ? view->low[edges[k]->axis]
                                                   : view->high[edges[k]->axis];
            p[along] = view->low[along];
            place_point(at, p, &x, &y);
            cairo_move_to(cairo, x, y);
            p[along] = view->high[along];
            place_point(at, p, &x, &y);
            cairo_line_to(cairo, x, y);
            style_stroke(cairo, (line_style){i < ticks.count ? COLOUR_GRID : COLOUR_STRONG_GRID, LINE_GRID, 0, 0});
        }
    }
}

/// Two edges of the floor that are near to the eye, and the upright one at the left.
static void choose_edges(const path_view *view, box_edge edges[3])
{
    int up = view->up;
    const int *floor = view->floor;
    double low_floor = floor_of(view);
    for (int k = 0; k < 2; k++)
    {
        int axis = floor[k], other = floor[1 - k];
        // The nearer edge is the lower one on the page.
        bool low = view->rows[1][other] > 0 || (view->rows[1][other] == 0 && view->rows[0][other] > 0);
        edges[k] = (box_edge){.axis = axis};
        edges[k].at[up] = low_floor;
        edges[k].at[other] = low ? view->low[other] : view->high[other];
        // Perpendicular to the edge, away from the floor.
        double x = view->rows[1][axis], y = view->rows[0][axis], length = hypot(x, y);
        double out = (low ? -1 : 1) * (x * view->rows[0][other] - y * view->rows[1][other]) < 0 ? -1 : 1;
        edges[k].away_x = out * x / length;
        edges[k].away_y = out * y / length;
    }
    // Upright: the corner farthest to the left.
    edges[2] = (box_edge){.axis = up, .away_x = -1};
    for (int k = 0; k < 2; k++)
        edges[2].at[floor[k]] = view->rows[0][floor[k]] >= 0 ? view->low[floor[k]] : view->high[floor[k]];
}

static void draw_upright(cairo_t *cairo, const film *shown, const placing *at, const box_edge *edge)
{
    const path_view *view = at->view;
    double p[3], x, y,
        height = at->scale * (view->high[edge->axis] - view->low[edge->axis]) * fabs(view->rows[1][edge->axis]);
    memcpy(p, edge->at, sizeof p);
    if (!(height > 24))
        return;
    p[edge->axis] = view->low[edge->axis];
    place_point(at, p, &x, &y);
    cairo_move_to(cairo, x, y);
    p[edge->axis] = view->high[edge->axis];
    place_point(at, p, &x, &y);
    cairo_line_to(cairo, x, y);
    style_stroke(cairo, (line_style){COLOUR_STRONG_GRID, LINE_GRID, 0, 0});
    draw_edge(cairo, shown, at, edge);
}

// The motion

/// Stroke a path; `floor` flattens it onto the floor.
static void draw_line(cairo_t *cairo, const film *shown, const film_track *track, const placing *at, const double *floor,
                      line_style style)
{
    path_simplifier path = simplifier_begin(canvas_sink(cairo), TOLERANCE);
    for (size_t i = 0; i < track->count; i++)
    {
        double p[3], x, y;
        take_point(shown, at->view, track->points + i * shown->space->point_dim, p);
        if (floor != NULL)
            p[at->view->up] = *floor;
        place_point(at, p, &x, &y);
        (i == 0 ? simplifier_move : simplifier_line)(&path, x, y);
    }
    simplifier_flush(&path);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    style_stroke(cairo, style);
}

static void draw_keys(cairo_t *cairo, const film *shown, const film_track *track, const placing *at)
{
    bool many = track->key_count > MANY_KEYS;
    size_t stride = 1 + track->key_count / MAX_RINGS; // else rings hide the path
    for (int outlying = 0; outlying < 2; outlying++)
        for (size_t i = 0; i < track->key_count; i++)
        {
            double p[3], x, y;
            bool marked = shown->outlying > 0 && track->deviations[i] > shown->outlying;
            if (marked != (outlying == 1) || (!marked && i % stride != 0))
                continue;
            take_point(shown, at->view, track->given + i * shown->space->point_dim, p);
            place_point(at, p, &x, &y);
            if (marked)
                legend_dot(cairo, x, y, MARKER_RADIUS, style_palette(4));
            else
                legend_ring(cairo, x, y, many ? 0.5 * MARKER_RADIUS : MARKER_RADIUS, COLOUR_CONTROL);
        }
}

typedef struct body_frame
{
    double x, y, depth;
    double axes[3][3]; ///< on the page to the right and upwards, and to the eye
} body_frame;

static void draw_frame(cairo_t *cairo, const body_frame *frame)
{
    // The axis that points away most comes first.
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 3; i++)
        for (int j = i + 1; j < 3; j++)
            if (frame->axes[order[j]][2] < frame->axes[order[i]][2])
                SWAP(order[i], order[j]);
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < 3; i++)
        {
            const double *axis = frame->axes[order[i]];
            style_segment(cairo, frame->x, frame->y, frame->x + FRAME_LENGTH * axis[0], frame->y - FRAME_LENGTH * axis[1]);
            style_use_line(cairo, pass == 0 ? (line_style){COLOUR_BACKGROUND, LINE_FRAME_AXIS + 1.2, 0, 0}
                                            : (line_style){film_axis_colour((size_t)order[i]), LINE_FRAME_AXIS, 0, 0});
            cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
            cairo_stroke(cairo);
        }
}

#define MOST 1000 ///< frames

/// Draw frames at equal times, from the farthest to the nearest; those that would cover earlier ones are left out.
static bat_status draw_frames(cairo_t *cairo, const film *shown, const film_track *track, const placing *at,
                              bat_error *error)
{
    body_frame frames[MOST];
    size_t wanted = shown->poses > 0 ? shown->poses : FRAMES, count = 0;
    double begin = track->times[0], end = track->times[track->count - 1];
    for (size_t i = 0; i < wanted && i < MOST; i++)
    {
        double pose[7], matrix[9], p[3];
        double time = wanted > 1 ? begin + (end - begin) * ((double)i / (double)(wanted - 1)) : begin;
        bat_status status = film_at(shown, track, time, pose, error);
        if (status != BAT_OK)
            return status;
        body_frame *frame = &frames[count];
        bat_rotation_to_matrix(pose + 3, matrix);
        take_point(shown, at->view, pose, p);
        place_point(at, p, &frame->x, &frame->y);
        frame->depth = row_of(at->view, 2, p);
        for (int a = 0; a < 3; a++)
            for (int r = 0; r < 3; r++)
                frame->axes[a][r] = row_of(at->view, r, (double[3]){matrix[a], matrix[3 + a], matrix[6 + a]});
        bool free = true;
        for (size_t k = 0; k < count && shown->poses == 0; k++)
            free = free && hypot(frames[k].x - frame->x, frames[k].y - frame->y) > FRAME_LENGTH;
        count += free;
    }
    for (size_t i = 1; i < count; i++) // insertion sort by depth
        for (size_t j = i; j > 0 && frames[j].depth < frames[j - 1].depth; j--)
            SWAP(frames[j], frames[j - 1]);
    for (size_t i = 0; i < count; i++)
        draw_frame(cairo, &frames[i]);
    return BAT_OK;
}

static void draw_ends(cairo_t *cairo, const film *shown, const film_track *track, const placing *at)
{
    size_t dim = shown->space->point_dim;
    double p[3], x[2], y[2];
    for (int end = 0; end < 2; end++)
    {
        take_point(shown, at->view, track->points + (end == 0 ? 0 : track->count - 1) * dim, p);
        place_point(at, p, &x[end], &y[end]);
    }
    bool apart = hypot(x[1] - x[0], y[1] - y[0]) > 12;
    text_use(cairo, TEXT_TICK, false);
    for (int end = 0; end < (apart ? 2 : 1); end++)
    {
        const char *name = !apart ? "start, end" : end == 0 ? "start" : "end";
        double beside = apart && x[end] < x[1 - end] ? -7 : 7;
        legend_dot(cairo, x[end], y[end], MARKER_RADIUS, track->colour);
        cairo_move_to(cairo, x[end] + beside - (beside < 0 ? text_width(cairo, name) : 0), y[end] + 0.36 * TEXT_TICK);
        cairo_text_path(cairo, name);
        style_stroke(cairo, (line_style){COLOUR_BACKGROUND, 2.4, 0, 0});
        style_use_colour(cairo, COLOUR_FOREGROUND);
        text_draw_middle(cairo, name, x[end] + beside, y[end], beside < 0 ? 1 : 0);
    }
}

bat_status path_draw(const film *shown, const path_view *view, cairo_t *cairo, const double box[4], bat_error *error)
{
    double width = fmax(box[2] - MARGIN_LEFT - MARGIN_RIGHT, 1), height = fmax(box[3] - MARGIN_TOP - MARGIN_BOTTOM, 1);
    const double *low = view->page_low, *high = view->page_high;
    placing at = {.view = view};
    at.scale = fmin(width / (high[0] - low[0]), height / (high[1] - low[1]));
    at.x = box[0] + MARGIN_LEFT + 0.5 * width - at.scale * 0.5 * (low[0] + high[0]);
    at.y = box[1] + MARGIN_TOP + 0.5 * height + at.scale * 0.5 * (high[1] + low[1]);
    box_edge edges[3];
    if (!isfinite(at.scale))
        return error_set(error, BAT_INVALID_POINT, BAT_NO_INDEX, 0, "the path is too small for a picture");
    choose_edges(view, edges);
    draw_floor(cairo, &at, &edges[0], &edges[1]);
    draw_edge(cairo, shown, &at, &edges[0]);
    draw_edge(cairo, shown, &at, &edges[1]);
    if (!view->flat)
        draw_upright(cairo, shown, &at, &edges[2]);
    double floor = edges[0].at[view->up];
    for (size_t k = 0; k < shown->count && !view->flat; k++)
        draw_line(cairo, shown, &shown->tracks[k], &at, &floor, (line_style){COLOUR_TRUTH, LINE_CONTROL, 0, 0});
    for (size_t k = 0; k < shown->count; k++)
        draw_line(cairo, shown, &shown->tracks[k], &at, NULL, (line_style){shown->tracks[k].colour, 1.1, 0, 0});
    bat_status status = BAT_OK;
    for (size_t k = 0; k < shown->count && status == BAT_OK; k++)
    {
        if (shown->body)
            status = draw_frames(cairo, shown, &shown->tracks[k], &at, error);
        draw_keys(cairo, shown, &shown->tracks[k], &at);
        if (!shown->keyframes->curves[k].closed && status == BAT_OK)
            draw_ends(cairo, shown, &shown->tracks[k], &at);
    }
    return status;
}
