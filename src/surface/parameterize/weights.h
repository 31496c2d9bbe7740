#ifndef SURFACE_PARAMETERIZE_WEIGHTS_H
#define SURFACE_PARAMETERIZE_WEIGHTS_H

#include "batten/cloud_parameterize.h"
#include "linalg/sparse_rows.h"
#include "surface/cloud/neighbours.h"

/// @file
/// Weights that make each interior point's parameter an average of its neighbours': one row for each interior point, in
/// their order, a column for each point of the cloud. Weights are above 0 and sum to 1.

/// What neighbourhoods are found with.
typedef struct weight_source
{
    const bat_cloud *cloud;
    const neighbour_tree *tree; ///< of the cloud's points
    bat_cloud_parameterization method;
    double radius; ///< in the cloud's units; 0 where every point has its own
} weight_source;

/// What one thread works with. All zero to begin with; release it with weight_scratch_free().
typedef struct weight_scratch
{
    neighbour_list near;
    double (*planar)[2];
    double (*inverse)[2];
    size_t capacity;
} weight_scratch;

void weight_scratch_free(weight_scratch *scratch);
/// Room for `count` planar points and their inverses.
bat_status weight_scratch_reserve(weight_scratch *scratch, size_t count, bat_error *error);

/// Some consecutive rows while they are made.
typedef struct weight_chunk
{
    uint32_t *columns;
    double *values;
    size_t count, capacity;
} weight_chunk;

/// Room for `more` entries, which the caller then appends.
bat_status weight_chunk_reserve(weight_chunk *chunk, size_t more, bat_error *error);

/// Appends the weights of one point.
typedef bat_status weight_maker(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                                bat_error *error);

/// All rows by the method of the options, with a radius of each point's own, every point joined to the boundary.
/// @return BAT_OK; BAT_NO_CONVERGENCE for mean values at a point without triangles; BAT_NO_MEMORY
bat_status weights_make(const bat_cloud *cloud, const neighbour_tree *tree, const bat_cloud_parameterize_options *options,
                        sparse_rows *rows, bat_error *error);

/// All rows, by some threads.
bat_status weights_build(const weight_source *source, weight_maker *maker, int threads, sparse_rows *rows, bat_error *error);

/// All points within the radius, all the same or by inverse distance; BAT_NO_CONVERGENCE when there are none.
bat_status weights_of_ball(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                           bat_error *error);
/// Shape-preserving weights of the point's neighbours in the Delaunay triangulation, by Qhull, of all points within the
/// radius in their best plane. BAT_NO_CONVERGENCE when they are too few or in line, or the point is on their hull.
bat_status weights_of_triangulated_ball(const weight_source *source, weight_scratch *scratch, size_t point,
                                        weight_chunk *chunk, bat_error *error);

/// The nearest points, all the same or by inverse distance. It does not fail but for want of memory.
bat_status weights_of_nearest(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                              bat_error *error);
/// Shape-preserving weights of the star in a plane that fits a neighbourhood wide against its thickness; where no star
/// closes, as at the end of a thin place, inverse distances. It does not fail but for want of memory.
bat_status weights_of_star(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                           bat_error *error);

/// Mean-value weights of the cloud's triangles (Floater 2003).
/// @return BAT_OK, BAT_NO_CONVERGENCE for a point without triangles, BAT_NO_MEMORY
bat_status weights_of_triangles(const bat_cloud *cloud, sparse_rows *rows, bat_error *error);

/// The first interior point that no chain of weights joins to the boundary; BAT_NO_INDEX for none.
bat_status weights_find_unjoined(const bat_cloud *cloud, const sparse_rows *rows, size_t *point, bat_error *error);

/// Give points that no chain joins to the boundary their nearest neighbours among those that are joined, the closest first,
/// until all are.
bat_status weights_join(const bat_cloud *cloud, sparse_rows *rows, bat_error *error);

/// The longest side of the box around the points.
double weights_longest_side(const bat_cloud *cloud);

/// The place of a point in the input.
size_t weights_input_place(const bat_cloud *cloud, size_t point);

#endif
