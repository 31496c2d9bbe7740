#ifndef SURFACE_TRIM_REGION_H
#define SURFACE_TRIM_REGION_H

#include "base/memory_pool.h"
#include "batten/spline.h"

/// @file
/// Trimming curves as polygons, and the part of the square that they bound.

/// Evaluate a curve.
/// @param t     in the domain
/// @param place receives `dimension` coordinates
void spline_curve_place(const bat_spline_curve *curve, double t, double *place);

/// The polygons of trimming curves. All zero: the whole square. Release it with trim_region_free().
typedef struct trim_region
{
    memory_pool pool;
    double (*points)[2]; ///< corners of all polygons, which are closed: the first is not repeated
    size_t count;
    size_t *loops; ///< loop_count + 1: the first corner of each polygon
    size_t loop_count;
    uint32_t *edges;   ///< of the rows: edges, which are numbered as their first corners
    size_t *row_edges; ///< TRIM_ROWS + 1
} trim_region;

enum
{
    TRIM_ROWS = 512
};

/// Sample trimming curves.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status trim_region_make(const bat_spline_trim *trim, trim_region *region, bat_error *error);
void trim_region_free(trim_region *region);
/// The corner of a polygon after another one.
size_t trim_region_next(const trim_region *region, size_t corner);
/// Whether a parameter is in the region, by the parity of crossings; true for an empty region.
bool trim_region_contains(const trim_region *region, double u, double v);

#endif
