// Refinement of meshes against writing its result to memory, measured in turn in one run: growth with size, memory, threads.
//
//   bench_mesh_refine [LEVELS]     from 40,000 faces; the default is 3, and 5 gives 41 million

#include "timing.h"

#include "../tests/support/mesh_makers.h"
#include "base/memory.h"
#include "batten/mesh_refine.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

enum
{
    ROUNDS = 5,
    SEEN_IN_PEAK = 200 << 20 ///< bytes; the process itself is small compared with larger results
};

static const struct
{
    const char *name;
    bat_mesh_scheme scheme;
} SCHEMES[] = {
    {"midpoint", BAT_MESH_SCHEME_MIDPOINT},
    {"loop", BAT_MESH_SCHEME_LOOP},
    {"butterfly", BAT_MESH_SCHEME_BUTTERFLY},
    {"sqrt3", BAT_MESH_SCHEME_SQRT3},
};

static size_t result_bytes(const bat_mesh *mesh)
{
    return mesh->vertex_count * 3 * sizeof *mesh->positions + mesh->face_count * 3 * sizeof *mesh->faces;
}

/// Seconds to allocate and fill new memory.
static double fill_seconds(size_t bytes)
{
    double start = seconds_now();
    unsigned char *room = memory_array(bytes, 1);
    if (room == NULL)
        return 0;
    memset(room, 1, bytes);
    // Use what is written.
    volatile unsigned char keep = room[bytes / 2];
    (void)keep;
    double seconds = seconds_now() - start;
    free(room);
    return seconds;
}

/// Processor seconds of this process so far.
static double processor_seconds(void)
{
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static long peak_bytes(void)
{
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss * 1024;
}

static void bench_scheme(const bat_mesh *coarse, size_t which, size_t levels, int threads)
{
    double wall[ROUNDS], busy[ROUNDS], fill[ROUNDS];
    size_t faces = 0, bytes = 0;
    for (int round = 0; round < ROUNDS; round++)
    {
        bat_mesh_refine_options options = bat_mesh_refine_defaults();
        options.scheme = SCHEMES[which].scheme;
        options.levels = levels;
        options.threads = threads;
        bat_mesh fine;
        bat_error error;
        double start = seconds_now(), start_busy = processor_seconds();
        if (bat_mesh_refine(coarse, &options, &fine, NULL, &error) != BAT_OK)
        {
            (void)fprintf(stderr, "bench_mesh_refine: %s\n", error.text);
            return;
        }
        wall[round] = seconds_now() - start;
        busy[round] = processor_seconds() - start_busy;
        faces = fine.face_count;
        bytes = result_bytes(&fine);
        bat_mesh_free(&fine);
        fill[round] = fill_seconds(bytes);
    }
    double seconds = median_of(wall, ROUNDS);
    (void)printf("%-10s %zu levels, %-11s %9zu faces: %4.2f of the speed of filling new memory, %5.1f million faces a "
                 "second, %3.0f ns of processor a face",
                 SCHEMES[which].name, levels, threads == 1 ? "one thread" : "all threads", faces,
                 median_of(fill, ROUNDS) / seconds, 1e-6 * (double)faces / seconds,
                 1e9 * median_of(busy, ROUNDS) / (double)faces);
    if (bytes > SEEN_IN_PEAK)
        (void)printf("; peak of memory so far %4.2f times the result", (double)peak_bytes() / (double)bytes);
    (void)printf("\n");
}

int main(int argc, char **argv)
{
    size_t most = argc > 1 ? (size_t)strtoul(argv[1], NULL, 10) : 3;
    bat_mesh coarse = mesh_irregular(200, 100, 2);
    (void)printf("From %zu faces of vertices with 3 to 12 faces; medians of %d rounds, neighbours from the list of faces "
                 "included\n",
                 coarse.face_count, ROUNDS);
    for (size_t levels = 1; levels <= most; levels++)
        for (size_t i = 0; i < sizeof SCHEMES / sizeof SCHEMES[0]; i++)
            for (int threads = 1; threads >= 0; threads--)
                bench_scheme(&coarse, i, levels, threads);
    bat_mesh_free(&coarse);
    return 0;
}
