#include "io/common/time_text.h"
#include "io/curve/csv.h"
#include "linalg/vector.h"
#include "space/degrees.h"

#include <inttypes.h>

/// @file
/// Writers of CSV and of trajectories.

/// More decimals of radians than of degrees.
static const int RADIAN_DECIMALS = 2;

typedef struct csv_layout
{
    size_t column_count;
    size_t coordinate_count;
    size_t channel_count;       ///< that are written
    const csv_columns *columns; ///< names and order of the columns in the input file; or null
    csv_columns made;           ///< those of a result that came from no file with columns
    const point_form *form;     ///< the form of the points; null for plain coordinates
    bool degrees;
    int decimals;      ///< of degrees
    size_t corner;     ///< the column before which that of the corners stands, or BAT_NO_INDEX
    double *places;    ///< of all points between the rows of the input file; null where they are not needed
    double *clocks;    ///< places for CSV_CLOCK, NaN in curves without the rows' times; null without such columns
    size_t time_place; ///< of the times among the numbers; BAT_NO_INDEX without
    int64_t origin;    ///< of the times
    int time_decimals; ///< of their unit
    const char *date;  ///< the form of the times where they are dates; else null
} csv_layout;

static bat_status choose_layout(const bat_curve_set *set, const bat_curve_write_options *options, csv_layout *layout,
                                bat_error *error)
{
    // Of GPX, some curves can have altitudes in their channels.
    bool places = set->attributes != NULL && set->attributes->format == BAT_CURVE_FORMAT_GPX;
    size_t channels = set->curves[0].channel_count;
    for (size_t i = 1; i < set->count; i++)
        channels = places && set->curves[i].channel_count < channels ? set->curves[i].channel_count : channels;
    for (size_t i = 1; i < set->count && !places; i++)
        if (set->curves[i].channel_count != channels)
            return error_set(error, BAT_UNSUPPORTED, i, 0, "CSV cannot hold curve %zu with %zu columns beside one with %zu",
                             i, set->curves[i].channel_count, channels);
    const bat_curve_attributes *attributes = set->attributes;
    bool globe = strcmp(set->space->name, "sphere") == 0 && set->space->point_dim == 3;
    bool degrees = globe && attributes != NULL && (attributes_are_geojson(attributes) || attributes->degrees);
    const point_form *form = attributes != NULL ? attributes->form : NULL;
    size_t coordinates = degrees ? 2 : form != NULL ? form->count : set->space->point_dim;
    *layout = (csv_layout){.column_count = coordinates + channels,
                           .coordinate_count = coordinates,
                           .channel_count = channels,
                           .form = form,
                           .degrees = degrees,
                           .decimals = options->precision,
                           .corner = BAT_NO_INDEX,
                           .time_place = BAT_NO_INDEX,
                           .origin = bat_curve_set_time_origin(set),
                           .time_decimals = attributes != NULL ? attributes->time_decimals : 0};
    const csv_columns *columns = attributes != NULL ? attributes->csv : NULL;
    if (attributes != NULL && columns == NULL &&
        (attributes->channels.time != BAT_NO_INDEX || attributes->channels.velocity_count > 0))
    {
        columns = &layout->made;
        if (!csv_columns_of_motion(attributes, &layout->made))
            return error_memory(error, sizeof *columns);
    }
    if (columns != NULL && (columns->names != NULL || columns->places != NULL) && columns->degrees == degrees &&
        csv_columns_fit(columns, coordinates, channels))
    {
        layout->columns = columns;
        layout->column_count = columns->count;
        layout->channel_count = channels - (columns->has_places ? CSV_PLACE_CHANNELS : 0);
        layout->corner = columns->corner;
        motion_channels known;
        csv_columns_channels(columns, coordinates, NULL, &known);
        layout->time_place = known.time != BAT_NO_INDEX ? coordinates + known.time : BAT_NO_INDEX;
        layout->date = attributes->time_text[0] != '\0' ? attributes->time_text : NULL;
    }
    for (size_t i = 0; i < set->count; i++)
        if (set->curves[i].corners == NULL)
            layout->corner = BAT_NO_INDEX;
    return BAT_OK;
}

/// Whether a point has the times of a row of the file, in all columns of CSV_CLOCK.
static bool has_row_times(const csv_layout *layout, const double *channels, size_t row)
{
    const csv_columns *columns = layout->columns;
    const size_t *cell = columns->cells.offsets + row * columns->cells.columns;
    for (size_t j = 0; j < columns->count; j++)
    {
        csv_kind kind = (csv_kind)columns->kinds[j];
        if (kind == CSV_NUMBER || kind == CSV_ID)
            continue;
        csv_field text = csv_text(columns->cells.text + *cell++);
        double value = 0;
        int64_t nanoseconds;
        if (kind != CSV_CLOCK)
            continue;
        if (layout->origin != 0 && columns->places[j] == layout->time_place &&
            exact_time_read(text.begin, text.end, 0, &nanoseconds))
            value = exact_time_since(nanoseconds, layout->origin);
        else if (number_read(text.begin, text.end, &value) != NULL)
            return false;
        if (value != channels[columns->places[j] - layout->coordinate_count])
            return false;
    }
    return true;
}

/// The places of a curve's points by the times of the rows, between which edges are halved; NaN where it has not all rows.
static void find_clocks(const csv_layout *layout, const bat_curve *curve, size_t index, double *places)
{
    const csv_cells *cells = &layout->columns->cells;
    size_t first = index < cells->curves ? cells->first_rows[index] : 0, at = 0, step = 1;
    size_t rows = index < cells->curves ? cells->first_rows[index + 1] - first : 0;
    bool found = rows > 0 && curve->count > 0 && has_row_times(layout, curve->channels, first);
    for (size_t row = 0; row < rows && found; row++, at += step)
    {
        bool last = row + 1 == rows;
        size_t end = last && !curve->closed ? at + 1 : curve->count;
        for (step = 1; at + step < end; step *= 2)
            if (!last && has_row_times(layout, curve->channels + (at + step) * curve->channel_count, first + row + 1))
                break;
        found = at + step < curve->count || (last && at + step == curve->count);
        for (size_t j = 0; j < step && found; j++)
            places[at + j] = (double)row + (double)j / (double)step;
    }
    for (size_t i = 0; i < curve->count && (!found || at != curve->count); i++)
        places[i] = NAN;
}

static bat_status find_places(const bat_curve_set *set, csv_layout *layout, bat_error *error)
{
    size_t rows = 0;
    const csv_columns *columns = layout->columns;
    bool clocks = columns != NULL && columns->kinds != NULL && memchr(columns->kinds, CSV_CLOCK, columns->count) != NULL;
    if (columns == NULL || (!columns->has_places && !clocks))
        return BAT_OK;
    for (size_t i = 0; i < set->count; i++)
        rows += set->curves[i].count;
    layout->places = columns->has_places ? memory_array(rows, sizeof *layout->places) : NULL;
    layout->clocks = clocks ? memory_array(rows, sizeof *layout->clocks) : NULL;
    if ((columns->has_places && layout->places == NULL) || (clocks && layout->clocks == NULL))
        return error_memory(error, rows * sizeof *layout->places);
    for (size_t i = 0, row = 0; i < set->count; row += set->curves[i++].count)
    {
        if (columns->has_places)
            cells_places(&columns->cells, &set->curves[i], i, layout->places + row);
        if (clocks)
            find_clocks(layout, &set->curves[i], i, layout->clocks + row);
    }
    return BAT_OK;
}

/// Whether other first rows could make a column one of numbers or none: its name or its first cell leaves that open.
static bool is_open(const csv_columns *columns)
{
    size_t cell = 0;
    for (size_t i = 0; i < columns->count && columns->names != NULL; i++)
        if (columns->places[i] != BAT_NO_INDEX && name_is_code(columns->names[i]))
            return true;
    for (size_t i = 0; i < columns->count && columns->kinds != NULL; i++)
    {
        csv_kind kind = (csv_kind)columns->kinds[i];
        if (kind == CSV_NUMBER || kind == CSV_ID)
            continue;
        csv_field field = csv_text(columns->cells.text + columns->cells.offsets[cell++]);
        double value;
        bool comma;
        if ((kind == CSV_TEXT || kind == CSV_GAPS) &&
            (csv_is_missing(field) || csv_read_number(field, ',', &value, &comma) == NULL))
            return true;
    }
    return false;
}

/// Whether a reader would take the same columns for coordinates in this space.
static bool is_implied(const csv_columns *columns, const char *space, size_t coordinates)
{
    csv_choice choice;
    csv_columns_choose(columns, space, false, &choice);
    bool same = choice.count == coordinates && choice.degrees == columns->degrees && choice.radians == columns->radians;
    for (size_t i = 0; same && i < coordinates; i++)
        same = columns->places[choice.columns[i]] == i;
    bool refused = csv_is_guess(columns, columns->count, &choice, false, space != NULL);
    return same && !refused && !(choice.by_place && is_open(columns));
}

/// Write the numbers of the columns of coordinates, from 1.
static void write_column_list(const csv_layout *layout, text_buffer *text)
{
    const csv_columns *columns = layout->columns;
    for (size_t i = 0; i < layout->coordinate_count && columns->chosen == NULL; i++)
        for (size_t j = 0; j < columns->count; j++)
            if (columns->places[j] == i)
                text_append_format(text, "%s%zu", i > 0 ? "," : "", j + 1 + (j >= columns->corner ? 1 : 0));
    if (columns->chosen != NULL)
        text_append_string(text, columns->chosen);
}

/// The space that a reader would choose from the columns.
static const char *implied_space(const csv_layout *layout)
{
    csv_choice choice;
    if (layout->degrees && layout->columns == NULL)
        return "sphere";
    if (layout->form != NULL)
        return ""; // the meaning of the names depends on the space
    if (layout->columns == NULL)
        return layout->column_count == 2 ? "plane" : "euclidean";
    column_names names = {layout->columns->names, layout->column_count};
    char fault[256];
    if (point_form_incomplete(NULL, &names, fault, sizeof fault))
        return ""; // they are refused without the space
    csv_columns_choose(layout->columns, NULL, false, &choice);
    bool refused = csv_is_guess(layout->columns, layout->columns->count, &choice, false, false);
    return refused ? "" : choice.space;
}

static void write_directives(const csv_layout *layout, const bat_curve_set *set, text_buffer *text)
{
    const char *space = set->space->name;
    bool named = strcmp(space, implied_space(layout)) != 0;
    if (named)
    {
        TEXT_APPEND(text, "# space: ", space, "\n");
    }
    if (layout->columns == NULL || layout->form != NULL || layout->columns->places == NULL ||
        is_implied(layout->columns, named ? space : NULL, layout->coordinate_count))
        return;
    text_append_string(text, "# columns: ");
    write_column_list(layout, text);
    text_append_string(text, "\n");
}

static void write_header(const csv_layout *layout, const bat_curve_set *set, text_buffer *text)
{
    write_directives(layout, set, text);
    if (layout->columns != NULL ? layout->columns->names == NULL : !layout->degrees)
        return;
    for (size_t i = 0; i < layout->column_count; i++)
    {
        static const char *const names[] = {"lon", "lat", "alt"};
        char other[32];
        (void)snprintf(other, sizeof other, "channel%zu", i);
        text_append_string(text, i > 0 ? "," : "");
        text_append_string(text, i == layout->corner ? "corner," : "");
        const char *name = layout->columns != NULL ? layout->columns->names[i] : i < 3 ? names[i] : other;
        cells_write_text(name, layout->column_count == 1, text);
    }
    text_append_string(text, layout->corner == layout->column_count ? ",corner\n" : "\n");
}

typedef struct csv_row
{
    const csv_layout *layout;
    const double *point, *numbers, *channels;
    degree_units units;
    size_t curve, index, first; ///< of the point; the row of its curve's first point
} csv_row;

/// A date with the time of day, in the form of the file.
static char *write_date(char *out, const csv_layout *layout, double seconds)
{
    iso_time form;
    int64_t nanoseconds;
    if (iso_time_read(layout->date, layout->date + strlen(layout->date), &form) &&
        exact_time_nanoseconds(layout->origin, seconds, &nanoseconds))
        return iso_time_write(out, &form, nanoseconds);
    return exact_time_write(out, layout->origin, layout->time_decimals, seconds);
}

static char *write_number(char *out, const csv_row *row, size_t place)
{
    const csv_layout *layout = row->layout;
    if (layout->date != NULL && place == layout->time_place && row->channels != NULL)
        return write_date(out, layout, row->channels[place - layout->coordinate_count]);
    if (place == layout->time_place && row->channels != NULL)
        return exact_time_write(out, layout->origin, layout->time_decimals, row->channels[place - layout->coordinate_count]);
    if (place >= layout->coordinate_count && row->channels != NULL)
        return number_write(out, row->channels[place - layout->coordinate_count]);
    if (layout->degrees)
    {
        if (layout->columns == NULL || !layout->columns->radians)
            return number_write_fixed(out, place == 0 ? row->units.longitude : row->units.latitude, layout->decimals);
        double angle =
            place == 0 ? atan2(row->point[1], row->point[0]) : atan2(row->point[2], hypot(row->point[0], row->point[1]));
        int decimals = layout->decimals + RADIAN_DECIMALS;
        return number_write_fixed(out, llrint(angle * (double)number_power_of_ten(decimals)), decimals);
    }
    return number_write(out, row->numbers[place]);
}

/// Write a field of a column, and reserve room for a number after it. Null when out of memory.
static char *write_field(char *out, const csv_row *row, size_t column, size_t cell, text_buffer *text)
{
    const csv_layout *layout = row->layout;
    const csv_columns *columns = layout->columns;
    csv_kind kind = columns != NULL && columns->kinds != NULL ? (csv_kind)columns->kinds[column] : CSV_NUMBER;
    const double *places = kind == CSV_CLOCK ? layout->clocks : layout->places;
    double place = places != NULL ? places[row->first + row->index] : 0;
    if (kind == CSV_NUMBER || (kind == CSV_CLOCK && isnan(place)))
        return write_number(out, row, columns != NULL && columns->places != NULL ? columns->places[column] : column);
    if (kind == CSV_ID)
        return out + snprintf(out, NUMBER_TEXT_SIZE, "%" PRId64,
                              columns->first_id + (int64_t)(row->index + (columns->ids_begin_anew ? 0 : row->first)));
    text_advance(text, out);
    cells_write(&columns->cells, kind, cell, row->curve, place, text);
    return text_reserve(text, (layout->column_count + 1) * (NUMBER_TEXT_SIZE + 1));
}

static void format_row(const csv_row *row, char flag, text_buffer *text)
{
    const csv_layout *layout = row->layout;
    size_t count = layout->column_count, cell = 0;
    char *out = text_reserve(text, (count + 1) * (NUMBER_TEXT_SIZE + 1));
    for (size_t j = 0; j < count && out != NULL; j++)
    {
        if (j == layout->corner)
        {
            *out++ = flag;
            *out++ = ',';
        }
        out = write_field(out, row, j, cell, text);
        bool is_cell = layout->columns != NULL && layout->columns->kinds != NULL &&
                       layout->columns->kinds[j] != CSV_NUMBER && layout->columns->kinds[j] != CSV_ID;
        cell += is_cell ? 1 : 0;
        if (out != NULL)
            *out++ = j + 1 < count || layout->corner == count ? ',' : '\n';
    }
    if (out != NULL && layout->corner == count)
    {
        *out++ = flag;
        *out++ = '\n';
    }
    if (out != NULL)
        text_advance(text, out); // else the sink reports the lack of memory
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
        if (!vector_is_finite(dim, point) || !vector_is_finite(channel_count, channels))
            return row_not_finite(span, i, error);
        double written[MAX_FORM_COLUMNS];
        if (layout->form != NULL)
            point_form_write(layout->form, point, written);
        csv_row row = {.layout = layout,
                       .point = point,
                       .numbers = layout->form != NULL ? written : point,
                       .channels = channels,
                       .curve = span->curve_index,
                       .index = i,
                       .first = span->first_row};
        if (layout->degrees)
            row.units = degrees_of_point(point, units_per_radian);
        format_row(&row, layout->corner != BAT_NO_INDEX && curve->corners[i] != 0 ? '1' : '0', text);
    }
    return BAT_OK;
}

bat_status csv_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    csv_layout layout = {0};
    text_buffer header = {0};
    bat_status status = choose_layout(set, options, &layout, error);
    if (status == BAT_OK)
        status = find_places(set, &layout, error);
    if (status == BAT_OK)
        write_header(&layout, set, &header);
    status = sink_take(sink, &header, status, error);
    if (status == BAT_OK)
        status = rows_write(set, sink, options->threads, format_rows, &layout, error);
    free(layout.places);
    free(layout.clocks);
    csv_columns_free(&layout.made);
    return status;
}

/// How a trajectory format writes a pose.
typedef struct pose_layout
{
    bat_curve_format format;
    const char *name, *header;
    char separator;
    size_t coordinates[7]; ///< those of a rigid motion in the order of a row
    bool matrix;           ///< 3 rows and 4 columns instead
    int time_decimals;     ///< of the unit of the times
    size_t time;           ///< the channel of the times; BAT_NO_INDEX: they are not written
    int64_t origin;        ///< of the times
} pose_layout;

/// Of a row of matrices.
#define MAX_POSE_NUMBERS 12

/// The numbers of a pose after its time. Returns their count.
static size_t pose_numbers(const pose_layout *layout, const double *point, double *numbers)
{
    double matrix[9];
    for (size_t j = 0; j < 7 && !layout->matrix; j++)
        numbers[j] = point[layout->coordinates[j]];
    if (!layout->matrix)
        return 7;
    bat_rotation_to_matrix(point + 3, matrix);
    for (size_t i = 0; i < 3; i++)
    {
        memcpy(numbers + 4 * i, matrix + 3 * i, 3 * sizeof *numbers);
        numbers[4 * i + 3] = point[i];
    }
    return MAX_POSE_NUMBERS;
}

static bat_status format_poses(const void *context, const row_span *span, text_buffer *text, bat_error *error)
{
    const pose_layout *layout = context;
    const bat_curve *curve = span->curve;
    for (size_t i = span->begin; i < span->end; i++)
    {
        double numbers[MAX_POSE_NUMBERS], time = 0;
        size_t count = pose_numbers(layout, curve->points + i * curve->space->point_dim, numbers);
        if (layout->time != BAT_NO_INDEX)
            time = curve->channels[i * curve->channel_count + layout->time];
        char *out = text_reserve(text, (1 + MAX_POSE_NUMBERS) * (NUMBER_TEXT_SIZE + 1));
        if (out == NULL)
            return BAT_OK; // the sink reports a lack of memory
        if (!isfinite(time) || !vector_is_finite(count, numbers))
            return row_not_finite(span, i, error);
        if (layout->time != BAT_NO_INDEX)
        {
            int64_t units;
            if (layout->time_decimals == EXACT_TIME_DECIMALS && !exact_time_nanoseconds(layout->origin, time, &units))
                return error_set(error, BAT_UNSUPPORTED, i, 0, "the time of point %zu is too large for nanoseconds", i);
            out = exact_time_write(out, layout->origin, layout->time_decimals, time);
            *out++ = layout->separator;
        }
        for (size_t j = 0; j < count; j++)
        {
            out = number_write(out, numbers[j]);
            *out++ = j + 1 < count ? layout->separator : '\n';
        }
        text_advance(text, out);
    }
    return BAT_OK;
}

/// The channel of the times, or BAT_NO_INDEX.
static size_t time_channel(const bat_curve_set *set)
{
    const bat_curve_attributes *attributes = set->attributes;
    if (attributes == NULL)
        return BAT_NO_INDEX;
    return attributes->channels.time < set->curves[0].channel_count ? attributes->channels.time : BAT_NO_INDEX;
}

static const pose_layout POSES[] = {
    {.format = BAT_CURVE_FORMAT_TUM,
     .name = "TUM",
     .header = "# timestamp tx ty tz qx qy qz qw\n",
     .separator = ' ',
     .coordinates = {0, 1, 2, 4, 5, 6, 3}},
    {.format = BAT_CURVE_FORMAT_EUROC,
     .name = "EuRoC",
     .header = "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n",
     .separator = ',',
     .coordinates = {0, 1, 2, 3, 4, 5, 6},
     .time_decimals = EXACT_TIME_DECIMALS},
    {.format = BAT_CURVE_FORMAT_KITTI, .name = "KITTI", .header = "", .separator = ' ', .matrix = true},
};

bat_status trajectory_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink,
                            bat_error *error)
{
    pose_layout layout = POSES[0];
    for (size_t i = 1; i < sizeof POSES / sizeof *POSES && layout.format != options->format; i++)
        layout = POSES[i];
    layout.time = layout.matrix ? BAT_NO_INDEX : time_channel(set);
    layout.origin = bat_curve_set_time_origin(set);
    if (set->attributes != NULL && set->attributes->format == options->format)
        layout.time_decimals = set->attributes->time_decimals;
    if (quaternion_place(set->space) != 3)
        return ERROR_UNSUPPORTED(error, 0, "a %s trajectory holds rigid motions, not the space %s", layout.name,
                                 set->space->name);
    if (set->count > 1)
        return error_set(error, BAT_UNSUPPORTED, 1, 0, "a %s trajectory is one curve, not %zu", layout.name, set->count);
    if (layout.time == BAT_NO_INDEX && !layout.matrix)
        return ERROR_UNSUPPORTED(error, 0, "a %s trajectory needs times, which these poses lack", layout.name);
    bat_status status = sink_format(sink, error, "%s", layout.header);
    return status == BAT_OK ? rows_write(set, sink, options->threads, format_poses, &layout, error) : status;
}
