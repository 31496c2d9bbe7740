#ifndef CURVE_TOPOLOGY_ANCHORS_H
#define CURVE_TOPOLOGY_ANCHORS_H

#include "batten/base.h"

/// @file
/// Points that stay where they are, one for each connected part of a set of curves. When refined edges pass over a part
/// without meeting it, such as a coast over an island, they pass over its anchor.

/// Anchors in a grid. All zero: none.
typedef struct anchor_grid
{
    double *points;     ///< count x 2, cell after cell
    size_t *components; ///< the part of each
    size_t *begins;     ///< the first anchor of each cell, and the count
    size_t count, columns, rows;
    double low[2], cell[2]; ///< the corner of the grid and the size of a cell
} anchor_grid;

/// Make a grid.
/// @param points     count x 2 finite numbers
/// @param components the part of each point
/// @param grid       release it with anchor_grid_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status anchor_grid_make(const double *points, const size_t *components, size_t count, anchor_grid *grid,
                            bat_error *error);
void anchor_grid_free(anchor_grid *grid);

/// Whether an anchor of another part than `component` lies inside a polygon, by the parity of edges to its right. The
/// test is exact.
/// @param polygon count x 2; the last point joins the first
bool anchor_grid_inside(const anchor_grid *grid, const double *polygon, size_t count, size_t component);

#endif
