#include "base/threads.h"
#include "io/curve/formats.h"
#include "io/curve/geojson.h"

#include <math.h>
#include <strings.h>

/// @file
/// Reader of GeoJSON (RFC 7946). A feature collection is split into the texts of its features, which threads read in
/// parallel.

/// A feature collection, split into the texts of its features.
typedef struct feature_split
{
    feature_text *features;
    size_t count, capacity;
    size_t before;   ///< the number of features before these, for messages
    bool geometries; ///< a geometry may stand in place of a feature
    char *frame;     ///< the text without the content of "features", except for its line breaks
    size_t frame_size;
} feature_split;

/// Advance to the opening bracket of the features.
static bool find_features(json_scanner *scan)
{
    json_scanner key;
    if (!json_scan_take(scan, '{'))
        return false;
    do
    {
        if (!json_scan_key(scan, &key))
            return false;
        if (json_scan_is(&key, "features"))
            return json_scan_at(scan, '[');
        if (!json_scan_value(scan))
            return false;
    } while (json_scan_take(scan, ','));
    return false;
}

/// Collect the features, from the opening bracket to the closing one.
static bool collect_features(const file_text *text, json_scanner *scan, feature_split *split)
{
    const char *counted = text->data;
    size_t line = 1;
    (void)json_scan_take(scan, '[');
    if (json_scan_at(scan, ']'))
        return true;
    do
    {
        if (!json_scan_at(scan, '{'))
            return false;
        feature_text feature = {.begin = scan->at};
        line += json_scan_newlines(counted, scan->at);
        counted = scan->at;
        feature.line = line;
        bool ended = json_scan_value(scan);
        feature.end = scan->at;
        if (!ended || !ARRAY_ADD(split->features, split->capacity, split->count, feature))
            return false;
    } while (json_scan_take(scan, ','));
    return json_scan_at(scan, ']');
}

static bool make_frame(const file_text *text, const char *open, const char *close, feature_split *split)
{
    text_buffer frame = {0};
    text_append(&frame, text->data, (size_t)(open + 1 - text->data));
    size_t newlines = json_scan_newlines(open, close);
    char *out = text_reserve(&frame, newlines);
    if (out != NULL)
    {
        memset(out, '\n', newlines);
        text_advance(&frame, out + newlines);
    }
    text_append(&frame, close, (size_t)(text->data + text->size - close));
    split->frame = frame.data;
    split->frame_size = frame.size;
    return !frame.failed;
}

static void split_free(feature_split *split)
{
    free(split->features);
    free(split->frame);
    *split = (feature_split){0};
}

/// Split a text. Only brackets, quotes and commas are examined; the parser checks each part. False when the text is not a
/// feature collection in the usual spelling, or out of memory; parse the whole text then.
static bool split_text(const file_text *text, feature_split *split)
{
    *split = (feature_split){0};
    json_scanner scan = {text->data, text->data + text->size};
    if (find_features(&scan))
    {
        const char *open = scan.at;
        if (collect_features(text, &scan, split) && make_frame(text, open, scan.at, split))
            return true;
    }
    split_free(split);
    return false;
}

/// The features first, …, end - 1, read by one thread.
typedef struct feature_batch
{
    size_t first, end;
    geojson_reader reader;
    bat_error error;
    bat_status status;
} feature_batch;

static void read_batch(feature_batch *batch, const feature_split *split)
{
    geojson_reader *reader = &batch->reader;
    reader->error = &batch->error;
    for (size_t i = batch->first; i < batch->end && batch->status == BAT_OK; i++)
    {
        const feature_text *feature = &split->features[i];
        reader->place.feature = split->before + i;
        reader->place.line = feature->line;
        json_t *tree = geojson_parse(reader, feature->begin, feature->end, feature->line);
        bool bare = split->geometries && !geojson_has_type(tree, "Feature");
        batch->status = tree != NULL ? geojson_read_feature(reader, tree, bare) : batch->error.status;
    }
}

static void add_count(size_t *count, size_t part, char *first, const char *part_first, size_t size)
{
    if (*count == 0 && part > 0)
        memcpy(first, part_first, size);
    *count += part;
}

static void add_findings(geojson_findings *sum, const geojson_findings *part)
{
    const size_t size = sizeof sum->first_repeat;
    size_t joins = sum->lines.joins + sum->polygons.joins, poles = sum->polygons.poles;
    add_count(&sum->repeats, part->repeats, sum->first_repeat, part->first_repeat, size);
    add_count(&sum->degenerate, part->degenerate, sum->first_degenerate, part->first_degenerate, size);
    add_count(&sum->unchanged, part->unchanged, sum->first_unchanged, part->first_unchanged, size);
    add_count(&sum->wide, part->wide, sum->first_wide, part->first_wide, size);
    add_count(&joins, part->lines.joins + part->polygons.joins, sum->first_join, part->first_join, size);
    add_count(&poles, part->polygons.poles, sum->first_pole, part->first_pole, size);
    stitch_report_add(&sum->lines, &part->lines);
    stitch_report_add(&sum->polygons, &part->polygons);
}

/// Append the curves and features of a batch to a reader.
static bool append_batch(geojson_reader *reader, geojson_reader *batch)
{
    geojson_document *document = &reader->document;
    geojson_document *part = &batch->document;
    if (!ARRAY_GROW(document->features, document->feature_capacity, document->feature_count + part->feature_count) ||
        !ARRAY_GROW(document->geometries, document->geometry_capacity, document->geometry_count + part->geometry_count) ||
        !geojson_document_reserve(document, document->polygon_count + part->polygon_count,
                                  document->curve_count + part->curve_count))
        return false;
    for (size_t i = 0; i < part->feature_count; i++)
    {
        geojson_feature feature = part->features[i];
        feature.curve += reader->builder.curve_count;
        feature.geometry += document->geometry_count;
        feature.polygon += document->polygon_count;
        document->features[document->feature_count + i] = feature;
    }
    if (part->geometry_count > 0)
        memcpy(document->geometries + document->geometry_count, part->geometries,
               part->geometry_count * sizeof *part->geometries);
    if (part->polygon_count > 0)
        memcpy(document->polygons + document->polygon_count, part->polygons, part->polygon_count * sizeof *part->polygons);
    if (part->curve_count > 0)
        memcpy(document->origins + document->curve_count, part->origins, part->curve_count * sizeof *part->origins);
    document->curve_count += part->curve_count;
    document->feature_count += part->feature_count;
    document->geometry_count += part->geometry_count;
    document->polygon_count += part->polygon_count;
    part->feature_count = 0;
    add_findings(&reader->findings, &batch->findings);
    return builder_append(&reader->builder, &batch->builder);
}

static size_t feature_size(const void *context, size_t feature)
{
    const feature_split *split = context;
    return (size_t)(split->features[feature].end - split->features[feature].begin);
}

static bat_status read_batches(geojson_reader *reader, const feature_split *split, feature_batch *batches, size_t count,
                               int threads)
{
    (void)threads; // unused without OpenMP
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads_for(threads, count))
    for (size_t i = 0; i < count; i++)
        read_batch(&batches[i], split);
    for (size_t i = 0; i < count; i++)
    {
        if (batches[i].status != BAT_OK)
        {
            if (reader->error != NULL)
                *reader->error = batches[i].error;
            return batches[i].status;
        }
        if (!append_batch(reader, &batches[i].reader))
            return error_memory(reader->error, split->count * sizeof(geojson_feature));
    }
    return BAT_OK;
}

static bat_status read_split(geojson_reader *reader, const feature_split *split, const bat_curve_read_options *options)
{
    static const int BATCH_BYTES = 1 << 18;
    block_cut cut;
    bat_status status = blocks_cut(split->count, feature_size, split, BATCH_BYTES, &cut, reader->error);
    if (status != BAT_OK)
        return status;
    feature_batch *batches = memory_array(cut.count, sizeof *batches);
    if (batches == NULL)
    {
        free(cut.starts);
        return error_memory(reader->error, cut.count * sizeof *batches);
    }
    for (size_t i = 0; i < cut.count; i++)
        batches[i] = (feature_batch){.first = cut.starts[i],
                                     .end = cut.starts[i + 1],
                                     .reader = geojson_reader_start(&reader->builder.space, options, NULL)};
    status = read_batches(reader, split, batches, cut.count, options->threads);
    for (size_t i = 0; i < cut.count; i++)
        geojson_reader_free(&batches[i].reader);
    free(batches);
    free(cut.starts);
    return status;
}

/// The name in a member "crs" of GeoJSON 2008; null when there is none. Sets whether there is a system without a name.
static const char *crs_name_of(const json_t *root, bool *unnamed)
{
    const json_t *crs = json_object_get(root, "crs");
    const char *type = json_string_value(json_object_get(crs, "type"));
    const char *name = json_string_value(json_object_get(json_object_get(crs, "properties"), "name"));
    bool named = type != NULL && strcasecmp(type, "name") == 0 && name != NULL;
    *unnamed = crs != NULL && !json_is_null(crs) && !named;
    return named ? name : NULL;
}

/// Choose the space by the options, else by the reference system of the root; null for a sequence, which has none.
static bat_status choose_space(geojson_reader *reader, const json_t *root, const bat_curve_read_options *options)
{
    if (geojson_has_type(root, "Topology"))
        return error_remedy(reader->error, ERROR_UNSUPPORTED(reader->error, 0, "the file is TopoJSON"), "read.format",
                            "topojson reads it");
    const char *crs = crs_name_of(root, &reader->unnamed_crs);
    if (crs != NULL)
    {
        reader->crs = crs_short_name(crs);
        if (reader->crs == NULL)
            return error_memory(reader->error, strlen(crs));
    }
    reader->plane_crs = options->space == NULL && reader->crs != NULL && !crs_is_geographic(reader->crs);
    const char *name = options->space != NULL ? options->space : reader->plane_crs ? "plane" : "sphere";
    if (strcmp(name, "euclidean") == 0)
        name = "plane";
    bat_space space;
    bat_status status = bat_space_by_name(name, 0, &space, reader->error);
    if (status != BAT_OK)
        return status;
    bool sphere = strcmp(name, "sphere") == 0;
    if (!sphere && space.point_dim != 2)
        return ERROR_UNSUPPORTED(reader->error, 0, "GeoJSON cannot hold points of the %s", name);
    reader->degrees = sphere;
    reader->builder.space = space;
    reader->builder.check = !sphere;
    return BAT_OK;
}

bat_status geojson_records_begin(const bat_curve_read_options *options, geojson_reader *reader, bat_error *error)
{
    const bat_space sphere = bat_sphere(2);
    *reader = geojson_reader_start(&sphere, options, error);
    bat_status status = choose_space(reader, NULL, options);
    if (status != BAT_OK)
        geojson_reader_free(reader);
    return status;
}

bat_status geojson_records_read(geojson_reader *reader, const feature_text *records, size_t count, size_t first,
                                const bat_curve_read_options *options)
{
    const feature_split split = {
        .features = (feature_text *)(uintptr_t)records, .count = count, .before = first, .geometries = true};
    return count > 0 ? read_split(reader, &split, options) : BAT_OK;
}

static const char *plural(size_t count)
{
    return count == 1 ? "" : "s";
}

/// ", the first in feature 6"; nothing in a file of one geometry.
static const char *first_in(const char *place, char *text, size_t size)
{
    (void)snprintf(text, size, "%s%s", place[0] != '\0' ? ", the first in " : "", place);
    return text;
}

/// Tell what was guessed and changed. False when out of memory.
static bool add_notes(const geojson_reader *reader, bat_curve_attributes *attributes)
{
    const geojson_findings *found = &reader->findings;
    const stitch_report *polygons = &found->polygons, *lines = &found->lines;
    char first[160];
    bool done = true;
    if (reader->plane_crs)
        done = attributes_note(attributes, "plane coordinates in %.80s, which the file names", reader->crs);
    if (done && reader->unnamed_crs && reader->degrees)
        done = attributes_note(attributes, "the member crs has no name: read as longitude and latitude");
    (void)first_in(found->first_join, first, sizeof first);
    if (done && polygons->joins > 0)
        done = attributes_note(attributes, "joined %zu polygons cut at the antimeridian into %zu%s",
                               polygons->joined + polygons->joins, polygons->joins, first);
    if (done && lines->joins > 0)
        done = attributes_note(attributes, "joined %zu lines cut at the antimeridian into %zu%s",
                               lines->joined + lines->joins, lines->joins, polygons->joins > 0 ? "" : first);
    if (done && polygons->poles > 0)
        done = attributes_note(attributes, "removed the closure of %zu polygon%s over a pole or around the axis%s",
                               polygons->poles, plural(polygons->poles), first_in(found->first_pole, first, sizeof first));
    if (done && found->repeats > 0)
        done = attributes_note(attributes, "dropped %zu repeated point%s%s", found->repeats, plural(found->repeats),
                               first_in(found->first_repeat, first, sizeof first));
    if (done && found->degenerate > 0)
        done = attributes_note(attributes, "dropped %zu line%s or ring%s with too few different points%s", found->degenerate,
                               plural(found->degenerate), plural(found->degenerate),
                               first_in(found->first_degenerate, first, sizeof first));
    if (done && found->wide > 0)
        done = attributes_note(
            attributes, "%zu edge%s more than 180 degrees of longitude and %s the short way, across the antimeridian%s",
            found->wide, found->wide == 1 ? " spans" : "s span", found->wide == 1 ? "goes" : "go",
            first_in(found->first_wide, first, sizeof first));
    if (done && found->unchanged > 0)
        done = attributes_note(attributes, "left %zu geometr%s without a usable outline unchanged%s", found->unchanged,
                               found->unchanged == 1 ? "y" : "ies", first_in(found->first_unchanged, first, sizeof first));
    return done;
}

bat_status geojson_records_end(geojson_reader *reader, bat_curve_format format, bat_curve_set *set)
{
    bat_curve_attributes *attributes = attributes_new(format);
    if (attributes == NULL || !add_notes(reader, attributes) || !geojson_document_keep(&reader->document, attributes))
    {
        attributes_release(attributes);
        return error_memory(reader->error, sizeof *attributes + sizeof reader->document);
    }
    attributes->crs = reader->crs;
    reader->crs = NULL;
    reader->findings = (geojson_findings){0};
    const curve_builder empty = {
        .space = reader->builder.space, .project = reader->builder.project, .check = reader->builder.check};
    bat_status status = builder_finish(&reader->builder, attributes, set, reader->error);
    reader->builder = empty;
    return status;
}

static bat_status read_whole(geojson_reader *reader, json_t *root)
{
    bool feature = geojson_has_type(root, "Feature");
    if (!geojson_has_type(root, "FeatureCollection"))
        return geojson_read_feature(reader, json_incref(root), !feature);
    json_t *features = json_object_get(root, "features");
    if (!json_is_array(features))
        return ERROR_FILE(reader->error, 0, "the FeatureCollection has no array of features");
    bat_status status = BAT_OK;
    for (size_t i = 0; i < json_array_size(features) && status == BAT_OK; i++)
    {
        reader->place.feature = i;
        status = geojson_read_feature(reader, json_incref(json_array_get(features, i)), false);
    }
    (void)json_array_clear(features);
    reader->document.collection = json_incref(root);
    return status;
}

/// Read feature by feature if the text can be split, which takes less memory and uses threads; else as one tree.
static bat_status read_text(geojson_reader *reader, const file_text *text, const bat_curve_read_options *options)
{
    feature_split split;
    json_t *root = NULL;
    bat_status status = BAT_OK;
    bool apart = split_text(text, &split);
    if (apart)
    {
        root = geojson_parse(reader, split.frame, split.frame + split.frame_size, 1);
        apart = root == NULL || geojson_has_type(root, "FeatureCollection");
    }
    if (apart && root != NULL)
    {
        reader->document.collection = json_incref(root);
        status = choose_space(reader, root, options);
        if (status == BAT_OK)
            status = read_split(reader, &split, options);
    }
    if (!apart)
    {
        json_decref(root);
        root = geojson_parse(reader, text->data, text->data + text->size, 1);
        if (root != NULL)
            status = choose_space(reader, root, options);
        if (root != NULL && status == BAT_OK)
            status = read_whole(reader, root);
    }
    split_free(&split);
    if (root == NULL)
        return reader->error->status;
    json_decref(root);
    return status;
}

bat_status geojson_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bat_error unread;
    const bat_space sphere = bat_sphere(2);
    if (error == NULL)
        error = &unread;
    geojson_reader reader = geojson_reader_start(&sphere, options, error);
    bat_status status = read_text(&reader, text, options);
    geojson_extraction_free(&reader.extraction);
    if (status == BAT_OK && reader.builder.curve_count == 0)
        status = ERROR_FILE(error, 0, "there are no lines or polygons");
    if (status == BAT_OK)
        status = geojson_records_end(&reader, BAT_CURVE_FORMAT_GEOJSON, set);
    geojson_reader_free(&reader);
    return status;
}

// Sequences of GeoJSON texts

static const char *skip_blanks(const char *at, const char *end)
{
    while (at < end && text_is_blank(*at))
        at++;
    return at;
}

record_scan record_scan_start(const char *text, size_t size, size_t line)
{
    const char *first = skip_blanks(text, text + size);
    return (record_scan){text, text + size, line, first < text + size && *first == RECORD_SEPARATOR};
}

bool record_scan_next(record_scan *scan, bool whole, feature_text *record)
{
    record_scan ahead = *scan;
    while (ahead.at < ahead.end)
    {
        // What stands between two separators, or before a line break.
        const char *begin = skip_blanks(ahead.at, ahead.end);
        begin += ahead.separated && begin < ahead.end && *begin == RECORD_SEPARATOR;
        begin = skip_blanks(begin, ahead.end);
        const char *end = memchr(begin, ahead.separated ? RECORD_SEPARATOR : '\n', (size_t)(ahead.end - begin));
        if (end == NULL && !whole)
            return false;
        const char *stop = end != NULL ? end : ahead.end;
        size_t line = ahead.line + json_scan_newlines(ahead.at, begin);
        ahead.line = line + json_scan_newlines(begin, stop);
        ahead.at = stop;
        *record = (feature_text){begin, stop, line};
        while (record->end > record->begin && text_is_blank(record->end[-1]))
            record->end--;
        if (record->end == record->begin)
            continue;
        *scan = ahead;
        return true;
    }
    if (whole)
        *scan = ahead;
    return false;
}

bool geojson_is_sequence(const char *text, size_t size)
{
    const char *end = text + size, *begin = skip_blanks(text, end);
    if (begin < end && *begin == RECORD_SEPARATOR)
        return true;
    const char *newline = begin < end && *begin == '{' ? memchr(begin, '\n', (size_t)(end - begin)) : NULL;
    if (newline == NULL)
        return false;
    const char *next = skip_blanks(newline, end), *last = newline;
    while (last > begin && text_is_blank(last[-1]))
        last--;
    // The first line is one object, and another one follows.
    json_scanner scan = {begin, end};
    return next < end && *next == '{' && last[-1] == '}' && json_scan_value(&scan) && scan.at == last;
}

bat_status geojson_sequence_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set,
                                 bat_error *error)
{
    bat_error unread;
    error = error != NULL ? error : &unread;
    geojson_reader reader;
    bat_status status = geojson_records_begin(options, &reader, error);
    if (status != BAT_OK)
        return status;
    feature_text *records = NULL, record;
    size_t count = 0, capacity = 0;
    record_scan scan = record_scan_start(text->data, text->size, 1);
    bool separated = scan.separated;
    while (status == BAT_OK && record_scan_next(&scan, true, &record))
        if (!ARRAY_ADD(records, capacity, count, record))
            status = error_memory(error, capacity * sizeof record);
    if (status == BAT_OK)
        status = geojson_records_read(&reader, records, count, 0, options);
    if (status == BAT_OK && reader.builder.curve_count == 0)
        status = ERROR_FILE(error, 0, "there are no lines or polygons");
    if (status == BAT_OK)
        status = geojson_records_end(&reader, separated ? BAT_CURVE_FORMAT_GEOJSON_SEQUENCE : BAT_CURVE_FORMAT_GEOJSON_LINES,
                                     set);
    geojson_reader_free(&reader);
    free(records);
    return status;
}

// Collections that other formats become

const char GEOJSON_MADE_BEGIN[] = "{\"type\":\"FeatureCollection\",\"features\":[";

geojson_made geojson_made_start(void)
{
    return (geojson_made){.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
}

void geojson_made_pad(const char *at, const char **counted, text_buffer *geojson)
{
    for (; *counted < at; ++*counted)
        if (**counted == '\n')
            text_append_string(geojson, "\n");
}

/// Tell what the file lets open. False when out of memory.
static bool note_space(const geojson_made *made, bool degrees, bat_curve_attributes *attributes)
{
    if (!degrees)
        return attributes_note(attributes, "the file names no coordinate system; its coordinates are those of a plane");
    return made->degrees ||
           attributes_note(attributes, "the file names no coordinate system; its coordinates are taken as degrees, because "
                                       "they could be (the plane takes them as they are)");
}

bat_status geojson_made_read(const geojson_made *made, text_buffer *geojson, bat_curve_format format,
                             const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bat_curve_read_options rest = *options;
    bool guessed = made->srid == 0 && options->space == NULL;
    bool degrees = made->low[0] >= -180 && made->high[0] <= 180 && made->low[1] >= -90 && made->high[1] <= 90;
    char end[96] = "]}";
    if (made->srid != 0)
        (void)snprintf(end, sizeof end, "],\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"EPSG:%d\"}}}", made->srid);
    text_append_string(geojson, end);
    if (geojson->failed)
        return error_memory(error, geojson->size);
    if (guessed)
        rest.space = degrees ? "sphere" : "plane";
    bat_curve_set read = {0};
    const file_text text = {.data = geojson->data, .size = geojson->size};
    bat_status status = geojson_read(&text, &rest, &read, error);
    if (status != BAT_OK && error != NULL && !made->lines)
        error->line = 0;
    if (status != BAT_OK)
        return status;
    geojson_document *document = read.attributes->remainder.content;
    read.attributes->format = format;
    document->measures = made->measures;
    (void)json_object_del(document->collection, "crs"); // the attributes have it
    for (size_t i = 0; !made->lines && i < document->feature_count; i++)
        document->features[i].line = 0;
    if (!guessed || note_space(made, degrees, read.attributes))
    {
        *set = read;
        return BAT_OK;
    }
    bat_curve_set_free(&read);
    return error_memory(error, geojson->size);
}
