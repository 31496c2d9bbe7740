/// @file
/// Set operations on sorted runs of grid cells; see hierarchical_space.h. Union, difference and support take linear time.

#include "surface/spline/hierarchical_space.h"

#include "base/array_grow.h"
#include "base/bisect.h"

void run_set_free(run_set *set)
{
    free(set->runs);
    *set = (run_set){0};
}

bool run_set_append(run_set *set, uint32_t row, uint32_t begin, uint32_t end)
{
    grid_run *last = set->count > 0 ? &set->runs[set->count - 1] : NULL;
    if (last != NULL && last->row == row && last->begin <= begin && last->end >= begin)
    {
        last->end = end > last->end ? end : last->end;
        return true;
    }
    if (!array_grow((void **)&set->runs, &set->capacity, set->count + 1, sizeof *set->runs) || set->runs == NULL)
        return false;
    set->runs[set->count++] = (grid_run){.row = row, .begin = begin, .end = end};
    return true;
}

static bool precedes(const grid_run *a, const grid_run *b)
{
    return a->row != b->row ? a->row < b->row : a->begin < b->begin;
}

static int compare_runs(const void *a, const void *b)
{
    return (int)precedes(b, a) - (int)precedes(a, b);
}

void run_set_sort(run_set *set)
{
    if (set->count == 0)
        return;
    qsort(set->runs, set->count, sizeof *set->runs, compare_runs);
    grid_run *last = set->runs;
    for (const grid_run *run = set->runs + 1; run < set->runs + set->count; run++)
        if (run->row == last->row && run->begin <= last->end)
            last->end = run->end > last->end ? run->end : last->end;
        else
            *++last = *run;
    set->count = (size_t)(last - set->runs) + 1;
}

uint64_t run_set_size(const run_set *set)
{
    uint64_t size = 0;
    for (size_t i = 0; i < set->count; i++)
        size += set->runs[i].end - set->runs[i].begin;
    return size;
}

void run_set_number(run_set *set, uint32_t first)
{
    for (size_t i = 0; i < set->count; i++)
    {
        set->runs[i].number = first;
        first += set->runs[i].end - set->runs[i].begin;
    }
}

/// Whether a run ends at or before (row, column).
static bool ends_before(const grid_run *run, uint32_t row, uint32_t column)
{
    return run->row < row || (run->row == row && run->end <= column);
}

size_t run_set_lower_bound(const run_set *set, uint32_t row, uint32_t column)
{
    size_t low = 0, high = set->count;
    BISECT(low, high, middle, ends_before(&set->runs[middle], row, column))
    return low;
}

size_t run_set_lower_bound_from(const run_set *set, uint32_t row, uint32_t column, size_t *hint)
{
    size_t i = *hint;
    if (i < set->count && ends_before(&set->runs[i], row, column))
        i++;
    bool after = i == 0 || ends_before(&set->runs[i - 1], row, column);
    bool before = i == set->count || !ends_before(&set->runs[i], row, column);
    return *hint = after && before ? i : run_set_lower_bound(set, row, column);
}

uint32_t run_set_find(const run_set *set, uint32_t row, uint32_t column)
{
    size_t i = run_set_lower_bound(set, row, column);
    if (i == set->count || set->runs[i].row != row || set->runs[i].begin > column)
        return UINT32_MAX;
    return set->runs[i].number + (column - set->runs[i].begin);
}

bool run_set_unite(const run_set *a, const run_set *b, run_set *both)
{
    size_t i = 0, j = 0;
    bool made = true;
    while (made && (i < a->count || j < b->count))
    {
        bool first = j == b->count || (i < a->count && precedes(&a->runs[i], &b->runs[j]));
        const grid_run *run = first ? &a->runs[i++] : &b->runs[j++];
        made = run_set_append(both, run->row, run->begin, run->end);
    }
    return made;
}

bool run_set_subtract(const run_set *from, const run_set *what, run_set *rest)
{
    size_t j = 0;
    for (size_t i = 0; i < from->count; i++)
    {
        const grid_run *run = &from->runs[i];
        uint32_t begin = run->begin;
        while (j < what->count &&
               (what->runs[j].row < run->row || (what->runs[j].row == run->row && what->runs[j].end <= begin)))
            j++;
        for (; j < what->count && what->runs[j].row == run->row && what->runs[j].begin < run->end; j++)
        {
            if (what->runs[j].begin > begin && !run_set_append(rest, run->row, begin, what->runs[j].begin))
                return false;
            begin = what->runs[j].end;
            if (begin >= run->end)
                break;
        }
        if (begin < run->end && !run_set_append(rest, run->row, begin, run->end))
            return false;
    }
    return true;
}

bool run_set_halve(const run_set *set, run_set *coarse)
{
    bool made = true;
    for (size_t i = 0; i < set->count && made; i++)
        if (set->runs[i].row % 2 == 0)
            made = run_set_append(coarse, set->runs[i].row / 2, set->runs[i].begin / 2, set->runs[i].end / 2);
    return made;
}

/// For each row, the univariate functions whose support lies in a run.
static bool support_columns(const run_set *cells, uint32_t width, uint32_t degree, run_set *columns)
{
    bool made = true;
    for (size_t i = 0; i < cells->count && made; i++)
    {
        const grid_run *run = &cells->runs[i];
        uint32_t begin = run->begin == 0 ? 0 : run->begin + degree, end = run->end == width ? width + degree : run->end;
        if (begin < end)
            made = run_set_append(columns, run->row, begin, end);
    }
    return made;
}

/// Offsets of the rows of a set, followed by the number of runs. Null when out of memory.
static size_t *row_beginnings(const run_set *set, size_t *rows)
{
    size_t *begin = memory_array(set->count + 1, sizeof *begin);
    *rows = 0;
    for (size_t i = 0; i < set->count && begin != NULL; i++)
        if (i == 0 || set->runs[i].row != set->runs[i - 1].row)
            begin[(*rows)++] = i;
    if (begin != NULL)
        begin[*rows] = set->count;
    return begin;
}

/// Append the intersection of `count` rows of a set to a row.
static bool append_common(const run_set *set, const size_t *begin, size_t count, uint32_t row, run_set *common)
{
    size_t at[BAT_SPLINE_MAX_DEGREE + 1];
    for (size_t k = 0; k < count; k++)
        at[k] = begin[k];
    for (;;)
    {
        uint32_t from = 0, to = UINT32_MAX;
        size_t first_to_end = 0;
        for (size_t k = 0; k < count; k++)
        {
            const grid_run *run = &set->runs[at[k]];
            from = run->begin > from ? run->begin : from;
            first_to_end = run->end < to ? k : first_to_end;
            to = run->end < to ? run->end : to;
        }
        if (from < to && !run_set_append(common, row, from, to))
            return false;
        if (++at[first_to_end] == begin[first_to_end + 1])
            return true;
    }
}

bool run_set_supports(const run_set *cells, const uint32_t size[2], const int degree[2], run_set *functions)
{
    uint32_t q = (uint32_t)degree[1];
    run_set columns = {0};
    size_t rows = 0, *begin = NULL;
    bool made =
        support_columns(cells, size[0], (uint32_t)degree[0], &columns) && (begin = row_beginnings(&columns, &rows)) != NULL;
    for (size_t r = 0; r < rows && made && columns.runs != NULL; r++)
    {
        uint32_t top = columns.runs[begin[r]].row, last = top == size[1] - 1 ? top + q : top;
        for (uint32_t j = top; j <= last && made; j++)
        {
            uint32_t bottom = j < q ? 0 : j - q;
            size_t needed = (size_t)(top - bottom) + 1;
            if (bottom <= top && r + 1 >= needed && columns.runs[begin[r + 1 - needed]].row == bottom)
                made = append_common(&columns, begin + (r + 1 - needed), needed, j, functions);
        }
    }
    free(begin);
    run_set_free(&columns);
    return made;
}
