#include "draw/common/legend.h"

#include "draw/common/style.h"

#include <math.h>
#include <string.h>

/// @file
/// Layout of a legend in one row or in columns of equal width.

#define SAMPLE 22.0
#define SAMPLE_GAP 6.0
#define ITEM_GAP 20.0
#define ROW 15.0

static const double TURN = 6.28318530717958647693;

void legend_ring(cairo_t *cairo, double x, double y, double radius, draw_colour colour)
{
    cairo_arc(cairo, x, y, radius, 0.0, TURN);
    style_use_colour(cairo, COLOUR_BACKGROUND);
    cairo_fill_preserve(cairo);
    style_stroke(cairo, (line_style){colour, fmin(0.9, 0.6 * radius), 0.0, 0.0});
}

void legend_dot(cairo_t *cairo, double x, double y, double radius, draw_colour colour)
{
    cairo_arc(cairo, x, y, radius + 0.6, 0.0, TURN);
    style_use_colour(cairo, COLOUR_BACKGROUND);
    cairo_fill(cairo);
    cairo_arc(cairo, x, y, radius, 0.0, TURN);
    style_use_colour(cairo, colour);
    cairo_fill(cairo);
}

void legend_fill_bars(cairo_t *cairo, draw_colour colour)
{
    cairo_set_source_rgba(cairo, colour.red, colour.green, colour.blue, 0.45);
    cairo_fill_preserve(cairo);
    style_use_line(cairo, (line_style){style_mix(colour, COLOUR_BACKGROUND, 0.9), LINE_GRID, 0.0, 0.0});
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_MITER);
    cairo_stroke(cairo);
}

static bool same_colour(draw_colour a, draw_colour b)
{
    return a.red == b.red && a.green == b.green && a.blue == b.blue;
}

static bool same_look(const legend_item *a, const legend_item *b)
{
    bool same_line = a->line.width == b->line.width && a->line.dash == b->line.dash && a->line.gap == b->line.gap;
    return strcmp(a->label, b->label) == 0 && a->mark == b->mark && same_line && same_colour(a->line.colour, b->line.colour);
}

void legend_add(legend_item *items, size_t *count, legend_item item)
{
    for (size_t i = 0; i < *count; i++)
        if (same_look(&items[i], &item))
            return;
    items[(*count)++] = item;
}

static double item_width(cairo_t *cairo, const legend_item *item, double width)
{
    return fmin(SAMPLE + SAMPLE_GAP + text_width(cairo, item->label), width);
}

/// The sum and the maximum of the items' widths.
static void measure(cairo_t *cairo, const legend_item *items, size_t count, double width, double *sum, double *widest)
{
    text_use(cairo, TEXT_LEGEND, false);
    *sum = -ITEM_GAP;
    *widest = 0.0;
    for (size_t i = 0; i < count; i++)
    {
        double wide = item_width(cairo, &items[i], width);
        *sum += wide + ITEM_GAP;
        *widest = fmax(*widest, wide);
    }
}

static size_t columns_of(double sum, double widest, size_t count, double width)
{
    size_t fitting = (size_t)((width + ITEM_GAP) / (widest + ITEM_GAP));
    size_t columns = sum <= width ? count : fitting > 1 ? fitting : 1;
    size_t rows = (count + columns - 1) / columns;
    return (count + rows - 1) / rows;
}

double legend_height(cairo_t *cairo, const legend_item *items, size_t count, double width)
{
    if (count == 0)
        return 0.0;
    double sum;
    double widest;
    measure(cairo, items, count, width, &sum, &widest);
    size_t columns = columns_of(sum, widest, count, width);
    size_t rows = (count + columns - 1) / columns;
    return ROW * (double)rows;
}

static void draw_sample(cairo_t *cairo, const legend_item *item, double x, double y)
{
    if (item->mark == LEGEND_BAR)
    {
        cairo_rectangle(cairo, x + 4.0, y - 4.0, SAMPLE - 8.0, 8.0);
        legend_fill_bars(cairo, item->line.colour);
        return;
    }
    if (item->line.width > 0.0)
    {
        cairo_move_to(cairo, x, y);
        cairo_line_to(cairo, x + SAMPLE, y);
        style_stroke(cairo, item->line);
    }
    if (item->mark == LEGEND_RING)
        legend_ring(cairo, x + 0.5 * SAMPLE, y, MARKER_RADIUS, item->line.colour);
    if (item->mark == LEGEND_DOT)
        legend_dot(cairo, x + 0.5 * SAMPLE, y, MARKER_RADIUS, item->line.colour);
}

static void draw_item(cairo_t *cairo, const legend_item *item, double x, double y, double width)
{
    char label[512];
    draw_sample(cairo, item, x, y);
    text_use(cairo, TEXT_LEGEND, false);
    style_use_colour(cairo, COLOUR_FOREGROUND);
    text_cut(cairo, item->label, 1.001 * (width - SAMPLE - SAMPLE_GAP), label, sizeof label);
    text_draw_middle(cairo, label, x + SAMPLE + SAMPLE_GAP, y, 0.0);
}

void legend_draw(cairo_t *cairo, const legend_item *items, size_t count, double x, double y, double width)
{
    if (count == 0)
        return;
    double sum;
    double widest;
    measure(cairo, items, count, width, &sum, &widest);
    size_t columns = columns_of(sum, widest, count, width);
    bool one_row = columns == count;
    double total = one_row ? sum : (double)columns * (widest + ITEM_GAP) - ITEM_GAP;
    double left = x + 0.5 * (width - total);
    for (size_t i = 0; i < count; i++)
    {
        size_t row = i / columns, column = i % columns;
        double wide = one_row ? item_width(cairo, &items[i], width) : widest;
        left = column == 0 ? x + 0.5 * (width - total) : left;
        draw_item(cairo, &items[i], left, y + ROW * ((double)row + 0.5), wide);
        left += wide + ITEM_GAP;
    }
}
