#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>

static void print_row(const bat_tension_noise_row *row)
{
    (void)printf("%-27s", row->method);
    for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
        reproduce_print_figure(row->g1[s].mean, row->published_g1[s], 8);
    (void)printf("\n%27s", "deviation");
    for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
        reproduce_print_figure(row->g1[s].deviation, row->published_deviation[s], 8);
    (void)printf("\n");
}

static json_t *cell_json(const bat_tension_noise_options *options, const bat_tension_noise_row *row, size_t s)
{
    json_t *object = json_pack("{s:s, s:s, s:o, s:I, s:o, s:o, s:o}", "space", "plane", "method", row->method, "noise",
                               report_number(options->noise[s]), "curves", (json_int_t)row->g1[s].count, "g1",
                               report_number(row->g1[s].mean), "g1_deviation", report_number(row->g1[s].deviation),
                               "g1_median", report_number(row->g1[s].median));
    reproduce_set_number(object, "tension", row->tension);
    reproduce_set_number(object, "published_g1", row->published_g1[s]);
    reproduce_set_number(object, "published_g1_deviation", row->published_deviation[s]);
    return object;
}

static int print_json(const bat_tension_noise_options *options, const bat_tension_noise_row *rows, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
            (void)json_array_append_new(array, cell_json(options, &rows[i], s));
    return report_json(json_pack("{s:I, s:I, s:o}", "levels", (json_int_t)options->levels, "seed", (json_int_t)options->seed,
                                 "rows", array));
}

static int print_text(const bat_tension_noise_options *options, const bat_tension_noise_row *rows, size_t count)
{
    (void)printf("Table 2 of Ugail and Howard (2026): largest exterior angle (G1), mean and deviation over the plane's %zu\n"
                 "validation curves, whose control points have normal noise of so many polygon radii; %zu levels.\nIn "
                 "brackets: ours divided by the published figure.\n\n%-27s",
                 rows[0].g1[0].count, options->levels, "method");
    for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
        (void)printf(" %8.2f %7s", options->noise[s], "");
    (void)printf("\n");
    for (size_t i = 0; i < count; i++)
        print_row(&rows[i]);
    (void)printf(
        "\n\"printed\" inserts on the side that eq. (9) says, \"outward\" on the other, which is right. The caption has "
        "four "
        "levels, but\nwithout noise it repeats table 1, which has five. No exterior angle is above pi: means of 3.18 and "
        "3.34 cannot be.\n");
    return EXIT_DONE;
}

int reproduce_tension_table2(const reproduce_job *job)
{
    bat_tension_noise_row rows[BAT_TENSION_NOISE_METHODS + 1];
    bat_curve_model *model;
    bat_error error;
    if (reproduce_model(job, &model) != EXIT_DONE)
        return EXIT_BAD_INPUT;
    bat_tension_noise_options options = bat_tension_noise_defaults();
    options.seed = job->seed;
    options.progress = report_progress("refining disturbed curves");
    size_t count = BAT_TENSION_NOISE_METHODS;
    bat_status status = bat_tension_table2(&options, rows, &error);
    if (status == BAT_OK)
    {
        bat_curve_scheme scheme = bat_curve_scheme_of_model(model);
        const char *name = bat_curve_model_has_fairness(model) ? "learned 0.50" : BAT_TENSION_LEARNED_PUBLISHED;
        status = bat_tension_table2_method(name, &scheme, &options, &rows[count++], &error);
    }
    report_progress_end();
    bat_curve_model_free(model);
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    return job->call.json ? print_json(&options, rows, count) : print_text(&options, rows, count);
}
