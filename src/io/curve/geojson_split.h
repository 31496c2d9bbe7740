#ifndef IO_CURVE_GEOJSON_SPLIT_H
#define IO_CURVE_GEOJSON_SPLIT_H

#include "io/common/file_text.h"

/// The text of one feature.
typedef struct feature_text
{
    const char *begin, *end;
    size_t line; ///< of its first byte, counted from 1
} feature_text;

/// A feature collection cut into the texts of its features, which can then be parsed apart from each other.
typedef struct geojson_split
{
    feature_text *features;
    size_t count, capacity;
    char *frame; ///< the text without what is between the brackets of "features", save for its line breaks
    size_t frame_size;
} geojson_split;

/// Cut a text. Only brackets, quotes and commas are looked at; it is the parser that decides whether each part is JSON.
/// False when the text is not a feature collection written in the usual way (or memory is short): parse it whole then.
bool geojson_split_text(const file_text *text, geojson_split *split);

void geojson_split_free(geojson_split *split);

#endif
