#include "reproduce.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// Curve schemes (Alam), Hermite schemes (Ben-Zion Vardi, Dyn and Sharon), and motions.

enum
{
    NAME_SIZE = 128
};

/// Draw a figure, of curves or of Hermite schemes, as SVG and as PNG.
static int draw_figure(const reproduce_job *job, const char *name, const bat_curve_figure *curves,
                       const bat_hermite_figure *hermite)
{
    static const char *const ENDINGS[] = {"svg", "png"};
    int code = EXIT_DONE;
    for (size_t i = 0; i < sizeof ENDINGS / sizeof *ENDINGS && code == EXIT_DONE; i++)
    {
        output_file picture;
        char file[NAME_SIZE + 8];
        (void)snprintf(file, sizeof file, "%s.%s", name, ENDINGS[i]);
        code = output_add(&job->call, job->folder, file, &picture);
        if (code == EXIT_DONE)
            code = report_status(NULL, picture.path,
                                 curves != NULL ? bat_curve_figure_draw(picture.write_to, curves, report_error())
                                                : bat_hermite_figure_draw(picture.write_to, hermite, report_error()));
    }
    return code;
}

// Curves

/// Make, draw and report one figure, and let go of its points.
static int curve_figure(const bat_curve_shape *shape, const bat_shape_figure *study, const reproduce_job *job,
                        report_table *table)
{
    bat_space plane = bat_euclidean(2);
    bat_curve_figure f;
    int code = report_status(NULL, shape->name,
                             bat_curve_figure_make(shape, study, &plane, report_progress(shape->name), &f, report_error()));
    if (code == EXIT_DONE)
        code = draw_figure(job, f.name, &f, NULL);
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

/// Make, draw and report figure `index`.
static int hermite_figure(size_t index, const reproduce_job *job, report_table *table)
{
    bat_hermite_figure figure;
    char name[NAME_SIZE];
    if (bat_hermite_figure_make(index, &figure, report_error()) != BAT_OK)
        return report_failure(NULL, report_error());
    (void)snprintf(name, sizeof name, "hermite-%s", figure.name);
    int code = draw_figure(job, name, NULL, &figure);
    for (size_t p = 0; p < figure.panel_count && code == EXIT_DONE; p++)
    {
        const bat_hermite_panel *panel = &figure.panels[p];
        char words[NAME_SIZE];
        (void)snprintf(words, sizeof words, panel->order > 0 ? "%s, order %zu" : "%s", panel->scheme, panel->order);
        report_row(table, "{figure:-6} {data:-20} {points:6}  {words:-24} {error:10.3g}\n",
                   "figure:z data:s points:z scheme:s error:n -words:s order:z?", index + 1, panel->data, panel->samples,
                   panel->scheme, panel->error, words, panel->order);
    }
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

/// A table of one quantity.
typedef struct order_table
{
    bat_hermite_quantity quantity;
    bool halvings; ///< with values for halved spacings, and the last order
    const char *title;
} order_table;

static const order_table ORDER_TABLES[] = {
    {BAT_HERMITE_QUANTITY_ERROR, true,
     "Largest distance from a smooth closed curve sampled at 16, 32, 64 and 128 points, refined three times; the "
     "last observed order"},
    {BAT_HERMITE_QUANTITY_POINT_PROXIMITY, true,
     "Points of De Casteljau and Bezier averages (lemma 3.7 and eq. 4.7: order 2), pairs 0.01 apart and less"},
    {BAT_HERMITE_QUANTITY_ANGLE_PROXIMITY, true, "Their angles (eq. 4.8: order 1)"},
    {BAT_HERMITE_QUANTITY_GEODESIC_ERROR, false,
     "Geodesics of length 1 reproduced by order 1, refined five times: largest error"},
    {BAT_HERMITE_QUANTITY_CONTRACTION, false, "Contraction of the longest edge by a level (eq. 4.2), orders 1 to 5"},
    {BAT_HERMITE_QUANTITY_DISPLACEMENT, false,
     "Displacement over the longest edge (eq. 4.3; theorem 4.8 bounds it by (m + 1) / 4), orders 1 to 5"},
    {BAT_HERMITE_QUANTITY_HALVING, true,
     "The assumption of theorem 4.8 (eq. 4.14), that the average halves L_H (eq. 4.10): largest difference of a "
     "half's share from 1/2, neighbours on the curve"},
    {BAT_HERMITE_QUANTITY_HALF_SHARE, false,
     "Largest share of L_H in a half (mu of eq. 4.12), pairs 1 apart with angles up to 45 degrees"},
    {BAT_HERMITE_QUANTITY_TRIANGLE, false,
     "The triangle inequality of L_H (eq. 4.11): largest L_H(Q0, Q1) / (L_H(Q0, Q) + L_H(Q, Q1)), at most 1 where "
     "it holds; Q is near the average"},
};

/// The number of rows in the group that begins at row `first`.
static size_t group_size(const bat_hermite_table *table, size_t first)
{
    size_t end = first + 1;
    while (end < table->count && isfinite(table->rows[end].order))
        end++;
    return end - first;
}

/// Print the groups of a quantity, each in one line.
static void print_halvings(const bat_hermite_table *table, bat_hermite_quantity quantity)
{
    (void)printf("space           scheme                                        h       h/2       h/4       h/8  order\n");
    for (size_t i = 0, size; i < table->count; i += size)
    {
        const bat_hermite_measure *rows = &table->rows[i];
        size = group_size(table, i);
        if (rows->quantity != quantity)
            continue;
        (void)printf("%-15s %-37s", rows->space, rows->scheme);
        for (size_t k = 0; k < size; k++)
            (void)printf(" %9.2e", rows[k].value);
        (void)printf(" %6.2f\n", rows[size - 1].order);
    }
}

static void print_single(const bat_hermite_table *table, bat_hermite_quantity quantity)
{
    const char *space = NULL;
    for (size_t i = 0; i < table->count; i++)
    {
        const bat_hermite_measure *row = &table->rows[i];
        if (row->quantity != quantity)
            continue;
        if (row->space != space)
            (void)printf("%s%-15s", space != NULL ? "\n" : "", row->space);
        (void)printf(" %10.3g", row->value);
        space = row->space;
    }
    (void)printf("\n");
}

int reproduce_hermite_order(const reproduce_job *job)
{
    bat_hermite_table table;
    report_table rows = report_begin(job->call.json);
    int code = report_status(NULL, NULL, bat_hermite_measure_orders(report_progress("measuring"), &table, report_error()));
    if (code != EXIT_DONE)
        return report_drop(&rows, code);
    for (size_t i = 0; i < table.count && rows.as_json; i++)
    {
        const bat_hermite_measure *row = &table.rows[i];
        report_row(&rows, "", "space:s scheme:s what:s value:n h:n? order:n?", row->space, row->scheme,
                   bat_hermite_quantity_name(row->quantity), row->value, row->h, row->order);
    }
    report_head(&rows, "Hermite schemes on manifolds, measured (Ben-Zion Vardi, Dyn and Sharon).\n");
    for (size_t i = 0; i < sizeof ORDER_TABLES / sizeof *ORDER_TABLES && !rows.as_json; i++)
    {
        (void)printf("\n%s\n\n", ORDER_TABLES[i].title);
        (ORDER_TABLES[i].halvings ? print_halvings : print_single)(&table, ORDER_TABLES[i].quantity);
    }
    bat_hermite_table_free(&table);
    return report_print(job->call.json, "", "rows:o", rows.rows);
}

// Keyframes

static json_t *pair_json(const double pair[2])
{
    return json_pack("[o, o]", report_number(pair[0]), report_number(pair[1]));
}

static void report_motion(report_table *table, const bat_keyframes_row *row)
{
    const double *pairs[] = {row->errors, row->limited, row->peers[0], row->peers[1], row->peers[2]};
    char name[32];
    if (table->as_json)
    {
        report_row(table, "", "motion:s noise:b step:z spline:o limited:o scipy_spline:o squad_akima:o slerp_linear:o",
                   row->motion, (int)row->noisy, row->step, pair_json(pairs[0]), pair_json(pairs[1]), pair_json(pairs[2]),
                   pair_json(pairs[3]), pair_json(pairs[4]));
        return;
    }
    (void)snprintf(name, sizeof name, "%s%s", row->motion, row->noisy ? ", noise" : "");
    (void)printf("%-16s %3zu", name, row->step);
    for (size_t p = 0; p < sizeof pairs / sizeof *pairs; p++)
        (void)printf(" %10.3e %10.3e", pairs[p][0], pairs[p][1]);
    for (size_t k = 0; k < 2; k++)
        (void)printf(" %6.3f", row->errors[k] / fmin(fmin(row->peers[0][k], row->peers[1][k]), row->peers[2][k]));
    (void)printf("\n");
}

int reproduce_motion_keyframes(const reproduce_job *job)
{
    bat_keyframes_row *rows;
    size_t count;
    int code = report_status(NULL, NULL,
                             bat_keyframes_measure(job->data, report_progress("measuring"), &rows, &count, report_error()));
    if (code != EXIT_DONE)
        return code;
    report_table table = report_begin(job->call.json);
    report_head(&table,
                "Every k-th pose kept; root mean square errors of the poses between: translation, and angle in "
                "degrees.\nratio: of the default spline to the best of scipy's CubicSpline with RotationSpline, Akima with "
                "squad, and\nlines with Slerp (stored figures).\n\nmotion             k                spline               "
                "limited CubicSpline, RotationS.          Akima, squad          lines, Slerp         ratio\n");
    for (size_t i = 0; i < count; i++)
        report_motion(&table, &rows[i]);
    free(rows);
    return report_print(job->call.json, "", "rows:o", table.rows);
}
