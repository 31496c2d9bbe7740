/// @file
/// Assembly of the normal equations of a fit; see system.h.
///
/// The thin-plate matrix is exact. On a cell the integrand is a sum of products of univariate polynomials, so that
///     M_ij = U2_ac V0_bd + U1_ac V1_bd + U0_ac V2_bd,   Uk_ac = integral of the k-th derivatives of functions a and c,
/// with univariate integrals by Gauss-Legendre quadrature with degree + 1 nodes.

#include "surface/fit/system.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/multifrontal.h"
#include "surface/spline/hierarchical_space.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    SIDE = BAT_SPLINE_MAX_DEGREE + 1 ///< maximum number of functions of a cell in one direction, and of quadrature nodes
};

/// Gauss-Legendre quadrature on [0, 1] with `count` nodes, exact for polynomials of degree 2 count - 1.
typedef struct gauss_rule
{
    int count;
    double node[SIDE], weight[SIDE];
} gauss_rule;

/// The Legendre polynomial of degree n and its derivative at x in (-1, 1).
static double legendre(int n, double x, double *slope)
{
    double before = 1, now = x;
    for (int k = 2; k <= n; k++)
    {
        double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
        before = now;
        now = next;
    }
    *slope = n * (before - x * now) / (1 - x * x);
    return now;
}

/// The nodes are the zeros of the Legendre polynomial, computed by Newton's method from Tricomi's approximation.
static gauss_rule gauss_rule_make(int count)
{
    gauss_rule rule = {.count = count};
    for (int i = 0; i < count; i++)
    {
        double slope = 1, x = cos(acos(-1.0) * (i + 0.75) / (count + 0.5));
        for (int step = 0; step < 8; step++)
            x -= legendre(count, x, &slope) / slope;
        (void)legendre(count, x, &slope);
        rule.node[i] = 0.5 * (1 - x);
        rule.weight[i] = 1 / ((1 - x * x) * slope * slope);
    }
    return rule;
}

typedef struct plate_context
{
    const bat_hierarchical_space *space;
    gauss_rule rule[2];
    bool levelled; ///< cells of level l have the weight 16^-l
} plate_context;

/// Univariate integrals over a cell of products of the k-th derivatives of two functions, k = 0, 1, 2.
typedef struct side_integrals
{
    double of[3][SIDE * SIDE];
} side_integrals;

static void integrate_side(const plate_context *plate, const hierarchical_cell *cell, int direction,
                           side_integrals *integrals)
{
    const gauss_rule *rule = &plate->rule[direction];
    size_t side = (size_t)plate->space->options.degree[direction] + 1;
    double spans = (double)hierarchical_spans(plate->space, cell->level, direction), values[3 * SIDE];
    double place = direction == 0 ? cell->column : cell->row, scale = 1 / spans;
    for (int order = 0; order < 3; order++)
        memset(integrals->of[order], 0, side * side * sizeof(double));
    for (int n = 0; n < rule->count; n++)
    {
        uniform_basis_values((int)side - 1, (size_t)spans, (size_t)place, rule->node[n], 2, values);
        for (size_t order = 0; order < 3; order++)
            for (size_t i = 0; i < side; i++)
                for (size_t j = 0; j < side; j++)
                    integrals->of[order][i * side + j] +=
                        rule->weight[n] * values[order * side + i] * values[order * side + j];
    }
    // Derivatives refer to the local coordinate of the cell; each derivative with respect to the parameter contributes a
    // factor `spans`.
    for (int order = 0; order < 3; order++, scale *= spans * spans)
        for (size_t k = 0; k < side * side; k++)
            integrals->of[order][k] *= scale;
}

static void fill_thin_plate(const void *context, size_t index, double *scratch, double *matrix, double *right)
{
    (void)right;
    const plate_context *plate = context;
    const hierarchical_cell *cell = &plate->space->cells[index];
    size_t width = (size_t)plate->space->options.degree[0] + 1, height = (size_t)plate->space->options.degree[1] + 1;
    size_t locals = width * height;
    double weight = plate->levelled ? ldexp(1, -4 * (int)cell->level) : 1;
    side_integrals u, v;
    integrate_side(plate, cell, 0, &u);
    integrate_side(plate, cell, 1, &v);
    for (size_t b = 0; b < height; b++)
        for (size_t a = 0; a < width; a++)
            for (size_t d = 0; d < height; d++)
                for (size_t c = 0; c < width; c++)
                    scratch[(b * width + a) * locals + d * width + c] =
                        weight * (u.of[2][a * width + c] * v.of[0][b * height + d] +
                                  u.of[1][a * width + c] * v.of[1][b * height + d] +
                                  u.of[0][a * width + c] * v.of[2][b * height + d]);
    hierarchical_extract_matrix(plate->space, cell, scratch, scratch + locals * locals, matrix);
}

/// Compute the lower triangle of the thin-plate matrix M.
static bat_status fit_thin_plate(const fit_pattern *pattern, const bat_hierarchical_space *space, bool levelled, int threads,
                                 double *values, bat_error *error)
{
    size_t locals = hierarchical_locals(space);
    plate_context plate = {
        .space = space,
        .rule = {gauss_rule_make(space->options.degree[0] + 1), gauss_rule_make(space->options.degree[1] + 1)},
        .levelled = levelled};
    fit_cell_work work = {.fill = fill_thin_plate,
                          .context = &plate,
                          .scratch = locals * (locals + hierarchical_space_max_active(space)),
                          .values = values};
    return fit_pattern_sum(pattern, space, &work, threads, error);
}

bat_status fit_system_make(const bat_hierarchical_space *space, const bat_group *group, size_t dimension, bool levelled,
                           int threads, fit_system *system, bat_error *error)
{
    *system = (fit_system){.space = space,
                           .functions = bat_hierarchical_space_functions(space),
                           .dimension = dimension,
                           .columns = dimension + FIT_PROBES,
                           .threads = threads};
    if (!group_is_first(group))
        return BAT_OK;
    bat_status status = fit_pattern_make(space, threads, &system->pattern, error);
    if (status != BAT_OK)
        return status;
    size_t entries = (size_t)system->pattern.first[system->functions];
    system->gram = memory_array(entries, sizeof *system->gram);
    system->plate = memory_array(entries, sizeof *system->plate);
    system->right = memory_array(system->functions * system->columns, sizeof *system->right);
    if (system->gram == NULL || system->plate == NULL || system->right == NULL)
        return error_memory(error, entries * sizeof *system->gram);
    return fit_thin_plate(&system->pattern, space, levelled, threads, system->plate, error);
}

void fit_system_free(fit_system *system)
{
    fit_pattern_free(&system->pattern);
    free(system->gram);
    free(system->plate);
    free(system->right);
    *system = (fit_system){0};
}

void fit_system_multiply(const fit_system *system, const double *values, size_t columns, const double *x, double *product)
{
    const fit_pattern *pattern = &system->pattern;
    memset(product, 0, system->functions * columns * sizeof *product);
    for (size_t j = 0; j < system->functions; j++)
    {
        for (size_t k = 0; k < columns; k++)
            product[j * columns + k] += values[pattern->first[j]] * x[j * columns + k];
        for (int at = pattern->first[j] + 1; at < pattern->first[j + 1]; at++)
        {
            size_t i = (size_t)pattern->row[at];
            for (size_t k = 0; k < columns; k++)
            {
                product[i * columns + k] += values[at] * x[j * columns + k];
                product[j * columns + k] += values[at] * x[i * columns + k];
            }
        }
    }
}

// Solvers

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
