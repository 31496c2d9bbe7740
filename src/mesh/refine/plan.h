#ifndef MESH_REFINE_PLAN_H
#define MESH_REFINE_PLAN_H

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

/// Check that 32-bit indices can number the finest mesh, and that memory holds it. `texture_links` is all zero for a mesh
/// without texture.
/// @return BAT_OK or BAT_TOO_LARGE
bat_status mesh_plan_check_size(const mesh_plan *plan, const bat_mesh *coarse, const mesh_sides *sides,
                                const bat_mesh_connectivity *links, const bat_mesh_connectivity *texture_links,
                                bat_error *error);

/// The scheme of a level, counted from 0.
const mesh_scheme *mesh_plan_scheme(const mesh_plan *plan, size_t level);

/// The fraction of the work that the first `level` levels take.
double mesh_plan_share(const mesh_plan *plan, size_t level);

#endif
