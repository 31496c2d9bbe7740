#include "research/train/tape_polygon.h"

#include "batten/curve_measure.h"
#include "research/train/geometry_feature.h"
#include "research/train/geometry_insert.h"
#include "research/train/geometry_loss.h"

#include <assert.h>

enum
{
    EDGE_FEATURES = GEOMETRY_PUBLISHED_FEATURES - 1 ///< features without the curvature
};

static bool has_gradient(const tape_polygon *polygon)
{
    return polygon->point_gradient != NULL;
}

static double *zeros(learn_tape *tape, size_t count)
{
    double *memory = learn_tape_memory(tape, count, sizeof *memory);
    if (memory != NULL)
        memset(memory, 0, count * sizeof *memory);
    return memory;
}

static void measure_back(void *context)
{
    tape_polygon *polygon = context;
    geometry_measure_back(&polygon->shape, polygon->profile_gradient, polygon->point_gradient);
}

/// A polygon with given points, measured.
static tape_polygon *polygon_make(learn_tape *tape, const geometry_polygon *shape, bool differentiated)
{
    size_t count = shape->count;
    tape_polygon *polygon = learn_tape_memory(tape, 1, sizeof *polygon);
    geometry_profile profile = {zeros(tape, count), zeros(tape, count)}, gradient = {0};
    double *point_gradient = NULL;
    if (differentiated)
    {
        gradient = (geometry_profile){zeros(tape, count), zeros(tape, count)};
        point_gradient = zeros(tape, count * geometry_dim(shape->surface));
    }
    if (tape->status != BAT_OK)
        return NULL;
    *polygon = (tape_polygon){*shape, profile, point_gradient, gradient};
    geometry_measure(&polygon->shape, profile);
    if (differentiated)
        learn_tape_record(tape, NULL, measure_back, polygon);
    return polygon;
}

tape_polygon *tape_polygon_given(learn_tape *tape, const geometry_polygon *shape)
{
    return polygon_make(tape, shape, false);
}

typedef struct insertion
{
    tape_polygon *coarse, *fine;
    learn_array *angles;
    double *precise; ///< the angles in double precision
} insertion;

static void insert_back(void *context)
{
    insertion *step = context;
    size_t edges = step->angles->rows;
    const double *fine_gradient = step->fine->point_gradient;
    if (!learn_wants(step->angles))
    {
        geometry_insert_back(&step->coarse->shape, step->precise, fine_gradient, step->coarse->point_gradient, NULL);
        return;
    }
    double *gradient = step->precise + edges;
    geometry_insert_back(&step->coarse->shape, step->precise, fine_gradient, step->coarse->point_gradient, gradient);
    real *to = learn_gradient(step->angles);
    for (size_t j = 0; j < edges; j++)
        to[j] += (real)gradient[j];
}

tape_polygon *tape_polygon_insert(learn_tape *tape, tape_polygon *coarse, learn_array *angles)
{
    if (tape->status != BAT_OK)
        return NULL;
    geometry_polygon shape = coarse->shape;
    size_t edges = geometry_edges(&shape);
    assert(angles->rows == edges && angles->columns == 1);
    shape.count += edges;
    double *points = learn_tape_memory(tape, shape.count * geometry_dim(shape.surface), sizeof *points);
    double *precise = zeros(tape, 2 * edges);
    insertion *step = learn_tape_memory(tape, 1, sizeof *step);
    if (tape->status != BAT_OK)
        return NULL;
    for (size_t j = 0; j < edges; j++)
        precise[j] = (double)angles->value[j];
    geometry_insert(&coarse->shape, precise, points);
    shape.points = points;
    *step = (insertion){.coarse = coarse, .angles = angles, .precise = precise};
    bool differentiated = has_gradient(coarse) || learn_wants(angles);
    // Recorded before the fine polygon's measure, so that it goes back after it.
    if (differentiated)
        learn_tape_record(tape, NULL, insert_back, step);
    step->fine = polygon_make(tape, &shape, differentiated);
    return step->fine;
}

typedef struct edge_features
{
    tape_polygon *polygon;
    learn_array *features;
    double *precise; ///< edges x GEOMETRY_PUBLISHED_FEATURES
} edge_features;

static void features_back(void *context)
{
    edge_features *s = context;
    const real *gradient = s->features->gradient;
    for (size_t j = 0; j < s->features->rows; j++)
        for (size_t i = 0; i < GEOMETRY_PUBLISHED_FEATURES; i++)
            s->precise[j * GEOMETRY_PUBLISHED_FEATURES + i] =
                i < EDGE_FEATURES ? (double)gradient[j * EDGE_FEATURES + i] : 0;
    geometry_published_features_back(&s->polygon->shape, s->polygon->profile, s->precise, GEOMETRY_PUBLISHED_FEATURES,
                                     s->polygon->profile_gradient);
}

learn_array *tape_polygon_features(learn_tape *tape, tape_polygon *polygon)
{
    if (tape->status != BAT_OK)
        return &tape->nothing;
    size_t edges = geometry_edges(&polygon->shape);
    learn_array *features = learn_array_make(tape, edges, EDGE_FEATURES, has_gradient(polygon));
    double *precise = learn_tape_memory(tape, edges * GEOMETRY_PUBLISHED_FEATURES, sizeof *precise);
    edge_features *s = learn_tape_memory(tape, 1, sizeof *s);
    if (tape->status != BAT_OK)
        return features;
    geometry_published_features(&polygon->shape, polygon->profile, precise, GEOMETRY_PUBLISHED_FEATURES);
    for (size_t j = 0; j < edges; j++)
        for (size_t i = 0; i < EDGE_FEATURES; i++)
            features->value[j * EDGE_FEATURES + i] = (real)precise[j * GEOMETRY_PUBLISHED_FEATURES + i];
    *s = (edge_features){polygon, features, precise};
    if (has_gradient(polygon))
        learn_tape_record(tape, features, features_back, s);
    return features;
}

/// A loss of a polygon.
typedef struct judgement
{
    tape_polygon *polygon;
    learn_array *loss;
    const double *truth;
    size_t truth_count;
    geometry_matches matches;
    geometry_feet feet;
    double power;
} judgement;

/// A loss to be filled in; null after a failure.
static judgement *judge(learn_tape *tape, tape_polygon *polygon, learn_backward *backward)
{
    if (tape->status != BAT_OK)
        return NULL;
    learn_array *loss = learn_array_make(tape, 1, 1, has_gradient(polygon));
    judgement *j = learn_tape_memory(tape, 1, sizeof *j);
    if (tape->status != BAT_OK)
        return NULL;
    *j = (judgement){.polygon = polygon, .loss = loss};
    if (has_gradient(polygon))
        learn_tape_record(tape, loss, backward, j);
    return j;
}

static void chamfer_back(void *context)
{
    const judgement *j = context;
    const geometry_polygon *shape = &j->polygon->shape;
    geometry_chamfer_back(shape->points, shape->count, j->truth, j->truth_count, geometry_dim(shape->surface), j->matches,
                          (double)*j->loss->gradient, j->polygon->point_gradient);
}

learn_array *tape_polygon_chamfer(learn_tape *tape, tape_polygon *polygon, const double *truth, size_t truth_count)
{
    judgement *j = judge(tape, polygon, chamfer_back);
    if (j == NULL)
        return &tape->nothing;
    const geometry_polygon *shape = &polygon->shape;
    size_t *of_points = learn_tape_memory(tape, shape->count, sizeof *of_points);
    size_t *of_truth = learn_tape_memory(tape, truth_count, sizeof *of_truth);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    j->truth = truth;
    j->truth_count = truth_count;
    j->matches = (geometry_matches){of_points, of_truth};
    *j->loss->value =
        (real)geometry_chamfer(shape->points, shape->count, truth, truth_count, geometry_dim(shape->surface), j->matches);
    return j->loss;
}

static void smoothness_back(void *context)
{
    const judgement *j = context;
    geometry_smoothness_back(&j->polygon->shape, j->polygon->profile, (double)*j->loss->gradient,
                             j->polygon->profile_gradient);
}

learn_array *tape_polygon_smoothness(learn_tape *tape, tape_polygon *polygon)
{
    judgement *j = judge(tape, polygon, smoothness_back);
    if (j == NULL)
        return &tape->nothing;
    *j->loss->value = (real)geometry_smoothness(&polygon->shape, polygon->profile);
    return j->loss;
}

static void bending_back(void *context)
{
    const judgement *j = context;
    geometry_bending_back(&j->polygon->shape, j->polygon->profile, BAT_CURVE_BENDING_OFFSET, (double)*j->loss->gradient,
                          j->polygon->profile_gradient);
}

learn_array *tape_polygon_bending(learn_tape *tape, tape_polygon *polygon)
{
    judgement *j = judge(tape, polygon, bending_back);
    if (j == NULL)
        return &tape->nothing;
    *j->loss->value = (real)geometry_bending(&polygon->shape, polygon->profile, BAT_CURVE_BENDING_OFFSET);
    return j->loss;
}

static void mean_nearest_back(void *context)
{
    const judgement *j = context;
    const geometry_polygon *shape = &j->polygon->shape;
    geometry_mean_nearest_back(shape->points, shape->count, j->truth, geometry_dim(shape->surface), j->matches.of_points,
                               (double)*j->loss->gradient, j->polygon->point_gradient);
}

learn_array *tape_polygon_mean_nearest(learn_tape *tape, tape_polygon *polygon, const double *truth, size_t truth_count)
{
    judgement *j = judge(tape, polygon, mean_nearest_back);
    if (j == NULL)
        return &tape->nothing;
    const geometry_polygon *shape = &polygon->shape;
    j->truth = truth;
    j->matches.of_points = learn_tape_memory(tape, shape->count, sizeof *j->matches.of_points);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    *j->loss->value = (real)geometry_mean_nearest(shape->points, shape->count, truth, truth_count,
                                                  geometry_dim(shape->surface), j->matches.of_points);
    return j->loss;
}

static void power_mean_back(void *context)
{
    const judgement *j = context;
    geometry_angle_power_mean_back(&j->polygon->shape, j->polygon->profile, j->power, (double)*j->loss->gradient,
                                   j->polygon->profile_gradient);
}

learn_array *tape_polygon_angle_power_mean(learn_tape *tape, tape_polygon *polygon, double power)
{
    judgement *j = judge(tape, polygon, power_mean_back);
    if (j == NULL)
        return &tape->nothing;
    j->power = power;
    *j->loss->value = (real)geometry_angle_power_mean(&polygon->shape, polygon->profile, power);
    return j->loss;
}

static void curve_distance_back(void *context)
{
    const judgement *j = context;
    geometry_curve_distance_back(&j->polygon->shape, j->truth, j->truth_count, j->feet, (double)*j->loss->gradient,
                                 j->polygon->point_gradient);
}

learn_array *tape_polygon_curve_distance(learn_tape *tape, tape_polygon *polygon, const double *truth, size_t truth_count)
{
    judgement *j = judge(tape, polygon, curve_distance_back);
    if (j == NULL)
        return &tape->nothing;
    const geometry_polygon *shape = &polygon->shape;
    size_t count = shape->count, larger = count > truth_count ? count : truth_count;
    j->truth = truth;
    j->truth_count = truth_count;
    j->feet.of_points = learn_tape_memory(tape, count, sizeof *j->feet.of_points);
    j->feet.of_truth = learn_tape_memory(tape, truth_count, sizeof *j->feet.of_truth);
    j->feet.point_weights = learn_tape_memory(tape, count, sizeof *j->feet.point_weights);
    j->feet.truth_weights = learn_tape_memory(tape, truth_count, sizeof *j->feet.truth_weights);
    j->feet.nearest = learn_tape_memory(tape, larger, sizeof *j->feet.nearest);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    *j->loss->value = (real)geometry_curve_distance(shape, truth, truth_count, j->feet);
    return j->loss;
}
