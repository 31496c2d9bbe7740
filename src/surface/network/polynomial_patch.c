/// @file
/// Penalized least squares for the coefficients of a patch, by normal equations:
///     (A^T A / n + diag(cost (a^2 + b^2)^2)) c = A^T x / n,   cost = ORDER_COST + NOISE_COST noise^2 / n

#include "surface/network/chart_network.h"

#include "base/error.h"
#include "linalg/blas.h"
#include "linalg/dense.h"
#include "linalg/vector.h"

enum
{
    ORDERS = PATCH_DEGREE + 1,
    BLOCK = 64, ///< rows assembled at a time
    COLUMNS = PATCH_TERMS + 3
};

/// Penalty factor, relative to the mean squared distance in the unit box.
static const double ORDER_COST = 1e-7;
/// Penalty factor for noise: the prior standard deviation of c_ab is 0.3 / (a^2 + b^2).
static const double NOISE_COST = 1 / (0.3 * 0.3);
/// Regularizes fits with fewer points than coefficients.
static const double RIDGE = 1e-14;
/// Regularize a step where the tangents are nearly parallel: STEP_RIDGE relative to |X_u|^2 |X_v|^2, STEP_FLOOR absolute.
static const double STEP_RIDGE = 1e-3, STEP_FLOOR = 1e-9;
/// Maximum length of a step in either parameter.
static const double MAX_STEP = 0.2;

void legendre_polynomials(double t, int degree, double *values)
{
    double x = 2 * t - 1;
    values[0] = 1;
    values[1] = x;
    for (int k = 1; k < degree; k++)
        values[k + 1] = ((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1);
}

/// Derivatives with respect to t of the Legendre polynomials at 2 t - 1.
static void legendre_slopes(const double *values, double *slopes)
{
    slopes[0] = 0;
    slopes[1] = 2;
    for (int k = 1; k < PATCH_DEGREE; k++)
        slopes[k + 1] = slopes[k - 1] + 2 * (2 * k + 1) * values[k];
}

/// A row of the design matrix: the terms at a parameter, then the coordinates of the point.
static void fill_row(const double *point, const double *parameter, double *row)
{
    double u[ORDERS], v[ORDERS];
    legendre_polynomials(parameter[0], PATCH_DEGREE, u);
    legendre_polynomials(parameter[1], PATCH_DEGREE, v);
    for (size_t a = 0; a < ORDERS; a++)
        for (size_t b = 0; b < ORDERS; b++)
            row[a * ORDERS + b] = u[a] * v[b];
    memcpy(row + PATCH_TERMS, point, 3 * sizeof *point);
}

/// The upper triangle of rows^T rows / count.
static void accumulate(const double *points, const double *parameters, size_t count, double *rows, double *products)
{
    memset(products, 0, (size_t)COLUMNS * COLUMNS * sizeof *products);
    for (size_t begin = 0; begin < count; begin += BLOCK)
    {
        size_t end = begin + BLOCK < count ? begin + BLOCK : count;
        for (size_t i = begin; i < end; i++)
            fill_row(points + 3 * i, parameters + 2 * i, rows + (i - begin) * COLUMNS);
        cblas_dsyrk(CblasRowMajor, CblasUpper, CblasTrans, COLUMNS, (int)(end - begin), 1 / (double)count, rows, COLUMNS, 1,
                    products, COLUMNS);
    }
}

static bat_status solve(const double *products, double cost, polynomial_patch *descriptor, bat_error *error)
{
    double matrix[PATCH_TERMS * PATCH_TERMS];
    for (size_t k = 0; k < PATCH_TERMS; k++)
    {
        size_t a = k / ORDERS, b = k % ORDERS;
        double order = (double)(a * a + b * b);
        for (size_t m = k; m < PATCH_TERMS; m++)
            matrix[k * PATCH_TERMS + m] = matrix[m * PATCH_TERMS + k] = products[k * COLUMNS + m];
        matrix[k * (PATCH_TERMS + 1)] += cost * order * order + RIDGE;
        memcpy(descriptor->terms[k], products + k * COLUMNS + PATCH_TERMS, 3 * sizeof(double));
    }
    bat_status status = decompose_solve(PATCH_TERMS, 3, matrix, &descriptor->terms[0][0], error);
    if (status != BAT_NO_CONVERGENCE)
        return status;
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                     "the polynomial patch through the cloud cannot be computed");
}

static void evaluate(const polynomial_patch *descriptor, const double parameter[2], double x[3], double xu[3], double xv[3])
{
    double u[ORDERS], v[ORDERS], du[ORDERS], dv[ORDERS];
    legendre_polynomials(parameter[0], PATCH_DEGREE, u);
    legendre_polynomials(parameter[1], PATCH_DEGREE, v);
    legendre_slopes(u, du);
    legendre_slopes(v, dv);
    for (size_t d = 0; d < 3; d++)
        x[d] = xu[d] = xv[d] = 0;
    for (size_t a = 0; a < ORDERS; a++)
    {
        double along[3] = {0}, across[3] = {0};
        for (size_t b = 0; b < ORDERS; b++)
            for (size_t d = 0; d < 3; d++)
            {
                along[d] += descriptor->terms[a * ORDERS + b][d] * v[b];
                across[d] += descriptor->terms[a * ORDERS + b][d] * dv[b];
            }
        for (size_t d = 0; d < 3; d++)
        {
            x[d] += u[a] * along[d];
            xu[d] += du[a] * along[d];
            xv[d] += u[a] * across[d];
        }
    }
}

static double root_mean_square(const polynomial_patch *descriptor, const double *points, const double *parameters,
                               size_t count)
{
    double sum = 0, x[3], xu[3], xv[3];
    for (size_t i = 0; i < count; i++)
    {
        evaluate(descriptor, parameters + 2 * i, x, xu, xv);
        for (size_t d = 0; d < 3; d++)
            sum += (points[3 * i + d] - x[d]) * (points[3 * i + d] - x[d]);
    }
    return sqrt(sum / (double)count);
}

bat_status polynomial_patch_fit(const double *points, const double *parameters, size_t count, double noise,
                                polynomial_patch *descriptor, bat_error *error)
{
    bat_status status = blas_load(error);
    if (status != BAT_OK)
        return status;
    size_t size = (size_t)COLUMNS * (COLUMNS + BLOCK) * sizeof(double);
    double *products = memory_array(size, 1);
    if (products == NULL)
        return error_memory(error, size);
    accumulate(points, parameters, count, products + COLUMNS * COLUMNS, products);
    polynomial_patch made;
    status = solve(products, ORDER_COST + NOISE_COST * noise * noise / (double)count, &made, error);
    free(products);
    if (status != BAT_OK)
        return status;
    made.residual = root_mean_square(&made, points, parameters, count);
    *descriptor = made;
    return BAT_OK;
}

static double bounded(double step)
{
    return fmin(fmax(step, -MAX_STEP), MAX_STEP);
}

void polynomial_patch_step(const polynomial_patch *descriptor, const double point[3], const double parameter[2],
                           double step[2])
{
    double x[3], xu[3], xv[3], gap[3];
    evaluate(descriptor, parameter, x, xu, xv);
    vector3_subtract(point, x, gap);
    double uu = vector3_dot(xu, xu), uv = vector3_dot(xu, xv), vv = vector3_dot(xv, xv);
    double along = vector3_dot(gap, xu), across = vector3_dot(gap, xv);
    double determinant = uu * vv * (1 + STEP_RIDGE) - uv * uv + STEP_FLOOR;
    step[0] = bounded((vv * along - uv * across) / determinant);
    step[1] = bounded((uu * across - uv * along) / determinant);
}

bool polynomial_patch_features(const polynomial_patch *descriptor, double *features)
{
    const double *p = descriptor->terms[ORDERS], *q = descriptor->terms[1];
    double first[3], second[3], third[3];
    double length = sqrt(vector3_dot(p, p));
    for (size_t d = 0; d < 3; d++)
        first[d] = p[d] / length;
    double along = vector3_dot(q, first);
    for (size_t d = 0; d < 3; d++)
        second[d] = q[d] - along * first[d];
    double height = sqrt(vector3_dot(second, second)), scale = 1 / sqrt(length * height);
    if (!isfinite(scale) || !(height > 1e-6 * length) || !(length > 1e-6 * height))
        return false;
    for (size_t d = 0; d < 3; d++)
        second[d] /= height;
    vector3_cross(first, second, third);
    for (size_t k = 1; k < PATCH_TERMS; k++)
    {
        const double *c = descriptor->terms[k];
        double *to = features + 3 * (k - 1);
        to[0] = scale * vector3_dot(c, first);
        to[1] = scale * vector3_dot(c, second);
        to[2] = scale * vector3_dot(c, third);
    }
    return true;
}
