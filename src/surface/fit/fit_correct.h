#ifndef SURFACE_FIT_FIT_CORRECT_H
#define SURFACE_FIT_FIT_CORRECT_H

#include "surface/fit/fit_nets.h"

/// How far feet are sought.
typedef struct fit_correction
{
    int steps;      ///< the most of Newton's method
    double settled; ///< when the next step is as short as this, in cells, the search ends
} fit_correction;

/// Every step until rounding ends it.
fit_correction fit_correction_full(void);

/// Move parameters to the feet of their points, eq. (6): min over u of |S(u) - x|^2, by Newton's method. Where its matrix is
/// not positive definite that of Gauss and Newton takes its place, steps are at most as long as a few cells, shortened until
/// the distance falls, and kept in the square; a boundary parameter moves along its side, at most half way to the corners, a
/// fixed one not at all. Distances never
/// rise. Points know their cells before and after, but their order by cells is no more. Distances are measured anew.
/// @param moved receives how many parameters changed
bat_status fit_correct(const fit_nets *nets, fit_points *points, fit_correction correction, int threads, size_t *moved,
                       bat_error *error);

/// Let points that are much farther off than the mean look for their feet elsewhere: from the parameter of the nearest point
/// in space that is near its own. Newton's method finds the foot of the valley that it begins in, and in the early rounds of
/// a fit, when the surface is stiff, that may be the wrong one for good. The farthest few do so, and stay where they are
/// unless they get nearer.
bat_status fit_correct_lost(const fit_nets *nets, fit_points *points, fit_correction correction, int threads, size_t *moved,
                            bat_error *error);

#endif
