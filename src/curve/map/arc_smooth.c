#include "curve/map/arc_refine.h"

#include "base/error.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/polygon.h"
#include "curve/smooth.h"

typedef struct smooth_job
{
    arc_graph *graph;
    const bat_curve_refine_options *options;
    const map_chart *chart;
    bat_curve *given; ///< the arcs before; their points are in `backs`
    smooth_back *backs;
    double *noises;
    met_edges met; ///< before
} smooth_job;

static bool note_new(void *context, edge_place first, edge_place second)
{
    smooth_job *job = context;
    if (met_edges_near(&job->met, job->given, first, second))
        return true;
    smooth_back_mark(&job->backs[first.curve], first.edge);
    smooth_back_mark(&job->backs[second.curve], second.edge);
    return true;
}

/// Mark the edges that pass over the anchor of another part on their way from the given ones.
static void search_passed(smooth_job *job, const chart_curves *given, const chart_curves *now, const anchor_grid *anchors)
{
    for (size_t a = 0; a < given->count; a++)
    {
        const bat_curve *from = &given->curves[a], *to = &now->curves[a];
        for (size_t i = 0; i < polygon_edges(from->count, from->closed); i++)
        {
            size_t next = i + 1 == from->count ? 0 : i + 1, row = 2 * sizeof(double);
            double swept[8];
            memcpy(swept, from->points + 2 * i, row);
            memcpy(swept + 2, from->points + 2 * next, row);
            memcpy(swept + 4, to->points + 2 * next, row);
            memcpy(swept + 6, to->points + 2 * i, row);
            if (anchor_grid_inside(anchors, swept, 4, job->graph->components[a]))
                smooth_back_mark(&job->backs[a], i);
        }
    }
}

/// Draw arcs back until none meets another that it did not meet.
static bat_status keep_apart(smooth_job *job, bat_error *error)
{
    const arc_graph *graph = job->graph;
    int threads = job->options->threads;
    chart_curves given = {0}, now = {0};
    anchor_grid anchors[2] = {{0}, {0}};
    bat_status status = chart_curves_make(job->chart, job->given, graph->arc_count, NULL, NULL, threads, &given, error);
    if (status == BAT_OK)
        status = met_edges_find(&given, job->chart, threads, &job->met, error);
    if (status == BAT_OK)
        status = arc_anchors_make(graph, job->chart, &given, &anchors[0], error);
    for (bool again = true; status == BAT_OK && again;)
    {
        again = false;
        status = chart_curves_make(job->chart, graph->arcs, graph->arc_count, NULL, NULL, threads, &now, error);
        if (status == BAT_OK)
            status = arc_anchors_make(graph, job->chart, &now, &anchors[1], error);
        if (status == BAT_OK)
            status =
                edge_pairs_find(now.curves, now.count, job->chart->turn, EDGE_PAIRS_ARCS, threads, note_new, job, error);
        for (int k = 0; k < 2 && status == BAT_OK; k++)
            search_passed(job, &given, &now, &anchors[k]);
        for (size_t a = 0; a < graph->arc_count && status == BAT_OK; a++)
            status = smooth_back_move(&job->backs[a], graph->arcs[a].points, &again);
        chart_curves_free(&now);
        anchor_grid_free(&anchors[1]);
    }
    chart_curves_free(&given);
    anchor_grid_free(&anchors[0]);
    return status;
}

static bat_status smooth_all(smooth_job *job, bat_error *error)
{
    size_t count = job->graph->arc_count;
    shared_work work = shared_work_make(count, (bat_progress){0});
#pragma omp parallel for schedule(dynamic) num_threads(threads_for(job->options->threads, count))
    for (size_t a = 0; a < count; a++)
    {
        bat_error failure;
        if (!shared_work_wants(&work, a))
            continue;
        bat_status status =
            smooth_points(&job->given[a], job->options->smooth, NULL, job->graph->arcs[a].points, &job->noises[a], &failure);
        if (status == BAT_OK)
            smooth_back_begin(&job->backs[a], job->graph->arcs[a].points);
        shared_work_finish(&work, a, error_curve(&failure, status, a), &failure);
    }
    return shared_work_end(&work, error);
}

bat_status arcs_smooth(arc_graph *graph, const bat_curve_refine_options *options, const map_chart *chart,
                       bat_curve_refine_report *report, bat_error *error)
{
    size_t count = graph->arc_count;
    smooth_job job = {.graph = graph, .options = options, .chart = chart};
    memory_pool pool = {0};
    job.given = memory_pool_array(&pool, count, sizeof *job.given);
    job.backs = memory_pool_zeros(&pool, count, sizeof *job.backs);
    job.noises = memory_pool_array(&pool, count, sizeof *job.noises);
    bat_status status = memory_pool_check(&pool, error);
    for (size_t a = 0; a < count && status == BAT_OK; a++)
    {
        status = smooth_back_make(&graph->arcs[a], &job.backs[a], error);
        job.given[a] = job.backs[a].given;
    }
    if (status == BAT_OK)
        status = smooth_all(&job, error);
    if (status == BAT_OK && chart != NULL)
        status = keep_apart(&job, error);
    for (size_t a = 0; a < count && status == BAT_OK; a++)
        smooth_report(&job.given[a], graph->arcs[a].points, job.noises[a], report);
    for (size_t a = 0; a < count && job.backs != NULL; a++)
        smooth_back_free(&job.backs[a]);
    memory_pool_free(&pool);
    met_edges_free(&job.met);
    return status;
}
