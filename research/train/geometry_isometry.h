#ifndef RESEARCH_TRAIN_GEOMETRY_ISOMETRY_H
#define RESEARCH_TRAIN_GEOMETRY_ISOMETRY_H

#include "research/train/geometry_polygon.h"

/// An isometry that keeps the orientation: a rotation about the origin, then, but on the sphere, a translation.
typedef struct geometry_isometry
{
    geometry_surface surface;
    double rotation[9]; ///< row-major, geometry_dim() x geometry_dim()
    double shift[2];    ///< where the origin goes; in the disk by the Möbius translation z -> shift + z
} geometry_isometry;

/// A random isometry: a uniform rotation and a translation in a uniform direction by a distance uniform in [0, reach), which
/// must be finite; on the sphere `reach` does not count.
geometry_isometry geometry_isometry_random(geometry_surface surface, double reach, bat_random *random);

/// Move points; `moved` may be `points`.
void geometry_isometry_apply(const geometry_isometry *isometry, const double *points, size_t count, double *moved);

#endif
