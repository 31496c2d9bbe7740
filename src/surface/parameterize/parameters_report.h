#ifndef SURFACE_PARAMETERIZE_PARAMETERS_REPORT_H
#define SURFACE_PARAMETERIZE_PARAMETERS_REPORT_H

#include "batten/cloud_parameterize.h"
#include "surface/parameterize/fold_finder.h"

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
