#include "research/train/tension_sample.h"

#include "research/networks/tension_network.h"
#include "research/train/geometry_insert.h"
#include "research/train/geometry_polygon.h"

enum
{
    LEARNED_STEPS = 2,
    ISOMETRIES = 2
};

/// With the sign as printed in eq. (9).
static const double WARM_UP_TENSION = -0.15;

geometry_surface tension_surface(bat_tension_space space)
{
    static const geometry_surface surfaces[] = {GEOMETRY_PLANE, GEOMETRY_SPHERE, GEOMETRY_DISK};
    return surfaces[space];
}

tension_sample tension_sample_of(const bat_tension_set *set, bat_tension_space space, size_t i)
{
    return (tension_sample){
        .control = {.points = set->control + i * BAT_TENSION_CONTROL_POINTS * set->dim,
                    .count = BAT_TENSION_CONTROL_POINTS,
                    .surface = tension_surface(space),
                    .closed = true},
        .truth = set->truth + i * BAT_TENSION_TRUTH_POINTS * set->dim,
        .truth_count = BAT_TENSION_TRUTH_POINTS,
    };
}

bat_status tension_predictor_make(bat_tension_embedding embedding, learn_parameters *parameters, bat_error *error)
{
    return tension_network_make_embedded((tension_embedding)embedding, parameters, error);
}

/// Features with three more columns, of which the surface's is 1.
static learn_array *add_one_hot(learn_tape *tape, learn_array *features, size_t place)
{
    learn_array *code = learn_array_make(tape, features->rows, TENSION_SPACES, false);
    for (size_t k = 0; k < learn_size(code); k++)
        code->value[k] = k % TENSION_SPACES == place;
    learn_array *both[2] = {features, code};
    return learn_concatenate_columns(tape, both, 2);
}

learn_array *tension_predict(learn_tape *tape, learn_array *features, geometry_surface surface,
                             bat_tension_embedding embedding)
{
    uint32_t place = (uint32_t)((int)surface + 1);
    if (embedding == BAT_TENSION_EMBEDDING_NONE)
        return tension_network_angles(tape, features, NULL);
    if (embedding == BAT_TENSION_EMBEDDING_ONE_HOT)
        return tension_network_angles(tape, add_one_hot(tape, features, place), NULL);
    uint32_t *spaces = learn_tape_memory(tape, features->rows, sizeof *spaces);
    if (spaces == NULL)
        return &tape->nothing;
    for (size_t j = 0; j < features->rows; j++)
        spaces[j] = place;
    return tension_network_angles(tape, features, spaces);
}

tape_polygon *tension_step(learn_tape *tape, tape_polygon *polygon, bat_tension_embedding embedding)
{
    if (tape->status != BAT_OK)
        return NULL;
    learn_array *features = tape_polygon_features(tape, polygon);
    return tape_polygon_insert(tape, polygon, tension_predict(tape, features, polygon->shape.surface, embedding));
}

/// The classical step, without derivative.
static tape_polygon *warm_up(learn_tape *tape, tape_polygon *control)
{
    if (tape->status != BAT_OK)
        return NULL;
    const geometry_polygon *shape = &control->shape;
    size_t edges = geometry_edges(shape);
    geometry_polygon fine = *shape;
    fine.count += edges;
    double *angles = learn_tape_memory(tape, edges, sizeof *angles);
    double *points = learn_tape_memory(tape, fine.count * geometry_dim(fine.surface), sizeof *points);
    if (tape->status != BAT_OK)
        return NULL;
    geometry_tension_angles(shape, control->profile, WARM_UP_TENSION, BAT_CURVE_ANGLE_SIGN_PRINTED, angles);
    geometry_insert(shape, angles, points);
    fine.points = points;
    return tape_polygon_given(tape, &fine);
}

/// The polygon moved by a random rotation.
static tape_polygon *rotated(learn_tape *tape, const geometry_polygon *polygon, bat_random *random)
{
    geometry_isometry rotation = geometry_isometry_random(polygon->surface, 0, random);
    geometry_polygon moved = *polygon;
    double *points = learn_tape_memory(tape, moved.count * geometry_dim(moved.surface), sizeof *points);
    if (points == NULL)
        return NULL;
    geometry_isometry_apply(&rotation, polygon->points, polygon->count, points);
    moved.points = points;
    return tape_polygon_given(tape, &moved);
}

learn_array *tension_consistency(learn_tape *tape, const geometry_polygon *polygon, bat_tension_embedding embedding,
                                 bat_random *random)
{
    // The network evaluates all rows at once: those of the polygon, then those of each image.
    learn_array *features[1 + ISOMETRIES];
    for (size_t k = 0; k < 1 + ISOMETRIES; k++)
    {
        tape_polygon *image = k == 0 ? tape_polygon_given(tape, polygon) : rotated(tape, polygon, random);
        features[k] = tape_polygon_features(tape, image);
    }
    learn_array *all = learn_concatenate_rows(tape, features, 1 + ISOMETRIES);
    learn_array *angles = tension_predict(tape, all, polygon->surface, embedding);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    size_t edges = geometry_edges(polygon);
    learn_array *still = learn_slice_rows(tape, angles, 0, edges), *sum = NULL;
    for (size_t k = 1; k <= ISOMETRIES; k++)
    {
        learn_array *moved = learn_slice_rows(tape, angles, k * edges, edges);
        learn_array *error = learn_sum_of_squares(tape, learn_subtract(tape, still, moved));
        sum = sum == NULL ? error : learn_add(tape, sum, error);
    }
    return learn_scale(tape, sum, (real)(1.0 / ISOMETRIES));
}

static learn_array *weighted(learn_tape *tape, learn_array *sum, learn_array *term, double weight)
{
    return weight > 0 ? learn_add(tape, sum, learn_scale(tape, term, (real)weight)) : sum;
}

static double smoothness_weight(const bat_curve_train_options *options, geometry_surface surface)
{
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        if (tension_surface((bat_tension_space)space) == surface)
            return options->smoothness[space];
    return 0;
}

tension_loss tension_sample_loss(learn_tape *tape, const tension_sample *sample, const bat_curve_train_options *options,
                                 bat_random *random)
{
    tape_polygon *polygon = warm_up(tape, tape_polygon_given(tape, &sample->control));
    for (int step = 0; step < LEARNED_STEPS; step++)
        polygon = tension_step(tape, polygon, options->embedding);
    tension_loss loss = {
        .chamfer = tape_polygon_chamfer(tape, polygon, sample->truth, sample->truth_count),
        .smoothness = tape_polygon_smoothness(tape, polygon),
        .bending = tape_polygon_bending(tape, polygon),
    };
    loss.total = weighted(tape, loss.chamfer, loss.smoothness, smoothness_weight(options, sample->control.surface));
    loss.total = weighted(tape, loss.total, loss.bending, options->bending);
    if (options->consistency > 0 && tape->status == BAT_OK)
    {
        loss.consistency = tension_consistency(tape, &polygon->shape, options->embedding, random);
        loss.total = weighted(tape, loss.total, loss.consistency, options->consistency);
    }
    return loss;
}
