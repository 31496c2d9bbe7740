#include "research/train/learned_train.h"

#include "base/error.h"
#include "curve/network/learned_network.h"
#include "research/data/control_polygon.h"
#include "research/data/tension_family.h"
#include "research/data/tension_set.h"
#include "research/data/wave.h"
#include "research/train/learned_sample.h"
#include "research/train/learned_validate.h"
#include "research/train/train.h"
#include "research/train/train_files.h"

#include <stdio.h>
#include <string.h>

enum
{
    PIECES = 8,
    CURVES = 4, ///< of a piece
    CHECK_EVERY = 5,
    SAVE_EVERY = 5,
    TRUTH = BAT_TENSION_TRUTH_POINTS,
    PUBLISHED_COUNT = BAT_TENSION_CONTROL_POINTS,
    LEAST_COUNT = 4,
    MOST_COUNT = 32,
    MOST_DIM = 3
};
static const double CHECKED[BAT_FAIRING_CHECKS] = {0, 0.5, 1};
static const learned_epoch EPOCH = {.steps = 250, .kept = 60};
/// The kept curves' seed; the tables have another.
static const uint64_t CHECK_SEED = 2;

/// A mean distance is this small where a rule is good.
static const learned_weights WEIGHTS = {
    .distance_unit = {[BAT_TENSION_PLANE] = 0.006, [BAT_TENSION_SPHERE] = 0.0105, [BAT_TENSION_DISK] = 0.0027},
    .bending_unit = {[BAT_TENSION_PLANE] = 24, [BAT_TENSION_SPHERE] = 12, [BAT_TENSION_DISK] = 16},
    .angle_unit = {[BAT_TENSION_PLANE] = 0.13, [BAT_TENSION_SPHERE] = 0.4, [BAT_TENSION_DISK] = 0.1},
    .least = 0.006,
};

/// As training goes on fair curves count more, and then the balance between bending and large angles is struck: at first the
/// network learns what is near.
static const struct
{
    double from;                           ///< share of the epochs
    double most;                           ///< as in learned_weights
    double angle[BAT_TENSION_SPACE_COUNT]; ///< likewise, in each space
} PHASES[] = {{0, 7, {1, 1, 1}}, {0.5, 9, {0.78, 0.78, 0.78}}, {0.75, 10, {0.98, 1.2, 0.85}}};

/// What is recorded of every batch.
enum
{
    DISTANCE,
    BENDING,
    ANGLE,
    FIGURE_COUNT
};
static const char *const FIGURES[FIGURE_COUNT] = {"distance", "bending", "angle"};

static const char *const CHECKS[] = {"mean_nn",         "mean_nn_plane_0",  "mean_nn_sphere_0", "mean_nn_disk_0",
                                     "mean_nn_plane_1", "mean_nn_sphere_1", "mean_nn_disk_1",   "g1_plane_1",
                                     "g1_sphere_1",     "g1_disk_1"};
enum
{
    CHECK_COUNT = sizeof CHECKS / sizeof *CHECKS
};

typedef struct training
{
    const bat_learned_train_options *options;
    uint64_t steps;
    learn_parameters parameters;
    bat_tension_set kept[BAT_TENSION_SPACE_COUNT];
} training;

bat_learned_train_options bat_learned_train_defaults(void)
{
    return (bat_learned_train_options){.seed = 1, .epochs = 300};
}

// Samples

/// How the control points of a sample lie on its curve. Half of the polygons have as many as the published; most of those
/// are evenly spaced.
static tension_control_plan draw_plan(bat_random *random)
{
    bool published = bat_random_uniform(random) < 0.5, even = bat_random_uniform(random) < (published ? 0.75 : 0.25);
    bool from_start = bat_random_uniform(random) < 0.25;
    double start = bat_random_uniform(random), jitter = bat_random_uniform(random);
    return (tension_control_plan){
        .count = published ? PUBLISHED_COUNT : (size_t)draw_whole(random, LEAST_COUNT, MOST_COUNT),
        .start = from_start ? 0 : start,
        .jitter = even ? 0 : jitter,
    };
}

/// Replace the end of a closed curve by the geodesic back to its beginning, which makes two corners, at point 0 and at the
/// one that is returned: tracks are closed like that. Returns 0 where there is no single geodesic and the curve stays as it
/// is.
static size_t cut(bat_tension_space space, bat_random *random, double *truth)
{
    const bat_space spaces[BAT_TENSION_SPACE_COUNT] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    const bat_space *here = &spaces[space];
    size_t dim = here->point_dim, kept = (size_t)draw_whole(random, TRUTH / 3, TRUTH - TRUTH / 20);
    double end[MOST_DIM], velocity[MOST_DIM], step[MOST_DIM];
    memcpy(end, truth + (kept - 1) * dim, dim * sizeof *end);
    if (here->log(here, end, truth, velocity) != BAT_OK)
        return 0;
    for (size_t i = kept; i < TRUTH; i++)
    {
        double share = (double)(i + 1 - kept) / (double)(TRUTH + 1 - kept);
        for (size_t k = 0; k < here->tangent_dim; k++)
            step[k] = share * velocity[k];
        (void)here->exp(here, end, step, truth + i * dim); // between two points of the space
    }
    return kept - 1;
}

/// Move the control point that lies nearest along the curve onto point `corner`: who records a track marks its turns.
/// @param lengths chord lengths from point 0
static void mark(size_t corner, const double *lengths, size_t count, size_t *samples)
{
    size_t nearest = 0;
    double least = INFINITY;
    for (size_t k = 0; k < count; k++)
    {
        double apart = fabs(lengths[samples[k]] - lengths[corner]);
        apart = fmin(apart, lengths[TRUTH] - apart);
        if (apart < least)
        {
            least = apart;
            nearest = k;
        }
    }
    samples[nearest] = corner;
}

/// A fresh curve with its control polygon.
/// @param truth,control room for TRUTH and MOST_COUNT points
static tension_sample draw_sample(bat_tension_space space, bat_random *random, double *truth, double *control)
{
    double lengths[TRUTH + 1];
    size_t samples[MOST_COUNT], dim = tension_dim(space);
    tension_control_plan plan;
    size_t corner;
    do
    {
        size_t family = (size_t)draw_whole(random, 0, (int)tension_family_count(space, false) - 1);
        tension_family_draw(space, false, family, random, TRUTH, truth);
        corner = bat_random_uniform(random) < 0.2 ? cut(space, random, truth) : 0;
        plan = draw_plan(random);
    } while (!tension_control_sample(space, truth, TRUTH, &plan, random, lengths, samples));
    if (corner > 0 && plan.count >= 8 && bat_random_uniform(random) < 0.6)
    {
        mark(corner, lengths, plan.count, samples);
        mark(0, lengths, plan.count, samples);
    }
    for (size_t k = 0; k < plan.count; k++)
        memcpy(control + k * dim, truth + samples[k] * dim, dim * sizeof *control);
    // Open curves are pieces of closed ones.
    bool open = bat_random_uniform(random) < 0.15;
    size_t count = open ? (size_t)draw_whole(random, LEAST_COUNT, (int)plan.count) : plan.count;
    return (tension_sample){
        .control = {.points = control, .count = count, .surface = tension_surface(space), .closed = !open},
        .truth = truth,
        .truth_count = TRUTH,
    };
}

/// Levels that bring a polygon to about a hundred vertices or more.
static size_t steps_for(size_t count)
{
    return count < 9 ? 5 : count < 18 ? 4 : 3;
}

/// Both ends are drawn more often than by a uniform distribution.
static double draw_fairness(bat_random *random)
{
    return fmin(fmax(1.3 * bat_random_uniform(random) - 0.15, 0), 1);
}

static learned_weights weights_at(uint64_t epoch, uint64_t epochs, bat_tension_space space)
{
    learned_weights weights = WEIGHTS;
    for (size_t i = 0; i < sizeof PHASES / sizeof *PHASES; i++)
        if ((double)epoch >= PHASES[i].from * (double)epochs)
        {
            weights.most = PHASES[i].most;
            weights.angle = PHASES[i].angle[space];
        }
    return weights;
}

/// Curve `number` of the training.
static learn_array *train_curve(const training *t, uint64_t epoch, learn_tape *tape, uint64_t number, double *figures)
{
    bat_tension_space space = (bat_tension_space)(number % BAT_TENSION_SPACE_COUNT);
    bat_random stream = tension_stream(TENSION_TRAINING, space, t->options->seed, number), *random = &stream;
    double *truth = learn_tape_memory(tape, TRUTH * MOST_DIM, sizeof *truth);
    double *control = learn_tape_memory(tape, MOST_COUNT * MOST_DIM, sizeof *control);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    tension_sample sample = draw_sample(space, random, truth, control);
    learned_weights weights = weights_at(epoch, t->options->epochs, space);
    double fairness = draw_fairness(random), share = 1.0 / (PIECES * CURVES);
    learned_loss loss = learned_sample_loss(tape, &sample, space, steps_for(sample.control.count), fairness, &weights);
    if (tape->status == BAT_OK)
    {
        figures[DISTANCE] += share * (double)*loss.distance->value / WEIGHTS.distance_unit[space];
        figures[BENDING] += share * (double)*loss.bending->value;
        figures[ANGLE] += share * (double)*loss.angle->value;
    }
    return learn_scale(tape, loss.total, (real)share);
}

// What learn_train() asks for

static bat_status train_piece(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *figures,
                              bat_error *error)
{
    (void)error;
    const training *t = context;
    for (size_t i = 0; i < CURVES; i++)
    {
        uint64_t number = ((piece->epoch * t->steps + piece->step) * PIECES + piece->index) * CURVES + i;
        learn_array *own = train_curve(t, piece->epoch, tape, number, figures);
        *loss = i == 0 ? own : learn_add(tape, *loss, own);
    }
    return BAT_OK;
}

static bat_status score(const training *t, bat_learned_score scores[BAT_FAIRING_CHECKS][BAT_TENSION_SPACE_COUNT],
                        bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < BAT_FAIRING_CHECKS && status == BAT_OK; i++)
        status = learned_validate(&t->parameters, t->kept, CHECKED[i], t->options->threads, scores[i], error);
    return status;
}

static bat_status check(void *context, uint64_t epoch, double *figures, bat_error *error)
{
    (void)epoch;
    enum
    {
        LAST = BAT_FAIRING_CHECKS - 1,
        SPACES = BAT_TENSION_SPACE_COUNT
    };
    bat_learned_score scores[BAT_FAIRING_CHECKS][SPACES];
    bat_status status = score(context, scores, error);
    if (status != BAT_OK)
        return status;
    figures[0] = 0;
    for (size_t space = 0; space < SPACES; space++)
    {
        figures[0] += scores[0][space].mean_nn / SPACES;
        figures[1 + space] = scores[0][space].mean_nn;
        figures[1 + SPACES + space] = scores[LAST][space].mean_nn;
        figures[1 + 2 * SPACES + space] = scores[LAST][space].g1;
    }
    return BAT_OK;
}

// All of it

static bat_status training_make(const bat_learned_train_options *options, learned_epoch epoch, training *t, bat_error *error)
{
    *t = (training){.options = options, .steps = epoch.steps};
    bat_status status = learned_network_make(&t->parameters, error);
    if (status == BAT_OK)
        learned_network_start(&t->parameters, options->seed);
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT && status == BAT_OK; space++)
        status = bat_tension_set_make((bat_tension_space)space, BAT_TENSION_RESAMPLED, epoch.kept, CHECK_SEED,
                                      &t->kept[space], error);
    return status;
}

static void training_free(training *t)
{
    learn_parameters_free(&t->parameters);
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        bat_tension_set_free(&t->kept[space]);
}

static learn_options learning_of(const bat_learned_train_options *given, const char *name, const train_files *files)
{
    learn_options options = learn_options_defaults();
    options.epochs = given->epochs;
    options.optimizer =
        (learn_optimizer_options){.rule = LEARN_ADAMW, .momentum = 0.9, .second = 0.99, .epsilon = 1e-8, .decay = 1e-3};
    options.schedule = (learn_schedule){.kind = LEARN_COSINE, .rate = 2e-3, .warmup = 1, .epochs = given->epochs};
    options.clip = 1;
    options.seed = given->seed;
    options.threads = given->threads;
    options.check_every = CHECK_EVERY;
    options.keep_last = true;
    options.checkpoint_every = SAVE_EVERY;
    options.name = name;
    options.resume = given->resume;
    options.progress = given->progress;
    train_files_use(files, &options);
    return options;
}

static bat_status run(training *t, const learn_options *options, learn_report *made, bat_error *error)
{
    learn_job job = {
        .context = t,
        .parameters = &t->parameters,
        .steps = t->steps,
        .pieces = PIECES,
        .figures = FIGURES,
        .figure_count = FIGURE_COUNT,
        .checks = CHECKS,
        .check_count = CHECK_COUNT,
        .piece = train_piece,
        .check = check,
    };
    return learn_train(&job, options, made, error);
}

static bat_status write_model(const training *t, const char *path, const learn_report *made, bat_error *error)
{
    char seed[32], epochs[32];
    (void)snprintf(seed, sizeof seed, "%llu", (unsigned long long)t->options->seed);
    (void)snprintf(epochs, sizeof epochs, "%llu", (unsigned long long)made->epochs);
    const safetensors_note notes[] = {{"recipe", "batten"}, {"seed", seed}, {"epochs", epochs}};
    return learn_parameters_write(&t->parameters, path, notes, sizeof notes / sizeof *notes, error);
}

bat_status learned_train_by(const bat_learned_train_options *options, learned_epoch epoch, bat_learned_train_report *report,
                            bat_error *error)
{
    if (options->epochs == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "training needs at least 1 epoch");
    training t = {0};
    train_files files;
    learn_report made;
    char name[64];
    (void)snprintf(name, sizeof name, "tension batten, %llu epochs", (unsigned long long)options->epochs);
    bat_status status = train_files_make(options->folder, &files, error);
    if (status == BAT_OK)
        status = training_make(options, epoch, &t, error);
    if (status == BAT_OK)
    {
        learn_options learning = learning_of(options, name, &files);
        status = run(&t, &learning, &made, error);
    }
    if (status == BAT_OK && options->folder != NULL)
        status = write_model(&t, files.model, &made, error);
    if (status == BAT_OK && report != NULL)
    {
        bat_learned_train_report filled = {.epochs = made.epochs, .loss = made.loss};
        status = score(&t, filled.scores, error);
        if (status == BAT_OK)
            *report = filled;
    }
    training_free(&t);
    return status;
}

bat_status bat_learned_train(const bat_learned_train_options *options, bat_learned_train_report *report, bat_error *error)
{
    bat_learned_train_options defaults = bat_learned_train_defaults();
    return learned_train_by(options != NULL ? options : &defaults, EPOCH, report, error);
}
