#include "mesh/refine/seams.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/refine/level.h"

bat_status seams_connect(const bat_mesh *mesh, const bat_mesh_connectivity *links, bat_mesh_connectivity *seams,
                         bat_error *error)
{
    size_t half_edges = 3 * mesh->face_count;
    bat_mesh_connectivity made = {
        .twin = memory_array(half_edges, sizeof *made.twin),
        .edge = memory_array(half_edges, sizeof *made.edge),
        .vertex_count = mesh->texture_count,
        .face_count = mesh->face_count,
    };
    if (made.twin == NULL || made.edge == NULL)
    {
        bat_mesh_connectivity_free(&made);
        return error_memory(error, half_edges * sizeof *made.twin);
    }
    const uint32_t *corner = mesh->texture_faces;
    uint32_t edges = 0;
    for (uint32_t h = 0; h < half_edges; h++)
    {
        uint32_t twin = links->twin[h];
        bool joined = twin != BAT_MESH_NONE && corner[h] == mesh_end(corner, twin) && corner[twin] == mesh_end(corner, h);
        made.twin[h] = joined ? twin : BAT_MESH_NONE;
        made.edge[h] = mesh_owns(made.twin, h) ? edges++ : made.edge[twin];
        made.boundary_edge_count += !joined;
    }
    made.edge_count = edges;
    *seams = made;
    return BAT_OK;
}
