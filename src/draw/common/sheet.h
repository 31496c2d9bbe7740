#ifndef DRAW_COMMON_SHEET_H
#define DRAW_COMMON_SHEET_H

#include "batten/curve_picture.h"
#include "draw/common/canvas.h"
#include "draw/common/legend.h"

/// @file
/// The page of pictures and charts: a title, a grid of boxes with captions, and a legend.

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

#endif
