/// @file
/// Charts and the network that moves them; see chart_network.h.

#include "surface/network/chart_network.h"

#include "base/error.h"
#include "learn/blas.h"
#include "learn/weights.h"
#include "mesh/measure/unit_box.h"
#include "surface/parameterize/weights.h"

#include <stdio.h>

#define ORDERS (CHART_DEGREE + 1)

/// A chart is treated as folded when the residual of its patch, beyond the noise, exceeds this in the unit box.
static const double MAX_RESIDUAL = 0.05;

/// Fit the patch to the whole cloud at the initial parameters, and compute features and steps.
static bat_status fit_patch(const bat_cloud *cloud, const double *boundary, double noise, surface_chart *chart,
                            bat_error *error)
{
    size_t bound = cloud->boundary_count;
    double *all = memory_array(cloud->count, 2 * sizeof *all);
    if (all == NULL)
        return error_memory(error, cloud->count * 2 * sizeof *all);
    memcpy(all, boundary, 2 * bound * sizeof *all);
    memcpy(all + 2 * bound, chart->parameters, 2 * chart->count * sizeof *all);
    polynomial_patch patch;
    bat_status status = polynomial_patch_fit(cloud->points, all, cloud->count, noise, &patch, error);
    free(all);
    if (status != BAT_OK)
        return status;
    chart->has_features = polynomial_patch_features(&patch, chart->features);
    chart->folded = patch.residual * patch.residual > MAX_RESIDUAL * MAX_RESIDUAL + 3 * noise * noise;
    for (size_t i = 0; i < chart->count; i++)
        polynomial_patch_step(&patch, cloud->points + 3 * (bound + i), chart->parameters + 2 * i, chart->steps + 2 * i);
    return BAT_OK;
}

bat_status surface_chart_make(const bat_cloud *cloud, const double *boundary, double *memory, surface_chart *chart,
                              bat_error *error)
{
    surface_chart made = {.count = cloud->count - cloud->boundary_count};
    made.parameters = memory;
    made.steps = memory + 2 * made.count;
    biharmonic_extension extension;
    bat_status status = biharmonic_extension_make(cloud, boundary, &extension, error);
    if (status != BAT_OK)
        return status;
    biharmonic_extension_evaluate(&extension, cloud->points + 3 * cloud->boundary_count, made.count, made.parameters);
    status = fit_patch(cloud, boundary, extension.noise, &made, error);
    biharmonic_extension_free(&extension);
    if (status == BAT_OK)
        *chart = made;
    return status;
}

void surface_chart_move(const surface_chart *chart, const double *moves, double *interior)
{
    double share = chart_gate(moves);
    for (size_t i = 0; i < chart->count; i++)
    {
        const double *at = chart->parameters + 2 * i;
        double u[ORDERS], v[ORDERS], field[2] = {0}, height = chart_bubble(at);
        legendre_polynomials(at[0], CHART_DEGREE, u);
        legendre_polynomials(at[1], CHART_DEGREE, v);
        for (size_t k = 0; k < CHART_TERMS; k++)
        {
            double term = u[k / ORDERS] * v[k % ORDERS];
            field[0] += term * moves[2 * k];
            field[1] += term * moves[2 * k + 1];
        }
        for (size_t d = 0; d < 2; d++)
            interior[2 * i + d] = fmin(fmax(at[d] + share * chart->steps[2 * i + d] + height * field[d], 0), 1);
    }
}

// Parameters

static size_t inputs_of(size_t layer)
{
    return layer == 0 ? (size_t)PATCH_FEATURES : (size_t)CHART_WIDTH;
}

static size_t outputs_of(size_t layer)
{
    return layer + 1 == CHART_LAYERS ? (size_t)CHART_MOVES : (size_t)CHART_WIDTH;
}

static bat_status make(const learn_source *source BAT_UNUSED, learn_parameters *parameters, bat_error *error)
{
    for (size_t layer = 0; layer < CHART_LAYERS; layer++)
    {
        char name[LEARN_NAME_SIZE];
        (void)snprintf(name, sizeof name, "layer.%zu.weight", layer);
        (void)learn_parameters_add(parameters, outputs_of(layer), inputs_of(layer), name);
        (void)snprintf(name, sizeof name, "layer.%zu.bias", layer);
        (void)learn_parameters_add(parameters, 0, outputs_of(layer), name);
    }
    return learn_parameters_allocate(parameters, error);
}

static void evaluate_layers(const real *weights, const double *features, double *moves)
{
    real x[CHART_WIDTH], y[CHART_WIDTH];
    for (size_t i = 0; i < PATCH_FEATURES; i++)
        x[i] = (real)features[i];
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

/// Stretch-minimizing parameters, for deep shapes.
static bat_status parameterize_deep(const bat_cloud *cloud, const double *boundary, int threads, double *interior,
                                    bat_error *error)
{
    double *all = memory_array(cloud->count, 2 * sizeof *all);
    if (all == NULL)
        return error_memory(error, cloud->count * 2 * sizeof *all);
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.method = BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING;
    options.threads = threads;
    bat_status status = bat_cloud_parameterize(cloud, boundary, &options, all, error);
    if (status == BAT_OK)
        memcpy(interior, all + 2 * cloud->boundary_count, 2 * (cloud->count - cloud->boundary_count) * sizeof *interior);
    free(all);
    return status;
}

static bat_status infer(const void *network, const bat_cloud *cloud, const double *boundary, int threads, double *interior,
                        bat_error *error)
{
    bat_status status = boundary_parameters_check(cloud, boundary, error);
    if (status == BAT_OK)
        status = blas_reserve(error);
    if (status != BAT_OK)
        return status;
    size_t count = cloud->count - cloud->boundary_count;
    double *memory = memory_array(count, 4 * sizeof *memory);
    if (memory == NULL)
        return error_memory(error, count * 4 * sizeof *memory);
    surface_chart chart;
    blas_single_begin();
    status = surface_chart_make(cloud, boundary, memory, &chart, error);
    // Deep shapes lie outside the training distribution of the network.
    if (status == BAT_OK && chart.folded)
        status = parameterize_deep(cloud, boundary, threads, interior, error);
    else if (status == BAT_OK)
    {
        double moves[CHART_MOVES] = {0};
        if (chart.has_features)
            evaluate_layers(network, chart.features, moves);
        surface_chart_move(&chart, moves, interior);
    }
    blas_single_end();
    free(memory);
    return status;
}

static const surface_rule RULE = {infer};

const learn_network surface_network_batten = {
    .array = "layer.0.weight",
    .recipe = "surface batten",
    .rule = &RULE,
    .make = make,
    .pack = learn_model_copy,
    .free = free,
};

// Models that parameterize clouds: reading them, and scaling clouds to the unit box.

struct bat_surface_model
{
    learn_model base;
};

static const learn_network *const NETWORKS[] = {&surface_network_batten};
const learn_networks surface_networks = {NETWORKS, 1, &weights_surface};

bat_status surface_model_read(const learn_networks *networks, const char *path, bat_surface_model **model, bat_error *error)
{
    learn_model *read = NULL;
    bat_status status = learn_model_read(networks, path, sizeof **model, &read, error);
    if (status == BAT_OK)
        *model = (bat_surface_model *)read;
    return status;
}

bat_status bat_surface_model_read(const char *path, bat_surface_model **model, bat_error *error)
{
    return surface_model_read(&surface_networks, path, model, error);
}

void bat_surface_model_free(bat_surface_model *model)
{
    learn_model_free((learn_model *)model);
}

bat_status bat_surface_model_parameterize(const bat_surface_model *model, const bat_cloud *cloud, const double *boundary,
                                          int threads, double *parameters, bat_error *error)
{
    bat_status status = bat_cloud_check(cloud, error);
    if (status != BAT_OK)
        return status;
    bat_cloud boxed = *cloud;
    unit_box box = unit_box_of(cloud->points, cloud->count);
    if (!isfinite(box.size))
        return ERROR_ARGUMENT(error, "the size of the cloud is not finite");
    if (array_make(&boxed.points, cloud->count, 3 * sizeof *boxed.points, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t i = 0; i < 3 * cloud->count; i++)
        boxed.points[i] = unit_box_in(&box, i, cloud->points[i]);
    memcpy(parameters, boundary, 2 * cloud->boundary_count * sizeof *parameters);
    const surface_rule *rule = model->base.kind->rule;
    status = rule->infer(model->base.network, &boxed, boundary, threads, parameters + 2 * cloud->boundary_count, error);
    free(boxed.points);
    return status;
}
