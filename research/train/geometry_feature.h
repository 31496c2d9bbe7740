#ifndef RESEARCH_TRAIN_GEOMETRY_FEATURE_H
#define RESEARCH_TRAIN_GEOMETRY_FEATURE_H

#include "research/train/geometry_polygon.h"

/// @file
/// The features of an edge of a polygon for networks: angles and ratios of lengths, invariant under isometries and scaling.

/// Features of an edge in the published network: 6 of the profile and the curvature.
#define GEOMETRY_PUBLISHED_FEATURES 7

/// Eq. (17) of Ugail and Howard (2026): the angles at vertices j - 1, j, j + 1, j + 2 over pi, the lengths of edges j and
/// j + 1 over the polygon's mean, and the curvature. For an open polygon, angles beyond its ends are 0 and the last edge is
/// its own successor.
/// @param features one row for each edge; rows lie `stride` >= GEOMETRY_PUBLISHED_FEATURES numbers apart
void geometry_published_features(const geometry_polygon *polygon, geometry_profile profile, double *features, size_t stride);
void geometry_published_features_back(const geometry_polygon *polygon, geometry_profile profile,
                                      const double *feature_gradients, size_t stride, geometry_profile gradient);

/// The range of the features around an edge. It is symmetric: reversal of the polygon reverses the order of the angles, with
/// their signs changed, and that of the lengths.
typedef struct geometry_stencil
{
    size_t angle_reach;  ///< angles on either side of the edge, so 2 angle_reach in all
    size_t length_reach; ///< edges on either side of the edge, so 2 length_reach + 1 in all
} geometry_stencil;

/// Features of an edge with a stencil.
static inline size_t geometry_stencil_size(geometry_stencil stencil)
{
    return 2 * stencil.angle_reach + 2 * stencil.length_reach + 1;
}

/// The angles over pi, in the polygon's order, then the lengths over their own mean. Beyond the ends of an open polygon both
/// are 0, and the mean does not include them. Around a closed polygon a wide stencil may contain vertices twice.
/// @param features one row for each edge; rows lie `stride` >= geometry_stencil_size() numbers apart
void geometry_stencil_features(const geometry_polygon *polygon, geometry_profile profile, geometry_stencil stencil,
                               double *features, size_t stride);
void geometry_stencil_features_back(const geometry_polygon *polygon, geometry_profile profile, geometry_stencil stencil,
                                    const double *feature_gradients, size_t stride, geometry_profile gradient);

#endif
