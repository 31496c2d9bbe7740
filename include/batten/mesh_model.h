#ifndef BATTEN_MESH_MODEL_H
#define BATTEN_MESH_MODEL_H

#include "batten/mesh_refine.h"

BAT_C_BEGIN

/// @file
/// Learned refinement of meshes: the network that comes with the library, and others from files.

/// A trained network. It does not change, and any number of calls may use it at once.
typedef struct bat_mesh_model bat_mesh_model;

/// Read a model from a safetensors file: what bat_mesh_train() writes, or any file with the arrays of the published program
/// ("net_init.layerIn.weight", …) in single or double precision. Of a training's checkpoint the best weights so far are taken.
/// What the published ablations leave out shows in the arrays; whether frames are fixed and lengths are relative
/// (bat_mesh_train_options) is in the file's note of the recipe.
///
/// @param model receives the model; release it with bat_mesh_model_free()
/// @return BAT_OK; BAT_BAD_FILE (an array is missing, has another shape, or holds a number that is not finite);
///         BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY; `*model` is untouched on failure
BAT_API bat_status bat_mesh_model_read(const char *path, bat_mesh_model **model, bat_error *error);
/// The model that comes with the library (models/mesh.md).
/// @param model receives the model; release it with bat_mesh_model_free()
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_mesh_model_builtin(bat_mesh_model **model, bat_error *error);
/// Does nothing to null.
BAT_API void bat_mesh_model_free(bat_mesh_model *model);

/// The rule of BAT_MESH_LEARNED that takes its vertices from a model, which must outlive it.
///
/// The published network (Liu et al., "Neural Subdivision", 2020) sees a mesh scaled into the unit box, (v - min) / max: it
/// follows turns about the box's middle and even scaling no more than that box does. It moves given vertices as well. An edge
/// whose two faces have no area or lie folded onto each other displaces nothing: its new vertex is its middle. At a boundary
/// the missing corner is thought where the other goes by point reflection in the edge's middle.
BAT_API const bat_mesh_rule *bat_mesh_model_rule(const bat_mesh_model *model);

BAT_C_END

#endif
