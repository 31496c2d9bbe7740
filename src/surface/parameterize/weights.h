#pragma once

#include "batten/cloud_parameterize.h"
#include "linalg/multifrontal.h"
#include "linalg/sparse.h"
#include "surface/cloud/spatial_order.h"

/// @file
/// Weights w_ik > 0 with sum_k w_ik = 1, which make the parameter of each interior point a convex combination of its
/// neighbours' parameters. A sparse matrix has one row for each interior point, in order, and one column for each point of
/// the cloud.

/// The input of weight computations.
typedef struct weight_source
{
    const bat_cloud *cloud;
    const nearest_tree *tree; ///< tree of the cloud's points
    bat_cloud_parameterization method;
    double radius; ///< radius of neighbourhoods in the units of the cloud; 0: adaptive
} weight_source;

/// Workspace of one thread, initially all zero. Release it with weight_scratch_free().
typedef struct weight_scratch
{
    neighbour_list near;
    double (*planar)[2];
    double (*inverse)[2];
    size_t capacity;
} weight_scratch;

void weight_scratch_free(weight_scratch *scratch);
/// Reserve memory for `count` planar points and their inverses.
bat_status weight_scratch_reserve(weight_scratch *scratch, size_t count, bat_error *error);

/// Consecutive rows under construction.
typedef struct weight_chunk
{
    uint32_t *columns;
    double *values;
    size_t count, capacity;
} weight_chunk;

/// Reserve memory for `more` entries, which the caller then appends.
bat_status weight_chunk_reserve(weight_chunk *chunk, size_t more, bat_error *error);

/// Append the weights of one point.
typedef bat_status weight_maker(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                                bat_error *error);

/// All rows by the method of the options, with adaptive neighbourhoods, and every point connected to the boundary.
/// @return BAT_OK; BAT_NO_CONVERGENCE for mean values at a point without triangles; BAT_NO_MEMORY
bat_status weights_make(const bat_cloud *cloud, const nearest_tree *tree, const bat_cloud_parameterize_options *options,
                        sparse_rows *rows, bat_error *error);

/// All rows by a weight function, in parallel.
bat_status weights_build(const weight_source *source, weight_maker *maker, int threads, sparse_rows *rows, bat_error *error);

/// Uniform or inverse-distance weights of all points within the radius; BAT_NO_CONVERGENCE if there are none.
bat_status weights_of_ball(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                           bat_error *error);
/// Shape-preserving weights as published: of the point's neighbours in the Delaunay triangulation (by Qhull) of all points
/// within the radius, projected to their best-fitting plane. BAT_NO_CONVERGENCE if there are fewer than three, if they are
/// collinear, or if the point is on their hull.
bat_status weights_of_triangulated_ball(const weight_source *source, weight_scratch *scratch, size_t point,
                                        weight_chunk *chunk, bat_error *error);

/// Uniform or inverse-distance weights of the nearest points. Fails only for lack of memory.
bat_status weights_of_nearest(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                              bat_error *error);
/// Shape-preserving weights of the star in the best-fitting plane of an adaptive neighbourhood (local_plane.h). If no star
/// closes around the point, inverse-distance weights. Fails only for lack of memory.
bat_status weights_of_star(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                           bat_error *error);

/// Mean-value weights of the cloud's triangles (Floater 2003).
/// @return BAT_OK, BAT_NO_CONVERGENCE for a point without triangles, BAT_NO_MEMORY
bat_status weights_of_triangles(const bat_cloud *cloud, sparse_rows *rows, bat_error *error);

/// The first interior point that is not connected to the boundary by a chain of weights; BAT_NO_INDEX for none.
bat_status weights_find_unjoined(const bat_cloud *cloud, const sparse_rows *rows, size_t *point, bat_error *error);

/// The longest side of the bounding box of the points.
double weights_longest_side(const bat_cloud *cloud);

// Solution of u_i = sum_k w_ik u_k for the parameters of interior points, w_ik >= 0, sum_k w_ik = 1, with the other
// parameters fixed: Floater and Reimers, "Meshless parameterization and surface reconstruction" (2001).

/// Check that the boundary of a cloud is known, and its parameters finite.
/// @return BAT_OK or BAT_INVALID_ARGUMENT
bat_status boundary_parameters_check(const bat_cloud *cloud, const double *boundary, bat_error *error);

/// Twice the signed area that the boundary parameters enclose.
double boundary_area(const bat_cloud *cloud, const double *parameters);

/// Points that are folded, outside or coincident.
size_t fault_count(const bat_cloud_parameters_report *report);

/// Solve for some interior points.
/// @param rows       weights from weights_build(), with every point connected to the boundary
/// @param moved      count: the points to solve for, none on the boundary; null for the whole interior
/// @param parameters count x 2; fixed ones are read, the others receive values in the bounding box of the fixed ones
/// @return BAT_OK, BAT_NO_CONVERGENCE or BAT_NO_MEMORY
bat_status averages_solve(const bat_cloud *cloud, const sparse_rows *rows, const bool *moved, double *parameters,
                          bat_error *error);

// Stretch minimization for clouds: Yoshizawa, Belyaev and Seidel, "Fast and simple stretch-minimizing" (2004).
//
// With s_k the stretch at point k, weights are updated by  w_ik <- w_ik / s_k  (rows rescaled to sum 1). The parameters are
// then solved for again. This is repeated while the total stretch decreases. The stretch at a point is the root mean square
// of the singular values of the derivative dx/du, fitted to the neighbours of its row by least squares. The total stretch
// is the root mean square over the interior.

/// Minimize the stretch of parameters.
/// @param rows       weights that the parameters satisfy; changed by every round, including a last one that is rejected
/// @param parameters count x 2
/// @return see averages_solve()
bat_status stretch_minimize(const bat_cloud *cloud, sparse_rows *rows, bat_progress progress, double *parameters,
                            bat_error *error);

// Parameters of least distortion. The points are triangulated in given parameters (Floater and Reimers, 2001). Then the
// symmetric Dirichlet energy of the triangles is minimized (weights.h). The triangles of a mesh are its own, with new
// points in the middles of edges that join boundary points through the interior.

/// Minimize the distortion of parameters.
/// @param cloud      points in spatial order, scaled to unit size, with a boundary
/// @param rows       weights that the parameters satisfy; changed where points crowd, which are spread first
/// @param parameters count x 2, in [0, 1]^2; unchanged where they have no triangulation without degenerate triangles
/// @return see averages_solve()
bat_status isometric_minimize(const bat_cloud *cloud, sparse_rows *rows, bat_progress progress, double *parameters,
                              bat_error *error);

// The star of the origin in the plane: its Delaunay neighbours, and convex weights of these that reproduce it.

#define STAR_MAX_RING 64 ///< maximum number of neighbours

/// The neighbours of the origin in the Delaunay triangulation of the origin and `count` points, counter-clockwise. They are
/// the corners of the convex hull of the origin and the points p / |p|^2, which is polar to the Voronoi cell of the origin.
/// Of cocircular points, as few as possible are corners. Points at the origin are ignored.
/// @param inverse workspace of `count` pairs
/// @param closed  whether the neighbours surround the origin; if not, the origin is on the convex hull, and the gap is after
///        the last
/// @return the number of neighbours; 0 if there are more than STAR_MAX_RING
size_t star_find(const double (*planar)[2], size_t count, double (*inverse)[2], size_t ring[STAR_MAX_RING], bool *closed);

/// Shape-preserving weights (Floater 1997, section 6). Each corner l forms a triangle with the side of the ring that the ray
/// from l through the origin meets. The weights are the mean over l of the barycentric coordinates of the origin in these
/// triangles.
/// @param ring    corners about the origin, counter-clockwise, each less than half a turn after the one before
/// @param weights receives positive weights with sum 1
void star_shape_preserving(const double (*ring)[2], size_t count, double *weights);

/// Map a ring in space to the plane by the geodesic polar map: spokes keep their lengths, angles sum to a full turn.
/// @param spokes vectors from the centre to the ring
/// @return false if a scaled angle reaches half a turn
bool star_unfold(const double (*spokes)[3], size_t count, double (*ring)[2]);

/// The neighbours of the point `middle` in the Delaunay triangulation of `count` points in the plane, computed by Qhull,
/// counter-clockwise. They do not surround a point on the convex hull.
/// @param ring_count receives 0 if there is no triangulation, if the point coincides with another one, or if it has fewer
///        than 3 or more than STAR_MAX_RING neighbours
/// @return BAT_OK or BAT_NO_MEMORY
bat_status triangulated_star_find(const double (*planar)[2], size_t count, size_t middle, size_t ring[STAR_MAX_RING],
                                  size_t *ring_count, bat_error *error);

// The symmetric Dirichlet energy of a map from triangles in space to the unit square, and its minimization.
//     E = sum over triangles of area (s_1^2 + s_2^2 + s_1^-2 + s_2^-2).
// s_1 and s_2 are the singular values of the map on a triangle. Triangles are scaled so that their total area is that of
// the square. The energy is infinite where a triangle degenerates, so that no triangle turns over. Points of the
// boundary slide along their side of the square; those at its corners stay.

enum
{
    DIRICHLET_UNKNOWNS = 6, ///< of a triangle
    DIRICHLET_ENTRIES = DIRICHLET_UNKNOWNS * (DIRICHLET_UNKNOWNS + 1) / 2
};

/// A triangle: gradients of the hat functions of its corners in its plane, and its area. The sum over corners of
/// parameter_k gradient_k^T is the derivative of the map to the parameters.
typedef struct dirichlet_triangle
{
    uint32_t corners[3];
    double gradient[3][2];
    double area;
    int entries[DIRICHLET_ENTRIES]; ///< of its unknowns' pairs (a, b), b <= a, in the matrix; negative for none
} dirichlet_triangle;

/// A map, its matrix and its solver. All zero: empty. Release it with dirichlet_free().
typedef struct dirichlet_map
{
    memory_pool pool; ///< all arrays
    dirichlet_triangle *triangles;
    size_t triangle_count;
    size_t point_count, boundary_count; ///< points of the boundary come first
    double *parameters, *next;          ///< point_count x 2
    int *unknown;                       ///< point_count x 2: unknowns of the coordinates, negative for coordinates that stay
    size_t unknowns;
    int *first; ///< unknowns + 1, of the pattern
    int *row;
    multifrontal *solver; ///< null: nothing moves
    double *values;       ///< of the matrix
    double *direction;    ///< unknowns
} dirichlet_map;

void dirichlet_free(dirichlet_map *map);

/// Measure triangles in space, scaled to the total area 1.
/// @param points    point_count x 3
/// @param triangles triangle_count x 3
/// @return BAT_OK or BAT_NO_MEMORY
bat_status dirichlet_measure(const double *points, const uint32_t *triangles, size_t triangle_count, dirichlet_map *map,
                             bat_error *error);

/// The energy of parameters; infinite where a triangle is degenerate or turned over.
double dirichlet_energy(const dirichlet_map *map, const double *parameters);

/// Number the unknowns, make the matrix and its solver. The map has triangles and parameters.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status dirichlet_prepare(dirichlet_map *map, bat_error *error);

/// Minimize the energy from parameters whose energy is finite.
/// @return BAT_OK, BAT_NO_MEMORY, BAT_CANCELLED
bat_status dirichlet_minimize(dirichlet_map *map, bat_progress progress, bat_error *error);
