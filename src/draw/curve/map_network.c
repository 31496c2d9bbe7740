#include "draw/curve/scene.h"

#include "base/array_grow.h"
#include "base/error.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// A hash table of the edges of a panel, and greedy colouring of the features that share edges.

/// An edge in the table; `layer` is BAT_NO_INDEX in an empty place.
typedef struct edge_place
{
    size_t layer, edge;
} edge_place;

/// Two features that share an edge, a < b, as indices into the sorted features.
typedef struct feature_pair
{
    size_t a, b;
} feature_pair;

typedef struct network_builder
{
    const bat_curve_picture_panel *panel;
    size_t point_dim;
    edge_place *table;
    size_t mask;
    size_t *features; ///< sorted, each once
    size_t feature_count;
    feature_pair *pairs;
    size_t pair_count, pair_capacity;
} network_builder;

static size_t edge_count(const bat_curve *curve)
{
    return curve->closed && curve->count > 1 ? curve->count : curve->count - 1;
}

/// The ends of an edge, the lower one first.
static void edge_ends(const network_builder *builder, edge_place place, const double **p, const double **q)
{
    const bat_curve *curve = builder->panel->layers[place.layer].curve;
    *p = curve->points + place.edge * builder->point_dim;
    *q = curve->points + (place.edge + 1 < curve->count ? place.edge + 1 : 0) * builder->point_dim;
    for (size_t k = 0; k < builder->point_dim; k++)
    {
        if ((*p)[k] != (*q)[k])
        {
            const double *first = *p;
            bool swap = (*p)[k] > (*q)[k];
            *p = swap ? *q : first;
            *q = swap ? first : *q;
            return;
        }
    }
}

/// Add a point to a hash (FNV-1a by words). -0 counts as 0.
static uint64_t hash_point(uint64_t hash, const double *point, size_t dim)
{
    for (size_t k = 0; k < dim; k++)
    {
        double number = point[k] + 0.0;
        uint64_t bits;
        memcpy(&bits, &number, sizeof bits);
        hash = (hash ^ bits) * 1099511628211u;
        hash ^= hash >> 29;
    }
    return hash;
}

/// Whether layers are drawn in one style.
static bool same_kind(const bat_curve_picture_layer *a, const bat_curve_picture_layer *b)
{
    return a->role == b->role && (a->polygon > 0) == (b->polygon > 0) && (a->polygon > 0 || a->colour == b->colour);
}

static bool same_point(const double *p, const double *q, size_t dim)
{
    for (size_t k = 0; k < dim; k++)
    {
        if (p[k] != q[k])
            return false;
    }
    return true;
}

/// The place of an edge in the table: that of an equal edge, or the empty one that it takes.
static edge_place *find_edge(const network_builder *builder, edge_place edge)
{
    const bat_curve_picture_layer *layer = &builder->panel->layers[edge.layer];
    const double *p;
    const double *q;
    edge_ends(builder, edge, &p, &q);
    uint64_t hash = 14695981039346656037u + (uint64_t)layer->role;
    hash = hash_point(hash_point(hash, p, builder->point_dim), q, builder->point_dim);
    size_t at = (size_t)(hash ^ hash >> 32) & builder->mask;
    for (; builder->table[at].layer != BAT_NO_INDEX; at = (at + 1) & builder->mask)
    {
        const double *other_p;
        const double *other_q;
        edge_ends(builder, builder->table[at], &other_p, &other_q);
        if (same_kind(layer, &builder->panel->layers[builder->table[at].layer]) &&
            same_point(p, other_p, builder->point_dim) && same_point(q, other_q, builder->point_dim))
            break;
    }
    return &builder->table[at];
}

static int compare_sizes(const void *a, const void *b)
{
    size_t p = *(const size_t *)a;
    size_t q = *(const size_t *)b;
    return (p > q) - (p < q);
}

static int compare_pairs(const void *a, const void *b)
{
    const feature_pair *p = a;
    const feature_pair *q = b;
    return p->b != q->b ? (p->b > q->b) - (p->b < q->b) : (p->a > q->a) - (p->a < q->a);
}

static size_t feature_index(const network_builder *builder, size_t layer)
{
    const size_t *found = bsearch(&builder->panel->layers[layer].feature, builder->features, builder->feature_count,
                                  sizeof *builder->features, compare_sizes);
    return (size_t)(found - builder->features);
}

static bool add_pair(network_builder *builder, size_t layer, size_t other)
{
    size_t a = feature_index(builder, layer);
    size_t b = feature_index(builder, other);
    feature_pair pair = {a < b ? a : b, a < b ? b : a};
    bool known = builder->pair_count > 0 && compare_pairs(&builder->pairs[builder->pair_count - 1], &pair) == 0;
    return a == b || known || ARRAY_ADD(builder->pairs, builder->pair_capacity, builder->pair_count, pair);
}

/// Enter all edges. False when out of memory.
static bool enter_edges(network_builder *builder, map_network *network)
{
    for (size_t layer = 0; layer < builder->panel->layer_count; layer++)
    {
        const bat_curve_picture_layer *own = &builder->panel->layers[layer];
        for (size_t edge = 0; edge < edge_count(own->curve); edge++)
        {
            edge_place *place = find_edge(builder, (edge_place){layer, edge});
            bool taken = place->layer != BAT_NO_INDEX;
            network->drawn[network->starts[layer] + edge] = taken ? 0 : 1;
            if (taken && own->polygon > 0 && !add_pair(builder, layer, place->layer))
                return false;
            if (!taken)
                *place = (edge_place){layer, edge};
        }
    }
    return true;
}

/// Give each feature the colour that the fewest features have, among those that its earlier neighbours lack.
static void colour_features(network_builder *builder, int *chosen)
{
    size_t used[MAP_COLOURS] = {0};
    size_t at = 0;
    if (builder->pair_count > 0)
        qsort(builder->pairs, builder->pair_count, sizeof *builder->pairs, compare_pairs);
    for (size_t i = 0; i < builder->feature_count; i++)
    {
        size_t beside[MAP_COLOURS] = {0};
        for (; at < builder->pair_count && builder->pairs[at].b == i; at++)
            beside[chosen[builder->pairs[at].a]]++;
        int best = 0;
        for (int c = 1; c < MAP_COLOURS; c++)
        {
            if (beside[c] < beside[best] || (beside[c] == beside[best] && used[c] < used[best]))
                best = c;
        }
        chosen[i] = best;
        used[best]++;
    }
}

/// Count the edges and collect the features.
static size_t collect(network_builder *builder, map_network *network)
{
    size_t edges = 0;
    const bat_curve_picture_panel *panel = builder->panel;
    for (size_t i = 0; i < panel->layer_count; i++)
    {
        network->starts[i] = edges;
        edges += edge_count(panel->layers[i].curve);
        if (panel->layers[i].polygon > 0)
            builder->features[builder->feature_count++] = panel->layers[i].feature;
    }
    network->starts[panel->layer_count] = edges;
    qsort(builder->features, builder->feature_count, sizeof *builder->features, compare_sizes);
    size_t kept = 0;
    for (size_t i = 0; i < builder->feature_count; i++)
    {
        if (kept == 0 || builder->features[kept - 1] != builder->features[i])
            builder->features[kept++] = builder->features[i];
    }
    builder->feature_count = kept;
    return edges;
}

static bool make_table(network_builder *builder, map_network *network, size_t edges)
{
    size_t size = 16;
    while (size < 2 * edges)
        size *= 2;
    builder->mask = size - 1;
    builder->table = memory_array(size, sizeof *builder->table);
    network->drawn = memory_array(edges + 1, 1);
    if (builder->table == NULL || network->drawn == NULL)
        return false;
    for (size_t i = 0; i < size; i++)
        builder->table[i].layer = BAT_NO_INDEX;
    return true;
}

bat_status map_network_make(const bat_curve_picture_panel *panel, map_network *network, bat_error *error)
{
    network_builder builder = {.panel = panel, .point_dim = panel->layers[0].curve->space->point_dim};
    bool polygons = false;
    for (size_t i = 0; i < panel->layer_count; i++)
        polygons = polygons || panel->layers[i].polygon > 0;
    *network = (map_network){0};
    if (!polygons)
        return BAT_OK;
    size_t edges = 0;
    network->starts = memory_array(panel->layer_count + 1, sizeof *network->starts);
    network->colours = calloc(panel->layer_count, sizeof *network->colours);
    builder.features = memory_array(panel->layer_count, sizeof *builder.features);
    int *chosen = memory_array(panel->layer_count, sizeof *chosen);
    bool made = network->starts != NULL && network->colours != NULL && builder.features != NULL && chosen != NULL;
    if (made)
        edges = collect(&builder, network);
    made = made && make_table(&builder, network, edges) && enter_edges(&builder, network);
    if (made)
    {
        colour_features(&builder, chosen);
        for (size_t i = 0; i < panel->layer_count; i++)
        {
            if (panel->layers[i].polygon > 0)
                network->colours[i] = chosen[feature_index(&builder, i)];
        }
    }
    else
    {
        map_network_free(network);
    }
    free(builder.table);
    free(builder.features);
    free(builder.pairs);
    free(chosen);
    return made ? BAT_OK : error_memory(error, edges * sizeof *builder.table);
}

void map_network_free(map_network *network)
{
    free(network->starts);
    free(network->drawn);
    free(network->colours);
    *network = (map_network){0};
}
