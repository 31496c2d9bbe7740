// The engine of the npm package against the library, on one thread, in processor time: Loop's scheme on 100,000 faces by 2
// levels, a million points by the angle-based and the four-point scheme, 100 points by the learned one. Needs node and `make
// web`.

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

enum
{
    ROUNDS = 12,
    ROWS = 250, ///< of the torus: 100,000 faces
    COLUMNS = 200,
    POINTS = 31250, ///< a million after 5 levels
    FEW_POINTS = 100,
    LEVELS = 5
};

static const double TWO_PI = 6.28318530717958647692;

static double processor_seconds(void)
{
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static bool make_torus(bat_mesh *mesh)
{
    *mesh = (bat_mesh){.positions = malloc(sizeof(double) * 3 * ROWS * COLUMNS),
                       .faces = malloc(sizeof(uint32_t) * 6 * ROWS * COLUMNS),
                       .vertex_count = ROWS * COLUMNS,
                       .face_count = 2 * ROWS * COLUMNS};
    if (mesh->positions == NULL || mesh->faces == NULL)
        return false;
    for (uint32_t i = 0; i < ROWS; i++)
        for (uint32_t j = 0; j < COLUMNS; j++)
        {
            double s = TWO_PI * i / ROWS, t = TWO_PI * j / COLUMNS;
            uint32_t at = i * COLUMNS + j, next = (i + 1) % ROWS, beside = (j + 1) % COLUMNS;
            double *position = mesh->positions + 3 * at;
            position[0] = (2 + cos(t)) * cos(s);
            position[1] = (2 + cos(t)) * sin(s);
            position[2] = sin(t);
            uint32_t corners[6] = {at, next * COLUMNS + j,      next * COLUMNS + beside,
                                   at, next * COLUMNS + beside, i * COLUMNS + beside};
            for (size_t c = 0; c < 6; c++)
                mesh->faces[6 * at + c] = corners[c];
        }
    return true;
}

static double mesh_seconds(const bat_mesh *mesh)
{
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LOOP;
    options.levels = 2;
    options.threads = 1;
    double least = INFINITY;
    for (int round = 0; round < ROUNDS; round++)
    {
        bat_mesh fine = {0};
        double begin = processor_seconds();
        if (bat_mesh_refine(mesh, &options, &fine, NULL, NULL) != BAT_OK)
            return NAN;
        least = fmin(least, processor_seconds() - begin);
        bat_mesh_free(&fine);
    }
    return least;
}

static double curve_seconds(size_t count, const char *scheme)
{
    const bat_space plane = bat_euclidean(2);
    bat_curve coarse = {.space = &plane, .points = malloc(sizeof(double) * 2 * count), .count = count, .closed = true};
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = LEVELS;
    options.threads = 1;
    options.simple = BAT_CURVE_SIMPLE_NEVER;
    double least = INFINITY;
    if (coarse.points == NULL || bat_curve_scheme_by_name(scheme, &options.scheme, NULL) != BAT_OK)
        least = NAN;
    for (size_t i = 0; i < count && coarse.points != NULL; i++)
    {
        double t = TWO_PI * (double)i / (double)count, r = 1 + 0.1 * sin(7 * t);
        coarse.points[2 * i] = r * cos(t);
        coarse.points[2 * i + 1] = r * sin(t);
    }
    for (int round = 0; round < ROUNDS && !isnan(least); round++)
    {
        bat_curve fine = {0};
        double begin = processor_seconds();
        least = bat_curve_refine(&coarse, &options, &fine, NULL) == BAT_OK ? fmin(least, processor_seconds() - begin) : NAN;
        bat_curve_free(&fine);
    }
    free(coarse.points);
    return least;
}

int main(void)
{
    FILE *peer = popen("node " BENCH_FOLDER "/peer_web.mjs", "r");
    bat_mesh mesh = {0};
    static const char *const NAMES[] = {"Loop, 100,000 faces by 2 levels", "angle-4, a million points",
                                        "four-point, a million points", "learned, 100 points by 5 levels"};
    double theirs[4] = {0};
    bool complete = peer != NULL && make_torus(&mesh);
    for (size_t i = 0; i < 4 && complete; i++)
        complete = fscanf(peer, "%lf", &theirs[i]) == 1;
    if (peer != NULL)
        (void)pclose(peer);
    if (complete)
    {
        double ours[4] = {mesh_seconds(&mesh), curve_seconds(POINTS, "angle-4"), curve_seconds(POINTS, "four-point"),
                          curve_seconds(FEW_POINTS, "learned")};
        for (size_t i = 0; i < 4; i++)
            printf("%-34s the package's speed over the library's: %.2f\n", NAMES[i], ours[i] / theirs[i]);
    }
    else
        printf("left out: the package needs node and `make web`\n");
    bat_mesh_free(&mesh);
    return 0;
}
