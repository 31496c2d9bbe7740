#ifndef SPACE_SPHERE_H
#define SPACE_SPHERE_H

/// Two points of a sphere whose sum is shorter than this are antipodal: the direction between them is lost in rounding.
#define SPHERE_ANTIPODAL_LENGTH 1e-14
#define SPHERE_ANTIPODAL_SQUARED_LENGTH (SPHERE_ANTIPODAL_LENGTH * SPHERE_ANTIPODAL_LENGTH)

#endif
