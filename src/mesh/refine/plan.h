#pragma once

#include "mesh/refine/scheme.h"

/// @file
/// The steps of a refinement.

/// The steps of a refinement with checked options.
typedef struct mesh_plan
{
    bat_mesh_refine_options options;
    size_t learned_levels; ///< the number of first levels that the learned rule makes
    bat_mesh_rules rules;  ///< of the options and the mesh, without AUTO
    mesh_rule *limit;      ///< moves the vertices to the limit surface at the end; null: they stay
} mesh_plan;

/// Plan a refinement by checked options, whose rule is there where the scheme is learned.
/// @return BAT_OK, BAT_UNSUPPORTED
bat_status mesh_plan_make(const bat_mesh *coarse, const bat_mesh_refine_options *options, mesh_plan *plan, bat_error *error);

/// Some rules, and others where they are AUTO.
bat_mesh_rules mesh_rules_or(bat_mesh_rules rules, bat_mesh_rules others);

/// Check that 32-bit indices can number the finest mesh, and memory holds it. All zero `texture_links`: no texture.
/// @return BAT_OK or BAT_TOO_LARGE
bat_status mesh_plan_check_size(const mesh_plan *plan, const bat_mesh *coarse, const mesh_sides *sides,
                                const bat_mesh_connectivity *links, const bat_mesh_connectivity *texture_links,
                                bat_error *error);

/// The scheme of a level, counted from 0.
const mesh_scheme *mesh_plan_scheme(const mesh_plan *plan, size_t level);

/// The fraction of the work that the first `level` levels take.
double mesh_plan_share(const mesh_plan *plan, size_t level);

// Adaptive refinement: faces are split where the surface needs it.

/// Refine a checked mesh by Loop's or Catmull and Clark's scheme until every face is within options->tolerance of the limit
/// surface, and no edge is longer than options->max_edge. All vertices are on the limit surface. Triangles beside finer ones
/// are cut to their vertices; quads beside finer ones take these in as corners.
/// @param sides of the faces of `coarse`
/// @param fine  receives the mesh without names of channels
/// @return as bat_mesh_refine(); BAT_TOO_LARGE where the deepest level does not suffice
bat_status adaptive_refine(const bat_mesh *coarse, const mesh_sides *sides, const bat_mesh_refine_options *options,
                           bat_mesh *fine, bat_error *error);

/// Refine by levels: the function that adaptive_refine() repeats.
bat_status refine_corners(const bat_mesh *coarse, const mesh_sides *sides, const bat_mesh_refine_options *options,
                          bat_mesh *fine, bat_error *error);

// Texture coordinates under smooth rules: face-varying data of OpenSubdiv 3.5.
//
// A seam is an inner edge whose faces disagree about a texture coordinate at one of its ends. A vertex without seams has
// the scheme's rule. At other vertices every coordinate has the rule of a corner (it stays) or of a crease along its
// outermost edges, by bat_mesh_linear and by the sharp edges between its faces.

/// Texture coordinates to refine.
typedef struct texture_rows
{
    const mesh_level *level;            ///< the mesh
    const bat_mesh_connectivity *seams; ///< the texture's links: seams are its boundary edges; no `first`
    const uint32_t *corners;            ///< the texture coordinates at the corners of faces
    const double *from;                 ///< x 2
    double *to;                         ///< of the next level x 2
    bat_mesh_linear linear;             ///< but AUTO and ALL
    smooth_mask *smooth;                ///< the scheme's
    bool quads;                         ///< Catmull and Clark's scheme, else Loop's
    /// For each coarse texture coordinate: whether its sharpness depends on that of the vertex's other one; null for the
    /// rules without such. Each level updates it.
    unsigned char *dependent;
    size_t dependent_count; ///< the number of coarse texture coordinates
    bool first_level;       ///< `dependent` is not set yet
} texture_rows;

/// Compute the next level's texture coordinates: those there are, one for each edge and, with `quads`, each face.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status texture_rule(const texture_rows *rows, bat_error *error);

/// Give vertices that share a texture coordinate one each, which smooth rules need. `mesh` may have lists of any polygons.
/// @param corner_count  of the corners of faces
/// @param texture       receives the coordinates, those of `mesh` first; release it with free()
/// @param texture_faces receives the coordinates at the corners; release it with free()
/// @return BAT_OK or BAT_NO_MEMORY; results are untouched on failure
bat_status texture_separate(const bat_mesh *mesh, size_t corner_count, double **texture, size_t *texture_count,
                            uint32_t **texture_faces, bat_error *error);
