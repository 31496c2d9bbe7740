// Learned refinement of meshes and training of its network: a small mesh many times, a large one once, and training steps,
// relative to the matrix products of the network's layers in the same run.

#include "timing.h"

#include "batten/mesh_refine.h"
#include "batten/research/networks.h"
#include "learn/blas.h"
#include "mesh/network/flap.h"
#include "research/learn/parameters.h"
#include "research/train/mesh_network_tape.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum
{
    LEVELS = 2,
    SMALL_ROUNDS = 201,
    LARGE_ROUNDS = 3,
    STEP_ROUNDS = 51,
    PRODUCT_ROWS = 480
};

static double cpu_now(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/// A bumpy torus of 2 m n faces.
static bat_mesh make_torus(uint32_t m, uint32_t n)
{
    bat_mesh mesh = {.vertex_count = m * n, .face_count = 2 * m * n};
    mesh.positions = malloc(3 * mesh.vertex_count * sizeof *mesh.positions);
    mesh.faces = malloc(3 * mesh.face_count * sizeof *mesh.faces);
    if (mesh.positions == NULL || mesh.faces == NULL)
        exit(EXIT_FAILURE);
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = 0; j < n; j++)
        {
            double u = 6.28318530717958647692 * i / m, v = 6.28318530717958647692 * j / n,
                   tube = 0.4 + 0.05 * sin(3 * u + v);
            double *p = mesh.positions + 3 * (i * n + j);
            p[0] = (1 + tube * cos(v)) * cos(u);
            p[1] = (1 + tube * cos(v)) * sin(u);
            p[2] = tube * sin(v);
            uint32_t a = i * n + j, b = (i + 1) % m * n + j, c = (i + 1) % m * n + (j + 1) % n, d = i * n + (j + 1) % n;
            memcpy(mesh.faces + 6 * a, (uint32_t[6]){a, b, c, a, c, d}, 6 * sizeof a);
        }
    return mesh;
}

/// A model of the published network.
static bat_mesh_model *random_model(void)
{
    char path[] = "/tmp/bench_mesh_model_XXXXXX";
    int file = mkstemp(path);
    learn_parameters parameters = {0};
    bat_mesh_model *model = NULL;
    if (file < 0 || mesh_network_make((mesh_network_form){0}, &parameters, NULL) != BAT_OK)
        exit(EXIT_FAILURE);
    mesh_network_start(&parameters, 1);
    (void)close(file);
    if (learn_parameters_write(&parameters, path, NULL, 0, NULL) != BAT_OK ||
        bat_mesh_model_read_published(path, &model, NULL) != BAT_OK)
        exit(EXIT_FAILURE);
    (void)unlink(path);
    learn_parameters_free(&parameters);
    return model;
}

/// Processor seconds on one thread, with connectivity.
static double time_refinement(const bat_mesh_model *model, const bat_mesh *coarse, bat_mesh *fine)
{
    const bat_mesh_rule *rule = bat_mesh_model_rule(model);
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    bat_mesh_connectivity connectivity;
    size_t fallback;
    options.threads = 1;
    double start = cpu_now();
    if (bat_mesh_connect(coarse, &connectivity, NULL) != BAT_OK ||
        rule->refine(rule, coarse, &connectivity, LEVELS, &options, fine, &fallback, NULL) != BAT_OK)
        exit(EXIT_FAILURE);
    bat_mesh_connectivity_free(&connectivity);
    return cpu_now() - start;
}

/// Processor seconds of a matrix product, rows x inputs by inputs x outputs, a few hundred rows at a time.
static double time_product(size_t rows, int inputs, int outputs)
{
    real *x = calloc((size_t)inputs * PRODUCT_ROWS, sizeof *x), *w = calloc((size_t)inputs * (size_t)outputs, sizeof *w),
         *y = calloc((size_t)outputs * PRODUCT_ROWS, sizeof *y);
    if (x == NULL || w == NULL || y == NULL)
        exit(EXIT_FAILURE);
    double start = cpu_now();
    for (size_t done = 0; done < rows; done += PRODUCT_ROWS)
        REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasTrans, PRODUCT_ROWS, outputs, inputs, 1, x, inputs, w, inputs, 0, y,
                  outputs);
    double seconds = cpu_now() - start;
    free(x);
    free(w);
    free(y);
    return seconds;
}

/// The products of the published layers: 21 and then 125 inputs for every half-flap.
static double published_products(size_t vertices)
{
    // A torus has six half-flaps for each vertex: once at the start, twice at level 0, twice at level 1 with four times as
    // many.
    size_t flaps = 6 * vertices;
    return time_product(flaps, 21, MESH_WIDTH) + time_product(10 * flaps, 125, MESH_WIDTH) +
           time_product(22 * flaps, MESH_WIDTH, MESH_WIDTH);
}

/// The products that remain when features are multiplied once for each vertex.
static double own_products(size_t vertices)
{
    enum
    {
        FEATURES = MESH_WIDTH - 3
    };
    size_t flaps = 6 * vertices;
    return time_product(flaps, 21, MESH_WIDTH) + time_product(10 * flaps, FLAP_EDGES, MESH_WIDTH) +
           time_product(10 * vertices, FEATURES, 4 * MESH_WIDTH) + time_product(22 * flaps, MESH_WIDTH, MESH_WIDTH);
}

static void report(const char *name, const bat_mesh *coarse, double seconds, const double products[2])
{
    (void)printf(
        "%s: %zu faces by %d levels: %.2f ms on one thread, connectivity included; %.2f of the rate of the published "
        "layers' bare sgemm, %.2f of that of the products it makes itself\n",
        name, coarse->face_count, LEVELS, 1e3 * seconds, products[0] / seconds, products[1] / seconds);
}

static void time_mesh(const char *name, const bat_mesh_model *model, const bat_mesh *coarse, int rounds)
{
    bat_mesh fine = {.positions = calloc(3 * 16 * coarse->vertex_count, sizeof(double))};
    double *seconds = calloc((size_t)rounds, sizeof *seconds), *published = calloc((size_t)rounds, sizeof *published),
           *own = calloc((size_t)rounds, sizeof *own);
    if (fine.positions == NULL || seconds == NULL || published == NULL || own == NULL)
        exit(EXIT_FAILURE);
    for (int round = 0; round < rounds; round++)
    {
        published[round] = published_products(coarse->vertex_count);
        own[round] = own_products(coarse->vertex_count);
        seconds[round] = time_refinement(model, coarse, &fine);
    }
    report(name, coarse, median_of(seconds, (size_t)rounds),
           (double[2]){median_of(published, (size_t)rounds), median_of(own, (size_t)rounds)});
    free(fine.positions);
    free(seconds);
    free(published);
    free(own);
}

/// The network that the library comes with, beside the published one.
static void time_learned(const bat_mesh_model *published, const bat_mesh *coarse, const char *name, int rounds)
{
    bat_mesh fine = {.positions = calloc(3 * 16 * coarse->vertex_count, sizeof(double))};
    double *seconds = calloc((size_t)rounds, sizeof *seconds), *theirs = calloc((size_t)rounds, sizeof *theirs);
    bat_mesh_model *model;
    if (fine.positions == NULL || seconds == NULL || theirs == NULL || bat_mesh_model_read(NULL, &model, NULL) != BAT_OK)
        exit(EXIT_FAILURE);
    for (int round = 0; round < rounds; round++)
    {
        theirs[round] = time_refinement(published, coarse, &fine);
        seconds[round] = time_refinement(model, coarse, &fine);
    }
    double ours = median_of(seconds, (size_t)rounds);
    (void)printf("%s, the library's network: %.2f ms, %.2f of the time of the published one\n", name, 1e3 * ours,
                 ours / median_of(theirs, (size_t)rounds));
    free(fine.positions);
    free(seconds);
    free(theirs);
    bat_mesh_model_free(model);
}

/// Forward, backward, and the loss of three levels.
static void time_step(const bat_mesh *coarse)
{
    learn_parameters parameters = {0};
    bat_mesh_connectivity connectivity;
    mesh_levels levels;
    learn_tape tape = learn_tape_make();
    if (mesh_network_make((mesh_network_form){0}, &parameters, NULL) != BAT_OK ||
        bat_mesh_connect(coarse, &connectivity, NULL) != BAT_OK ||
        mesh_levels_make(coarse->faces, &connectivity, LEVELS, 1, &levels, NULL) != BAT_OK)
        exit(EXIT_FAILURE);
    mesh_network_start(&parameters, 1);
    real *gradient = calloc(parameters.total, sizeof *gradient);
    double forward[STEP_ROUNDS], both[STEP_ROUNDS];
    for (int round = 0; round < STEP_ROUNDS && gradient != NULL; round++)
    {
        learn_array *states[LEVELS + 1], *loss = NULL;
        double start = cpu_now();
        learn_tape_begin(&tape, &parameters, gradient);
        learn_array *positions = learn_array_make(&tape, coarse->vertex_count, 3, false);
        for (size_t i = 0; i < learn_size(positions); i++)
            positions->value[i] = (real)coarse->positions[i];
        mesh_network_refine(&tape, (mesh_network_form){0}, &levels, positions, states);
        for (size_t i = 0; i <= LEVELS; i++)
        {
            learn_array *own = learn_mean_of_squares(&tape, learn_slice_columns(&tape, states[i], 0, 3));
            loss = i == 0 ? own : learn_add(&tape, loss, own);
        }
        forward[round] = cpu_now() - start;
        learn_tape_backward(&tape, loss, 1);
        both[round] = cpu_now() - start;
    }
    (void)printf("a training step of a mesh of %zu vertices, %d levels: %.2f ms on one thread, of which %.2f forward\n",
                 coarse->vertex_count, LEVELS, 1e3 * median_of(both, STEP_ROUNDS), 1e3 * median_of(forward, STEP_ROUNDS));
    free(gradient);
    learn_tape_free(&tape);
    mesh_levels_free(&levels);
    bat_mesh_connectivity_free(&connectivity);
    learn_parameters_free(&parameters);
}

int main(void)
{
    bat_mesh_model *model = random_model();
    bat_mesh small = make_torus(20, 10), large = make_torus(250, 200), medium = make_torus(25, 9);
    blas_single_begin();
    time_mesh("small", model, &small, SMALL_ROUNDS);
    time_mesh("large", model, &large, LARGE_ROUNDS);
    time_learned(model, &small, "small", SMALL_ROUNDS);
    time_learned(model, &large, "large", LARGE_ROUNDS);
    time_step(&medium);
    blas_single_end();
    bat_mesh_free(&small);
    bat_mesh_free(&large);
    bat_mesh_free(&medium);
    bat_mesh_model_free(model);
    return EXIT_SUCCESS;
}
