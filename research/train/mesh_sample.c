#include "research/train/mesh_sample.h"

#include "mesh/measure/unit_box.h"
#include "search/nearest.h"

#include <assert.h>
#include <math.h>

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

// Distance off the surface

/// The weight of squared errors along the surface, relative to those off it.
static const double ALONG = 0.1;

typedef struct off_surface
{
    learn_array *state, *loss;
    double *pull; ///< rows x 3: the loss of each point by its place
} off_surface;

/// The loss of one point, and its derivative by the point.
static double one_off_surface(const double error[3], const double normal[3], double slack, double pull[3])
{
    double off = 0, all = 0;
    for (size_t a = 0; a < 3; a++)
    {
        off += error[a] * normal[a];
        all += error[a] * error[a];
    }
    double root = sqrt((1 - ALONG) * off * off + ALONG * all + slack * slack);
    for (size_t a = 0; a < 3; a++)
        pull[a] = ((1 - ALONG) * off * normal[a] + ALONG * error[a]) / root;
    return root - slack;
}

static void off_surface_back(void *context)
{
    const off_surface *o = context;
    real *gradient = learn_gradient(o->state);
    double slope = (double)*o->loss->gradient / (double)o->state->rows;
    for (size_t i = 0; i < o->state->rows; i++)
        for (size_t a = 0; a < 3; a++)
            gradient[i * o->state->columns + a] += (real)(slope * o->pull[3 * i + a]);
}

learn_array *mesh_sample_off_surface(learn_tape *tape, learn_array *state, const double *targets, const double *normals,
                                     double slack)
{
    learn_array *loss = learn_array_make(tape, 1, 1, learn_wants(state));
    off_surface *o = learn_tape_memory(tape, 1, sizeof *o);
    double *pull = learn_tape_memory(tape, 3 * state->rows, sizeof *pull);
    if (tape->status != BAT_OK)
        return loss;
    double sum = 0;
    for (size_t i = 0; i < state->rows; i++)
    {
        double error[3];
        point_at(state, i, error);
        for (size_t a = 0; a < 3; a++)
            error[a] -= targets[3 * i + a];
        sum += one_off_surface(error, normals + 3 * i, slack, pull + 3 * i);
    }
    *loss->value = (real)(sum / (double)state->rows);
    *o = (off_surface){state, loss, pull};
    if (learn_wants(loss))
        learn_tape_record(tape, loss, off_surface_back, o);
    return loss;
}

// The loss

/// The mean length of the coarse mesh's edges in its unit box.
static double mean_edge(const bat_mesh *mesh, const unit_box *box)
{
    double sum = 0;
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
    {
        const double *a = mesh->positions + 3 * mesh->faces[h], *b = mesh->positions + 3 * mesh->faces[bat_mesh_next(h)];
        sum += sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
    }
    return sum / (double)(3 * mesh->face_count) / box->size;
}

/// Relative to the mean coarse edge: below it the surface loss is quadratic.
static const double SLACK = 0.01;

static learn_array *boxed(learn_tape *tape, const unit_box *box, const double *positions, size_t count)
{
    learn_array *array = learn_array_make(tape, count, 3, false);
    for (size_t i = 0; i < learn_size(array); i++)
        array->value[i] = (real)unit_box_in(box, i, positions[i]);
    return array;
}

static learn_array *level_loss(learn_tape *tape, mesh_sample_loss_form form, learn_array *state, const unit_box *box,
                               const mesh_pair *pair, const double *target)
{
    if (!form.chamfer && !form.surface)
        return learn_mean_squared_error(tape, learn_slice_columns(tape, state, 0, 3), boxed(tape, box, target, state->rows));
    double *boxed_target = learn_tape_memory(tape, 3 * state->rows, sizeof *boxed_target);
    if (boxed_target == NULL)
        return &tape->nothing;
    for (size_t i = 0; i < 3 * state->rows; i++)
        boxed_target[i] = unit_box_in(box, i, target[i]);
    if (form.chamfer)
        return mesh_sample_chamfer(tape, state, boxed_target, state->rows);
    // In units of coarse edges, so that all shapes have the same weight.
    double edge = mean_edge(&pair->coarse, box);
    return learn_scale(tape, mesh_sample_off_surface(tape, state, boxed_target, pair->normals, SLACK * edge),
                       (real)(1 / edge));
}

learn_array *mesh_sample_loss(learn_tape *tape, mesh_network_form network, mesh_sample_loss_form form, const mesh_pair *pair,
                              double *error_at)
{
    form.surface = form.surface && pair->normals != NULL;
    learn_array *states[MESH_PAIR_MAX_LEVELS + 1], *loss = NULL;
    unit_box box = unit_box_of(pair->coarse.positions, pair->coarse.vertex_count);
    learn_array *positions = boxed(tape, &box, pair->coarse.positions, pair->coarse.vertex_count);
    mesh_network_refine(tape, network, &pair->levels, positions, states);
    for (size_t level = 0; level <= pair->levels.count; level++)
    {
        learn_array *own = level_loss(tape, form, states[level], &box, pair, pair->target[level]);
        if (tape->status != BAT_OK)
            return &tape->nothing;
        error_at[level] = (double)*own->value;
        if (form.last_level && level < pair->levels.count)
            continue;
        loss = loss == NULL ? own : learn_add(tape, loss, own);
    }
    return loss;
}
