/// @file
/// Tests of what a cloud is; see boundary.h.

#include "surface/cloud/boundary.h"

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "base/threads.h"

#include <string.h>

// A line

// Largest ratio of the second variance to the first of points on a line, and of points that scatter about one: these have a
// third variance of at least MIN_ROUND of the second.
static const double MAX_LINE = 1e-10;
static const double MAX_SCATTERED_LINE = 1e-4;
static const double MIN_ROUND = 0.25;

bat_status diagnose_line(const double *points, size_t count, bat_error *error)
{
    local_plane plane = local_plane_fit_all(points, count);
    const double *variance = plane.variance;
    bool exact = variance[1] <= MAX_LINE * variance[0];
    bool scattered = variance[1] <= MAX_SCATTERED_LINE * variance[0] && variance[2] >= MIN_ROUND * variance[1];
    if (!exact && !scattered)
        return BAT_OK;
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                     "no boundary loop was found: the points lie along a line; a surface needs points beside it");
}

// A volume

/// Whether most neighbourhoods of `wanted` points are about as thick as wide.
/// @return BAT_OK or BAT_NO_MEMORY
static bat_status find_thick(const double *points, const nearest_tree *tree, size_t wanted, bool *found, bat_error *error)
{
    static const size_t PLACES = 64;
    static const double MIN_THICK = 0.3; // The third variance of a ball is that of the second.
    size_t thick = 0, made = 0;
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (size_t i = 0; i < tree->count && status == BAT_OK && wanted > 0; i += tree->count / PLACES + 1, made++)
    {
        status = neighbours_nearest(tree, points + 3 * i, wanted, &near, error);
        if (status != BAT_OK)
            break;
        local_plane plane = local_plane_fit(points, &near);
        thick += plane.variance[2] > MIN_THICK * plane.variance[1];
    }
    neighbour_list_free(&near);
    *found = 2 * thick > made;
    return status;
}

bat_status diagnose_volume(const double *points, const nearest_tree *tree, bat_error *error)
{
    // Neighbourhoods of 1 % are thick by noise, too, those of 10 % by layers.
    const size_t sizes[2] = {tree->count < 2000 ? 20 : tree->count / 100, tree->count / 10};
    bool fills = true;
    bat_status status = BAT_OK;
    for (size_t k = 0; k < 2 && status == BAT_OK && fills; k++)
        status = find_thick(points, tree, sizes[k], &fills, error);
    if (status != BAT_OK || !fills)
        return status;
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                     "the points fill a volume; a surface needs points on it alone");
}

// Two sheets

enum
{
    SHEET_PLACES = 64,
    SHEET_MIN_POINTS = 64,
    SHEET_MAX_POINTS = 1024
};
// Kurtosis of two normal distributions, means four standard deviations apart: 1.72; uniform: 1.8; normal: 3.
static const double MAX_KURTOSIS = 1.72;
// Noise below this share of the spacing is not tested: farther sheets are separate pieces.
static const double SHEET_MIN_NOISE = 0.1;
// Radius of neighbourhoods in standard deviations.
static const double SHEET_REACH = 5;

static double kurtosis_at(const double *points, const neighbour_list *near)
{
    local_plane plane = local_plane_fit(points, near);
    if (!(plane.variance[1] > 0))
        return 3;
    local_quadratic quadratic = local_quadratic_fit(points, near, &plane);
    double second = 0, fourth = 0;
    for (size_t i = 0; i < near->count; i++)
    {
        double height = local_quadratic_height(&quadratic, points + 3 * (size_t)near->entries[i].item);
        second += height * height;
        fourth += height * height * height * height;
    }
    return second > 0 ? fourth * (double)near->count / (second * second) : 3;
}

bat_status diagnose_sheets(const double *points, const nearest_tree *tree, double noise, double spacing, double unit,
                           bat_error *error)
{
    if (noise < SHEET_MIN_NOISE * spacing || tree->count < SHEET_MIN_POINTS)
        return BAT_OK;
    double reach = SHEET_REACH * noise / spacing, share = fmin(ANGLE_PI * reach * reach, SHEET_MAX_POINTS);
    size_t wanted = share < SHEET_MIN_POINTS ? SHEET_MIN_POINTS : (size_t)share;
    double kurtoses[SHEET_PLACES];
    size_t stride = tree->count / SHEET_PLACES + 1, made = 0;
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (size_t i = stride / 2; i < tree->count && status == BAT_OK; i += stride)
    {
        status = neighbours_nearest(tree, points + 3 * i, wanted, &near, error);
        if (status == BAT_OK)
            kurtoses[made++] = kurtosis_at(points, &near);
    }
    neighbour_list_free(&near);
    if (status != BAT_OK || made == 0)
        return status;
    if (sort_median(kurtoses, made) > MAX_KURTOSIS)
        return BAT_OK;
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                     "the points lie on two sheets, about %.3g apart; leave one out, or give the boundary to fit "
                     "the surface between them",
                     2 * noise * unit);
}

// Pieces

enum
{
    LINKS = 8, ///< neighbours of a point in the graph
    LINK_RANK = 6,
    FLAT_NEIGHBOURS = 12,
    FLAT_PLACES = 64,
    MIN_BRIDGES = 3
};
// Longest link, in distances of the neighbour of rank LINK_RANK of the denser end,
static const double MAX_LINK = 1.25;
// and of the sparser end, for links between large components.
static const double MAX_BRIDGE = 1.5;
// Smaller components, as a share of all points, are outliers.
static const double MIN_PIECE = 0.05;
// A component is scattered in space, rather than on a surface, where the median of the ratio of its third variance to its
// second exceeds this, and exceeds SCATTERED_RATIO times that of the largest component.
static const double MIN_SCATTERED = 0.1;
static const double SCATTERED_RATIO = 3;

typedef struct piece_graph
{
    memory_pool pool;
    const double *points;
    const nearest_tree *tree;
    uint32_t *links;  ///< count x LINKS
    double *lengths;  ///< count x LINKS
    double *reach;    ///< count: distance of the neighbour of rank LINK_RANK
    uint32_t *parent; ///< count: union-find forest
    size_t *sizes;    ///< count: of components, at their roots
} piece_graph;

static bat_status graph_make(const double *points, const nearest_tree *tree, piece_graph *graph, bat_error *error)
{
    size_t count = tree->count;
    *graph = (piece_graph){.points = points, .tree = tree};
    graph->links = memory_pool_array(&graph->pool, count, LINKS * sizeof *graph->links);
    graph->lengths = memory_pool_array(&graph->pool, count, LINKS * sizeof *graph->lengths);
    graph->reach = memory_pool_array(&graph->pool, count, sizeof *graph->reach);
    graph->parent = memory_pool_array(&graph->pool, count, sizeof *graph->parent);
    graph->sizes = memory_pool_array(&graph->pool, count, sizeof *graph->sizes);
    bool complete = graph->pool.missing == 0;
#pragma omp parallel num_threads(threads_for(0, count / 256 + 1)) if (complete) reduction(&& : complete)
    {
        neighbour_list near = {0};
#pragma omp for schedule(static)
        for (size_t i = 0; i < count; i++)
        {
            if (!complete || neighbours_nearest(tree, points + 3 * i, LINKS + 1, &near, NULL) != BAT_OK)
            {
                complete = false;
                continue;
            }
            size_t made = 0;
            for (size_t k = 0; k < near.count && made < LINKS; k++)
                if (near.entries[k].item != i)
                {
                    graph->links[LINKS * i + made] = near.entries[k].item;
                    graph->lengths[LINKS * i + made++] = sqrt(near.entries[k].squared);
                }
            for (; made < LINKS; made++)
            {
                graph->links[LINKS * i + made] = (uint32_t)i;
                graph->lengths[LINKS * i + made] = made > 0 ? graph->lengths[LINKS * i + made - 1] : 0;
            }
            graph->reach[i] = graph->lengths[LINKS * i + LINK_RANK - 1];
        }
        neighbour_list_free(&near);
    }
    return complete ? BAT_OK : error_memory(error, count * (LINKS + 4) * sizeof(double));
}

static void merge(const piece_graph *graph, uint32_t a, uint32_t b)
{
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    if (low == high)
        return;
    graph->parent[high] = low;
    graph->sizes[low] += graph->sizes[high];
    graph->sizes[high] = 0;
}

static void join_dense(const piece_graph *graph)
{
    for (uint32_t i = 0; i < graph->tree->count; i++)
    {
        graph->parent[i] = i;
        graph->sizes[i] = 1;
    }
    for (size_t e = 0; e < LINKS * graph->tree->count; e++)
    {
        uint32_t i = (uint32_t)(e / LINKS), k = graph->links[e];
        if (graph->lengths[e] <= MAX_LINK * fmin(graph->reach[i], graph->reach[k]))
            merge(graph, sets_root(graph->parent, i), sets_root(graph->parent, k));
    }
}

/// The median ratio of the third variance to the second around points of a component.
static bat_status measure_scatter(const piece_graph *graph, uint32_t root, double *ratio, bat_error *error)
{
    double ratios[FLAT_PLACES];
    size_t stride = graph->sizes[root] / FLAT_PLACES + 1, passed = 0, made = 0;
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (uint32_t i = 0; i < graph->tree->count && status == BAT_OK && made < FLAT_PLACES; i++)
    {
        if (sets_root(graph->parent, i) != root || passed++ % stride != 0)
            continue;
        status = neighbours_nearest(graph->tree, graph->points + 3 * (size_t)i, FLAT_NEIGHBOURS, &near, error);
        if (status != BAT_OK)
            break;
        local_plane plane = local_plane_fit(graph->points, &near);
        ratios[made++] = plane.variance[1] > 0 ? plane.variance[2] / plane.variance[1] : 0;
    }
    neighbour_list_free(&near);
    *ratio = made > 0 ? sort_median(ratios, made) : 0;
    return status;
}

/// Merge large components that touch where the density of the points changes.
static void join_large(const piece_graph *graph, size_t minimum)
{
    for (bool joined = true; joined;)
    {
        joined = false;
        size_t bridges = 0;
        uint32_t from = 0, to = 0;
        for (size_t e = 0; e < LINKS * graph->tree->count && !joined; e++)
        {
            uint32_t i = (uint32_t)(e / LINKS), k = graph->links[e], a = sets_root(graph->parent, i),
                     b = sets_root(graph->parent, k);
            if (a == b || graph->sizes[a] < minimum || graph->sizes[b] < minimum ||
                graph->lengths[e] > MAX_BRIDGE * fmax(graph->reach[i], graph->reach[k]))
                continue;
            bool same = bridges > 0 && ((a == from && b == to) || (a == to && b == from));
            bridges = same ? bridges + 1 : 1;
            from = a;
            to = b;
            joined = bridges >= MIN_BRIDGES;
        }
        if (joined)
            merge(graph, from, to);
    }
}

/// Split components that are scattered in space into points.
static bat_status drop_scattered(const piece_graph *graph, uint32_t largest, size_t minimum, bat_error *error)
{
    double flat, ratio;
    bat_status status = measure_scatter(graph, largest, &flat, error);
    for (uint32_t i = 0; i < graph->tree->count && status == BAT_OK; i++)
    {
        if (i == largest || graph->sizes[i] < minimum)
            continue;
        status = measure_scatter(graph, i, &ratio, error);
        if (status == BAT_OK && ratio > MIN_SCATTERED && ratio > SCATTERED_RATIO * flat)
            graph->sizes[i] = 1;
    }
    return status;
}

static uint32_t largest_of(const piece_graph *graph, uint32_t besides)
{
    uint32_t largest = besides == 0 ? (graph->tree->count > 1 ? 1 : 0) : 0;
    for (uint32_t i = 0; i < graph->tree->count; i++)
        if (i != besides && graph->sizes[i] > graph->sizes[largest])
            largest = i;
    return largest;
}

static const int PEEL_NEIGHBOURS = 13;
// Outliers beside a surface are looked for where this share of the points are outliers elsewhere,
static const double MIN_PEEL = 0.02;
// and are farther from the plane of their neighbours than this many median distances and this share of the spacing.
static const double PEEL_MEDIANS = 6;
static const double PEEL_SPACINGS = 0.5;

/// Distances of the kept points from the planes of their kept neighbours, and the spacings; others get 0.
static bat_status measure_heights(const piece_graph *graph, const bool *kept, double *heights, double *spacings,
                                  bat_error *error)
{
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (size_t i = 0; i < graph->tree->count && status == BAT_OK; i++)
    {
        heights[i] = 0;
        const double *here = graph->points + 3 * i;
        if (!kept[i])
            continue;
        status = neighbours_nearest(graph->tree, here, 2 * PEEL_NEIGHBOURS, &near, error);
        if (status != BAT_OK)
            break;
        size_t made = 0;
        for (size_t k = 0; k < near.count && made < PEEL_NEIGHBOURS; k++)
            if (kept[near.entries[k].item] && near.entries[k].item != i)
                near.entries[made++] = near.entries[k];
        near.count = made;
        if (made < PEEL_NEIGHBOURS / 2)
            continue;
        local_plane plane = local_plane_fit(graph->points, &near);
        for (int k = 0; k < 3; k++)
            heights[i] += (here[k] - plane.centre[k]) * plane.axes[2][k];
        heights[i] = fabs(heights[i]);
        spacings[i] = sqrt(near.entries[made - 1].squared * ANGLE_PI / (double)made);
    }
    neighbour_list_free(&near);
    return status;
}

/// Leave out points that stand off the surface. `left` is updated.
static bat_status peel(const piece_graph *graph, bool *kept, size_t *left, bat_error *error)
{
    size_t count = graph->tree->count;
    double *heights = memory_array(count, 3 * sizeof *heights);
    if (heights == NULL)
        return error_memory(error, count * 3 * sizeof *heights);
    double *spacings = heights + count, *sorted = spacings + count;
    bat_status status = measure_heights(graph, kept, heights, spacings, error);
    if (status == BAT_OK)
    {
        memcpy(sorted, heights, count * sizeof *sorted);
        qsort(sorted, count, sizeof *sorted, ascending);
    }
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        if (kept[i] && heights[i] > 0 && heights[i] > PEEL_MEDIANS * sorted[count / 2] &&
            heights[i] > PEEL_SPACINGS * spacings[i])
        {
            kept[i] = false;
            ++*left;
        }
    free(heights);
    return status;
}

bat_status diagnose_pieces(const double *points, const nearest_tree *tree, bool *kept, size_t *left, bat_error *error)
{
    piece_graph graph;
    bat_status status = graph_make(points, tree, &graph, error);
    size_t minimum = (size_t)(MIN_PIECE * (double)tree->count) + LINKS + 1;
    uint32_t largest = 0;
    *left = 0;
    if (status == BAT_OK)
    {
        join_dense(&graph);
        largest = largest_of(&graph, UINT32_MAX);
        status = drop_scattered(&graph, largest, minimum, error);
    }
    if (status == BAT_OK)
    {
        join_large(&graph, minimum);
        largest = largest_of(&graph, UINT32_MAX);
        uint32_t second = largest_of(&graph, largest);
        if (second != largest && graph.sizes[second] >= minimum)
            status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                               "no boundary loop was found: the cloud has several pieces, one of %zu points and another of "
                               "%zu; a patch is one piece: fit each by itself",
                               graph.sizes[largest], graph.sizes[second]);
    }
    for (uint32_t i = 0; i < tree->count && status == BAT_OK; i++)
    {
        kept[i] = sets_root(graph.parent, i) == largest;
        *left += !kept[i];
    }
    if (status == BAT_OK && (double)*left > MIN_PEEL * (double)tree->count)
        status = peel(&graph, kept, left, error);
    memory_pool_free(&graph.pool);
    return status;
}
