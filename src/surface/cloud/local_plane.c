/// @file
/// Planes by eigenvectors of the covariance matrix  C = (1/n) sum_i (x_i - mean)(x_i - mean)^T.

#include "surface/cloud/local_plane.h"

#include "base/error.h"
#include "linalg/symmetric.h"

#include <string.h>

/// Fit a plane to the points of the entries, or to the first points where these are null.
static local_plane fit_plane(const double *points, const neighbour *entries, size_t count)
{
    local_plane plane = {0};
    double number = (double)count, moment[9] = {0}, vectors[9];
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++)
            plane.centre[k] += points[3 * (entries != NULL ? (size_t)entries[i].item : i) + k] / number;
    for (size_t i = 0; i < count; i++)
    {
        double arm[3];
        vector3_subtract(points + 3 * (entries != NULL ? (size_t)entries[i].item : i), plane.centre, arm);
        for (int k = 0; k < 9; k++)
            moment[k] += arm[k / 3] * arm[k % 3] / number;
    }
    symmetric_eigen(3, moment, vectors, SYMMETRIC_BY_NORM);
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 3; i++)
        for (int j = i + 1; j < 3; j++)
            if (moment[4 * order[j]] > moment[4 * order[i]])
                SWAP(order[i], order[j]);
    for (int i = 0; i < 3; i++)
    {
        memcpy(plane.axes[i], vectors + 3 * (ptrdiff_t)order[i], sizeof plane.axes[i]);
        plane.variance[i] = fmax(moment[4 * order[i]], 0);
    }
    vector3_cross(plane.axes[0], plane.axes[1], plane.axes[2]);
    return plane;
}

local_plane local_plane_fit(const double *points, const neighbour_list *list)
{
    return fit_plane(points, list->entries, list->count);
}

local_plane local_plane_fit_all(const double *points, size_t count)
{
    return fit_plane(points, NULL, count);
}

void local_plane_project(const local_plane *plane, const double origin[3], const double point[3], double foot[2])
{
    double arm[3];
    vector3_subtract(point, origin, arm);
    foot[0] = vector3_dot(arm, plane->axes[0]);
    foot[1] = vector3_dot(arm, plane->axes[1]);
}

unit_frame unit_frame_of(const double *points, size_t count)
{
    unit_frame frame = {.exponent = 1};
    double low[3], high[3], half = 0;
    box_of_points(3, points, count, low, high);
    for (int k = 0; k < 3; k++)
    {
        frame.middle[k] = low[k] * 0.5 + high[k] * 0.5;
        half = fmax(half, high[k] * 0.5 - low[k] * 0.5);
    }
    int exponent = 0;
    (void)frexp(half, &exponent);
    frame.exponent = 1 - exponent;
    return frame;
}

void unit_frame_place(const unit_frame *frame, const double point[3], double place[3])
{
    for (int k = 0; k < 3; k++)
        place[k] = ldexp(point[k] * 0.5 - frame->middle[k] * 0.5, frame->exponent);
}

double *points_to_unit_size(const double *points, size_t count)
{
    double *made = memory_array(count, 3 * sizeof *made);
    if (made == NULL)
        return NULL;
    unit_frame frame = unit_frame_of(points, count);
    for (size_t i = 0; i < count; i++)
        unit_frame_place(&frame, points + 3 * i, made + 3 * i);
    return made;
}

/// Largest ratio of the variance across the plane to the smaller one along it.
static const double MAX_THICKNESS = 0.25;

bat_status neighbourhood_find(const nearest_tree *tree, const double *points, const double place[3], size_t wanted,
                              neighbour_list *near, local_plane *plane, bat_error *error)
{
    for (;; wanted *= 2)
    {
        bat_status status = neighbours_nearest(tree, place, wanted, near, error);
        if (status != BAT_OK)
            return status;
        *plane = local_plane_fit(points, near);
        if (plane->variance[2] <= MAX_THICKNESS * plane->variance[1] || wanted >= NEIGHBOURHOOD_MAX ||
            near->count == tree->count)
            return BAT_OK;
    }
}

// Quadratic polynomials by normal equations

#define TERMS LOCAL_QUADRATIC_TERMS

/// Pivots below this fraction of the diagonal entry are skipped.
static const double MIN_PIVOT = 1e-9;

/// Solve the normal equations in place by Cholesky's method. Terms that the points do not determine get 0.
static void solve(double matrix[TERMS][TERMS], double *right)
{
    bool determined[TERMS];
    for (int j = 0; j < TERMS; j++)
    {
        double diagonal = matrix[j][j];
        for (int k = 0; k < j; k++)
            matrix[j][j] -= determined[k] ? matrix[j][k] * matrix[j][k] : 0;
        determined[j] = matrix[j][j] > MIN_PIVOT * diagonal;
        if (!determined[j])
            continue;
        matrix[j][j] = sqrt(matrix[j][j]);
        for (int i = j + 1; i < TERMS; i++)
        {
            for (int k = 0; k < j; k++)
                matrix[i][j] -= determined[k] ? matrix[i][k] * matrix[j][k] : 0;
            matrix[i][j] /= matrix[j][j];
        }
    }
    for (int j = 0; j < TERMS; j++)
    {
        for (int k = 0; k < j; k++)
            right[j] -= determined[k] ? matrix[j][k] * right[k] : 0;
        right[j] = determined[j] ? right[j] / matrix[j][j] : 0;
    }
    for (int j = TERMS; j-- > 0;)
    {
        for (int i = j + 1; i < TERMS; i++)
            right[j] -= determined[j] && determined[i] ? matrix[i][j] * right[i] : 0;
        right[j] = determined[j] ? right[j] / matrix[j][j] : 0;
    }
}

/// The terms at a point, and its height above the plane.
static double terms_at(const local_quadratic *quadratic, const double point[3], double terms[TERMS])
{
    const local_plane *plane = &quadratic->plane;
    double height = 0, foot[2];
    local_plane_project(plane, plane->centre, point, foot);
    for (int k = 0; k < 3; k++)
        height += (point[k] - plane->centre[k]) * plane->axes[2][k];
    double x = foot[0] / quadratic->scale, y = foot[1] / quadratic->scale;
    const double values[TERMS] = {1, x, y, x * x, x * y, y * y};
    for (int k = 0; k < TERMS; k++)
        terms[k] = values[k];
    return height;
}

local_quadratic local_quadratic_fit(const double *points, const neighbour_list *near, const local_plane *plane)
{
    local_quadratic quadratic = {.plane = *plane, .scale = sqrt(plane->variance[0])};
    double matrix[TERMS][TERMS] = {{0}};
    for (size_t i = 0; i < near->count; i++)
    {
        double terms[TERMS], height = terms_at(&quadratic, points + 3 * (size_t)near->entries[i].item, terms);
        for (int a = 0; a < TERMS; a++)
        {
            quadratic.terms[a] += terms[a] * height;
            for (int b = 0; b <= a; b++)
                matrix[a][b] += terms[a] * terms[b];
        }
    }
    solve(matrix, quadratic.terms);
    return quadratic;
}

double local_quadratic_height(const local_quadratic *quadratic, const double point[3])
{
    double terms[TERMS], height = terms_at(quadratic, point, terms);
    for (int k = 0; k < TERMS; k++)
        height -= quadratic->terms[k] * terms[k];
    return height;
}

// Noise by local quadratic fits

enum
{
    MIN_POINTS = 24,
    MAX_POINTS = 1536,
    MAX_PLACES = 1000
};

/// Neighbourhoods grow until the residual variance is at most this share of the smaller variance along the plane: in smaller
/// ones the plane follows the noise. Where none is so flat, as in thin parts, the flattest counts.
static const double MAX_FLATNESS = 0.02;

/// The variance of the neighbours' heights about a quadratic polynomial, by the median of its distribution.
static double variance_at(const double *points, const neighbour_list *near, const local_plane *plane)
{
    local_quadratic quadratic = local_quadratic_fit(points, near, plane);
    double squares = 0;
    for (size_t i = 0; i < near->count; i++)
    {
        double height = local_quadratic_height(&quadratic, points + 3 * (size_t)near->entries[i].item);
        squares += height * height;
    }
    double freedom = (double)near->count - LOCAL_QUADRATIC_TERMS, root = 1 - 2 / (9 * freedom);
    return squares / (freedom * root * root * root);
}

bat_status noise_estimate(const double *points, const nearest_tree *tree, double *sigma, bat_error *error)
{
    size_t stride = tree->count / MAX_PLACES + 1, made = 0;
    double *variances = memory_array(tree->count / stride + 1, sizeof *variances);
    if (variances == NULL)
        return error_memory(error, tree->count * sizeof *variances);
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    *sigma = 0;
    for (size_t i = stride / 2; i < tree->count && status == BAT_OK && tree->count >= MIN_POINTS; i += stride)
    {
        double flattest = INFINITY, least = 0;
        for (size_t wanted = MIN_POINTS; status == BAT_OK; wanted *= 2)
        {
            status = neighbours_nearest(tree, points + 3 * i, wanted, &near, error);
            if (status != BAT_OK)
                break;
            local_plane plane = local_plane_fit(points, &near);
            double variance = plane.variance[1] > 0 ? variance_at(points, &near, &plane) : 0;
            double flatness = plane.variance[1] > 0 ? variance / plane.variance[1] : 0;
            if (flatness < flattest)
            {
                flattest = flatness;
                least = variance;
            }
            if (flatness <= MAX_FLATNESS || wanted >= MAX_POINTS || 4 * near.count >= tree->count)
                break;
        }
        if (status == BAT_OK)
            variances[made++] = least;
    }
    if (status == BAT_OK && made > 0)
        *sigma = sqrt(sort_median(variances, made));
    neighbour_list_free(&near);
    free(variances);
    return status;
}
