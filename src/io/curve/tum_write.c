#include "base/error.h"
#include "curve/csv_columns.h"
#include "io/common/number_text.h"
#include "io/common/row_blocks.h"
#include "io/curve/curve_formats.h"

#include <math.h>

/// Places of what a row has, in its order, among the coordinates of a rigid motion.
static const size_t COORDINATES[] = {0, 1, 2, 4, 5, 6, 3};
enum
{
    COORDINATE_COUNT = sizeof COORDINATES / sizeof COORDINATES[0]
};

static bat_status format_rows(const void *context, const row_span *span, text_buffer *text, bat_error *error)
{
    const size_t *time = context;
    const bat_curve *curve = span->curve;
    for (size_t i = span->begin; i < span->end; i++)
    {
        const double *point = curve->points + i * curve->space->point_dim;
        double row[1 + COORDINATE_COUNT] = {curve->channels[i * curve->channel_count + *time]};
        for (size_t j = 0; j < COORDINATE_COUNT; j++)
            row[1 + j] = point[COORDINATES[j]];
        char *out = text_reserve(text, (1 + COORDINATE_COUNT) * (NUMBER_TEXT_SIZE + 1));
        if (out == NULL)
            return BAT_OK; // the sink reports it
        for (size_t j = 0; j <= COORDINATE_COUNT; j++)
        {
            if (!isfinite(row[j]))
                return row_not_finite(span, i, error);
            out = number_write(out, row[j]);
            *out++ = j < COORDINATE_COUNT ? ' ' : '\n';
        }
        text_advance(text, out);
    }
    return BAT_OK;
}

/// The channel that holds the times.
static size_t time_channel(const bat_curve_set *set)
{
    const bat_curve_attributes *attributes = set->attributes;
    if (attributes == NULL || attributes->csv.names == NULL)
        return BAT_NO_INDEX;
    const point_form *form = attributes->csv.form;
    motion_channels channels;
    csv_columns_channels(&attributes->csv, form != NULL ? form->count : set->space->point_dim, NULL, &channels);
    return channels.time < set->curves[0].channel_count ? channels.time : BAT_NO_INDEX;
}

bat_status tum_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    size_t time = time_channel(set);
    if (quaternion_place(set->space) != 3)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "a TUM trajectory holds rigid motions, not the space %s",
                         set->space->name);
    if (set->count > 1)
        return error_set(error, BAT_UNSUPPORTED, 1, 0, "a TUM trajectory is one curve, not %zu", set->count);
    if (time == BAT_NO_INDEX)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "a TUM trajectory needs times, which these poses lack");
    row_blocks blocks;
    bat_status status = row_blocks_begin(set, &blocks, error);
    if (status != BAT_OK)
        return status;
    text_buffer header = {0};
    text_append_string(&header, "# timestamp tx ty tz qx qy qz qw\n");
    status = sink_write(sink, &header, error);
    if (status == BAT_OK)
        status = row_blocks_write(&blocks, sink, options->threads, format_rows, &time, error);
    text_free(&header);
    row_blocks_end(&blocks);
    return status;
}
