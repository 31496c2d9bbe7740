#pragma once

#include "mesh/refine/level.h"

/// @file
/// Sharpness of creases and corners through the levels: DeRose, Kass and Truong, "Subdivision surfaces in character
/// animation" (1998). Each level subtracts 1 from a sharpness below BAT_MESH_SHARP.

/// The sharpness that remains after one level.
static inline double sharpness_after_level(double sharpness)
{
    if (sharpness >= BAT_MESH_SHARP)
        return sharpness;
    return sharpness > 1 ? sharpness - 1 : 0;
}

/// Compute the sharpness of edges from a mesh's creases and, with `crease_angle` above 0, from the angles between its faces.
/// @param level     the mesh's faces and links
/// @param sharpness receives one number for each edge, or null when no edge is sharp
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a crease that is not an edge; BAT_NO_MEMORY
bat_status sharpness_of_edges(const mesh_level *level, const bat_mesh *mesh, double crease_angle, double **sharpness,
                              bat_error *error);

/// Compute the sharpness of vertices from a mesh's corners: one number for each vertex, or null without corners.
/// @param sharpen_boundary make sharp for ever the boundary vertices of a single face
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sharpness_of_vertices(const mesh_level *level, const bat_mesh *mesh, bool sharpen_boundary, double **sharpness,
                                 bat_error *error);

/// A half-edge between two vertices, in either direction; BAT_MESH_NONE when they are not neighbours.
uint32_t mesh_half_edge_between(const mesh_level *level, uint32_t a, uint32_t b);

/// List what is sharp. Release the list with sharp_list_free().
/// @param list all zero where nothing is sharp
/// @return BAT_OK or BAT_NO_MEMORY; `list` is all zero on failure
bat_status sharp_list_make(const mesh_level *level, sharp_list *list, bat_error *error);
void sharp_list_free(sharp_list *list);

/// Compute mesh_level::child_sharpness for Chaikin's rule of creases (OpenSubdiv 3.5, Sdc::Options::CREASE_CHAIKIN).
/// Where several semi-sharp edges meet, 3/4 of an edge's sharpness and 1/4 of the mean of the others pass on, less 1.
/// @param children receives two numbers for each edge, or null when no edge is sharp
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sharpness_chaikin(const mesh_level *level, double **children, bat_error *error);

/// The sharpness of one half of a half-edge's edge on the next level: of that at the half-edge's begin, or of the other.
static inline double sharpness_of_half(const mesh_level *level, uint32_t half_edge, bool at_begin)
{
    uint32_t edge = level->links->edge[half_edge];
    if (level->child_sharpness != NULL)
        return level->child_sharpness[2 * (size_t)edge + (mesh_owns(level->links->twin, half_edge) ? !at_begin : at_begin)];
    return level->edge_sharpness != NULL ? sharpness_after_level(level->edge_sharpness[edge]) : 0;
}

/// The weight of the midpoint against the smooth rule at the vertex on an inner edge, 1 for a sharp edge. Under Chaikin's
/// rule it can exceed 1 where only one half stays sharp, as in OpenSubdiv.
static inline double edge_weight(const mesh_level *level, uint32_t half_edge)
{
    double sharpness = level->edge_sharpness != NULL ? level->edge_sharpness[level->links->edge[half_edge]] : 0;
    if (!(sharpness > 0))
        return 0;
    bool stays = sharpness_of_half(level, half_edge, true) > 0 && sharpness_of_half(level, half_edge, false) > 0;
    return stays ? 1 : sharpness;
}

/// Compute the sharpness of the edges of the split mesh, whose connectivity is `fine`.
/// @param result receives one number for each edge of the split mesh, or null when none is sharp
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sharpness_split(const mesh_level *level, const bat_mesh_connectivity *fine, double **result, bat_error *error);

/// Write the creases and corners of the mesh `fine` that `level` is split into.
/// @return BAT_OK or BAT_NO_MEMORY; `fine` may hold a part of both on failure
bat_status sharpness_write(const mesh_level *level, bat_mesh *fine, bat_error *error);

/// The type of a vertex, which selects its rule.
typedef enum sharp_kind
{
    SHARP_SMOOTH, ///< no sharp edge
    SHARP_DART,   ///< one sharp edge, which ends here
    SHARP_CREASE, ///< two sharp edges
    SHARP_CORNER  ///< three or more sharp edges, or a sharp vertex
} sharp_kind;

/// A vertex and its sharp edges. Boundary edges are always sharp.
typedef struct sharp_vertex
{
    sharp_kind kind;
    uint32_t ends[2];    ///< crease: its neighbours along the crease; dart: the neighbour along the sharp edge
    uint32_t corners[2]; ///< corners of faces at the vertex where these neighbours are
} sharp_vertex;

/// Classify a vertex that has a face, on this level and after one more level.
/// @param after  receives the type after the level; may be null
/// @param fading receives the weight of the rule for `now`, against the rule for `after`; null when `after` is
void sharpness_around(const mesh_level *level, uint32_t vertex, sharp_vertex *now, sharp_vertex *after, double *fading);

/// The weights of a vertex rule: of the vertex, of each neighbour (and in Catmull-Clark's scheme of the middle of each
/// face), and of two selected neighbours.
typedef struct vertex_mask
{
    double own, ring, pair;
    uint32_t corners[2]; ///< corners of faces at the vertex where the selected neighbours are
} vertex_mask;

/// Apply a mask to the sum of the neighbours, which is in the row of the vertex, and to the selected ones, `ends`.
static inline void mask_row(const mesh_rows *rows, uint32_t vertex, const vertex_mask *mask, const uint32_t ends[2],
                            size_t dim)
{
    const double *own = rows->from + vertex * dim, *p = rows->from + ends[0] * dim, *q = rows->from + ends[1] * dim;
    double *restrict to = rows->to + vertex * dim;
    for (size_t i = 0; i < dim; i++)
        to[i] = mask->own * own[i] + mask->ring * to[i] + mask->pair * (p[i] + q[i]);
}

/// The mask of a smooth vertex inside the mesh.
typedef vertex_mask smooth_mask(unsigned valence);

/// The mask of a vertex that has a face, by its sharp edges.
vertex_mask mask_around(const mesh_level *level, uint32_t vertex, unsigned valence, smooth_mask *smooth);

/// Apply the mask of a vertex, with `sharp` that by its sharp edges, to the sum of the neighbours in its row.
/// @param ends its neighbours along the boundary, or itself twice inside the mesh
static inline void mask_vertex(const mesh_rows *rows, uint32_t vertex, bool sharp, bool boundary, unsigned valence,
                               smooth_mask *smooth, uint32_t ends[2], size_t dim)
{
    vertex_mask mask = {.own = 3.0 / 4, .pair = 1.0 / 8};
    if (sharp)
    {
        mask = mask_around(rows->level, vertex, valence, smooth);
        ends[0] = rows->level->faces[mask.corners[0]];
        ends[1] = rows->level->faces[mask.corners[1]];
    }
    else if (!boundary)
        mask = smooth(valence);
    mask_row(rows, vertex, &mask, ends, dim);
}

/// Call a function for all vertices that are sharp or have a sharp edge, some repeatedly without mesh_level::sharp.
void sharpness_visit(const mesh_level *level, void (*visit)(const void *context, uint32_t vertex), const void *context);

// Limit normals: cross products of two tangents. The tangents are left eigenvectors of the local subdivision matrix for its
// largest eigenvalues below 1, applied to the vertices around.

typedef struct normal_job normal_job;

/// The tangents of a scheme.
typedef struct normal_rules
{
    bool quads; ///< the vertices opposite in the quads around count as well
    /// The normal of a smooth vertex.
    void (*smooth)(const normal_job *job, uint32_t vertex, double normal[3]);
    /// The normal on one side of a crease, of `faces` faces counter-clockwise from a half-edge on the crease.
    void (*side)(const normal_job *job, uint32_t half_edge, unsigned faces, double normal[3]);
    /// The product of a row and the subdivision matrix around a dart whose sharp edge leads to neighbour 0: of the vertex,
    /// its neighbours and, with `quads`, the vertices opposite in the quads between the neighbours i and i + 1.
    void (*multiply)(unsigned valence, const double *row, double *product);
} normal_rules;

struct normal_job
{
    const mesh_level *level;
    const double *positions;
    double *normals;
    const normal_rules *rules;
};

/// Add `weight` times the vector between two vertices.
void normal_add_way(const normal_job *job, double weight, uint32_t from, uint32_t to, double sum[3]);

extern const normal_rules loop_normals, catmull_clark_normals;

/// Compute the unit normals at all vertices: on a crease the mean of both sides; at corners the area-weighted mean of the
/// faces around; zero for a vertex without a face, and where the normal is not defined.
/// @param sides of the faces of the checked mesh, which are triangles or, for rules of quads, should be quads
/// @return BAT_OK, BAT_UNSUPPORTED, BAT_NOT_MANIFOLD, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY
bat_status normals_compute(const bat_mesh *mesh, const mesh_sides *sides, const normal_rules *rules, int threads,
                           double *normals, bat_error *error);

/// Compute the limit positions of a level's vertices; `rows->to` has as many rows as `rows->from`. A crease is a cubic
/// B-spline, so its limit is (4 v + p + q) / 6 for the neighbours p and q on it. Corners stay.
/// @param inner writes the row of a vertex that is neither
void limit_rows(const mesh_rows *rows, void (*inner)(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp),
                int threads);
