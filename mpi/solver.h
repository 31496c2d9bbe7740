#ifndef MPI_SOLVER_H
#define MPI_SOLVER_H

#include "batten/surface_fit.h"

/// @file
/// Sparse symmetric positive definite systems solved by PETSc on all ranks. Rank 0 has the matrix and the right-hand sides.
/// Solutions are refined with residuals in extended precision (Wilkinson, 1963), so that they agree with those of another
/// solver to rounding.

typedef struct petsc_solver petsc_solver;

/// @param iterative conjugate gradients with GAMG instead of MUMPS
petsc_solver *petsc_solver_make(bool iterative);
void petsc_solver_free(petsc_solver *solver);

// As in bat_surface_team.

bat_status petsc_solver_factor(petsc_solver *solver, size_t size, const int *first, const int *row, const double *values,
                               bool *regular, bat_error *error);
bat_status petsc_solver_solve(petsc_solver *solver, size_t columns, const double *right, double *solution, bat_error *error);
bat_status petsc_solver_attend(petsc_solver *solver, bat_error *error);
bat_status petsc_solver_release(petsc_solver *solver, bat_error *error);

#endif
