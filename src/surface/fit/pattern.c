/// @file
/// Assembly of sparse symmetric matrices over the cells of a hierarchical space; see system.h.
///
///     K = sum over cells c of E_c^T K_c E_c,   E_c selects the functions that are active on cell c.
///
/// Cells are processed in batches. All threads compute the contributions of a batch. Each thread then adds those of its own
/// functions, cell by cell. Every entry is therefore summed in the same order for any number of threads.

#include "surface/fit/system.h"
#include "surface/spline/hierarchical_space.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum
{
    BATCH_NUMBERS = 1 << 19, ///< numbers in the buffer of one batch; at least one cell always fits
    OPERATIONS_AN_ENTRY = 10 ///< estimated cost of extracting and adding one entry, for threads_worth()
};

/// The cells in the support of every function, ascending.
typedef struct function_cells
{
    size_t *first; ///< functions + 2
    uint32_t *cell;
} function_cells;

static bat_status function_cells_make(const bat_hierarchical_space *space, function_cells *cells, bat_error *error)
{
    size_t functions = bat_hierarchical_space_functions(space), cell_count = bat_hierarchical_space_cells(space);
    const uint32_t *active;
    *cells = (function_cells){.first = calloc(functions + 2, sizeof *cells->first)};
    if (cells->first == NULL)
        return error_memory(error, (functions + 2) * sizeof *cells->first);
    for (size_t c = 0; c < cell_count; c++)
        for (size_t k = bat_hierarchical_space_active(space, c, &active); k-- > 0;)
            cells->first[active[k] + 2]++;
    for (size_t f = 0; f <= functions; f++)
        cells->first[f + 1] += cells->first[f];
    cells->cell = memory_array(cells->first[functions + 1], sizeof *cells->cell);
    if (cells->cell == NULL)
        return error_memory(error, cells->first[functions + 1] * sizeof *cells->cell);
    for (size_t c = 0; c < cell_count; c++)
        for (size_t k = bat_hierarchical_space_active(space, c, &active); k-- > 0;)
            cells->cell[cells->first[active[k] + 1]++] = (uint32_t)c;
    return BAT_OK;
}

static void function_cells_free(function_cells *cells)
{
    free(cells->first);
    free(cells->cell);
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

static bat_status add_up(fit_pattern *pattern, bat_error *error)
{
    size_t total = 0;
    for (size_t f = 0; f < pattern->functions; f++)
    {
        total += (size_t)pattern->first[f + 1];
        if (total > INT_MAX)
            return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the matrix of %zu functions has too many entries",
                             pattern->functions);
        pattern->first[f + 1] = (int)total;
    }
    pattern->row = memory_array(total, sizeof *pattern->row);
    return pattern->row == NULL ? error_memory(error, total * sizeof *pattern->row) : BAT_OK;
}

bat_status fit_pattern_make(const bat_hierarchical_space *space, int threads, fit_pattern *pattern, bat_error *error)
{
    size_t functions = bat_hierarchical_space_functions(space);
    *pattern = (fit_pattern){.functions = functions, .first = calloc(functions + 1, sizeof *pattern->first)};
    if (pattern->first == NULL)
        return error_memory(error, (functions + 1) * sizeof *pattern->first);
    function_cells cells;
    bat_status status = function_cells_make(space, &cells, error);
    if (status == BAT_OK && !find_all(space, &cells, threads, pattern, true))
        status = error_memory(error, functions * sizeof(uint32_t));
    if (status == BAT_OK)
        status = add_up(pattern, error);
    if (status == BAT_OK && !find_all(space, &cells, threads, pattern, false))
        status = error_memory(error, functions * sizeof(uint32_t));
    function_cells_free(&cells);
    return status;
}

void fit_pattern_free(fit_pattern *pattern)
{
    free(pattern->first);
    free(pattern->row);
    *pattern = (fit_pattern){0};
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
                for (size_t d = 0; d < work->columns; d++)
                    work->right[active[k] * work->columns + d] += right[k * work->columns + d];
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
