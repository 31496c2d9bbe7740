/// @file
/// Assembly of sparse symmetric matrices over the cells of a hierarchical space; see system.h.
///
///     K = sum over cells c of E_c^T K_c E_c,   E_c selects the functions that are active on cell c.
///
/// Cells are processed in batches. All threads compute the contributions of a batch. Each thread then adds those of its own
/// functions, cell by cell. Every entry is therefore summed in the same order for any number of threads.

#include "surface/fit/system.h"

#include "base/error.h"
#include "base/threads.h"
#include "linalg/multifrontal.h"

#include <limits.h>
#include <string.h>

enum
{
    BATCH_NUMBERS = 1 << 19, ///< numbers in the buffer of one batch; at least one cell always fits
    OPERATIONS_AN_ENTRY = 10 ///< estimated cost of extracting and adding one entry, for threads_worth()
};

/// The cells in the support of every function, ascending.
typedef struct function_cells
{
    memory_pool pool;
    size_t *first; ///< functions + 2
    uint32_t *cell;
} function_cells;

static bat_status function_cells_make(const bat_hierarchical_space *space, function_cells *cells, bat_error *error)
{
    size_t functions = bat_hierarchical_space_functions(space), cell_count = bat_hierarchical_space_cells(space);
    const uint32_t *active;
    *cells = (function_cells){0};
    cells->first = memory_pool_zeros(&cells->pool, functions + 2, sizeof *cells->first);
    if (cells->first == NULL)
        return memory_pool_check(&cells->pool, error);
    for (size_t c = 0; c < cell_count; c++)
        for (size_t k = bat_hierarchical_space_active(space, c, &active); k-- > 0;)
            cells->first[active[k] + 2]++;
    for (size_t f = 0; f <= functions; f++)
        cells->first[f + 1] += cells->first[f];
    cells->cell = memory_pool_array(&cells->pool, cells->first[functions + 1], sizeof *cells->cell);
    if (cells->cell == NULL)
        return memory_pool_check(&cells->pool, error);
    for (size_t c = 0; c < cell_count; c++)
        for (size_t k = bat_hierarchical_space_active(space, c, &active); k-- > 0;)
            cells->cell[cells->first[active[k] + 1]++] = (uint32_t)c;
    return BAT_OK;
}

/// The row indices of column f: functions g >= f that share a cell with f, ascending.
/// @param marked marked[g] is 1 + the last column in which g was found
static size_t find_rows(const bat_hierarchical_space *space, const function_cells *cells, size_t f, uint32_t *marked,
                        int *rows)
{
    size_t count = 0;
    for (size_t c = cells->first[f]; c < cells->first[f + 1]; c++)
    {
        const uint32_t *active;
        size_t active_count = bat_hierarchical_space_active(space, cells->cell[c], &active);
        for (size_t k = active_count; k-- > 0 && active[k] >= f;)
            if (marked[active[k]] != f + 1)
            {
                marked[active[k]] = (uint32_t)f + 1;
                rows[count++] = (int)active[k];
            }
    }
    qsort(rows, count, sizeof *rows, ascending_int);
    return count;
}

/// Count or store the row indices of columns begin to end - 1.
static void find_range(const bat_hierarchical_space *space, const function_cells *cells, size_t begin, size_t end,
                       uint32_t *marked, int *rows, fit_pattern *pattern, bool counting)
{
    for (size_t f = begin; f < end; f++)
        if (counting)
            pattern->first[f + 1] = (int)find_rows(space, cells, f, marked, rows);
        else
            (void)find_rows(space, cells, f, marked, pattern->row + pattern->first[f]);
}

/// Count or store the row indices of all columns. False when out of memory.
static bool find_all(const bat_hierarchical_space *space, const function_cells *cells, int threads, fit_pattern *pattern,
                     bool counting)
{
    size_t functions = pattern->functions, maximum = functions;
    double active = (double)hierarchical_space_max_active(space), operations = (double)functions * active * active;
    int used = threads_worth(threads, (functions + 255) / 256, operations);
    bool allocated = true;
#pragma omp parallel for schedule(static) num_threads(used) reduction(&& : allocated)
    for (int t = 0; t < used; t++)
    {
        uint32_t *marked = calloc(functions, sizeof *marked);
        int *rows = counting ? memory_array(maximum, sizeof *rows) : NULL;
        allocated = allocated && marked != NULL && (rows != NULL || !counting);
        if (allocated)
            find_range(space, cells, functions * (size_t)t / (size_t)used, functions * ((size_t)t + 1) / (size_t)used,
                       marked, rows, pattern, counting);
        free(marked);
        free(rows);
    }
    return allocated;
}

bat_status fit_system_reserve(fit_system *system, bat_error *error)
{
    fit_pattern *pattern = &system->pattern;
    size_t total = 0;
    for (size_t f = 0; f < pattern->functions; f++)
    {
        total += (size_t)pattern->first[f + 1];
        if (total > INT_MAX)
            return ERROR_TOO_LARGE(error, "the matrix of %zu functions has too many entries", pattern->functions);
        pattern->first[f + 1] = (int)total;
    }
    pattern->row = memory_pool_array(&system->pool, total, sizeof *pattern->row);
    system->gram = memory_pool_array(&system->pool, total, sizeof *system->gram);
    system->plate = memory_pool_array(&system->pool, total, sizeof *system->plate);
    system->right = memory_pool_array(&system->pool, system->functions * system->columns, sizeof *system->right);
    return memory_pool_check(&system->pool, error);
}

static bat_status make_pattern(fit_system *system, bat_error *error)
{
    fit_pattern *pattern = &system->pattern;
    size_t functions = pattern->functions = system->functions;
    pattern->first = memory_pool_zeros(&system->pool, functions + 1, sizeof *pattern->first);
    if (pattern->first == NULL)
        return memory_pool_check(&system->pool, error);
    function_cells cells;
    bat_status status = function_cells_make(system->space, &cells, error);
    if (status == BAT_OK && !find_all(system->space, &cells, system->threads, pattern, true))
        status = error_memory(error, functions * sizeof(uint32_t));
    if (status == BAT_OK)
        status = fit_system_reserve(system, error);
    if (status == BAT_OK && !find_all(system->space, &cells, system->threads, pattern, false))
        status = error_memory(error, functions * sizeof(uint32_t));
    memory_pool_free(&cells.pool);
    return status;
}

/// The contributions of a batch of cells, stored one after another.
typedef struct batch
{
    size_t begin, end; ///< cells
    size_t *place;     ///< offset of each cell's numbers
    double *numbers;
} batch;

static size_t numbers_of(const fit_cell_work *work, size_t active)
{
    return active * (active + work->columns);
}

/// Extend the batch by as many cells as fit the buffer, at least one.
static void batch_set(const bat_hierarchical_space *space, const fit_cell_work *work, size_t cells, size_t room, batch *now)
{
    const uint32_t *active;
    size_t used = 0;
    now->end = now->begin;
    while (now->end < cells)
    {
        size_t more = numbers_of(work, bat_hierarchical_space_active(space, now->end, &active));
        if (now->end > now->begin && used + more > room)
            break;
        now->place[now->end - now->begin] = used;
        used += more;
        now->end++;
    }
}

static bool batch_fill(const bat_hierarchical_space *space, const fit_cell_work *work, const batch *now, int threads)
{
    bool allocated = true;
#pragma omp parallel num_threads(threads) reduction(&& : allocated)
    {
        double *scratch = memory_array(work->scratch, sizeof *scratch);
        allocated = scratch != NULL;
#pragma omp for schedule(dynamic, 16)
        for (size_t c = now->begin; c < now->end; c++)
        {
            const uint32_t *active;
            size_t count = bat_hierarchical_space_active(space, c, &active);
            double *matrix = now->numbers + now->place[c - now->begin];
            double *right = matrix + count * count;
            if (scratch != NULL)
                work->fill(work->context, c, scratch, matrix, work->columns == 0 ? NULL : right);
        }
        free(scratch);
    }
    return allocated;
}

/// Add a column of a cell's matrix to the sparse matrix. Both row lists ascend, so that one pass merges them.
static void add_column(const fit_pattern *pattern, const uint32_t *active, size_t count, size_t k, const double *matrix,
                       double *values)
{
    const int *row = pattern->row;
    size_t at = (size_t)pattern->first[active[k]];
    for (size_t m = k; m < count; m++)
    {
        while (row[at] < (int)active[m])
            at++;
        values[at] += matrix[m * count + k];
    }
}

/// Add the contributions of a batch; each thread adds those of its own functions.
static void batch_add(const fit_pattern *pattern, const bat_hierarchical_space *space, const fit_cell_work *work,
                      const batch *now, int threads)
{
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++)
        for (size_t c = now->begin; c < now->end; c++)
        {
            const uint32_t *active;
            size_t count = bat_hierarchical_space_active(space, c, &active);
            const double *matrix = now->numbers + now->place[c - now->begin];
            const double *right = matrix + count * count;
            for (size_t k = 0; k < count; k++)
            {
                if (active[k] % (uint32_t)threads != (uint32_t)t)
                    continue;
                add_column(pattern, active, count, k, matrix, work->values);
                if (work->right != NULL)
                    vector_add(work->columns, 1, right + k * work->columns, work->right + active[k] * work->columns);
            }
        }
}

/// Estimated number of arithmetic operations to extract and add the matrices of all cells.
static double operations_to_add(const bat_hierarchical_space *space)
{
    const uint32_t *active;
    double squares = 0;
    for (size_t c = bat_hierarchical_space_cells(space); c-- > 0;)
    {
        double count = (double)bat_hierarchical_space_active(space, c, &active);
        squares += count * count;
    }
    return OPERATIONS_AN_ENTRY * squares;
}

bat_status fit_pattern_sum(const fit_pattern *pattern, const bat_hierarchical_space *space, const fit_cell_work *work,
                           int threads, bat_error *error)
{
    size_t cells = bat_hierarchical_space_cells(space), largest = numbers_of(work, hierarchical_space_max_active(space));
    size_t room = largest > BATCH_NUMBERS / cells ? BATCH_NUMBERS : cells * largest;
    room = room > largest ? room : largest;
    int used = threads_worth(threads, (cells + 15) / 16, work->operations + operations_to_add(space));
    bool adds = pattern->first != NULL;
    batch now = {.place = memory_array(cells, sizeof *now.place),
                 .numbers = adds ? memory_array(room, sizeof *now.numbers) : NULL};
    bat_status status =
        now.place != NULL && (now.numbers != NULL || !adds) ? BAT_OK : error_memory(error, room * sizeof(double));
    if (adds)
        memset(work->values, 0, (size_t)pattern->first[pattern->functions] * sizeof *work->values);
    if (adds && work->columns > 0)
        memset(work->right, 0, pattern->functions * work->columns * sizeof *work->right);
    for (; status == BAT_OK && now.begin < cells; now.begin = now.end)
    {
        batch_set(space, work, cells, room, &now);
        if (work->collect != NULL)
            status = work->collect(work->context, now.begin, now.end, now.place, now.numbers, error);
        else if (!batch_fill(space, work, &now, used))
            status = error_memory(error, work->scratch * sizeof(double));
        if (status == BAT_OK && adds)
            batch_add(pattern, space, work, &now, used);
    }
    free(now.place);
    free(now.numbers);
    return status;
}

// Assembly of the normal equations of a fit; see system.h.
//
// The thin-plate matrix is exact. On a cell the integrand is a sum of products of univariate polynomials, so that
//     M_ij = U2_ac V0_bd + U1_ac V1_bd + U0_ac V2_bd,   Uk_ac = integral of the k-th derivatives of functions a and c,
// with univariate integrals by Gauss-Legendre quadrature with degree + 1 nodes.

/// maximum number of functions of a cell in one direction, and of quadrature nodes
#define SIDE (BAT_SPLINE_MAX_DEGREE + 1)

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
    // Derivatives refer to the cell's local coordinate; each derivative by the parameter is a factor `spans`.
    for (int order = 0; order < 3; order++, scale *= spans * spans)
        vector_scale(side * side, scale, integrals->of[order]);
}

static void fill_thin_plate(const void *context, size_t index, double *scratch, double *matrix, double *right BAT_UNUSED)
{
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

bat_status fit_system_make(const bat_hierarchical_space *space, const fit_team *team, size_t dimension, bool levelled,
                           int threads, fit_system *system, bat_error *error)
{
    *system = (fit_system){.space = space,
                           .functions = bat_hierarchical_space_functions(space),
                           .dimension = dimension,
                           .columns = dimension + FIT_PROBES,
                           .threads = threads};
    if (!team_is_first(team))
        return BAT_OK;
    bat_status status = make_pattern(system, error);
    return status == BAT_OK ? fit_thin_plate(&system->pattern, space, levelled, threads, system->plate, error) : status;
}

void fit_system_free(fit_system *system)
{
    memory_pool_free(&system->pool);
    *system = (fit_system){0};
}

void fit_system_multiply(const fit_system *system, const double *values, size_t columns, const double *x, double *product)
{
    const fit_pattern *pattern = &system->pattern;
    memset(product, 0, system->functions * columns * sizeof *product);
    for (size_t j = 0; j < system->functions; j++)
    {
        vector_add(columns, values[pattern->first[j]], x + j * columns, product + j * columns);
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
    multifrontal *fronts;          ///< null with a team's solver
    const fit_team_solver *shared; ///< a team's solver; null for the library's
    const fit_pattern *pattern;    ///< of a team's solver
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

bat_status fit_solver_make_for(const fit_team *team, const fit_pattern *pattern, fit_solver **solver, bat_error *error)
{
    if (!team_is_first(team))
        return BAT_OK;
    if (team == NULL || team->solver.factor == NULL)
        return fit_solver_make(pattern, solver, error);
    fit_solver *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    *made = (fit_solver){.functions = pattern->functions, .shared = &team->solver, .pattern = pattern};
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
    if (solver->shared != NULL)
    {
        bat_status status = solver->shared->factor(solver->shared->context, solver->functions, pattern->first, pattern->row,
                                                   values, &regular, error);
        *pivot = regular ? 1 : 0;
        return status;
    }
    return multifrontal_factor(solver->fronts, values, NULL, pivot, error);
}

bat_status fit_solver_solve(fit_solver *solver, size_t columns, const double *right, double *solution, bat_error *error)
{
    const fit_team_solver *shared = solver->shared;
    size_t bytes = solver->functions * columns * sizeof *solution;
    if (shared != NULL)
    {
        double *copy = right == solution ? memory_array(1, bytes) : NULL;
        if (right == solution && copy == NULL)
            return error_memory(error, bytes);
        if (copy != NULL)
            memcpy(copy, right, bytes);
        bat_status status = shared->solve(shared->context, columns, copy != NULL ? copy : right, solution, error);
        free(copy);
        return status;
    }
    memmove(solution, right, bytes);
    return multifrontal_solve(solver->fronts, columns, solution, error);
}
