#ifndef MESH_REPAIR_STEPS_H
#define MESH_REPAIR_STEPS_H

#include "batten/mesh.h"

/// The steps of bat_mesh_repair(), in their order. Each returns false when out of memory.

/// A mesh in repair. Half-edges are those of the faces that are left.
typedef struct repair_work
{
    const bat_mesh *mesh;
    uint32_t *faces;   ///< face_count x 3: the faces that are left, by the mesh's vertices
    uint32_t *sources; ///< the faces of the mesh that they are
    size_t face_count;
    uint32_t *sorted; ///< the half-edges in the order of their edges
    uint32_t
        *twin;     ///< the other half-edge of an edge of two faces, in either direction; BAT_MESH_NONE where the mesh is cut
    uint32_t *fan; ///< of every half-edge: the least one that begins in the same fan of the same vertex
    uint32_t *copies;    ///< face_count x 3: the faces by the vertices of the result
    uint32_t *origins;   ///< of the result's vertices: what they were in the mesh
    size_t vertex_count; ///< of the result
} repair_work;

/// An edge by its vertices in the mesh.
typedef struct repair_edge
{
    uint32_t low, high;
} repair_edge;

static inline repair_edge repair_edge_of(const repair_work *work, uint32_t half_edge)
{
    uint32_t a = work->faces[half_edge], b = work->faces[bat_mesh_next(half_edge)];
    return a < b ? (repair_edge){a, b} : (repair_edge){b, a};
}

/// Drop faces with a vertex twice and faces that repeat an earlier one.
bool repair_drop_faces(repair_work *work, bat_mesh_repair_report *report);

/// Sort the half-edges and make twins of those that are alone with each other on their edge.
bool repair_join_faces(repair_work *work, bat_mesh_repair_report *report);

/// Turn faces over so that twins run in opposite directions, and cut where they still do not.
bool repair_orient_faces(repair_work *work, bat_mesh_repair_report *report);

/// Give every fan a vertex of its own.
bool repair_split_vertices(repair_work *work, bat_mesh_repair_report *report);

#endif
