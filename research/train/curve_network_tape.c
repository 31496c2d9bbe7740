#include "research/train/curve_network_tape.h"

#include "batten/curve_scheme.h"
#include "curve/network/learned_network.h"

#include <assert.h>

/// High enough to be near the largest angle, low enough to be smooth.
static const double ANGLE_POWER = 16;

/// Vertices of the polygons in the tables, for which a typical angle is known.
static const double FINEST_COUNT = BAT_TENSION_CONTROL_POINTS << 5;

enum
{
    R = LEARNED_REACH
};

// Features and angles

/// The features of all edges of a polygon.
typedef struct edge_features
{
    tape_polygon *polygon;
    double fairness;
    learn_array *features;      ///< edges x LEARNED_FEATURES
    learned_features *per_edge; ///< of the edges
    learned_features *gradient; ///< the same, by the loss
    /// Of the polygon continued beyond its ends; entry LEARNED_REACH + i is that of the polygon's i.
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

static void features_back(void *context)
{
    edge_features *s = context;
    const geometry_polygon *shape = &s->polygon->shape;
    size_t edges = geometry_edges(shape), entries = continued(shape);
    double *angle_gradient = s->angles + entries, *length_gradient = s->lengths + entries;
    memset(angle_gradient, 0, entries * sizeof *angle_gradient);
    memset(length_gradient, 0, entries * sizeof *length_gradient);
    const real *features = s->features->gradient;
    for (size_t j = 0; j < edges; j++)
    {
        double gradient[LEARNED_FEATURES] = {0};
        for (size_t i = 0; i < LEARNED_FEATURES && s->features->begun; i++)
            gradient[i] = (double)features[j * LEARNED_FEATURES + i];
        learned_see_back(s->angles + R + j, s->lengths + R + j, (double)shape->surface, gradient, s->gradient[j],
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
/// (BAT_CURVE_END_REFLECT).
static edge_features *gather_features(learn_tape *tape, tape_polygon *polygon, double fairness)
{
    if (tape->status != BAT_OK)
        return NULL;
    const geometry_polygon *shape = &polygon->shape;
    size_t edges = geometry_edges(shape), entries = continued(shape);
    bool differentiated = polygon->point_gradient != NULL;
    edge_features *s = learn_tape_memory(tape, 1, sizeof *s);
    learn_array *features = learn_array_make(tape, edges, LEARNED_FEATURES, differentiated);
    learned_features *per_edge = learn_tape_memory(tape, 2 * edges, sizeof *per_edge);
    double *extended = learn_tape_memory(tape, 4 * entries, sizeof *extended);
    if (tape->status != BAT_OK)
        return NULL;
    *s = (edge_features){polygon, fairness, features, per_edge, per_edge + edges, extended, extended + 2 * entries};
    memset(s->gradient, 0, edges * sizeof *s->gradient);
    for (size_t k = 0; k < entries; k++)
    {
        ptrdiff_t i = (ptrdiff_t)k - R;
        source vertex = vertex_source(shape, i);
        s->angles[k] = vertex.sign * polygon->profile.angles[vertex.index];
        s->lengths[k] = polygon->profile.lengths[edge_source(shape, i)];
    }
    for (size_t j = 0; j < edges; j++)
    {
        double row[LEARNED_FEATURES];
        per_edge[j] = learned_see(s->angles + R + j, s->lengths + R + j, (double)shape->surface, fairness, row);
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
    real *to = learn_wants(c->output) ? learn_gradient(c->output) : NULL;
    for (size_t j = 0; j < c->angles->rows; j++)
    {
        double share = (double)real_tanh(c->output->value[j]), gradient = (double)c->angles->gradient[j];
        learned_features edge = c->edges->per_edge[j];
        if (fabs(edge.base + edge.scale * share) > BAT_CURVE_ANGLE_LIMIT)
            continue;
        c->edges->gradient[j].base += gradient;
        c->edges->gradient[j].scale += gradient * share;
        if (to != NULL)
            to[j] += (real)(gradient * edge.scale * (1 - share * share));
    }
}

/// The insertion angles base + scale tanh(output), clipped to BAT_CURVE_ANGLE_LIMIT.
/// @param output edges x 1
static learn_array *insertion_angles(learn_tape *tape, edge_features *edges, learn_array *output)
{
    if (tape->status != BAT_OK)
        return &tape->nothing;
    learn_array *angles = learn_array_make(tape, output->rows, 1, true);
    angle_choice *c = learn_tape_memory(tape, 1, sizeof *c);
    if (tape->status != BAT_OK)
        return angles;
    assert(output->columns == 1);
    for (size_t j = 0; j < output->rows; j++)
    {
        learned_features edge = edges->per_edge[j];
        double angle = edge.base + edge.scale * (double)real_tanh(output->value[j]);
        angles->value[j] = (real)fmin(fmax(angle, -BAT_CURVE_ANGLE_LIMIT), BAT_CURVE_ANGLE_LIMIT);
    }
    *c = (angle_choice){edges, output, angles};
    learn_tape_record(tape, angles, angles_back, c);
    return angles;
}

// The loss

tape_polygon *curve_network_step(learn_tape *tape, tape_polygon *polygon, double fairness)
{
    edge_features *edges = gather_features(tape, polygon, fairness);
    if (tape->status != BAT_OK)
        return NULL;
    learn_array *output = learned_network_apply(tape, edges->features);
    return tape_polygon_insert(tape, polygon, insertion_angles(tape, edges, output));
}

curve_network_loss curve_network_sample_loss(learn_tape *tape, const tension_sample *sample, bat_tension_space space,
                                             size_t steps, double fairness, const curve_loss_weights *weights)
{
    tape_polygon *polygon = tape_polygon_given(tape, &sample->control);
    for (size_t step = 0; step < steps; step++)
        polygon = curve_network_step(tape, polygon, fairness);
    curve_network_loss loss = {0};
    loss.distance = sample->control.closed ? tape_polygon_chamfer(tape, polygon, sample->truth, sample->truth_count)
                                           : tape_polygon_mean_nearest(tape, polygon, sample->truth, sample->truth_count);
    learn_array *bending = tape_polygon_bending(tape, polygon);
    loss.bending = learn_subtract(tape, learn_log(tape, bending),
                                  learn_log(tape, learn_add_number(tape, bending, (real)weights->bending_unit[space])));
    loss.angle = tape_polygon_angle_power_mean(tape, polygon, ANGLE_POWER);
    double fair = weights->min_roughness * pow(weights->max_roughness / weights->min_roughness, fairness);
    if (tape->status != BAT_OK)
        return loss;
    // Angles halve with every level: the unit belongs to polygons of FINEST_COUNT vertices.
    double angle_unit = weights->angle_unit[space] * FINEST_COUNT / (double)polygon->shape.count;
    learn_array *angle = learn_scale(tape, loss.angle, (real)(weights->angle / angle_unit));
    learn_array *roughness = learn_add(tape, loss.bending, angle);
    loss.total = learn_add(tape, learn_scale(tape, loss.distance, (real)(1 / weights->distance_unit[space])),
                           learn_scale(tape, roughness, (real)fair));
    return loss;
}
