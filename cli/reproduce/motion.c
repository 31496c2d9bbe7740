#include "reproduce.h"

#include "report.h"

#include "batten/research/motion_study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    PEERS = 3
};

/// The best peer in translation or rotation.
static double best_of(const bat_keyframes_row *row, size_t which)
{
    double best = INFINITY;
    for (size_t p = 0; p < PEERS; p++)
        best = fmin(best, row->peers[p][which]);
    return best;
}

static json_t *pair_json(const double pair[2])
{
    return json_pack("[o, o]", report_number(pair[0]), report_number(pair[1]));
}

static int print_json(const bat_keyframes_row *rows, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
    {
        const bat_keyframes_row *row = &rows[i];
        (void)json_array_append_new(array, json_pack("{s:s, s:b, s:I, s:o, s:o, s:o, s:o, s:o}", "motion", row->motion,
                                                     "noise", row->noisy, "step", (json_int_t)row->step, "spline",
                                                     pair_json(row->errors), "limited", pair_json(row->limited),
                                                     "scipy_spline", pair_json(row->peers[0]), "squad_akima",
                                                     pair_json(row->peers[1]), "slerp_linear", pair_json(row->peers[2])));
    }
    return report_json(json_pack("{s:o}", "rows", array));
}

static void print_text(const bat_keyframes_row *rows, size_t count)
{
    (void)printf(
        "Every k-th pose kept; root mean square errors of the poses between: translation, and angle in degrees.\n"
        "ratio: of the default spline to the best of scipy's CubicSpline with RotationSpline, Akima with squad, and\n"
        "lines with Slerp (stored figures).\n\n");
    (void)printf("%-16s %3s %21s %21s %21s %21s %21s %13s\n", "motion", "k", "spline", "limited", "CubicSpline, RotationS.",
                 "Akima, squad", "lines, Slerp", "ratio");
    for (size_t i = 0; i < count; i++)
    {
        const bat_keyframes_row *row = &rows[i];
        const double *pairs[] = {row->errors, row->limited, row->peers[0], row->peers[1], row->peers[2]};
        char name[32];
        (void)snprintf(name, sizeof name, "%s%s", row->motion, row->noisy ? ", noise" : "");
        (void)printf("%-16s %3zu", name, row->step);
        for (size_t p = 0; p < sizeof pairs / sizeof *pairs; p++)
            (void)printf(" %10.3e %10.3e", pairs[p][0], pairs[p][1]);
        (void)printf(" %6.3f %6.3f\n", row->errors[0] / best_of(row, 0), row->errors[1] / best_of(row, 1));
    }
}

int reproduce_motion_keyframes(const reproduce_job *job)
{
    bat_keyframes_row *rows;
    size_t count;
    bat_error error;
    bat_status status = bat_keyframes_measure(job->data, report_progress("measuring"), &rows, &count, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    int code = EXIT_DONE;
    if (job->call.json)
        code = print_json(rows, count);
    else
        print_text(rows, count);
    free(rows);
    return code;
}
