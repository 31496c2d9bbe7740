#include "draw/common/style.h"

#include "batten/curve_picture.h"

/// @file
/// The palette and the styles of lines.

/// The palette of Okabe and Ito, "Color universal design" (2008), which readers with any colour vision can distinguish. The
/// darkest colours come first; yellow is omitted because it is invisible on white.
static const draw_colour palette[BAT_CURVE_PICTURE_COLOURS] = {
    {0.000, 0.447, 0.698}, // blue
    {0.835, 0.369, 0.000}, // vermilion
    {0.000, 0.620, 0.451}, // bluish green
    {0.800, 0.475, 0.655}, // reddish purple
    {0.902, 0.624, 0.000}, // orange
    {0.337, 0.706, 0.914}, // sky blue
    {0.250, 0.250, 0.250}, // black, softened
};

draw_colour style_palette(int index)
{
    return palette[(unsigned)(index - 1) % BAT_CURVE_PICTURE_COLOURS];
}

draw_colour style_fill(int index)
{
    static const draw_colour fills[] = {
        {0.965, 0.937, 0.847}, // sand
        {0.882, 0.929, 0.847}, // green
        {0.969, 0.886, 0.839}, // peach
        {0.902, 0.882, 0.945}, // lilac
        {0.996, 0.965, 0.749}, // yellow
        {0.953, 0.867, 0.906}, // rose
    };
    return fills[(unsigned)index % (sizeof fills / sizeof fills[0])];
}

line_style style_curve(int index)
{
    static const double dashes[][2] = {{0.0, 0.0}, {6.0, 2.5}, {2.0, 2.0}};
    const double *dash = dashes[(unsigned)(index - 1) / BAT_CURVE_PICTURE_COLOURS % 3];
    return (line_style){style_palette(index), LINE_CURVE, dash[0], dash[1]};
}

draw_colour style_mix(draw_colour a, draw_colour b, double share)
{
    double rest = 1.0 - share;
    return (draw_colour){share * a.red + rest * b.red, share * a.green + rest * b.green, share * a.blue + rest * b.blue};
}

void style_use_colour(cairo_t *cairo, draw_colour colour)
{
    cairo_set_source_rgb(cairo, colour.red, colour.green, colour.blue);
}

void style_use_line(cairo_t *cairo, line_style line)
{
    style_use_colour(cairo, line.colour);
    cairo_set_line_width(cairo, line.width);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(cairo, line.dash > 0.0 ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
    double dashes[2] = {line.dash, line.gap};
    cairo_set_dash(cairo, dashes, line.dash > 0.0 ? 2 : 0, 0.0);
}

void style_stroke(cairo_t *cairo, line_style line)
{
    style_use_line(cairo, line);
    cairo_stroke(cairo);
}
