#include "reproduce.h"

#include "arguments.h"
#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum
{
    MAX_POINTS = 32,
    SPACES = BAT_TENSION_SPACE_COUNT,
    CHARTS = 2 * SPACES
};

/// The metrics of one space: of the learned scheme for all fairness settings, and of the others.
typedef struct frontier
{
    double learned_x[MAX_POINTS], learned_y[MAX_POINTS], other_x[MAX_POINTS], other_y[MAX_POINTS];
    const char *other_names[MAX_POINTS];
    size_t learned, others;
    bat_chart_series series[2];
    char title[64];
} frontier;

static double roughness(const bat_tension_row *row, bool bending)
{
    return bending ? row->bending.median : row->g1.mean;
}

/// Rows with the printed sign of the insertion angle are omitted, because their distances are much larger.
static bool is_shown(const bat_tension_row *row)
{
    return strstr(row->method, "printed") == NULL;
}

static void collect(const bat_tension_row *rows, size_t count, bool bending, frontier *f)
{
    for (size_t i = 0; i < count && f->learned < MAX_POINTS && f->others < MAX_POINTS; i++)
    {
        if (isfinite(rows[i].fairness))
        {
            f->learned_x[f->learned] = rows[i].mean_nn.mean;
            f->learned_y[f->learned++] = roughness(&rows[i], bending);
        }
        else if (is_shown(&rows[i]))
        {
            f->other_x[f->others] = rows[i].mean_nn.mean;
            f->other_y[f->others] = roughness(&rows[i], bending);
            f->other_names[f->others++] = rows[i].method;
        }
    }
}

static bat_chart chart_of(frontier *f, const char *space, bool bending)
{
    (void)snprintf(f->title, sizeof f->title, "%s: %s", space, bending ? "median bending" : "G1");
    f->series[0] = (bat_chart_series){.x = f->learned_x,
                                      .y = f->learned_y,
                                      .count = f->learned,
                                      .mark = BAT_CHART_LINE_POINTS,
                                      .label = "learned, fairness 0 to 1"};
    f->series[1] = (bat_chart_series){.x = f->other_x,
                                      .y = f->other_y,
                                      .count = f->others,
                                      .mark = BAT_CHART_POINTS,
                                      .label = "other schemes",
                                      .point_labels = f->other_names};
    bat_chart chart = bat_chart_defaults();
    chart.series = f->series;
    chart.series_count = 2;
    chart.title = f->title;
    chart.x_label = "mean-NN";
    chart.y_label = bending ? "median bending" : "mean G1";
    chart.log_x = chart.log_y = true;
    return chart;
}

int reproduce_draw_frontier(const reproduce_job *job, const bat_tension_row *rows, size_t count)
{
    frontier frontiers[CHARTS] = {0};
    bat_chart charts[CHARTS];
    bat_error error;
    for (size_t c = 0; c < CHARTS; c++)
    {
        const bat_tension_row *own = rows + c % SPACES * (count / SPACES);
        bool bending = c >= SPACES;
        collect(own, count / SPACES, bending, &frontiers[c]);
        charts[c] = chart_of(&frontiers[c], own->space, bending);
    }
    bat_curve_picture_options draw = bat_curve_picture_defaults();
    draw.columns = SPACES;
    draw.width = 1400;
    draw.height = 900;
    reproduce_picture picture;
    int code = reproduce_picture_add(job, "tension-frontier.png", &picture);
    if (code == EXIT_DONE && bat_chart_write(picture.write_to, charts, CHARTS, &draw, &error) != BAT_OK)
        code = report_failure(picture.path, &error);
    return code;
}
