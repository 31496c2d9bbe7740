/// @file
/// Quadratic polynomials by normal equations; see local_quadratic.h.

#include "surface/cloud/local_quadratic.h"

#include <math.h>

enum
{
    TERMS = LOCAL_QUADRATIC_TERMS
};

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
