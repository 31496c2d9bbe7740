// What a point costs that a decimation's map carries: random points of the coarse mesh to the fine one and back, many in a
// call and one in a call, on one thread, as shares of a bound of 3 microseconds. It also prints the error of the round trip.
//
//   bench_mesh_map [SHARE [MESH ...]]     SHARE: of the vertices that stay, default .01
//
// Without a mesh, a creature of 50,000 vertices.

#include "timing.h"

#include "batten/batten.h"
#include "batten/research/mesh_shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum
{
    POINTS = 50000,
    ROUNDS = 3,
    VERTICES = 50000
};

static const double BOUND = 3e-6, DEFAULT_SHARE = 0.01;

/// Processor time: other programs do not count.
static double processor_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int failed(const bat_error *error)
{
    (void)fprintf(stderr, "bench_mesh_map: %s\n", error->text);
    return 1;
}

/// Carry all points, `block` in a call.
static double carry(const bat_mesh_map *map, bool to_fine, bat_mesh_point *points, size_t block)
{
    double begun = processor_seconds();
    for (size_t i = 0; i < POINTS; i += block)
        (void)(to_fine ? bat_mesh_map_to_fine : bat_mesh_map_to_coarse)(map, points + i, block, NULL);
    return processor_seconds() - begun;
}

static double round_trip(const bat_mesh *mesh, const bat_mesh_point *a, const bat_mesh_point *b)
{
    double square = 0;
    for (size_t k = 0; k < 3; k++)
    {
        double step = 0;
        for (size_t c = 0; c < 3; c++)
            step += a->barycentric[c] * mesh->positions[3 * (size_t)mesh->faces[3 * (size_t)a->face + c] + k] -
                    b->barycentric[c] * mesh->positions[3 * (size_t)mesh->faces[3 * (size_t)b->face + c] + k];
        square += step * step;
    }
    return sqrt(square);
}

static int measure(const char *name, const bat_mesh *fine, double share)
{
    static bat_mesh_point points[POINTS], carried[POINTS];
    bat_mesh coarse;
    bat_mesh_map *map;
    bat_error error;
    bat_mesh_summary summary;
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.ratio = share;
    if (bat_mesh_decimate(fine, &options, &coarse, &map, &error) != BAT_OK ||
        bat_mesh_summarize(&coarse, &summary, &error) != BAT_OK)
        return failed(&error);
    bat_random random = bat_random_seed(1);
    for (size_t i = 0; i < POINTS; i++)
    {
        double u = sqrt(bat_random_uniform(&random)), v = bat_random_uniform(&random);
        points[i] = (bat_mesh_point){(uint32_t)(bat_random_bits(&random) % coarse.face_count), {1 - u, u * (1 - v), u * v}};
    }
    (void)printf("%s: %zu faces to %zu, microseconds a point (share of the bound)\n", name, fine->face_count,
                 coarse.face_count);
    for (size_t block = POINTS; block >= 1; block = block > 1 ? 1 : 0)
    {
        double there[ROUNDS], back[ROUNDS], worst = 0;
        for (size_t round = 0; round < ROUNDS; round++)
        {
            memcpy(carried, points, sizeof points);
            there[round] = carry(map, true, carried, block) / POINTS;
            back[round] = carry(map, false, carried, block) / POINTS;
        }
        for (size_t i = 0; i < POINTS; i++)
            worst = fmax(worst, round_trip(&coarse, &points[i], &carried[i]));
        double to_fine = median_of(there, ROUNDS), to_coarse = median_of(back, ROUNDS);
        (void)printf("  %6zu a call: to fine %.2f (%.2f), to coarse %.2f (%.2f); round trip %.1e of the diagonal\n", block,
                     1e6 * to_fine, to_fine / BOUND, 1e6 * to_coarse, to_coarse / BOUND, worst / summary.diagonal);
    }
    bat_mesh_free(&coarse);
    bat_mesh_map_free(map);
    return 0;
}

int main(int argc, char **argv)
{
    double share = argc > 1 ? strtod(argv[1], NULL) : DEFAULT_SHARE;
    int code = 0;
    bat_mesh mesh;
    bat_error error;
    if (argc <= 2)
    {
        if (bat_mesh_shape("creature", VERTICES, 1, &mesh, &error) != BAT_OK)
            return failed(&error);
        code = measure("creature", &mesh, share);
        bat_mesh_free(&mesh);
    }
    for (int i = 2; i < argc && code == 0; i++)
    {
        if (bat_mesh_read(argv[i], NULL, &mesh, &error) != BAT_OK)
            return failed(&error);
        code = measure(argv[i], &mesh, share);
        bat_mesh_free(&mesh);
    }
    return code;
}
