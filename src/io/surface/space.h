#ifndef IO_SURFACE_SPACE_H
#define IO_SURFACE_SPACE_H

#include "batten/spline_hierarchical.h"

/// @file
/// Spaces of splines from what files say of them.

/// A box of a file: its cells, which are of the grid of its level, are of that level or finer.
typedef struct surface_box
{
    uint64_t level;
    uint64_t low[2], high[2];
    size_t line;
} surface_box;

/// The number of cells of a level's grid in a direction. It fits 64 bits for every level below BAT_HIERARCHICAL_MAX_LEVELS
/// and every number of spans below 2^32.
static inline uint64_t surface_level_cells(const bat_hierarchical_options *options, uint64_t level, int direction)
{
    return (uint64_t)options->spans[direction] << level;
}

/// Make the space in which each cell has the highest level of the boxes that hold it, 0 where there is none. Boxes may
/// overlap, and one may end in the midst of a cell of the level before if others fill that cell.
/// @param line      of the coefficients, for errors
/// @param functions the number of functions that the file has coefficients for: a space far beyond it is refused before it
///         takes memory
/// @return BAT_OK; BAT_BAD_FILE with the line of a box that is not in its grid or has no cells, or where the space does not
///         have `functions` functions; BAT_UNSUPPORTED where regions are not made of cells of the level before;
///         BAT_TOO_LARGE; BAT_NO_MEMORY
bat_status surface_space_make(const bat_hierarchical_options *options, const surface_box *boxes, size_t count, size_t line,
                              size_t functions, bat_hierarchical_space **space, bat_error *error);

#endif
