#ifndef RESEARCH_SHAPES_SURFACE_SCAN_H
#define RESEARCH_SHAPES_SURFACE_SCAN_H

#include "research/shapes/surface_cloud.h"
#include "research/shapes/surface_shape.h"

/// @file
/// What a scanner that looks along z makes of a surface: lines, denser along themselves than across, fewer points on steep
/// places, a second sweep over a part, a gap where nothing was seen, noise, no order.

/// @param points about how many
/// @return BAT_OK or BAT_NO_MEMORY
bat_status surface_scan(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                        bat_error *error);

#endif
