#pragma once

#include "surface/cloud/part.h"
#include "surface/trim/trimming.h"

/// @file
/// A candidate of bat_surface_reconstruct(): one way to parameterize a cloud, and its fit.

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

// A reconstruction, which makes candidates and chooses one.

/// Factor of the radius of the disc that finds another boundary where the surface is wrong.
#define SURFACE_SMALL_DISC 0.7
/// Progress share of finding the boundary and measuring the cloud.
#define SURFACE_PREPARE_SHARE 0.1

/// A reconstruction at work. Release it with reconstruction_free().
typedef struct reconstruction
{
    bat_cloud *cloud;
    const bat_surface_reconstruct_options *options;
    double disc; ///< factor of the radius of the disc that finds the boundary
    bool deep;   ///< charts of triangles alone, whose parameters are corrected at the end alone
    bat_surface_edges edges;
    bat_surface_parameters kinds[BAT_SURFACE_MAX_CANDIDATES]; ///< methods of parameterization to compare
    size_t kind_count;
    double *boundary;      ///< boundary_count x 2 parameters; null when all parameters are given and the boundary is unknown
    cloud_part part;       ///< of a large cloud; empty when all points are parameterized
    double *part_boundary; ///< part.cloud.boundary_count x 2
    cloud_geometry geometry;   ///< of the part, or of the cloud
    surface_trimming trimming; ///< of a trimmed surface
    double *planar;            ///< its parameters; null for other surfaces
    surface_candidate candidates[BAT_SURFACE_MAX_CANDIDATES];
    surface_candidate *best;   ///< one of `candidates`
    bat_surface_result result; ///< metrics of the candidates, later the selected surface
} reconstruction;

/// Make all candidates, and choose the best.
bat_status reconstruction_find(reconstruction *work, bat_error *error);
/// The maximum number of functions of the fit to all points.
size_t reconstruction_last_budget(const reconstruction *work);
/// Whether the points lie on a one-sided surface: normals come back turned over, along a cut as long as its width.
bool reconstruction_is_one_sided(const reconstruction *work);
bat_status reconstruction_tell_one_sided(bat_error *error);
/// Move the best candidate to the result.
bat_status reconstruction_store(reconstruction *work, bat_error *error);
void reconstruction_free(reconstruction *work);
