#pragma once

#include <cairo.h>
#include <stdbool.h>
#include <stddef.h>

/// @file
/// The style of all pictures: colours, line widths and text sizes. Lengths are in points.

typedef struct draw_colour
{
    double red, green, blue;
} draw_colour;

/// The style of a line; `dash` is 0 for a solid line.
typedef struct line_style
{
    draw_colour colour;
    double width;
    double dash; ///< the length of a dash
    double gap;  ///< the length of a gap
} line_style;

static inline bool style_same_line(const line_style *a, const line_style *b)
{
    const draw_colour *p = &a->colour, *q = &b->colour;
    return p->red == q->red && p->green == q->green && p->blue == q->blue && a->width == b->width && a->dash == b->dash &&
           a->gap == b->gap;
}

static const draw_colour COLOUR_BACKGROUND = {1.0, 1.0, 1.0};
static const draw_colour COLOUR_FOREGROUND = {0.16, 0.18, 0.21};
static const draw_colour COLOUR_MUTED = {0.38, 0.41, 0.45};
static const draw_colour COLOUR_FRAME = {0.55, 0.58, 0.62};
static const draw_colour COLOUR_CONTROL = {0.40, 0.48, 0.58};
static const draw_colour COLOUR_TRUTH = {0.68, 0.69, 0.71};
static const draw_colour COLOUR_GRID = {0.865, 0.88, 0.90};
static const draw_colour COLOUR_STRONG_GRID = {0.68, 0.715, 0.755};

/// Of maps: the ground beneath polygons, and without, the graticule, the borders of results and of given polygons.
static const draw_colour COLOUR_SEA = {0.925, 0.952, 0.972};
static const draw_colour COLOUR_EMPTY = {0.982, 0.986, 0.991};
static const draw_colour COLOUR_GRATICULE = {0.80, 0.835, 0.87};
static const draw_colour COLOUR_BORDER = {0.30, 0.33, 0.37};
static const draw_colour COLOUR_GIVEN = {0.62, 0.64, 0.67};

#define TEXT_TITLE 11.5
#define TEXT_CAPTION 9.5
#define TEXT_LEGEND 9.0
#define TEXT_TICK 7.5

#define LINE_CURVE 1.4
#define LINE_TRUTH 2.3
#define LINE_CONTROL 0.8
#define LINE_COMB 0.45
#define LINE_ENVELOPE 0.7
#define LINE_GRID 0.5
#define LINE_FRAME 0.7
#define LINE_GRATICULE 0.4
#define LINE_BORDER 0.7
#define LINE_GIVEN 0.45
#define LINE_ROUTE 1.2
#define MARKER_RADIUS 2.1

/// Colour `index` of the palette, from 1; it repeats after BAT_CURVE_PICTURE_COLOURS.
draw_colour style_palette(int index);
/// The line of the curve with colour `index`: solid for the first colours, then with long dashes, then with short dashes.
line_style style_curve(int index);
/// The light fill `index` of maps, from 0; there are MAP_COLOURS.
draw_colour style_fill(int index);
/// The mixture share a + (1 - share) b.
draw_colour style_mix(draw_colour a, draw_colour b, double share);

void style_use_colour(cairo_t *cairo, draw_colour colour);
/// Set the colour, width and dashes of the next stroke.
void style_use_line(cairo_t *cairo, line_style line);
void style_stroke(cairo_t *cairo, line_style line);

/// Append a segment to cairo's current path.
static inline void style_segment(cairo_t *cairo, double from_x, double from_y, double to_x, double to_y)
{
    cairo_move_to(cairo, from_x, from_y);
    cairo_line_to(cairo, to_x, to_y);
}

// Short texts in the system's sans-serif font. All texts are UTF-8 that passed text_is_valid().

/// The smallest size that text_draw_fitted() uses.
#define TEXT_SMALLEST 6.0

/// Whether a text is null or well-formed UTF-8 without control characters.
bool text_is_valid(const char *text);
bool text_given(const char *text);

void text_use(cairo_t *cairo, double size, bool bold);
double text_width(cairo_t *cairo, const char *text);
/// Draw a text with the point (x, y) on its baseline, at the fraction `align` of its width: 0 left, 1/2 centre, 1 right.
void text_draw(cairo_t *cairo, const char *text, double x, double y, double align);
/// Draw a text with y in the middle of the digits' height.
void text_draw_middle(cairo_t *cairo, const char *text, double x, double y, double align);
/// Draw a text centred at (x, y) in the current colour. A text wider than `width` is reduced, or truncated with an ellipsis.
void text_draw_fitted(cairo_t *cairo, const char *text, double size, bool bold, double x, double y, double width);
/// Copy `text` into `buffer` of `capacity` bytes, truncated with an ellipsis to `width` in the current font.
void text_cut(cairo_t *cairo, const char *text, double width, char *buffer, size_t capacity);

static inline double text_digit_height(double size)
{
    return 0.72 * size;
}
