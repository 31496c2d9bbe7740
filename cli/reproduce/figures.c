#include "reproduce.h"

#include "report.h"

#include "batten/research/curve_shapes.h"
#include "batten/research/motion_study.h"
#include "batten/space.h"

#include <stdio.h>

// Pictures of curve schemes and of Hermite schemes.

enum
{
    NAME_SIZE = 128
};

/// Draws a figure.
typedef bat_status (*figure_draw)(const char *path, const void *figure, bat_error *error);

/// Draw a figure as SVG and as PNG.
static int draw_figure(const reproduce_job *job, const char *name, figure_draw draw, const void *figure)
{
    static const char *const ENDINGS[] = {"svg", "png"};
    int code = EXIT_DONE;
    for (size_t i = 0; i < sizeof ENDINGS / sizeof *ENDINGS && code == EXIT_DONE; i++)
    {
        bat_error error;
        reproduce_picture picture;
        char file[NAME_SIZE + 8];
        (void)snprintf(file, sizeof file, "%s.%s", name, ENDINGS[i]);
        code = reproduce_picture_add(job, file, &picture);
        if (code == EXIT_DONE)
            code = report_status(NULL, picture.path, draw(picture.write_to, figure, &error), &error);
    }
    return code;
}

// Curves

static bat_status draw_curves(const char *path, const void *figure, bat_error *error)
{
    return bat_curve_figure_draw(path, figure, error);
}

/// Make, draw and report one figure, and let go of its points.
static int curve_figure(const bat_curve_shape *shape, const bat_shape_figure *study, const reproduce_job *job,
                        report_table *table)
{
    bat_space plane = bat_euclidean(2);
    bat_error error;
    bat_curve_figure f;
    bat_status status = bat_curve_figure_make(shape, study, &plane, report_progress(shape->name), &f, &error);
    int code = report_status(NULL, shape->name, status, &error);
    if (code == EXIT_DONE)
        code = draw_figure(job, f.name, draw_curves, &f);
    if (code == EXIT_DONE)
        report_row(table,
                   "{figure:-6} {shape:-7} {scheme:-26} {vertices:8} {points:10} {seconds:8.2f} {level_10_to_20:12.2e} "
                   "{level_10_to_limit:12.2e} {level_20_to_limit:12.2e}\n",
                   "figure:s shape:s scheme:s picture:s vertices:z points:z seconds:n level_10_to_20:n level_10_to_limit:n "
                   "level_20_to_limit:n",
                   f.study->number, f.shape->name, f.study->scheme, f.name, f.vertices, f.points, f.seconds, f.chord,
                   f.middle_off_limit, f.last_off_limit);
    bat_curve_figure_free(&f);
    return code;
}

int reproduce_curve_figures(const reproduce_job *job)
{
    report_table table = report_begin(job->call.json);
    int code = EXIT_DONE;
    report_head(&table, "The figures of Alam (2025) with our own polygons, refined by 20 levels.\n\n"
                        "figure shape   scheme                     vertices     points  seconds     10 to 20  10 to limit  "
                        "20 to limit\n");
    for (size_t s = 0; s < bat_curve_shape_count() && code == EXIT_DONE; s++)
    {
        const bat_curve_shape *shape = bat_curve_shape_at(s);
        for (size_t k = 0; k < shape->figure_count && code == EXIT_DONE; k++)
            code = curve_figure(shape, &shape->figures[k], job, &table);
    }
    if (code != EXIT_DONE)
        return report_drop(&table, code);
    return report_print(
        job->call.json,
        "\n10 to 20: how far points of level 20 lie from the polygon of level 10. To limit: how far vertices of a level "
        "lie from\ntheir own limits. Shapes are 2 to 3 units across. The study does not print the ratios of its corner "
        "cutting.\nPictures: {folder}/curve-figures-SCHEME-SHAPE.svg and .png\n",
        "-folder:s figures:o", job->folder, table.rows);
}

// Hermite schemes

static bat_status draw_hermite(const char *path, const void *figure, bat_error *error)
{
    return bat_hermite_figure_draw(path, figure, error);
}

static void report_panel(report_table *table, const bat_hermite_panel *panel, size_t number)
{
    char words[NAME_SIZE];
    (void)snprintf(words, sizeof words, panel->order > 0 ? "%s, order %zu" : "%s", panel->scheme, panel->order);
    report_row(table, "{figure:-6} {data:-20} {points:6}  {words:-24} {error:10.3g}\n",
               "figure:z data:s points:z scheme:s error:n -words:s order:z?", number, panel->data, panel->samples,
               panel->scheme, panel->error, words, panel->order);
}

/// Make, draw and report figure `index`.
static int hermite_figure(size_t index, const reproduce_job *job, report_table *table)
{
    bat_hermite_figure figure;
    bat_error error;
    char name[NAME_SIZE];
    if (bat_hermite_figure_make(index, &figure, &error) != BAT_OK)
        return report_failure(NULL, &error);
    (void)snprintf(name, sizeof name, "hermite-%s", figure.name);
    int code = draw_figure(job, name, draw_hermite, &figure);
    for (size_t p = 0; p < figure.panel_count && code == EXIT_DONE; p++)
        report_panel(table, &figure.panels[p], index + 1);
    bat_hermite_figure_free(&figure);
    return code;
}

int reproduce_hermite_figures(const reproduce_job *job)
{
    report_table table = report_begin(job->call.json);
    int code = EXIT_DONE;
    report_head(&table,
                "Figures 1 to 4 of Ben-Zion Vardi, Dyn and Sharon: the largest distance of the scheme's points from the "
                "smooth curve.\n\nfigure data                 points  scheme                        error\n");
    for (size_t i = 0; i < BAT_HERMITE_FIGURE_COUNT && code == EXIT_DONE; i++)
        code = hermite_figure(i, job, &table);
    if (code != EXIT_DONE)
        return report_drop(&table, code);
    return report_print(
        job->call.json,
        "\nThe curves of figures 3 and 4 are those behind the published program's outputs, those of figures 1 and 2 "
        "ours: the text names none.\nTransport: Merrien's scheme by parallel transport, given derivatives by the "
        "index; of directions: given unit vectors in\ntheir place, as in the published comparison. Pictures: "
        "{folder}/hermite-NAME.svg and .png\n",
        "-folder:s rows:o", job->folder, table.rows);
}
