#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <math.h>
#include <stdio.h>

/// The fairness settings of the library's learned scheme in the table.
static const double FAIRNESS[] = {0, 0.25, 0.5, 0.75, 1};

enum
{
    FAIRNESS_COUNT = sizeof FAIRNESS / sizeof *FAIRNESS,
    OWN = 1 + FAIRNESS_COUNT ///< number of methods besides the built-in ones
};

static void print_row(const bat_tension_row *row)
{
    char method[64];
    (void)snprintf(method, sizeof method, isfinite(row->fairness) ? "%s %.2f" : "%s", row->method, row->fairness);
    (void)printf("%-7s %-27s", row->space, method);
    if (isfinite(row->tension))
        (void)printf(" %+6.3f", row->tension);
    else
        (void)printf(" %6s", "");
    reproduce_print_figure(row->mean_nn.mean, row->published_mean_nn, 9);
    (void)printf(" %9.4g", row->hausdorff.mean);
    reproduce_print_figure(row->bending.mean, row->published_bending, 9);
    if (row->mean_nn.count > 1)
        (void)printf(" %9.4g", row->bending.median);
    reproduce_print_figure(row->g1.mean, row->published_g1, 7);
    (void)printf("\n");
}

static json_t *row_json(const bat_tension_row *row)
{
    json_t *object = json_pack("{s:s, s:s, s:s, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "space", row->space, "method",
                               row->method, "arithmetic", "double", "curves", (json_int_t)row->mean_nn.count, "mean_nn",
                               report_number(row->mean_nn.mean), "mean_nn_deviation", report_number(row->mean_nn.deviation),
                               "hausdorff", report_number(row->hausdorff.mean), "bending", report_number(row->bending.mean),
                               "bending_median", report_number(row->bending.median), "g1", report_number(row->g1.mean),
                               "g1_median", report_number(row->g1.median));
    reproduce_set_number(object, "tension", row->tension);
    reproduce_set_number(object, "fairness", row->fairness);
    reproduce_set_number(object, "published_mean_nn", row->published_mean_nn);
    reproduce_set_number(object, "published_bending", row->published_bending);
    reproduce_set_number(object, "published_g1", row->published_g1);
    return object;
}

static int print_rows(const bat_tension_row *rows, size_t count, const char *title, const char *remark, bool as_json)
{
    if (as_json)
    {
        json_t *array = json_array();
        for (size_t i = 0; i < count; i++)
            (void)json_array_append_new(array, row_json(&rows[i]));
        return report_json(json_pack("{s:o}", "rows", array));
    }
    bool sets = rows[0].mean_nn.count > 1, published = isfinite(rows[0].published_mean_nn);
    (void)printf("%s\n%s\n", title, published ? "In brackets: ours divided by the published figure.\n" : "");
    (void)printf("%-7s %-27s %6s %17s %9s %17s%s %15s\n", "space", "method", "mu", "mean-NN          ", "Hausdorff",
                 "bending          ", sets ? "    median" : "", "G1             ");
    for (size_t i = 0; i < count; i++)
        print_row(&rows[i]);
    (void)printf("\n%s\n", remark);
    return EXIT_DONE;
}

/// The networks to compare: the published one and the library's own; the user may replace one of the same kind.
typedef struct networks
{
    bat_curve_model *published, *own; ///< `own` null: the built-in weights
} networks;

static void networks_free(networks *n)
{
    bat_curve_model_free(n->published);
    bat_curve_model_free(n->own);
}

static int read_networks(const reproduce_job *job, networks *n)
{
    bat_error error;
    bat_curve_model *given = NULL;
    *n = (networks){0};
    if (job->model != NULL && bat_curve_model_read_published(job->model, &given, &error) != BAT_OK)
        return report_failure(job->model, &error);
    if (given != NULL && bat_curve_model_has_fairness(given))
        n->own = given;
    else
        n->published = given;
    if (n->published == NULL && bat_curve_model_read_published(NULL, &n->published, &error) != BAT_OK)
    {
        networks_free(n);
        return report_failure(NULL, &error);
    }
    return EXIT_DONE;
}

static void own_methods(const networks *n, bat_tension_method methods[OWN])
{
    methods[0] = (bat_tension_method){BAT_TENSION_LEARNED_PUBLISHED, NAN, bat_curve_scheme_of_model(n->published)};
    for (size_t i = 0; i < FAIRNESS_COUNT; i++)
    {
        bat_curve_scheme scheme = n->own != NULL ? bat_curve_scheme_of_model(n->own) : bat_curve_scheme_learned(FAIRNESS[i]);
        scheme.fairness = FAIRNESS[i];
        methods[1 + i] = (bat_tension_method){"learned", FAIRNESS[i], scheme};
    }
}

/// The rows of table 1: for each space the built-in methods, then the others.
static bat_status table1_rows(bat_tension_set_kind curves, const bat_tension_method methods[OWN], bat_tension_row *rows,
                              bat_error *error)
{
    bat_tension_row built_in[BAT_TENSION_TABLE1_ROWS], own[BAT_TENSION_SPACE_COUNT * OWN];
    bat_progress progress = report_progress("refining the curves");
    bat_status status = bat_tension_table1(curves, built_in, 0, progress, error);
    if (status == BAT_OK)
        status = bat_tension_table1_methods(curves, methods, OWN, own, 0, progress, error);
    report_progress_end();
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT && status == BAT_OK; s++)
    {
        for (size_t m = 0; m < BAT_TENSION_METHODS; m++)
            *rows++ = built_in[s * BAT_TENSION_METHODS + m];
        for (size_t m = 0; m < OWN; m++)
            *rows++ = own[s * OWN + m];
    }
    return status;
}

static const char *const TABLE1_TITLES[] = {
    [BAT_TENSION_SET_KIND_PUBLISHED] = "Table 1 of Ugail and Howard (2026): the published validation curves, five levels.",
    [BAT_TENSION_SET_KIND_RESAMPLED] =
        "Table 1 of Ugail and Howard (2026) on resampled curves of the training families, five levels.",
    [BAT_TENSION_SET_KIND_UNSEEN] = "Table 1 of Ugail and Howard (2026) on curves of unseen families, five levels.",
};

static const char *table1_remark(bat_tension_set_kind curves)
{
    if (curves != BAT_TENSION_SET_KIND_PUBLISHED)
        return "\"printed\" inserts on the side that eq. (9) says, \"outward\" on the other, which is right. "
               "docs/algorithms/tension-network.md "
               "describes\nthe curves.";
    return "\"printed\" inserts on the side that eq. (9) says, \"outward\" on the other, which is right. The "
           "mean bending on the\nsphere and the disk is decided by a few curves with almost coincident control "
           "points, and in the published figures by\nthe clamps and the single precision that they were taken "
           "with: look at the median. The text does not determine the\nadaptive heuristic: no reading of it "
           "gives the published figures (docs/errata.md).";
}

int reproduce_tension_table1(const reproduce_job *job)
{
    bat_tension_method methods[OWN];
    bat_tension_row rows[BAT_TENSION_SPACE_COUNT * (BAT_TENSION_METHODS + OWN)];
    networks compared;
    bat_error error;
    if (read_networks(job, &compared) != EXIT_DONE)
        return EXIT_BAD_INPUT;
    own_methods(&compared, methods);
    bat_status status = table1_rows(job->curves, methods, rows, &error);
    networks_free(&compared);
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    const size_t count = sizeof rows / sizeof *rows;
    reproduce_picture picture;
    int code = job->folder != NULL ? reproduce_picture_add(job, "tension-frontier.png", &picture) : EXIT_DONE;
    if (code != EXIT_DONE)
        return code;
    if (job->folder != NULL && bat_tension_frontier_draw(picture.write_to, rows, count, &error) != BAT_OK)
        return report_failure(picture.path, &error);
    return print_rows(rows, count, TABLE1_TITLES[job->curves], table1_remark(job->curves), job->call.json);
}

int reproduce_tension_iss(const reproduce_job *job)
{
    bat_tension_method methods[OWN];
    bat_tension_row rows[BAT_TENSION_METHODS + OWN];
    networks compared;
    bat_error error;
    if (read_networks(job, &compared) != EXIT_DONE)
        return EXIT_BAD_INPUT;
    own_methods(&compared, methods);
    bat_progress progress = report_progress("refining the ground track");
    bat_status status = bat_tension_table5(rows, 0, progress, &error);
    if (status == BAT_OK)
        status = bat_tension_table5_methods(methods, OWN, rows + BAT_TENSION_METHODS, 0, progress, &error);
    report_progress_end();
    networks_free(&compared);
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    reproduce_picture picture;
    int code = job->folder != NULL ? reproduce_picture_add(job, "tension-iss.png", &picture) : EXIT_DONE;
    if (code != EXIT_DONE)
        return code;
    if (job->folder != NULL && bat_tension_iss_draw(picture.write_to, &error) != BAT_OK)
        return report_failure(picture.path, &error);
    return print_rows(rows, BAT_TENSION_METHODS + OWN,
                      "Table 5 of Ugail and Howard (2026): the ISS ground track, 16 control points, five levels.",
                      "What the paper's table calls Hausdorff is the mean nearest-neighbour distance; Hausdorff here is the "
                      "true one.\nThe published learned predictor: mean-NN 0.00699, bending 76.0, G1 0.721.",
                      job->call.json);
}
