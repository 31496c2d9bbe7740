#ifndef RESEARCH_STUDIES_MESH_STUDY_H
#define RESEARCH_STUDIES_MESH_STUDY_H

#include "batten/mesh_refine.h"
#include "batten/research/mesh_study.h"

/// @file
/// Common parts of the studies of learned mesh subdivision.

/// Check the options of a study that trains.
bat_status mesh_study_check_training(const bat_mesh_study_options *options, bat_error *error);

/// The published recipe with the study's numbers, and cosine decay of the learning rate.
bat_mesh_train_options mesh_study_recipe(const bat_mesh_study_options *options);

/// Train by a recipe in the subfolder `name` of the study's folder, or resume the training there, and read the best weights.
/// @param model receives the model; release it with bat_mesh_model_free()
bat_status mesh_study_train(const bat_mesh *shapes, size_t count, const bat_mesh_study_options *options, const char *name,
                            bat_mesh_train_options recipe, bat_mesh_train_report *report, bat_mesh_model **model,
                            bat_error *error);

/// Decimate a shape by quadric errors to the study's number of vertices.
bat_status mesh_study_decimate(const bat_mesh *shape, const bat_mesh_study_options *options, bat_progress progress,
                               bat_mesh *coarse, bat_error *error);

/// Subdivide a coarse mesh and measure its distance from the shape. `fine` may be null.
bat_status mesh_study_score(const bat_mesh *shape, const bat_mesh *coarse, const bat_mesh_method *method,
                            const bat_mesh_study_options *options, bat_progress progress, bat_mesh *fine,
                            bat_mesh_score *score, bat_error *error);

#endif
