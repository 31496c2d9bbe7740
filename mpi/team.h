#ifndef MPI_TEAM_H
#define MPI_TEAM_H

#include "batten/surface_fit.h"

/// @file
/// The processes of MPI as a team of bat_surface_fit_together(). Every rank makes one; a failure of MPI ends the program.

typedef struct fit_team fit_team;

/// How systems are solved.
typedef enum team_solver
{
    TEAM_SOLVER_CHOLESKY, ///< by the library, on rank 0: the same bits for any number of ranks
    TEAM_SOLVER_DIRECT,   ///< by PETSc and MUMPS
    TEAM_SOLVER_ITERATIVE ///< by PETSc: conjugate gradients with algebraic multigrid
} team_solver;

/// @param state null, or the path of the file that keeps the state between rounds
/// @param label identifies the input and the options of the fit, for the state
fit_team *fit_team_make(team_solver solver, const char *state, uint64_t label);
void fit_team_free(fit_team *team);
/// The interface for the library.
const bat_surface_team *fit_team_interface(const fit_team *team);
/// Say how many rows this rank has and how many lower ranks have, for the state.
void fit_team_set_rows(fit_team *team, size_t first, size_t count, size_t total);
/// The number of rounds that an earlier call had finished; 0 for none.
size_t fit_team_resumed(const fit_team *team);
/// Remove the file of a state, by one rank.
void fit_team_forget(const char *state);

#endif
