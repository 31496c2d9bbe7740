#ifndef BATTEN_TENSION_MODEL_H
#define BATTEN_TENSION_MODEL_H

#include "batten/scheme.h"

BAT_C_BEGIN

/// @file
/// Learned curve schemes: the one that the library comes with, and those of networks that are read from files.

/// The learned scheme that the library comes with: for the plane, the sphere S^2 and the disk, closed and open curves of any
/// scale and spacing. A network adds to the angle of the six-point rule what 8 exterior angles and 9 edge lengths around the
/// edge suggest. It keeps the given points; it commutes with isometries, mirror images, reversal and, on the plane, scaling;
/// no angle reaches BAT_ANGLE_LIMIT whatever the weights (Theorem 1 of Ugail and Howard 2026). docs/fairing.md describes it;
/// `batten train tension --recipe batten` makes its weights.
///
/// @param fairness 0 follows the data most closely, 1 gives the smoothest curve; clipped to that range, NaN is 1/2
BAT_API bat_scheme bat_scheme_learned(double fairness);

/// A trained network. It does not change, and any number of calls may use it at once.
typedef struct bat_tension_model bat_tension_model;

/// Read a model from a safetensors file: what bat_fairing_train() or bat_tension_train() writes, or any file with the arrays of the published program
/// ("geom_embed.weight", "input_proj.0.weight", …) in single or double precision. Of a training's checkpoint the best weights
/// so far are taken, or those of its last step where no best are known yet. The networks of table 3 without a learned
/// embedding (BAT_TENSION_EMBEDDING_ONE_HOT, BAT_TENSION_EMBEDDING_NONE) are told by their arrays.
///
/// @param model receives the model; release it with bat_tension_model_free()
/// @return BAT_OK; BAT_BAD_FILE (an array is missing, has another shape, or holds a number that is not finite);
///         BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY; `*model` is untouched on failure
BAT_API bat_status bat_tension_model_read(const char *path, bat_tension_model **model, bat_error *error);
/// The network of the published recipe that the library's project trained (models/tension-published.md), to compare with.
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_tension_model_published(bat_tension_model **model, bat_error *error);
/// Whether bat_scheme's fairness means something to a model.
BAT_API bool bat_tension_model_has_fairness(const bat_tension_model *model);
/// Does nothing to null.
BAT_API void bat_tension_model_free(bat_tension_model *model);

/// The scheme that takes its insertion angles from a model, which must outlive it: for the plane, the sphere S^2 and the disk.
/// The published network looks at four exterior angles and two edge lengths around an edge (eq. 17), the lengths relative to
/// the mean of the polygon. New vertices are safe whatever the weights (Theorem 1): no angle reaches BAT_ANGLE_LIMIT.
/// `scheme.fairness`, 1/2 at first, only means something to a model of the library's own recipe.
BAT_API bat_scheme bat_scheme_of_model(const bat_tension_model *model);

BAT_C_END

#endif
