#include "linalg/dense.h"
#include "linalg/sparse.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// An approximate inverse of I - W by smoothed aggregation (Vaněk, Mandel and Brezina 1996): unknowns are gathered around
// some of them; a correction is constant on each gathering, smoothed once; a coarser level's equations are the sums over
// gatherings. One cycle is a sweep of Gauss and Seidel forward, the correction from the coarser level, and a sweep
// backward. All vectors have two columns.

typedef struct average_level
{
    sparse_rows matrix;       ///< the diagonal first in each row
    sparse_rows prolongation; ///< to this level from the next coarser one; none on the last
    uint32_t *gathering;      ///< of each unknown: its number on the next coarser level
    double *right;            ///< count x 2 each: what the cycle has to undo here, its result, and the rest;
    double *result;           ///< the finest level's right side and result are the caller's
    double *rest;
} average_level;

enum
{
    AVERAGE_LEVELS = 24,
    AVERAGE_BLOCK =
        16384,            ///< rows that a sweep goes through one after the other; blocks do not see each other's new numbers
    AVERAGE_COARSEST = 48 ///< unknowns that are solved for densely
};

typedef struct average_hierarchy
{
    average_level levels[AVERAGE_LEVELS];
    size_t level_count;
    double *dense; ///< the LU decomposition of the last level, row-major
    size_t *pivots;
    int threads; ///< of the cycle; the result is the same
} average_hierarchy;

/// The number of the gathering of an unknown that is in none.
static const uint32_t ALONE = UINT32_MAX;

/// An entry is strong when it is at least this share of the largest one of its row.
static const double STRONG = 0.25;
/// 4 / 3 over a bound of the spectral radius of D^-1 A, which is 2 for an M-matrix.
static const double DAMPING = 2.0 / 3.0;

static void average_hierarchy_free(average_hierarchy *hierarchy)
{
    for (size_t l = 0; l < AVERAGE_LEVELS; l++)
    {
        average_level *level = &hierarchy->levels[l];
        sparse_rows_free(&level->matrix);
        sparse_rows_free(&level->prolongation);
        free(level->gathering);
        free(level->right);
        free(level->result);
        free(level->rest);
    }
    free(hierarchy->dense);
    free(hierarchy->pivots);
    *hierarchy = (average_hierarchy){0};
}

static bat_status make_finest(const sparse_rows *weights, sparse_rows *matrix, bat_error *error)
{
    size_t count = weights->row_count;
    bat_status status = sparse_rows_make(count, count, weights->starts[count] + count, matrix, error);
    if (status != BAT_OK)
        return status;
    size_t at = 0;
    for (size_t i = 0; i < count; i++)
    {
        matrix->starts[i] = at;
        matrix->columns[at] = (uint32_t)i;
        matrix->values[at++] = 1;
        for (size_t e = weights->starts[i]; e < weights->starts[i + 1]; e++)
        {
            matrix->columns[at] = weights->columns[e];
            matrix->values[at++] = -weights->values[e];
        }
    }
    return BAT_OK;
}

/// The size below which an entry of row i is weak.
static double strong_bound(const sparse_rows *matrix, size_t i)
{
    double largest = 0;
    for (size_t e = matrix->starts[i] + 1; e < matrix->starts[i + 1]; e++)
        largest = fmax(largest, fabs(matrix->values[e]));
    return STRONG * largest;
}

/// Whether none of the strong neighbours of i is gathered yet.
static bool is_free(const sparse_rows *matrix, size_t i, const uint32_t *gathering)
{
    if (gathering[i] != ALONE)
        return false;
    double bound = strong_bound(matrix, i);
    for (size_t e = matrix->starts[i] + 1; e < matrix->starts[i + 1]; e++)
        if (fabs(matrix->values[e]) >= bound && gathering[matrix->columns[e]] != ALONE)
            return false;
    return true;
}

/// Puts i and its strong neighbours that are still alone into a gathering.
static void gather_around(const sparse_rows *matrix, size_t i, uint32_t number, uint32_t *gathering)
{
    double bound = strong_bound(matrix, i);
    gathering[i] = number;
    for (size_t e = matrix->starts[i] + 1; e < matrix->starts[i + 1]; e++)
        if (fabs(matrix->values[e]) >= bound && gathering[matrix->columns[e]] == ALONE)
            gathering[matrix->columns[e]] = number;
}

/// The gathering that the strongest neighbour of i had joined in the first pass; ALONE for none.
static uint32_t strongest_gathering(const sparse_rows *matrix, size_t i, const uint32_t *gathering)
{
    double strongest = 0;
    uint32_t found = ALONE;
    for (size_t e = matrix->starts[i] + 1; e < matrix->starts[i + 1]; e++)
        if (fabs(matrix->values[e]) > strongest && gathering[matrix->columns[e]] != ALONE)
        {
            strongest = fabs(matrix->values[e]);
            found = gathering[matrix->columns[e]];
        }
    return found;
}

/// Gathers all unknowns; returns the number of gatherings.
static uint32_t gather(const sparse_rows *matrix, uint32_t *gathering, uint32_t *joined)
{
    size_t count = matrix->row_count;
    uint32_t gatherings = 0;
    memset(gathering, 0xff, count * sizeof *gathering);
    for (size_t i = 0; i < count; i++)
        if (is_free(matrix, i, gathering))
            gather_around(matrix, i, gatherings++, gathering);
    for (size_t i = 0; i < count; i++)
        joined[i] = gathering[i] != ALONE ? gathering[i] : strongest_gathering(matrix, i, gathering);
    memcpy(gathering, joined, count * sizeof *gathering);
    for (size_t i = 0; i < count; i++)
        if (gathering[i] == ALONE)
            gather_around(matrix, i, gatherings++, gathering);
    return gatherings;
}

/// Adds to a row of the prolongation that begins at `start`, and returns its new end.
static size_t add_to_row(sparse_rows *prolongation, size_t start, size_t end, uint32_t column, double value)
{
    for (size_t e = start; e < end; e++)
        if (prolongation->columns[e] == column)
        {
            prolongation->values[e] += value;
            return end;
        }
    prolongation->columns[end] = column;
    prolongation->values[end] = value;
    return end + 1;
}

/// (I - damping D^-1 A) applied to constants on the gatherings.
static bat_status make_prolongation(const sparse_rows *matrix, const uint32_t *gathering, uint32_t gatherings,
                                    double damping, sparse_rows *prolongation, bat_error *error)
{
    size_t count = matrix->row_count;
    bat_status status = sparse_rows_make(count, gatherings, matrix->starts[count], prolongation, error);
    if (status != BAT_OK)
        return status;
    size_t end = 0;
    for (size_t i = 0; i < count; i++)
    {
        size_t start = prolongation->starts[i] = end;
        double factor = damping / matrix->values[matrix->starts[i]];
        end = add_to_row(prolongation, start, end, gathering[i], 1);
        for (size_t e = matrix->starts[i]; e < matrix->starts[i + 1]; e++)
            end = add_to_row(prolongation, start, end, gathering[matrix->columns[e]], -factor * matrix->values[e]);
    }
    prolongation->starts[count] = end;
    return BAT_OK;
}

/// Sums the rows of each gathering: coarse = S A P, where S is the prolongation that was not smoothed, transposed. Smoothing
/// both sides suits symmetric matrices; here rows may differ in scale, and a coarse diagonal would not stay above 0.
static bat_status make_coarse(const sparse_rows *matrix, const sparse_rows *prolongation, const uint32_t *gathering,
                              sparse_rows *coarse, bat_error *error)
{
    size_t count = matrix->row_count;
    sparse_rows gathers = {0}, sums = {0}, product = {0};
    bat_status status = sparse_rows_make(count, prolongation->column_count, count, &gathers, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        gathers.starts[i] = i;
        gathers.columns[i] = gathering[i];
        gathers.values[i] = 1;
    }
    if (status == BAT_OK)
        status = sparse_rows_transpose(&gathers, &sums, error);
    if (status == BAT_OK)
        status = sparse_rows_multiply(matrix, prolongation, false, &product, error);
    if (status == BAT_OK)
        status = sparse_rows_multiply(&sums, &product, true, coarse, error);
    sparse_rows_free(&gathers);
    sparse_rows_free(&sums);
    sparse_rows_free(&product);
    return status;
}

/// Whether sweeps can run: each row begins with a diagonal above 0.
static bool has_diagonal(const sparse_rows *matrix)
{
    for (size_t i = 0; i < matrix->row_count; i++)
        if (matrix->starts[i] == matrix->starts[i + 1] || matrix->columns[matrix->starts[i]] != i ||
            !(matrix->values[matrix->starts[i]] > 0))
            return false;
    return true;
}

/// The prolongation smoothed by so much, and the coarser matrix.
static bat_status try_coarser(average_level *level, uint32_t gatherings, double damping, average_level *coarser,
                              bat_error *error)
{
    sparse_rows_free(&level->prolongation);
    sparse_rows_free(&coarser->matrix);
    bat_status status =
        make_prolongation(&level->matrix, level->gathering, gatherings, damping, &level->prolongation, error);
    if (status == BAT_OK)
        status = make_coarse(&level->matrix, &level->prolongation, level->gathering, &coarser->matrix, error);
    return status;
}

static bat_status build_coarser(average_level *level, average_level *coarser, bat_error *error)
{
    size_t count = level->matrix.row_count;
    uint32_t *joined = memory_array(count, sizeof *joined);
    level->gathering = memory_array(count, sizeof *level->gathering);
    if (joined == NULL || level->gathering == NULL)
    {
        free(joined);
        return error_memory(error, count * 2 * sizeof *joined);
    }
    uint32_t gatherings = gather(&level->matrix, level->gathering, joined);
    free(joined);
    if (gatherings > count / 10 * 9)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the unknowns of a system of averages do not hang together");
    bat_status status = try_coarser(level, gatherings, DAMPING, coarser, error);
    // Without smoothing the sums of an M-matrix are one again.
    if (status == BAT_OK && !has_diagonal(&coarser->matrix))
        status = try_coarser(level, gatherings, 0, coarser, error);
    if (status == BAT_OK && !has_diagonal(&coarser->matrix))
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "a coarser system of averages has no diagonal");
    return status;
}

static bat_status make_vectors(average_hierarchy *hierarchy, bat_error *error)
{
    for (size_t l = 0; l < hierarchy->level_count; l++)
    {
        average_level *level = &hierarchy->levels[l];
        size_t count = level->matrix.row_count;
        level->rest = memory_array(count, 2 * sizeof(double));
        level->right = l > 0 ? memory_array(count, 2 * sizeof(double)) : NULL;
        level->result = l > 0 ? memory_array(count, 2 * sizeof(double)) : NULL;
        if (level->rest == NULL || (l > 0 && (level->right == NULL || level->result == NULL)))
            return error_memory(error, count * 2 * sizeof(double));
    }
    return BAT_OK;
}

static bat_status build_coarsest(average_hierarchy *hierarchy, bat_error *error)
{
    const sparse_rows *matrix = &hierarchy->levels[hierarchy->level_count - 1].matrix;
    size_t n = matrix->row_count;
    hierarchy->dense = memory_array(n * n, sizeof(double));
    hierarchy->pivots = memory_array(n, sizeof(size_t));
    if (hierarchy->dense == NULL || hierarchy->pivots == NULL)
        return error_memory(error, n * n * sizeof(double));
    memset(hierarchy->dense, 0, n * n * sizeof(double));
    for (size_t i = 0; i < n; i++)
        for (size_t e = matrix->starts[i]; e < matrix->starts[i + 1]; e++)
            hierarchy->dense[i * n + matrix->columns[e]] += matrix->values[e];
    if (!decompose_factor(n, hierarchy->dense, hierarchy->pivots))
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the system of averages is singular");
    return BAT_OK;
}

/// @return BAT_OK, BAT_NO_CONVERGENCE where unknowns cannot be gathered or the coarsest matrix is singular, BAT_NO_MEMORY
static bat_status average_hierarchy_build(const sparse_rows *weights, int threads, average_hierarchy *hierarchy,
                                          bat_error *error)
{
    *hierarchy = (average_hierarchy){.level_count = 1, .threads = threads};
    bat_status status = make_finest(weights, &hierarchy->levels[0].matrix, error);
    while (status == BAT_OK && hierarchy->levels[hierarchy->level_count - 1].matrix.row_count > AVERAGE_COARSEST)
    {
        if (hierarchy->level_count == AVERAGE_LEVELS)
            status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "a system of averages has too many levels");
        else
        {
            average_level *level = &hierarchy->levels[hierarchy->level_count++ - 1];
            status = build_coarser(level, level + 1, error);
        }
    }
    if (status == BAT_OK)
        status = make_vectors(hierarchy, error);
    if (status == BAT_OK)
        status = build_coarsest(hierarchy, error);
    if (status != BAT_OK)
        average_hierarchy_free(hierarchy);
    return status;
}

/// One row's step of Gauss and Seidel within a block of `size` rows from `begin` on; other rows are as they were before.
static inline void sweep_row(const sparse_rows *matrix, size_t i, size_t begin, size_t size, const double *right,
                             const double *before, double *x)
{
    size_t e = matrix->starts[i];
    double diagonal = matrix->values[e], first = right[2 * i], second = right[2 * i + 1];
    for (e++; e < matrix->starts[i + 1]; e++)
    {
        size_t column = matrix->columns[e];
        const double *at = (column - begin < size ? x : before) + 2 * column;
        first -= matrix->values[e] * at[0];
        second -= matrix->values[e] * at[1];
    }
    x[2 * i] = first / diagonal;
    x[2 * i + 1] = second / diagonal;
}

/// A sweep through all rows, in blocks.
static void sweep(const average_level *level, int threads, bool forward, const double *right, double *x)
{
    size_t count = level->matrix.row_count, blocks = (count + AVERAGE_BLOCK - 1) / AVERAGE_BLOCK;
    if (blocks > 1)
        memcpy(level->rest, x, 2 * count * sizeof *x);
#pragma omp parallel for num_threads(threads_for(threads, blocks)) schedule(static)
    for (size_t b = 0; b < blocks; b++)
    {
        size_t begin = b * AVERAGE_BLOCK, end = begin + AVERAGE_BLOCK < count ? begin + AVERAGE_BLOCK : count;
        for (size_t k = 0; k < end - begin; k++)
            sweep_row(&level->matrix, forward ? begin + k : end - 1 - k, begin, end - begin, right, level->rest, x);
    }
}

static void find_rest(const average_level *level, int threads, const double *right, const double *x)
{
    sparse_rows_apply_pairs(&level->matrix, threads, x, level->rest);
    for (size_t i = 0; i < 2 * level->matrix.row_count; i++)
        level->rest[i] = right[i] - level->rest[i];
}

/// The sums of the rest over gatherings.
static void restrict_rest(const average_level *level, double *coarse)
{
    memset(coarse, 0, 2 * level->prolongation.column_count * sizeof *coarse);
    for (size_t i = 0; i < level->matrix.row_count; i++)
    {
        double *to = coarse + 2 * (size_t)level->gathering[i];
        to[0] += level->rest[2 * i];
        to[1] += level->rest[2 * i + 1];
    }
}

/// x += P coarse
static void add_correction(const average_level *level, const double *coarse, double *x)
{
    const sparse_rows *prolongation = &level->prolongation;
    for (size_t i = 0; i < prolongation->row_count; i++)
        for (size_t e = prolongation->starts[i]; e < prolongation->starts[i + 1]; e++)
            for (size_t c = 0; c < 2; c++)
                x[2 * i + c] += prolongation->values[e] * coarse[2 * (size_t)prolongation->columns[e] + c];
}

/// result = roughly (I - W)^-1 right, linear in `right`.
static void average_hierarchy_cycle(average_hierarchy *hierarchy, const double *right, double *result)
{
    size_t last = hierarchy->level_count - 1;
    for (size_t l = 0; l < last; l++)
    {
        average_level *level = &hierarchy->levels[l];
        const double *b = l == 0 ? right : level->right;
        double *own = l == 0 ? result : level->result;
        size_t count = level->matrix.row_count;
        memset(own, 0, 2 * count * sizeof *own);
        sweep(level, hierarchy->threads, true, b, own);
        find_rest(level, hierarchy->threads, b, own);
        restrict_rest(level, level[1].right);
    }
    average_level *coarsest = &hierarchy->levels[last];
    double *x = last == 0 ? result : coarsest->result;
    size_t n = coarsest->matrix.row_count;
    memcpy(x, last == 0 ? right : coarsest->right, 2 * n * sizeof *x);
    decompose_substitute(n, 2, hierarchy->dense, hierarchy->pivots, x);
    for (size_t l = last; l-- > 0;)
    {
        average_level *level = &hierarchy->levels[l];
        x = l == 0 ? result : level->result;
        add_correction(level, level[1].result, x);
        sweep(level, hierarchy->threads, false, l == 0 ? right : level->right, x);
    }
}

// Iterations

enum
{
    ITERATIONS = 100, ///< of a run
    RUNS = 8,         ///< each begins from the true residual
    SLOW_RUNS = 2,    ///< runs that barely help are forgiven so often once the residual is small
    VECTORS = 7
};

/// A residual of so many units of rounding of the largest constant is small enough, times the root of thousands of unknowns.
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

/// Unknowns that a decomposition is tried for: its time and memory grow faster than they.
static const int MAX_DIRECT = 100000;

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
