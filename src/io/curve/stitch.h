#pragma once

#include "batten/curve.h"

/// @file
/// Polygons and lines that a file cuts at the antimeridian (RFC 7946, section 3.1.9) or closes over a pole, joined again on
/// the sphere.
///
/// The *seam* is the meridian of 180 degrees, or that of 0 degrees for longitudes beyond 180. An edge lies on the seam when
/// both ends have its longitude or are a pole. Where such edges of one geometry run in opposite directions, they cancel; the
/// other edges form rings again. An edge that none cancels is a real border and stays. A closure over a pole that ends up to
/// 1e-2 degrees short of the seam lies on it.

typedef struct stitch_origin
{
    size_t part; ///< the polygon, or the line
    size_t ring; ///< of the polygon; 0 for a line
} stitch_origin;

typedef struct stitch_polygon
{
    size_t rings; ///< their number; the outer one comes first
    int pole;     ///< in its interior when its outer ring goes around the axis: 1 north, -1 south. 0: the file does not tell
} stitch_polygon;

/// The lines or polygons of one geometry of a file.
typedef struct stitch_geometry
{
    bat_curve *curves;      ///< count, on the sphere S^2; rings are closed and do not repeat their first point
    stitch_origin *origins; ///< for each curve; of a joined one, that of the curve at its start
    size_t count;
    stitch_polygon *polygons; ///< null for lines
    size_t polygon_count;
} stitch_geometry;

typedef struct stitch_report
{
    size_t joined;        ///< given polygons or lines that are now part of another one
    size_t joins;         ///< polygons or lines that were made of several
    size_t poles;         ///< polygons whose closure over a pole, or around the axis, was removed
    size_t removed;       ///< points that the cut had added on great circles between their neighbours
    size_t unrepresented; ///< polygons whose interior contains both poles; they have no outline on the sphere and stay
} stitch_report;

void stitch_report_add(stitch_report *sum, const stitch_report *part);

/// The precision of a file, from the decimals that it writes: what a cut may be off.
typedef struct stitch_tolerance
{
    double latitude; ///< degrees between two latitudes on the seam that are one point
    double offset;   ///< degrees between a point and a great circle on which it lies
} stitch_tolerance;

/// The tolerance for the most decimals of any of these longitudes and latitudes.
stitch_tolerance stitch_tolerance_of(const double *degrees, size_t count);

/// Whether stitch_polygons() or stitch_lines() could find something: some point lies on the seam or at a pole.
bool stitch_concerns(const double *degrees, size_t count);

/// Join the polygons of a geometry. The order of polygons is that of their first parts. A ring begins where one of its parts
/// begins off the seam, else where the first one does. A point that the cut added is removed where it lies on the great
/// circle between its neighbours.
///
/// @param geometry its arrays are replaced by new ones from malloc(), if something was joined
/// @param degrees  longitude and latitude of every point, curve after curve, as in the file
/// @param report   what was done; all zero: the geometry is unchanged
/// @return false when out of memory; the geometry is unchanged then
bool stitch_polygons(stitch_geometry *geometry, const double *degrees, const stitch_tolerance *tolerance,
                     stitch_report *report);

/// Join lines of a geometry whose ends meet on the seam: one ends there, and another one begins there with a longitude that
/// differs by 360 degrees. The line that follows in the file is preferred.
///
/// @param geometry open curves, without polygons
/// @param close    whether a line whose ends meet in this way becomes a closed curve
bool stitch_lines(stitch_geometry *geometry, const double *degrees, const stitch_tolerance *tolerance, bool close,
                  stitch_report *report);

void stitch_geometry_free(stitch_geometry *geometry);

// The seam of a geometry, and curves made of points of other curves.

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
