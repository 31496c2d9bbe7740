#ifndef TESTS_SUPPORT_DECIMATE_HELPERS_H
#define TESTS_SUPPORT_DECIMATE_HELPERS_H

// Meshes to decimate, and their measurements.

#include "check.h"

#include "batten/mesh_decimate.h"

/// A mesh with allocated arrays; release it with bat_mesh_free().
static inline bat_mesh shape_room(size_t vertices, size_t faces)
{
    bat_mesh mesh = {.vertex_count = vertices, .face_count = faces};
    mesh.positions = malloc(vertices * 3 * sizeof(double));
    mesh.faces = malloc(faces * 3 * sizeof(uint32_t));
    assert_non_null(mesh.positions);
    assert_non_null(mesh.faces);
    return mesh;
}

/// Two faces for the cell of four vertices, counter-clockwise.
static inline void shape_cell(bat_mesh *mesh, size_t cell, size_t a, size_t b, size_t c, size_t d)
{
    const size_t corners[6] = {a, b, c, a, c, d};
    for (size_t k = 0; k < 6; k++)
        mesh->faces[6 * cell + k] = (uint32_t)corners[k];
}

/// A torus of `n` by `m` cells, radii 1 and `thickness`.
static inline bat_mesh shape_torus(size_t n, size_t m, double thickness)
{
    const double turn = 6.28318530717958647692;
    bat_mesh mesh = shape_room(n * m, 2 * n * m);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < m; j++)
        {
            double u = turn * (double)i / (double)n, v = turn * (double)j / (double)m;
            double *p = mesh.positions + 3 * (i * m + j);
            p[0] = (1 + thickness * cos(v)) * cos(u);
            p[1] = (1 + thickness * cos(v)) * sin(u);
            p[2] = thickness * sin(v);
            shape_cell(&mesh, i * m + j, i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m);
        }
    return mesh;
}

/// The vertex of a cube's surface grid at integer coordinates from 0 to n, numbered in order of use; `numbers` begins all
/// zero.
static inline uint32_t shape_cube_vertex(bat_mesh *mesh, uint32_t *numbers, size_t n, size_t x, size_t y, size_t z)
{
    uint32_t *number = &numbers[(x * (n + 1) + y) * (n + 1) + z];
    if (*number == 0)
    {
        double *p = mesh->positions + 3 * mesh->vertex_count;
        p[0] = (double)x / (double)n;
        p[1] = (double)y / (double)n;
        p[2] = (double)z / (double)n;
        *number = (uint32_t)++mesh->vertex_count;
    }
    return *number - 1;
}

/// The unit cube, each side a grid of n by n cells.
static inline bat_mesh shape_cube(size_t n)
{
    bat_mesh mesh = shape_room(6 * n * n + 2, 12 * n * n);
    uint32_t *numbers = calloc((n + 1) * (n + 1) * (n + 1), sizeof *numbers);
    assert_non_null(numbers);
    mesh.vertex_count = 0;
    size_t cell = 0;
    for (size_t side = 0; side < 6; side++)
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
            {
                uint32_t corner[4];
                for (size_t k = 0; k < 4; k++)
                {
                    size_t at[3], u = i + (k == 1 || k == 2), v = j + (k >= 2), axis = side / 2;
                    at[axis] = side % 2 == 0 ? 0 : n;
                    at[(axis + 1) % 3] = side % 2 == 0 ? v : u;
                    at[(axis + 2) % 3] = side % 2 == 0 ? u : v;
                    corner[k] = shape_cube_vertex(&mesh, numbers, n, at[0], at[1], at[2]);
                }
                shape_cell(&mesh, cell++, corner[0], corner[1], corner[2], corner[3]);
            }
    free(numbers);
    return mesh;
}

/// The unit sphere, from the grid of a cube; radii vary by `roughness`.
static inline bat_mesh shape_sphere(size_t n, double roughness, uint64_t seed)
{
    bat_mesh mesh = shape_cube(n);
    bat_random random = bat_random_seed(seed);
    for (size_t v = 0; v < mesh.vertex_count; v++)
    {
        double *p = mesh.positions + 3 * v, length = 0;
        for (int c = 0; c < 3; c++)
        {
            p[c] = tan((2 * p[c] - 1) * 0.78539816339744830962);
            length += p[c] * p[c];
        }
        double scale = (1 + roughness * (2 * bat_random_uniform(&random) - 1)) / sqrt(length);
        for (int c = 0; c < 3; c++)
            p[c] *= scale;
    }
    return mesh;
}

/// The unit square of n by n cells with heights `height` sin(3 x) cos(2 y), in a tilted plane; with `hole` the middle cells
/// are left out.
static inline bat_mesh shape_sheet(size_t n, double height, bool hole)
{
    bat_mesh mesh = shape_room((n + 1) * (n + 1), 2 * n * n);
    size_t cells = 0;
    for (size_t i = 0; i <= n; i++)
        for (size_t j = 0; j <= n; j++)
        {
            double x = (double)i / (double)n, y = (double)j / (double)n, z = height * sin(3 * x) * cos(2 * y);
            double *p = mesh.positions + 3 * (i * (n + 1) + j);
            p[0] = 0.6 * x - 0.8 * z;
            p[1] = y;
            p[2] = 0.8 * x + 0.6 * z;
            bool outside = i < n / 3 || i >= n - n / 3 || j < n / 3 || j >= n - n / 3;
            if (i < n && j < n && (!hole || outside))
                shape_cell(&mesh, cells++, i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1,
                           i * (n + 1) + j + 1);
        }
    mesh.face_count = 2 * cells;
    return mesh;
}

static inline const double *shape_corner(const bat_mesh *mesh, size_t face, size_t corner)
{
    return mesh->positions + 3 * (size_t)mesh->faces[3 * face + corner];
}

/// The normal of a face, with twice its area as length.
static inline void shape_vector(const bat_mesh *mesh, size_t face, double *vector)
{
    const double *a = shape_corner(mesh, face, 0), *b = shape_corner(mesh, face, 1), *c = shape_corner(mesh, face, 2);
    for (size_t k = 0; k < 3; k++)
    {
        size_t l = (k + 1) % 3, m = (k + 2) % 3;
        vector[k] = (b[l] - a[l]) * (c[m] - a[m]) - (b[m] - a[m]) * (c[l] - a[l]);
    }
}

static inline double shape_area(const bat_mesh *mesh)
{
    double area = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        double vector[3];
        shape_vector(mesh, f, vector);
        area += sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]) / 2;
    }
    return area;
}

static inline double shape_volume(const bat_mesh *mesh)
{
    double volume = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        double vector[3];
        shape_vector(mesh, f, vector);
        for (size_t k = 0; k < 3; k++)
            volume += vector[k] * shape_corner(mesh, f, 0)[k] / 6;
    }
    return volume;
}

/// Topological invariants of collapses.
typedef struct shape_topology
{
    long euler;
    size_t loops; ///< of the boundary
} shape_topology;

/// Fails for a mesh that is not a manifold.
static inline shape_topology shape_topology_of(const bat_mesh *mesh)
{
    bat_mesh_connectivity connectivity;
    bat_error error = {0};
    if (bat_mesh_connect(mesh, &connectivity, &error) != BAT_OK)
        fail_msg("%s", error.text);
    shape_topology topology = {-(long)connectivity.edge_count + (long)mesh->face_count, 0};
    for (size_t v = 0; v < mesh->vertex_count; v++)
        topology.euler += connectivity.first[v] != BAT_MESH_NONE;
    bool *seen = calloc(mesh->vertex_count, sizeof *seen);
    assert_non_null(seen);
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        uint32_t h = connectivity.first[v];
        if (h == BAT_MESH_NONE || connectivity.twin[h] != BAT_MESH_NONE || seen[v])
            continue;
        topology.loops++;
        for (size_t at = v; !seen[at]; at = mesh->faces[bat_mesh_next(connectivity.first[at])])
            seen[at] = true;
    }
    free(seen);
    bat_mesh_connectivity_free(&connectivity);
    return topology;
}

static inline void shape_point(const bat_mesh *mesh, const bat_mesh_point *point, double *position)
{
    for (size_t k = 0; k < 3; k++)
    {
        position[k] = 0;
        for (size_t c = 0; c < 3; c++)
            position[k] += point->barycentric[c] * shape_corner(mesh, point->face, c)[k];
    }
}

static inline double shape_distance(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

#endif
