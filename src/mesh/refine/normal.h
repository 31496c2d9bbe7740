#ifndef MESH_REFINE_NORMAL_H
#define MESH_REFINE_NORMAL_H

#include "mesh/refine/sharpness.h"

/// @file
/// Limit normals: cross products of two tangents. The tangents are left eigenvectors of the local subdivision matrix for its
/// largest eigenvalues below 1, applied to the vertices around.

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

#endif
