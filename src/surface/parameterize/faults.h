#ifndef SURFACE_PARAMETERIZE_FAULTS_H
#define SURFACE_PARAMETERIZE_FAULTS_H

#include "batten/cloud_parameterize.h"
#include "surface/cloud/orientation.h"
#include "surface/cloud/spatial_order.h"

/// @file
/// Where parameters fold a cloud. The cloud is prepared once and any number of parameters are looked at.

typedef struct fold_finder
{
    spatial_order order; ///< parameters are given in this order
    oriented_planes oriented;
} fold_finder;

/// All zero on failure.
bat_status fold_finder_make(const bat_cloud *cloud, fold_finder *finder, bat_error *error);
void fold_finder_free(fold_finder *finder);

/// Look at each interior point. In a cloud of triangles, folded is a corner of a triangle that is flat or turned over.
/// Without triangles, a point is folded when the affine map from its local plane to parameters, fitted to its neighbourhood
/// in least squares, is flat or turns over. The boundary says which way is right.
/// @param parameters count x 2, in spatial order
/// @param folded     receives count; false on the boundary
/// @param stretches  receives the ratio of the map's singular values for each interior point; may be null
/// @return BAT_OK or BAT_NO_MEMORY
bat_status fold_finder_find(const fold_finder *finder, const double *parameters, bool *folded, double *stretches,
                            bat_error *error);

/// What to complain of, by point in spatial order.
typedef struct parameter_faults
{
    bool *folded;     ///< count each; on the boundary only `outside` may be true
    bool *outside;    ///< not in the square, or not a number
    bool *coincident; ///< with another point, to twelve digits after the point
} parameter_faults;

bat_status parameter_faults_make(size_t count, parameter_faults *faults, bat_error *error);
void parameter_faults_free(parameter_faults *faults);

/// Find all faults and report them.
/// @param parameters count x 2, in the finder's order
bat_status parameter_faults_find(const fold_finder *finder, const double *parameters, parameter_faults *faults,
                                 bat_cloud_parameters_report *report, bat_error *error);

/// Check that a cloud can be looked at: what bat_cloud_check() wants, and a boundary.
bat_status parameters_check_cloud(const bat_cloud *cloud, bat_error *error);

#endif
