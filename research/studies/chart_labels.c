#include "research/studies/chart_labels.h"

#include "base/error.h"
#include "base/memory.h"
#include "draw/common/style.h"

#include <math.h>
#include <stdlib.h>

/// The distance between a point and its label.
#define CLEARANCE 4.5

typedef struct rectangle
{
    double x, y, width, height;
} rectangle;

static double overlap(const rectangle *a, const rectangle *b)
{
    double width = fmin(a->x + a->width, b->x + b->width) - fmax(a->x, b->x);
    double height = fmin(a->y + a->height, b->y + b->height) - fmax(a->y, b->y);
    return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

/// Candidate positions of a label: eight directions at three distances.
#define DIRECTIONS 8
#define RINGS 3

/// The position of a label for a candidate, in order of preference.
static rectangle candidate(double x, double y, double width, double height, int choice)
{
    static const double across[DIRECTIONS] = {0.0, -1.0, -0.5, -0.5, 0.0, -1.0, 0.0, -1.0};
    static const double down[DIRECTIONS] = {-0.5, -0.5, -1.0, 0.0, -1.0, -1.0, 0.0, 0.0};
    static const double shift_x[DIRECTIONS] = {1.0, -1.0, 0.0, 0.0, 0.6, -0.6, 0.6, -0.6};
    static const double shift_y[DIRECTIONS] = {0.0, 0.0, -1.0, 1.0, -0.6, -0.6, 0.6, 0.6};
    static const double distances[RINGS] = {CLEARANCE, 3.0 * CLEARANCE, 6.0 * CLEARANCE};
    int k = choice % DIRECTIONS;
    double distance = distances[choice / DIRECTIONS];
    return (rectangle){x + across[k] * width + distance * shift_x[k], y + down[k] * height + distance * shift_y[k], width,
                       height};
}

typedef struct point_label
{
    const char *text;
    double x, y;
} point_label;

/// The areas that labels should not cover: dots and earlier labels.
typedef struct obstacles
{
    rectangle plot;
    rectangle *taken; ///< the dots come first
    size_t dots;
    size_t count;
} obstacles;

static void leader_end(const rectangle *label, double x, double y, double *to_x, double *to_y)
{
    *to_x = fmin(fmax(x, label->x - 1.5), label->x + label->width + 1.5);
    *to_y = fmin(fmax(y, label->y), label->y + label->height);
}

/// Draw a thin line from a dot to a label that is not beside it.
static void draw_leader(cairo_t *cairo, double x, double y, const rectangle *label)
{
    double to_x;
    double to_y;
    leader_end(label, x, y, &to_x, &to_y);
    double length = hypot(to_x - x, to_y - y);
    double share = length > 0.0 ? fmin(1.0, 3.2 / length) : 1.0;
    cairo_move_to(cairo, x + share * (to_x - x), y + share * (to_y - y));
    cairo_line_to(cairo, to_x, to_y);
    style_stroke(cairo, (line_style){COLOUR_FRAME, LINE_GRID, 0.0, 0.0});
}

/// Whether the line from (x, y) to its label crosses another dot.
static bool leader_hits(const obstacles *around, double x, double y, const rectangle *label)
{
    double to_x;
    double to_y;
    leader_end(label, x, y, &to_x, &to_y);
    double dx = to_x - x;
    double dy = to_y - y;
    double square = fmax(dx * dx + dy * dy, 1e-12);
    for (size_t i = 0; i < around->dots; i++)
    {
        double from_x = around->taken[i].x + 0.5 * around->taken[i].width - x;
        double from_y = around->taken[i].y + 0.5 * around->taken[i].height - y;
        double share = fmin(fmax((from_x * dx + from_y * dy) / square, 0.0), 1.0);
        bool other = hypot(from_x, from_y) > 0.5;
        if (other && hypot(from_x - share * dx, from_y - share * dy) < 2.5)
            return true;
    }
    return false;
}

/// The area that a label covers, in square points.
static double cost(const obstacles *around, const point_label *point, const rectangle *label)
{
    const double wrong_dot = 40.0;
    double hidden = 0.0;
    for (size_t i = 0; i < around->count; i++)
        hidden += overlap(&around->taken[i], label);
    double outside = label->width * label->height - overlap(&around->plot, label);
    return hidden + 3.0 * outside + (leader_hits(around, point->x, point->y, label) ? wrong_dot : 0.0);
}

static void place_label(cairo_t *cairo, obstacles *around, const point_label *point)
{
    double width = text_width(cairo, point->text);
    rectangle best = candidate(point->x, point->y, width, TEXT_TICK, 0);
    double min_cost = cost(around, point, &best);
    int chosen = 0;
    for (int choice = 1; choice < RINGS * DIRECTIONS && min_cost > 1e-9; choice++)
    {
        rectangle label = candidate(point->x, point->y, width, TEXT_TICK, choice);
        double price = cost(around, point, &label);
        if (price < min_cost)
        {
            min_cost = price;
            best = label;
            chosen = choice;
        }
    }
    if (chosen >= DIRECTIONS)
        draw_leader(cairo, point->x, point->y, &best);
    style_use_colour(cairo, COLOUR_FOREGROUND);
    text_draw_middle(cairo, point->text, best.x, best.y + 0.5 * best.height, 0.0);
    around->taken[around->count++] = best;
}

/// Collect the visible points of the labelled series. Points without a text are included, because labels must not cover
/// them.
static size_t collect(const plot_axes *axes, const bat_chart_series *series, const char *const *texts, point_label *points)
{
    const plot_axis *x = &axes->x, *y = &axes->y;
    size_t count = 0;
    for (size_t i = 0; i < series->count; i++)
    {
        double place_x = plot_place(x, plot_number(x, series->x[i]));
        double place_y = plot_place(y, plot_number(y, series->y[i]));
        if (place_x >= x->start && place_x <= x->end && place_y >= y->end && place_y <= y->start)
            points[count++] = (point_label){texts[i], place_x, place_y};
    }
    return count;
}

/// Order from top to bottom, then from left to right.
static int compare(const void *a, const void *b)
{
    const point_label *p = a;
    const point_label *q = b;
    return p->y != q->y ? (p->y > q->y) - (p->y < q->y) : (p->x > q->x) - (p->x < q->x);
}

bat_status chart_labels_draw(cairo_t *cairo, const plot_axes *axes, const bat_chart_series *series, const char *const *texts,
                             bat_error *error)
{
    const plot_axis *x = &axes->x, *y = &axes->y;
    point_label *points = memory_array(series->count, sizeof *points);
    rectangle *taken = memory_array(2 * series->count, sizeof *taken);
    if (points == NULL || taken == NULL)
    {
        free(points);
        free(taken);
        return error_memory(error, 2 * series->count * sizeof *taken);
    }
    obstacles around = {.plot = {x->start, y->end, x->end - x->start, y->start - y->end}, .taken = taken};
    around.dots = around.count = collect(axes, series, texts, points);
    qsort(points, around.dots, sizeof *points, compare);
    for (size_t i = 0; i < around.dots; i++)
        taken[i] = (rectangle){points[i].x - 3.0, points[i].y - 3.0, 6.0, 6.0};
    text_use(cairo, TEXT_TICK, false);
    for (size_t i = 0; i < around.dots; i++)
        if (text_given(points[i].text))
            place_label(cairo, &around, &points[i]);
    free(points);
    free(taken);
    return BAT_OK;
}
