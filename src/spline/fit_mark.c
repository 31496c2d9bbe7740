#include "spline/fit_mark.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

// Without a tolerance, the worst cells that have this share of the squared error are marked (Doerfler, 1996).
static const double BULK = 0.3;

enum
{
    MOST_RINGS = 1 << 8
};

/// A cell and the sum of squared errors of its points.
typedef struct ranked_cell
{
    double score;
    uint32_t cell;
} ranked_cell;

static int compare_ranked(const void *a, const void *b)
{
    const ranked_cell *x = a, *y = b;
    if (x->score != y->score)
        return x->score < y->score ? 1 : -1;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

/// The score of a cell; 0 when all its points lie within the tolerance.
static double score_of(const fit_points *points, size_t cell, double tolerance)
{
    double sum = 0, largest = 0;
    for (size_t place = points->first[cell]; place < points->first[cell + 1]; place++)
    {
        size_t row = points->order[place];
        double distance = points->distance[row], weight = points->weight[row];
        sum += weight * distance * distance;
        largest = weight > 0 ? fmax(largest, distance) : largest;
    }
    return largest > tolerance ? sum : 0;
}

/// Rank the cells that have an error.
/// @return how many there are
static size_t rank_cells(const bat_hierarchical_space *space, const fit_points *points, double tolerance,
                         ranked_cell *ranked)
{
    size_t count = 0;
    for (size_t c = 0; c < points->cells; c++)
    {
        // Cells of the last level stay as they are.
        bool may = bat_hierarchical_space_cell(space, c).level + 1 < BAT_HIERARCHICAL_MOST_LEVELS;
        double score = may ? score_of(points, c, tolerance) : 0;
        if (score > 0)
            ranked[count++] = (ranked_cell){score, (uint32_t)c};
    }
    qsort(ranked, count, sizeof *ranked, compare_ranked);
    return count;
}

/// The number of first cells that have the bulk of the error.
static size_t bulk_of(const ranked_cell *ranked, size_t count)
{
    double total = 0, sum = 0;
    for (size_t k = 0; k < count; k++)
        total += ranked[k].score;
    size_t wanted = 0;
    while (wanted < count && sum < BULK * total)
        sum += ranked[wanted++].score;
    return wanted;
}

/// A cell and its rings, as far as the grid goes.
static bat_spline_box grow(const bat_hierarchical_space *space, bat_spline_box box, uint32_t rings)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(space);
    for (int k = 0; k < 2; k++)
    {
        uint32_t spans = (uint32_t)(options.spans[k] << box.level);
        box.low[k] = box.low[k] > rings ? box.low[k] - rings : 0;
        box.high[k] = spans - box.high[k] > rings ? box.high[k] + rings : spans;
    }
    return box;
}

/// Everything a refinement is chosen from.
typedef struct mark_choice
{
    const bat_hierarchical_space *space;
    const ranked_cell *ranked;
    bat_spline_box *boxes;
    uint32_t rings;
} mark_choice;

/// A copy of the space with the first cells refined.
static bat_status refine_first(const mark_choice *choice, size_t count, bat_hierarchical_space **refined, bat_error *error)
{
    for (size_t k = 0; k < count; k++)
    {
        bat_spline_box box = bat_hierarchical_space_cell(choice->space, choice->ranked[k].cell);
        choice->boxes[k] = grow(choice->space, box, choice->rings);
    }
    bat_hierarchical_space *copy;
    bat_status status = bat_hierarchical_space_copy(choice->space, &copy, error);
    if (status != BAT_OK)
        return status;
    status = bat_hierarchical_space_refine(copy, choice->boxes, count, error);
    if (status != BAT_OK)
    {
        bat_hierarchical_space_free(copy);
        return status;
    }
    *refined = copy;
    return BAT_OK;
}

/// Refine the most first cells that fit the budget, by regula falsi kept off the ends: 0 fit, `count` do not.
static bat_status fill_budget(const mark_choice *choice, size_t count, size_t count_functions, size_t budget,
                              bat_hierarchical_space **refined, bat_error *error)
{
    size_t low = 0, high = count, low_functions = bat_hierarchical_space_functions(choice->space),
           high_functions = count_functions;
    while (high - low > 1 && budget - low_functions > budget / 500)
    {
        double share = (double)(budget - low_functions) / (double)(high_functions - low_functions);
        size_t try = low + (size_t)(fmin(fmax(share, 0.1), 0.9) * (double)(high - low));
        try = try <= low ? low + 1 : try >= high ? high - 1 : try;
        bat_hierarchical_space *made;
        bat_status status = refine_first(choice, try, &made, error);
        if (status != BAT_OK)
            return status;
        size_t functions = bat_hierarchical_space_functions(made);
        if (functions > budget)
        {
            high = try;
            high_functions = functions;
            bat_hierarchical_space_free(made);
            continue;
        }
        low = try;
        low_functions = functions;
        bat_hierarchical_space_free(*refined);
        *refined = made;
    }
    return BAT_OK;
}

/// Refine the first `wanted` cells, or as many as fit. More rings are taken where refinement gives no function.
static bat_status refine_wanted(mark_choice *choice, size_t wanted, size_t budget, bat_hierarchical_space **refined,
                                bat_error *error)
{
    size_t before = bat_hierarchical_space_functions(choice->space);
    for (; choice->rings < MOST_RINGS; choice->rings++)
    {
        bat_hierarchical_space *made;
        bat_status status = refine_first(choice, wanted, &made, error);
        if (status != BAT_OK)
            return status;
        size_t functions = bat_hierarchical_space_functions(made);
        if (functions > before && (budget == 0 || functions <= budget))
        {
            *refined = made;
            return BAT_OK;
        }
        bat_hierarchical_space_free(made);
        if (functions > before)
            return fill_budget(choice, wanted, functions, budget, refined, error);
    }
    return BAT_OK;
}

bat_status fit_mark_refine(const bat_hierarchical_space *space, const fit_points *points, const fit_marking *marking,
                           bat_hierarchical_space **refined, bat_error *error)
{
    *refined = NULL;
    ranked_cell *ranked = memory_array(points->cells, sizeof *ranked);
    bat_spline_box *boxes = memory_array(points->cells, sizeof *boxes);
    bat_status status = BAT_OK;
    if (ranked == NULL || boxes == NULL)
        status = error_memory(error, points->cells * sizeof *boxes);
    else
    {
        size_t count = rank_cells(space, points, marking->tolerance, ranked);
        size_t wanted = marking->tolerance > 0 ? count : bulk_of(ranked, count);
        mark_choice choice = {space, ranked, boxes, (uint32_t)marking->neighbours};
        if (wanted > 0)
            status = refine_wanted(&choice, wanted, marking->budget, refined, error);
    }
    if (status != BAT_OK)
    {
        bat_hierarchical_space_free(*refined);
        *refined = NULL;
    }
    free(ranked);
    free(boxes);
    return status;
}
