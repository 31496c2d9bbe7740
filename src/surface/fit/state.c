/// @file
/// States of adaptive fits; see loop.h.

#include "surface/fit/loop.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/progress.h"
#include "surface/spline/hierarchical_space.h"

#include <stdlib.h>
#include <string.h>

/// What begins the bytes of a state; rounds and boxes follow.
typedef struct state_head
{
    uint64_t rounds, boxes, best_boxes, best_round, outliers;
    double lambda, best_expected, best_left, best_held_rms, best_held_largest, best_lambda, seconds;
    uint64_t full, corrects, has_best;
} state_head;

static size_t state_columns(const fit_loop *loop, bat_surface_fit_column columns[4])
{
    columns[0] = (bat_surface_fit_column){loop->points.parameter, 2};
    columns[1] = (bat_surface_fit_column){loop->points.weight, 1};
    columns[2] = (bat_surface_fit_column){loop->best.parameter, 2};
    columns[3] = (bat_surface_fit_column){loop->best.distance, 1};
    return loop->held != NULL ? 4 : 2;
}

bat_status fit_state_save(const fit_loop *loop, bat_error *error)
{
    const bat_surface_fit_backend *backend = &loop->backend;
    bat_surface_fit_column columns[4];
    bat_spline_box *boxes = NULL, *best_boxes = NULL;
    size_t count = 0, best_count = 0;
    if (backend->save == NULL)
        return BAT_OK;
    bat_status status = hierarchical_space_regions(loop->space, &boxes, &count, error);
    if (status == BAT_OK && loop->best.space != NULL)
        status = hierarchical_space_regions(loop->best.space, &best_boxes, &best_count, error);
    size_t rounds = loop->count * sizeof *loop->rounds, size = sizeof(state_head) + rounds;
    size += (count + best_count) * sizeof *boxes + fit_border_state_size(&loop->border);
    char *bytes = status == BAT_OK ? memory_array(size, 1) : NULL;
    if (status == BAT_OK && bytes == NULL)
        status = error_memory(error, size);
    if (status == BAT_OK)
    {
        state_head head = {.rounds = loop->count,
                           .boxes = count,
                           .best_boxes = best_count,
                           .best_round = loop->best.round,
                           .outliers = loop->outliers,
                           .lambda = loop->lambda,
                           .best_expected = loop->best.expected,
                           .best_left = loop->best.left,
                           .best_held_rms = loop->best.held_rms,
                           .best_held_largest = loop->best.held_largest,
                           .best_lambda = loop->best.lambda,
                           .seconds = clock_seconds() - loop->begin,
                           .full = loop->full,
                           .corrects = loop->corrects,
                           .has_best = loop->best.space != NULL};
        memcpy(bytes, &head, sizeof head);
        memcpy(bytes + sizeof head, loop->rounds, rounds);
        if (count > 0)
            memcpy(bytes + sizeof head + rounds, boxes, count * sizeof *boxes);
        if (best_count > 0)
            memcpy(bytes + sizeof head + rounds + count * sizeof *boxes, best_boxes, best_count * sizeof *boxes);
        fit_border_save(&loop->border, bytes + size - fit_border_state_size(&loop->border));
        status = backend->save(backend->context, bytes, size, columns, state_columns(loop, columns), error);
    }
    free(bytes);
    free(boxes);
    free(best_boxes);
    return status;
}

static bat_status read_state(fit_loop *loop, const char *bytes, size_t size, bat_error *error)
{
    state_head head = {0};
    if (size >= sizeof head)
        memcpy(&head, bytes, sizeof head);
    size_t rounds = head.rounds * sizeof *loop->rounds, boxes = (head.boxes + head.best_boxes) * sizeof(bat_spline_box);
    if (head.rounds > (size_t)loop->options->iterations || (head.has_best != 0 && loop->held == NULL) ||
        size != sizeof head + rounds + boxes + fit_border_state_size(&loop->border))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "the state is not one of this fit");
    bat_spline_box *copy = memory_array(boxes, 1);
    if (copy == NULL)
        return error_memory(error, boxes);
    memcpy(loop->rounds, bytes + sizeof head, rounds);
    memcpy(copy, bytes + sizeof head + rounds, boxes);
    bat_hierarchical_space *space = NULL;
    bat_status status = hierarchical_space_of_regions(&loop->options->space, copy, head.boxes, &space, error);
    if (status == BAT_OK && head.has_best != 0)
        status = hierarchical_space_of_regions(&loop->options->space, copy + head.boxes, head.best_boxes, &loop->best.space,
                                               error);
    free(copy);
    if (status != BAT_OK)
    {
        bat_hierarchical_space_free(space);
        return status;
    }
    bat_hierarchical_space_free(loop->space);
    loop->space = space;
    loop->count = head.rounds;
    loop->outliers = head.outliers;
    loop->lambda = head.lambda;
    loop->full = head.full != 0;
    loop->corrects = head.corrects != 0;
    loop->best.round = head.best_round;
    loop->best.expected = head.best_expected;
    loop->best.left = head.best_left;
    loop->best.held_rms = head.best_held_rms;
    loop->best.held_largest = head.best_held_largest;
    loop->best.lambda = head.best_lambda;
    loop->begin = clock_seconds() - head.seconds;
    fit_border_load(&loop->border, bytes + sizeof head + rounds + boxes, &loop->points);
    return BAT_OK;
}

bat_status fit_state_load(fit_loop *loop, bat_error *error)
{
    const bat_surface_fit_backend *backend = &loop->backend;
    bat_surface_fit_column columns[4];
    void *bytes = NULL;
    size_t size = 0;
    if (backend->load == NULL)
        return BAT_OK;
    bat_status status = backend->load(backend->context, &bytes, &size, columns, state_columns(loop, columns), error);
    if (status == BAT_OK && bytes != NULL)
        status = read_state(loop, bytes, size, error);
    free(bytes);
    return status;
}
