#include "research/learn/operations.h"
#include "research/train/curve_train.h"

#include "base/error.h"
#include "batten/curve_measure.h"
#include "batten/research/curve_study.h"
#include "curve/network/learned_network.h"
#include "research/data/control_polygon.h"
#include "research/data/rough_curve.h"
#include "research/data/simplify.h"
#include "research/data/tension_family.h"
#include "research/data/tension_set.h"
#include "research/data/wave.h"
#include "research/train/curve_network_tape.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The recipe of the shipped curve rule.

enum
{
    SPACES = BAT_TENSION_SPACE_COUNT,
    STEPS = 250, ///< of an epoch
    PIECES = 8,
    CURVES = 4,             ///< of a piece
    VALIDATION_CURVES = 60, ///< of each space
    TRUTH = BAT_TENSION_TRUTH_POINTS,
    PUBLISHED_COUNT = BAT_TENSION_CONTROL_POINTS,
    MIN_COUNT = 4,
    MAX_COUNT = 48,
    MAX_DIM = 3,
    ROUGH_POINTS = SIMPLIFY_MAX_POINTS,
};
/// The share of rough curves; the others are of smooth families.
static const double ROUGH_SHARE = 0.6;
static const double FAIRNESS[BAT_CURVE_TRAIN_FAIRNESSES] = {0, 0.5, 1};
/// The seed of the validation curves; the tables have another.
static const uint64_t VALIDATION_SEED = 2;

/// During training the weight of the roughness grows: the network learns to follow the data first.
static const struct
{
    double from; ///< share of the epochs
    curve_loss_weights weights;
} PHASES[] = {
    {0, {.min_roughness = 0.005, .max_roughness = 5, .angle = 1, .hinge = 1}},
    {0.5, {.min_roughness = 0.005, .max_roughness = 8, .angle = 1.5, .hinge = 3}},
};

/// Mean distances that a good rule reaches on the smooth families.
static const double SMOOTH_UNIT[SPACES] = {
    [BAT_TENSION_SPACE_PLANE] = 0.006, [BAT_TENSION_SPACE_SPHERE] = 0.0105, [BAT_TENSION_SPACE_DISK] = 0.0027};

/// What is recorded of every batch.
enum
{
    DISTANCE,
    BENDING,
    ANGLE,
    METRIC_COUNT
};
static const char *const METRICS[METRIC_COUNT] = {"distance", "bending", "angle"};

static const char *const VALIDATION[] = {"mean_nn",         "mean_nn_plane_0",  "mean_nn_sphere_0", "mean_nn_disk_0",
                                         "mean_nn_plane_1", "mean_nn_sphere_1", "mean_nn_disk_1",   "g1_plane_1",
                                         "g1_sphere_1",     "g1_disk_1"};

/// Of the learning rate, where training begins with the weights of a model.
static const double START_RATE_SHARE = 0.5;

// Samples

/// The distribution of a sample's control points on its curve. Half of the polygons have as many points as the published
/// ones; most of those are evenly spaced.
static tension_control_plan draw_plan(bat_random *random)
{
    bool published = bat_random_uniform(random) < 0.5, even = bat_random_uniform(random) < (published ? 0.75 : 0.25);
    bool from_start = bat_random_uniform(random) < 0.25;
    double start = bat_random_uniform(random), jitter = bat_random_uniform(random);
    return (tension_control_plan){
        .count = published ? PUBLISHED_COUNT : (size_t)draw_whole(random, MIN_COUNT, 32),
        .start = from_start ? 0 : start,
        .jitter = even ? 0 : jitter,
    };
}

/// Replace the end of a closed curve by the geodesic back to its beginning, as closed tracks have one. It makes corners at
/// point 0 and at the returned point. Returns 0, and leaves the curve alone, where there is no unique geodesic.
static size_t close_by_geodesic(bat_tension_space space, bat_random *random, double *truth)
{
    const bat_space spaces[SPACES] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    const bat_space *here = &spaces[space];
    size_t dim = here->point_dim, remaining = (size_t)draw_whole(random, TRUTH / 3, TRUTH - TRUTH / 20);
    double end[MAX_DIM], velocity[MAX_DIM], step[MAX_DIM];
    memcpy(end, truth + (remaining - 1) * dim, dim * sizeof *end);
    if (here->log(here, end, truth, velocity) != BAT_OK)
        return 0;
    for (size_t i = remaining; i < TRUTH; i++)
    {
        double share = (double)(i + 1 - remaining) / (double)(TRUTH + 1 - remaining);
        for (size_t k = 0; k < here->tangent_dim; k++)
            step[k] = share * velocity[k];
        (void)here->exp(here, end, step, truth + i * dim); // cannot fail between two points of the space
    }
    return remaining - 1;
}

/// Move the control point that is nearest along the curve onto point `corner`, because recorded tracks have points at turns.
/// @param lengths chord lengths from point 0
static void snap_to_corner(size_t corner, const double *lengths, size_t count, size_t *samples)
{
    size_t nearest = 0;
    double min = INFINITY;
    for (size_t k = 0; k < count; k++)
    {
        double distance = fabs(lengths[samples[k]] - lengths[corner]);
        distance = fmin(distance, lengths[TRUTH] - distance);
        if (distance < min)
        {
            min = distance;
            nearest = k;
        }
    }
    samples[nearest] = corner;
}

/// A new curve with its control polygon.
/// @param truth,control room for TRUTH and MAX_COUNT points
static tension_sample draw_smooth_sample(bat_tension_space space, bat_random *random, double *truth, double *control)
{
    double lengths[TRUTH + 1];
    size_t samples[MAX_COUNT], dim = tension_dim(space);
    tension_control_plan plan;
    size_t corner;
    do
    {
        size_t family = (size_t)draw_whole(random, 0, (int)tension_family_count(space, false) - 1);
        tension_family_draw(space, false, family, random, TRUTH, truth);
        corner = bat_random_uniform(random) < 0.2 ? close_by_geodesic(space, random, truth) : 0;
        plan = draw_plan(random);
    } while (!tension_control_sample(space, truth, TRUTH, &plan, random, lengths, samples));
    if (corner > 0 && plan.count >= 8 && bat_random_uniform(random) < 0.6)
    {
        snap_to_corner(corner, lengths, plan.count, samples);
        snap_to_corner(0, lengths, plan.count, samples);
    }
    for (size_t k = 0; k < plan.count; k++)
        memcpy(control + k * dim, truth + samples[k] * dim, dim * sizeof *control);
    // Open curves are pieces of closed ones.
    bool open = bat_random_uniform(random) < 0.15 && samples[0] < samples[plan.count - 1];
    size_t count = open ? (size_t)draw_whole(random, MIN_COUNT, (int)plan.count) : plan.count;
    size_t first = open ? samples[0] : 0, end = open ? samples[count - 1] + 1 : TRUTH;
    return (tension_sample){
        .control = {.points = control, .count = count, .surface = tension_surface(space), .closed = !open},
        .truth = truth + first * dim,
        .truth_count = end - first,
    };
}

// Rough curves

/// Whether neighbouring control points are distinct.
static bool samples_are_fit(const double *points, const size_t *samples, size_t count, bool closed)
{
    for (size_t k = 0; k + (closed ? 0 : 1) < count; k++)
    {
        const double *p = points + 2 * samples[k], *q = points + 2 * samples[(k + 1) % count];
        if (hypot(q[0] - p[0], q[1] - p[1]) < 1e-4)
            return false;
    }
    return true;
}

/// Map a plane point with norm at most 1 into a space: the plane itself, a cap of the sphere of angular radius `reach` by
/// the azimuthal equidistant map, or a concentric disk of Euclidean radius `reach`.
static void place_point(bat_tension_space space, double reach, const double *from, double *point)
{
    double radius = hypot(from[0], from[1]), factor = space == BAT_TENSION_SPACE_PLANE ? 1 : reach;
    if (space == BAT_TENSION_SPACE_SPHERE && radius > 0)
        factor = sin(reach * radius) / radius;
    point[0] = factor * from[0];
    point[1] = factor * from[1];
    if (space == BAT_TENSION_SPACE_SPHERE)
        point[2] = cos(reach * radius);
}

static size_t draw_count(bat_random *random, size_t low, size_t high)
{
    return (size_t)((double)low * pow((double)(high + 1) / (double)low, bat_random_uniform(random)));
}

/// A new rough curve with its control polygon.
/// @param truth,control room for TRUTH and MAX_COUNT points
static tension_sample draw_rough_sample(bat_tension_space space, bat_random *random, double *truth, double *control)
{
    double plane[2 * ROUGH_POINTS], moved[2];
    size_t samples[MAX_COUNT], dim = tension_dim(space), count = draw_count(random, 5, MAX_COUNT);
    static const rough_family FAMILIES[] = {ROUGH_RADIAL,  ROUGH_SPECTRAL, ROUGH_DIRECTION, ROUGH_DIRECTION,
                                            ROUGH_CORNERS, ROUGH_CORNERS,  ROUGH_STROKE,    ROUGH_STROKE,
                                            ROUGH_PIECES,  ROUGH_PIECES,   ROUGH_PIECES};
    rough_family family = FAMILIES[draw_whole(random, 0, sizeof FAMILIES / sizeof *FAMILIES - 1)];
    bool closed = rough_curve_draw(family, random, ROUGH_POINTS, plane);
    // Half of the curves with a spectrum are themselves polylines, of 1.5 to 12 pieces for each control edge.
    bool polyline = family != ROUGH_CORNERS && family != ROUGH_STROKE && draw_coin(random);
    if (polyline)
        rough_curve_simplify(random, closed, draw_count(random, count + count / 2, 12 * count), ROUGH_POINTS, plane);
    static const curve_sampling SAMPLINGS[] = {
        CURVE_SAMPLING_EVEN,
        CURVE_SAMPLING_EVEN,
        CURVE_SAMPLING_UNEVEN,
        CURVE_SAMPLING_UNEVEN,
        CURVE_SAMPLING_UNEVEN,
        CURVE_SAMPLING_UNEVEN,
        CURVE_SAMPLING_UNEVEN,
        CURVE_SAMPLING_UNEVEN,
        CURVE_SAMPLING_TIME,
        CURVE_SAMPLING_CURVATURE,
        CURVE_SAMPLING_VISVALINGAM,
        CURVE_SAMPLING_VISVALINGAM,
        CURVE_SAMPLING_VISVALINGAM,
        CURVE_SAMPLING_VISVALINGAM,
        CURVE_SAMPLING_VISVALINGAM,
        CURVE_SAMPLING_VISVALINGAM,
        CURVE_SAMPLING_VISVALINGAM,
        CURVE_SAMPLING_DOUGLAS_PEUCKER,
        CURVE_SAMPLING_DOUGLAS_PEUCKER,
        CURVE_SAMPLING_DOUGLAS_PEUCKER,
        CURVE_SAMPLING_DOUGLAS_PEUCKER,
        CURVE_SAMPLING_DOUGLAS_PEUCKER,
    };
    curve_sampling how = SAMPLINGS[draw_whole(random, 0, sizeof SAMPLINGS / sizeof *SAMPLINGS - 1)];
    curve_sample(how, plane, ROUGH_POINTS, closed, count, random, samples);
    while (!samples_are_fit(plane, samples, count, closed))
    {
        closed = rough_curve_draw(ROUGH_RADIAL, random, ROUGH_POINTS, plane);
        curve_sample(CURVE_SAMPLING_EVEN, plane, ROUGH_POINTS, closed, count, random, samples);
    }
    double reach = space == BAT_TENSION_SPACE_SPHERE ? draw_between(random, 0.02, 1.2) : draw_between(random, 0.1, 0.75);
    double noise = bat_random_uniform(random) < 0.15 ? draw_between(random, 0, 0.1) / (double)count : 0;
    for (size_t i = 0; i < TRUTH; i++)
    {
        // An open curve keeps both ends.
        size_t from = closed ? i * ROUGH_POINTS / TRUTH : i * (ROUGH_POINTS - 1) / (TRUTH - 1);
        place_point(space, reach, plane + 2 * from, truth + i * dim);
    }
    for (size_t k = 0; k < count; k++)
    {
        for (size_t a = 0; a < 2; a++)
            moved[a] = plane[2 * samples[k] + a] + (noise > 0 ? noise * bat_random_normal(random) : 0);
        place_point(space, reach, moved, control + k * dim);
    }
    return (tension_sample){
        .control = {.points = control, .count = count, .surface = tension_surface(space), .closed = closed},
        .truth = truth,
        .truth_count = TRUTH,
    };
}

/// The number of levels after which a polygon has about a hundred vertices or more.
static size_t steps_for(size_t count)
{
    return count < 9 ? 5 : count < 20 ? 4 : 3;
}

/// Uniform, with additional probability for 0 and 1.
static double draw_fairness(bat_random *random)
{
    return fmin(fmax(1.3 * bat_random_uniform(random) - 0.15, 0), 1);
}

static curve_loss_weights weights_at(uint64_t epoch, uint64_t epochs)
{
    curve_loss_weights weights = PHASES[0].weights;
    for (size_t i = 0; i < sizeof PHASES / sizeof *PHASES; i++)
        if ((double)epoch >= PHASES[i].from * (double)epochs)
            weights = PHASES[i].weights;
    return weights;
}

/// Curve `number` of the training.
static learn_array *train_curve(const curve_training *t, uint64_t epoch, learn_tape *tape, uint64_t number, double *metrics)
{
    bat_tension_space space = (bat_tension_space)(number % SPACES);
    bat_random stream = tension_stream(TENSION_TRAINING, space, t->options->run.seed, number), *random = &stream;
    double *truth = learn_tape_memory(tape, TRUTH * MAX_DIM, sizeof *truth);
    double *control = learn_tape_memory(tape, MAX_COUNT * MAX_DIM, sizeof *control);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    bool rough = bat_random_uniform(random) < ROUGH_SHARE;
    tension_sample sample = (rough ? draw_rough_sample : draw_smooth_sample)(space, random, truth, control);
    curve_loss_weights weights = weights_at(epoch, t->options->run.epochs);
    weights.distance_unit = rough ? 0 : SMOOTH_UNIT[space];
    double fairness = draw_fairness(random), share = 1.0 / (PIECES * CURVES);
    curve_network_loss loss = curve_network_sample_loss(tape, &sample, steps_for(sample.control.count), fairness, &weights);
    if (tape->status == BAT_OK)
    {
        metrics[DISTANCE] += share * (double)*loss.distance->value;
        metrics[BENDING] += share * (double)*loss.bending->value;
        metrics[ANGLE] += share * (double)*loss.angle->value;
    }
    return learn_scale(tape, loss.total, (real)share);
}

// Validation

/// The refined control polygons of a part of one set.
static bat_status refine(const bat_tension_set *set, group_items own, const bat_space *space,
                         const bat_curve_angle_rule *rule, double fairness, int threads, bat_curve *coarse, bat_curve *fine,
                         bat_error *error)
{
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.scheme = bat_curve_scheme_angle_rule(rule);
    options.scheme.fairness = fairness;
    options.levels = BAT_TENSION_LEVELS;
    options.threads = threads;
    options.simple = BAT_CURVE_SIMPLE_NEVER; // the rule alone is trained
    if (own.end == own.begin)
        return BAT_OK;
    for (size_t i = own.begin; i < own.end; i++)
        coarse[i] = bat_tension_control(set, i, space);
    return bat_curves_refine(coarse + own.begin, own.end - own.begin, &options, fine + own.begin, error);
}

static bat_status measure(const bat_tension_set *set, group_items own, const bat_space *space, const bat_curve *fine,
                          bat_curve_train_score *scores, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = own.begin; i < own.end && status == BAT_OK; i++)
    {
        bat_curve truth = bat_tension_truth(set, i, space);
        bat_curve_distance distance;
        bat_curve_fairness_values fairness;
        status = bat_curve_compare(&fine[i], &truth, NULL, &distance, error);
        if (status == BAT_OK)
            status = bat_curve_fairness(&fine[i], NULL, &fairness, error);
        if (status == BAT_OK)
            scores[i] = (bat_curve_train_score){distance.mean_nn, fairness.bending, fairness.g1};
    }
    return status;
}

bat_status curve_batten_validate(const learn_parameters *parameters, const bat_tension_set sets[SPACES], double fairness,
                                 const bat_group *group, int threads, bat_curve_train_score scores[SPACES], bat_error *error)
{
    const bat_space spaces[SPACES] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    bat_status status = BAT_OK;
    for (size_t s = 0; s < SPACES && status == BAT_OK; s++)
    {
        size_t count = sets[s].count;
        group_items own = group_items_of(group, count);
        const bat_curve_angle_rule rule = learned_rule(parameters->values);
        bat_curve *curves = calloc(2 * count, sizeof *curves);
        bat_curve_train_score *own_scores = calloc(count, sizeof *own_scores);
        if (curves == NULL || own_scores == NULL)
            status = error_memory(error, 2 * count * sizeof *curves);
        if (status == BAT_OK)
            status = refine(&sets[s], own, &spaces[s], &rule, fairness, threads, curves, curves + count, error);
        if (status == BAT_OK)
            status = measure(&sets[s], own, &spaces[s], curves + count, own_scores, error);
        status = group_collect(group, own_scores, sizeof *own_scores, count, status, error);
        if (status == BAT_OK)
            scores[s] = curve_mean_score(own_scores, count);
        for (size_t i = 0; i < count && curves != NULL; i++)
            bat_curve_free(&curves[count + i]);
        free(curves);
        free(own_scores);
    }
    return status;
}

bat_status curve_batten_score(const curve_training *t, bat_curve_train_score scores[BAT_CURVE_TRAIN_FAIRNESSES][SPACES],
                              bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < BAT_CURVE_TRAIN_FAIRNESSES && status == BAT_OK; i++)
        status = curve_batten_validate(&t->base.parameters, t->validation, FAIRNESS[i], t->options->run.group,
                                       t->options->run.threads, scores[i], error);
    return status;
}

// Options

static bat_status check(const void *context, bat_error *error)
{
    const bat_curve_train_options *o = ((const curve_training *)context)->options;
    bool terms = o->bending != 0 || o->consistency != 0;
    for (size_t space = 0; space < SPACES; space++)
        terms = terms || o->smoothness[space] != 0;
    if (o->embedding != BAT_TENSION_EMBEDDING_LEARNED || terms)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "embedding, smoothness, bending and consistency must be 0: only the published recipe has them");
    return BAT_OK;
}

static void describe(const void *context, char text[TRAIN_TEXT_SIZE])
{
    const curve_training *t = context;
    (void)snprintf(text, TRAIN_TEXT_SIZE, "tension batten, %llu epochs", (unsigned long long)t->options->run.epochs);
    train_describe_begin(&t->base, text);
}

// Training

static bat_status make(void *context, bat_error *error)
{
    curve_training *t = context;
    if (t->size.steps == 0)
        t->size.steps = STEPS;
    if (t->size.validation_curves == 0)
        t->size.validation_curves = VALIDATION_CURVES;
    bat_status status = learned_network_make(&t->base.parameters, error);
    if (status == BAT_OK)
        learned_network_start(&t->base.parameters, t->options->run.seed);
    if (status == BAT_OK && t->options->begin != NULL)
        status = train_begin(&t->base, t->options->begin, error);
    for (int space = 0; space < SPACES && status == BAT_OK; space++)
        status = bat_tension_set_make((bat_tension_space)space, BAT_TENSION_SET_KIND_RESAMPLED, t->size.validation_curves,
                                      VALIDATION_SEED, &t->validation[space], error);
    return status;
}

static void configure(const void *context, learn_job *job, learn_options *options)
{
    const curve_training *t = context;
    job->pieces = PIECES;
    job->steps = t->size.steps;
    if (t->options->begin != NULL)
        options->schedule.rate *= START_RATE_SHARE;
}

static bat_status piece_loss(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *metrics,
                             bat_error *error)
{
    (void)error;
    const curve_training *t = context;
    for (size_t i = 0; i < CURVES; i++)
    {
        uint64_t number = ((piece->epoch * t->size.steps + piece->step) * PIECES + piece->index) * CURVES + i;
        learn_array *own = train_curve(t, piece->epoch, tape, number, metrics);
        *loss = i == 0 ? own : learn_add(tape, *loss, own);
    }
    return BAT_OK;
}

static bat_status validate(void *context, double *metrics, bat_error *error)
{
    enum
    {
        LAST = BAT_CURVE_TRAIN_FAIRNESSES - 1
    };
    bat_curve_train_score scores[BAT_CURVE_TRAIN_FAIRNESSES][SPACES];
    bat_status status = curve_batten_score(context, scores, error);
    if (status != BAT_OK)
        return status;
    metrics[0] = 0;
    for (size_t space = 0; space < SPACES; space++)
    {
        metrics[0] += scores[0][space].mean_nn / SPACES;
        metrics[1 + space] = scores[0][space].mean_nn;
        metrics[1 + SPACES + space] = scores[LAST][space].mean_nn;
        metrics[1 + 2 * SPACES + space] = scores[LAST][space].g1;
    }
    return BAT_OK;
}

const train_recipe curve_recipe_batten = {
    .columns = {METRICS, METRIC_COUNT, VALIDATION, sizeof VALIDATION / sizeof *VALIDATION},
    .optimizer = {.rule = LEARN_ADAMW, .momentum = 0.9, .second = 0.99, .epsilon = 1e-8, .decay = 1e-3},
    .schedule = {.kind = LEARN_COSINE, .rate = 2e-3, .warmup = 1},
    .plateau = {.reduce_factor = 0.5},
    .clip = 1,
    .validate_every = 5,
    .checkpoint_every = 5,
    .check = check,
    .make = make,
    .configure = configure,
    .describe = describe,
    .piece_loss = piece_loss,
    .validate = validate,
};
