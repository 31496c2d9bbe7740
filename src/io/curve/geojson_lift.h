#ifndef IO_CURVE_GEOJSON_LIFT_H
#define IO_CURVE_GEOJSON_LIFT_H

#include "base/text_buffer.h"

/// The text of a feature, or of a geometry alone, from which the coordinates of lines and polygons are lifted out: each
/// array of them is replaced by its number, [0], [1], … and its line breaks. So the parser makes no tree of them, which
/// would take many times the memory of the text. All zero: empty. It can be used again for the next text.
typedef struct geojson_lift
{
    text_buffer text;
    const char **arrays; ///< where each array begins in the original text; they are right JSON and hold only numbers
    size_t count, capacity;
} geojson_lift;

/// Lift the coordinates out. Afterwards an array of a single whole number is such a reference, wherever a geometry of lines
/// or polygons has it for coordinates. False when nothing could be lifted: because of unusual spelling, wrong syntax or want
/// of memory, or because there are no lines; parse the original text then.
bool geojson_lift_text(geojson_lift *lift, const char *begin, const char *end);

void geojson_lift_free(geojson_lift *lift);

#endif
