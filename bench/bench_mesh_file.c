// Reading and writing of meshes: a torus of about 100 MB as OBJ, and the same as PLY, OFF and STL. Rates are compared with
// copying the same bytes in memory, measured in the same run, a bound for any reader.

#include "timing.h"

#include "batten/mesh_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum
{
    AROUND = 1150, ///< vertices around the tube and along it
    ROUNDS = 3,
    FLOOR = 150 ///< MB/s of reading OBJ
};

/// A torus of AROUND x AROUND vertices with rounded numbers, as other programs write them, or with all digits.
static bool make_torus(bool rounded, bat_mesh *mesh)
{
    static const double turn = 6.283185307179586;
    size_t count = (size_t)AROUND * AROUND;
    *mesh = (bat_mesh){.positions = malloc(count * 3 * sizeof(double)),
                       .faces = malloc(count * 6 * sizeof(uint32_t)),
                       .vertex_count = count,
                       .face_count = 2 * count};
    if (mesh->positions == NULL || mesh->faces == NULL)
        return false;
    for (size_t i = 0; i < count; i++)
    {
        double u = turn * (double)(i / AROUND) / AROUND, v = turn * (double)(i % AROUND) / AROUND;
        const double point[3] = {(3 + cos(v)) * cos(u), (3 + cos(v)) * sin(u), sin(v)};
        for (size_t k = 0; k < 3; k++)
            mesh->positions[3 * i + k] = rounded ? round(point[k] * 1e6) / 1e6 : point[k];
        size_t right = i / AROUND * AROUND + (i + 1) % AROUND, up = (i + AROUND) % count, far = (right + AROUND) % count;
        const size_t corners[6] = {i, up, far, i, far, right};
        for (size_t k = 0; k < 6; k++)
            mesh->faces[6 * i + k] = (uint32_t)corners[k];
    }
    return true;
}

/// The processor seconds of this process.
static double seconds_computed(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/// Seconds to copy bytes to new memory; negative when out of memory.
static double copy_seconds(const char *bytes, size_t size)
{
    double start = seconds_computed();
    char *copy = malloc(size);
    if (copy == NULL)
        return -1.0;
    memcpy(copy, bytes, size);
    volatile char last = copy[size - 1];
    (void)last;
    double spent = seconds_computed() - start;
    free(copy);
    return spent;
}

/// The measurements of a format.
typedef struct format_rates
{
    double read[ROUNDS], write[ROUNDS], ratio[ROUNDS]; ///< MB/s of processor time; reading relative to copying
} format_rates;

static bool measure_round(const bat_mesh *mesh, const bat_mesh_write_options *writing, int round, format_rates *rates,
                          double *megabytes)
{
    bat_mesh_read_options reading = bat_mesh_read_defaults();
    bat_error error = {.text = ""};
    bat_mesh back = {0};
    char *bytes = NULL;
    size_t size = 0;
    reading.format = writing->format;
    double start = seconds_computed();
    bool fine = bat_mesh_write_memory(mesh, writing, &bytes, &size, &error) == BAT_OK;
    double written = seconds_computed();
    fine = fine && bat_mesh_read_memory(bytes, size, &reading, &back, &error) == BAT_OK;
    double read = seconds_computed();
    *megabytes = (double)size * 1e-6;
    rates->write[round] = *megabytes / (written - start);
    rates->read[round] = *megabytes / (read - written);
    rates->ratio[round] = fine ? copy_seconds(bytes, size) / (read - written) : 0.0;
    if (!fine)
        (void)fprintf(stderr, "%s\n", error.text);
    bat_mesh_free(&back);
    free(bytes);
    return fine;
}

static bool measure(const bat_mesh *mesh, const char *name, bat_mesh_format format, bat_mesh_encoding encoding)
{
    bat_mesh_write_options writing = bat_mesh_write_defaults();
    writing.format = format;
    writing.encoding = encoding;
    writing.threads = 1;
    format_rates rates;
    double megabytes;
    for (int round = 0; round < ROUNDS; round++)
        if (!measure_round(mesh, &writing, round, &rates, &megabytes))
            return false;
    (void)printf("%-22s %4.0f MB: read at %5.0f MB/s, %.3f of the rate of copying; written at %5.0f MB/s\n", name, megabytes,
                 median_of(rates.read, ROUNDS), median_of(rates.ratio, ROUNDS), median_of(rates.write, ROUNDS));
    return true;
}

int main(void)
{
    bat_mesh rounded = {0}, exact = {0};
    bool fine = make_torus(true, &rounded) && make_torus(false, &exact);
    (void)printf("A torus of %d vertices and %d faces, one thread (floor for OBJ: %d MB/s)\n", AROUND * AROUND,
                 2 * AROUND * AROUND, FLOOR);
    fine = fine && measure(&rounded, "OBJ, 6 decimals", BAT_MESH_FORMAT_OBJ, BAT_MESH_ENCODING_TEXT) &&
           measure(&exact, "OBJ, all digits", BAT_MESH_FORMAT_OBJ, BAT_MESH_ENCODING_TEXT) &&
           measure(&exact, "OFF", BAT_MESH_FORMAT_OFF, BAT_MESH_ENCODING_TEXT) &&
           measure(&exact, "PLY, ascii", BAT_MESH_FORMAT_PLY, BAT_MESH_ENCODING_TEXT) &&
           measure(&exact, "PLY, little-endian", BAT_MESH_FORMAT_PLY, BAT_MESH_ENCODING_BINARY) &&
           measure(&exact, "PLY, big-endian", BAT_MESH_FORMAT_PLY, BAT_MESH_ENCODING_BIG_ENDIAN) &&
           measure(&exact, "STL, binary", BAT_MESH_FORMAT_STL, BAT_MESH_ENCODING_BINARY);
    bat_mesh_free(&rounded);
    bat_mesh_free(&exact);
    return !fine;
}
