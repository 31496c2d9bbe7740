#ifndef BATTEN_CURVE_FILE_H
#define BATTEN_CURVE_FILE_H

#include "batten/curve.h"

BAT_C_BEGIN

/// @file
/// Curves from files and to files: CSV, GeoJSON, OBJ line elements and TUM trajectories. docs/formats.md says what each
/// format means.

/// What a file tells beyond its curves: GeoJSON features with their properties, CSV column names. Opaque, shared by
/// counting.
typedef struct bat_curve_attributes bat_curve_attributes;

/// The curves of one file, with what else survives from it. All zero: empty.
typedef struct bat_curve_set
{
    bat_space *space;  ///< where all the curves live; owned
    bat_curve *curves; ///< `count` of them, in the order of the file; each one's `space` is the set's; owned
    size_t count;
    bat_curve_attributes *attributes; ///< what the file says beside the curves; null when there is no file; owned (shared)
    size_t *lines; ///< the line of the file that each point stands on, curve after curve; null when unknown; owned
} bat_curve_set;

/// Free what a set owns and make it empty. Does nothing to a set that is empty already.
BAT_API void bat_curve_set_free(bat_curve_set *set);

/// Move one curve that did not come from a file into a set of its own, to write it. `curve` is left empty.
/// @return BAT_OK or BAT_NO_MEMORY; on failure `curve` keeps its points
BAT_API bat_status bat_curve_set_single(bat_curve *curve, bat_curve_set *set, bat_error *error);

/// Make a set of `count` curves that did not come from a file. They must live in one kind of space, the first one's, which
/// is copied (its `parameters` are not, and must outlive the set).
///
/// @param curves an array from malloc(); the set takes it and frees it
/// @param count  at least 1
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; on failure the caller keeps the array
BAT_API bat_status bat_curve_set_take(bat_curve *curves, size_t count, bat_curve_set *set, bat_error *error);

/// Make a set of changed curves, one for each curve of `source` and in the same order, that keeps the source's attributes.
///
/// @param curves an array of source->count curves from malloc(), in the source's kind of space; the result takes it and
/// frees
///               it, and makes every curve's `space` its own copy of the source's
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; on failure the caller keeps the array
BAT_API bat_status bat_curve_set_like(const bat_curve_set *source, bat_curve *curves, bat_curve_set *result,
                                      bat_error *error);

/// The line of the file, counted from 1, that a point was read from; for GeoJSON the line that its feature begins on. 0 when
/// it is not known.
BAT_API size_t bat_curve_set_line(const bat_curve_set *set, size_t curve, size_t point);

/// The formats of curves.
typedef enum bat_curve_format
{
    BAT_CURVE_FORMAT_AUTO, ///< by the file's ending; failing that by the content (reading) or by where the set came from
                           ///< (writing)
    BAT_CURVE_FORMAT_CSV,
    BAT_CURVE_FORMAT_GEOJSON,
    BAT_CURVE_FORMAT_OBJ,
    BAT_CURVE_FORMAT_TUM ///< poses in time, as the TUM benchmark writes them: timestamp tx ty tz qx qy qz qw; the space
                         ///< "rigid"
} bat_curve_format;

/// A format by name: "auto", "csv", "geojson", "obj" or "tum".
/// @return BAT_OK or BAT_INVALID_ARGUMENT
BAT_API bat_status bat_curve_format_by_name(const char *name, bat_curve_format *format, bat_error *error);
/// The format that a path's ending stands for, in either case: .csv .txt, .geojson .json, .obj, .tum; else
/// BAT_CURVE_FORMAT_AUTO.
BAT_API bat_curve_format bat_curve_format_of_path(const char *path);

/// How to read. Begin with bat_curve_read_defaults().
typedef struct bat_curve_read_options
{
    bat_curve_format format; ///< default BAT_CURVE_FORMAT_AUTO
    const char *space;       ///< a name as in bat_space_by_name(); default null: what the file implies
    int closed;              ///< -1: as the file says (default); 0: every line is open; 1: every line is closed
    bool project;            ///< move points that are off their space onto it instead of refusing them; default false
    int threads;             ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
} bat_curve_read_options;

/// The options' default values.
BAT_API bat_curve_read_options bat_curve_read_defaults(void);

/// Read the curves of a file.
///
/// @param path    "-" is standard input
/// @param options null for the defaults
/// @param set     receives the curves, at least one; release it with bat_curve_set_free()
/// @param error   `line` is the line at fault (CSV, OBJ, JSON syntax) and `index` the point's index in its curve, where
/// there
///                is one; for GeoJSON the text names the feature and the position
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_UNSUPPORTED, BAT_FILE_ACCESS, BAT_BAD_FILE, BAT_TOO_LARGE or BAT_NO_MEMORY;
/// `set` is
///         untouched on failure
BAT_API bat_status bat_curve_read(const char *path, const bat_curve_read_options *options, bat_curve_set *set,
                                  bat_error *error);
/// The same from `size` bytes of text, which need no final zero. BAT_CURVE_FORMAT_AUTO goes by the content.
BAT_API bat_status bat_curve_read_memory(const char *text, size_t size, const bat_curve_read_options *options,
                                         bat_curve_set *set, bat_error *error);

/// How to write. Begin with bat_curve_write_defaults().
typedef struct bat_curve_write_options
{
    bat_curve_format format; ///< default BAT_CURVE_FORMAT_AUTO
    int precision;           ///< decimals of longitudes and latitudes in degrees, 0 to 12; default 10. Other numbers are
                             ///< written with as many digits as bring back the same double
    int threads;             ///< 0: as many as OpenMP gives; the bytes do not depend on it; default 0
} bat_curve_write_options;

/// The options' default values.
BAT_API bat_curve_write_options bat_curve_write_defaults(void);

/// Write the curves of a set. The file appears whole or not at all; on failure an existing one stays as it was.
///
/// @param path    "-" is standard output
/// @param set     at least one curve; points must be in their space
/// @param options null for the defaults
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_UNSUPPORTED (the format cannot hold the space or the curve), BAT_FILE_ACCESS or
///         BAT_NO_MEMORY
BAT_API bat_status bat_curve_write(const char *path, const bat_curve_set *set, const bat_curve_write_options *options,
                                   bat_error *error);
/// The same to memory: `text` receives `size` bytes and a final zero; release it with free().
BAT_API bat_status bat_curve_write_memory(const bat_curve_set *set, const bat_curve_write_options *options, char **text,
                                          size_t *size, bat_error *error);

BAT_C_END

#endif
