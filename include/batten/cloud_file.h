#ifndef BATTEN_CLOUD_FILE_H
#define BATTEN_CLOUD_FILE_H

#include "batten/cloud.h"
#include "batten/mesh_file.h"

BAT_C_BEGIN

/// @file
/// Readers of clouds: XYZ, CSV, PLY, OBJ and what scanners write; writers of the first four. docs/formats.md describes the
/// formats.

/// Formats of clouds.
typedef enum bat_cloud_format
{
    /// By the file's ending, failing that by the content.
    BAT_CLOUD_FORMAT_AUTO,
    /// Three numbers a line, blanks between; '#' begins a remark; further columns are left out. A row of names, and one of
    /// the number of points, may come first; other separators make it CSV.
    BAT_CLOUD_FORMAT_XYZ,
    BAT_CLOUD_FORMAT_CSV, ///< with or without a line of names; x, y, z by name or the first three
    BAT_CLOUD_FORMAT_PLY, ///< vertices, ASCII or binary; faces, if there are, make it a mesh
    BAT_CLOUD_FORMAT_OBJ, ///< vertices; faces, if there are, make it a mesh
    BAT_CLOUD_FORMAT_PCD, ///< of the Point Cloud Library: text, binary or compressed; reading only
    BAT_CLOUD_FORMAT_LAS, ///< 1.0 to 1.4, not compressed; reading only
    BAT_CLOUD_FORMAT_PTX, ///< scans with transformations; reading only
    BAT_CLOUD_FORMAT_STL, ///< this and the following are meshes, for reading only
    BAT_CLOUD_FORMAT_OFF,
    BAT_CLOUD_FORMAT_GLB ///< glTF 2.0
} bat_cloud_format;

/// The formats by name.
extern BAT_API const bat_family bat_cloud_format_family;

/// Options of reading. Begin with bat_cloud_read_defaults().
typedef struct bat_cloud_read_options
{
    bat_cloud_format format;
    /// Number of leading points that are the boundary loop. 0: the number in a remark "# N boundary points first" before the
    /// first point, else unknown. A remark "# corners A B C D" gives the corners as indices into the loop, counted from 0.
    size_t boundary;
    /// A second file with the boundary loop; null for none. Its points go first, also in the cloud's `order`. Points of the
    /// first file that repeat one of them are left out.
    const char *boundary_path;
    /// Refuse points that repeat an earlier one. Otherwise they are left out, and bat_cloud::duplicates counts them; in a
    /// mesh, vertices in the same place are merged. Default false.
    bool strict;
    /// Four points of the file, counted from 0, for bat_cloud_set_corners(); the boundary is found where it is not known.
    /// Null: as the file says, the default.
    const size_t *corners;
    /// Of LAS: the classes that are read, between commas, as in "2,8". Null, the default: all but 7 and 18, which are noise.
    const char *classes;
    bat_mesh_notes *notes; ///< what was left out and guessed is appended; may be null, the default
    bat_limits limits;     ///< what is more is refused with BAT_TOO_LARGE; default: those of bat_limits
} bat_cloud_read_options;

/// The options' default values.
BAT_API bat_cloud_read_options bat_cloud_read_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_cloud_read_fields;

/// Read a cloud. A PLY or OBJ file with faces is a mesh, which bat_cloud_from_mesh() converts.
/// @param path    "-" for standard input
/// @param options null for the defaults
/// @param cloud   receives the cloud; release it with bat_cloud_free()
/// @param error   `line` is a line of the main file. A failure of the boundary's file is told in the text, with its line
/// @return BAT_OK; BAT_BAD_FILE with the line; BAT_INVALID_POINT with line and point for a point that is not finite or
///         repeats another, if strict; BAT_INVALID_ARGUMENT for an option that contradicts the file; the failures of
///         bat_cloud_from_mesh(), bat_cloud_find_boundary() and bat_cloud_set_corners(); BAT_FILE_ACCESS, BAT_TOO_LARGE,
///         BAT_UNSUPPORTED or BAT_NO_MEMORY; `cloud` is untouched on failure
BAT_API bat_status bat_cloud_read(const char *path, const bat_cloud_read_options *options, bat_cloud *cloud,
                                  bat_error *error);
/// Write parameters as lines "u v", in the order of the input. "nan nan" stands for a point that was left out.
/// @param path       "-" for standard output
/// @param parameters cloud->count x 2
/// @return BAT_OK, BAT_FILE_ACCESS or BAT_NO_MEMORY
BAT_API bat_status bat_cloud_parameters_write(const char *path, const bat_cloud *cloud, const double *parameters,
                                              bat_error *error);
/// Read the lines of bat_cloud_parameters_write(): one row for each point of the same input. '#' begins a remark.
/// @param parameters receives an array of cloud->count x 2 from malloc(), in the cloud's order
/// @return BAT_OK; BAT_BAD_FILE with the line for a number outside 0 to 1 or a wrong number of rows; BAT_FILE_ACCESS or
///         BAT_NO_MEMORY
BAT_API bat_status bat_cloud_parameters_read(const char *path, const bat_cloud *cloud, double **parameters,
                                             bat_error *error);

BAT_C_END

#endif
