/// @file
/// Marking by error, as in adaptive finite elements.
///
/// A cell c has the error indicator  e_c = sum over its points of w_i |S(u_i) - x_i|^2.  With a tolerance, all cells with a
/// point beyond it are marked. Without one, the smallest set of cells with  sum e_c >= BULK_SHARE * total  is marked:
/// Doerfler, "A convergent adaptive algorithm for Poisson's equation" (1996).

#include "base/counting_sort.h"
#include "surface/fit/loop.h"

#include "base/error.h"

// Share of the total squared error that the marked cells carry, without a tolerance (Doerfler, 1996).
static const double BULK_SHARE = 0.3;
// Minimum growth factor of the number of functions in one round, which bounds the number of rounds.
static const double MIN_GROWTH = 1.1;
// Points of a cell are separable by finer functions when they spread over at least this part of the cell in a direction.
static const double SEPARATION = 1.0 / 16;

enum
{
    /// A cell with this many rings contains the support of a function of the next level, for any degree.
    ENOUGH_RINGS = BAT_SPLINE_MAX_DEGREE / 4 + 1,
    /// One part in this many of a budget may be left unused.
    SLACK = 500
};

void cell_points_add(cell_points *to, const cell_points *more)
{
    to->sum += more->sum;
    to->largest = fmax(to->largest, more->largest);
    to->count += more->count;
    for (int k = 0; k < 2; k++)
    {
        to->low[k] = fmin(to->low[k], more->low[k]);
        to->high[k] = fmax(to->high[k], more->high[k]);
    }
}

cell_points cell_points_of_places(const fit_points *points, size_t begin, size_t end)
{
    cell_points gathered = CELL_NO_POINTS;
    for (size_t place = begin; place < end; place++)
    {
        size_t row = points->order[place];
        // Guides are no reason to refine.
        if (points->weight[row] == 0 || points->number[row] >= points->guides)
            continue;
        gathered.sum += points->weight[row] * points->distance[row] * points->distance[row];
        gathered.largest = fmax(gathered.largest, points->distance[row]);
        gathered.count++;
        box_include(2, points->parameter + 2 * row, gathered.low, gathered.high);
    }
    return gathered;
}

cell_points cell_points_of(const fit_points *points, size_t cell)
{
    cell_points gathered = CELL_NO_POINTS;
    for (size_t begin = points->first[cell], end = points->first[cell + 1]; begin < end;)
    {
        size_t next = fit_points_block_end(points, begin, end);
        cell_points block = cell_points_of_places(points, begin, next);
        cell_points_add(&gathered, &block);
        begin = next;
    }
    return gathered;
}

/// Whether finer functions could separate the points of a cell. Points that coincide in the parameters, such as points whose
/// projection converged to a wrong foot, would otherwise be refined without end.
static bool are_separable(const bat_hierarchical_space *space, const cell_points *gathered, uint32_t level)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(space);
    for (int k = 0; k < 2; k++)
        if ((gathered->high[k] - gathered->low[k]) * (double)(options.spans[k] << level) >= SEPARATION)
            return true;
    return false;
}

double cell_score(const bat_hierarchical_space *space, const cell_points *gathered, size_t cell, const fit_marking *marking)
{
    double tolerance = marking->tolerance;
    uint32_t level = bat_hierarchical_space_cell(space, cell).level;
    if (gathered->largest <= tolerance || gathered->count < (double)marking->fewest ||
        level + 1 == BAT_HIERARCHICAL_MAX_LEVELS)
        return 0;
    if (tolerance > 0)
        return gathered->sum;
    return are_separable(space, gathered, level) ? gathered->sum * (gathered->count - 1) / gathered->count : 0;
}

static bat_status score_cells(const bat_hierarchical_space *space, const fit_points *points, const fit_marking *marking,
                              double *scores, bat_error *error)
{
    if (points->spread != NULL)
        return points->team->score_cells(space, points, marking, scores, error);
    for (size_t c = 0; c < points->cells; c++)
    {
        cell_points gathered = cell_points_of(points, c);
        scores[c] = cell_score(space, &gathered, c, marking);
    }
    return BAT_OK;
}

/// Sort the cells of positive score in descending order.
/// @return their number
static size_t rank_cells(const double *scores, size_t cells, scored *ranked)
{
    size_t count = 0;
    for (size_t c = 0; c < cells; c++)
        if (scores[c] > 0)
            ranked[count++] = (scored){scores[c], c};
    qsort(ranked, count, sizeof *ranked, larger_first);
    return count;
}

/// The number of highest-ranked cells that carry BULK_SHARE of the total error.
static size_t bulk_of(const scored *ranked, size_t count)
{
    double total = 0, sum = 0;
    for (size_t k = 0; k < count; k++)
        total += ranked[k].score;
    size_t wanted = 0;
    while (wanted < count && sum < BULK_SHARE * total)
        sum += ranked[wanted++].score;
    return wanted;
}

typedef struct mark_choice
{
    const bat_hierarchical_space *space;
    const scored *ranked;
    int rings;
} mark_choice;

/// A cell and the active cells of the same level in its rings. Coarser cells in the rings are not refined: they would be
/// refined through several levels at once, which costs more functions than it reduces the error.
/// @param boxes receives up to side_of()^2 boxes
static size_t surround(const mark_choice *choice, bat_spline_box cell, bat_spline_box *boxes)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(choice->space);
    size_t count = 0;
    double spans[2];
    for (int k = 0; k < 2; k++)
        spans[k] = (double)(options.spans[k] << cell.level);
    for (int down = -choice->rings; down <= choice->rings; down++)
        for (int across = -choice->rings; across <= choice->rings; across++)
        {
            double u = ((double)cell.low[0] + across + 0.5) / spans[0], v = ((double)cell.low[1] + down + 0.5) / spans[1];
            if (u < 0 || u > 1 || v < 0 || v > 1)
                continue;
            size_t there = bat_hierarchical_space_locate(choice->space, u, v);
            bat_spline_box box = bat_hierarchical_space_cell(choice->space, there);
            if (box.level == cell.level)
                boxes[count++] = box;
        }
    return count;
}

/// The space with the first cells and their rings refined.
/// @param most      the most functions that the space may have
/// @param functions receives their number
/// @param refined   receives the space, or null if it has more functions
static bat_status refine_first(const mark_choice *choice, size_t count, size_t most, size_t *functions,
                               bat_hierarchical_space **refined, bat_error *error)
{
    size_t side = 2 * (size_t)choice->rings + 1, boxes_count = 0; // side: of a cell with its rings, in cells
    bat_spline_box *boxes = memory_array(count, side * side * sizeof *boxes);
    if (boxes == NULL)
        return error_memory(error, count * side * side * sizeof *boxes);
    for (size_t k = 0; k < count; k++)
    {
        bat_spline_box cell = bat_hierarchical_space_cell(choice->space, choice->ranked[k].index);
        boxes_count += surround(choice, cell, boxes + boxes_count);
    }
    bat_status status = hierarchical_space_refined(choice->space, boxes, boxes_count, most, functions, refined, error);
    free(boxes);
    return status;
}

/// Refine the largest number of highest-ranked cells that fits the budget, by regula falsi on the number of cells. Initially
/// 0 cells fit and `count` do not. Only the last space is made; others are counted.
static bat_status fill_budget(const mark_choice *choice, size_t count, size_t count_functions, size_t budget,
                              bat_hierarchical_space **refined, bat_error *error)
{
    size_t before = bat_hierarchical_space_functions(choice->space), functions;
    size_t low = 0, high = count, low_functions = before, high_functions = count_functions;
    while (high - low > 1 && budget - low_functions > budget / SLACK)
    {
        double share = (double)(budget - low_functions) / (double)(high_functions - low_functions);
        size_t try = low + (size_t)(fmin(fmax(share, 0.1), 0.9) * (double)(high - low));
        try = try <= low ? low + 1 : try >= high ? high - 1 : try;
        bat_status status = refine_first(choice, try, 0, &functions, refined, error);
        if (status != BAT_OK)
            return status;
        *(functions <= budget ? &low : &high) = try;
        *(functions <= budget ? &low_functions : &high_functions) = functions;
    }
    return low_functions > before ? refine_first(choice, low, budget, &functions, refined, error) : BAT_OK;
}

/// Refine the first `wanted` cells, or as many as fit the budget. If the number of functions grows too little, double the
/// number of cells up to `maximum`, then add rings.
static bat_status refine_wanted(mark_choice *choice, size_t wanted, size_t maximum, size_t budget,
                                bat_hierarchical_space **refined, bat_error *error)
{
    size_t before = bat_hierarchical_space_functions(choice->space), most = budget > 0 ? budget : SIZE_MAX;
    for (;;)
    {
        size_t functions;
        bat_hierarchical_space *made;
        bat_status status = refine_first(choice, wanted, most, &functions, &made, error);
        if (status != BAT_OK)
            return status;
        bool few = wanted < maximum && (double)functions < MIN_GROWTH * (double)before;
        if (!few && functions > before && made != NULL)
        {
            *refined = made;
            return BAT_OK;
        }
        bat_hierarchical_space_free(made);
        if (few)
            wanted = 2 * wanted < maximum ? 2 * wanted : maximum;
        else if (functions > before)
            return fill_budget(choice, wanted, functions, budget, refined, error);
        else if (choice->rings++ >= ENOUGH_RINGS)
            return BAT_OK;
    }
}

bat_status fit_mark_refine(const bat_hierarchical_space *space, const fit_points *points, const fit_marking *marking,
                           bat_hierarchical_space **refined, bat_error *error)
{
    *refined = NULL;
    if (marking->budget > 0 && bat_hierarchical_space_functions(space) >= marking->budget)
        return BAT_OK;
    memory_pool pool = {0};
    scored *ranked = memory_pool_array(&pool, points->cells, sizeof *ranked);
    double *scores = memory_pool_array(&pool, points->cells, sizeof *scores);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        status = score_cells(space, points, marking, scores, error);
    size_t count = status == BAT_OK ? rank_cells(scores, points->cells, ranked) : 0;
    size_t wanted = marking->tolerance > 0 ? count : bulk_of(ranked, count);
    mark_choice choice = {space, ranked, marking->neighbours};
    if (wanted > 0)
        status = refine_wanted(&choice, wanted, count, marking->budget, refined, error);
    if (status != BAT_OK)
    {
        bat_hierarchical_space_free(*refined);
        *refined = NULL;
    }
    memory_pool_free(&pool);
    return status;
}
