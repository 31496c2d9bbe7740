#ifndef LINALG_SUPERNODAL_GPL_H
#define LINALG_SUPERNODAL_GPL_H

#include "linalg/front_tree.h"

/// @file
/// Sparse symmetric positive definite systems by the supernodal factorization of CHOLMOD (Chen, Davis, Hager and
/// Rajamanickam, 2008). It is published under the GPL, so this is in builds with BATTEN_GPL alone. The functions are as in
/// linalg/multifrontal.h.

typedef struct supernodal supernodal;

/// @param pattern must outlive the solver
/// @return BAT_OK, BAT_NO_MEMORY, BAT_TOO_LARGE
bat_status supernodal_make(const symmetric_pattern *pattern, supernodal **solver, bat_error *error);
/// Does nothing to null.
void supernodal_free(supernodal *solver);

/// @param values the entries of the pattern
/// @param pivot  receives the least pivot over the diagonal entry that it came from; 0 where a pivot is not above 0
/// @return BAT_OK, BAT_NO_MEMORY
bat_status supernodal_factor(supernodal *solver, const double *values, double *pivot, bat_error *error);

/// @param x [count x columns] right-hand sides, receives solutions
/// @return BAT_OK, BAT_NO_MEMORY
bat_status supernodal_solve(supernodal *solver, size_t columns, double *x, bat_error *error);

#endif
