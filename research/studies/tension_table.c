/// @file
/// Tables 1 and 5 of Ugail and Howard (2026): distance, bending energy and exterior angles of refined curves, for built-in
/// and any other schemes.

#include "batten/research/curve_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Section 7.1: the grid of the oracle. (The text counts 21 values; from -0.5 to 0.05 in steps of 0.025 there are 23.)
static const double GRID_LOW = -0.5, GRID_HIGH = 0.05;
enum
{
    GRID_COUNT = 23,
    /// Number of measurements for the built-in rows of one set, including the two searches.
    BUILT_IN_STEPS = 2 * GRID_COUNT + BAT_TENSION_METHODS,
};

/// The control polygons and true curves of one space, and the number of levels.
typedef struct case_set
{
    const char *name;
    const bat_curve *control, *truth;
    size_t count, levels;
} case_set;

/// The measures of a refined curve, in the order of `numbers`.
enum
{
    MEAN_NN,
    HAUSDORFF,
    BENDING,
    G1,
    MEASURES
};

/// Measure one method on one curve of a set. The measures are stored in numbers[i], numbers[i + set->count], …
static bat_status measure_one(const case_set *set, size_t i, const bat_curve_scheme *scheme, double *numbers,
                              bat_error *error)
{
    bat_curve_refine_options refine = bat_curve_refine_defaults();
    refine.scheme = *scheme;
    refine.levels = set->levels;
    refine.threads = 1;
    refine.simple = BAT_CURVE_SIMPLE_NEVER; // the published program has no such test
    bat_curve_measure_options measure = bat_curve_measure_defaults();
    measure.threads = 1;
    bat_curve fine;
    bat_curve_distance distance;
    bat_curve_fairness_values fairness;
    bat_status status = bat_curve_refine(&set->control[i], &refine, &fine, error);
    if (status != BAT_OK)
        return status;
    status = bat_curve_compare(&fine, &set->truth[i], &measure, &distance, error);
    if (status == BAT_OK)
        status = bat_curve_fairness(&fine, &measure, &fairness, error);
    bat_curve_free(&fine);
    if (status != BAT_OK)
        return status;
    numbers[MEAN_NN * set->count + i] = distance.mean_nn;
    numbers[HAUSDORFF * set->count + i] = distance.hausdorff;
    numbers[BENDING * set->count + i] = fairness.bending;
    numbers[G1 * set->count + i] = fairness.g1;
    return BAT_OK;
}

/// Measure one method on all curves of a set. `numbers` receives MEASURES x set->count numbers.
static bat_status measure_set(const case_set *set, const bat_curve_scheme *scheme, int threads, double *numbers,
                              bat_error *error)
{
    shared_work work = shared_work_make(set->count, (bat_progress){0});
    threads = threads_for(threads, set->count);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < set->count; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error own;
        bat_status status = measure_one(set, i, scheme, numbers, &own);
        shared_work_finish(&work, i, status, &own);
    }
    bat_error first;
    bat_status status = shared_work_end(&work, &first);
    if (status != BAT_OK)
        return error_set(error, status, first.index, 0, "%s curve %zu: %.180s", set->name, work.failed, first.text);
    return BAT_OK;
}

/// State of the computation of a table.
typedef struct table_state
{
    double *numbers; ///< measures of one method on one set
    int threads;
    bat_progress progress;
    size_t done, total; ///< number of measurements
    bat_error *error;
} table_state;

static bat_status step(table_state *state, const case_set *set, const bat_curve_scheme *scheme)
{
    bat_status status = measure_set(set, scheme, state->threads, state->numbers, state->error);
    state->done++;
    if (status == BAT_OK && state->progress.report != NULL &&
        !state->progress.report(state->progress.context, (double)state->done / (double)state->total))
        return error_set(state->error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
    return status;
}

/// Whether the scheme's angles are those of eq. (9).
static bool has_tension(const bat_curve_scheme *scheme)
{
    return scheme->kind == BAT_CURVE_SCHEME_KIND_ANGLE && scheme->rule == NULL;
}

static bat_status fill_row(table_state *state, const case_set *set, const bat_tension_method *method, bat_tension_row *row)
{
    const bat_curve_scheme *scheme = &method->scheme;
    bat_status status = step(state, set, scheme);
    *row = (bat_tension_row){.space = set->name,
                             .method = method->name,
                             .tension = has_tension(scheme) ? scheme->tension : NAN,
                             .fairness = method->fairness,
                             .published_mean_nn = NAN,
                             .published_bending = NAN,
                             .published_g1 = NAN};
    bat_curve_summary *summaries[MEASURES] = {&row->mean_nn, &row->hausdorff, &row->bending, &row->g1};
    for (size_t m = 0; m < MEASURES && status == BAT_OK; m++)
        status = bat_curve_summarize(state->numbers + m * set->count, set->count, summaries[m], state->error);
    return status;
}

static bat_curve_scheme angle(double tension, bat_curve_angle_sign sign, bool adaptive)
{
    bat_curve_scheme scheme = bat_curve_scheme_angle(tension);
    scheme.sign = sign;
    scheme.adaptive = adaptive;
    return scheme;
}

/// The tension of a grid with the smallest mean of mean_nn.
static bat_status search_tension(table_state *state, const case_set *set, const bat_tension_search_options *options,
                                 double *best)
{
    double minimum = INFINITY, spacing = (options->high - options->low) / (double)(options->count - 1);
    *best = options->low;
    for (size_t i = 0; i < options->count; i++)
    {
        bat_curve_scheme scheme = options->scheme;
        scheme.tension = options->low + (double)i * spacing;
        bat_curve_summary mean_nn;
        bat_status status = step(state, set, &scheme);
        if (status == BAT_OK)
            status = bat_curve_summarize(state->numbers + MEAN_NN * set->count, set->count, &mean_nn, state->error);
        if (status != BAT_OK)
            return status;
        if (mean_nn.mean < minimum)
        {
            minimum = mean_nn.mean;
            *best = scheme.tension;
        }
    }
    return BAT_OK;
}

static bat_status search_published(table_state *state, const case_set *set, bat_curve_angle_sign sign, double *best)
{
    bat_tension_search_options options = bat_tension_search_defaults();
    options.scheme.sign = sign;
    return search_tension(state, set, &options, best);
}

/// The rows of a set: the caller's methods, or the built-in ones if there are none.
typedef struct row_maker
{
    size_t rows;
    const bat_tension_method *methods;
} row_maker;

static const row_maker BUILT_IN = {.rows = BAT_TENSION_METHODS};

/// Number of measurements for the rows of one set.
static size_t steps_of(const row_maker *make)
{
    return make->methods != NULL ? make->rows : BUILT_IN_STEPS;
}

static bat_status fill_method_rows(table_state *state, const case_set *set, const bat_tension_method *methods, size_t count,
                                   bat_tension_row *rows)
{
    bat_status status = BAT_OK;
    for (size_t m = 0; m < count && status == BAT_OK; m++)
        status = fill_row(state, set, &methods[m], &rows[m]);
    return status;
}

static bat_status fill_built_in_rows(table_state *state, const case_set *set, bat_tension_row *rows)
{
    double best_printed = 0, best_outward = 0;
    bat_status status = search_published(state, set, BAT_CURVE_ANGLE_SIGN_PRINTED, &best_printed);
    if (status == BAT_OK)
        status = search_published(state, set, BAT_CURVE_ANGLE_SIGN_OUTWARD, &best_outward);
    if (status != BAT_OK)
        return status;
    const bat_tension_method methods[BAT_TENSION_METHODS] = {
        {"four-point-printed", NAN, angle(BAT_CURVE_TENSION_FOUR_POINT, BAT_CURVE_ANGLE_SIGN_PRINTED, false)},
        {"six-point-printed", NAN, angle(BAT_CURVE_TENSION_SIX_POINT, BAT_CURVE_ANGLE_SIGN_PRINTED, false)},
        {"four-point-outward", NAN, angle(BAT_CURVE_TENSION_FOUR_POINT, BAT_CURVE_ANGLE_SIGN_OUTWARD, false)},
        {"six-point-outward", NAN, angle(BAT_CURVE_TENSION_SIX_POINT, BAT_CURVE_ANGLE_SIGN_OUTWARD, false)},
        {"log-exp-4", NAN, bat_curve_scheme_log_exp(bat_mask_four_point(BAT_MASK_FOUR_POINT_WEIGHT))},
        {"log-exp-6", NAN, bat_curve_scheme_log_exp(bat_mask_six_point(BAT_MASK_SIX_POINT_WEIGHT))},
        {"oracle-printed", NAN, angle(best_printed, BAT_CURVE_ANGLE_SIGN_PRINTED, false)},
        {"oracle-outward", NAN, angle(best_outward, BAT_CURVE_ANGLE_SIGN_OUTWARD, false)},
        {"adaptive-heuristic-printed", NAN, angle(best_printed, BAT_CURVE_ANGLE_SIGN_PRINTED, true)},
        {"adaptive-heuristic", NAN, angle(best_outward, BAT_CURVE_ANGLE_SIGN_OUTWARD, true)},
    };
    return fill_method_rows(state, set, methods, BAT_TENSION_METHODS, rows);
}

/// The published numbers of a method, by its index among the built-in ones.
typedef struct published
{
    size_t method;
    double mean_nn, bending, g1;
} published;

static void set_published(bat_tension_row *rows, const published *published_numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        bat_tension_row *row = &rows[published_numbers[i].method];
        row->published_mean_nn = published_numbers[i].mean_nn;
        row->published_bending = published_numbers[i].bending;
        row->published_g1 = published_numbers[i].g1;
    }
}

enum
{
    PUBLISHED_ROWS = 6
};

/// Table 1, plane, sphere, disk: four-point, six-point, log-exp 4, log-exp 6, best fixed tension, adaptive heuristic.
static const published TABLE1[BAT_TENSION_SPACE_COUNT][PUBLISHED_ROWS] = {
    {{0, 0.03538, 1477.5, 2.655},
     {1, 0.03623, 2355.3, 2.824},
     {4, 0.00971, 2025.7, 0.496},
     {5, 0.00884, 2788.4, 0.359},
     {6, 0.03525, 1374.1, 2.630},
     {8, 0.02481, 682, 1.48}},
    {{0, 0.06082, 517.4, 2.144},
     {1, 0.06471, 782.0, 2.289},
     {4, 0.03971, 1369.3, 0.512},
     {5, 0.04000, 1298.5, 0.410},
     {6, 0.06015, 475.3, 2.139},
     {8, 0.05344, 242, 1.22}},
    {{0, 0.02937, 23195.5, 2.758},
     {1, 0.02939, 25074.4, 2.912},
     {4, 0.00436, 1591.1, 0.309},
     {5, 0.00338, 735.8, 0.205},
     {6, 0.02937, 23428.4, 2.792},
     {8, 0.01824, 19641, 1.53}},
};

/// The learned predictor in table 1 and in table 5.
static const published LEARNED1[BAT_TENSION_SPACE_COUNT] = {
    {0, 0.01636, 20.9, 0.237}, {0, 0.04905, 13.8, 0.231}, {0, 0.00435, 17403.9, 0.160}};
static const published LEARNED5 = {0, 0.00699, 76.0, 0.721};

/// Table 5. Its column "Hausdorff" contains mean nearest-neighbour distances.
static const published TABLE5[] = {{0, 0.00414, 129.6, 2.235}, {1, 0.00529, 253.6, 2.906}};

static bat_status state_make(table_state *state, size_t max_curves, size_t steps)
{
    state->total = steps;
    state->numbers = memory_array(MEASURES * max_curves, sizeof *state->numbers);
    return state->numbers != NULL ? BAT_OK : error_memory(state->error, MEASURES * max_curves * sizeof *state->numbers);
}

static bat_status fill_rows(table_state *state, const case_set *set, const row_maker *make, bat_tension_row *rows)
{
    return make->methods != NULL ? fill_method_rows(state, set, make->methods, make->rows, rows)
                                 : fill_built_in_rows(state, set, rows);
}

/// Fill in the published numbers of the rows of one set.
static void set_published_rows(bat_tension_row *rows, const row_maker *make, const published *published_numbers,
                               size_t count, const published *learned)
{
    if (make->methods == NULL)
        set_published(rows, published_numbers, count);
    for (size_t m = 0; m < make->rows && make->methods != NULL; m++)
        if (strcmp(make->methods[m].name, BAT_TENSION_LEARNED_PUBLISHED) == 0)
            set_published(&rows[m], learned, 1);
}

static bat_status fill_space(table_state *state, const bat_tension_set *set, const bat_space *space, const row_maker *make,
                             bat_tension_row *rows)
{
    bat_curve *curves = memory_array(2 * set->count, sizeof *curves);
    if (curves == NULL)
        return error_memory(state->error, 2 * set->count * sizeof *curves);
    for (size_t i = 0; i < set->count; i++)
    {
        curves[i] = bat_tension_control(set, i, space);
        curves[set->count + i] = bat_tension_truth(set, i, space);
    }
    case_set cases = {space->name, curves, curves + set->count, set->count, BAT_TENSION_LEVELS};
    bat_status status = fill_rows(state, &cases, make, rows);
    free(curves);
    return status;
}

/// The curves of all three spaces; free each set.
static bat_status make_sets(bat_tension_set_kind kind, bat_tension_set *sets, bat_error *error)
{
    bat_status status = BAT_OK;
    if (kind == BAT_TENSION_SET_KIND_PUBLISHED)
    {
        bat_tension_data data;
        status = bat_tension_data_make(&data, error);
        for (int s = 0; s < BAT_TENSION_SPACE_COUNT && status == BAT_OK; s++)
        {
            sets[s] = data.validation[s];
            bat_tension_set_free(&data.train[s]);
        }
        return status;
    }
    for (int s = 0; s < BAT_TENSION_SPACE_COUNT && status == BAT_OK; s++)
        status = bat_tension_set_make((bat_tension_space)s, kind, BAT_TENSION_TEST_CURVES, BAT_TENSION_TEST_SEED, &sets[s],
                                      error);
    return status;
}

static bat_status make_table1(bat_tension_set_kind kind, const row_maker *make, bat_tension_row *rows, int threads,
                              bat_progress progress, bat_error *error)
{
    const bat_space spaces[BAT_TENSION_SPACE_COUNT] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    bat_tension_set sets[BAT_TENSION_SPACE_COUNT] = {{0}};
    table_state state = {.threads = threads, .progress = progress, .error = error};
    bat_status status = make_sets(kind, sets, error);
    size_t maximum = 0;
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        maximum = sets[s].count > maximum ? sets[s].count : maximum;
    if (status == BAT_OK)
        status = state_make(&state, maximum, BAT_TENSION_SPACE_COUNT * steps_of(make));
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT && status == BAT_OK; s++, rows += make->rows)
    {
        status = fill_space(&state, &sets[s], &spaces[s], make, rows);
        if (status == BAT_OK && kind == BAT_TENSION_SET_KIND_PUBLISHED)
            set_published_rows(rows, make, TABLE1[s], PUBLISHED_ROWS, &LEARNED1[s]);
    }
    free(state.numbers);
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        bat_tension_set_free(&sets[s]);
    return status;
}

static bat_status make_table5(const row_maker *make, bat_tension_row *rows, int threads, bat_progress progress,
                              bat_error *error)
{
    bat_space sphere = bat_sphere(2);
    bat_curve truth, control;
    bat_status status = bat_tension_iss_track(&sphere, &truth, &control, error);
    if (status != BAT_OK)
        return status;
    table_state state = {.threads = threads, .progress = progress, .error = error};
    status = state_make(&state, 1, steps_of(make));
    case_set cases = {sphere.name, &control, &truth, 1, BAT_TENSION_LEVELS};
    if (status == BAT_OK)
        status = fill_rows(&state, &cases, make, rows);
    if (status == BAT_OK)
        set_published_rows(rows, make, TABLE5, sizeof TABLE5 / sizeof TABLE5[0], &LEARNED5);
    free(state.numbers);
    bat_curve_free(&truth);
    bat_curve_free(&control);
    return status;
}

bat_status bat_tension_table1(bat_tension_set_kind curves, bat_tension_row *rows, int threads, bat_progress progress,
                              bat_error *error)
{
    return make_table1(curves, &BUILT_IN, rows, threads, progress, error);
}

bat_status bat_tension_table5(bat_tension_row *rows, int threads, bat_progress progress, bat_error *error)
{
    return make_table5(&BUILT_IN, rows, threads, progress, error);
}

static bat_status check_methods(const bat_tension_method *methods, size_t count, bat_error *error)
{
    if (methods == NULL || count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a table needs at least one method");
    return BAT_OK;
}

bat_status bat_tension_table1_methods(bat_tension_set_kind curves, const bat_tension_method *methods, size_t count,
                                      bat_tension_row *rows, int threads, bat_progress progress, bat_error *error)
{
    bat_status status = check_methods(methods, count, error);
    return status == BAT_OK ? make_table1(curves, &(row_maker){count, methods}, rows, threads, progress, error) : status;
}

bat_status bat_tension_table5_methods(const bat_tension_method *methods, size_t count, bat_tension_row *rows, int threads,
                                      bat_progress progress, bat_error *error)
{
    bat_status status = check_methods(methods, count, error);
    return status == BAT_OK ? make_table5(&(row_maker){count, methods}, rows, threads, progress, error) : status;
}

bat_tension_search_options bat_tension_search_defaults(void)
{
    return (bat_tension_search_options){.scheme = bat_curve_scheme_angle(0),
                                        .low = GRID_LOW,
                                        .high = GRID_HIGH,
                                        .count = GRID_COUNT,
                                        .levels = BAT_TENSION_LEVELS};
}

bat_status bat_tension_search(const bat_curve *coarse, const bat_curve *truth, size_t count,
                              const bat_tension_search_options *options, double *tension, bat_error *error)
{
    bat_tension_search_options defaults = bat_tension_search_defaults();
    options = options != NULL ? options : &defaults;
    if (count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there are no curves to search the tension with");
    if (!has_tension(&options->scheme) || options->count < 2 || !(options->low < options->high))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "a search needs an angle-based scheme and at least two tensions in a range");
    table_state state = {.threads = options->threads, .progress = options->progress, .error = error};
    bat_status status = state_make(&state, count, options->count);
    case_set cases = {coarse->space->name, coarse, truth, count, options->levels};
    double best = 0;
    if (status == BAT_OK)
        status = search_tension(&state, &cases, options, &best);
    if (status == BAT_OK)
        *tension = best;
    free(state.numbers);
    return status;
}
