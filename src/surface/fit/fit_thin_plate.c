#include "surface/fit/fit_thin_plate.h"

#include "surface/spline/hierarchical_space.h"

#include <math.h>
#include <string.h>

enum
{
    SIDE = BAT_SPLINE_MAX_DEGREE + 1 ///< the most functions of a cell in one direction, and nodes of a rule
};

/// Gauss' rule on [0, 1] for polynomials of degree 2 count - 1.
typedef struct gauss_rule
{
    int count;
    double node[SIDE], weight[SIDE];
} gauss_rule;

/// Legendre's polynomial of degree n and its derivative at x inside of (-1, 1).
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

/// Nodes are the zeros of Legendre's polynomial, by Newton's method from Tricomi's approximation.
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

/// Univariate integrals over a cell, of products of two functions' derivatives of order 0, 1, 2.
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
    // Derivatives are by places within the cell: each by the parameter is one by those times the number of spans.
    for (int order = 0; order < 3; order++, scale *= spans * spans)
        for (size_t k = 0; k < side * side; k++)
            integrals->of[order][k] *= scale;
}

static void fill_cell(const void *context, size_t index, double *scratch, double *matrix, double *right)
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

bat_status fit_thin_plate(const fit_pattern *pattern, const bat_hierarchical_space *space, int threads, double *values,
                          bat_error *error)
{
    size_t locals = hierarchical_locals(space);
    plate_context plate = {
        .space = space,
        .rule = {gauss_rule_make(space->options.degree[0] + 1), gauss_rule_make(space->options.degree[1] + 1)}};
    fit_cell_work work = {.fill = fill_cell,
                          .context = &plate,
                          .scratch = locals * (locals + bat_hierarchical_space_max_active(space)),
                          .values = values};
    return fit_pattern_sum(pattern, space, &work, threads, error);
}
