#include "research/learn/packed_norm.h"

#include "research/learn/functions.h"

// A function with clones must be static: compilers export the clones of a hidden function.

LANES_CLONES
static void norm_gelu(size_t rows, size_t columns, const real *gain, const real *shift, const real *skip, real *y)
{
    for (size_t r = 0; r < rows; r++)
    {
        real *restrict row = y + r * columns;
        real mean, rate;
        row_statistics(row, columns, &mean, &rate);
        if (skip != NULL)
            for (size_t c = 0; c < columns; c++)
                row[c] = real_gelu(skip[r * columns + c] + ((row[c] - mean) * rate * gain[c] + shift[c]));
        else
            for (size_t c = 0; c < columns; c++)
                row[c] = real_gelu((row[c] - mean) * rate * gain[c] + shift[c]);
    }
}

LANES_CLONES
static void gelu(size_t count, real *y)
{
    for (size_t i = 0; i < count; i++)
        y[i] = real_gelu(y[i]);
}

void learn_packed_norm_gelu(size_t rows, size_t columns, const real *gain, const real *shift, const real *skip, real *y)
{
    norm_gelu(rows, columns, gain, shift, skip, y);
}

void learn_packed_gelu(size_t count, real *y)
{
    gelu(count, y);
}
