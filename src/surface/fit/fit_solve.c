#include "surface/fit/fit_solve.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "linalg/blas_single.h"

#include <cholmod.h>
#include <stdlib.h>

struct fit_solver
{
    const fit_pattern *pattern;
    cholmod_common common;
    cholmod_factor *factor;
    cholmod_dense *solution, *scratch[2]; ///< kept between solves
};

static bat_status cholmod_failure(const fit_solver *solver, bat_error *error)
{
    size_t functions = solver->pattern->functions;
    if (solver->common.status == CHOLMOD_OUT_OF_MEMORY)
        return error_memory(error, functions * sizeof(double));
    if (solver->common.status == CHOLMOD_TOO_LARGE)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the equations of %zu functions are too large to factor",
                         functions);
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the equations of %zu functions cannot be factored",
                     functions);
}

/// The matrix as CHOLMOD sees it, which does not change it.
static cholmod_sparse as_sparse(const fit_pattern *pattern, const double *values)
{
    return (cholmod_sparse){.nrow = pattern->functions,
                            .ncol = pattern->functions,
                            .nzmax = (size_t)pattern->first[pattern->functions],
                            .p = pattern->first,
                            .i = pattern->row,
                            .x = (void *)(uintptr_t)values,
                            .stype = -1,
                            .itype = CHOLMOD_INT,
                            .xtype = values == NULL ? CHOLMOD_PATTERN : CHOLMOD_REAL,
                            .dtype = CHOLMOD_DOUBLE,
                            .sorted = 1,
                            .packed = 1};
}

/// Work on this thread alone. CHOLMOD 3 shares its copying among four threads, for every supernode anew and whatever the
/// number of processors, which takes longer than to copy.
static int solver_begin(void)
{
    blas_single_begin();
    return threads_alone_begin();
}

static void solver_end(int levels)
{
    threads_alone_end(levels);
    blas_single_end();
}

bat_status fit_solver_make(const fit_pattern *pattern, fit_solver **solver, bat_error *error)
{
    fit_solver *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    made->pattern = pattern;
    (void)cholmod_start(&made->common);
    made->common.print = 0;
    made->common.error_handler = NULL;
    made->common.supernodal = CHOLMOD_SUPERNODAL;
    made->common.quick_return_if_not_posdef = 1;
    made->common.nmethods = 1;
    made->common.method[0].ordering = CHOLMOD_AMD;
    made->common.postorder = 1;
    cholmod_sparse matrix = as_sparse(pattern, NULL);
    made->factor = cholmod_analyze(&matrix, &made->common);
    if (made->factor == NULL)
    {
        bat_status status = cholmod_failure(made, error);
        fit_solver_free(made);
        return status;
    }
    *solver = made;
    return BAT_OK;
}

void fit_solver_free(fit_solver *solver)
{
    if (solver == NULL)
        return;
    (void)cholmod_free_factor(&solver->factor, &solver->common);
    (void)cholmod_free_dense(&solver->solution, &solver->common);
    (void)cholmod_free_dense(&solver->scratch[0], &solver->common);
    (void)cholmod_free_dense(&solver->scratch[1], &solver->common);
    (void)cholmod_finish(&solver->common);
    free(solver);
}

/// The least squared diagonal entry of the factor over the matrix's.
static double least_pivot(const fit_solver *solver, const double *values)
{
    const cholmod_factor *factor = solver->factor;
    const int *super = factor->super, *row_first = factor->pi, *value_first = factor->px, *order = factor->Perm;
    const double *entries = factor->x;
    double least = 1;
    for (size_t s = 0; s < factor->nsuper; s++)
    {
        size_t rows = (size_t)(row_first[s + 1] - row_first[s]);
        for (int j = super[s]; j < super[s + 1]; j++)
        {
            double diagonal = entries[(size_t)value_first[s] + (size_t)(j - super[s]) * (rows + 1)];
            double pivot = diagonal * diagonal / values[solver->pattern->first[order[j]]];
            least = pivot < least ? pivot : least;
        }
    }
    return least;
}

bat_status fit_solver_factor(fit_solver *solver, const double *values, double *pivot, bat_error *error)
{
    cholmod_sparse matrix = as_sparse(solver->pattern, values);
    int levels = solver_begin();
    (void)cholmod_factorize(&matrix, solver->factor, &solver->common);
    solver_end(levels);
    *pivot = 0;
    if (solver->common.status == CHOLMOD_NOT_POSDEF)
        return BAT_OK;
    if (solver->common.status < CHOLMOD_OK)
        return cholmod_failure(solver, error);
    *pivot = least_pivot(solver, values);
    return BAT_OK;
}

bat_status fit_solver_solve(fit_solver *solver, size_t columns, const double *right, double *solution, bat_error *error)
{
    size_t functions = solver->pattern->functions;
    double *by_columns = memory_array(functions * columns, sizeof *by_columns);
    if (by_columns == NULL)
        return error_memory(error, functions * columns * sizeof *by_columns);
    for (size_t i = 0; i < functions; i++)
        for (size_t k = 0; k < columns; k++)
            by_columns[k * functions + i] = right[i * columns + k];
    cholmod_dense given = {.nrow = functions,
                           .ncol = columns,
                           .nzmax = functions * columns,
                           .d = functions,
                           .x = by_columns,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
    int levels = solver_begin();
    int solved = cholmod_solve2(CHOLMOD_A, solver->factor, &given, NULL, &solver->solution, NULL, &solver->scratch[0],
                                &solver->scratch[1], &solver->common);
    solver_end(levels);
    free(by_columns);
    if (!solved)
        return cholmod_failure(solver, error);
    const double *found = solver->solution->x;
    for (size_t i = 0; i < functions; i++)
        for (size_t k = 0; k < columns; k++)
            solution[i * columns + k] = found[k * functions + i];
    return BAT_OK;
}
