#include "research/train/mesh_network_tape.h"

#include "learn/blas.h"

#include <assert.h>

// Rows

static inline void add_row(size_t columns, real factor, const real *restrict from, real *restrict to)
{
    for (size_t c = 0; c < columns; c++)
        to[c] += factor * from[c];
}

static void record(learn_tape *tape, learn_array *output, learn_backward *backward, const void *context, size_t size)
{
    if (!learn_wants(output))
        return;
    void *copy = learn_tape_memory(tape, 1, size);
    if (copy == NULL)
        return;
    memcpy(copy, context, size);
    learn_tape_record(tape, output, backward, copy);
}

// Differential coordinates

typedef struct differences
{
    const mesh_flaps *flaps;
    learn_array *positions, *state;
} differences;

static void differences_back(void *context)
{
    const differences *d = context;
    const mesh_flaps *flaps = d->flaps;
    real *to = learn_gradient(d->positions);
    for (size_t v = 0; v < flaps->vertex_count; v++)
    {
        const real *gradient = d->state->gradient + 6 * v;
        uint32_t begin = flaps->first[v], end = flaps->first[v + 1];
        add_row(3, 1, gradient, to + 3 * v);
        if (begin < end)
            add_row(3, 1, gradient + 3, to + 3 * v);
        for (uint32_t f = begin; f < end; f++)
            add_row(3, -1 / (real)(end - begin), gradient + 3, to + 3 * flaps->flap[f].corner[1]);
    }
}

learn_array *tape_flap_differences(learn_tape *tape, const mesh_flaps *flaps, learn_array *positions)
{
    learn_array *state = learn_array_make(tape, positions->rows, 6, learn_wants(positions));
    if (tape->status != BAT_OK)
        return state;
    assert(positions->columns == 3 && positions->rows == flaps->vertex_count);
    memset(state->value, 0, learn_size(state) * sizeof(real));
    for (size_t v = 0; v < flaps->vertex_count; v++)
    {
        real *row = state->value + 6 * v;
        uint32_t begin = flaps->first[v], end = flaps->first[v + 1];
        for (uint32_t f = begin; f < end; f++)
            add_row(3, -1 / (real)(end - begin), positions->value + 3 * flaps->flap[f].corner[1], row + 3);
        add_row(3, 1, positions->value + 3 * v, row);
        if (begin < end)
            add_row(3, 1, positions->value + 3 * v, row + 3);
    }
    differences context = {flaps, positions, state};
    record(tape, state, differences_back, &context, sizeof context);
    return state;
}

// Local coordinates

typedef struct localization
{
    tape_flap_local local;
    learn_array *state;
    real *vectors; ///< edges and vectors in space, laid out as the coordinates
} localization;

static inline void put3(const real *from, size_t count, size_t f, real *to)
{
    to[f] = from[0];
    to[count + f] = from[1];
    to[2 * count + f] = from[2];
}

static inline void take3(const real *from, size_t count, size_t f, real factor, real *restrict to)
{
    to[0] += factor * from[f];
    to[1] += factor * from[count + f];
    to[2] += factor * from[2 * count + f];
}

/// From the corners' positions to the three edges. A missing corner is i + j - k.
static void gather_edges(const mesh_flaps *flaps, const learn_array *state, real *edges)
{
    size_t columns = state->columns;
    for (size_t f = 0; f < flaps->count; f++)
    {
        const mesh_flap *flap = &flaps->flap[f];
        const real *i = state->value + flap->corner[0] * columns;
        real edge[FLAP_EDGES];
        for (size_t c = 0; c < 3; c++)
            for (size_t a = 0; a < 3; a++)
                edge[3 * c + a] = state->value[flap->corner[c + 1] * columns + a] - i[a];
        if (flap->missing != MESH_FLAP_WHOLE)
        {
            size_t there = flap->missing == MESH_FLAP_NO_LEFT ? 6 : 3;
            for (size_t a = 0; a < 3; a++)
                edge[9 - there + a] = edge[a] - edge[there + a];
        }
        for (size_t a = 0; a < FLAP_EDGES; a++)
            edges[a * flaps->count + f] = edge[a];
    }
}

static void gather_edges_back(const mesh_flaps *flaps, const real *edge_gradient, learn_array *state)
{
    size_t columns = state->columns;
    real *to = learn_gradient(state);
    for (size_t f = 0; f < flaps->count; f++)
    {
        const mesh_flap *flap = &flaps->flap[f];
        real edge[FLAP_EDGES];
        for (size_t a = 0; a < FLAP_EDGES; a++)
            edge[a] = edge_gradient[a * flaps->count + f];
        if (flap->missing != MESH_FLAP_WHOLE)
        {
            size_t there = flap->missing == MESH_FLAP_NO_LEFT ? 6 : 3;
            for (size_t a = 0; a < 3; a++)
            {
                edge[a] += edge[9 - there + a];
                edge[there + a] -= edge[9 - there + a];
                edge[9 - there + a] = 0;
            }
        }
        for (size_t c = 0; c < 3; c++)
        {
            add_row(3, 1, edge + 3 * c, to + flap->corner[c + 1] * columns);
            add_row(3, -1, edge + 3 * c, to + flap->corner[0] * columns);
        }
    }
}

static void gather_vectors(const mesh_flaps *flaps, const learn_array *state, size_t vectors, real *to)
{
    for (size_t f = 0; f < flaps->count; f++)
        for (size_t c = 0; c < 4; c++)
            for (size_t v = 0; v < vectors; v++)
                put3(state->value + flaps->flap[f].corner[c] * state->columns + 3 + 3 * v, flaps->count, f,
                     to + 3 * (c * vectors + v) * flaps->count);
}

static void gather_vectors_back(const mesh_flaps *flaps, const real *gradient, size_t vectors, learn_array *state)
{
    real *to = learn_gradient(state);
    for (size_t f = 0; f < flaps->count; f++)
        for (size_t c = 0; c < 4; c++)
            for (size_t v = 0; v < vectors; v++)
                take3(gradient + 3 * (c * vectors + v) * flaps->count, flaps->count, f, 1,
                      to + flaps->flap[f].corner[c] * state->columns + 3 + 3 * v);
}

static void localize_back(void *context)
{
    const localization *l = context;
    const mesh_flaps *flaps = l->local.flaps;
    size_t count = flaps->count, numbers = l->local.coordinates->rows;
    real *frame_gradient = learn_gradient(l->local.frame), *local_gradient = learn_gradient(l->local.coordinates);
    // The gradient by the vectors in space replaces that by the local coordinates.
    for (size_t n = 0; n < numbers; n += 3)
        flap_turn_back(count, l->local.frame->value, l->vectors + n * count, frame_gradient, local_gradient + n * count);
    flap_frames_back(l->local.view, count, l->vectors, frame_gradient, local_gradient);
    gather_edges_back(flaps, local_gradient, l->state);
    gather_vectors_back(flaps, local_gradient + FLAP_EDGES * count, l->local.vectors, l->state);
}

tape_flap_local tape_flap_localize(learn_tape *tape, const mesh_flaps *flaps, flap_frame_options view, learn_array *state,
                                   size_t vectors)
{
    size_t count = flaps->count, numbers = FLAP_EDGES + 12 * vectors;
    bool wants = learn_wants(state);
    tape_flap_local local = {flaps, view, vectors, learn_array_make(tape, FLAP_FRAME, count, wants),
                             learn_array_make(tape, numbers, count, wants)};
    localization l = {local, state, learn_tape_memory(tape, numbers * count, sizeof(real))};
    if (tape->status != BAT_OK)
        return local;
    assert(state->rows == flaps->vertex_count && state->columns >= 3 + 3 * vectors);
    gather_edges(flaps, state, l.vectors);
    gather_vectors(flaps, state, vectors, l.vectors + FLAP_EDGES * count);
    flap_frames(view, count, l.vectors, local.frame->value);
    for (size_t n = 0; n < numbers; n += 3)
        flap_turn(count, local.frame->value, l.vectors + n * count, local.coordinates->value + n * count);
    if (!wants)
        return local;
    localization *copy = learn_tape_memory(tape, 1, sizeof *copy);
    if (copy != NULL)
    {
        *copy = l;
        learn_tape_record(tape, NULL, localize_back, copy);
    }
    return local;
}

// The first layer: y_f = max(0, b + A s_f + sum over corners c of B_c h_c)
//   s_f local coordinates, numbers x count (transposed); h_c features of corner c; A outputs x numbers and B 4 outputs x
//   features are the weight's columns in another order

typedef struct layer
{
    const mesh_flaps *flaps;
    size_t vectors, outputs;
    learn_array *coordinates, *state, *weight, *bias, *y;
    real *of_local;    ///< A
    real *of_features; ///< B
} layer;

static size_t feature_count(const layer *l)
{
    return l->state->columns - 3 - 3 * l->vectors;
}

/// The weight's column of local coordinate n.
static size_t local_column(const layer *l, size_t n)
{
    size_t columns = l->state->columns, of_vectors = 3 * l->vectors;
    if (n < FLAP_EDGES)
        return (n / 3 + 1) * columns - 3 + n % 3;
    n -= FLAP_EDGES;
    return n / of_vectors * columns + n % of_vectors;
}

/// The weight's first column for the features of a corner.
static size_t feature_column(const layer *l, size_t corner)
{
    return corner * l->state->columns + 3 * l->vectors;
}

/// Split the weight into its parts.
static void part_weight(const layer *l)
{
    size_t numbers = l->coordinates->rows, features = feature_count(l);
    for (size_t o = 0; o < l->outputs; o++)
    {
        const real *row = l->weight->value + o * l->weight->columns;
        for (size_t n = 0; n < numbers; n++)
            l->of_local[o * numbers + n] = row[local_column(l, n)];
        for (size_t c = 0; c < 4; c++)
            memcpy(l->of_features + (c * l->outputs + o) * features, row + feature_column(l, c), features * sizeof *row);
    }
}

/// Add the gradients of its parts to the weight's.
static void join_weight(const layer *l, const real *of_local, const real *of_features)
{
    size_t numbers = l->coordinates->rows, features = feature_count(l);
    real *gradient = learn_gradient(l->weight);
    for (size_t o = 0; o < l->outputs; o++)
    {
        real *row = gradient + o * l->weight->columns;
        for (size_t n = 0; n < numbers; n++)
            row[local_column(l, n)] += of_local[o * numbers + n];
        for (size_t c = 0; c < 4 && features > 0; c++)
            add_row(features, 1, of_features + (c * l->outputs + o) * features, row + feature_column(l, c));
    }
}

/// y_f = b + the products of the corners
LANES_CLONES
static void gather_products(const mesh_flaps *flaps, size_t outputs, const real *restrict products,
                            const real *restrict bias, real *restrict y)
{
    for (size_t f = 0; f < flaps->count; f++, y += outputs)
    {
        const uint32_t *corner = flaps->flap[f].corner;
        const real *i = products + 4 * outputs * corner[0], *j = products + outputs * (4 * (size_t)corner[1] + 1);
        const real *k = products + outputs * (4 * (size_t)corner[2] + 2),
                   *l = products + outputs * (4 * (size_t)corner[3] + 3);
        for (size_t o = 0; o < outputs; o++)
            y[o] = bias[o] + ((i[o] + j[o]) + (k[o] + l[o]));
    }
}

LANES_CLONES
static void scatter_products(const mesh_flaps *flaps, size_t outputs, const real *restrict y, real *restrict products)
{
    for (size_t f = 0; f < flaps->count; f++, y += outputs)
        for (size_t c = 0; c < 4; c++)
            add_row(outputs, 1, y, products + outputs * (4 * (size_t)flaps->flap[f].corner[c] + c));
}

LANES_CLONES
static void repeat_row(size_t rows, size_t columns, const real *restrict row, real *restrict y)
{
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
            y[r * columns + c] = row[c];
}

LANES_CLONES
static void rectify(size_t count, real *y)
{
    for (size_t i = 0; i < count; i++)
        y[i] = y[i] > 0 ? y[i] : 0;
}

LANES_CLONES
static void rectify_back(size_t count, const real *restrict y, real *restrict gradient)
{
    for (size_t i = 0; i < count; i++)
        gradient[i] = y[i] > 0 ? gradient[i] : 0;
}

LANES_CLONES
static void add_column_sums(size_t rows, size_t columns, const real *restrict x, real *restrict sums)
{
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
            sums[c] += x[r * columns + c];
}

/// @param products room for vertex_count x 4 outputs
static void layer_forward(const layer *l, real *products)
{
    int count = (int)l->flaps->count, outputs = (int)l->outputs, numbers = (int)l->coordinates->rows;
    int vertices = (int)l->state->rows, columns = (int)l->state->columns, features = (int)feature_count(l);
    const real *of_vertices = l->state->value + 3 + 3 * l->vectors;
    real *y = l->y->value;
    if (features > 0)
    {
        REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasTrans, vertices, 4 * outputs, features, 1, of_vertices, columns,
                  l->of_features, features, 0, products, 4 * outputs);
        gather_products(l->flaps, l->outputs, products, l->bias->value, y);
    }
    else
        repeat_row(l->flaps->count, l->outputs, l->bias->value, y);
    REAL_GEMM(CblasRowMajor, CblasTrans, CblasTrans, count, outputs, numbers, 1, l->coordinates->value, count, l->of_local,
              numbers, 1, y, outputs);
    rectify(learn_size(l->y), y);
}

/// The part of the features. `products` receives the gradient by the vertices' products.
static void features_back(const layer *l, const real *dy, real *products, real *of_features)
{
    int outputs = 4 * (int)l->outputs, features = (int)feature_count(l);
    int vertices = (int)l->state->rows, columns = (int)l->state->columns;
    memset(products, 0, l->state->rows * 4 * l->outputs * sizeof *products);
    scatter_products(l->flaps, l->outputs, dy, products);
    REAL_GEMM(CblasRowMajor, CblasTrans, CblasNoTrans, outputs, features, vertices, 1, products, outputs,
              l->state->value + 3 + 3 * l->vectors, columns, 0, of_features, features);
    if (learn_wants(l->state))
        REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasNoTrans, vertices, features, outputs, 1, products, outputs,
                  l->of_features, features, 1, learn_gradient(l->state) + 3 + 3 * l->vectors, columns);
}

typedef struct layer_context
{
    layer layer;
    real *products;               ///< vertex_count x 4 outputs
    real *of_local, *of_features; ///< gradients of the weight's parts
} layer_context;

static void layer_back(void *context)
{
    const layer_context *c = context;
    const layer *l = &c->layer;
    int count = (int)l->flaps->count, outputs = (int)l->outputs, numbers = (int)l->coordinates->rows;
    real *dy = l->y->gradient;
    rectify_back(learn_size(l->y), l->y->value, dy);
    if (learn_wants(l->weight))
        REAL_GEMM(CblasRowMajor, CblasTrans, CblasTrans, outputs, numbers, count, 1, dy, outputs, l->coordinates->value,
                  count, 0, c->of_local, numbers);
    if (feature_count(l) > 0)
        features_back(l, dy, c->products, c->of_features);
    if (learn_wants(l->weight))
        join_weight(l, c->of_local, c->of_features);
    if (learn_wants(l->bias))
        add_column_sums(l->flaps->count, l->outputs, dy, learn_gradient(l->bias));
    if (learn_wants(l->coordinates))
        REAL_GEMM(CblasRowMajor, CblasTrans, CblasTrans, numbers, count, outputs, 1, l->of_local, numbers, dy, outputs, 1,
                  learn_gradient(l->coordinates), count);
}

learn_array *tape_flap_layer(learn_tape *tape, const tape_flap_local *local, learn_array *state, learn_array *weight,
                             learn_array *bias)
{
    const mesh_flaps *flaps = local->flaps;
    size_t outputs = weight->rows, features = state->columns - 3 - 3 * local->vectors;
    bool wants = learn_wants(weight) || learn_wants(bias) || learn_wants(state);
    learn_array *y = learn_array_make(tape, flaps->count, outputs, wants);
    layer_context c = {.products = learn_tape_memory(tape, flaps->vertex_count * 4 * outputs, sizeof(real)),
                       .of_local = learn_tape_memory(tape, outputs * local->coordinates->rows, sizeof(real)),
                       .of_features = learn_tape_memory(tape, 4 * outputs * features, sizeof(real)),
                       .layer = {flaps, local->vectors, outputs, local->coordinates, state, weight, bias, y,
                                 learn_tape_memory(tape, outputs * local->coordinates->rows, sizeof(real)),
                                 learn_tape_memory(tape, 4 * outputs * features, sizeof(real))}};
    if (tape->status != BAT_OK)
        return &tape->nothing;
    assert(weight->columns == 4 * state->columns - 3 && bias->columns == outputs);
    part_weight(&c.layer);
    layer_forward(&c.layer, c.products);
    record(tape, y, layer_back, &c, sizeof c);
    return y;
}

// Means of the outputs of half-flaps

typedef struct pooling
{
    tape_flap_local local;
    learn_array *output, *state, *next;
} pooling;

/// Add the first three outputs of half-flap f, rotated out of its frame, times `share`.
static inline void add_displacement(const tape_flap_local *local, size_t f, const real *output, real share, real *to)
{
    size_t count = local->flaps->count;
    const real *frame = local->frame->value + f;
    real unit = share * frame[FLAP_UNIT * count];
    for (size_t a = 0; a < 3; a++)
        to[a] +=
            unit * (output[0] * frame[a * count] + output[1] * frame[(3 + a) * count] + output[2] * frame[(6 + a) * count]);
}

static inline void displacement_back(const tape_flap_local *local, size_t f, const real *output, real share,
                                     const real *gradient, real *output_gradient)
{
    size_t count = local->flaps->count;
    const real *frame = local->frame->value + f;
    real unit = share * frame[FLAP_UNIT * count], along_all = 0;
    for (size_t b = 0; b < 3; b++)
    {
        real along = 0;
        for (size_t a = 0; a < 3; a++)
            along += gradient[a] * frame[(3 * b + a) * count];
        output_gradient[b] = unit * along;
        along_all += share * output[b] * along;
    }
    if (!learn_wants(local->frame))
        return;
    real *frame_gradient = learn_gradient(local->frame) + f;
    for (size_t b = 0; b < 3; b++)
        for (size_t a = 0; a < 3; a++)
            frame_gradient[(3 * b + a) * count] += unit * output[b] * gradient[a];
    frame_gradient[FLAP_UNIT * count] += along_all;
}

/// Gradient by the output of one half-flap. Its first three numbers go through the frame.
static inline void output_back(const pooling *p, size_t f, real share, const real *gradient, real *to)
{
    size_t columns = p->output->columns;
    real *row = to + f * columns, first[3];
    displacement_back(&p->local, f, p->output->value + f * columns, share, gradient, first);
    add_row(3, 1, first, row);
    add_row(columns - 3, share, gradient + 3, row + 3);
}

static void move_forward(const pooling *p)
{
    const mesh_flaps *flaps = p->local.flaps;
    size_t columns = p->output->columns;
    for (size_t v = 0; v < flaps->vertex_count; v++)
    {
        real *row = p->next->value + v * columns;
        uint32_t begin = flaps->first[v], end = flaps->first[v + 1];
        real share = begin < end ? 1 / (real)(end - begin) : 0;
        memset(row, 0, columns * sizeof *row);
        for (uint32_t f = begin; f < end; f++)
        {
            const real *output = p->output->value + f * columns;
            add_displacement(&p->local, f, output, share, row);
            add_row(columns - 3, share, output + 3, row + 3);
        }
        add_row(3, 1, p->state->value + v * p->state->columns, row);
    }
}

static void move_back(void *context)
{
    const pooling *p = context;
    const mesh_flaps *flaps = p->local.flaps;
    real *output = learn_gradient(p->output), *state = learn_wants(p->state) ? learn_gradient(p->state) : NULL;
    for (size_t v = 0; v < flaps->vertex_count; v++)
    {
        const real *gradient = p->next->gradient + v * p->output->columns;
        uint32_t begin = flaps->first[v], end = flaps->first[v + 1];
        for (uint32_t f = begin; f < end; f++)
            output_back(p, f, 1 / (real)(end - begin), gradient, output);
        if (state != NULL)
            add_row(3, 1, gradient, state + v * p->state->columns);
    }
}

static void insert_forward(const pooling *p)
{
    const mesh_flaps *flaps = p->local.flaps;
    size_t columns = p->output->columns;
    memcpy(p->next->value, p->state->value, learn_size(p->state) * sizeof(real));
    for (size_t e = 0; e < flaps->edge_count; e++)
    {
        real *row = p->next->value + (flaps->vertex_count + e) * columns;
        memset(row, 0, columns * sizeof *row);
        for (size_t side = 0; side < 2; side++)
        {
            uint32_t f = flaps->of_edge[e][side];
            const real *output = p->output->value + f * columns;
            add_displacement(&p->local, f, output, (real)0.5, row);
            add_row(columns - 3, (real)0.5, output + 3, row + 3);
            add_row(3, (real)0.5, p->state->value + flaps->flap[f].corner[0] * columns, row);
        }
    }
}

static void insert_back(void *context)
{
    const pooling *p = context;
    const mesh_flaps *flaps = p->local.flaps;
    size_t columns = p->output->columns;
    real *output = learn_gradient(p->output), *state = learn_wants(p->state) ? learn_gradient(p->state) : NULL;
    if (state != NULL)
        add_row(learn_size(p->state), 1, p->next->gradient, state);
    for (size_t e = 0; e < flaps->edge_count; e++)
    {
        const real *gradient = p->next->gradient + (flaps->vertex_count + e) * columns;
        for (size_t side = 0; side < 2; side++)
        {
            uint32_t f = flaps->of_edge[e][side];
            output_back(p, f, (real)0.5, gradient, output);
            if (state != NULL)
                add_row(3, (real)0.5, gradient, state + flaps->flap[f].corner[0] * columns);
        }
    }
}

static learn_array *pool(learn_tape *tape, pooling p, void (*forward)(const pooling *), learn_backward *backward)
{
    if (tape->status != BAT_OK)
        return &tape->nothing;
    assert(p.output->rows == p.local.flaps->count && p.output->columns >= 3);
    forward(&p);
    record(tape, p.next, backward, &p, sizeof p);
    return p.next;
}

learn_array *tape_flap_move(learn_tape *tape, const tape_flap_local *local, learn_array *output, learn_array *state)
{
    learn_array *next = learn_array_make(tape, local->flaps->vertex_count, output->columns, learn_wants(output));
    return pool(tape, (pooling){*local, output, state, next}, move_forward, move_back);
}

learn_array *tape_flap_insert(learn_tape *tape, const tape_flap_local *local, learn_array *output, learn_array *state)
{
    const mesh_flaps *flaps = local->flaps;
    assert(tape->status != BAT_OK || output->columns == state->columns);
    learn_array *next =
        learn_array_make(tape, flaps->vertex_count + flaps->edge_count, output->columns, learn_wants(output));
    return pool(tape, (pooling){*local, output, state, next}, insert_forward, insert_back);
}

// The network

void mesh_network_start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t p = 0; p < parameters->count; p++)
    {
        const learn_parameter *parameter = &parameters->list[p];
        // A bias follows its weight in the list.
        size_t inputs = parameter->rank == 2 ? parameter->columns : parameters->list[p - 1].columns;
        double bound = 1 / sqrt((double)inputs);
        real *values = learn_parameter_values(parameters, p);
        for (size_t i = 0; i < parameter->rows * parameter->columns; i++)
            values[i] = (real)(bound * (2 * bat_random_uniform(&random) - 1));
    }
}

/// The output of a module for all half-flaps.
static learn_array *evaluate(learn_tape *tape, mesh_module module, const tape_flap_local *local, learn_array *state)
{
    learn_array *parameters[MESH_MODULE_SIZE];
    for (size_t p = 0; p < MESH_MODULE_SIZE; p++)
        parameters[p] = learn_parameter_array(tape, (size_t)module * MESH_MODULE_SIZE + p);
    learn_array *x = tape_flap_layer(tape, local, state, parameters[0], parameters[1]);
    x = learn_linear_relu(tape, x, parameters[2], parameters[3]);
    return learn_linear(tape, x, parameters[4], parameters[5]);
}

void mesh_network_refine(learn_tape *tape, mesh_network_form form, const mesh_levels *levels, learn_array *positions,
                         learn_array **states)
{
    flap_frame_options view = {.fixed = form.fixed_frames, .relative = form.relative};
    learn_array *state = form.no_differences ? positions : tape_flap_differences(tape, &levels->level[0], positions);
    tape_flap_local local = tape_flap_localize(tape, &levels->level[0], view, state, form.no_differences ? 0 : 1);
    state = tape_flap_move(tape, &local, evaluate(tape, MESH_MODULE_INIT, &local, state), state);
    states[0] = state;
    for (size_t level = 0; level < levels->count; level++)
    {
        const mesh_flaps *flaps = &levels->level[level];
        local = tape_flap_localize(tape, flaps, view, state, 0);
        state = tape_flap_move(tape, &local, evaluate(tape, MESH_MODULE_VERTEX, &local, state), state);
        local = tape_flap_localize(tape, flaps, view, state, 0);
        state = tape_flap_insert(tape, &local, evaluate(tape, MESH_MODULE_EDGE, &local, state), state);
        states[level + 1] = state;
    }
}
