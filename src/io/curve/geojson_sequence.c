#include "io/curve/geojson.h"

#include "io/curve/formats.h"

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
