#ifndef IO_SURFACE_STEP_H
#define IO_SURFACE_STEP_H

#include "batten/spline_hierarchical.h"
#include "io/common/block_writer.h"
#include "io/surface/shell.h"

/// @file
/// The clear-text encoding of ISO 10303-21: numbered entities.

/// Where entities go. All zero but `sink`: none yet.
typedef struct step_text
{
    text_sink *sink;
    text_buffer text; ///< not yet in the sink
    size_t line;      ///< where its last line begins
    uint32_t count;   ///< of entities so far: the number of the last one
    bool separate;    ///< whether the next item of a list needs a comma before it
} step_text;

/// Append plain text that holds no real numbers.
void step_plain(step_text *step, const char *format, ...) __attribute__((format(printf, 2, 3)));
/// Append a real number, which has a decimal point here.
void step_real(step_text *step, double value);

/// Begin the next entity: `#number=text`. Returns its number.
uint32_t step_begin(step_text *step, const char *text);
/// End an entity: `text;`. The text goes to the sink now and then.
bat_status step_end(step_text *step, const char *text, bat_error *error);

/// Lists: `(`, items with commas, `)`. The line is broken when it is long.
void step_list_begin(step_text *step);
void step_list_reference(step_text *step, uint32_t entity);
void step_list_real(step_text *step, double value);
void step_list_whole(step_text *step, size_t value);
void step_list_end(step_text *step);

/// A whole entity: CARTESIAN_POINT. Returns its number.
uint32_t step_point(step_text *step, const double point[3]);

/// Write what is left, and free it.
bat_status step_finish(step_text *step, bat_status status, bat_error *error);

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
