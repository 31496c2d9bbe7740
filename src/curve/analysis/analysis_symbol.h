#ifndef CURVE_ANALYSIS_ANALYSIS_SYMBOL_H
#define CURVE_ANALYSIS_ANALYSIS_SYMBOL_H

#include "batten/curve_scheme.h"

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

/// a(z) / (1 + z)^order, the mask that refines differences of that order; `order` up to the multiplicity.
bat_mask symbol_difference(const mask_symbol *symbol, size_t order);

/// The largest degree d below the multiplicity with a^(k)(1) = 2 shift (shift - 1) … (shift - k + 1) for all k <= d
/// (Dyn, Hormann, Sabin and Shen 2008, theorem 4.3).
size_t symbol_reproduction_degree(const mask_symbol *symbol);

#endif
