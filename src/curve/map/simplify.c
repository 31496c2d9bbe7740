#include "curve/map/arc_refine.h"

#include "base/error.h"
#include "curve/polygon.h"

#include <limits.h>

/// @file
/// Simplification of the arcs of a map by Douglas and Peucker's algorithm. Where simplified arcs would meet, pass over a
/// part of the map, or vanish, points come back.

/// Arcs on the way to be simplified.
typedef struct simplify_job
{
    const arc_graph *graph;
    double tolerance;
    edge_geometry geometry;
    unsigned char **keep; ///< of each arc, flags of its points
    size_t *rows;         ///< of the arc in hand: its kept points
    double *swept;        ///< what an edge passes over
    bool again;           ///< points came back
} simplify_job;

/// The point between two of an arc that is farthest from the edge between these; `from` where there is none.
static size_t farthest(const simplify_job *job, size_t a, size_t from, size_t to, double *distance)
{
    const bat_curve *arc = &job->graph->arcs[a];
    size_t dim = arc->space->point_dim, found = from;
    const double *p = arc->points + from * dim, *q = arc->points + to % arc->count * dim;
    *distance = -1;
    for (size_t i = from + 1; i < to; i++)
    {
        double d = polygon_edge_distance(arc->space, job->geometry, p, q, arc->points + i * dim);
        if (d > *distance)
        {
            *distance = d;
            found = i;
        }
    }
    return found;
}

/// Keep what the tolerance asks for between two kept points.
static void keep_between(simplify_job *job, size_t a, size_t from, size_t to)
{
    // The larger part of a range waits while the smaller one is divided, so that few ranges wait.
    size_t waiting[CHAR_BIT * sizeof(size_t)][2] = {{from, to}}, count = 1;
    while (count > 0)
    {
        double distance;
        from = waiting[count - 1][0];
        to = waiting[--count][1];
        size_t middle = farthest(job, a, from, to, &distance);
        if (!(distance > job->tolerance))
            continue;
        job->keep[a][middle] = 1;
        bool smaller_first = middle - from < to - middle;
        size_t parts[2][2] = {{smaller_first ? middle : from, smaller_first ? to : middle},
                              {smaller_first ? from : middle, smaller_first ? middle : to}};
        memcpy(waiting[count], parts, sizeof parts);
        count += 2;
    }
}

/// Keep the point farthest from an edge between two kept ones.
static size_t keep_farthest(simplify_job *job, size_t a, size_t from, size_t to)
{
    double distance;
    size_t middle = farthest(job, a, from, to, &distance);
    job->again |= middle != from && job->keep[a][middle] == 0;
    job->keep[a][middle] = 1;
    return middle;
}

/// The ends, and for rings and loops a point on each side, so that they keep an area.
static void simplify_arc(simplify_job *job, size_t a)
{
    const bat_curve *arc = &job->graph->arcs[a];
    size_t end = polygon_edges(arc->count, arc->closed), size = arc->space->point_dim * sizeof(double);
    bool loop = arc->closed || memcmp(arc->points, arc->points + (arc->count - 1) * arc->space->point_dim, size) == 0;
    job->keep[a][0] = 1;
    job->keep[a][end % arc->count] = 1;
    if (!loop)
    {
        keep_between(job, a, 0, end);
        return;
    }
    size_t middle = keep_farthest(job, a, 0, end);
    keep_between(job, a, 0, middle);
    keep_between(job, a, middle, end);
    double before, after;
    size_t first = farthest(job, a, 0, middle, &before), second = farthest(job, a, middle, end, &after);
    job->keep[a][before > after ? first : second] = 1;
}

/// The kept points of an arc: their indices, and for a closed one the count at the end. Returns the number of edges.
static size_t list_rows(simplify_job *job, size_t a)
{
    const bat_curve *arc = &job->graph->arcs[a];
    size_t count = 0;
    for (size_t i = 0; i < arc->count; i++)
        if (job->keep[a][i] != 0)
            job->rows[count++] = i;
    if (arc->closed)
        job->rows[count++] = arc->count;
    return count - 1;
}

/// The kept points as curves.
static void simplified_arcs(simplify_job *job, bat_curve *arcs, double *points)
{
    for (size_t a = 0; a < job->graph->arc_count; a++)
    {
        const bat_curve *arc = &job->graph->arcs[a];
        size_t dim = arc->space->point_dim, edges = list_rows(job, a);
        arcs[a] = (bat_curve){.space = arc->space, .points = points, .closed = arc->closed};
        arcs[a].count = edges + !arc->closed;
        for (size_t i = 0; i < arcs[a].count; i++, points += dim)
            memcpy(points, arc->points + job->rows[i] * dim, dim * sizeof *points);
    }
}

/// Bring back points of edges that pass over anchors.
static void search_passed(simplify_job *job, const chart_curves *given, const anchor_grid *anchors)
{
    for (size_t a = 0; a < job->graph->arc_count && anchors->count > 0; a++)
    {
        const bat_curve *flat = &given->curves[a];
        size_t edges = list_rows(job, a);
        for (size_t k = 0; k < edges; k++)
        {
            size_t from = job->rows[k], to = job->rows[k + 1];
            for (size_t i = from; i <= to; i++)
                memcpy(job->swept + 2 * (i - from), flat->points + 2 * (i < flat->count ? i : 0), 2 * sizeof(double));
            if (to - from > 1 && anchor_grid_inside(anchors, job->swept, to - from + 1, job->graph->components[a]))
                (void)keep_farthest(job, a, from, to);
        }
    }
}

/// Bring points back until arcs meet and pass only where they did before.
static bat_status keep_apart(simplify_job *job, const map_chart *chart, int threads, bat_error *error)
{
    const arc_graph *graph = job->graph;
    size_t room = 0;
    for (size_t a = 0; a < graph->arc_count; a++)
        room += graph->arcs[a].count;
    bat_curve *arcs = memory_array(graph->arc_count, sizeof *arcs);
    double *points = memory_array(room, BAT_SPACE_MAX_DIM * sizeof *points);
    chart_curves given = {0};
    anchor_grid anchors = {0};
    bat_status status = arcs != NULL && points != NULL ? BAT_OK : error_memory(error, room * sizeof *points);
    if (status == BAT_OK)
        status = chart_curves_make(chart, graph->arcs, graph->arc_count, NULL, NULL, threads, &given, error);
    if (status == BAT_OK)
        status = arc_anchors_make(graph, chart, &given, &anchors, error);
    job->again = true;
    while (status == BAT_OK && job->again)
    {
        chart_curves now = {0};
        met_edges met = {0};
        job->again = false;
        simplified_arcs(job, arcs, points);
        status = chart_curves_make(chart, arcs, graph->arc_count, NULL, NULL, threads, &now, error);
        if (status == BAT_OK)
            status = met_edges_find(&now, chart, threads, &met, error);
        for (size_t i = met.count; i > 0 && status == BAT_OK; i--) // from the last, as a new row moves those after it
        {
            edge_place place = met.pairs[i - 1].places[0];
            if (i < met.count && memcmp(&met.pairs[i].places[0], &met.pairs[i - 1].places[0], sizeof place) == 0)
                continue;
            list_rows(job, place.curve);
            size_t from = job->rows[place.edge], to = job->rows[place.edge + 1];
            if (to - from > 1)
                (void)keep_farthest(job, place.curve, from, to);
        }
        search_passed(job, &given, &anchors);
        met_edges_free(&met);
        chart_curves_free(&now);
    }
    anchor_grid_free(&anchors);
    chart_curves_free(&given);
    free(arcs);
    free(points);
    return status;
}

static bat_status simplify_arcs(const arc_graph *graph, double tolerance, const map_chart *chart, int threads,
                                unsigned char **keep, bat_error *error)
{
    simplify_job job = {.graph = graph, .tolerance = tolerance, .keep = keep};
    size_t longest = 0;
    for (size_t a = 0; a < graph->arc_count; a++)
        longest = graph->arcs[a].count > longest ? graph->arcs[a].count : longest;
    memory_pool pool = {0};
    job.rows = memory_pool_array(&pool, longest + 1, sizeof *job.rows);
    job.swept = memory_pool_array(&pool, longest + 1, 2 * sizeof *job.swept);
    job.geometry = graph->arc_count > 0 ? polygon_geometry_of(graph->arcs[0].space) : GEOMETRY_ANY;
    bat_status status = memory_pool_check(&pool, error);
    for (size_t a = 0; a < graph->arc_count && status == BAT_OK; a++)
        simplify_arc(&job, a);
    if (status == BAT_OK && chart != NULL && graph->arc_count > 0)
        status = keep_apart(&job, chart, threads, error);
    memory_pool_free(&pool);
    return status;
}

// Curves of kept points

/// Flag the points of a curve that its arcs keep.
static void flag_kept(const arc_graph *graph, unsigned char *const *keep, const bat_curve *curve, size_t c,
                      unsigned char *flags)
{
    size_t at = graph->begins[c];
    memset(flags, 1, curve->count); // the end of an open one
    for (size_t u = graph->first_use[c]; u < graph->first_use[c + 1]; u++)
    {
        const arc_use *use = &graph->uses[u];
        const bat_curve *arc = &graph->arcs[use->arc];
        size_t n = arc->count, edges = polygon_edges(n, arc->closed);
        for (size_t step = 0; step < edges; step++)
        {
            size_t forward = arc->closed ? (use->offset + step) % n : step;
            size_t back = arc->closed ? (use->offset + n - step) % n : n - 1 - step;
            flags[at] = keep[use->arc][use->reversed ? back : forward];
            at = at + 1 < curve->count ? at + 1 : 0;
        }
    }
}

/// Copy the flagged points of a curve.
static bat_status copy_kept(const bat_curve *curve, const unsigned char *flags, bat_curve *kept, size_t **origins,
                            bat_error *error)
{
    bat_status status = curve_room(curve, curve->count, curve->corners != NULL, kept, error);
    *origins = memory_array(curve->count, sizeof **origins);
    kept->count = 0;
    for (size_t i = 0; i < curve->count && status == BAT_OK && *origins != NULL; i++)
        if (flags[i] != 0)
        {
            (*origins)[kept->count] = i;
            curve_copy_row(curve, i, kept, kept->count++);
        }
    return *origins != NULL ? status : error_memory(error, curve->count * sizeof **origins);
}

bat_status simplified_curves_make(const bat_curve *curves, size_t count, double tolerance, const map_chart *chart,
                                  int threads, snapped_curves *simple, bat_error *error)
{
    arc_graph graph = {0};
    unsigned char **corners = memory_array(count, sizeof *corners), **keep = NULL, *flags = NULL;
    size_t longest = 0;
    *simple = (snapped_curves){.count = count, .curves = calloc(count, sizeof *simple->curves)};
    simple->origins = calloc(count, sizeof *simple->origins);
    bat_status status = corners != NULL && simple->curves != NULL && simple->origins != NULL
                            ? BAT_OK
                            : error_memory(error, count * sizeof *simple->curves);
    for (size_t c = 0; c < count && status == BAT_OK; c++)
    {
        corners[c] = curves[c].corners;
        longest = curves[c].count > longest ? curves[c].count : longest;
    }
    if (status == BAT_OK)
        status = arc_graph_make(curves, count, corners, false, &graph, error);
    keep = status == BAT_OK ? calloc(graph.arc_count + 1, sizeof *keep) : NULL;
    flags = memory_array(longest, 1);
    if (status == BAT_OK && (keep == NULL || flags == NULL))
        status = error_memory(error, longest);
    for (size_t a = 0; a < graph.arc_count && status == BAT_OK; a++)
    {
        keep[a] = calloc(graph.arcs[a].count, 1);
        status = keep[a] != NULL ? BAT_OK : error_memory(error, graph.arcs[a].count);
    }
    if (status == BAT_OK)
        status = simplify_arcs(&graph, tolerance, chart, threads, keep, error);
    for (size_t c = 0; c < count && status == BAT_OK; c++)
    {
        flag_kept(&graph, keep, &curves[c], c, flags);
        status = copy_kept(&curves[c], flags, &simple->curves[c], &simple->origins[c], error);
        simple->moved += status == BAT_OK ? curves[c].count - simple->curves[c].count : 0;
    }
    for (size_t a = 0; keep != NULL && a < graph.arc_count; a++)
        free(keep[a]);
    free(keep);
    free(corners);
    free(flags);
    arc_graph_free(&graph);
    return status;
}
