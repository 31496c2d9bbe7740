#ifndef DRAW_COMMON_SHEET_H
#define DRAW_COMMON_SHEET_H

#include "batten/curve_picture.h"
#include "draw/common/canvas.h"
#include "draw/common/legend.h"

/// @file
/// The page that pictures and charts share: a title, a grid of boxes with captions, a legend.

/// What fills the boxes of a sheet.
typedef struct sheet_content
{
    size_t count;   ///< of boxes
    size_t columns; ///< of boxes in a row
    const bat_curve_picture_options *options;
    const legend_item *items;
    size_t item_count;
    double natural_width; ///< of the sheet, when the options leave it open
    const void *context;
    /// The height that suits box `index` at that width.
    double (*height)(const void *context, size_t index, double width);
    /// The text beneath box `index`; may be null.
    const char *(*caption)(const void *context, size_t index);
    /// Fill box `index`, at (x, y, width, height).
    bat_status (*draw)(const void *context, cairo_t *cairo, size_t index, const double box[4], bat_error *error);
    double footer_height; ///< of something more below the legend; 0 for none
    /// Draw it into (x, y, width, height).
    void (*draw_footer)(const void *context, cairo_t *cairo, const double box[4]);
} sheet_content;

/// The width of a sheet whose boxes have that width.
double sheet_width(double box_width, size_t columns);

/// Lay out, draw and put into a file.
bat_status sheet_write(const char *path, const sheet_content *content, bat_error *error);

#endif
