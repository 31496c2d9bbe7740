#pragma once

#include <math.h>

/// A sum that does not lose the low digits of its terms (Neumaier 1974).
typedef struct exact_sum
{
    double value, lost;
} exact_sum;

static inline void sum_add(exact_sum *sum, double term)
{
    double value = sum->value + term;
    sum->lost += fabs(sum->value) >= fabs(term) ? (sum->value - value) + term : (term - value) + sum->value;
    sum->value = value;
}

static inline double sum_total(const exact_sum *sum)
{
    return isfinite(sum->lost) ? sum->value + sum->lost : sum->value;
}
