#ifndef CURVE_CURVE_ATTRIBUTES_H
#define CURVE_CURVE_ATTRIBUTES_H

#include "batten/curve_set.h"

#include "curve/point_form.h"

#include <stdatomic.h>

/// What a CSV column holds.
typedef enum csv_kind
{
    CSV_NUMBER, ///< a coordinate or a channel
    CSV_ID,     ///< running numbers, which are written anew
    CSV_GROUP,  ///< one text for each curve
    CSV_TEXT,   ///< texts; new points take that of the point before
    CSV_TIME,   ///< ISO 8601 times; new points get times between
    CSV_GAPS,   ///< numbers and empty cells; new points get numbers between where both sides have one
    CSV_EMPTY   ///< nothing
} csv_kind;

/// The cells of the columns that are neither coordinates nor channels nor running numbers.
typedef struct csv_cells
{
    size_t columns; ///< with cells, in the order of the file
    size_t curves;
    size_t *first_rows;    ///< the row that each curve begins with, then the number of all rows
    unsigned char *closed; ///< whether each curve was closed
    size_t *offsets;       ///< rows x columns, into `text`
    char *text;            ///< cells with a zero after each
} csv_cells;

enum
{
    /// Channels at the end of a row that tell a point's place between the rows of the file, where there are cells: the row k
    /// of an open curve and 0, or cos and sin of 2 pi k / n for a closed one of n rows.
    CSV_PLACE_CHANNELS = 2
};

/// The columns of a CSV file that had a header, or other columns than numbers.
typedef struct csv_columns
{
    char **names;   ///< one block: the pointers, then the text; null without a header
    size_t *places; ///< what each column of numbers holds: coordinate `place`, or channel `place - coordinates`; null: in
                    ///< their order
    unsigned char *kinds; ///< a csv_kind for each column; null: all are numbers
    size_t count;
    size_t other_count;     ///< columns that are no numbers
    csv_cells cells;        ///< all zero without such columns
    bool has_places;        ///< each point has CSV_PLACE_CHANNELS
    int64_t first_id;       ///< of CSV_ID
    bool ids_begin_anew;    ///< with each curve
    bool degrees;           ///< the coordinates are longitude and latitude
    bool radians;           ///< they are written in radians
    const point_form *form; ///< how points are written, where not by their coordinates as they are
    size_t altitude;        ///< the channel that is the altitude, or BAT_NO_INDEX
    size_t corner;          ///< where the file has its column of corners, which is not in `names`; or BAT_NO_INDEX
    char *chosen;           ///< the columns of coordinates, by their numbers from 1, where they were chosen; else null
} csv_columns;

enum
{
    /// Of a date with the time of day, ISO 8601.
    ATTRIBUTES_TIME_SIZE = 49
};

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
    char *crs;      ///< the coordinate reference system, "EPSG:25833" or a URN; null when the file names none; owned
    bool on_sphere; ///< the curves were taken from the plane of that system to the sphere, and go back when written
    char **notes;   ///< note_count sentences about the reading; see bat_curve_set_note()
    size_t note_count;
    int64_t time_origin; ///< whole seconds since 1970 that times, a channel, count from; see bat_curve_set_time_origin()
    char time_text[ATTRIBUTES_TIME_SIZE]; ///< a time of the file, where times were dates and are written as such; else empty
};

/// Whether curves come from GeoJSON or a sequence of it. Null is allowed.
static inline bool attributes_are_geojson(const bat_curve_attributes *attributes)
{
    return attributes != NULL &&
           (attributes->format == BAT_CURVE_FORMAT_GEOJSON || attributes->format == BAT_CURVE_FORMAT_GEOJSON_LINES ||
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
