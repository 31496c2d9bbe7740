#include "solver.h"

#include "ranks.h"

#include <math.h>
#include <petscksp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// What rank 0 asks of the others.
typedef enum command
{
    COMMAND_FACTOR,
    COMMAND_SOLVE,
    COMMAND_RELEASE
} command;

enum
{
    MAX_REFINEMENTS = 6,
    MUMPS_WORKSPACE = 14, ///< the place of this option in MUMPS: per cent of memory beyond its estimate,
    WORKSPACE = 200       ///< which is too low for small matrices on several ranks
};

// Refinement of a column ends when its largest change is at most this share of the largest number.
static const double CHANGE_TOLERANCE = 1e-15;
// Conjugate gradients end when the residual is at most this share of the right-hand side; refinement does the rest.
static const double RESIDUAL_TOLERANCE = 1e-12;

struct petsc_solver
{
    bool iterative;
    PetscInt size;
    Mat matrix;
    KSP method;
    Vec right, solution;
    Vec all;            ///< on rank 0: the whole vector
    VecScatter scatter; ///< between `right` and `all`
    // Of rank 0, as given.
    const int *first, *row;
    const double *values;
    bool factored;
};

static void need(PetscErrorCode code)
{
    bat_error error = {.status = BAT_NO_CONVERGENCE};
    if (code == 0)
        return;
    const char *text;
    (void)PetscErrorMessage(code, &text, NULL);
    (void)snprintf(error.text, sizeof error.text, "PETSc fails: %s", text != NULL ? text : "for an unknown reason");
    ranks_need(NULL, BAT_NO_CONVERGENCE, &error);
}

static petsc_solver *solver_make(bool iterative)
{
    petsc_solver *solver = ranks_allocate(1, sizeof *solver);
    PetscBool begun;
    // PETSc gets no words of the command line; its own options come from the environment (PETSC_OPTIONS).
    need(PetscInitialized(&begun));
    if (!begun)
    {
        need(PetscInitializeNoArguments());
        (void)PetscPopSignalHandler();
    }
    need(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
    solver->iterative = iterative;
    return solver;
}

static void drop(petsc_solver *solver)
{
    need(KSPDestroy(&solver->method));
    need(MatDestroy(&solver->matrix));
    need(VecScatterDestroy(&solver->scatter));
    need(VecDestroy(&solver->right));
    need(VecDestroy(&solver->solution));
    need(VecDestroy(&solver->all));
    solver->factored = false;
}

static void solver_free(petsc_solver *solver)
{
    if (solver == NULL)
        return;
    drop(solver);
    need(PetscPopErrorHandler());
    free(solver);
}

static int ask(int what)
{
    (void)MPI_Bcast(&what, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return what;
}

/// Make the matrix and the vectors. Each rank gets a part of consecutive rows.
static void make_parts(petsc_solver *solver)
{
    need(MatCreate(PETSC_COMM_WORLD, &solver->matrix));
    need(MatSetSizes(solver->matrix, PETSC_DECIDE, PETSC_DECIDE, solver->size, solver->size));
    need(MatSetType(solver->matrix, MATAIJ));
    need(MatSetUp(solver->matrix));
    need(MatSetOption(solver->matrix, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
    need(MatSetOption(solver->matrix, MAT_SPD, PETSC_TRUE));
    need(MatCreateVecs(solver->matrix, &solver->solution, &solver->right));
    need(VecScatterCreateToZero(solver->right, &solver->scatter, &solver->all));
}

/// Numbers of entries of each row, left of and within the diagonal part of its rank, and without it.
static void count_entries(const petsc_solver *solver, const PetscInt *ranges, int *within, int *without)
{
    PetscInt *owner = ranks_allocate((size_t)solver->size, sizeof *owner);
    for (int rank = 0; rank < ranks_count(); rank++)
        for (PetscInt i = ranges[rank]; i < ranges[rank + 1]; i++)
            owner[i] = rank;
    for (PetscInt j = 0; j < solver->size; j++)
        for (int at = solver->first[j]; at < solver->first[j + 1]; at++)
        {
            int i = solver->row[at];
            int *counts = owner[i] == owner[j] ? within : without;
            counts[i]++;
            if (i != j)
                counts[j]++;
        }
    free(owner);
}

/// Allocate exactly, and set all entries from rank 0.
static void fill_matrix(petsc_solver *solver)
{
    const PetscInt *ranges;
    int size = (int)solver->size, *counts = ranks_allocate(2 * (size_t)size, sizeof *counts);
    need(MatGetOwnershipRanges(solver->matrix, &ranges));
    if (ranks_rank() == 0)
        count_entries(solver, ranges, counts, counts + size);
    (void)MPI_Bcast(counts, 2 * size, MPI_INT, 0, MPI_COMM_WORLD);
    int begin = (int)ranges[ranks_rank()];
    need(MatSeqAIJSetPreallocation(solver->matrix, 0, counts + begin));
    need(MatMPIAIJSetPreallocation(solver->matrix, 0, counts + begin, 0, counts + size + begin));
    free(counts);
    for (PetscInt j = 0; ranks_rank() == 0 && j < solver->size; j++)
        for (int at = solver->first[j]; at < solver->first[j + 1]; at++)
        {
            PetscInt i = solver->row[at];
            need(MatSetValues(solver->matrix, 1, &i, 1, &j, &solver->values[at], INSERT_VALUES));
            if (i != j)
                need(MatSetValues(solver->matrix, 1, &j, 1, &i, &solver->values[at], INSERT_VALUES));
        }
    need(MatAssemblyBegin(solver->matrix, MAT_FINAL_ASSEMBLY));
    need(MatAssemblyEnd(solver->matrix, MAT_FINAL_ASSEMBLY));
}

static void choose_method(petsc_solver *solver)
{
    PC preconditioner;
    need(KSPCreate(PETSC_COMM_WORLD, &solver->method));
    need(KSPSetOperators(solver->method, solver->matrix, solver->matrix));
    need(KSPGetPC(solver->method, &preconditioner));
    need(KSPSetType(solver->method, solver->iterative ? KSPCG : KSPPREONLY));
    need(PCSetType(preconditioner, solver->iterative ? PCGAMG : PCCHOLESKY));
    if (solver->iterative)
        need(KSPSetTolerances(solver->method, RESIDUAL_TOLERANCE, PETSC_DEFAULT, PETSC_DEFAULT, 10000));
    else
    {
        Mat factors;
        need(PCFactorSetMatSolverType(preconditioner, MATSOLVERMUMPS));
        need(PCFactorSetUpMatSolverType(preconditioner));
        need(PCFactorGetMatrix(preconditioner, &factors));
        need(MatMumpsSetIcntl(factors, MUMPS_WORKSPACE, WORKSPACE));
    }
    need(KSPSetFromOptions(solver->method));
}

/// What all ranks do for petsc_solver_factor().
/// @return whether the matrix is regular, as far as the method tells
static bool factor_together(petsc_solver *solver)
{
    drop(solver);
    (void)MPI_Bcast(&solver->size, 1, MPIU_INT, 0, MPI_COMM_WORLD);
    make_parts(solver);
    fill_matrix(solver);
    choose_method(solver);
    KSPConvergedReason reason;
    PetscErrorCode code = KSPSetUp(solver->method);
    need(KSPGetConvergedReason(solver->method, &reason));
    solver->factored = code == 0 && reason >= 0;
    return solver->factored;
}

/// What all ranks do for one column. Rank 0 has the vectors.
/// @return whether there is a solution
static bool solve_together(petsc_solver *solver, const double *right, double *solution)
{
    PetscScalar *numbers;
    size_t bytes = ranks_rank() == 0 ? (size_t)solver->size * sizeof *numbers : 0;
    need(VecGetArray(solver->all, &numbers));
    if (bytes > 0)
        memcpy(numbers, right, bytes);
    need(VecRestoreArray(solver->all, &numbers));
    need(VecScatterBegin(solver->scatter, solver->all, solver->right, INSERT_VALUES, SCATTER_REVERSE));
    need(VecScatterEnd(solver->scatter, solver->all, solver->right, INSERT_VALUES, SCATTER_REVERSE));
    KSPConvergedReason reason;
    need(KSPSolve(solver->method, solver->right, solver->solution));
    need(KSPGetConvergedReason(solver->method, &reason));
    need(VecScatterBegin(solver->scatter, solver->solution, solver->all, INSERT_VALUES, SCATTER_FORWARD));
    need(VecScatterEnd(solver->scatter, solver->solution, solver->all, INSERT_VALUES, SCATTER_FORWARD));
    need(VecGetArray(solver->all, &numbers));
    if (bytes > 0)
        memcpy(solution, numbers, bytes);
    need(VecRestoreArray(solver->all, &numbers));
    return reason > 0 || reason == KSP_DIVERGED_ITS;
}

static bat_status solver_factor(petsc_solver *solver, size_t size, const int *first, const int *row, const double *values,
                                bool *regular, bat_error *error)
{
    (void)error;
    (void)ask(COMMAND_FACTOR);
    solver->size = (PetscInt)size;
    solver->first = first;
    solver->row = row;
    solver->values = values;
    *regular = factor_together(solver);
    return BAT_OK;
}

/// residual = right - K solution.
static void find_residual(const petsc_solver *solver, const double *right, const double *solution, long double *work,
                          double *residual)
{
    for (PetscInt i = 0; i < solver->size; i++)
        work[i] = right[i];
    for (PetscInt j = 0; j < solver->size; j++)
        for (int at = solver->first[j]; at < solver->first[j + 1]; at++)
        {
            int i = solver->row[at];
            work[i] -= (long double)solver->values[at] * solution[j];
            if (i != j)
                work[j] -= (long double)solver->values[at] * solution[i];
        }
    for (PetscInt i = 0; i < solver->size; i++)
        residual[i] = (double)work[i];
}

/// Solve one column on rank 0, and refine the solution while it gets better.
static bool solve_column(petsc_solver *solver, const double *right, double *solution, long double *work, double *residual,
                         double *change)
{
    double before = INFINITY;
    (void)ask(COMMAND_SOLVE);
    if (!solve_together(solver, right, solution))
        return false;
    for (int k = 0; k < MAX_REFINEMENTS; k++)
    {
        double largest = 0, moved = 0;
        find_residual(solver, right, solution, work, residual);
        (void)ask(COMMAND_SOLVE);
        if (!solve_together(solver, residual, change))
            return true;
        for (PetscInt i = 0; i < solver->size; i++)
        {
            largest = fmax(largest, fabs(solution[i]));
            moved = fmax(moved, fabs(change[i]));
        }
        if (!(moved < before))
            return true;
        for (PetscInt i = 0; i < solver->size; i++)
            solution[i] += change[i];
        if (moved <= CHANGE_TOLERANCE * largest)
            return true;
        before = moved;
    }
    return true;
}

static bat_status solver_solve(petsc_solver *solver, size_t columns, const double *right, double *solution, bat_error *error)
{
    size_t size = (size_t)solver->size;
    double *numbers = ranks_allocate(4 * size, sizeof *numbers);
    long double *work = ranks_allocate(size, sizeof *work);
    double *column = numbers, *found = column + size, *residual = found + size, *change = residual + size;
    bool good = true;
    for (size_t k = 0; k < columns && good; k++)
    {
        for (size_t i = 0; i < size; i++)
            column[i] = right[i * columns + k];
        good = solve_column(solver, column, found, work, residual, change);
        for (size_t i = 0; i < size; i++)
            solution[i * columns + k] = found[i];
    }
    free(numbers);
    free(work);
    if (good)
        return BAT_OK;
    if (error != NULL)
    {
        *error = (bat_error){.status = BAT_NO_CONVERGENCE, .index = BAT_NO_INDEX};
        (void)snprintf(error->text, sizeof error->text, "PETSc finds no solution of %zu equations; --solver cholesky does",
                       size);
    }
    return BAT_NO_CONVERGENCE;
}

static bat_status solver_attend(petsc_solver *solver, bat_error *error)
{
    (void)error;
    for (;;)
        switch (ask(COMMAND_RELEASE))
        {
        case COMMAND_FACTOR:
            (void)factor_together(solver);
            break;
        case COMMAND_SOLVE:
            (void)solve_together(solver, NULL, NULL);
            break;
        default:
            drop(solver);
            return BAT_OK;
        }
}

static bat_status solver_release(petsc_solver *solver, bat_error *error)
{
    (void)error;
    (void)ask(COMMAND_RELEASE);
    drop(solver);
    return BAT_OK;
}

static void solver_end(void)
{
    (void)PetscFinalize();
}

extern const petsc_functions PETSC_TABLE;
__attribute__((visibility("default"))) const petsc_functions PETSC_TABLE = {
    .make = solver_make,
    .free = solver_free,
    .end = solver_end,
    .factor = solver_factor,
    .solve = solver_solve,
    .attend = solver_attend,
    .release = solver_release,
};
