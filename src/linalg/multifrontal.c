#include "linalg/multifrontal.h"

#include "base/error.h"
#include "base/lanes.h"
#include "linalg/blas.h"
#include "linalg/blas_single.h"

enum
{
    SIDES = 2,  ///< L and U^T
    BLOCK = 32, ///< pivots that are eliminated from each other before they are eliminated from the other rows
    SHORT = 8,  ///< below so many pivots, a loop takes less time than a call of BLAS
    STRIP = 64  ///< columns of a triangle that are computed as a rectangle
};

struct multifrontal
{
    front_tree tree;
    size_t sides;          ///< 1 for symmetric matrices, where U^T = L
    double *panels[SIDES]; ///< of each front its columns of L, and of U^T: rows x pivots, by columns, the pivots' rows first
    double *updates;       ///< within a factorization: a stack of updates, those of fronts whose parents are to come
    int *waiting;          ///< [fronts] a stack of these fronts
    int *position;         ///< [count] positions of rows in the front at work, by place
    int *relative;         ///< [panel_max] positions of a child's rows in the front at work
    memory_pool pool;      ///< of all arrays but `updates`
};

static bat_status allocate_factors(multifrontal *solver, bat_error *error)
{
    const front_tree *tree = &solver->tree;
    size_t entries = tree->panel_first[tree->fronts];
    memory_pool *pool = &solver->pool;
    for (size_t side = 0; side < solver->sides; side++)
        solver->panels[side] = memory_pool_array(pool, entries, sizeof(double));
    solver->waiting = memory_pool_array(pool, tree->fronts, sizeof(int));
    solver->position = memory_pool_array(pool, tree->count, sizeof(int));
    solver->relative = memory_pool_array(pool, tree->panel_max, sizeof(int));
    return memory_pool_check(pool, error);
}

bat_status multifrontal_make(const symmetric_pattern *pattern, bool symmetric, multifrontal **solver, bat_error *error)
{
    multifrontal *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    made->sides = symmetric ? 1 : SIDES;
    bat_status status = front_tree_make(pattern, &made->tree, error);
    if (status == BAT_OK)
        status = allocate_factors(made, error);
    if (status == BAT_OK)
        *solver = made;
    else
        multifrontal_free(made);
    return status;
}

void multifrontal_free(multifrontal *solver)
{
    if (solver == NULL)
        return;
    front_tree_free(&solver->tree);
    memory_pool_free(&solver->pool);
    free(solver);
}

/// The matrix of a front, [F11 F12; F21 F22], where F11 holds the pivots.
typedef struct front
{
    size_t number;          ///< in the tree
    size_t rows, pivots;    ///< the pivots are among the rows
    size_t below;           ///< rows that are not pivots
    size_t sides;           ///< 1 for symmetric matrices, where both panels are the same
    double *panels[SIDES];  ///< [F11; F21] and [F11 F12]^T by columns; of F11 the triangle below the diagonal
    double *updates[SIDES]; ///< F22 and F22^T by columns, the triangles below the diagonal
} front;

/// target_ij -= sum_k left_ik right_jk for i >= j.
/// @param stride from each column of left and right to the next
LANES_CLONES
static void subtract_narrow_products(size_t rows, size_t columns, size_t inner, const double *restrict left,
                                     const double *restrict right, size_t stride, double *restrict target,
                                     size_t target_stride)
{
    for (size_t j = 0; j < columns; j++)
    {
        double *restrict own = target + j * target_stride;
        size_t k = 0;
        for (; k + 4 <= inner; k += 4)
        {
            const double *l = left + k * stride, *r = right + k * stride + j;
            double a = r[0], b = r[stride], c = r[2 * stride], d = r[3 * stride];
            for (size_t i = j; i < rows; i++)
                own[i] -= (l[i] * a + l[stride + i] * b) + (l[2 * stride + i] * c + l[3 * stride + i] * d);
        }
        for (; k < inner; k++)
        {
            const double *l = left + k * stride;
            double a = right[k * stride + j];
            for (size_t i = j; i < rows; i++)
                own[i] -= l[i] * a;
        }
    }
}

/// The same; entries above the diagonal may change too.
static void subtract_products(size_t rows, size_t columns, size_t inner, const double *left, const double *right,
                              size_t stride, double *target, size_t target_stride)
{
    if (inner < SHORT)
    {
        subtract_narrow_products(rows, columns, inner, left, right, stride, target, target_stride);
        return;
    }
    for (size_t begin = 0; begin < columns; begin += STRIP)
    {
        size_t width = columns - begin < STRIP ? columns - begin : STRIP;
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, (int)(rows - begin), (int)width, (int)inner, -1, left + begin,
                    (int)stride, right + begin, (int)stride, 1, target + begin * target_stride + begin, (int)target_stride);
    }
}

/// x = x T^-T for a lower triangle T, both by columns.
/// @param stride from each column to the next
LANES_CLONES
static void divide_by_narrow_triangle(size_t rows, size_t columns, const double *restrict triangle, double *restrict x,
                                      size_t stride)
{
    for (size_t k = 0; k < columns; k++)
    {
        double factor = 1 / triangle[k * stride + k];
        double *own = x + k * stride;
        for (size_t i = 0; i < rows; i++)
            own[i] *= factor;
        for (size_t j = k + 1; j < columns; j++)
        {
            double a = triangle[k * stride + j];
            double *restrict other = x + j * stride;
            for (size_t i = 0; i < rows; i++)
                other[i] -= own[i] * a;
        }
    }
}

static void divide_by_triangle(size_t rows, size_t columns, const double *triangle, double *x, size_t stride)
{
    if (columns < SHORT)
        divide_by_narrow_triangle(rows, columns, triangle, x, stride);
    else
        cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, (int)rows, (int)columns, 1, triangle,
                    (int)stride, x, (int)stride);
}

/// Eliminate the pivots from `begin` to `end` from each other.
/// @return whether all of them are above 0 and finite
static bool eliminate_block(const front *at, size_t begin, size_t end)
{
    size_t rows = at->rows;
    double *lower = at->panels[0], *upper = at->panels[1];
    for (size_t k = begin; k < end; k++)
    {
        double pivot = lower[k * rows + k];
        if (!(pivot > 0 && pivot < INFINITY))
            return false;
        double root = sqrt(pivot);
        for (size_t side = 0; side < at->sides; side++)
        {
            double *column = at->panels[side] + k * rows;
            column[k] = root;
            for (size_t i = k + 1; i < end; i++)
                column[i] /= root;
        }
        for (size_t j = k + 1; j < end; j++)
        {
            for (size_t i = j; i < end; i++)
                lower[j * rows + i] -= lower[k * rows + i] * upper[k * rows + j];
            for (size_t i = j; i < end && at->sides == SIDES; i++)
                upper[j * rows + i] -= upper[k * rows + i] * lower[k * rows + j];
        }
    }
    return true;
}

/// Eliminate all pivots of a front. F11 = L11 U11, F21 becomes L21 = F21 U11^-1, F12^T becomes U12^T = F12^T L11^-T, and F22
/// becomes F22 - L21 U12. Each step is the same for L and for U^T, with the other one of them as the factor.
/// @return as eliminate_block()
static bool eliminate(const front *at)
{
    size_t rows = at->rows;
    for (size_t begin = 0; begin < at->pivots; begin += BLOCK)
    {
        size_t end = begin + BLOCK < at->pivots ? begin + BLOCK : at->pivots, width = end - begin;
        size_t diagonal = begin * rows + begin, beneath = begin * rows + end, rest = end * rows + end;
        if (!eliminate_block(at, begin, end))
            return false;
        for (size_t side = 0; side < at->sides && end < rows; side++)
            divide_by_triangle(rows - end, width, at->panels[1 - side] + diagonal, at->panels[side] + beneath, rows);
        for (size_t side = 0; side < at->sides && end < at->pivots; side++)
            subtract_products(rows - end, at->pivots - end, width, at->panels[side] + beneath,
                              at->panels[1 - side] + beneath, rows, at->panels[side] + rest, rows);
    }
    for (size_t side = 0; side < at->sides && at->below > 0; side++)
        subtract_products(at->below, at->below, at->pivots, at->panels[side] + at->pivots, at->panels[1 - side] + at->pivots,
                          rows, at->updates[side], at->below);
    return true;
}

static size_t rows_below(const front_tree *tree, size_t f)
{
    return tree->row_first[f + 1] - tree->row_first[f];
}

static size_t update_size(const multifrontal *solver, size_t f)
{
    size_t below = rows_below(&solver->tree, f);
    return solver->sides * below * below;
}

/// A front of zeros, with its update at the end of the others.
static front front_begin(const multifrontal *solver, size_t f, size_t used)
{
    const front_tree *tree = &solver->tree;
    int pivots = tree->pivot_first[f + 1] - tree->pivot_first[f], position = 0;
    size_t below = rows_below(tree, f), rows = (size_t)pivots + below, other = solver->sides - 1;
    front at = {.number = f,
                .rows = rows,
                .pivots = (size_t)pivots,
                .below = below,
                .sides = solver->sides,
                .panels = {solver->panels[0] + tree->panel_first[f], solver->panels[other] + tree->panel_first[f]},
                .updates = {solver->updates + used, solver->updates + used + other * below * below}};
    for (size_t side = 0; side < at.sides; side++)
        memset(at.panels[side], 0, rows * at.pivots * sizeof(double));
    memset(at.updates[0], 0, at.sides * below * below * sizeof(double));
    for (; position < pivots; position++)
        solver->position[tree->pivot_first[f] + position] = position;
    for (size_t k = tree->row_first[f]; k < tree->row_first[f + 1]; k++)
        solver->position[tree->rows[k]] = position++;
    return at;
}

/// Set the entries of the matrix in the rows and columns of the pivots.
static void set_entries(const multifrontal *solver, const double *lower, const double *upper, const front *at)
{
    const front_tree *tree = &solver->tree;
    int begin = tree->pivot_first[at->number], end = tree->pivot_first[at->number + 1];
    for (int pivot = begin; pivot < end; pivot++)
        for (size_t e = tree->entry_first[pivot]; e < tree->entry_first[pivot + 1]; e++)
        {
            front_entry entry = tree->entries[e];
            bool swapped = entry.source < 0;
            int source = swapped ? ~entry.source : entry.source;
            size_t place = (size_t)(pivot - begin) * at->rows + (size_t)solver->position[entry.row];
            at->panels[0][place] = swapped ? upper[source] : lower[source];
            at->panels[1][place] = swapped ? lower[source] : upper[source];
        }
}

/// Add a child's update.
static void add_update(const multifrontal *solver, size_t child, const double *update, const front *at)
{
    const front_tree *tree = &solver->tree;
    const int *rows = tree->rows + tree->row_first[child];
    int *relative = solver->relative;
    size_t count = rows_below(tree, child);
    for (size_t i = 0; i < count; i++)
        relative[i] = solver->position[rows[i]];
    for (size_t side = 0; side < at->sides; side++, update += count * count)
        for (size_t j = 0; j < count; j++)
        {
            size_t column = (size_t)relative[j], first = column < at->pivots ? 0 : at->pivots;
            double *target =
                first == 0 ? at->panels[side] + column * at->rows : at->updates[side] + (column - first) * at->below;
            for (size_t i = j; i < count; i++)
                target[(size_t)relative[i] - first] += update[j * count + i];
        }
}

/// The least pivot of a front over the diagonal entry of the matrix.
static double min_pivot(const multifrontal *solver, const double *lower, const front *at)
{
    const front_tree *tree = &solver->tree;
    double least = INFINITY;
    for (size_t k = 0; k < at->pivots; k++)
    {
        double root = at->panels[0][k * at->rows + k];
        least = fmin(least, root * root / lower[tree->diagonal[(size_t)tree->pivot_first[at->number] + k]]);
    }
    return least;
}

/// Factor a matrix with the stack of updates.
/// @return the least pivot over the diagonal entry that it came from, or 0
static double factor_fronts(multifrontal *solver, const double *lower, const double *upper)
{
    const front_tree *tree = &solver->tree;
    size_t waiting = 0, used = 0; // of the stacks
    double least = 1;
    for (size_t f = 0; f < tree->fronts && least > 0; f++)
    {
        front at = front_begin(solver, f, used);
        size_t size = update_size(solver, f), begin = used;
        set_entries(solver, lower, upper != NULL ? upper : lower, &at);
        for (int c = 0; c < tree->children[f]; c++)
        {
            size_t child = (size_t)solver->waiting[--waiting];
            begin -= update_size(solver, child);
            add_update(solver, child, solver->updates + begin, &at);
        }
        least = eliminate(&at) ? fmin(least, min_pivot(solver, lower, &at)) : 0;
        if (size > 0)
        {
            memmove(solver->updates + begin, solver->updates + used, size * sizeof(double));
            solver->waiting[waiting++] = (int)f;
        }
        used = begin + size;
    }
    return least;
}

bat_status multifrontal_factor(multifrontal *solver, const double *lower, const double *upper, double *pivot,
                               bat_error *error)
{
    *pivot = 0;
    bat_status reserved = blas_reserve(error);
    if (reserved != BAT_OK)
        return reserved;
    size_t size = solver->tree.update_max;
    if (array_make(&solver->updates, size, solver->sides * sizeof(double), error) != BAT_OK)
        return BAT_NO_MEMORY;
    blas_single_begin();
    *pivot = factor_fronts(solver, lower, upper);
    blas_single_end();
    // Factors are kept for long, and the stack is a third of them.
    free(solver->updates);
    solver->updates = NULL;
    return BAT_OK;
}

/// Forward x = L^-1 x for the pivots of a front, subtracted from its other rows; backward x = U^-1 x, from its other rows.
/// @param x    columns of `count` numbers, in order of elimination
/// @param part room for the front's rows
static void solve_front(const multifrontal *solver, bool backward, size_t f, size_t columns, double *x, double *part)
{
    const front_tree *tree = &solver->tree;
    size_t count = tree->count, pivots = (size_t)(tree->pivot_first[f + 1] - tree->pivot_first[f]);
    size_t below = rows_below(tree, f), rows = pivots + below;
    const double *panel = solver->panels[backward ? solver->sides - 1 : 0] + tree->panel_first[f];
    const int *row = tree->rows + tree->row_first[f];
    double *own = x + tree->pivot_first[f];
    for (size_t c = 0; c < columns && backward; c++)
        for (size_t i = 0; i < below; i++)
            part[c * below + i] = x[c * count + (size_t)row[i]];
    if (below > 0 && backward)
        cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, (int)pivots, (int)columns, (int)below, -1, panel + pivots,
                    (int)rows, part, (int)below, 1, own, (int)count);
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, backward ? CblasTrans : CblasNoTrans, CblasNonUnit, (int)pivots,
                (int)columns, 1, panel, (int)rows, own, (int)count);
    if (below > 0 && !backward)
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, (int)below, (int)columns, (int)pivots, 1, panel + pivots,
                    (int)rows, own, (int)count, 0, part, (int)below);
    for (size_t c = 0; c < columns && !backward; c++)
        for (size_t i = 0; i < below; i++)
            x[c * count + (size_t)row[i]] -= part[c * below + i];
}

bat_status multifrontal_solve(const multifrontal *solver, size_t columns, double *x, bat_error *error)
{
    const front_tree *tree = &solver->tree;
    size_t count = tree->count, numbers = (count + tree->panel_max) * columns;
    double *ordered = memory_array(numbers, sizeof *ordered), *part = ordered != NULL ? ordered + count * columns : NULL;
    if (ordered == NULL)
        return error_memory(error, numbers * sizeof *ordered);
    for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < columns; c++)
            ordered[c * count + k] = x[(size_t)tree->order[k] * columns + c];
    blas_single_begin();
    for (size_t f = 0; f < tree->fronts; f++)
        solve_front(solver, false, f, columns, ordered, part);
    for (size_t f = tree->fronts; f-- > 0;)
        solve_front(solver, true, f, columns, ordered, part);
    blas_single_end();
    for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < columns; c++)
            x[(size_t)tree->order[k] * columns + c] = ordered[c * count + k];
    free(ordered);
    return BAT_OK;
}
