#ifndef CURVE_ANALYSIS_ANALYSIS_LIMIT_H
#define CURVE_ANALYSIS_ANALYSIS_LIMIT_H

#include "batten/curve_analysis.h"
#include "curve/analysis/analysis_symbol.h"

/// The points that determine the limit at 0 of the index parametrization: `size` of them, the first of index `first`.
/// An index i of the next level needs the points from (i - last) / 2 to (i - first) / 2, so 1 - last … -first - 1 need only
/// themselves.
static inline int limit_matrix_first(const bat_mask *mask)
{
    return 2 - mask->first - (int)mask->count;
}
static inline size_t limit_matrix_size(const bat_mask *mask)
{
    return mask->count > 2 ? mask->count - 2 : 0;
}
/// Entry (i, j) is mask(i - 2 j).
void limit_matrix(const bat_mask *mask, double *matrix);

/// Fill eigenvalues and eigenvectors of an analysis whose matrix is there. The eigenvalues 1, 1/2, … 2^(1 - n) that the
/// factor (1 + z)^n brings are taken as exact; the others are those of the quotient's local matrix.
bat_status limit_eigenvalues(const mask_symbol *symbol, bat_analysis *analysis, bat_error *error);

/// The stencil of the limit at 0 of the index parametrization; weight -k is the basic limit function at the integer k. The
/// scheme must converge.
bat_status limit_point(const mask_symbol *symbol, bat_mask_stencil *stencil, bat_error *error);
/// The stencil of the derivative there; count 0 unless 1/2 is a simple eigenvalue and only 1 is larger.
bat_status limit_tangent(const mask_symbol *symbol, const bat_analysis *analysis, bat_mask_stencil *stencil,
                         bat_error *error);
/// The stencil of the limit at the parameter of a point, from limit_point()'s.
void limit_vertex(const mask_symbol *symbol, const bat_mask_stencil *point, bat_mask_stencil *stencil);

#endif
