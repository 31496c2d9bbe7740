#ifndef BATTEN_RESEARCH_MAP_SHAPES_H
#define BATTEN_RESEARCH_MAP_SHAPES_H

#include "batten/curve_set.h"

BAT_C_BEGIN

/// @file
/// Random maps of invented countries on the sphere, for tests and benchmarks of what keeps borders shared.

/// Options of a map. Begin with bat_shape_map_defaults().
typedef struct bat_shape_map_options
{
    size_t countries; ///< 12 to 5000, enclaves included and lakes not; default 200
    size_t detail; ///< a border between two cells has 2^detail edges, 1 to 10; default 2. A map of 200 countries has about
                   ///< 4000 * 2^detail vertices, a shared one counted twice
    uint64_t seed; ///< another seed gives another map; default 1
} bat_shape_map_options;

/// The options' default values.
BAT_API bat_shape_map_options bat_shape_map_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_shape_map_fields;

/// Make a map of the Earth's size: polygons of longitude and latitude that border on each other, with islands, lakes,
/// islands in lakes, enclaves, straight borders along meridians (of one edge) and parallels, one country around the south
/// pole, and about five across the antimeridian.
///
/// Features that share a border have the same vertices there, and rings of different polygons meet nowhere else. Rings are
/// simple, outer ones counter-clockwise and holes clockwise. This holds on the sphere, where edges are great circles, and in
/// the plane of longitude and latitude. Coordinates have six decimals.
///
/// A feature has an id ("C001", lakes "L001"), and the properties "name", "kind" ("country", "lake" or "enclave") and
/// "population". The result is the same on every machine, but for rounding of cosines in the last digit.
///
/// @param options null for the defaults
/// @param set     receives the rings, on the sphere and not cut; bat_curve_write() cuts them at the antimeridian. Release it
///                with bat_curve_set_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; `set` is untouched on failure
BAT_API bat_status bat_shape_map(const bat_shape_map_options *options, bat_curve_set *set, bat_error *error);

BAT_C_END

#endif
