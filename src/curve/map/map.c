#include "base/error.h"
#include "base/option.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/corner.h"
#include "curve/map/arc_refine.h"
#include "curve/pieces.h"
#include "curve/smooth.h"
#include "space/degrees.h"

static const bat_choice TOPOLOGIES[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "files with features", BAT_CURVE_MAP_TOPOLOGY_AUTO),
    CHOICE("features", "files with features, such as GeoJSON, are maps", BAT_CURVE_MAP_TOPOLOGY_FEATURES),
    CHOICE("shared", "every set of curves is a map", BAT_CURVE_MAP_TOPOLOGY_ALWAYS),
    CHOICE("separate", "every curve is refined by itself", BAT_CURVE_MAP_TOPOLOGY_SEPARATE),
};
const bat_family bat_curve_map_topology_family = FAMILY("map topology", TOPOLOGIES);

static const bat_choice EDGES[] = {
    CHOICE("auto", "those along parallels and meridians, longer than a degree, stay on them", BAT_CURVE_MAP_EDGES_AUTO),
    CHOICE("geodesic", "edges are parts of great circles", BAT_CURVE_MAP_EDGES_GEODESIC),
    CHOICE("straight", "those longer than a degree are straight in longitude and latitude", BAT_CURVE_MAP_EDGES_STRAIGHT),
};
const bat_family bat_curve_map_edges_family = FAMILY("map edges", EDGES);

static const bat_choice JOINS[] = {
    CHOICE("auto", "two lines that meet where no third does go on as one", BAT_CURVE_MAP_JOIN_AUTO),
    CHOICE("no", "every line ends where it ends", BAT_CURVE_MAP_JOIN_NO),
};
const bat_family bat_curve_map_join_family = FAMILY("map join", JOINS);

bat_curve_map_refine_options bat_curve_map_refine_defaults(void)
{
    return (bat_curve_map_refine_options){.refine = bat_curve_refine_defaults(), .decimals = 10};
}

static const option_field FIELDS[] = {
    OPTION_FAMILY(bat_curve_map_refine_options, topology, bat_curve_map_topology_family),
    OPTION_FAMILY(bat_curve_map_refine_options, edges, bat_curve_map_edges_family),
    OPTION_FAMILY(bat_curve_map_refine_options, join, bat_curve_map_join_family),
    OPTION_FIELD(bat_curve_map_refine_options, simplify, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_curve_map_refine_options, snap_tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_curve_map_refine_options, decimals, OPTION_INT, 0, DEGREE_MAX_DECIMALS),
    OPTION_STRUCT(bat_curve_map_refine_options, refine, bat_curve_refine_fields),
};

const bat_options_table bat_curve_map_refine_fields = OPTIONS_TABLE(bat_curve_map_refine_options, FIELDS, NULL);

/// A map during refinement.
typedef struct map_job
{
    const bat_curve *curves; ///< the given ones, or those of `snapped` or `simple`, or the chains
    size_t count;
    const bat_curve *lines; ///< `line_count` of them, of which the chains are made
    size_t line_count;
    const bat_curve *given;
    unsigned char *touching; ///< of each given curve: a ring that comes within rounding of touching itself; null for none
    size_t touch_count, touch_points; ///< of rings, of their vertices that are corners for that
    snapped_curves snapped, simple;
    line_chains chains;
    degree_edges straight;
    bat_curve_refine_options refine; ///< complete
    bat_curve_map_refine_report report;
    unsigned char **corners; ///< of each curve; null without corners
    arc_graph graph;
    refined_arcs fine;
    bat_curve *result; ///< `count` refined curves
    bat_curve *cut;    ///< the lines that are cut out of them, where there are chains
} map_job;

/// Run a function for each curve.
typedef bat_status curve_work(map_job *job, size_t curve, bat_error *error);
static bat_status for_each_curve(map_job *job, curve_work *run, bat_error *error)
{
    shared_work work = shared_work_make(job->count, (bat_progress){0});
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads_for(job->refine.threads, job->count))
    for (size_t i = 0; i < job->count; i++)
    {
        bat_error failure;
        if (shared_work_wants(&work, i))
            shared_work_finish(&work, i, error_curve(&failure, run(job, i, &failure), i), &failure);
    }
    return shared_work_end(&work, error);
}

static bat_status check_curve(map_job *job, size_t curve, bat_error *error)
{
    return bat_curve_check(&job->curves[curve], error);
}

/// Whether edges can be straight in degrees.
static bool has_straight_edges(const map_job *job)
{
    return job->straight.edges != BAT_CURVE_MAP_EDGES_GEODESIC && corners_stay(&job->refine);
}

static bat_status find_corners(map_job *job, size_t curve, bat_error *error)
{
    const bat_curve *given = &job->curves[curve];
    size_t count;
    if (array_make(&job->corners[curve], given->count, 1, error) != BAT_OK)
        return BAT_NO_MEMORY;
    bat_status status = corners_find(given, &job->refine, job->corners[curve], &count, error);
    if (status == BAT_OK && has_straight_edges(job))
        status = degrees_flag_runs(given, &job->straight, job->corners[curve], error);
    return status;
}

static bat_status find_all_corners(map_job *job, bat_error *error)
{
    bool has_corners = has_straight_edges(job);
    for (size_t i = 0; i < job->count; i++)
        has_corners |= corners_wanted(&job->curves[i], &job->refine);
    if (!has_corners)
        return BAT_OK;
    if (array_zeros(&job->corners, job->count, sizeof *job->corners, error) != BAT_OK)
        return BAT_NO_MEMORY;
    bat_status status = for_each_curve(job, find_corners, error);
    for (size_t i = 0; i < job->count && status == BAT_OK; i++)
        for (size_t k = 0; k < job->curves[i].count; k++)
            job->report.curves.corners += job->corners[i][k];
    return status;
}

/// Join lines that meet end to end.
static bat_status join_lines(map_job *job, bat_curve_map_join join, bat_error *error)
{
    job->lines = job->curves;
    job->line_count = job->count;
    if (join == BAT_CURVE_MAP_JOIN_NO || !scheme_keeps_points(&job->refine.scheme) || job->refine.snap)
        return BAT_OK;
    bat_status status = line_chains_make(job->curves, job->count, &job->chains, error);
    job->report.joints = job->chains.pairs;
    if (status == BAT_OK && job->chains.pairs > 0)
    {
        job->curves = job->chains.curves;
        job->count = job->chains.count;
    }
    return status;
}

/// Find whether joined points make a ring touch itself. Such a ring has straight edges, where schemes can have corners.
static bat_status find_touching(map_job *job, size_t curve, bat_error *error)
{
    const bat_curve *given = &job->given[curve];
    bat_curve *joined = &job->snapped.curves[curve];
    size_t row = given->space->point_dim * sizeof(double), same = 0;
    bool apart, touches = false;
    while (same < given->count && same < joined->count &&
           memcmp((char *)joined->points + same * row, (char *)given->points + same * row, row) == 0)
        same++;
    if (!given->closed || (same == given->count && same == joined->count))
        return BAT_OK;
    bat_status status = curve_edges_are_apart(joined, &apart, error);
    if (status == BAT_OK && !apart)
        status = curve_edges_are_apart(given, &touches, error);
    if (status != BAT_OK || !touches)
        return status;
    if (job->refine.strict && job->refine.simple != BAT_CURVE_SIMPLE_NEVER)
        return error_remedy(
            error,
            error_set(error, BAT_INVALID_POINT, same > 0 ? same - 1 : 0, 0, "the ring touches itself within rounding"),
            "simple", "never leaves it as given");
    job->touching[curve] = true;
    if (!corners_stay(&job->refine))
        return BAT_OK;
    free(joined->corners);
    if (array_make(&joined->corners, joined->count, 1, error) != BAT_OK)
        return BAT_NO_MEMORY;
    memset(joined->corners, 1, joined->count);
    return BAT_OK;
}

static bat_status find_all_touching(map_job *job, bat_error *error)
{
    job->given = job->curves;
    if (array_zeros(&job->touching, job->count, 1, error) != BAT_OK)
        return BAT_NO_MEMORY;
    bat_status status = for_each_curve(job, find_touching, error);
    for (size_t i = 0; i < job->count; i++)
    {
        job->touch_count += job->touching[i];
        job->touch_points += job->touching[i] && corners_stay(&job->refine) ? job->snapped.curves[i].count : 0;
    }
    return status;
}

/// Check the given curves, join their points and lines, and cut them into arcs.
static bat_status prepare(map_job *job, const map_chart *chart, const bat_curve_map_refine_options *options,
                          bat_error *error)
{
    double tolerance = options->snap_tolerance;
    bat_status status = for_each_curve(job, check_curve, error);
    if (status == BAT_OK && chart != NULL)
        status = snapped_curves_make(job->curves, job->count, chart, tolerance, job->refine.threads, &job->snapped, error);
    if (status != BAT_OK)
        return status;
    if (job->snapped.curves != NULL)
    {
        if (tolerance == 0)
            status = find_all_touching(job, error);
        job->curves = job->snapped.curves;
    }
    if (status != BAT_OK)
        return status;
    job->report.snapped = job->snapped.moved + job->snapped.added;
    job->report.spikes = job->snapped.spikes;
    job->report.largest_snap = job->snapped.largest;
    if (options->simplify > 0)
    {
        status = simplified_curves_make(job->curves, job->count, options->simplify, chart, job->refine.threads, &job->simple,
                                        error);
        if (status != BAT_OK)
            return status;
        job->curves = job->simple.curves;
        job->report.dropped = job->simple.moved;
    }
    status = join_lines(job, options->join, error);
    if (status == BAT_OK)
        status = find_all_corners(job, error);
    if (status == BAT_OK)
        status = arc_graph_make(job->curves, job->count, job->corners, scheme_keeps_points(&job->refine.scheme), &job->graph,
                                error);
    job->report.arcs = job->graph.arc_count;
    job->report.nodes = job->graph.nodes;
    job->report.shared = job->graph.shared;
    return status;
}

// Curves of arcs

/// The uses of a curve, one after the other, as rows of the refined curve before its rotation.
typedef struct use_rows
{
    const arc_use *use;
    const bat_curve *arc; ///< refined
    size_t row, count;    ///< the first row and the number of rows
} use_rows;

/// The rows of a use. The last point of an open arc belongs to the next use.
static use_rows rows_of_use(const map_job *job, const arc_use *use, size_t row)
{
    const bat_curve *arc = &job->fine.arcs[use->arc];
    return (use_rows){use, arc, row, polygon_edges(arc->count, arc->closed)};
}

/// The point of the arc in row `i` of a use.
static size_t point_in_row(const use_rows *rows, size_t offset, size_t i)
{
    size_t count = rows->arc->count;
    if (!rows->arc->closed)
        return rows->use->reversed ? count - 1 - i : i;
    return rows->use->reversed ? (offset + count - i) % count : (offset + i) % count;
}

/// The row at which a point of a curve lies, when the first use begins at point graph->begins[curve].
static size_t row_of_point(const map_job *job, size_t curve, size_t point)
{
    const arc_graph *graph = &job->graph;
    size_t begin = graph->begins[curve], count = job->curves[curve].count, row = 0;
    size_t left = point >= begin ? point - begin : point + count - begin;
    for (size_t u = graph->first_use[curve]; u < graph->first_use[curve + 1] && scheme_keeps_points(&job->refine.scheme);
         u++)
    {
        const arc_use *use = &graph->uses[u];
        const bat_curve *arc = &graph->arcs[use->arc];
        size_t edges = polygon_edges(arc->count, arc->closed);
        use_rows rows = rows_of_use(job, use, row);
        if (left < edges && use->reversed)
            return row + rows.count - refined_arcs_row(&job->fine, graph, use->arc, edges - left);
        if (left < edges)
            return row + refined_arcs_row(&job->fine, graph, use->arc, left);
        left -= edges;
        row += rows.count;
    }
    return job->curves[curve].closed || point == 0 ? 0 : row;
}

/// Refine the channels of a curve over one use, in the direction of the arc, so that the points are the arc's.
static bat_status refine_channels(const map_job *job, size_t curve, size_t begin, const arc_use *use, bat_curve *fine,
                                  bat_error *error)
{
    const bat_curve *given = &job->curves[curve], *arc = &job->graph.arcs[use->arc];
    size_t channels = given->channel_count, row = channels * sizeof(double);
    bat_curve slice = *arc;
    slice.channel_count = channels;
    if (array_make(&slice.channels, arc->count, row, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t i = 0; i < arc->count; i++)
    {
        size_t step = arc->closed ? (use->reversed ? use->offset + arc->count - i : i + arc->count - use->offset)
                                  : (use->reversed ? arc->count - 1 - i : i);
        memcpy(slice.channels + i * channels, given->channels + (begin + step) % given->count * channels, row);
    }
    bat_curve_refine_options how = job->refine;
    how.simple = BAT_CURVE_SIMPLE_NEVER;
    how.corner_angle = 0;
    how.find_corners = false;
    how.progress = (bat_progress){0};
    how.threads = 1;
    how.report = NULL;
    const unsigned char *joints = arc_joints(&job->graph, job->chains.joints, use->arc);
    bat_status status = pieces_refine(&slice, &how, joints, NULL, fine, NULL, error);
    free(slice.channels);
    return status;
}

/// The row of a curve of `count` rows when row `first` becomes row 0.
static size_t turned_row(size_t row, size_t first, size_t count)
{
    return row >= first ? row - first : row + count - first;
}

/// Copy the points and channels of one use to their rows of a curve, whose row `first` is row 0 of the result.
static bat_status copy_use(const map_job *job, size_t curve, size_t begin, const use_rows *rows, size_t first,
                           bat_curve *result, bat_error *error)
{
    const arc_use *use = rows->use;
    size_t dim = result->space->point_dim, channels = result->channel_count;
    size_t offset = rows->arc->closed ? refined_arcs_row(&job->fine, &job->graph, use->arc, use->offset) : 0;
    bat_curve with_channels = {.space = result->space};
    bat_status status = channels > 0 ? refine_channels(job, curve, begin, use, &with_channels, error) : BAT_OK;
    bool last = !result->closed && rows->row + rows->count + 1 == result->count; // an open curve has a last point
    for (size_t i = 0; i < rows->count + last && status == BAT_OK; i++)
    {
        size_t to = turned_row(rows->row + i, first, result->count), from = point_in_row(rows, offset, i);
        memcpy(result->points + to * dim, rows->arc->points + from * dim, dim * sizeof(double));
        if (channels > 0)
            memcpy(result->channels + to * channels, with_channels.channels + from * channels, channels * sizeof(double));
    }
    if (status == BAT_OK && job->corners != NULL)
        result->corners[turned_row(rows->row, first, result->count)] = job->corners[curve][begin];
    bat_curve_free(&with_channels);
    return status;
}

/// Put a refined curve together from its arcs.
static bat_status assemble_curve(map_job *job, size_t curve, bat_error *error)
{
    const arc_graph *graph = &job->graph;
    const bat_curve *given = &job->curves[curve];
    bat_curve *result = &job->result[curve];
    size_t count = !given->closed;
    for (size_t u = graph->first_use[curve]; u < graph->first_use[curve + 1]; u++)
        count += rows_of_use(job, &graph->uses[u], 0).count;
    bat_status status = curve_room(given, count, job->corners != NULL, result, error);
    if (status != BAT_OK)
        return status;
    size_t first = row_of_point(job, curve, 0), row = 0, begin = graph->begins[curve];
    for (size_t u = graph->first_use[curve]; u < graph->first_use[curve + 1] && status == BAT_OK; u++)
    {
        const arc_use *use = &graph->uses[u];
        const bat_curve *arc = &graph->arcs[use->arc];
        use_rows rows = rows_of_use(job, use, row);
        status = copy_use(job, curve, begin, &rows, first, result, error);
        row += rows.count;
        begin = (begin + polygon_edges(arc->count, arc->closed)) % given->count;
    }
    if (job->corners != NULL && !given->closed)
        result->corners[result->count - 1] = job->corners[curve][given->count - 1];
    return status;
}

/// Cut the lines out of the chains.
static bat_status cut_line(map_job *job, size_t line, bat_error *error)
{
    chain_member member = job->chains.members[line];
    const bat_curve *chain = &job->curves[member.chain], *given = &job->lines[line];
    const bat_curve *refined = &job->result[member.chain];
    size_t rows[2], end = member.first + given->count - 1;
    for (size_t k = 0; k < 2; k++)
    {
        size_t row = row_of_point(job, member.chain, (k == 0 ? member.first : end) % chain->count);
        rows[k] = chain->closed ? turned_row(row, row_of_point(job, member.chain, 0), refined->count) : row;
    }
    if (!given->closed)
        return line_chains_cut(refined, rows[0], rows[1], member.reversed, &job->cut[line], error);
    job->cut[line] = *refined; // a ring is alone in its chain
    job->result[member.chain] = (bat_curve){.space = refined->space};
    return BAT_OK;
}

/// Give a ring that would touch itself its given points back, where others do not share its edges.
/// @param uses of each arc
static void restore_ring(const map_job *job, size_t ring, const size_t *uses)
{
    const arc_graph *graph = &job->graph;
    size_t curve = job->chains.pairs > 0 ? job->chains.members[ring].chain : ring;
    const arc_use *use = graph->uses + graph->first_use[curve];
    const size_t *origins = job->snapped.origins[ring];
    size_t edges = job->snapped.curves[ring].count, row = 0, kept = 0;
    bat_curve *made = job->cut != NULL ? &job->cut[ring] : &job->result[ring];
    if (graph->first_use[curve + 1] - graph->first_use[curve] != edges)
        return; // the scheme has no corners
    for (size_t i = 0; i < edges; i++)
    {
        bool shared = uses[use[i].arc] > 1, held = shared || uses[use[i > 0 ? i - 1 : edges - 1].arc] > 1;
        size_t rows = rows_of_use(job, &use[i], 0).count;
        if (!held && (i == 0 || origins[i] != origins[i - 1]))
            curve_copy_row(&job->given[ring], origins[i], made, kept++);
        for (size_t k = held ? 0 : 1; k < (shared ? rows : 1); k++)
            curve_copy_row(made, row + k, made, kept++);
        row += rows;
    }
    made->count = kept;
}

static bat_status restore_touching(map_job *job, bat_error *error)
{
    size_t *uses = calloc(job->graph.arc_count + 1, sizeof *uses);
    if (uses == NULL)
        return error_memory(error, job->graph.arc_count * sizeof *uses);
    for (size_t u = 0; u < job->graph.use_count; u++)
        uses[job->graph.uses[u].arc]++;
    for (size_t i = 0; i < job->line_count; i++)
        if (job->touching[i])
            restore_ring(job, i, uses);
    free(uses);
    return BAT_OK;
}

// The whole

/// Say which point of which curve failed, when it was a point of an arc.
static void name_place(const map_job *job, bat_error *error)
{
    if (error == NULL || error->curve >= job->graph.arc_count)
        return;
    arc_origin origin = job->graph.origins[error->curve];
    error->curve = origin.curve;
    if (error->index == BAT_NO_INDEX)
    {
        if (job->chains.pairs > 0)
            line_chains_find(&job->chains, job->lines, job->line_count, &error->curve, &error->index);
        return;
    }
    size_t point = (origin.point + error->index) % job->curves[origin.curve].count;
    if (job->chains.pairs > 0)
        line_chains_find(&job->chains, job->lines, job->line_count, &error->curve, &point);
    point = job->simple.curves != NULL ? job->simple.origins[error->curve][point] : point;
    error->index = job->snapped.curves != NULL ? job->snapped.origins[error->curve][point] : point;
}

/// Smooth the arcs. To keep areas, they move sideways as a whole first, so that the edges need to bulge less afterwards.
static bat_status smooth_arcs(map_job *job, const map_chart *chart, bool tested, bool keep_area, bat_error *error)
{
    bat_status status = arcs_smooth(&job->graph, &job->refine, tested ? chart : NULL, &job->report.curves, error);
    refined_arcs arcs = {.arcs = job->graph.arcs, .count = job->graph.arc_count};
    bat_curve_refine_options moving = job->refine;
    moving.snap = true; // the points of arcs may move
    if (status != BAT_OK || !keep_area || chart == NULL)
        return status;
    status = arcs_keep_area(&job->graph, job->curves, job->count, &moving, chart, tested, &arcs, &job->report, error);
    return status == BAT_UNSUPPORTED ? BAT_OK : status; // what is left to do comes after refinement
}

static bat_status refine_map(map_job *job, const bat_curve_map_refine_options *options, bat_error *error)
{
    static const double ROUNDED = 1.5; // units of the file by which rounding changes a straight line
    const bat_space *space = job->curves[0].space;
    map_chart chart;
    bool has_chart = chart_of_space(space, options->decimals, &chart);
    bool tested = has_chart && job->refine.simple != BAT_CURVE_SIMPLE_NEVER;
    if (job->refine.ends == BAT_CURVE_END_RULE_FREE)
        return ERROR_UNSUPPORTED(error, 0,
                                 "the end rule free leaves gaps between the arcs of a map; refine the curves separately");
    job->straight.edges = has_chart && chart.globe ? options->edges : BAT_CURVE_MAP_EDGES_GEODESIC;
    job->straight.unit = has_chart && chart.globe ? ROUNDED / chart.units_per_degree : 0;
    bat_status status = prepare(job, has_chart ? &chart : NULL, options, error);
    if (status != BAT_OK)
        return status;
    status = stop_resolve(job->curves, job->count, &job->refine, error);
    if (status == BAT_OK && smooth_wanted(&job->refine))
        status = smooth_arcs(job, has_chart ? &chart : NULL, tested, options->keep_area, error);
    job->refine.smooth = 0;
    if (status == BAT_OK)
        status = refined_arcs_make(&job->graph, job->chains.joints, &job->refine, tested ? &chart : NULL,
                                   has_straight_edges(job) ? &job->straight : NULL, &job->report, &job->fine, error);
    if (status != BAT_OK)
    {
        name_place(job, error);
        return status;
    }
    if (options->keep_area)
        status = has_chart ? arcs_keep_area(&job->graph, job->curves, job->count, &job->refine, &chart, tested, &job->fine,
                                            &job->report, error)
                           : ERROR_UNSUPPORTED(error, 0, "there are no areas in this space");
    if (status != BAT_OK)
        return status;
    if (array_zeros(&job->result, job->count, sizeof *job->result, error) != BAT_OK)
        return BAT_NO_MEMORY;
    status = for_each_curve(job, assemble_curve, error);
    if (status == BAT_OK && job->chains.pairs > 0)
    {
        status = array_zeros(&job->cut, job->line_count, sizeof *job->cut, error);
        for (size_t i = 0; i < job->line_count && status == BAT_OK; i++)
            status = cut_line(job, i, error);
    }
    job->report.given_crossing += job->touch_count;
    job->report.curves.corners -= job->touch_points;
    return status == BAT_OK && job->touch_count > 0 ? restore_touching(job, error) : status;
}

static bool is_map(const bat_curve_set *set, const bat_curve_map_refine_options *options)
{
    map_chart chart;
    if (options->topology == BAT_CURVE_MAP_TOPOLOGY_ALWAYS)
        return true;
    return options->topology <= BAT_CURVE_MAP_TOPOLOGY_FEATURES && bat_curve_set_has_features(set) && set->count > 0 &&
           chart_of_space(set->space, options->decimals, &chart);
}

bat_status bat_curve_map_refine(const bat_curve_set *coarse, const bat_curve_map_refine_options *options,
                                bat_curve_set *fine, bat_error *error)
{
    bat_curve_map_refine_options defaults = bat_curve_map_refine_defaults();
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_curve_map_refine_fields, options, error);
    if (status != BAT_OK)
        return status;
    map_job job = {.curves = coarse->curves, .count = coarse->count, .refine = options->refine};
    job.report.map = is_map(coarse, options);
    if (job.refine.scheme.kind == BAT_CURVE_SCHEME_KIND_AUTO && coarse->count > 0)
        job.refine.scheme = bat_curve_scheme_for(coarse->space, NULL);
    if (job.report.map && coarse->count > 0)
        status = refine_map(&job, options, error);
    else
    {
        job.refine.report = &job.report.curves;
        status = array_zeros(&job.result, job.count, sizeof *job.result, error);
        if (status == BAT_OK)
            status = bat_curves_refine(job.curves, job.count, &job.refine, job.result, error);
    }
    if (status == BAT_OK)
        status = bat_curve_set_like(coarse, job.cut != NULL ? job.cut : job.result, fine, error);
    if (status == BAT_OK)
    {
        *(job.cut != NULL ? &job.cut : &job.result) = NULL;
        if (options->report != NULL)
            *options->report = job.report;
    }
    for (size_t i = 0; i < job.count && job.corners != NULL; i++)
        free(job.corners[i]);
    free(job.corners);
    curves_free(job.result, job.count);
    curves_free(job.cut, job.line_count);
    free(job.touching);
    line_chains_free(&job.chains);
    arc_graph_free(&job.graph);
    snapped_curves_free(&job.simple);
    snapped_curves_free(&job.snapped);
    refined_arcs_free(&job.fine);
    return status;
}
