#ifndef BATTEN_SURFACE_FILE_H
#define BATTEN_SURFACE_FILE_H

#include "batten/shell.h"
#include "batten/spline.h"

BAT_C_BEGIN

/// @file
/// Readers and writers of spline surfaces: XML of G+Smo, STEP, IGES, VTK, OBJ and JSON. docs/formats.md describes the
/// formats.

/// Formats of surfaces.
typedef enum bat_surface_format
{
    BAT_SURFACE_FORMAT_AUTO, ///< by the file's ending: .xml, .step or .stp, .vtk, .obj, .json, .iges or .igs
    BAT_SURFACE_FORMAT_XML,  ///< G+Smo: THBSpline2, of the plain basis HBSpline2, of one level TensorBSpline2; exact
    /// ISO 10303-21, B_SPLINE_SURFACE_WITH_KNOTS: one shell of tensor-product patches; a trimmed surface as one face; exact
    BAT_SURFACE_FORMAT_STEP,
    BAT_SURFACE_FORMAT_VTK, ///< legacy, a quadrilateral grid of each cell, with level, and the data points with their errors
    BAT_SURFACE_FORMAT_OBJ, ///< triangles
    BAT_SURFACE_FORMAT_JSON, ///< degrees, boxes, functions, control points, trimming curves; exact
    BAT_SURFACE_FORMAT_IGES  ///< 5.3: a rational B-spline surface (128), a trimmed one as trimmed surface (144); exact
} bat_surface_format;

/// The formats by name.
extern BAT_API const bat_family bat_surface_format_family;

/// The unit of length that CAD files name. Coordinates are written as they are.
typedef enum bat_surface_unit
{
    BAT_SURFACE_UNIT_AUTO, ///< the default: BAT_SURFACE_UNIT_MILLIMETRE
    BAT_SURFACE_UNIT_MILLIMETRE,
    BAT_SURFACE_UNIT_METRE,
    BAT_SURFACE_UNIT_INCH
} bat_surface_unit;

/// The units by name.
extern BAT_API const bat_family bat_surface_unit_family;

/// Options of writing. Begin with bat_surface_write_defaults().
typedef struct bat_surface_write_options
{
    bat_surface_format format;
    bat_surface_unit unit; ///< for STEP and IGES; default millimetre
    size_t samples;        ///< of each cell and direction for VTK and OBJ, at most 1024; 0: as many as the degree plus 1
    const double *points;  ///< point_count x 3: data points, for VTK; null for none
    const double *errors;  ///< point_count: their distances, for VTK; null for none
    size_t point_count;
} bat_surface_write_options;

/// The options' default values.
BAT_API bat_surface_write_options bat_surface_write_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_surface_write_fields;

/// Write a surface; the file appears whole or not at all.
/// @param path    "-" for standard output (with a format)
/// @param surface of dimension 3 (XML and JSON: any)
/// @param options null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_INVALID_POINT with a control point or data point that is not finite;
///         BAT_UNSUPPORTED for a dimension that the format does not have, or triangles of which trimming leaves none;
///         BAT_TOO_LARGE beyond 2^32 - 1 samples or entities; BAT_FILE_ACCESS; BAT_NO_MEMORY
BAT_API bat_status bat_surface_write(const char *path, const bat_spline_surface *surface,
                                     const bat_surface_write_options *options, bat_error *error);
/// Write a surface as the simple shape that its points lie on, with its outline projected onto the shape. Edges are lines
/// and circles where these are as near as the points. The spline is written in formats other than STEP, and where the shape
/// needs a seam or a pole.
/// @param shape of bat_surface_find_primitive()
/// @param edges null, or receives the numbers of splines, lines and circles, all 0 where the spline was written
/// @param area  null, or receives that of the shape; NaN where the spline was written
/// @return as bat_surface_write()
BAT_API bat_status bat_surface_write_shape(const char *path, const bat_spline_surface *surface,
                                           const bat_surface_primitive *shape, const bat_surface_write_options *options,
                                           size_t edges[3], double *area, bat_error *error);
/// Write a shell: as STEP, whose closed parts are solids, or as a mesh in a format of batten/mesh_file.h that has polygons.
/// @param options null for the defaults; the format and the unit count, and `samples` of each patch for meshes
/// @return as bat_surface_write(); BAT_UNSUPPORTED for another format
BAT_API bat_status bat_shell_write(const char *path, const bat_shell *shell, const bat_surface_write_options *options,
                                   bat_error *error);
/// Read a surface from G+Smo XML (THBSpline2, HBSpline2, TensorBSpline2 on clamped uniform knots) or from JSON. The order of
/// functions and boxes in G+Smo is converted.
/// @param surface untouched on failure
/// @return BAT_OK; BAT_BAD_FILE with the line; BAT_UNSUPPORTED for other content; BAT_TOO_LARGE for a space far larger than
///         its coefficients; BAT_FILE_ACCESS; BAT_NO_MEMORY
BAT_API bat_status bat_surface_read(const char *path, bat_spline_surface *surface, bat_error *error);

BAT_C_END

#endif
