#include "draw/common/sheet.h"

#include "base/error.h"

/// @file
/// Layout of a page: heights of rows from their boxes, scaled to a prescribed height.

#define MARGIN 14.0
#define GAP_ACROSS 16.0
#define GAP_DOWN 14.0
#define TITLE_SPACE 24.0
#define CAPTION_SPACE 17.0
#define LEGEND_GAP 9.0
#define MIN_BOX 10.0
#define LARGEST_SIDE 10000.0

typedef struct layout
{
    double width, height;
    double box_width;
    double title; ///< height of the title
    double legend;
    double footer;
    size_t rows;
    double *heights;  ///< for each row: the height of its boxes
    double *captions; ///< for each row: the height of its captions
} layout;

double sheet_width(double box_width, size_t columns)
{
    return 2.0 * MARGIN + box_width * (double)columns + GAP_ACROSS * (double)(columns - 1);
}

static const char *caption_of(const sheet_content *content, size_t index)
{
    return content->caption != NULL ? content->caption(content->context, index) : NULL;
}

/// Check that the page is large enough for its content.
static bat_status check_room(const layout *plan, double fixed, bat_error *error)
{
    if (plan->height > LARGEST_SIDE)
    {
        return ERROR_TOO_LARGE(error, "the picture would be %.0f points high; the maximum is 10000", plan->height);
    }
    if (plan->box_width < MIN_BOX || plan->height < fixed + MIN_BOX * (double)plan->rows)
        return ERROR_ARGUMENT(error, "a picture of %.0f by %.0f points is too small for its panels, titles and legend",
                              plan->width, plan->height);
    return BAT_OK;
}

/// Compute the widths, the title and the legend of the page.
static layout plan_page(const sheet_content *content, cairo_t *cairo)
{
    const bat_curve_picture_options *options = content->options;
    double columns = (double)content->columns;
    layout plan = {.width = options->width > 0.0 ? options->width : content->natural_width,
                   .rows = (content->count + content->columns - 1) / content->columns,
                   .title = text_given(options->title) ? TITLE_SPACE : 0.0};
    plan.box_width = (plan.width - 2.0 * MARGIN - GAP_ACROSS * (columns - 1.0)) / columns;
    plan.legend = legend_height(cairo, content->items, content->item_count, plan.width - 2.0 * MARGIN);
    plan.legend += plan.legend > 0.0 ? LEGEND_GAP : 0.0;
    plan.footer = content->footer_height > 0.0 ? content->footer_height + LEGEND_GAP : 0.0;
    return plan;
}

static bat_status plan_layout(const sheet_content *content, cairo_t *cairo, layout *plan, bat_error *error)
{
    *plan = plan_page(content, cairo);
    plan->heights = memory_array(plan->rows, sizeof(double));
    plan->captions = memory_array(plan->rows, sizeof(double));
    if (plan->heights == NULL || plan->captions == NULL)
        return error_memory(error, plan->rows * sizeof(double));
    double natural = 0.0;
    double fixed = 2.0 * MARGIN + plan->title + plan->legend + plan->footer + GAP_DOWN * (double)(plan->rows - 1);
    for (size_t row = 0; row < plan->rows; row++)
    {
        plan->heights[row] = MIN_BOX;
        plan->captions[row] = 0;
        for (size_t i = row * content->columns; i < (row + 1) * content->columns && i < content->count; i++)
        {
            plan->heights[row] = fmax(plan->heights[row], content->height(content->context, i, plan->box_width));
            if (text_given(caption_of(content, i)))
                plan->captions[row] = CAPTION_SPACE;
        }
        natural += plan->heights[row];
        fixed += plan->captions[row];
    }
    bool prescribed = content->options->height > 0.0;
    plan->height = prescribed ? content->options->height : ceil(natural + fixed);
    for (size_t row = 0; row < plan->rows && prescribed; row++)
        plan->heights[row] *= (plan->height - fixed) / natural;
    return check_room(plan, fixed, error);
}

static bat_status draw_row(const sheet_content *content, cairo_t *cairo, const layout *plan, size_t row, double y,
                           bat_error *error)
{
    size_t first = row * content->columns;
    for (size_t i = first; i < first + content->columns && i < content->count; i++)
    {
        double x = MARGIN + (double)(i - first) * (plan->box_width + GAP_ACROSS);
        double box[4] = {x, y, plan->box_width, plan->heights[row]};
        cairo_save(cairo);
        bat_status status = content->draw(content->context, cairo, i, box, error);
        cairo_restore(cairo);
        if (status != BAT_OK)
            return status;
        const char *caption = caption_of(content, i);
        if (text_given(caption))
        {
            style_use_colour(cairo, COLOUR_FOREGROUND);
            text_draw_fitted(cairo, caption, TEXT_CAPTION, false, x + 0.5 * plan->box_width,
                             y + plan->heights[row] + CAPTION_SPACE - 4.0, plan->box_width);
        }
    }
    return BAT_OK;
}

static bat_status draw_sheet(const sheet_content *content, cairo_t *cairo, const layout *plan, bat_error *error)
{
    double y = MARGIN + plan->title;
    if (plan->title > 0.0)
    {
        style_use_colour(cairo, COLOUR_FOREGROUND);
        text_draw_fitted(cairo, content->options->title, TEXT_TITLE, true, 0.5 * plan->width, MARGIN + 10.0,
                         plan->width - 2.0 * MARGIN);
    }
    for (size_t row = 0; row < plan->rows; row++)
    {
        bat_status status = draw_row(content, cairo, plan, row, y, error);
        if (status != BAT_OK)
            return status;
        y += plan->heights[row] + plan->captions[row] + GAP_DOWN;
    }
    y += LEGEND_GAP - GAP_DOWN;
    legend_draw(cairo, content->items, content->item_count, MARGIN, y, plan->width - 2.0 * MARGIN);
    if (plan->footer > 0.0)
    {
        double box[4] = {MARGIN, y + plan->legend, plan->width - 2.0 * MARGIN, content->footer_height};
        content->draw_footer(content->context, cairo, box);
    }
    return BAT_OK;
}

bat_status sheet_write(const char *path, const sheet_content *content, bat_error *error)
{
    canvas_format format;
    bat_status status = canvas_format_of(path, &format, error);
    if (status != BAT_OK)
        return status;
    layout plan = {0};
    draw_canvas canvas = {0}, small = {0}; // the small page provides font metrics for the layout
    status = canvas_open(&small, CANVAS_PNG, 1.0, 1.0, 1.0, error);
    if (status == BAT_OK)
        status = plan_layout(content, small.cairo, &plan, error);
    canvas_close(&small);
    if (status == BAT_OK)
        status = canvas_open(&canvas, format, plan.width, plan.height, content->options->pixels_per_point, error);
    if (status == BAT_OK)
        status = draw_sheet(content, canvas.cairo, &plan, error);
    if (status == BAT_OK)
        status = canvas_save(&canvas, path, error);
    canvas_close(&canvas);
    free(plan.heights);
    free(plan.captions);
    return status;
}
