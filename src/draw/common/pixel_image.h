#ifndef DRAW_COMMON_PIXEL_IMAGE_H
#define DRAW_COMMON_PIXEL_IMAGE_H

#include "batten/base.h"

#include <cairo.h>

/// @file
/// Images with computed pixels within drawings.

typedef struct pixel_box
{
    double x, y; ///< on the page
    double per_point;
    size_t columns, rows;
} pixel_box;

/// The pixels that cover a box (x, y, width, height), aligned with the page's pixels where it has any.
pixel_box pixel_box_align(cairo_t *cairo, double per_point, const double box[4]);

/// Computes pixels of four bytes, cairo's ARGB32 (premultiplied, in native byte order), with rows `stride` bytes apart. They
/// are transparent on entry.
typedef bat_status pixel_painter(const void *context, unsigned char *pixels, size_t stride, bat_error *error);

/// Paint an image and draw it on the page.
/// @return the painter's status, or BAT_NO_MEMORY
bat_status pixel_image_draw(cairo_t *cairo, const pixel_box *place, pixel_painter *paint, const void *context,
                            bat_error *error);

#endif
