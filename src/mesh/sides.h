#pragma once

#include "batten/mesh.h"

/// @file
/// Half-edges of faces with any number of corners.

/// How many corners the faces have. All zero: three. A half-edge has the index of the corner where it begins, and the
/// corners of a face follow one another.
typedef struct mesh_sides
{
    bool quads;              ///< every face has four
    const uint32_t *offsets; ///< face_count + 1: the first corner of each face, where their numbers differ; else null
    const uint32_t *face;    ///< the face of each half-edge, where their numbers differ; else null
} mesh_sides;

/// The number of corners of the first faces of a mesh; with `face_count` of all faces.
static inline size_t mesh_corners_until(const bat_mesh *mesh, size_t face)
{
    return mesh->offsets != NULL ? mesh->offsets[face] : 3 * face;
}

/// The sides of a checked mesh. They share its offsets; release `face` with free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sides_of_mesh(const bat_mesh *mesh, mesh_sides *sides, uint32_t **face, bat_error *error);

/// The offsets of `face_count` faces of `count` corners each; null when out of memory.
uint32_t *sides_offsets(size_t face_count, uint32_t count);

/// The number of corners of all faces.
static inline uint32_t sides_corners(const mesh_sides *sides, size_t face_count)
{
    return sides->offsets != NULL ? sides->offsets[face_count] : (uint32_t)face_count * (sides->quads ? 4 : 3);
}

/// The face of a half-edge.
static inline uint32_t sides_face(const mesh_sides *sides, uint32_t half_edge)
{
    return sides->offsets != NULL ? sides->face[half_edge] : half_edge / (sides->quads ? 4 : 3);
}

/// The first corner of a face, and that of the face after it.
static inline uint32_t sides_begin(const mesh_sides *sides, uint32_t face)
{
    return sides->offsets != NULL ? sides->offsets[face] : face * (sides->quads ? 4 : 3);
}

/// The half-edge after another one in its face.
static inline uint32_t sides_next(const mesh_sides *sides, uint32_t half_edge)
{
    if (sides->quads)
        return half_edge % 4 == 3 ? half_edge - 3 : half_edge + 1;
    if (sides->offsets == NULL)
        return bat_mesh_next(half_edge);
    uint32_t face = sides->face[half_edge];
    return half_edge + 1 == sides->offsets[face + 1] ? sides->offsets[face] : half_edge + 1;
}

/// The half-edge before another one in its face.
static inline uint32_t sides_previous(const mesh_sides *sides, uint32_t half_edge)
{
    if (sides->quads)
        return half_edge % 4 == 0 ? half_edge + 3 : half_edge - 1;
    if (sides->offsets == NULL)
        return bat_mesh_previous(half_edge);
    uint32_t face = sides->face[half_edge];
    return half_edge == sides->offsets[face] ? sides->offsets[face + 1] - 1 : half_edge - 1;
}

/// Find the neighbours of faces with checked corners, as bat_mesh_connect() does.
/// @param count the number of faces
bat_status sides_connect(const mesh_sides *sides, const uint32_t *faces, size_t count, size_t vertex_count,
                         bat_mesh_connectivity *connectivity, bat_error *error);
