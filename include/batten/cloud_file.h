#ifndef BATTEN_CLOUD_FILE_H
#define BATTEN_CLOUD_FILE_H

#include "batten/cloud.h"

BAT_C_BEGIN

/// @file
/// Clouds from files.

/// Formats of clouds.
typedef enum bat_cloud_format
{
    BAT_CLOUD_FORMAT_AUTO, ///< by the file's ending: .xyz, .txt or .asc, .csv, .ply, .obj; failing that by the content
    BAT_CLOUD_FORMAT_XYZ,  ///< three numbers a line, blanks between; '#' begins a remark; further columns are left out
    BAT_CLOUD_FORMAT_CSV,  ///< with or without a line of names; x, y, z by name or the first three
    BAT_CLOUD_FORMAT_PLY,  ///< vertices, ASCII or binary; faces, if there are, make it a mesh
    BAT_CLOUD_FORMAT_OBJ   ///< vertices; faces, if there are, make it a mesh
} bat_cloud_format;

/// A format, or "auto", by name.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names them all
BAT_API bat_status bat_cloud_format_by_name(const char *name, bat_cloud_format *value, bat_error *error);
/// The name. Never null.
BAT_API const char *bat_cloud_format_name(bat_cloud_format value);
/// The table, row by row; `index` from 0 on.
/// @return false past the last
BAT_API bool bat_cloud_format_list(size_t index, bat_choice *choice);
/// The format that a path's ending stands for, in either case; else BAT_CLOUD_FORMAT_AUTO.
BAT_API bat_cloud_format bat_cloud_format_of_path(const char *path);

/// How to read. All zero: the defaults.
typedef struct bat_cloud_read_options
{
    bat_cloud_format format;
    /// How many points come first as the boundary loop; 0: what a remark "# N boundary points first" before the first point
    /// says, or unknown. A remark "# corners A B C D" beside it names corners by their places in the loop, counted from 0.
    size_t boundary;
    /// A second file with the boundary loop: its points go first, also in the cloud's `order`, and points of the first file
    /// that repeat one are left out; null for none.
    const char *boundary_path;
    /// Leave out points that repeat an earlier one instead of failing; in a mesh, join vertices in the same place.
    bool drop_duplicates;
    /// Four points of the file, counted from 0, for bat_cloud_set_corners(); the boundary is found where it is not known.
    /// Null: as the file says, the default.
    const size_t *corners;
} bat_cloud_read_options;

/// The options' default values.
BAT_API bat_cloud_read_options bat_cloud_read_defaults(void);
/// Check options; null passes.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field out of range
BAT_API bat_status bat_cloud_read_options_check(const bat_cloud_read_options *options, bat_error *error);

/// Read a cloud. A PLY or OBJ file with faces is a mesh and goes through bat_cloud_from_mesh().
/// @param path    "-" for standard input
/// @param options null for the defaults
/// @param cloud   receives the cloud; release it with bat_cloud_free()
/// @return BAT_OK; BAT_BAD_FILE with the line; BAT_INVALID_POINT with line and point that is not finite (in PLY and OBJ that
/// is
///         BAT_BAD_FILE) or repeats another; BAT_INVALID_ARGUMENT for an option that the file contradicts; what
///         bat_cloud_from_mesh() and, with corners, bat_cloud_find_boundary() and bat_cloud_set_corners() return;
///         BAT_FILE_ACCESS, BAT_TOO_LARGE, BAT_UNSUPPORTED, BAT_NO_MEMORY; `cloud` is untouched on failure. Text about the
///         boundary's file says so and names its line; bat_error::line is one of the main file
BAT_API bat_status bat_cloud_read(const char *path, const bat_cloud_read_options *options, bat_cloud *cloud,
                                  bat_error *error);
/// Write a cloud as XYZ, CSV, PLY or OBJ, by the ending; "-" is standard output in XYZ. All four are text that brings back
/// the same doubles and say boundary and corners in remarks at the top; PLY and OBJ also hold the triangles. The file
/// appears whole or not at all.
/// @return BAT_OK; BAT_INVALID_ARGUMENT where the ending says no format; what bat_cloud_check() returns; BAT_FILE_ACCESS;
/// BAT_NO_MEMORY
BAT_API bat_status bat_cloud_write(const char *path, const bat_cloud *cloud, bat_error *error);

/// Write parameters as lines "u v", in the order that the points had in the input; "nan nan" stands for a point that was
/// left out.
/// @param path       "-" for standard output
/// @param parameters cloud->count x 2
BAT_API bat_status bat_cloud_parameters_write(const char *path, const bat_cloud *cloud, const double *parameters,
                                              bat_error *error);
/// Read what bat_cloud_parameters_write() writes, for the same input: a row for each of its points, '#' beginning a remark.
/// @param parameters receives an array of cloud->count x 2 from malloc(), in the cloud's order
/// @return BAT_OK; BAT_BAD_FILE with the line for what is no number from 0 to 1, or for another number of rows;
/// BAT_FILE_ACCESS or
///         BAT_NO_MEMORY
BAT_API bat_status bat_cloud_parameters_read(const char *path, const bat_cloud *cloud, double **parameters,
                                             bat_error *error);

BAT_C_END

#endif
