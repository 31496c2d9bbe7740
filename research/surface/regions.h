#pragma once

#include "batten/spline.h"

/// The space that has the regions of hierarchical_space_regions(). Changes `boxes`.
/// @return the failures of bat_hierarchical_space_make() and bat_hierarchical_space_refine()
bat_status hierarchical_space_of_regions(const bat_hierarchical_options *options, bat_spline_box *boxes, size_t count,
                                         bat_hierarchical_space **space, bat_error *error);
