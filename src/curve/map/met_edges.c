#include "curve/map/arc_refine.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "curve/polygon.h"

#include <stdlib.h>

static int compare_sizes(size_t a, size_t b)
{
    return (a > b) - (a < b);
}

static int compare_pairs(const void *a, const void *b)
{
    const met_pair *p = a, *q = b;
    for (int k = 0; k < 2; k++)
    {
        int order = compare_sizes(p->places[k].curve, q->places[k].curve);
        if (order == 0)
            order = compare_sizes(p->places[k].edge, q->places[k].edge);
        if (order != 0)
            return order;
    }
    return 0;
}

static bool note_pair(void *context, edge_place first, edge_place second)
{
    met_edges *met = context;
    return ARRAY_ADD(met->pairs, met->capacity, met->count, (met_pair){{first, second}}) &&
           ARRAY_ADD(met->pairs, met->capacity, met->count, (met_pair){{second, first}});
}

bat_status met_edges_find(const chart_curves *charts, const map_chart *chart, int threads, met_edges *met, bat_error *error)
{
    edge_tree tree;
    *met = (met_edges){0};
    bat_status status = edge_tree_make(charts->curves, charts->count, 0, threads, &tree, error);
    tree.turn = chart->turn;
    if (status == BAT_OK && !edge_tree_search(&tree, EDGE_PAIRS_ARCS, false, note_pair, met))
        status = error_memory(error, met->count * sizeof *met->pairs);
    edge_tree_free(&tree);
    if (met->count > 0)
        qsort(met->pairs, met->count, sizeof *met->pairs, compare_pairs);
    return status;
}

void met_edges_free(met_edges *met)
{
    free(met->pairs);
    *met = (met_edges){0};
}

bool met_edges_near(const met_edges *met, const bat_curve *arcs, edge_place first, edge_place second)
{
    if (met->count == 0)
        return false;
    size_t edges[2] = {polygon_edges(arcs[first.curve].count, arcs[first.curve].closed),
                       polygon_edges(arcs[second.curve].count, arcs[second.curve].closed)};
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
        {
            met_pair pair = {{{first.curve, (first.edge + i + edges[0] - 1) % edges[0]},
                              {second.curve, (second.edge + j + edges[1] - 1) % edges[1]}}};
            if (bsearch(&pair, met->pairs, met->count, sizeof pair, compare_pairs) != NULL)
                return true;
        }
    return false;
}
