#pragma once

#include "batten/mesh_decimate.h"
#include "batten/shell.h"
#include "linalg/sparse.h"
#include "surface/cloud/local_plane.h"

#include <math.h>

/// @file
/// The steps from points to a shell: connection, layout, grid of control points, patches, fit, judgement.
/// docs/algorithms/shells.md describes them. Statuses other than those of the calls inside are named.

// The connection: a mesh of triangles near the points.

#define SHELL_SPACING_POINTS 7 ///< nearest points that tell the spacing of the points around a place

/// The spacing: the side of the square that each point has for itself.
static inline double shell_spacing(const neighbour_list *near)
{
    return 1.7724538509055159 * sqrt(near->entries[near->count - 1].squared / SHELL_SPACING_POINTS);
}

/// Points and what is known of them.
typedef struct shell_cloud
{
    const double *points; ///< count x 3, distinct
    size_t count;
    const nearest_tree *tree; ///< of the points
    double spacing;           ///< median distance of neighbours
    double noise;             ///< standard deviation of a coordinate, from neighbourhoods
    double share;             ///< of the spacing, or of the noise where that is more: the wanted size of a cell
    double cell;              ///< of the grid that connects them: details below it are lost
    const double *areas;      ///< count: the area that each point has for itself
} shell_cloud;

/// What can be reached from far away between the points.
typedef struct shell_outside
{
    double cell, origin[3];
    size_t size[3];
    uint8_t *marks; ///< of the cells
    bool closed;    ///< it leaves an inside
} shell_outside;

/// Whether a place is outside.
bool shell_is_outside(const shell_outside *outside, const double *place);

/// Turn normals outwards: of a closed surface to the outside; of an open one all alike, to the side from which more
/// directions lead away freely.
/// @param outside receives the outside; its marks are of the pool
bat_status shell_orient(const shell_cloud *cloud, oriented_planes *planes, memory_pool *pool, shell_outside *outside,
                        bat_error *error);

/// Make the zero level of a smooth function whose gradients are the normals of the points.
/// @param cloud   receives the spacing, the noise and the cell
/// @param mesh    receives the mesh, with outward normals where it is closed
/// @param normals receives the outward normals of the points, count x 3; may be null
bat_status shell_connect(shell_cloud *cloud, bat_progress progress, bat_mesh *mesh, double *normals, bat_error *error);

/// Distances of places from the nearest point, in spacings of the points around that one, or in `least` where these are
/// less.
/// @param less what is taken off the distances first
bat_status shell_distances(const double *points, const nearest_tree *tree, const double *places, size_t place_count,
                           double less, double least, double *distances, bat_error *error);

/// Leave out pieces that few points support, and open the holes of the points: parts of the mesh that are far from all
/// points, in local spacings.
/// @param fill diameter of holes that stay closed all the same
bat_status shell_open_holes(const shell_cloud *cloud, double fill, bat_mesh *mesh, bat_shell_report *report,
                            bat_error *error);

/// Even out the last vertices of a mesh, or its boundary loops where `first` is the number of vertices, and those beside.
/// @param ring_count of vertices that move, beginning with those
bat_status shell_even_out(bat_mesh *mesh, size_t first, uint8_t ring_count, int rounds, bat_error *error);

/// Cut tunnels and bridges of the mesh that the points contradict, and close both sides.
bat_status shell_cut_handles(const shell_cloud *cloud, bat_mesh *mesh, bat_shell_report *report, bat_error *error);

/// Put sharp edges of the points as creases into a copy of the mesh that connects them, where that leaves no folds.
/// @param outwards normals of the points, count x 3; their sides alone matter
/// @param angle    least angle between the normals of the two sides
/// @param creased  receives the copy; empty when there is no crease
bat_status shell_find_creases(const shell_cloud *cloud, const double *outwards, double angle, const bat_mesh *mesh,
                              bat_mesh *creased, bat_error *error);

// The layout: a coarse mesh of quads, each of which becomes a face of the shell.

/// Where the corners of a triangle of the decimated mesh lie.
typedef struct shell_triangle
{
    uint32_t face;      ///< the first face of the layout in its polygon; face k begins at corner k
    uint8_t corners[3]; ///< the corners of the polygon
    bool paired;        ///< the polygon is made of two triangles
} shell_triangle;

/// A layout. Release it with shell_layout_free().
typedef struct shell_layout
{
    size_t vertex_count, face_count;
    uint32_t *quads;   ///< face_count x 4, counter-clockwise from outside
    double *positions; ///< vertex_count x 3
    bool *sharp;       ///< face_count x 4: whether the side from each corner is a crease; boundaries are sharp anyway
    bool *corner;      ///< vertex_count: whether creases end in a corner there
    bat_mesh_map *map; ///< between the mesh and its decimation
    shell_triangle *triangles; ///< of the decimation
    memory_pool pool;
} shell_layout;

/// A place on a shell: a face and parameters, or a quad of the grid and parameters of its patch.
typedef struct shell_place
{
    uint32_t face;
    double u, v; ///< 0 to 1
} shell_place;

/// Make a layout from a mesh: decimate it, pair triangles into quads, and split all faces once.
/// @param mesh    of triangles, manifold; its creases become creases of the layout
/// @param faces   the wanted number of faces
/// @param exact   with creases: thinner triangles, for no more faces
/// @param normals weight of the mesh's channels in the error of the decimation
bat_status shell_layout_make(const bat_mesh *mesh, size_t faces, bool exact, double normals, shell_layout *layout,
                             bat_error *error);
void shell_layout_free(shell_layout *layout);

/// The places on the layout of points of the mesh.
/// @param points changed to points of the decimated mesh
bat_status shell_layout_places(const shell_layout *layout, bat_mesh_point *points, size_t count, shell_place *places,
                               bat_error *error);

// The grid: control points of all faces, spans x spans quads in each. A quad is the control point mesh of one bicubic patch.
// Corner 0 of a face or quad has the parameters (0, 0), corner 1 (1, 0), corner 2 (1, 1), corner 3 (0, 1).

typedef enum shell_kind
{
    SHELL_SMOOTH,
    SHELL_CREASE, ///< on a crease, or on the boundary
    SHELL_CORNER
} shell_kind;

/// The grid. Release it with shell_grid_free().
typedef struct shell_grid
{
    size_t spans; ///< of a face and direction, at least 2
    size_t face_count, quad_count, vertex_count;
    uint32_t *quads; ///< quad_count x 4; quad (i, j) of face f is (f spans + j) spans + i
    bat_mesh_connectivity links;
    bool *sharp;    ///< quad_count x 4: of each half-edge
    uint8_t *kinds; ///< vertex_count: shell_kind
    /// The points of patches as averages of control points. Rows: the limit of each vertex; for each half-edge the Bézier
    /// point after its begin; for each half-edge the interior Bézier point beside its begin; for each half-edge on a
    /// boundary the Bézier point before its end.
    sparse_rows rows;
    memory_pool pool;
} shell_grid;

/// Make the grid of a layout with its rows.
bat_status shell_grid_make(const shell_layout *layout, size_t spans, shell_grid *grid, bat_error *error);
void shell_grid_free(shell_grid *grid);

/// Quads with their neighbours.
typedef struct shell_quads
{
    const uint32_t *corners;
    size_t vertex_count, count;
    const bat_mesh_connectivity *links;
} shell_quads;

/// The number of a point of a finer grid: (i, j) of a quad, 0 to `parts` each. The quads' vertices come first, then points
/// on edges, then those inside quads.
uint32_t shell_quads_point(const shell_quads *quads, size_t parts, uint32_t quad, size_t i, size_t j);
/// How many they are.
size_t shell_quads_points(const shell_quads *quads, size_t parts);

/// The row of each of the 4 x 4 Bézier points of a quad, u fastest.
void shell_grid_patch(const shell_grid *grid, uint32_t quad, size_t rows[16]);

/// The Bézier points of all quads.
/// @param control vertex_count x 3
/// @param bezier  receives quad_count x 16 x 3
bat_status shell_grid_bezier(const shell_grid *grid, const double *control, double *bezier, bat_error *error);

/// The four cubic Bernstein polynomials, and their derivatives where `slopes` isn't null.
void shell_bernstein(double t, double values[4], double *slopes);

/// Point and derivatives of a bicubic patch.
/// @param along derivatives by u and by v; may be null
void shell_patch_evaluate(const double *bezier, double u, double v, double point[3], double along[2][3]);

/// The first of: point, derivatives by u, v, uu, uv and vv of a bicubic patch.
void shell_patch_derivatives(const double *bezier, double u, double v, size_t count, double *at);

/// The angle between the normals of two patches at a place of a half-edge that both share.
double shell_jump(const shell_grid *grid, const double *bezier, uint32_t half_edge, double t);

/// Move a place to the nearest one on the patches around, by Gauss-Newton steps across their sides.
/// @param place of a quad of the grid
/// @return the squared distance
double shell_place_correct(const shell_grid *grid, const double *bezier, const double point[3], int steps,
                           shell_place *place);

// The fit of a grid to points.

/// Points with places on a grid, and the control points that are fitted to them.
typedef struct shell_fit
{
    const shell_grid *grid;
    const double *points; ///< count x 3
    size_t count;
    size_t moving;       ///< of these, the first ones: their places are corrected. Lambda stays where others follow
    shell_place *places; ///< count: on quads of the grid; changed by corrections
    const bool *held;    ///< count: points that are left out of the fit; null: none
    const double *start; ///< vertex_count x 3: places of the control points on the layout, which scale the smoothing
    double *control;     ///< vertex_count x 3: the result
    double *bezier;      ///< quad_count x 16 x 3: of the result
    double *squared;     ///< count: squared distances from the result
    double unbias;       ///< variance of a coordinate, whose bias on curved surfaces is taken off; 0: none
    double stiffness;    ///< factor of the noise that is assumed; 1
    double *stiff;       ///< vertex_count: factors of the smoothing, which grow where normals jump
    double lambda;       ///< the smoothing weight of the last round; 0 at the start
    double trace;        ///< of the influence matrix: the number of free parameters of a coordinate
    int threads;
    bat_progress progress;
} shell_fit;

/// Fit control points by penalized least squares, and correct places, in rounds.
bat_status shell_fit_run(shell_fit *fit, int rounds, bat_error *error);

/// The squared distances of the points from the patches, at corrected places.
void shell_fit_correct(const shell_fit *fit);

/// Move Bézier points along normals, so that normals agree across the sides where they jump.
bat_status shell_agree(const shell_grid *grid, double *bezier, bat_error *error);

// The judgement.

/// The number of patches that cross others.
bat_status shell_count_crossings(const bat_shell *shell, size_t *crossings, bat_error *error);

/// Mark the vertices of quads that fold: their normal is against the mesh's, or differs from a neighbour's by 30 degrees.
/// @param count receives the number of such places and sides
bat_status shell_find_folds(const shell_fit *fit, const bat_mesh *mesh, bool *marks, size_t *count, bat_error *error);

/// Measure a shell by its points and by the mesh that connects them.
bat_status shell_measure(const bat_shell *shell, const shell_fit *fit, const bat_mesh *mesh, bat_shell_report *report,
                         bat_error *error);

typedef enum shell_fault
{
    SHELL_RIGHT,
    SHELL_SHEETS, ///< the shell runs between two sheets of points, nearer to each other than their points
    SHELL_MISSED  ///< a part of the points is far from the shell
} shell_fault;

/// What the points beside each other say against a shell that was measured.
/// @param worst receives a point there
bat_status shell_find_fault(const shell_fit *fit, const bat_shell_report *report, shell_fault *fault, size_t *worst,
                            bat_error *error);

/// BAT_OK, or BAT_NO_CONVERGENCE with a text of what is wrong.
/// @param noise estimated from neighbourhoods of the points
bat_status shell_judge(const bat_shell *shell, const bat_shell_report *report, double noise, bat_error *error);
