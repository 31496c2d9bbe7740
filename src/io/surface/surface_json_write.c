#include "base/error.h"
#include "io/common/number_text.h"
#include "io/surface/surface_formats.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

/// JSON readers take "-0" for a whole number, which has no sign.
static void append_number(text_buffer *text, double value)
{
    char *out = text_reserve(text, NUMBER_TEXT_SIZE + 2);
    if (out == NULL)
        return;
    text_advance(text, number_write(out, value));
    if (value == 0 && signbit(value))
        text_append_string(text, ".0");
}

/// What ends a row of an array of rows.
static const char *row_end(size_t row, size_t rows)
{
    return row + 1 < rows ? "],\n" : "]\n";
}

static void append_head(text_buffer *text, const bat_spline_surface *surface)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(surface->space);
    char head[512];
    (void)snprintf(head, sizeof head,
                   "{\n\"format\": \"batten surface\",\n\"version\": 1,\n\"degree\": [%d, %d],\n\"spans\": [%zu, %zu],\n"
                   "\"truncated\": %s,\n\"admissible\": %d,\n\"dimension\": %zu,\n",
                   options.degree[0], options.degree[1], options.spans[0], options.spans[1],
                   options.truncated ? "true" : "false", options.admissible, surface->dimension);
    text_append_string(text, head);
}

static bat_status append_boxes(text_buffer *text, const bat_hierarchical_space *space, bat_error *error)
{
    bat_spline_box *boxes = NULL;
    size_t count = 0;
    bat_status status = bat_hierarchical_space_regions(space, &boxes, &count, error);
    if (status != BAT_OK)
        return status;
    text_append_string(text, "\"boxes\": [\n");
    for (size_t i = 0; i < count; i++)
    {
        char row[128];
        (void)snprintf(row, sizeof row, "[%" PRIu32 ", %" PRIu32 ", %" PRIu32 ", %" PRIu32 ", %" PRIu32 "%s", boxes[i].level,
                       boxes[i].low[0], boxes[i].low[1], boxes[i].high[0], boxes[i].high[1], row_end(i, count));
        text_append_string(text, row);
    }
    text_append_string(text, "],\n");
    free(boxes);
    return BAT_OK;
}

static void append_functions(text_buffer *text, const bat_hierarchical_space *space)
{
    size_t count = bat_hierarchical_space_functions(space);
    text_append_string(text, "\"functions\": [\n");
    for (size_t i = 0; i < count; i++)
    {
        bat_spline_function function = bat_hierarchical_space_function(space, i);
        char row[64];
        (void)snprintf(row, sizeof row, "[%" PRIu32 ", %" PRIu32 ", %" PRIu32 "%s", function.level, function.i, function.j,
                       row_end(i, count));
        text_append_string(text, row);
    }
    text_append_string(text, "],\n");
}

static void append_control(text_buffer *text, const bat_spline_surface *surface)
{
    size_t count = bat_hierarchical_space_functions(surface->space);
    const double *number = surface->control;
    text_append_string(text, "\"control\": [\n");
    for (size_t i = 0; i < count; i++)
    {
        text_append_string(text, "[");
        for (size_t c = 0; c < surface->dimension; c++)
        {
            if (c > 0)
                text_append_string(text, ", ");
            append_number(text, *number++);
        }
        text_append_string(text, row_end(i, count));
    }
    text_append_string(text, "]\n}\n");
}

bat_status surface_json_write(const bat_spline_surface *surface, text_sink *sink, bat_error *error)
{
    text_buffer text = {0};
    append_head(&text, surface);
    bat_status status = append_boxes(&text, surface->space, error);
    append_functions(&text, surface->space);
    append_control(&text, surface);
    if (status == BAT_OK)
        status = sink_write(sink, &text, error);
    text_free(&text);
    return status;
}
