/// @file
/// Conversion of a hierarchical surface to tensor-product patches. Active cells of one level are grouped into rectangles.
/// Over a rectangle the surface is a B-spline surface of that level, whose control points are the local coefficients of its
/// cells.

#include "surface/spline/tensor_surface.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "surface/spline/hierarchical_space.h"

/// The run with the same columns in the next row, if there is one.
static size_t run_below(const run_set *cells, const grid_run *run)
{
    size_t i = run_set_lower_bound(cells, run->row + 1, run->begin);
    if (i == cells->count || cells->runs[i].row != run->row + 1 || cells->runs[i].begin != run->begin ||
        cells->runs[i].end != run->end)
        return cells->count;
    return i;
}

/// Append a set of cells as disjoint boxes to an array from malloc(). Runs with equal columns in consecutive rows form one
/// box.
static bat_status hierarchical_boxes(const run_set *cells, uint32_t level, bat_spline_box **boxes, size_t *count,
                                     size_t *capacity, bat_error *error)
{
    bool *taken = calloc(cells->count + 1, sizeof *taken), made = taken != NULL;
    for (size_t i = 0; i < cells->count && made; i++)
    {
        const grid_run *run = &cells->runs[i];
        if (taken[i])
            continue;
        bat_spline_box box = {level, {run->begin, run->row}, {run->end, run->row + 1}};
        for (size_t next = run_below(cells, run); next < cells->count; next = run_below(cells, &cells->runs[next]))
        {
            taken[next] = true;
            box.high[1]++;
        }
        made = ARRAY_ADD(*boxes, *capacity, *count, box);
    }
    free(taken);
    return made ? BAT_OK : error_memory(error, (*count + 1) * sizeof **boxes);
}

bat_status hierarchical_space_regions(const bat_hierarchical_space *space, bat_spline_box **boxes, size_t *count,
                                      bat_error *error)
{
    bat_spline_box *made = NULL;
    size_t made_count = 0, capacity = 0;
    // Allocate the array even if there is only one level.
    bat_status status = ARRAY_GROW(made, capacity, 1) ? BAT_OK : error_memory(error, sizeof *made);
    for (uint32_t l = 1; l < space->levels && status == BAT_OK; l++)
        status = hierarchical_boxes(&space->level[l].region, l, &made, &made_count, &capacity, error);
    if (status != BAT_OK)
    {
        free(made);
        return status;
    }
    *boxes = made;
    *count = made_count;
    return BAT_OK;
}

/// Allocate a patch with the knots of its level's B-splines that do not vanish on its box.
static bat_status make_piece(const bat_spline_surface *surface, const bat_spline_box *box, tensor_surface *piece,
                             bat_error *error)
{
    *piece = (tensor_surface){.dimension = surface->dimension};
    size_t size = surface->dimension;
    for (int d = 0; d < 2; d++)
    {
        size_t p = (size_t)surface->space->options.degree[d], functions = box->high[d] - box->low[d] + p;
        size_t spans = hierarchical_spans(surface->space, box->level, d), count = functions + p + 1;
        piece->knots[d] = (bat_knot_vector){memory_array(count, sizeof(double)), count, (int)p};
        for (size_t i = 0; i < count && piece->knots[d].knots != NULL; i++)
        {
            size_t k = box->low[d] + i;
            piece->knots[d].knots[i] = k <= p ? 0 : k >= p + spans ? 1 : (double)(k - p) / (double)spans;
        }
        size *= functions;
    }
    piece->control = memory_array(size, sizeof *piece->control);
    if (piece->control != NULL && piece->knots[0].knots != NULL && piece->knots[1].knots != NULL)
        return BAT_OK;
    tensor_surface_free(piece);
    return error_memory(error, size * sizeof *piece->control);
}

/// Copy the local coefficients of a cell to the patch whose box contains the cell.
static void place_cell(const bat_spline_surface *surface, const bat_spline_box *box, const hierarchical_cell *cell,
                       double *local, tensor_surface *piece)
{
    size_t columns = (size_t)piece->knots[0].degree + 1, rows = (size_t)piece->knots[1].degree + 1;
    size_t width = knot_vector_functions(&piece->knots[0]), size = surface->dimension;
    hierarchical_local_control(surface->space, cell, surface->control, size, local);
    for (size_t b = 0; b < rows; b++)
    {
        size_t place = (cell->row - box->low[1] + b) * width + (cell->column - box->low[0]);
        memcpy(piece->control + place * size, local + b * columns * size, columns * size * sizeof *local);
    }
}

static bat_status cut_piece(const bat_spline_surface *surface, const bat_spline_box *box, double *local,
                            tensor_surface *piece, bat_error *error)
{
    const bat_hierarchical_space *space = surface->space;
    bat_status status = make_piece(surface, box, piece, error);
    if (status != BAT_OK)
        return status;
    for (uint32_t row = box->low[1]; row < box->high[1]; row++)
    {
        size_t first = run_set_find(&space->level[box->level].cells, row, box->low[0]);
        for (size_t c = first; c < first + (box->high[0] - box->low[0]); c++)
            place_cell(surface, box, &space->cells[c], local, piece);
    }
    for (int d = 0; d < 2 && status == BAT_OK; d++)
    {
        double spans = (double)hierarchical_spans(space, box->level, d);
        status = tensor_surface_restrict(piece, d, box->low[d] / spans, box->high[d] / spans, error);
    }
    if (status != BAT_OK)
        tensor_surface_free(piece);
    return status;
}

static bat_status cut_pieces(const bat_spline_surface *surface, const bat_spline_box *boxes, size_t count,
                             tensor_surface **patches, bat_error *error)
{
    size_t size = hierarchical_locals(surface->space) * surface->dimension, cut = 0;
    tensor_surface *made = memory_array(count, sizeof *made);
    double *local = memory_array(size, sizeof *local);
    bat_status status = made != NULL && local != NULL ? BAT_OK : error_memory(error, count * sizeof *made);
    while (status == BAT_OK && cut < count)
    {
        status = cut_piece(surface, &boxes[cut], local, &made[cut], error);
        cut += status == BAT_OK;
    }
    free(local);
    if (status == BAT_OK)
    {
        *patches = made;
        return BAT_OK;
    }
    while (cut > 0)
        tensor_surface_free(&made[--cut]);
    free(made);
    return status;
}

bat_status spline_surface_patches(const bat_spline_surface *surface, tensor_surface **patches, size_t *count,
                                  bat_error *error)
{
    const bat_hierarchical_space *space = surface->space;
    bat_spline_box *boxes = NULL;
    size_t box_count = 0, capacity = 0;
    bat_status status = BAT_OK;
    for (uint32_t l = 0; l < space->levels && status == BAT_OK; l++)
        status = hierarchical_boxes(&space->level[l].cells, l, &boxes, &box_count, &capacity, error);
    if (status == BAT_OK)
        status = cut_pieces(surface, boxes, box_count, patches, error);
    if (status == BAT_OK)
        *count = box_count;
    free(boxes);
    return status;
}

// Tensor-product B-spline surfaces: restriction.
//     S(u, v) = sum_ij c_ij B_i(u) B_j(v)
// The blossom (polar form) of a spline segment is the symmetric multiaffine polynomial b(t_1, …, t_p) with b(t, …, t) =
// S(t). Its values at p consecutive knots are the control points, for any knot vector of the spline (Ramshaw, "Blossoming: a
// connect-the-dots approach to splines", 1987).

void tensor_surface_free(tensor_surface *surface)
{
    for (int d = 0; d < 2; d++)
        knot_vector_free(&surface->knots[d]);
    free(surface->control);
    *surface = (tensor_surface){0};
}

/// The blossom of a coordinate on a span, by de Boor's algorithm. Arguments are taken in decreasing order; arguments that
/// are knots of the span then copy control points.
/// @param control of the first function on the span; the next ones are `stride` numbers apart
static double blossom(const bat_knot_vector *knots, size_t span, const double *arguments, const double *control,
                      size_t stride)
{
    double points[BAT_SPLINE_MAX_DEGREE + 1];
    size_t degree = (size_t)knots->degree;
    for (size_t k = 0; k <= degree; k++)
        points[k] = control[k * stride];
    for (size_t k = 1; k <= degree; k++)
        for (size_t j = degree; j >= k; j--)
        {
            double low = knots->knots[span - degree + j], high = knots->knots[span + j + 1 - k];
            double share = (arguments[degree - k] - low) / (high - low);
            points[j] = (1 - share) * points[j - 1] + share * points[j];
        }
    return points[degree];
}

bat_status knot_vector_cut(const bat_knot_vector *knots, double low, double high, bat_knot_vector *cut, bat_error *error)
{
    size_t degree = (size_t)knots->degree, count = 0;
    double *made = memory_array(knots->count + 2 * degree + 2, sizeof *made);
    if (made == NULL)
        return error_memory(error, (knots->count + 2 * degree + 2) * sizeof *made);
    while (count <= degree)
        made[count++] = low;
    for (size_t i = 0; i < knots->count; i++)
        if (knots->knots[i] > low && knots->knots[i] < high)
            made[count++] = knots->knots[i];
    for (size_t i = 0; i <= degree; i++)
        made[count++] = high;
    *cut = (bat_knot_vector){.knots = made, .count = count, .degree = knots->degree};
    return BAT_OK;
}

void tensor_surface_convert(const tensor_surface *surface, int direction, const bat_knot_vector *to, double *control)
{
    const bat_knot_vector *old = &surface->knots[direction];
    size_t p = (size_t)old->degree, dimension = surface->dimension, rows = knot_vector_functions(to);
    size_t others = knot_vector_functions(&surface->knots[1 - direction]);
    // Control point i of the direction and k of the other one has the index i step + k across.
    size_t step = direction == 0 ? 1 : others, across = direction == 0 ? rows : 1;
    size_t old_across = direction == 0 ? knot_vector_functions(old) : 1;
    for (size_t i = 0; i < rows; i++)
    {
        size_t span = knot_vector_span(old, to->knots[i]);
        for (size_t k = 0; k < others * dimension; k++)
        {
            size_t other = k / dimension, d = k % dimension;
            const double *from = surface->control + ((span - p) * step + other * old_across) * dimension + d;
            control[(i * step + other * across) * dimension + d] =
                blossom(old, span, to->knots + i + 1, from, step * dimension);
        }
    }
}

bat_status tensor_surface_restrict(tensor_surface *surface, int direction, double low, double high, bat_error *error)
{
    bat_knot_vector *old = &surface->knots[direction];
    bat_knot_vector to;
    bat_status status = knot_vector_cut(old, low, high, &to, error);
    if (status != BAT_OK)
        return status;
    size_t rows = knot_vector_functions(&to) * knot_vector_functions(&surface->knots[1 - direction]);
    double *control = memory_array(rows, surface->dimension * sizeof *control);
    if (control == NULL)
    {
        knot_vector_free(&to);
        return error_memory(error, rows * surface->dimension * sizeof *control);
    }
    tensor_surface_convert(surface, direction, &to, control);
    free(surface->control);
    surface->control = control;
    knot_vector_free(old);
    *old = to;
    return BAT_OK;
}
