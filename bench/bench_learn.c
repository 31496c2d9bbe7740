// A forward and backward pass of the tension network against its bare matrix products, in turn in one run.

#include "timing.h"

#include "learn/blas.h"
#include "research/learn/train.h"
#include "research/networks/tension_network.h"

#include <stdio.h>

enum
{
    ROUNDS = 41,
    MAX_ROWS = 576
};

typedef struct bench
{
    learn_parameters parameters;
    real *gradient;
    learn_tape tape;
    real *left, *right, *result; ///< matrices for the bare products
} bench;

/// As many products of the same shapes as the passes need, and nothing else.
static void bare_products(const bench *b, int rows, bool backward)
{
    for (size_t i = 0; i < b->parameters.count; i++)
    {
        const learn_parameter *p = &b->parameters.list[i];
        if (p->rank != 2 || i == 0)
            continue;
        int outputs = (int)p->rows, inputs = (int)p->columns;
        REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasTrans, rows, outputs, inputs, 1, b->left, inputs, b->right, inputs, 0,
                  b->result, outputs);
        if (!backward)
            continue;
        REAL_GEMM(CblasRowMajor, CblasTrans, CblasNoTrans, outputs, inputs, rows, 1, b->left, outputs, b->right, inputs, 0,
                  b->result, inputs);
        REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasNoTrans, rows, inputs, outputs, 1, b->left, outputs, b->right, inputs, 0,
                  b->result, inputs);
    }
}

static void network_pass(bench *b, size_t rows, bool backward)
{
    uint32_t spaces[MAX_ROWS];
    learn_tape_begin(&b->tape, &b->parameters, backward ? b->gradient : NULL);
    if (backward)
        learn_tape_drop(&b->tape, 1);
    learn_array *features = learn_array_make(&b->tape, rows, TENSION_FEATURES, backward);
    for (size_t k = 0; k < learn_size(features); k++)
        features->value[k] = (real)(k % 17) / 17;
    for (size_t r = 0; r < rows; r++)
        spaces[r] = (uint32_t)(r % 3);
    learn_array *angles = tension_network_angles(&b->tape, features, spaces);
    learn_tape_backward(&b->tape, learn_sum_of_squares(&b->tape, angles), 1);
}

static void compare(bench *b, size_t rows, bool backward)
{
    double network[ROUNDS], bare[ROUNDS];
    for (int round = 0; round < ROUNDS; round++)
    {
        double start = seconds_now();
        bare_products(b, (int)rows, backward);
        double middle = seconds_now();
        network_pass(b, rows, backward);
        network[round] = seconds_now() - middle;
        bare[round] = middle - start;
    }
    double pass = median_of(network, ROUNDS), products = median_of(bare, ROUNDS);
    (void)printf("%-22s %4zu rows: %5.2f of the speed of bare sgemm, %4.0f thousand rows a second\n",
                 backward ? "forward and backward" : "forward", rows, products / pass, (double)rows / pass * 1e-3);
}

// Training steps of the published recipe without its geometry: a batch of 8 samples, each with 24 and 48 rows that count for
// the curve and 4 passes of 96 rows that compare the network with itself.

static bat_status sample(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *metrics,
                         bat_error *error)
{
    (void)metrics;
    (void)error;
    enum
    {
        PASSES = 3
    };
    static const size_t rows[PASSES] = {24, 48, 4 * 96};
    const uint32_t *spaces = context;
    learn_array *sums[PASSES];
    for (size_t pass = 0; pass < PASSES; pass++)
    {
        learn_array *features = learn_array_make(tape, rows[pass], TENSION_FEATURES, pass == 1);
        for (size_t k = 0; k < learn_size(features); k++)
            features->value[k] = (real)bat_random_uniform(&piece->random);
        sums[pass] = learn_mean_of_squares(tape, tension_network_angles(tape, features, spaces));
    }
    *loss = learn_add(tape, learn_add(tape, sums[0], sums[1]), sums[2]);
    return BAT_OK;
}

static void time_steps(learn_parameters *parameters, int threads)
{
    enum
    {
        STEPS = 60,
        EPOCH_STEPS = 120
    };
    uint32_t spaces[MAX_ROWS] = {0};
    learn_job job = {.context = spaces, .parameters = parameters, .steps = STEPS, .pieces = 8, .piece_loss = sample};
    learn_options options = learn_options_defaults();
    options.threads = threads;
    double start = seconds_now();
    bat_status status = learn_train(&job, &options, NULL, NULL);
    double seconds = seconds_now() - start;
    (void)printf("training on %d threads: %5.2f ms a batch, %5.2f s for the network in a published epoch%s\n", threads,
                 1e3 * seconds / STEPS, seconds * EPOCH_STEPS / STEPS, status == BAT_OK ? "" : " (failed)");
}

int main(void)
{
    bench b = {.tape = learn_tape_make()};
    if (tension_network_make(&b.parameters, NULL) != BAT_OK)
        return EXIT_FAILURE;
    tension_network_start(&b.parameters, 1);
    size_t numbers = (size_t)MAX_ROWS * TENSION_WIDTH;
    b.gradient = calloc(b.parameters.total, sizeof(real));
    b.left = calloc(numbers, sizeof(real));
    b.right = calloc(numbers, sizeof(real));
    b.result = calloc(numbers, sizeof(real));
    bool ready = b.gradient != NULL && b.left != NULL && b.right != NULL && b.result != NULL;
    for (size_t k = 0; ready && k < numbers; k++)
    {
        b.left[k] = (real)(k % 7);
        b.right[k] = (real)(k % 5);
    }
    blas_single_begin();
    const size_t rows[] = {24, 72, 192, 384, MAX_ROWS};
    for (int backward = 0; ready && backward < 2; backward++)
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
            compare(&b, rows[i], backward == 1);
    blas_single_end();
    for (int threads = 1; ready && threads <= 2; threads++)
        time_steps(&b.parameters, threads);
    free(b.gradient);
    free(b.left);
    free(b.right);
    free(b.result);
    learn_tape_free(&b.tape);
    learn_parameters_free(&b.parameters);
    return ready ? EXIT_SUCCESS : EXIT_FAILURE;
}
