#ifndef SURFACE_SPLINE_UNIFORM_BASIS_H
#define SURFACE_SPLINE_UNIFORM_BASIS_H

#include "batten/spline.h"

/// @file
/// The B-splines of degree p of a clamped uniform knot vector, seen from one of its cells. Cell c of a grid of `cells` sees
/// functions c to c + p. What they look like there depends only on how far the ends are, up to p - 1 cells away: a small
/// grid that has the ends as near says the same, so that one short table serves grids of any size.

/// Two-scale relations of a degree. Release it with uniform_basis_free().
typedef struct uniform_basis
{
    int degree;                                    ///< at least 1
    double *refinement[2 * BAT_SPLINE_MAX_DEGREE]; ///< [n]: for a grid of n cells, (n + p) x (2 n + p)
    double *storage;                               ///< owned
} uniform_basis;

bat_status uniform_basis_make(int degree, uniform_basis *basis, bat_error *error);
void uniform_basis_free(uniform_basis *basis);

/// A block of (p + 1) x (p + 1) numbers, rows `stride` apart.
typedef struct uniform_refinement
{
    const double *rows;
    size_t stride;
} uniform_refinement;

/// The functions of a cell in those of its lower (half 0) or upper (half 1) half, a cell of the grid twice as fine: row a
/// says function cell + a in fine functions 2 cell + half to 2 cell + half + p.
uniform_refinement uniform_basis_refinement(const uniform_basis *basis, size_t cells, size_t cell, size_t half);

/// The coefficient of one fine function in one coarse function of a grid of `cells`.
double uniform_basis_two_scale(const uniform_basis *basis, size_t cells, size_t coarse, size_t fine);

/// The functions of a cell at a place s of it, 0 to 1, and their derivatives by s.
/// @param derivatives 0 to 2
/// @param values      receives (derivatives + 1) x (p + 1) numbers
void uniform_basis_values(int degree, size_t cells, size_t cell, double s, int derivatives, double *values);

#endif
