#ifndef SURFACE_FIT_MARKING_H
#define SURFACE_FIT_MARKING_H

#include "surface/fit/points.h"

/// What to refine.
typedef struct fit_marking
{
    double
        tolerance;  ///< cells with a point farther off are marked; 0: those that together have a share of the squared error
    size_t budget;  ///< the most functions afterwards; 0: any number
    int neighbours; ///< rings of cells around a marked one
} fit_marking;

/// Refine the cells whose points are farthest off, and rings of cells of the same level around them. Cells rank by the
/// weighted sum of squared distances of their points; when not all that are marked fit the budget, the first ones that do
/// are refined.
/// @param refined receives the refined space; null when there is nothing to refine or nothing fits
bat_status fit_mark_refine(const bat_hierarchical_space *space, const fit_points *points, const fit_marking *marking,
                           bat_hierarchical_space **refined, bat_error *error);

#endif
