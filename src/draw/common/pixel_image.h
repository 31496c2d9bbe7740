#ifndef DRAW_COMMON_PIXEL_IMAGE_H
#define DRAW_COMMON_PIXEL_IMAGE_H

#include "batten/base.h"

#include <cairo.h>

/// @file
/// Images within drawings, whose pixels are computed.

/// A box in whole pixels of an image.
typedef struct pixel_box
{
    double x, y; ///< on paper
    double per_point;
    size_t columns, rows;
} pixel_box;

/// The image that fits a box (x, y, width, height); its pixels lie on the paper's, where that has any.
pixel_box pixel_box_align(cairo_t *cairo, double per_point, const double box[4]);

/// Fills pixels of four bytes, cairo's ARGB32 (premultiplied, in the machine's order), each row `stride` bytes after the one
/// before. They are transparent before.
typedef bat_status pixel_painter(const void *context, unsigned char *pixels, size_t stride, bat_error *error);

/// Have an image painted and put it on paper.
/// @return what the painter returns, or BAT_NO_MEMORY
bat_status pixel_image_draw(cairo_t *cairo, const pixel_box *place, pixel_painter *paint, const void *context,
                            bat_error *error);

#endif
