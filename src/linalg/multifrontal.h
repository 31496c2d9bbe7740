#ifndef LINALG_MULTIFRONTAL_H
#define LINALG_MULTIFRONTAL_H

#include "linalg/front_tree.h"

/// @file
/// Direct solution of sparse linear systems by the multifrontal method (Duff and Reid, 1983; Liu, 1992). The factorization
/// is A = L U, where L and U^T have the same diagonal, without pivoting. It exists in any order of elimination for symmetric
/// positive definite matrices, where U = L^T, and for nonsingular M-matrices. For matrices that are diagonally dominant by
/// rows, its growth factor is at most 2 (Higham, 2002, chapter 9).

typedef struct multifrontal multifrontal;

/// Analyse a pattern and allocate the factors. The pattern may be released afterwards.
/// @param symmetric whether the matrix is symmetric and not its pattern alone
/// @return BAT_OK, BAT_NO_MEMORY
bat_status multifrontal_make(const symmetric_pattern *pattern, bool symmetric, multifrontal **solver, bat_error *error);
/// Does nothing to null.
void multifrontal_free(multifrontal *solver);

/// Factor a matrix on the calling thread. There are no factors where the least pivot is 0.
/// @param lower the entries of the pattern
/// @param upper the entries on the other side of the diagonal; null: those of `lower`, for a symmetric matrix
/// @param pivot receives the least pivot over the diagonal entry that it came from; 0 where a pivot is not above 0
/// @return BAT_OK, BAT_NO_MEMORY
bat_status multifrontal_factor(multifrontal *solver, const double *lower, const double *upper, double *pivot,
                               bat_error *error);

/// Solve A x = b on the calling thread. The factors must exist.
/// @param x [count x columns] b, receives x
/// @return BAT_OK, BAT_NO_MEMORY
bat_status multifrontal_solve(const multifrontal *solver, size_t columns, double *x, bat_error *error);

#endif
