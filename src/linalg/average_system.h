#ifndef LINALG_AVERAGE_SYSTEM_H
#define LINALG_AVERAGE_SYSTEM_H

#include "linalg/sparse_rows.h"

/// @file
/// Systems whose unknowns are averages of each other and of something given: x_i = sum_k w_ik x_k + c_i with w_ik >= 0, w_ii
/// = 0 and sum_k w_ik <= 1, each unknown joined by some chain of weights to one whose sum is below 1. The matrix I - W is
/// then an M-matrix: there is one solution, and where the c_i are the missing shares of given values, it lies within their
/// range.

/// Solve for two columns at once by an LU decomposition, without pivoting, which M-matrices do not need.
/// @param weights  count x count
/// @param constant count x 2
/// @param x        receives count x 2
/// @return BAT_OK, BAT_NO_CONVERGENCE for a singular system, BAT_NO_MEMORY, BAT_TOO_LARGE
bat_status average_solve_direct(const sparse_rows *weights, const double *constant, double *x, bat_error *error);

/// The same by BiCGSTAB (van der Vorst 1992) over a multilevel cycle, in time and memory in proportion to the entries. Where
/// it does not settle, as on large clouds with noise as wide as their spacing, average_solve_direct() takes over, up to
/// 100,000 unknowns. Unknowns that are joined should lie close to each other in number.
///
/// The largest residual ends up within some units of rounding of the largest number.
/// @param threads as many as OpenMP gives when 0; the result is the same
/// @return BAT_OK, BAT_NO_CONVERGENCE, BAT_NO_MEMORY
bat_status average_solve_iterative(const sparse_rows *weights, const double *constant, int threads, double *x,
                                   bat_error *error);

#endif
