#include "linalg/average_hierarchy.h"
#include "linalg/average_system.h"

#include "base/error.h"
#include "base/memory.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    ITERATIONS = 100, ///< of a run
    RUNS = 8,         ///< each begins from the true residual
    SLOW_RUNS = 2,    ///< runs that barely help are forgiven so often once the residual is small
    VECTORS = 7
};

/// A residual of so many units of rounding, in proportion to the largest constant, is small enough for a thousand unknowns; for more, the
/// root of their number times as many.
static const double ENOUGH = 16 * DBL_EPSILON;
static const double FEW = 1000;
/// Where the residual no longer falls, so many times as much will do.
static const double FORGIVEN = 4;
/// One run need not do more than this.
static const double RUN_REDUCTION = 1e-9;

/// The vectors of BiCGSTAB, count x 2 each.
typedef struct iteration
{
    const sparse_rows *weights;
    average_hierarchy hierarchy;
    double *residual, *shadow, *direction, *smooth, *image, *smooth_residual, *residual_image;
    size_t count;
} iteration;

/// image = (I - W) x
static void apply(const sparse_rows *weights, const double *x, double *image)
{
    sparse_rows_apply_pairs(weights, x, image);
    for (size_t i = 0; i < 2 * weights->row_count; i++)
        image[i] = x[i] - image[i];
}

/// The inner product of each column.
static void multiply_columns(size_t count, const double *a, const double *b, double product[2])
{
    product[0] = product[1] = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 2; c++)
            product[c] += a[2 * i + c] * b[2 * i + c];
}

static double largest(size_t count, const double *a)
{
    double found = 0;
    for (size_t i = 0; i < 2 * count; i++)
        found = a[i] <= found && a[i] >= -found ? found : fabs(a[i]);
    return found;
}

/// a / b, 0 where a column has nothing left to do.
static double ratio(double a, double b)
{
    return b != 0 && isfinite(a / b) ? a / b : 0;
}

/// Run from the residual in it->residual; adds to x.
static void run(iteration *it, double target, double *x)
{
    size_t count = it->count;
    double before[2], now[2], step[2], length[2], product[2], square[2];
    memcpy(it->shadow, it->residual, 2 * count * sizeof(double));
    memcpy(it->direction, it->residual, 2 * count * sizeof(double));
    multiply_columns(count, it->shadow, it->residual, before);
    for (size_t round = 0; round < ITERATIONS; round++)
    {
        average_hierarchy_cycle(&it->hierarchy, it->direction, it->smooth);
        apply(it->weights, it->smooth, it->image);
        multiply_columns(count, it->shadow, it->image, product);
        for (size_t c = 0; c < 2; c++)
            step[c] = ratio(before[c], product[c]);
        for (size_t i = 0; i < 2 * count; i++)
            it->residual[i] -= step[i % 2] * it->image[i];
        average_hierarchy_cycle(&it->hierarchy, it->residual, it->smooth_residual);
        apply(it->weights, it->smooth_residual, it->residual_image);
        multiply_columns(count, it->residual_image, it->residual, product);
        multiply_columns(count, it->residual_image, it->residual_image, square);
        for (size_t c = 0; c < 2; c++)
            length[c] = ratio(product[c], square[c]);
        for (size_t i = 0; i < 2 * count; i++)
        {
            x[i] += step[i % 2] * it->smooth[i] + length[i % 2] * it->smooth_residual[i];
            it->residual[i] -= length[i % 2] * it->residual_image[i];
        }
        double left = largest(count, it->residual);
        if (!(left > target))
            return;
        multiply_columns(count, it->shadow, it->residual, now);
        for (size_t c = 0; c < 2; c++)
        {
            product[c] = ratio(now[c], before[c]) * ratio(step[c], length[c]);
            before[c] = now[c];
        }
        for (size_t i = 0; i < 2 * count; i++)
            it->direction[i] = it->residual[i] + product[i % 2] * (it->direction[i] - length[i % 2] * it->image[i]);
    }
}

static bool settle(iteration *it, const double *constant, double *x)
{
    size_t count = it->count, slow = 0;
    double before = INFINITY, enough = ENOUGH * fmax(sqrt((double)count / FEW), 1) * largest(count, constant);
    memset(x, 0, 2 * count * sizeof *x);
    for (size_t r = 0; r < RUNS; r++)
    {
        apply(it->weights, x, it->residual);
        for (size_t i = 0; i < 2 * count; i++)
            it->residual[i] = constant[i] - it->residual[i];
        double left = largest(count, it->residual);
        if (left <= enough)
            return true;
        slow += left > 0.5 * before;
        if (slow >= SLOW_RUNS)
            return left <= FORGIVEN * enough;
        before = left;
        run(it, fmax(0.5 * enough, RUN_REDUCTION * left), x);
    }
    return before <= FORGIVEN * enough;
}

bat_status average_solve_iterative(const sparse_rows *weights, const double *constant, double *x, bat_error *error)
{
    size_t count = weights->row_count;
    if (count == 0)
        return BAT_OK;
    double *vectors = memory_array(VECTORS * count, 2 * sizeof *vectors);
    if (vectors == NULL)
        return error_memory(error, VECTORS * count * 2 * sizeof *vectors);
    iteration it = {.weights = weights, .count = count};
    double **places[VECTORS] = {&it.residual, &it.shadow,          &it.direction,     &it.smooth,
                                &it.image,    &it.smooth_residual, &it.residual_image};
    for (size_t v = 0; v < VECTORS; v++)
        *places[v] = vectors + v * 2 * count;
    bat_status status = average_hierarchy_build(weights, &it.hierarchy, error);
    bool settled = status == BAT_OK && settle(&it, constant, x);
    average_hierarchy_free(&it.hierarchy);
    free(vectors);
    if (status == BAT_NO_MEMORY || settled)
        return status;
    return average_solve_direct(weights, constant, x, error);
}
