#ifndef DRAW_SURFACE_SURFACE_DOTS_H
#define DRAW_SURFACE_SURFACE_DOTS_H

#include "batten/base.h"
#include "draw/common/style.h"

/// @file
/// Many dots in an image.

/// Pixels of four bytes, cairo's ARGB32, that dots are drawn into.
typedef struct dot_image
{
    unsigned char *pixels;
    size_t stride, columns, rows;
} dot_image;

/// A dot; those of greater `rank` are drawn later.
typedef struct image_dot
{
    double x, y, rank;
    size_t index; ///< of the point; among equal ranks the lower is drawn first
} image_dot;

/// The radius in pixels that suits `count` dots over an area of so many square pixels, `per_point` of them to a point.
double dot_radius(double area, size_t count, double per_point);
void dots_sort(image_dot *dots, size_t count);
/// Draw a disk with a soft edge.
void dot_draw(const dot_image *image, double x, double y, double radius, draw_colour colour);

#endif
