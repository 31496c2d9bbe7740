#ifndef TESTS_SUPPORT_MESH_MAKERS_H
#define TESTS_SUPPORT_MESH_MAKERS_H

// Meshes for tests and benchmarks; release them with bat_mesh_free(). Also for C++.

#include "batten/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// An array of zeros; exits when out of memory.
static inline void *mesh_room(size_t count, size_t size)
{
    void *room = calloc(count > 0 ? count : 1, size);
    if (room == NULL)
        abort();
    return room;
}

/// A mesh with allocated positions and faces.
static inline bat_mesh mesh_with_room(size_t vertices, size_t faces)
{
    bat_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertex_count = vertices;
    mesh.face_count = faces;
    mesh.positions = (double *)mesh_room(vertices, 3 * sizeof *mesh.positions);
    mesh.faces = (uint32_t *)mesh_room(faces, 3 * sizeof *mesh.faces);
    return mesh;
}

static inline void mesh_set_vertex(bat_mesh *mesh, size_t vertex, double x, double y, double z)
{
    double *p = mesh->positions + 3 * vertex;
    p[0] = x;
    p[1] = y;
    p[2] = z;
}

static inline void mesh_set_face(bat_mesh *mesh, size_t face, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *corner = mesh->faces + 3 * face;
    corner[0] = a;
    corner[1] = b;
    corner[2] = c;
}

static inline bat_mesh mesh_tetrahedron(void)
{
    bat_mesh mesh = mesh_with_room(4, 4);
    mesh_set_vertex(&mesh, 0, 1, 1, 1);
    mesh_set_vertex(&mesh, 1, -1, -1, 1);
    mesh_set_vertex(&mesh, 2, -1, 1, -1);
    mesh_set_vertex(&mesh, 3, 1, -1, -1);
    mesh_set_face(&mesh, 0, 0, 2, 1);
    mesh_set_face(&mesh, 1, 0, 1, 3);
    mesh_set_face(&mesh, 2, 0, 3, 2);
    mesh_set_face(&mesh, 3, 1, 2, 3);
    return mesh;
}

static inline bat_mesh mesh_octahedron(void)
{
    bat_mesh mesh = mesh_with_room(6, 8);
    for (size_t i = 0; i < 6; i++)
        mesh.positions[3 * i + i / 2] = i % 2 == 0 ? 1 : -1;
    for (uint32_t f = 0; f < 8; f++)
    {
        uint32_t x = f & 1, y = 2 + (f >> 1 & 1), z = 4 + (f >> 2 & 1);
        bool even = ((f & 1) + (f >> 1 & 1) + (f >> 2 & 1)) % 2 == 0;
        mesh_set_face(&mesh, f, x, even ? y : z, even ? z : y);
    }
    return mesh;
}

static inline bat_mesh mesh_icosahedron(void)
{
    const double golden = 1.6180339887498949;
    static const uint32_t corners[60] = {0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                                         4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                                         6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
    bat_mesh mesh = mesh_with_room(12, 20);
    for (size_t i = 0; i < 12; i++)
    {
        size_t axis = i / 4;
        double small = i % 2 == 0 ? -1 : 1, large = i % 4 < 2 ? golden : -golden;
        double *p = mesh.positions + 3 * i;
        p[axis] = small;
        p[(axis + 1) % 3] = large;
    }
    memcpy(mesh.faces, corners, sizeof corners);
    return mesh;
}

/// A closed torus of `around` by `across` quadrangles, each cut in two: all vertices are regular.
static inline bat_mesh mesh_torus(uint32_t around, uint32_t across)
{
    bat_mesh mesh = mesh_with_room((size_t)around * across, 2 * (size_t)around * across);
    size_t face = 0;
    for (uint32_t i = 0; i < around; i++)
        for (uint32_t j = 0; j < across; j++)
        {
            double u = 6.283185307179586 * i / around, v = 6.283185307179586 * j / across, r = 3 + cos(v);
            uint32_t ni = (i + 1) % around, nj = (j + 1) % across;
            mesh_set_vertex(&mesh, (size_t)i * across + j, r * cos(u), r * sin(u), sin(v));
            mesh_set_face(&mesh, face++, i * across + j, ni * across + j, ni * across + nj);
            mesh_set_face(&mesh, face++, i * across + j, ni * across + nj, i * across + nj);
        }
    return mesh;
}

/// An open grid of `columns` by `rows` vertices of the triangular lattice of side 1, in the plane: inner vertices are
/// regular.
static inline bat_mesh mesh_grid(uint32_t columns, uint32_t rows)
{
    bat_mesh mesh = mesh_with_room((size_t)columns * rows, 2 * (size_t)(columns - 1) * (rows - 1));
    size_t face = 0;
    for (uint32_t j = 0; j < rows; j++)
        for (uint32_t i = 0; i < columns; i++)
            mesh_set_vertex(&mesh, (size_t)j * columns + i, i + 0.5 * j, sqrt(0.75) * j, 0);
    for (uint32_t j = 0; j + 1 < rows; j++)
        for (uint32_t i = 0; i + 1 < columns; i++)
        {
            uint32_t corner = j * columns + i;
            mesh_set_face(&mesh, face++, corner, corner + 1, corner + columns);
            mesh_set_face(&mesh, face++, corner + 1, corner + columns + 1, corner + columns);
        }
    return mesh;
}

/// A flat fan of `faces` faces around vertex 0: a disk, or half a disk when open.
static inline bat_mesh mesh_fan(uint32_t faces, bool closed)
{
    uint32_t rim = closed ? faces : faces + 1;
    bat_mesh mesh = mesh_with_room(1 + rim, faces);
    for (uint32_t i = 0; i < rim; i++)
    {
        double angle = (closed ? 6.283185307179586 : 3.141592653589793) * i / faces;
        mesh_set_vertex(&mesh, 1 + i, cos(angle), sin(angle), 0);
    }
    for (uint32_t i = 0; i < faces; i++)
        mesh_set_face(&mesh, i, 0, 1 + i, 1 + (i + 1) % rim);
    return mesh;
}

/// Move all coordinates by up to `size`, reproducibly.
static inline void mesh_shake(bat_mesh *mesh, double size, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->positions[i] += size * (2 * bat_random_uniform(&random) - 1);
}

/// Flip an edge. False, with the mesh unchanged, where the flipped edge exists already or a vertex would have fewer than 3
/// or more than 12 faces.
static inline bool mesh_turn_edge(bat_mesh *mesh, const bat_mesh_connectivity *links, unsigned *valence, uint32_t h)
{
    uint32_t t = links->twin[h];
    if (t == BAT_MESH_NONE)
        return false;
    uint32_t a = mesh->faces[h], b = mesh->faces[t], c = mesh->faces[bat_mesh_previous(h)],
             d = mesh->faces[bat_mesh_previous(t)];
    uint32_t around = links->first[c], first = around;
    do
    {
        if (mesh->faces[bat_mesh_next(around)] == d || mesh->faces[bat_mesh_previous(around)] == d)
            return false;
        around = bat_mesh_next_around(links, around);
    } while (around != first && around != BAT_MESH_NONE);
    if (valence[a] <= 3 || valence[b] <= 3 || valence[c] >= 12 || valence[d] >= 12)
        return false;
    valence[a]--;
    valence[b]--;
    valence[c]++;
    valence[d]++;
    mesh_set_face(mesh, h / 3, a, d, c);
    mesh_set_face(mesh, t / 3, b, c, d);
    return true;
}

/// A closed mesh with vertices of 3 to 12 faces: a perturbed torus with random edges flipped.
static inline bat_mesh mesh_irregular(uint32_t around, uint32_t across, uint64_t seed)
{
    bat_mesh mesh = mesh_torus(around, across);
    bat_random random = bat_random_seed(seed);
    unsigned *valence = (unsigned *)mesh_room(mesh.vertex_count, sizeof *valence);
    for (size_t i = 0; i < 3 * mesh.face_count; i++)
        valence[mesh.faces[i]]++;
    for (int round = 0; round < 6; round++)
    {
        // The neighbourhood of an edge must be unchanged: only one face at each vertex may have changed.
        bat_mesh_connectivity links;
        if (bat_mesh_connect(&mesh, &links, NULL) != BAT_OK)
            abort();
        bool *touched = (bool *)mesh_room(mesh.vertex_count, sizeof *touched);
        for (size_t i = 0; i < mesh.face_count; i++)
        {
            uint32_t h = (uint32_t)(bat_random_uniform(&random) * 3 * (double)mesh.face_count), t = links.twin[h];
            uint32_t corners[4] = {mesh.faces[h], mesh.faces[t], mesh.faces[bat_mesh_previous(h)],
                                   mesh.faces[bat_mesh_previous(t)]};
            bool fresh = true;
            for (int c = 0; c < 4; c++)
                fresh = fresh && !touched[corners[c]];
            if (fresh && mesh_turn_edge(&mesh, &links, valence, h))
                for (int c = 0; c < 4; c++)
                    touched[corners[c]] = true;
        }
        free(touched);
        bat_mesh_connectivity_free(&links);
    }
    free(valence);
    mesh_shake(&mesh, 0.05, seed + 1);
    return mesh;
}

/// The union of two meshes; the second's vertices and faces follow the first's.
static inline bat_mesh mesh_join(const bat_mesh *a, const bat_mesh *b)
{
    bat_mesh mesh = mesh_with_room(a->vertex_count + b->vertex_count, a->face_count + b->face_count);
    memcpy(mesh.positions, a->positions, 3 * a->vertex_count * sizeof *a->positions);
    memcpy(mesh.positions + 3 * a->vertex_count, b->positions, 3 * b->vertex_count * sizeof *b->positions);
    memcpy(mesh.faces, a->faces, 3 * a->face_count * sizeof *a->faces);
    for (size_t i = 0; i < 3 * b->face_count; i++)
        mesh.faces[3 * a->face_count + i] = b->faces[i] + (uint32_t)a->vertex_count;
    return mesh;
}

#endif
