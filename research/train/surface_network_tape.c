#include "research/train/surface_network_tape.h"

#include "research/learn/functions.h"
#include "research/learn/parameters.h"

#include <assert.h>

enum
{
    W = SURFACE_WIDTH
};

tape_graph tape_graph_make(learn_tape *tape, const learn_array *targets, const learn_array *sources, double radius)
{
    tape_graph graph = {.targets = targets->rows, .sources = sources->rows, .words = surface_words(sources->rows)};
    size_t width = sources->columns;
    assert(tape->status != BAT_OK || (targets->columns == width && width <= W));
    real *memory = learn_tape_memory(tape, surface_sources_size(sources->rows, width), sizeof *memory);
    graph.bits = learn_tape_memory(tape, graph.targets, graph.words * sizeof *graph.bits);
    graph.degrees = learn_tape_memory(tape, graph.targets, sizeof *graph.degrees);
    if (tape->status != BAT_OK)
        return (tape_graph){0};
    surface_sources laid_out = surface_sources_make(sources->value, sources->rows, width, memory);
    surface_neighbours(&laid_out, targets->value, graph.targets, radius, graph.bits, graph.degrees);
    for (size_t i = 0; i < graph.targets; i++)
        graph.edges += graph.degrees[i];
    return graph;
}

// Means: y_i = the mean of x_j over the neighbours j of i
//   x and y rows x W

typedef struct mean
{
    learn_array *x, *y;
    tape_graph graph;
    real *word_sums; ///< words x W
    real *shares;    ///< rows x W, for the way back
} mean;

static void mean_forward(const mean *m)
{
    surface_word_sums(m->x->value, m->graph.sources, m->word_sums);
    for (size_t i = 0; i < m->graph.targets; i++)
    {
        real *y = m->y->value + i * W;
        surface_sum(m->graph.bits + i * m->graph.words, m->x->value, m->graph.sources, m->word_sums, y);
        for (size_t c = 0; c < W; c++)
            y[c] /= (real)m->graph.degrees[i];
    }
}

/// dx_j += the sum of dy_i / degree_i over those i of which j is a neighbour: they are the neighbours of j.
static void mean_backward(void *context)
{
    const mean *m = context;
    real *dx = learn_gradient(m->x), sum[W];
    for (size_t i = 0; i < m->graph.targets; i++)
        for (size_t c = 0; c < W; c++)
            m->shares[i * W + c] = m->y->gradient[i * W + c] / (real)m->graph.degrees[i];
    surface_word_sums(m->shares, m->graph.sources, m->word_sums);
    for (size_t j = 0; j < m->graph.sources; j++)
    {
        surface_sum(m->graph.bits + j * m->graph.words, m->shares, m->graph.sources, m->word_sums, sum);
        for (size_t c = 0; c < W; c++)
            dx[j * W + c] += sum[c];
    }
}

learn_array *tape_graph_mean(learn_tape *tape, learn_array *x, const tape_graph *graph)
{
    learn_array *y = learn_array_make(tape, x->rows, x->columns, learn_wants(x));
    mean *m = learn_tape_memory(tape, 1, sizeof *m);
    real *word_sums = learn_tape_memory(tape, graph->words, W * sizeof *word_sums);
    real *shares = learn_wants(x) ? learn_tape_memory(tape, learn_size(x), sizeof *shares) : NULL;
    if (tape->status != BAT_OK)
        return &tape->nothing;
    assert(x->columns == W && graph->targets == x->rows && graph->sources == x->rows);
    *m = (mean){x, y, *graph, word_sums, shares};
    mean_forward(m);
    if (learn_wants(y))
        learn_tape_record(tape, y, mean_backward, m);
    return y;
}

// Messages: z_ij = x_i + y_j for each edge, h_ij = (z_ij - mean) rate, and m_i = the mean over j of max(0, gain h_ij +
// shift)
//   x and m targets x W, y sources x W, mean and rate 1 x W
//
// h_ij = own_i + near_j with own_i = (x_i - mean) rate and near_j = y_j rate.

typedef struct messages
{
    learn_array *x, *y, *gain, *shift, *m;
    tape_graph graph;
    real *own, *near; ///< targets x W, sources x W
    real *word_sums;
    double rate[W];
} messages;

enum
{
    LANES = SURFACE_LANES,
    VECTORS = SURFACE_VECTORS
};

static inline const surface_lanes *lanes_of(const real *row, size_t v)
{
    return (const surface_lanes *)(row + v * LANES);
}

static inline surface_lanes *lanes_in(real *row, size_t v)
{
    return (surface_lanes *)(row + v * LANES);
}

static inline const real *row_of(const real *rows, size_t word, uint64_t bits)
{
    return rows + (word * SURFACE_WORD + (size_t)__builtin_ctzll(bits)) * W;
}

/// The number of targets that have each source as a neighbour.
static void count_targets(const tape_graph *graph, uint32_t *counts)
{
    memset(counts, 0, graph->sources * sizeof *counts);
    for (size_t i = 0; i < graph->targets; i++)
        for (size_t w = 0; w < graph->words; w++)
            for (uint64_t word = graph->bits[i * graph->words + w]; word != 0; word &= word - 1)
                counts[w * SURFACE_WORD + (size_t)__builtin_ctzll(word)]++;
}

/// sum[c] += factor x[c]
static inline void add_row(double factor, const real *x, double *sum)
{
    for (size_t c = 0; c < W; c++)
        sum[c] += factor * (double)x[c];
}

/// The mean and variance of z over edges, from those of x and y and from the sums of x_i times y_j.
static void find_statistics(const messages *m, const uint32_t *counts, double middle[W], double variance[W])
{
    const tape_graph *graph = &m->graph;
    double mean_x[W] = {0}, mean_y[W] = {0}, edges = (double)graph->edges;
    for (size_t i = 0; i < graph->targets; i++)
        add_row(graph->degrees[i] / edges, m->x->value + i * W, mean_x);
    for (size_t j = 0; j < graph->sources; j++)
        add_row(counts[j] / edges, m->y->value + j * W, mean_y);
    memset(variance, 0, W * sizeof *variance);
    surface_word_sums(m->y->value, graph->sources, m->word_sums);
    for (size_t i = 0; i < graph->targets; i++)
    {
        real sum[W];
        double degree = graph->degrees[i];
        surface_sum(graph->bits + i * graph->words, m->y->value, graph->sources, m->word_sums, sum);
        for (size_t c = 0; c < W; c++)
        {
            double x = (double)m->x->value[i * W + c] - mean_x[c];
            variance[c] += x * (degree * x + 2 * ((double)sum[c] - degree * mean_y[c])) / edges;
        }
    }
    for (size_t j = 0; j < graph->sources; j++)
        for (size_t c = 0; c < W; c++)
        {
            double y = (double)m->y->value[j * W + c] - mean_y[c];
            variance[c] += counts[j] * y * y / edges;
        }
    for (size_t c = 0; c < W; c++)
        middle[c] = mean_x[c] + mean_y[c];
}

static void normalize(messages *m, const uint32_t *counts)
{
    double middle[W], variance[W];
    find_statistics(m, counts, middle, variance);
    for (size_t c = 0; c < W; c++)
        m->rate[c] = 1 / sqrt(fmax(variance[c], 0) + (double)NORMALIZATION_EPSILON);
    for (size_t i = 0; i < m->graph.targets; i++)
        for (size_t c = 0; c < W; c++)
            m->own[i * W + c] = (real)(m->rate[c] * ((double)m->x->value[i * W + c] - middle[c]));
    for (size_t j = 0; j < m->graph.sources; j++)
        for (size_t c = 0; c < W; c++)
            m->near[j * W + c] = (real)(m->rate[c] * (double)m->y->value[j * W + c]);
}

/// One target: sum = the sum over j of max(0, gain h_ij + shift).
LANES_CLONES
static void sum_messages(const messages *m, size_t i, real *sum)
{
    const uint64_t *bits = m->graph.bits + i * m->graph.words;
    surface_lanes total[VECTORS], begin[VECTORS], gain[VECTORS];
    for (size_t v = 0; v < VECTORS; v++)
    {
        total[v] = (surface_lanes){0};
        gain[v] = *lanes_of(m->gain->value, v);
        begin[v] = gain[v] * *lanes_of(m->own + i * W, v) + *lanes_of(m->shift->value, v);
    }
    for (size_t w = 0; w < m->graph.words; w++)
        for (uint64_t word = bits[w]; word != 0; word &= word - 1)
        {
            const real *near = row_of(m->near, w, word);
            for (size_t v = 0; v < VECTORS; v++)
            {
                surface_lanes message = gain[v] * *lanes_of(near, v) + begin[v];
                total[v] += (surface_lanes)((message > (surface_lanes){0}) & (surface_mask)message);
            }
        }
    for (size_t v = 0; v < VECTORS; v++)
        *lanes_in(sum, v) = total[v];
}

/// One target's neighbours whose ReLU is active: their number, and the sum of their near_j.
LANES_CLONES
static void sum_open(const messages *m, size_t i, real *count, real *sum)
{
    const uint64_t *bits = m->graph.bits + i * m->graph.words;
    surface_lanes open[VECTORS], total[VECTORS], begin[VECTORS], gain[VECTORS], one = (surface_lanes){0} + 1;
    for (size_t v = 0; v < VECTORS; v++)
    {
        open[v] = total[v] = (surface_lanes){0};
        gain[v] = *lanes_of(m->gain->value, v);
        begin[v] = gain[v] * *lanes_of(m->own + i * W, v) + *lanes_of(m->shift->value, v);
    }
    for (size_t w = 0; w < m->graph.words; w++)
        for (uint64_t word = bits[w]; word != 0; word &= word - 1)
        {
            const real *near = row_of(m->near, w, word);
            for (size_t v = 0; v < VECTORS; v++)
            {
                surface_lanes n = *lanes_of(near, v);
                surface_mask mask = gain[v] * n + begin[v] > (surface_lanes){0};
                open[v] += (surface_lanes)(mask & (surface_mask)one);
                total[v] += (surface_lanes)(mask & (surface_mask)n);
            }
        }
    for (size_t v = 0; v < VECTORS; v++)
    {
        *lanes_in(count, v) = open[v];
        *lanes_in(sum, v) = total[v];
    }
}

/// With g_ij the gradient behind the normalization, dz_ij = g_ij - flat - steep near_j, all three multiplied by gain and
/// rate. The part that x_i and y_j share.
typedef struct edge_gradient
{
    real g[W], flat[W], steep[W];
} edge_gradient;

LANES_CLONES
static void spread_gradient(const messages *m, size_t i, const edge_gradient *e, real *dx, real *dy)
{
    const uint64_t *bits = m->graph.bits + i * m->graph.words;
    surface_lanes total[VECTORS], begin[VECTORS], gain[VECTORS];
    for (size_t v = 0; v < VECTORS; v++)
    {
        total[v] = *lanes_of(dx, v);
        gain[v] = *lanes_of(m->gain->value, v);
        begin[v] = gain[v] * *lanes_of(m->own + i * W, v) + *lanes_of(m->shift->value, v);
    }
    for (size_t w = 0; w < m->graph.words; w++)
        for (uint64_t word = bits[w]; word != 0; word &= word - 1)
        {
            const real *near = row_of(m->near, w, word);
            real *to = dy + (near - m->near);
            for (size_t v = 0; v < VECTORS; v++)
            {
                surface_lanes n = *lanes_of(near, v);
                surface_mask mask = gain[v] * n + begin[v] > (surface_lanes){0};
                surface_lanes dz = (surface_lanes)(mask & (surface_mask)*lanes_of(e->g, v)) - *lanes_of(e->flat, v) -
                                   *lanes_of(e->steep, v) * n;
                total[v] += dz;
                *lanes_in(to, v) = *lanes_of(to, v) + dz;
            }
        }
    for (size_t v = 0; v < VECTORS; v++)
        *lanes_in(dx, v) = total[v];
}

static void messages_forward(messages *m, const uint32_t *counts)
{
    normalize(m, counts);
    for (size_t i = 0; i < m->graph.targets; i++)
    {
        real *sum = m->m->value + i * W;
        sum_messages(m, i, sum);
        for (size_t c = 0; c < W && m->graph.degrees[i] > 0; c++)
            sum[c] /= (real)m->graph.degrees[i];
    }
}

/// dgain and dshift, and their means over edges.
static void gain_backward(const messages *m, double mean_gh[W], double mean_g[W])
{
    memset(mean_gh, 0, W * sizeof *mean_gh);
    memset(mean_g, 0, W * sizeof *mean_g);
    for (size_t i = 0; i < m->graph.targets; i++)
    {
        real open[W], sum[W];
        if (m->graph.degrees[i] == 0)
            continue;
        sum_open(m, i, open, sum);
        for (size_t c = 0; c < W; c++)
        {
            double g = (double)m->m->gradient[i * W + c] / m->graph.degrees[i];
            mean_g[c] += g * (double)open[c];
            mean_gh[c] += g * ((double)sum[c] + (double)open[c] * (double)m->own[i * W + c]);
        }
    }
    real *dgain = learn_gradient(m->gain), *dshift = learn_gradient(m->shift);
    for (size_t c = 0; c < W; c++)
    {
        dgain[c] += (real)mean_gh[c];
        dshift[c] += (real)mean_g[c];
        mean_gh[c] /= (double)m->graph.edges;
        mean_g[c] /= (double)m->graph.edges;
    }
}

/// dz_ij = gain rate (g_ij - mean(g) - h_ij mean(g h))
static void messages_backward(void *context)
{
    const messages *m = context;
    double mean_gh[W], mean_g[W];
    gain_backward(m, mean_gh, mean_g);
    real *dx = learn_gradient(m->x), *dy = learn_gradient(m->y);
    for (size_t i = 0; i < m->graph.targets; i++)
    {
        edge_gradient e;
        if (m->graph.degrees[i] == 0)
            continue;
        for (size_t c = 0; c < W; c++)
        {
            double scale = (double)m->gain->value[c] * m->rate[c];
            e.g[c] = (real)(scale * (double)m->m->gradient[i * W + c] / m->graph.degrees[i]);
            e.flat[c] = (real)(scale * (mean_g[c] + (double)m->own[i * W + c] * mean_gh[c]));
            e.steep[c] = (real)(scale * mean_gh[c]);
        }
        spread_gradient(m, i, &e, dx + i * W, dy);
    }
}

learn_array *tape_graph_messages(learn_tape *tape, learn_array *x, learn_array *y, learn_array *gain, learn_array *shift,
                                 const tape_graph *graph)
{
    bool wants = learn_wants(x);
    learn_array *made = learn_array_make(tape, x->rows, x->columns, wants);
    messages *m = learn_tape_memory(tape, 1, sizeof *m);
    uint32_t *counts = learn_tape_memory(tape, graph->sources, sizeof *counts);
    real *own = learn_tape_memory(tape, learn_size(x), sizeof *own),
         *near = learn_tape_memory(tape, learn_size(y), sizeof *near);
    real *word_sums = learn_tape_memory(tape, graph->words, W * sizeof *word_sums);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    assert(x->columns == W && y->columns == W && gain->columns == W && shift->columns == W);
    assert(graph->targets == x->rows && graph->sources == y->rows);
    assert(wants == learn_wants(y) && wants == learn_wants(gain) && wants == learn_wants(shift));
    *m = (messages){x, y, gain, shift, made, *graph, own, near, word_sums, {0}};
    if (graph->edges == 0)
    {
        memset(made->value, 0, learn_size(made) * sizeof *made->value);
        return made;
    }
    count_targets(graph, counts);
    messages_forward(m, counts);
    if (wants)
        learn_tape_record(tape, made, messages_backward, m);
    return made;
}

// The network

/// Weights and biases uniform between plus and minus 1 / sqrt(inputs), gains 1, shifts 0, as PyTorch does.
static void start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t p = 0; p < parameters->count; p += 2)
    {
        const learn_parameter *weight = &parameters->list[p];
        if (weight->rank == 1)
        {
            learn_parameter_fill(parameters, p, 1);
            continue;
        }
        double bound = 1 / sqrt((double)weight->columns);
        real *values = learn_parameter_values(parameters, p);
        // The bias follows the weight in memory.
        for (size_t i = 0; i < weight->rows * weight->columns + weight->rows; i++)
            values[i] = (real)(bound * (2 * bat_random_uniform(&random) - 1));
    }
}

static learn_array *rows_of(learn_tape *tape, const double *numbers, size_t rows, size_t columns)
{
    learn_array *array = learn_array_make(tape, rows, columns, false);
    for (size_t i = 0; i < learn_size(array); i++)
        array->value[i] = (real)numbers[i];
    return array;
}

/// A linear layer of the rows that have neighbours. The other rows are 0, without the bias.
static learn_array *layer_where_reached(learn_tape *tape, learn_array *x, learn_array *weight, learn_array *bias,
                                        const tape_graph *graph)
{
    uint32_t *reached = learn_tape_memory(tape, graph->targets, sizeof *reached);
    size_t count = 0;
    for (size_t i = 0; reached != NULL && i < graph->targets; i++)
        if (graph->degrees[i] > 0)
            reached[count++] = (uint32_t)i;
    learn_array *y = learn_linear(tape, learn_gather_rows(tape, x, reached, count), weight, bias);
    return learn_scatter_mean(tape, y, reached, graph->targets);
}

/// The mean over edges of h or g.
/// @param x          targets x 3
/// @param y          sources x 3
/// @param conditions sources x 2; null for none
static learn_array *message_network(learn_tape *tape, size_t first, learn_array *x, learn_array *y, learn_array *conditions,
                                    const tape_graph *graph)
{
    learn_array *p[SURFACE_MESSAGE_ARRAYS];
    for (size_t i = 0; i < SURFACE_MESSAGE_ARRAYS; i++)
        p[i] = learn_parameter_array(tape, first + i);
    learn_array *of_target = learn_slice_columns(tape, p[0], 0, 3), *of_source = learn_slice_columns(tape, p[0], 3, 3);
    learn_array *at_target = learn_linear(tape, x, learn_subtract(tape, of_target, of_source), p[1]);
    learn_array *at_source = learn_linear(tape, y, of_source, NULL);
    if (conditions != NULL)
        at_source = learn_add(tape, at_source, learn_linear(tape, conditions, learn_slice_columns(tape, p[0], 6, 2), NULL));
    learn_array *output = tape_graph_messages(tape, at_target, at_source, p[2], p[3], graph);
    return layer_where_reached(tape, output, p[4], p[5], graph);
}

static learn_array *hidden_layer(learn_tape *tape, size_t first, learn_array *x, bool last, size_t *edges)
{
    tape_graph graph = tape_graph_make(tape, x, x, SURFACE_RADIUS);
    *edges = graph.edges;
    learn_array *weight = learn_parameter_array(tape, first), *bias = learn_parameter_array(tape, first + 1);
    learn_array *both[2] = {x, learn_subtract(tape, tape_graph_mean(tape, x, &graph), x)};
    learn_array *joined = learn_concatenate_columns(tape, both, 2);
    return last ? learn_linear(tape, joined, weight, bias) : learn_linear_relu(tape, joined, weight, bias);
}

static learn_array *output_network(learn_tape *tape, size_t first, learn_array *x)
{
    learn_array *p[SURFACE_OUTPUT_ARRAYS];
    for (size_t i = 0; i < SURFACE_OUTPUT_ARRAYS; i++)
        p[i] = learn_parameter_array(tape, first + i);
    x = learn_relu(tape, learn_batch_norm(tape, learn_linear(tape, x, p[0], p[1]), p[2], p[3]));
    x = learn_relu(tape, learn_batch_norm(tape, learn_linear(tape, x, p[4], p[5]), p[6], p[7]));
    return learn_sigmoid(tape, learn_linear(tape, x, p[8], p[9]));
}

static learn_array *input_layer(learn_tape *tape, const bat_cloud *cloud, const double *boundary, surface_edges *edges)
{
    bool informed = surface_network_count_is_informed(tape->parameter_count);
    size_t bound = cloud->boundary_count, begin = informed ? bound : 0;
    learn_array *x = rows_of(tape, cloud->points + 3 * begin, cloud->count - begin, 3);
    tape_graph graph = tape_graph_make(tape, x, x, SURFACE_RADIUS);
    edges->count[0] = graph.edges;
    learn_array *output =
        message_network(tape, surface_network_part_begin(tape->parameter_count, SURFACE_PART_INTERIOR), x, x, NULL, &graph);
    if (informed && bound > 0)
    {
        learn_array *y = rows_of(tape, cloud->points, bound, 3), *conditions = rows_of(tape, boundary, bound, 2);
        graph = tape_graph_make(tape, x, y, SURFACE_RADIUS);
        edges->count[1] = graph.edges;
        size_t first = surface_network_part_begin(tape->parameter_count, SURFACE_PART_BOUNDARY);
        output = learn_add(tape, output, message_network(tape, first, x, y, conditions, &graph));
    }
    return learn_relu(tape, output);
}

learn_array *surface_network_predict(learn_tape *tape, const bat_cloud *cloud, const double *boundary, surface_edges *edges)
{
    surface_edges unused;
    edges = edges != NULL ? edges : &unused;
    *edges = (surface_edges){0};
    size_t count = tape->parameter_count, hidden = surface_network_part_begin(count, SURFACE_PART_HIDDEN);
    learn_array *features[1 + SURFACE_HIDDEN] = {input_layer(tape, cloud, boundary, edges)};
    for (size_t layer = 0; layer < SURFACE_HIDDEN; layer++)
        features[layer + 1] =
            hidden_layer(tape, hidden + 2 * layer, features[layer], layer + 1 == SURFACE_HIDDEN, &edges->count[2 + layer]);
    learn_array *joined = learn_concatenate_columns(tape, features, 1 + SURFACE_HIDDEN);
    learn_array *output = output_network(tape, surface_network_part_begin(count, SURFACE_PART_OUTPUT), joined);
    size_t interior = cloud->count - cloud->boundary_count;
    return output->rows == interior ? output : learn_slice_rows(tape, output, cloud->boundary_count, interior);
}

static learn_array *predict(learn_tape *tape, const bat_cloud *cloud, const double *boundary)
{
    return surface_network_predict(tape, cloud, boundary, NULL);
}

const surface_network_tape surface_tape_published = {
    .kind = &surface_network_published,
    .start = start,
    .predict = predict,
};

const surface_network_tape surface_tape_uninformed = {
    .kind = &surface_network_uninformed,
    .start = start,
    .predict = predict,
};
