#ifndef TESTS_SUPPORT_PIXEL_HELPERS_H
#define TESTS_SUPPORT_PIXEL_HELPERS_H

// Access to the pixels of a picture.

#include "check.h"

#include <cairo.h>

/// A picture in memory.
typedef struct pixels
{
    cairo_surface_t *surface;
    const unsigned char *data;
    int width, height, stride;
} pixels;

static inline pixels pixels_of(cairo_surface_t *surface)
{
    assert_int_equal(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
    cairo_surface_flush(surface);
    return (pixels){surface, cairo_image_surface_get_data(surface), cairo_image_surface_get_width(surface),
                    cairo_image_surface_get_height(surface), cairo_image_surface_get_stride(surface)};
}

static inline pixels open_png(const char *path)
{
    return pixels_of(cairo_image_surface_create_from_png(path));
}

static inline uint32_t pixel_at(const pixels *picture, int x, int y)
{
    uint32_t pixel;
    memcpy(&pixel, picture->data + y * picture->stride + 4 * x, sizeof pixel);
    return pixel & 0xffffffu;
}

static inline double lightness(uint32_t pixel)
{
    return ((double)(pixel >> 16 & 255) + (double)(pixel >> 8 & 255) + (double)(pixel & 255)) / (3 * 255.0);
}

/// The bounding box of non-white pixels in the columns from `from` to `to`.
typedef struct drawn_area
{
    int left, right, top, bottom;
    size_t count;
} drawn_area;

static inline drawn_area find_inked_area(const pixels *picture, int from, int to)
{
    drawn_area found = {picture->width, -1, picture->height, -1, 0};
    for (int y = 0; y < picture->height; y++)
        for (int x = from; x < to; x++)
        {
            if (pixel_at(picture, x, y) == 0xffffffu)
                continue;
            found.count++;
            found.left = x < found.left ? x : found.left;
            found.right = x > found.right ? x : found.right;
            found.top = y < found.top ? y : found.top;
            found.bottom = y > found.bottom ? y : found.bottom;
        }
    return found;
}

#endif
