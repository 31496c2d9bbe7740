/// @file
/// The adaptive fitting loop of Giannelli, Imperatore, Mantzaflaris and Scholz, "BIDGCN" (2023), section 5, after Kiss et
/// al. (2014):
///     repeat  fit: solve (G + 2 lambda M) c = b  (system.h)
///             correct: move parameters to foot points  (points.h)
///             stop if the tolerance or the budget is reached
///             mark and refine cells  (marking.c)
/// The default criterion for lambda is restricted likelihood. With `robust`, points are re-weighted after every measurement.

#include "base/choice.h"
#include "base/option.h"
#include "base/progress.h"
#include "surface/fit/loop.h"

#include <string.h>

enum
{
    /// Fewest points of a cell that is refined where no size is given. Functions of finer cells would be free beside the
    /// points, above all at the border, which points at random places do not reach.
    POINTS_IN_CELL = 12,
    POINTS_PER_FUNCTION = 4, ///< fewest points for each function, when neither a tolerance nor a budget is set,
    POINTS_IN_TOLERANCE = 2, ///< and beside a tolerance,
    POINTS_IN_TENSOR = 1,    ///< and of a tensor product, whose smoothing is the same everywhere
    HOLD_OUT = 10,           ///< one in this many points is held out by default,
    HOLD_OUT_MIN = 200,      ///< of at least this many points
    MAX_HOLD_OUT = 1000,
    SMALL_SYSTEM = 500, ///< functions up to which weights cost next to nothing to try
    TRIALS_FIRST = 12,  ///< weights evaluated in the first round and for small systems,
    TRIALS = 4,         ///< for larger systems,
    TRIALS_LAST = 6,    ///< and in the round that fills the budget
    NEWTON_STEPS = 3,   ///< Newton steps of a parameter in one correction
    MAX_ROUNDS = 1000   ///< the largest number of rounds in the options
};

// Newton's method for a parameter stops when a step is at most this long, in cells.
static const double STEP_TOLERANCE = 1e-3;
// Parameters are corrected when at least NEAR_SHARE of the points are within this many sides of their cell. While a surface
// is stiff, feet may be at other places of it, and corrections would fold the parameters of deep shapes. Corrections of a
// fit whose size is free begin with STIFF_REACH: a coarse surface swings beyond a curved edge, where feet would leave a part
// of the square empty, in which the surface then folds. Where distances fall by less than SLOW in a round, which noise and
// narrow features cause too, it waits no longer.
static const double CORRECTION_REACH = 0.25;
static const double STIFF_REACH = 0.025;
static const double SLOW = 0.7;
static const double NEAR_SHARE = 0.9;
// The expected squared distances of new points fall, when they do by this many standard errors of their fall over the
// points. Refinement ends when they have not, with the functions more by STALL_GROWTH and STALL_MORE: a few coarse cells do
// not reach a narrow feature.
static const double FALL_ERRORS = 2;
static const double STALL_GROWTH = 2.2;
static const double STALL_MORE = 64;
// Weight of held-out points in the expected squared distance: the other part is generalized cross-validation.
static const double HELD_OUT_SHARE = 1.0 / 3;
// A budget counts as filled from this fraction on, because refinement adds at least a few functions at a time.
static const double BUDGET_FILLED = 0.99;
// Distances of held-out points below this fraction of the size of the point set are as good as none.
static const double EXACT = 1e-9;
// Distances below this fraction are rounding errors.
static const double ROUNDING = 1e-13;

bat_surface_fit_options bat_surface_fit_defaults(void)
{
    return (bat_surface_fit_options){
        .space = {.degree = {3, 3}, .spans = {1, 1}, .truncated = true},
        .share = 1,
        .hold_out = HOLD_OUT,
        .iterations = 30,
        .neighbours = 1,
        .smoothing = BAT_SURFACE_SMOOTHING_LIKELIHOOD,
        .corrections = 1,
        .restarts = true,
    };
}

void bat_surface_fit_report_free(bat_surface_fit_report *report)
{
    free(report->rounds);
    free(report->distances);
    *report = (bat_surface_fit_report){0};
}

static const bat_choice SMOOTHINGS[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "restricted maximum likelihood", BAT_SURFACE_SMOOTHING_AUTO),
    CHOICE("likelihood", "restricted maximum likelihood", BAT_SURFACE_SMOOTHING_LIKELIHOOD),
    CHOICE("cross-validation", "generalized cross-validation", BAT_SURFACE_SMOOTHING_CROSS_VALIDATION),
    CHOICE("noise", "restricted maximum likelihood with the noise that is given", BAT_SURFACE_SMOOTHING_NOISE),
    CHOICE("given", "the weight of the options", BAT_SURFACE_SMOOTHING_GIVEN),
};
const bat_family bat_surface_smoothing_family = FAMILY("choice of smoothing", SMOOTHINGS);

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_surface_fit_options, tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_surface_fit_options, share, OPTION_ABOVE, 0, 1),
    OPTION_FIELD(bat_surface_fit_options, hold_out, OPTION_INT, 0, MAX_HOLD_OUT),
    OPTION_FIELD(bat_surface_fit_options, iterations, OPTION_INT, 0, MAX_ROUNDS),
    OPTION_FIELD(bat_surface_fit_options, neighbours, OPTION_INT, 0, BAT_SURFACE_FIT_MAX_NEIGHBOURS),
    OPTION_FAMILY(bat_surface_fit_options, smoothing, bat_surface_smoothing_family),
    OPTION_FIELD(bat_surface_fit_options, weight, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_surface_fit_options, noise, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_surface_fit_options, corrections, OPTION_INT, 0, MAX_ROUNDS),
    OPTION_FIELD(bat_surface_fit_options, final_corrections, OPTION_INT, 0, MAX_ROUNDS),
    OPTION_THREADS(bat_surface_fit_options),
    OPTION_STRUCT(bat_surface_fit_options, space, bat_hierarchical_fields),
};

static bat_status surface_fit_options_check(const void *opaque, bat_error *error)
{
    const bat_surface_fit_options *options = opaque;
    if (options->smoothing == BAT_SURFACE_SMOOTHING_NOISE && !(options->noise > 0))
        return error_option(error, "noise", "is %.10g, but must be finite and above 0", options->noise);
    if (options->hold_out == 1)
        return error_option(error, "hold_out", "is 1, but must be 0 or 2 to %d", MAX_HOLD_OUT);
    return BAT_OK;
}

const bat_options_table bat_surface_fit_fields = OPTIONS_TABLE(bat_surface_fit_options, FIELDS, surface_fit_options_check);

static void loop_free_fit(fit_loop *loop)
{
    fit_solver_free(loop->solver);
    loop->solver = NULL;
    fit_system_free(&loop->system);
    fit_nets_free(&loop->nets);
    free(loop->control);
    loop->control = NULL;
}

static bool can_be_held_out(const fit_points *points, size_t row)
{
    return points->freedom[row] == FIT_FREE && points->number[row] < points->guides;
}

/// Hold out one in some free points along the Morton curve.
static bat_status hold_out(fit_loop *loop, bat_error *error)
{
    fit_points *points = &loop->points;
    uint64_t step = (uint64_t)loop->options->hold_out, passed = 0, count = 0;
    loop->held = memory_array(points->count, sizeof *loop->held);
    loop->best.parameter = memory_array(points->count, 2 * sizeof *loop->best.parameter);
    loop->best.distance = memory_array(points->count, sizeof *loop->best.distance);
    if (loop->held == NULL || loop->best.parameter == NULL || loop->best.distance == NULL)
        return error_memory(error, points->count * 2 * sizeof *loop->best.parameter);
    for (size_t row = 0; row < points->count; row++)
        count += can_be_held_out(points, row);
    bat_status status = team_sum_before(points->team, count, &passed, error);
    count = 0;
    for (size_t row = 0; row < points->count; row++)
    {
        passed += can_be_held_out(points, row);
        loop->held[row] = can_be_held_out(points, row) && passed % step == step / 2;
        count += loop->held[row];
        if (loop->held[row])
            points->weight[row] = 0;
    }
    if (status == BAT_OK)
        status = team_sum_counts(points->team, &count, 1, error);
    loop->held_count = (size_t)count;
    return status;
}

static double held_weight(const fit_loop *loop, size_t row)
{
    return !loop->held[row] ? 0 : loop->options->robust ? loop->points.weight[row] : 1;
}

/// Sums over the points that are held out, then over the others without samples of border curves.
static void held_terms(const void *context, size_t row, double *sums)
{
    const fit_loop *loop = context;
    double weight = held_weight(loop, row), distance = loop->points.distance[row];
    sums[0] += weight * distance * distance;
    sums[1] += weight;
    if (loop->held[row] || loop->points.number[row] >= loop->points.own)
        return;
    weight = loop->points.weight[row];
    sums[2] += weight * distance * distance;
    sums[3] += weight;
}

/// Measure the distances of the points that are held out, and take these out of the fit.
static bat_status measure_held_out(fit_loop *loop, bat_error *error)
{
    fit_points *points = &loop->points;
    double sums[4];
    bat_status status =
        fit_sum_points(points->team, points->count, held_terms, loop, 4, loop->options->threads, sums, error);
    loop->held_largest = 0;
    for (size_t row = 0; row < points->count; row++)
    {
        if (held_weight(loop, row) > 0)
            loop->held_largest = fmax(loop->held_largest, points->distance[row]);
        if (loop->held[row])
            points->weight[row] = 0;
    }
    if (status == BAT_OK)
        status = team_largest(points->team, &loop->held_largest, 1, error);
    loop->held_rms = sums[1] > 0 ? sqrt(sums[0] / sums[1]) : NAN;
    loop->left = sums[3] > 0 ? 1 - loop->trace / sums[3] : NAN;
    // A geometric mean of the distance of held-out points, which is unbiased, and of generalized cross-validation,
    // R / N / (1 - T / N)^2, which varies less.
    loop->expected =
        loop->left > 0 ? pow(sqrt(sums[2] / sums[3]) / loop->left, 1 - HELD_OUT_SHARE) * pow(loop->held_rms, HELD_OUT_SHARE)
                       : loop->held_rms;
    return status;
}

/// @param team    null for one process
/// @param numbers of a part; null where all points are here
static bat_status loop_make(const fit_team *team, const bat_surface_fit_data *data, const uint32_t *numbers,
                            const bat_surface_fit_options *options, fit_loop *loop, bat_error *error)
{
    *loop = (fit_loop){.options = options, .team = team, .begin = clock_seconds()};
    if (array_make(&loop->rounds, (size_t)options->iterations + 1, sizeof *loop->rounds, error) != BAT_OK)
        return BAT_NO_MEMORY;
    bat_status status = bat_hierarchical_space_make(&options->space, &loop->space, error);
    if (status == BAT_OK && numbers == NULL && data->border && data->boundary_count > 0)
        status = fit_border_make(data, options, &loop->border, error);
    if (numbers != NULL && data->curves != NULL)
    {
        loop->border = *data->curves;
        *data->curves = (fit_border){0};
    }
    if (status == BAT_OK)
        status = fit_border_points(&loop->border, team, data, numbers, options->space.truncated, &loop->points, error);
    if (status == BAT_OK && options->tensor)
        status = array_make(&loop->fixed, loop->points.count, 2 * sizeof *loop->fixed, error);
    if (status == BAT_OK && options->tensor)
        memcpy(loop->fixed, loop->points.parameter, 2 * loop->points.count * sizeof *loop->fixed);
    size_t fewest = options->tensor ? POINTS_IN_TENSOR : options->tolerance > 0 ? POINTS_IN_TOLERANCE : POINTS_PER_FUNCTION;
    loop->budget = options->functions > 0 ? options->functions : (loop->points.total + fewest - 1) / fewest;
    if (status == BAT_OK && options->hold_out > 0 && loop->points.total >= HOLD_OUT_MIN)
        status = hold_out(loop, error);
    loop->size = status == BAT_OK ? vector_largest(loop->points.count * loop->points.dimension, loop->points.position) : 0;
    return status == BAT_OK ? team_largest(loop->points.team, &loop->size, 1, error) : status;
}

/// Report the fraction of work done: the logarithmic progress towards the budget, or the fraction of iterations. False to
/// cancel. Serves as the progress callback of the search for lambda; its argument is ignored.
static bool loop_report(void *context, double unused BAT_UNUSED)
{
    fit_loop *loop = context;
    const bat_progress *progress = &loop->options->progress;
    double first = (double)(loop->count > 0 ? loop->rounds[0].functions : 1);
    double now = (double)bat_hierarchical_space_functions(loop->space);
    double share = (double)loop->count / ((double)loop->options->iterations + 1);
    if (loop->budget > 0 && (double)loop->budget > first && loop->count > 0)
        share = fmax(share, log(now / first) / log((double)loop->budget / first));
    loop->reported = fmax(loop->reported, fmin(share, 0.99));
    return progress->report == NULL || progress->report(progress->context, loop->reported);
}

static bat_status loop_check(fit_loop *loop, bat_error *error)
{
    bat_status status =
        loop_report(loop, 0) ? BAT_OK : error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the fit was stopped");
    return team_agree_with_first(loop->team, status, error);
}

/// Maximum number of weights to evaluate in this round.
static int trials_for(const fit_loop *loop)
{
    size_t functions = loop->system.functions;
    if (functions <= SMALL_SYSTEM || loop->count == 0)
        return TRIALS_FIRST;
    return loop->budget > 0 && (double)functions >= BUDGET_FILLED * (double)loop->budget ? TRIALS_LAST : TRIALS;
}

/// The coordinates of residuals that hold noise: correction removes the two along the surface.
static size_t noisy_coordinates(const fit_loop *loop)
{
    size_t dimension = loop->points.dimension;
    return !loop->corrects ? dimension : dimension > 3 ? dimension - 2 : 1;
}

/// Factor of the variance of residuals for the choice of a weight. In all coordinates together the noise has the ratio of
/// their numbers; its root is taken, because the whole ratio smooths too much where functions are few.
static double residual_spread(const fit_loop *loop)
{
    return sqrt((double)loop->points.dimension / (double)noisy_coordinates(loop));
}

/// Solve the system, on the first process with or without the others.
static bat_status solve_control(fit_loop *loop, bool search, bat_error *error)
{
    const bat_surface_fit_options *options = loop->options;
    const fit_team *team = loop->team;
    const fit_team_solver *solver = team != NULL ? &team->solver : &(fit_team_solver){0};
    bool given = options->smoothing == BAT_SURFACE_SMOOTHING_GIVEN, shares = solver->factor != NULL;
    fit_weight_search wanted = {.smoothing = search ? options->smoothing : BAT_SURFACE_SMOOTHING_GIVEN,
                                .noise = options->noise * sqrt(residual_spread(loop) * (double)noisy_coordinates(loop)),
                                .spread = residual_spread(loop),
                                .lambda = given ? options->weight : loop->lambda,
                                .trials = trials_for(loop),
                                .progress = {loop_report, loop}};
    bat_status status = BAT_OK;
    double trace = NAN;
    if (team_is_first(team))
        status = fit_weight_find(&loop->system, loop->solver, &wanted, &loop->lambda, &trace, loop->control, error);
    if (shares && team_is_first(team))
    {
        bat_status released = solver->release(solver->context, status == BAT_OK ? error : NULL);
        status = status == BAT_OK ? released : status;
    }
    else if (shares)
        status = solver->attend(solver->context, error);
    status = team_agree_with_first(team, status, error);
    if (status == BAT_OK)
        status = team_broadcast(team, &loop->lambda, sizeof loop->lambda, error);
    if (status == BAT_OK && search)
        status = team_broadcast(team, &trace, sizeof trace, error);
    if (search)
        loop->trace = trace;
    return status == BAT_OK ? team_broadcast(team, loop->control,
                                             loop->system.functions * loop->points.dimension * sizeof *loop->control, error)
                            : status;
}

/// Solve for the control points over the current space. Requires fit_points_locate().
/// @param search whether to search for lambda; otherwise the last one is used
static bat_status fit_control(fit_loop *loop, bool search, bat_error *error)
{
    const bat_surface_fit_options *options = loop->options;
    bat_status status = loop_check(loop, error);
    if (status == BAT_OK)
        status = fit_points_sort(&loop->points, loop->space, error);
    if (status == BAT_OK)
        status = fit_system_gather(&loop->system, &loop->points, error);
    if (status != BAT_OK)
        return status;
    status = solve_control(loop, search, error);
    fit_nets_free(&loop->nets);
    return status == BAT_OK
               ? fit_nets_make(loop->space, loop->control, loop->points.dimension, options->threads, &loop->nets, error)
               : status;
}

/// Leave boundary points on the edge to the border curves.
static void leave_out_edges(fit_loop *loop)
{
    fit_points *points = &loop->points;
    for (size_t row = 0; row < points->count; row++)
    {
        if (points->number[row] >= loop->border.boundary_count || (loop->held != NULL && loop->held[row]))
            continue;
        bool takes = fit_border_takes(&loop->border, points->number[row]);
        if (!takes || !loop->options->robust)
            points->weight[row] = takes ? 1 : 0;
    }
}

/// How near points must be before a round corrects their parameters.
static double reach_of_round(const fit_loop *loop)
{
    const bat_surface_fit_round *rounds = loop->rounds;
    size_t count = loop->count;
    // A surface of a given size may stay coarse.
    bool is_coarse = loop->options->iterations == 0 || loop->options->functions > 0;
    bool is_slow = count >= 2 && rounds[count - 1].rms > SLOW * rounds[count - 2].rms;
    return loop->corrects || is_coarse || is_slow ? CORRECTION_REACH : STIFF_REACH;
}

/// Measure distances, or move the parameters to foot points, and update the robust weights.
/// @param reach how near points must be, in sides of cells; 0: measure only
static bat_status measure_distances(fit_loop *loop, double reach, bat_error *error)
{
    fit_correction correction = {NEWTON_STEPS, STEP_TOLERANCE};
    int threads = loop->options->threads;
    size_t moved;
    bat_status status = loop_check(loop, error);
    double share = 0;
    if (status == BAT_OK && reach > 0)
        status = fit_near_share(&loop->nets, &loop->points, reach, threads, &share, error);
    bool correct = share >= NEAR_SHARE || loop->fixed != NULL;
    if (status == BAT_OK && !correct)
        status = fit_nets_measure(&loop->nets, &loop->points, threads, error);
    if (status == BAT_OK && correct)
        status = fit_correct(&loop->nets, &loop->points, correction, threads, &moved, error);
    if (status == BAT_OK && correct && loop->options->restarts)
        status = fit_correct_wrong_feet(&loop->nets, &loop->points, correction, threads, &moved, error);
    if (status == BAT_OK && loop->options->robust)
        status = fit_robust_weights(&loop->points, loop->size, &loop->outliers, error);
    if (status == BAT_OK && loop->held != NULL)
        status = measure_held_out(loop, error);
    if (loop->fixed != NULL)
        memcpy(loop->points.parameter, loop->fixed, 2 * loop->points.count * sizeof *loop->fixed);
    correct = correct && loop->fixed == NULL;
    loop->corrects = loop->corrects || correct;
    if (status == BAT_OK && correct && loop->border.samples > 0)
    {
        status = fit_border_update(&loop->border, &loop->nets, &loop->points, error);
        if (status == BAT_OK)
            leave_out_edges(loop);
    }
    return status;
}

static bat_status begin_round(fit_loop *loop, bat_error *error)
{
    size_t functions = bat_hierarchical_space_functions(loop->space);
    loop_free_fit(loop);
    bat_status status = fit_system_make(loop->space, loop->team, loop->points.dimension,
                                        loop->options->smoothing != BAT_SURFACE_SMOOTHING_GIVEN, loop->options->threads,
                                        &loop->system, error);
    if (status == BAT_OK)
        status = fit_solver_make_for(loop->team, &loop->system.pattern, &loop->solver, error);
    if (status != BAT_OK)
        return status;
    fit_points_locate(&loop->points, loop->space, loop->options->threads);
    loop->control = memory_array(functions * loop->points.dimension, sizeof *loop->control);
    return loop->control == NULL ? error_memory(error, functions * loop->points.dimension * sizeof *loop->control) : BAT_OK;
}

static void distance_terms(const void *context, size_t row, double *sums)
{
    const fit_loop *loop = context;
    double distance = loop->points.distance[row];
    if (loop->points.number[row] >= loop->points.own)
        return;
    sums[0] += distance * distance;
    sums[1] += distance <= loop->options->tolerance;
}

typedef struct worst_point
{
    double distance;
    uint64_t row; ///< among all points
    uint64_t number;
} worst_point;

static bat_status find_worst(const fit_points *points, worst_point *worst, bat_error *error)
{
    *worst = (worst_point){0};
    for (size_t row = 0; row < points->count; row++)
        if (points->number[row] < points->own && points->distance[row] > worst->distance)
            *worst = (worst_point){points->distance[row], points->before + row, points->number[row]};
    size_t *sizes;
    char *all;
    bat_status status = team_gather(points->team, worst, sizeof *worst, &sizes, &all, error);
    const worst_point *found = (const worst_point *)(void *)all;
    for (size_t rank = 0; status == BAT_OK && found != NULL && rank < team_count(points->team); rank++)
        if (found[rank].distance > worst->distance)
            *worst = found[rank];
    free(sizes);
    free(all);
    return status == BAT_OK ? team_broadcast(points->team, worst, sizeof *worst, error) : status;
}

static bat_status measure_round(const fit_loop *loop, bat_surface_fit_round *round, bat_error *error)
{
    const fit_points *points = &loop->points;
    worst_point worst = {0};
    double sums[2];
    bat_status status =
        fit_sum_points(points->team, points->count, distance_terms, loop, 2, loop->options->threads, sums, error);
    if (status == BAT_OK)
        status = find_worst(points, &worst, error);
    *round = (bat_surface_fit_round){.functions = loop->system.functions,
                                     .levels = bat_hierarchical_space_levels(loop->space),
                                     .mean_squared = sums[0] / (double)points->total,
                                     .rms = sqrt(sums[0] / (double)points->total),
                                     .largest = worst.distance,
                                     .worst = (size_t)worst.number,
                                     .within = sums[1] / (double)points->total,
                                     .held_out = loop->held != NULL ? loop->held_rms : NAN,
                                     .weight = loop->lambda,
                                     .seconds = clock_seconds() - loop->begin};
    return status;
}

/// Whether the goal is reached: the required share of points within the tolerance, or the budget, or an exact surface.
static bool has_reached(const fit_loop *loop, const bat_surface_fit_round *round)
{
    if (loop->options->tolerance == 0 && loop->stalled)
        return true;
    if (loop->options->tolerance > 0)
        return round->within >= loop->options->share;
    if (loop->options->functions == 0 && loop->held != NULL && loop->held_rms <= EXACT * loop->size)
        return true;
    bool filled = loop->full || (double)round->functions >= BUDGET_FILLED * (double)loop->budget;
    return filled || round->largest <= ROUNDING * loop->size;
}

/// Refine all cells, where the budget allows it.
static bat_status refine_all(const fit_loop *loop, bat_hierarchical_space **finer, bat_error *error)
{
    size_t cells = bat_hierarchical_space_cells(loop->space), functions;
    bat_spline_box *boxes = memory_array(cells, sizeof *boxes);
    if (boxes == NULL)
        return error_memory(error, cells * sizeof *boxes);
    for (size_t c = 0; c < cells; c++)
        boxes[c] = bat_hierarchical_space_cell(loop->space, c);
    bat_status status = hierarchical_space_refined(loop->space, boxes, cells, loop->budget, &functions, finer, error);
    free(boxes);
    return status;
}

/// Refine the marked cells.
/// @param refined receives whether any cell was refined
static bat_status refine_marked(fit_loop *loop, bool *refined, bat_error *error)
{
    const bat_surface_fit_options *options = loop->options;
    bool has_size = options->tolerance > 0 || options->functions > 0;
    fit_marking marking = {options->tolerance, loop->budget, has_size ? 0 : POINTS_IN_CELL, options->neighbours};
    bat_hierarchical_space *finer = NULL;
    bat_status status = fit_points_sort(&loop->points, loop->space, error);
    // Each process has two spaces for a while, and no room for the nets too.
    fit_nets_free(&loop->nets);
    if (status == BAT_OK)
        status = options->tensor ? refine_all(loop, &finer, error)
                                 : fit_mark_refine(loop->space, &loop->points, &marking, &finer, error);
    *refined = finer != NULL;
    loop->full = loop->budget > 0 && finer == NULL;
    if (status == BAT_OK && finer == NULL)
        status = fit_nets_make(loop->space, loop->control, loop->points.dimension, options->threads, &loop->nets, error);
    if (finer != NULL)
    {
        loop_free_fit(loop);
        bat_hierarchical_space_free(loop->space);
        loop->space = finer;
    }
    return status;
}

/// Sums over the points of how much their squared distances have fallen since the best round. Those of points that are not
/// held out are expected ones, by generalized cross-validation.
static void fall_terms(const void *context, size_t row, double *sums)
{
    const fit_loop *loop = context;
    if (loop->points.number[row] >= loop->points.own)
        return;
    bool held = loop->held[row];
    double now = loop->points.distance[row] / (held ? 1 : loop->left);
    double before = loop->best.distance[row] / (held ? 1 : loop->best.left);
    double fall = (held ? held_weight(loop, row) : loop->points.weight[row]) * (before * before - now * now);
    sums[0] += isfinite(fall) ? fall : 0;
    sums[1] += isfinite(fall) ? fall * fall : 0;
}

/// Whether the expected distances have fallen by more than some standard errors of their fall.
static bat_status has_fallen(const fit_loop *loop, bool *fallen, bat_error *error)
{
    const fit_points *points = &loop->points;
    double sums[2];
    bat_status status =
        fit_sum_points(points->team, points->count, fall_terms, loop, 2, loop->options->threads, sums, error);
    *fallen = status == BAT_OK && sums[0] > FALL_ERRORS * sqrt(sums[1] - sums[0] * sums[0] / (double)points->total);
    return status;
}

/// Compare the last round with the best one, and keep the better of them. Sets `stalled` where refinement ends.
static bat_status compare_held_out(fit_loop *loop, bat_error *error)
{
    const bat_surface_fit_round *round = &loop->rounds[loop->count - 1];
    fit_best *best = &loop->best;
    bool fallen = true;
    bat_status status = best->space != NULL ? has_fallen(loop, &fallen, error) : BAT_OK;
    if (status != BAT_OK)
        return status;
    if (best->space != NULL && !(fallen && loop->expected < best->expected))
    {
        double enough = STALL_GROWTH * (double)loop->rounds[best->round].functions + STALL_MORE;
        // A surface that is still far from the points is too stiff to tell.
        bool near = loop->corrects || loop->fixed != NULL || loop->options->corrections == 0;
        loop->stalled = near && (double)round->functions >= enough && loop->count > best->round + 2;
        return BAT_OK;
    }
    bat_hierarchical_space *copy;
    status = hierarchical_space_copy(loop->space, &copy, error);
    if (status != BAT_OK)
        return status;
    bat_hierarchical_space_free(best->space);
    best->space = copy;
    best->expected = loop->expected;
    best->left = loop->left;
    best->held_rms = loop->held_rms;
    best->held_largest = loop->held_largest;
    best->round = loop->count - 1;
    best->lambda = loop->lambda;
    memcpy(best->parameter, loop->points.parameter, 2 * loop->points.count * sizeof *best->parameter);
    memcpy(best->distance, loop->points.distance, loop->points.count * sizeof *best->distance);
    return BAT_OK;
}

/// Whether the held-out points choose the size of the space.
static bool has_free_size(const fit_loop *loop)
{
    return loop->held != NULL && loop->options->functions == 0;
}

/// Fit all points, the held-out ones too, in the final space: the best one, where held-out points choose it and the
/// tolerance is not reached. The round replaces that of the space.
static bat_status fit_all_points(fit_loop *loop, bat_error *error)
{
    fit_best *best = &loop->best;
    bool reached = loop->options->tolerance > 0 && has_reached(loop, &loop->rounds[loop->count - 1]);
    if (has_free_size(loop) && !reached && best->round + 1 < loop->count)
    {
        bat_hierarchical_space_free(loop->space);
        loop->space = best->space;
        best->space = NULL;
        loop->count = best->round + 1;
        loop->stalled = true;
        loop->lambda = best->lambda;
        loop->expected = best->expected;
        loop->held_rms = best->held_rms;
        loop->held_largest = best->held_largest;
        memcpy(loop->points.parameter, best->parameter, 2 * loop->points.count * sizeof *best->parameter);
    }
    for (size_t row = 0; row < loop->points.count; row++)
        if (loop->held[row])
            loop->points.weight[row] = 1;
    free(loop->held);
    loop->held = NULL;
    bat_status status =
        loop->options->robust ? fit_robust_weights(&loop->points, loop->size, &loop->outliers, error) : BAT_OK;
    if (status == BAT_OK)
        status = begin_round(loop, error);
    if (status == BAT_OK)
        status = fit_control(loop, true, error);
    return status == BAT_OK ? measure_distances(loop, loop->options->corrections > 0 ? CORRECTION_REACH : 0, error) : status;
}

static bat_status run_rounds(fit_loop *loop, bat_error *error)
{
    const fit_team *team = loop->team;
    bat_status loaded = team != NULL && team->load != NULL ? team->load(team, loop, error) : BAT_OK;
    if (loaded != BAT_OK)
        return loaded;
    for (bool refined = true; refined;)
    {
        bat_status status = begin_round(loop, error);
        if (status == BAT_OK)
            status = fit_control(loop, true, error);
        if (status == BAT_OK && loop->options->corrections == 0)
            status = measure_distances(loop, 0, error);
        for (int k = 0; k < loop->options->corrections && status == BAT_OK; k++)
        {
            if (k > 0)
                status = fit_control(loop, false, error);
            if (status == BAT_OK)
                status = measure_distances(loop, reach_of_round(loop), error);
        }
        if (status != BAT_OK)
            return status;
        bat_surface_fit_round *round = &loop->rounds[loop->count++];
        status = measure_round(loop, round, error);
        if (status == BAT_OK && has_free_size(loop))
            status = compare_held_out(loop, error);
        if (status != BAT_OK || loop->stalled || has_reached(loop, round) || loop->count > (size_t)loop->options->iterations)
            return status;
        status = refine_marked(loop, &refined, error);
        if (status == BAT_OK && refined && team != NULL && team->save != NULL)
            status = team->save(team, loop, error);
        if (status != BAT_OK)
            return status;
    }
    return BAT_OK;
}

static bat_status run(fit_loop *loop, bat_error *error)
{
    bool holds = loop->held != NULL;
    bat_status status = run_rounds(loop, error);
    if (status == BAT_OK && holds)
        status = fit_all_points(loop, error);
    if (status == BAT_OK)
    {
        int rounds = loop->options->final_corrections;
        if (rounds > 0 && loop->options->corrections == 0)
            status = measure_distances(loop, CORRECTION_REACH, error);
        for (int k = 0; k < rounds && status == BAT_OK; k++)
        {
            status = fit_control(loop, k == 0, error);
            if (status == BAT_OK)
                status = measure_distances(loop, CORRECTION_REACH, error);
        }
    }
    if (status == BAT_OK)
        status = measure_round(loop, &loop->rounds[loop->count - 1], error);
    if (status == BAT_OK)
        loop->rounds[loop->count - 1].held_out = holds ? loop->held_rms : NAN;
    return status;
}

static bat_status store_result(fit_loop *loop, bat_surface_fit_data *data, bat_spline_surface *surface,
                               bat_surface_fit_report *report, bat_error *error)
{
    double *distances = report == NULL ? NULL : memory_array(data->count, sizeof *distances);
    if (report != NULL && distances == NULL)
        return error_memory(error, data->count * sizeof *distances);
    for (size_t row = 0; report != NULL && row < loop->points.count; row++)
        if (loop->points.is_part || loop->points.number[row] < loop->points.own)
            distances[loop->points.is_part ? row : loop->points.number[row]] = loop->points.distance[row];
    uint64_t changed = fit_points_return(&loop->points, data);
    bat_status status = team_sum_counts(loop->team, &changed, 1, error);
    if (status != BAT_OK)
    {
        free(distances);
        return status;
    }
    bool holds = isfinite(loop->rounds[loop->count - 1].held_out);
    fit_points_restore(&loop->points, loop->system.functions, loop->control);
    if (report != NULL)
        *report = (bat_surface_fit_report){.rounds = loop->rounds,
                                           .count = loop->count,
                                           .distances = distances,
                                           .moved = (size_t)changed,
                                           .outliers = loop->outliers,
                                           .stalled = loop->stalled,
                                           .held_out_count = holds ? loop->held_count : 0,
                                           .held_out_rms = holds ? loop->held_rms : NAN,
                                           .held_out_largest = holds ? loop->held_largest : NAN,
                                           .expected_rms = holds ? loop->expected : NAN,
                                           .reached = has_reached(loop, &loop->rounds[loop->count - 1])};
    else
        free(loop->rounds);
    *surface = (bat_spline_surface){.space = loop->space, .control = loop->control, .dimension = data->dimension};
    loop->rounds = NULL;
    loop->space = NULL;
    loop->control = NULL;
    return BAT_OK;
}

bat_status fit_all(const fit_team *team, bat_surface_fit_data *data, const uint32_t *numbers,
                   const bat_surface_fit_options *options, bat_spline_surface *surface, bat_surface_fit_report *report,
                   bat_error *error)
{
    fit_loop loop = {0};
    const bat_surface_fit_options defaults = bat_surface_fit_defaults();
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_surface_fit_fields, options, error);
    if (status == BAT_OK)
        status = fit_points_check(team, data, numbers, error);
    if (status == BAT_OK)
        status = loop_make(team, data, numbers, options, &loop, error);
    if (status == BAT_OK)
        status = run(&loop, error);
    if (status == BAT_OK)
        status = store_result(&loop, data, surface, report, error);
    loop_free_fit(&loop);
    fit_points_free(&loop.points);
    fit_border_free(&loop.border);
    bat_hierarchical_space_free(loop.space);
    bat_hierarchical_space_free(loop.best.space);
    free(loop.best.parameter);
    free(loop.best.distance);
    free(loop.held);
    free(loop.fixed);
    free(loop.rounds);
    return status;
}

bat_status bat_surface_fit(bat_surface_fit_data *data, const bat_surface_fit_options *options, bat_spline_surface *surface,
                           bat_surface_fit_report *report, bat_error *error)
{
    return fit_all(NULL, data, NULL, options, surface, report, error);
}
