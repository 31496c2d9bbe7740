#ifndef TESTS_SUPPORT_SURFACE_FIT_HELPERS_H
#define TESTS_SUPPORT_SURFACE_FIT_HELPERS_H

#include "check.h"

#include "batten/surface_fit.h"

/// A function of the square into space.
typedef void (*surface_shape)(double u, double v, double *point);

/// Points of a shape with their parameters. Release it with sample_free().
typedef struct surface_sample
{
    bat_surface_fit_data data;
    double *points;
    double *truth; ///< the points without noise
} surface_sample;

/// Random parameters, the first ones going round the boundary, corners first of each side.
static inline surface_sample sample_make(surface_shape shape, size_t count, size_t boundary, double noise, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    surface_sample sample = {.points = calloc(3 * count, sizeof(double)), .truth = calloc(3 * count, sizeof(double))};
    double *parameters = calloc(2 * count, sizeof(double));
    assert_non_null(sample.points);
    assert_non_null(sample.truth);
    assert_non_null(parameters);
    size_t side = boundary / 4;
    for (size_t i = 0; i < count; i++)
    {
        double *at = parameters + 2 * i, t = side > 0 ? (double)(i % side) / (double)side : 0;
        at[0] = bat_random_uniform(&random);
        at[1] = bat_random_uniform(&random);
        if (i < 4 * side)
        {
            size_t which = i / side;
            at[0] = which == 0 ? t : which == 1 ? 1 : which == 2 ? 1 - t : 0;
            at[1] = which == 0 ? 0 : which == 1 ? t : which == 2 ? 1 : 1 - t;
        }
        shape(at[0], at[1], sample.truth + 3 * i);
        for (size_t k = 0; k < 3; k++)
            sample.points[3 * i + k] = sample.truth[3 * i + k] + noise * bat_random_normal(&random);
    }
    sample.data = (bat_surface_fit_data){.points = sample.points,
                                         .parameters = parameters,
                                         .count = count,
                                         .dimension = 3,
                                         .boundary_count = 4 * side,
                                         .slides = true};
    return sample;
}

static inline void sample_free(surface_sample *sample)
{
    free(sample->points);
    free(sample->truth);
    free(sample->data.parameters);
}

/// Hills of several widths on a bent sheet.
static inline void shape_hills(double u, double v, double *point)
{
    double x = u - 0.3, y = v - 0.6;
    point[0] = u + 0.05 * sin(4 * v);
    point[1] = v;
    point[2] = 0.1 * sin(5 * u * u + 3 * v) + 0.1 * exp(-200 * (x * x + y * y));
}

/// A polynomial of bidegree (2, 2).
static inline void shape_biquadratic(double u, double v, double *point)
{
    point[0] = u + 0.3 * v * v;
    point[1] = v - 0.2 * u * u * v;
    point[2] = 1 + u * v - 2 * u * u * v * v;
}

/// A space of some bidegree that is refined here and there.
static inline bat_hierarchical_space *refined_space(int degree_u, int degree_v, bool truncated)
{
    bat_hierarchical_options options = bat_hierarchical_defaults();
    options.degree[0] = degree_u;
    options.degree[1] = degree_v;
    options.spans[0] = 3;
    options.spans[1] = 2;
    options.truncated = truncated;
    bat_hierarchical_space *space;
    check_status(bat_hierarchical_space_make(&options, &space, NULL), BAT_OK);
    bat_spline_box boxes[] = {{0, {0, 0}, {2, 2}}, {1, {1, 0}, {4, 3}}};
    check_status(bat_hierarchical_space_refine(space, boxes, 2, NULL), BAT_OK);
    return space;
}

/// The largest distance of a surface from the points of a sample, or from their truth.
static inline double largest_distance(const bat_spline_surface *surface, const bat_surface_fit_data *data,
                                      const double *points)
{
    double largest = 0, *values = calloc(3 * data->count, sizeof *values);
    assert_non_null(values);
    check_status(bat_spline_surface_evaluate(surface, data->parameters, data->count, 0, values, NULL), BAT_OK);
    for (size_t i = 0; i < 3 * data->count; i++)
        largest = fmax(largest, fabs(values[i] - points[i]));
    free(values);
    return largest;
}

/// The mean over points of the squared distance.
static inline double mean_squared(const bat_spline_surface *surface, const bat_surface_fit_data *data, const double *points)
{
    double sum = 0, *values = calloc(3 * data->count, sizeof *values);
    assert_non_null(values);
    check_status(bat_spline_surface_evaluate(surface, data->parameters, data->count, 0, values, NULL), BAT_OK);
    for (size_t i = 0; i < 3 * data->count; i++)
        sum += (values[i] - points[i]) * (values[i] - points[i]);
    free(values);
    return sum / (double)data->count;
}

#endif
