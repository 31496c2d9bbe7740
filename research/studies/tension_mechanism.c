/// @file
/// Analysis of the trained network of Ugail and Howard (2026): effective tensions (section 9, eq. 26) and a Lipschitz bound
/// (remark 4), the product over layers of spectral norms |W|_2, by power iteration.

#include "batten/research/curve_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "learn/blas.h"
#include "research/learn/operations.h"
#include "research/networks/tension_network.h"
#include "research/studies/spectral_norm.h"
#include "research/train/geometry_insert.h"
#include "research/train/tension_sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    SPACES = BAT_TENSION_SPACE_COUNT,
    BINS = BAT_TENSION_EFFECTIVE_BINS,
    MAX_LEVELS = 10
};

/// Below this |A - B| the paper calls the effective tension undefined.
static const double MIN_DIFFERENCE = 1e-6;

/// Published in the text of section 9.
static const double PUBLISHED_MEANS[SPACES] = {-0.39, 0.32, -0.82};
static const double PUBLISHED_DEVIATIONS[SPACES] = {1.99, NAN, NAN};

bat_tension_mechanism_options bat_tension_mechanism_defaults(void)
{
    return (bat_tension_mechanism_options){.curves = 60, .levels = 3};
}

// Every insertion on the curves of one space

/// The network, and the statistics of one space.
typedef struct analysis
{
    const learn_parameters *parameters;
    bat_tension_embedding embedding;
    size_t levels;
    learn_tape tape;
    double *points[2]; ///< points of a polygon and of the refined one
    double *angles;    ///< angles of the insertions on a polygon
    double *printed, *outward;
    size_t insertions; ///< insertions
    size_t defined;    ///< insertions with an effective tension
    double gradient;   ///< length of the longest gradient
} analysis;

/// A copy of the features on the tape, to differentiate with respect to them.
static learn_array *watched(learn_tape *tape, const learn_array *features)
{
    learn_array *copy = learn_array_make(tape, features->rows, features->columns, true);
    if (tape->status == BAT_OK)
        memcpy(copy->value, features->value, learn_size(features) * sizeof *copy->value);
    return copy;
}

/// The effective tension of eq. (26) for edge j, with either sign of the angle.
static void note_tension(analysis *w, const double *exterior, size_t count, size_t j, double alpha)
{
    double outer = (exterior[(j + count - 1) % count] + exterior[(j + 2) % count]) / 8;
    double inner = (exterior[j] + exterior[(j + 1) % count]) / 8;
    w->insertions++;
    if (fabs(outer - inner) < MIN_DIFFERENCE)
        return;
    w->printed[w->defined] = (alpha - inner) / (outer - inner);
    w->outward[w->defined] = (-alpha - inner) / (outer - inner);
    w->defined++;
}

static void note_gradient(analysis *w, learn_array *features)
{
    const real *gradient = learn_gradient(features);
    for (size_t j = 0; j < features->rows; j++)
    {
        double square = 0;
        for (size_t k = 0; k < features->columns; k++)
        {
            double slope = (double)gradient[j * features->columns + k];
            square += slope * slope;
        }
        w->gradient = fmax(w->gradient, sqrt(square));
    }
}

/// Refine a polygon into `fine`, and accumulate the statistics of the insertions.
static bat_status analyze_level(analysis *w, const geometry_polygon *polygon, double *fine, bat_error *error)
{
    learn_tape *tape = &w->tape;
    learn_tape_begin(tape, w->parameters, NULL);
    tape_polygon *given = tape_polygon_given(tape, polygon);
    learn_array *features = watched(tape, tape_polygon_features(tape, given));
    learn_array *angles = tension_predict(tape, features, polygon->surface, w->embedding);
    // The angle of an edge depends only on its own features. The gradient of the sum therefore contains the gradients of all
    // angles.
    learn_tape_backward(tape, learn_sum(tape, angles), 1);
    bat_status status = learn_tape_status(tape, error);
    if (status != BAT_OK)
        return status;
    for (size_t j = 0; j < polygon->count; j++)
    {
        w->angles[j] = (double)angles->value[j];
        note_tension(w, given->profile.angles, polygon->count, j, w->angles[j]);
    }
    note_gradient(w, features);
    geometry_insert(polygon, w->angles, fine);
    return BAT_OK;
}

static bat_status analyze_curve(analysis *w, const geometry_polygon *control, bat_error *error)
{
    geometry_polygon polygon = *control;
    bat_status status = BAT_OK;
    for (size_t level = 0; level < w->levels && status == BAT_OK; level++)
    {
        double *fine = w->points[level % 2];
        status = analyze_level(w, &polygon, fine, error);
        polygon.points = fine;
        polygon.count *= 2;
    }
    return status;
}

static bat_status analysis_make(const learn_parameters *parameters, bat_tension_embedding embedding,
                                const bat_tension_mechanism_options *options, analysis *w, bat_error *error)
{
    *w = (analysis){.parameters = parameters, .embedding = embedding, .levels = options->levels, .tape = learn_tape_make()};
    size_t finest = (size_t)BAT_TENSION_CONTROL_POINTS << options->levels, insertions = options->curves * finest;
    w->points[0] = memory_array(2 * 3 * finest, sizeof(double));
    w->angles = memory_array(finest, sizeof(double));
    w->printed = memory_array(2 * insertions, sizeof(double));
    if (w->points[0] == NULL || w->angles == NULL || w->printed == NULL)
        return error_memory(error, 2 * insertions * sizeof(double));
    w->points[1] = w->points[0] + 3 * finest;
    w->outward = w->printed + insertions;
    return BAT_OK;
}

static void analysis_free(analysis *w)
{
    learn_tape_free(&w->tape);
    free(w->points[0]);
    free(w->angles);
    free(w->printed);
}

// What becomes of it

/// A quantile of sorted numbers, by linear interpolation.
static double quantile(const double *sorted, size_t count, double share)
{
    double place = share * (double)(count - 1);
    size_t below = (size_t)place, above = below + 1 < count ? below + 1 : below;
    return sorted[below] + (place - (double)below) * (sorted[above] - sorted[below]);
}

static size_t bin_of(double tension)
{
    const double width = (BAT_TENSION_EFFECTIVE_MAX - BAT_TENSION_EFFECTIVE_MIN) / BINS;
    double place = (tension - BAT_TENSION_EFFECTIVE_MIN) / width;
    return place >= BINS ? BINS - 1 : (size_t)place;
}

/// Sort the tensions, and clip them for the summary and the histogram.
static bat_status describe(double *tensions, size_t defined, size_t insertions, bat_tension_effective *effective,
                           bat_error *error)
{
    static const double shares[] = {0.05, 0.25, 0.5, 0.75, 0.95};
    *effective = (bat_tension_effective){.insertions = insertions, .undefined = insertions - defined};
    if (defined == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "no insertion has an effective tension");
    qsort(tensions, defined, sizeof *tensions, ascending);
    for (size_t q = 0; q < sizeof shares / sizeof *shares; q++)
        effective->quantiles[q] = quantile(tensions, defined, shares[q]);
    for (size_t i = 0; i < defined; i++)
    {
        effective->below += tensions[i] < BAT_TENSION_EFFECTIVE_MIN;
        effective->above += tensions[i] > BAT_TENSION_EFFECTIVE_MAX;
        tensions[i] = fmin(fmax(tensions[i], BAT_TENSION_EFFECTIVE_MIN), BAT_TENSION_EFFECTIVE_MAX);
        effective->histogram[bin_of(tensions[i])]++;
    }
    return bat_curve_summarize(tensions, defined, &effective->summary, error);
}

/// The angle for zero features.
static bat_status measure_centre(analysis *w, geometry_surface surface, double *centre, bat_error *error)
{
    static const real zeros[TENSION_FEATURES];
    learn_tape_begin(&w->tape, w->parameters, NULL);
    learn_array *features = learn_constant(&w->tape, 1, TENSION_FEATURES, zeros);
    learn_array *angle = tension_predict(&w->tape, features, surface, w->embedding);
    bat_status status = learn_tape_status(&w->tape, error);
    if (status == BAT_OK)
        *centre = (double)*angle->value;
    return status;
}

static bool report_progress(bat_progress progress, size_t done, size_t total)
{
    return progress.report == NULL || progress.report(progress.context, (double)done / (double)total);
}

static bat_status analyze_space(analysis *w, const bat_tension_set *set, bat_tension_space space,
                                const bat_tension_mechanism_options *options, bat_tension_mechanism_space *found,
                                bat_error *error)
{
    size_t count = options->curves < set->count ? options->curves : set->count;
    bat_status status = BAT_OK;
    w->insertions = w->defined = 0;
    w->gradient = 0;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        tension_sample sample = tension_sample_of(set, space, i);
        if (!report_progress(options->progress, (size_t)space * count + i, SPACES * count))
            return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
        status = analyze_curve(w, &sample.control, error);
    }
    if (status == BAT_OK)
        status = describe(w->printed, w->defined, w->insertions, &found->printed, error);
    if (status == BAT_OK)
        status = describe(w->outward, w->defined, w->insertions, &found->outward, error);
    if (status == BAT_OK)
        status = measure_centre(w, tension_surface(space), &found->centre, error);
    found->largest_gradient = w->gradient;
    found->published_mean = PUBLISHED_MEANS[space];
    found->published_deviation = PUBLISHED_DEVIATIONS[space];
    return status;
}

/// The spectral norm of one layer (remark 4).
static bat_status measure_layer(const learn_parameters *parameters, size_t place, double *norm, bat_error *error)
{
    const learn_parameter *weight = &parameters->list[place];
    const real *values = learn_parameter_values(parameters, place);
    size_t total = weight->rows * weight->columns;
    double *matrix = memory_array(total, sizeof *matrix);
    if (matrix == NULL)
        return error_memory(error, total * sizeof *matrix);
    for (size_t i = 0; i < total; i++)
        matrix[i] = (double)values[i];
    bat_status status = spectral_norm(weight->rows, weight->columns, matrix, norm, error);
    free(matrix);
    return status;
}

static bat_status measure_layers(const learn_parameters *parameters, bat_tension_embedding embedding,
                                 bat_tension_mechanism_report *report, bat_error *error)
{
    size_t layer = 0;
    report->product = 1;
    // The embedding is the only matrix that is not a layer.
    for (size_t i = embedding == BAT_TENSION_EMBEDDING_LEARNED ? 1 : 0; i < parameters->count; i++)
    {
        if (parameters->list[i].rank != 2)
            continue;
        bat_status status = measure_layer(parameters, i, &report->layers[layer], error);
        if (status != BAT_OK)
            return status;
        report->product *= report->layers[layer++];
    }
    return BAT_OK;
}

static bat_status analyze(const learn_parameters *parameters, bat_tension_embedding embedding,
                          const bat_tension_mechanism_options *options, bat_tension_mechanism_report *report,
                          bat_error *error)
{
    analysis w;
    bat_tension_data data = {0};
    blas_single_begin();
    bat_status status = measure_layers(parameters, embedding, report, error);
    if (status == BAT_OK)
        status = bat_tension_data_make(&data, error);
    if (status == BAT_OK)
    {
        status = analysis_make(parameters, embedding, options, &w, error);
        for (size_t s = 0; s < SPACES && status == BAT_OK; s++)
            status = analyze_space(&w, &data.validation[s], (bat_tension_space)s, options, &report->spaces[s], error);
        analysis_free(&w);
    }
    blas_single_end();
    bat_tension_data_free(&data);
    return status;
}

bat_status bat_tension_mechanism(const char *path, const bat_tension_mechanism_options *options,
                                 bat_tension_mechanism_report *report, bat_error *error)
{
    bat_tension_mechanism_options defaults = bat_tension_mechanism_defaults();
    options = options != NULL ? options : &defaults;
    if (options->curves == 0 || options->curves > BAT_TENSION_CURVES || options->levels == 0 || options->levels > MAX_LEVELS)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the mechanism is looked at on 1 to %d curves and 1 to %d levels", BAT_TENSION_CURVES, MAX_LEVELS);
    learn_parameters parameters;
    bat_status status = tension_network_read(path, &parameters, error);
    if (status != BAT_OK)
        return status;
    status = analyze(&parameters, (bat_tension_embedding)tension_network_embedding(&parameters), options, report, error);
    learn_parameters_free(&parameters);
    return status;
}
