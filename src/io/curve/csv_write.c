#include "base/error.h"
#include "curve/csv_columns.h"
#include "io/common/number_text.h"
#include "io/curve/formats.h"
#include "io/curve/rows.h"
#include "space/degrees.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/// @file
/// Writer of CSV and of trajectories in the TUM format.

/// The columns of the rows.
typedef struct csv_layout
{
    size_t column_count;
    size_t coordinate_count;
    const csv_columns *columns; ///< names and order of the columns in the input file; or null
    const point_form *form;     ///< the form of the points; null for plain coordinates
    bool degrees;
    int decimals;  ///< of degrees
    size_t corner; ///< the column before which that of the corners stands, or BAT_NO_INDEX
} csv_layout;

static bat_status choose_layout(const bat_curve_set *set, const bat_curve_write_options *options, csv_layout *layout,
                                bat_error *error)
{
    size_t channels = set->curves[0].channel_count;
    for (size_t i = 1; i < set->count; i++)
        if (set->curves[i].channel_count != channels)
            return error_set(error, BAT_UNSUPPORTED, i, 0, "CSV cannot hold curve %zu with %zu columns beside one with %zu",
                             i, set->curves[i].channel_count, channels);
    const bat_curve_attributes *attributes = set->attributes;
    bool globe = strcmp(set->space->name, "sphere") == 0 && set->space->point_dim == 3;
    bool degrees = globe && attributes != NULL && (attributes_are_geojson(attributes) || attributes->csv.degrees);
    const point_form *form = attributes != NULL ? attributes->csv.form : NULL;
    size_t coordinates = degrees ? 2 : form != NULL ? form->count : set->space->point_dim;
    *layout = (csv_layout){coordinates + channels, coordinates, NULL, form, degrees, options->precision, BAT_NO_INDEX};
    if (attributes != NULL && attributes->csv.names != NULL && attributes->csv.count == layout->column_count &&
        attributes->csv.degrees == degrees)
    {
        layout->columns = &attributes->csv;
        layout->corner = attributes->csv.corner;
    }
    for (size_t i = 0; i < set->count; i++)
        if (set->curves[i].corners == NULL)
            layout->corner = BAT_NO_INDEX;
    return BAT_OK;
}

/// The space that a reader would choose from the columns.
static const char *implied_space(const csv_layout *layout)
{
    size_t longitude, latitude;
    if (layout->degrees || (layout->columns != NULL && csv_columns_geographic(layout->columns, &longitude, &latitude)))
        return "sphere";
    if (layout->form != NULL)
        return ""; // the meaning of the names depends on the space
    return layout->column_count == 2 ? "plane" : "euclidean";
}

static void write_header(const csv_layout *layout, const bat_curve_set *set, text_buffer *text)
{
    char separator = ',';
    if (strcmp(set->space->name, implied_space(layout)) != 0)
    {
        text_append_string(text, "# space: ");
        text_append_string(text, set->space->name);
        text_append_string(text, "\n");
    }
    if (layout->columns == NULL && !layout->degrees)
        return;
    for (size_t i = 0; i < layout->column_count; i++)
    {
        static const char *const names[] = {"lon", "lat", "alt"};
        char other[32];
        (void)snprintf(other, sizeof other, "channel%zu", i);
        if (i > 0)
            text_append(text, &separator, 1);
        if (i == layout->corner)
            text_append_string(text, "corner,");
        text_append_string(text, layout->columns != NULL ? layout->columns->names[i] : i < 3 ? names[i] : other);
    }
    text_append_string(text, layout->corner == layout->column_count ? ",corner\n" : "\n");
}

static char *write_number(char *out, const csv_layout *layout, const double *numbers, const double *channels,
                          degree_units units, size_t place)
{
    if (channels != NULL && place >= layout->coordinate_count)
        return number_write(out, channels[place - layout->coordinate_count]);
    if (layout->degrees)
        return number_write_fixed(out, place == 0 ? units.longitude : units.latitude, layout->decimals);
    return number_write(out, numbers[place]);
}

static bool all_finite(const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

static bat_status format_rows(const void *context, const row_span *span, text_buffer *text, bat_error *error)
{
    const csv_layout *layout = context;
    const bat_curve *curve = span->curve;
    size_t dim = curve->space->point_dim, channel_count = curve->channel_count;
    double units_per_radian = degree_units_per_radian(layout->decimals);
    if (span->begin == 0 && span->curve_index > 0)
        text_append_string(text, "\n");
    if (span->begin == 0 && curve->closed)
        text_append_string(text, "# closed\n");
    for (size_t i = span->begin; i < span->end; i++)
    {
        const double *point = curve->points + i * dim;
        const double *channels = channel_count > 0 ? curve->channels + i * channel_count : NULL;
        if (!all_finite(point, dim) || !all_finite(channels, channel_count))
            return row_not_finite(span, i, error);
        double written[MAX_FORM_COLUMNS];
        if (layout->form != NULL)
            point_form_write(layout->form, point, written);
        const double *numbers = layout->form != NULL ? written : point;
        degree_units units = layout->degrees ? degrees_of_point(point, units_per_radian) : (degree_units){0};
        char *out = text_reserve(text, (layout->column_count + 1) * (NUMBER_TEXT_SIZE + 1));
        if (out == NULL)
            return BAT_OK; // the sink reports a lack of memory
        char flag = layout->corner != BAT_NO_INDEX && curve->corners[i] != 0 ? '1' : '0';
        for (size_t j = 0; j < layout->column_count; j++)
        {
            if (j == layout->corner)
            {
                *out++ = flag;
                *out++ = ',';
            }
            size_t place = layout->columns != NULL && layout->columns->places != NULL ? layout->columns->places[j] : j;
            out = write_number(out, layout, numbers, channels, units, place);
            *out++ = j + 1 < layout->column_count || layout->corner == layout->column_count ? ',' : '\n';
        }
        if (layout->corner == layout->column_count)
        {
            *out++ = flag;
            *out++ = '\n';
        }
        text_advance(text, out);
    }
    return BAT_OK;
}

bat_status csv_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    csv_layout layout = {0};
    bat_status status = choose_layout(set, options, &layout, error);
    row_blocks blocks;
    if (status == BAT_OK)
        status = row_blocks_begin(set, &blocks, error);
    if (status != BAT_OK)
        return status;
    text_buffer header = {0};
    write_header(&layout, set, &header);
    status = sink_write(sink, &header, error);
    if (status == BAT_OK)
        status = row_blocks_write(&blocks, sink, options->threads, format_rows, &layout, error);
    text_free(&header);
    row_blocks_end(&blocks);
    return status;
}

/// The coordinates of a rigid motion in the order of a TUM row.
static const size_t COORDINATES[] = {0, 1, 2, 4, 5, 6, 3};
enum
{
    COORDINATE_COUNT = sizeof COORDINATES / sizeof COORDINATES[0]
};

static bat_status format_tum_rows(const void *context, const row_span *span, text_buffer *text, bat_error *error)
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
            return BAT_OK; // the sink reports a lack of memory
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

/// The channel of the times, or BAT_NO_INDEX.
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
        status = row_blocks_write(&blocks, sink, options->threads, format_tum_rows, &time, error);
    text_free(&header);
    row_blocks_end(&blocks);
    return status;
}
