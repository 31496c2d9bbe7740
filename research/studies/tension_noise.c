/// @file
/// Table 2 of Ugail and Howard (2026), section 7.7: largest exterior angles after refinement of disturbed control polygons.

#include "batten/research/curve_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/progress.h"
#include "batten/research/curve_data.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bat_tension_noise_options bat_tension_noise_defaults(void)
{
    return (bat_tension_noise_options){.noise = {0, 0.03, 0.06, 0.1, 0.15, 0.2}, .levels = BAT_TENSION_LEVELS, .seed = 1};
}

// The published figures

typedef struct published
{
    const char *method;
    double g1[BAT_TENSION_NOISES], deviation[BAT_TENSION_NOISES];
} published;

/// Table 2. The paper's schemes have the printed sign, as in tables 1 and 5.
static const published TABLE2[] = {
    {"four-point-printed", {2.655, 2.70, 2.76, 2.84, 2.95, 3.08}, {0.32, 0.33, 0.35, 0.38, 0.42, 0.47}},
    {"six-point-printed", {2.824, 2.88, 2.94, 3.05, 3.18, 3.34}, {0.35, 0.36, 0.38, 0.42, 0.47, 0.54}},
    {"adaptive-heuristic-printed", {1.480, 1.52, 1.57, 1.65, 1.76, 1.89}, {0.28, 0.30, 0.33, 0.37, 0.43, 0.51}},
    {BAT_TENSION_LEARNED_PUBLISHED, {0.237, 0.258, 0.287, 0.334, 0.396, 0.462}, {0.08, 0.09, 0.11, 0.14, 0.17, 0.21}},
};

static void set_published(const bat_tension_noise_options *options, bat_tension_noise_row *row)
{
    bat_tension_noise_options defaults = bat_tension_noise_defaults();
    for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
    {
        row->published_g1[s] = row->published_deviation[s] = NAN;
        for (size_t i = 0; i < sizeof TABLE2 / sizeof *TABLE2; i++)
            if (strcmp(row->method, TABLE2[i].method) == 0 && options->noise[s] == defaults.noise[s])
            {
                row->published_g1[s] = TABLE2[i].g1[s];
                row->published_deviation[s] = TABLE2[i].deviation[s];
            }
    }
}

// The polygons

/// The plane validation polygons, with disturbed copies.
typedef struct noise_state
{
    bat_space plane;
    bat_tension_data data;
    size_t count;
    bat_curve *control, *truth, *noisy, *fine; ///< `count` each; the first three do not own their points
    double *offsets;                           ///< displacements for noise of strength 1, in the layout of the polygons
    double *points;                            ///< points of the disturbed polygons
    bat_curve_fairness_values *fairness;
    double *g1;
    const bat_tension_noise_options *options;
    bat_error *error;
} noise_state;

/// The radius of a polygon: the largest distance of a point from the mean.
static double radius_of(const double *points)
{
    enum
    {
        COUNT = BAT_TENSION_CONTROL_POINTS
    };
    double x = 0, y = 0, radius = 0;
    for (size_t i = 0; i < COUNT; i++)
    {
        x += points[2 * i] / COUNT;
        y += points[2 * i + 1] / COUNT;
    }
    for (size_t i = 0; i < COUNT; i++)
        radius = fmax(radius, hypot(points[2 * i] - x, points[2 * i + 1] - y));
    return radius;
}

static bat_status allocate(noise_state *state)
{
    const size_t numbers = state->count * BAT_TENSION_CONTROL_POINTS * 2;
    state->control = memory_array(4 * state->count, sizeof *state->control);
    state->offsets = memory_array(2 * numbers, sizeof *state->offsets);
    state->fairness = memory_array(state->count, sizeof *state->fairness);
    state->g1 = memory_array(state->count, sizeof *state->g1);
    if (state->control == NULL || state->offsets == NULL || state->fairness == NULL || state->g1 == NULL)
        return error_memory(state->error, numbers * sizeof *state->offsets);
    state->truth = state->control + state->count;
    state->noisy = state->truth + state->count;
    state->fine = state->noisy + state->count;
    state->points = state->offsets + numbers;
    return BAT_OK;
}

static void draw_offsets(noise_state *state)
{
    const bat_tension_set *set = &state->data.validation[BAT_TENSION_SPACE_PLANE];
    const size_t numbers = BAT_TENSION_CONTROL_POINTS * set->dim;
    bat_random random = bat_random_seed(state->options->seed);
    for (size_t i = 0; i < state->count; i++)
    {
        double radius = radius_of(set->control + i * numbers);
        for (size_t k = 0; k < numbers; k++)
            state->offsets[i * numbers + k] = radius * bat_random_normal(&random);
    }
}

static bat_status check_options(const bat_tension_noise_options *options, bat_error *error)
{
    for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
        if (!(isfinite(options->noise[s]) && options->noise[s] >= 0))
            return error_set(error, BAT_INVALID_ARGUMENT, s, 0, "noise %zu is negative or not finite", s);
    return BAT_OK;
}

static bat_status state_make(const bat_tension_noise_options *options, noise_state *state, bat_error *error)
{
    *state = (noise_state){.plane = bat_euclidean(2), .options = options, .error = error};
    bat_status status = check_options(options, error);
    if (status == BAT_OK)
        status = bat_tension_data_make(&state->data, error);
    if (status != BAT_OK)
        return status;
    const bat_tension_set *set = &state->data.validation[BAT_TENSION_SPACE_PLANE];
    state->count = set->count;
    status = allocate(state);
    for (size_t i = 0; i < state->count && status == BAT_OK; i++)
    {
        state->control[i] = state->noisy[i] = bat_tension_control(set, i, &state->plane);
        state->truth[i] = bat_tension_truth(set, i, &state->plane);
        state->noisy[i].points = state->points + i * BAT_TENSION_CONTROL_POINTS * 2;
    }
    if (status == BAT_OK)
        draw_offsets(state);
    return status;
}

static void state_free(noise_state *state)
{
    bat_tension_data_free(&state->data);
    free(state->control);
    free(state->offsets);
    free(state->fairness);
    free(state->g1);
}

static void disturb(noise_state *state, double noise)
{
    const size_t numbers = BAT_TENSION_CONTROL_POINTS * 2;
    for (size_t i = 0; i < state->count; i++)
        for (size_t k = 0; k < numbers; k++)
            state->points[i * numbers + k] = state->control[i].points[k] + noise * state->offsets[i * numbers + k];
}

// A row

/// Refine the disturbed polygons and summarize their largest angles.
static bat_status measure(noise_state *state, const bat_curve_scheme *scheme, bat_curve_summary *g1)
{
    bat_curve_refine_options refine = bat_curve_refine_defaults();
    refine.scheme = *scheme;
    refine.levels = state->options->levels;
    refine.threads = state->options->threads;
    refine.simple = BAT_CURVE_SIMPLE_NEVER; // the published program has no such test
    bat_curve_measure_options how = bat_curve_measure_defaults();
    how.threads = state->options->threads;
    bat_error own;
    bat_status status = bat_curves_refine(state->noisy, state->count, &refine, state->fine, &own);
    if (status == BAT_OK)
    {
        status = bat_curves_fairness(state->fine, state->count, &how, state->fairness, &own);
        for (size_t i = 0; i < state->count; i++)
            bat_curve_free(&state->fine[i]);
    }
    if (status != BAT_OK)
        return error_set(state->error, status, own.index, 0, "disturbed curve %zu: %.180s", own.curve, own.text);
    for (size_t i = 0; i < state->count; i++)
        state->g1[i] = state->fairness[i].g1;
    return bat_curve_summarize(state->g1, state->count, g1, state->error);
}

static bat_status fill_row(noise_state *state, const char *method, const bat_curve_scheme *scheme, bat_progress progress,
                           bat_tension_noise_row *row)
{
    bool has_tension = scheme->kind == BAT_CURVE_SCHEME_KIND_ANGLE && scheme->rule == NULL;
    *row = (bat_tension_noise_row){.method = method, .tension = has_tension ? scheme->tension : NAN};
    set_published(state->options, row);
    bat_status status = BAT_OK;
    for (size_t s = 0; s < BAT_TENSION_NOISES && status == BAT_OK; s++)
    {
        disturb(state, state->options->noise[s]);
        status = measure(state, scheme, &row->g1[s]);
        double done = (double)(s + 1) / BAT_TENSION_NOISES;
        if (status == BAT_OK && progress.report != NULL && !progress.report(progress.context, done))
            status = error_set(state->error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
    }
    return status;
}

static bat_curve_scheme angle(double tension, bat_curve_angle_sign sign, bool adaptive)
{
    bat_curve_scheme scheme = bat_curve_scheme_angle(tension);
    scheme.sign = sign;
    scheme.adaptive = adaptive;
    return scheme;
}

/// mu* of table 1.
static bat_status search(noise_state *state, bat_curve_angle_sign sign, double *tension)
{
    bat_tension_search_options options = bat_tension_search_defaults();
    options.scheme.sign = sign;
    options.threads = state->options->threads;
    return bat_tension_search(state->control, state->truth, state->count, &options, tension, state->error);
}

static bat_status fill_rows(noise_state *state, bat_tension_noise_row *rows)
{
    double best_printed = 0, best_outward = 0;
    bat_status status = search(state, BAT_CURVE_ANGLE_SIGN_PRINTED, &best_printed);
    if (status == BAT_OK)
        status = search(state, BAT_CURVE_ANGLE_SIGN_OUTWARD, &best_outward);
    const struct
    {
        const char *method;
        bat_curve_scheme scheme;
    } methods[BAT_TENSION_NOISE_METHODS] = {
        {"four-point-printed", angle(BAT_CURVE_TENSION_FOUR_POINT, BAT_CURVE_ANGLE_SIGN_PRINTED, false)},
        {"six-point-printed", angle(BAT_CURVE_TENSION_SIX_POINT, BAT_CURVE_ANGLE_SIGN_PRINTED, false)},
        {"adaptive-heuristic-printed", angle(best_printed, BAT_CURVE_ANGLE_SIGN_PRINTED, true)},
        {"four-point-outward", angle(BAT_CURVE_TENSION_FOUR_POINT, BAT_CURVE_ANGLE_SIGN_OUTWARD, false)},
        {"six-point-outward", angle(BAT_CURVE_TENSION_SIX_POINT, BAT_CURVE_ANGLE_SIGN_OUTWARD, false)},
        {"adaptive-heuristic", angle(best_outward, BAT_CURVE_ANGLE_SIGN_OUTWARD, true)},
    };
    const double share = 1.0 / BAT_TENSION_NOISE_METHODS;
    for (size_t m = 0; m < BAT_TENSION_NOISE_METHODS && status == BAT_OK; m++)
    {
        progress_part part = {state->options->progress, (double)m * share, share};
        status = fill_row(state, methods[m].method, &methods[m].scheme, progress_of_part(&part), &rows[m]);
    }
    return status;
}

bat_status bat_tension_table2(const bat_tension_noise_options *options, bat_tension_noise_row *rows, bat_error *error)
{
    bat_tension_noise_options defaults = bat_tension_noise_defaults();
    noise_state state;
    bat_status status = state_make(options != NULL ? options : &defaults, &state, error);
    if (status == BAT_OK)
        status = fill_rows(&state, rows);
    state_free(&state);
    return status;
}

bat_status bat_tension_table2_method(const char *method, const bat_curve_scheme *scheme,
                                     const bat_tension_noise_options *options, bat_tension_noise_row *row, bat_error *error)
{
    bat_tension_noise_options defaults = bat_tension_noise_defaults();
    noise_state state;
    bat_status status = state_make(options != NULL ? options : &defaults, &state, error);
    if (status == BAT_OK)
        status = fill_row(&state, method, scheme, state.options->progress, row);
    state_free(&state);
    return status;
}
