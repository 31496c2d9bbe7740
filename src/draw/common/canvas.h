#ifndef DRAW_COMMON_CANVAS_H
#define DRAW_COMMON_CANVAS_H

#include "base/text_buffer.h"
#include "draw/curve/simplify.h"

#include <cairo.h>

/// @file
/// A page in memory that is saved as an SVG, PNG or PDF file.

typedef enum canvas_format
{
    CANVAS_SVG,
    CANVAS_PNG,
    CANVAS_PDF
} canvas_format;

/// The format for a path, by its ending.
/// @return BAT_OK or BAT_INVALID_ARGUMENT
bat_status canvas_format_of(const char *path, canvas_format *format, bat_error *error);

typedef struct draw_canvas
{
    cairo_t *cairo; ///< the unit is a point, with the origin at the top left
    cairo_surface_t *surface;
    canvas_format format;
    text_buffer bytes;       ///< of the file
    double pixels_per_point; ///< 1 for SVG and PDF
} draw_canvas;

/// Open a white page. The canvas must not move in memory until canvas_close().
bat_status canvas_open(draw_canvas *canvas, canvas_format format, double width, double height, double pixels_per_point,
                       bat_error *error);
/// Finish the drawing and write the file, completely or not at all.
bat_status canvas_save(draw_canvas *canvas, const char *path, bat_error *error);
/// Release everything; does nothing to a canvas that is all zero.
void canvas_close(draw_canvas *canvas);

/// A sink that appends to cairo's current path.
path_sink canvas_sink(cairo_t *cairo);

#endif
