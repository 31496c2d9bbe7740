// Closest points of a mesh: construction of the tree relative to sorting the faces, queries relative to a search without
// detours, and a comparison of two meshes relative to its queries. All on one thread.

#include "timing.h"

#include "batten/mesh_measure.h"
#include "mesh/measure/closest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    QUERIES = 200000,
    ROUNDS = 5
};

static const double TURN = 6.28318530717958647693;

/// Put the faces in a random order.
static void shuffle_faces(bat_mesh *mesh)
{
    bat_random random = bat_random_seed(4);
    for (size_t f = mesh->face_count - 1; f > 0; f--)
    {
        size_t other = (size_t)(bat_random_uniform(&random) * (double)(f + 1));
        for (size_t c = 0; c < 3; c++)
        {
            uint32_t kept = mesh->faces[3 * f + c];
            mesh->faces[3 * f + c] = mesh->faces[3 * other + c];
            mesh->faces[3 * other + c] = kept;
        }
    }
}

/// A wavy, slightly rough torus of 2 n^2 faces; `size` is about the radius of its tube.
static bool make_torus(uint32_t n, double size, bat_mesh *mesh)
{
    bat_random random = bat_random_seed(3);
    *mesh = (bat_mesh){.positions = malloc((size_t)n * n * 3 * sizeof(double)),
                       .faces = malloc((size_t)n * n * 6 * sizeof(uint32_t)),
                       .vertex_count = (size_t)n * n,
                       .face_count = (size_t)2 * n * n};
    if (mesh->positions == NULL || mesh->faces == NULL)
        return false;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
        {
            double a = TURN * i / n, b = TURN * j / n, *at = mesh->positions + 3 * ((size_t)i * n + j);
            double r = size + 0.02 * sin(7 * a) * cos(5 * b) + 0.05 / n * bat_random_normal(&random);
            at[0] = (1 + r * cos(b)) * cos(a);
            at[1] = (1 + r * cos(b)) * sin(a);
            at[2] = r * sin(b);
            uint32_t *face = mesh->faces + 6 * ((size_t)i * n + j), i1 = (i + 1) % n, j1 = (j + 1) % n;
            face[0] = face[3] = i * n + j;
            face[1] = i1 * n + j;
            face[2] = face[4] = i1 * n + j1;
            face[5] = i * n + j1;
        }
    shuffle_faces(mesh);
    return true;
}

/// The positions of queries: along a path near the surface, random near it, random within half the radius.
typedef enum query_kind
{
    QUERY_PATH,
    QUERY_NEAR,
    QUERY_FAR,
    QUERY_KINDS
} query_kind;

static void make_queries(query_kind kind, double *points)
{
    bat_random random = bat_random_seed(5);
    for (int i = 0; i < QUERIES; i++)
    {
        double u = bat_random_uniform(&random), v = bat_random_uniform(&random);
        double a = TURN * (kind == QUERY_PATH ? (double)i / QUERIES : u);
        double b = TURN * (kind == QUERY_PATH ? fmod(200.0 * i / QUERIES, 1) : v);
        double r = 0.402 + (kind == QUERY_FAR ? 0.2 * bat_random_uniform(&random) : 0);
        points[3 * i] = (1 + r * cos(b)) * cos(a);
        points[3 * i + 1] = (1 + r * cos(b)) * sin(a);
        points[3 * i + 2] = r * sin(b);
    }
}

static double seconds_for_queries(const closest_tree *tree, const double *points, double *sum)
{
    uint32_t place = 0;
    double start = seconds_now();
    for (int i = 0; i < QUERIES; i++)
        *sum += closest_find(tree, points + 3 * i, &place);
    return seconds_now() - start;
}

/// Sort the faces by the x coordinate of their first corner.
static double seconds_for_sorting(const bat_mesh *mesh)
{
    // The key comes first: compare_doubles() takes an entry for its key.
    struct
    {
        double key;
        size_t face;
    } *entries = malloc(mesh->face_count * sizeof *entries);
    if (entries == NULL)
        return NAN;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        entries[f].key = mesh->positions[3 * (size_t)mesh->faces[3 * f]];
        entries[f].face = f;
    }
    double start = seconds_now();
    qsort(entries, mesh->face_count, sizeof *entries, compare_doubles);
    double spent = seconds_now() - start;
    free(entries);
    return spent;
}

static bool bench_building(const bat_mesh *mesh)
{
    double times[ROUNDS], sorting[ROUNDS];
    for (int round = 0; round < ROUNDS; round++)
    {
        closest_tree tree;
        double start = seconds_now();
        if (closest_build(mesh, 2, &tree, NULL) != BAT_OK)
            return false;
        times[round] = seconds_now() - start;
        sorting[round] = seconds_for_sorting(mesh);
        closest_free(&tree);
    }
    double time = median_of(times, ROUNDS), sort = median_of(sorting, ROUNDS);
    (void)printf("%zu faces: tree in %.1f ms, %.2f of the time of qsort() on the faces\n", mesh->face_count, 1e3 * time,
                 time / sort);
    return true;
}

/// A search without detours opens one node of each level and one packet. Its time is that of a search among eight faces,
/// times the levels.
static bool bench_queries(const bat_mesh *mesh, double *points)
{
    static const char *const NAMES[QUERY_KINDS] = {"along a path", "here and there", "here and there, farther out"};
    bat_mesh eight = *mesh;
    eight.face_count = 8;
    closest_tree tree, small;
    if (closest_build(mesh, 2, &tree, NULL) != BAT_OK || closest_build(&eight, 2, &small, NULL) != BAT_OK)
        return false;
    double sum = 0;
    for (int kind = 0; kind < QUERY_KINDS; kind++)
    {
        double times[ROUNDS], bounds[ROUNDS];
        make_queries((query_kind)kind, points);
        for (int round = 0; round < ROUNDS; round++)
        {
            times[round] = seconds_for_queries(&tree, points, &sum);
            bounds[round] = tree.root_level * seconds_for_queries(&small, points, &sum);
        }
        double time = median_of(times, ROUNDS), bound = median_of(bounds, ROUNDS);
        (void)printf("%zu faces, queries %s: %.2f million a second, %.2f of the rate of a search that never goes astray\n",
                     mesh->face_count, NAMES[kind], QUERIES / time * 1e-6, bound / time);
    }
    closest_free(&tree);
    closest_free(&small);
    return sum > 0;
}

static bool bench_comparison(const bat_mesh *first, const bat_mesh *second, double *points)
{
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    options.threads = 1;
    double times[ROUNDS], bounds[ROUNDS], sum = 0;
    closest_tree tree;
    if (closest_build(second, 2, &tree, NULL) != BAT_OK)
        return false;
    make_queries(QUERY_PATH, points);
    for (int round = 0; round < ROUNDS; round++)
    {
        bat_mesh_distance distance;
        double start = seconds_now();
        if (bat_mesh_compare(first, second, &options, &distance, NULL) != BAT_OK)
            return false;
        times[round] = seconds_now() - start;
        bounds[round] = seconds_for_queries(&tree, points, &sum) / QUERIES * 2 * (double)options.samples;
    }
    double time = median_of(times, ROUNDS);
    (void)printf("%zu faces compared with %zu: %.0f ms on one thread, %.2f times that of as many queries along a path as "
                 "there are samples\n",
                 first->face_count, second->face_count, 1e3 * time, time / median_of(bounds, ROUNDS));
    closest_free(&tree);
    return true;
}

int main(void)
{
    bat_mesh coarse = {0}, fine = {0};
    double *points = malloc(sizeof *points * 3 * QUERIES);
    bool done = points != NULL && make_torus(84, 0.41, &coarse) && make_torus(224, 0.4, &fine) && bench_building(&coarse) &&
                bench_building(&fine) && bench_queries(&coarse, points) && bench_queries(&fine, points) &&
                bench_comparison(&coarse, &fine, points);
    bat_mesh_free(&coarse);
    bat_mesh_free(&fine);
    free(points);
    return done ? 0 : 1;
}
