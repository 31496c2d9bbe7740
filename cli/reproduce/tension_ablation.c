#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <math.h>
#include <stdio.h>

static const char *const SPACES[BAT_TENSION_SPACE_COUNT] = {"plane", "sphere", "disk"};

/// One of the two tables.
typedef struct ablation
{
    const char *title, *remark;
    bat_status (*make)(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows, bat_error *error);
    size_t rows;
} ablation;

static json_t *cell_json(const bat_tension_ablation_row *row, size_t space)
{
    const bat_tension_ablation_score *ours = &row->scores[space], *published = &row->published[space];
    json_t *object = json_pack(
        "{s:s, s:s, s:I, s:I, s:I, s:o, s:o, s:o, s:o}", "space", SPACES[space], "variant", row->variant, "weights",
        (json_int_t)row->weights, "epochs", (json_int_t)row->report.run.epochs, "best_epoch",
        (json_int_t)row->report.run.best_epoch, "mean_nn", report_number(ours->mean_nn), "g1", report_number(ours->g1),
        "bending", report_number(row->report.scores[0][space].bending), "bending_share", report_number(ours->bending));
    reproduce_set_number(object, "published_mean_nn", published->mean_nn);
    reproduce_set_number(object, "published_g1", published->g1);
    reproduce_set_number(object, "published_bending_share", published->bending);
    return object;
}

static int print_json(const reproduce_job *job, const bat_tension_ablation_row *rows, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
            (void)json_array_append_new(array, cell_json(&rows[i], space));
    return report_json(json_pack("{s:I, s:s, s:o}", "seed", (json_int_t)job->seed, "folder", job->folder, "rows", array));
}

static int print_text(const reproduce_job *job, const ablation *table, const bat_tension_ablation_row *rows)
{
    (void)printf("%s of Ugail and Howard (2026): 100 epochs each, seed %llu, stored in %s. Validation curves, five learned\n"
                 "levels, best weights. In brackets: ours divided by the published figure.\n\n%-7s %-15s %8s %5s %18s %17s "
                 "%17s\n",
                 table->title, (unsigned long long)job->seed, job->folder, "space", "variant", "weights", "epoch",
                 "mean-NN         ", "G1             ", "bending share  ");
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        for (size_t i = 0; i < table->rows; i++)
        {
            const bat_tension_ablation_score *ours = &rows[i].scores[space], *published = &rows[i].published[space];
            (void)printf("%-7s %-15s %8zu %5llu", SPACES[space], rows[i].variant, rows[i].weights,
                         (unsigned long long)rows[i].report.run.best_epoch);
            reproduce_print_figure(ours->mean_nn, published->mean_nn, 10);
            reproduce_print_figure(ours->g1, published->g1, 9);
            reproduce_print_figure(ours->bending, published->bending, 9);
            (void)printf("\n");
        }
    (void)printf("\n%s\n", table->remark);
    return EXIT_DONE;
}

static int reproduce(const reproduce_job *job, const ablation *table)
{
    bat_tension_ablation_row rows[BAT_TENSION_TABLE4_ROWS];
    bat_tension_ablation_options options = bat_tension_ablation_defaults();
    bat_error error;
    options.seed = job->seed;
    options.folder = job->folder;
    options.progress = report_progress("training");
    bat_status status = table->make(&options, rows, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    return job->call.json ? print_json(job, rows, table->rows) : print_text(job, table, rows);
}

static const char BENDING[] = "The bending share is the mean bending over that of the four-point scheme as printed.";

int reproduce_tension_table3(const reproduce_job *job)
{
    const ablation table = {"Table 3", BENDING, bat_tension_table3, BAT_TENSION_TABLE3_ROWS};
    return reproduce(job, &table);
}

int reproduce_tension_table4(const reproduce_job *job)
{
    const ablation table = {"Table 4", BENDING, bat_tension_table4, BAT_TENSION_TABLE4_ROWS};
    return reproduce(job, &table);
}
