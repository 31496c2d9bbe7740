#ifndef MESH_DECIMATE_MAP_H
#define MESH_DECIMATE_MAP_H

#include "batten/mesh_decimate.h"
#include "mesh/decimate/collapse.h"
#include "mesh/decimate/flatten.h"

/// @file
/// The map between a mesh and its decimation: the flat rings of all collapses, in order.
///
/// A collapse has an entry for each face of its ring. The entries of a face hang together in the order of the collapses, so
/// that a point is carried through only those collapses that its face took part in.

#define MAP_NONE UINT32_MAX

/// A collapse. Its entries are those of the ring's faces, in the ring's order; its points are i, j, the new vertex, and the
/// outside.
typedef struct map_collapse
{
    uint32_t first_entry, first_point;
    uint8_t count, vanishing, j_begin, j_end; ///< as in collapse_ring
    uint8_t closed;
} map_collapse;

struct bat_mesh_map
{
    map_collapse *collapses;
    size_t collapse_count;

    uint32_t *half_edge; ///< of an entry: the half-edge of its face that begins at i or j, as in collapse_ring
    uint32_t *collapse;  ///< of an entry: its collapse
    uint32_t *previous;  ///< of an entry: the entry of the same face in an earlier collapse; MAP_NONE for none
    uint32_t *next;      ///< of an entry: that in a later collapse
    size_t entry_count;

    double *points; ///< point_count x 2
    size_t point_count;

    uint32_t *first; ///< of a face of the fine mesh: its first entry
    uint32_t *last;  ///< of a face of the fine mesh: its last entry
    uint32_t *kept;  ///< of a face of the coarse mesh: the face of the fine mesh it was
    size_t fine_vertices, fine_faces, coarse_vertices, coarse_faces;
    uint64_t fine_digest, coarse_digest; ///< of the faces, to recognize the meshes

    size_t collapse_room, entry_room, point_room; ///< while the map is made
};

/// The corners in the plane of face k of a collapse, before it or after it. The first one is where the face's half-edge
/// begins.
static inline void map_corners(const bat_mesh_map *map, const map_collapse *collapse, uint32_t k, bool after,
                               const double *corners[3])
{
    const double *points = map->points + 2 * (size_t)collapse->first_point;
    uint32_t apex = k >= collapse->j_begin && k < collapse->j_end ? FLAT_J : FLAT_I;
    uint32_t from = FLAT_RING + k, to = k + 1;
    if (k >= collapse->count)
    {
        bool left = k == collapse->count;
        apex = left ? FLAT_I : FLAT_J;
        from = left ? FLAT_J : FLAT_I;
        to = left ? collapse->j_end : collapse->j_begin;
    }
    if (collapse->closed && to == collapse->count)
        to = 0;
    corners[0] = points + (size_t)2 * (after ? (uint32_t)FLAT_NEW : apex);
    corners[1] = points + (size_t)2 * from;
    corners[2] = points + (size_t)2 * (FLAT_RING + to);
}

/// Twice the area of a triangle in the plane, positive where it is counter-clockwise.
static inline double map_area(const double *a, const double *b, const double *c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// A map of a mesh of so many faces onto itself.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status map_make(size_t fine_faces, bat_mesh_map **map, bat_error *error);
/// Append a collapse. `flat` are the ring's points in the plane.
/// @return BAT_OK, BAT_TOO_LARGE or BAT_NO_MEMORY
bat_status map_append(bat_mesh_map *map, const collapse_ring *ring, const double (*flat)[2], bat_error *error);
/// Make the map ready for use: give back spare room, link the entries, remember the meshes. `kept` must be set.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status map_finish(bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, bat_error *error);
/// Link the entries of every face, from the order of the collapses. The links and `first` and `last` must have their room.
void map_link(bat_mesh_map *map);
/// Room for the links of all entries.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status map_allocate_links(bat_mesh_map *map, bat_error *error);
/// A number that depends on a mesh's faces and their order (FNV-1a).
uint64_t map_digest(const bat_mesh *mesh);
/// Check that points can be carried through a map whose arrays are set, links excepted: every collapse works on faces that
/// are still there, all flat faces have a positive area, and what is left are the faces of `kept`.
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status map_inspect(const bat_mesh_map *map, bat_error *error);
/// @return BAT_OK, or BAT_INVALID_ARGUMENT where the map is not one between meshes of these faces. Either may be null.
bat_status map_check(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, bat_error *error);

#endif
