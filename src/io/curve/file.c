#include "base/atomic_file.h"
#include "base/choice.h"
#include "base/option.h"
#include "io/curve/gpx.h"
#include "io/gis/gis.h"

/// @file
/// Reading and writing of curve sets in any format, from files and from memory.

typedef struct curve_format
{
    bat_choice choice;
    curve_reader *read;
    curve_writer *write;
    const char *drivers; ///< without a reader: those of GDAL, as gis_read() takes them; null for all
    unsigned holds;      ///< what a file of the format can hold
} curve_format;

/// What a format can hold beside lines and polygons.
enum
{
    HOLDS_IDS = 1,
    HOLDS_PROPERTIES = 2,
    HOLDS_OTHERS = 4, ///< points, and features without lines and polygons
    HOLDS_ALTITUDES = 8,
    HOLDS_MEASURES = 16,
    HOLDS_FEATURES = HOLDS_IDS | HOLDS_PROPERTIES | HOLDS_OTHERS | HOLDS_ALTITUDES,
    HOLDS_TEXTS = 32, ///< of points
    HOLDS_NUMBERS = 64,
    HOLDS_BESIDE = 128, ///< measures, beside altitudes alone
    HOLDS_TRACKS = 256  ///< columns, beside longitude and latitude alone
};

/// A row of a format that is read and written, and how.
#define FORMAT_ROW(name, value, endings, summary, ...)                                                                      \
    {                                                                                                                       \
        .choice = CHOICE_FORMAT(name, summary, endings, value), __VA_ARGS__                                                 \
    }

static const curve_format FORMATS[] = {
    {.choice = CHOICE_OF_USE(UNLISTED, "auto", "by the file's ending", BAT_CURVE_FORMAT_AUTO)},
    FORMAT_ROW("csv", BAT_CURVE_FORMAT_CSV, ".csv .tsv .txt",
               "curves: a row of numbers for each point, with or without names of columns", .read = csv_read,
               .write = csv_write, .holds = HOLDS_ALTITUDES | HOLDS_MEASURES | HOLDS_TEXTS | HOLDS_NUMBERS),
    FORMAT_ROW("geojson", BAT_CURVE_FORMAT_GEOJSON, ".geojson .json",
               "curves: lines and polygons of longitude and latitude in degrees, with their properties",
               .read = geojson_read, .write = geojson_write, .holds = HOLDS_FEATURES | HOLDS_BESIDE),
    FORMAT_ROW("geojsonl", BAT_CURVE_FORMAT_GEOJSON_LINES, ".geojsonl .ndjson .jsonl",
               "curves: GeoJSON, a feature on each line", .read = geojson_sequence_read, .write = geojson_write,
               .holds = HOLDS_FEATURES | HOLDS_BESIDE),
    FORMAT_ROW("geojsonseq", BAT_CURVE_FORMAT_GEOJSON_SEQUENCE, ".geojsons",
               "curves: GeoJSON text sequences (RFC 8142), a feature after each record separator",
               .read = geojson_sequence_read, .write = geojson_write, .holds = HOLDS_FEATURES | HOLDS_BESIDE),
    FORMAT_ROW("obj", BAT_CURVE_FORMAT_OBJ, ".obj", "curves: line elements", .read = obj_read, .write = obj_write),
    FORMAT_ROW("gpx", BAT_CURVE_FORMAT_GPX, ".gpx",
               "curves: tracks and routes of GPX, with times and other values of points", .read = gpx_read,
               .write = gpx_write, .holds = HOLDS_FEATURES | HOLDS_TRACKS),
    FORMAT_ROW("wkt", BAT_CURVE_FORMAT_WKT, ".wkt .ewkt", "curves: well-known text, a geometry after the other",
               .read = wkt_read, .write = wkt_write, .holds = HOLDS_OTHERS | HOLDS_ALTITUDES | HOLDS_MEASURES),
    FORMAT_ROW("wkt-csv", BAT_CURVE_FORMAT_WKT_CSV, NULL,
               "curves: CSV with a column of well-known text or binary, and attributes", .read = wkt_table_read,
               .write = wkt_table_write, .holds = HOLDS_FEATURES | HOLDS_MEASURES),
    FORMAT_ROW("topojson", BAT_CURVE_FORMAT_TOPOJSON, ".topojson", "curves: TopoJSON, shared borders stored once",
               .read = topojson_read, .write = topojson_write, .holds = HOLDS_FEATURES | HOLDS_BESIDE),
    FORMAT_ROW("tum", BAT_CURVE_FORMAT_TUM, ".tum", "motions: poses in time, timestamp tx ty tz qx qy qz qw",
               .read = csv_read, .write = trajectory_write, .holds = HOLDS_NUMBERS),
    FORMAT_ROW("euroc", BAT_CURVE_FORMAT_EUROC, NULL,
               "motions: poses in time, #timestamp [ns], position, quaternion w x y z", .read = trajectory_read,
               .write = trajectory_write, .holds = HOLDS_NUMBERS),
    FORMAT_ROW("kitti", BAT_CURVE_FORMAT_KITTI, NULL, "motions: poses without times, 12 numbers of a 3x4 matrix",
               .read = trajectory_read, .write = trajectory_write),
    FORMAT_ROW("bvh", BAT_CURVE_FORMAT_BVH, ".bvh", "motions: joints of motion capture", .read = trajectory_read),
    // By GDAL.
    FORMAT_ROW("gpkg", BAT_CURVE_FORMAT_GPKG, ".gpkg", "curves: GeoPackage, by GDAL", .drivers = "GPKG",
               .holds = HOLDS_FEATURES | HOLDS_MEASURES),
    FORMAT_ROW("shp", BAT_CURVE_FORMAT_SHP, ".shp", "curves: Shapefile, by GDAL", .drivers = "ESRI Shapefile",
               .holds = HOLDS_FEATURES | HOLDS_MEASURES),
    // The last driver that knows the ending writes: LIBKML's time grows with the square of the size.
    FORMAT_ROW("kml", BAT_CURVE_FORMAT_KML, ".kml .kmz", "curves: KML, by GDAL", .drivers = "LIBKML,KML",
               .holds = HOLDS_FEATURES),
    FORMAT_ROW("fgb", BAT_CURVE_FORMAT_FGB, ".fgb", "curves: FlatGeobuf, by GDAL", .drivers = "FlatGeobuf",
               .holds = HOLDS_FEATURES | HOLDS_MEASURES),
    FORMAT_ROW("dxf", BAT_CURVE_FORMAT_DXF, ".dxf", "curves: drawings in DXF, by GDAL", .drivers = "DXF",
               .holds = HOLDS_OTHERS | HOLDS_ALTITUDES),
    FORMAT_ROW("gdal", BAT_CURVE_FORMAT_GDAL, ".zip", "curves: any vector format of GDAL, also remote or packed",
               .drivers = NULL, .holds = HOLDS_FEATURES | HOLDS_MEASURES),
};

/// The row of a path that only GDAL opens: of the ending before ".gz", else that of GDAL.
static const bat_choice *row_of_virtual_path(const char *path)
{
    if (!gis_is_virtual(path))
        return NULL;
    const char *dot = strrchr(path, '.');
    bool packed = dot != NULL && strcasecmp(dot, ".gz") == 0;
    char *inner = packed ? strndup(path, (size_t)(dot - path)) : NULL;
    const bat_choice *row = choice_of_ending(&bat_curve_format_family, inner != NULL ? inner : path);
    free(inner);
    return row != NULL ? row : choice_of_value(&bat_curve_format_family, BAT_CURVE_FORMAT_GDAL);
}

const bat_family bat_curve_format_family = FAMILY_OF_PATHS("curve format", FORMATS, row_of_virtual_path);

/// The row of a format other than BAT_CURVE_FORMAT_AUTO.
static const curve_format *row_of(bat_curve_format format)
{
    return (const curve_format *)(const void *)choice_of_value(&bat_curve_format_family, (int)format);
}

/// The format of a file's ending; BAT_CURVE_FORMAT_AUTO for a name without one.
static bat_status format_for_path(const char *path, bool writes, bat_curve_format *format, bat_error *error)
{
    const bat_choice *row;
    bat_status status = bat_choice_of_path(&bat_curve_format_family, path, writes, &row, error);
    if (status == BAT_OK)
        *format = row != NULL ? (bat_curve_format)row->value : BAT_CURVE_FORMAT_AUTO;
    return status;
}

/// The format of a text: GeoJSON begins with a brace, GPX with a tag, OBJ with a statement; all others are CSV.
static bat_curve_format format_of_text(const file_text *text)
{
    text_line line = text_line_start(text);
    while (text_line_next(text, &line))
    {
        size_t length = (size_t)(line.end - line.begin);
        if (length == 0 || *line.begin == '#')
            continue;
        if (*line.begin == '<')
            return BAT_CURVE_FORMAT_GPX;
        if (*line.begin == '{' || *line.begin == RECORD_SEPARATOR)
            return BAT_CURVE_FORMAT_GEOJSON;
        static const char *const statements[] = {"v ", "vn ", "vt ", "l ", "o ", "g ", "s ", "mtllib ", "usemtl "};
        for (size_t i = 0; i < sizeof statements / sizeof *statements; i++)
        {
            size_t size = strlen(statements[i]);
            if (length > size && memcmp(line.begin, statements[i], size) == 0)
                return BAT_CURVE_FORMAT_OBJ;
        }
        break;
    }
    return BAT_CURVE_FORMAT_CSV;
}

bat_curve_read_options bat_curve_read_defaults(void)
{
    return (bat_curve_read_options){.format = BAT_CURVE_FORMAT_AUTO, .closed = -1};
}

bat_curve_write_options bat_curve_write_defaults(void)
{
    return (bat_curve_write_options){.format = BAT_CURVE_FORMAT_AUTO, .precision = 10};
}

static const bat_choice TIME_UNITS[] = {
    CHOICE("auto", "by the name of the column, else by the size of the first time", BAT_TIME_UNIT_AUTO),
    CHOICE("seconds", "seconds", BAT_TIME_UNIT_SECONDS),
    CHOICE("milliseconds", "thousandths of seconds", BAT_TIME_UNIT_MILLISECONDS),
    CHOICE("microseconds", "millionths of seconds", BAT_TIME_UNIT_MICROSECONDS),
    CHOICE("nanoseconds", "billionths of seconds", BAT_TIME_UNIT_NANOSECONDS),
};
const bat_family bat_time_unit_family = FAMILY("unit of time", TIME_UNITS);

static const option_field READ_FIELDS[] = {
    OPTION_FAMILY(bat_curve_read_options, format, bat_curve_format_family),
    OPTION_FAMILY(bat_curve_read_options, time_unit, bat_time_unit_family),
    OPTION_FIELD(bat_curve_read_options, closed, OPTION_INT, -1, 1),
    OPTION_FIELD(bat_curve_read_options, translation_weight, OPTION_NUMBER, 0, INFINITY),
    OPTION_THREADS(bat_curve_read_options),
};

static bat_status curve_read_options_check(const void *opaque, bat_error *error)
{
    const bat_curve_read_options *options = opaque;
    const char *fault = poses_euler_fault(options->euler);
    return fault == NULL ? BAT_OK : ERROR_ARGUMENT(error, "%s", fault);
}

const bat_options_table bat_curve_read_fields = OPTIONS_TABLE(bat_curve_read_options, READ_FIELDS, curve_read_options_check);

static const option_field WRITE_FIELDS[] = {
    OPTION_FAMILY(bat_curve_write_options, format, bat_curve_format_family),
    OPTION_FIELD(bat_curve_write_options, precision, OPTION_INT, 0, DEGREE_MAX_DECIMALS),
    OPTION_THREADS(bat_curve_write_options),
};

const bat_options_table bat_curve_write_fields = OPTIONS_TABLE(bat_curve_write_options, WRITE_FIELDS, NULL);

/// Whether a format has what the options name.
static bat_status check_format_options(bat_curve_format format, const bat_curve_read_options *options, bat_error *error)
{
    const char *name = bat_choice_name(&bat_curve_format_family, (int)format);
    if (format != BAT_CURVE_FORMAT_CSV && (options->columns != NULL || options->group != NULL))
        return ERROR_ARGUMENT(error, "only CSV has %s, not the format %s",
                              options->columns != NULL ? "columns" : "a column to group by", name);
    if (row_of(format)->read != NULL && options->layer != NULL && format != BAT_CURVE_FORMAT_TOPOJSON)
        return ERROR_ARGUMENT(error, "only TopoJSON and formats of GDAL have layers, not the format %s", name);
    return BAT_OK;
}

static bat_status read_format(const file_text *text, bat_curve_format format, const bat_curve_read_options *options,
                              bat_curve_set *set, bat_error *error)
{
    if (format == BAT_CURVE_FORMAT_AUTO)
        format = format_of_text(text);
    bool table = false, taken = false, named = options->format != BAT_CURVE_FORMAT_AUTO;
    bool chosen_columns = options->columns != NULL || options->group != NULL;
    bat_status told = format == BAT_CURVE_FORMAT_CSV && !chosen_columns ? wkt_is_table(text, &table, error) : BAT_OK;
    if (told != BAT_OK)
        return told;
    format = table ? BAT_CURVE_FORMAT_WKT_CSV : format;
    // Poses tell themselves by their content, where nobody names the format.
    if (format == BAT_CURVE_FORMAT_CSV && options->layer == NULL)
    {
        bat_status status =
            poses_read(text, named ? BAT_CURVE_FORMAT_CSV : BAT_CURVE_FORMAT_AUTO, options, set, &taken, error);
        if (taken)
            return status;
    }
    if (options->key_times != NULL && format != BAT_CURVE_FORMAT_KITTI)
        return error_option(error, "key_times", "go with KITTI poses, not the format %s",
                            bat_choice_name(&bat_curve_format_family, (int)format));
    if (format == BAT_CURVE_FORMAT_GEOJSON && !named &&
        geojson_text_has_type(text->data, text->data + text->size, "Topology"))
        format = BAT_CURVE_FORMAT_TOPOJSON;
    if (format == BAT_CURVE_FORMAT_GEOJSON && geojson_is_sequence(text->data, text->size))
        format = BAT_CURVE_FORMAT_GEOJSON_LINES;
    if (row_of(format)->read == NULL)
        return ERROR_UNSUPPORTED(error, 0, "the format %s is read from files alone",
                                 bat_choice_name(&bat_curve_format_family, (int)format));
    bat_status status = check_format_options(format, options, error);
    bat_curve_read_options chosen = *options;
    chosen.format = format;
    return status == BAT_OK ? row_of(format)->read(text, &chosen, set, error) : status;
}

/// Read a file, or `size` bytes where the path is null.
static bat_status read_set(const char *path, const char *bytes, size_t size, const bat_curve_read_options *options,
                           bat_curve_set *set, bat_error *error)
{
    bat_curve_read_options defaults = bat_curve_read_defaults();
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_curve_read_fields, options, error);
    bat_curve_format format = options->format;
    if (status == BAT_OK && path != NULL && format == BAT_CURVE_FORMAT_AUTO)
        status = format_for_path(path, false, &format, error);
    if (status != BAT_OK)
        return status;
    bat_curve_set made;
    if (path != NULL && format != BAT_CURVE_FORMAT_AUTO && row_of(format)->read == NULL)
    {
        status = check_format_options(format, options, error);
        if (status == BAT_OK)
            status = gis_read(path, row_of(format)->drivers, options, &made, error);
    }
    else
    {
        file_text text = {0};
        status = path == NULL           ? file_text_copy(bytes, size, &options->limits, &text, error)
                 : gis_is_virtual(path) ? gis_text_read(path, &options->limits, &text, error)
                                        : file_text_read(path, &options->limits, &text, error);
        if (status == BAT_OK)
            status = read_format(&text, format, options, &made, error);
        file_text_free(&text);
    }
    if (status != BAT_OK)
        return status;
    status = options->on_sphere ? gis_to_sphere(&made, error) : BAT_OK;
    if (status != BAT_OK)
    {
        bat_curve_set_free(&made);
        return status;
    }
    *set = made;
    if (options->translation_weight > 0)
        set->space->weight = options->translation_weight;
    return BAT_OK;
}

bat_status bat_curve_read(const char *path, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    return read_set(path, NULL, 0, options, set, error);
}

bat_status bat_curve_read_memory(const char *text, size_t size, const bat_curve_read_options *options, bat_curve_set *set,
                                 bat_error *error)
{
    return read_set(NULL, text, size, options, set, error);
}

/// Check what is to be written and begin its report.
static bat_status check_write(const bat_curve_set *set, const bat_curve_write_options *options, bat_error *error)
{
    bat_status status = bat_options_check(&bat_curve_write_fields, options, error);
    if (options->report != NULL)
        *options->report = (bat_curve_write_report){.first_left_out = BAT_NO_INDEX};
    if (status != BAT_OK)
        return status;
    if (options->crs != NULL && options->crs[0] == '\0')
        return error_option(error, "crs", "must not be empty");
    if (set->count == 0)
        return ERROR_ARGUMENT(error, "there are no curves to write");
    for (size_t i = 0; i < set->count; i++)
        if (set->curves[i].count == 0)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "curve %zu has no points", i);
    return BAT_OK;
}

/// The format for a path. A .txt file has the format of the input, if that was of TUM or KITTI, and a .csv file that of
/// EuRoC or of a table of well-known text.
static bat_status format_of_output(const char *path, const bat_curve_attributes *attributes, bat_curve_format *format,
                                   bat_error *error)
{
    bat_status status = format_for_path(path, true, format, error);
    const char *dot = strrchr(path, '.');
    bool text = dot != NULL && strcasecmp(dot, ".txt") == 0, table = dot != NULL && strcasecmp(dot, ".csv") == 0;
    bat_curve_format given = attributes != NULL ? attributes->format : BAT_CURVE_FORMAT_AUTO;
    bool kept = (text && (given == BAT_CURVE_FORMAT_TUM || given == BAT_CURVE_FORMAT_KITTI)) ||
                (table && given == BAT_CURVE_FORMAT_EUROC) ||
                (*format == BAT_CURVE_FORMAT_CSV && given == BAT_CURVE_FORMAT_WKT_CSV);
    if (status == BAT_OK && kept)
        *format = given;
    return status;
}

bat_status curve_format_choose(const char *path, const bat_curve_attributes *attributes,
                               const bat_curve_write_options *options, bat_curve_format *format, bat_error *error)
{
    *format = options->format;
    bool by_path = *format == BAT_CURVE_FORMAT_AUTO && path != NULL;
    bat_status status = by_path ? format_of_output(path, attributes, format, error) : BAT_OK;
    if (status != BAT_OK)
        return status;
    if (*format == BAT_CURVE_FORMAT_AUTO && attributes != NULL)
        *format = attributes->format;
    return *format == BAT_CURVE_FORMAT_AUTO ? choice_unnamed_output(&bat_curve_format_family, error) : BAT_OK;
}

/// What a document has, in the bits of what formats hold, but for its altitudes and measures.
static unsigned features_have(const geojson_document *document)
{
    unsigned has = 0;
    for (size_t i = 0; i < document->feature_count; i++)
    {
        const geojson_feature *feature = &document->features[i];
        const json_t *geometry = json_object_get(feature->tree, "geometry");
        const json_t *members = json_object_get(geometry != NULL ? geometry : feature->tree, "geometries");
        has |= json_object_get(feature->tree, "id") != NULL ? HOLDS_IDS : 0U;
        has |= json_object_size(json_object_get(feature->tree, "properties")) > 0 ? HOLDS_PROPERTIES : 0U;
        has |= feature->curve_count == 0 || json_array_size(members) > feature->geometry_count ? HOLDS_OTHERS : 0U;
    }
    return has;
}

/// The words for all choices of ids, properties and other features.
#define LOST(first, comma)                                                                                                  \
    first, first comma "ids", first comma "properties", first comma "ids, properties", first comma OTHERS,                  \
        first comma "ids, " OTHERS, first comma "properties, " OTHERS, first comma "ids, properties, " OTHERS
#define OTHERS "points and other features"

/// What of a file another format cannot hold, in words; null for nothing.
static const char *lost_of(const bat_curve_set *set, const curve_format *row)
{
    static const char *const of_features[] = {LOST("", ""), LOST("altitudes", ", "), LOST("measures", ", "),
                                              LOST("altitudes, measures", ", ")};
    static const char *const of_columns[] = {NULL, "columns of texts", "times and other numbers of points",
                                             "columns of texts, times and other numbers of points"};
    const bat_curve_attributes *attributes = set->attributes;
    const char *of_gpx = gpx_lost(set, (bat_curve_format)row->choice.value);
    if (attributes == NULL || of_gpx != NULL)
        return of_gpx;
    const csv_columns *csv = attributes->csv;
    const geojson_document *document = attributes_are_geojson(attributes) ? attributes->remainder.content : NULL;
    size_t most = 0, places = csv != NULL && csv->has_places ? CSV_PLACE_CHANNELS : 0;
    unsigned has = 0, holds = row->holds;
    if (attributes->degrees && (holds & HOLDS_TRACKS) != 0)
        holds |= HOLDS_TEXTS | HOLDS_NUMBERS;
    for (size_t i = 0; i < set->count; i++)
        most = set->curves[i].channel_count > most + places ? set->curves[i].channel_count - places : most;
    if (document != NULL)
    {
        has = features_have(document) | (document->measures || most > 1 ? HOLDS_MEASURES : 0U);
        has |= most > (document->measures ? 1 : 0) ? HOLDS_ALTITUDES : 0U;
        holds |= !document->measures && (holds & HOLDS_BESIDE) != 0 ? HOLDS_MEASURES : 0U;
        return (has & ~holds) != 0 ? of_features[has & ~holds] : NULL;
    }
    bool altitude = csv != NULL && csv->altitude < most && (holds & HOLDS_ALTITUDES) != 0;
    has = most > altitude ? HOLDS_NUMBERS : 0U;
    for (size_t i = 0; csv != NULL && csv->kinds != NULL && i < csv->count; i++)
    {
        csv_kind kind = (csv_kind)csv->kinds[i];
        has |= kind == CSV_TEXT || kind == CSV_GROUP ? HOLDS_TEXTS : 0U;
        has |= kind == CSV_TIME || kind == CSV_GAPS ? HOLDS_NUMBERS : 0U;
    }
    return of_columns[(has & ~holds) / HOLDS_TEXTS];
}

/// Write a set to a file, or to `memory` where the path is null or one of a compressed file.
static bat_status write_set(const char *path, const bat_curve_set *set, const bat_curve_write_options *options,
                            text_buffer *memory, bat_error *error)
{
    bat_curve_write_options chosen = options != NULL ? *options : bat_curve_write_defaults();
    if (set->attributes != NULL && set->attributes->on_sphere && set->space->point_dim == 3)
    {
        bat_curve_set plane;
        bat_status moved = gis_transform(set, set->attributes->crs, GIS_PLANE, &plane, error);
        if (moved != BAT_OK)
            return moved;
        moved = write_set(path, &plane, options, memory, error);
        bat_curve_set_free(&plane);
        return moved;
    }
    bat_status status = check_write(set, &chosen, error);
    if (status == BAT_OK)
        status = curve_format_choose(path, set->attributes, &chosen, &chosen.format, error);
    if (status != BAT_OK)
        return status;
    const curve_format *row = row_of(chosen.format);
    if (chosen.report != NULL)
        chosen.report->lost = lost_of(set, row);
    if (row->write == NULL && row->read != NULL)
        return ERROR_UNSUPPORTED(error, 0, "%s is read only", row->choice.name);
    if (row->write == NULL && path == NULL)
        return ERROR_UNSUPPORTED(error, 0, "the format %s is written to files alone", row->choice.name);
    if (row->write == NULL)
        return gis_write(path, row->drivers, set, &chosen, error);
    if (path == NULL || gis_is_virtual(path))
    {
        text_sink sink = {.buffer = memory};
        status = row->write(set, &chosen, &sink, error);
        text_append(memory, "", 1);
        return status == BAT_OK && memory->failed ? error_memory(error, memory->size) : status;
    }
    atomic_file file;
    status = atomic_file_begin(path, &file, error);
    if (status != BAT_OK)
        return status;
    text_sink sink = {.stream = file.stream};
    status = row->write(set, &chosen, &sink, error);
    return atomic_file_end(&file, status, error);
}

bat_status bat_curve_write(const char *path, const bat_curve_set *set, const bat_curve_write_options *options,
                           bat_error *error)
{
    text_buffer text = {0};
    bat_status status = write_set(path, set, options, &text, error);
    if (status == BAT_OK && text.size > 0)
    {
        text.size--; // without the final zero
        status = gis_text_write(path, &text, error);
    }
    text_free(&text);
    return status;
}

bat_status bat_curve_write_memory(const bat_curve_set *set, const bat_curve_write_options *options, char **text,
                                  size_t *size, bat_error *error)
{
    text_buffer buffer = {0};
    bat_status status = write_set(NULL, set, options, &buffer, error);
    if (status != BAT_OK)
    {
        text_free(&buffer);
        return status;
    }
    *text = buffer.data;
    *size = buffer.size - 1;
    return BAT_OK;
}
