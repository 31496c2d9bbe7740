#pragma once

#include "batten/curve_scheme.h"

#include <float.h>

/// @file
/// The limit of a linear scheme at the integers, from its mask, and how fast differences shrink.

/// Rounding of a coefficient that a reader of decimal numbers or a short formula leaves.
#define COEFFICIENT_ROUNDING (16.0 * DBL_EPSILON)

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

/// The left eigenvector of the local matrix, scaled so that its product with the points (index - centre)^power is 1; the
/// power is 1 with `against_index`, else 0.
bat_status limit_left(const bat_mask *mask, double eigenvalue, bool against_index, bat_mask_stencil *stencil,
                      bat_error *error);
/// The stencil of the limit at 0: weight -k is the basic limit function at the integer k. The scheme must converge.
bat_status limit_point(const mask_symbol *symbol, bat_mask_stencil *stencil, bat_error *error);
/// The stencil of the limit at the parameter of a point, from limit_point()'s.
void limit_vertex(const mask_symbol *symbol, const bat_mask_stencil *point, bat_mask_stencil *stencil);

/// The weight of a point; 0 beyond the stencil.
double limit_weight(const bat_mask_stencil *stencil, int offset);

/// The largest sum of moduli over a residue class of indices: the maximum norm of subdivision with this arity.
double mask_operator_norm(const double *coefficients, size_t count, size_t arity);

/// The mask of several subdivision steps taken as one: q(z) q(z^2) … q(z^(2^(steps - 1))).
typedef struct iterated_mask
{
    const bat_mask *mask;
    double *coefficients;
    double *next;
    size_t count;
    size_t arity;
    double norm_of_step;
} iterated_mask;

bat_status iterated_mask_begin(const bat_mask *mask, iterated_mask *iterated, bat_error *error);
/// One more step; false when the mask gets too long.
bool iterated_mask_step(iterated_mask *iterated);
void iterated_mask_end(iterated_mask *iterated);
/// min over k <= depth of |S^k|^(1/k) in the maximum norm (Dyn 1992): cheap, and good when nothing else is.
bat_status mask_iterated_norm(const bat_mask *mask, size_t depth, double *best, bat_error *error);
/// Multiply a mask by 1 + z.
void mask_multiply_by_factor(bat_mask *mask);
