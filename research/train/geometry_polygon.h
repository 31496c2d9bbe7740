#ifndef RESEARCH_TRAIN_GEOMETRY_POLYGON_H
#define RESEARCH_TRAIN_GEOMETRY_POLYGON_H

#include "batten/base.h"

/// @file
/// Polygons on the three oriented surfaces of constant curvature, and isometries of these.
///
/// The functions of geometry_*.h compute in double, allocate nothing and cannot fail. Next to a function stands its
/// derivative, NAME_back(): it takes the gradient of a loss with respect to the function's results and *adds* that with
/// respect to its inputs to what the caller's arrays hold. Points are rows of coordinates; a gradient with respect to a
/// point is a row of derivatives with respect to them; on the sphere only its part tangent to the sphere has a meaning.

/// A surface; the value is its curvature.
typedef enum geometry_surface
{
    GEOMETRY_DISK = -1,  ///< the hyperbolic plane as the Poincaré disk, 2 coordinates
    GEOMETRY_PLANE = 0,  ///< 2 coordinates
    GEOMETRY_SPHERE = 1, ///< unit vectors, 3 coordinates
} geometry_surface;

/// A geodesic polygon of at least 3 vertices, of which neighbours are neither equal nor antipodal. Edge j goes from vertex j
/// to vertex j + 1.
typedef struct geometry_polygon
{
    const double *points; ///< count x geometry_dim()
    size_t count;
    geometry_surface surface;
    bool closed;
} geometry_polygon;

/// Coordinates of a point.
static inline size_t geometry_dim(geometry_surface surface)
{
    return surface == GEOMETRY_SPHERE ? 3 : 2;
}

/// Edges of a polygon: an open one has none from its last vertex.
static inline size_t geometry_edges(const geometry_polygon *polygon)
{
    return polygon->closed ? polygon->count : polygon->count - 1;
}

/// Vertices of a polygon with an angle: the ends of an open one have none.
static inline size_t geometry_corners(const geometry_polygon *polygon)
{
    return polygon->closed ? polygon->count : polygon->count - 2;
}

/// A polygon up to isometry, or the gradient with respect to that. What an open polygon lacks is stored as 0, and its
/// gradient is not read.
typedef struct geometry_profile
{
    double *angles;  ///< count exterior angles, positive for left turns
    double *lengths; ///< count geodesic edge lengths
} geometry_profile;

/// Measure a polygon. The formulas are those of src/space: Ugail and Howard (2026), eq. (1) and (2), and the Möbius
/// translation to the origin, all without cancellation for near vertices.
void geometry_measure(const geometry_polygon *polygon, geometry_profile profile);
void geometry_measure_back(const geometry_polygon *polygon, geometry_profile gradient, double *point_gradients);

/// Mean of the edge lengths.
double geometry_mean_length(const geometry_polygon *polygon, geometry_profile profile);
void geometry_mean_length_back(const geometry_polygon *polygon, double mean_gradient, geometry_profile gradient);

/// An isometry that keeps the orientation: a rotation about the origin, followed by a translation except on the sphere.
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
