#include "linalg/multifrontal.h"

#include "base/error.h"

#include <amd.h>
#include <string.h>

static const int NONE = -1;

/// The elimination tree in the order of approximate minimum degree, and the fronts that its columns are merged to.
/// A front is named by its last column. All arrays have `count` numbers but where it is said.
typedef struct analysis
{
    size_t count;
    int *order;  ///< the unknown at each place
    int *place;  ///< of each unknown
    int *parent; ///< in the tree; NONE
    int *below;  ///< entries below the diagonal of each column of the factor
    int *front;  ///< of each column
    int *width;  ///< columns of each front
    int *number; ///< of each front in postorder
    int *head;   ///< first children
    int *next;   ///< siblings
    int *stack;
    size_t *zeros;         ///< entries of each front that are not in the factor's columns
    size_t *earlier_first; ///< count + 1
    int *earlier;          ///< neighbours at earlier places, of each place
    memory_pool pool;      ///< of all arrays
} analysis;

static bat_status analysis_make(const symmetric_pattern *pattern, analysis *work, bat_error *error)
{
    size_t count = pattern->count;
    *work = (analysis){.count = count};
    int **arrays[] = {&work->order, &work->place,  &work->parent, &work->below, &work->front,
                      &work->width, &work->number, &work->head,   &work->next,  &work->stack};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        *arrays[k] = memory_pool_array(&work->pool, count, sizeof(int));
    work->zeros = memory_pool_array(&work->pool, count, sizeof *work->zeros);
    work->earlier_first = memory_pool_array(&work->pool, count + 1, sizeof *work->earlier_first);
    work->earlier = memory_pool_array(&work->pool, (size_t)pattern->first[count], sizeof *work->earlier);
    return memory_pool_check(&work->pool, error);
}

static bat_status order_unknowns(const symmetric_pattern *pattern, analysis *work, bat_error *error)
{
    int result = amd_order((int)pattern->count, pattern->first, pattern->row, work->order, NULL, NULL);
    if (result == AMD_OUT_OF_MEMORY)
        return error_memory(error, (size_t)pattern->first[pattern->count] * 2 * sizeof(int));
    if (result != AMD_OK && result != AMD_OK_BUT_JUMBLED)
        return ERROR_ARGUMENT(error, "the pattern of a sparse matrix is not valid");
    for (size_t k = 0; k < work->count; k++)
        work->place[work->order[k]] = (int)k;
    return BAT_OK;
}

/// The neighbours of each place at earlier places.
static void list_earlier(const symmetric_pattern *pattern, analysis *work)
{
    size_t count = work->count, *first = work->earlier_first;
    memset(first, 0, (count + 1) * sizeof *first);
    for (int pass = 0; pass < 2; pass++)
    {
        for (size_t j = 0; j < count; j++)
            for (int k = pattern->first[j] + 1; k < pattern->first[j + 1]; k++)
            {
                int a = work->place[j], b = work->place[pattern->row[k]], later = a > b ? a : b;
                if (pass == 0)
                    first[later]++;
                else
                    work->earlier[--first[later]] = a + b - later;
            }
        for (size_t j = 0; j < count && pass == 0; j++)
            first[j + 1] += first[j];
    }
}

/// The elimination tree and the counts of entries, by walking up from each entry of a row to the row itself (Liu, 1990).
static void find_tree(analysis *work)
{
    int *seen = work->stack;
    for (int i = 0; i < (int)work->count; i++)
    {
        work->parent[i] = NONE;
        work->below[i] = 0;
        seen[i] = i;
        for (size_t k = work->earlier_first[i]; k < work->earlier_first[i + 1]; k++)
            for (int j = work->earlier[k]; seen[j] != i; j = work->parent[j])
            {
                if (work->parent[j] == NONE)
                    work->parent[j] = i;
                work->below[j]++;
                seen[j] = i;
            }
    }
}

/// Merge a front into its parent's front.
static void merge(analysis *work, int child, int parent)
{
    size_t rows = (size_t)work->width[parent] + (size_t)work->below[parent];
    work->zeros[parent] += work->zeros[child] + (size_t)work->width[child] * (rows - (size_t)work->below[child]);
    work->width[parent] += work->width[child];
    work->front[child] = parent;
}

/// Merge each column with one before it that has the same rows.
static void merge_columns(analysis *work)
{
    for (int i = 0; i < (int)work->count; i++)
    {
        work->front[i] = i;
        work->width[i] = 1;
        work->zeros[i] = 0;
    }
    for (int i = 0; i < (int)work->count; i++)
    {
        int parent = work->parent[i];
        if (parent != NONE && work->below[i] == work->below[parent] + 1 && work->width[parent] == 1)
            merge(work, i, parent);
    }
}

/// The front that each column has come to.
static void resolve_fronts(analysis *work)
{
    for (size_t i = work->count; i-- > 0;)
        work->front[i] = work->front[work->front[i]];
}

/// The fronts' children, those of the least number first.
static void list_children(analysis *work)
{
    for (size_t i = 0; i < work->count; i++)
        work->head[i] = NONE;
    for (size_t i = work->count; i-- > 0;)
        if (work->front[i] == (int)i && work->parent[i] != NONE)
        {
            int parent = work->front[work->parent[i]];
            work->next[i] = work->head[parent];
            work->head[parent] = (int)i;
        }
}

/// Whether it is worth the zeros to merge a front into its parent's: large dense matrices are worked on faster than small
/// ones. The bounds are those of Chen, Davis, Hager and Rajamanickam, "Algorithm 887: CHOLMOD" (2008).
static bool worth_merging(const analysis *work, int child, int parent)
{
    enum
    {
        NARROW = 4,
        MEDIUM = 16,
        WIDE = 48
    };
    size_t width = (size_t)work->width[child] + (size_t)work->width[parent], below = (size_t)work->below[parent];
    size_t rows = (size_t)work->width[parent] + below;
    double zeros = (double)(work->zeros[child] + work->zeros[parent] +
                            (size_t)work->width[child] * (rows - (size_t)work->below[child]));
    double share = zeros / ((double)width * (0.5 * (double)(width + 1) + (double)below));
    return width <= NARROW || (width <= MEDIUM && share < 0.8) || (width <= WIDE && share < 0.1) || share < 0.05;
}

/// Number the fronts in postorder.
/// @return how many there are
static size_t number_fronts(analysis *work)
{
    int fronts = 0, *stack = work->stack;
    for (size_t root = 0; root < work->count; root++)
    {
        if (work->parent[root] != NONE)
            continue;
        size_t depth = 0;
        stack[depth++] = (int)root;
        while (depth > 0)
        {
            int top = stack[depth - 1], child = work->head[top];
            if (child != NONE)
            {
                work->head[top] = work->next[child];
                stack[depth++] = child;
            }
            else
            {
                work->number[top] = fronts++;
                depth--;
            }
        }
    }
    return (size_t)fronts;
}

void front_tree_free(front_tree *tree)
{
    memory_pool_free(&tree->pool);
    *tree = (front_tree){0};
}

static bat_status allocate_tree(size_t count, size_t fronts, size_t entries, front_tree *tree, bat_error *error)
{
    *tree = (front_tree){.count = count, .fronts = fronts};
    memory_pool *pool = &tree->pool;
    tree->order = memory_pool_array(pool, count, sizeof(int));
    tree->diagonal = memory_pool_array(pool, count, sizeof(int));
    tree->entry_first = memory_pool_zeros(pool, count + 1, sizeof(size_t));
    tree->entries = memory_pool_array(pool, entries, sizeof(front_entry));
    tree->pivot_first = memory_pool_zeros(pool, fronts + 1, sizeof(int));
    tree->children = memory_pool_zeros(pool, fronts + 1, sizeof(int));
    tree->row_first = memory_pool_zeros(pool, fronts + 1, sizeof(size_t));
    tree->panel_first = memory_pool_zeros(pool, fronts + 1, sizeof(size_t));
    return memory_pool_check(pool, error);
}

/// Widths, numbers of rows and children of the fronts, and what they need.
static bat_status measure_fronts(const analysis *work, front_tree *tree, bat_error *error)
{
    for (size_t i = 0; i < work->count; i++)
        if (work->front[i] == (int)i)
        {
            size_t f = (size_t)work->number[i], rows = (size_t)work->below[i], width = (size_t)work->width[i];
            tree->pivot_first[f + 1] = work->width[i];
            tree->row_first[f + 1] = rows;
            tree->panel_first[f + 1] = (width + rows) * width;
            tree->panel_max = width + rows > tree->panel_max ? width + rows : tree->panel_max;
            if (work->parent[i] != NONE)
                tree->children[work->number[work->front[work->parent[i]]]]++;
        }
    for (size_t f = 0; f < tree->fronts; f++)
    {
        tree->pivot_first[f + 1] += tree->pivot_first[f];
        tree->row_first[f + 1] += tree->row_first[f];
        tree->panel_first[f + 1] += tree->panel_first[f];
    }
    tree->rows = memory_pool_array(&tree->pool, tree->row_first[tree->fronts], sizeof(int));
    return memory_pool_check(&tree->pool, error);
}

/// The order of elimination: front by front, the columns of a front as they were.
static void order_fronts(const symmetric_pattern *pattern, analysis *work, front_tree *tree)
{
    int *cursor = work->stack;
    memcpy(cursor, tree->pivot_first, tree->fronts * sizeof *cursor);
    for (size_t i = 0; i < work->count; i++)
        tree->order[cursor[work->number[work->front[i]]]++] = work->order[i];
    for (size_t k = 0; k < work->count; k++)
    {
        work->place[tree->order[k]] = (int)k;
        tree->diagonal[k] = pattern->first[tree->order[k]];
    }
}

/// The entries of the matrix in the column of the earlier unknown.
static void list_entries(const symmetric_pattern *pattern, const int *place, front_tree *tree)
{
    size_t *first = tree->entry_first;
    for (int pass = 0; pass < 2; pass++)
    {
        for (size_t j = pattern->count; j-- > 0;)
            for (int k = pattern->first[j + 1]; k-- > pattern->first[j];)
            {
                int column = place[j], row = place[pattern->row[k]];
                bool swapped = row < column;
                size_t owner = (size_t)(swapped ? row : column);
                if (pass == 0)
                    first[owner]++;
                else
                    tree->entries[--first[owner]] = (front_entry){swapped ? column : row, swapped ? ~k : k};
            }
        for (size_t j = 0; j < pattern->count && pass == 0; j++)
            first[j + 1] += first[j];
    }
}

/// The rows of one front: those of its entries and its children's, without its pivots.
/// @param children the fronts before this place are its children
static void list_rows(size_t f, const int *children, int *seen, front_tree *tree)
{
    int end = tree->pivot_first[f + 1], *rows = tree->rows + tree->row_first[f];
    size_t count = 0;
    for (int pivot = tree->pivot_first[f]; pivot < end; pivot++)
        for (size_t e = tree->entry_first[pivot]; e < tree->entry_first[pivot + 1]; e++)
        {
            int row = tree->entries[e].row;
            if (row >= end && seen[row] != (int)f)
            {
                seen[row] = (int)f;
                rows[count++] = row;
            }
        }
    for (int c = 1; c <= tree->children[f]; c++)
        for (size_t k = tree->row_first[children[-c]]; k < tree->row_first[children[-c] + 1]; k++)
        {
            int row = tree->rows[k];
            if (row >= end && seen[row] != (int)f)
            {
                seen[row] = (int)f;
                rows[count++] = row;
            }
        }
    qsort(rows, count, sizeof *rows, ascending_int);
}

/// The rows of all fronts, and the room that those take whose parents are to come.
static void list_all_rows(analysis *work, front_tree *tree)
{
    int *stack = work->stack, *seen = work->number;
    size_t depth = 0, room = 0;
    for (size_t i = 0; i < work->count; i++)
        seen[i] = NONE;
    for (size_t f = 0; f < tree->fronts; f++)
    {
        list_rows(f, stack + depth, seen, tree);
        size_t rows = tree->row_first[f + 1] - tree->row_first[f], own = rows * rows;
        tree->update_max = room + own > tree->update_max ? room + own : tree->update_max;
        for (int c = 0; c < tree->children[f]; c++)
        {
            size_t child = (size_t)stack[--depth], below = tree->row_first[child + 1] - tree->row_first[child];
            room -= below * below;
        }
        if (own > 0)
        {
            stack[depth++] = (int)f;
            room += own;
        }
    }
}

bat_status front_tree_make(const symmetric_pattern *pattern, front_tree *tree, bat_error *error)
{
    *tree = (front_tree){0};
    analysis work;
    bat_status status = analysis_make(pattern, &work, error);
    if (status == BAT_OK)
        status = order_unknowns(pattern, &work, error);
    if (status == BAT_OK)
    {
        list_earlier(pattern, &work);
        find_tree(&work);
        merge_columns(&work);
        resolve_fronts(&work);
        list_children(&work);
        for (int i = 0; i < (int)work.count; i++)
            for (int child = work.front[i] == i ? work.head[i] : NONE; child != NONE; child = work.next[child])
                if (worth_merging(&work, child, i))
                    merge(&work, child, i);
        resolve_fronts(&work);
        list_children(&work);
        status = allocate_tree(pattern->count, number_fronts(&work), (size_t)pattern->first[pattern->count], tree, error);
    }
    if (status == BAT_OK)
        status = measure_fronts(&work, tree, error);
    if (status == BAT_OK)
    {
        order_fronts(pattern, &work, tree);
        list_entries(pattern, work.place, tree);
        list_all_rows(&work, tree);
    }
    if (status != BAT_OK)
        front_tree_free(tree);
    memory_pool_free(&work.pool);
    return status;
}
