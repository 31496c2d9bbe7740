#include "research/networks/mesh_inference.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Forward pass of the network on blocks of half-flaps. The first layer is split: the products of vertex features are
/// computed once for each vertex and added for the four corners of a half-flap.

enum
{
    W = MESH_WIDTH,
    FEATURES = W - 3,               ///< features of a state: all but the position
    ROWS = 16 * LEARN_TILE,         ///< half-flaps of a block
    MAX_GEOMETRY = FLAP_EDGES + 12, ///< three edges and, in the first module, four differential coordinates
    VERTICES = ROWS / 6,            ///< vertices of a block
    DIFFERENCES = 6,                ///< width of the first state: position and differential coordinate
    LAYER = (W + 1) * LEARN_PANEL,  ///< numbers of a packed layer with W inputs
    MODULE = (FEATURES + 1) * 4 * LEARN_PANEL + (MAX_GEOMETRY + 1) * LEARN_PANEL + 2 * LAYER
};

// Weights

/// The weight's columns of a module's first layer, sorted as in research/train/mesh_network_tape.h.
typedef struct first_layer
{
    real features[4 * W][FEATURES]; ///< one corner after the other
    real geometry[W][MAX_GEOMETRY];
} first_layer;

static void sort_columns(const real *weight, size_t columns, first_layer *sorted)
{
    size_t width = (columns + 3) / 4;
    for (size_t o = 0; o < W; o++, weight += columns)
        for (size_t c = 0; c < 4; c++)
        {
            // The columns of corner c follow those of its position, which corner 0 does not have.
            const real *own = weight + c * width;
            for (size_t a = 0; a < 3 && c > 0; a++)
                sorted->geometry[o][3 * (c - 1) + a] = weight[c * width + a - 3];
            for (size_t a = 0; a < 3 && width == DIFFERENCES; a++)
                sorted->geometry[o][FLAP_EDGES + 3 * c + a] = own[a];
            if (width == W)
                memcpy(sorted->features[c * W + o], own, sizeof sorted->features[0]);
        }
}

static learn_packed pack(size_t inputs, size_t outputs, const real *weight, size_t stride, const real *bias, real **memory)
{
    learn_packed layer = learn_pack(inputs, outputs, weight, stride, bias, *memory);
    *memory += learn_packed_size(inputs, outputs);
    return layer;
}

static void pack_module(const learn_parameters *parameters, mesh_module which, mesh_inference_module *module, real *memory)
{
    static const real zeros[4 * W];
    first_layer sorted = {0};
    const real *values[MESH_MODULE_SIZE];
    size_t first = (size_t)which * MESH_MODULE_SIZE;
    for (size_t p = 0; p < MESH_MODULE_SIZE; p++)
        values[p] = learn_parameter_values(parameters, first + p);
    sort_columns(values[0], parameters->list[first].columns, &sorted);
    size_t geometry = parameters->list[first].columns == 4 * DIFFERENCES - 3 ? MAX_GEOMETRY : FLAP_EDGES;
    module->features = pack(FEATURES, 4 * W, sorted.features[0], FEATURES, zeros, &memory);
    module->geometry = pack(geometry, W, sorted.geometry[0], MAX_GEOMETRY, values[1], &memory);
    module->hidden = pack(W, W, values[2], W, values[3], &memory);
    module->last = pack(W, W, values[4], W, values[5], &memory);
}

bat_status mesh_inference_make(const learn_parameters *parameters, mesh_network_form form, mesh_inference *network,
                               bat_error *error)
{
    *network = (mesh_inference){.form = form, .memory = memory_array(MESH_MODULE_COUNT * MODULE, sizeof(real))};
    if (network->memory == NULL)
        return error_memory(error, MESH_MODULE_COUNT * MODULE * sizeof(real));
    for (size_t m = 0; m < MESH_MODULE_COUNT; m++)
        pack_module(parameters, (mesh_module)m, &network->module[m], network->memory + m * MODULE);
    return BAT_OK;
}

void mesh_inference_free(mesh_inference *network)
{
    free(network->memory);
    *network = (mesh_inference){0};
}

// A block of half-flaps

/// The input of a level: half-flaps, states and the module to apply.
typedef struct level_input
{
    flap_frame_options frames;
    const mesh_inference_module *module;
    const mesh_flaps *flaps;
    const real *state; ///< vertex_count x width
    size_t width;      ///< W; for the first module the width of the first state
    const real
        *products; ///< vertex_count x 4 W: the products of the features with the first layer; null for the first module
} level_input;

/// The memory of a thread.
typedef struct block
{
    _Alignas(64) real vectors[MAX_GEOMETRY * ROWS]; ///< in space
    real geometry[MAX_GEOMETRY * ROWS];             ///< in the local frames
    real frame[FLAP_FRAME * ROWS];
    real x[ROWS * MAX_GEOMETRY]; ///< the same, one row for each half-flap
    real inner[ROWS * W];
    real output[ROWS * W];
    const mesh_flap *flap[ROWS];
    size_t rows;     ///< the number of half-flaps
    size_t failures; ///< half-flaps without a frame or with an output that is not finite
} block;

static inline void gather_flap(const level_input *s, const mesh_flap *flap, real *vectors)
{
    const real *corner[4];
    for (size_t c = 0; c < 4; c++)
        corner[c] = s->state + flap->corner[c] * s->width;
    for (size_t c = 0; c < 3; c++)
        for (size_t a = 0; a < 3; a++)
            vectors[(3 * c + a) * ROWS] = corner[c + 1][a] - corner[0][a];
    if (flap->missing != MESH_FLAP_WHOLE)
    {
        size_t there = flap->missing == MESH_FLAP_NO_LEFT ? 6 : 3;
        for (size_t a = 0; a < 3; a++)
            vectors[(9 - there + a) * ROWS] = vectors[a * ROWS] - vectors[(there + a) * ROWS];
    }
    if (s->width == DIFFERENCES)
        for (size_t c = 0; c < 4; c++)
            for (size_t a = 0; a < 3; a++)
                vectors[(FLAP_EDGES + 3 * c + a) * ROWS] = corner[c][3 + a];
}

/// Prefetch the products that add_products() reads.
static inline void prefetch_products(const level_input *s, const mesh_flap *flap)
{
    enum
    {
        LINE = 64 / sizeof(real)
    };
    for (size_t c = 0; c < 4; c++)
        for (size_t i = 0; i < W; i += LINE)
            __builtin_prefetch(s->products + 4 * W * (size_t)flap->corner[c] + c * W + i);
}

static inline void prefetch_positions(const level_input *s, const mesh_flap *flap)
{
    for (size_t c = 1; c < 4; c++)
        __builtin_prefetch(s->state + flap->corner[c] * s->width);
}

/// Compute b->x for the half-flaps of b->flap.
static void gather_inputs(const level_input *s, block *b)
{
    enum
    {
        AHEAD = 12 ///< half-flaps
    };
    size_t numbers = s->module->geometry.inputs;
    for (size_t r = 0; r < b->rows; r++)
    {
        if (r + AHEAD < b->rows)
            prefetch_positions(s, b->flap[r + AHEAD]);
        gather_flap(s, b->flap[r], b->vectors + r);
        if (s->products != NULL)
            prefetch_products(s, b->flap[r]);
    }
    flap_frames(s->frames, ROWS, b->vectors, b->frame);
    for (size_t n = 0; n < numbers; n += 3)
        flap_turn(ROWS, b->frame, b->vectors + n * ROWS, b->geometry + n * ROWS);
    for (size_t r = 0; r < ROWS; r++)
        for (size_t n = 0; n < numbers; n++)
            b->x[r * numbers + n] = b->geometry[n * ROWS + r];
}

LANES_CLONES
static void rectify(size_t count, real *y)
{
    for (size_t i = 0; i < count; i++)
        y[i] = y[i] > 0 ? y[i] : 0;
}

/// y = max(0, y + the products of the four corners)
LANES_CLONES
static void add_products(size_t rows, const mesh_flap *const *flap, const real *restrict products, real *restrict y)
{
    for (size_t r = 0; r < rows; r++, y += W)
    {
        const uint32_t *corner = flap[r]->corner;
        const real *i = products + 4 * W * (size_t)corner[0], *j = products + 4 * W * (size_t)corner[1] + W;
        const real *k = products + 4 * W * (size_t)corner[2] + 2 * W, *l = products + 4 * W * (size_t)corner[3] + 3 * W;
        for (size_t o = 0; o < W; o++)
        {
            real sum = y[o] + ((i[o] + j[o]) + (k[o] + l[o]));
            y[o] = sum > 0 ? sum : 0;
        }
    }
}

/// Rotate the displacements from the local frames into space. Replace those that are not finite by 0.
static void rotate_displacements(block *b)
{
    for (size_t r = 0; r < b->rows; r++)
    {
        real *output = b->output + r * W, out[3];
        const real *frame = b->frame + r;
        for (size_t a = 0; a < 3; a++)
            out[a] = frame[FLAP_UNIT * ROWS] *
                     (output[0] * frame[a * ROWS] + output[1] * frame[(3 + a) * ROWS] + output[2] * frame[(6 + a) * ROWS]);
        bool finite = isfinite(out[0] + out[1] + out[2]);
        b->failures += !finite;
        for (size_t a = 0; a < 3; a++)
            output[a] = finite ? out[a] : 0;
    }
}

/// Apply the module to b->flap. b->output receives its outputs, with displacements in space.
static void evaluate(const level_input *s, block *b)
{
    const mesh_inference_module *module = s->module;
    size_t rows = learn_whole_tiles(b->rows);
    gather_inputs(s, b);
    learn_packed_linear(&module->geometry, rows, b->x, module->geometry.inputs, b->output);
    if (s->products != NULL)
        add_products(b->rows, b->flap, s->products, b->output);
    else
        rectify(rows * W, b->output);
    learn_packed_linear(&module->hidden, rows, b->output, W, b->inner);
    rectify(rows * W, b->inner);
    learn_packed_linear(&module->last, rows, b->inner, W, b->output);
    rotate_displacements(b);
}

// Vertices and edges

static inline void add_row(size_t columns, const real *restrict from, real *restrict to)
{
    for (size_t c = 0; c < columns; c++)
        to[c] += from[c];
}

static void count_frameless(block *b)
{
    for (size_t r = 0; r < b->rows; r++)
        b->failures += b->frame[r] == 0 && b->frame[ROWS + r] == 0 && b->frame[2 * ROWS + r] == 0;
}

/// Compute the new states of the vertices begin, …, end - 1.
static void move_vertices(const level_input *s, size_t begin, size_t end, real *next, block *b)
{
    const mesh_flaps *flaps = s->flaps;
    memset(next + begin * W, 0, (end - begin) * W * sizeof *next);
    for (uint32_t f = flaps->first[begin]; f < flaps->first[end]; f += (uint32_t)b->rows)
    {
        uint32_t left = flaps->first[end] - f;
        b->rows = left < ROWS ? left : ROWS;
        for (size_t r = 0; r < b->rows; r++)
            b->flap[r] = &flaps->flap[f + r];
        evaluate(s, b);
        for (size_t r = 0; r < b->rows; r++)
            add_row(W, b->output + r * W, next + b->flap[r]->corner[0] * (size_t)W);
        if (s->products == NULL)
            count_frameless(b);
    }
    for (size_t v = begin; v < end; v++)
    {
        uint32_t count = flaps->first[v + 1] - flaps->first[v];
        real share = count > 0 ? 1 / (real)count : 0;
        for (size_t c = 0; c < W; c++)
            next[v * W + c] *= share;
        add_row(3, s->state + v * s->width, next + v * W);
    }
}

/// Compute the states of the new vertices on the edges begin, …, end - 1, `columns` numbers of each. The edges fit into one
/// block.
static void insert_vertices(const level_input *s, size_t begin, size_t end, size_t columns, real *next, block *b)
{
    b->rows = 2 * (end - begin);
    for (size_t r = 0; r < b->rows; r++)
        b->flap[r] = &s->flaps->flap[s->flaps->of_edge[begin + r / 2][r % 2]];
    evaluate(s, b);
    for (size_t e = begin; e < end; e++)
    {
        const real *one = b->output + 2 * (e - begin) * W, *two = one + W;
        const uint32_t *corner = b->flap[2 * (e - begin)]->corner;
        const real *i = s->state + corner[0] * (size_t)W, *j = s->state + corner[1] * (size_t)W;
        real *row = next + e * columns;
        for (size_t c = 0; c < columns; c++)
            row[c] = (real)0.5 * (one[c] + two[c]);
        for (size_t a = 0; a < 3; a++)
            row[a] += (real)0.5 * (i[a] + j[a]);
    }
}

// Levels

typedef struct run
{
    const mesh_inference *network;
    int threads;
    real *state, *next; ///< vertices at the start of the last level, rounded up to whole tiles, x W
    real *products;     ///< the same number x 4 W
    size_t failures;
} run;

/// Multiply the features of all vertices with the first layer.
static void multiply(const run *u, const mesh_inference_module *module, size_t vertices)
{
    size_t tiles = learn_whole_tiles(vertices), blocks = (tiles + ROWS - 1) / ROWS;
#pragma omp parallel for num_threads(threads_for(u->threads, blocks))
    for (size_t i = 0; i < blocks; i++)
    {
        size_t begin = i * ROWS, rows = tiles - begin < ROWS ? tiles - begin : ROWS;
        learn_packed_linear(&module->features, rows, u->state + begin * W + 3, W, u->products + begin * 4 * W);
    }
}

static level_input level_input_of(const run *u, mesh_module module, const mesh_flaps *flaps)
{
    flap_frame_options frames = {.fixed = u->network->form.fixed_frames, .relative = u->network->form.relative};
    return (level_input){frames, &u->network->module[module], flaps, u->state, W, u->products};
}

/// Compute the states of all vertices, from s->state to u->state.
static void move(run *u, const level_input *s)
{
    size_t vertices = s->flaps->vertex_count, blocks = (vertices + VERTICES - 1) / VERTICES, failures = 0;
#pragma omp parallel num_threads(threads_for(u->threads, blocks)) reduction(+ : failures)
    {
        block b = {0};
#pragma omp for
        for (size_t i = 0; i < blocks; i++)
        {
            size_t begin = i * VERTICES, end = begin + VERTICES < vertices ? begin + VERTICES : vertices;
            move_vertices(s, begin, end, u->next, &b);
        }
        failures += b.failures;
    }
    u->failures += failures;
    real *before = u->state;
    u->state = u->next;
    u->next = before;
}

static void insert(run *u, const level_input *s, size_t columns, real *next)
{
    const size_t edges = s->flaps->edge_count, size = ROWS / 2, blocks = (edges + size - 1) / size;
    size_t failures = 0;
#pragma omp parallel num_threads(threads_for(u->threads, blocks)) reduction(+ : failures)
    {
        block b = {0};
#pragma omp for
        for (size_t i = 0; i < blocks; i++)
            insert_vertices(s, i * size, i * size + size < edges ? i * size + size : edges, columns, next, &b);
        failures += b.failures;
    }
    u->failures += failures;
}

/// Apply one level. The last level computes positions only.
static void refine_level(run *u, const mesh_flaps *flaps, real *fine)
{
    size_t vertices = flaps->vertex_count;
    level_input s = level_input_of(u, MESH_MODULE_VERTEX, flaps);
    multiply(u, s.module, vertices);
    move(u, &s);
    s = level_input_of(u, MESH_MODULE_EDGE, flaps);
    multiply(u, s.module, vertices);
    if (fine == NULL)
    {
        insert(u, &s, W, u->state + vertices * W);
        return;
    }
    insert(u, &s, 3, fine + 3 * vertices);
    for (size_t v = 0; v < vertices; v++)
        memcpy(fine + 3 * v, u->state + v * W, 3 * sizeof *fine);
}

/// Set the first state: positions and differential coordinates p_i - mean of its neighbours.
static void begin_state(const mesh_flaps *flaps, const real *positions, real *state)
{
    for (size_t v = 0; v < flaps->vertex_count; v++, state += DIFFERENCES)
    {
        real sum[3] = {0};
        uint32_t begin = flaps->first[v], end = flaps->first[v + 1];
        for (uint32_t f = begin; f < end; f++)
            add_row(3, positions + 3 * (size_t)flaps->flap[f].corner[1], sum);
        for (size_t a = 0; a < 3; a++)
        {
            state[a] = positions[3 * v + a];
            state[3 + a] = begin < end ? state[a] - sum[a] / (real)(end - begin) : 0;
        }
    }
}

bat_status mesh_inference_refine(const mesh_inference *network, const mesh_levels *levels, int threads,
                                 const real *positions, real *fine, size_t *fallback, bat_error *error)
{
    size_t rows = learn_whole_tiles(levels->level[levels->count - 1].vertex_count), size;
    if (size_multiply_overflows(rows, 6 * (size_t)W, &size))
        size = SIZE_MAX;
    real *memory = memory_array(size, sizeof *memory);
    if (memory == NULL)
        return error_memory(error, size < SIZE_MAX / sizeof *memory ? size * sizeof *memory : SIZE_MAX);
    run u = {network, threads, memory, memory + rows * W, memory + 2 * rows * W, 0};
    // Rows beyond the last vertex fill its tile; they are read.
    memset(memory, 0, 2 * rows * W * sizeof *memory);
    level_input begin = level_input_of(&u, MESH_MODULE_INIT, &levels->level[0]);
    begin.products = NULL;
    begin.width = network->form.no_differences ? 3 : DIFFERENCES;
    if (network->form.no_differences)
        memcpy(u.state, positions, 3 * begin.flaps->vertex_count * sizeof *positions);
    else
        begin_state(begin.flaps, positions, u.state);
    move(&u, &begin);
    *fallback = (u.failures + 1) / 2;
    u.failures = 0;
    for (size_t i = 0; i < levels->count; i++)
        refine_level(&u, &levels->level[i], i + 1 < levels->count ? NULL : fine);
    *fallback += u.failures;
    free(memory);
    return BAT_OK;
}
