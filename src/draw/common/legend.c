#include "draw/common/legend.h"

#include "draw/common/ticks.h"
#include "linalg/vector.h"

#include <string.h>

/// @file
/// Interpolation between stops in Oklab (Ottosson, "A perceptual color space for image processing", 2020).

#define BAR_WIDTH 190.0
#define BAR_HEIGHT 7.0
#define BAR_STEPS 128

/// A colour in Oklab: lightness, chroma and hue in degrees.
typedef struct perceived
{
    double lightness, chroma, hue;
} perceived;

static draw_colour to_linear(perceived colour)
{
    double angle = colour.hue * ANGLE_DEGREE;
    double a = colour.chroma * cos(angle), b = colour.chroma * sin(angle);
    double l = colour.lightness + 0.3963377774 * a + 0.2158037573 * b;
    double m = colour.lightness - 0.1055613458 * a - 0.0638541728 * b;
    double s = colour.lightness - 0.0894841775 * a - 1.2914855480 * b;
    l = l * l * l;
    m = m * m * m;
    s = s * s * s;
    return (draw_colour){fmin(fmax(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, 0), 1),
                         fmin(fmax(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s, 0), 1),
                         fmin(fmax(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s, 0), 1)};
}

draw_colour colour_scale_at(double share)
{
    // The lightness decreases uniformly, the hue turns from yellow through red to violet, and the chroma stays within sRGB.
    static const perceived STOPS[] = {{0.95, 0.045, 100}, {0.83, 0.120, 78},  {0.71, 0.165, 45},
                                      {0.59, 0.180, 18},  {0.47, 0.165, -15}, {0.35, 0.130, -45}};
    const int last = sizeof STOPS / sizeof STOPS[0] - 1;
    double place = fmin(fmax(share, 0), 1) * last;
    int stop = place >= last ? last - 1 : (int)place;
    double t = place - stop;
    const perceived *a = &STOPS[stop], *b = &STOPS[stop + 1];
    return to_linear((perceived){a->lightness + t * (b->lightness - a->lightness), a->chroma + t * (b->chroma - a->chroma),
                                 a->hue + t * (b->hue - a->hue)});
}

draw_colour colour_scale_diverging(double share)
{
    double from_middle = fmin(fabs(2 * share - 1), 1);
    return to_linear((perceived){0.95 - 0.5 * from_middle, 0.17 * from_middle, share < 0.5 ? 255 : 30});
}

double colour_encode(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

double colour_decode(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

double colour_bar_height(void)
{
    return BAR_HEIGHT + 16.0;
}

static void draw_steps(cairo_t *cairo, colour_scale *scale, double x, double y)
{
    cairo_pattern_t *pattern = cairo_pattern_create_linear(x, 0, x + BAR_WIDTH, 0);
    for (int i = 0; i <= BAR_STEPS; i++)
    {
        draw_colour colour = scale((double)i / BAR_STEPS);
        cairo_pattern_add_color_stop_rgb(pattern, (double)i / BAR_STEPS, colour_encode(colour.red),
                                         colour_encode(colour.green), colour_encode(colour.blue));
    }
    cairo_rectangle(cairo, x, y, BAR_WIDTH, BAR_HEIGHT);
    cairo_set_source(cairo, pattern);
    cairo_fill_preserve(cairo);
    cairo_pattern_destroy(pattern);
    style_stroke(cairo, (line_style){.colour = COLOUR_FRAME, .width = LINE_FRAME});
}

void colour_bar_draw(cairo_t *cairo, colour_scale *scale, double low, double high, const char *label, const double box[4])
{
    text_use(cairo, TEXT_LEGEND, false);
    char scale_text[TICK_SCALE_SIZE];
    tick_list ticks = ticks_linear(low, high, 5);
    ticks_use_scale(&ticks, ticks_scale(low, high));
    tick_scale_text(ticks.scale, scale_text);
    double gap = 8.0,
           label_width = text_given(label) ? fmin(text_width(cairo, label), box[2] - BAR_WIDTH - 60.0) + gap : 0.0;
    double x = box[0] + 0.5 * (box[2] - BAR_WIDTH) + 0.5 * label_width, y = box[1];
    draw_steps(cairo, scale, x, y);
    if (text_given(label) && label_width > gap)
    {
        char cut[256];
        style_use_colour(cairo, COLOUR_FOREGROUND);
        text_cut(cairo, label, label_width - gap, cut, sizeof cut);
        text_draw_middle(cairo, cut, x - gap, y + 0.5 * BAR_HEIGHT, 1.0);
    }
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    text_draw_middle(cairo, scale_text, x + BAR_WIDTH + gap, y + 0.5 * BAR_HEIGHT, 0.0);
    for (size_t i = 0; i < ticks.count; i++)
    {
        double at = x + BAR_WIDTH * (ticks.values[i] - low) / (high - low);
        style_segment(cairo, at, y + BAR_HEIGHT, at, y + BAR_HEIGHT + 2.0);
        style_stroke(cairo, (line_style){.colour = COLOUR_FRAME, .width = LINE_FRAME});
        style_use_colour(cairo, COLOUR_MUTED);
        if (ticks.labelled[i])
            tick_draw(cairo, &ticks, i, at, y + BAR_HEIGHT + 7.5, 0.5);
    }
}

// Layout of a legend in one row or in columns of equal width.

#define SAMPLE 22.0
#define SAMPLE_GAP 6.0
#define ITEM_GAP 20.0
#define ROW 15.0

void legend_ring(cairo_t *cairo, double x, double y, double radius, draw_colour colour)
{
    cairo_arc(cairo, x, y, radius, 0.0, ANGLE_TURN);
    style_use_colour(cairo, COLOUR_BACKGROUND);
    cairo_fill_preserve(cairo);
    style_stroke(cairo, (line_style){colour, fmin(0.9, 0.6 * radius), 0.0, 0.0});
}

void legend_dot(cairo_t *cairo, double x, double y, double radius, draw_colour colour)
{
    cairo_arc(cairo, x, y, radius + 0.6, 0.0, ANGLE_TURN);
    style_use_colour(cairo, COLOUR_BACKGROUND);
    cairo_fill(cairo);
    cairo_arc(cairo, x, y, radius, 0.0, ANGLE_TURN);
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

void legend_add(legend_item *items, size_t *count, legend_item item)
{
    for (size_t i = 0; i < *count; i++)
        if (strcmp(items[i].label, item.label) == 0 && items[i].mark == item.mark &&
            style_same_line(&items[i].line, &item.line))
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
    double sum, widest;
    measure(cairo, items, count, width, &sum, &widest);
    size_t columns = columns_of(sum, widest, count, width), rows = (count + columns - 1) / columns;
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
        style_segment(cairo, x, y, x + SAMPLE, y);
        style_stroke(cairo, item->line);
    }
    if (item->mark == LEGEND_RING)
        legend_ring(cairo, x + 0.5 * SAMPLE, y, MARKER_RADIUS, item->line.colour);
    if (item->mark == LEGEND_DOT)
        legend_dot(cairo, x + 0.5 * SAMPLE, y, MARKER_RADIUS, item->line.colour);
}

void legend_draw(cairo_t *cairo, const legend_item *items, size_t count, double x, double y, double width)
{
    if (count == 0)
        return;
    double sum, widest;
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
        double middle = y + ROW * ((double)row + 0.5);
        char label[512];
        draw_sample(cairo, &items[i], left, middle);
        text_use(cairo, TEXT_LEGEND, false);
        style_use_colour(cairo, COLOUR_FOREGROUND);
        text_cut(cairo, items[i].label, 1.001 * (wide - SAMPLE - SAMPLE_GAP), label, sizeof label);
        text_draw_middle(cairo, label, left + SAMPLE + SAMPLE_GAP, middle, 0.0);
        left += wide + ITEM_GAP;
    }
}
