#ifndef BATTEN_SURFACE_MODEL_H
#define BATTEN_SURFACE_MODEL_H

#include "batten/cloud.h"

BAT_C_BEGIN

/// @file
/// Learned parameters of scattered points: Giannelli, Imperatore, Mantzaflaris and Scholz, "BIDGCN: Boundary informed dynamic graph
/// convolutional network for adaptive spline fitting of scattered data" (2023), and our own network.

/// A trained network. It does not change, and any number of calls may use it at once.
typedef struct bat_surface_model bat_surface_model;

/// Read a model from a safetensors file: what bat_surface_train() writes, either network. Of a checkpoint the best weights so far.
/// @param model receives the model; release it with bat_surface_model_free()
/// @return BAT_OK; BAT_BAD_FILE; BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY; `*model` is untouched on failure
BAT_API bat_status bat_surface_model_read(const char *path, bat_surface_model **model, bat_error *error);
/// The model that comes with the library (models/surface.md).
BAT_API bat_status bat_surface_model_builtin(bat_surface_model **model, bat_error *error);
/// Does nothing to null.
BAT_API void bat_surface_model_free(bat_surface_model *model);

/// Find the interior parameters of a cloud. They do not depend on the cloud's place and size.
/// @param boundary   boundary_count x 2
/// @param threads    0: as many as OpenMP gives; the result does not depend on it
/// @param parameters receives count x 2, the boundary's first
/// @return BAT_OK; what bat_cloud_check() returns; BAT_INVALID_ARGUMENT for a cloud whose size is not finite; BAT_NO_MEMORY; with our network
///         BAT_INVALID_ARGUMENT for a cloud without boundary or boundary parameters that are not finite, and BAT_NO_CONVERGENCE for such as are beyond all bounds
BAT_API bat_status bat_surface_model_parameterize(const bat_surface_model *model, const bat_cloud *cloud,
                                                  const double *boundary, int threads, double *parameters, bat_error *error);

BAT_C_END

#endif
