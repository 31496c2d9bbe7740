#ifndef IO_CURVE_STITCH_SEAM_H
#define IO_CURVE_STITCH_SEAM_H

#include "io/curve/stitch.h"

/// @file
/// The seam of a geometry, and curves made of points of other curves.

/// The meridian at which a geometry is cut.
typedef struct stitch_seam
{
    double longitude; ///< 180 or 0 degrees
    double near;      ///< degrees from the seam or a pole that count as on it
} stitch_seam;

stitch_seam stitch_seam_of(const double *degrees, size_t count);
bool stitch_on_seam(const stitch_seam *seam, double longitude);
/// 1 at the north pole, -1 at the south pole, else 0.
int stitch_pole(const stitch_seam *seam, double latitude);

/// A vertex of a joined curve: a point of a given one, or a point that divides one of its edges on the seam.
typedef struct stitch_vertex
{
    const bat_curve *curve;
    size_t point;
    double share; ///< from this point to the next, for channels; 0 at the point itself
    double longitude, latitude;
    bool junction; ///< where given curves were joined
} stitch_vertex;

/// A sequence of vertices, reused. All zero: empty.
typedef struct stitch_path
{
    stitch_vertex *vertices;
    size_t count, capacity;
} stitch_path;

/// Make a curve of a path. Neighbours that are one point of the sphere become one vertex. Junctions on the great circle
/// between their neighbours are removed and counted. The path is changed.
/// @return false when out of memory
bool stitch_make_curve(stitch_path *path, bool closed, const stitch_tolerance *tolerance, size_t *removed, bat_curve *curve);

#endif
