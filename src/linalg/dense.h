#pragma once

#include "batten/base.h"

/// @file
/// Decompositions of small dense matrices, row-major and square of side `n` unless said otherwise. All give BAT_OK,
/// BAT_NO_MEMORY, or BAT_NO_CONVERGENCE where an iteration did not converge.

/// The left eigenvector x of `eigenvalue`, which must be simple, with sum constraint_i x_i = 1: the least squares solution
/// of (a^T - eigenvalue I) x = 0 and the constraint.
bat_status dense_left_vector(size_t n, const double *a, double eigenvalue, const double *constraint, double *vector,
                             bat_error *error);

/// The x of least |a x - b|, where a is rows x columns of full rank with rows >= columns. Destroys `a`.
/// @param b `rows` numbers; receives x as its first `columns` numbers, and the residual in other axes as the last ones
bat_status decompose_least_squares(size_t rows, size_t columns, double *a, double *b, bat_error *error);

/// Solve a x = b by elimination with row exchanges; BAT_NO_CONVERGENCE also for a singular matrix, or the failure of
/// blas_load(). Destroys `a`.
/// @param b n x columns; receives x
bat_status decompose_solve(size_t n, size_t columns, double *a, double *b, bat_error *error);

/// The eigenvalues of a symmetric matrix in ascending order; of `a` only the upper triangle is read.
/// @param a receives the eigenvectors as columns
bat_status decompose_symmetric(size_t n, double *a, double *values, bat_error *error);

/// The Householder vector of x, with v[0] = 1, in its place: (I - beta v v^T) x is a multiple of the first unit vector.
double dense_reflector(size_t m, double *v);
/// Rows `at` and on of an m-row reflector times the columns from `from` to the last.
void dense_reflect_rows(size_t n, double *a, size_t at, size_t m, const double *v, double beta, size_t from);
