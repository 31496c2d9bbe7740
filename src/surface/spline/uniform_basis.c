/// @file
/// Uniform B-splines by the recurrence of Cox and de Boor, with integer knots, and their two-scale relations by knot
/// insertion:
///     B_i(coarse) = sum_j R_ij B_j(fine),   R by inserting the midpoints of all cells (Boehm, 1980; The NURBS Book, A5.1).

#include "surface/spline/hierarchical_space.h"

#include "base/error.h"
#include "base/memory.h"

#include <string.h>

/// Insert the midpoints of all cells from left to right. Between insertions, the matrix expresses the coarse functions in
/// those of the current knots; its rows have 2 cells + degree entries.
static void insert_middles(size_t cells, size_t degree, double *matrix)
{
    size_t rows = cells + degree, stride = 2 * cells + degree;
    memset(matrix, 0, rows * stride * sizeof *matrix);
    for (size_t i = 0; i < rows; i++)
        matrix[i * stride + i] = 1;
    for (size_t cell = 0; cell < cells; cell++)
    {
        // Knots up to the beginning of the cell are already fine, 2 cell + degree + 1 in number; the others are coarse.
        size_t middle = 2 * cell + 1, span = 2 * cell + degree, columns = rows + cell;
        for (size_t i = columns; i > span - degree; i--)
        {
            double share = 0;
            if (i <= span)
            {
                size_t lower = i < degree ? 0 : i - degree, upper = 2 * (i - cell < cells ? i - cell : cells);
                share = (double)(middle - lower) / (double)(upper - lower);
            }
            for (double *entry = matrix + i; entry < matrix + rows * stride; entry += stride)
                entry[0] = share * entry[0] + (1 - share) * entry[-1];
        }
    }
}

bat_status uniform_basis_make(int degree, uniform_basis *basis, bat_error *error)
{
    size_t p = (size_t)degree, total = 0;
    for (size_t n = 1; n < 2 * p; n++)
        total += (n + p) * (2 * n + p);
    *basis = (uniform_basis){.degree = degree, .storage = memory_array(total, sizeof *basis->storage)};
    if (basis->storage == NULL)
        return error_memory(error, total * sizeof *basis->storage);
    double *next = basis->storage;
    for (size_t n = 1; n < 2 * p; n++)
    {
        basis->refinement[n] = next;
        insert_middles(n, p, next);
        next += (n + p) * (2 * n + p);
    }
    return BAT_OK;
}

void uniform_basis_free(uniform_basis *basis)
{
    free(basis->storage);
    *basis = (uniform_basis){0};
}

uniform_refinement uniform_basis_refinement(const uniform_basis *basis, size_t cells, size_t cell, size_t half)
{
    size_t p = (size_t)basis->degree, before = cell < p - 1 ? cell : p - 1;
    size_t after = cells - 1 - cell < p - 1 ? cells - 1 - cell : p - 1, near = before + 1 + after;
    size_t stride = 2 * near + p;
    return (uniform_refinement){basis->refinement[near] + before * stride + 2 * before + half, stride};
}

double uniform_basis_two_scale(const uniform_basis *basis, size_t cells, size_t coarse, size_t fine)
{
    size_t p = (size_t)basis->degree, fine_cell = fine < 2 * cells ? fine : 2 * cells - 1, cell = fine_cell / 2;
    if (coarse < cell || coarse > cell + p)
        return 0;
    uniform_refinement refinement = uniform_basis_refinement(basis, cells, cell, fine_cell % 2);
    return refinement.rows[(coarse - cell) * refinement.stride + fine - fine_cell];
}

/// Distances of the knots from a cell, in cells, as algorithm A2.2 of The NURBS Book uses them.
typedef struct cell_knots
{
    int below[BAT_SPLINE_MAX_DEGREE + 1]; ///< [j]: distance of the j-th knot at or before the cell, j >= 1
    int above[BAT_SPLINE_MAX_DEGREE + 1]; ///< [j]: distance of the j-th knot after the beginning of the cell
} cell_knots;

static double reciprocal(int complete)
{
    static const double TABLE[] = {0,      1,      1. / 2,  1. / 3,  1. / 4,  1. / 5,  1. / 6,  1. / 7,
                                   1. / 8, 1. / 9, 1. / 10, 1. / 11, 1. / 12, 1. / 13, 1. / 14, 1. / 15};
    return TABLE[complete];
}

/// Functions of degree j from those of degree j - 1.
static void raise_values(const cell_knots *knots, int j, double s, const double *from, double *to)
{
    double saved = 0;
    for (int r = 0; r < j; r++)
    {
        int above = knots->above[r + 1], below = knots->below[j - r];
        double share = from[r] * reciprocal(above + below);
        to[r] = saved + (above - s) * share;
        saved = (s + below) * share;
    }
    to[j] = saved;
}

/// Derivatives of the functions of degree j from values (or derivatives) of those of degree j - 1.
static void raise_derivatives(const cell_knots *knots, int j, const double *from, double *to)
{
    double before = 0;
    for (int r = 0; r < j; r++)
    {
        double slope = j * from[r] * reciprocal(knots->above[r + 1] + knots->below[j - r]);
        to[r] = before - slope;
        before = slope;
    }
    to[j] = before;
}

void uniform_basis_values(int degree, size_t cells, size_t cell, double s, int derivatives, double *values)
{
    cell_knots knots;
    for (int j = 1; j <= degree; j++)
    {
        knots.below[j] = (size_t)(j - 1) < cell ? j - 1 : (int)cell;
        knots.above[j] = (size_t)j < cells - cell ? j : (int)(cells - cell);
    }
    // The functions of the last three degrees, at the index degree modulo 3.
    double recent[3][BAT_SPLINE_MAX_DEGREE + 1], slopes[BAT_SPLINE_MAX_DEGREE + 1];
    recent[0][0] = 1;
    for (int j = 1; j <= degree; j++)
        raise_values(&knots, j, s, recent[(j - 1) % 3], recent[j % 3]);
    size_t count = (size_t)degree + 1;
    memcpy(values, recent[degree % 3], count * sizeof *values);
    if (derivatives >= 1)
        raise_derivatives(&knots, degree, recent[(degree - 1) % 3], values + count);
    if (derivatives < 2)
        return;
    if (degree < 2)
    {
        memset(values + 2 * count, 0, count * sizeof *values);
        return;
    }
    raise_derivatives(&knots, degree - 1, recent[(degree - 2) % 3], slopes);
    raise_derivatives(&knots, degree, slopes, values + 2 * count);
}
