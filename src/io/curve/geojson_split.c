#include "io/curve/geojson_split.h"

#include "base/text_buffer.h"
#include "io/common/json_scan.h"

/// Go to the bracket that opens the array of features.
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
static bool collect_features(const file_text *text, json_scanner *scan, geojson_split *split)
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
        if (!json_scan_value(scan))
            return false;
        feature.end = scan->at;
        if (!add_feature(split, feature))
            return false;
    } while (json_scan_take(scan, ','));
    return json_scan_at(scan, ']');
}

static bool make_frame(const file_text *text, const char *open, const char *close, geojson_split *split)
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

bool geojson_split_text(const file_text *text, geojson_split *split)
{
    *split = (geojson_split){0};
    json_scanner scan = {text->data, text->data + text->size};
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
