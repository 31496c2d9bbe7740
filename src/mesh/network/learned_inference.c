#include "mesh/network/learned_network.h"

#include "base/error.h"
#include "base/threads.h"
#include "linalg/vector.h"

/// @file
/// Forward pass of the network on blocks of vertices, half-flaps and edges. Products of vertex states are computed once for
/// each vertex and gathered.

enum
{
    W = LEARNED_WIDTH,
    X = LEARNED_EDGE_FEATURES,
    IN = LEARNED_VERTEX_INPUTS,
    VK = LEARNED_VERTEX_CANDIDATES,
    EK = LEARNED_EDGE_CANDIDATES,
    ROWS = 16 * LEARN_TILE, ///< rows of a block
    VERTICES = ROWS / 2,    ///< vertices of a block whose half-flaps are visited
    POOLED = 1024           ///< vertices whose states are summed at once
};

// Weights

/// Memory for packed layers, which are aligned because all sizes are whole panels.
static learn_packed pack(size_t inputs, size_t outputs, const real *weight, size_t stride, const real *bias, real **memory)
{
    learn_packed layer = learn_pack(inputs, outputs, weight, stride, bias, *memory);
    *memory += learn_packed_size(inputs, outputs);
    return layer;
}

static size_t packed_size(void)
{
    return learn_packed_size(IN, W) + 10 * learn_packed_size(W, W) + 2 * learn_packed_size(X, W) + learn_packed_size(W, VK) +
           learn_packed_size(W, EK);
}

static void pack_level(const real *const *v, size_t level, learned_layers *layers, real **memory)
{
    static const real none[W];
    size_t columns = IN + (level > 0 ? W : 0);
    *layers = (learned_layers){
        .in = pack(IN, W, v[LEARNED_VERTEX_IN], columns, v[LEARNED_VERTEX_IN_BIAS], memory),
        .hidden = pack(W, W, v[LEARNED_VERTEX_HIDDEN], W, v[LEARNED_VERTEX_HIDDEN_BIAS], memory),
        .message_self = pack(W, W, v[LEARNED_MESSAGE_SELF], W, v[LEARNED_MESSAGE_SELF_BIAS], memory),
        .message_ring = pack(W, W, v[LEARNED_MESSAGE_RING], W, none, memory),
        .message_edge = pack(X, W, v[LEARNED_MESSAGE_EDGE], X, none, memory),
        .update_self = pack(W, W, v[LEARNED_UPDATE_SELF], W, v[LEARNED_UPDATE_BIAS], memory),
        .update_message = pack(W, W, v[LEARNED_UPDATE_MESSAGE], W, none, memory),
        .out = pack(W, W, v[LEARNED_VERTEX_OUT], W, v[LEARNED_VERTEX_OUT_BIAS], memory),
        .last = pack(W, VK, v[LEARNED_VERTEX_LAST], W, v[LEARNED_VERTEX_LAST_BIAS], memory),
        .end = pack(W, W, v[LEARNED_EDGE_END], W, none, memory),
        .opposite = pack(W, W, v[LEARNED_EDGE_OPPOSITE], W, none, memory),
        .edge_own = pack(X, W, v[LEARNED_EDGE_OWN], X, v[LEARNED_EDGE_OWN_BIAS], memory),
        .edge_hidden = pack(W, W, v[LEARNED_EDGE_HIDDEN], W, v[LEARNED_EDGE_HIDDEN_BIAS], memory),
        .edge_last = pack(W, EK, v[LEARNED_EDGE_LAST], W, v[LEARNED_EDGE_LAST_BIAS], memory),
        .ring = v[LEARNED_RING_LAST],
        .ring_bias = v[LEARNED_RING_LAST_BIAS],
        .context = {v[LEARNED_CONTEXT_UPDATE], v[LEARNED_CONTEXT_VERTEX], v[LEARNED_CONTEXT_EDGE]},
        .context_bias = {v[LEARNED_UPDATE_BIAS], v[LEARNED_VERTEX_OUT_BIAS], v[LEARNED_EDGE_OWN_BIAS]},
    };
    layers->last.wanted = VK;
    layers->edge_last.wanted = EK;
    if (level > 0)
        layers->in_state = pack(W, W, v[LEARNED_VERTEX_IN] + IN, columns, none, memory);
}

bat_status mesh_learned_pack(const learn_parameters *parameters, mesh_learned *network, bat_error *error)
{
    size_t size = LEARNED_LEVELS_OF_MESH * packed_size() + parameters->total;
    mesh_learned made = {.memory = memory_array(size, sizeof *made.memory)};
    if (made.memory == NULL)
        return error_memory(error, size * sizeof *made.memory);
    real *plain = made.memory + LEARNED_LEVELS_OF_MESH * packed_size(), *memory = made.memory;
    memcpy(plain, parameters->values, parameters->total * sizeof *plain);
    const real *values[LEARNED_PARAMETERS];
    for (size_t p = 0; p < LEARNED_PARAMETERS; p++)
        values[p] = plain + parameters->list[p].offset;
    for (size_t level = 0; level < LEARNED_LEVELS_OF_MESH; level++)
        pack_level(values + learned_parameter_of(level, 0), level, &made.level[level], &memory);
    made.pool = values[LEARNED_POOL_WEIGHT];
    made.pool_bias = values[LEARNED_POOL_BIAS];
    *network = made;
    return BAT_OK;
}

// A level

typedef struct pass
{
    const learned_layers *layers;
    const mesh_flaps *flaps;
    learned_geometry geometry;
    size_t old;         ///< vertices of the level before
    const real *before; ///< states of the level before, or null
    /// Vertices and edges x W: the first states, which the second replace; in the last level those of the level before.
    real *state;
    real *product; ///< vertices x W: of the first states for the ring, then of the second states as opposite vertices
    real *end;     ///< vertices x W: products of the second states as ends; in the last level these replace the states
    real *message; ///< vertices x W: the mean messages, at level 0
    bool last;
    double (*sums)[LEARNED_RINGS][3];
    real bias[3][W]; ///< of update, vertex and edge, with the context
    double reach;    ///< of moves
    double *fine;
    int threads;
    size_t failures;
} pass;

/// The memory of a thread.
typedef struct block
{
    _Alignas(64) real in[ROWS * IN];
    real x[ROWS * W], y[ROWS * W], z[ROWS * W], message[ROWS * W], self[ROWS * W];
    real ring[ROWS * LEARNED_RINGS];
    double move[ROWS][3], size[ROWS], factor[ROWS];
    size_t failures;
} block;

LANES_CLONES
static void rectify(size_t count, real *y)
{
    for (size_t i = 0; i < count; i++)
        y[i] = y[i] > 0 ? y[i] : 0;
}

/// y = max(0, x + y)
LANES_CLONES
static void add_rectify(size_t count, const real *restrict x, real *restrict y)
{
    for (size_t i = 0; i < count; i++)
    {
        real sum = x[i] + y[i];
        y[i] = sum > 0 ? sum : 0;
    }
}

/// tanh of the first `columns` numbers of rows of W numbers, which move together.
LANES_CLONES
static void squash(size_t rows, size_t columns, real *y)
{
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
            y[r * columns + c] = y[r * W + c];
    for (size_t i = 0; i < rows * columns; i++)
        y[i] = real_tanh(y[i]);
}

/// A layer with another bias.
static learn_packed with_bias(const learn_packed *layer, const real *bias)
{
    learn_packed changed = *layer;
    changed.bias = bias;
    return changed;
}

static void copy_rows(const real *from, size_t rows, size_t columns, real *to)
{
    memcpy(to, from, rows * columns * sizeof *to);
    memset(to + rows * columns, 0, (learn_whole_tiles(rows) - rows) * columns * sizeof *to);
}

/// The first states of the vertices begin, …, end - 1, and their products for the ring.
static void begin_states(const pass *p, size_t begin, size_t end, block *b)
{
    const learned_layers *layers = p->layers;
    size_t rows = end - begin, tiles = learn_whole_tiles(rows);
    for (size_t r = 0; r < rows; r++)
        learned_vertex_inputs(&p->geometry, p->old, begin + r, b->in + r * IN);
    memset(b->in + rows * IN, 0, (tiles - rows) * IN * sizeof *b->in);
    learn_packed_linear(&layers->in, tiles, b->in, IN, b->x);
    if (p->before != NULL)
    {
        learn_packed_linear(&layers->in_state, tiles, p->before + begin * W, W, b->y);
        add_rectify(tiles * W, b->y, b->x);
    }
    else
        rectify(tiles * W, b->x);
    learn_packed_linear(&layers->hidden, tiles, b->x, W, p->state + begin * W);
    rectify(tiles * W, p->state + begin * W);
    learn_packed_linear(&layers->message_ring, tiles, p->state + begin * W, W, p->product + begin * W);
}

/// message = max(0, message + product of the first vertex + product of the second for the ring)
/// @param selves products of the vertices from `begin` on
LANES_CLONES
static void add_messages(size_t rows, const mesh_flap *flap, size_t begin, const real *restrict selves,
                         const real *restrict products, real *restrict message)
{
    for (size_t r = 0; r < rows; r++, message += W)
    {
        const real *self = selves + W * (flap[r].corner[0] - begin), *ring = products + W * (size_t)flap[r].corner[1];
        for (size_t c = 0; c < W; c++)
        {
            real sum = message[c] + (self[c] + ring[c]);
            message[c] = sum > 0 ? sum : 0;
        }
    }
}

/// The weights of the ring sums, from messages.
LANES_CLONES
static void weigh_ring(const learned_layers *layers, size_t rows, const real *restrict message, real *restrict weight)
{
    enum
    {
        PARTS = 16 ///< sums side by side
    };
    for (size_t r = 0; r < rows; r++, message += W)
        for (size_t k = 0; k < LEARNED_RINGS; k++)
        {
            const real *with = layers->ring + k * W;
            real part[PARTS] = {0};
            for (size_t c = 0; c < W; c += PARTS)
                for (size_t i = 0; i < PARTS; i++)
                    part[i] += message[c + i] * with[c + i];
            for (size_t half = PARTS / 2; half > 0; half /= 2)
                for (size_t i = 0; i < half; i++)
                    part[i] += part[half + i];
            weight[r * LEARNED_RINGS + k] = layers->ring_bias[k] + part[0];
        }
    for (size_t i = 0; i < rows * LEARNED_RINGS; i++)
        weight[i] = real_tanh(weight[i]);
}

static void add_ring_sums(const pass *p, const mesh_flap *flap, size_t rows, const real *weight)
{
    const double *positions = p->geometry.positions;
    for (size_t r = 0; r < rows; r++)
    {
        const double *v = positions + 3 * (size_t)flap[r].corner[0], *w = positions + 3 * (size_t)flap[r].corner[1];
        for (size_t k = 0; k < LEARNED_RINGS; k++)
            for (int c = 0; c < 3; c++)
                p->sums[flap[r].corner[0]][k][c] +=
                    LEARNED_RING_SHARE * (double)weight[r * LEARNED_RINGS + k] * (w[c] - v[c]);
    }
}

/// The mean messages of the vertices begin, …, end - 1, and their ring sums.
static void gather_into(const pass *p, size_t begin, size_t end, real *message, block *b)
{
    const mesh_flaps *flaps = p->flaps;
    size_t count;
    memset(message, 0, (end - begin) * W * sizeof *message);
    // A tile may reach into the next block, which another thread may change.
    copy_rows(p->state + begin * W, end - begin, W, b->in);
    learn_packed_linear(&p->layers->message_self, learn_whole_tiles(end - begin), b->in, W, b->self);
    for (size_t f = flaps->first[begin]; f < flaps->first[end]; f += count)
    {
        size_t left = flaps->first[end] - f;
        const mesh_flap *flap = &flaps->flap[f];
        count = left < ROWS ? left : ROWS;
        for (size_t r = 0; r < count; r++)
            memcpy(b->in + r * X, p->geometry.edge_features + flap[r].edge * (size_t)X, X * sizeof *b->in);
        learn_packed_linear(&p->layers->message_edge, learn_whole_tiles(count), b->in, X, b->x);
        add_messages(count, flap, begin, b->self, p->product, b->x);
        weigh_ring(p->layers, count, b->x, b->ring);
        add_ring_sums(p, flap, count, b->ring);
        for (size_t r = 0; r < count; r++)
        {
            real *to = message + (flap[r].corner[0] - begin) * W;
            for (size_t c = 0; c < W; c++)
                to[c] += b->x[r * W + c];
        }
    }
    for (size_t v = begin; v < end; v++)
    {
        uint32_t valence = flaps->first[v + 1] - flaps->first[v];
        real share = valence > 0 ? 1 / (real)valence : 0;
        for (size_t c = 0; c < W; c++)
            message[(v - begin) * W + c] *= share;
    }
}

static void gather_messages(const pass *p, size_t begin, size_t end, block *b)
{
    gather_into(p, begin, end, p->message + begin * W, b);
}

/// The sum of candidates times coefficients, which come before bounds.
static inline void sum_move(size_t count, const double candidate[][3], const learned_bound *bound, const real *coefficient,
                            double move[3])
{
    double sum[3] = {0};
    for (size_t k = 0; k < count; k++)
    {
        double factor = (double)(bound[k].middle + bound[k].reach * coefficient[k]);
        vector_add(3, factor, candidate[k], sum);
    }
    memcpy(move, sum, sizeof sum);
}

/// Bound the moves of a block and add them to points. One that is not finite fails: its point stays.
static void apply_moves(size_t rows, double reach, block *b, double *points)
{
    learned_move_factors(rows, reach, (const double(*)[3])b->move, b->size, b->factor);
    for (size_t r = 0; r < rows; r++)
        if (isfinite(b->move[r][0] + b->move[r][1] + b->move[r][2]))
            vector_add(3, b->factor[r], b->move[r], points + 3 * r);
        else
            b->failures++;
}

/// The move of a vertex by its coefficients.
static void find_move(const pass *p, size_t v, const real *coefficient, double move[3])
{
    double candidate[VK][3];
    if (p->flaps->first[v] == p->flaps->first[v + 1] || learned_at_boundary(p->flaps, v))
    {
        memset(move, 0, 3 * sizeof *move);
        return;
    }
    learned_vertex_candidates(&p->geometry, v, p->sums[v][0], candidate);
    sum_move(VK, (const double(*)[3])candidate, learned_vertex_bound, coefficient, move);
}

/// The second states of the vertices begin, …, end - 1 replace the first; then their new positions.
/// @param message in whole tiles
static void update_with(const pass *p, size_t begin, size_t end, const real *message, block *b)
{
    const learned_layers *layers = p->layers;
    size_t rows = end - begin, tiles = learn_whole_tiles(rows);
    real *state = p->state + begin * W;
    learn_packed self = with_bias(&layers->update_self, p->bias[0]), out = with_bias(&layers->out, p->bias[1]);
    // A tile may reach into the next block, which another thread updates.
    copy_rows(state, rows, W, b->in);
    learn_packed_linear(&self, tiles, b->in, W, b->x);
    learn_packed_linear(&layers->update_message, tiles, message, W, b->z);
    add_rectify(tiles * W, b->z, b->x);
    memcpy(state, b->x, rows * W * sizeof *state);
    learn_packed_linear(&out, tiles, b->x, W, b->y);
    rectify(tiles * W, b->y);
    learn_packed_linear(&layers->last, tiles, b->y, W, b->z);
    squash(rows, VK, b->z);
    for (size_t r = 0; r < rows; r++)
    {
        find_move(p, begin + r, b->z + r * VK, b->move[r]);
        b->size[r] = p->geometry.size[begin + r];
    }
    memcpy(p->fine + 3 * begin, p->geometry.positions + 3 * begin, 3 * rows * sizeof *p->fine);
    apply_moves(rows, p->reach, b, p->fine + 3 * begin);
}

static void update_vertices(const pass *p, size_t begin, size_t end, block *b)
{
    update_with(p, begin, end, p->message + begin * W, b);
}

/// Both at once, where nothing is pooled in between.
static void gather_and_update(const pass *p, size_t begin, size_t end, block *b)
{
    memset(b->message + (end - begin) * W, 0, (learn_whole_tiles(end - begin) - (end - begin)) * W * sizeof *b->message);
    gather_into(p, begin, end, b->message, b);
    update_with(p, begin, end, b->message, b);
}

/// hidden = max(0, hidden + products of the four corners)
LANES_CLONES
static void add_corners(size_t rows, const mesh_flap *const *flap, const real *restrict ends, const real *restrict opposites,
                        real *restrict hidden)
{
    for (size_t r = 0; r < rows; r++, hidden += W)
    {
        const uint32_t *corner = flap[r]->corner;
        const real *i = ends + W * (size_t)corner[0], *j = ends + W * (size_t)corner[1];
        const real *k = opposites + W * (size_t)corner[2], *l = opposites + W * (size_t)corner[3];
        for (size_t c = 0; c < W; c++)
        {
            real sum = hidden[c] + ((i[c] + j[c]) + (k[c] + l[c]));
            hidden[c] = sum > 0 ? sum : 0;
        }
    }
}

/// Where the new vertex of an edge begins, and its move.
static void place_edge(const pass *p, size_t e, const mesh_flap *flap, const real *coefficient, double *to, double move[3])
{
    const double *positions = p->geometry.positions, *i = positions + 3 * (size_t)flap->corner[0],
                 *j = positions + 3 * (size_t)flap->corner[1];
    double candidate[EK][3], ring[3];
    if (flap->missing != MESH_FLAP_WHOLE)
    {
        learned_boundary_point(p->flaps, positions, e, to);
        memset(move, 0, 3 * sizeof *move);
        return;
    }
    for (int c = 0; c < 3; c++)
    {
        ring[c] = 0.5 * (p->sums[flap->corner[0]][1][c] + p->sums[flap->corner[1]][1][c]);
        to[c] = 0.5 * (i[c] + j[c]);
    }
    learned_edge_candidates(&p->geometry, e, ring, candidate);
    sum_move(EK, (const double(*)[3])candidate, learned_edge_bound, coefficient, move);
}

/// The new vertices of the edges begin, …, end - 1.
static void insert_vertices(const pass *p, size_t begin, size_t end, block *b)
{
    const learned_layers *layers = p->layers;
    const mesh_flap *flap[ROWS];
    size_t rows = end - begin, tiles = learn_whole_tiles(rows);
    for (size_t r = 0; r < rows; r++)
        flap[r] = &p->flaps->flap[p->flaps->of_edge[begin + r][0]];
    learn_packed own = with_bias(&layers->edge_own, p->bias[2]);
    copy_rows(p->geometry.edge_features + begin * X, rows, X, b->in);
    learn_packed_linear(&own, tiles, b->in, X, b->x);
    add_corners(rows, flap, p->end, p->product, b->x);
    learn_packed_linear(&layers->edge_hidden, tiles, b->x, W, b->y);
    rectify(tiles * W, b->y);
    if (!p->last)
        memcpy(p->state + (p->flaps->vertex_count + begin) * W, b->y, rows * W * sizeof *b->y);
    learn_packed_linear(&layers->edge_last, tiles, b->y, W, b->z);
    squash(rows, EK, b->z);
    double *to = p->fine + 3 * (p->flaps->vertex_count + begin);
    for (size_t r = 0; r < rows; r++)
    {
        place_edge(p, begin + r, flap[r], b->z + r * EK, to + 3 * r, b->move[r]);
        b->size[r] = learned_edge_size(&p->geometry, begin + r);
    }
    apply_moves(rows, p->reach, b, to);
}

// The mesh-wide numbers

/// From the mean state and message of all vertices, summed in the same order for any number of threads.
static bat_status pool(const mesh_learned *network, const pass *p, double fairness, real context[LEARNED_CONTEXT],
                       bat_error *error)
{
    size_t vertices = p->flaps->vertex_count, parts = (vertices + POOLED - 1) / POOLED;
    double(*sums)[2 * W] = calloc(parts, sizeof *sums), mean[2 * W] = {0};
    if (sums == NULL)
        return error_memory(error, parts * sizeof *sums);
#pragma omp parallel for num_threads(threads_for(p->threads, parts))
    for (size_t i = 0; i < parts; i++)
        for (size_t v = i * POOLED; v < vertices && v < (i + 1) * POOLED; v++)
            for (size_t c = 0; c < W; c++)
            {
                sums[i][c] += (double)p->state[v * W + c];
                sums[i][W + c] += (double)p->message[v * W + c];
            }
    for (size_t i = 0; i < parts; i++)
        for (size_t c = 0; c < 2 * W; c++)
            mean[c] += sums[i][c] / (double)vertices;
    free(sums);
    for (size_t o = 0; o < LEARNED_POOL; o++)
    {
        double sum = (double)network->pool_bias[o];
        for (size_t c = 0; c < 2 * W; c++)
            sum += mean[c] * (double)network->pool[o * 2 * W + c];
        context[o] = sum > 0 ? (real)sum : 0;
    }
    context[LEARNED_POOL] = (real)fairness;
    context[LEARNED_POOL + 1] = (real)(fairness * fairness);
    return BAT_OK;
}

// All

/// The work on the vertices or edges begin, …, end - 1.
typedef void block_work(const pass *p, size_t begin, size_t end, block *b);

static void run_blocks(pass *p, block_work *work, size_t count, size_t size)
{
    size_t blocks = (count + size - 1) / size, failures = 0;
#pragma omp parallel num_threads(threads_for(p->threads, blocks)) reduction(+ : failures)
    {
        block b = {0};
#pragma omp for
        for (size_t i = 0; i < blocks; i++)
        {
            size_t begin = i * size, end = begin + size < count ? begin + size : count;
            work(p, begin, end, &b);
        }
        failures += b.failures;
    }
    p->failures += failures;
}

/// Products of the second states, as ends and as opposite vertices.
static void multiply_ends(const pass *p, size_t begin, size_t end, block *b)
{
    size_t rows = end - begin, tiles = learn_whole_tiles(rows);
    copy_rows(p->state + begin * W, rows, W, b->in);
    learn_packed_linear(&p->layers->opposite, tiles, b->in, W, p->product + begin * W);
    learn_packed_linear(&p->layers->end, tiles, b->in, W, p->end + begin * W);
}

/// The parts of the memory of a level, each aligned to 64 bytes.
typedef struct parts
{
    size_t sums, product, geometry, message, end, all; ///< offsets
} parts;

/// @param last the last level: it keeps no messages, and its ends are where its states were
static parts parts_of(const mesh_flaps *flaps, bool last)
{
    enum
    {
        ALIGNED = 64,
        PARTS = 5
    };
    size_t vertices = flaps->vertex_count, states = learn_whole_tiles(vertices) * W * sizeof(real), more = last ? 0 : states;
    const size_t sizes[PARTS] = {vertices * LEARNED_RINGS * 3 * sizeof(double), states,
                                 learned_geometry_size(vertices, flaps->edge_count), more, more};
    size_t begin[PARTS + 1] = {0};
    for (size_t i = 0; i < PARTS; i++)
        begin[i + 1] = begin[i] + (sizes[i] + ALIGNED - 1) / ALIGNED * ALIGNED;
    return (parts){begin[0], begin[1], begin[2], begin[3], begin[4], begin[5]};
}

bat_status mesh_learned_begin(const mesh_levels *levels, mesh_learned_run *run, bat_error *error)
{
    size_t size = 0;
    for (size_t i = 0; i < levels->count; i++)
    {
        size_t own = parts_of(&levels->level[i], i + 1 == LEARNED_LEVELS_OF_MESH).all;
        size = own > size ? own : size;
    }
    *run = (mesh_learned_run){.memory = memory_array(size, 1)};
    return run->memory != NULL ? BAT_OK : error_memory(error, size);
}

/// The states that a level returns: those of its vertices and edges. The last level has the memory of the level before.
static bat_status take_states(const mesh_flaps *flaps, bool last, mesh_learned_run *run, real **state, bat_error *error)
{
    size_t count = flaps->vertex_count + flaps->edge_count, rows = learn_whole_tiles(count);
    *state = run->state;
    if (last)
        return BAT_OK;
    if (array_make(state, rows, W * sizeof **state, error) != BAT_OK)
        return BAT_NO_MEMORY;
    memset(*state + count * W, 0, (rows - count) * W * sizeof **state);
    return BAT_OK;
}

bat_status mesh_learned_step(const mesh_learned *network, size_t level, const mesh_flaps *flaps, const double *positions,
                             size_t old, double fairness, int threads, mesh_learned_run *run, double *fine, size_t *failures,
                             bat_error *error)
{
    bool last = level + 1 == LEARNED_LEVELS_OF_MESH;
    size_t vertices = flaps->vertex_count, rows = learn_whole_tiles(vertices);
    char *memory = run->memory;
    real *state;
    bat_status status = take_states(flaps, last, run, &state, error);
    if (status != BAT_OK)
        return status;
    parts at = parts_of(flaps, last);
    pass p = {.layers = &network->level[level],
              .flaps = flaps,
              .geometry = learned_geometry_in(flaps, positions, threads, memory + at.geometry),
              .old = old,
              .last = last,
              .before = run->state,
              .state = state,
              .product = (real *)(void *)(memory + at.product),
              .end = last ? state : (real *)(void *)(memory + at.end),
              .message = (real *)(void *)(memory + at.message),
              .sums = (double(*)[LEARNED_RINGS][3])(void *)(memory + at.sums),
              .reach = learned_reach(fairness),
              .fine = fine,
              .threads = threads};
    memset(p.sums, 0, vertices * sizeof *p.sums);
    run_blocks(&p, begin_states, vertices, ROWS);
    if (level == 0)
    {
        // Rows beyond the last vertex fill its tile; they are read.
        memset(p.message + vertices * W, 0, (rows - vertices) * W * sizeof *p.message);
        run_blocks(&p, gather_messages, vertices, VERTICES);
        status = pool(network, &p, fairness, run->context, error);
    }
    if (status == BAT_OK)
    {
        for (size_t i = 0; i < 3; i++)
            for (size_t o = 0; o < W; o++)
            {
                real sum = p.layers->context_bias[i][o];
                for (size_t c = 0; c < LEARNED_CONTEXT; c++)
                    sum += run->context[c] * p.layers->context[i][o * LEARNED_CONTEXT + c];
                p.bias[i][o] = sum;
            }
        if (level == 0)
            run_blocks(&p, update_vertices, vertices, ROWS);
        else
            run_blocks(&p, gather_and_update, vertices, VERTICES);
        run_blocks(&p, multiply_ends, vertices, ROWS);
        run_blocks(&p, insert_vertices, flaps->edge_count, ROWS);
        *failures = p.failures;
    }
    if (run->state != state)
        free(run->state);
    run->state = state;
    return status;
}
