#include "research/train/bezier_fit.h"

#include "base/error.h"
#include "base/memory.h"

#include <assert.h>
#include <lapacke.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Singular values below this, relative to the largest, are treated as 0.
static const double RANK_SHARE = 1e-11;

enum
{
    MAX_SIDE = BEZIER_MAX_DEGREE + 1
};

/// The matrix of the least-squares problem, column by column.
static void collocate(const double *parameters, size_t count, int degree, double *matrix)
{
    size_t side = (size_t)degree + 1;
    for (size_t k = 0; k < count; k++)
    {
        double u[MAX_SIDE], v[MAX_SIDE];
        bezier_basis(degree, parameters[2 * k], u, NULL);
        bezier_basis(degree, parameters[2 * k + 1], v, NULL);
        for (size_t i = 0; i < side; i++)
            for (size_t j = 0; j < side; j++)
                matrix[(j * side + i) * count + k] = u[i] * v[j];
    }
}

/// The derivatives of the patch.
static void slopes_at(const bezier_surface *patch, const double parameter[2], double slope_u[3], double slope_v[3])
{
    double u[MAX_SIDE], v[MAX_SIDE], du[MAX_SIDE] = {0}, dv[MAX_SIDE] = {0};
    bezier_basis(patch->degree, parameter[0], u, du);
    bezier_basis(patch->degree, parameter[1], v, dv);
    const double(*control)[3] = patch->control;
    for (size_t a = 0; a < 3; a++)
        slope_u[a] = slope_v[a] = 0;
    for (int j = 0; j <= patch->degree; j++)
        for (int i = 0; i <= patch->degree; i++, control++)
            for (size_t a = 0; a < 3; a++)
            {
                slope_u[a] += du[i] * v[j] * (*control)[a];
                slope_v[a] += u[i] * dv[j] * (*control)[a];
            }
}

static bool are_finite(const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(numbers[i]))
            return false;
    return true;
}

/// Solve with the matrix's columns and the right-hand sides, each `rows` long, the latter with room for `columns`.
static bat_status solve(size_t rows, size_t columns, double *matrix, double *sides, bat_error *error)
{
    lapack_int pivots[MAX_SIDE * MAX_SIDE] = {0}, rank;
    size_t leading = rows > columns ? rows : columns;
    lapack_int failure = LAPACKE_dgelsy(LAPACK_COL_MAJOR, (lapack_int)rows, (lapack_int)columns, 3, matrix, (lapack_int)rows,
                                        sides, (lapack_int)leading, pivots, RANK_SHARE, &rank);
    return failure == 0 ? BAT_OK : error_memory(error, rows * columns * sizeof *matrix);
}

static void find_residual(const double *points, const double *parameters, size_t count, bezier_fit *fit)
{
    double squares = 0;
    for (size_t k = 0; k < count; k++)
    {
        double point[3];
        bezier_surface_at(&fit->patch, parameters + 2 * k, point);
        for (size_t a = 0; a < 3; a++)
        {
            double r = fit->residual[3 * k + a] = point[a] - points[3 * k + a];
            squares += r * r;
        }
    }
    fit->error = squares / (3 * (double)count);
}

bat_status bezier_fit_make(const double *points, const double *parameters, size_t count, bezier_fit *fit, bat_error *error)
{
    assert(fit->patch.degree >= 1 && fit->patch.degree <= BEZIER_MAX_DEGREE && count > 0);
    size_t side = (size_t)fit->patch.degree + 1, columns = side * side, leading = count > columns ? count : columns, size;
    if (count > INT_MAX || size_multiply_overflows(count, columns, &size))
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "%zu points are too many for a fit", count);
    if (!are_finite(points, 3 * count) || !are_finite(parameters, 2 * count))
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "points or parameters of a fit are not finite");
    double *matrix = memory_array(size, sizeof *matrix), *sides = memory_array(leading, 3 * sizeof *sides);
    bat_status status = BAT_OK;
    if (matrix == NULL || sides == NULL)
        status = error_memory(error, size * sizeof *matrix);
    else
    {
        collocate(parameters, count, fit->patch.degree, matrix);
        // LAPACK returns the solution in the first rows, which may be more than there are points.
        memset(sides, 0, 3 * leading * sizeof *sides);
        for (size_t i = 0; i < 3 * count; i++)
            sides[i % 3 * leading + i / 3] = points[i];
        status = solve(count, columns, matrix, sides, error);
    }
    for (size_t i = 0; i < 3 * columns && status == BAT_OK; i++)
        fit->patch.control[i / 3][i % 3] = sides[i % 3 * leading + i / 3];
    if (status == BAT_OK)
        find_residual(points, parameters, count, fit);
    free(matrix);
    free(sides);
    return status;
}

void bezier_fit_gradient(const bezier_fit *fit, const double *parameters, size_t count, double *gradient)
{
    double share = 2 / (3 * (double)count);
    for (size_t k = 0; k < count; k++)
    {
        double slopes[2][3];
        slopes_at(&fit->patch, parameters + 2 * k, slopes[0], slopes[1]);
        for (size_t d = 0; d < 2; d++)
        {
            const double *r = fit->residual + 3 * k, *s = slopes[d];
            gradient[2 * k + d] = share * (r[0] * s[0] + r[1] * s[1] + r[2] * s[2]);
        }
    }
}
