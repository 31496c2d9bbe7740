#include "base/error.h"
#include "draw/common/sheet.h"
#include "draw/curve/scene.h"

/// @file
/// Pictures of curves: a page of panels with a legend.

bat_curve_picture_options bat_curve_picture_defaults(void)
{
    return (bat_curve_picture_options){.pixels_per_point = 2.0,
                                       .longitude = NAN,
                                       .latitude = NAN,
                                       .control_polygon = true,
                                       .control_points = true,
                                       .grid = true,
                                       .legend = true};
}

/// The largest aspect ratio of a flat drawing at the page's usual width, height over width.
#define TALLEST 1.25

/// The fraction of the usual width that a page needs; smaller if all panels exceed the largest aspect ratio.
static double narrowing(const scene *made)
{
    const double min_share = 0.55;
    double share = made->options->width > 0.0 ? 1.0 : min_share;
    for (size_t i = 0; i < made->count; i++)
    {
        const scene_panel *panel = &made->panels[i];
        bool flat = panel->space == VIEW_PLANE || panel->space == VIEW_SOLID;
        bool local = panel->space == VIEW_SPHERE && panel->frame.map.projection == BAT_CURVE_PROJECTION_LOCAL;
        const double *low = local ? panel->frame.map.low : panel->frame.low;
        const double *high = local ? panel->frame.map.high : panel->frame.high;
        share = fmax(share, flat || local ? TALLEST * (high[0] - low[0]) / (high[1] - low[1]) : 1.0);
    }
    return fmin(share, 1.0);
}

static double content_height(const void *context, size_t index, double width)
{
    const scene *made = context;
    return panel_height(&made->panels[index], made->options, TALLEST / narrowing(made), width);
}

static const char *content_caption(const void *context, size_t index)
{
    const scene *made = context;
    return made->panels[index].source->title;
}

static bat_status content_draw(const void *context, cairo_t *cairo, size_t index, const double box[4], bat_error *error)
{
    const scene *made = context;
    return panel_draw(cairo, &made->panels[index], made->options, box, error);
}

/// Collect the labelled layers of all panels without repetitions. Release the items with free().
static bat_status collect_legend(const scene *made, legend_item **items, size_t *count, bat_error *error)
{
    size_t max_count = 0;
    for (size_t i = 0; i < made->count; i++)
        max_count += made->panels[i].source->layer_count;
    *count = 0;
    if (array_make(items, max_count, sizeof **items, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t i = 0; i < made->count && made->options->legend; i++)
    {
        const bat_curve_picture_panel *panel = made->panels[i].source;
        bool repeats = // the lines that other panels show beneath results
            made->count > 1 && scene_is_map(&made->panels[i]) && made->panels[i].given_only;
        for (size_t k = 0; k < panel->layer_count && !repeats; k++)
            if (text_given(panel->layers[k].label) && scene_layer_shown(&panel->layers[k], made->options))
                legend_add(*items, count, panel_legend_item(&made->panels[i], k, made->options));
    }
    return BAT_OK;
}

/// The width for the panels of a row, at most that of a usual page.
static double natural_width(const scene *made)
{
    bool wide = false, local = false;
    for (size_t i = 0; i < made->count; i++)
    {
        bat_curve_projection shown = made->panels[i].frame.map.projection;
        bool sphere = made->panels[i].space == VIEW_SPHERE;
        wide = wide || (sphere && (shown == BAT_CURVE_PROJECTION_MAP || shown == BAT_CURVE_PROJECTION_BOTH));
        local = local || (sphere && shown == BAT_CURVE_PROJECTION_LOCAL);
    }
    if (made->columns == 1)
        return wide ? 640.0 : local ? 480.0 : 400.0;
    if (made->columns == 2)
        return wide ? 960.0 : local ? 800.0 : 620.0;
    return wide ? 1200.0 : fmin(840.0 + 130.0 * fmax(0.0, (double)made->columns - 5.0), 4000.0);
}

bat_status bat_curve_picture_write(const char *path, const bat_curve_picture_panel *panels, size_t count,
                                   const bat_curve_picture_options *options, bat_error *error)
{
    bat_curve_picture_options defaults = bat_curve_picture_defaults();
    canvas_format format;
    if (path == NULL || panels == NULL || count == 0)
        return ERROR_ARGUMENT(error, "a picture needs a file name and at least one panel");
    bat_status status = canvas_format_of(path, &format, error);
    if (status != BAT_OK)
        return status;
    scene made;
    status = scene_make(panels, count, options != NULL ? options : &defaults, &made, error);
    if (status != BAT_OK)
        return status;
    legend_item *items;
    size_t item_count;
    status = collect_legend(&made, &items, &item_count, error);
    if (status == BAT_OK)
    {
        sheet_content content = {.count = count,
                                 .columns = made.columns,
                                 .options = made.options,
                                 .items = items,
                                 .item_count = item_count,
                                 .natural_width = narrowing(&made) * natural_width(&made),
                                 .context = &made,
                                 .height = content_height,
                                 .caption = content_caption,
                                 .draw = content_draw};
        status = sheet_write(path, &content, error);
        free(items);
    }
    scene_free(&made);
    return status;
}

bat_status bat_curve_picture_projection(const bat_curve_picture_panel *panels, size_t count,
                                        const bat_curve_picture_options *options, bat_curve_projection *taken,
                                        bat_error *error)
{
    bat_curve_picture_options defaults = bat_curve_picture_defaults();
    scene made;
    if (panels == NULL || count == 0 || taken == NULL)
        return ERROR_ARGUMENT(error, "a projection needs at least one panel");
    bat_status status = scene_measure(panels, count, options != NULL ? options : &defaults, &made, error);
    if (status != BAT_OK)
        return status;
    *taken = BAT_CURVE_PROJECTION_AUTO;
    for (size_t i = count; i-- > 0;)
        *taken = made.panels[i].space == VIEW_SPHERE ? made.panels[i].frame.map.projection : *taken;
    scene_free(&made);
    return BAT_OK;
}
