#include "linalg/supernodal_gpl.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "linalg/blas_single.h"

#include <cholmod.h>
#include <stdlib.h>

struct supernodal
{
    symmetric_pattern pattern;
    cholmod_common common;
    cholmod_factor *factor;
    cholmod_dense *solution, *scratch[2]; ///< kept between solves
};

static bat_status supernodal_failure(const supernodal *solver, bat_error *error)
{
    size_t count = solver->pattern.count;
    if (solver->common.status == CHOLMOD_OUT_OF_MEMORY)
        return error_memory(error, count * sizeof(double));
    if (solver->common.status == CHOLMOD_TOO_LARGE)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the equations of %zu functions are too large to factor",
                         count);
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the equations of %zu functions cannot be factored", count);
}

/// The matrix as CHOLMOD sees it, which does not change it.
static cholmod_sparse as_sparse(const symmetric_pattern *pattern, const double *values)
{
    return (cholmod_sparse){.nrow = pattern->count,
                            .ncol = pattern->count,
                            .nzmax = (size_t)pattern->first[pattern->count],
                            .p = (void *)(uintptr_t)pattern->first,
                            .i = (void *)(uintptr_t)pattern->row,
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
static int supernodal_begin(void)
{
    blas_single_begin();
    return threads_alone_begin();
}

static void supernodal_end(int levels)
{
    threads_alone_end(levels);
    blas_single_end();
}

bat_status supernodal_make(const symmetric_pattern *pattern, supernodal **solver, bat_error *error)
{
    supernodal *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    made->pattern = *pattern;
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
        bat_status status = supernodal_failure(made, error);
        supernodal_free(made);
        return status;
    }
    *solver = made;
    return BAT_OK;
}

void supernodal_free(supernodal *solver)
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
static double least_pivot(const supernodal *solver, const double *values)
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
            double pivot = diagonal * diagonal / values[solver->pattern.first[order[j]]];
            least = pivot < least ? pivot : least;
        }
    }
    return least;
}

bat_status supernodal_factor(supernodal *solver, const double *values, double *pivot, bat_error *error)
{
    cholmod_sparse matrix = as_sparse(&solver->pattern, values);
    int levels = supernodal_begin();
    int factored = cholmod_factorize(&matrix, solver->factor, &solver->common);
    supernodal_end(levels);
    *pivot = 0;
    if (solver->common.status == CHOLMOD_NOT_POSDEF)
        return BAT_OK;
    if (!factored || solver->common.status < CHOLMOD_OK || solver->factor->x == NULL)
        return supernodal_failure(solver, error);
    *pivot = least_pivot(solver, values);
    return BAT_OK;
}

/// The room that cholmod_solve2() works in. It takes its two arrays without a look at the first of them where the second
/// could be made, and then writes to null.
static bool solve_room(supernodal *solver, size_t columns)
{
    size_t count = solver->pattern.count;
    cholmod_common *common = &solver->common;
    return cholmod_ensure_dense(&solver->solution, count, columns, count, CHOLMOD_REAL, common) != NULL &&
           cholmod_ensure_dense(&solver->scratch[0], count, columns, count, CHOLMOD_REAL, common) != NULL &&
           cholmod_ensure_dense(&solver->scratch[1], columns, solver->factor->maxesize, columns, CHOLMOD_REAL, common) !=
               NULL;
}

bat_status supernodal_solve(supernodal *solver, size_t columns, double *x, bat_error *error)
{
    size_t count = solver->pattern.count;
    double *by_columns = memory_array(count * columns, sizeof *by_columns);
    if (by_columns == NULL)
        return error_memory(error, count * columns * sizeof *by_columns);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < columns; k++)
            by_columns[k * count + i] = x[i * columns + k];
    cholmod_dense given = {.nrow = count,
                           .ncol = columns,
                           .nzmax = count * columns,
                           .d = count,
                           .x = by_columns,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
    int levels = supernodal_begin();
    bool solved =
        solve_room(solver, columns) && cholmod_solve2(CHOLMOD_A, solver->factor, &given, NULL, &solver->solution, NULL,
                                                      &solver->scratch[0], &solver->scratch[1], &solver->common);
    supernodal_end(levels);
    free(by_columns);
    if (!solved)
        return supernodal_failure(solver, error);
    const double *found = solver->solution->x;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < columns; k++)
            x[i * columns + k] = found[k * count + i];
    return BAT_OK;
}
