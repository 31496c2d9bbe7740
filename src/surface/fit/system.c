/// @file
/// Assembly of the normal equations of a fit; see system.h.
///
/// The thin-plate matrix is exact. On a cell the integrand is a sum of products of univariate polynomials, so that
///     M_ij = U2_ac V0_bd + U1_ac V1_bd + U0_ac V2_bd,   Uk_ac = integral of the k-th derivatives of functions a and c,
/// with univariate integrals by Gauss-Legendre quadrature with degree + 1 nodes.

#include "surface/fit/system.h"

#include "base/error.h"
#include "base/memory.h"
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
    side_integrals u, v;
    integrate_side(plate, cell, 0, &u);
    integrate_side(plate, cell, 1, &v);
    for (size_t b = 0; b < height; b++)
        for (size_t a = 0; a < width; a++)
            for (size_t d = 0; d < height; d++)
                for (size_t c = 0; c < width; c++)
                    scratch[(b * width + a) * locals + d * width + c] = u.of[2][a * width + c] * v.of[0][b * height + d] +
                                                                        u.of[1][a * width + c] * v.of[1][b * height + d] +
                                                                        u.of[0][a * width + c] * v.of[2][b * height + d];
    hierarchical_extract_matrix(plate->space, cell, scratch, scratch + locals * locals, matrix);
}

/// Compute the lower triangle of the thin-plate matrix M.
static bat_status fit_thin_plate(const fit_pattern *pattern, const bat_hierarchical_space *space, int threads,
                                 double *values, bat_error *error)
{
    size_t locals = hierarchical_locals(space);
    plate_context plate = {
        .space = space,
        .rule = {gauss_rule_make(space->options.degree[0] + 1), gauss_rule_make(space->options.degree[1] + 1)}};
    fit_cell_work work = {.fill = fill_thin_plate,
                          .context = &plate,
                          .scratch = locals * (locals + bat_hierarchical_space_max_active(space)),
                          .values = values};
    return fit_pattern_sum(pattern, space, &work, threads, error);
}

bat_status fit_system_make(const bat_hierarchical_space *space, size_t dimension, int threads, fit_system *system,
                           bat_error *error)
{
    *system = (fit_system){.space = space,
                           .functions = bat_hierarchical_space_functions(space),
                           .dimension = dimension,
                           .columns = dimension + FIT_PROBES,
                           .threads = threads};
    bat_status status = fit_pattern_make(space, threads, &system->pattern, error);
    if (status != BAT_OK)
        return status;
    size_t entries = (size_t)system->pattern.first[system->functions];
    system->gram = memory_array(entries, sizeof *system->gram);
    system->plate = memory_array(entries, sizeof *system->plate);
    system->right = memory_array(system->functions * system->columns, sizeof *system->right);
    if (system->gram == NULL || system->plate == NULL || system->right == NULL)
        return error_memory(error, entries * sizeof *system->gram);
    return fit_thin_plate(&system->pattern, space, threads, system->plate, error);
}

void fit_system_free(fit_system *system)
{
    fit_pattern_free(&system->pattern);
    free(system->gram);
    free(system->plate);
    free(system->right);
    *system = (fit_system){0};
}

/// The data from which the contribution of a cell is assembled.
typedef struct gather_context
{
    const fit_system *system;
    const fit_points *points;
    const double *rows; ///< count x dimension
    size_t probes;
} gather_context;

/// A pseudo-random sign that depends only on the point and the probe: one bit of the finalizer of splitmix64 (Steele, Lea
/// and Flood, 2014).
static double random_sign(uint32_t number, size_t probe)
{
    uint64_t z = ((uint64_t)probe << 32 | number) * UINT64_C(0x9e3779b97f4a7c15) + UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (z ^ z >> 31) >> 63 != 0 ? 1 : -1;
}

/// The coefficients of a point in the right-hand sides: w x for the coordinates, sqrt(w) z for the probes.
static void set_loads(const gather_context *gather, size_t row, double *loads)
{
    const fit_points *points = gather->points;
    size_t dimension = points->dimension;
    double weight = points->weight[row], root = sqrt(weight);
    for (size_t k = 0; k < dimension; k++)
        loads[k] = weight * gather->rows[row * dimension + k];
    for (size_t k = 0; k < gather->probes; k++)
        loads[dimension + k] = root * random_sign(points->number[row], k);
}

/// Add the contribution of a point with `count` function values to the lower triangle and the right-hand sides.
static void add_point(size_t count, const double *values, double weight, const double *loads, size_t columns, double *matrix,
                      double *right)
{
    for (size_t i = 0; i < count; i++)
    {
        double scaled = weight * values[i];
        if (matrix != NULL)
            for (size_t j = 0; j <= i; j++)
                matrix[i * count + j] += scaled * values[j];
        for (size_t k = 0; k < columns; k++)
            right[i * columns + k] += values[i] * loads[k];
    }
}

/// Whether evaluating the active functions at each point costs less than first assembling in the local functions.
static bool extract_points_first(size_t points, size_t locals, size_t coarse, size_t active)
{
    return points * (coarse * locals + active * active / 2) < points * locals * locals / 2 + 2 * coarse * locals * active;
}

static void mirror(size_t side, double *matrix)
{
    for (size_t i = 0; i < side; i++)
        for (size_t j = 0; j < i; j++)
            matrix[j * side + i] = matrix[i * side + j];
}

static void fill_from_points(const gather_context *gather, const hierarchical_cell *cell, size_t begin, size_t end,
                             double *scratch, double *matrix, double *right)
{
    const bat_hierarchical_space *space = gather->system->space;
    const fit_points *points = gather->points;
    size_t locals = hierarchical_locals(space), columns = points->dimension + gather->probes;
    double *loads = scratch, *values = loads + columns, *active = values + locals;
    for (size_t place = begin; place < end; place++)
    {
        size_t row = points->order[place];
        const double *at = points->parameter + 2 * row;
        hierarchical_local_values(space, cell, at[0], at[1], 0, values);
        hierarchical_extract_products(space, cell, values, 1, active);
        set_loads(gather, row, loads);
        add_point(cell->active, active, points->weight[row], loads, columns, matrix, right);
    }
}

static void fill_from_locals(const gather_context *gather, const hierarchical_cell *cell, size_t begin, size_t end,
                             double *scratch, double *matrix, double *right)
{
    const bat_hierarchical_space *space = gather->system->space;
    const fit_points *points = gather->points;
    size_t locals = hierarchical_locals(space), columns = points->dimension + gather->probes;
    double *loads = scratch, *values = loads + columns, *local_right = values + locals;
    double *local_matrix = local_right + locals * columns, *rest = local_matrix + locals * locals;
    memset(local_right, 0, locals * columns * sizeof *local_right);
    memset(local_matrix, 0, locals * locals * sizeof *local_matrix);
    for (size_t place = begin; place < end; place++)
    {
        size_t row = points->order[place];
        const double *at = points->parameter + 2 * row;
        hierarchical_local_values(space, cell, at[0], at[1], 0, values);
        set_loads(gather, row, loads);
        add_point(locals, values, points->weight[row], loads, columns, matrix == NULL ? NULL : local_matrix, local_right);
    }
    hierarchical_extract_products(space, cell, local_right, columns, right);
    if (matrix == NULL)
        return;
    mirror(locals, local_matrix);
    hierarchical_extract_matrix(space, cell, local_matrix, rest, matrix);
}

static void fill_cell(const void *context, size_t index, double *scratch, double *matrix, double *right)
{
    const gather_context *gather = context;
    const hierarchical_cell *cell = &gather->system->space->cells[index];
    size_t columns = gather->points->dimension + gather->probes, active = cell->active;
    size_t begin = gather->points->first[index], end = gather->points->first[index + 1];
    if (extract_points_first(end - begin, hierarchical_locals(gather->system->space), cell->coarse, active))
    {
        if (matrix != NULL)
            memset(matrix, 0, active * active * sizeof *matrix);
        memset(right, 0, active * columns * sizeof *right);
        fill_from_points(gather, cell, begin, end, scratch, matrix, right);
    }
    else
        fill_from_locals(gather, cell, begin, end, scratch, matrix, right);
}

static bat_status gather_all(const gather_context *gather, double *values, double *right, bat_error *error)
{
    const fit_system *system = gather->system;
    size_t locals = hierarchical_locals(system->space), active = bat_hierarchical_space_max_active(system->space);
    size_t columns = system->dimension + gather->probes;
    fit_cell_work work = {.fill = fill_cell,
                          .context = gather,
                          .scratch = columns + locals + locals * columns + locals * locals + active * locals + active,
                          .columns = columns,
                          .operations = (double)gather->points->count * (double)(100 + locals * locals),
                          .values = values,
                          .right = right};
    return fit_pattern_sum(&system->pattern, system->space, &work, system->threads, error);
}

bat_status fit_system_gather(fit_system *system, const fit_points *points, bat_error *error)
{
    system->square = 0;
    system->counted = 0;
    for (size_t row = 0; row < points->count; row++)
    {
        double square = 0;
        for (size_t k = 0; k < points->dimension; k++)
            square += points->position[row * points->dimension + k] * points->position[row * points->dimension + k];
        system->square += points->weight[row] * square;
        system->counted += points->weight[row] > 0;
    }
    gather_context gather = {system, points, points->position, FIT_PROBES};
    return gather_all(&gather, system->gram, system->right, error);
}

bat_status fit_system_gather_residual(const fit_system *system, const fit_points *points, const double *rows, double *result,
                                      bat_error *error)
{
    gather_context gather = {system, points, rows, 0};
    return gather_all(&gather, NULL, result, error);
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
