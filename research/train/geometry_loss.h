#ifndef RESEARCH_TRAIN_GEOMETRY_LOSS_H
#define RESEARCH_TRAIN_GEOMETRY_LOSS_H

#include "research/train/geometry_polygon.h"

/// @file
/// Losses of polygons: fairness measures of a profile, and distances from given points. Each NAME_back() takes the gradient
/// with respect to the loss's value.

// Fairness. The means of an open polygon are over the vertices that have an angle.

/// Mean of the squared angles: eq. (20) of Ugail and Howard (2026).
double geometry_smoothness(const geometry_polygon *polygon, geometry_profile profile);
void geometry_smoothness_back(const geometry_polygon *polygon, geometry_profile profile, double loss_gradient,
                              geometry_profile gradient);

/// Mean of the squares of angle / (mean length of its two edges + offset): eq. (21). The published program's offset is
/// BAT_CURVE_BENDING_OFFSET.
double geometry_bending(const geometry_polygon *polygon, geometry_profile profile, double offset);
void geometry_bending_back(const geometry_polygon *polygon, geometry_profile profile, double offset, double loss_gradient,
                           geometry_profile gradient);

/// Mean of the squared differences of angles at neighbouring vertices.
double geometry_angle_variation(const geometry_polygon *polygon, geometry_profile profile);
void geometry_angle_variation_back(const geometry_polygon *polygon, geometry_profile profile, double loss_gradient,
                                   geometry_profile gradient);

/// Power mean (mean |angle|^power)^(1/power), power > 1: a differentiable proxy for the largest angle.
double geometry_angle_power_mean(const geometry_polygon *polygon, geometry_profile profile, double power);
void geometry_angle_power_mean_back(const geometry_polygon *polygon, geometry_profile profile, double power,
                                    double loss_gradient, geometry_profile gradient);

// Distances of two sets of points, Euclidean in the stored coordinates on every surface, as in the published training
// program. Nearest neighbours are found by brute force: for the hundreds of points of a training sample that is faster than
// any tree, and it needs no memory.

/// For each query, a point of 2 or 3 coordinates, the nearest item; of several at the same distance the first.
/// @param nearest receives query_count numbers of items
void geometry_nearest(const double *queries, size_t query_count, const double *items, size_t item_count, size_t dim,
                      size_t *nearest);

/// Which points are nearest to which; arrays of the caller.
typedef struct geometry_matches
{
    size_t *of_points; ///< for each point, the nearest of the truth
    size_t *of_truth;  ///< for each point of the truth, the nearest point
} geometry_matches;

/// Half the mean distance of the points to the truth plus half that of the truth to the points: eq. (19) of Ugail and Howard
/// (2026).
/// @param points  count x dim, count >= 1, dim 2 or 3
/// @param truth   truth_count x dim, truth_count >= 1
/// @param matches receives what the derivative needs
double geometry_chamfer(const double *points, size_t count, const double *truth, size_t truth_count, size_t dim,
                        geometry_matches matches);
/// The derivative with respect to the points, 0 where a point lies on the truth.
void geometry_chamfer_back(const double *points, size_t count, const double *truth, size_t truth_count, size_t dim,
                           geometry_matches matches, double loss_gradient, double *point_gradients);

/// The mean distance of the points to the truth alone: "mean-NN" of section 7.
/// @param of_points receives for each point the nearest of the truth
double geometry_mean_nearest(const double *points, size_t count, const double *truth, size_t truth_count, size_t dim,
                             size_t *of_points);
void geometry_mean_nearest_back(const double *points, size_t count, const double *truth, size_t dim, const size_t *of_points,
                                double loss_gradient, double *point_gradients);

// Distances of two polylines, Euclidean in the stored coordinates, with chords between the points.

/// A point on a polyline.
typedef struct geometry_foot
{
    size_t edge;  ///< from item `edge` to the next one
    double share; ///< 0 at its begin, 1 at its end
} geometry_foot;

/// What the derivative of geometry_curve_distance() needs; arrays of the caller.
typedef struct geometry_feet
{
    geometry_foot *of_points; ///< for each point of the polygon, on the truth
    geometry_foot *of_truth;  ///< for each point of the truth, on the polygon
    double *point_weights;    ///< share of the length that belongs to a point; sum 1
    double *truth_weights;
    size_t *nearest; ///< room for the larger count
} geometry_feet;

/// Half the mean distance of the polygon to the truth plus half that of the truth to the polygon. Means are over the points,
/// weighted by the lengths of the edges at them; a distance is that to the edges at the nearest point.
/// @param truth truth_count x dim, at least 2, closed like the polygon
double geometry_curve_distance(const geometry_polygon *polygon, const double *truth, size_t truth_count, geometry_feet feet);
/// The derivative with respect to the points.
void geometry_curve_distance_back(const geometry_polygon *polygon, const double *truth, size_t truth_count,
                                  geometry_feet feet, double loss_gradient, double *point_gradients);

#endif
