#ifndef RESEARCH_SHAPES_SURFACE_BEZIER_H
#define RESEARCH_SHAPES_SURFACE_BEZIER_H

#include "batten/research/surface_shapes.h"

/// @file
/// Random tensor-product Bezier surfaces: S(u, v) = sum_ij c_ij B_i(u) B_j(v), B_i the Bernstein polynomials.

#define BEZIER_MAX_DEGREE 15

/// A tensor-product Bézier surface of bidegree (degree, degree). Control point (i, j) is row j (degree + 1) + i.
typedef struct bezier_surface
{
    int degree;
    double control[(BEZIER_MAX_DEGREE + 1) * (BEZIER_MAX_DEGREE + 1)][3];
} bezier_surface;

/// Draw control points (Giannelli et al., 2023, section 4.2), then a rotation. The rotation is drawn also if `turned` is
/// false, so that both cases use the same random numbers.
void bezier_surface_draw(int degree, bool turned, bat_random *random, bezier_surface *surface);
/// Evaluate a surface.
void bezier_surface_at(const bezier_surface *surface, const double parameter[2], double point[3]);

/// The Bernstein polynomials at t, and optionally their derivatives, by recurrence over the degree.
/// @param value receives degree + 1 numbers
/// @param slope receives degree + 1 numbers; null if not requested
void bezier_basis(int degree, double t, double *value, double *slope);

#endif
