#include "research/learn/parameters.h"
#include "research/train/surface_network_tape.h"
#include "surface/network/chart_network.h"

#include <math.h>

/// @file
/// The network of surface/network/chart_network.h on a tape, for training.

/// He's normal weights, biases 0; the last layer's weights are so small that training begins near zero moves.
static void start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t layer = 0; layer < CHART_LAYERS; layer++)
    {
        double factor = layer + 1 == CHART_LAYERS ? 1e-4 : 2;
        learn_parameter_fill_normal(parameters, 2 * layer,
                                    sqrt(factor / (double)(layer == 0 ? PATCH_FEATURES : CHART_WIDTH)), &random);
        learn_parameter_fill(parameters, 2 * layer + 1, 0);
    }
}

void surface_chart_move_back(const surface_chart *chart, const double *moves, const double *by_interior, double *by_moves)
{
    double share = chart_gate(moves), by_share = 0;
    for (size_t i = 0; i < chart->count; i++)
    {
        const double *at = chart->parameters + 2 * i, *by = by_interior + 2 * i;
        double u[CHART_DEGREE + 1], v[CHART_DEGREE + 1], height = chart_bubble(at);
        legendre_polynomials(at[0], CHART_DEGREE, u);
        legendre_polynomials(at[1], CHART_DEGREE, v);
        for (size_t k = 0; k < CHART_TERMS; k++)
        {
            double term = height * u[k / (CHART_DEGREE + 1)] * v[k % (CHART_DEGREE + 1)];
            by_moves[2 * k] += term * by[0];
            by_moves[2 * k + 1] += term * by[1];
        }
        by_share += by[0] * chart->steps[2 * i] + by[1] * chart->steps[2 * i + 1];
    }
    by_moves[CHART_GATE] += by_share * share * (1 - share);
}

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

static learn_array *evaluate(learn_tape *tape, learn_array *features)
{
    learn_array *x = features;
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
    learn_array *features = learn_array_make(tape, 1, PATCH_FEATURES, false);
    for (size_t i = 0; i < learn_size(features); i++)
        features->value[i] = (real)m->chart.features[i];
    m->moves = evaluate(tape, features);
    m->interior = learn_array_make(tape, count, 2, learn_wants(m->moves));
    if (tape->status != BAT_OK)
        return &tape->nothing;
    for (size_t i = 0; i < CHART_MOVES; i++)
        m->precise[i] = m->chart.has_features ? (double)m->moves->value[i] : 0;
    m->scratch = memory + 4 * count;
    surface_chart_move(&m->chart, m->precise, m->scratch);
    for (size_t i = 0; i < 2 * count; i++)
        m->interior->value[i] = (real)m->scratch[i];
    if (learn_wants(m->interior) && m->chart.has_features)
        learn_tape_record(tape, m->interior, move_back, m);
    return m->interior;
}

/// Squares differ by orders of magnitude between clean and noisy clouds. The logarithm gives them comparable weight.
static const real LOSS_FLOOR = (real)1e-7;

static learn_array *loss(learn_tape *tape, const surface_sample *sample, learn_array *interior)
{
    return learn_log(tape, learn_add_number(tape, surface_sample_residual(tape, sample, interior), LOSS_FLOOR));
}

const surface_network_tape surface_tape_batten = {
    .kind = &surface_network_batten,
    .start = start,
    .predict = predict,
    .loss = loss,
};
