#pragma once

#include "batten/curve_analysis.h"
#include "batten/curve_scheme.h"
#include "linalg/joint_radius.h"

/// A checked mask without zeros at its ends, and what its Laurent polynomial a(z) = sum a(k) z^k says.
typedef struct mask_symbol
{
    bat_mask mask;       ///< count >= 2
    int last;            ///< index of the last coefficient
    size_t multiplicity; ///< n of the largest factor (1 + z)^n, to rounding; at least 1
    bat_mask quotient;   ///< a(z) / (1 + z)^multiplicity
    double remainder;    ///< largest |coefficient| of a(z) - (1 + z)^n quotient(z)
    double shift;        ///< a'(1) / 2
} mask_symbol;

/// Check a mask and factor its symbol.
/// @return BAT_OK or BAT_INVALID_ARGUMENT: no coefficients, too many, not finite, or sums over even and odd indices not 1
bat_status symbol_make(const bat_mask *mask, mask_symbol *result, bat_error *error);

/// Divide by (1 + z)^n if that leaves nothing but rounding.
///
/// The quotient's lower half is found from the low end and its upper half from the high end, where coefficients are small
/// and exact; dividing across the middle would let rounding grow like a binomial. The remainder counts as rounding when,
/// index by index, it is at most (16 + 2 n) epsilon times the coefficient of (1 + z)^n |quotient|(z).
bool symbol_divide(const bat_mask *mask, size_t n, bat_mask *quotient, double *remainder);

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

/// The stencil of the limit at 0: weight -k is the basic limit function at the integer k. The scheme must converge.
bat_status limit_point(const mask_symbol *symbol, bat_mask_stencil *stencil, bat_error *error);
/// The stencil of the derivative there; count 0 unless 1/2 is a simple eigenvalue and only 1 is larger.
bat_status limit_tangent(const mask_symbol *symbol, const bat_analysis *analysis, bat_mask_stencil *stencil,
                         bat_error *error);
/// The stencil of the limit at the parameter of a point, from limit_point()'s.
void limit_vertex(const mask_symbol *symbol, const bat_mask_stencil *point, bat_mask_stencil *stencil);

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
