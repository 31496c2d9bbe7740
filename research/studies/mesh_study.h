#ifndef RESEARCH_STUDIES_MESH_STUDY_H
#define RESEARCH_STUDIES_MESH_STUDY_H

#include "batten/mesh_refine.h"
#include "batten/research/mesh_study.h"

/// @file
/// What the studies of learned subdivision share.

/// Whether numbers and folder are such that a study can train.
bat_status mesh_study_check_training(const bat_mesh_study_options *options, bat_error *error);

/// The published recipe with the study's numbers, its rate falling.
bat_mesh_train_options mesh_study_recipe(const bat_mesh_study_options *options);

/// Train by a recipe into the folder `name` of the study's, or go on with what is there, and read the best weights.
/// @param model receives it; release it with bat_mesh_model_free()
bat_status mesh_study_train(const bat_mesh *shapes, size_t count, const bat_mesh_study_options *options, const char *name,
                            bat_mesh_train_options recipe, bat_mesh_train_report *report, bat_mesh_model **model,
                            bat_error *error);

/// Decimate a shape as a study does.
bat_status mesh_study_decimate(const bat_mesh *shape, const bat_mesh_study_options *options, bat_progress progress,
                               bat_mesh *coarse, bat_error *error);

/// Subdivide a coarse mesh and measure how far that is from the shape. `fine` may be null.
bat_status mesh_study_score(const bat_mesh *shape, const bat_mesh *coarse, const bat_mesh_method *method,
                            const bat_mesh_study_options *options, bat_progress progress, bat_mesh *fine,
                            bat_mesh_score *score, bat_error *error);

#endif
