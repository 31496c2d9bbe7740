#include "research/train/tension_validate.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "batten/curve_measure.h"
#include "batten/research/curve_study.h"
#include "learn/blas.h"
#include "research/train/geometry_chamfer.h"
#include "research/train/geometry_loss.h"

#include <stdlib.h>

enum
{
    FINEST = BAT_TENSION_CONTROL_POINTS << BAT_TENSION_LEVELS
};

typedef struct validation
{
    const learn_parameters *parameters;
    bat_tension_embedding embedding;
    const bat_tension_set *sets;
    size_t curves;             ///< of all sets
    bat_tension_score *scores; ///< of the curves, set by set
    int threads;
} validation;

/// The mean distance of points to the nearest of others.
static double mean_nearest(const geometry_polygon *polygon, const double *truth, size_t truth_count)
{
    size_t dim = geometry_dim(polygon->surface), nearest[FINEST];
    double sum = 0;
    geometry_nearest(polygon->points, polygon->count, truth, truth_count, dim, nearest);
    for (size_t i = 0; i < polygon->count; i++)
    {
        const double *p = polygon->points + i * dim, *q = truth + nearest[i] * dim;
        double square = 0;
        for (size_t k = 0; k < dim; k++)
            square += (p[k] - q[k]) * (p[k] - q[k]);
        sum += sqrt(square);
    }
    return sum / (double)polygon->count;
}

static double largest_angle(const tape_polygon *polygon)
{
    double largest = 0;
    for (size_t j = 0; j < polygon->shape.count; j++)
        largest = fmax(largest, fabs(polygon->profile.angles[j]));
    return largest;
}

static bat_status score_curve(const validation *v, learn_tape *tape, const tension_sample *sample, bat_tension_score *score)
{
    learn_tape_begin(tape, v->parameters, NULL);
    tape_polygon *polygon = tape_polygon_given(tape, &sample->control);
    for (int level = 0; level < BAT_TENSION_LEVELS; level++)
        polygon = tension_step(tape, polygon, v->embedding);
    if (tape->status != BAT_OK)
        return tape->status;
    score->mean_nn = mean_nearest(&polygon->shape, sample->truth, sample->truth_count);
    score->bending = geometry_bending(&polygon->shape, polygon->profile, BAT_CURVE_BENDING_OFFSET);
    score->g1 = largest_angle(polygon);
    return BAT_OK;
}

/// Curve `index` of all sets.
static tension_sample sample_at(const validation *v, size_t index)
{
    size_t space = 0;
    while (index >= v->sets[space].count)
        index -= v->sets[space++].count;
    return tension_sample_of(&v->sets[space], (bat_tension_space)space, index);
}

static bat_status score_curves(const validation *v)
{
    bat_status status = BAT_OK;
    blas_single_begin();
#pragma omp parallel num_threads(v->threads) if (v->threads > 1)
    {
        learn_tape tape = learn_tape_make();
#pragma omp for schedule(dynamic, 4)
        for (size_t i = 0; i < v->curves; i++)
        {
            tension_sample sample = sample_at(v, i);
            bat_status own = score_curve(v, &tape, &sample, &v->scores[i]);
            if (own != BAT_OK)
            {
#pragma omp atomic write
                status = own;
            }
        }
        learn_tape_free(&tape);
    }
    blas_single_end();
    return status;
}

static bat_tension_score mean_score(const bat_tension_score *scores, size_t count)
{
    bat_tension_score sum = {0};
    for (size_t i = 0; i < count; i++)
    {
        sum.mean_nn += scores[i].mean_nn;
        sum.bending += scores[i].bending;
        sum.g1 += scores[i].g1;
    }
    double n = (double)count;
    return (bat_tension_score){sum.mean_nn / n, sum.bending / n, sum.g1 / n};
}

bat_status tension_validate(const learn_parameters *parameters, bat_tension_embedding embedding,
                            const bat_tension_set sets[BAT_TENSION_SPACE_COUNT], int threads,
                            bat_tension_score scores[BAT_TENSION_SPACE_COUNT], bat_error *error)
{
    validation v = {.parameters = parameters, .embedding = embedding, .sets = sets};
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        v.curves += sets[space].count;
    v.threads = threads_for(threads, v.curves);
    v.scores = memory_array(v.curves, sizeof *v.scores);
    bat_status status = v.scores != NULL ? score_curves(&v) : BAT_NO_MEMORY;
    const bat_tension_score *own = v.scores;
    for (size_t space = 0; status == BAT_OK && space < BAT_TENSION_SPACE_COUNT; space++)
    {
        scores[space] = mean_score(own, sets[space].count);
        own += sets[space].count;
    }
    free(v.scores);
    return status == BAT_OK ? BAT_OK : error_memory(error, v.curves * sizeof *v.scores);
}

double tension_cross_mean(const bat_tension_score scores[BAT_TENSION_SPACE_COUNT])
{
    double sum = 0, count = 0;
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        if (!isnan(scores[space].mean_nn))
        {
            sum += scores[space].mean_nn;
            count++;
        }
    return sum / count;
}
