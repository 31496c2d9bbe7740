#pragma once

#include "base/text_buffer.h"
#include "batten/curve_picture.h"
#include "draw/common/legend.h"
#include "draw/curve/view.h"

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

// Images with computed pixels within drawings.

typedef struct pixel_box
{
    double x, y; ///< on the page
    double per_point;
    size_t columns, rows;
} pixel_box;

/// The pixels that cover a box (x, y, width, height), aligned with the page's pixels where it has any.
pixel_box pixel_box_align(cairo_t *cairo, double per_point, const double box[4]);

/// Computes pixels of four bytes, cairo's ARGB32, with rows `stride` bytes apart. They are transparent on entry.
typedef bat_status pixel_painter(const void *context, unsigned char *pixels, size_t stride, bat_error *error);

/// Paint an image and draw it on the page.
/// @return the painter's status, or BAT_NO_MEMORY
bat_status pixel_image_draw(cairo_t *cairo, const pixel_box *place, pixel_painter *paint, const void *context,
                            bat_error *error);

// The page of pictures and charts: a title, a grid of boxes with captions, and a legend.

typedef struct sheet_content
{
    size_t count;   ///< the number of boxes
    size_t columns; ///< boxes in a row
    const bat_curve_picture_options *options;
    const legend_item *items;
    size_t item_count;
    double natural_width; ///< the width of the page if the options leave it open
    const void *context;
    /// The preferred height of box `index` for a width.
    double (*height)(const void *context, size_t index, double width);
    /// The text below box `index`; may be null, as its result may be.
    const char *(*caption)(const void *context, size_t index);
    /// Draw box `index` at (x, y, width, height).
    bat_status (*draw)(const void *context, cairo_t *cairo, size_t index, const double box[4], bat_error *error);
    double footer_height; ///< the height of an additional part below the legend; 0 for none
    /// Draw that part at (x, y, width, height).
    void (*draw_footer)(const void *context, cairo_t *cairo, const double box[4]);
} sheet_content;

double sheet_width(double box_width, size_t columns);

/// Lay out the page, draw it and write the file.
bat_status sheet_write(const char *path, const sheet_content *content, bat_error *error);
