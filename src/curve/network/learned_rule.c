#include "curve/network/learned_network.h"

#include "base/choice.h"
#include "learn/packed.h"
#include "learn/weights.h"
#include "space/builtin.h"

#include <assert.h>
#include <stdio.h>

// The network of learned_network.h for inference: no tape, no allocation. Weights are in the layout of their file.

/// Edges that go through the network together.
#define LEARNED_ROWS (8 * LEARN_TILE)

/// One call's memory; aligned to 64 bytes.
typedef struct learned_scratch
{
    _Alignas(64) real x[LEARNED_ROWS * LEARNED_WIDTH];
    real inner[LEARNED_ROWS * LEARNED_WIDTH], next[LEARNED_ROWS * LEARNED_WIDTH];
    real features[LEARNED_ROWS * LEARNED_FEATURES];
    learned_edge edges[LEARNED_ROWS];
    learned_logs logs[LEARNED_ROWS + 2 * LEARNED_RANGE];
} learned_scratch;

static const char *const BLOCK_NAMES[KLEIN_COUNT] = {"kept", "second", "first", "both"};

static void add_layer(learn_parameters *parameters, size_t layer, klein_widths in)
{
    char name[LEARN_NAME_SIZE];
    for (size_t k = 0; k < KLEIN_COUNT; k++)
    {
        (void)snprintf(name, sizeof name, "layer.%zu.%s", layer, BLOCK_NAMES[k]);
        (void)learn_parameters_add(parameters, in.of[k], LEARNED_CHANNELS, name);
    }
    (void)snprintf(name, sizeof name, "layer.%zu.bias", layer);
    (void)learn_parameters_add(parameters, 0, LEARNED_CHANNELS, name);
}

bat_status learned_network_make(learn_parameters *parameters, bat_error *error)
{
    for (size_t layer = 0; layer < LEARNED_LAYERS; layer++)
        add_layer(parameters, layer, layer == 0 ? learned_widths() : klein_equal(LEARNED_CHANNELS));
    (void)learn_parameters_add(parameters, 1, LEARNED_CHANNELS, "output.first");
    (void)learn_parameters_add(parameters, 1, LEARNED_CHANNELS, "output.kept");
    bat_status status = learn_parameters_allocate(parameters, error);
    assert(status != BAT_OK || parameters->count == LEARNED_PARAMETERS);
    return status;
}

enum
{
    C = LEARNED_CHANNELS,
    FIRST_LAYER = LEARNED_FEATURES * C + C, ///< numbers of a layer: its four weights and its bias
    OTHER_LAYER = LEARNED_WIDTH * C + C,
    OUTPUT_AT = FIRST_LAYER + (LEARNED_LAYERS - 1) * OTHER_LAYER,
};

_Static_assert(LEARNED_CHANNELS % LEARN_PANEL == 0, "a block is whole panels");

/// A layer's block k: inputs x C. In these arrays a block's rows lie together, `rows` x C, and block behind block.
static void linear(const real *weights, klein_widths in, size_t rows, const real *x, size_t stride, bool blocks, bool adds,
                   real *y)
{
    static const real ZEROS[C];
    const real *bias = weights + klein_total(in) * C;
    for (size_t k = 0; k < KLEIN_COUNT; k++)
    {
        learn_packed layer = learn_packed_plain(in.of[k], C, weights, k == KLEIN_KEPT ? bias : ZEROS);
        layer.adds = adds;
        learn_packed_linear(&layer, rows, x, stride, y + k * rows * C);
        weights += in.of[k] * C;
        x += blocks ? rows * C : in.of[k];
    }
}

/// Whole tiles of rows. Returns the input of the output layer: for each block rows x C.
static const real *forward(const real *weights, size_t rows, learned_scratch *s)
{
    real *x = s->x, *inner = s->inner, *next = s->next;
    linear(weights, learned_widths(), rows, s->features, LEARNED_FEATURES, false, false, inner);
    learn_packed_klein_gelu(rows * C, inner, x);
    weights += FIRST_LAYER;
    for (size_t block = 0; block < LEARNED_BLOCKS; block++, weights += 2 * OTHER_LAYER)
    {
        linear(weights, klein_equal(C), rows, x, C, true, false, inner);
        learn_packed_klein_gelu(rows * C, inner, next);
        linear(weights + OTHER_LAYER, klein_equal(C), rows, next, C, true, true, x);
    }
    learn_packed_klein_gelu(rows * C, x, next);
    return next;
}

/// The outputs of a tile of rows, correction and gate, from two blocks of the last layer's input.
static void outputs(const real *weights, const real *first, const real *kept, double *corrections, double *gates)
{
    double sums[2][LEARN_TILE] = {{0}};
    for (size_t c = 0; c < C; c++)
        for (size_t r = 0; r < LEARN_TILE; r++)
        {
            sums[0][r] += (double)weights[c] * (double)first[r * C + c];
            sums[1][r] += (double)weights[C + c] * (double)kept[r * C + c];
        }
    memcpy(corrections, sums[0], sizeof sums[0]);
    memcpy(gates, sums[1], sizeof sums[1]);
}

/// The insertion angles of `count` edges, positive to the left. Where weights are so large that numbers overflow on the way,
/// the angle is that of the six-point rule.
/// @param weights  the values of learned_network_make()'s parameters, in order
/// @param angles   angles[j + i] is that of vertex i of edge j (learned_features_of()), lengths likewise
/// @param begin    the setting of edge 0; the parity alternates
/// @param chosen   receives `count` angles; not limited to the admissible ones
static void learned_inference_angles(const real *weights, size_t count, const double *angles, const double *lengths,
                                     learned_setting begin, bool brakes, double *chosen, learned_scratch *scratch)
{
    // At fairness 1 rough lines lose nothing.
    const double parity = begin.parity, wanted = fmin((1 - begin.fairness) / 0.75, 1);
    for (size_t done = 0; done < count; done += LEARNED_ROWS)
    {
        size_t rows = count - done < LEARNED_ROWS ? count - done : LEARNED_ROWS, whole = learn_whole_tiles(rows);
        memset(scratch->features + rows * LEARNED_FEATURES, 0, (whole - rows) * LEARNED_FEATURES * sizeof(real));
        learned_logs_of(angles + done, lengths + done, rows, begin.level == 0, scratch->logs);
        for (size_t r = 0; r < rows; r++)
        {
            double features[LEARNED_FEATURES];
            size_t j = done + r;
            begin.parity = j % 2 == 0 ? parity : -parity;
            scratch->edges[r] =
                learned_features_of(angles + j, lengths + j, begin, scratch->logs + LEARNED_RANGE - 1 + r, features);
            for (size_t i = 0; i < LEARNED_FEATURES; i++)
                scratch->features[r * LEARNED_FEATURES + i] = (real)features[i];
        }
        const real *last = forward(weights, whole, scratch);
        const real *kept = last + KLEIN_KEPT * whole * C, *first = last + KLEIN_FIRST * whole * C;
        double corrections[LEARNED_ROWS], gates[LEARNED_ROWS];
        for (size_t r = 0; r < whole; r += LEARN_TILE)
            outputs(weights + OUTPUT_AT, first + r * C, kept + r * C, corrections + r, gates + r);
        for (size_t r = 0; r < rows; r++)
        {
            double angle = learned_angle(scratch->edges[r], corrections[r], gates[r]);
            if (brakes && begin.level == 0)
                angle = learned_braked(angles + done + r, scratch->logs + LEARNED_RANGE - 1 + r, wanted, angle);
            chosen[done + r] = isnan(angle) ? scratch->edges[r].base : angle;
        }
    }
}

const char *learned_rule_fault(const bat_curve_angle_rule *rule BAT_UNUSED, const bat_space *space)
{
    int curvature;
    return space_is_surface(space, &curvature) ? NULL : "the network knows the plane, the sphere and the disk";
}

static void angles_of(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, bool brakes, double *chosen,
                      void *scratch)
{
    const real *weights = rule->parameters != NULL ? rule->parameters : weights_learned.arrays[0].values;
    int curvature = 0;
    (void)space_is_surface(view->space, &curvature);
    bool even = view->first % 2 == 0;
    learned_setting begin = {.curvature = curvature,
                             .fairness = view->fairness,
                             .level = (double)view->level,
                             .parity = view->level == 0 ? 0
                                       : even           ? 1
                                                        : -1};
    learned_inference_angles(weights, view->count, view->angles, view->lengths, begin, brakes, chosen, scratch);
}

static void rule_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *chosen,
                        void *scratch)
{
    angles_of(rule, view, true, chosen, scratch);
}

/// The rule of the weights in its `parameters`, or of the shipped ones.
static const bat_curve_angle_rule RULE = {
    .name = "learned",
    .reach = LEARNED_RANGE,
    .levels = LEARNED_LEVELS,
    .scratch_size = sizeof(learned_scratch),
    .fault = learned_rule_fault,
    .angles = rule_angles,
};

/// The network alone, as trainings have it.
static void network_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *chosen,
                           void *scratch)
{
    angles_of(rule, view, false, chosen, scratch);
}

bat_curve_angle_rule learned_rule(const real *weights)
{
    bat_curve_angle_rule rule = RULE;
    rule.angles = network_angles;
    rule.parameters = weights;
    return rule;
}

static bat_status make(const learn_source *source BAT_UNUSED, learn_parameters *parameters, bat_error *error)
{
    return learned_network_make(parameters, error);
}

const learn_network curve_network_learned = {
    .array = "layer.0.kept",
    .rule = &RULE,
    .make = make,
    .pack = learn_model_copy,
    .free = free,
};

bat_curve_scheme bat_curve_scheme_learned(double fairness)
{
    bat_curve_scheme scheme = bat_curve_scheme_angle_rule(&RULE);
    scheme.fairness = fairness;
    return scheme;
}

struct bat_curve_model
{
    learn_model network;
    bat_curve_angle_rule rule;
    bool has_fairness;
};

static const learn_network *const NETWORKS[] = {&curve_network_learned};
const learn_networks curve_networks = {NETWORKS, 1, &weights_learned};

bat_status curve_model_read(const learn_networks *networks, const char *path, bat_curve_model **model, bat_error *error)
{
    learn_model *read = NULL;
    bat_status status = learn_model_read(networks, path, sizeof **model, &read, error);
    if (status != BAT_OK)
        return status;
    *model = (bat_curve_model *)read;
    (*model)->rule = *(const bat_curve_angle_rule *)read->kind->rule;
    (*model)->rule.parameters = read->network;
    (*model)->has_fairness = read->kind == &curve_network_learned;
    return BAT_OK;
}

bat_status bat_curve_model_read(const char *path, bat_curve_model **model, bat_error *error)
{
    return curve_model_read(&curve_networks, path, model, error);
}

static const bat_choice MODELS[] = {
    {.name = "learned", .summary = "the curve scheme that comes with the library, 134,720 weights; weights/batten.md"},
};
const bat_family bat_curve_model_family = FAMILY("curve model", MODELS);

bool bat_curve_model_has_fairness(const bat_curve_model *model)
{
    return model->has_fairness;
}

void bat_curve_model_free(bat_curve_model *model)
{
    learn_model_free((learn_model *)model);
}

bat_curve_scheme bat_curve_scheme_of_model(const bat_curve_model *model)
{
    bat_curve_scheme scheme = bat_curve_scheme_angle_rule(&model->rule);
    scheme.fairness = 0.25;
    return scheme;
}
