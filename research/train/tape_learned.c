#include "research/train/tape_learned.h"

#include "batten/curve_scheme.h"

#include <assert.h>

enum
{
    R = LEARNED_REACH
};

/// Where entry i of the continued polygon comes from. Reflection in an end exchanges the two sides of the end vertex, keeps
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

/// Entries of a continued polygon.
static size_t continued(const geometry_polygon *polygon)
{
    return polygon->count + 2 * R + 1;
}

static void sights_back(void *context)
{
    tape_fairing *s = context;
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

tape_fairing *tape_fairing_see(learn_tape *tape, tape_polygon *polygon, double fairness)
{
    if (tape->status != BAT_OK)
        return NULL;
    const geometry_polygon *shape = &polygon->shape;
    size_t edges = geometry_edges(shape), entries = continued(shape);
    bool wanted = polygon->point_gradient != NULL;
    tape_fairing *s = learn_tape_memory(tape, 1, sizeof *s);
    learn_array *features = learn_array_make(tape, edges, LEARNED_FEATURES, wanted);
    learned_features *sights = learn_tape_memory(tape, 2 * edges, sizeof *sights);
    double *extended = learn_tape_memory(tape, 4 * entries, sizeof *extended);
    if (tape->status != BAT_OK)
        return NULL;
    *s = (tape_fairing){polygon, fairness, features, sights, sights + edges, extended, extended + 2 * entries};
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
        double seen[LEARNED_FEATURES];
        sights[j] = learned_see(s->angles + R + j, s->lengths + R + j, (double)shape->surface, fairness, seen);
        for (size_t i = 0; i < LEARNED_FEATURES; i++)
            features->value[j * LEARNED_FEATURES + i] = (real)seen[i];
    }
    if (wanted)
        learn_tape_record(tape, NULL, sights_back, s);
    return s;
}

typedef struct choice
{
    tape_fairing *sight;
    learn_array *said, *angles;
} choice;

static void angles_back(void *context)
{
    choice *c = context;
    real *to = learn_wants(c->said) ? learn_gradient(c->said) : NULL;
    for (size_t j = 0; j < c->angles->rows; j++)
    {
        double share = (double)real_tanh(c->said->value[j]), gradient = (double)c->angles->gradient[j];
        learned_features sight = c->sight->sights[j];
        if (fabs(sight.base + sight.scale * share) > BAT_CURVE_ANGLE_LIMIT)
            continue;
        c->sight->gradient[j].base += gradient;
        c->sight->gradient[j].scale += gradient * share;
        if (to != NULL)
            to[j] += (real)(gradient * sight.scale * (1 - share * share));
    }
}

learn_array *tape_fairing_angles(learn_tape *tape, tape_fairing *sight, learn_array *said)
{
    if (tape->status != BAT_OK)
        return &tape->nothing;
    learn_array *angles = learn_array_make(tape, said->rows, 1, true);
    choice *c = learn_tape_memory(tape, 1, sizeof *c);
    if (tape->status != BAT_OK)
        return angles;
    assert(said->columns == 1);
    for (size_t j = 0; j < said->rows; j++)
    {
        learned_features seen = sight->sights[j];
        double angle = seen.base + seen.scale * (double)real_tanh(said->value[j]);
        angles->value[j] = (real)fmin(fmax(angle, -BAT_CURVE_ANGLE_LIMIT), BAT_CURVE_ANGLE_LIMIT);
    }
    *c = (choice){sight, said, angles};
    learn_tape_record(tape, angles, angles_back, c);
    return angles;
}
