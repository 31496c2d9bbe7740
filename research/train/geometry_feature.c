#include "research/train/geometry_feature.h"

static const double INVERSE_PI = 0.31830988618379067154;

/// The position of a stencil's entry among `count` items: index `first` - before, modulo `count` on a closed polygon.
/// @return false beyond the ends of an open one
static bool find_item(size_t first, size_t before, size_t count, bool closed, size_t *item)
{
    if (closed)
    {
        *item = (first + count - before % count) % count;
        return true;
    }
    *item = first - before;
    return first >= before && first - before < count;
}

static size_t next_edge(const geometry_polygon *polygon, size_t edge)
{
    return edge + 1 < geometry_edges(polygon) ? edge + 1 : polygon->closed ? 0 : edge;
}

void geometry_published_features(const geometry_polygon *polygon, geometry_profile profile, double *features, size_t stride)
{
    size_t edges = geometry_edges(polygon);
    double inverse_mean = 1 / geometry_mean_length(polygon, profile);
    for (size_t j = 0; j < edges; j++, features += stride)
    {
        for (size_t i = 0; i < 4; i++)
        {
            size_t vertex;
            bool exists = find_item(j + i, 1, polygon->count, polygon->closed, &vertex);
            features[i] = exists ? profile.angles[vertex] * INVERSE_PI : 0;
        }
        features[4] = profile.lengths[j] * inverse_mean;
        features[5] = profile.lengths[next_edge(polygon, j)] * inverse_mean;
        features[6] = (double)polygon->surface;
    }
}

void geometry_published_features_back(const geometry_polygon *polygon, geometry_profile profile,
                                      const double *feature_gradients, size_t stride, geometry_profile gradient)
{
    size_t edges = geometry_edges(polygon);
    double inverse_mean = 1 / geometry_mean_length(polygon, profile), sum = 0;
    const double *row = feature_gradients;
    for (size_t j = 0; j < edges; j++, row += stride)
    {
        for (size_t i = 0; i < 4; i++)
        {
            size_t vertex;
            if (find_item(j + i, 1, polygon->count, polygon->closed, &vertex))
                gradient.angles[vertex] += row[i] * INVERSE_PI;
        }
        size_t next = next_edge(polygon, j);
        gradient.lengths[j] += row[4] * inverse_mean;
        gradient.lengths[next] += row[5] * inverse_mean;
        sum += row[4] * profile.lengths[j] + row[5] * profile.lengths[next];
    }
    geometry_mean_length_back(polygon, -sum * inverse_mean * inverse_mean, gradient);
}

/// Mean length of the edges in the stencil of an edge, and their number.
static double stencil_mean(const geometry_polygon *polygon, geometry_profile profile, geometry_stencil stencil, size_t edge,
                           size_t *count)
{
    double sum = 0;
    *count = 0;
    for (size_t i = 0; i < 2 * stencil.length_reach + 1; i++)
    {
        size_t item;
        if (!find_item(edge + i, stencil.length_reach, geometry_edges(polygon), polygon->closed, &item))
            continue;
        sum += profile.lengths[item];
        ++*count;
    }
    return sum / (double)*count;
}

void geometry_stencil_features(const geometry_polygon *polygon, geometry_profile profile, geometry_stencil stencil,
                               double *features, size_t stride)
{
    size_t edges = geometry_edges(polygon), angles = 2 * stencil.angle_reach, lengths = 2 * stencil.length_reach + 1;
    for (size_t j = 0; j < edges; j++, features += stride)
    {
        size_t item, count;
        // The first angle of edge j lies at vertex j + 1 - angle_reach.
        for (size_t i = 0; i < angles; i++)
            features[i] = find_item(j + 1 + i, stencil.angle_reach, polygon->count, polygon->closed, &item)
                              ? profile.angles[item] * INVERSE_PI
                              : 0;
        double inverse = 1 / stencil_mean(polygon, profile, stencil, j, &count);
        for (size_t i = 0; i < lengths; i++)
            features[angles + i] =
                find_item(j + i, stencil.length_reach, edges, polygon->closed, &item) ? profile.lengths[item] * inverse : 0;
    }
}

void geometry_stencil_features_back(const geometry_polygon *polygon, geometry_profile profile, geometry_stencil stencil,
                                    const double *feature_gradients, size_t stride, geometry_profile gradient)
{
    size_t edges = geometry_edges(polygon), angles = 2 * stencil.angle_reach, lengths = 2 * stencil.length_reach + 1;
    const double *row = feature_gradients;
    for (size_t j = 0; j < edges; j++, row += stride)
    {
        size_t item, count;
        for (size_t i = 0; i < angles; i++)
            if (find_item(j + 1 + i, stencil.angle_reach, polygon->count, polygon->closed, &item))
                gradient.angles[item] += row[i] * INVERSE_PI;
        double inverse = 1 / stencil_mean(polygon, profile, stencil, j, &count), sum = 0;
        for (size_t i = 0; i < lengths; i++)
            if (find_item(j + i, stencil.length_reach, edges, polygon->closed, &item))
                sum += row[angles + i] * profile.lengths[item];
        double mean_gradient = -sum * inverse * inverse / (double)count;
        for (size_t i = 0; i < lengths; i++)
            if (find_item(j + i, stencil.length_reach, edges, polygon->closed, &item))
                gradient.lengths[item] += row[angles + i] * inverse + mean_gradient;
    }
}
