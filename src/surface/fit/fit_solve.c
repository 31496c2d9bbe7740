#include "surface/fit/fit_solve.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/multifrontal.h"

#include <stdlib.h>
#include <string.h>

struct fit_solver
{
    size_t functions;
    multifrontal *fronts;                   ///< null with a backend
    const bat_surface_fit_backend *backend; ///< whose solver this is; null for the library's
    const fit_pattern *pattern;             ///< of a backend's solver
};

bat_status fit_solver_make(const fit_pattern *pattern, fit_solver **solver, bat_error *error)
{
    fit_solver *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    made->functions = pattern->functions;
    const symmetric_pattern symmetric = {pattern->functions, pattern->first, pattern->row};
    bat_status status = multifrontal_make(&symmetric, true, &made->fronts, error);
    if (status == BAT_OK)
        *solver = made;
    else
        fit_solver_free(made);
    return status;
}

bat_status fit_solver_make_for(const bat_group *group, const bat_surface_fit_backend *backend, const fit_pattern *pattern,
                               fit_solver **solver, bat_error *error)
{
    if (!group_is_first(group))
        return BAT_OK;
    if (backend->factor == NULL)
        return fit_solver_make(pattern, solver, error);
    fit_solver *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    *made = (fit_solver){.functions = pattern->functions, .backend = backend, .pattern = pattern};
    *solver = made;
    return BAT_OK;
}

void fit_solver_free(fit_solver *solver)
{
    if (solver == NULL)
        return;
    multifrontal_free(solver->fronts);
    free(solver);
}

bat_status fit_solver_factor(fit_solver *solver, const double *values, double *pivot, bat_error *error)
{
    const fit_pattern *pattern = solver->pattern;
    bool regular = false;
    if (solver->backend != NULL)
    {
        bat_status status = solver->backend->factor(solver->backend->context, solver->functions, pattern->first,
                                                    pattern->row, values, &regular, error);
        *pivot = regular ? 1 : 0;
        return status;
    }
    return multifrontal_factor(solver->fronts, values, NULL, pivot, error);
}

bat_status fit_solver_solve(fit_solver *solver, size_t columns, const double *right, double *solution, bat_error *error)
{
    const bat_surface_fit_backend *backend = solver->backend;
    size_t bytes = solver->functions * columns * sizeof *solution;
    if (backend != NULL)
    {
        double *copy = right == solution ? memory_array(1, bytes) : NULL;
        if (right == solution && copy == NULL)
            return error_memory(error, bytes);
        if (copy != NULL)
            memcpy(copy, right, bytes);
        bat_status status = backend->solve(backend->context, columns, copy != NULL ? copy : right, solution, error);
        free(copy);
        return status;
    }
    memmove(solution, right, bytes);
    return multifrontal_solve(solver->fronts, columns, solution, error);
}
