#ifndef SURFACE_FIT_FIT_THIN_PLATE_H
#define SURFACE_FIT_FIT_THIN_PLATE_H

#include "surface/fit/fit_pattern.h"

/// The thin-plate matrix of a space,
///     M_ij = integral over the square of B_i,uu B_j,uu + B_i,uv B_j,uv + B_i,vv B_j,vv,
/// so that the energy J of eq. (5) is c^T M c. Exact: on a cell it is a sum of products of univariate integrals of
/// polynomials, by Gauss' rule.
/// @param values receives the lower triangle in the pattern
bat_status fit_thin_plate(const fit_pattern *pattern, const bat_hierarchical_space *space, int threads, double *values,
                          bat_error *error);

#endif
