#include "reproduce.h"

#include "arguments.h"
#include "report.h"

#include "batten/batten.h"
#include "batten/research/curve_shapes.h"
#include "batten/research/research.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum
{
    PANELS = 5,
    MIDDLE = 3, ///< the panels of level 10 …
    LAST = 4,   ///< … and of level 20
    MAX_OUTLINES = BAT_SHAPE_MAX_OUTLINES,
    NAME_SIZE = 64
};

/// The levels that the study shows.
static const size_t LEVELS[PANELS] = {0, 1, 2, 10, 20};

/// One figure of the study: a shape at every level, and its measurements.
typedef struct figure
{
    const bat_curve_shape *shape;
    const bat_shape_figure *study;
    bat_curve curves[PANELS][MAX_OUTLINES];
    char name[NAME_SIZE]; ///< of its files, without folder and ending
    size_t vertices, points;
    double seconds;          ///< time to refine to the last level
    double chord;            ///< largest distance of the last level from the edges of the middle one
    double middle_off_limit; ///< largest distance of a vertex of the middle level from its limit
    double last_off_limit;   ///< the same for the last level
} figure;

static double now(void)
{
    struct timespec time;
    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static bat_status refine_outlines(figure *f, const bat_space *plane, size_t panel, const bat_curve_scheme *scheme,
                                  bat_error *error)
{
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = *scheme;
    how.levels = LEVELS[panel];
    how.simple = BAT_CURVE_SIMPLE_NEVER;
    how.progress = report_progress(f->name);
    bat_status status = BAT_OK;
    for (size_t o = 0; o < f->shape->outline_count && status == BAT_OK; o++)
    {
        bat_curve coarse;
        status = bat_curve_shape_curve(f->shape, o, plane, &coarse, error);
        if (status != BAT_OK)
            break;
        status = bat_curve_refine(&coarse, &how, &f->curves[panel][o], error);
        bat_curve_free(&coarse);
    }
    return status;
}

/// Update the largest distances of the figure by those of outline `o`.
static bat_status measure_outline(figure *f, size_t o, const bat_mask_stencil *stencil, bat_error *error)
{
    const bat_curve *middle = &f->curves[MIDDLE][o], *last = &f->curves[LAST][o];
    bat_curve_measure_options how = bat_curve_measure_defaults();
    how.progress = report_progress(f->name);
    double chord, middle_off_limit, last_off_limit;
    bat_status status = bat_curve_chord_distance(middle, last, &how, &chord, error);
    if (status == BAT_OK)
        status = bat_curve_limit_distance(middle, stencil, &how, &middle_off_limit, error);
    if (status == BAT_OK)
        status = bat_curve_limit_distance(last, stencil, &how, &last_off_limit, error);
    if (status != BAT_OK)
        return status;
    f->chord = fmax(f->chord, chord);
    f->middle_off_limit = fmax(f->middle_off_limit, middle_off_limit);
    f->last_off_limit = fmax(f->last_off_limit, last_off_limit);
    return BAT_OK;
}

static bat_status figure_measure(figure *f, const bat_mask_stencil *stencil, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t o = 0; o < f->shape->outline_count && status == BAT_OK; o++)
    {
        f->vertices += f->curves[0][o].count;
        f->points += f->curves[LAST][o].count;
        status = measure_outline(f, o, stencil, error);
    }
    return status;
}

static bat_status figure_make(const bat_curve_shape *shape, const bat_shape_figure *study, const bat_space *plane, figure *f,
                              bat_error *error)
{
    *f = (figure){.shape = shape, .study = study};
    (void)snprintf(f->name, sizeof f->name, "curve-figures-%.*s-%s", (int)strcspn(study->scheme, ":"), study->scheme,
                   shape->name);
    bat_curve_scheme scheme;
    bat_mask_stencil stencil;
    bat_status status = bat_curve_scheme_by_name(study->scheme, &scheme, error);
    if (status == BAT_OK)
        status = bat_mask_limit_stencil(&scheme.mask, &stencil, error);
    for (size_t panel = 0; panel < PANELS && status == BAT_OK; panel++)
    {
        double begin = now();
        status = refine_outlines(f, plane, panel, &scheme, error);
        f->seconds = now() - begin;
    }
    return status == BAT_OK ? figure_measure(f, &stencil, error) : status;
}

static void figure_free(figure *f)
{
    for (size_t panel = 0; panel < PANELS; panel++)
        for (size_t o = 0; o < MAX_OUTLINES; o++)
            bat_curve_free(&f->curves[panel][o]);
}

/// Write the five panels, as SVG and as PNG.
static int figure_draw(const figure *f, const reproduce_job *job)
{
    bat_curve_picture_layer layers[PANELS][MAX_OUTLINES];
    bat_curve_picture_panel panels[PANELS];
    char titles[PANELS][NAME_SIZE], heading[2 * NAME_SIZE], name[NAME_SIZE + 8];
    for (size_t panel = 0; panel < PANELS; panel++)
    {
        for (size_t o = 0; o < f->shape->outline_count; o++)
            layers[panel][o] = (bat_curve_picture_layer){.curve = &f->curves[panel][o], .colour = 1};
        (void)snprintf(titles[panel], sizeof titles[panel], "level %zu", LEVELS[panel]);
        panels[panel] = (bat_curve_picture_panel){layers[panel], f->shape->outline_count, titles[panel]};
    }
    (void)snprintf(heading, sizeof heading, "%s, %s", f->shape->name, f->study->scheme);
    bat_curve_picture_options how = bat_curve_picture_defaults();
    how.title = heading;
    static const char *const ENDINGS[] = {"svg", "png"};
    for (size_t i = 0; i < sizeof ENDINGS / sizeof ENDINGS[0]; i++)
    {
        bat_error error;
        reproduce_picture picture;
        (void)snprintf(name, sizeof name, "%s.%s", f->name, ENDINGS[i]);
        int code = reproduce_picture_add(job, name, &picture);
        if (code != EXIT_DONE)
            return code;
        if (bat_curve_picture_write(picture.write_to, panels, PANELS, &how, &error) != BAT_OK)
            return report_failure(picture.path, &error);
    }
    return EXIT_DONE;
}

static json_t *figure_json(const figure *f)
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

static void print_figure(const figure *f)
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
    bat_space plane = bat_euclidean(2);
    bat_error error;
    figure f;
    bat_status status = figure_make(shape, study, &plane, &f, &error);
    report_progress_end();
    int code = status == BAT_OK ? figure_draw(&f, job) : report_failure(shape->name, &error);
    if (code == EXIT_DONE && array != NULL && json_array_append_new(array, figure_json(&f)) != 0)
        code = report_failure(NULL, &(bat_error){.text = "out of memory"});
    else if (code == EXIT_DONE && array == NULL)
        print_figure(&f);
    figure_free(&f);
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
