#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double DEGREES = 57.295779513082320877;

enum
{
    MAX_WAYS = 32
};

/// Means over the meshes that were made in one way, refined by one method.
typedef struct summary
{
    const char *way, *method;
    size_t count, closed;
    double relative, worst; ///< sum of logarithms; the greatest
    const char *worst_shape;
    double rough, volume; ///< sums: of logarithms of the angle over the true one; of absolute errors
} summary;

static int print_json(const bat_real_meshes_row *rows, size_t count, size_t levels)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
    {
        const bat_real_meshes_row *row = &rows[i];
        (void)json_array_append_new(
            array, json_pack("{s:s, s:s, s:I, s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "shape", row->shape, "way", row->way,
                             "vertices", (json_int_t)row->vertices, "scheme", row->method, "mean", report_number(row->mean),
                             "hausdorff", report_number(row->hausdorff), "relative", report_number(row->relative), "angle",
                             report_number(row->angle * DEGREES), "true_angle", report_number(row->true_angle * DEGREES),
                             "volume", report_number(row->volume)));
    }
    return report_json(json_pack("{s:I, s:o}", "levels", (json_int_t)levels, "rows", array));
}

static void print_rows(const bat_real_meshes_row *rows, size_t count)
{
    (void)printf("%-12s %8s %-10s %-20s %8s %9s %10s %6s %6s %8s\n", "shape", "vertices", "way", "scheme", "relative",
                 "mean %", "largest %", "angle", "true", "volume %");
    for (size_t i = 0; i < count; i++)
    {
        const bat_real_meshes_row *row = &rows[i];
        (void)printf("%-12s %8zu %-10s %-20s %8.3f %9.4f %10.3f %6.1f %6.1f ", row->shape, row->vertices, row->way,
                     row->method, row->relative, 100 * row->mean, 100 * row->hausdorff, row->angle * DEGREES,
                     row->true_angle * DEGREES);
        if (isfinite(row->volume))
            (void)printf("%8.2f\n", 100 * row->volume);
        else
            (void)printf("%8s\n", "-");
    }
}

static void add_row(summary *s, const bat_real_meshes_row *row)
{
    s->count++;
    s->relative += log(row->relative);
    s->rough += log(row->angle / row->true_angle);
    if (row->relative > s->worst)
    {
        s->worst = row->relative;
        s->worst_shape = row->shape;
    }
    if (isfinite(row->volume))
    {
        s->closed++;
        s->volume += fabs(row->volume);
    }
}

static void print_summary(const bat_real_meshes_row *rows, size_t count)
{
    summary all[MAX_WAYS * 8] = {0};
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
    {
        size_t at = 0;
        while (at < used && (strcmp(all[at].way, rows[i].way) != 0 || strcmp(all[at].method, rows[i].method) != 0))
            at++;
        if (at == sizeof all / sizeof *all)
            continue;
        if (at == used)
            all[used++] = (summary){.way = rows[i].way, .method = rows[i].method};
        add_row(&all[at], &rows[i]);
    }
    (void)printf("\n%-10s %-20s %6s %8s %8s %-12s %10s %8s\n", "way", "scheme", "meshes", "relative", "worst", "of",
                 "angle/true", "volume %");
    for (size_t i = 0; i < used; i++)
    {
        const summary *s = &all[i];
        double share = 1 / (double)s->count;
        (void)printf("%-10s %-20s %6zu %8.3f %8.3f %-12s %10.3f ", s->way, s->method, s->count, exp(share * s->relative),
                     s->worst, s->worst_shape, exp(share * s->rough));
        if (s->closed > 0)
            (void)printf("%8.2f\n", 100 * s->volume / (double)s->closed);
        else
            (void)printf("%8s\n", "-");
    }
}

int reproduce_real_meshes(const reproduce_job *job)
{
    bat_real_meshes_options options = bat_real_meshes_defaults();
    bat_mesh_model *model = NULL;
    bat_real_meshes_row *rows;
    size_t count;
    bat_error error;
    if (job->model != NULL && bat_mesh_model_read_published(job->model, &model, &error) != BAT_OK)
        return report_failure(job->model, &error);
    options.model = model;
    options.progress = report_progress("measuring meshes");
    bat_status status = bat_real_meshes(job->data, &options, &rows, &count, &error);
    report_progress_end();
    bat_mesh_model_free(model);
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    int code = EXIT_DONE;
    if (job->call.json)
        code = print_json(rows, count, options.levels);
    else
    {
        (void)printf(
            "Coarse meshes refined by %zu levels against the shapes that they were made from.\n"
            "relative: mean distance over the least of flat, butterfly and Loop; mean and largest distance over the\n"
            "diagonal; angle: 95 %% quantile between neighbouring faces, degrees; true: the same with all vertices\n"
            "moved to the shape; volume: error.\n\n",
            options.levels);
        print_rows(rows, count);
        print_summary(rows, count);
    }
    free(rows);
    return code;
}
