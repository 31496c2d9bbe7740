#include "models/tape_graph.h"

#include "learn/row_statistics.h"

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

// Messages: z_ij = x_i + y_j for each edge, h_ij = (z_ij - mean) rate, and m_i = the mean over j of max(0, gain h_ij + shift)
//   x and m targets x W, y sources x W, mean and rate 1 x W

typedef struct messages
{
    learn_array *x, *y, *gain, *shift, *m;
    tape_graph graph;
    double mean[W], rate[W];
} messages;

/// The next neighbour at or behind `*j`, which becomes the place behind it; false when there is none.
static inline bool next_neighbour(const uint64_t *bits, size_t words, size_t *place, size_t *neighbour)
{
    size_t w = *place / SURFACE_WORD;
    uint64_t word = w < words ? bits[w] >> (*place % SURFACE_WORD) << (*place % SURFACE_WORD) : 0;
    while (word == 0 && ++w < words)
        word = bits[w];
    if (word == 0)
        return false;
    *neighbour = w * SURFACE_WORD + (size_t)__builtin_ctzll(word);
    *place = *neighbour + 1;
    return true;
}

LANES_CLONES
static void add_row(const real *restrict from, real *restrict to)
{
    for (size_t c = 0; c < W; c++)
        to[c] += from[c];
}

/// Add the squares of what z_ij differs from `mean` by.
LANES_CLONES
static void add_squares(const real *restrict centred, const real *restrict y, real *restrict squares)
{
    for (size_t c = 0; c < W; c++)
        squares[c] += (centred[c] + y[c]) * (centred[c] + y[c]);
}

static void find_mean(messages *m)
{
    memset(m->mean, 0, sizeof m->mean);
    for (size_t i = 0; i < m->graph.targets; i++)
    {
        real sum[W] = {0};
        for (size_t place = 0, j; next_neighbour(m->graph.bits + i * m->graph.words, m->graph.words, &place, &j);)
            add_row(m->y->value + j * W, sum);
        for (size_t c = 0; c < W; c++)
            m->mean[c] += (double)sum[c] + m->graph.degrees[i] * (double)m->x->value[i * W + c];
    }
    for (size_t c = 0; c < W; c++)
        m->mean[c] /= (double)m->graph.edges;
}

static void find_rate(messages *m)
{
    double squares[W] = {0};
    for (size_t i = 0; i < m->graph.targets; i++)
    {
        real sum[W] = {0}, centred[W];
        for (size_t c = 0; c < W; c++)
            centred[c] = (real)((double)m->x->value[i * W + c] - m->mean[c]);
        for (size_t place = 0, j; next_neighbour(m->graph.bits + i * m->graph.words, m->graph.words, &place, &j);)
            add_squares(centred, m->y->value + j * W, sum);
        for (size_t c = 0; c < W; c++)
            squares[c] += (double)sum[c];
    }
    for (size_t c = 0; c < W; c++)
        m->rate[c] = 1 / sqrt(squares[c] / (double)m->graph.edges + (double)NORMALIZATION_EPSILON);
}

/// gain h_ij + shift = slope y_j + begin
static void normalized(const messages *m, size_t i, real slope[W], real begin[W])
{
    for (size_t c = 0; c < W; c++)
    {
        double s = (double)m->gain->value[c] * m->rate[c];
        slope[c] = (real)s;
        begin[c] = (real)(s * ((double)m->x->value[i * W + c] - m->mean[c]) + (double)m->shift->value[c]);
    }
}

LANES_CLONES
static void add_message(const real *restrict slope, const real *restrict begin, const real *restrict y, real *restrict sum)
{
    for (size_t c = 0; c < W; c++)
    {
        real h = slope[c] * y[c] + begin[c];
        sum[c] += h > 0 ? h : 0;
    }
}

static void messages_forward(messages *m)
{
    find_mean(m);
    find_rate(m);
    for (size_t i = 0; i < m->graph.targets; i++)
    {
        real slope[W], begin[W], *sum = m->m->value + i * W;
        normalized(m, i, slope, begin);
        memset(sum, 0, W * sizeof *sum);
        for (size_t place = 0, j; next_neighbour(m->graph.bits + i * m->graph.words, m->graph.words, &place, &j);)
            add_message(slope, begin, m->y->value + j * W, sum);
        for (size_t c = 0; c < W && m->graph.degrees[i] > 0; c++)
            sum[c] /= (real)m->graph.degrees[i];
    }
}

/// Of the ReLUs of one target that let through: add how many, and their y.
LANES_CLONES
static void count_open(const real *restrict slope, const real *restrict begin, const real *restrict y, real *restrict open,
                       real *restrict sum)
{
    for (size_t c = 0; c < W; c++)
    {
        bool is_open = slope[c] * y[c] + begin[c] > 0;
        open[c] += is_open ? 1 : 0;
        sum[c] += is_open ? y[c] : 0;
    }
}

/// dgain and dshift, and their means over edges: with g_ij the gradient behind the ReLU, the means of g_ij h_ij and g_ij.
static void gain_backward(const messages *m, double mean_gh[W], double mean_g[W])
{
    memset(mean_gh, 0, W * sizeof *mean_gh);
    memset(mean_g, 0, W * sizeof *mean_g);
    for (size_t i = 0; i < m->graph.targets; i++)
    {
        real slope[W], begin[W], open[W] = {0}, sum[W] = {0};
        normalized(m, i, slope, begin);
        for (size_t place = 0, j; next_neighbour(m->graph.bits + i * m->graph.words, m->graph.words, &place, &j);)
            count_open(slope, begin, m->y->value + j * W, open, sum);
        for (size_t c = 0; c < W && m->graph.degrees[i] > 0; c++)
        {
            double g = (double)m->m->gradient[i * W + c] / m->graph.degrees[i];
            double centred = (double)m->x->value[i * W + c] - m->mean[c];
            mean_g[c] += g * (double)open[c];
            mean_gh[c] += g * m->rate[c] * ((double)sum[c] + (double)open[c] * centred);
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

/// What the gradient of an edge of one target is: slope (g where the ReLU is open - flat - steep y_j).
typedef struct edge_gradient
{
    real slope[W], begin[W];
    real g[W], flat[W], steep[W];
} edge_gradient;

LANES_CLONES
static void edge_backward(const edge_gradient *e, const real *restrict y, real *restrict dx, real *restrict dy)
{
    for (size_t c = 0; c < W; c++)
    {
        real open = e->slope[c] * y[c] + e->begin[c] > 0 ? e->g[c] : 0;
        real dz = e->slope[c] * (open - e->flat[c] - e->steep[c] * y[c]);
        dx[c] += dz;
        dy[c] += dz;
    }
}

/// dz_ij = gain rate (g_ij - mean(g) - h_ij mean(g h)), which x_i and y_j share.
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
        normalized(m, i, e.slope, e.begin);
        for (size_t c = 0; c < W; c++)
        {
            double centred = (double)m->x->value[i * W + c] - m->mean[c];
            e.g[c] = m->m->gradient[i * W + c] / (real)m->graph.degrees[i];
            e.flat[c] = (real)(mean_g[c] + m->rate[c] * centred * mean_gh[c]);
            e.steep[c] = (real)(m->rate[c] * mean_gh[c]);
        }
        for (size_t place = 0, j; next_neighbour(m->graph.bits + i * m->graph.words, m->graph.words, &place, &j);)
            edge_backward(&e, m->y->value + j * W, dx + i * W, dy + j * W);
    }
}

learn_array *tape_graph_messages(learn_tape *tape, learn_array *x, learn_array *y, learn_array *gain, learn_array *shift,
                                 const tape_graph *graph)
{
    bool wants = learn_wants(x);
    learn_array *made = learn_array_make(tape, x->rows, x->columns, wants);
    messages *m = learn_tape_memory(tape, 1, sizeof *m);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    assert(x->columns == W && y->columns == W && gain->columns == W && shift->columns == W);
    assert(graph->targets == x->rows && graph->sources == y->rows);
    assert(wants == learn_wants(y) && wants == learn_wants(gain) && wants == learn_wants(shift));
    *m = (messages){.x = x, .y = y, .gain = gain, .shift = shift, .m = made, .graph = *graph};
    if (graph->edges == 0)
    {
        memset(made->value, 0, learn_size(made) * sizeof *made->value);
        return made;
    }
    messages_forward(m);
    if (wants)
        learn_tape_record(tape, made, messages_backward, m);
    return made;
}
