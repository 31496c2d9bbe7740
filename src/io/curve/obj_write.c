#include "base/error.h"
#include "io/common/number_text.h"
#include "io/common/row_blocks.h"
#include "io/curve/curve_formats.h"

#include <math.h>

static bat_status format_vertices(const void *context, const row_span *span, text_buffer *text, bat_error *error)
{
    (void)context;
    size_t dim = span->curve->space->point_dim;
    for (size_t i = span->begin; i < span->end; i++)
    {
        const double *point = span->curve->points + i * dim;
        char *out = text_reserve(text, 3 * (NUMBER_TEXT_SIZE + 1) + 2);
        if (out == NULL)
            return BAT_OK; // the sink reports it
        *out++ = 'v';
        for (size_t j = 0; j < 3; j++)
        {
            double coordinate = j < dim ? point[j] : 0.0;
            if (!isfinite(coordinate))
                return row_not_finite(span, i, error);
            *out++ = ' ';
            out = number_write(out, coordinate);
        }
        *out++ = '\n';
        text_advance(text, out);
    }
    return BAT_OK;
}

static char *write_index(char *out, size_t index)
{
    *out++ = ' ';
    return number_write_fixed(out, (int64_t)index + 1, 0);
}

/// `context` is the row of each curve's first point.
static bat_status format_elements(const void *context, const row_span *span, text_buffer *text, bat_error *error)
{
    (void)error;
    size_t first = ((const size_t *)context)[span->curve_index];
    if (span->begin == 0)
        text_append_string(text, "l");
    for (size_t i = span->begin; i < span->end; i++)
    {
        char *out = text_reserve(text, NUMBER_TEXT_SIZE);
        if (out == NULL)
            return BAT_OK;
        text_advance(text, write_index(out, first + i));
    }
    if (span->end < span->curve->count)
        return BAT_OK;
    char *out = text_reserve(text, NUMBER_TEXT_SIZE);
    if (out == NULL)
        return BAT_OK;
    if (span->curve->closed)
        out = write_index(out, first);
    *out++ = '\n';
    text_advance(text, out);
    return BAT_OK;
}

static bat_status check_curves(const bat_curve_set *set, bat_error *error)
{
    if (set->space->point_dim != 2 && set->space->point_dim != 3)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "OBJ cannot hold points of %zu coordinates",
                         set->space->point_dim);
    for (size_t i = 0; i < set->count; i++)
        if (set->curves[i].count < 2)
            return error_set(error, BAT_UNSUPPORTED, i, 0, "OBJ cannot hold curve %zu, which has a single point", i);
    return BAT_OK;
}

bat_status obj_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    row_blocks blocks;
    bat_status status = check_curves(set, error);
    if (status == BAT_OK)
        status = row_blocks_begin(set, &blocks, error);
    if (status != BAT_OK)
        return status;
    status = row_blocks_write(&blocks, sink, options->threads, format_vertices, NULL, error);
    if (status == BAT_OK)
        status = row_blocks_write(&blocks, sink, options->threads, format_elements, blocks.first_rows, error);
    row_blocks_end(&blocks);
    return status;
}
