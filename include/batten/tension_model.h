#ifndef BATTEN_TENSION_MODEL_H
#define BATTEN_TENSION_MODEL_H

#include "batten/scheme.h"

BAT_C_BEGIN

/// @file
/// Learned tension: curve schemes whose insertion angles come from the trained network of Ugail and Howard (2026), section 5.

/// A trained network. It does not change, and any number of calls may use it at once.
typedef struct bat_tension_model bat_tension_model;

/// Read a model from a safetensors file: what bat_tension_train() writes, or any file with the arrays of the published program
/// ("geom_embed.weight", "input_proj.0.weight", …) in single or double precision. Of a training's checkpoint the best weights
/// so far are taken, or those of its last step where no best are known yet. The networks of table 3 without a learned
/// embedding (BAT_TENSION_EMBEDDING_ONE_HOT, BAT_TENSION_EMBEDDING_NONE) are told by their arrays.
///
/// @param model receives the model; release it with bat_tension_model_free()
/// @return BAT_OK; BAT_BAD_FILE (an array is missing, has another shape, or holds a number that is not finite);
///         BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY; `*model` is untouched on failure
BAT_API bat_status bat_tension_model_read(const char *path, bat_tension_model **model, bat_error *error);
/// Does nothing to null.
BAT_API void bat_tension_model_free(bat_tension_model *model);

/// The scheme that takes its insertion angles from a model, which must outlive it: for the plane, the sphere S^2 and the disk.
/// It looks at four exterior angles and two edge lengths around an edge (eq. 17), the lengths relative to the mean of the
/// polygon. New vertices are safe whatever the weights (Theorem 1): no angle reaches BAT_ANGLE_LIMIT.
BAT_API bat_scheme bat_scheme_learned(const bat_tension_model *model);

BAT_C_END

#endif
