#ifndef MPI_SOLVER_H
#define MPI_SOLVER_H

#include "batten/surface_fit.h"

/// @file
/// Sparse symmetric positive definite systems solved by PETSc on all ranks. Rank 0 has the matrix and the right-hand sides.
/// Solutions are refined with residuals in extended precision (Wilkinson, 1963), so that they agree with those of another
/// solver to rounding.
///
/// PETSc brings more than a hundred libraries, which take 30 MiB of each rank. Therefore they are in a module of their own,
/// batten-petsc, which is loaded where it is asked for.

typedef struct petsc_solver petsc_solver;

/// What the module gives. All ranks call `make`, `free` and `end`; the others are as in bat_surface_fit_backend.
typedef struct petsc_functions
{
    /// @param iterative conjugate gradients with GAMG instead of MUMPS
    petsc_solver *(*make)(bool iterative);
    void (*free)(petsc_solver *solver);
    /// Before the end of MPI.
    void (*end)(void);

    bat_status (*factor)(petsc_solver *solver, size_t size, const int *first, const int *row, const double *values,
                         bool *regular, bat_error *error);
    bat_status (*solve)(petsc_solver *solver, size_t columns, const double *right, double *solution, bat_error *error);
    bat_status (*attend)(petsc_solver *solver, bat_error *error);
    bat_status (*release)(petsc_solver *solver, bat_error *error);
} petsc_functions;

/// The name of the module's table.
#define PETSC_TABLE batten_petsc
#define PETSC_TABLE_NAME "batten_petsc"

/// The module, which is loaded at the first call, by all ranks; a failure ends all.
const petsc_functions *petsc_load(void);
/// End PETSc where it was loaded.
void petsc_end(void);

#endif
