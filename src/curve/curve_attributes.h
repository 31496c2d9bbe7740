#ifndef CURVE_CURVE_ATTRIBUTES_H
#define CURVE_CURVE_ATTRIBUTES_H

#include "batten/curve_set.h"

#include "curve/point_form.h"

#include <stdatomic.h>

/// The columns of a CSV file that had a header.
typedef struct csv_columns
{
    char **names;   ///< one block: the pointers, then the text; null without a header
    size_t *places; ///< what each column holds: coordinate `place`, or channel `place - coordinates`; null without a header
    size_t count;
    bool degrees;           ///< the coordinates are longitude and latitude
    const point_form *form; ///< how points are written, where not by their coordinates as they are
    size_t altitude;        ///< the channel that is the altitude, or BAT_NO_INDEX
    size_t corner;          ///< where the file has its column of corners, which is not in `names`; or BAT_NO_INDEX
} csv_columns;

/// What else a format keeps of a file.
typedef struct file_remainder
{
    void *content;                                     ///< known to its format alone; null for none; owned
    void (*free)(void *content);                       ///< of the content and all that it owns
    size_t (*line)(const void *content, size_t curve); ///< the line that a curve begins on; 0 when unknown
    /// Write the place of a curve in the file, in a few words.
    void (*place)(const void *content, size_t curve, char *text, size_t size);
} file_remainder;

/// What a closed curve bounds.
typedef struct curve_ring
{
    size_t polygon; ///< the index of its polygon; BAT_NO_INDEX for a line
    size_t feature; ///< the index of its feature
} curve_ring;

struct bat_curve_attributes
{
    atomic_size_t owners;
    bat_curve_format format; ///< what the file was
    csv_columns csv;
    file_remainder remainder;
    curve_ring *rings; ///< one for each curve of the set; null when the file knows no polygons
    size_t ring_count;
    char *crs;    ///< the coordinate reference system, "EPSG:25833" or a URN; null when the file names none; owned
    char **notes; ///< note_count sentences about the reading; see bat_curve_set_note()
    size_t note_count;
};

/// Whether curves come from GeoJSON or a sequence of it. Null is allowed.
static inline bool attributes_are_geojson(const bat_curve_attributes *attributes)
{
    return attributes != NULL && (attributes->format == BAT_CURVE_FORMAT_GEOJSON ||
                                  attributes->format == BAT_CURVE_FORMAT_GEOJSON_LINES ||
                                  attributes->format == BAT_CURVE_FORMAT_GEOJSON_SEQUENCE);
}

/// Attributes with one owner.
bat_curve_attributes *attributes_new(bat_curve_format format);
void attributes_share(bat_curve_attributes *attributes);
/// Give up one ownership, and free the attributes when it was the last. Null is allowed.
void attributes_release(bat_curve_attributes *attributes);
/// Add a note, see bat_curve_set_note(), before the attributes are shared. False when out of memory.
bool attributes_note(bat_curve_attributes *attributes, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
