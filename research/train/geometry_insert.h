#ifndef RESEARCH_TRAIN_GEOMETRY_INSERT_H
#define RESEARCH_TRAIN_GEOMETRY_INSERT_H

#include "batten/curve_scheme.h"
#include "research/train/geometry_polygon.h"

/// @file
/// One angle-based subdivision step (Ugail and Howard 2026, section 3.3) and its derivative.

/// Insert a vertex on every edge: the apex of the isosceles triangle with base angles insertion_angles[j] over edge j, left
/// of the edge when positive. Eq. (6), (7), and (8) corrected, in the closed forms of src/curve/kernel_angle.c; in the disk
/// the tangent of the angle is limited, as there, to 0.9 of that at which the sides become parallel.
///
/// @param insertion_angles one for each edge, of modulus at most BAT_CURVE_ANGLE_LIMIT
/// @param fine             receives count + edges rows: vertex j, then the new vertex of edge j
void geometry_insert(const geometry_polygon *polygon, const double *insertion_angles, double *fine);
/// @param point_gradients     may be null
/// @param insertion_gradients may be null
void geometry_insert_back(const geometry_polygon *polygon, const double *insertion_angles, const double *fine_gradients,
                          double *point_gradients, double *insertion_gradients);

/// The insertion angles of a tension, eq. (9) limited to BAT_CURVE_ANGLE_LIMIT, with its sign as printed or outward. Beyond
/// the ends of an open polygon angles count as 0.
void geometry_tension_angles(const geometry_polygon *polygon, geometry_profile profile, double tension,
                             bat_curve_angle_sign sign, double *insertion_angles);
void geometry_tension_angles_back(const geometry_polygon *polygon, geometry_profile profile, double tension,
                                  bat_curve_angle_sign sign, const double *insertion_gradients, geometry_profile gradient);

#endif
