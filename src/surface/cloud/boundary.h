#ifndef SURFACE_CLOUD_BOUNDARY_H
#define SURFACE_CLOUD_BOUNDARY_H

#include "batten/cloud.h"

/// bat_cloud_find_boundary() that reports progress and may be cancelled.
/// @param scale factor of the radius of the disc
/// @return as that call, or BAT_CANCELLED; `cloud` is untouched on failure
bat_status cloud_find_boundary(bat_cloud *cloud, double scale, bat_progress progress, bat_error *error);

#endif
