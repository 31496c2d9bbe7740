/// @file
/// Orientation of tangent planes by Kruskal's algorithm with a signed union-find forest; see local_plane.h. Edges are sorted
/// into buckets by sqrt(1 - |n_i . n_k|).

#include "surface/cloud/local_plane.h"

#include "linalg/vector.h"

#include "base/error.h"
#include "base/threads.h"

#include <string.h>

enum
{
    LINKS = 10,    ///< neighbours of a point in the graph
    BUCKETS = 1024 ///< buckets of edge costs
};

static const int NEAR_LINKS = 5; ///< the nearest neighbours, which conflicts are counted of
/// Least cosine between planes that are nearly parallel.
static const double MIN_PARALLEL = 0.9;

/// Stands for no neighbour.
static const uint32_t NONE = UINT32_MAX;

void oriented_planes_free(oriented_planes *oriented)
{
    free(oriented->planes);
    free(oriented->reach);
    *oriented = (oriented_planes){0};
}

/// Compute the plane and the LINKS nearest neighbours of each point.
static bat_status fit_planes(const bat_cloud *cloud, const nearest_tree *tree, oriented_planes *oriented, uint32_t *links,
                             bat_error *error)
{
    bat_status status = BAT_OK;
#pragma omp parallel num_threads(threads_for(0, cloud->count / 256 + 1))
    {
        neighbour_list near = {0};
#pragma omp for schedule(dynamic, 256)
        for (size_t i = 0; i < cloud->count; i++)
        {
            bat_status own = neighbourhood_find(tree, cloud->points, cloud->points + 3 * i, NEIGHBOURHOOD_MIN, &near,
                                                &oriented->planes[i], NULL);
            size_t found = 0;
            for (size_t k = 0; own == BAT_OK && k < near.count && found < LINKS; k++)
                if (near.entries[k].item != i)
                    links[LINKS * i + found++] = near.entries[k].item;
            for (; found < LINKS; found++)
                links[LINKS * i + found] = NONE;
            oriented->reach[i] = near.count;
            if (own != BAT_OK)
#pragma omp atomic write
                status = own;
        }
        neighbour_list_free(&near);
    }
    return status == BAT_OK ? BAT_OK : error_set(error, status, BAT_NO_INDEX, 0, "out of memory for neighbourhoods");
}

/// Union-find forest. flips[i] tells whether the normal of i must be flipped to agree with that of parent[i].
typedef struct union_find
{
    uint32_t *parent;
    bool *flips;
} union_find;

/// Find the root of a point, and whether its normal must be flipped to agree with the root's.
static uint32_t find_root(const union_find *forest, uint32_t i, bool *flips)
{
    bool sum = false;
    while (forest->parent[i] != i)
    {
        uint32_t parent = forest->parent[i];
        // Path halving: the grandparent becomes the parent. Roots are not flipped.
        forest->flips[i] = forest->flips[i] != forest->flips[parent];
        forest->parent[i] = forest->parent[parent];
        sum = sum != forest->flips[i];
        i = forest->parent[i];
    }
    *flips = sum;
    return i;
}

static double normal_product(const oriented_planes *oriented, size_t i, size_t k)
{
    return vector3_dot(oriented->planes[i].axes[2], oriented->planes[k].axes[2]);
}

static size_t bucket_of(const oriented_planes *oriented, size_t i, size_t k)
{
    double sine = sqrt(fmax(1 - fabs(normal_product(oriented, i, k)), 0));
    return sine >= 1 ? BUCKETS - 1 : (size_t)(sine * BUCKETS);
}

/// Merge neighbours in the order of increasing cost.
static bat_status join(oriented_planes *oriented, size_t count, const uint32_t *links, union_find *forest, bat_error *error)
{
    size_t starts[BUCKETS + 1] = {0};
    size_t *edges = memory_array(count, LINKS * sizeof *edges);
    if (edges == NULL)
        return error_memory(error, count * LINKS * sizeof *edges);
    for (size_t e = 0; e < LINKS * count; e++)
        if (links[e] != NONE)
            starts[bucket_of(oriented, e / LINKS, links[e]) + 1]++;
    for (size_t b = 0; b < BUCKETS; b++)
        starts[b + 1] += starts[b];
    size_t total = starts[BUCKETS];
    for (size_t e = 0; e < LINKS * count; e++)
        if (links[e] != NONE)
            edges[starts[bucket_of(oriented, e / LINKS, links[e])]++] = e;
    for (size_t n = 0; n < total; n++)
    {
        size_t i = edges[n] / LINKS, k = links[edges[n]];
        bool flips_i, flips_k;
        uint32_t root_i = find_root(forest, (uint32_t)i, &flips_i), root_k = find_root(forest, (uint32_t)k, &flips_k);
        double product = normal_product(oriented, i, k);
        if (root_i == root_k)
        {
            bool agree = (flips_i != flips_k) == (product < 0);
            oriented->conflicts += !agree && fabs(product) >= MIN_PARALLEL && edges[n] % LINKS < NEAR_LINKS;
            continue;
        }
        forest->parent[root_k] = root_i;
        forest->flips[root_k] = (flips_i != flips_k) != (product < 0);
    }
    free(edges);
    return BAT_OK;
}

/// The vote of a boundary point: positive if its normal has the correct sign.
static double vote_of(const bat_cloud *cloud, const oriented_planes *oriented, const uint32_t *links, size_t i)
{
    size_t count = cloud->boundary_count;
    const double *points = cloud->points, *at = points + 3 * i;
    double along[3], inward[3] = {0}, up[3];
    vector3_subtract(points + 3 * ((i + 1) % count), points + 3 * ((i + count - 1) % count), along);
    for (size_t k = 0; k < LINKS && links[LINKS * i + k] != NONE; k++)
        for (size_t c = 0; c < 3; c++)
            inward[c] += points[3 * (size_t)links[LINKS * i + k] + c] - at[c];
    vector3_cross(along, inward, up);
    double length = sqrt(vector3_dot(up, up));
    return length > 0 ? vector3_dot(up, oriented->planes[i].axes[2]) / length : 0;
}

static void flip_planes(const bat_cloud *cloud, const uint32_t *links, const union_find *forest, double *votes,
                        oriented_planes *oriented)
{
    bool flips;
    memset(votes, 0, cloud->count * sizeof *votes);
    for (size_t i = 0; i < cloud->boundary_count; i++)
    {
        uint32_t root = find_root(forest, (uint32_t)i, &flips);
        double vote = vote_of(cloud, oriented, links, i);
        votes[root] += flips ? -vote : vote;
    }
    for (size_t i = 0; i < cloud->count; i++)
    {
        uint32_t root = find_root(forest, (uint32_t)i, &flips);
        local_plane *plane = &oriented->planes[i];
        for (size_t c = 0; c < 3 && flips != (votes[root] < 0); c++)
            plane->axes[2][c] = -plane->axes[2][c];
        vector3_cross(plane->axes[2], plane->axes[0], plane->axes[1]);
    }
}

bat_status oriented_planes_make(const bat_cloud *cloud, const nearest_tree *tree, oriented_planes *oriented,
                                bat_error *error)
{
    size_t count = cloud->count;
    *oriented = (oriented_planes){.planes = memory_array(count, sizeof *oriented->planes),
                                  .reach = memory_array(count, sizeof *oriented->reach)};
    memory_pool pool = {0};
    uint32_t *links = memory_pool_array(&pool, count, LINKS * sizeof *links);
    double *votes = memory_pool_array(&pool, count, sizeof *votes);
    union_find forest = {.parent = memory_pool_array(&pool, count, sizeof *forest.parent),
                         .flips = memory_pool_array(&pool, count, sizeof *forest.flips)};
    bat_status status = oriented->planes == NULL || oriented->reach == NULL
                            ? error_memory(error, count * sizeof *oriented->planes)
                            : memory_pool_check(&pool, error);
    if (status == BAT_OK)
        status = fit_planes(cloud, tree, oriented, links, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        forest.parent[i] = (uint32_t)i;
        forest.flips[i] = false;
    }
    if (status == BAT_OK)
        status = join(oriented, count, links, &forest, error);
    if (status == BAT_OK)
        flip_planes(cloud, links, &forest, votes, oriented);
    else
        oriented_planes_free(oriented);
    memory_pool_free(&pool);
    return status;
}
