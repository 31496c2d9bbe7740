/// @file
/// Knot vectors, and B-spline basis functions with derivatives by the recurrence of Cox and de Boor (The NURBS Book, A2.2
/// and A2.3):
///     B_i,p(t) = (t - t_i) / (t_i+p - t_i) B_i,p-1(t) + (t_i+p+1 - t) / (t_i+p+1 - t_i+1) B_i+1,p-1(t).

#include "surface/spline/tensor_surface.h"

#include "base/bisect.h"
#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

bat_status knot_vector_uniform(int degree, size_t spans, bat_knot_vector *knots, bat_error *error)
{
    if (degree < 0 || degree > BAT_SPLINE_MAX_DEGREE)
        return ERROR_ARGUMENT(error, "the degree %d is not between 0 and %d", degree, BAT_SPLINE_MAX_DEGREE);
    if (spans == 0)
        return ERROR_ARGUMENT(error, "a knot vector needs at least one span");
    size_t p = (size_t)degree, count;
    if (__builtin_add_overflow(spans, 2 * p + 1, &count) || count > SIZE_MAX / sizeof(double))
        return ERROR_TOO_LARGE(error, "a knot vector of %zu spans is too large", spans);
    double *made = memory_array(count, sizeof *made);
    if (made == NULL)
        return error_memory(error, count * sizeof *made);
    for (size_t i = 0; i < count; i++)
        made[i] = i <= p ? 0 : i >= p + spans ? 1 : (double)(i - p) / (double)spans;
    *knots = (bat_knot_vector){made, count, degree};
    return BAT_OK;
}

bat_status knot_vector_check(const bat_knot_vector *knots, bat_error *error)
{
    if (knots->degree < 0 || knots->degree > BAT_SPLINE_MAX_DEGREE)
        return ERROR_ARGUMENT(error, "the degree %d is not between 0 and %d", knots->degree, BAT_SPLINE_MAX_DEGREE);
    size_t p = (size_t)knots->degree, multiplicity = 1;
    if (knots->knots == NULL || knots->count < 2 * p + 2)
        return ERROR_ARGUMENT(error, "a knot vector of degree %zu has at least %zu knots", p, 2 * p + 2);
    for (size_t i = 0; i < knots->count; i++)
    {
        if (!isfinite(knots->knots[i]))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "knot %zu is not finite", i);
        if (i > 0 && knots->knots[i] < knots->knots[i - 1])
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "knot %zu is smaller than the knot before it", i);
        multiplicity = i > 0 && knots->knots[i] == knots->knots[i - 1] ? multiplicity + 1 : 1;
        if (multiplicity > p + 1)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "knot %zu has a multiplicity above %zu", i, p + 1);
    }
    if (!(knots->knots[p] < knots->knots[knots->count - p - 1]))
        return error_set(error, BAT_INVALID_ARGUMENT, p, 0, "the domain from knot %zu to knot %zu has no length", p,
                         knots->count - p - 1);
    return BAT_OK;
}

void knot_vector_free(bat_knot_vector *knots)
{
    free(knots->knots);
    *knots = (bat_knot_vector){0};
}

size_t knot_vector_span(const bat_knot_vector *knots, double t)
{
    // Bisection with knots[low] <= t, and knots[high] > t or at the end of the domain.
    size_t low = (size_t)knots->degree, high = knot_vector_functions(knots);
    if (t >= knots->knots[high])
        while (knots->knots[high - 1] == knots->knots[high])
            high--;
    return bisect_reals(knots->knots, low, high, t);
}

/// The functions of degrees 0 to p on a span, and the widths of their recurrences.
typedef struct basis_triangle
{
    double values[BAT_SPLINE_MAX_DEGREE + 1][BAT_SPLINE_MAX_DEGREE + 1]; ///< [j][r]: function span - j + r of degree j
    double widths[BAT_SPLINE_MAX_DEGREE + 1][BAT_SPLINE_MAX_DEGREE + 1]; ///< [j][r]: denominator of the recurrence
} basis_triangle;

/// A2.2 of The NURBS Book.
static void fill_triangle(const bat_knot_vector *knots, size_t span, double t, basis_triangle *triangle)
{
    const double *after = knots->knots + span + 1;
    triangle->values[0][0] = 1;
    for (int j = 1; j <= knots->degree; j++)
    {
        double saved = 0;
        for (int r = 0; r < j; r++)
        {
            double upper = after[r], lower = after[r - j];
            triangle->widths[j][r] = upper - lower;
            double share = triangle->values[j - 1][r] / (upper - lower);
            triangle->values[j][r] = saved + (upper - t) * share;
            saved = (t - lower) * share;
        }
        triangle->values[j][j] = saved;
    }
}

void knot_vector_basis(const bat_knot_vector *knots, size_t span, double t, int derivatives, double *values)
{
    size_t p = (size_t)knots->degree;
    basis_triangle triangle;
    fill_triangle(knots, span, t, &triangle);
    for (size_t k = 0; k <= (size_t)derivatives; k++)
    {
        double *row = values + k * (p + 1);
        if (k > p)
        {
            memset(row, 0, (p + 1) * sizeof *row);
            continue;
        }
        // k differences of the functions of degree p - k give the k-th derivatives of degree p.
        memcpy(row, triangle.values[p - k], (p - k + 1) * sizeof *row);
        for (size_t j = p - k + 1; j <= p; j++)
        {
            double before = 0;
            for (size_t r = 0; r < j; r++)
            {
                double slope = (double)j * row[r] / triangle.widths[j][r];
                row[r] = before - slope;
                before = slope;
            }
            row[j] = before;
        }
    }
}
