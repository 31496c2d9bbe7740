#include "draw/common/legend.h"

#include "draw/common/style.h"
#include "draw/common/ticks.h"

#include <math.h>

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
    double angle = colour.hue * 0.017453292519943295;
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

static void draw_steps(cairo_t *cairo, double x, double y)
{
    cairo_pattern_t *pattern = cairo_pattern_create_linear(x, 0, x + BAR_WIDTH, 0);
    for (int i = 0; i <= BAR_STEPS; i++)
    {
        draw_colour colour = colour_scale_at((double)i / BAR_STEPS);
        cairo_pattern_add_color_stop_rgb(pattern, (double)i / BAR_STEPS, colour_encode(colour.red),
                                         colour_encode(colour.green), colour_encode(colour.blue));
    }
    cairo_rectangle(cairo, x, y, BAR_WIDTH, BAR_HEIGHT);
    cairo_set_source(cairo, pattern);
    cairo_fill_preserve(cairo);
    cairo_pattern_destroy(pattern);
    style_stroke(cairo, (line_style){.colour = COLOUR_FRAME, .width = LINE_FRAME});
}

void colour_bar_draw(cairo_t *cairo, double low, double high, const char *label, const double box[4])
{
    text_use(cairo, TEXT_LEGEND, false);
    char scale_text[TICK_SCALE_SIZE];
    tick_list ticks = ticks_linear(low, high, 5);
    ticks_use_scale(&ticks, ticks_scale(low, high));
    tick_scale_text(ticks.scale, scale_text);
    double gap = 8.0,
           label_width = text_given(label) ? fmin(text_width(cairo, label), box[2] - BAR_WIDTH - 60.0) + gap : 0.0;
    double x = box[0] + 0.5 * (box[2] - BAR_WIDTH) + 0.5 * label_width, y = box[1];
    draw_steps(cairo, x, y);
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
        cairo_move_to(cairo, at, y + BAR_HEIGHT);
        cairo_line_to(cairo, at, y + BAR_HEIGHT + 2.0);
        style_stroke(cairo, (line_style){.colour = COLOUR_FRAME, .width = LINE_FRAME});
        style_use_colour(cairo, COLOUR_MUTED);
        if (ticks.labelled[i])
            tick_draw(cairo, &ticks, i, at, y + BAR_HEIGHT + 7.5, 0.5);
    }
}
