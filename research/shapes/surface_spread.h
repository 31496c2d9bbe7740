#ifndef RESEARCH_SHAPES_SURFACE_SPREAD_H
#define RESEARCH_SHAPES_SURFACE_SPREAD_H

#include "research/shapes/surface_cloud.h"
#include "research/shapes/surface_shape.h"

/// @file
/// Points spread evenly over a surface, whatever its parameters: in strips of even width across its longer way, each with as
/// many points as its area asks for, a little out of line.

/// @param points of the whole cloud; the boundary has what suits the distance between neighbours, which is even along each
/// side
/// @return BAT_OK or BAT_NO_MEMORY
bat_status surface_spread(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                          bat_error *error);

#endif
