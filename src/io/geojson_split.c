#include "io/geojson_split.h"

#include "io/text_buffer.h"

/// A place in the text. `at` is null after something unexpected.
typedef struct scanner
{
    const char *at, *end;
} scanner;

static void skip_blanks(scanner *scan)
{
    while (scan->at < scan->end && (*scan->at == ' ' || *scan->at == '\n' || *scan->at == '\r' || *scan->at == '\t'))
        scan->at++;
}

static bool at_byte(scanner *scan, char byte)
{
    skip_blanks(scan);
    return scan->at < scan->end && *scan->at == byte;
}

static bool take_byte(scanner *scan, char byte)
{
    bool there = at_byte(scan, byte);
    scan->at += there;
    return there;
}

/// Go behind the string that begins here.
static bool skip_string(scanner *scan)
{
    scan->at++;
    while (scan->at < scan->end && *scan->at != '"')
        scan->at += *scan->at == '\\' ? 2 : 1;
    if (scan->at >= scan->end)
        return false;
    scan->at++;
    return true;
}

/// Go behind the value that begins here: to the end of its brackets, or to the comma or bracket that follows a plain value.
static bool skip_value(scanner *scan)
{
    size_t depth = 0;
    while (scan->at < scan->end)
    {
        char c = *scan->at;
        if (c == '"')
        {
            if (!skip_string(scan))
                return false;
            continue;
        }
        if (depth == 0 && (c == ',' || c == '}' || c == ']'))
            return true;
        scan->at++;
        if (c == '{' || c == '[')
            depth++;
        else if (c == '}' || c == ']')
        {
            if (--depth == 0)
                return true;
        }
    }
    return false;
}

/// Go to the bracket that opens the array of features.
static bool find_features(scanner *scan)
{
    static const char wanted[] = "\"features\"";
    if (!take_byte(scan, '{'))
        return false;
    do
    {
        if (!at_byte(scan, '"'))
            return false;
        const char *key = scan->at;
        if (!skip_string(scan))
            return false;
        bool found = (size_t)(scan->at - key) == sizeof wanted - 1 && memcmp(key, wanted, sizeof wanted - 1) == 0;
        if (!take_byte(scan, ':'))
            return false;
        if (found)
            return at_byte(scan, '[');
        skip_blanks(scan);
        if (!skip_value(scan))
            return false;
    } while (take_byte(scan, ','));
    return false;
}

static size_t count_newlines(const char *begin, const char *end)
{
    size_t count = 0;
    while (begin < end && (begin = memchr(begin, '\n', (size_t)(end - begin))) != NULL)
    {
        count++;
        begin++;
    }
    return count;
}

static bool add_feature(geojson_split *split, feature_text feature)
{
    void *features = split->features;
    bool grown = array_grow(&features, &split->capacity, split->count + 1, sizeof feature);
    split->features = features;
    if (grown)
        split->features[split->count++] = feature;
    return grown;
}

/// Take the features between the brackets; the scanner is at the opening one and ends at the closing one.
static bool collect_features(const file_text *text, scanner *scan, geojson_split *split)
{
    const char *counted = text->data;
    size_t line = 1;
    (void)take_byte(scan, '[');
    if (at_byte(scan, ']'))
        return true;
    do
    {
        if (!at_byte(scan, '{'))
            return false;
        feature_text feature = {.begin = scan->at};
        line += count_newlines(counted, scan->at);
        counted = scan->at;
        feature.line = line;
        if (!skip_value(scan))
            return false;
        feature.end = scan->at;
        if (!add_feature(split, feature))
            return false;
    } while (take_byte(scan, ','));
    return at_byte(scan, ']');
}

static bool make_frame(const file_text *text, const char *open, const char *close, geojson_split *split)
{
    text_buffer frame = {0};
    text_append(&frame, text->data, (size_t)(open + 1 - text->data));
    size_t newlines = count_newlines(open, close);
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

bool geojson_split_text(const file_text *text, geojson_split *split)
{
    *split = (geojson_split){0};
    scanner scan = {text->data, text->data + text->size};
    if (find_features(&scan))
    {
        const char *open = scan.at;
        if (collect_features(text, &scan, split) && make_frame(text, open, scan.at, split))
            return true;
    }
    geojson_split_free(split);
    return false;
}

void geojson_split_free(geojson_split *split)
{
    free(split->features);
    free(split->frame);
    *split = (geojson_split){0};
}
