#include "surface/network/surface_chart_network.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/cloud_parameterize.h"
#include "learn/blas.h"
#include "surface/network/surface_chart.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Parameters

static size_t inputs_of(size_t layer)
{
    return layer == 0 ? (size_t)SURFACE_SEEN : (size_t)CHART_WIDTH;
}

static size_t outputs_of(size_t layer)
{
    return layer + 1 == CHART_LAYERS ? (size_t)CHART_MOVES : (size_t)CHART_WIDTH;
}

static bat_status make(learn_parameters *parameters, bat_error *error)
{
    for (size_t layer = 0; layer < CHART_LAYERS; layer++)
    {
        char name[LEARN_NAME_SIZE];
        (void)snprintf(name, sizeof name, "layer.%zu.weight", layer);
        (void)learn_parameters_add(parameters, outputs_of(layer), inputs_of(layer), name);
        (void)snprintf(name, sizeof name, "layer.%zu.bias", layer);
        (void)learn_parameters_add(parameters, 0, outputs_of(layer), name);
    }
    bat_status status = learn_parameters_allocate(parameters, error);
    if (status != BAT_OK)
        learn_parameters_free(parameters);
    return status;
}

static bat_status make_network(const learn_parameters *parameters, void **network, bat_error *error)
{
    real *weights = memory_array(parameters->total, sizeof *weights);
    if (weights == NULL)
        return error_memory(error, parameters->total * sizeof *weights);
    memcpy(weights, parameters->values, parameters->total * sizeof *weights);
    *network = weights;
    return BAT_OK;
}

static void say_at_once(const real *weights, const double *seen, double *moves)
{
    real x[CHART_WIDTH], y[CHART_WIDTH];
    for (size_t i = 0; i < SURFACE_SEEN; i++)
        x[i] = (real)seen[i];
    for (size_t layer = 0; layer < CHART_LAYERS; layer++)
    {
        size_t inputs = inputs_of(layer), outputs = outputs_of(layer);
        const real *bias = weights + inputs * outputs;
        for (size_t i = 0; i < outputs; i++)
            y[i] = bias[i];
        REAL_GEMV(CblasRowMajor, CblasNoTrans, (int)outputs, (int)inputs, 1, weights, (int)inputs, x, 1, 1, y, 1);
        for (size_t i = 0; i < outputs; i++)
            x[i] = layer + 1 < CHART_LAYERS ? real_gelu(y[i]) : y[i];
        weights = bias + outputs;
    }
    for (size_t i = 0; i < CHART_MOVES; i++)
        moves[i] = (double)x[i];
}

/// Parameters of little stretch, which take more time.
static bat_status parameterize_deep(const bat_cloud *cloud, const double *boundary, int threads, double *interior,
                                    bat_error *error)
{
    double *all = memory_array(cloud->count, 2 * sizeof *all);
    if (all == NULL)
        return error_memory(error, cloud->count * 2 * sizeof *all);
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.method = BAT_CLOUD_PARAMETERIZE_STRETCH_MINIMIZING;
    options.threads = threads;
    bat_status status = bat_cloud_parameterize(cloud, boundary, &options, all, error);
    if (status == BAT_OK)
        memcpy(interior, all + 2 * cloud->boundary_count, 2 * (cloud->count - cloud->boundary_count) * sizeof *interior);
    free(all);
    return status;
}

static bat_status check_boundary(const bat_cloud *cloud, const double *boundary, bat_error *error)
{
    if (cloud->boundary_count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the boundary of the cloud is not known");
    for (size_t i = 0; i < 2 * cloud->boundary_count; i++)
        if (!isfinite(boundary[i]))
            return error_set(error, BAT_INVALID_ARGUMENT, i / 2, 0, "the parameters of boundary point %zu are not finite",
                             i / 2);
    return BAT_OK;
}

static bat_status infer(const void *network, const bat_cloud *cloud, const double *boundary, int threads, double *interior,
                        bat_error *error)
{
    bat_status status = check_boundary(cloud, boundary, error);
    if (status != BAT_OK)
        return status;
    size_t count = cloud->count - cloud->boundary_count;
    double *memory = memory_array(count, 4 * sizeof *memory);
    if (memory == NULL)
        return error_memory(error, count * 4 * sizeof *memory);
    surface_chart chart;
    blas_single_begin();
    status = surface_chart_make(cloud, boundary, memory, &chart, error);
    // Charts of deep shapes are like none that the network has learned from: it is not asked about them.
    if (status == BAT_OK && chart.folded)
        status = parameterize_deep(cloud, boundary, threads, interior, error);
    else if (status == BAT_OK)
    {
        double moves[CHART_MOVES] = {0};
        if (chart.sees)
            say_at_once(network, chart.seen, moves);
        surface_chart_move(&chart, moves, interior);
    }
    blas_single_end();
    free(memory);
    return status;
}

const surface_network_kind surface_network_batten = {
    .name = "batten",
    .make = make,
    .make_network = make_network,
    .free_network = free,
    .infer = infer,
};
