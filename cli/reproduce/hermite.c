#include "reproduce.h"

#include "report.h"

#include "batten/research/motion_study.h"

#include <math.h>
#include <stdio.h>

enum
{
    TITLE_SIZE = 128
};

// The figures

static void scheme_words(const bat_hermite_panel *panel, char *text, size_t size)
{
    if (panel->order > 0)
        (void)snprintf(text, size, "%s, order %zu", panel->scheme, panel->order);
    else
        (void)snprintf(text, size, "%s", panel->scheme);
}

/// Add the pictures of a figure, as SVG and as PNG.
static int draw_figure(const bat_hermite_figure *figure, const reproduce_job *job)
{
    static const char *const ENDINGS[] = {"svg", "png"};
    int code = EXIT_DONE;
    for (size_t i = 0; i < sizeof ENDINGS / sizeof *ENDINGS && code == EXIT_DONE; i++)
    {
        bat_error error;
        reproduce_picture picture;
        char name[TITLE_SIZE];
        (void)snprintf(name, sizeof name, "hermite-%s.%s", figure->name, ENDINGS[i]);
        code = reproduce_picture_add(job, name, &picture);
        if (code == EXIT_DONE && bat_hermite_figure_draw(picture.write_to, figure, &error) != BAT_OK)
            code = report_failure(picture.path, &error);
    }
    return code;
}

static json_t *panel_json(const bat_hermite_panel *panel, size_t number)
{
    json_t *row = json_pack("{s:I, s:s, s:I, s:s, s:o}", "figure", (json_int_t)number, "data", panel->data, "points",
                            (json_int_t)panel->samples, "scheme", panel->scheme, "error", report_number(panel->error));
    if (panel->order > 0 && row != NULL)
        (void)json_object_set_new(row, "order", json_integer((json_int_t)panel->order));
    return row;
}

static void print_panel(const bat_hermite_panel *panel, size_t number)
{
    char words[TITLE_SIZE / 2];
    scheme_words(panel, words, sizeof words);
    (void)printf("%-6zu %-20s %6zu  %-24s %10.3g\n", number, panel->data, panel->samples, words, panel->error);
}

/// Make, draw and report figure `index`; add its rows to the array where there is one.
static int reproduce_figure(size_t index, const reproduce_job *job, json_t *rows)
{
    bat_hermite_figure figure;
    bat_error error;
    if (bat_hermite_figure_make(index, &figure, &error) != BAT_OK)
        return report_failure(NULL, &error);
    int code = draw_figure(&figure, job);
    for (size_t p = 0; p < figure.panel_count && code == EXIT_DONE; p++)
    {
        if (rows == NULL)
            print_panel(&figure.panels[p], index + 1);
        else if (json_array_append_new(rows, panel_json(&figure.panels[p], index + 1)) != 0)
            code = report_failure(NULL, &(bat_error){.text = "out of memory"});
    }
    bat_hermite_figure_free(&figure);
    return code;
}

int reproduce_hermite_figures(const reproduce_job *job)
{
    json_t *rows = job->call.json ? json_array() : NULL;
    if (job->call.json && rows == NULL)
        return report_json(NULL);
    if (!job->call.json)
        (void)printf(
            "Figures 1 to 4 of Ben-Zion Vardi, Dyn and Sharon: the largest distance of the scheme's points from the "
            "smooth curve.\n\n%-6s %-20s %6s  %-24s %10s\n",
            "figure", "data", "points", "scheme", "error");
    int code = EXIT_DONE;
    for (size_t i = 0; i < BAT_HERMITE_FIGURE_COUNT && code == EXIT_DONE; i++)
        code = reproduce_figure(i, job, rows);
    if (code == EXIT_DONE && job->call.json)
        return report_json(json_pack("{s:o}", "rows", rows));
    json_decref(rows);
    if (code == EXIT_DONE)
        (void)printf(
            "\nThe curves of figures 3 and 4 are those behind the published program's outputs, those of figures 1 and 2 "
            "ours: the text names none.\nTransport: Merrien's scheme by parallel transport, given derivatives by the "
            "index; of directions: given unit vectors in\ntheir place, as in the published comparison. Pictures: "
            "%s/hermite-NAME.svg and .png\n",
            job->folder);
    return code;
}

// The orders

static json_t *measure_json(const bat_hermite_measure *row)
{
    json_t *object = json_pack("{s:s, s:s, s:s, s:o}", "space", row->space, "scheme", row->scheme, "what",
                               bat_hermite_quantity_name(row->quantity), "value", report_number(row->value));
    if (object != NULL)
    {
        reproduce_set_number(object, "h", row->h);
        reproduce_set_number(object, "order", row->order);
    }
    return object;
}

static int print_json(const bat_hermite_table *table)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < table->count; i++)
        (void)json_array_append_new(rows, measure_json(&table->rows[i]));
    return report_json(json_pack("{s:o}", "rows", rows));
}

/// The number of rows in the group that begins at row `first`.
static size_t group_size(const bat_hermite_table *table, size_t first)
{
    size_t end = first + 1;
    while (end < table->count && isfinite(table->rows[end].order))
        end++;
    return end - first;
}

/// Print a group in one line: values for halved spacings, and the last order.
static void print_group(const bat_hermite_measure *rows, size_t count)
{
    (void)printf("%-15s %-37s", rows->space, rows->scheme);
    for (size_t i = 0; i < count; i++)
        (void)printf(" %9.2e", rows[i].value);
    (void)printf(" %6.2f\n", rows[count - 1].order);
}

static void print_halvings(const bat_hermite_table *table, bat_hermite_quantity quantity, const char *title)
{
    (void)printf("\n%s\n\n%-15s %-37s %9s %9s %9s %9s %6s\n", title, "space", "scheme", "h", "h/2", "h/4", "h/8", "order");
    for (size_t i = 0; i < table->count; i += group_size(table, i))
        if (table->rows[i].quantity == quantity)
            print_group(&table->rows[i], group_size(table, i));
}

static void print_single(const bat_hermite_table *table, bat_hermite_quantity quantity, const char *title)
{
    const char *space = NULL;
    (void)printf("\n%s\n\n", title);
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

static int print_text(const bat_hermite_table *table)
{
    (void)printf("Hermite schemes on manifolds, measured (Ben-Zion Vardi, Dyn and Sharon).\n");
    print_halvings(
        table, BAT_HERMITE_QUANTITY_ERROR,
        "Largest distance from a smooth closed curve sampled at 16, 32, 64 and 128 points, refined three times; the "
        "last observed order");
    print_halvings(table, BAT_HERMITE_QUANTITY_POINT_PROXIMITY,
                   "Points of De Casteljau and Bezier averages (lemma 3.7 and eq. 4.7: order 2), pairs 0.01 apart and less");
    print_halvings(table, BAT_HERMITE_QUANTITY_ANGLE_PROXIMITY, "Their angles (eq. 4.8: order 1)");
    print_single(table, BAT_HERMITE_QUANTITY_GEODESIC_ERROR,
                 "Geodesics of length 1 reproduced by order 1, refined five times: largest error");
    print_single(table, BAT_HERMITE_QUANTITY_CONTRACTION,
                 "Contraction of the longest edge by a level (eq. 4.2), orders 1 to 5");
    print_single(table, BAT_HERMITE_QUANTITY_DISPLACEMENT,
                 "Displacement over the longest edge (eq. 4.3; theorem 4.8 bounds it by (m + 1) / 4), orders 1 to 5");
    print_halvings(
        table, BAT_HERMITE_QUANTITY_HALVING,
        "The assumption of theorem 4.8 (eq. 4.14), that the average halves L_H (eq. 4.10): largest difference of a "
        "half's share from 1/2, neighbours on the curve");
    print_single(table, BAT_HERMITE_QUANTITY_HALF_SHARE,
                 "Largest share of L_H in a half (mu of eq. 4.12), pairs 1 apart with angles up to 45 degrees");
    print_single(
        table, BAT_HERMITE_QUANTITY_TRIANGLE,
        "The triangle inequality of L_H (eq. 4.11): largest L_H(Q0, Q1) / (L_H(Q0, Q) + L_H(Q, Q1)), at most 1 where "
        "it holds; Q is near the average");
    return EXIT_DONE;
}

int reproduce_hermite_order(const reproduce_job *job)
{
    bat_hermite_table table;
    bat_error error;
    bat_status status = bat_hermite_measure_orders(report_progress("measuring"), &table, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    int code = job->call.json ? print_json(&table) : print_text(&table);
    bat_hermite_table_free(&table);
    return code;
}
