#include "reproduce.h"

#include "report.h"
#include "terminal.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <stdlib.h>

/// Counts of the outcomes.
typedef struct outcomes
{
    size_t right_accepted, right_refused, wrong_accepted, wrong_refused, failed;
} outcomes;

static const char *outcome_of(const bat_scan_verdict_row *row)
{
    if (row->failure[0] != '\0')
        return "none";
    if (row->is_right)
        return row->is_accepted ? "right" : "right, refused";
    return row->is_accepted ? "wrong, accepted" : "wrong, refused";
}

static outcomes count_outcomes(const bat_scan_verdict_row *rows, size_t count)
{
    outcomes sums = {0};
    for (size_t i = 0; i < count; i++)
    {
        const bat_scan_verdict_row *row = &rows[i];
        bool made = row->failure[0] == '\0';
        sums.failed += !made;
        sums.right_accepted += made && row->is_right && row->is_accepted;
        sums.right_refused += made && row->is_right && !row->is_accepted;
        sums.wrong_accepted += made && !row->is_right && row->is_accepted;
        sums.wrong_refused += made && !row->is_right && !row->is_accepted;
    }
    return sums;
}

static int print_json(const bat_scan_verdict_row *rows, size_t count)
{
    outcomes sums = count_outcomes(rows, count);
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
    {
        const bat_scan_verdict_row *row = &rows[i];
        (void)json_array_append_new(
            array, json_pack("{s:s, s:I, s:o, s:s, s:s, s:i, s:o, s:o, s:o}", "shape", row->shape, "points",
                             (json_int_t)row->points, "noise", report_number(row->noise), "outcome", outcome_of(row),
                             "failure", row->failure, "fault", (int)row->fault, "distance_from_surface",
                             report_number(row->distance_from_surface), "distance_from_points",
                             report_number(row->distance_from_points), "area", report_number(row->area)));
    }
    return report_json(json_pack("{s:I, s:I, s:I, s:I, s:I, s:o}", "right_accepted", (json_int_t)sums.right_accepted,
                                 "right_refused", (json_int_t)sums.right_refused, "wrong_accepted",
                                 (json_int_t)sums.wrong_accepted, "wrong_refused", (json_int_t)sums.wrong_refused, "failed",
                                 (json_int_t)sums.failed, "rows", array));
}

static void print_rows(const bat_scan_verdict_row *rows, size_t count)
{
    (void)printf("%-20s %7s %7s %-16s %8s %8s %6s\n", "shape", "points", "noise", "outcome", "missed", "strays", "area");
    for (size_t i = 0; i < count; i++)
    {
        const bat_scan_verdict_row *row = &rows[i];
        (void)printf("%-20s %7zu %7g %-16s ", row->shape, row->points, row->noise, outcome_of(row));
        if (row->failure[0] != '\0')
            terminal_print(stdout, "%s\n", row->failure);
        else
            (void)printf("%8.4f %8.4f %6.3f\n", row->distance_from_surface, row->distance_from_points, row->area);
    }
    outcomes sums = count_outcomes(rows, count);
    (void)printf(
        "\nright and accepted %zu, right but refused %zu, wrong but accepted %zu, wrong and refused %zu, none %zu\n",
        sums.right_accepted, sums.right_refused, sums.wrong_accepted, sums.wrong_refused, sums.failed);
}

int reproduce_scan_verdict(const reproduce_job *job)
{
    bat_scan_verdict_options options = bat_scan_verdict_defaults();
    bat_scan_verdict_row *rows;
    size_t count;
    bat_error error;
    options.seed = job->seed;
    options.progress = report_progress("fitting");
    bat_status status = bat_scan_verdict(job->data, &options, &rows, &count, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    int code = EXIT_DONE;
    if (job->call.json)
        code = print_json(rows, count);
    else
        print_rows(rows, count);
    free(rows);
    return code;
}
