#ifndef SURFACE_CANDIDATE_H
#define SURFACE_CANDIDATE_H

#include "batten/cloud.h"
#include "batten/distributed.h"
#include "batten/surface.h"
#include "surface/cloud/local_plane.h"
#include "surface/cloud/part.h"
#include "surface/trim/trimming.h"
#include "surface/verdict.h"

/// @file
/// Charts: parameters that a part of a cloud tells for all its points.

struct reconstruction;

struct bat_surface_chart
{
    unit_frame frame;           ///< of the whole cloud
    bat_cloud part;             ///< points whose parameters are known
    double *of_part;            ///< part.count x 2: these parameters, on the surface
    bat_spline_surface surface; ///< through the part
    double *loop;               ///< loop_count x 3: the boundary of the cloud
    double *loop_parameters;    ///< loop_count x 2
    size_t loop_count;
    size_t functions; ///< budget of the fit to all points

    // Of the process that has found the chart.

    struct reconstruction *work; ///< null in others
    bat_surface_reconstruct_options options;
};

/// Free all but what belongs to `work`.
void chart_free_shared(bat_surface_chart *chart);

// A candidate of bat_surface_reconstruct(): one way to parameterize a cloud, and its fit.

/// A parameterization and its fit. All zero: empty. Release it with surface_candidate_free().
typedef struct surface_candidate
{
    bat_surface_candidate report;
    double *parameters; ///< count x 2, after repair: the initial parameters of a fit
    double *corrected;  ///< count x 2, after the parameter corrections of the fit; null after a fit to a sample
    bat_spline_surface surface;
    bat_surface_fit_report fit;
    const surface_trimming *trimming; ///< null for a surface that is not trimmed
} surface_candidate;

void surface_candidate_free(surface_candidate *candidate);

/// Parameterize a cloud by method `kind`, check the parameters for folds and repair them.
/// @param boundary cloud->boundary_count x 2; null for given parameters
/// @return BAT_OK, also when the method fails (then report.failure describes the failure); BAT_NO_MEMORY
bat_status surface_candidate_make(const bat_cloud *cloud, const double *boundary,
                                  const bat_surface_reconstruct_options *options, bat_surface_parameters kind,
                                  surface_candidate *candidate, bat_error *error);

/// Fit a surface to all points, judge it, and store it with its metrics.
/// @param geometry of the cloud
/// @param slides   see bat_surface_fit_data
/// @return see surface_candidate_make(); also BAT_CANCELLED
bat_status surface_candidate_fit(const bat_cloud *cloud, const cloud_geometry *geometry,
                                 const bat_surface_fit_options *options, bool slides, bool border,
                                 surface_candidate *candidate, bat_error *error);
/// Fit a surface to a random sample of about `points` points and store only its metrics.
bat_status surface_candidate_fit_sample(const bat_cloud *cloud, const bat_surface_fit_options *options, bool slides,
                                        bool border, size_t points, surface_candidate *candidate, bat_error *error);

/// Give the parameters of a candidate that was fitted to a part of a cloud to all points: those of their feet on its
/// surface, found from that of the nearest point of the part. The surface and the report of its fit are dropped.
/// @param boundary cloud->boundary_count x 2
/// @return BAT_OK, BAT_NO_MEMORY or the failures of spline_correct()
bat_status surface_candidate_extend(surface_candidate *candidate, const cloud_part *part, const bat_cloud *cloud,
                                    const double *boundary, bat_error *error);

/// Index of the best candidate. Surfaces that are judged to be wrong are excluded, unless all are. A candidate is excluded
/// when its one-sided Hausdorff distance (surface to points) exceeds twice the smallest one. Among the others, those that
/// reach the tolerance win, and of these the one with the fewest functions. If none reaches the tolerance, or none is set,
/// the smallest mean squared distance wins. Returns 0 when all have failed. Sets `strays` of the excluded ones.
size_t surface_candidate_best(surface_candidate *candidates, size_t count, const bat_surface_fit_options *options);

// Places on the triangles of a cloud, evenly in its parameters. They hold a surface where few points have much of the unit
// square, as in parts that stand out of a deep shape.

/// Places of a grid of about as many nodes as points. Release it with virtual_points_free().
typedef struct virtual_points
{
    double *places;     ///< count x 3
    double *parameters; ///< count x 2
    size_t count;
} virtual_points;

/// Interpolate triangles linearly at the nodes of a grid. Where triangles overlap, the first one counts.
/// @param cloud      with triangles
/// @param parameters count x 2
/// @return BAT_OK or BAT_NO_MEMORY
bat_status virtual_points_make(const bat_cloud *cloud, const double *parameters, virtual_points *guides, bat_error *error);
void virtual_points_free(virtual_points *guides);

#endif
