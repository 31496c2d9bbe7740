#ifndef BATTEN_RESEARCH_SURFACE_CHART_H
#define BATTEN_RESEARCH_SURFACE_CHART_H

#include "batten/research/distributed.h"

BAT_C_BEGIN

/// @file
/// Reconstructions that several processes make together, as the program batten-mpi does. The first process has all points,
/// or a sample of them. It finds boundary, corners, parameters of a part, and the surface of this part, as
/// bat_surface_reconstruct() does. Each process then locates its points, and bat_surface_fit_together() fits the surface.
/// With all points in the first process, the surface is that of bat_surface_reconstruct() to the last bit.

/// The parameters that a part of a cloud tells for all its points.
typedef struct bat_surface_chart bat_surface_chart;

/// Half the distance from the centre of the bounding box, by which bat_surface_reconstruct() sorts points; those at the same
/// distance by their coordinates.
/// @param centre half the sum of the least and the largest coordinates: low * 0.5 + high * 0.5
BAT_API double bat_surface_chart_order(const double point[3], const double centre[3]);
/// bat_cloud_find_boundary() as bat_surface_reconstruct() calls it.
/// @param again by the smaller disc that is tried where the first surface is wrong
/// @return as that call, or BAT_CANCELLED
BAT_API bat_status bat_surface_chart_boundary(bat_cloud *cloud, bool again, bat_progress progress, bat_error *error);
/// Move the boundary loop of a sample outwards to the points of a larger cloud. Each point of the loop has the points that
/// are nearer to it than to the others; the outermost of them takes its place. The first process makes the frames of the
/// loop's points.
/// @param cloud  with its boundary loop
/// @param frames receives boundary_count x BAT_SURFACE_LOOP_FRAME numbers
/// @return BAT_OK; BAT_INVALID_ARGUMENT without a boundary; BAT_NO_MEMORY
BAT_API bat_status bat_surface_loop_frames(const bat_cloud *cloud, double *frames, bat_error *error);
/// Numbers of a frame: place, outward and normal direction, and how far points may be.
#define BAT_SURFACE_LOOP_FRAME 10
/// Find the outermost of some points at each point of a loop.
/// @param frames   loop x BAT_SURFACE_LOOP_FRAME
/// @param points   count x 3
/// @param outwards receives the distance of each, [loop]; 0 for none beyond the point of the loop
/// @param outer    receives their indices, [loop]
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_surface_loop_outermost(const double *frames, size_t loop, const double *points, size_t count,
                                              double *outwards, size_t *outer, bat_error *error);

/// Find a chart: all that bat_surface_reconstruct() does before its fit to all points.
/// @param cloud   stays in use until the chart is freed; its points are sorted as by bat_surface_reconstruct()
/// @param options parameters are automatic, neither published nor trimmed; null for the defaults
/// @param chart   receives the chart; release it with bat_surface_chart_free()
/// @return as bat_surface_reconstruct(); BAT_INVALID_ARGUMENT also for other options, and for clouds with few points
BAT_API bat_status bat_surface_chart_find(bat_cloud *cloud, const bat_surface_reconstruct_options *options,
                                          bat_surface_chart **chart, bat_error *error);
/// Free a chart; null is allowed.
BAT_API void bat_surface_chart_free(bat_surface_chart *chart);
/// A chart as bytes, for other processes of the same build.
/// @param bytes receives an array from malloc()
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_surface_chart_pack(const bat_surface_chart *chart, void **bytes, size_t *size, bat_error *error);
/// The chart of these bytes.
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; `chart` is untouched on failure
BAT_API bat_status bat_surface_chart_unpack(const void *bytes, size_t size, bat_surface_chart **chart, bat_error *error);
/// The parameters of points that are not on the boundary: those of their feet on the surface of the part.
/// @param points     count x 3
/// @param parameters receives count x 2
/// @return BAT_OK, BAT_NO_MEMORY or the failures of spline_correct()
BAT_API bat_status bat_surface_chart_locate(const bat_surface_chart *chart, const double *points, size_t count,
                                            double *parameters, bat_error *error);
/// The boundary loop, with its parameters: the first points of the cloud.
/// @param functions receives the budget of the fit to all points: bat_surface_fit_options::functions, unless that is 0; may
///                  be null
/// @return the number of its points
BAT_API size_t bat_surface_chart_loop(const bat_surface_chart *chart, const double **points, const double **parameters,
                                      size_t *functions);
/// Judge the surface that all processes have fitted, in the process that has found the chart.
/// @param surface    belongs to the result
/// @param report     belongs to the result; its distances are of any points
/// @param parameters of the points of the cloud after the fit, [cloud->count x 2]
/// @param distances  of these points, [cloud->count]
/// @param result     as by bat_surface_reconstruct(), of a surface that is right or wrong
/// @return BAT_OK; BAT_NO_CONVERGENCE for a one-sided surface; BAT_CANCELLED; BAT_NO_MEMORY
BAT_API bat_status bat_surface_chart_finish(bat_surface_chart *chart, bat_spline_surface *surface,
                                            bat_surface_fit_report *report, const double *parameters,
                                            const double *distances, bat_surface_result *result, bat_error *error);

/// Judge a surface by points: distances both ways, areas, normals.
/// @param cloud      the points; no two alike
/// @param parameters count x 2: theirs
/// @param distances  count: theirs from the surface
/// @param options    null for the defaults; their tolerance counts
/// @return BAT_OK; the failures of bat_cloud_check(); BAT_NO_MEMORY
BAT_API bat_status bat_surface_judge(const bat_spline_surface *surface, const bat_cloud *cloud, const double *parameters,
                                     const double *distances, const bat_surface_fit_options *options,
                                     bat_surface_verdict *verdict, bat_error *error);

BAT_C_END

#endif
