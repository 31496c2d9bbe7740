#ifndef IO_SURFACE_SURFACE_STEP_H
#define IO_SURFACE_SURFACE_STEP_H

#include "batten/spline_hierarchical.h"
#include "io/surface/step_text.h"
#include "io/surface/surface_shell.h"

/// @file
/// The parts of a STEP file of a surface.

/// The pieces of a surface and how they meet. Release it with step_model_free().
typedef struct step_model
{
    bat_tensor_surface *patches; ///< face_count of the shell, clamped
    surface_shell shell;
    double tolerance;       ///< below what points count as one
    double *points;         ///< 3 x vertex_count: where the vertices are
    uint32_t *same;         ///< vertex_count: the vertex that stands for each; others only where sides have shrunk to points
    bool *collapsed;        ///< edge_count: those that have
    bat_knot_vector *knots; ///< edge_count: of the edges' curves
    double **control;       ///< edge_count: their control points
} step_model;

bat_status step_model_make(const bat_spline_surface *surface, step_model *model, bat_error *error);
void step_model_free(step_model *model);

#endif
