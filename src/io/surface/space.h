#ifndef IO_SURFACE_SPACE_H
#define IO_SURFACE_SPACE_H

#include "batten/spline.h"

/// @file
/// Hierarchical spline spaces from the contents of files.

/// A box of cells of one level, which the space refines to that level or further.
typedef struct surface_box
{
    uint64_t level;
    uint64_t low[2], high[2];
    size_t line;
} surface_box;

/// The number of cells of a level in one direction. It fits into 64 bits for all levels below BAT_HIERARCHICAL_MAX_LEVELS
/// and up to 2^32 spans.
static inline uint64_t surface_level_cells(const bat_hierarchical_options *options, uint64_t level, int direction)
{
    return (uint64_t)options->spans[direction] << level;
}

/// Make the space in which each cell has the highest level of the boxes that contain it, or 0. Boxes may overlap. A box may
/// divide cells of the previous level if other boxes fill these cells.
/// @param line      of the coefficients, for errors
/// @param functions the number of coefficients in the file; much larger spaces are refused before memory is allocated
/// @return BAT_OK; BAT_BAD_FILE with the line of an empty box or one outside its grid, or for a wrong number of functions;
/// BAT_UNSUPPORTED for regions that divide cells of the previous level; BAT_TOO_LARGE; BAT_NO_MEMORY
bat_status surface_space_make(const bat_hierarchical_options *options, const surface_box *boxes, size_t count, size_t line,
                              size_t functions, bat_hierarchical_space **space, bat_error *error);

#endif
