#ifndef SURFACE_PARAMETERIZE_WEIGHTS_H
#define SURFACE_PARAMETERIZE_WEIGHTS_H

#include "batten/cloud_parameterize.h"
#include "linalg/sparse_rows.h"
#include "surface/cloud/neighbours.h"
#include "surface/cloud/spatial_order.h"

/// @file
/// Weights w_ik > 0 with sum_k w_ik = 1, which make the parameter of each interior point a convex combination of its
/// neighbours' parameters. A sparse matrix has one row for each interior point, in order, and one column for each point of
/// the cloud.

/// The input of weight computations.
typedef struct weight_source
{
    const bat_cloud *cloud;
    const neighbour_tree *tree; ///< tree of the cloud's points
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
bat_status weights_make(const bat_cloud *cloud, const neighbour_tree *tree, const bat_cloud_parameterize_options *options,
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

/// Connect all points to the boundary. Points without a chain of weights to it are linked to their nearest connected
/// neighbours, the closest first.
bat_status weights_join(const bat_cloud *cloud, sparse_rows *rows, bat_error *error);

/// The longest side of the bounding box of the points.
double weights_longest_side(const bat_cloud *cloud);

#endif
