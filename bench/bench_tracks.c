// A GeoJSON file of many short tracks: read, refine, write. The rate of output is compared with that of writing the same
// bytes as they are, measured in the same run.

#include "timing.h"

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    TRACKS = 100000,
    POINTS = 10,
    LEVELS = 4,
    ROUNDS = 3,
    THREADS = 2
};

/// Tracks of about 100 km here and there, as a GPS logger makes them.
static bool write_input(const char *path)
{
    FILE *file = fopen(path, "w");
    if (file == NULL)
        return false;
    bat_random random = bat_random_seed(7);
    (void)fputs("{\"type\":\"FeatureCollection\",\"features\":[\n", file);
    for (int i = 0; i < TRACKS; i++)
    {
        double longitude = 340 * bat_random_uniform(&random) - 170, latitude = 140 * bat_random_uniform(&random) - 70;
        double heading = 6.283185307179586 * bat_random_uniform(&random);
        (void)fprintf(
            file,
            "%s{\"type\":\"Feature\",\"properties\":{\"id\":%d},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[",
            i > 0 ? ",\n" : "", i);
        for (int k = 0; k < POINTS; k++)
        {
            (void)fprintf(file, "%s[%.6f,%.6f]", k > 0 ? "," : "", longitude, latitude);
            heading += 0.3 * bat_random_normal(&random);
            longitude += 0.1 * cos(heading);
            latitude += 0.1 * sin(heading);
        }
        (void)fputs("]}}", file);
    }
    (void)fputs("\n]}\n", file);
    return fclose(file) == 0;
}

/// Seconds spent in each stage.
typedef struct stages
{
    double read, refine, write;
} stages;

static bool run(const char *input, const char *output, stages *spent, bat_error *error)
{
    bat_curve_set coarse = {0}, fine = {0};
    bat_curve_read_options read = bat_curve_read_defaults();
    bat_curve_write_options write = bat_curve_write_defaults();
    bat_curve_refine_options refine = bat_curve_refine_defaults();
    read.threads = write.threads = refine.threads = THREADS;
    refine.levels = LEVELS;
    double start = seconds_now();
    if (bat_curve_read(input, &read, &coarse, error) != BAT_OK)
        return false;
    double after_read = seconds_now();
    bat_curve *curves = calloc(coarse.count, sizeof *curves);
    if (curves == NULL || bat_curves_refine(coarse.curves, coarse.count, &refine, curves, error) != BAT_OK ||
        bat_curve_set_like(&coarse, curves, &fine, error) != BAT_OK)
        return false;
    double after_refine = seconds_now();
    bool written = bat_curve_write(output, &fine, &write, error) == BAT_OK;
    *spent = (stages){after_read - start, after_refine - after_read, seconds_now() - after_refine};
    bat_curve_set_free(&coarse);
    bat_curve_set_free(&fine);
    return written;
}

/// Copy a file's bytes from memory to another file: the bound of any writer. Returns the seconds, and the size.
static double plain_write(const char *from, const char *to, double *size)
{
    FILE *file = fopen(from, "rb");
    if (file == NULL || fseek(file, 0, SEEK_END) != 0)
        return NAN;
    size_t bytes = (size_t)ftell(file);
    rewind(file);
    char *text = malloc(bytes);
    bool read = text != NULL && fread(text, 1, bytes, file) == bytes;
    (void)fclose(file);
    double start = seconds_now();
    file = read ? fopen(to, "wb") : NULL;
    bool written = file != NULL && fwrite(text, 1, bytes, file) == bytes;
    written = file != NULL && fclose(file) == 0 && written;
    double spent = seconds_now() - start;
    free(text);
    *size = (double)bytes;
    return written ? spent : NAN;
}

int main(void)
{
    char folder[] = "/tmp/batten-bench-XXXXXX", input[64], output[64], copy[64];
    if (mkdtemp(folder) == NULL)
        return 1;
    (void)snprintf(input, sizeof input, "%s/in.geojson", folder);
    (void)snprintf(output, sizeof output, "%s/out.geojson", folder);
    (void)snprintf(copy, sizeof copy, "%s/copy", folder);
    int failed = !write_input(input);
    double rates[ROUNDS], ratios[ROUNDS], size = 0;
    stages spent = {0};
    for (int round = 0; round < ROUNDS && !failed; round++)
    {
        bat_error error = {.text = ""};
        failed = !run(input, output, &spent, &error);
        if (failed)
            (void)fprintf(stderr, "%s\n", error.text);
        double plain = failed ? NAN : plain_write(output, copy, &size), total = spent.read + spent.refine + spent.write;
        rates[round] = size / total * 1e-6;
        ratios[round] = plain / total;
    }
    if (!failed)
        (void)printf(
            "%d tracks of %d points refined by %d levels on %d threads: %.0f MB of GeoJSON at %.0f MB/s (floor 100), %.3f "
            "of the rate of writing the same bytes;\nlast round: reading %.2f s, refining %.2f s, writing %.2f s\n",
            TRACKS, POINTS, LEVELS, THREADS, size * 1e-6, median_of(rates, ROUNDS), median_of(ratios, ROUNDS), spent.read,
            spent.refine, spent.write);
    (void)remove(input);
    (void)remove(output);
    (void)remove(copy);
    (void)remove(folder);
    return failed;
}
