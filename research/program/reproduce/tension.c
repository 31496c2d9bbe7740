#include "reproduce.h"

#include <math.h>
#include <stdio.h>

// Ugail and Howard (2026).

static const char *const SPACES[BAT_TENSION_SPACE_COUNT] = {"plane", "sphere", "disk"};

// Tables 1 and 5

/// The fairness settings of the library's learned scheme in the table.
static const double FAIRNESS[] = {0, 0.25, 0.5, 0.75, 1};

enum
{
    FAIRNESS_COUNT = sizeof FAIRNESS / sizeof *FAIRNESS,
    OWN = 1 + FAIRNESS_COUNT ///< number of methods besides the built-in ones
};

static void report_method(report_table *table, const bat_tension_row *row)
{
    char method[64];
    (void)snprintf(method, sizeof method, isfinite(row->fairness) ? "%s %.2f" : "%s", row->method, row->fairness);
    report_row(table,
               "{space:-7} {name:-27} [tension?{tension:+6.3f}][!tension?      ] {mean_nn/published_mean_nn:9.5g} "
               "{hausdorff:9.4g} {bending/published_bending:9.5g}[several? {bending_median:9.4g}] {g1/published_g1:7.5g}\n",
               "space:s method:s -name:s arithmetic:s curves:z -several:b mean_nn:n mean_nn_deviation:n hausdorff:n "
               "bending:n bending_median:n g1:n g1_median:n tension:n? fairness:n? published_mean_nn:n? "
               "published_bending:n? published_g1:n?",
               row->space, row->method, method, "double", row->mean_nn.count, (int)(row->mean_nn.count > 1),
               row->mean_nn.mean, row->mean_nn.deviation, row->hausdorff.mean, row->bending.mean, row->bending.median,
               row->g1.mean, row->g1.median, row->tension, row->fairness, row->published_mean_nn, row->published_bending,
               row->published_g1);
}

static int print_rows(const bat_tension_row *rows, size_t count, const char *title, const char *remark, bool as_json)
{
    bool sets = rows[0].mean_nn.count > 1, published = isfinite(rows[0].published_mean_nn);
    report_table table = report_begin(as_json);
    report_head(&table, "%s\n%s\n", title, published ? "In brackets: ours divided by the published figure.\n" : "");
    report_head(
        &table,
        "space   method                          mu mean-NN           Hausdorff bending          %s G1             \n",
        sets ? "    median" : "");
    for (size_t i = 0; i < count; i++)
        report_method(&table, &rows[i]);
    report_head(&table, "\n%s\n", remark);
    return report_print(as_json, "", "rows:o", table.rows);
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
    bat_curve_model *given = NULL;
    *n = (networks){0};
    if (job->model != NULL && bat_curve_model_read_published(job->model, &given, report_error()) != BAT_OK)
        return report_failure(job->model, report_error());
    *(given != NULL && bat_curve_model_has_fairness(given) ? &n->own : &n->published) = given;
    return n->published != NULL
               ? EXIT_DONE
               : report_status(NULL, NULL, bat_curve_model_read_published(NULL, &n->published, report_error()));
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
                              bat_progress progress, bat_error *error)
{
    bat_tension_row built_in[BAT_TENSION_TABLE1_ROWS], own[BAT_TENSION_SPACE_COUNT * OWN];
    bat_status status = bat_tension_table1(curves, built_in, 0, progress, error);
    if (status == BAT_OK)
        status = bat_tension_table1_methods(curves, methods, OWN, own, 0, progress, error);
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
               "docs/algorithms/tension-network.md describes\nthe curves.";
    return "\"printed\" inserts on the side that eq. (9) says, \"outward\" on the other, which is right. The "
           "mean bending on the\nsphere and the disk is decided by a few curves with almost coincident control "
           "points, and in the published figures by\nthe clamps and the single precision that they were taken "
           "with: look at the median. The text does not determine the\nadaptive heuristic: no reading of it "
           "gives the published figures (docs/errata.md).";
}

/// Reproduce table 1, or table 5, that of the ground track.
static int reproduce_methods(const reproduce_job *job, bool track)
{
    bat_tension_method methods[OWN];
    bat_tension_row rows[BAT_TENSION_SPACE_COUNT * (BAT_TENSION_METHODS + OWN)];
    size_t count = track ? BAT_TENSION_METHODS + OWN : sizeof rows / sizeof *rows;
    networks compared;
    if (read_networks(job, &compared) != EXIT_DONE)
    {
        networks_free(&compared);
        return EXIT_BAD_INPUT;
    }
    own_methods(&compared, methods);
    bat_progress progress = report_progress(track ? "refining the ground track" : "refining the curves");
    bat_status status = track ? bat_tension_table5(rows, 0, progress, report_error())
                              : table1_rows(job->curves, methods, rows, progress, report_error());
    if (status == BAT_OK && track)
        status = bat_tension_table5_methods(methods, OWN, rows + BAT_TENSION_METHODS, 0, progress, report_error());
    networks_free(&compared);
    output_file picture;
    int code = report_status(NULL, NULL, status);
    if (code == EXIT_DONE && job->folder != NULL)
        code = output_add(&job->call, job->folder, track ? "tension-iss.png" : "tension-frontier.png", &picture);
    if (code == EXIT_DONE && job->folder != NULL)
    {
        status = track ? bat_tension_iss_draw(picture.write_to, report_error())
                       : bat_tension_frontier_draw(picture.write_to, rows, count, report_error());
        code = report_status(NULL, picture.path, status);
    }
    if (code != EXIT_DONE)
        return code;
    if (!track)
        return print_rows(rows, count, TABLE1_TITLES[job->curves], table1_remark(job->curves), job->call.json);
    return print_rows(rows, count,
                      "Table 5 of Ugail and Howard (2026): the ISS ground track, 16 control points, five levels.",
                      "What the paper's table calls Hausdorff is the mean nearest-neighbour distance; Hausdorff here is the "
                      "true one.\nThe published learned predictor: mean-NN 0.00699, bending 76.0, G1 0.721.",
                      job->call.json);
}

int reproduce_tension_table1(const reproduce_job *job)
{
    return reproduce_methods(job, false);
}

int reproduce_tension_iss(const reproduce_job *job)
{
    return reproduce_methods(job, true);
}

// Table 2

static void report_noise(report_table *table, const bat_tension_noise_options *options, const bat_tension_noise_row *row)
{
    report_head(table, "%-27s", row->method);
    for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
        report_row(table, " {g1/published_g1:8.5g}",
                   "space:s method:s noise:n curves:z g1:n g1_deviation:n g1_median:n tension:n? published_g1:n? "
                   "published_g1_deviation:n?",
                   "plane", row->method, options->noise[s], row->g1[s].count, row->g1[s].mean, row->g1[s].deviation,
                   row->g1[s].median, row->tension, row->published_g1[s], row->published_deviation[s]);
    report_head(table, "\n                  deviation");
    for (size_t s = 0; s < BAT_TENSION_NOISES && !table->as_json; s++)
        (void)report_part(false, " {ours/published:8.5g}", "ours:n published:n", row->g1[s].deviation,
                          row->published_deviation[s]);
    report_head(table, "\n");
}

static int print_noise(const bat_tension_noise_options *options, const bat_tension_noise_row *rows, size_t count,
                       bool as_json)
{
    report_table table = report_begin(as_json);
    report_head(&table,
                "Table 2 of Ugail and Howard (2026): largest exterior angle (G1), mean and deviation over the plane's "
                "%zu\nvalidation curves, whose control points have normal noise of so many polygon radii; %zu levels.\nIn "
                "brackets: ours divided by the published figure.\n\nmethod                     ",
                rows[0].g1[0].count, options->levels);
    for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
        report_head(&table, " %8.2f        ", options->noise[s]);
    report_head(&table, "\n");
    for (size_t i = 0; i < count; i++)
        report_noise(&table, options, &rows[i]);
    return report_print(
        as_json,
        "\n\"printed\" inserts on the side that eq. (9) says, \"outward\" on the other, which is right. The caption has "
        "four levels, but\nwithout noise it repeats table 1, which has five. No exterior angle is above pi: means of 3.18 "
        "and 3.34 cannot be.\n",
        "levels:z seed:z rows:o", options->levels, (size_t)options->seed, table.rows);
}

int reproduce_tension_table2(const reproduce_job *job)
{
    bat_tension_noise_row rows[BAT_TENSION_NOISE_METHODS + 1];
    bat_curve_model *model;
    if (bat_curve_model_read_published(job->model, &model, report_error()) != BAT_OK)
        return report_failure(job->model, report_error());
    bat_tension_noise_options options = bat_tension_noise_defaults();
    options.seed = job->seed;
    options.progress = report_progress("refining disturbed curves");
    size_t count = BAT_TENSION_NOISE_METHODS;
    bat_status status = bat_tension_table2(&options, rows, report_error());
    if (status == BAT_OK)
    {
        bat_curve_scheme scheme = bat_curve_scheme_of_model(model);
        const char *name = bat_curve_model_has_fairness(model) ? "learned 0.50" : BAT_TENSION_LEARNED_PUBLISHED;
        status = bat_tension_table2_method(name, &scheme, &options, &rows[count++], report_error());
    }
    bat_curve_model_free(model);
    int code = report_status(NULL, NULL, status);
    return code == EXIT_DONE ? print_noise(&options, rows, count, job->call.json) : code;
}

// Tables 3 and 4

/// Reproduce one of the two tables.
static int reproduce_ablation(const reproduce_job *job, const char *title, size_t count,
                              bat_status (*make)(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows,
                                                 bat_error *error))
{
    bat_tension_ablation_row rows[BAT_TENSION_TABLE4_ROWS];
    bat_tension_ablation_options options = bat_tension_ablation_defaults();
    options.seed = job->seed;
    options.folder = job->folder;
    options.progress = report_progress("training");
    int code = report_status(NULL, NULL, make(&options, rows, report_error()));
    if (code != EXIT_DONE)
        return code;
    report_table table = report_begin(job->call.json);
    report_head(&table,
                "%s of Ugail and Howard (2026): 100 epochs each, seed %llu, stored in %s. Validation curves, five "
                "learned\nlevels, best weights. In brackets: ours divided by the published figure.\n\nspace   variant       "
                "   weights epoch   mean-NN            G1                bending share  \n",
                title, (unsigned long long)job->seed, job->folder);
    // The text is ordered by spaces, JSON by variants.
    for (size_t k = 0; k < count * BAT_TENSION_SPACE_COUNT; k++)
    {
        const bat_tension_ablation_row *row = &rows[table.as_json ? k / BAT_TENSION_SPACE_COUNT : k % count];
        size_t space = table.as_json ? k % BAT_TENSION_SPACE_COUNT : k / count;
        const bat_tension_ablation_score *ours = &row->scores[space], *published = &row->published[space];
        report_row(&table,
                   "{space:-7} {variant:-15} {weights:8} {best_epoch:5} {mean_nn/published_mean_nn:10.5g} "
                   "{g1/published_g1:9.5g} {bending_share/published_bending_share:9.5g}\n",
                   "space:s variant:s weights:z epochs:z best_epoch:z mean_nn:n g1:n bending:n bending_share:n "
                   "published_mean_nn:n? published_g1:n? published_bending_share:n?",
                   SPACES[space], row->variant, row->weights, (size_t)row->report.run.epochs,
                   (size_t)row->report.run.best_epoch, ours->mean_nn, ours->g1, row->report.scores[0][space].bending,
                   ours->bending, published->mean_nn, published->g1, published->bending);
    }
    return report_print(job->call.json,
                        "\nThe bending share is the mean bending over that of the four-point scheme as printed.\n",
                        "seed:z folder:s rows:o", (size_t)job->seed, job->folder, table.rows);
}

int reproduce_tension_table3(const reproduce_job *job)
{
    return reproduce_ablation(job, "Table 3", BAT_TENSION_TABLE3_ROWS, bat_tension_table3);
}

int reproduce_tension_table4(const reproduce_job *job)
{
    return reproduce_ablation(job, "Table 4", BAT_TENSION_TABLE4_ROWS, bat_tension_table4);
}

// Section 9

static const int QUANTILES = sizeof((bat_tension_effective *)0)->quantiles / sizeof(double);

/// Remark 4.
static const double PUBLISHED_PRODUCT = 2.8;

static void report_effective(report_table *rows, const char *space, const char *sign, const bat_tension_effective *e,
                             double published_mean, double published_deviation)
{
    double all = (double)e->summary.count;
    json_t *histogram = json_array();
    for (size_t i = 0; i < BAT_TENSION_EFFECTIVE_BINS; i++)
        (void)json_array_append_new(histogram, json_integer((json_int_t)e->histogram[i]));
    report_row(rows,
               "{space:-7} {sign:-8} {insertions:10} {undefined:9} {100 below_share:6.1f} % {100 above_share:6.1f} %  "
               "{mean:+6.2f} {deviation:6.2f} ",
               "insertions:z undefined:z below:z above:z -below_share:n -above_share:n mean:n deviation:n quantiles:o "
               "histogram:o space:s sign:s published_mean:n? published_deviation:n?",
               e->insertions, e->undefined, e->below, e->above, (double)e->below / all, (double)e->above / all,
               e->summary.mean, e->summary.deviation, report_numbers(e->quantiles, QUANTILES), histogram, space, sign,
               published_mean, published_deviation);
    for (size_t q = 0; q < QUANTILES; q++)
        report_head(rows, " %+7.2f", e->quantiles[q]);
    report_head(rows, "\n");
    if (!isfinite(published_mean))
        return;
    report_head(rows, "                 published                             %+6.2f", published_mean);
    if (published_deviation > 0)
        report_head(rows, " %6.2f", published_deviation);
    report_head(rows, "\n");
}

static void print_lipschitz(const bat_tension_mechanism_report *report)
{
    (void)printf("\nSpectral norms of the linear layers, by power iteration:");
    for (size_t i = 0; i < BAT_TENSION_LAYERS; i++)
        (void)printf(" %.3g", report->layers[i]);
    (void)printf("\nTheir product, the bound of remark 4: %.4g (published: %.1f, ratio %.3g)\n", report->product,
                 PUBLISHED_PRODUCT, report->product / PUBLISHED_PRODUCT);
    (void)printf("Longest gradient of the angle by the six features, on these insertions:");
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        (void)printf("%s %s %.3g", s > 0 ? "," : "", SPACES[s], report->spaces[s].largest_gradient);
    (void)printf("\nAngle for features of 0, which theorem 2 wants to be 0:");
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        (void)printf("%s %s %+.3g", s > 0 ? "," : "", SPACES[s], report->spaces[s].centre);
    (void)printf("\n");
}

static int print_mechanism(const bat_tension_mechanism_report *report, const bat_tension_mechanism_options *options,
                           const reproduce_job *job)
{
    report_table rows = report_begin(job->call.json), spaces = report_begin(job->call.json);
    report_head(
        &rows,
        "Section 9 of Ugail and Howard (2026): the effective tension (eq. 26) of every insertion on %zu validation curves a "
        "space,\n%zu levels. Mean and deviation after clipping to -3 ... 1.5, as published; quantiles without.\n\n",
        options->curves, options->levels);
    report_head(&rows, "space   sign     insertions undefined below -3 over 1.5    mean   dev.      5 %%    25 %%    50 %%  "
                       "  75 %%    95 %%\n");
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        const bat_tension_mechanism_space *space = &report->spaces[s];
        report_effective(&rows, SPACES[s], "printed", &space->printed, space->published_mean, space->published_deviation);
        report_effective(&rows, SPACES[s], "outward", &space->outward, NAN, NAN);
        report_row(&spaces, "", "space:s largest_gradient:n centre:n", SPACES[s], space->largest_gradient, space->centre);
    }
    if (!job->call.json)
        print_lipschitz(report);
    return report_print(job->call.json, "[folder?\n{folder}/tension-mechanism.png\n]",
                        "-folder:s curves:z levels:z rows:o lipschitz.layers:o lipschitz.product:n "
                        "lipschitz.published_product:n lipschitz.spaces:o",
                        job->folder, options->curves, options->levels, rows.rows,
                        report_numbers(report->layers, BAT_TENSION_LAYERS), report->product, PUBLISHED_PRODUCT, spaces.rows);
}

int reproduce_tension_mechanism(const reproduce_job *job)
{
    bat_tension_mechanism_report report;
    bat_tension_mechanism_options options = bat_tension_mechanism_defaults();
    output_file picture;
    options.progress = report_progress("refining validation curves");
    bat_status status = bat_tension_mechanism(job->model, &options, &report, report_error());
    bool is_model = status == BAT_BAD_FILE || status == BAT_FILE_ACCESS;
    int code = report_status(NULL, is_model ? job->model : NULL, status);
    if (code == EXIT_DONE && job->folder != NULL)
        code = output_add(&job->call, job->folder, "tension-mechanism.png", &picture);
    if (code == EXIT_DONE && job->folder != NULL)
        code = report_status(NULL, picture.path, bat_tension_mechanism_draw(picture.write_to, &report, report_error()));
    return code == EXIT_DONE ? print_mechanism(&report, &options, job) : code;
}
