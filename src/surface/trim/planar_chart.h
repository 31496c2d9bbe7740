#ifndef SURFACE_TRIM_PLANAR_CHART_H
#define SURFACE_TRIM_PLANAR_CHART_H

#include "surface/verdict.h"

/// @file
/// Charts with free boundary: places of the points of a cloud in a rectangle, with little distortion. A cloud whose normals
/// are within MAX_TILT of one direction is projected along it, and so is one that is flat as a whole. Other clouds get the
/// places u that minimize
///     sum over neighbours i, j of |u_j - u_i - R_i p_ij|^2,
/// where p_ij is the projection of x_j - x_i to the tangent plane of x_i, with the length of x_j - x_i, and R_i a rotation:
/// the energy of Sorkine and Alexa, "As-rigid-as-possible surface modeling" (2007), from the tangent planes that are
/// unrolled along a tree.

/// A chart.
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

#endif
