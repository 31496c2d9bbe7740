#include "draw/common/sheet.h"

#include "base/error.h"

#include <math.h>

/// @file
/// Pixel images aligned with the pixels of the page.

pixel_box pixel_box_align(cairo_t *cairo, double per_point, const double box[4])
{
    double x = box[0], y = box[1];
    cairo_user_to_device(cairo, &x, &y);
    x = ceil(x);
    y = ceil(y);
    cairo_device_to_user(cairo, &x, &y);
    return (pixel_box){.x = x,
                       .y = y,
                       .per_point = per_point,
                       .columns = (size_t)fmax(floor((box[0] + box[2] - x) * per_point), 1),
                       .rows = (size_t)fmax(floor((box[1] + box[3] - y) * per_point), 1)};
}

bat_status pixel_image_draw(cairo_t *cairo, const pixel_box *place, pixel_painter *paint, const void *context,
                            bat_error *error)
{
    cairo_surface_t *image = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, (int)place->columns, (int)place->rows);
    if (cairo_surface_status(image) != CAIRO_STATUS_SUCCESS)
    {
        cairo_surface_destroy(image);
        return error_memory(error, 4 * place->columns * place->rows);
    }
    cairo_surface_flush(image);
    bat_status status =
        paint(context, cairo_image_surface_get_data(image), (size_t)cairo_image_surface_get_stride(image), error);
    cairo_surface_mark_dirty(image);
    if (status == BAT_OK)
    {
        cairo_save(cairo);
        cairo_translate(cairo, place->x, place->y);
        cairo_scale(cairo, 1 / place->per_point, 1 / place->per_point);
        cairo_set_source_surface(cairo, image, 0, 0);
        cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_NEAREST);
        cairo_paint(cairo);
        cairo_restore(cairo);
    }
    cairo_surface_destroy(image);
    return status;
}
