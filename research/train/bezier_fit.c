#include "research/train/bezier_fit.h"

#include "base/error.h"
#include "base/memory.h"

#include <assert.h>
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

static double product(size_t count, const double *x, size_t x_step, const double *y, size_t y_step)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += x[i * x_step] * y[i * y_step];
    return sum;
}

static void swap(size_t count, double *x, double *y)
{
    for (size_t i = 0; i < count; i++)
    {
        double kept = x[i];
        x[i] = y[i];
        y[i] = kept;
    }
}

/// Make v a Householder vector with v[0] = 1 whose reflection I - beta v v^T takes it to (value, 0, …).
static double make_reflector(size_t count, double *v, size_t step, double *value)
{
    double rest = product(count - 1, v + step, step, v + step, step), length = sqrt(v[0] * v[0] + rest);
    *value = v[0];
    if (rest == 0)
        return 0;
    *value = v[0] > 0 ? -length : length;
    double lead = v[0] - *value;
    for (size_t i = 1; i < count; i++)
        v[i * step] /= lead;
    return -lead / *value;
}

/// x -= beta (v . x) v, where v[0] = 1 is not stored.
static void reflect(size_t count, const double *v, size_t v_step, double beta, double *first, double *x, size_t x_step)
{
    double sum = beta * (*first + product(count - 1, v + v_step, v_step, x, x_step));
    *first -= sum;
    for (size_t i = 1; i < count; i++)
        x[(i - 1) * x_step] -= sum * v[i * v_step];
}

/// Reduce the matrix to an upper trapezoid by reflections, the longest column first, and reflect the right-hand sides.
/// @param order receives the column of each
/// @return the rank
static size_t factor(size_t rows, size_t columns, double *matrix, double *sides, size_t leading, size_t *order)
{
    size_t rank = 0, most = rows < columns ? rows : columns;
    double largest = 0;
    for (size_t j = 0; j < columns; j++)
        order[j] = j;
    for (; rank < most; rank++)
    {
        size_t longest = rank;
        double max_square = -1, value;
        for (size_t j = rank; j < columns; j++)
        {
            const double *column = matrix + j * rows + rank;
            double square = product(rows - rank, column, 1, column, 1);
            longest = square > max_square ? j : longest;
            max_square = fmax(max_square, square);
        }
        largest = fmax(largest, sqrt(max_square));
        if (!(sqrt(max_square) > RANK_SHARE * largest))
            break;
        size_t kept = order[rank];
        order[rank] = order[longest];
        order[longest] = kept;
        if (longest != rank)
            swap(rows, matrix + rank * rows, matrix + longest * rows);
        double *v = matrix + rank * rows + rank, beta = make_reflector(rows - rank, v, 1, &value);
        for (size_t j = rank + 1; j < columns; j++)
            reflect(rows - rank, v, 1, beta, matrix + j * rows + rank, matrix + j * rows + rank + 1, 1);
        for (size_t d = 0; d < 3; d++)
            reflect(rows - rank, v, 1, beta, sides + d * leading + rank, sides + d * leading + rank + 1, 1);
        *v = value;
    }
    return rank;
}

/// Solve in the sense of least squares with the matrix's columns and the right-hand sides, each `rows` long, the latter with
/// room for `columns`. Of several solutions, the shortest (Golub and Van Loan 2013, section 5.5.5).
static void solve(size_t rows, size_t columns, double *matrix, double *sides)
{
    double solution[MAX_SIDE * MAX_SIDE], beta[MAX_SIDE * MAX_SIDE] = {0};
    size_t order[MAX_SIDE * MAX_SIDE], leading = rows > columns ? rows : columns;
    size_t rank = factor(rows, columns, matrix, sides, leading, order), more = columns - rank;
    // Reflections from the right: row k keeps its entry on the diagonal; its other columns from `rank` on vanish.
    for (size_t k = rank; k-- > 0 && more > 0;)
    {
        double *row = matrix + rank * rows + k, *diagonal = matrix + k * rows + k, value;
        double rest = product(more, row, rows, row, rows), length = sqrt(*diagonal * *diagonal + rest);
        if (rest == 0)
            continue;
        value = *diagonal > 0 ? -length : length;
        for (size_t j = 0; j < more; j++)
            row[j * rows] /= *diagonal - value;
        beta[k] = (value - *diagonal) / value;
        for (size_t i = 0; i < k; i++)
            reflect(more + 1, row - rows, rows, beta[k], matrix + k * rows + i, matrix + rank * rows + i, rows);
        *diagonal = value;
    }
    for (size_t d = 0; d < 3; d++)
    {
        double *side = sides + d * leading;
        for (size_t k = rank; k-- > 0;)
            side[k] =
                (side[k] - product(rank - k - 1, matrix + (k + 1) * rows + k, rows, side + k + 1, 1)) / matrix[k * rows + k];
        memset(side + rank, 0, more * sizeof *side);
        for (size_t k = 0; k < rank && more > 0; k++)
            reflect(more + 1, matrix + (rank - 1) * rows + k, rows, beta[k], side + k, side + rank, 1);
        for (size_t k = 0; k < columns; k++)
            solution[order[k]] = side[k];
        memcpy(side, solution, columns * sizeof *side);
    }
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
        // The solution stands in the first rows, which may be more than there are points.
        memset(sides, 0, 3 * leading * sizeof *sides);
        for (size_t i = 0; i < 3 * count; i++)
            sides[i % 3 * leading + i / 3] = points[i];
        solve(count, columns, matrix, sides);
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
