#ifndef BATTEN_RESEARCH_CHART_PICTURE_H
#define BATTEN_RESEARCH_CHART_PICTURE_H

#include "batten/curve_picture.h"

BAT_C_BEGIN

/// @file
/// Charts of numbers as SVG, PNG or PDF: lines, dots and bars over linear or logarithmic axes.

/// How the numbers of a series are drawn.
typedef enum bat_chart_mark
{
    BAT_CHART_MARK_AUTO,        ///< the default: BAT_CHART_MARK_LINE
    BAT_CHART_MARK_LINE,        ///< joined in their order
    BAT_CHART_MARK_POINTS,      ///< dots
    BAT_CHART_MARK_LINE_POINTS, ///< both
    BAT_CHART_MARK_BARS ///< bars from 0 to y that touch half-way between neighbouring x; x increases; no logarithmic y
} bat_chart_mark;

/// One series of a chart.
typedef struct bat_chart_series
{
    const double *x; ///< `count` finite numbers, positive on a logarithmic axis
    const double *y; ///< the same
    size_t count;    ///< at least 1; at least 2 for bars
    bat_chart_mark mark;
    const char *label; ///< UTF-8, for the legend; null or "" for none
    int colour;        ///< 1, 2, …: that colour of the fixed order; 0: the place in the chart
} bat_chart_series;

/// A chart: axes with ticks at round numbers, a light grid, a legend below. All zero but `series` is a sensible chart, but
/// for the ranges: begin with bat_chart_defaults().
typedef struct bat_chart
{
    const bat_chart_series *series;
    size_t series_count; ///< at least 1
    const char *title;   ///< UTF-8; these three may be null
    const char *x_label;
    const char *y_label;
    bool log_x;
    bool log_y;
    double x_low, x_high; ///< the axis' range; NaN: from the numbers; default NaN. What lies outside is cut off.
    double y_low, y_high;
} bat_chart;

/// A chart without series.
BAT_API bat_chart bat_chart_defaults(void);

/// Draw charts into a file, in the way of bat_curve_picture_write(). Of the options only `width`, `height`,
/// `pixels_per_point`, `columns`, `legend`, `title` and `grid` matter.
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_INVALID_POINT with the index of the number; BAT_TOO_LARGE; BAT_NO_MEMORY;
///         BAT_FILE_ACCESS
BAT_API bat_status bat_chart_write(const char *path, const bat_chart *charts, size_t count,
                                   const bat_curve_picture_options *options, bat_error *error);

BAT_C_END

#endif
