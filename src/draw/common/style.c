#include "draw/common/style.h"

#include "base/utf8.h"
#include "batten/curve_picture.h"

#include <stdint.h>
#include <string.h>

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

// Validation, measurement and drawing of texts by cairo's text functions

bool text_is_valid(const char *text)
{
    const unsigned char *rest = (const unsigned char *)text;
    size_t length = 0;
    for (; rest != NULL && *rest != '\0'; rest += length)
    {
        length = *rest < ' ' || *rest == 0x7f ? 0 : utf8_size(rest, SIZE_MAX);
        if (length == 0)
            return false;
    }
    return true;
}

bool text_given(const char *text)
{
    return text != NULL && text[0] != '\0';
}

void text_use(cairo_t *cairo, double size, bool bold)
{
    cairo_select_font_face(cairo, "sans", CAIRO_FONT_SLANT_NORMAL, bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, size);
}

double text_width(cairo_t *cairo, const char *text)
{
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, text, &extents);
    return extents.x_advance;
}

void text_draw(cairo_t *cairo, const char *text, double x, double y, double align)
{
    cairo_move_to(cairo, x - align * text_width(cairo, text), y);
    cairo_show_text(cairo, text);
    cairo_new_path(cairo);
}

void text_draw_middle(cairo_t *cairo, const char *text, double x, double y, double align)
{
    cairo_matrix_t font;
    cairo_get_font_matrix(cairo, &font);
    text_draw(cairo, text, x, y + 0.5 * text_digit_height(font.yy), align);
}

void text_cut(cairo_t *cairo, const char *text, double width, char *buffer, size_t capacity)
{
    static const char ellipsis[] = "\xe2\x80\xa6";
    size_t length = strlen(text);
    if (length < capacity && text_width(cairo, text) <= width)
    {
        memcpy(buffer, text, length + 1);
        return;
    }
    size_t room = capacity - sizeof ellipsis;
    length = length < room ? length : room;
    do
    {
        while (length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80)
            length--;
        memcpy(buffer, text, length);
        memcpy(buffer + length, ellipsis, sizeof ellipsis);
    } while (length > 0 && text_width(cairo, buffer) > width && length--);
}

void text_draw_fitted(cairo_t *cairo, const char *text, double size, bool bold, double x, double y, double width)
{
    char buffer[1024];
    text_use(cairo, size, bold);
    double natural = text_width(cairo, text);
    if (natural > width)
    {
        double smaller = size * width / natural;
        text_use(cairo, smaller > TEXT_SMALLEST ? smaller : TEXT_SMALLEST, bold);
    }
    text_cut(cairo, text, width * 1.001, buffer, sizeof buffer);
    text_draw(cairo, buffer, x, y, 0.5);
}
