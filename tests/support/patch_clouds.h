#ifndef TESTS_SUPPORT_PATCH_CLOUDS_H
#define TESTS_SUPPORT_PATCH_CLOUDS_H

// Clouds of patches whose parameters are known, and meshes of such patches.

#include "check.h"

#include "batten/cloud_parameterize.h"

/// Where a surface is at a parameter.
typedef void patch_surface(double u, double v, double place[3]);

/// A cloud with the parameters it was sampled at. Release it with patch_free().
typedef struct patch
{
    bat_cloud cloud;
    double *parameters;
} patch;

static inline void patch_free(patch *made)
{
    bat_cloud_free(&made->cloud);
    free(made->parameters);
}

/// A tilted plane, sheared.
static inline void patch_plane(double u, double v, double place[3])
{
    place[0] = 1 + 2 * u + 0.5 * v;
    place[1] = -3 + 0.3 * u + 1.5 * v;
    place[2] = 0.7 * u - 0.4 * v;
}

/// Waves over the square.
static inline void patch_waves(double u, double v, double place[3])
{
    place[0] = u;
    place[1] = v;
    place[2] = 0.15 * sin(5 * u) * cos(4 * v);
}

/// A patch of the unit sphere that reaches far around it.
static inline void patch_sphere(double u, double v, double place[3])
{
    double turn = 4 * (u - 0.5), rise = 2.4 * (v - 0.5);
    place[0] = cos(rise) * cos(turn);
    place[1] = cos(rise) * sin(turn);
    place[2] = sin(rise);
}

/// The parameters of place k of a loop around the square with `side` points a side, corners shared.
static inline void patch_loop(size_t k, size_t side, double at[2])
{
    size_t edge = k / (side - 1);
    double t = (double)(k % (side - 1)) / (double)(side - 1);
    at[0] = edge == 0 ? t : edge == 1 ? 1 : edge == 2 ? 1 - t : 0;
    at[1] = edge == 0 ? 0 : edge == 1 ? t : edge == 2 ? 1 : 1 - t;
}

static inline patch patch_allocate(size_t side, size_t interior)
{
    size_t boundary = 4 * (side - 1), count = boundary + interior;
    patch made = {.cloud = {.points = malloc(count * 3 * sizeof(double)),
                            .count = count,
                            .boundary_count = boundary,
                            .corners = {0, side - 1, 2 * (side - 1), 3 * (side - 1)},
                            .has_corners = true},
                  .parameters = malloc(count * 2 * sizeof(double))};
    assert_non_null(made.cloud.points);
    assert_non_null(made.parameters);
    for (size_t k = 0; k < boundary; k++)
        patch_loop(k, side, made.parameters + 2 * k);
    return made;
}

static inline void patch_place(patch *made, patch_surface *surface, double noise, bat_random *random)
{
    for (size_t i = 0; i < made->cloud.count; i++)
    {
        surface(made->parameters[2 * i], made->parameters[2 * i + 1], made->cloud.points + 3 * i);
        for (size_t c = 0; c < 3 && noise > 0; c++)
            made->cloud.points[3 * i + c] += noise * bat_random_normal(random);
    }
}

/// Points at random parameters within the square.
static inline patch patch_scatter(patch_surface *surface, size_t side, size_t interior, double noise, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    patch made = patch_allocate(side, interior);
    for (size_t k = 2 * made.cloud.boundary_count; k < 2 * made.cloud.count; k++)
        made.parameters[k] = bat_random_uniform(&random);
    patch_place(&made, surface, noise, &random);
    return made;
}

/// The number of the point in row j, column i of a grid of `side` x `side`, the boundary first.
static inline uint32_t patch_grid_number(size_t i, size_t j, size_t side)
{
    size_t last = side - 1;
    if (j == 0)
        return (uint32_t)i;
    if (i == last)
        return (uint32_t)(last + j);
    if (j == last)
        return (uint32_t)(3 * last - i);
    if (i == 0)
        return (uint32_t)(4 * last - j);
    return (uint32_t)(4 * last + (j - 1) * (side - 2) + i - 1);
}

/// A mesh: a grid of the square, its interior points moved by up to `shake` of a cell, two triangles a cell.
static inline patch patch_mesh(patch_surface *surface, size_t side, double shake, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    patch made = patch_allocate(side, (side - 2) * (side - 2));
    double cell = 1 / (double)(side - 1);
    for (size_t j = 1; j + 1 < side; j++)
        for (size_t i = 1; i + 1 < side; i++)
        {
            double *at = made.parameters + 2 * (size_t)patch_grid_number(i, j, side);
            at[0] = cell * ((double)i + shake * (2 * bat_random_uniform(&random) - 1));
            at[1] = cell * ((double)j + shake * (2 * bat_random_uniform(&random) - 1));
        }
    patch_place(&made, surface, 0, &random);
    size_t cells = (side - 1) * (side - 1);
    made.cloud.triangles = malloc(cells * 6 * sizeof(uint32_t));
    made.cloud.triangle_count = 2 * cells;
    assert_non_null(made.cloud.triangles);
    for (size_t k = 0; k < cells; k++)
    {
        size_t i = k % (side - 1), j = k / (side - 1);
        uint32_t a = patch_grid_number(i, j, side), b = patch_grid_number(i + 1, j, side),
                 c = patch_grid_number(i + 1, j + 1, side), d = patch_grid_number(i, j + 1, side);
        const uint32_t both[6] = {a, b, c, a, c, d};
        memcpy(made.cloud.triangles + 6 * k, both, sizeof both);
    }
    return made;
}

#endif
