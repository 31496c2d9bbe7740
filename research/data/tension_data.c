/// @file
/// The data set of Ugail and Howard (2026), section 6.1: 1,200 closed curves with control polygons, in single precision,
/// shuffled and split into 960 training and 240 validation curves.

#include "batten/research/curve_data.h"

#include "base/error.h"
#include "research/data/control_polygon.h"
#include "research/data/tension_curves.h"
#include "research/data/tension_set.h"

#include <math.h>
#include <string.h>

enum
{
    TRUTH = BAT_TENSION_TRUTH_POINTS,
    CONTROL = BAT_TENSION_CONTROL_POINTS,
    TOTAL = BAT_TENSION_SPACE_COUNT * BAT_TENSION_CURVES,
    VALIDATION = TOTAL / 5,
    MAX_DIM = 3
};

void bat_tension_data_free(bat_tension_data *data)
{
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        bat_tension_set_free(&data->train[space]);
        bat_tension_set_free(&data->validation[space]);
    }
}

/// Round to single precision as in the published arrays; on the sphere, restore unit length in double precision.
static void round_point(bat_tension_space space, const double *point, double *rounded)
{
    size_t dim = tension_dim(space);
    double squared = 0;
    for (size_t i = 0; i < dim; i++)
    {
        rounded[i] = (double)(float)point[i];
        squared += rounded[i] * rounded[i];
    }
    if (space == BAT_TENSION_SPACE_SPHERE)
        for (size_t i = 0; i < dim; i++)
            rounded[i] /= sqrt(squared);
}

/// The destination of a curve: its part of the split, and its row there.
typedef struct curve_place
{
    bat_tension_set *set;
    size_t row;
} curve_place;

/// Make a curve with its control polygon.
static void make_curve(bat_tension_space space, size_t number, mersenne *stream, curve_place place)
{
    double points[TRUTH * MAX_DIM], lengths[TRUTH + 1];
    size_t samples[CONTROL], dim = tension_dim(space);
    tension_curve(space, number, stream, points);
    arc_samples(points, TRUTH, dim, true, lengths, CONTROL, samples);
    double *truth = place.set->truth + place.row * TRUTH * dim;
    double *control = place.set->control + place.row * CONTROL * dim;
    for (size_t i = 0; i < TRUTH; i++)
        round_point(space, points + i * dim, truth + i * dim);
    for (size_t k = 0; k < CONTROL; k++)
    {
        size_t vertex = samples[k] + (tension_tie_takes_next(space, number, k) ? 1 : 0);
        memcpy(control + k * dim, truth + vertex * dim, dim * sizeof *control);
    }
    place.set->number[place.row] = number;
}

/// The state of the stream after all curves, from which the shuffle is drawn.
static mersenne stream_after_curves(void)
{
    double points[TRUTH * MAX_DIM];
    mersenne stream = mersenne_seed(TENSION_SEED);
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        for (size_t number = 0; number < BAT_TENSION_CURVES; number++)
            tension_curve((bat_tension_space)space, number, &stream, points);
    return stream;
}

/// Split the shuffled order: count the curves of each set, allocate the sets, and assign a row to every curve.
static bool split(const size_t *order, bat_tension_data *data, curve_place *places)
{
    for (size_t position = 0; position < TOTAL; position++)
    {
        bat_tension_set *sets = position < VALIDATION ? data->validation : data->train;
        bat_tension_set *set = &sets[order[position] / BAT_TENSION_CURVES];
        places[order[position]] = (curve_place){set, set->count++};
    }
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        data->train[space].dim = data->validation[space].dim = tension_dim((bat_tension_space)space);
        if (!tension_set_allocate(&data->train[space]) || !tension_set_allocate(&data->validation[space]))
            return false;
    }
    for (size_t position = 0; position < TOTAL; position++)
    {
        curve_place place = places[order[position]];
        place.set->index[place.row] = position < VALIDATION ? position : position - VALIDATION;
    }
    return true;
}

bat_status bat_tension_data_make(bat_tension_data *data, bat_error *error)
{
    bat_tension_data made = {0};
    size_t order[TOTAL];
    curve_place places[TOTAL];
    mersenne stream = stream_after_curves();
    mersenne_permutation(&stream, order, TOTAL);
    if (!split(order, &made, places))
    {
        bat_tension_data_free(&made);
        return error_memory(error, (size_t)TOTAL * (TRUTH + CONTROL) * MAX_DIM * sizeof(double));
    }
    stream = mersenne_seed(TENSION_SEED);
    for (size_t curve = 0; curve < TOTAL; curve++)
        make_curve((bat_tension_space)(curve / BAT_TENSION_CURVES), curve % BAT_TENSION_CURVES, &stream, places[curve]);
    *data = made;
    return BAT_OK;
}

bat_curve bat_tension_truth(const bat_tension_set *set, size_t i, const bat_space *space)
{
    return (bat_curve){.space = space, .points = set->truth + i * TRUTH * set->dim, .count = TRUTH, .closed = true};
}

bat_curve bat_tension_control(const bat_tension_set *set, size_t i, const bat_space *space)
{
    return (bat_curve){.space = space, .points = set->control + i * CONTROL * set->dim, .count = CONTROL, .closed = true};
}
