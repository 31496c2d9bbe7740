#include "linalg/average_hierarchy.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The number of the gathering of an unknown that is in none.
static const uint32_t ALONE = UINT32_MAX;

/// An entry is strong when it is at least this share of the largest one of its row.
static const double STRONG = 0.25;
/// 4 / 3 over a bound of the spectral radius of D^-1 A, which is 2 for an M-matrix.
static const double DAMPING = 2.0 / 3.0;

void average_hierarchy_free(average_hierarchy *hierarchy)
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

/// LU decomposition of the dense matrix in place, with row exchanges; false when it is singular.
static bool decompose(size_t n, double *a, size_t *pivots)
{
    for (size_t k = 0; k < n; k++)
    {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[pivot * n + k]))
                pivot = i;
        pivots[k] = pivot;
        if (!(fabs(a[pivot * n + k]) > 0))
            return false;
        for (size_t j = 0; j < n && pivot != k; j++)
        {
            double kept = a[k * n + j];
            a[k * n + j] = a[pivot * n + j];
            a[pivot * n + j] = kept;
        }
        for (size_t i = k + 1; i < n; i++)
        {
            double factor = a[i * n + k] /= a[k * n + k];
            for (size_t j = k + 1; factor != 0 && j < n; j++)
                a[i * n + j] -= factor * a[k * n + j];
        }
    }
    return true;
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
    if (!decompose(n, hierarchy->dense, hierarchy->pivots))
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the system of averages is singular");
    return BAT_OK;
}

bat_status average_hierarchy_build(const sparse_rows *weights, int threads, average_hierarchy *hierarchy, bat_error *error)
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

/// Solve with the LU decomposition.
static void solve_coarsest(const average_hierarchy *hierarchy, size_t n, const double *right, double *x)
{
    const double *a = hierarchy->dense;
    memcpy(x, right, 2 * n * sizeof *x);
    for (size_t k = 0; k < n; k++)
        for (size_t c = 0; c < 2; c++)
        {
            size_t pivot = hierarchy->pivots[k];
            double kept = x[2 * pivot + c];
            x[2 * pivot + c] = x[2 * k + c];
            x[2 * k + c] = kept;
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            for (size_t c = 0; c < 2; c++)
                x[2 * i + c] -= a[i * n + j] * x[2 * j + c];
    for (size_t i = n; i-- > 0;)
        for (size_t c = 0; c < 2; c++)
        {
            double sum = x[2 * i + c];
            for (size_t j = i + 1; j < n; j++)
                sum -= a[i * n + j] * x[2 * j + c];
            x[2 * i + c] = sum / a[i * n + i];
        }
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

void average_hierarchy_cycle(average_hierarchy *hierarchy, const double *right, double *result)
{
    size_t last = hierarchy->level_count - 1;
    for (size_t l = 0; l < last; l++)
    {
        average_level *level = &hierarchy->levels[l];
        const double *b = l == 0 ? right : level->right;
        double *x = l == 0 ? result : level->result;
        size_t count = level->matrix.row_count;
        memset(x, 0, 2 * count * sizeof *x);
        sweep(level, hierarchy->threads, true, b, x);
        find_rest(level, hierarchy->threads, b, x);
        restrict_rest(level, level[1].right);
    }
    average_level *coarsest = &hierarchy->levels[last];
    solve_coarsest(hierarchy, coarsest->matrix.row_count, last == 0 ? right : coarsest->right,
                   last == 0 ? result : coarsest->result);
    for (size_t l = last; l-- > 0;)
    {
        average_level *level = &hierarchy->levels[l];
        double *x = l == 0 ? result : level->result;
        add_correction(level, level[1].result, x);
        sweep(level, hierarchy->threads, false, l == 0 ? right : level->right, x);
    }
}
