#include "curve/measure/metric_tree.h"

#include "base/error.h"
#include "linalg/vector.h"

// A subtree is a range of positions: its vantage point, then the half of the others nearer to it, then the rest.

static const size_t SHELL_SIZE = 4;

static size_t outer_begin(size_t begin, size_t end)
{
    return begin + 1 + (end - begin - 1) / 2;
}

static double distance_to(const metric_tree *tree, size_t position, const double *point)
{
    size_t row = tree->items[position] * tree->space->point_dim;
    return tree->space->distance(tree->space, point, tree->points + row);
}

static void shell_of(const keyed *entries, size_t begin, size_t end, double *shell)
{
    box_clear(1, &shell[0], &shell[1]);
    for (size_t i = begin; i < end; i++)
        box_include(1, &entries[i].key, &shell[0], &shell[1]);
}

static void arrange(metric_tree *tree, keyed *entries, size_t begin, size_t end)
{
    if (begin == end)
        return;
    tree->items[begin] = entries[begin].item;
    for (size_t i = begin + 1; i < end; i++)
        entries[i].key = distance_to(tree, begin, tree->points + entries[i].item * tree->space->point_dim);
    size_t outer = outer_begin(begin, end);
    if (outer < end)
        select_nth(entries + begin + 1, end - begin - 1, outer - begin - 1);
    shell_of(entries, begin + 1, outer, tree->shells + begin * SHELL_SIZE);
    shell_of(entries, outer, end, tree->shells + begin * SHELL_SIZE + 2);
    arrange(tree, entries, begin + 1, outer);
    arrange(tree, entries, outer, end);
}

void metric_tree_free(metric_tree *tree)
{
    free(tree->items);
    free(tree->shells);
    *tree = (metric_tree){0};
}

bat_status metric_tree_build(const bat_space *space, const double *points, size_t count, metric_tree *tree, bat_error *error)
{
    metric_tree made = {.space = space, .points = points, .count = count};
    made.items = memory_array(count, sizeof *made.items);
    made.shells = memory_array(count, SHELL_SIZE * sizeof *made.shells);
    keyed *entries = memory_array(count, sizeof *entries);
    if (made.items == NULL || made.shells == NULL || entries == NULL)
    {
        metric_tree_free(&made);
        free(entries);
        return error_memory(error, count * SHELL_SIZE * sizeof(double));
    }
    for (size_t i = 0; i < count; i++)
        entries[i] = (keyed){0, i};
    arrange(&made, entries, 0, count);
    free(entries);
    *tree = made;
    return BAT_OK;
}

/// How far a point at `distance` from the vantage point is, at least, from anything in the shell. Infinite for an empty one.
static double gap_to_shell(double distance, const double *shell)
{
    return fmax(fmax(shell[0] - distance, distance - shell[1]), 0);
}

static void search(const metric_tree *tree, const double *point, size_t begin, size_t end, nearest_hit *best)
{
    while (begin < end)
    {
        double distance = distance_to(tree, begin, point);
        if (distance < best->distance)
            *best = (nearest_hit){tree->items[begin], distance};
        const double *shells = tree->shells + begin * SHELL_SIZE;
        size_t outer = outer_begin(begin, end);
        double inner_gap = gap_to_shell(distance, shells), outer_gap = gap_to_shell(distance, shells + 2);
        // The nearer half first, by recursion; the other by going on with the loop.
        bool inner_first = inner_gap <= outer_gap;
        size_t near_begin = inner_first ? begin + 1 : outer, near_end = inner_first ? outer : end;
        if (fmin(inner_gap, outer_gap) < best->distance)
            search(tree, point, near_begin, near_end, best);
        if (!(fmax(inner_gap, outer_gap) < best->distance))
            return;
        size_t far_begin = inner_first ? outer : begin + 1, far_end = inner_first ? end : outer;
        begin = far_begin;
        end = far_end;
    }
}

nearest_hit metric_tree_find(const metric_tree *tree, const double *point)
{
    nearest_hit best = {BAT_NO_INDEX, INFINITY};
    search(tree, point, 0, tree->count, &best);
    return best;
}
