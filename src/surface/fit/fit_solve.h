#ifndef SURFACE_FIT_FIT_SOLVE_H
#define SURFACE_FIT_FIT_SOLVE_H

#include "surface/fit/pattern.h"
#include "surface/fit/sums.h"

/// @file
/// Sparse symmetric positive definite systems of one pattern.

typedef struct fit_solver fit_solver;

/// Order and analyse a pattern, which must outlive the solver.
bat_status fit_solver_make(const fit_pattern *pattern, fit_solver **solver, bat_error *error);
/// The same by the solver of a backend, where it has one; the backend must outlive it. Of the processes of a group, the
/// first alone has a solver; the others attend.
bat_status fit_solver_make_for(const bat_group *group, const bat_surface_fit_backend *backend, const fit_pattern *pattern,
                               fit_solver **solver, bat_error *error);
/// Does nothing to null.
void fit_solver_free(fit_solver *solver);

/// Factor the matrix K of these values. One thread works, so that the result does not depend on their number.
/// @param pivot receives the least pivot of Cholesky's method over the diagonal entry it came from: from 1, when functions
/// have
///              nothing in common, down to about the unit roundoff for a singular matrix, and 0 where the method broke off
bat_status fit_solver_factor(fit_solver *solver, const double *values, double *pivot, bat_error *error);

/// Solve by the last factorization, whose pivot must be above 0.
/// @param right    functions x columns
/// @param solution receives as many; may be `right`
bat_status fit_solver_solve(fit_solver *solver, size_t columns, const double *right, double *solution, bat_error *error);

#endif
