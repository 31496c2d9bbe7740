#ifndef LINALG_LEADING_ORBIT_H
#define LINALG_LEADING_ORBIT_H

#include "linalg/joint_radius.h"

/// Leading eigenvectors of the leaders of a joint radius, and the vectors they pass through while their product is applied,
/// each step divided by `rate`: vertices that an extremal polytope must have.
///
/// A complex eigenvector stands for an ellipse, on which the product turns vectors; it gives `phases` points of half of it.
/// @param set the matrices that the leaders' letters count
/// @param vectors receives rows of dimension numbers; release it with free()
/// @return BAT_OK, BAT_NO_MEMORY or BAT_NO_CONVERGENCE
bat_status leading_orbits(const matrix_set *set, const joint_radius *radius, double rate, size_t phases, double **vectors,
                          size_t *count, bat_error *error);

#endif
