#pragma once

#include "batten/surface.h"
#include "surface/cloud/local_plane.h"

/// @file
/// Judgement of a surface by its cloud, both ways.

/// What is known of a cloud without any surface. Lengths are those of the cloud scaled to unit size.
typedef struct cloud_geometry
{
    unit_frame frame;         ///< the scale
    spatial_order order;      ///< the cloud in spatial order, scaled, with its tree
    oriented_planes oriented; ///< tangent planes of these points
    double *spacing;          ///< count: mean distance of neighbours in the tangent plane
    double middle_spacing;    ///< their median
    double area;              ///< sum of the areas of the points
    double noise;             ///< estimated standard deviation of a coordinate
    double size;              ///< longest side of the bounding box
    bool is_deep;             ///< set by a caller: surfaces are judged by the triangles of the cloud too
} cloud_geometry;

/// Measure a cloud.
/// @param progress asked whether to go on
/// @return BAT_OK, BAT_CANCELLED or BAT_NO_MEMORY; release `geometry` in all cases
bat_status cloud_geometry_make(const bat_cloud *cloud, int threads, bat_progress progress, cloud_geometry *geometry,
                               bat_error *error);
void cloud_geometry_free(cloud_geometry *geometry);

/// Judge a surface over the bounding box of the parameters of the points.
/// @param parameters of the points, [count x 2]
/// @param distances of the points of the cloud from the surface, [count], in the units of the cloud
/// @param options   of the fit: threads, progress, and the tolerance that was asked for
/// @return BAT_OK, BAT_CANCELLED or BAT_NO_MEMORY
bat_status surface_judge(const cloud_geometry *geometry, const bat_spline_surface *surface, const double *parameters,
                         const double *distances, size_t count, const bat_surface_fit_options *options,
                         bat_surface_verdict *verdict, bat_error *error);
