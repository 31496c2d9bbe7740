#ifndef SPACE_BUILTIN_H
#define SPACE_BUILTIN_H

#include "batten/space.h"

/// Whether a space is one that the library made, so that code written for it in closed form applies. A user's space is not,
/// even where it has some of our functions.
bool space_is_euclidean(const bat_space *space);
bool space_is_plane(const bat_space *space);
bool space_is_sphere(const bat_space *space); ///< S^2
bool space_is_disk(const bat_space *space);
bool space_is_rotation(const bat_space *space);
bool space_is_rigid(const bat_space *space);
bool space_is_product(const bat_space *space); ///< its parameters are bat_product_factors

/// Whether a space is one of ours of constant curvature with orthonormal coordinates of tangent vectors: a sphere, the disk
/// or a hyperbolic space.
/// @param curvature receives 1 or -1 where it is
bool space_is_curved(const bat_space *space, double *curvature);

/// Whether a space is one of the three oriented surfaces: plane, S^2 or disk.
/// @param curvature receives 0, 1 or -1 where it is
bool space_is_surface(const bat_space *space, int *curvature);

/// What a space lacks that every space has, in a few words ("function log"); null for nothing.
const char *space_lack(const bat_space *space);

/// Whether a space has all functions that are not optional, dimensions within bounds and an injectivity radius. Null is no
/// space.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names what is missing
bat_status space_check_complete(const bat_space *space, bat_error *error);

#endif
