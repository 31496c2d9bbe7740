#pragma once

#include "batten/base.h"

/// @file
/// Eigenvalues and singular values of small dense matrices, row-major and square of side `n` unless said otherwise.
/// Calls that return a status give BAT_OK, BAT_NO_MEMORY, or BAT_NO_CONVERGENCE where an iteration did not converge.

/// product = a b
void dense_multiply(size_t n, const double *a, const double *b, double *product);
/// result = a x
void dense_apply(size_t n, const double *a, const double *x, double *result);
/// The Frobenius norm.
double dense_norm(size_t n, const double *a);

/// The largest modulus of an eigenvalue, as computed: without any allowance for rounding.
/// @param scratch room for n (n + 2) numbers
bat_status dense_spectral_radius(size_t n, const double *a, double *scratch, double *radius, bat_error *error);

/// A number that no spectral radius of a matrix within `distance` of `a` (spectral norm) falls below, rounding included.
///
/// The eigenvalues of such a matrix lie in discs about the computed eigenvalues of `a`, of radius n distance / s where s is
/// the cosine between left and right eigenvector; a connected set of k discs holds k of them (Bauer and Fike; Demmel 1997,
/// theorem 4.5). Defective eigenvalues get large discs, so they weaken the bound but never spoil it.
bat_status dense_spectral_radius_below(size_t n, const double *a, double distance, double *bound, bat_error *error);

/// The eigenvalue of largest modulus and its right eigenvector of largest entry 1; `imaginary` is zero for a real one.
bat_status dense_leading_vector(size_t n, const double *a, double *real, double *imaginary, bat_error *error);

/// All eigenvalues, each with the radius within which rounding may have moved it.
bat_status dense_eigenvalues(size_t n, const double *a, double *real, double *imaginary, double *radius, bat_error *error);

/// An orthonormal basis of the approximate null space of a - (real + i imaginary) I: the right singular vectors of singular
/// values up to `tolerance`, at least one and at most `limit`.
/// @param vectors receives up to `limit` rows of n complex numbers (real part, imaginary part)
bat_status dense_null_space(size_t n, const double *a, double real, double imaginary, double tolerance, size_t limit,
                            double *vectors, size_t *count, bat_error *error);

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
