#include "batten/mesh_measure.h"

#include "base/error.h"
#include "base/threads.h"
#include "mesh/check.h"
#include "mesh/measure/closest.h"

#include <float.h>
#include <math.h>

/// @file
/// Closest points and distances for many points, in blocks on several threads.

enum
{
    /// Points of a block. Each block starts its search anew, so results do not depend on the number of threads.
    BLOCK = 1024
};

static bat_status check_points(const double *points, size_t count, const char *what, bat_error *error)
{
    for (size_t i = 0; i < 3 * count; i++)
        if (!(fabs(points[i]) <= DBL_MAX / 4))
            return error_set(error, BAT_INVALID_POINT, i / 3, 0, "%s %zu is not finite or too far from the origin", what,
                             i / 3);
    return BAT_OK;
}

/// Check the mesh and the points, and build a tree for queries with these points.
static bat_status tree_for(const bat_mesh *mesh, const double *points, size_t count, const char *what, closest_tree *tree,
                           bat_error *error)
{
    bat_status status = mesh_check_triangles(mesh, error);
    if (status == BAT_OK)
        status = check_points(mesh->positions, mesh->vertex_count, "vertex", error);
    if (status == BAT_OK)
        status = check_points(points, count, what, error);
    if (status != BAT_OK)
        return status;
    double largest = closest_largest(mesh->positions, 3 * mesh->vertex_count, 0);
    return closest_build(mesh, closest_largest(points, 3 * count, largest), tree, error);
}

/// Find the closest points, or only their distances where `closest` is null.
static void find_block(const closest_tree *tree, const double *points, size_t count, bat_mesh_closest_point *closest,
                       double *distances)
{
    uint32_t place = 0;
    for (size_t i = 0; i < count; i++)
    {
        double distance = closest_find(tree, points + 3 * i, &place);
        if (closest == NULL)
        {
            distances[i] = distance;
            continue;
        }
        closest_hit hit = closest_point_at(tree, points + 3 * i, place);
        closest[i] = (bat_mesh_closest_point){.at = {.face = hit.face}, .distance = hit.distance};
        for (int k = 0; k < 3; k++)
        {
            closest[i].at.barycentric[k] = hit.barycentric[k];
            closest[i].position[k] = hit.point[k];
        }
    }
}

/// Find the closest points or the distances of all points, which messages call `what`.
static bat_status find_all(const bat_mesh *mesh, const double *points, size_t count, const char *what, int threads,
                           bat_mesh_closest_point *closest, double *distances, bat_error *error)
{
    closest_tree tree;
    bat_status status = tree_for(mesh, points, count, what, &tree, error);
    if (status != BAT_OK)
        return status;
    size_t blocks = count / BLOCK + (count % BLOCK > 0);
    threads = threads_for(threads, blocks);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t block = 0; block < blocks; block++)
    {
        size_t begin = block * BLOCK, size = count - begin < BLOCK ? count - begin : BLOCK;
        find_block(&tree, points + 3 * begin, size, closest != NULL ? closest + begin : NULL,
                   distances != NULL ? distances + begin : NULL);
    }
    closest_free(&tree);
    return BAT_OK;
}

bat_status bat_mesh_closest(const bat_mesh *mesh, const double *points, size_t count, int threads,
                            bat_mesh_closest_point *closest, bat_error *error)
{
    return find_all(mesh, points, count, "point", threads, closest, NULL, error);
}

bat_status bat_mesh_vertex_distances(const bat_mesh *from, const bat_mesh *onto, int threads, double *distances,
                                     bat_error *error)
{
    return find_all(onto, from->positions, from->vertex_count, "vertex", threads, NULL, distances, error);
}
