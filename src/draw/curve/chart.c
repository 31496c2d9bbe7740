#include "base/error.h"
#include "base/memory.h"
#include "draw/common/sheet.h"
#include "draw/common/text.h"
#include "draw/curve/plot.h"
#include "draw/curve/scene.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// Pages of charts.

/// The aspect ratio of a chart, height over width.
#define ASPECT 0.68
/// The width that a chart needs for its numbers.
#define MIN_WIDTH 180.0

bat_chart bat_chart_defaults(void)
{
    return (bat_chart){.x_low = NAN, .x_high = NAN, .y_low = NAN, .y_high = NAN};
}

typedef struct chart_set
{
    const bat_chart *charts;
    const bat_curve_picture_options *options;
    plot_axis *axes; ///< x and y for each chart
} chart_set;

static double content_height(const void *context, size_t index, double width)
{
    (void)context;
    (void)index;
    return ASPECT * width;
}

static const char *content_caption(const void *context, size_t index)
{
    const chart_set *set = context;
    return set->charts[index].title;
}

static bat_status content_draw(const void *context, cairo_t *cairo, size_t index, const double box[4], bat_error *error)
{
    const chart_set *set = context;
    return plot_draw(cairo, &set->charts[index], set->options, set->axes[2 * index], set->axes[2 * index + 1], box, error);
}

/// Collect the labelled series of all charts without repetitions. Release the items with free().
static bat_status collect_legend(const chart_set *set, size_t charts, legend_item **items, size_t *count, bat_error *error)
{
    size_t max_count = 0;
    for (size_t i = 0; i < charts; i++)
    {
        max_count += set->charts[i].series_count;
    }
    *count = 0;
    *items = memory_array(max_count, sizeof **items);
    if (*items == NULL)
    {
        return error_memory(error, max_count * sizeof **items);
    }
    for (size_t i = 0; i < charts && set->options->legend; i++)
    {
        for (size_t k = 0; k < set->charts[i].series_count; k++)
        {
            if (text_given(set->charts[i].series[k].label))
            {
                legend_add(*items, count, plot_legend_item(&set->charts[i], k));
            }
        }
    }
    return BAT_OK;
}

static double natural_width(size_t columns)
{
    return columns == 1 ? 400.0 : columns == 2 ? 660.0 : 900.0;
}

static bat_status write_set(const char *path, chart_set *set, size_t count, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        bat_status status = plot_measure(&set->charts[i], i, &set->axes[2 * i], &set->axes[2 * i + 1], error);
        if (status != BAT_OK)
        {
            return status;
        }
    }
    legend_item *items;
    size_t item_count;
    bat_status status = collect_legend(set, count, &items, &item_count, error);
    if (status == BAT_OK)
    {
        size_t columns = scene_columns(set->options, count, MIN_WIDTH);
        sheet_content content = {.count = count,
                                 .columns = columns,
                                 .options = set->options,
                                 .items = items,
                                 .item_count = item_count,
                                 .natural_width = natural_width(columns),
                                 .context = set,
                                 .height = content_height,
                                 .caption = content_caption,
                                 .draw = content_draw};
        status = sheet_write(path, &content, error);
        free(items);
    }
    return status;
}

bat_status bat_chart_write(const char *path, const bat_chart *charts, size_t count, const bat_curve_picture_options *options,
                           bat_error *error)
{
    bat_curve_picture_options defaults = bat_curve_picture_defaults();
    if (path == NULL || charts == NULL || count == 0)
    {
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "charts need a file name and at least one chart");
    }
    chart_set set = {charts, options != NULL ? options : &defaults, NULL};
    bat_status status = bat_options_check(&bat_curve_picture_fields, set.options, error);
    if (status != BAT_OK)
    {
        return status;
    }
    set.axes = memory_array(2 * count, sizeof *set.axes);
    if (set.axes == NULL)
    {
        return error_memory(error, 2 * count * sizeof *set.axes);
    }
    status = write_set(path, &set, count, error);
    free(set.axes);
    return status;
}
