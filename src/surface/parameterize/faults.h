#ifndef SURFACE_PARAMETERIZE_FAULTS_H
#define SURFACE_PARAMETERIZE_FAULTS_H

#include "batten/cloud_parameterize.h"
#include "surface/cloud/orientation.h"
#include "surface/cloud/spatial_order.h"

/// @file
/// Detection of faults of parameters: folds, parameters outside the square, coincident parameters.
///
/// A point is folded when the map from its local plane to the parameters reverses orientation.

/// A cloud prepared for fold detection with any number of parameterizations.
typedef struct fold_finder
{
    spatial_order order; ///< the order in which parameters are given
    oriented_planes oriented;
} fold_finder;

/// Prepare a cloud. `finder` is all zero on failure.
bat_status fold_finder_make(const bat_cloud *cloud, fold_finder *finder, bat_error *error);
void fold_finder_free(fold_finder *finder);

/// Faults by point, in spatial order.
typedef struct parameter_faults
{
    bool *folded;     ///< count each; on the boundary only `outside` may be true
    bool *outside;    ///< not in the unit square, or NaN
    bool *coincident; ///< equal to those of another point, rounded to twelve decimals
} parameter_faults;

bat_status parameter_faults_make(size_t count, parameter_faults *faults, bat_error *error);
void parameter_faults_free(parameter_faults *faults);

/// Find and count all faults.
/// @param parameters count x 2, in the order of the finder
bat_status parameter_faults_find(const fold_finder *finder, const double *parameters, parameter_faults *faults,
                                 bat_cloud_parameters_report *report, bat_error *error);

/// Check a cloud: bat_cloud_check(), and a known boundary.
bat_status parameters_check_cloud(const bat_cloud *cloud, bat_error *error);

#endif
