#ifndef IO_SURFACE_STEP_H
#define IO_SURFACE_STEP_H

#include "batten/spline.h"
#include "io/common/block_writer.h"
#include "io/surface/shell.h"
#include "surface/spline/tensor_surface.h"

/// @file
/// STEP files of surfaces: the clear-text encoding of ISO 10303-21 with numbered entities, and the geometry and topology of
/// the file.

/// A STEP file during writing. All zero except for `sink`: no entities yet.
typedef struct step_text
{
    text_sink *sink;
    text_buffer text; ///< text that is not in the sink yet
    size_t line;      ///< the start of its last line
    uint32_t count;   ///< the number of entities, which is the number of the last one
    bool separate;    ///< the next item of a list needs a comma before it
} step_text;

/// Append text without real numbers.
void step_plain(step_text *step, const char *format, ...) __attribute__((format(printf, 2, 3)));
/// Append a real number; STEP requires a decimal point.
void step_real(step_text *step, double value);

/// Begin an entity: `#number=text`. Returns its number.
uint32_t step_begin(step_text *step, const char *text);
/// End an entity: `text;`. Passes the text to the sink when there is enough.
bat_status step_end(step_text *step, const char *text, bat_error *error);

/// Lists: `(`, items separated by commas, `)`. Long lines are broken.
void step_list_begin(step_text *step);
void step_list_reference(step_text *step, uint32_t entity);
void step_list_real(step_text *step, double value);
void step_list_whole(step_text *step, size_t value);
void step_list_end(step_text *step);

/// Write a CARTESIAN_POINT with 2 or 3 coordinates. Returns its number.
uint32_t step_point(step_text *step, const double *point, size_t dimension);

/// Write the remaining text and release it.
bat_status step_finish(step_text *step, bat_status status, bat_error *error);

/// The patches of a surface and their topology. Release it with step_model_free().
typedef struct step_model
{
    tensor_surface *patches; ///< face_count patches, clamped
    surface_shell shell;
    double tolerance; ///< points at smaller distances are identified
    double *points;   ///< 3 x vertex_count: positions
    uint32_t *
        same; ///< vertex_count: the representative of each vertex; vertices on sides that are collapsed to a point share one
    bool *collapsed;        ///< edge_count: whether the edge is collapsed to a point
    bat_knot_vector *knots; ///< edge_count: the knots of the edges' curves
    double **control;       ///< edge_count: the control points of the edges' curves
} step_model;

bat_status step_model_make(const bat_spline_surface *surface, step_model *model, bat_error *error);
void step_model_free(step_model *model);

#endif
