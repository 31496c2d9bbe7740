#ifndef BATTEN_SURFACE_PICTURE_H
#define BATTEN_SURFACE_PICTURE_H

#include "batten/cloud.h"
#include "batten/spline_hierarchical.h"

BAT_C_BEGIN

/// @file
/// Pictures of fitted surfaces, as figure 14 of Giannelli et al., "BIDGCN" (2023).

/// What a row of panels shows. Panels whose data is null are left out.
typedef struct bat_surface_picture_row
{
    const char *title;                 ///< of the row; may be null
    const bat_cloud *cloud;            ///< the points
    const bat_spline_surface *surface; ///< of dimension 3
    const double *distances;           ///< of the cloud's points, for error colours
    const double *parameters;          ///< of the cloud's points, for the parameter plane
} bat_surface_picture_row;

/// How. All zero: the defaults.
typedef struct bat_surface_picture_options
{
    int width;            ///< pixels of a panel, 60 to 4000; 0: 420
    double largest_error; ///< the end of the colour scale; 0: the 99th per cent of all distances
    /// Where the eye is, as seen from the middle. Zeros: a little above and beside the mean normal, on the side to which the
    /// surface bulges; across the broad side of one that nearly closes or whose boundary is not known.
    double view[3];
    double up[3]; ///< what is upwards; zeros: z, or y where the surface faces z
} bat_surface_picture_options;

/// The options' default values.
BAT_API bat_surface_picture_options bat_surface_picture_defaults(void);
/// Check options; null passes.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field out of range
BAT_API bat_status bat_surface_picture_options_check(const bat_surface_picture_options *options, bat_error *error);

/// Draw rows of: cloud, surface, points coloured by error, parameter plane with the hierarchical mesh. PNG, SVG or PDF by
/// the ending. The file appears whole or not at all; the same input gives the same bytes.
/// @param options null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT for another ending, an option out of range, a row without cloud and surface, with
/// distances or
///         parameters but no cloud, with a surface that is not in space; BAT_INVALID_POINT with the point or control point
///         that is not finite, whose distance is not a finite length or whose parameters are not in the square;
///         BAT_NO_MEMORY; BAT_FILE_ACCESS
BAT_API bat_status bat_surface_picture_write(const char *path, const bat_surface_picture_row *rows, size_t count,
                                             const bat_surface_picture_options *options, bat_error *error);

BAT_C_END

#endif
