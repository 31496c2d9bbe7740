#ifndef RESEARCH_STUDIES_SPECTRAL_NORM_H
#define RESEARCH_STUDIES_SPECTRAL_NORM_H

#include "batten/base.h"

/// The largest singular value of a matrix, by power iteration on a^T a: from below, to about 1e-9 relative where the two
/// largest differ by a tenth, less where they are nearer.
/// @param a rows x columns, row-major, finite
/// @return BAT_OK, BAT_NO_CONVERGENCE, BAT_NO_MEMORY or the failure of blas_load()
bat_status spectral_norm(size_t rows, size_t columns, const double *a, double *norm, bat_error *error);

#endif
