#pragma once

#include "base/memory.h"
#include "batten/surface_file.h"
#include "surface/spline/tensor_surface.h"

/// @file
/// Tessellation of spline surfaces into grids of quads and into triangles without cracks.

/// A surface sampled on a grid in each cell. Cells share the points of their borders. Release it with tessellation_free().
typedef struct surface_tessellation
{
    memory_pool pool;
    size_t vertex_count;
    size_t grid_count;  ///< the number of vertices of quads, which come first
    double *parameters; ///< vertex_count x 2
    double *positions;  ///< vertex_count x 3
    double *normals; ///< vertex_count x 3: unit vectors along S_u x S_v; where that is zero, the normal at a nearby interior
                     ///< point

    size_t quad_count;
    /// quad_count x 4, counter-clockwise from the lower left; finer neighbours are ignored
    uint32_t *quads;
    /// quad_count: the level of its cell. A trimmed surface has no quads, and triangle_count levels
    uint32_t *levels;

    size_t triangle_count;
    uint32_t *triangles; ///< triangle_count x 3, counter-clockwise: a manifold with all border points
} surface_tessellation;

/// Tessellate a surface.
/// @param surface of dimension 3
/// @param samples of each cell and direction; 0: the degree plus 1
/// @return BAT_OK; BAT_TOO_LARGE beyond 2^32 - 1 vertices or lattice points along a side; BAT_NO_MEMORY
bat_status surface_tessellate(const bat_spline_surface *surface, size_t samples, surface_tessellation *tessellation,
                              bat_error *error);
void tessellation_free(surface_tessellation *tessellation);

// The geometry and topology of a STEP file: patches, and vertices, edges and loops of their rectangles in the square.

// A hierarchical surface as one tensor-product surface, with its trimming curves in space, for CAD files.

/// The curve of an edge: its image; a line, with a place before its first point; or a circle around a place and an axis.
typedef struct shape_curve
{
    enum
    {
        SHAPE_SPLINE,
        SHAPE_LINE,
        SHAPE_CIRCLE
    } kind;
    double place[3], axis[3], radius;
} shape_curve;

/// A simple shape that replaces the surface, in a frame around its axis whose first axis is opposite to the outline.
typedef struct shape_model
{
    bat_surface_primitive shape; ///< of kind BAT_SURFACE_PRIMITIVE_NONE where the surface stays
    double axes[3][3];
    double height; ///< of the outline's first point
    double area;   ///< negative where the shape's normal is opposite to that of the surface
} shape_model;

/// The model. Release it with trimmed_model_free().
typedef struct trimmed_model
{
    const bat_spline_surface *source;
    shape_model shape;
    shape_curve *curves;         ///< of each image
    tensor_surface surface;      ///< over the grid of the finest level
    const bat_spline_trim *trim; ///< of the hierarchical surface
    bat_spline_curve *images;    ///< of each trimming curve: the curve in space, with the same parameters
    size_t piece_count;
    double tolerance; ///< points at smaller distances are identified
} trimmed_model;

/// Make the model, with images on a simple shape where one is given.
/// @param shape null for none
/// @return BAT_OK; BAT_TOO_LARGE where the finest level has more than 2^20 functions; BAT_NO_MEMORY
bat_status trimmed_model_make(const bat_spline_surface *surface, const bat_surface_primitive *shape, trimmed_model *model,
                              bat_error *error);
void trimmed_model_free(trimmed_model *model);

/// Choose axes.
/// @param middle a point of the surface
void shape_model_begin(const bat_surface_primitive *shape, const double middle[3], shape_model *model);
/// The nearest point of the shape.
void shape_model_project(const shape_model *model, const double point[3], double foot[3]);
/// Choose the curves of edges, and measure the shape. False where it needs a seam or a pole.
bool shape_model_end(trimmed_model *model);

/// The power of ten below the diagonal of the box of control points, times 1e-7.
double model_tolerance(const tensor_surface *patches, size_t count);

/// Write a real number, which has a decimal point in CAD files.
/// @param out    has room for NUMBER_TEXT_SIZE + 1 characters
/// @param letter of the exponent
/// @return the end of the text
char *model_real(char *out, double value, char letter);

/// A rectangle on a lattice.
typedef struct shell_face
{
    uint64_t low[2], high[2];
} shell_face;

/// A straight edge between two neighbouring vertices on a line.
typedef struct shell_edge
{
    uint32_t from, to;  ///< vertices, in the direction of increasing u or v
    uint32_t direction; ///< 0: along u; 1: along v
    uint32_t faces[2];  ///< the second is SHELL_NONE on the border of the square
    uint32_t sides[2];  ///< the side of each face: 0 v = low, 1 u = high, 2 v = high, 3 u = low
} shell_edge;

#define SHELL_NONE UINT32_MAX

/// An edge in the loop of a face.
typedef struct shell_use
{
    uint32_t edge;
    bool backward; ///< against its direction
} shell_use;

/// The topology; release it with shell_free().
typedef struct surface_shell
{
    memory_pool pool;
    size_t vertex_count;
    uint64_t *vertices; ///< vertex_count x 2: all corners of faces, each once, sorted by v and then u
    size_t edge_count;
    shell_edge *edges;
    size_t face_count;
    size_t *loops;   ///< face_count + 1: the start of each face's loop
    shell_use *uses; ///< counter-clockwise from the lower left corner
} surface_shell;

/// Compute the topology of rectangles that tile a square: vertices, edges between neighbours, the loop of each face.
/// @return BAT_OK; BAT_TOO_LARGE beyond 2^29 faces; BAT_NO_MEMORY
bat_status shell_make(const shell_face *faces, size_t count, surface_shell *shell, bat_error *error);
void shell_free(surface_shell *shell);

/// The patches of a surface and their topology. Release it with step_model_free().
typedef struct step_model
{
    memory_pool pool;
    tensor_surface *patches; ///< face_count patches, clamped
    surface_shell shell;
    double tolerance; ///< points at smaller distances are identified
    double *points;   ///< 3 x vertex_count: positions
    uint32_t *
        same; ///< vertex_count: the representative of each vertex; vertices on sides that are collapsed to a point share one
    bool *collapsed;        ///< edge_count: whether the edge is collapsed to a point
    bat_knot_vector *knots; ///< edge_count: the knots of the edges' curves
    double **control;       ///< edge_count: the control points of the edges' curves
    uint32_t *pieces;       ///< face_count: the connected part of each face; null: all one open part
    size_t piece_count;
    bool *closed;     ///< piece_count: the part has no boundary
    uint32_t *around; ///< piece_count: the solid whose void the part surrounds; the part itself for others
} step_model;

bat_status step_model_make(const bat_spline_surface *surface, step_model *model, bat_error *error);
/// The same of a shell: a patch of each face, of splines whose first derivatives are continuous.
bat_status shell_model_make(const bat_shell *shell, step_model *model, bat_error *error);
void step_model_free(step_model *model);
