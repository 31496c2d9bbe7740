#pragma once

#include "batten/mesh_decimate.h"
#include "linalg/vector.h"
#include "mesh/decimate/collapse.h"

/// @file
/// Flattening of a ring before and after its collapse onto the same polygon (Liu et al., 2020, section 4.1).
///
/// The points are in the order i, j, the new vertex, vertex[0], vertex[1], ….

enum
{
    FLAT_I,
    FLAT_J,
    FLAT_NEW,
    FLAT_RING,
    FLAT_POINTS = FLAT_RING + COLLAPSE_MAX_FACES + 1,
    /// The unknowns of a flattening: all points except the new vertex.
    FLAT_UNKNOWNS = FLAT_POINTS - 1
};

/// Workspace of one flattening.
typedef struct flat_workspace
{
    /// The lower triangle of the Hermitian matrix of the conformal energy, then of its factor: real and imaginary parts.
    double real[FLAT_UNKNOWNS][FLAT_UNKNOWNS], imaginary[FLAT_UNKNOWNS][FLAT_UNKNOWNS];
    double inverse_pivot[FLAT_UNKNOWNS];
    double right[FLAT_UNKNOWNS][2];
    uint32_t unknown[FLAT_UNKNOWNS]; ///< for each row: its point
} flat_workspace;

/// The points of face k of a ring, before or after the collapse. Vanishing faces come last.
static inline void flat_corners(const collapse_ring *ring, uint32_t face, bool after, uint32_t *corners)
{
    for (uint32_t c = 0; c < 3; c++)
    {
        uint32_t local = collapse_ring_corner(ring, face, c);
        corners[c] = local < 2 ? (after ? (uint32_t)FLAT_NEW : local) : local + 1;
    }
}

/// Flatten a ring with minimal conformal energy.
///
/// Closed rings, and rings with one end on the boundary, use spectral conformal parameterization (Mullen, Tong, Alliez and
/// Desbrun, 2008). The new vertex then follows by least squares with fixed outer vertices, or lies at a boundary vertex i.
/// Rings of a boundary edge use a least-squares conformal map. Their boundary, from the last vertex through i and j to the
/// first, lies on a line with its lengths; the new vertex lies on that line.
///
/// @param points positions in space
/// @param flat   receives positions in the plane
/// @return false when the equations have no solution
bool flatten_ring(const collapse_ring *ring, const double (*points)[3], flat_workspace *workspace, double (*flat)[2]);

/// Whether the flattened ring is a bijection before and after the collapse. All faces must have positive areas, and the
/// angles around the new vertex must add up to a full turn or, on the boundary, to less. The outer polygon is then simple
/// and covered once. After the collapse every face must have the quality `min_quality`, or that of the worst face before.
bool flat_is_valid(const collapse_ring *ring, const double (*flat)[2], double min_quality);

// The map between a mesh and its decimation: the flattened rings of all collapses, in order.
//
// A collapse has an entry for each face of its ring. The entries of a face are linked in the order of the collapses, so a
// point visits only those collapses that changed its face.

#define MAP_NONE UINT32_MAX

/// A collapse. Its entries are the faces of the ring, in ring order. Its points are i, j, the new vertex and the outer
/// vertices.
typedef struct map_collapse
{
    uint32_t first_entry, first_point;
    uint8_t count, vanishing, j_begin, j_end; ///< as in collapse_ring
    uint8_t closed;
} map_collapse;

/// An entry with all that carrying a point needs, so that it reads few places of memory.
typedef struct map_step
{
    uint32_t half_edge;    ///< as in the map
    uint32_t previous;     ///< the entry of the same face in the previous collapse, or MAP_NONE
    uint32_t next;         ///< the entry of the same face in the next collapse, or MAP_NONE
    map_collapse collapse; ///< a copy
} map_step;

struct bat_mesh_map
{
    map_collapse *collapses;
    size_t collapse_count;

    uint32_t *half_edge; ///< for each entry: the half-edge of its face that begins at i or j
    map_step *steps;     ///< for each entry
    size_t entry_count;

    double *points; ///< point_count x 2
    size_t point_count;

    uint32_t *first; ///< for each fine face: its first entry
    uint32_t *last;  ///< for each fine face: its last entry
    uint32_t *kept;  ///< for each coarse face: the fine face that remained
    size_t fine_vertices, fine_faces, coarse_vertices, coarse_faces;
    uint64_t fine_digest, coarse_digest; ///< digests of the faces, which identify the meshes

    size_t collapse_room, entry_room, point_room; ///< capacities during construction
};

/// The corners of face k of a collapse in the plane, before or after it. The face's half-edge begins at the first corner.
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

/// Interpolate a value of the vertices at a point; `values` has `width` numbers for each vertex.
static inline double map_value_at(const bat_mesh *mesh, const double *values, size_t width, const bat_mesh_point *point)
{
    double sum = 0;
    for (size_t c = 0; c < 3; c++)
        sum += point->barycentric[c] * values[width * mesh->faces[3 * (size_t)point->face + c]];
    return sum;
}

/// Append a collapse to a map, which is all zero before the first one; `flat` holds the flattened points of its ring.
/// @return BAT_OK, BAT_TOO_LARGE or BAT_NO_MEMORY
bat_status map_append(bat_mesh_map *map, const collapse_ring *ring, const double (*flat)[2], bat_error *error);
/// Finish the map: release spare memory, link the entries, store the digests. `kept` must be set.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status map_finish(bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, bat_error *error);
/// Link the entries of every face in the order of the collapses.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status map_link(bat_mesh_map *map, bat_error *error);
/// Check a map whose arrays are set, except for the links. Every collapse must act on existing faces, all flattened faces
/// must have positive areas, and the remaining faces must be those in `kept`.
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status map_inspect(const bat_mesh_map *map, bat_error *error);
/// Check that the map belongs to these meshes; either may be null.
/// @return BAT_OK or BAT_INVALID_ARGUMENT
bat_status map_check(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, bat_error *error);
