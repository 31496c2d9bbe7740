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

// Edges of rings on the seam: division at each other's ends, and cancellation.

typedef struct stitch_ring
{
    const bat_curve *curve;
    const double *degrees; ///< count x 2, of a closure over a pole on the seam
    size_t polygon;
    bool on_seam;  ///< has an edge on the seam, and therefore half-edges
    bool oriented; ///< the planar orientation is known: no edge crosses the map's border
    bool reversed; ///< half-edges run against the ring, so that the interior is on their left
} stitch_ring;

/// A directed edge of a ring, or a piece of one, from its origin to the origin of the next.
typedef struct stitch_half_edge
{
    size_t ring;
    size_t point; ///< the point at its origin, or before the origin of a piece
    size_t previous, next;
    double share;               ///< for the origin of a piece: from `point` to the next one; else 0
    double longitude, latitude; ///< the origin
    bool piece;                 ///< the origin divides an edge
    bool gone;                  ///< cancelled
    bool junction;              ///< edges before the origin have been cancelled
} stitch_half_edge;

typedef struct stitch_edges
{
    const stitch_geometry *geometry;
    const stitch_tolerance *tolerance;
    stitch_seam seam;
    stitch_ring *rings; ///< geometry->count
    double *snapped;    ///< the degrees of the rings
    stitch_half_edge *edges;
    size_t count, capacity;
    size_t *groups;      ///< for each polygon, another one that it is joined to, or itself at the root
    bool *changed;       ///< for each polygon, whether one of its edges was cancelled
    bool *north, *south; ///< for each polygon, whether a cancelled edge ends at the pole
    size_t cancelled;    ///< pairs of half-edges
} stitch_edges;

/// Make the half-edges of the rings with edges on the seam, and cancel opposite ones. Rings with very many overlapping edges
/// are left alone. False when out of memory.
bool stitch_edges_make(const stitch_geometry *geometry, const double *degrees, const stitch_tolerance *tolerance,
                       stitch_edges *edges);

/// The root of a polygon's group: the first polygon of those that are joined.
size_t stitch_edges_group(const stitch_edges *edges, size_t polygon);

void stitch_edges_free(stitch_edges *edges);

#endif
