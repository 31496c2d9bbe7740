#ifndef SURFACE_PARAMETERIZE_FOLD_FINDER_H
#define SURFACE_PARAMETERIZE_FOLD_FINDER_H

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
bat_status fold_finder_run(const fold_finder *finder, const double *parameters, bool *folded, double *stretches,
                           bat_error *error);

#endif
