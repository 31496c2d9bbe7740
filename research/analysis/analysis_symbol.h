#pragma once

#include "batten/research/curve_analysis.h"
#include "curve/limit.h"
#include "research/analysis/joint_radius.h"

/// Fill eigenvalues and eigenvectors of an analysis whose matrix is there. The eigenvalues 1, 1/2, … 2^(1 - n) that the
/// factor (1 + z)^n brings are taken as exact; the others are those of the quotient's local matrix.
bat_status limit_eigenvalues(const mask_symbol *symbol, bat_analysis *analysis, bat_error *error);

/// The stencil of the derivative there; count 0 unless 1/2 is a simple eigenvalue and only 1 is larger.
bat_status limit_tangent(const mask_symbol *symbol, const bat_analysis *analysis, bat_mask_stencil *stencil,
                         bat_error *error);
/// The most vertices that an analysis may be told to use.
#define ANALYSIS_VERTEX_LIMIT 100000

/// The two matrices by which a mask of count coefficients takes count - 1 (at least 1) neighbouring values to the next
/// level: entry (r, c) of matrix e is mask(r - 2 c + count - 1 - e), with the mask's indices counted from 0.
/// @param matrices a set of two with that dimension
void smoothness_matrices(const bat_mask *mask, double *matrices);
static inline size_t smoothness_dimension(const bat_mask *mask)
{
    return mask->count > 1 ? mask->count - 1 : 1;
}

/// Bounds of the joint spectral radius of a mask's matrices, the growth rate of its subdivision operator.
/// @param stop_below stop as soon as the radius is proven to be below this; 0 for never
bat_status smoothness_radius(const bat_mask *mask, const bat_mask_analyze_options *options, double stop_below,
                             joint_radius *radius, bat_error *error);

/// Whether the integer shifts of the basic limit function of (1 + z)^n quotient(z), n >= 1, are proven to be stable: there
/// is a constant C with max |c_j| <= C max |sum c_j phi(x - j)| for all bounded c. The same is proven for every quotient
/// whose coefficients differ in sum of moduli by at most `distance`.
bool smoothness_is_stable(const bat_mask *quotient, double distance);
