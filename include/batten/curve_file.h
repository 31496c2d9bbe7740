#ifndef BATTEN_CURVE_FILE_H
#define BATTEN_CURVE_FILE_H

#include "batten/curve.h"
#include "batten/curve_set.h"

BAT_C_BEGIN

/// @file
/// Readers and writers of curves: CSV, GeoJSON and sequences of it, GPX, WKT, TopoJSON, OBJ line elements, trajectories of
/// TUM, EuRoC and KITTI and, by GDAL, formats of geographic information systems. docs/formats.md describes the formats.

/// The formats by name. bat_choice_of_path() takes the ending before ".gz", and BAT_CURVE_FORMAT_GDAL for other paths that
/// end so or begin with "/vsi".
extern BAT_API const bat_family bat_curve_format_family;

/// The unit of times in a file.
typedef enum bat_time_unit
{
    BAT_TIME_UNIT_AUTO, ///< that of the column's name, as in "time_ns" or "t [ms]"; else by the size of the first time:
                        ///< seconds below 1e11, milliseconds below 1e14, microseconds below 1e17, else nanoseconds
    BAT_TIME_UNIT_SECONDS,
    BAT_TIME_UNIT_MILLISECONDS,
    BAT_TIME_UNIT_MICROSECONDS,
    BAT_TIME_UNIT_NANOSECONDS
} bat_time_unit;

/// The units of times by name.
extern BAT_API const bat_family bat_time_unit_family;

/// Options of reading. Begin with bat_curve_read_defaults().
typedef struct bat_curve_read_options
{
    bat_curve_format format; ///< default BAT_CURVE_FORMAT_AUTO
    const char *space;       ///< a name as in bat_space_by_name(); default null: what the file implies
    int closed;              ///< -1: as the file says (default); 0: every line is open; 1: every line is closed
    bool strict;  ///< refuse repeated points, and a motion's other columns, instead of dropping them; default false
    bool project; ///< move points that are off their space onto it instead of refusing them; default false
    /// CSV: the columns of the coordinates, names or numbers from 1 with commas between them, as "x,y" or "lon,lat"; default
    /// null: what names and places tell.
    const char *columns;
    /// CSV: the name or number of a column; all rows with one value in it make one curve, in the order of the file, and the
    /// curves follow each other in the order of their first rows. Default null: blank lines separate curves.
    const char *group;
    /// CSV: read the rows as keyframes of motions. The names of the columns tell the space, of rotation vectors and tensors
    /// too. One column beside the times is a motion on the line. Other columns are left out, with a note. Times are seconds
    /// since bat_curve_set_time_origin(); they are written as they were: in their unit, or as dates with times of day (ISO
    /// 8601). Default false: such dates are texts, with new ones between.
    bool motion;
    bat_time_unit time_unit; ///< of the times of motions; default BAT_TIME_UNIT_AUTO
    const char *layer; ///< formats with layers, and TopoJSON: its name; default null: the only one with lines or polygons
    bool on_sphere;    ///< take projected coordinates to the sphere, and back when they are written, by PROJ;
                       ///< default false
    /// CSV: the order and the unit of columns roll, pitch and yaw, as "zyx" or "zyx,degrees" or "xyz,radians": the body
    /// turns about its own axes in the order of the letters, roll about x, pitch about y, yaw about z. Default null: the
    /// order zyx, with the unit in the names of the columns; names without a unit are refused.
    const char *euler;
    /// KITTI: a file of times as for bat_motion_times_read(), one for each pose; default null: pose i is at time i.
    const char *key_times;
    double translation_weight; ///< of the space "rigid", as in bat_rigid(); 0: as the space has it, 1; default 0
    int threads;               ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_limits limits;         ///< what is more is refused with BAT_TOO_LARGE; default: those of bat_limits
} bat_curve_read_options;

/// The options' default values.
BAT_API bat_curve_read_options bat_curve_read_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_curve_read_fields;

/// Read the curves of a file.
///
/// @param path    "-" is standard input. An ending that no format has is an error where the options name no format; the
///                content of a file without an ending tells its format. Paths that begin with /vsi, and those that end
///                in .gz or .zip, go to GDAL
/// @param options null for the defaults
/// @param set     receives the curves, at least one; release it with bat_curve_set_free()
/// @param error   `line` is the failing line (CSV, OBJ, JSON syntax) and `index` the point's index in its curve; for GeoJSON
///                the text names the feature and the position
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_UNSUPPORTED, BAT_FILE_ACCESS, BAT_BAD_FILE, BAT_TOO_LARGE or BAT_NO_MEMORY;
///         `set` is untouched on failure
BAT_API bat_status bat_curve_read(const char *path, const bat_curve_read_options *options, bat_curve_set *set,
                                  bat_error *error);
/// The same from `size` bytes of text, which need no final zero. BAT_CURVE_FORMAT_AUTO goes by the content.
BAT_API bat_status bat_curve_read_memory(const char *text, size_t size, const bat_curve_read_options *options,
                                         bat_curve_set *set, bat_error *error);

/// What a writer left out.
typedef struct bat_curve_write_report
{
    size_t left_out;       ///< rings of GeoJSON polygons that have no area at the precision
    size_t first_left_out; ///< the curve of the first; BAT_NO_INDEX for none and for a file written part by part
    const char *lost;      ///< what the file that was read has and the format cannot hold, in words; null for nothing
} bat_curve_write_report;

/// Options of writing. Begin with bat_curve_write_defaults().
typedef struct bat_curve_write_options
{
    bat_curve_format format; ///< default BAT_CURVE_FORMAT_AUTO
    int precision;           ///< decimals of longitudes and latitudes in degrees, 0 to 12; default 10. Other numbers are
                             ///< written with as many digits as bring back the same double
    int threads;             ///< 0: as many as OpenMP gives; the bytes do not depend on it; default 0
    const char *crs; ///< the coordinate reference system of the coordinates, such as "EPSG:25833", for the member "crs" of
                     ///< GeoJSON and for formats of GDAL; default null: what the file that was read names
    /// The map that was refined to the set: its polygons are judged as the file will hold them, and one that crosses itself,
    /// loses area or leaves a shared border is an error. GeoJSON and formats of GDAL; default null
    const bat_curve_set *given;
    bat_curve_write_report *report; ///< receives what was left out; default null
} bat_curve_write_options;

/// The options' default values.
BAT_API bat_curve_write_options bat_curve_write_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_curve_write_fields;

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

/// Options of bat_curve_refine_file(). Begin with bat_curve_refine_file_defaults().
typedef struct bat_curve_refine_file_options
{
    bat_curve_read_options read;
    bat_curve_refine_options refine; ///< `progress` and `report` are those of the whole file
    bat_curve_write_options write;
    /// Called with each part of the file, in their order, by the calling thread: the given curves and the refined ones.
    /// False stops the call with BAT_CANCELLED. Default: null.
    bool (*visit)(void *context, const bat_curve_set *coarse, const bat_curve_set *fine);
    void *context; ///< handed to `visit`
} bat_curve_refine_file_options;

/// What bat_curve_refine_file() found.
typedef struct bat_curve_refine_file_report
{
    size_t features; ///< records of a sequence; 0 for other formats
    size_t curves;
    size_t coarse_points, fine_points;
    bool streamed; ///< the file was read part by part
} bat_curve_refine_file_report;

/// The options' default values.
BAT_API bat_curve_refine_file_options bat_curve_refine_file_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_curve_refine_file_fields;

/// Read the curves of a file, refine each by itself, and write them. A sequence of GeoJSON that is written as GeoJSON or as
/// a sequence is read, refined and written part by part: the memory does not grow with the number of features. A part has
/// about a million refined points, or a single feature that has more. The result is that of bat_curve_read(),
/// bat_curves_refine() and bat_curve_write(), byte for byte, and appears whole or not at all; but standard output may
/// receive records before a failure.
///
/// @param input   "-" is standard input, whose format `read` names if it is to be read part by part
/// @param output  "-" is standard output; it may be the input file
/// @param options null for the defaults
/// @param report  receives counts when the call succeeds; may be null
/// @param error   `operand` is 1 where the output is at fault; `line` is the line that the failing feature begins on, and
/// the
///                text names the feature
/// @return as bat_curve_read(), bat_curves_refine() and bat_curve_write()
BAT_API bat_status bat_curve_refine_file(const char *input, const char *output, const bat_curve_refine_file_options *options,
                                         bat_curve_refine_file_report *report, bat_error *error);

BAT_C_END

#endif
