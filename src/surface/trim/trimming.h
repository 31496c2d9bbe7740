#pragma once

#include "batten/spline.h"
#include "surface/verdict.h"

/// @file
/// Trimming curves as polygons, and the part of the square that they bound.

/// Evaluate a curve.
/// @param t     in the domain
/// @param place receives `dimension` coordinates
void spline_curve_place(const bat_spline_curve *curve, double t, double *place);

/// The polygons of trimming curves. All zero: the whole square. Release it with trim_region_free().
typedef struct trim_region
{
    memory_pool pool;
    double (*points)[2]; ///< corners of all polygons, which are closed: the first is not repeated
    size_t count;
    size_t *loops; ///< loop_count + 1: the first corner of each polygon
    size_t loop_count;
    uint32_t *edges;   ///< of the rows: edges, which are numbered as their first corners
    size_t *row_edges; ///< TRIM_ROWS + 1
} trim_region;

#define TRIM_ROWS 512

/// Sample trimming curves.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status trim_region_make(const bat_spline_trim *trim, trim_region *region, bat_error *error);
void trim_region_free(trim_region *region);
/// The corner of a polygon after another one.
size_t trim_region_next(const trim_region *region, size_t corner);
/// Whether a parameter is in the region, by the parity of crossings; true for an empty region.
bool trim_region_contains(const trim_region *region, double u, double v);

// Trimmed surfaces: the chart of a cloud, its outline and holes, and the trimming curves over the chart's rectangle.

typedef struct planar_chart
{
    double (*places)[2]; ///< [count of the cloud], in units of the scaled cloud, from 0 to `sides`
    double sides[2];     ///< of the rectangle, the longer one first
    double direction[3]; ///< of the projection; zero for an unrolled cloud
} planar_chart;

/// Make a chart.
/// @param margin of the rectangle around the points, in spacings
/// @return BAT_OK; BAT_NO_CONVERGENCE for points that are on a line or have no chart; BAT_NO_MEMORY
bat_status planar_chart_make(const cloud_geometry *geometry, double margin, planar_chart *chart, bat_error *error);
void planar_chart_free(planar_chart *chart);

/// Closed polygons through points of a chart. Release them with outline_free().
typedef struct outline_loops
{
    uint32_t *corners;     ///< points, in the numbers of the chart
    size_t *first;         ///< count + 1: the first corner of each loop
    size_t count;          ///< the outline comes first, counter-clockwise; then holes, clockwise, the largest area first
    bool *filled;          ///< count: whether a hole is to be closed
    double *spacing;       ///< of each corner, without its neighbours across the loop
    bool random;           ///< whether the points are at random places, not on a grid
    double area;           ///< of the surface by the density of the points, in units of the scaled cloud
    bat_surface_gap *gaps; ///< gap_count: the holes, and gaps nearly as large, in units of the scaled cloud
    size_t gap_count;
    bat_surface_edges edges;
} outline_loops;

/// Find the loops.
/// @param fill  holes of at most this diameter are to be closed, in units of the scaled cloud
/// @param close gaps whose circles have at most this diameter are to be closed
/// @return BAT_OK; BAT_NO_CONVERGENCE for points in several pieces; BAT_NO_MEMORY
bat_status outline_find(const cloud_geometry *geometry, const planar_chart *chart, double fill, double close,
                        outline_loops *loops, bat_error *error);
void outline_free(outline_loops *loops);

/// Fit trimming curves to loops. Points inside a patch that was scanned at random places end before the true edge. Their
/// loops are rough, and the curves lie outside of them by the missing area over their length; round ones become the circles
/// that all points make likely. Points on the edge are met. `edges` of the loops may ask for polygons or smooth curves.
/// @param sides      of the rectangle that the square stands for, in units of the scaled cloud
/// @param parameters of the points, points x 2
/// @param spacing    of the points, in units of the scaled cloud
/// @param noise      standard deviation of a coordinate, in units of the scaled cloud
/// @return BAT_OK or BAT_NO_MEMORY; `trim` is empty on failure
bat_status fair_loops_make(const outline_loops *loops, const double sides[2], const double *parameters, size_t points,
                           const double *spacing, double noise, bat_spline_trim *trim, bat_error *error);

/// What is known of a trimmed surface before the fit.
typedef struct surface_trimming
{
    planar_chart chart;
    outline_loops loops;
} surface_trimming;

/// Make the chart and find the loops.
/// @param fill  holes of at most this diameter are to be closed, in units of the cloud
/// @param close gaps whose circles have at most this diameter are to be closed
/// @return BAT_OK; see planar_chart_make() and outline_find(); release `trimming` in both cases
bat_status trimming_make(const cloud_geometry *geometry, double fill, double close, surface_trimming *trimming,
                         bat_error *error);
void trimming_free(surface_trimming *trimming);

/// The parameters of the points in the chart's rectangle.
/// @param parameters receives count x 2, in the cloud's order
void trimming_parameters(const cloud_geometry *geometry, const surface_trimming *trimming, double *parameters);

/// The curves of all loops, the filled ones included.
/// @param parameters of the points after the fit, count x 2, in the cloud's order
/// @param rms        root mean square distance of the points from the surface, in units of the scaled cloud: their noise is
///                   no larger, also where the surface bends between neighbours
/// @return BAT_OK or BAT_NO_MEMORY; `trim` is empty on failure
bat_status trimming_curves(const cloud_geometry *geometry, const surface_trimming *trimming, const double *parameters,
                           double rms, bat_spline_trim *trim, bat_error *error);
/// Hand over the list of holes and gaps, in units of the cloud.
void trimming_take_gaps(const cloud_geometry *geometry, surface_trimming *trimming, bat_surface_gap **gaps, size_t *count);
/// Remove the curves of the filled loops. Returns their number.
size_t trimming_drop_filled(const surface_trimming *trimming, bat_spline_trim *trim);
