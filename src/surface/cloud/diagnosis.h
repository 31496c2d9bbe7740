#ifndef SURFACE_CLOUD_DIAGNOSIS_H
#define SURFACE_CLOUD_DIAGNOSIS_H

#include "surface/cloud/neighbours.h"

/// @file
/// Clouds that are not one patch of a surface: a test for each kind. Each returns BAT_NO_CONVERGENCE, with a text that says
/// what the cloud is and what to do.

/// Whether the points lie along a straight line.
bat_status diagnose_line(const double *points, size_t count, bat_error *error);

/// Whether the points lie on two parallel sheets that are closer than their points are: the heights of neighbours above a
/// quadratic polynomial have two modes, which makes their kurtosis small.
/// @param noise    standard deviation of these heights
/// @param spacing  mean spacing of the points
/// @param unit     length of a unit of the points in that of the cloud, for the text
bat_status diagnose_sheets(const double *points, const neighbour_tree *tree, double noise, double spacing, double unit,
                           bat_error *error);

/// Whether the cloud has several pieces: components of the graph of near neighbours. Points that belong to no piece are
/// outliers.
/// @param kept  count; receives which points belong to the one piece
/// @param left  receives the number of the others
bat_status diagnose_pieces(const double *points, const neighbour_tree *tree, bool *kept, size_t *left, bat_error *error);

#endif
