#include "curve/map/arc_refine.h"

#include "base/progress.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/pieces.h"

#include <math.h>

/// The state of a refinement.
typedef struct arc_job
{
    const arc_graph *graph;
    unsigned char *const *joints; ///< line_chains::joints of the graph's curves; null for none
    const bat_curve_refine_options *options;
    const map_chart *chart;
    const degree_edges *straight;
    bat_curve_map_refine_report *report;
    met_edges given;     ///< pairs of given edges
    size_t levels;       ///< levels before the polygons of the present step
    refined_arcs *fine;  ///< the result of the present step
    anchor_grid anchors; ///< a given point of each connected part
    chart_curves before; ///< the charts of the polygons of the present step
    chart_curves after;  ///< the charts of its result
} arc_job;

// Edges that meet before refinement

/// Find the given edges that meet, which may meet after refinement as well, or are refused.
static bat_status find_given(arc_job *job, bat_error *error)
{
    bat_status status = met_edges_find(&job->before, job->chart, job->options->threads, &job->given, error);
    job->report->given_crossing = job->given.count / 2;
    if (status != BAT_OK || !job->options->strict || job->given.count == 0)
        return status;
    edge_place first = job->given.pairs[0].places[0];
    status = error_set(error, BAT_INVALID_POINT, first.edge, 0, "the edge after this point crosses or touches another one");
    return error_curve(error, status, first.curve);
}

bat_status arc_anchors_make(const arc_graph *graph, const map_chart *chart, const chart_curves *charts, anchor_grid *anchors,
                            bat_error *error)
{
    size_t copies = chart->turn > 0 ? 3 : 1, room = copies * graph->component_count, count = 0, seen = 0;
    double *points = memory_array(room, 2 * sizeof *points);
    size_t *components = memory_array(room, sizeof *components);
    bat_status status = points != NULL && components != NULL ? BAT_OK : error_memory(error, room * 2 * sizeof *points);
    for (size_t a = 0; a < graph->arc_count && status == BAT_OK; a++)
    {
        if (graph->components[a] != seen)
            continue;
        seen++;
        for (size_t k = 0; k < copies; k++, count++)
        {
            static const double TURNS[] = {0, -1, 1};
            points[2 * count] = charts->curves[a].points[0] + TURNS[k] * chart->turn;
            points[2 * count + 1] = charts->curves[a].points[1];
            components[count] = graph->components[a];
        }
    }
    if (status == BAT_OK && graph->component_count > 1)
        status = anchor_grid_make(points, components, count, anchors, error);
    free(points);
    free(components);
    return status;
}

/// Whether the given edges under two edges of the present polygons meet, or neighbours of them.
static bool may_meet(void *context, edge_place first, edge_place second)
{
    const arc_job *job = context;
    first.edge >>= job->levels;
    second.edge >>= job->levels;
    return met_edges_near(&job->given, job->graph->arcs, first, second);
}

// Steps

static const bat_curve *arcs_of(const arc_job *job)
{
    return job->fine->arcs == NULL ? job->graph->arcs : job->fine->arcs;
}

/// Refine one arc with stops, where edges have levels of their own.
static bat_status refine_pieces(const arc_job *job, const bat_curve_refine_options *how, refined_arcs *next,
                                bat_error *error)
{
    shared_work work = shared_work_make(next->count, how->progress);
    if (array_zeros(&next->starts, next->count, sizeof *next->starts, error) != BAT_OK)
        return BAT_NO_MEMORY;
    size_t least = SIZE_MAX, most = 0;
#pragma omp parallel for schedule(dynamic) num_threads(threads_for(how->threads, next->count)) reduction(min                \
                                                                                                         : least)           \
    reduction(max                                                                                                           \
              : most)
    for (size_t i = 0; i < next->count; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error failure;
        bat_curve_refine_options one = *how;
        bat_curve_refine_report report = {0};
        one.threads = 1;
        one.progress = (bat_progress){0};
        one.report = &report;
        const unsigned char *joints = arc_joints(job->graph, job->joints, i);
        bat_status status =
            pieces_refine(&job->graph->arcs[i], &one, joints, NULL, &next->arcs[i], &next->starts[i], &failure);
        (void)error_curve(&failure, status, i);
        least = report.min_levels < least ? report.min_levels : least;
        most = report.max_levels > most ? report.max_levels : most;
        shared_work_finish(&work, i, status, &failure);
    }
    job->report->curves.stopped = next->count;
    job->report->curves.min_levels = least == SIZE_MAX ? 0 : least;
    job->report->curves.max_levels = most;
    return shared_work_end(&work, error);
}

static bool keeps_points(const bat_curve_refine_options *options)
{
    return scheme_keeps_points(&options->scheme) && !options->snap;
}

/// Whether the levels are computed and tested one after the other. Splines are not made level by level.
static bool goes_by_levels(const arc_job *job)
{
    return job->chart != NULL && !stop_wanted(job->options) && keeps_points(job->options) &&
           scheme_goes_by_levels(&job->options->scheme);
}

/// Whether each level begins with the coordinates that a file would hold.
static bool is_rounded(const arc_job *job)
{
    return job->chart != NULL && job->chart->globe && goes_by_levels(job);
}

static bool is_same_place(const double *flat, size_t i, size_t j)
{
    return flat[2 * i] == flat[2 * j] && flat[2 * i + 1] == flat[2 * j + 1];
}

static bool move_edge(void *context, size_t curve, size_t edge, size_t begin, size_t end, draw_move move)
{
    arc_job *job = context;
    chart_move(job->chart, &job->before.curves[curve], &job->fine->arcs[curve], &job->after.curves[curve], edge, begin, end,
               move);
    return true;
}

/// Draw back what meets after a step.
static bat_status draw_arcs_back(arc_job *job, bat_progress progress, bat_error *error)
{
    size_t count = job->fine->count;
    drawn_curve *drawn = memory_array(count, sizeof *drawn);
    if (drawn == NULL)
        return error_memory(error, count * sizeof *drawn);
    for (size_t i = 0; i < count; i++)
        drawn[i] = (drawn_curve){&job->before.curves[i], job->fine->starts != NULL ? job->fine->starts[i] : NULL};
    draw_rules rules = {.pairs = EDGE_PAIRS_ARCS,
                        .turn = job->chart->turn,
                        .move = job->chart->globe ? move_edge : NULL,
                        .may_meet = job->given.count > 0 ? may_meet : NULL,
                        .context = job,
                        .anchors = &job->anchors,
                        .threads = job->options->threads,
                        .components = job->graph->components};
    draw_back_counts counts;
    bat_status status = draw_back(drawn, job->after.curves, count, &rules, progress, &counts, error);
    job->report->crossings += counts.crossings;
    job->report->drawn_back += counts.edges;
    free(drawn);
    return error_curve(error, status, counts.stuck.curve);
}

/// The given edge of an arc that a refined edge lies over, roughly where the scheme moves the given points.
static edge_place given_edge(const arc_job *job, edge_place fine)
{
    const bat_curve *coarse = &job->graph->arcs[fine.curve], *refined = &job->fine->arcs[fine.curve];
    size_t edges = polygon_edges(refined->count, refined->closed);
    return (edge_place){fine.curve, fine.edge * polygon_edges(coarse->count, coarse->closed) / edges};
}

/// A search for edges that meet and should not.
typedef struct crossing_search
{
    arc_job *job;
    edge_place found; ///< the given edge beneath; curve BAT_NO_INDEX for none
} crossing_search;

static bool note_crossing(void *context, edge_place first, edge_place second)
{
    crossing_search *search = context;
    first = given_edge(search->job, first);
    second = given_edge(search->job, second);
    if (may_meet(search->job, first, second))
        return true;
    search->found = first;
    return false;
}

/// Refuse arcs that meet, of schemes that move the given points: there are no edges to which they could be drawn back.
static bat_status refuse_crossings(arc_job *job, bat_error *error)
{
    crossing_search search = {job, {BAT_NO_INDEX, 0}};
    bat_status status = edge_pairs_find(job->after.curves, job->after.count, job->chart->turn, EDGE_PAIRS_ARCS,
                                        job->options->threads, note_crossing, &search, error);
    if (status == BAT_OK && search.found.curve != BAT_NO_INDEX)
        status = error_remedy(
            error,
            error_set(error, BAT_UNSUPPORTED, search.found.edge, 0,
                      "the refined curve crosses a curve after point %zu, and the scheme does not keep the given points, "
                      "to which it could be drawn back",
                      search.found.edge),
            "simple", "never lets it");
    return error_curve(error, status, search.found.curve);
}

/// The charts of the result of a step, and what follows from them.
static bat_status keep_apart(arc_job *job, bat_progress progress, bat_error *error)
{
    bool keeps = keeps_points(job->options);
    bat_status status = chart_curves_make(job->chart, job->fine->arcs, job->fine->count, keeps ? &job->before : NULL,
                                          (size_t *const *)job->fine->starts, job->options->threads, &job->after, error);
    if (status != BAT_OK)
        return status;
    return keeps ? draw_arcs_back(job, progress, error) : refuse_crossings(job, error);
}

/// Place the new points of an arc evenly on its edges.
static bat_status place_on_edges(const bat_curve *before, bool in_degrees, bat_curve *after, bat_error *error)
{
    size_t dim = after->space->point_dim, step = (after->count - 1) / (before->count - 1);
    for (size_t i = 0; i < after->count; i++)
    {
        const double *p = before->points + i / step * dim;
        double *point = after->points + i * dim;
        if (i % step == 0)
            continue;
        if (in_degrees)
            degrees_edge_point(p, p + dim, (double)(i % step) / (double)step, point);
        else if (polygon_edge_point(after->space, p, p + dim, i % step, step, point) != BAT_OK)
            return error_set(error, BAT_CUT_LOCUS, 0, 0, "there is no unique geodesic along the edge after point 0");
    }
    return BAT_OK;
}

/// Straighten arcs of one edge where there are corners, without rounding; every scheme makes them straight but for rounding.
/// On the sphere, straighten also arcs that are straight in degrees. Levels that go on from a file's decimals look at their
/// own polygon alone.
static bat_status straighten(const arc_job *job, refined_arcs *next, bat_error *error)
{
    bool rounded = is_rounded(job);
    bat_status status = BAT_OK;
    for (size_t a = 0; a < next->count && keeps_points(job->options) && status == BAT_OK; a++)
    {
        const bat_curve *before = &arcs_of(job)[a], *first = rounded ? before : &job->graph->arcs[a];
        bool in_degrees = job->straight != NULL && degrees_straight(before, job->straight);
        if (in_degrees || (job->graph->has_corners && first->count == 2 && !first->closed))
            status = place_on_edges(before, in_degrees, &next->arcs[a], error);
    }
    return status;
}

/// Number the places of an arc's points in its chart, as a file holds them, where points that were drawn back to the start
/// of an edge repeat it: a point has the number of the one before it if it repeats it, and 0 before the end of a ring if it
/// repeats the first.
/// @param numbers of each point; may be null
/// @return how many there are
static size_t number_places(const bat_curve *arc, const double *flat, size_t *numbers)
{
    size_t end = arc->count, count = 0;
    while (arc->closed && end > 1 && is_same_place(flat, end - 1, 0))
        end--;
    for (size_t i = 0; i < arc->count; i++)
    {
        count += i == 0 || (i < end && !is_same_place(flat, i, i - 1));
        if (numbers != NULL)
            numbers[i] = i < end ? count - 1 : 0;
    }
    return count;
}

/// Refine an arc of the globe by a level as if it had each place once. Equal points have equal points between them.
static bat_status refine_repeating(const arc_job *job, size_t a, const bat_curve_refine_options *how, bat_curve *fine,
                                   bat_error *error)
{
    const bat_curve *arc = &arcs_of(job)[a];
    const double *flat = job->before.curves[a].points;
    size_t row = 3 * sizeof(double), *numbers = memory_array(arc->count, sizeof *numbers);
    bat_curve once = *arc, reduced = {0};
    once.points = memory_array(arc->count, row);
    *fine = (bat_curve){.space = arc->space, .closed = arc->closed, .count = 2 * arc->count - !arc->closed};
    fine->points = memory_array(fine->count, row);
    if (numbers == NULL || once.points == NULL || fine->points == NULL)
    {
        free(numbers);
        free(once.points);
        return error_memory(error, fine->count * row);
    }
    once.count = number_places(arc, flat, numbers);
    for (size_t i = 0; i < arc->count; i++)
        chart_to_point(job->chart, flat + 2 * i, once.points + 3 * numbers[i]);
    bool whole = once.count > 1 + (size_t)arc->closed;
    bat_status status = whole ? bat_curve_refine(&once, how, &reduced, error) : BAT_OK;
    for (size_t i = 0; i < fine->count && status == BAT_OK; i++)
    {
        size_t before = i / 2, after = before + 1 < arc->count ? before + 1 : 0;
        const double *p = arc->points + 3 * before, *q = arc->points + 3 * after;
        if (i % 2 == 0)
            memcpy(fine->points + 3 * i, p, row);
        else if (whole && numbers[before] != numbers[after])
            memcpy(fine->points + 3 * i, reduced.points + 3 * (2 * numbers[before] + 1), row);
        else
            status = bat_space_geodesic(arc->space, p, q, 0.5, fine->points + 3 * i);
    }
    free(numbers);
    free(once.points);
    bat_curve_free(&reduced);
    return status;
}

/// Refine the arcs, those with repeated places without them.
static bat_status refine_arcs(const arc_job *job, const bat_curve_refine_options *how, bat_curve *fine, bat_error *error)
{
    const bat_curve *arcs = arcs_of(job);
    size_t count = job->graph->arc_count, plain = 0;
    bool rounded = is_rounded(job) && how->levels > 0;
    bat_curve *given = memory_array(count, sizeof *given), *made = memory_array(count, sizeof *made);
    bat_status status = given != NULL && made != NULL ? BAT_OK : error_memory(error, count * sizeof *given);
    for (size_t a = 0; a < count && status == BAT_OK; a++)
        if (rounded && number_places(&arcs[a], job->before.curves[a].points, NULL) < arcs[a].count)
            status = error_curve(error, refine_repeating(job, a, how, &fine[a], error), a);
        else
            given[plain++] = arcs[a];
    if (status == BAT_OK)
        status = bat_curves_refine(given, plain, how, made, error);
    for (size_t a = 0, next = 0; a < count && status == BAT_OK; a++)
        if (fine[a].points == NULL)
            fine[a] = made[next++];
    free(given);
    free(made);
    return status;
}

/// Refine the present polygons, which have job->levels levels, by `how`, and keep them apart.
static bat_status run_step(arc_job *job, const bat_curve_refine_options *how, bat_error *error)
{
    static const double REFINED_SHARE = 0.6; // of the work
    size_t count = job->graph->arc_count;
    progress_part parts[2] = {{how->progress, 0, REFINED_SHARE}, {how->progress, REFINED_SHARE, 1 - REFINED_SHARE}};
    bat_curve_refine_options one = *how;
    bat_curve_refine_report report;
    refined_arcs next = {.count = count, .arcs = calloc(count, sizeof *next.arcs)};
    one.progress = progress_of_part(&parts[0]);
    one.report = &report;
    if (next.arcs == NULL)
        return error_memory(error, count * sizeof *next.arcs);
    bat_status status;
    status = stop_wanted(how) ? refine_pieces(job, &one, &next, error) : refine_arcs(job, &one, next.arcs, error);
    if (status == BAT_OK)
        status = straighten(job, &next, error);
    if (status != BAT_OK)
    {
        refined_arcs_free(&next);
        return status;
    }
    bat_curve *given = job->fine->arcs; // charts of the plane and the disk use their points
    *job->fine = next;
    if (job->chart != NULL)
    {
        status = keep_apart(job, progress_of_part(&parts[1]), error);
        chart_curves_free(&job->before);
        job->before = job->after;
        job->after = (chart_curves){0};
    }
    curves_free(given, count);
    return status;
}

/// Copies of the arcs of the graph, as the polygons of the first step.
static bat_status copy_arcs(arc_job *job, bat_error *error)
{
    size_t count = job->graph->arc_count;
    bat_curve *arcs = calloc(count > 0 ? count : 1, sizeof *arcs);
    *job->fine = (refined_arcs){.arcs = arcs, .count = count};
    if (arcs == NULL)
        return error_memory(error, count * sizeof *arcs);
    for (size_t a = 0; a < count; a++)
    {
        arcs[a] = job->graph->arcs[a];
        size_t size = arcs[a].count * arcs[a].space->point_dim * sizeof(double);
        if (array_make(&arcs[a].points, size, 1, error) != BAT_OK)
            return BAT_NO_MEMORY;
        memcpy(arcs[a].points, job->graph->arcs[a].points, size);
    }
    return BAT_OK;
}

/// Give the arcs of the globe the coordinates that the file will hold, so that a file between two levels changes nothing.
/// Points that would repeat their neighbours stay as they are.
static void round_arcs(const arc_job *job)
{
    for (size_t a = 0; a < job->fine->count; a++)
    {
        const double *flat = job->before.curves[a].points;
        size_t count = job->fine->arcs[a].count;
        for (size_t i = 0; i < count; i++)
            if (!is_same_place(flat, i, i > 0 ? i - 1 : count - 1) && !is_same_place(flat, i, i + 1 < count ? i + 1 : 0))
                chart_to_point(job->chart, flat + 2 * i, job->fine->arcs[a].points + 3 * i);
    }
}

/// Give the vertices of the graph the coordinates back that were rounded.
static void restore_given(const arc_job *job)
{
    for (size_t a = 0; a < job->fine->count; a++)
    {
        const bat_curve *given = &job->graph->arcs[a];
        for (size_t i = 0; i < given->count; i++)
            memcpy(job->fine->arcs[a].points + 3 * refined_arcs_row(job->fine, job->graph, a, i), given->points + 3 * i,
                   3 * sizeof(double));
    }
}

/// Refine level by level, from one polygon of the file's decimals to the next.
static bat_status run_levels(arc_job *job, bat_curve_refine_options *how, bat_error *error)
{
    double whole = ldexp(1, (int)job->options->levels) - 1;
    bat_status status = job->chart->globe ? copy_arcs(job, error) : BAT_OK;
    how->levels = 1;
    for (size_t level = 0; level < job->options->levels && status == BAT_OK; level++)
    {
        progress_part part = {job->options->progress, (ldexp(1, (int)level) - 1) / whole, ldexp(1, (int)level) / whole};
        how->progress = progress_of_part(&part);
        how->first_level = job->options->first_level + level;
        job->levels = level;
        if (job->chart->globe)
            round_arcs(job);
        status = run_step(job, how, error);
    }
    how->progress = (bat_progress){0};
    if (status == BAT_OK && job->chart->globe)
        restore_given(job);
    return status;
}

/// The steps: one, or one for each level.
static bat_status run_steps(arc_job *job, bat_error *error)
{
    bat_curve_refine_options how = *job->options;
    how.simple = BAT_CURVE_SIMPLE_NEVER;
    how.corner_angle = 0;
    how.find_corners = false;
    if (!stop_wanted(&how))
        job->report->curves.min_levels = job->report->curves.max_levels = how.levels;
    return !goes_by_levels(job) || how.levels == 0 ? run_step(job, &how, error) : run_levels(job, &how, error);
}

/// Whether the arcs of a graph have room for all levels.
static bat_status check_room(const arc_job *job, bat_error *error)
{
    bat_status status = BAT_OK;
    bat_curve_refine_options how = *job->options;
    size_t longest = 0, count;
    for (size_t i = 1; i < job->graph->arc_count; i++)
        longest = job->graph->arcs[i].count > job->graph->arcs[longest].count ? i : longest;
    how.corner_angle = 0;
    how.find_corners = false;
    if (job->graph->arc_count > 0 && !stop_wanted(&how))
        status = bat_curve_refined_count(&job->graph->arcs[longest], &how, &count, error);
    return error_curve(error, status, longest);
}

bat_status refined_arcs_make(const arc_graph *graph, unsigned char *const *joints, const bat_curve_refine_options *options,
                             const map_chart *chart, const degree_edges *straight, bat_curve_map_refine_report *report,
                             refined_arcs *fine, bat_error *error)
{
    *fine = (refined_arcs){0};
    arc_job job = {.graph = graph,
                   .joints = joints,
                   .options = options,
                   .chart = chart,
                   .straight = straight,
                   .report = report,
                   .fine = fine};
    bat_status status = check_room(&job, error);
    if (status == BAT_OK && chart != NULL)
    {
        status = chart_curves_make(chart, graph->arcs, graph->arc_count, NULL, NULL, options->threads, &job.before, error);
        if (status == BAT_OK)
            status = find_given(&job, error);
        if (status == BAT_OK)
            status = arc_anchors_make(graph, chart, &job.before, &job.anchors, error);
    }
    if (status == BAT_OK)
        status = run_steps(&job, error);
    if (status != BAT_OK && error != NULL && error->index != BAT_NO_INDEX)
        error->index >>= job.levels;
    anchor_grid_free(&job.anchors);
    chart_curves_free(&job.before);
    chart_curves_free(&job.after);
    met_edges_free(&job.given);
    return status;
}

size_t refined_arcs_row(const refined_arcs *fine, const arc_graph *graph, size_t arc, size_t i)
{
    const bat_curve *coarse = &graph->arcs[arc], *refined = &fine->arcs[arc];
    if (fine->starts != NULL)
        return fine->starts[arc][i];
    return i * (polygon_edges(refined->count, refined->closed) / polygon_edges(coarse->count, coarse->closed));
}

void refined_arcs_free(refined_arcs *fine)
{
    curves_free(fine->arcs, fine->count);
    for (size_t i = 0; i < fine->count && fine->starts != NULL; i++)
        free(fine->starts[i]);
    free(fine->starts);
    *fine = (refined_arcs){0};
}
