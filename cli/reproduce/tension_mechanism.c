#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>

enum
{
    SPACES = BAT_TENSION_SPACE_COUNT,
    BINS = BAT_TENSION_EFFECTIVE_BINS
};

static const char *const NAMES[SPACES] = {"plane", "sphere", "disk"};

/// Remark 4.
static const double PUBLISHED_PRODUCT = 2.8;

// The figures

static json_t *effective_json(const bat_tension_effective *e)
{
    json_t *quantiles = json_array(), *histogram = json_array();
    for (size_t q = 0; q < sizeof e->quantiles / sizeof *e->quantiles; q++)
        (void)json_array_append_new(quantiles, report_number(e->quantiles[q]));
    for (size_t i = 0; i < BINS; i++)
        (void)json_array_append_new(histogram, json_integer((json_int_t)e->histogram[i]));
    return json_pack("{s:I, s:I, s:I, s:I, s:o, s:o, s:o, s:o}", "insertions", (json_int_t)e->insertions, "undefined",
                     (json_int_t)e->undefined, "below", (json_int_t)e->below, "above", (json_int_t)e->above, "mean",
                     report_number(e->summary.mean), "deviation", report_number(e->summary.deviation), "quantiles",
                     quantiles, "histogram", histogram);
}

static json_t *row_json(const char *space, const char *sign, const bat_tension_effective *e)
{
    json_t *row = effective_json(e);
    if (row != NULL)
    {
        (void)json_object_set_new(row, "space", json_string(space));
        (void)json_object_set_new(row, "sign", json_string(sign));
    }
    return row;
}

static int print_json(const bat_tension_mechanism_report *report, const bat_tension_mechanism_options *options)
{
    json_t *rows = json_array(), *layers = json_array(), *spaces = json_array();
    for (size_t s = 0; s < SPACES; s++)
    {
        const bat_tension_mechanism_space *space = &report->spaces[s];
        json_t *printed = row_json(NAMES[s], "printed", &space->printed);
        reproduce_set_number(printed, "published_mean", space->published_mean);
        reproduce_set_number(printed, "published_deviation", space->published_deviation);
        (void)json_array_append_new(rows, printed);
        (void)json_array_append_new(rows, row_json(NAMES[s], "outward", &space->outward));
        (void)json_array_append_new(spaces, json_pack("{s:s, s:o, s:o}", "space", NAMES[s], "largest_gradient",
                                                      report_number(space->largest_gradient), "centre",
                                                      report_number(space->centre)));
    }
    for (size_t i = 0; i < BAT_TENSION_LAYERS; i++)
        (void)json_array_append_new(layers, report_number(report->layers[i]));
    json_t *lipschitz = json_pack("{s:o, s:o, s:o, s:o}", "layers", layers, "product", report_number(report->product),
                                  "published_product", report_number(PUBLISHED_PRODUCT), "spaces", spaces);
    return report_json(json_pack("{s:I, s:I, s:o, s:o}", "curves", (json_int_t)options->curves, "levels",
                                 (json_int_t)options->levels, "rows", rows, "lipschitz", lipschitz));
}

static void print_effective(const char *space, const char *sign, const bat_tension_effective *e)
{
    double all = (double)e->summary.count;
    (void)printf("%-7s %-8s %10zu %9zu %6.1f %% %6.1f %%  %+6.2f %6.2f ", space, sign, e->insertions, e->undefined,
                 100 * (double)e->below / all, 100 * (double)e->above / all, e->summary.mean, e->summary.deviation);
    for (size_t q = 0; q < sizeof e->quantiles / sizeof *e->quantiles; q++)
        (void)printf(" %+7.2f", e->quantiles[q]);
    (void)printf("\n");
}

static void print_lipschitz(const bat_tension_mechanism_report *report)
{
    (void)printf("\nSpectral norms of the linear layers, by power iteration:");
    for (size_t i = 0; i < BAT_TENSION_LAYERS; i++)
        (void)printf(" %.3g", report->layers[i]);
    (void)printf("\nTheir product, the bound of remark 4: %.4g (published: %.1f, ratio %.3g)\n", report->product,
                 PUBLISHED_PRODUCT, report->product / PUBLISHED_PRODUCT);
    (void)printf("Longest gradient of the angle by the six features, on these insertions:");
    for (size_t s = 0; s < SPACES; s++)
        (void)printf(" %s %.3g%s", NAMES[s], report->spaces[s].largest_gradient, s + 1 < SPACES ? "," : "\n");
    (void)printf("Angle for features of 0, which theorem 2 wants to be 0:");
    for (size_t s = 0; s < SPACES; s++)
        (void)printf(" %s %+.3g%s", NAMES[s], report->spaces[s].centre, s + 1 < SPACES ? "," : "\n");
}

static int print_text(const bat_tension_mechanism_report *report, const bat_tension_mechanism_options *options,
                      const char *folder)
{
    (void)printf(
        "Section 9 of Ugail and Howard (2026): the effective tension (eq. 26) of every insertion on %zu validation curves a "
        "space,\n%zu levels. Mean and deviation after clipping to -3 ... 1.5, as published; quantiles without.\n\n",
        options->curves, options->levels);
    (void)printf("%-7s %-8s %10s %9s %8s %8s  %6s %6s  %7s %7s %7s %7s %7s\n", "space", "sign", "insertions", "undefined",
                 "below -3", "over 1.5", "mean", "dev.", "5 %", "25 %", "50 %", "75 %", "95 %");
    for (size_t s = 0; s < SPACES; s++)
    {
        const bat_tension_mechanism_space *space = &report->spaces[s];
        print_effective(NAMES[s], "printed", &space->printed);
        (void)printf("%26s %27s %+6.2f", "published", "", space->published_mean);
        if (space->published_deviation > 0)
            (void)printf(" %6.2f", space->published_deviation);
        (void)printf("\n");
        print_effective(NAMES[s], "outward", &space->outward);
    }
    print_lipschitz(report);
    if (folder != NULL)
        (void)printf("\n%s/tension-mechanism.png\n", folder);
    return EXIT_DONE;
}

int reproduce_tension_mechanism(const reproduce_job *job)
{
    bat_tension_mechanism_report report;
    bat_tension_mechanism_options options = bat_tension_mechanism_defaults();
    bat_error error;
    options.progress = report_progress("refining validation curves");
    bat_status status = bat_tension_mechanism(job->model, &options, &report, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(status == BAT_BAD_FILE || status == BAT_FILE_ACCESS ? job->model : NULL, &error);
    reproduce_picture picture;
    int code = job->folder != NULL ? reproduce_picture_add(job, "tension-mechanism.png", &picture) : EXIT_DONE;
    if (code != EXIT_DONE)
        return code;
    if (job->folder != NULL && bat_tension_mechanism_draw(picture.write_to, &report, &error) != BAT_OK)
        return report_failure(picture.path, &error);
    return job->call.json ? print_json(&report, &options) : print_text(&report, &options, job->folder);
}
