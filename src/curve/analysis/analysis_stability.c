#include "curve/analysis/analysis_smoothness.h"

#include <math.h>

// Integer shifts of phi are stable unless some z on the unit circle is a "zero": phi^(x + 2 pi k) = 0 for all integers k,
// where z = exp(-i x). The refinement equation says: if z is a zero and w^2 = z, then a(w) = 0 or w is a zero, for both
// roots w. There are finitely many zeros, and 1 is none. So when a has no two zeros w and -w on the circle, then every zero
// has exactly one root that is a zero, and squaring permutes them; the zeros w form cycles of roots of unity of odd order,
// with a(-w) = 0 throughout. (Jia and Wang 1993, theorem 2, where the converse is proven too.)
//
// Both conditions are checked with the quotient q(z) = a(z) / (1 + z)^n on cells of the circle: a's other zeros, at z = -1,
// pair with z = 1, where a is 2, and belong to the cycle of 1. A cell counts as free of zeros when |q| at its middle exceeds
// what q can change within the cell. Doubling the angle takes cell c to the cells 2 c and 2 c + 1, so a cycle of zeros is a
// cycle in a graph.

/// Cells of the circle, a power of two.
#define CELLS 16384u
/// Rounding in a value of q, relative to the sum of the moduli of its coefficients.
#define VALUE_ROUNDING 1e-13

/// A lower bound of |q| over cell `cell` of the circle, whose middle has the angle 2 pi (cell + 1/2) / CELLS.
static double min_modulus(const bat_mask *q, size_t cell, double distance)
{
    const double pi = 3.14159265358979323846;
    const double angle = 2.0 * pi * ((double)cell + 0.5) / CELLS;
    const double middle = 0.5 * (double)(q->count - 1);
    double real = 0.0;
    double imaginary = 0.0;
    double size = 0.0;
    double slope = 0.0;
    for (size_t k = 0; k < q->count; k++)
    {
        real += q->coefficients[k] * cos((double)k * angle);
        imaginary += q->coefficients[k] * sin((double)k * angle);
        size += fabs(q->coefficients[k]);
        slope += fabs(q->coefficients[k]) * fabs((double)k - middle);
    }
    return hypot(real, imaginary) - slope * pi / CELLS - VALUE_ROUNDING * size - distance;
}

static bool has_symmetric_zeros(const bool *may_vanish)
{
    for (size_t cell = 0; cell < CELLS / 2; cell++)
    {
        if (may_vanish[cell] && may_vanish[cell + CELLS / 2])
            return true;
    }
    return false;
}

/// Whether cell `cell` of w may be on a cycle, given which others may: it needs one before it and one after it. The two
/// cells that touch w = 1 may not follow themselves, since only w = 1 stays there.
static bool keeps_company(const bool *alive, size_t cell)
{
    const size_t after[2] = {2 * cell % CELLS, (2 * cell + 1) % CELLS};
    const size_t before[2] = {cell / 2, cell / 2 + CELLS / 2};
    bool has_after = false;
    bool has_before = false;
    for (size_t i = 0; i < 2; i++)
    {
        has_after = has_after || (after[i] != cell && alive[after[i]]);
        has_before = has_before || (before[i] != cell && alive[before[i]]);
    }
    return has_after && has_before;
}

static bool has_cycle(bool *alive)
{
    for (bool changed = true; changed;)
    {
        changed = false;
        for (size_t cell = 0; cell < CELLS; cell++)
        {
            if (alive[cell] && !keeps_company(alive, cell))
            {
                alive[cell] = false;
                changed = true;
            }
        }
    }
    for (size_t cell = 0; cell < CELLS; cell++)
    {
        if (alive[cell])
            return true;
    }
    return false;
}

bool smoothness_is_stable(const bat_mask *quotient, double distance)
{
    bool may_vanish[CELLS];
    bool alive[CELLS];
    for (size_t cell = 0; cell < CELLS; cell++)
        may_vanish[cell] = min_modulus(quotient, cell, distance) <= 0.0;
    for (size_t cell = 0; cell < CELLS; cell++)
        alive[cell] = may_vanish[(cell + CELLS / 2) % CELLS];
    return !has_symmetric_zeros(may_vanish) && !has_cycle(alive);
}
