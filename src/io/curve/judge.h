#pragma once

#include "batten/curve_set.h"
#include "io/curve/geojson_shape.h"

/// @file
/// What a refined map must not be: polygons that cross themselves or have lost area, and borders that are no longer shared.

/// Judge the polygons of a geometry as a file will hold them. They must not cross or touch themselves unless the given ones
/// do, and their area must be that of the given ones and what lies between the borders; where given vertices have moved, the
/// area is not judged.
///
/// @param given  the shape of the given curves
/// @param fine   that of the refined ones
/// @param first  the index of the first curve, for messages
/// @return BAT_OK, BAT_UNSUPPORTED or BAT_NO_MEMORY
bat_status judge_polygons(const geojson_shape *given, const geojson_shape *fine, const geojson_style *style, size_t first,
                          bat_error *error);

/// Judge shared edges: what became of one is the same in every curve. Curves with moved or dropped vertices do not count.
/// @return BAT_OK, BAT_UNSUPPORTED or BAT_NO_MEMORY
bat_status judge_borders(const bat_curve_set *given, const bat_curve_set *fine, bat_error *error);
