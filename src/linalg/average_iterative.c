#include "linalg/average_hierarchy.h"
#include "linalg/average_system.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

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

/// A residual of so many units of rounding, in proportion to the largest constant, is small enough for a thousand unknowns;
/// for more, the root of their number times as many.
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
    double *partial; ///< 2 for each block: sums are made block by block, whatever the threads
    size_t count, blocks;
    int threads;
} iteration;

/// Where a block of vectors begins and ends.
typedef struct block
{
    size_t begin, end;
} block;

static block block_at(const iteration *it, size_t b)
{
    size_t end = (b + 1) * AVERAGE_BLOCK;
    return (block){2 * b * AVERAGE_BLOCK, 2 * (end < it->count ? end : it->count)};
}

static int threads_of(const iteration *it)
{
    return threads_for(it->threads, it->blocks);
}

/// image = (I - W) x
static void apply(const iteration *it, const double *x, double *image)
{
    sparse_rows_apply_pairs(it->weights, it->threads, x, image);
#pragma omp parallel for num_threads(threads_of(it)) schedule(static)
    for (size_t b = 0; b < it->blocks; b++)
        for (size_t i = block_at(it, b).begin; i < block_at(it, b).end; i++)
            image[i] = x[i] - image[i];
}

/// The inner product of each column.
static void multiply_columns(const iteration *it, const double *u, const double *v, double product[2])
{
#pragma omp parallel for num_threads(threads_of(it)) schedule(static)
    for (size_t b = 0; b < it->blocks; b++)
    {
        block at = block_at(it, b);
        double first = 0, second = 0;
        for (size_t i = at.begin; i < at.end; i += 2)
        {
            first += u[i] * v[i];
            second += u[i + 1] * v[i + 1];
        }
        it->partial[2 * b] = first;
        it->partial[2 * b + 1] = second;
    }
    product[0] = product[1] = 0;
    for (size_t b = 0; b < 2 * it->blocks; b++)
        product[b % 2] += it->partial[b];
}

/// result_i = u_i + factor v_i, with a factor for each column; `result` may be `u`.
static void add_multiple(const iteration *it, const double *u, const double factor[2], const double *v, double *result)
{
#pragma omp parallel for num_threads(threads_of(it)) schedule(static)
    for (size_t b = 0; b < it->blocks; b++)
    {
        block at = block_at(it, b);
        for (size_t i = at.begin; i < at.end; i += 2)
        {
            result[i] = u[i] + factor[0] * v[i];
            result[i + 1] = u[i + 1] + factor[1] * v[i + 1];
        }
    }
}

/// The largest modulus; not a number where there is one.
static double largest(size_t count, const double *a)
{
    double found = 0;
    for (size_t i = 0; i < 2 * count; i++)
        found = a[i] <= found && a[i] >= -found ? found : fabs(a[i]);
    return found;
}

/// a / b of each column, 0 where nothing is left to do.
static void divide_columns(const double a[2], const double b[2], double ratio[2])
{
    for (size_t c = 0; c < 2; c++)
        ratio[c] = b[c] != 0 && isfinite(a[c] / b[c]) ? a[c] / b[c] : 0;
}

/// The half step along the direction: x and the residual move; `step` is how far.
static void step_along_direction(iteration *it, const double before[2], double step[2], double *x)
{
    double product[2];
    average_hierarchy_cycle(&it->hierarchy, it->direction, it->smooth);
    apply(it, it->smooth, it->image);
    multiply_columns(it, it->shadow, it->image, product);
    divide_columns(before, product, step);
    const double back[2] = {-step[0], -step[1]};
    add_multiple(it, it->residual, back, it->image, it->residual);
    add_multiple(it, x, step, it->smooth, x);
}

/// The half step along the residual, as far as makes it least.
static void step_along_residual(iteration *it, double length[2], double *x)
{
    double product[2], square[2];
    average_hierarchy_cycle(&it->hierarchy, it->residual, it->smooth_residual);
    apply(it, it->smooth_residual, it->residual_image);
    multiply_columns(it, it->residual_image, it->residual, product);
    multiply_columns(it, it->residual_image, it->residual_image, square);
    divide_columns(product, square, length);
    const double back[2] = {-length[0], -length[1]};
    add_multiple(it, it->residual, back, it->residual_image, it->residual);
    add_multiple(it, x, length, it->smooth_residual, x);
}

/// Run from the residual in it->residual; adds to x.
static void run(iteration *it, double target, double *x)
{
    double before[2], now[2], step[2], length[2], turn[2], part[2];
    memcpy(it->shadow, it->residual, 2 * it->count * sizeof(double));
    memcpy(it->direction, it->residual, 2 * it->count * sizeof(double));
    multiply_columns(it, it->shadow, it->residual, before);
    for (size_t round = 0; round < ITERATIONS; round++)
    {
        step_along_direction(it, before, step, x);
        step_along_residual(it, length, x);
        if (!(largest(it->count, it->residual) > target))
            return;
        multiply_columns(it, it->shadow, it->residual, now);
        divide_columns(now, before, turn);
        divide_columns(step, length, part);
        const double back[2] = {-length[0], -length[1]}, next[2] = {turn[0] * part[0], turn[1] * part[1]};
        add_multiple(it, it->direction, back, it->image, it->direction);
        add_multiple(it, it->residual, next, it->direction, it->direction);
        memcpy(before, now, sizeof before);
    }
}

static bool settle(iteration *it, const double *constant, double *x)
{
    size_t count = it->count, slow = 0;
    double before = INFINITY, enough = ENOUGH * fmax(sqrt((double)count / FEW), 1) * largest(count, constant);
    memset(x, 0, 2 * count * sizeof *x);
    for (size_t r = 0; r < RUNS; r++)
    {
        apply(it, x, it->residual);
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

enum
{
    MAX_DIRECT = 100000 ///< unknowns that a decomposition is tried for: its time and memory grow faster than they
};

bat_status average_solve_iterative(const sparse_rows *weights, const double *constant, int threads, double *x,
                                   bat_error *error)
{
    size_t count = weights->row_count;
    if (count == 0)
        return BAT_OK;
    iteration it = {
        .weights = weights, .count = count, .blocks = (count + AVERAGE_BLOCK - 1) / AVERAGE_BLOCK, .threads = threads};
    double *vectors = memory_array(VECTORS * count + it.blocks, 2 * sizeof *vectors);
    if (vectors == NULL)
        return error_memory(error, VECTORS * count * 2 * sizeof *vectors);
    double **places[VECTORS] = {&it.residual, &it.shadow,          &it.direction,     &it.smooth,
                                &it.image,    &it.smooth_residual, &it.residual_image};
    for (size_t v = 0; v < VECTORS; v++)
        *places[v] = vectors + v * 2 * count;
    it.partial = vectors + VECTORS * 2 * count;
    bat_status status = average_hierarchy_build(weights, threads, &it.hierarchy, error);
    bool settled = status == BAT_OK && settle(&it, constant, x);
    average_hierarchy_free(&it.hierarchy);
    free(vectors);
    if (status == BAT_NO_MEMORY || settled)
        return status;
    if (count > MAX_DIRECT)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "a system of %zu averages did not settle", count);
    return average_solve_direct(weights, constant, x, error);
}
