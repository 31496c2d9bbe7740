#include "draw/common/style.h"

#include "base/utf8.h"

#include <stdint.h>
#include <string.h>

/// @file
/// Validation, measurement and drawing of texts by cairo's text functions.

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
