// An epoch of the published tension recipe, what of it is geometry and what network, and the same epoch in PyTorch, where
// there is one: bench/peer_tension_epoch.py, run by $PYTHON or /usr/bin/python3.

#include "timing.h"

#include "learn/blas.h"
#include "research/networks/tension_network.h"
#include "research/train/tension_sample.h"

#include <math.h>
#include <stdio.h>

enum
{
    TRAINING_CURVES = 960,
    SAMPLES = 240, ///< timed for each share
    FINEST = 96
};

/// How many times faster than PyTorch, sample by sample as in the paper, an epoch has to be.
static const double FLOOR = 15;

/// When the first and the last step began.
typedef struct clock_watch
{
    double begin, end;
} clock_watch;

static bool note_time(void *context, double fraction)
{
    clock_watch *watch = context;
    (void)fraction;
    watch->end = seconds_now();
    if (watch->begin == 0)
        watch->begin = watch->end;
    return true;
}

/// Seconds from the first step of two epochs to the last, for one epoch.
static double time_epoch(int threads)
{
    clock_watch watch = {0};
    bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    options.run.epochs = 2;
    options.run.threads = threads;
    options.run.progress = (bat_progress){note_time, &watch};
    if (bat_curve_train(&options, NULL, NULL) != BAT_OK)
        return NAN;
    const double steps = 2.0 * TRAINING_CURVES / 8;
    return (watch.end - watch.begin) / (steps - 1) * steps / 2;
}

typedef struct shares
{
    learn_parameters parameters;
    bat_tension_data data;
    learn_tape tape;
    real *gradient;
} shares;

static tension_sample sample_at(const shares *s, size_t k)
{
    size_t space = k % BAT_TENSION_SPACE_COUNT;
    return tension_sample_of(&s->data.train[space], (bat_tension_space)space, k / BAT_TENSION_SPACE_COUNT);
}

/// Seconds for an epoch's samples on one thread, everything included but the optimizer.
static double time_samples(shares *s)
{
    bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    double start = seconds_now();
    for (size_t k = 0; k < SAMPLES; k++)
    {
        bat_random random = bat_random_seed(k);
        tension_sample sample = sample_at(s, k);
        learn_tape_begin(&s->tape, &s->parameters, s->gradient);
        learn_tape_drop(&s->tape, k);
        tension_loss loss = tension_sample_loss(&s->tape, &sample, &options, &random);
        learn_tape_backward(&s->tape, loss.total, 1);
    }
    return (seconds_now() - start) * TRAINING_CURVES / SAMPLES;
}

/// The same network evaluations on features that are there, without a polygon.
static double time_network(shares *s)
{
    static const size_t rows[] = {24, 48, 3 * FINEST};
    double start = seconds_now();
    for (size_t k = 0; k < SAMPLES; k++)
    {
        learn_array *sum = NULL;
        learn_tape_begin(&s->tape, &s->parameters, s->gradient);
        learn_tape_drop(&s->tape, k);
        for (size_t pass = 0; pass < sizeof rows / sizeof *rows; pass++)
        {
            learn_array *features = learn_array_make(&s->tape, rows[pass], TENSION_FEATURES, pass == 1);
            for (size_t i = 0; i < learn_size(features); i++)
                features->value[i] = (real)(i % 17) / 17;
            learn_array *angles = tension_predict(&s->tape, features, GEOMETRY_PLANE, BAT_TENSION_EMBEDDING_LEARNED);
            learn_array *loss = learn_sum_of_squares(&s->tape, angles);
            sum = sum == NULL ? loss : learn_add(&s->tape, sum, loss);
        }
        learn_tape_backward(&s->tape, sum, 1);
    }
    return (seconds_now() - start) * TRAINING_CURVES / SAMPLES;
}

static bool compare_shares(void)
{
    shares s = {.tape = learn_tape_make()};
    bool ready = bat_tension_data_make(&s.data, NULL) == BAT_OK && tension_network_make(&s.parameters, NULL) == BAT_OK;
    s.gradient = ready ? calloc(s.parameters.total, sizeof *s.gradient) : NULL;
    ready = s.gradient != NULL;
    if (ready)
    {
        enum
        {
            ROUNDS = 5
        };
        double all[ROUNDS], network[ROUNDS];
        tension_network_start(&s.parameters, 1);
        blas_single_begin();
        (void)time_samples(&s);
        for (int round = 0; round < ROUNDS; round++)
        {
            all[round] = time_samples(&s);
            network[round] = time_network(&s);
        }
        blas_single_end();
        double whole = median_of(all, ROUNDS), part = median_of(network, ROUNDS);
        (void)printf("samples of an epoch on 1 thread: %5.2f s, of which network %5.2f s and geometry %5.2f s\n", whole,
                     part, whole - part);
    }
    bat_tension_data_free(&s.data);
    learn_parameters_free(&s.parameters);
    learn_tape_free(&s.tape);
    free(s.gradient);
    return ready;
}

/// Seconds of an epoch in PyTorch: sample by sample, and by groups of a batch's samples in one space (section 6.2 of the
/// paper).
typedef struct peer_seconds
{
    char version[32];
    double samples, groups;
} peer_seconds;

/// False where there is no PyTorch; the peer has said so then.
static bool time_peer(int threads, peer_seconds *seconds)
{
    char command[4096];
    const char *python = getenv("PYTHON") != NULL ? getenv("PYTHON") : "/usr/bin/python3";
    int length =
        snprintf(command, sizeof command, "'%s' '%s/peer_tension_epoch.py' --threads %d", python, BENCH_FOLDER, threads);
    (void)fflush(stdout);
    FILE *peer = length < (int)sizeof command ? popen(command, "r") : NULL;
    if (peer == NULL)
        return false;
    int read = fscanf(peer, "version %31s samples %lg groups %lg", seconds->version, &seconds->samples, &seconds->groups);
    return pclose(peer) == 0 && read == 3;
}

/// Seconds of an epoch, ours and PyTorch's, on so many threads; NaN where there is no PyTorch.
static void compare_epochs(int threads, double *ours, double *theirs)
{
    peer_seconds peer;
    *ours = time_epoch(threads);
    *theirs = NAN;
    (void)printf("an epoch of the published recipe on %d thread%s %.2f s", threads, threads == 1 ? ": " : "s:", *ours);
    if (time_peer(threads, &peer))
    {
        *theirs = peer.samples;
        (void)printf("; PyTorch %s, from a tenth: sample by sample %.1f s (%.1f times), by groups %.1f s (%.1f times)",
                     peer.version, peer.samples, peer.samples / *ours, peer.groups, peer.groups / *ours);
    }
    (void)printf("\n");
}

int main(void)
{
    enum
    {
        MAX_THREADS = 2
    };
    double ours = INFINITY, theirs = INFINITY;
    if (!compare_shares())
        return EXIT_FAILURE;
    for (int threads = 1; threads <= MAX_THREADS; threads++)
    {
        double own, peer;
        compare_epochs(threads, &own, &peer);
        ours = fmin(ours, own);
        theirs = fmin(theirs, peer);
    }
    if (isfinite(theirs))
        (void)printf("fastest against fastest, sample by sample: %.1f times (floor %g)\n", theirs / ours, FLOOR);
    return EXIT_SUCCESS;
}
