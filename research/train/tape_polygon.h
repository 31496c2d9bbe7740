#ifndef RESEARCH_TRAIN_TAPE_POLYGON_H
#define RESEARCH_TRAIN_TAPE_POLYGON_H

#include "research/learn/tape.h"
#include "research/train/geometry_polygon.h"

/// @file
/// Polygons on a tape: the differentiable geometry as operations between those of a network. Points, angles and lengths stay
/// in double precision; the input and output of a network are in the network's precision.
///
/// As with arrays, after a failure the tape stores the status and the operations do nothing; a polygon may then be null.

typedef struct tape_polygon
{
    geometry_polygon shape;
    geometry_profile profile;          ///< measured
    double *point_gradient;            ///< as the points; null without a derivative
    geometry_profile profile_gradient; ///< likewise
} tape_polygon;

/// A polygon that is given, without derivative. `points` are not copied: they must stay until the step has been
/// differentiated.
tape_polygon *tape_polygon_given(learn_tape *tape, const geometry_polygon *shape);
/// The polygon with a vertex inserted on every edge (research/train/geometry_insert.h).
/// @param angles one row for each edge
tape_polygon *tape_polygon_insert(learn_tape *tape, tape_polygon *coarse, learn_array *angles);

/// The features of every edge for the published network, without its space (eq. 17 of Ugail and Howard 2026): edges x 6.
learn_array *tape_polygon_features(learn_tape *tape, tape_polygon *polygon);

// Losses, 1 x 1.

/// Eq. (19). The truth must stay until the step has been differentiated.
learn_array *tape_polygon_chamfer(learn_tape *tape, tape_polygon *polygon, const double *truth, size_t truth_count);
/// Eq. (20).
learn_array *tape_polygon_smoothness(learn_tape *tape, tape_polygon *polygon);
/// Eq. (21), with the offset of the published program.
learn_array *tape_polygon_bending(learn_tape *tape, tape_polygon *polygon);
/// The mean distance of the polygon's vertices to the truth. The truth must stay until the step has been differentiated.
learn_array *tape_polygon_mean_nearest(learn_tape *tape, tape_polygon *polygon, const double *truth, size_t truth_count);
/// geometry_curve_distance(). The truth must stay until the step has been differentiated.
learn_array *tape_polygon_curve_distance(learn_tape *tape, tape_polygon *polygon, const double *truth, size_t truth_count);
/// geometry_angle_power_mean().
learn_array *tape_polygon_angle_power_mean(learn_tape *tape, tape_polygon *polygon, double power);

#endif
