#ifndef MPI_CHART_H
#define MPI_CHART_H

#include "points.h"

#include "batten/research/surface_chart.h"
#include "batten/surface.h"

/// @file
/// Points without parameters. Rank 0 finds boundary, corners and parameters, by all points or by a sample of them, as one
/// machine does by all. Every rank then locates its own points.
///
/// The sample depends on the points alone. Where it is not all of them, its boundary loop moves outwards to the outermost
/// points of all ranks.

/// A chart on all ranks.
typedef struct shared_chart
{
    bat_surface_chart *chart;
    bat_cloud cloud; ///< of rank 0: the points by which the chart is found, numbered as all
    uint64_t limit;  ///< points with a smaller hash are in the sample; UINT64_MAX: all
    bool found;      ///< the boundary was unknown
    double seconds;  ///< that it took to find it
} shared_chart;

void shared_chart_free(shared_chart *shared);

/// Bring the points of the sample to rank 0.
/// @param part  sorted by file_part_sort()
/// @param total of all ranks
/// @param wanted number of points of the sample, about; all for no more points
void shared_chart_sample(const file_part *part, size_t total, size_t wanted, shared_chart *shared);
/// Find boundary and parameters.
/// @param again with the smaller disc for the boundary, which rank 0 tries where the first surface is wrong
/// @param error receives a failure, on all ranks
bat_status shared_chart_find(const file_part *part, const bat_surface_reconstruct_options *options, bool again,
                             shared_chart *shared, bat_error *error);
/// Give points their parameters and their numbers in the fit, and distribute them. Empties the part.
/// @param border receives the border curves of this rank's fit
bat_status shared_chart_distribute(const shared_chart *shared, file_part *part, const bat_surface_fit_options *options,
                                   size_t relief, fit_input *input, bat_surface_border **border, size_t *functions,
                                   bat_error *error);
/// Judge a surface on rank 0.
/// @param result has the surface and the report of this rank; receives, on rank 0, what bat_surface_chart_finish() gives
bat_status shared_chart_finish(const shared_chart *shared, const fit_input *input, bat_surface_result *result,
                               bat_error *error);

/// Tell what the report says of the cloud: its points get their numbers in the file.
/// @param result of rank 0; the numbers of the worst points change
/// @param cloud  receives boundary and corners, without points
void shared_chart_describe(const shared_chart *shared, const file_part *part, bat_surface_result *result, bat_cloud *cloud);

#endif
