/// @file
/// Test sets of curves drawn from continuous families (bat_tension_set_make).

#include "research/data/tension_set.h"

#include "base/error.h"
#include "base/memory.h"
#include "research/data/control_polygon.h"
#include "research/data/tension_family.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    TRUTH = BAT_TENSION_TRUTH_POINTS,
    CONTROL = BAT_TENSION_CONTROL_POINTS,
    MAX_DIM = 3
};

/// Minimum edge length of a control polygon, as a fraction of the mean edge length.
static const double SHORTEST_EDGE = 1.0 / 50;
/// Maximum step between points of a curve, as a fraction of its length: 20 times the mean.
static const double MAX_STEP = 20.0 / TRUTH;

void bat_tension_set_free(bat_tension_set *set)
{
    free(set->index);
    free(set->number);
    free(set->truth);
    free(set->control);
    *set = (bat_tension_set){0};
}

bool tension_set_allocate(bat_tension_set *set)
{
    size_t numbers;
    if (size_multiply_overflows(set->count, (size_t)TRUTH * MAX_DIM, &numbers))
        return false;
    set->index = memory_array(set->count, sizeof *set->index);
    set->number = memory_array(set->count, sizeof *set->number);
    set->truth = memory_array(set->count * TRUTH * set->dim, sizeof *set->truth);
    set->control = memory_array(set->count * CONTROL * set->dim, sizeof *set->control);
    return set->index != NULL && set->number != NULL && set->truth != NULL && set->control != NULL;
}

bat_random tension_stream(tension_purpose purpose, bat_tension_space space, uint64_t seed, uint64_t number)
{
    // Each word of the state is an injective function of one argument, and a step of the generator is injective. Hence no
    // two streams start in the same state. The first steps mix the words.
    const int mixing = 20;
    uint64_t kind = (uint64_t)purpose * BAT_TENSION_SPACE_COUNT + (uint64_t)space;
    bat_random random = bat_random_seed(seed);
    random.state[1] = bat_random_seed(number).state[0];
    random.state[2] = bat_random_seed(kind).state[0];
    for (int i = 0; i < mixing; i++)
        (void)bat_random_bits(&random);
    return random;
}

static double chord(const double *p, const double *q, size_t dim)
{
    double squared = 0;
    for (size_t i = 0; i < dim; i++)
        squared += (q[i] - p[i]) * (q[i] - p[i]);
    return sqrt(squared);
}

static bool jumps(const double *lengths)
{
    double longest = 0;
    for (size_t i = 0; i < TRUTH; i++)
        longest = fmax(longest, lengths[i + 1] - lengths[i]);
    return longest > MAX_STEP * lengths[TRUTH];
}

static bool has_short_edge(const double *control, size_t dim)
{
    double sum = 0, shortest = INFINITY;
    for (size_t k = 0; k < CONTROL; k++)
    {
        double length = chord(control + k * dim, control + (k + 1) % CONTROL * dim, dim);
        sum += length;
        shortest = fmin(shortest, length);
    }
    return shortest < SHORTEST_EDGE * sum / CONTROL;
}

/// Draw curves with control polygons until one is valid.
static void draw_fit(bat_tension_space space, bool unseen, size_t family, bat_random *random, double *truth, double *control)
{
    double lengths[TRUTH + 1];
    size_t samples[CONTROL], dim = tension_dim(space);
    for (;;)
    {
        tension_family_draw(space, unseen, family, random, TRUTH, truth);
        tension_control_plan plan = {.count = CONTROL, .start = bat_random_uniform(random)};
        if (!tension_control_sample(space, truth, TRUTH, &plan, random, lengths, samples) || jumps(lengths))
            continue;
        for (size_t k = 0; k < CONTROL; k++)
            memcpy(control + k * dim, truth + samples[k] * dim, dim * sizeof *control);
        if (!has_short_edge(control, dim))
            return;
    }
}

bat_status bat_tension_set_make(bat_tension_space space, bat_tension_set_kind kind, size_t count, uint64_t seed,
                                bat_tension_set *set, bat_error *error)
{
    if ((kind != BAT_TENSION_SET_KIND_RESAMPLED && kind != BAT_TENSION_SET_KIND_UNSEEN) ||
        (unsigned)space >= BAT_TENSION_SPACE_COUNT || count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "a set needs a valid space, at least one curve, and the kind resampled or unseen");
    bool unseen = kind == BAT_TENSION_SET_KIND_UNSEEN;
    bat_tension_set made = {.count = count, .dim = tension_dim(space)};
    if (!tension_set_allocate(&made))
    {
        bat_tension_set_free(&made);
        return error_set(error, BAT_NO_MEMORY, BAT_NO_INDEX, 0, "out of memory for a set of %zu curves", count);
    }
    size_t families = tension_family_count(space, unseen);
    for (size_t i = 0; i < count; i++)
    {
        bat_random random = tension_stream(unseen ? TENSION_UNSEEN_TEST : TENSION_RESAMPLED_TEST, space, seed, i);
        made.index[i] = made.number[i] = i;
        draw_fit(space, unseen, i % families, &random, made.truth + i * TRUTH * made.dim,
                 made.control + i * CONTROL * made.dim);
    }
    *set = made;
    return BAT_OK;
}
