#ifndef MESH_DECIMATE_TOLERANCE_H
#define MESH_DECIMATE_TOLERANCE_H

#include "mesh/decimate/collapse_error.h"
#include "mesh/measure/closest.h"

/// @file
/// A bound on the distance between a mesh and its decimation, checked at samples for every collapse.
///
/// Samples of the given mesh are its vertices and the middles of its edges and faces. Each belongs to the present face that
/// was nearest when the faces around it last changed; it must stay within the bound of one of the new faces. Samples of the
/// result are its vertices, three points of each edge and four of each face; they must stay within the bound of the given
/// mesh.

typedef struct tolerance
{
    double bound;
    closest_tree tree; ///< of the given mesh
    double *samples;   ///< sample_count x 3
    size_t sample_count;
    uint32_t *first;  ///< for each face: its first sample, or BAT_MESH_NONE
    uint32_t *next;   ///< for each sample: the next one of its face, or BAT_MESH_NONE
    uint32_t *place;  ///< for each vertex: a place of the tree near it
    uint32_t *moved;  ///< the samples of the current ring
    uint8_t *nearest; ///< for each of them: its new face in the ring
    size_t moved_count;
} tolerance;

/// @return BAT_OK or BAT_NO_MEMORY
/// @param topology of the given mesh, before any collapse
bat_status tolerance_make(const bat_mesh *fine, const bat_mesh_connectivity *topology, double bound, tolerance *made,
                          bat_error *error);
void tolerance_free(tolerance *all);

/// Whether the collapse of a ring to a position keeps the bound at all samples.
bool tolerance_allows(tolerance *all, const error_vertex *vertices, const collapse_ring *ring, const double *position);
/// Give the samples of the ring of the last tolerance_allows() to their new faces.
void tolerance_apply(tolerance *all, const collapse_ring *ring);

#endif
