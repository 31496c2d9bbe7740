#ifndef MPI_BACKEND_H
#define MPI_BACKEND_H

#include "batten/research/distributed.h"
#include "batten/surface_fit.h"

/// @file
/// The solvers of PETSc and the store of the state, for bat_surface_fit_together(). Every rank makes one; a failure of MPI
/// ends the program.

typedef struct fit_backend fit_backend;

/// How systems are solved.
typedef enum fit_solver_kind
{
    FIT_SOLVER_CHOLESKY, ///< by the library, on rank 0: the same bits for any number of ranks
    FIT_SOLVER_DIRECT,   ///< by PETSc and MUMPS
    FIT_SOLVER_ITERATIVE ///< by PETSc: conjugate gradients with algebraic multigrid
} fit_solver_kind;

/// @param state null, or the path of the file that keeps the state between rounds
/// @param label identifies the input and the options of the fit, for the state
fit_backend *fit_backend_make(fit_solver_kind solver, const char *state, uint64_t label);
void fit_backend_free(fit_backend *backend);
/// The interface for the library.
const bat_surface_fit_backend *fit_backend_interface(const fit_backend *backend);
/// Say how many rows this rank has and how many lower ranks have, for the state.
void fit_backend_set_rows(fit_backend *backend, size_t first, size_t count, size_t total);
/// The number of rounds that an earlier call had finished; 0 for none.
size_t fit_backend_resumed(const fit_backend *backend);
/// Remove the file of a state, by one rank.
void fit_backend_forget(const char *state);

#endif
