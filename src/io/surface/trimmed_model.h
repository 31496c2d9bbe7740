#ifndef IO_SURFACE_TRIMMED_MODEL_H
#define IO_SURFACE_TRIMMED_MODEL_H

#include "batten/spline.h"
#include "surface/spline/tensor_surface.h"

/// @file
/// A hierarchical surface as one tensor-product surface, with its trimming curves in space, for CAD files.

/// The model. Release it with trimmed_model_free().
typedef struct trimmed_model
{
    tensor_surface surface;      ///< over the grid of the finest level
    const bat_spline_trim *trim; ///< of the hierarchical surface
    bat_spline_curve *images;    ///< of each trimming curve: the curve in space, with the same parameters
    size_t piece_count;
    double tolerance; ///< points at smaller distances are identified
} trimmed_model;

/// Make the model.
/// @return BAT_OK; BAT_TOO_LARGE where the finest level has more than 2^20 functions; BAT_NO_MEMORY
bat_status trimmed_model_make(const bat_spline_surface *surface, trimmed_model *model, bat_error *error);
void trimmed_model_free(trimmed_model *model);

/// The power of ten below the diagonal of the box of control points, times 1e-7.
double model_tolerance(const tensor_surface *patches, size_t count);

/// Write a real number, which has a decimal point in CAD files.
/// @param out    has room for NUMBER_TEXT_SIZE + 1 characters
/// @param letter of the exponent
/// @return the end of the text
char *model_real(char *out, double value, char letter);

#endif
