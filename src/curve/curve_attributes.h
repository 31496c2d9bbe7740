#pragma once

#include "batten/curve_set.h"

#include "curve/point_form.h"

#include <stdatomic.h>

/// The channels of a curve that hold times and velocities.
typedef struct motion_channels
{
    size_t time;                     ///< BAT_NO_INDEX without times
    size_t velocity[MAX_VELOCITIES]; ///< BAT_NO_INDEX for the part of a pose that has none
    size_t velocity_count;           ///< 0 without velocities
    size_t deviation;                ///< the first of as many standard deviations, in a result; 0 without
} motion_channels;

/// The number of channels with times and velocities.
static inline size_t motion_channels_count(const motion_channels *channels)
{
    size_t count = channels->time != BAT_NO_INDEX;
    for (size_t i = 0; i < channels->velocity_count; i++)
        count += channels->velocity[i] != BAT_NO_INDEX;
    return count + (channels->deviation > 0 ? channels->velocity_count : 0);
}

/// Of a date with the time of day, ISO 8601.
#define ATTRIBUTES_TIME_SIZE 49

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
    bat_curve_format format;  ///< what the file was
    bool degrees;             ///< a table has the coordinates as longitude and latitude
    const point_form *form;   ///< how a table has points, where not by their coordinates as they are; else null
    motion_channels channels; ///< times and velocities in a table whose curves have channel_count channels
    size_t channel_count;
    struct csv_columns *csv;                       ///< all columns, known to io alone; null for other formats; owned
    void (*free_csv)(struct csv_columns *columns); ///< of them
    file_remainder remainder;
    curve_ring *rings; ///< one for each curve of the set; null when the file knows no polygons
    size_t ring_count;
    char *crs;      ///< the coordinate reference system, "EPSG:25833" or a URN; null when the file names none; owned
    bool on_sphere; ///< the curves were taken from the plane of that system to the sphere, and go back when written
    char **notes;   ///< note_count sentences about the reading; see bat_curve_set_note()
    size_t note_count;
    int64_t time_origin; ///< whole seconds since 1970 that times, a channel, count from; see bat_curve_set_time_origin()
    bool turned;         ///< signs of quaternions tell the way of about half a turn; see builder_continue_signs()
    int time_decimals;   ///< of seconds that the unit of the file's times has: 3, 6, 9; 0 for seconds
    char time_text[ATTRIBUTES_TIME_SIZE]; ///< a time of the file, where times were dates and are written as such; else empty
};

/// Whether curves come from GeoJSON, a sequence of it, or a format whose content is kept as GeoJSON. Null is allowed.
static inline bool attributes_are_geojson(const bat_curve_attributes *attributes)
{
    return attributes != NULL &&
           (attributes->format == BAT_CURVE_FORMAT_GEOJSON || attributes->format == BAT_CURVE_FORMAT_GEOJSON_LINES ||
            attributes->format == BAT_CURVE_FORMAT_GEOJSON_SEQUENCE || attributes->format == BAT_CURVE_FORMAT_GPX ||
            attributes->format == BAT_CURVE_FORMAT_WKT || attributes->format == BAT_CURVE_FORMAT_WKT_CSV ||
            attributes->format == BAT_CURVE_FORMAT_TOPOJSON);
}

/// Attributes with one owner.
bat_curve_attributes *attributes_new(bat_curve_format format);
void attributes_share(bat_curve_attributes *attributes);
/// Give up one ownership, and free the attributes when it was the last. Null is allowed.
void attributes_release(bat_curve_attributes *attributes);
/// Add a note, see bat_curve_set_note(), before the attributes are shared. False when out of memory.
bool attributes_note(bat_curve_attributes *attributes, const char *format, ...) __attribute__((format(printf, 2, 3)));
