#include "models/surface_chart_network.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/parameterize.h"
#include "learn/blas.h"
#include "models/surface_chart.h"
#include "models/surface_sample.h"

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

/// He's normal weights, a last layer that says next to nothing, biases 0.
static void start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t layer = 0; layer < CHART_LAYERS; layer++)
    {
        double factor = layer + 1 == CHART_LAYERS ? 1e-4 : 2;
        learn_parameter_fill_normal(parameters, 2 * layer, sqrt(factor / (double)inputs_of(layer)), &random);
        learn_parameter_fill(parameters, 2 * layer + 1, 0);
    }
}

// On a tape

typedef struct movement
{
    surface_chart chart;
    learn_array *moves, *interior;
    double precise[CHART_MOVES];
    double *scratch; ///< interior points x 2
} movement;

static void move_back(void *context)
{
    movement *m = context;
    const real *by_interior = m->interior->gradient;
    double by_moves[CHART_MOVES] = {0};
    for (size_t i = 0; i < learn_size(m->interior); i++)
        m->scratch[i] = (double)by_interior[i];
    surface_chart_move_back(&m->chart, m->precise, m->scratch, by_moves);
    real *to = learn_gradient(m->moves);
    for (size_t i = 0; i < CHART_MOVES; i++)
        to[i] += (real)by_moves[i];
}

static learn_array *say(learn_tape *tape, learn_array *seen)
{
    learn_array *x = seen;
    for (size_t layer = 0; layer < CHART_LAYERS; layer++)
    {
        x = learn_linear(tape, x, learn_parameter_array(tape, 2 * layer), learn_parameter_array(tape, 2 * layer + 1));
        if (layer + 1 < CHART_LAYERS)
            x = learn_gelu(tape, x);
    }
    return x;
}

static learn_array *predict(learn_tape *tape, const bat_cloud *cloud, const double *boundary)
{
    size_t count = cloud->count - cloud->boundary_count;
    movement *m = learn_tape_memory(tape, 1, sizeof *m);
    double *memory = learn_tape_memory(tape, count, 6 * sizeof *memory);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    bat_status status = surface_chart_make(cloud, boundary, memory, &m->chart, NULL);
    if (status != BAT_OK)
    {
        tape->status = status;
        return &tape->nothing;
    }
    learn_array *seen = learn_array_make(tape, 1, SURFACE_SEEN, false);
    for (size_t i = 0; i < learn_size(seen); i++)
        seen->value[i] = (real)m->chart.seen[i];
    m->moves = say(tape, seen);
    m->interior = learn_array_make(tape, count, 2, learn_wants(m->moves));
    if (tape->status != BAT_OK)
        return &tape->nothing;
    for (size_t i = 0; i < CHART_MOVES; i++)
        m->precise[i] = m->chart.sees ? (double)m->moves->value[i] : 0;
    m->scratch = memory + 4 * count;
    surface_chart_move(&m->chart, m->precise, m->scratch);
    for (size_t i = 0; i < 2 * count; i++)
        m->interior->value[i] = (real)m->scratch[i];
    if (learn_wants(m->interior) && m->chart.sees)
        learn_tape_record(tape, m->interior, move_back, m);
    return m->interior;
}

/// Squares differ by orders of magnitude between clean and noisy clouds: the logarithm lets all count.
static const real LOSS_FLOOR = (real)1e-7;

static learn_array *loss(learn_tape *tape, const surface_sample *sample, learn_array *interior)
{
    return learn_log(tape, learn_add_number(tape, surface_sample_residual(tape, sample, interior), LOSS_FLOOR));
}

// Without a tape

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
    bat_parameterize_options options = bat_parameterize_defaults();
    options.method = BAT_PARAMETERIZE_STRETCH_MINIMIZING;
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
    .start = start,
    .predict = predict,
    .loss = loss,
    .make_network = make_network,
    .free_network = free,
    .infer = infer,
};
