/// @file
/// Pictures of the studies of Ugail and Howard (2026).

#include "batten/research/curve_study.h"

#include "batten/space.h"
#include "research/studies/chart_labels.h"

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
                                      .mark = BAT_CHART_MARK_LINE_POINTS,
                                      .label = "learned, fairness 0 to 1"};
    f->series[1] = (bat_chart_series){
        .x = f->other_x, .y = f->other_y, .count = f->others, .mark = BAT_CHART_MARK_POINTS, .label = "other schemes"};
    bat_chart chart = bat_chart_defaults();
    chart.series = f->series;
    chart.series_count = 2;
    chart.title = f->title;
    chart.x_label = "mean-NN";
    chart.y_label = bending ? "median bending" : "mean G1";
    chart.log_x = chart.log_y = true;
    return chart;
}

/// Name the other schemes of a chart: those of the frontier that has its series.
static bat_status draw_names(const void *context, cairo_t *cairo, const bat_chart *chart, const plot_axes *axes,
                             bat_error *error)
{
    const frontier *f = context;
    while (chart->series != f->series)
        f++;
    return chart_labels_draw(cairo, axes, &f->series[1], f->other_names, error);
}

bat_status bat_tension_frontier_draw(const char *path, const bat_tension_row *rows, size_t count, bat_error *error)
{
    frontier frontiers[CHARTS] = {0};
    bat_chart charts[CHARTS];
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
    const chart_overlay names = {draw_names, frontiers};
    return chart_write(path, charts, CHARTS, &draw, &names, error);
}

// The histograms

/// Fraction of the insertions in each bin.
static void fill_bars(const bat_tension_effective *effective, double *x, double *y)
{
    const double width = (BAT_TENSION_EFFECTIVE_MAX - BAT_TENSION_EFFECTIVE_MIN) / BAT_TENSION_EFFECTIVE_BINS;
    for (size_t i = 0; i < BAT_TENSION_EFFECTIVE_BINS; i++)
    {
        x[i] = BAT_TENSION_EFFECTIVE_MIN + ((double)i + 0.5) * width;
        y[i] = (double)effective->histogram[i] / (double)effective->summary.count;
    }
}

bat_status bat_tension_mechanism_draw(const char *path, const bat_tension_mechanism_report *report, bat_error *error)
{
    static const char *const NAMES[SPACES] = {"plane", "sphere", "disk"};
    double x[2 * SPACES][BAT_TENSION_EFFECTIVE_BINS], y[2 * SPACES][BAT_TENSION_EFFECTIVE_BINS];
    bat_chart_series series[2 * SPACES];
    bat_chart charts[2 * SPACES];
    char titles[2 * SPACES][40];
    for (size_t i = 0; i < 2 * (size_t)SPACES; i++)
    {
        bool printed = i < SPACES;
        const bat_tension_mechanism_space *space = &report->spaces[i % SPACES];
        fill_bars(printed ? &space->printed : &space->outward, x[i], y[i]);
        (void)snprintf(titles[i], sizeof titles[i], "%s, %s sign", NAMES[i % SPACES], printed ? "printed" : "outward");
        series[i] = (bat_chart_series){.x = x[i],
                                       .y = y[i],
                                       .count = BAT_TENSION_EFFECTIVE_BINS,
                                       .mark = BAT_CHART_MARK_BARS,
                                       .colour = printed ? 1 : 2};
        charts[i] = bat_chart_defaults();
        charts[i].series = &series[i];
        charts[i].series_count = 1;
        charts[i].title = titles[i];
        charts[i].x_label = "effective tension";
        charts[i].y_label = "share of the insertions";
    }
    bat_curve_picture_options options = bat_curve_picture_defaults();
    options.columns = SPACES;
    return bat_chart_write(path, charts, 2 * SPACES, &options, error);
}

// The ground track

bat_status bat_tension_iss_draw(const char *path, bat_error *error)
{
    bat_space sphere = bat_sphere(2);
    bat_curve truth, control, fine = {0};
    bat_status status = bat_tension_iss_track(&sphere, &truth, &control, error);
    if (status != BAT_OK)
        return status;
    bat_curve_refine_options refine = bat_curve_refine_defaults();
    refine.scheme = bat_curve_scheme_angle(BAT_CURVE_TENSION_FOUR_POINT);
    status = bat_curve_refine(&control, &refine, &fine, error);
    if (status == BAT_OK)
    {
        bat_curve_picture_layer layers[] = {
            {.curve = &control, .role = BAT_CURVE_LAYER_ROLE_CONTROL, .label = "16 control points"},
            {.curve = &truth, .role = BAT_CURVE_LAYER_ROLE_TRUTH, .label = "ground track"},
            {.curve = &fine, .role = BAT_CURVE_LAYER_ROLE_CURVE, .label = "four-point, outward"},
        };
        bat_curve_picture_panel panel = {.layers = layers, .layer_count = 3};
        bat_curve_picture_options draw = bat_curve_picture_defaults();
        draw.projection = BAT_CURVE_PROJECTION_BOTH;
        status = bat_curve_picture_write(path, &panel, 1, &draw, error);
    }
    bat_curve_free(&truth);
    bat_curve_free(&control);
    bat_curve_free(&fine);
    return status;
}
