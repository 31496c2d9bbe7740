// The published network for clouds: inference against the bare products that it cannot do without, and a training step.

#include "timing.h"

#include "learn/blas.h"
#include "research/networks/bidgcn.h"
#include "research/train/surface_network_tape.h"
#include "research/train/surface_sample.h"

#include <stdio.h>
#include <string.h>

enum
{
    ROUNDS = 21,
    POINTS = 1000
};

/// Seconds of this thread's work, whatever else the machine does.
static double cpu_now(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static surface_sample sample_of(size_t points)
{
    surface_sample_range range = {.min_points = points, .max_points = points, .min_degree = 2, .max_degree = 2};
    bat_random random = bat_random_seed(1);
    surface_sample sample;
    if (surface_sample_draw(&range, &random, &sample, NULL) != BAT_OK)
        exit(EXIT_FAILURE);
    return sample;
}

static learn_parameters weights(int argc, char **argv)
{
    learn_parameters parameters = {0};
    if (surface_tape_published.kind->make(NULL, &parameters, NULL) != BAT_OK)
        exit(EXIT_FAILURE);
    surface_tape_published.start(&parameters, 1);
    safetensors content;
    if (argc > 1 && (safetensors_read(argv[1], &content, NULL) != BAT_OK ||
                     learn_parameters_extract(&parameters, &content, "", parameters.values, NULL) != BAT_OK))
        exit(EXIT_FAILURE);
    if (argc > 1)
        safetensors_free(&content);
    return parameters;
}

static double time_product(size_t rows, size_t inputs, size_t outputs)
{
    float *x = calloc(rows, inputs * sizeof *x), *w = calloc(inputs, outputs * sizeof *w),
          *y = calloc(rows, outputs * sizeof *y);
    if (x == NULL || w == NULL || y == NULL)
        exit(EXIT_FAILURE);
    double start = cpu_now();
    cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, (int)rows, (int)outputs, (int)inputs, 1, x, (int)inputs, w,
                (int)inputs, 0, y, (int)outputs);
    double seconds = cpu_now() - start;
    free(x);
    free(w);
    free(y);
    return seconds;
}

/// The layers, and the distances of features.
static double products(size_t points)
{
    return SURFACE_HIDDEN * (time_product(points, SURFACE_WIDTH, points) +
                             time_product(points, (size_t)2 * SURFACE_WIDTH, SURFACE_WIDTH)) +
           2 * time_product(points, SURFACE_WIDTH, SURFACE_WIDTH) + time_product(points, SURFACE_JOINED, SURFACE_OUTPUT) +
           time_product(points, SURFACE_OUTPUT, SURFACE_OUTPUT) + time_product(points, SURFACE_OUTPUT, 2);
}

static void time_inference(const learn_parameters *parameters, size_t points)
{
    surface_sample sample = sample_of(points);
    double inference[ROUNDS], bare[ROUNDS], *interior = calloc(points, 2 * sizeof *interior);
    void *network;
    if (interior == NULL || surface_inference_make(NULL, parameters, &network, NULL) != BAT_OK)
        exit(EXIT_FAILURE);
    for (int round = 0; round < ROUNDS; round++)
    {
        bare[round] = products(points);
        double start = cpu_now();
        if (surface_inference_run(network, &sample.cloud, sample.parameters, 1, interior, NULL) != BAT_OK)
            exit(EXIT_FAILURE);
        inference[round] = cpu_now() - start;
    }
    double seconds = median_of(inference, ROUNDS);
    (void)printf(
        "%zu points and %zu of the boundary: %.2f ms on one thread, %.2f of the rate of the bare products by sgemm\n",
        points, sample.cloud.boundary_count, 1e3 * seconds, median_of(bare, ROUNDS) / seconds);
    surface_inference_free(network);
    free(interior);
    surface_sample_free(&sample);
}

static void time_step(const learn_parameters *parameters)
{
    surface_sample sample = sample_of(POINTS);
    surface_edges edges;
    learn_tape tape = learn_tape_make();
    real *gradient = calloc(parameters->total, sizeof *gradient);
    double forward[ROUNDS], both[ROUNDS];
    for (int round = 0; round < ROUNDS && gradient != NULL; round++)
    {
        double start = cpu_now();
        learn_tape_begin(&tape, parameters, gradient);
        learn_array *interior = surface_network_predict(&tape, &sample.cloud, sample.parameters, &edges);
        learn_array *loss = surface_sample_residual(&tape, &sample, interior);
        forward[round] = cpu_now() - start;
        learn_tape_backward(&tape, loss, 1);
        both[round] = cpu_now() - start;
    }
    (void)printf("a training step of %d points: %.2f ms on one thread, of which %.2f forward; edges", POINTS,
                 1e3 * median_of(both, ROUNDS), 1e3 * median_of(forward, ROUNDS));
    for (size_t i = 0; i < 2 + SURFACE_HIDDEN; i++)
        (void)printf(" %zu", edges.count[i]);
    (void)printf("\n");
    free(gradient);
    learn_tape_free(&tape);
    surface_sample_free(&sample);
}

/// With the name of a model's file, of its weights; else of those that training begins with.
int main(int argc, char **argv)
{
    learn_parameters parameters = weights(argc, argv);
    blas_single_begin();
    time_inference(&parameters, POINTS);
    time_inference(&parameters, 5 * POINTS);
    time_step(&parameters);
    blas_single_end();
    learn_parameters_free(&parameters);
    return EXIT_SUCCESS;
}
