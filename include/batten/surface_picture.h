#ifndef BATTEN_SURFACE_PICTURE_H
#define BATTEN_SURFACE_PICTURE_H

#include "batten/cloud.h"
#include "batten/shell.h"
#include "batten/spline.h"

BAT_C_BEGIN

/// @file
/// Pictures of fitted surfaces, in the style of figure 14 of Giannelli et al., "BIDGCN" (2023).

/// One row of panels. Panels whose data is null are left out.
typedef struct bat_surface_picture_row
{
    const char *title;                 ///< of the row; may be null
    const bat_cloud *cloud;            ///< the points
    const bat_spline_surface *surface; ///< of dimension 3
    const double *distances;           ///< of the cloud's points, for error colours
    const double *parameters;          ///< of the cloud's points, for the parameter plane
} bat_surface_picture_row;

/// Options of pictures. Begin with bat_surface_picture_defaults().
typedef struct bat_surface_picture_options
{
    int width;            ///< pixels of a panel, 60 to 4000; 0: 420
    double largest_error; ///< the end of the colour scale; 0: the 99th per cent of all distances
    /// The direction of the viewer from the centre. Zeros: a little above and beside the mean normal, on the convex side. A
    /// surface that nearly closes, or one without a boundary, is seen across its broad side.
    double view[3];
    double up[3]; ///< the upward direction; zeros: z, or y where the surface faces z
} bat_surface_picture_options;

/// The options' default values.
BAT_API bat_surface_picture_options bat_surface_picture_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_surface_picture_fields;

/// Draw rows of panels: cloud, surface, points coloured by error, parameter plane with the hierarchical mesh. The ending
/// chooses PNG, SVG or PDF. The file appears whole or not at all; the same input gives the same bytes.
/// @param options null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT for another ending, an option out of range, or a row without cloud and surface,
///         without the cloud of its distances or parameters, or with a surface that is not in R^3; BAT_INVALID_POINT with a
///         point or control point that is not finite, a distance that is not a finite length, or a parameter outside of the
///         square; BAT_NO_MEMORY; BAT_FILE_ACCESS
BAT_API bat_status bat_surface_picture_write(const char *path, const bat_surface_picture_row *rows, size_t count,
                                             const bat_surface_picture_options *options, bat_error *error);

/// What the panels of surfaces show.
typedef enum bat_surface_view
{
    BAT_SURFACE_VIEW_SHADED,   ///< the default
    BAT_SURFACE_VIEW_ZEBRA,    ///< reflected stripes, which break where the surface is not smooth
    BAT_SURFACE_VIEW_CURVATURE ///< mean curvature, positive where the surface bulges towards the viewer
} bat_surface_view;

extern BAT_API const bat_family bat_surface_view_family; ///< the choices by name
#define BAT_SURFACE_MAX_BANDS 4                          ///< on each side

/// What inspectors look at. All zero: as bat_surface_picture_write().
typedef struct bat_surface_inspection
{
    bat_surface_view view;
    const double *bands; ///< band_count, above 0 and rising: distances that bound colours on each side; null: a scale
    size_t band_count;   ///< at most BAT_SURFACE_MAX_BANDS
} bat_surface_inspection;

/// Draw rows for an inspection (null: all zero). With bands, the legend has the share of the points in each, and rows with
/// distances need a surface and parameters.
/// @return as bat_surface_picture_write(); BAT_INVALID_ARGUMENT also for a wrong inspection
BAT_API bat_status bat_surface_picture_inspect(const char *path, const bat_surface_picture_row *rows, size_t count,
                                               const bat_surface_inspection *inspection,
                                               const bat_surface_picture_options *options, bat_error *error);

/// Draw a shell with the sides of its faces and, beside it, points by their distances from it. Views other than shaded leave
/// out the sides.
/// @param title   may be null
/// @param points  count x 3; with 0 points the shell is alone
/// @param options null for the defaults, with panels of 640 pixels
/// @return as bat_surface_picture_inspect(); BAT_INVALID_ARGUMENT also for a shell without faces
BAT_API bat_status bat_shell_picture_write(const char *path, const char *title, const bat_shell *shell, const double *points,
                                           size_t count, const bat_surface_inspection *inspection,
                                           const bat_surface_picture_options *options, bat_error *error);

BAT_C_END

#endif
