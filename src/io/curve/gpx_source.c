#include "io/curve/gpx.h"

#include "io/common/time_text.h"

/// @file
/// Values of the points of GPX as columns.

void gpx_source_free(gpx_source *source)
{
    text_free(&source->frame);
    text_free(&source->tags);
    text_free(&source->contents);
    text_free(&source->texts);
    free(source->columns);
    free(source->curves);
    free(source->rows);
    free(source->values);
    free(source->point_rows);
    *source = (gpx_source){0};
}

size_t gpx_column_find(gpx_source *source, const char *key, size_t size, size_t own, const char *name)
{
    size_t at = source->tags.size, named = at + size, count = source->column_count;
    for (size_t i = 0; i < count; i++)
    {
        const gpx_column *column = &source->columns[i];
        if (column->tag.end - column->parents.begin == size &&
            memcmp(source->tags.data + column->parents.begin, key, size) == 0)
            return i;
    }
    if (count == GPX_MAX_COLUMNS)
        return BAT_NO_INDEX;
    const gpx_column column = {.parents = {at, at + own},
                               .tag = {at + own, named},
                               .name = {named, named + strlen(name)},
                               .index = count,
                               .direct = own == 0,
                               .kind = CSV_EMPTY};
    text_append(&source->tags, key, size);
    text_append_string(&source->tags, name);
    if (!ARRAY_ADD(source->columns, source->column_capacity, source->column_count, column))
        source->tags.failed = true;
    return source->tags.failed ? BAT_NO_INDEX : count;
}

double gpx_altitude(const gpx_source *source, size_t row)
{
    static const char name[] = "ele";
    const size_t size = sizeof name - 1;
    for (size_t i = source->rows[row].value; i < source->value_count; i++)
    {
        const gpx_column *column = &source->columns[source->values[i].column];
        const char *text = source->texts.data;
        double value;
        if (column->direct && column->name.end - column->name.begin == size &&
            memcmp(source->tags.data + column->name.begin, name, size) == 0)
            return number_read(text + source->values[i].text.begin, text + source->values[i].text.end, &value) == NULL
                       ? value
                       : NAN;
    }
    return NAN;
}

static bool is_among(const char *name, size_t size, const char *const *names, size_t count, size_t *place)
{
    for (*place = 0; *place < count; ++*place)
        if (strlen(names[*place]) == size && memcmp(names[*place], name, size) == 0)
            return true;
    return false;
}

size_t gpx_name_size(const char *tag, const char *end)
{
    const char *at = tag + 1;
    while (at < end && strchr(" \t\r\n/>", *at) == NULL)
        at++;
    return (size_t)(at - tag) - 1;
}

/// The place of a column's outermost element among the children of a point, as the schemas order them.
static int rank_of(const gpx_source *source, const gpx_column *column)
{
    static const char *const order[] = {"ele",  "time", "course", "speed",   "magvar",        "geoidheight", "name", "cmt",
                                        "desc", "src",  "url",    "urlname", "link",          "sym",         "type", "fix",
                                        "sat",  "hdop", "vdop",   "pdop",    "ageofdgpsdata", "dgpsid"};
    const char *tag = source->tags.data + column->parents.begin + 1;
    size_t size = gpx_name_size(tag - 1, source->tags.data + column->tag.end), place;
    const char *colon = memchr(tag, ':', size);
    size -= colon != NULL ? (size_t)(colon + 1 - tag) : 0;
    tag = colon != NULL ? colon + 1 : tag;
    (void)is_among(tag, size, order, sizeof order / sizeof *order, &place);
    return (int)place;
}

/// Whether there are no values between those of an element: texts and codes, and angles, which go around.
static bool is_discrete(const char *name)
{
    static const char *const texts[] = {"name", "cmt", "desc", "src", "url", "urlname", "sym", "type", "fix", "link"};
    size_t place;
    return name_is_code(name) || name_is_angle(name) ||
           is_among(name, strlen(name), texts, sizeof texts / sizeof *texts, &place);
}

static int compare_columns(const gpx_source *source, const gpx_column *a, const gpx_column *b)
{
    const char *tags = source->tags.data;
    size_t a_size = a->parents.end - a->parents.begin, b_size = b->parents.end - b->parents.begin;
    int order = a->rank - b->rank;
    if (order == 0)
        order = memcmp(tags + a->parents.begin, tags + b->parents.begin, a_size < b_size ? a_size : b_size);
    if (order == 0)
        order = (a_size > b_size) - (a_size < b_size);
    return order != 0 ? order : (a->index > b->index) - (a->index < b->index);
}

static int decimals_of(const char *begin, const char *end)
{
    const char *point = memchr(begin, '.', (size_t)(end - begin));
    int decimals = 0;
    while (point != NULL && ++point < end && *point >= '0' && *point <= '9')
        decimals++;
    return decimals;
}

/// The name of a column, in a buffer.
static const char *name_of(const gpx_source *source, const gpx_column *column, char name[NAME_BASE_SIZE])
{
    (void)snprintf(name, NAME_BASE_SIZE, "%.*s", (int)(column->name.end - column->name.begin),
                   source->tags.data + column->name.begin);
    return name;
}

/// Let a value decide the kind of its column.
static void take_kind(const gpx_source *source, gpx_column *column, const gpx_value *value)
{
    static const int MOST_DECIMALS = 9;
    const char *begin = source->texts.data + value->text.begin, *end = source->texts.data + value->text.end;
    iso_time time;
    double number;
    csv_kind kind = iso_time_read(begin, end, &time)           ? CSV_TIME
                    : number_read(begin, end, &number) == NULL ? CSV_GAPS
                                                               : CSV_TEXT;
    column->kind = column->kind == CSV_EMPTY || column->kind == kind ? kind : CSV_TEXT;
    int decimals = decimals_of(begin, end);
    decimals = decimals < MOST_DECIMALS ? decimals : MOST_DECIMALS;
    column->decimals = decimals > column->decimals ? decimals : column->decimals;
}

void gpx_columns_sort(gpx_source *source)
{
    static const int ALTITUDE_DECIMALS = 2;
    size_t places[GPX_MAX_COLUMNS];
    char name[NAME_BASE_SIZE];
    gpx_column *columns = source->columns;
    for (size_t i = 0; i < source->column_count; i++)
    {
        columns[i].rank = rank_of(source, &columns[i]);
        columns[i].decimals = columns[i].rank == 0 ? ALTITUDE_DECIMALS : 0;
        for (size_t k = i; k > 0 && compare_columns(source, &columns[k - 1], &columns[k]) > 0; k--)
            SWAP(columns[k], columns[k - 1]);
    }
    source->altitude = BAT_NO_INDEX;
    for (size_t i = 0; i < source->column_count; i++)
    {
        places[columns[i].index] = i;
        if (columns[i].rank == 0 && columns[i].direct)
            source->altitude = i;
    }
    for (size_t i = 0; i < source->value_count; i++)
    {
        source->values[i].column = places[source->values[i].column];
        take_kind(source, &columns[source->values[i].column], &source->values[i]);
    }
    for (size_t i = 0; i < source->column_count; i++)
        if (columns[i].kind == CSV_GAPS && is_discrete(name_of(source, &columns[i], name)))
            columns[i].kind = CSV_TEXT;
}

/// The value of a row in a column; empty for none.
static csv_field value_at(const gpx_source *source, size_t row, size_t column)
{
    for (size_t i = source->rows[row].value; i < source->rows[row + 1].value; i++)
        if (source->values[i].column == column)
            return (csv_field){source->texts.data + source->values[i].text.begin,
                               source->texts.data + source->values[i].text.end};
    return (csv_field){"", ""};
}

gpx_place gpx_place_of(const gpx_source *source, size_t curve, double place)
{
    const gpx_curve *of = &source->curves[curve];
    size_t points = (curve + 1 < source->curve_count ? of[1].point : source->point_count) - of->point;
    size_t k = (size_t)place < points ? (size_t)place : points - 1;
    const size_t *rows = source->point_rows + of->point;
    double share = place - (double)k;
    size_t end = of->row + of->row_count - of->returning;
    if (!(share > 0))
        return (gpx_place){rows[k], rows[k], 0};
    if (k + 1 < points)
        return (gpx_place){rows[k + 1] - 1, rows[k + 1], share};
    return (gpx_place){end - 1, of->returning ? end : rows[0], share};
}

void gpx_number_write(const gpx_column *column, double value, text_buffer *text)
{
    static const double LARGE = 1e8;
    if (fabs(value) < LARGE)
        text_append_fixed(text, "", llrint(value * (double)number_power_of_ten(column->decimals)), column->decimals);
    else
        text_append_real(text, "", value);
}

bool gpx_value_write(const gpx_source *source, size_t column, gpx_place place, text_buffer *text)
{
    const gpx_column *of = &source->columns[column];
    csv_field from = value_at(source, place.from, column), to = value_at(source, place.to, column);
    if (from.begin == from.end || (place.share > 0 && (to.begin == to.end || of->kind == CSV_TEXT)))
        return false;
    iso_time a, b;
    double first, second;
    if (place.share == 0)
        text_append(text, from.begin, (size_t)(from.end - from.begin));
    else if (of->kind == CSV_TIME && iso_time_read(from.begin, from.end, &a) && iso_time_read(to.begin, to.end, &b))
    {
        char *out = text_reserve(text, ISO_TIME_SIZE);
        int64_t step = llrint(place.share * (double)(b.nanoseconds - a.nanoseconds));
        if (out != NULL)
            text_advance(text, iso_time_write(out, &a, a.nanoseconds + step));
    }
    else if (number_read(from.begin, from.end, &first) == NULL && number_read(to.begin, to.end, &second) == NULL)
        gpx_number_write(of, (1 - place.share) * first + place.share * second, text);
    else
        return false;
    return true;
}

#define COORDINATES 2 ///< the first columns: longitude and latitude

/// Name the columns of a table: by the elements, with a number where names are equal. False when out of memory.
static bool name_columns(const gpx_source *source, csv_columns *columns)
{
    char names[COORDINATES + GPX_MAX_COLUMNS][NAME_BASE_SIZE + 4] = {"lon", "lat"};
    csv_field fields[COORDINATES + GPX_MAX_COLUMNS];
    size_t count = COORDINATES + source->column_count;
    for (size_t i = 0; i < count; i++)
    {
        char name[NAME_BASE_SIZE];
        size_t number = 1;
        if (i >= COORDINATES)
            (void)snprintf(names[i], sizeof names[i], "%s", name_of(source, &source->columns[i - COORDINATES], name));
        for (size_t k = 0; k < i; k++)
            if (strcmp(names[k], names[i]) == 0)
            {
                (void)snprintf(names[i], sizeof names[i], "%s_%zu", name, ++number);
                k = 0;
            }
        fields[i] = (csv_field){names[i], names[i] + strlen(names[i])};
    }
    return csv_columns_name(columns, fields, count);
}

/// Append a cell; a table has no line breaks in it.
static bool add_cell(cell_builder *cells, csv_field value, text_buffer *line)
{
    line->size = 0;
    text_append(line, value.begin, (size_t)(value.end - value.begin));
    for (size_t i = 0; i < line->size; i++)
        line->data[i] = strchr("\r\n", line->data[i]) != NULL ? ' ' : line->data[i];
    return !line->failed && cells_add(cells, (csv_field){line->data, line->data + line->size});
}

static bool fill_cells(const gpx_source *source, const curve_builder *builder, const csv_columns *columns,
                       cell_builder *cells)
{
    text_buffer line = {0};
    bool done = true;
    for (size_t i = 0; i < source->curve_count && done; i++)
    {
        for (size_t k = 0; k < builder->curves[i].count && done; k++, cells->row_count++)
            for (size_t j = 0; j < source->column_count && done; j++)
                if (columns->kinds[2 + j] != CSV_NUMBER)
                    done = add_cell(cells, value_at(source, source->point_rows[source->curves[i].point + k], j), &line);
        done = done && cells_end_curve(cells, builder->curves[i].closed);
    }
    text_free(&line);
    return done;
}

bat_curve_attributes *gpx_attributes_make(const gpx_source *source, const curve_builder *builder, bool altitude,
                                          bool degrees)
{
    bat_curve_attributes *attributes = csv_attributes_new(BAT_CURVE_FORMAT_GPX);
    csv_columns *columns = attributes != NULL ? attributes->csv : NULL;
    cell_builder cells = {0};
    size_t count = 2 + source->column_count;
    bool done = columns != NULL && name_columns(source, columns) && (columns->kinds = memory_array(count, 1)) != NULL;
    for (size_t i = 0; i < count && done; i++)
    {
        bool number = i < 2 || (altitude && i - 2 == source->altitude);
        columns->kinds[i] = number ? CSV_NUMBER : (unsigned char)source->columns[i - 2].kind;
        columns->other_count += number ? 0 : 1;
    }
    if (done)
    {
        columns->has_places = true;
        columns->degrees = degrees;
        columns->altitude = altitude ? 0 : BAT_NO_INDEX;
        cells.columns = columns->other_count;
        done = csv_columns_place(columns, (const size_t[]){0, 1}, 2) && fill_cells(source, builder, columns, &cells);
    }
    if (done)
    {
        cells_finish(&cells, &columns->cells);
        return attributes;
    }
    cells_free(&cells);
    attributes_release(attributes);
    return NULL;
}

const char *gpx_lost(const bat_curve_set *set, bat_curve_format format)
{
    const bat_curve_attributes *attributes = set->attributes;
    if (attributes == NULL || attributes->format != BAT_CURVE_FORMAT_GPX || format == BAT_CURVE_FORMAT_GPX)
        return NULL;
    const gpx_source *source = ((const geojson_document *)attributes->remainder.content)->gpx;
    bool geojson = attributes_are_geojson(&(bat_curve_attributes){.format = format}) && format < BAT_CURVE_FORMAT_OBJ;
    bool table = format == BAT_CURVE_FORMAT_CSV;
    bool values = source->column_count > (attributes->csv->altitude == BAT_NO_INDEX ? 0 : 1);
    if (geojson)
        return source->repeats > 0 ? "the values of points that repeat the one before them" : NULL;
    if (table)
        return "waypoints, and names and other values of tracks and routes";
    return values ? "times and other values of points" : NULL;
}

/// What writes the values of a column.
typedef struct property_writer
{
    const gpx_source *source;
    const bat_curve_set *set;
    size_t first, column;
    double **places; ///< of each curve of the shape
} property_writer;

static void write_value(const void *context, size_t curve, size_t index, double share, text_buffer *text)
{
    const property_writer *writer = context;
    const bat_curve *of = &writer->set->curves[writer->first + curve];
    double place = writer->places[curve][index];
    if (share > 0 && index + 1 < of->count)
        place += share * (writer->places[curve][index + 1] - place);
    text_buffer value = {0};
    if (!gpx_value_write(writer->source, writer->column, gpx_place_of(writer->source, writer->first + curve, place), &value))
        text_append_string(text, "null");
    else if (writer->source->columns[writer->column].kind == CSV_GAPS)
    {
        double number = 0;
        (void)number_read(value.data, value.data + value.size, &number);
        text_append_real(text, "", number);
    }
    else
        json_text_string(text, value.data, value.size);
    text->failed = text->failed || value.failed;
    text_free(&value);
}

/// Whether a point of some curves has a value.
static bool has_values(const gpx_source *source, size_t first, size_t count, size_t column)
{
    const gpx_curve *last = &source->curves[first + count - 1];
    size_t row = source->curves[first].row, end = last->row + last->row_count;
    for (size_t i = source->rows[row].value; i < source->rows[end].value; i++)
        if (source->values[i].column == column)
            return true;
    return false;
}

bool gpx_properties_write(const bat_curve_set *set, const geojson_shape *shape, size_t first, text_buffer *text)
{
    const bat_curve_attributes *attributes = set->attributes;
    const gpx_source *source = ((const geojson_document *)attributes->remainder.content)->gpx;
    size_t count = shape->curve_count, written = 0;
    property_writer writer = {source, set, first, 0, calloc(count + 1, sizeof *writer.places)};
    bool done = writer.places != NULL;
    for (size_t i = 0; i < count && done; i++)
    {
        writer.places[i] = memory_array(set->curves[first + i].count, sizeof(double));
        done = writer.places[i] != NULL;
        if (done)
            cells_places(&attributes->csv->cells, &set->curves[first + i], first + i, writer.places[i]);
    }
    text_append_string(text, "{");
    for (writer.column = 0; writer.column < source->column_count && done; writer.column++)
    {
        const char *name = attributes->csv->names[2 + writer.column];
        if ((writer.column == source->altitude && shape->value_count > 0) ||
            !has_values(source, first, count, writer.column))
            continue;
        name = strcmp(name, "time") == 0 ? "times" : name;
        text_append_string(text, written++ > 0 ? "," : "");
        json_text_string(text, name, strlen(name));
        text_append_string(text, ":");
        geojson_shape_values(shape, write_value, &writer, text);
    }
    text_append_string(text, "}");
    for (size_t i = 0; i < count && writer.places != NULL; i++)
        free(writer.places[i]);
    free(writer.places);
    return done;
}
