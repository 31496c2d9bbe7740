#include "reproduce.h"

#include "arguments.h"
#include "report.h"

#include "batten/batten.h"
#include "batten/shapes.h"

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
    MOST_OUTLINES = BAT_SHAPE_MAX_OUTLINES,
    NAME_SIZE = 64,
    PATH_SIZE = 4096,
};

/// The levels that the study shows.
static const size_t LEVELS[PANELS] = {0, 1, 2, 10, 20};

/// One figure of the study: a shape at every level, and what it says in numbers.
typedef struct figure
{
    const bat_shape *shape;
    const bat_shape_figure *study;
    bat_curve curves[PANELS][MOST_OUTLINES];
    char name[NAME_SIZE]; ///< of its files, without folder and ending
    size_t vertices, points;
    double seconds;          ///< to refine by the last level
    double chord;            ///< greatest distance of the last level from the edges of the middle one
    double middle_off_limit; ///< greatest distance of a vertex of the middle level from its limit
    double last_off_limit;   ///< the same of the last level
} figure;

static double now(void)
{
    struct timespec time;
    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/// The squared distance of a point from the edge from a to b, which differ.
static double squared_edge_distance(const double *p, const double *a, const double *b)
{
    double ux = b[0] - a[0], uy = b[1] - a[1], vx = p[0] - a[0], vy = p[1] - a[1];
    double share = (ux * vx + uy * vy) / (ux * ux + uy * uy);
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    double x = vx - share * ux, y = vy - share * uy;
    return x * x + y * y;
}

/// The greatest distance of a fine curve's vertices from the edges of the coarse curve that it refines. Only the edges at the
/// vertex's own place along the curve are looked at.
static double chord_distance(const bat_curve *coarse, const bat_curve *fine)
{
    const long reach = 2;
    long count = (long)coarse->count;
    double greatest = 0;
    for (size_t i = 0; i < fine->count; i++)
    {
        double nearest = INFINITY;
        long at = (long)(i * coarse->count / fine->count);
        for (long edge = at - reach; edge <= at + reach; edge++)
        {
            if (!coarse->closed && (edge < 0 || edge >= count - 1))
                continue;
            long begin = (edge + count) % count;
            double distance = squared_edge_distance(fine->points + 2 * i, coarse->points + 2 * begin,
                                                    coarse->points + 2 * ((begin + 1) % count));
            nearest = distance < nearest ? distance : nearest;
        }
        greatest = nearest > greatest ? nearest : greatest;
    }
    return sqrt(greatest);
}

/// The greatest distance of a refined curve's vertices from the limits that the stencil takes them to; without those of an
/// open curve whose stencils reach its end points.
static double limit_distance(const bat_curve *curve, const bat_stencil *stencil)
{
    long count = (long)curve->count, first = stencil->first, last = first + (long)stencil->count - 1;
    long begin = curve->closed ? 0 : 1 - (first < 0 ? first : 0);
    long end = curve->closed ? count : count - 1 - (last > 0 ? last : 0);
    double greatest = 0;
    for (long i = begin; i < end; i++)
    {
        double x = 0, y = 0;
        for (long k = 0; k < (long)stencil->count; k++)
        {
            long j = i + first + k;
            j = j < 0 ? j + count : j >= count ? j - count : j;
            x += stencil->weights[k] * (curve->points[2 * j] - curve->points[2 * i]);
            y += stencil->weights[k] * (curve->points[2 * j + 1] - curve->points[2 * i + 1]);
        }
        greatest = fmax(greatest, x * x + y * y);
    }
    return sqrt(greatest);
}

static bat_status refine_outlines(figure *f, const bat_space *plane, size_t panel, const bat_scheme *scheme,
                                  bat_error *error)
{
    bat_refine_options how = bat_refine_defaults();
    how.scheme = *scheme;
    how.levels = LEVELS[panel];
    how.progress = report_progress(f->name);
    bat_status status = BAT_OK;
    for (size_t o = 0; o < f->shape->outline_count && status == BAT_OK; o++)
    {
        bat_curve coarse;
        status = bat_shape_curve(f->shape, o, plane, &coarse, error);
        if (status != BAT_OK)
            break;
        status = bat_curve_refine(&coarse, &how, &f->curves[panel][o], error);
        bat_curve_free(&coarse);
    }
    return status;
}

static void figure_measure(figure *f, const bat_stencil *stencil)
{
    for (size_t o = 0; o < f->shape->outline_count; o++)
    {
        const bat_curve *middle = &f->curves[MIDDLE][o], *last = &f->curves[LAST][o];
        f->vertices += f->curves[0][o].count;
        f->points += last->count;
        f->chord = fmax(f->chord, chord_distance(middle, last));
        f->middle_off_limit = fmax(f->middle_off_limit, limit_distance(middle, stencil));
        f->last_off_limit = fmax(f->last_off_limit, limit_distance(last, stencil));
    }
}

static bat_status figure_make(const bat_shape *shape, const bat_shape_figure *study, const bat_space *plane, figure *f,
                              bat_error *error)
{
    *f = (figure){.shape = shape, .study = study};
    (void)snprintf(f->name, sizeof f->name, "curve-figures-%.*s-%s", (int)strcspn(study->scheme, ":"), study->scheme,
                   shape->name);
    bat_scheme scheme;
    bat_stencil stencil;
    bat_status status = bat_scheme_by_name(study->scheme, &scheme, error);
    if (status == BAT_OK)
        status = bat_mask_limit_stencil(&scheme.mask, &stencil, error);
    for (size_t panel = 0; panel < PANELS && status == BAT_OK; panel++)
    {
        double begin = now();
        status = refine_outlines(f, plane, panel, &scheme, error);
        f->seconds = now() - begin;
    }
    if (status == BAT_OK)
        figure_measure(f, &stencil);
    return status;
}

static void figure_free(figure *f)
{
    for (size_t panel = 0; panel < PANELS; panel++)
        for (size_t o = 0; o < MOST_OUTLINES; o++)
            bat_curve_free(&f->curves[panel][o]);
}

/// Write the five panels, as SVG and as PNG.
static int figure_draw(const figure *f, const char *folder)
{
    bat_picture_layer layers[PANELS][MOST_OUTLINES];
    bat_picture_panel panels[PANELS];
    char titles[PANELS][NAME_SIZE], heading[2 * NAME_SIZE], path[PATH_SIZE];
    for (size_t panel = 0; panel < PANELS; panel++)
    {
        for (size_t o = 0; o < f->shape->outline_count; o++)
            layers[panel][o] = (bat_picture_layer){.curve = &f->curves[panel][o], .colour = 1};
        (void)snprintf(titles[panel], sizeof titles[panel], "level %zu", LEVELS[panel]);
        panels[panel] = (bat_picture_panel){layers[panel], f->shape->outline_count, titles[panel]};
    }
    (void)snprintf(heading, sizeof heading, "%s, %s", f->shape->name, f->study->scheme);
    bat_picture_options how = bat_picture_defaults();
    how.title = heading;
    static const char *const ENDINGS[] = {"svg", "png"};
    for (size_t i = 0; i < sizeof ENDINGS / sizeof ENDINGS[0]; i++)
    {
        bat_error error;
        if ((size_t)snprintf(path, sizeof path, "%s/%s.%s", folder, f->name, ENDINGS[i]) >= sizeof path)
            return report_failure(NULL, &(bat_error){.text = "the folder's name is too long"});
        if (bat_picture_write(path, panels, PANELS, &how, &error) != BAT_OK)
            return report_failure(path, &error);
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
static int reproduce_figure(const bat_shape *shape, const bat_shape_figure *study, const char *folder, json_t *array)
{
    bat_space plane = bat_euclidean(2);
    bat_error error;
    figure f;
    bat_status status = figure_make(shape, study, &plane, &f, &error);
    report_progress_end();
    int code = status == BAT_OK ? figure_draw(&f, folder) : report_failure(shape->name, &error);
    if (code == EXIT_DONE && array != NULL)
        (void)json_array_append_new(array, figure_json(&f));
    else if (code == EXIT_DONE)
        print_figure(&f);
    figure_free(&f);
    return code;
}

int reproduce_curve_figures(const char *folder, bool as_json)
{
    json_t *array = as_json ? json_array() : NULL;
    int code = EXIT_DONE;
    if (!as_json)
        print_head();
    for (size_t s = 0; s < bat_shape_count() && code == EXIT_DONE; s++)
    {
        const bat_shape *shape = bat_shape_at(s);
        for (size_t k = 0; k < shape->figure_count && code == EXIT_DONE; k++)
            code = report_interrupted() ? report_failure(NULL, &(bat_error){.text = "stopped"})
                                        : reproduce_figure(shape, &shape->figures[k], folder, array);
    }
    if (code == EXIT_DONE && as_json)
        return report_json(json_pack("{s:o}", "figures", array));
    json_decref(array);
    if (code == EXIT_DONE)
        print_foot(folder);
    return code;
}
