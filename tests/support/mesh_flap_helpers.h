#ifndef TESTS_SUPPORT_MESH_FLAP_HELPERS_H
#define TESTS_SUPPORT_MESH_FLAP_HELPERS_H

// Meshes for the networks, and the published network with its results, where these files exist.

#include "check.h"

#include "batten/mesh_refine.h"
#include "learn/safetensors.h"
#include "mesh/network/flap.h"

#define NEURAL_MESH SHARED_DATA "/oracle/neural-mesh/"

static inline void *test_memory(size_t count, size_t size)
{
    void *memory = calloc(count > 0 ? count : 1, size);
    assert_non_null(memory);
    return memory;
}

static inline bat_mesh_connectivity connected(const bat_mesh *mesh)
{
    bat_mesh_connectivity connectivity;
    check_status(bat_mesh_connect(mesh, &connectivity, NULL), BAT_OK);
    return connectivity;
}

static inline mesh_levels levels_of(const bat_mesh *mesh, size_t count)
{
    bat_mesh_connectivity connectivity = connected(mesh);
    mesh_levels levels;
    check_status(mesh_levels_make(mesh->faces, &connectivity, count, 2, &levels, NULL), BAT_OK);
    bat_mesh_connectivity_free(&connectivity);
    return levels;
}

/// Split every face in four at the midpoints of edges.
static inline bat_mesh split(const bat_mesh *mesh, size_t levels)
{
    bat_mesh fine;
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_MIDPOINT;
    options.levels = levels;
    check_status(bat_mesh_refine(mesh, &options, &fine, NULL, NULL), BAT_OK);
    return fine;
}

/// An octahedron with vertices moved by up to `jitter`, without its last `missing` faces.
static inline bat_mesh octahedron(size_t missing, double jitter, bat_random *random)
{
    static const double positions[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    static const uint32_t faces[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    bat_mesh mesh = {.positions = test_memory(18, sizeof(double)),
                     .faces = test_memory(24, sizeof(uint32_t)),
                     .vertex_count = 6,
                     .face_count = 8 - missing};
    memcpy(mesh.faces, faces, sizeof faces);
    for (size_t i = 0; i < 18; i++)
        mesh.positions[i] = positions[i] + jitter * (2 * bat_random_uniform(random) - 1);
    return mesh;
}

/// The unit sphere, 8 x 4^levels faces.
static inline bat_mesh ball(size_t levels)
{
    bat_random random = bat_random_seed(1);
    bat_mesh base = octahedron(0, 0, &random), mesh = split(&base, levels);
    for (size_t v = 0; v < mesh.vertex_count; v++)
    {
        double *p = mesh.positions + 3 * v, length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (size_t a = 0; a < 3; a++)
            p[a] /= length;
    }
    bat_mesh_free(&base);
    return mesh;
}

/// False, with a message, where the file does not exist.
static inline bool read_shared(const char *path, safetensors *content)
{
    if (safetensors_read(path, content, NULL) == BAT_OK)
        return true;
    print_message("skipped: there is no %s\n", path);
    return false;
}

static inline bat_mesh mesh_in(const safetensors *content, const char *positions, const char *faces)
{
    const safetensors_array *p = safetensors_find(content, positions), *f = safetensors_find(content, faces);
    assert_non_null(p);
    assert_non_null(f);
    bat_mesh mesh = {.positions = test_memory(p->count, sizeof(double)),
                     .faces = test_memory(f->count, sizeof(uint32_t)),
                     .vertex_count = p->shape[0],
                     .face_count = f->shape[0]};
    int64_t *indices = test_memory(f->count, sizeof *indices);
    check_status(safetensors_doubles(content, positions, p->count, mesh.positions, NULL), BAT_OK);
    check_status(safetensors_integers(content, faces, f->count, indices, NULL), BAT_OK);
    for (size_t i = 0; i < f->count; i++)
        mesh.faces[i] = (uint32_t)indices[i];
    free(indices);
    return mesh;
}

/// Match vertices by position, one to one; `match` receives the vertex of `actual` for every vertex of `expected`.
static inline void match_vertices(const double *actual, const double *expected, size_t count, double tolerance,
                                  uint32_t *match)
{
    bool *taken = test_memory(count, sizeof *taken);
    for (size_t e = 0; e < count; e++)
    {
        double least = INFINITY;
        for (size_t a = 0; a < count; a++)
        {
            double squares = 0;
            for (size_t k = 0; k < 3; k++)
                squares += (actual[3 * a + k] - expected[3 * e + k]) * (actual[3 * a + k] - expected[3 * e + k]);
            if (squares < least)
            {
                least = squares;
                match[e] = (uint32_t)a;
            }
        }
        check_near(sqrt(least), 0, tolerance);
        assert_false(taken[match[e]]);
        taken[match[e]] = true;
    }
    free(taken);
}

static inline int compare_faces(const void *a, const void *b)
{
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

/// Rotate every face to its smallest vertex, and sort the faces.
static inline void sort_faces(uint32_t *faces, size_t count)
{
    for (uint32_t *f = faces; f < faces + 3 * count; f += 3)
        while (f[0] > f[1] || f[0] > f[2])
        {
            uint32_t first = f[0];
            f[0] = f[1];
            f[1] = f[2];
            f[2] = first;
        }
    qsort(faces, count, 3 * sizeof *faces, compare_faces);
}

/// The same mesh for any order of vertices and faces.
static inline void check_same_mesh(const bat_mesh *actual, const bat_mesh *expected, double tolerance)
{
    assert_int_equal(actual->vertex_count, expected->vertex_count);
    assert_int_equal(actual->face_count, expected->face_count);
    size_t count = 3 * expected->face_count;
    uint32_t *match = test_memory(expected->vertex_count, sizeof *match);
    uint32_t *mine = test_memory(count, sizeof *mine), *theirs = test_memory(count, sizeof *theirs);
    match_vertices(actual->positions, expected->positions, expected->vertex_count, tolerance, match);
    for (size_t i = 0; i < count; i++)
    {
        mine[i] = actual->faces[i];
        theirs[i] = match[expected->faces[i]];
    }
    sort_faces(mine, expected->face_count);
    sort_faces(theirs, expected->face_count);
    assert_memory_equal(mine, theirs, count * sizeof *mine);
    free(match);
    free(mine);
    free(theirs);
}

#endif
