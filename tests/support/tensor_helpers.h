#ifndef TESTS_TENSOR_HELPERS_H
#define TESTS_TENSOR_HELPERS_H

#include "check.h"
#include "surface/spline/tensor_surface.h"

/// @file
/// Tensor-product surfaces by their definition.

/// Check both knot vectors, and that control points are finite.
static inline void check_tensor_surface(const tensor_surface *surface)
{
    for (int d = 0; d < 2; d++)
        assert_int_equal(knot_vector_check(&surface->knots[d], NULL), BAT_OK);
    size_t size = knot_vector_functions(&surface->knots[0]) * knot_vector_functions(&surface->knots[1]);
    for (size_t i = 0; i < size * surface->dimension; i++)
        assert_true(isfinite(surface->control[i]));
}

/// The point of a surface at a parameter of its domain: the sum of all products of functions, by the univariate ones.
static inline void tensor_surface_at(const tensor_surface *surface, const double parameter[2], double *value)
{
    double basis[2][BAT_SPLINE_MAX_DEGREE + 1];
    size_t span[2], degree[2], row = knot_vector_functions(&surface->knots[0]), dimension = surface->dimension;
    for (int d = 0; d < 2; d++)
    {
        const bat_knot_vector *knots = &surface->knots[d];
        assert_true(parameter[d] >= knots->knots[knots->degree]);
        assert_true(parameter[d] <= knots->knots[knot_vector_functions(knots)]);
        degree[d] = (size_t)knots->degree;
        span[d] = knot_vector_span(knots, parameter[d]);
        knot_vector_basis(knots, span[d], parameter[d], 0, basis[d]);
    }
    memset(value, 0, dimension * sizeof *value);
    for (size_t b = 0; b <= degree[1]; b++)
        for (size_t a = 0; a <= degree[0]; a++)
            for (size_t d = 0; d < dimension; d++)
                value[d] += basis[1][b] * basis[0][a] *
                            surface->control[((span[1] - degree[1] + b) * row + span[0] - degree[0] + a) * dimension + d];
}

#endif
