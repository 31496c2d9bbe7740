#include "research/train/curve_network_tape.h"

#include "batten/curve_scheme.h"
#include "research/learn/klein_layers.h"
#include "research/learn/operations.h"
#include "research/learn/parameters.h"
#include "research/train/learned_features_back.h"

#include <assert.h>

/// High enough to be near the largest angle, low enough to be smooth.
static const double ANGLE_POWER = 16;

/// Of the fairness in the logarithm of the roughness's weight.
static const double FAIRNESS_POWER = 1.25;
/// Added to the distance of classical schemes, in mean edges: below it, differences do not matter.
static const double DISTANCE_FLOOR = 0.004;
/// Added to the angle of classical schemes, for a polygon of 384 vertices; angles halve with every level.
static const double ANGLE_FLOOR = 0.02, ANGLE_FLOOR_COUNT = 384;

enum
{
    R = LEARNED_RANGE
};

// Features and angles

/// The features of all edges of a polygon.
typedef struct edge_features
{
    tape_polygon *polygon;
    learned_setting setting; ///< that of edge 0
    learn_array *features;   ///< edges x LEARNED_FEATURES; null for a classical step
    learned_edge *per_edge;
    learned_edge *gradient; ///< of the loss, with respect to per_edge
    /// Of the polygon continued beyond its ends; entry LEARNED_RANGE + i is that of the polygon's i.
    double *angles, *lengths;
} edge_features;

/// The source of entry i of the continued polygon. Reflection in an end exchanges the two sides of the end vertex, keeps
/// lengths and changes the angles' signs.
typedef struct source
{
    size_t index;
    double sign;
} source;

/// Vertex i of a polygon of `count` vertices, -count <= i < 2 count.
static source vertex_source(const geometry_polygon *polygon, ptrdiff_t i)
{
    ptrdiff_t count = (ptrdiff_t)polygon->count;
    assert(count > 1);
    if (polygon->closed)
        return (source){(size_t)(((i % count) + count) % count), 1};
    ptrdiff_t period = 2 * (count - 1), at = ((i % period) + period) % period;
    return at < count ? (source){(size_t)at, at % (count - 1) == 0 ? 0 : 1} : (source){(size_t)(period - at), -1};
}

static size_t edge_source(const geometry_polygon *polygon, ptrdiff_t i)
{
    ptrdiff_t edges = (ptrdiff_t)geometry_edges(polygon);
    assert(edges > 0);
    if (polygon->closed)
        return (size_t)(((i % edges) + edges) % edges);
    ptrdiff_t period = 2 * edges, at = ((i % period) + period) % period;
    return (size_t)(at < edges ? at : period - 1 - at);
}

/// Entries of a polygon continued beyond its ends.
static size_t continued(const geometry_polygon *polygon)
{
    return polygon->count + 2 * R + 1;
}

/// The setting of edge j.
static learned_setting setting_of(const edge_features *s, size_t j)
{
    learned_setting setting = s->setting;
    setting.parity = j % 2 == 0 ? setting.parity : -setting.parity;
    return setting;
}

static void features_back(void *context)
{
    edge_features *s = context;
    const geometry_polygon *shape = &s->polygon->shape;
    size_t edges = geometry_edges(shape), entries = continued(shape);
    double *angle_gradient = s->angles + entries, *length_gradient = s->lengths + entries;
    memset(angle_gradient, 0, entries * sizeof *angle_gradient);
    memset(length_gradient, 0, entries * sizeof *length_gradient);
    bool begun = s->features != NULL && s->features->begun;
    for (size_t j = 0; j < edges && s->features == NULL; j++)
        learned_later_back(s->angles + R + j, s->lengths + R + j, s->gradient[j].base, angle_gradient + R + j,
                           length_gradient + R + j);
    for (size_t j = 0; j < edges && s->features != NULL; j++)
    {
        double gradient[LEARNED_FEATURES] = {0};
        for (size_t i = 0; i < LEARNED_FEATURES && begun; i++)
            gradient[i] = (double)s->features->gradient[j * LEARNED_FEATURES + i];
        learned_features_back(s->angles + R + j, s->lengths + R + j, setting_of(s, j), gradient, s->gradient[j],
                              angle_gradient + R + j, length_gradient + R + j);
    }
    geometry_profile to = s->polygon->profile_gradient;
    for (size_t k = 0; k < entries; k++)
    {
        ptrdiff_t i = (ptrdiff_t)k - R;
        source vertex = vertex_source(shape, i);
        to.angles[vertex.index] += vertex.sign * angle_gradient[k];
        to.lengths[edge_source(shape, i)] += length_gradient[k];
    }
}

/// Gather the features of a polygon's edges. An open polygon is continued by point reflection in its ends
/// (BAT_CURVE_END_RULE_REFLECT).
/// @param level from LEARNED_LEVELS on without the network's features
static edge_features *gather_features(learn_tape *tape, tape_polygon *polygon, size_t level, double fairness)
{
    if (tape->status != BAT_OK)
        return NULL;
    const geometry_polygon *shape = &polygon->shape;
    size_t edges = geometry_edges(shape), entries = continued(shape);
    bool differentiated = polygon->point_gradient != NULL;
    edge_features *s = learn_tape_memory(tape, 1, sizeof *s);
    bool learned = level < LEARNED_LEVELS;
    learn_array *features = learned ? learn_array_make(tape, edges, LEARNED_FEATURES, differentiated) : NULL;
    learned_edge *per_edge = learn_tape_memory(tape, 2 * edges, sizeof *per_edge);
    double *extended = learn_tape_memory(tape, 4 * entries, sizeof *extended);
    learned_logs *logs = learn_tape_memory(tape, entries, sizeof *logs);
    if (tape->status != BAT_OK)
        return NULL;
    learned_setting setting = {(double)shape->surface, fairness, (double)level, level == 0 ? 0 : 1};
    *s = (edge_features){polygon, setting, features, per_edge, per_edge + edges, extended, extended + 2 * entries};
    memset(s->gradient, 0, edges * sizeof *s->gradient);
    for (size_t k = 0; k < entries; k++)
    {
        ptrdiff_t i = (ptrdiff_t)k - R;
        source vertex = vertex_source(shape, i);
        s->angles[k] = vertex.sign * polygon->profile.angles[vertex.index];
        s->lengths[k] = polygon->profile.lengths[edge_source(shape, i)];
    }
    for (size_t j = 0; j < edges && !learned; j++)
        per_edge[j] =
            (learned_edge){.base = learned_later(s->angles + R + j, s->lengths + R + j), .limit = BAT_CURVE_ANGLE_LIMIT};
    if (learned)
        learned_logs_of(s->angles + R, s->lengths + R, edges, level == 0, logs);
    for (size_t j = 0; j < edges && learned; j++)
    {
        double row[LEARNED_FEATURES];
        per_edge[j] = learned_features_of(s->angles + R + j, s->lengths + R + j, setting_of(s, j), logs + R - 1 + j, row);
        for (size_t i = 0; i < LEARNED_FEATURES; i++)
            features->value[j * LEARNED_FEATURES + i] = (real)row[i];
    }
    if (differentiated)
        learn_tape_record(tape, NULL, features_back, s);
    return s;
}

typedef struct angle_choice
{
    edge_features *edges;
    learn_array *output, *angles;
} angle_choice;

static void angles_back(void *context)
{
    angle_choice *c = context;
    real *to = c->output != NULL && learn_wants(c->output) ? learn_gradient(c->output) : NULL;
    for (size_t j = 0; j < c->angles->rows; j++)
    {
        learned_edge edge = c->edges->per_edge[j];
        double gradient = (double)c->angles->gradient[j], correction = 0, gate = 0;
        if (c->output != NULL)
        {
            correction = tanh((double)c->output->value[LEARNED_OUTPUTS * j]);
            gate = tanh((double)c->output->value[LEARNED_OUTPUTS * j + 1]);
        }
        double angle = edge.base * (1 + gate) + edge.scale * correction;
        if (fabs(angle) > edge.limit)
        {
            c->edges->gradient[j].limit += angle > 0 ? gradient : -gradient;
            continue;
        }
        c->edges->gradient[j].base += gradient * (1 + gate);
        c->edges->gradient[j].scale += gradient * correction;
        if (to == NULL)
            continue;
        to[LEARNED_OUTPUTS * j] += (real)(gradient * edge.scale * (1 - correction * correction));
        to[LEARNED_OUTPUTS * j + 1] += (real)(gradient * edge.base * (1 - gate * gate));
    }
}

/// The insertion angles of learned_angle(), clipped to BAT_CURVE_ANGLE_LIMIT.
/// @param output edges x LEARNED_OUTPUTS; null for the six-point rule
static learn_array *insertion_angles(learn_tape *tape, edge_features *edges, learn_array *output)
{
    if (tape->status != BAT_OK)
        return &tape->nothing;
    size_t count = geometry_edges(&edges->polygon->shape);
    bool differentiated = output != NULL || edges->polygon->point_gradient != NULL;
    learn_array *angles = learn_array_make(tape, count, 1, differentiated);
    angle_choice *c = learn_tape_memory(tape, 1, sizeof *c);
    if (tape->status != BAT_OK)
        return angles;
    assert(output == NULL || output->columns == LEARNED_OUTPUTS);
    for (size_t j = 0; j < count; j++)
    {
        const real *row = output != NULL ? output->value + LEARNED_OUTPUTS * j : NULL;
        double angle = edges->per_edge[j].base;
        if (row != NULL)
            angle = learned_angle(edges->per_edge[j], (double)row[0], (double)row[1]);
        angles->value[j] = (real)fmin(fmax(angle, -BAT_CURVE_ANGLE_LIMIT), BAT_CURVE_ANGLE_LIMIT);
    }
    *c = (angle_choice){edges, output, angles};
    if (differentiated)
        learn_tape_record(tape, angles, angles_back, c);
    return angles;
}

// The network

void learned_network_start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t i = 0; i < LEARNED_AT_OUTPUT; i++)
    {
        const learn_parameter *weight = &parameters->list[i];
        // A block's second layer begins small: the blocks change little at first.
        size_t layer = i / LEARNED_LAYER_SIZE;
        double gain = layer > 0 && layer % 2 == 0 ? 0.1 : 1;
        if (weight->rank == 2)
            learn_parameter_fill_normal(parameters, i, gain * sqrt(2.0 / (double)weight->rows), &random);
    }
}

static learn_array *linear_at(learn_tape *tape, learn_array *x, size_t layer)
{
    learn_array *weights[KLEIN_COUNT];
    size_t place = layer * LEARNED_LAYER_SIZE;
    for (size_t k = 0; k < KLEIN_COUNT; k++)
        weights[k] = learn_parameter_array(tape, place + k);
    return learn_klein_linear(tape, x, layer == 0 ? learned_widths() : klein_equal(LEARNED_CHANNELS),
                              klein_equal(LEARNED_CHANNELS), weights, learn_parameter_array(tape, place + KLEIN_COUNT));
}

learn_array *learned_network_apply(learn_tape *tape, learn_array *features)
{
    learn_array *x = learn_klein_gelu(tape, linear_at(tape, features, 0));
    for (size_t layer = 1; layer < LEARNED_LAYERS; layer += 2)
    {
        learn_array *inner = learn_klein_gelu(tape, linear_at(tape, x, layer));
        x = learn_add(tape, x, linear_at(tape, inner, layer + 1));
    }
    x = learn_klein_gelu(tape, x);
    static const klein_character BLOCKS[LEARNED_OUTPUTS] = {KLEIN_FIRST, KLEIN_KEPT};
    learn_array *outputs[LEARNED_OUTPUTS];
    for (size_t i = 0; i < LEARNED_OUTPUTS; i++)
        outputs[i] = learn_linear(tape, learn_slice_columns(tape, x, BLOCKS[i] * LEARNED_CHANNELS, LEARNED_CHANNELS),
                                  learn_parameter_array(tape, LEARNED_AT_OUTPUT + i), NULL);
    return learn_concatenate_columns(tape, outputs, LEARNED_OUTPUTS);
}

tape_polygon *curve_network_step(learn_tape *tape, tape_polygon *polygon, size_t level, double fairness)
{
    edge_features *edges = gather_features(tape, polygon, level, fairness);
    if (tape->status != BAT_OK)
        return NULL;
    learn_array *output = level < LEARNED_LEVELS ? learned_network_apply(tape, edges->features) : NULL;
    return tape_polygon_insert(tape, polygon, insertion_angles(tape, edges, output));
}

// The loss

/// What a classical scheme does with the polygon of a sample.
typedef struct classical_result
{
    double distance, bending, angle;
} classical_result;

static classical_result measure_result(learn_tape *tape, tape_polygon *polygon, const tension_sample *sample)
{
    learn_array *distance = tape_polygon_curve_distance(tape, polygon, sample->truth, sample->truth_count);
    learn_array *bending = tape_polygon_bending(tape, polygon);
    learn_array *angle = tape_polygon_angle_power_mean(tape, polygon, ANGLE_POWER);
    if (tape->status != BAT_OK)
        return (classical_result){0};
    return (classical_result){(double)*distance->value, (double)*bending->value, (double)*angle->value};
}

/// The polygon itself, with all edges divided, or the result of the six-point rule in turns.
static classical_result try_classical(learn_tape *tape, const tension_sample *sample, size_t steps, bool divided)
{
    tape_polygon *polygon = tape_polygon_given(tape, &sample->control);
    for (size_t step = 0; step < steps && tape->status == BAT_OK; step++)
    {
        size_t edges = geometry_edges(&polygon->shape);
        edge_features *six = divided ? NULL : gather_features(tape, polygon, LEARNED_LEVELS, 0);
        learn_array *zeros = divided ? learn_array_make(tape, edges, 1, false) : NULL;
        if (divided && tape->status == BAT_OK)
            memset(zeros->value, 0, edges * sizeof *zeros->value);
        polygon = tape_polygon_insert(tape, polygon, divided ? zeros : insertion_angles(tape, six, NULL));
    }
    return tape->status == BAT_OK ? measure_result(tape, polygon, sample) : (classical_result){0};
}

/// The mean length of the edges in the stored coordinates, in which distances are measured.
static double mean_chord(const geometry_polygon *polygon)
{
    size_t edges = geometry_edges(polygon), dim = geometry_dim(polygon->surface);
    double sum = 0;
    for (size_t j = 0; j < edges; j++)
    {
        const double *p = polygon->points + j * dim, *q = polygon->points + (j + 1) % polygon->count * dim;
        double squared = 0;
        for (size_t i = 0; i < dim; i++)
            squared += (q[i] - p[i]) * (q[i] - p[i]);
        sum += sqrt(squared);
    }
    return sum / (double)edges;
}

curve_network_loss curve_network_sample_loss(learn_tape *tape, const tension_sample *sample, size_t steps, double fairness,
                                             const curve_loss_weights *weights)
{
    classical_result itself = try_classical(tape, sample, steps, true), six = try_classical(tape, sample, steps, false);
    tape_polygon *polygon = tape_polygon_given(tape, &sample->control);
    for (size_t step = 0; step < steps; step++)
        polygon = curve_network_step(tape, polygon, step, fairness);
    curve_network_loss loss = {0};
    if (tape->status != BAT_OK)
        return loss;
    double floor = DISTANCE_FLOOR * mean_chord(&sample->control), best = fmin(itself.distance, six.distance) + floor;
    loss.distance = tape_polygon_curve_distance(tape, polygon, sample->truth, sample->truth_count);
    double factor = tape->status == BAT_OK && (double)*loss.distance->value > best ? 1 + weights->hinge : 1;
    loss.distance =
        learn_scale(tape, loss.distance, (real)(1 / (weights->distance_unit > 0 ? weights->distance_unit : best)));
    learn_array *bending = tape_polygon_bending(tape, polygon);
    loss.bending = learn_subtract(tape, learn_log(tape, bending),
                                  learn_log(tape, learn_add_number(tape, bending, (real)(six.bending + 1e-3))));
    loss.angle = tape_polygon_angle_power_mean(tape, polygon, ANGLE_POWER);
    if (tape->status != BAT_OK)
        return loss;
    double min_angle = ANGLE_FLOOR * ANGLE_FLOOR_COUNT / (double)polygon->shape.count;
    loss.angle = learn_scale(tape, loss.angle, (real)(1 / (six.angle + min_angle)));
    double fair =
        weights->min_roughness * pow(weights->max_roughness / weights->min_roughness, pow(fairness, FAIRNESS_POWER));
    learn_array *roughness = learn_add(tape, loss.bending, learn_scale(tape, loss.angle, (real)weights->angle));
    loss.total = learn_add(tape, learn_scale(tape, loss.distance, (real)factor), learn_scale(tape, roughness, (real)fair));
    return loss;
}
