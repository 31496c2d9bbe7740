#include "research/learn/operations.h"

#include <assert.h>

// Rows gathered, averaged and concatenated, by a list of indices; without one, index k is k itself.

typedef struct rows
{
    learn_array *x, *y;
    const uint32_t *offsets, *indices;
    uint32_t *sizes;     ///< of the groups of a scatter
    size_t first;        ///< of a slice
    learn_array **parts; ///< of a concatenation
    size_t part_count;
} rows;

static inline void add_row(size_t columns, real factor, const real *restrict from, real *restrict to)
{
    for (size_t c = 0; c < columns; c++)
        to[c] += factor * from[c];
}

static learn_array *arrange(learn_tape *tape, rows r, void (*forward)(const rows *), learn_backward *backward)
{
    if (tape->status != BAT_OK)
        return &tape->nothing;
    forward(&r);
    rows *context = learn_wants(r.y) ? learn_tape_memory(tape, 1, sizeof *context) : NULL;
    if (context != NULL)
    {
        *context = r;
        learn_tape_record(tape, r.y, backward, context);
    }
    return r.y;
}

// Gather: y_k = x_indices[k]
//   x rows x columns, y count x columns

static void gather_forward(const rows *r)
{
    size_t columns = r->x->columns;
    for (size_t k = 0; k < r->y->rows; k++)
    {
        assert(r->indices[k] < r->x->rows);
        memcpy(r->y->value + k * columns, r->x->value + r->indices[k] * columns, columns * sizeof(real));
    }
}

LANES_CLONES
static void gather_backward(void *context)
{
    const rows *r = context;
    size_t columns = r->x->columns;
    real *dx = learn_gradient(r->x);
    for (size_t k = 0; k < r->y->rows; k++)
        add_row(columns, 1, r->y->gradient + k * columns, dx + r->indices[k] * columns);
}

learn_array *learn_gather_rows(learn_tape *tape, learn_array *x, const uint32_t *indices, size_t count)
{
    learn_array *y = learn_array_make(tape, count, x->columns, learn_wants(x));
    return arrange(tape, (rows){.x = x, .y = y, .indices = indices}, gather_forward, gather_backward);
}

// Segment mean: y_s = the mean of x_indices[k] over offsets[s] <= k < offsets[s + 1]
//   x rows x columns, y count x columns

LANES_CLONES
static void segment_mean_forward(const rows *r)
{
    size_t columns = r->x->columns;
    memset(r->y->value, 0, learn_size(r->y) * sizeof(real));
    for (size_t s = 0; s < r->y->rows; s++)
    {
        uint32_t begin = r->offsets[s], end = r->offsets[s + 1];
        real *y = r->y->value + s * columns;
        for (uint32_t k = begin; k < end; k++)
        {
            size_t row = r->indices != NULL ? r->indices[k] : k;
            assert(row < r->x->rows);
            add_row(columns, 1, r->x->value + row * columns, y);
        }
        for (size_t c = 0; end > begin && c < columns; c++)
            y[c] /= (real)(end - begin);
    }
}

LANES_CLONES
static void segment_mean_backward(void *context)
{
    const rows *r = context;
    size_t columns = r->x->columns;
    real *dx = learn_gradient(r->x);
    for (size_t s = 0; s < r->y->rows; s++)
    {
        uint32_t begin = r->offsets[s], end = r->offsets[s + 1];
        for (uint32_t k = begin; k < end; k++)
        {
            size_t row = r->indices != NULL ? r->indices[k] : k;
            add_row(columns, 1 / (real)(end - begin), r->y->gradient + s * columns, dx + row * columns);
        }
    }
}

learn_array *learn_segment_mean(learn_tape *tape, learn_array *x, const uint32_t *offsets, const uint32_t *indices,
                                size_t count)
{
    learn_array *y = learn_array_make(tape, count, x->columns, learn_wants(x));
    return arrange(tape, (rows){.x = x, .y = y, .offsets = offsets, .indices = indices}, segment_mean_forward,
                   segment_mean_backward);
}

// Scatter mean: y_t = the mean of x_k over all k with targets[k] = t
//   x rows x columns, y count x columns

LANES_CLONES
static void scatter_mean_forward(const rows *r)
{
    size_t columns = r->x->columns;
    memset(r->y->value, 0, learn_size(r->y) * sizeof(real));
    memset(r->sizes, 0, r->y->rows * sizeof *r->sizes);
    for (size_t k = 0; k < r->x->rows; k++)
    {
        assert(r->indices[k] < r->y->rows);
        r->sizes[r->indices[k]]++;
        add_row(columns, 1, r->x->value + k * columns, r->y->value + r->indices[k] * columns);
    }
    for (size_t t = 0; t < r->y->rows; t++)
        for (size_t c = 0; r->sizes[t] > 0 && c < columns; c++)
            r->y->value[t * columns + c] /= (real)r->sizes[t];
}

LANES_CLONES
static void scatter_mean_backward(void *context)
{
    const rows *r = context;
    size_t columns = r->x->columns;
    real *dx = learn_gradient(r->x);
    for (size_t k = 0; k < r->x->rows; k++)
    {
        size_t t = r->indices[k];
        add_row(columns, 1 / (real)r->sizes[t], r->y->gradient + t * columns, dx + k * columns);
    }
}

learn_array *learn_scatter_mean(learn_tape *tape, learn_array *x, const uint32_t *targets, size_t count)
{
    learn_array *y = learn_array_make(tape, count, x->columns, learn_wants(x));
    uint32_t *sizes = learn_tape_memory(tape, count, sizeof *sizes);
    return arrange(tape, (rows){.x = x, .y = y, .indices = targets, .sizes = sizes}, scatter_mean_forward,
                   scatter_mean_backward);
}

// Slices: y = the rows first … first + count - 1 of x, or those columns

static void slice_rows_forward(const rows *r)
{
    memcpy(r->y->value, r->x->value + r->first * r->x->columns, learn_size(r->y) * sizeof(real));
}

static void slice_rows_backward(void *context)
{
    const rows *r = context;
    add_row(learn_size(r->y), 1, r->y->gradient, learn_gradient(r->x) + r->first * r->x->columns);
}

learn_array *learn_slice_rows(learn_tape *tape, learn_array *x, size_t first, size_t count)
{
    assert(tape->status != BAT_OK || (first <= x->rows && count <= x->rows - first));
    learn_array *y = learn_array_make(tape, count, x->columns, learn_wants(x));
    return arrange(tape, (rows){.x = x, .y = y, .first = first}, slice_rows_forward, slice_rows_backward);
}

static void slice_columns_forward(const rows *r)
{
    size_t from = r->x->columns, to = r->y->columns;
    for (size_t k = 0; k < r->y->rows; k++)
        memcpy(r->y->value + k * to, r->x->value + k * from + r->first, to * sizeof(real));
}

static void slice_columns_backward(void *context)
{
    const rows *r = context;
    size_t from = r->x->columns, to = r->y->columns;
    real *dx = learn_gradient(r->x);
    for (size_t k = 0; k < r->y->rows; k++)
        add_row(to, 1, r->y->gradient + k * to, dx + k * from + r->first);
}

learn_array *learn_slice_columns(learn_tape *tape, learn_array *x, size_t first, size_t count)
{
    assert(tape->status != BAT_OK || (first <= x->columns && count <= x->columns - first));
    learn_array *y = learn_array_make(tape, x->rows, count, learn_wants(x));
    return arrange(tape, (rows){.x = x, .y = y, .first = first}, slice_columns_forward, slice_columns_backward);
}

// Concatenations: the parts one below the other, or side by side

static void concatenate_rows_forward(const rows *r)
{
    real *y = r->y->value;
    for (size_t p = 0; p < r->part_count; p++)
    {
        memcpy(y, r->parts[p]->value, learn_size(r->parts[p]) * sizeof *y);
        y += learn_size(r->parts[p]);
    }
}

static void concatenate_rows_backward(void *context)
{
    const rows *r = context;
    const real *dy = r->y->gradient;
    for (size_t p = 0; p < r->part_count; p++)
    {
        if (learn_wants(r->parts[p]))
            add_row(learn_size(r->parts[p]), 1, dy, learn_gradient(r->parts[p]));
        dy += learn_size(r->parts[p]);
    }
}

static void concatenate_columns_forward(const rows *r)
{
    size_t columns = r->y->columns, at = 0;
    for (size_t p = 0; p < r->part_count; p++)
    {
        size_t width = r->parts[p]->columns;
        for (size_t k = 0; k < r->y->rows; k++)
            memcpy(r->y->value + k * columns + at, r->parts[p]->value + k * width, width * sizeof(real));
        at += width;
    }
}

static void concatenate_columns_backward(void *context)
{
    const rows *r = context;
    size_t columns = r->y->columns, at = 0;
    for (size_t p = 0; p < r->part_count; p++)
    {
        size_t width = r->parts[p]->columns;
        real *dpart = learn_wants(r->parts[p]) ? learn_gradient(r->parts[p]) : NULL;
        for (size_t k = 0; dpart != NULL && k < r->y->rows; k++)
            add_row(width, 1, r->y->gradient + k * columns + at, dpart + k * width);
        at += width;
    }
}

/// A copy of the list on the tape, and whether any of them has a derivative.
static learn_array **copy_parts(learn_tape *tape, learn_array *const *arrays, size_t count, bool *wants)
{
    learn_array **parts = learn_tape_memory(tape, count, sizeof *parts);
    *wants = false;
    for (size_t p = 0; parts != NULL && p < count; p++)
    {
        parts[p] = arrays[p];
        *wants = *wants || learn_wants(arrays[p]);
    }
    return parts;
}

learn_array *learn_concatenate_rows(learn_tape *tape, learn_array *const *arrays, size_t count)
{
    bool wants;
    learn_array **parts = copy_parts(tape, arrays, count, &wants);
    if (parts == NULL)
        return &tape->nothing;
    size_t total = 0;
    for (size_t p = 0; p < count; p++)
    {
        assert(arrays[p]->columns == arrays[0]->columns);
        total += arrays[p]->rows;
    }
    learn_array *y = learn_array_make(tape, total, arrays[0]->columns, wants);
    return arrange(tape, (rows){.y = y, .parts = parts, .part_count = count}, concatenate_rows_forward,
                   concatenate_rows_backward);
}

learn_array *learn_concatenate_columns(learn_tape *tape, learn_array *const *arrays, size_t count)
{
    bool wants;
    learn_array **parts = copy_parts(tape, arrays, count, &wants);
    if (parts == NULL)
        return &tape->nothing;
    size_t total = 0;
    for (size_t p = 0; p < count; p++)
    {
        assert(arrays[p]->rows == arrays[0]->rows);
        total += arrays[p]->columns;
    }
    learn_array *y = learn_array_make(tape, arrays[0]->rows, total, wants);
    return arrange(tape, (rows){.y = y, .parts = parts, .part_count = count}, concatenate_columns_forward,
                   concatenate_columns_backward);
}
