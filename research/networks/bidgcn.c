/// @file
/// Parameters and inference of the network of bidgcn.h, without a tape.
///
/// The first layers of h and g are linear in e = (x_i, x_j, u_j). Mean and variance of z = w . e + b over all edges
/// therefore follow from the mean and the covariance of e,
///     mean(z) = w . mean(e) + b,   var(z) = w^T cov(e) w,
/// so that batch normalization needs one pass over the edges to accumulate the moments of e. The normalized z is a term of
/// the target plus a term of the source. Blocks of ROWS points pass through the layers together.

#include "research/networks/bidgcn.h"

#include "base/error.h"
#include "base/lanes.h"
#include "base/memory.h"
#include "base/threads.h"
#include "batten/research/networks.h"
#include "learn/weights.h"
#include "research/learn/functions.h"
#include "search/nearest.h"
#include "surface/network/chart_network.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    W = SURFACE_WIDTH,
    ROWS = 16 * LEARN_TILE, ///< points in a block
    OUTPUT_LAYERS = 3       ///< layers of the output network
};

enum
{
    SOURCE_FEATURES = 5, ///< maximum number of features of a source: position, and parameters of a boundary point
    EDGE_FEATURES = 3 + SOURCE_FEATURES ///< maximum number of features of an edge
};

/// The parameters of a first layer.
typedef struct surface_first_layer
{
    size_t source_features;   ///< features of a source: 3 or 5
    const real *weight;       ///< SURFACE_WIDTH x (3 + source_features): for x_i, x_j - x_i, u_j
    const real *gain, *shift; ///< SURFACE_WIDTH
} surface_first_layer;

/// Moments of e over edges: number, sums, and sums of products (lower triangle).
typedef struct surface_moments
{
    double count, first[EDGE_FEATURES], second[EDGE_FEATURES][EDGE_FEATURES];
} surface_moments;

/// The layer with its normalization folded in: z = shares . e + begin.
typedef struct surface_first_folded
{
    double shares[EDGE_FEATURES][SURFACE_WIDTH];
    double begin[SURFACE_WIDTH];
} surface_first_folded;

// Moments

/// Add the edges of a target to the moments.
/// @param sources count x source_features
static void surface_moments_edges(const real position[3], const real *sources, size_t source_features, const uint64_t *bits,
                                  size_t words, surface_moments *moments)
{
    double count = 0, sum[SOURCE_FEATURES] = {0};
    for (size_t w = 0; w < words; w++)
        for (uint64_t word = bits[w]; word != 0; word &= word - 1)
        {
            const real *source = sources + (w * SURFACE_WORD + (size_t)__builtin_ctzll(word)) * source_features;
            count++;
            for (size_t a = 0; a < source_features; a++)
            {
                sum[a] += (double)source[a];
                for (size_t b = 0; b <= a; b++)
                    moments->second[3 + a][3 + b] += (double)source[a] * (double)source[b];
            }
        }
    moments->count += count;
    for (size_t a = 0; a < 3; a++)
    {
        moments->first[a] += count * (double)position[a];
        for (size_t b = 0; b <= a; b++)
            moments->second[a][b] += count * (double)position[a] * (double)position[b];
    }
    for (size_t a = 0; a < source_features; a++)
    {
        moments->first[3 + a] += sum[a];
        for (size_t b = 0; b < 3; b++)
            moments->second[3 + a][b] += sum[a] * (double)position[b];
    }
}

static void surface_moments_add(const surface_moments *more, surface_moments *moments)
{
    moments->count += more->count;
    for (size_t a = 0; a < EDGE_FEATURES; a++)
    {
        moments->first[a] += more->first[a];
        for (size_t b = 0; b <= a; b++)
            moments->second[a][b] += more->second[a][b];
    }
}

/// The mean and covariance of e over all edges; zero without edges.
static void find_covariance(const surface_moments *moments, double mean[EDGE_FEATURES],
                            double covariance[EDGE_FEATURES][EDGE_FEATURES])
{
    double share = moments->count > 0 ? 1 / moments->count : 0;
    for (size_t a = 0; a < EDGE_FEATURES; a++)
        mean[a] = share * moments->first[a];
    for (size_t a = 0; a < EDGE_FEATURES; a++)
        for (size_t b = 0; b <= a; b++)
            covariance[a][b] = covariance[b][a] = share * moments->second[a][b] - mean[a] * mean[b];
}

// The layer

/// Fold the batch normalization into the layer.
/// @param moments moments of all edges
static void surface_first_fold(const surface_first_layer *layer, const surface_moments *moments,
                               surface_first_folded *folded)
{
    size_t edge_features = 3 + layer->source_features;
    double mean[EDGE_FEATURES], covariance[EDGE_FEATURES][EDGE_FEATURES];
    find_covariance(moments, mean, covariance);
    for (size_t c = 0; c < W; c++)
    {
        const real *weight = layer->weight + c * edge_features;
        double w[EDGE_FEATURES], middle = 0, variance = 0;
        for (size_t a = 0; a < edge_features; a++)
        {
            w[a] = (double)weight[a] - (a < 3 ? (double)weight[a + 3] : 0);
            middle += w[a] * mean[a];
            for (size_t b = 0; b < a; b++)
                variance += 2 * w[a] * covariance[a][b] * w[b];
            variance += w[a] * covariance[a][a] * w[a];
        }
        double rate = (double)layer->gain[c] / sqrt(fmax(variance, 0) + (double)NORMALIZATION_EPSILON);
        folded->begin[c] = (double)layer->shift[c] - rate * middle;
        for (size_t a = 0; a < edge_features; a++)
            folded->shares[a][c] = rate * w[a];
    }
}

LANES_CLONES
static void add_share(double number, const double *restrict shares, double *restrict sum)
{
    for (size_t c = 0; c < W; c++)
        sum[c] += number * shares[c];
}

/// The terms of the sources in z.
/// @param sources count x source_features
/// @param near    receives count x SURFACE_WIDTH
static void surface_first_sources(const surface_first_folded *folded, const real *sources, size_t count,
                                  size_t source_features, real *messages_from)
{
    for (size_t j = 0; j < count; j++)
    {
        double sum[W] = {0};
        for (size_t a = 0; a < source_features; a++)
            add_share((double)sources[j * source_features + a], folded->shares[3 + a], sum);
        for (size_t c = 0; c < W; c++)
            messages_from[j * W + c] = (real)sum[c];
    }
}

/// The sum over neighbours of max(0, begin + near_j).
LANES_CLONES
static void sum_messages(const uint64_t *bits, size_t words, const real *messages_from, const real *begin, real *sum)
{
    surface_lanes total[SURFACE_VECTORS], own[SURFACE_VECTORS];
    for (size_t v = 0; v < SURFACE_VECTORS; v++)
    {
        total[v] = (surface_lanes){0};
        own[v] = *(const surface_lanes *)(begin + v * SURFACE_LANES);
    }
    for (size_t w = 0; w < words; w++)
        for (uint64_t word = bits[w]; word != 0; word &= word - 1)
        {
            const real *row = messages_from + (w * SURFACE_WORD + (size_t)__builtin_ctzll(word)) * W;
            for (size_t v = 0; v < SURFACE_VECTORS; v++)
            {
                surface_lanes z = own[v] + *(const surface_lanes *)(row + v * SURFACE_LANES);
                total[v] += (surface_lanes)((z > (surface_lanes){0}) & (surface_mask)z);
            }
        }
    for (size_t v = 0; v < SURFACE_VECTORS; v++)
        *(surface_lanes *)(sum + v * SURFACE_LANES) = total[v];
}

/// The mean of max(0, z) over the neighbours of a target; 0 if there are none.
/// @param mean receives SURFACE_WIDTH numbers
static void surface_first_mean(const surface_first_folded *folded, const real position[3], const real *messages_from,
                               const uint64_t *bits, size_t words, uint32_t degree, real *mean)
{
    double own[W];
    real begin[W];
    for (size_t c = 0; c < W; c++)
        own[c] = folded->begin[c];
    for (size_t a = 0; a < 3; a++)
        add_share((double)position[a], folded->shares[a], own);
    for (size_t c = 0; c < W; c++)
        begin[c] = (real)own[c];
    sum_messages(bits, words, messages_from, begin, mean);
    for (size_t c = 0; c < W && degree > 0; c++)
        mean[c] /= (real)degree;
}

// Weights

/// The message function h or g.
typedef struct message
{
    surface_first_layer first;
    learn_packed second;
} message;

typedef struct surface_inference
{
    bool informed;
    message messages[2]; ///< h for interior edges, g for boundary edges
    learn_packed hidden[SURFACE_HIDDEN];
    learn_packed output[OUTPUT_LAYERS];
    const real *gain[OUTPUT_LAYERS - 1], *shift[OUTPUT_LAYERS - 1];
    real *values; ///< copy of the parameters
    real *packed; ///< the packed layers
} surface_inference;

static size_t packed_size(const learn_parameters *parameters)
{
    size_t size = 0;
    for (size_t p = 0; p < parameters->count; p++)
        if (parameters->list[p].rank == 2)
            size += learn_packed_size(parameters->list[p].columns, parameters->list[p].rows);
    return size;
}

/// Pack the layer whose weight is parameter p at *memory, and advance *memory.
static learn_packed pack(const learn_parameters *parameters, size_t p, real **memory)
{
    const learn_parameter *weight = &parameters->list[p];
    learn_packed layer = learn_pack(weight->columns, weight->rows, learn_parameter_values(parameters, p), weight->columns,
                                    learn_parameter_values(parameters, p + 1), *memory);
    *memory += learn_packed_size(weight->columns, weight->rows);
    return layer;
}

static void pack_all(const learn_parameters *parameters, surface_inference *network)
{
    real *memory = network->packed;
    const learn_parameter *list = parameters->list;
    network->informed = surface_network_is_informed(parameters);
    for (size_t k = 0; k < (network->informed ? 2 : 1); k++)
    {
        size_t p = surface_network_part(parameters, k == 0 ? SURFACE_PART_INTERIOR : SURFACE_PART_BOUNDARY);
        network->messages[k] = (message){.first = {.source_features = list[p].columns - 3,
                                                   .weight = network->values + list[p].offset,
                                                   .gain = network->values + list[p + 2].offset,
                                                   .shift = network->values + list[p + 3].offset},
                                         .second = pack(parameters, p + 4, &memory)};
    }
    size_t hidden = surface_network_part(parameters, SURFACE_PART_HIDDEN);
    for (size_t layer = 0; layer < SURFACE_HIDDEN; layer++)
        network->hidden[layer] = pack(parameters, hidden + 2 * layer, &memory);
    size_t output = surface_network_part(parameters, SURFACE_PART_OUTPUT);
    for (size_t part = 0; part < OUTPUT_LAYERS; part++)
    {
        network->output[part] = pack(parameters, output + 4 * part, &memory);
        if (part + 1 == OUTPUT_LAYERS)
            break;
        network->gain[part] = network->values + list[output + 4 * part + 2].offset;
        network->shift[part] = network->values + list[output + 4 * part + 3].offset;
    }
}

bat_status surface_inference_make(const learn_source *source, const learn_parameters *parameters, void **network,
                                  bat_error *error)
{
    (void)source;
    surface_inference *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    made->values = memory_array(parameters->total, sizeof(real));
    made->packed = memory_array(packed_size(parameters), sizeof(real));
    if (made->values == NULL || made->packed == NULL)
    {
        surface_inference_free(made);
        return error_memory(error, 2 * parameters->total * sizeof(real));
    }
    memcpy(made->values, parameters->values, parameters->total * sizeof(real));
    pack_all(parameters, made);
    *network = made;
    return BAT_OK;
}

void surface_inference_free(void *network)
{
    surface_inference *made = network;
    if (made == NULL)
        return;
    free(made->values);
    free(made->packed);
    free(made);
}

// Memory

/// Workspace of an inference. Numbers of rows are rounded up to whole tiles, because layers process whole tiles.
typedef struct inference_run
{
    const surface_inference *network;
    int threads;
    size_t count;            ///< points of the network
    size_t boundary_count;   ///< boundary points with parameters; 0 without the informed layer
    const size_t *order;     ///< count: indices of the points in a spatially coherent order
    real *position;          ///< count x 3
    real *boundary_position; ///< boundary_count x 3
    real *boundary_features; ///< boundary_count x SOURCE_FEATURES: positions and parameters
    real *features;          ///< (1 + SURFACE_HIDDEN) x tiles x W
    real *sources;           ///< packed sources of a graph
    real *boundary_sources;  ///< packed sources of the boundary
    real *word_sums;         ///< words x W
    real *messages_from;     ///< count x W: terms of interior points in the first layer
    real *boundary_messages; ///< boundary_count x W: terms of boundary points
    real *hidden_output[2];  ///< tiles x SURFACE_OUTPUT: layers of the output network
    double *sums;            ///< blocks x SURFACE_OUTPUT
    uint64_t *bits;          ///< threads x ROWS x words
} inference_run;

static size_t blocks_of(const inference_run *r)
{
    return (r->count + ROWS - 1) / ROWS;
}

static size_t words_of(const inference_run *r)
{
    return surface_words(r->count > r->boundary_count ? r->count : r->boundary_count);
}

/// Reserve the next array at a multiple of 64 bytes; null without memory, to compute the total size.
static void *next_array(void *memory, size_t *used, size_t count, size_t size)
{
    enum
    {
        LINE = 64
    };
    char *array = memory != NULL ? (char *)memory + *used : NULL;
    *used += (count * size + LINE - 1) / LINE * LINE;
    return array;
}

/// Assign the arrays of the workspace; returns their total size.
static size_t lay_out(inference_run *r, void *memory)
{
    size_t used = 0, tiles = learn_whole_tiles(r->count);
    r->position = next_array(memory, &used, 3 * tiles, sizeof(real));
    r->boundary_position = next_array(memory, &used, 3 * r->boundary_count, sizeof(real));
    r->boundary_features = next_array(memory, &used, SOURCE_FEATURES * r->boundary_count, sizeof(real));
    r->features = next_array(memory, &used, (1 + SURFACE_HIDDEN) * tiles * W, sizeof(real));
    r->sources = next_array(memory, &used, surface_sources_size(r->count, W), sizeof(real));
    r->boundary_sources = next_array(memory, &used, surface_sources_size(r->boundary_count, 3), sizeof(real));
    r->word_sums = next_array(memory, &used, words_of(r) * W, sizeof(real));
    r->messages_from = next_array(memory, &used, r->count * W, sizeof(real));
    r->boundary_messages = next_array(memory, &used, r->boundary_count * W, sizeof(real));
    for (size_t i = 0; i < 2; i++)
        r->hidden_output[i] = next_array(memory, &used, tiles * SURFACE_OUTPUT, sizeof(real));
    r->sums = next_array(memory, &used, blocks_of(r) * SURFACE_OUTPUT, sizeof(double));
    r->bits = next_array(memory, &used, (size_t)r->threads * ROWS * words_of(r), sizeof(uint64_t));
    return used;
}

static real *features_of(const inference_run *r, size_t layer)
{
    return r->features + layer * learn_whole_tiles(r->count) * W;
}

/// The neighbour bits of a block for the calling thread.
static uint64_t *thread_bits(const inference_run *r)
{
    size_t thread = 0;
#if defined(_OPENMP)
    thread = (size_t)omp_get_thread_num();
#endif
    return r->bits + thread * ROWS * words_of(r);
}

static size_t rows_from(const inference_run *r, size_t begin)
{
    return r->count - begin < ROWS ? r->count - begin : ROWS;
}

// The input layer

LANES_CLONES
static void rectify(size_t count, real *y)
{
    for (size_t i = 0; i < count; i++)
        y[i] = y[i] > 0 ? y[i] : 0;
}

/// Edges to interior or to boundary points.
typedef struct edges
{
    const message *message;
    surface_sources sources;
    const real *source_features; ///< features of the sources
    real *messages_from;         ///< terms of the sources in the first layer
    surface_first_folded first;
} edges;

/// Set up a kind of edges, and pack its sources.
static void begin_edges(const inference_run *r, size_t kind, edges *e)
{
    bool boundary_count = kind == 1;
    e->message = &r->network->messages[kind];
    e->source_features = boundary_count ? r->boundary_features : r->position;
    e->messages_from = boundary_count ? r->boundary_messages : r->messages_from;
    e->sources = boundary_count ? surface_sources_make(r->boundary_position, r->boundary_count, 3, r->boundary_sources)
                                : surface_sources_make(r->position, r->count, 3, r->sources);
}

/// Accumulate the moments of the edges, and fold the normalization into the first layer.
static void measure_edges(const inference_run *r, edges *e, surface_moments *of_blocks)
{
    size_t words = surface_words(e->sources.count), blocks = blocks_of(r),
           source_features = e->message->first.source_features;
    surface_moments all = {0};
#pragma omp parallel for num_threads(threads_for(r->threads, blocks)) schedule(static)
    for (size_t b = 0; b < blocks; b++)
    {
        uint64_t *bits = thread_bits(r);
        uint32_t degrees[ROWS];
        size_t begin = b * ROWS, rows = rows_from(r, begin);
        of_blocks[b] = (surface_moments){0};
        surface_neighbours(&e->sources, r->position + 3 * begin, rows, SURFACE_RADIUS, bits, degrees);
        for (size_t i = 0; i < rows; i++)
            surface_moments_edges(r->position + 3 * (begin + i), e->source_features, source_features, bits + i * words,
                                  words, &of_blocks[b]);
    }
    for (size_t b = 0; b < blocks; b++)
        surface_moments_add(&of_blocks[b], &all);
    surface_first_fold(&e->message->first, &all, &e->first);
    surface_first_sources(&e->first, e->source_features, e->sources.count, source_features, e->messages_from);
}

/// Add the mean message of one kind of edges to the features of a block.
static void add_messages(const inference_run *r, const edges *e, size_t begin, real *features)
{
    _Alignas(64) real means[ROWS * W] = {0}, output[ROWS * W];
    uint32_t degrees[ROWS];
    uint64_t *bits = thread_bits(r);
    size_t rows = rows_from(r, begin), words = surface_words(e->sources.count);
    surface_neighbours(&e->sources, r->position + 3 * begin, rows, SURFACE_RADIUS, bits, degrees);
    for (size_t i = 0; i < rows; i++)
        surface_first_mean(&e->first, r->position + 3 * (begin + i), e->messages_from, bits + i * words, words, degrees[i],
                           means + i * W);
    learn_packed_linear(&e->message->second, learn_whole_tiles(rows), means, W, output);
    for (size_t i = 0; i < rows; i++)
        for (size_t c = 0; c < W && degrees[i] > 0; c++)
            features[i * W + c] += output[i * W + c];
}

/// Compute f_0.
static bat_status input_layer(const inference_run *r, bat_error *error)
{
    size_t kinds = r->network->informed && r->boundary_count > 0 ? 2 : 1, blocks = blocks_of(r);
    surface_moments *of_blocks = memory_array(blocks, sizeof *of_blocks);
    edges *all = memory_array(kinds, sizeof *all);
    bat_status status = BAT_OK;
    if (of_blocks == NULL || all == NULL)
        status = error_memory(error, blocks * sizeof *of_blocks);
    for (size_t kind = 0; kind < kinds && status == BAT_OK; kind++)
    {
        begin_edges(r, kind, &all[kind]);
        measure_edges(r, &all[kind], of_blocks);
    }
#pragma omp parallel for num_threads(threads_for(r->threads, blocks)) schedule(static)
    for (size_t b = 0; b < (status == BAT_OK ? blocks : 0); b++)
    {
        real *features = features_of(r, 0) + b * ROWS * W;
        size_t rows = rows_from(r, b * ROWS);
        memset(features, 0, learn_whole_tiles(rows) * W * sizeof *features);
        for (size_t kind = 0; kind < kinds; kind++)
            add_messages(r, &all[kind], b * ROWS, features);
        rectify(rows * W, features);
    }
    free(of_blocks);
    free(all);
    return status;
}

// The hidden layers

/// Concatenate f_i and mean_j f_j - f_i.
LANES_CLONES
static void join(const real *restrict x, uint32_t degree, const real *restrict sum, real *restrict joined)
{
    for (size_t c = 0; c < W; c++)
    {
        joined[c] = x[c];
        joined[W + c] = sum[c] / (real)degree - x[c];
    }
}

static void hidden_block(const inference_run *r, size_t layer, const surface_sources *sources, size_t begin)
{
    _Alignas(64) real joined[ROWS * 2 * W];
    uint32_t degrees[ROWS];
    uint64_t *bits = thread_bits(r);
    const real *x = features_of(r, layer);
    real *y = features_of(r, layer + 1) + begin * W;
    size_t rows = rows_from(r, begin), tiles = learn_whole_tiles(rows), words = surface_words(r->count);
    surface_neighbours(sources, x + begin * W, rows, SURFACE_RADIUS, bits, degrees);
    for (size_t i = 0; i < rows; i++)
    {
        real sum[W];
        surface_sum(bits + i * words, x, r->count, r->word_sums, sum);
        join(x + (begin + i) * W, degrees[i], sum, joined + i * 2 * W);
    }
    memset(joined + rows * 2 * W, 0, (tiles - rows) * 2 * W * sizeof *joined);
    learn_packed_linear(&r->network->hidden[layer], tiles, joined, (size_t)2 * W, y);
    if (layer + 1 < SURFACE_HIDDEN)
        rectify(tiles * W, y);
}

static void hidden_layer(const inference_run *r, size_t layer)
{
    size_t blocks = blocks_of(r);
    const real *x = features_of(r, layer);
    surface_sources sources = surface_sources_make(x, r->count, W, r->sources);
    surface_word_sums(x, r->count, r->word_sums);
#pragma omp parallel for num_threads(threads_for(r->threads, blocks)) schedule(static)
    for (size_t b = 0; b < blocks; b++)
        hidden_block(r, layer, &sources, b * ROWS);
}

// The output network

/// Sum the columns of a block of rows, or their squared deviations from a mean.
LANES_CLONES
static void sum_columns(size_t rows, const real *restrict x, const real *restrict mean, double *restrict sums)
{
    real own[SURFACE_OUTPUT] = {0};
    for (size_t i = 0; i < rows; i++)
        for (size_t c = 0; c < SURFACE_OUTPUT; c++)
        {
            real number = x[i * SURFACE_OUTPUT + c];
            own[c] += mean == NULL ? number : (number - mean[c]) * (number - mean[c]);
        }
    for (size_t c = 0; c < SURFACE_OUTPUT; c++)
        sums[c] = (double)own[c];
}

static void mean_of_blocks(const inference_run *r, real *mean)
{
    for (size_t c = 0; c < SURFACE_OUTPUT; c++)
    {
        double sum = 0;
        for (size_t b = 0; b < blocks_of(r); b++)
            sum += r->sums[b * SURFACE_OUTPUT + c];
        mean[c] = (real)(sum / (double)r->count);
    }
}

/// y = max(0, slope y + begin)
LANES_CLONES
static void normalize(size_t rows, const real *restrict slope, const real *restrict begin, real *restrict y)
{
    for (size_t i = 0; i < rows; i++)
        for (size_t c = 0; c < SURFACE_OUTPUT; c++)
        {
            real h = slope[c] * y[i * SURFACE_OUTPUT + c] + begin[c];
            y[i * SURFACE_OUTPUT + c] = h > 0 ? h : 0;
        }
}

/// Batch normalization after layer `part` of the output network, as slope and offset, from the column sums of the blocks.
static void fold_output(const inference_run *r, size_t part, real *slope, real *begin)
{
    const real *y = r->hidden_output[part];
    real mean[SURFACE_OUTPUT], variance[SURFACE_OUTPUT];
    size_t blocks = blocks_of(r);
    mean_of_blocks(r, mean);
#pragma omp parallel for num_threads(threads_for(r->threads, blocks)) schedule(static)
    for (size_t b = 0; b < blocks; b++)
        sum_columns(rows_from(r, b * ROWS), y + b * ROWS * SURFACE_OUTPUT, mean, r->sums + b * SURFACE_OUTPUT);
    mean_of_blocks(r, variance);
    for (size_t c = 0; c < SURFACE_OUTPUT; c++)
    {
        slope[c] = r->network->gain[part][c] / real_sqrt(variance[c] + NORMALIZATION_EPSILON);
        begin[c] = r->network->shift[part][c] - slope[c] * mean[c];
    }
}

/// The first layer of the output network, applied to the concatenated features.
static void join_output(const inference_run *r)
{
    size_t blocks = blocks_of(r);
#pragma omp parallel for num_threads(threads_for(r->threads, blocks)) schedule(static)
    for (size_t b = 0; b < blocks; b++)
    {
        _Alignas(64) real joined[ROWS * SURFACE_JOINED];
        size_t begin = b * ROWS, rows = rows_from(r, begin), tiles = learn_whole_tiles(rows);
        for (size_t layer = 0; layer <= SURFACE_HIDDEN; layer++)
            for (size_t i = 0; i < tiles; i++)
                memcpy(joined + i * SURFACE_JOINED + layer * W, features_of(r, layer) + (begin + i) * W, W * sizeof *joined);
        real *y = r->hidden_output[0] + begin * SURFACE_OUTPUT;
        learn_packed_linear(&r->network->output[0], tiles, joined, SURFACE_JOINED, y);
        sum_columns(rows, y, NULL, r->sums + b * SURFACE_OUTPUT);
    }
}

/// Apply the output network.
/// @param first index of the first interior point in the cloud
static void output_network(const inference_run *r, size_t first, double *interior)
{
    size_t blocks = blocks_of(r);
    real slope[SURFACE_OUTPUT], begin[SURFACE_OUTPUT];
    join_output(r);
    fold_output(r, 0, slope, begin);
#pragma omp parallel for num_threads(threads_for(r->threads, blocks)) schedule(static)
    for (size_t b = 0; b < blocks; b++)
    {
        size_t rows = rows_from(r, b * ROWS), tiles = learn_whole_tiles(rows), at = b * ROWS * SURFACE_OUTPUT;
        normalize(tiles, slope, begin, r->hidden_output[0] + at);
        learn_packed_linear(&r->network->output[1], tiles, r->hidden_output[0] + at, SURFACE_OUTPUT,
                            r->hidden_output[1] + at);
        sum_columns(rows, r->hidden_output[1] + at, NULL, r->sums + b * SURFACE_OUTPUT);
    }
    fold_output(r, 1, slope, begin);
#pragma omp parallel for num_threads(threads_for(r->threads, blocks)) schedule(static)
    for (size_t b = 0; b < blocks; b++)
    {
        _Alignas(64) real output[ROWS * LEARN_PANEL];
        size_t rows = rows_from(r, b * ROWS), tiles = learn_whole_tiles(rows), at = b * ROWS * SURFACE_OUTPUT;
        normalize(tiles, slope, begin, r->hidden_output[1] + at);
        learn_packed_linear(&r->network->output[2], tiles, r->hidden_output[1] + at, SURFACE_OUTPUT, output);
        for (size_t i = 0; i < rows; i++)
        {
            size_t point = r->order[b * ROWS + i];
            for (size_t d = 0; d < 2 && point >= first; d++)
                interior[2 * (point - first) + d] = (double)real_sigmoid(output[i * LEARN_PANEL + d]);
        }
    }
}

// All of it

static void read_places(const inference_run *r, const double *points, const double *boundary_count, const double *parameters)
{
    size_t tiles = learn_whole_tiles(r->count);
    for (size_t i = 0; i < 3 * r->count; i++)
        r->position[i] = (real)points[3 * r->order[i / 3] + i % 3];
    for (size_t i = 0; i < 3 * r->boundary_count; i++)
        r->boundary_position[i] = (real)boundary_count[i];
    for (size_t i = 0; i < SOURCE_FEATURES * r->boundary_count; i++)
    {
        size_t k = i / SOURCE_FEATURES, a = i % SOURCE_FEATURES;
        r->boundary_features[i] = (real)(a < 3 ? boundary_count[3 * k + a] : parameters[2 * k + a - 3]);
    }
    for (size_t layer = 0; layer <= SURFACE_HIDDEN; layer++)
        memset(features_of(r, layer) + r->count * W, 0, (tiles - r->count) * W * sizeof(real));
}

/// Compute the parameters.
static bat_status run_network(inference_run *r, const bat_cloud *cloud, const double *boundary, double *interior,
                              bat_error *error)
{
    size_t begin = cloud->count - r->count, size = lay_out(r, NULL);
    void *memory = memory_array(size, 1);
    if (memory == NULL)
        return error_memory(error, size);
    (void)lay_out(r, memory);
    read_places(r, cloud->points + 3 * begin, cloud->points, boundary);
    bat_status status = input_layer(r, error);
    for (size_t layer = 0; layer < SURFACE_HIDDEN && status == BAT_OK; layer++)
        hidden_layer(r, layer);
    if (status == BAT_OK)
        output_network(r, cloud->boundary_count - begin, interior);
    free(memory);
    return status;
}

bat_status surface_inference_run(const void *network, const bat_cloud *cloud, const double *boundary, int threads,
                                 double *interior, bat_error *error)
{
    const surface_inference *made = network;
    size_t begin = made->informed ? cloud->boundary_count : 0;
    inference_run r = {.network = made, .count = cloud->count - begin, .boundary_count = begin};
    nearest_tree tree;
    if (cloud->count == cloud->boundary_count)
        return BAT_OK;
    r.threads = threads_for(threads, blocks_of(&r));
    bat_status status = neighbours_build(cloud->points + 3 * begin, r.count, &tree, error);
    if (status != BAT_OK)
        return status;
    r.order = tree.items;
    status = run_network(&r, cloud, boundary, interior, error);
    nearest_free(&tree);
    return status;
}

// Parameters

static void add_layer(learn_parameters *parameters, size_t outputs, size_t inputs, const char *part, int position)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%s.%d.weight", part, position);
    (void)learn_parameters_add(parameters, outputs, inputs, name);
    (void)snprintf(name, sizeof name, "%s.%d.bias", part, position);
    (void)learn_parameters_add(parameters, 0, outputs, name);
}

static void add_normalization(learn_parameters *parameters, size_t width, const char *part, int position)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%s.%d.weight", part, position);
    (void)learn_parameters_add(parameters, 0, width, name);
    (void)snprintf(name, sizeof name, "%s.%d.bias", part, position);
    (void)learn_parameters_add(parameters, 0, width, name);
}

/// Names follow PyTorch's Sequential: 0 layer, 1 normalization, 2 ReLU, 3 layer, …
static void add_message(learn_parameters *parameters, size_t inputs, const char *part)
{
    add_layer(parameters, SURFACE_WIDTH, inputs, part, 0);
    add_normalization(parameters, SURFACE_WIDTH, part, 1);
    add_layer(parameters, SURFACE_WIDTH, SURFACE_WIDTH, part, 3);
}

static bat_status make(bool informed, learn_parameters *parameters, bat_error *error)
{
    add_message(parameters, 6, "interior");
    if (informed)
        add_message(parameters, 8, "boundary");
    for (int layer = 0; layer < SURFACE_HIDDEN; layer++)
    {
        char part[16];
        (void)snprintf(part, sizeof part, "hidden.%d", layer);
        add_layer(parameters, SURFACE_WIDTH, (size_t)2 * SURFACE_WIDTH, part, 0);
    }
    add_layer(parameters, SURFACE_OUTPUT, SURFACE_JOINED, "output", 0);
    add_normalization(parameters, SURFACE_OUTPUT, "output", 1);
    add_layer(parameters, SURFACE_OUTPUT, SURFACE_OUTPUT, "output", 3);
    add_normalization(parameters, SURFACE_OUTPUT, "output", 4);
    add_layer(parameters, 2, SURFACE_OUTPUT, "output", 6);
    bat_status status = learn_parameters_allocate(parameters, error);
    if (status != BAT_OK)
        learn_parameters_free(parameters);
    assert(status != BAT_OK || !informed || parameters->total == SURFACE_WEIGHTS);
    return status;
}

static bat_status make_published(const learn_source *source, learn_parameters *parameters, bat_error *error)
{
    (void)source;
    return make(true, parameters, error);
}

static bat_status make_uninformed(const learn_source *source, learn_parameters *parameters, bat_error *error)
{
    (void)source;
    return make(false, parameters, error);
}

bool surface_network_count_is_informed(size_t parameter_count)
{
    return parameter_count == 2 * SURFACE_MESSAGE_ARRAYS + SURFACE_HIDDEN_ARRAYS + SURFACE_OUTPUT_ARRAYS;
}

size_t surface_network_part_begin(size_t parameter_count, surface_part part)
{
    const size_t begins[] = {0, SURFACE_MESSAGE_ARRAYS, parameter_count - SURFACE_OUTPUT_ARRAYS - SURFACE_HIDDEN_ARRAYS,
                             parameter_count - SURFACE_OUTPUT_ARRAYS};
    return begins[part];
}

size_t surface_network_part(const learn_parameters *parameters, surface_part part)
{
    return surface_network_part_begin(parameters->count, part);
}

bool surface_network_is_informed(const learn_parameters *parameters)
{
    return surface_network_count_is_informed(parameters->count);
}

static const surface_rule RULE = {surface_inference_run};

const learn_network surface_network_published = {
    .array = "interior.0.weight",
    .recipe = "surface published",
    .rule = &RULE,
    .make = make_published,
    .pack = surface_inference_make,
    .free = surface_inference_free,
};

const learn_network surface_network_uninformed = {
    .array = "interior.0.weight",
    .recipe = "surface uninformed",
    .rule = &RULE,
    .make = make_uninformed,
    .pack = surface_inference_make,
    .free = surface_inference_free,
};

bat_status bat_surface_model_read_published(const char *path, bat_surface_model **model, bat_error *error)
{
    static const learn_network *const ALL[] = {&surface_network_published, &surface_network_uninformed,
                                               &surface_network_batten};
    const learn_networks networks = {ALL, 3, &weights_surface};
    return surface_model_read(&networks, path, model, error);
}
