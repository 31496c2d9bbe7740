#ifndef SURFACE_FIT_MARKING_H
#define SURFACE_FIT_MARKING_H

#include "surface/fit/points.h"

/// @file
/// Marking of cells for refinement in the adaptive loop.

/// How to select the cells to refine.
typedef struct fit_marking
{
    double tolerance; ///< cells with a point at a larger distance are marked; 0: mark the cells with a fixed share of the
                      ///< total squared error
    size_t budget;    ///< maximum number of functions after refinement; 0: unlimited
    size_t fewest;    ///< cells with fewer points are not refined
    int neighbours;   ///< number of rings of cells refined around a marked cell
} fit_marking;

/// Refine the marked cells, and rings of active cells of the same level around them. Cells are ranked by the weighted sum of
/// squared distances of their points. If the budget does not allow all marked cells, only the highest-ranked ones are
/// refined.
/// @param refined receives the refined space; null when there is nothing to refine or nothing fits the budget
bat_status fit_mark_refine(const bat_hierarchical_space *space, const fit_points *points, const fit_marking *marking,
                           bat_hierarchical_space **refined, bat_error *error);

#endif
