#include "draw/common/sheet.h"
#include "draw/curve/scene.h"

#include <stdio.h>

/// @file
/// Graticule, frame and scale bar of local maps.

static const double SECOND = ANGLE_PI / 648000.0;

#define SECONDS_PER_MINUTE 60.0
#define SECONDS_PER_DEGREE 3600.0
/// The distance of labels from the frame.
#define LABEL_GAP 3.0

double grid_step(double range)
{
    static const double steps[] = {30.0, 20.0, 10.0, 5.0, 2.0, 1.0};
    static const double units[] = {SECONDS_PER_DEGREE, SECONDS_PER_MINUTE, 1.0};
    const double wanted = 3.0;
    for (size_t unit = 0; unit < 3; unit++)
        for (size_t i = 0; i < 6; i++)
            if (wanted * steps[i] * units[unit] <= range)
                return steps[i] * units[unit];
    double step = 0.5;
    for (int i = 1; wanted * step > range && step > 1e-9; i++)
        step *= i % 3 == 1 ? 0.4 : 0.5; // 0.5, 0.2, 0.1, 0.05, …
    return step;
}

void grid_angle_label(double seconds, double step, const char *positive, const char *negative, char *label, size_t size)
{
    int decimals = step < 1.0 ? (int)ceil(-log10(step) - 1e-9) : 0;
    double unit = pow(10.0, -decimals);
    double whole = round(fabs(seconds) / unit) * unit;
    double degrees = floor(whole / SECONDS_PER_DEGREE + 1e-12);
    double minutes = floor((whole - degrees * SECONDS_PER_DEGREE) / SECONDS_PER_MINUTE + 1e-9);
    double rest = fabs(whole - degrees * SECONDS_PER_DEGREE - minutes * SECONDS_PER_MINUTE);
    bool plain = whole == 0.0 || (positive[0] == 'E' && whole == 180.0 * SECONDS_PER_DEGREE);
    const char *side = plain ? "" : seconds > 0.0 ? positive : negative;
    if (step >= SECONDS_PER_DEGREE)
        (void)snprintf(label, size, "%.0f\xc2\xb0%s", degrees, side);
    else if (step >= SECONDS_PER_MINUTE)
        (void)snprintf(label, size, "%.0f\xc2\xb0%02.0f\xe2\x80\xb2%s", degrees, minutes, side);
    else
        (void)snprintf(label, size, "%.0f\xc2\xb0%02.0f\xe2\x80\xb2%0*.*f\xe2\x80\xb3%s", degrees, minutes,
                       decimals > 0 ? decimals + 3 : 2, decimals, rest, side);
}

double grid_scale_length(double width)
{
    double limit = 0.25 * width;
    double power = pow(10.0, floor(log10(limit)));
    double lead = limit / power;
    return power * (lead >= 5.0 ? 5.0 : lead >= 2.0 ? 2.0 : 1.0);
}

void grid_scale_bar(cairo_t *cairo, double x, double y, double width, double extent, const char *unit)
{
    double length = grid_scale_length(extent);
    double page = width * length / extent;
    char label[96];
    bool metres = strcmp(unit, "m") == 0;
    if (metres && length >= 1000.0)
        (void)snprintf(label, sizeof label, "%.10g km", length / 1000.0);
    else if (metres && length < 1.0)
        (void)snprintf(label, sizeof label, "%.6g cm", length * 100.0);
    else
        (void)snprintf(label, sizeof label, "%.10g %.60s", length, unit);
    style_segment(cairo, x, y - 2.0, x, y + 2.0);
    style_segment(cairo, x, y, x + page, y);
    style_segment(cairo, x + page, y - 2.0, x + page, y + 2.0);
    style_stroke(cairo, (line_style){COLOUR_MUTED, LINE_FRAME, 0.0, 0.0});
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    text_draw_middle(cairo, label, x + page + 5.0, y, 0.0);
}

#define MAX_LABELS 256

/// The angles that a window covers, in seconds of arc. Longitudes are relative to that of the centre.
typedef struct window_range
{
    double south, north;
    double west, east;
    bool north_pole, south_pole;
    double lat_step, lon_step;
    double labels[MAX_LABELS][3]; ///< the labels so far: their middles on the page, and half their widths
    size_t label_count;
} window_range;

static bool pole_in_window(const draw_view *view, const scene_frame *frame, double side)
{
    double u, v;
    view_project(view, (double[3]){0.0, 0.0, side}, &u, &v);
    return u >= frame->map.low[0] && u <= frame->map.high[0] && v >= frame->map.low[1] && v <= frame->map.high[1];
}

static void include_border(window_range *range, const draw_view *view, const scene_frame *frame, double u, double v)
{
    double point[3];
    view_local_point(view, u, v, point);
    double latitude = atan2(point[2], hypot(point[0], point[1])) / SECOND;
    double longitude = remainder(atan2(point[1], point[0]) - frame->map.longitude, ANGLE_TURN) / SECOND;
    range->south = fmin(range->south, latitude);
    range->north = fmax(range->north, latitude);
    range->west = fmin(range->west, longitude);
    range->east = fmax(range->east, longitude);
}

/// Round a step of longitudes up so that polar maps have few.
static void choose_steps(window_range *range, const scene_frame *frame)
{
    const double polar_step = 30.0 * SECONDS_PER_DEGREE;
    double width = (frame->map.high[0] - frame->map.low[0]) / SECOND;
    double height = (frame->map.high[1] - frame->map.low[1]) / SECOND;
    bool polar = range->north_pole || range->south_pole;
    range->lat_step = grid_step(fmin(polar ? 0.5 * height : height, 180.0 * SECONDS_PER_DEGREE));
    double level = fmax(cos(frame->map.latitude), 1e-3);
    range->lon_step = polar ? polar_step : fmin(grid_step(fmin(width / level, 360.0 * SECONDS_PER_DEGREE)), polar_step);
}

static window_range range_of(const draw_view *view, const scene_frame *frame)
{
    static const int STEPS = 64;
    window_range range = {.south = INFINITY, .north = -INFINITY, .west = INFINITY, .east = -INFINITY};
    const double *low = frame->map.low, *high = frame->map.high;
    for (int i = 0; i <= STEPS; i++)
    {
        double u = low[0] + (high[0] - low[0]) * i / STEPS, v = low[1] + (high[1] - low[1]) * i / STEPS;
        include_border(&range, view, frame, u, low[1]);
        include_border(&range, view, frame, u, high[1]);
        include_border(&range, view, frame, low[0], v);
        include_border(&range, view, frame, high[0], v);
    }
    range.north_pole = pole_in_window(view, frame, 1.0);
    range.south_pole = pole_in_window(view, frame, -1.0);
    const double quarter = 90.0 * SECONDS_PER_DEGREE;
    range.north = range.north_pole ? quarter : range.north;
    range.south = range.south_pole ? -quarter : range.south;
    if (range.north_pole || range.south_pole)
    {
        range.west = -2.0 * quarter;
        range.east = 2.0 * quarter;
    }
    choose_steps(&range, frame);
    return range;
}

#define LINE_STEPS 180

/// The points of a line of the graticule within the range; `at` is in seconds, for meridians absolute.
static void line_points(const window_range *range, const scene_frame *frame, double at, bool parallel, double *points)
{
    for (int i = 0; i <= LINE_STEPS; i++)
    {
        double share = (double)i / LINE_STEPS;
        double longitude =
            parallel ? frame->map.longitude + SECOND * (range->west + share * (range->east - range->west)) : SECOND * at;
        double latitude = SECOND * (parallel ? at : range->south + share * (range->north - range->south));
        double *point = points + (size_t)(3 * i);
        point[0] = cos(latitude) * cos(longitude);
        point[1] = cos(latitude) * sin(longitude);
        point[2] = sin(latitude);
    }
}

/// A side of the window: coordinate `axis` has the value `at`.
typedef struct window_side
{
    int axis;
    double at;
} window_side;

/// Where a line crosses a side of the window.
/// @return false when it does not
static bool cross_side(const draw_view *view, const scene_frame *frame, const double *points, window_side side,
                       double place[2])
{
    double last[2];
    view_project(view, points, &last[0], &last[1]);
    for (int i = 1; i <= LINE_STEPS; i++)
    {
        double next[2];
        view_project(view, points + (size_t)(3 * i), &next[0], &next[1]);
        double from = last[side.axis] - side.at, to = next[side.axis] - side.at;
        if ((from < 0.0) != (to < 0.0))
        {
            double share = from / (from - to);
            place[side.axis] = side.at;
            place[1 - side.axis] = last[1 - side.axis] + share * (next[1 - side.axis] - last[1 - side.axis]);
            if (place[1 - side.axis] >= frame->map.low[1 - side.axis] &&
                place[1 - side.axis] <= frame->map.high[1 - side.axis])
                return true;
        }
        last[0] = next[0];
        last[1] = next[1];
    }
    return false;
}

/// Calls `take` for each line of the graticule.
typedef void (*line_taker)(cairo_t *cairo, const draw_view *view, const scene_frame *frame, window_range *range,
                           const double *points, double at, bool parallel);

static void visit_lines(cairo_t *cairo, const draw_view *view, const scene_frame *frame, line_taker take)
{
    double points[3 * (LINE_STEPS + 1)];
    window_range range = range_of(view, frame);
    const double quarter = 90.0 * SECONDS_PER_DEGREE;
    double step = range.lat_step;
    for (double k = ceil(range.south / step); k * step <= range.north; k += 1.0)
        if (fabs(k * step) < quarter - 0.5 * step)
        {
            line_points(&range, frame, k * step, true, points);
            take(cairo, view, frame, &range, points, k * step, true);
        }
    step = range.lon_step;
    double middle = frame->map.longitude / SECOND;
    double first = ceil((middle + range.west) / step), last = floor((middle + range.east) / step);
    last = last * step - first * step > 4.0 * quarter - 0.5 * step ? last - 1.0 : last; // once around
    for (double k = first; k <= last; k += 1.0)
    {
        line_points(&range, frame, k * step, false, points);
        take(cairo, view, frame, &range, points, k * step, false);
    }
}

static void take_line(cairo_t *cairo, const draw_view *view, const scene_frame *frame, window_range *range,
                      const double *points, double at, bool parallel)
{
    (void)frame, (void)range, (void)at, (void)parallel;
    path_simplifier path = simplifier_begin(canvas_sink(cairo), 0.05);
    view_trace(view, points, LINE_STEPS + 1, false, VIEW_FRONT, &path);
}

void grid_local_lines(cairo_t *cairo, const draw_view *view, const scene_frame *frame)
{
    visit_lines(cairo, view, frame, take_line);
    style_stroke(cairo, (line_style){COLOUR_GRATICULE, LINE_GRATICULE, 0.0, 0.0});
}

/// Whether a label at (x, y) leaves the others readable; then it is remembered.
static bool label_fits(window_range *range, double x, double y, double width)
{
    const double apart = 4.0;
    for (size_t i = 0; i < range->label_count; i++)
    {
        const double *other = range->labels[i];
        if (fabs(other[0] - x) < other[2] + 0.5 * width + apart && fabs(other[1] - y) < TEXT_TICK + 1.0)
            return false;
    }
    if (range->label_count == MAX_LABELS)
        return false;
    double *own = range->labels[range->label_count++];
    own[0] = x;
    own[1] = y;
    own[2] = 0.5 * width;
    return true;
}

/// Write a label beside a side of the window, unless it covers another.
static void side_label(cairo_t *cairo, const draw_view *view, window_range *range, const char *label, window_side side,
                       bool high, const double place[2])
{
    double x = view_x(view, place[0]), y = view_y(view, place[1]);
    double width = text_width(cairo, label);
    double beside = LABEL_GAP + (side.axis == 1 ? 0.5 * TEXT_TICK : 0.5 * width);
    if (!label_fits(range, side.axis == 1 ? x : x + (high ? beside : -beside),
                    side.axis == 1 ? y + (high ? -beside : beside) : y, width))
        return;
    if (side.axis == 1)
        text_draw(cairo, label, x, high ? y - LABEL_GAP : y + LABEL_GAP + text_digit_height(TEXT_TICK), 0.5);
    else
        text_draw_middle(cairo, label, high ? x + LABEL_GAP : x - LABEL_GAP, y, high ? 0.0 : 1.0);
}

/// Label a meridian at the lower side, or on polar maps at every side; a parallel at the left, or on polar maps where it
/// crosses the vertical above the pole.
static void take_label(cairo_t *cairo, const draw_view *view, const scene_frame *frame, window_range *range,
                       const double *points, double at, bool parallel)
{
    const map_choice *map = &frame->map;
    bool polar = range->north_pole || range->south_pole;
    char label[48];
    double place[2];
    double angle = parallel ? at : remainder(at, 360.0 * SECONDS_PER_DEGREE);
    grid_angle_label(angle, parallel ? range->lat_step : range->lon_step, parallel ? "N" : "E", parallel ? "S" : "W", label,
                     sizeof label);
    if (parallel && polar)
    {
        window_side vertical = {0, 0.0};
        if (cross_side(view, frame, points, vertical, place))
            text_draw(cairo, label, view_x(view, place[0]) + 2.0, view_y(view, place[1]) - 2.0, 0.0);
        return;
    }
    const window_side sides[4] = {{1, map->low[1]}, {0, map->low[0]}, {1, map->high[1]}, {0, map->high[0]}};
    // Lines that run along a side are not labelled there.
    for (int k = parallel ? 1 : 0; k < (polar ? 4 : parallel ? 2 : 1); k++)
        if (cross_side(view, frame, points, sides[k], place))
            side_label(cairo, view, range, label, sides[k], k >= 2, place);
}

/// The path of the window, which may be larger than the disk that the whole sphere becomes.
static void window_path(cairo_t *cairo, const draw_view *view, const scene_frame *frame)
{
    double x = view_x(view, frame->map.low[0]), y = view_y(view, frame->map.high[1]);
    cairo_rectangle(cairo, x, y, view_x(view, frame->map.high[0]) - x, view_y(view, frame->map.low[1]) - y);
}

void grid_local_clip(cairo_t *cairo, const draw_view *view, const scene_frame *frame)
{
    const double whole = 2.0;
    window_path(cairo, view, frame);
    cairo_clip(cairo);
    double u = fmax(fabs(frame->map.low[0]), fabs(frame->map.high[0]));
    double v = fmax(fabs(frame->map.low[1]), fabs(frame->map.high[1]));
    if (hypot(u, v) > whole)
    {
        cairo_arc(cairo, view->origin_x, view->origin_y, whole * view->scale, 0.0, ANGLE_TURN);
        cairo_clip(cairo);
    }
}

void grid_local_ground(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool sea)
{
    cairo_save(cairo);
    grid_local_clip(cairo, view, frame);
    style_use_colour(cairo, sea ? COLOUR_SEA : COLOUR_EMPTY);
    cairo_paint(cairo);
    cairo_restore(cairo);
}

insets grid_local_room(const scene_frame *frame, bool labels)
{
    const double digit_width = 0.6 * TEXT_TICK;
    draw_view view = {.kind = VIEW_LOCAL, .space = VIEW_SPHERE, .point_dim = 3};
    view_set_globe(&view, frame->map.longitude, frame->map.latitude);
    window_range range = range_of(&view, frame);
    char label[48];
    grid_angle_label(range.north, range.lat_step, "N", "S", label, sizeof label);
    bool polar = range.north_pole || range.south_pole;
    size_t letters = 0;
    for (const char *c = label; *c != '\0'; c++)
        letters += ((unsigned char)*c & 0xc0u) != 0x80u ? 1 : 0;
    double left = !labels ? 4.0 : LABEL_GAP + 3.0 + (polar ? 26.0 : digit_width * (double)letters);
    return (insets){.left = left,
                    .top = labels && polar ? 4.0 + TEXT_TICK : 4.0,
                    .right = labels && !polar ? 16.0 : left,
                    .bottom = 4.0 + GRID_SCALE_HEIGHT + (labels ? TEXT_TICK + LABEL_GAP : 0.0)};
}

void grid_local_frame(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool labels)
{
    double x = view_x(view, frame->map.low[0]);
    double y = view_y(view, frame->map.low[1]) + (labels ? TEXT_TICK + LABEL_GAP : 0.0) + 0.6 * GRID_SCALE_HEIGHT;
    double extent = frame->map.high[0] - frame->map.low[0];
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    if (labels)
        visit_lines(cairo, view, frame, take_label);
    window_path(cairo, view, frame);
    style_use_line(cairo, (line_style){COLOUR_FRAME, LINE_FRAME, 0.0, 0.0});
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_MITER);
    cairo_stroke(cairo);
    grid_scale_bar(cairo, x, y, extent * view->scale, extent * BAT_EARTH_RADIUS, "m");
}
