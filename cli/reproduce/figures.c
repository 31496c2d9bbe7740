#include "reproduce.h"

#include "report.h"

#include "batten/research/curve_shapes.h"
#include "batten/space.h"

#include <stdio.h>

static json_t *figure_json(const bat_curve_figure *f)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:I, s:I, s:f, s:f, s:f, s:f}", "figure", f->study->number, "shape",
                     f->shape->name, "scheme", f->study->scheme, "picture", f->name, "vertices", (json_int_t)f->vertices,
                     "points", (json_int_t)f->points, "seconds", f->seconds, "level_10_to_20", f->chord, "level_10_to_limit",
                     f->middle_off_limit, "level_20_to_limit", f->last_off_limit);
}

static void print_head(void)
{
    (void)printf("The figures of Alam (2025) with our own polygons, refined by 20 levels.\n\n");
    (void)printf("%-6s %-7s %-26s %8s %10s %8s %12s %12s %12s\n", "figure", "shape", "scheme", "vertices", "points",
                 "seconds", "10 to 20", "10 to limit", "20 to limit");
}

static void print_figure(const bat_curve_figure *f)
{
    (void)printf("%-6s %-7s %-26s %8zu %10zu %8.2f %12.2e %12.2e %12.2e\n", f->study->number, f->shape->name,
                 f->study->scheme, f->vertices, f->points, f->seconds, f->chord, f->middle_off_limit, f->last_off_limit);
    (void)fflush(stdout);
}

static void print_foot(const char *folder)
{
    (void)printf(
        "\n10 to 20: how far points of level 20 lie from the polygon of level 10. To limit: how far vertices of a level "
        "lie from\ntheir own limits. Shapes are 2 to 3 units across. The study does not print the ratios of its corner "
        "cutting.\nPictures: %s/curve-figures-SCHEME-SHAPE.svg and .png\n",
        folder);
}

/// Make, draw and report one figure, and let go of its points.
static int reproduce_figure(const bat_curve_shape *shape, const bat_shape_figure *study, const reproduce_job *job,
                            json_t *array)
{
    static const char *const ENDINGS[] = {"svg", "png"};
    bat_space plane = bat_euclidean(2);
    bat_error error;
    bat_curve_figure f;
    bat_status status = bat_curve_figure_make(shape, study, &plane, report_progress(shape->name), &f, &error);
    report_progress_end();
    int code = status == BAT_OK ? EXIT_DONE : report_failure(shape->name, &error);
    for (size_t i = 0; i < sizeof ENDINGS / sizeof *ENDINGS && code == EXIT_DONE; i++)
    {
        char name[80];
        reproduce_picture picture;
        (void)snprintf(name, sizeof name, "%s.%s", f.name, ENDINGS[i]);
        code = reproduce_picture_add(job, name, &picture);
        if (code == EXIT_DONE && bat_curve_figure_draw(picture.write_to, &f, &error) != BAT_OK)
            code = report_failure(picture.path, &error);
    }
    if (code == EXIT_DONE && array != NULL && json_array_append_new(array, figure_json(&f)) != 0)
        code = report_failure(NULL, &(bat_error){.text = "out of memory"});
    else if (code == EXIT_DONE && array == NULL)
        print_figure(&f);
    bat_curve_figure_free(&f);
    return code;
}

int reproduce_curve_figures(const reproduce_job *job)
{
    bool as_json = job->call.json;
    json_t *array = as_json ? json_array() : NULL;
    int code = EXIT_DONE;
    if (as_json && array == NULL)
        return report_json(NULL);
    if (!as_json)
        print_head();
    for (size_t s = 0; s < bat_curve_shape_count() && code == EXIT_DONE; s++)
    {
        const bat_curve_shape *shape = bat_curve_shape_at(s);
        for (size_t k = 0; k < shape->figure_count && code == EXIT_DONE; k++)
            code = reproduce_figure(shape, &shape->figures[k], job, array);
    }
    if (code == EXIT_DONE && as_json)
        return report_json(json_pack("{s:o}", "figures", array));
    json_decref(array);
    if (code == EXIT_DONE)
        print_foot(job->folder);
    return code;
}
