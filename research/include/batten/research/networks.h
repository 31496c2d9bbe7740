#ifndef BATTEN_RESEARCH_NETWORKS_H
#define BATTEN_RESEARCH_NETWORKS_H

#include "batten/cloud_parameterize.h"
#include "batten/curve_scheme.h"
#include "batten/mesh_refine.h"

BAT_C_BEGIN

/// @file
/// Networks of papers, to compare with. Each call reads what its counterpart of the product reads, too: the arrays of a
/// file, or the recipe in it, tell which network it holds. Of a checkpoint, the best weights are taken, or the last ones.

/// Read a model as bat_curve_model_read(), or a network of Ugail and Howard (2026), section 5.3: a file of
/// bat_curve_train(), or one with the arrays of the published program ("geom_embed.weight", ...) in single or double
/// precision. The arrays tell the variants of table 3 without a learned embedding. The features are four exterior angles and
/// two edge lengths, relative to the polygon's mean (eq. 17).
/// @param path null: the network of the published recipe that batten's project trained (weights/tension-published.md)
BAT_API bat_status bat_curve_model_read_published(const char *path, bat_curve_model **model, bat_error *error);

/// Read a model as bat_mesh_model_read(), or the network of Liu et al., "Neural Subdivision" (2020): a file of
/// bat_mesh_train(), or one with the arrays of the published program ("net_init.layerIn.weight", ...). The arrays tell the
/// published network and its ablations; the file's recipe tells whether frames are fixed and lengths are relative.
///
/// The network works on the mesh scaled into the unit box, (v - min) / max. Its results turn and scale with the mesh only as
/// that box does. It also moves given vertices. An edge whose two faces have no area or are folded onto each other gets its
/// midpoint. At a boundary, a missing opposite vertex is replaced by i + j - k.
/// @param path null: the model that comes with the library, batten's
BAT_API bat_status bat_mesh_model_read_published(const char *path, bat_mesh_model **model, bat_error *error);

/// Read a model as bat_surface_model_read(), or the network of Giannelli, Imperatore, Mantzaflaris and Scholz, "BIDGCN"
/// (2023), from a file of bat_surface_train().
/// @param path null: the model that comes with the library, batten's
BAT_API bat_status bat_surface_model_read_published(const char *path, bat_surface_model **model, bat_error *error);

BAT_C_END

#endif
