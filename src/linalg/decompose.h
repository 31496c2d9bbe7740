#ifndef LINALG_DECOMPOSE_H
#define LINALG_DECOMPOSE_H

#include "batten/base.h"

/// @file
/// Decompositions of small dense matrices, on which linalg/dense.h rests.
/// Matrices are row-major and square of side `n` unless said otherwise. All give BAT_OK, BAT_NO_MEMORY, or
/// BAT_NO_CONVERGENCE where an iteration did not converge.

/// The eigenvalues of `a`, which is destroyed. Complex ones stand in pairs, positive imaginary part first.
bat_status decompose_eigenvalues(size_t n, double *a, double *real, double *imaginary, bat_error *error);

/// The eigenvalues of `a`, which is destroyed, and the right eigenvectors of length 1 as columns; of a complex pair, the
/// real part of the first one's and its imaginary part share two columns.
/// @param right  receives n x n
/// @param cosine receives n cosines between left and right eigenvectors
bat_status decompose_eigenvectors(size_t n, double *a, double *real, double *imaginary, double *right, double *cosine,
                                  bat_error *error);

/// The singular values of a complex matrix (real part, imaginary part), which is destroyed, in descending order.
/// @param adjoint receives n x n complex numbers: V^H of a = U diag(values) V^H
bat_status decompose_singular(size_t n, double *a, double *values, double *adjoint, bat_error *error);

/// The x of least |a x - b|, where a is rows x columns of full rank with rows >= columns. Destroys `a`.
/// @param b `rows` numbers; receives x as its first `columns` numbers
bat_status decompose_least_squares(size_t rows, size_t columns, double *a, double *b, bat_error *error);

/// P a = L U by elimination with row exchanges, in place: row k was exchanged with row pivots[k]. False for a singular
/// matrix.
bool decompose_factor(size_t n, double *a, size_t *pivots);
/// Solve a x = b by the factors of decompose_factor().
/// @param b n x columns; receives x
void decompose_substitute(size_t n, size_t columns, const double *a, const size_t *pivots, double *b);
/// Solve a x = b by elimination with row exchanges; BAT_NO_CONVERGENCE also for a singular matrix. Destroys `a`.
/// @param b n x columns; receives x
bat_status decompose_solve(size_t n, size_t columns, double *a, double *b, bat_error *error);

/// The eigenvalues of a symmetric matrix in ascending order; of `a` only the upper triangle is read.
/// @param a receives the eigenvectors as columns
bat_status decompose_symmetric(size_t n, double *a, double *values, bat_error *error);

#endif
