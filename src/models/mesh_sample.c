#include "models/mesh_sample.h"

#include "models/unit_box.h"
#include "search/nearest.h"

#include <assert.h>

// Chamfer distance

typedef struct chamfer
{
    learn_array *state, *loss;
    const double *targets;
    size_t count;
    size_t *of_points;  ///< the target nearest to each point
    size_t *of_targets; ///< the point nearest to each target
} chamfer;

static void point_at(const learn_array *state, size_t row, double point[3])
{
    for (size_t a = 0; a < 3; a++)
        point[a] = (double)state->value[row * state->columns + a];
}

/// For each query the nearest item; returns the sum of the squared distances. False when out of memory.
static bool match(const double *queries, size_t query_count, const double *items, size_t item_count, size_t *nearest,
                  double *squares)
{
    nearest_tree tree;
    if (nearest_build(NEAREST_POINTS, items, NULL, item_count, 3, &tree, NULL) != BAT_OK)
        return false;
    *squares = 0;
    for (size_t q = 0; q < query_count; q++)
    {
        nearest_hit hit = nearest_find(&tree, queries + 3 * q);
        nearest[q] = hit.item;
        *squares += hit.distance * hit.distance;
    }
    nearest_free(&tree);
    return true;
}

static void pull(const chamfer *c, size_t row, size_t target, double slope, real *gradient)
{
    double point[3];
    point_at(c->state, row, point);
    for (size_t a = 0; a < 3; a++)
        gradient[row * c->state->columns + a] += (real)(slope * (point[a] - c->targets[3 * target + a]));
}

static void chamfer_back(void *context)
{
    const chamfer *c = context;
    real *gradient = learn_gradient(c->state);
    double slope = (double)*c->loss->gradient / 3;
    for (size_t i = 0; i < c->state->rows; i++)
        pull(c, i, c->of_points[i], slope / (double)c->state->rows, gradient);
    for (size_t i = 0; i < c->count; i++)
        pull(c, c->of_targets[i], i, slope / (double)c->count, gradient);
}

learn_array *mesh_sample_chamfer(learn_tape *tape, learn_array *state, const double *targets, size_t count)
{
    learn_array *loss = learn_array_make(tape, 1, 1, learn_wants(state));
    chamfer *c = learn_tape_memory(tape, 1, sizeof *c);
    double *points = learn_tape_memory(tape, 3 * state->rows, sizeof *points);
    size_t *of_points = learn_tape_memory(tape, state->rows, sizeof *of_points);
    size_t *of_targets = learn_tape_memory(tape, count, sizeof *of_targets);
    if (tape->status != BAT_OK)
        return loss;
    double there, back;
    for (size_t i = 0; i < state->rows; i++)
        point_at(state, i, points + 3 * i);
    if (!match(points, state->rows, targets, count, of_points, &there) ||
        !match(targets, count, points, state->rows, of_targets, &back))
    {
        tape->status = BAT_NO_MEMORY;
        return &tape->nothing;
    }
    *loss->value = (real)((there / (double)state->rows + back / (double)count) / 6);
    *c = (chamfer){state, loss, targets, count, of_points, of_targets};
    if (learn_wants(loss))
        learn_tape_record(tape, loss, chamfer_back, c);
    return loss;
}

// The loss

static learn_array *boxed(learn_tape *tape, const unit_box *box, const double *positions, size_t count)
{
    learn_array *array = learn_array_make(tape, count, 3, false);
    for (size_t i = 0; i < learn_size(array); i++)
        array->value[i] = (real)unit_box_in(box, i, positions[i]);
    return array;
}

static learn_array *judge(learn_tape *tape, mesh_sample_loss_form form, learn_array *state, const unit_box *box,
                          const double *target)
{
    if (!form.chamfer)
        return learn_mean_squared_error(tape, learn_slice_columns(tape, state, 0, 3), boxed(tape, box, target, state->rows));
    double *boxed_target = learn_tape_memory(tape, 3 * state->rows, sizeof *boxed_target);
    if (boxed_target == NULL)
        return &tape->nothing;
    for (size_t i = 0; i < 3 * state->rows; i++)
        boxed_target[i] = unit_box_in(box, i, target[i]);
    return mesh_sample_chamfer(tape, state, boxed_target, state->rows);
}

learn_array *mesh_sample_loss(learn_tape *tape, mesh_network_form network, mesh_sample_loss_form form, const mesh_pair *pair,
                              double *error_at)
{
    learn_array *states[MESH_PAIR_MOST_LEVELS + 1], *loss = NULL;
    unit_box box = unit_box_of(pair->coarse.positions, pair->coarse.vertex_count);
    learn_array *positions = boxed(tape, &box, pair->coarse.positions, pair->coarse.vertex_count);
    mesh_network_refine(tape, network, &pair->levels, positions, states);
    for (size_t level = 0; level <= pair->levels.count; level++)
    {
        learn_array *own = judge(tape, form, states[level], &box, pair->target[level]);
        if (tape->status != BAT_OK)
            return &tape->nothing;
        error_at[level] = (double)*own->value;
        if (form.last_level && level < pair->levels.count)
            continue;
        loss = loss == NULL ? own : learn_add(tape, loss, own);
    }
    return loss;
}
