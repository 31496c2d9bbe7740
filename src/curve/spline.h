#ifndef CURVE_SPLINE_H
#define CURVE_SPLINE_H

#include "curve/scheme_kind.h"

/// @file
/// Splines of Bezier curves through the points of a curve. A Bezier curve over an edge has an odd degree d. Its inner
/// control points follow from the first (d - 1) / 2 derivatives by the parameter at both ends. Between points of a space
/// other than R^n, de Casteljau's algorithm takes points of geodesics (Park and Ravani 1995). Two such curves with the same
/// velocity at their common point are C1; in R^n those of degree 5 with the same acceleration are C2.

enum
{
    SPLINE_MAX_DEGREE = 5
};

typedef struct spline spline;

/// What differs from spline to spline.
typedef struct spline_form
{
    size_t degree;                              ///< 3 or 5
    void (*weights)(double t, double *weights); ///< the degree + 1 Bernstein polynomials
    /// Find the derivatives at all points.
    /// @param fault receives the point at fault
    bat_status (*find)(const spline *s, const bat_curve_refine_options *options, size_t *fault);
} spline_form;

struct spline
{
    const bat_curve *coarse;
    const bat_curve_scheme *scheme;
    const spline_form *form;
    const bat_space *space; ///< of the rows
    size_t channel_count, dim, tangent_dim, count, edges;
    bool euclidean;
    double *rows;        ///< count x dim
    double *increments;  ///< of the parameter over each edge
    double *derivatives; ///< count x (degree - 1) / 2 x tangent_dim, by the parameter: velocities, accelerations
};

static inline size_t spline_wrapped(const spline *s, ptrdiff_t i)
{
    ptrdiff_t count = (ptrdiff_t)s->count;
    return (size_t)((i % count + count) % count);
}

static inline const double *spline_row_at(const spline *s, ptrdiff_t i)
{
    return s->rows + spline_wrapped(s, i) * s->dim;
}

/// The increment over the edge that begins at point i.
static inline double spline_increment(const spline *s, ptrdiff_t i)
{
    return s->increments[spline_wrapped(s, i)];
}

/// Derivative `order`, from 1 on, at point i.
static inline double *spline_derivative(const spline *s, size_t i, size_t order)
{
    return s->derivatives + (i * (s->form->degree / 2) + order - 1) * s->tangent_dim;
}

/// A spline_refine of a form.
bat_status spline_make(const spline_form *form, const bat_curve *coarse, const refine_plan *plan, double *points,
                       double *channels, bat_error *error);

#endif
