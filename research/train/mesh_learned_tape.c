#include "research/train/mesh_learned_tape.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"
#include "mesh/refine/level.h"
#include "research/learn/parameters.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum
{
    VK = LEARNED_VERTEX_CANDIDATES,
    EK = LEARNED_EDGE_CANDIDATES
};

// Weights

void mesh_learned_start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t p = 0; p < parameters->count; p++)
    {
        const learn_parameter *which = &parameters->list[p];
        size_t kind = p < LEARNED_POOL_WEIGHT ? p % LEARNED_LEVEL_PARAMETERS : LEARNED_LEVEL_PARAMETERS;
        bool last = kind == LEARNED_VERTEX_LAST || kind == LEARNED_EDGE_LAST || kind == LEARNED_RING_LAST;
        if (which->rank == 2)
            learn_parameter_fill_normal(parameters, p, (last ? 0.1 : 1) * sqrt(1.4 / (double)which->columns), &random);
    }
}

// Rows

bat_status learned_geometry_make(const mesh_flaps *flaps, const double *positions, learned_geometry *geometry,
                                 bat_error *error)
{
    size_t size = learned_geometry_size(flaps->vertex_count, flaps->edge_count);
    void *memory = memory_array(size, 1);
    if (memory == NULL)
        return error_memory(error, size);
    *geometry = learned_geometry_in(flaps, positions, 1, memory);
    return BAT_OK;
}

void learned_geometry_free(learned_geometry *geometry)
{
    free(geometry->umbrella); // the first of all
    *geometry = (learned_geometry){0};
}

bat_status mesh_learned_rows_make(const mesh_flaps *flaps, mesh_learned_rows *rows, bat_error *error)
{
    mesh_learned_rows made = {.memory = memory_array(3 * flaps->count + 4 * flaps->edge_count, sizeof *made.memory)};
    if (made.memory == NULL)
        return error_memory(error, flaps->count * 5 * sizeof *made.memory);
    for (size_t i = 0; i < 3; i++)
        made.flap[i] = made.memory + i * flaps->count;
    for (size_t i = 0; i < 4; i++)
        made.edge[i] = made.memory + 3 * flaps->count + i * flaps->edge_count;
    for (size_t f = 0; f < flaps->count; f++)
    {
        made.flap[0][f] = flaps->flap[f].corner[0];
        made.flap[1][f] = flaps->flap[f].corner[1];
        made.flap[2][f] = flaps->flap[f].edge;
    }
    for (size_t e = 0; e < flaps->edge_count; e++)
        for (size_t i = 0; i < 4; i++)
            made.edge[i][e] = flaps->flap[flaps->of_edge[e][0]].corner[i];
    *rows = made;
    return BAT_OK;
}

void mesh_learned_rows_free(mesh_learned_rows *rows)
{
    free(rows->memory);
    *rows = (mesh_learned_rows){0};
}

// max(0, the sum of gathered rows)

enum
{
    MAX_TERMS = 5
};

typedef struct row_sum
{
    learn_array *term[MAX_TERMS], *result;
    const uint32_t *index[MAX_TERMS]; ///< null: row r itself
    size_t count;
} row_sum;

static inline size_t row_of(const row_sum *s, size_t term, size_t r)
{
    return s->index[term] != NULL ? s->index[term][r] : r;
}

static void row_sum_back(void *context)
{
    const row_sum *s = context;
    size_t columns = s->result->columns;
    for (size_t t = 0; t < s->count; t++)
    {
        if (!learn_wants(s->term[t]))
            continue;
        real *to = learn_gradient(s->term[t]);
        for (size_t r = 0; r < s->result->rows; r++)
        {
            const real *value = s->result->value + r * columns, *gradient = s->result->gradient + r * columns;
            real *row = to + row_of(s, t, r) * columns;
            for (size_t c = 0; c < columns; c++)
                row[c] += value[c] > 0 ? gradient[c] : 0;
        }
    }
}

static learn_array *sum_rows(learn_tape *tape, size_t rows, size_t count, learn_array *const *terms,
                             const uint32_t *const *index)
{
    row_sum s = {.count = count};
    learn_array *result = learn_array_make(tape, rows, terms[0]->columns, true);
    row_sum *context = learn_tape_memory(tape, 1, sizeof *context);
    if (tape->status != BAT_OK)
        return result;
    for (size_t t = 0; t < count; t++)
    {
        s.term[t] = terms[t];
        s.index[t] = index[t];
    }
    s.result = result;
    size_t columns = result->columns;
    for (size_t r = 0; r < rows; r++)
    {
        real *row = result->value + r * columns;
        memcpy(row, terms[0]->value + row_of(&s, 0, r) * columns, columns * sizeof *row);
        for (size_t t = 1; t < count; t++)
        {
            const real *from = terms[t]->value + row_of(&s, t, r) * columns;
            for (size_t c = 0; c < columns; c++)
                row[c] += from[c];
        }
        for (size_t c = 0; c < columns; c++)
            row[c] = row[c] > 0 ? row[c] : 0;
    }
    *context = s;
    learn_tape_record(tape, result, row_sum_back, context);
    return result;
}

// Coefficients: middle + reach tanh(x), column by column

typedef struct bounded
{
    learn_array *x, *y;
    const learned_bound *bound;
} bounded;

static void bounded_back(void *context)
{
    const bounded *b = context;
    real *to = learn_gradient(b->x);
    size_t columns = b->x->columns;
    for (size_t i = 0; i < learn_size(b->x); i++)
    {
        const learned_bound *bound = &b->bound[i % columns];
        real t = (b->y->value[i] - bound->middle) / bound->reach;
        to[i] += b->y->gradient[i] * bound->reach * (1 - t * t);
    }
}

static learn_array *bound_columns(learn_tape *tape, learn_array *x, const learned_bound *bound)
{
    learn_array *y = learn_array_make(tape, x->rows, x->columns, true);
    bounded *context = learn_tape_memory(tape, 1, sizeof *context);
    if (tape->status != BAT_OK)
        return y;
    for (size_t i = 0; i < learn_size(x); i++)
        y->value[i] = bound[i % x->columns].middle + bound[i % x->columns].reach * real_tanh(x->value[i]);
    *context = (bounded){x, y, bound};
    learn_tape_record(tape, y, bounded_back, context);
    return y;
}

// New positions

typedef struct composition
{
    const mesh_flaps *flaps;
    const learned_geometry *geometry;
    learn_array *positions, *ring, *vertex, *edge, *result;
    double (*sums)[LEARNED_RINGS][3]; ///< vertices: the ring sums
    double reach;                     ///< of moves
} composition;

static const double *place(const composition *p, uint32_t vertex)
{
    return p->geometry->positions + 3 * (size_t)vertex;
}

static bool edge_is_learned(const mesh_flaps *flaps, size_t e)
{
    return flaps->flap[flaps->of_edge[e][0]].missing == MESH_FLAP_WHOLE;
}

static void edge_ring(const composition *p, size_t e, double ring[3])
{
    const uint32_t *corner = p->flaps->flap[p->flaps->of_edge[e][0]].corner;
    for (int c = 0; c < 3; c++)
        ring[c] = 0.5 * (p->sums[corner[0]][1][c] + p->sums[corner[1]][1][c]);
}

static void add_sums(const composition *p)
{
    for (size_t f = 0; f < p->flaps->count; f++)
    {
        const uint32_t *corner = p->flaps->flap[f].corner;
        const double *v = place(p, corner[0]), *w = place(p, corner[1]);
        for (size_t k = 0; k < LEARNED_RINGS; k++)
            for (int c = 0; c < 3; c++)
                p->sums[corner[0]][k][c] +=
                    LEARNED_RING_SHARE * (double)p->ring->value[f * LEARNED_RINGS + k] * (w[c] - v[c]);
    }
}

/// The sum of candidates times coefficients.
static void sum_move(size_t count, const double candidate[][3], const real *coefficient, double move[3])
{
    memset(move, 0, 3 * sizeof *move);
    for (size_t k = 0; k < count; k++)
        for (int c = 0; c < 3; c++)
            move[c] += (double)coefficient[k] * candidate[k][c];
}

static double factor_of(const composition *p, const double move[3], double size)
{
    double factor;
    learned_move_factors(1, p->reach, (const double(*)[3])move, &size, &factor);
    return factor;
}

static void compose(const composition *p)
{
    size_t vertices = p->flaps->vertex_count;
    real *to = p->result->value;
    for (size_t v = 0; v < vertices; v++, to += 3)
    {
        double candidate[VK][3], move[3];
        learned_vertex_candidates(p->geometry, v, p->sums[v][0], candidate);
        sum_move(VK, (const double(*)[3])candidate, p->vertex->value + v * VK, move);
        double factor = learned_at_boundary(p->flaps, v) ? 0 : factor_of(p, move, p->geometry->size[v]);
        for (int c = 0; c < 3; c++)
            to[c] = (real)(place(p, (uint32_t)v)[c] + factor * move[c]);
    }
    for (size_t e = 0; e < p->flaps->edge_count; e++, to += 3)
    {
        double candidate[EK][3], ring[3], point[3], move[3];
        const uint32_t *corner = p->flaps->flap[p->flaps->of_edge[e][0]].corner;
        if (edge_is_learned(p->flaps, e))
        {
            edge_ring(p, e, ring);
            learned_edge_candidates(p->geometry, e, ring, candidate);
            sum_move(EK, (const double(*)[3])candidate, p->edge->value + e * EK, move);
            double factor = factor_of(p, move, learned_edge_size(p->geometry, e));
            for (int c = 0; c < 3; c++)
                point[c] = 0.5 * (place(p, corner[0])[c] + place(p, corner[1])[c]) + factor * move[c];
        }
        else
            learned_boundary_point(p->flaps, p->geometry->positions, e, point);
        for (int c = 0; c < 3; c++)
            to[c] = (real)point[c];
    }
}

/// The gradients with respect to what the candidates are made of.
typedef struct vector_gradients
{
    double (*position)[3], (*umbrella)[3], (*second)[3];
    double (*sums)[LEARNED_RINGS][3];
} vector_gradients;

static void add3(double *to, double factor, const double *vector)
{
    for (int c = 0; c < 3; c++)
        to[c] += factor * vector[c];
}

/// full g + normal n (n.g)
static void mix(double full, double normal, const double g[3], const double n[3], double result[3])
{
    double height = normal * vector3_dot(n, g);
    for (int c = 0; c < 3; c++)
        result[c] = full * g[c] + height * n[c];
}

/// From the gradient with respect to a bounded move to that with respect to the move. The size counts as constant.
static void bound_back(const composition *p, const double move[3], double size, double g[3])
{
    double reach = p->reach * size, square = vector3_dot(move, move), factor = factor_of(p, move, size);
    if (!(square > 0))
        return;
    double fourth = factor * factor * factor * factor, r2 = square / (reach * reach);
    double along = vector3_dot(move, g) * r2 * r2 * fourth / square;
    for (int c = 0; c < 3; c++)
        g[c] = factor * (g[c] - along * move[c]);
}

static void vertices_back(const composition *p, const vector_gradients *to)
{
    const real *gradient = p->result->gradient;
    real *coefficient = learn_gradient(p->vertex);
    for (size_t v = 0; v < p->flaps->vertex_count; v++, gradient += 3)
    {
        double g[3] = {(double)gradient[0], (double)gradient[1], (double)gradient[2]}, candidate[VK][3], own[3];
        add3(to->position[v], 1, g);
        if (learned_at_boundary(p->flaps, v))
            continue;
        learned_vertex_candidates(p->geometry, v, p->sums[v][0], candidate);
        const real *c = p->vertex->value + v * VK;
        sum_move(VK, (const double(*)[3])candidate, c, own);
        bound_back(p, own, p->geometry->size[v], g);
        const double *n = p->geometry->vertex_normal[v];
        for (size_t k = 0; k < VK; k++)
            coefficient[v * VK + k] += (real)vector3_dot(g, candidate[k]);
        mix((double)c[0], (double)c[1], g, n, own);
        add3(to->umbrella[v], 1, own);
        mix((double)c[2], (double)c[3], g, n, own);
        add3(to->second[v], 1, own);
        mix((double)c[4], (double)c[5], g, n, own);
        add3(to->sums[v][0], 1, own);
    }
}

/// The gradient of a star passes to the rings of the edge's ends that are not on the boundary.
static void star_back(const composition *p, const vector_gradients *to, size_t e, const double g[3])
{
    const mesh_flap *flap = p->flaps->flap;
    const uint32_t *pair = p->flaps->of_edge[e], *corner = flap[pair[0]].corner;
    bool at_boundary[2] = {learned_at_boundary(p->flaps, corner[0]), learned_at_boundary(p->flaps, corner[1])};
    for (int end = 0; end < 2; end++)
    {
        if (at_boundary[end])
            continue;
        uint32_t v = corner[end], begin = p->flaps->first[v], stop = p->flaps->first[v + 1], f = pair[end];
        double share = at_boundary[1 - end] ? 1 : 0.5;
        unsigned j = 0;
        do
        {
            double weight = share * butterfly_weight(stop - begin, j);
            add3(to->position[flap[f].corner[1]], weight, g);
            add3(to->position[v], -weight, g);
            f = f + 1 == stop ? begin : f + 1;
            j++;
        } while (f != pair[end]);
    }
    if (at_boundary[0] != at_boundary[1])
    {
        double sign = at_boundary[0] ? 0.5 : -0.5;
        add3(to->position[corner[1]], sign, g);
        add3(to->position[corner[0]], -sign, g);
    }
}

static void boundary_back(const composition *p, const vector_gradients *to, size_t e, const double g[3])
{
    const mesh_flaps *flaps = p->flaps;
    const uint32_t *corner = flaps->flap[flaps->of_edge[e][0]].corner;
    for (int end = 0; end < 2; end++)
    {
        uint32_t v = corner[end], other = corner[1 - end];
        uint32_t a = flaps->flap[flaps->first[v]].corner[1], b = flaps->flap[flaps->first[v + 1] - 1].corner[1];
        add3(to->position[v], 9.0 / 16, g);
        add3(to->position[a == other ? b : a], -1.0 / 16, g);
    }
}

static void edges_back(const composition *p, const vector_gradients *to)
{
    const real *gradient = p->result->gradient + 3 * p->flaps->vertex_count;
    real *coefficient = learn_gradient(p->edge);
    for (size_t e = 0; e < p->flaps->edge_count; e++, gradient += 3)
    {
        double g[3] = {(double)gradient[0], (double)gradient[1], (double)gradient[2]}, candidate[EK][3], ring[3], own[3];
        if (!edge_is_learned(p->flaps, e))
        {
            boundary_back(p, to, e, g);
            continue;
        }
        const uint32_t *corner = p->flaps->flap[p->flaps->of_edge[e][0]].corner;
        edge_ring(p, e, ring);
        learned_edge_candidates(p->geometry, e, ring, candidate);
        const real *c = p->edge->value + e * EK;
        const double *n = p->geometry->edge_normal[e];
        for (int end = 0; end < 2; end++)
            add3(to->position[corner[end]], 0.5, g);
        sum_move(EK, (const double(*)[3])candidate, c, own);
        bound_back(p, own, learned_edge_size(p->geometry, e), g);
        for (size_t k = 0; k < EK; k++)
            coefficient[e * EK + k] += (real)vector3_dot(g, candidate[k]);
        mix((double)c[0], (double)c[4], g, n, own);
        star_back(p, to, e, own);
        mix((double)c[1], (double)c[5], g, n, own);
        for (int end = 0; end < 2; end++)
        {
            add3(to->position[corner[end]], -0.5, own);
            add3(to->position[corner[2 + end]], 0.5, own);
        }
        mix((double)c[2], (double)c[6], g, n, own);
        for (int end = 0; end < 2; end++)
            add3(to->umbrella[corner[end]], 0.5, own);
        mix((double)c[3], (double)c[7], g, n, own);
        for (int end = 0; end < 2; end++)
            add3(to->sums[corner[end]][1], 0.5, own);
        mix(0, (double)c[8], g, n, own);
        for (int end = 0; end < 2; end++)
            add3(to->umbrella[corner[2 + end]], 0.5, own);
    }
}

static void rings_back(const composition *p, const vector_gradients *to)
{
    const mesh_flaps *flaps = p->flaps;
    real *ring = learn_gradient(p->ring);
    for (size_t f = 0; f < flaps->count; f++)
    {
        const uint32_t *corner = flaps->flap[f].corner;
        double share = 1 / (double)(flaps->first[corner[0] + 1] - flaps->first[corner[0]]), edge[3];
        vector3_subtract(place(p, corner[1]), place(p, corner[0]), edge);
        for (size_t k = 0; k < LEARNED_RINGS; k++)
        {
            const double *g = to->sums[corner[0]][k];
            double weight = LEARNED_RING_SHARE * (double)p->ring->value[f * LEARNED_RINGS + k];
            ring[f * LEARNED_RINGS + k] += (real)(LEARNED_RING_SHARE * vector3_dot(g, edge));
            add3(to->position[corner[1]], weight, g);
            add3(to->position[corner[0]], -weight, g);
        }
        add3(to->umbrella[corner[1]], share, to->second[corner[0]]);
    }
    for (size_t f = 0; f < flaps->count; f++)
    {
        const uint32_t *corner = flaps->flap[f].corner;
        double share = 1 / (double)(flaps->first[corner[0] + 1] - flaps->first[corner[0]]);
        add3(to->position[corner[1]], share, to->umbrella[corner[0]]);
        add3(to->position[corner[0]], -share, to->umbrella[corner[0]]);
    }
}

static void composition_back(void *context)
{
    const composition *p = context;
    size_t vertices = p->flaps->vertex_count;
    double(*memory)[3] = (double(*)[3])(p->sums + vertices);
    vector_gradients to = {memory, memory + vertices, memory + 2 * vertices,
                           (double(*)[LEARNED_RINGS][3])(memory + 3 * vertices)};
    memset(memory, 0, (3 + LEARNED_RINGS) * vertices * sizeof *memory);
    vertices_back(p, &to);
    edges_back(p, &to);
    rings_back(p, &to);
    if (!learn_wants(p->positions))
        return;
    real *gradient = learn_gradient(p->positions);
    for (size_t i = 0; i < 3 * vertices; i++)
        gradient[i] += (real)(&to.position[0][0])[i];
}

/// The positions of the next level.
static learn_array *compose_level(learn_tape *tape, const mesh_flaps *flaps, const learned_geometry *geometry,
                                  learn_array *positions, learn_array *ring, learn_array *vertex, learn_array *edge,
                                  double fairness)
{
    size_t vertices = flaps->vertex_count;
    learn_array *result = learn_array_make(tape, vertices + flaps->edge_count, 3, true);
    composition *p = learn_tape_memory(tape, 1, sizeof *p);
    // Ring sums, then the memory of the backward pass.
    double *memory = learn_tape_memory(tape, vertices, (2 * LEARNED_RINGS + 3) * 3 * sizeof *memory);
    if (tape->status != BAT_OK)
        return result;
    *p = (composition){flaps,
                       geometry,
                       positions,
                       ring,
                       vertex,
                       edge,
                       result,
                       (double(*)[LEARNED_RINGS][3])memory,
                       learned_reach(fairness)};
    memset(memory, 0, vertices * LEARNED_RINGS * 3 * sizeof *memory);
    add_sums(p);
    compose(p);
    learn_tape_record(tape, result, composition_back, p);
    return result;
}

// The network

static learn_array *parameter(learn_tape *tape, size_t level, learned_parameter which)
{
    return learn_parameter_array(tape, learned_parameter_of(level, which));
}

static learn_array *linear(learn_tape *tape, size_t level, learn_array *x, learned_parameter weight, bool biased)
{
    return learn_linear(tape, x, parameter(tape, level, weight),
                        biased ? parameter(tape, level, (learned_parameter)(weight + 1)) : NULL);
}

/// Context times weight, plus a bias: 1 x LEARNED_WIDTH.
static learn_array *context_bias(learn_tape *tape, size_t level, learn_array *context, learned_parameter weight,
                                 learned_parameter bias)
{
    return learn_linear(tape, context, parameter(tape, level, weight), parameter(tape, level, bias));
}

static learn_array *pool(learn_tape *tape, learn_array *state, learn_array *message, double fairness)
{
    uint32_t *ends = learn_tape_memory(tape, 2, sizeof *ends);
    if (ends == NULL)
        return &tape->nothing;
    ends[0] = 0;
    ends[1] = (uint32_t)state->rows;
    learn_array *means[2] = {learn_segment_mean(tape, state, ends, NULL, 1),
                             learn_segment_mean(tape, message, ends, NULL, 1)};
    const real given[2] = {(real)fairness, (real)(fairness * fairness)};
    learn_array *parts[2] = {learn_linear_relu(tape, learn_concatenate_columns(tape, means, 2),
                                               learn_parameter_array(tape, LEARNED_POOL_WEIGHT),
                                               learn_parameter_array(tape, LEARNED_POOL_BIAS)),
                             learn_constant(tape, 1, 2, given)};
    return learn_concatenate_columns(tape, parts, 2);
}

static learn_array *vertex_inputs(learn_tape *tape, const learned_geometry *geometry, size_t old)
{
    learn_array *inputs = learn_array_make(tape, geometry->flaps->vertex_count, LEARNED_VERTEX_INPUTS, false);
    for (size_t v = 0; v < inputs->rows; v++)
        learned_vertex_inputs(geometry, old, v, inputs->value + v * LEARNED_VERTEX_INPUTS);
    return inputs;
}

learn_array *mesh_learned_level(learn_tape *tape, size_t level, const mesh_flaps *flaps, const mesh_learned_rows *rows,
                                const learned_geometry *geometry, size_t old, learn_array *positions, double fairness,
                                learn_array **state, learn_array **context)
{
    if (tape->status != BAT_OK)
        return &tape->nothing;
    learn_array *inputs[2] = {vertex_inputs(tape, geometry, old), *state};
    learn_array *x = learn_constant(tape, flaps->edge_count, LEARNED_EDGE_FEATURES, geometry->edge_features);
    learn_array *in = *state != NULL ? learn_concatenate_columns(tape, inputs, 2) : inputs[0];
    learn_array *s = learn_linear_relu(tape, in, parameter(tape, level, LEARNED_VERTEX_IN),
                                       parameter(tape, level, LEARNED_VERTEX_IN_BIAS));
    s = learn_linear_relu(tape, s, parameter(tape, level, LEARNED_VERTEX_HIDDEN),
                          parameter(tape, level, LEARNED_VERTEX_HIDDEN_BIAS));
    learn_array *terms[MAX_TERMS] = {linear(tape, level, s, LEARNED_MESSAGE_SELF, true),
                                     linear(tape, level, s, LEARNED_MESSAGE_RING, false),
                                     linear(tape, level, x, LEARNED_MESSAGE_EDGE, false)};
    const uint32_t *index[MAX_TERMS] = {rows->flap[0], rows->flap[1], rows->flap[2]};
    learn_array *message = sum_rows(tape, flaps->count, 3, terms, index);
    learn_array *ring = learn_tanh(tape, linear(tape, level, message, LEARNED_RING_LAST, true));
    learn_array *mean = learn_segment_mean(tape, message, flaps->first, NULL, flaps->vertex_count);
    if (*context == NULL)
        *context = pool(tape, s, mean, fairness);
    learn_array *bias = context_bias(tape, level, *context, LEARNED_CONTEXT_UPDATE, LEARNED_UPDATE_BIAS);
    learn_array *update[2] = {learn_linear(tape, s, parameter(tape, level, LEARNED_UPDATE_SELF), bias),
                              linear(tape, level, mean, LEARNED_UPDATE_MESSAGE, false)};
    s = learn_relu(tape, learn_add(tape, update[0], update[1]));
    bias = context_bias(tape, level, *context, LEARNED_CONTEXT_VERTEX, LEARNED_VERTEX_OUT_BIAS);
    learn_array *out = learn_linear_relu(tape, s, parameter(tape, level, LEARNED_VERTEX_OUT), bias);
    learn_array *vertex = bound_columns(tape, linear(tape, level, out, LEARNED_VERTEX_LAST, true), learned_vertex_bound);
    learn_array *end = linear(tape, level, s, LEARNED_EDGE_END, false),
                *opposite = linear(tape, level, s, LEARNED_EDGE_OPPOSITE, false);
    bias = context_bias(tape, level, *context, LEARNED_CONTEXT_EDGE, LEARNED_EDGE_OWN_BIAS);
    learn_array *parts[MAX_TERMS] = {end, end, opposite, opposite,
                                     learn_linear(tape, x, parameter(tape, level, LEARNED_EDGE_OWN), bias)};
    const uint32_t *corners[MAX_TERMS] = {rows->edge[0], rows->edge[1], rows->edge[2], rows->edge[3], NULL};
    learn_array *hidden = sum_rows(tape, flaps->edge_count, 5, parts, corners);
    hidden = learn_linear_relu(tape, hidden, parameter(tape, level, LEARNED_EDGE_HIDDEN),
                               parameter(tape, level, LEARNED_EDGE_HIDDEN_BIAS));
    learn_array *edge = bound_columns(tape, linear(tape, level, hidden, LEARNED_EDGE_LAST, true), learned_edge_bound);
    learn_array *states[2] = {s, hidden};
    *state = level + 1 < LEARNED_LEVELS_OF_MESH ? learn_concatenate_rows(tape, states, 2) : NULL;
    return compose_level(tape, flaps, geometry, positions, ring, vertex, edge, fairness);
}

/// The geometry of a level that the tape has made; it lives as long as the step. Null after a failure.
static const learned_geometry *geometry_of(learn_tape *tape, const mesh_flaps *flaps, const learn_array *positions)
{
    double *copy = learn_tape_memory(tape, learn_size(positions), sizeof *copy);
    void *memory = learn_tape_memory(tape, learned_geometry_size(flaps->vertex_count, flaps->edge_count), 1);
    learned_geometry *made = learn_tape_memory(tape, 1, sizeof *made);
    if (tape->status != BAT_OK)
        return NULL;
    for (size_t i = 0; i < learn_size(positions); i++)
        copy[i] = (double)positions->value[i];
    *made = learned_geometry_in(flaps, copy, 1, memory);
    return made;
}

learn_array *mesh_learned_refine(learn_tape *tape, const mesh_learned_input *input, double fairness)
{
    const mesh_flaps *flaps = input->levels->level;
    size_t count = flaps[0].vertex_count;
    real *given = learn_tape_memory(tape, 3 * count, sizeof *given);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    for (size_t i = 0; i < 3 * count; i++)
        given[i] = (real)input->positions[i];
    learn_array *positions = learn_constant(tape, count, 3, given), *state = NULL, *context = NULL;
    positions =
        mesh_learned_level(tape, 0, &flaps[0], &input->rows[0], input->geometry, 0, positions, fairness, &state, &context);
    const learned_geometry *geometry = tape->status == BAT_OK ? geometry_of(tape, &flaps[1], positions) : NULL;
    if (geometry == NULL)
        return &tape->nothing;
    return mesh_learned_level(tape, 1, &flaps[1], &input->rows[1], geometry, count, positions, fairness, &state, &context);
}
