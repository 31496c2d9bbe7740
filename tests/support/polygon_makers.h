#ifndef TESTS_SUPPORT_POLYGON_MAKERS_H
#define TESTS_SUPPORT_POLYGON_MAKERS_H

// Polygon meshes for tests and benchmarks; release them with bat_mesh_free(). Also for C++.

#include "mesh_makers.h"

/// A mesh with allocated positions and corners; the offsets are those of faces of `sides` corners each.
static inline bat_mesh polygon_with_room(size_t vertices, size_t faces, size_t corners, uint32_t sides)
{
    bat_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertex_count = vertices;
    mesh.face_count = faces;
    mesh.positions = (double *)mesh_room(vertices, 3 * sizeof *mesh.positions);
    mesh.offsets = (uint32_t *)mesh_room(faces + 1, sizeof *mesh.offsets);
    mesh.faces = (uint32_t *)mesh_room(corners, sizeof *mesh.faces);
    for (size_t f = 0; f <= faces; f++)
        mesh.offsets[f] = (uint32_t)f * sides;
    return mesh;
}

static inline bat_mesh polygon_cube(void)
{
    static const uint32_t corners[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    bat_mesh mesh = polygon_with_room(8, 6, 24, 4);
    for (size_t v = 0; v < 8; v++)
        for (size_t i = 0; i < 3; i++)
            mesh.positions[3 * v + i] = v >> i & 1 ? 1 : -1;
    memcpy(mesh.faces, corners, sizeof corners);
    return mesh;
}

/// An open grid of quads with `columns` by `rows` vertices, in the plane.
static inline bat_mesh polygon_grid(uint32_t columns, uint32_t rows)
{
    size_t faces = (size_t)(columns - 1) * (rows - 1);
    bat_mesh mesh = polygon_with_room((size_t)columns * rows, faces, 4 * faces, 4);
    for (size_t v = 0; v < mesh.vertex_count; v++)
    {
        mesh.positions[3 * v] = (double)(v % columns);
        mesh.positions[3 * v + 1] = (double)(v / columns);
    }
    uint32_t *corner = mesh.faces;
    for (uint32_t j = 0; j + 1 < rows; j++)
        for (uint32_t i = 0; i + 1 < columns; i++)
        {
            uint32_t v = j * columns + i;
            *corner++ = v;
            *corner++ = v + 1;
            *corner++ = v + columns + 1;
            *corner++ = v + columns;
        }
    return mesh;
}

/// A closed torus of quads: all vertices are regular.
static inline bat_mesh polygon_torus(uint32_t around, uint32_t across)
{
    size_t count = (size_t)around * across;
    bat_mesh mesh = polygon_with_room(count, count, 4 * count, 4);
    uint32_t *corner = mesh.faces;
    for (uint32_t i = 0; i < around; i++)
        for (uint32_t j = 0; j < across; j++)
        {
            double u = 6.283185307179586 * i / around, v = 6.283185307179586 * j / across, r = 3 + cos(v);
            double *p = mesh.positions + 3 * ((size_t)i * across + j);
            uint32_t ni = (i + 1) % around, nj = (j + 1) % across;
            p[0] = r * cos(u);
            p[1] = r * sin(u);
            p[2] = sin(v);
            *corner++ = i * across + j;
            *corner++ = ni * across + j;
            *corner++ = ni * across + nj;
            *corner++ = i * across + nj;
        }
    return mesh;
}

/// Whether two faces of a triangle mesh can become one: they share one edge, and the four vertices differ.
static inline bool polygon_can_merge(const bat_mesh *mesh, uint32_t h, uint32_t twin)
{
    return mesh->faces[bat_mesh_previous(h)] != mesh->faces[bat_mesh_previous(twin)];
}

/// A mesh of triangles and quads, reproducibly: pairs of triangles of a mesh joined, by chance.
static inline bat_mesh polygon_mixed(const bat_mesh *from, double share, uint64_t seed)
{
    bat_mesh_connectivity links;
    if (bat_mesh_connect(from, &links, NULL) != BAT_OK)
        abort();
    bat_random random = bat_random_seed(seed);
    bat_mesh mesh = polygon_with_room(from->vertex_count, from->face_count, 3 * from->face_count, 3);
    memcpy(mesh.positions, from->positions, 3 * from->vertex_count * sizeof *from->positions);
    bool *used = (bool *)mesh_room(from->face_count, sizeof *used);
    uint32_t *corner = mesh.faces;
    mesh.face_count = 0;
    for (uint32_t f = 0; f < from->face_count; f++)
    {
        if (used[f])
            continue;
        uint32_t h = 3 * f + (uint32_t)(3 * bat_random_uniform(&random)), twin = links.twin[h];
        used[f] = true;
        *corner++ = from->faces[h];
        if (twin != BAT_MESH_NONE && !used[twin / 3] && bat_random_uniform(&random) < share &&
            polygon_can_merge(from, h, twin))
        {
            used[twin / 3] = true;
            *corner++ = from->faces[bat_mesh_previous(twin)];
        }
        *corner++ = from->faces[bat_mesh_next(h)];
        *corner++ = from->faces[bat_mesh_previous(h)];
        mesh.offsets[++mesh.face_count] = (uint32_t)(corner - mesh.faces);
    }
    free(used);
    bat_mesh_connectivity_free(&links);
    return mesh;
}

#endif
