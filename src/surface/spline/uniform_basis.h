#ifndef SURFACE_SPLINE_UNIFORM_BASIS_H
#define SURFACE_SPLINE_UNIFORM_BASIS_H

#include "batten/spline.h"

/// @file
/// B-splines of degree p over a clamped uniform knot vector, evaluated on a cell.
///
/// On cell c, functions c to c + p do not vanish. They depend only on the distances of the cell from both ends of the grid,
/// up to p - 1 cells. A small grid with the same distances has the same functions there. Hence one table of two-scale
/// relations for grids of 1 to 2 p - 1 cells serves all grids.

/// The two-scale relations of a degree. Release it with uniform_basis_free().
typedef struct uniform_basis
{
    int degree;                                    ///< at least 1
    double *refinement[2 * BAT_SPLINE_MAX_DEGREE]; ///< [n]: matrix (n + p) x (2 n + p) of the grid with n cells
    double *storage;                               ///< owned
} uniform_basis;

bat_status uniform_basis_make(int degree, uniform_basis *basis, bat_error *error);
void uniform_basis_free(uniform_basis *basis);

/// A (p + 1) x (p + 1) block of a matrix; consecutive rows are `stride` numbers apart.
typedef struct uniform_refinement
{
    const double *rows;
    size_t stride;
} uniform_refinement;

/// The two-scale relation on the lower (half 0) or upper (half 1) half of a cell. Row a holds the coefficients of function
/// cell + a in the fine functions 2 cell + half to 2 cell + half + p.
uniform_refinement uniform_basis_refinement(const uniform_basis *basis, size_t cells, size_t cell, size_t half);

/// The coefficient of a fine function in a coarse function of a grid with `cells` cells.
double uniform_basis_two_scale(const uniform_basis *basis, size_t cells, size_t coarse, size_t fine);

/// The functions of a cell at the local coordinate s in [0, 1], and their derivatives with respect to s.
/// @param derivatives 0 to 2
/// @param values      receives (derivatives + 1) x (p + 1) numbers
void uniform_basis_values(int degree, size_t cells, size_t cell, double s, int derivatives, double *values);

#endif
