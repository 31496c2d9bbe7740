#include "curve/pieces.h"

#include "base/memory.h"
#include "base/progress.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "batten/curve_measure.h"
#include "space/builtin.h"

#include <limits.h>
#include <string.h>

enum
{
    /// The most levels of an edge that are tested together: more would compute points that are not wanted.
    MAX_TESTED = 6,
    /// Points of the deepest level that are in memory at a time, for each thread.
    WINDOW = 1 << 13,
    /// Points that one item of work computes, where edges have fewer.
    ITEM_POINTS = 1 << 12,
    /// What beginning a run costs, in points, beside those of its support.
    RUN_COST = 32,
    UNDECIDED = 255,
    FAILED = 254
};
_Static_assert(WINDOW >= 1 << (MAX_TESTED + STOP_LOOKAHEAD), "a window holds whole pieces of every level under test");

/// Readers of maps draw lines that are straight in longitude and latitude. At 70 degrees of latitude they are at most this
/// many times the square of a geodesic's length away from it.
static const double SPHERE_SAGITTA = 0.35;

/// Deviations of later levels decay at most and at least by these ratios.
static const double MIN_RATIO = 0.25, MAX_RATIO = 0.75;

bat_status stop_check(const bat_curve_refine_options *options, bat_error *error)
{
    const bat_curve_scheme *scheme = &options->scheme;
    const char *fault = NULL;
    bool keeps = scheme_keeps_points(scheme);
    bool odd = mask_trimmed(&scheme->mask).count % 2 == 1 && mask_is_symmetric(&scheme->mask);
    if (scheme_needs_whole_polygons(scheme))
        fault = "a rule that uses the whole polygon of each level; give a number of levels instead";
    else if (!scheme_goes_by_levels(scheme))
        fault = "a spline, which has no levels; choose a scheme that keeps the points, such as "
                "four-point:parameters=centripetal, or give a number of levels";
    else if (options->ends == BAT_CURVE_END_RULE_FREE)
        fault = "free ends; choose another rule for the ends";
    else if (!keeps && !scheme_kind_of(scheme)->linear)
        fault = "a scheme that moves points; choose one that keeps them, such as log-exp-4, or give a number of levels";
    else if (!keeps && !(odd && options->snap))
        fault = odd ? "a scheme that moves points, unless they are moved onto its limit curve (snap)"
                    : "a scheme that moves points, unless its mask is symmetric and of odd length; choose another, such as "
                      "lane-riesenfeld:order=3, and move points onto its limit curve (snap)";
    return fault == NULL ? BAT_OK : ERROR_UNSUPPORTED(error, 0, "max_edge and tolerance do not go with %s", fault);
}

bat_status curves_median_edge(const bat_curve *curves, size_t count, double *median, bat_error *error)
{
    size_t total = 0, edges = 0;
    for (size_t i = 0; i < count; i++)
        total += curves[i].count;
    double *lengths = memory_array(total + 1, sizeof *lengths);
    if (lengths == NULL)
        return error_memory(error, total * sizeof *lengths);
    for (size_t i = 0; i < count; i++)
    {
        bat_curve_edge_lengths(&curves[i], lengths + edges);
        edges += polygon_edges(curves[i].count, curves[i].closed);
    }
    bat_curve_summary summary = {0};
    bat_status status = edges > 0 ? bat_curve_summarize(lengths, edges, &summary, error) : BAT_OK;
    *median = summary.median;
    free(lengths);
    return status;
}

bat_status stop_resolve(const bat_curve *curves, size_t count, bat_curve_refine_options *options, bat_error *error)
{
    double share = options->relative_tolerance, median = 0;
    if (!(share > 0) || options->tolerance > 0)
        return BAT_OK;
    options->relative_tolerance = 0;
    if (count == 0 || stop_check(options, NULL) != BAT_OK)
        return BAT_OK;
    bat_status status = curves_median_edge(curves, count, &median, error);
    if (status != BAT_OK || !(median > 0))
        return status;
    options->relative_tolerance = share;
    options->tolerance = share * median;
    if (space_is_sphere(curves->space) && options->max_edge == 0)
        options->max_edge = sqrt(options->tolerance / SPHERE_SAGITTA);
    return BAT_OK;
}

size_t stop_deepest(const bat_curve_refine_options *options, size_t edges)
{
    const size_t bits = CHAR_BIT * sizeof(size_t) - 1;
    size_t deepest = options->max_levels + STOP_LOOKAHEAD;
    deepest = deepest < bits ? deepest : bits;
    while (deepest > 0 && edges > (size_t)(PTRDIFF_MAX / 16) >> deepest)
        deepest--;
    return deepest;
}

/// The smallest k with length / 2^k <= limit.
static size_t halvings(double length, double limit)
{
    size_t k = 0;
    while (length > limit && k < 2 * STOP_MOST_LEVELS)
    {
        length /= 2;
        k++;
    }
    return k;
}

size_t stop_levels_of_geodesic(const bat_curve_refine_options *options, double length)
{
    size_t levels = options->max_edge > 0 ? halvings(length, options->max_edge) : 0;
    return levels <= options->max_levels ? levels : SIZE_MAX;
}

/// The levels of one edge that are tested next.
typedef struct tested
{
    unsigned char from, to;
} tested;

/// The search for the levels of a polygon's edges.
typedef struct level_search
{
    const refine_source *source;
    const bat_curve_refine_options *options;
    edge_geometry geometry;
    size_t lookahead; ///< 0 where only lengths count
    size_t most;      ///< levels of an edge
    tested *tests;    ///< for each edge: what is tested in this round,
    tested *next;     ///< and in the next one
    unsigned char *levels;
} level_search;

/// What the points of an edge at one level say, as maxima over its pieces.
typedef struct piece_maxima
{
    double length;    ///< of a piece
    double first;     ///< distance of the points of the next level from the pieces
    double second;    ///< of the points of the level after it from the pieces of the next level
    double deviation; ///< of both from the pieces
} piece_maxima;

/// fmax() that keeps NaN.
static double larger(double a, double b)
{
    return isnan(b) || b > a ? b : a;
}

/// One piece with `stride` points of the deepest level to its end.
static void measure_piece(const level_search *search, const double *points, size_t stride, piece_maxima *maxima)
{
    const bat_curve_refine_options *options = search->options;
    const bat_space *space = search->source->space;
    edge_geometry geometry = search->geometry;
    size_t dim = space->point_dim;
    const double *end = points + stride * dim;
    if (options->max_edge > 0)
        maxima->length = larger(maxima->length, space->distance(space, points, end));
    if (!(options->tolerance > 0))
        return;
    size_t quarter = stride / 4 * dim;
    const double *middle = points + 2 * quarter;
    double at_middle = polygon_edge_distance(space, geometry, points, end, middle);
    maxima->first = larger(maxima->first, at_middle);
    maxima->deviation = larger(maxima->deviation, at_middle);
    for (size_t half = 0; half < 2; half++)
    {
        const double *begin = points + 2 * half * quarter;
        const double *new_point = begin + quarter;
        maxima->second =
            larger(maxima->second, polygon_edge_distance(space, geometry, begin, begin + 2 * quarter, new_point));
        maxima->deviation = larger(maxima->deviation, polygon_edge_distance(space, geometry, points, end, new_point));
    }
}

/// The estimate of stop_levels().
static double limit_distance(const piece_maxima *maxima)
{
    if (!(maxima->second > 0))
        return maxima->deviation;
    double ratio = fmin(fmax(maxima->second / maxima->first, MIN_RATIO), MAX_RATIO);
    return maxima->deviation + maxima->second * ratio / (1 - ratio);
}

/// Edges from which the same level is wanted, or the same levels are under test, and others between them.
typedef struct edge_run
{
    size_t edge, count;
} edge_run;

/// The last run of each level during collection.
typedef struct run_list
{
    edge_run *runs;
    size_t count;
    size_t open[STOP_MOST_LEVELS + STOP_LOOKAHEAD + 1]; ///< its index and one; 0 for none
} run_list;

/// Add an edge to the last run of its level, or begin another. Edges between cost less than another run's support.
static void run_list_add(run_list *list, const refine_kernel *kernel, size_t edge, size_t level, bool joins)
{
    size_t support = (size_t)(kernel->last - kernel->first);
    size_t gap = (support * level + RUN_COST) >> level;
    edge_run *last = list->open[level] > 0 ? &list->runs[list->open[level] - 1] : NULL;
    if (joins && last != NULL && edge <= last->edge + last->count + gap &&
        edge + 1 - last->edge <= (size_t)ITEM_POINTS >> level)
    {
        last->count = edge + 1 - last->edge;
        return;
    }
    list->runs[list->count++] = (edge_run){edge, 1};
    list->open[level] = list->count;
}

static void advance(level_search *search, size_t edge, const piece_maxima *last)
{
    const bat_curve_refine_options *options = search->options;
    const tested *test = &search->tests[edge];
    size_t more = 1;
    if (options->max_edge > 0 && isfinite(last->length))
        more = halvings(last->length, options->max_edge);
    if (options->tolerance > 0 && isfinite(last->deviation))
    {
        size_t halved = (halvings(limit_distance(last), options->tolerance) + 1) / 2; // a level divides it by four
        more = halved > more ? halved : more;
    }
    more = more < 1 ? 1 : more > MAX_TESTED ? MAX_TESTED : more;
    size_t to = test->to + more;
    search->next[edge] = (tested){(unsigned char)(test->to + 1), (unsigned char)(to > search->most ? search->most : to)};
}

/// Decide an edge, or choose what to test next.
static bat_status decide(level_search *search, size_t edge, const piece_maxima *maxima, bat_error *error)
{
    const bat_curve_refine_options *options = search->options;
    const tested test = search->tests[edge];
    for (size_t level = test.from; level <= test.to; level++)
    {
        const piece_maxima *at = &maxima[level - test.from];
        double distance = options->tolerance > 0 ? limit_distance(at) : 0;
        if (!isfinite(at->length) || !isfinite(distance))
            return error_point(error, BAT_INVALID_POINT, edge, "new points after point", " are too large for doubles");
        if (options->max_edge > 0 && !(at->length <= options->max_edge))
            continue;
        if (options->tolerance > 0 && !(distance <= options->tolerance))
            continue;
        search->levels[edge] = (unsigned char)level;
        return BAT_OK;
    }
    if (test.to >= search->most)
        search->levels[edge] = FAILED;
    else
        advance(search, edge, &maxima[test.to - test.from]);
    return BAT_OK;
}

/// Whether an edge is undecided and has these levels under test. Edges of other runs have others, and may be decided now.
static bool is_tested(const level_search *search, size_t edge, tested test)
{
    return search->tests[edge].from == test.from && search->tests[edge].to == test.to && search->levels[edge] == UNDECIDED;
}

/// Measure and decide the edges of a run, a window of points at a time.
static bat_status decide_run(level_search *search, edge_run run, int threads, double *points, piece_maxima *maxima,
                             bat_error *error)
{
    const bat_space *space = search->source->space;
    const tested test = search->tests[run.edge];
    size_t deepest = test.to + search->lookahead, tests = (size_t)(test.to - test.from) + 1;
    size_t total = run.count << deepest, dim = space->point_dim;
    memset(maxima, 0, run.count * tests * sizeof *maxima);
    for (size_t begin = 0; begin < total; begin += WINDOW)
    {
        size_t count = total - begin < WINDOW ? total - begin : WINDOW;
        bat_status status = refine_source_run(search->source, deepest, run.edge, begin, count + 1, threads, points, error);
        if (status != BAT_OK)
            return status;
        for (size_t level = test.from; level <= test.to; level++)
        {
            size_t stride = (size_t)1 << (deepest - level);
            for (size_t i = 0; i < count; i += stride)
            {
                size_t edge = (begin + i) >> deepest;
                if (is_tested(search, run.edge + edge, test))
                    measure_piece(search, points + i * dim, stride, &maxima[edge * tests + level - test.from]);
            }
        }
    }
    for (size_t i = 0; i < run.count; i++)
    {
        if (!is_tested(search, run.edge + i, test))
            continue;
        bat_status status = decide(search, run.edge + i, maxima + i * tests, error);
        if (status != BAT_OK)
            return status;
    }
    return BAT_OK;
}

/// The undecided edges as runs of equal tests, of at most ITEM_POINTS points or one edge each. Returns their number.
static size_t collect_runs(const level_search *search, size_t edges, edge_run *runs)
{
    run_list list = {.runs = runs};
    for (size_t i = 0; i < edges; i++)
    {
        if (search->levels[i] != UNDECIDED)
            continue;
        const tested test = search->tests[i];
        size_t level = test.to + search->lookahead, last = list.open[level];
        bool joins = last > 0 && search->tests[runs[last - 1].edge].from == test.from;
        run_list_add(&list, &search->source->task.kernel, i, level, joins);
    }
    return list.count;
}

bat_status stop_needs_more(size_t edge, size_t most, bat_error *error)
{
    (void)error_point(error, BAT_TOO_LARGE, edge, "the edge after point", " needs more than the %zu levels allowed", most);
    return error_remedy(error, BAT_TOO_LARGE, "max_levels", "allows more");
}

/// The first edge that needs too many levels is at fault. The levels that edges have, or have at least, bound the work of
/// the next round by the allowed points.
static bat_status find_failure(const level_search *search, size_t edges, bat_error *error)
{
    double least = 0;
    for (size_t i = 0; i < edges; i++)
    {
        if (search->levels[i] == FAILED)
            return stop_needs_more(i, search->most, error);
        least += ldexp(1, search->levels[i] == UNDECIDED ? search->tests[i].from : search->levels[i]);
    }
    if (least <= (double)search->options->max_points)
        return BAT_OK;
    return ERROR_TOO_LARGE(error, "the refined curve has more than %zu points", search->options->max_points);
}

/// One round: all undecided edges are decided or move on.
static bat_status decide_round(level_search *search, const edge_run *runs, size_t count, int threads, bat_progress progress,
                               bat_error *error)
{
    size_t dim = search->source->task.kernel.dim;
    shared_work work = shared_work_make(count, progress);
    int team = threads_for(threads, count), inner = count < (size_t)threads_for(threads, SIZE_MAX) ? threads : 1;
    team = inner == 1 ? team : 1;
#pragma omp parallel num_threads(team) if (team > 1)
    {
        double *points = memory_array(WINDOW + 1, dim * sizeof *points);
        piece_maxima *maxima = memory_array(ITEM_POINTS * (MAX_TESTED + 1), sizeof *maxima);
#pragma omp for schedule(dynamic)
        for (size_t i = 0; i < count; i++)
        {
            if (!shared_work_wants(&work, i))
                continue;
            bat_error own;
            bat_status status = points != NULL && maxima != NULL ? decide_run(search, runs[i], inner, points, maxima, &own)
                                                                 : error_memory(&own, WINDOW * dim * sizeof *points);
            shared_work_finish(&work, i, status, &own);
        }
        free(points);
        free(maxima);
    }
    return shared_work_end(&work, error);
}

/// What to test first. An edge cannot have fewer levels than its chord, if its points stay.
static bat_status begin_search(level_search *search, bool keeps_points, size_t edges, bat_error *error)
{
    const bat_curve_refine_options *options = search->options;
    const refine_source *source = search->source;
    const bat_space *space = source->space;
    for (size_t i = 0; i < edges; i++)
    {
        const double *p = refine_source_vertex(source, i), *q = refine_source_vertex(source, i + 1);
        size_t from = 0;
        if (keeps_points && options->max_edge > 0)
            from = halvings(space->distance(space, p, q) * (1 - 1e-12), options->max_edge);
        size_t to = from + (search->lookahead > 0 && from < search->most);
        search->tests[i] = search->next[i] = (tested){(unsigned char)from, (unsigned char)to};
        search->levels[i] = from <= search->most ? UNDECIDED : FAILED;
    }
    return find_failure(search, edges, error);
}

bat_status stop_levels(const refine_source *source, const bat_curve_refine_options *options, bool keeps_points, size_t edges,
                       size_t deepest, int threads, bat_progress progress, unsigned char *levels, bat_error *error)
{
    memory_pool pool = {0};
    level_search search = {.source = source,
                           .options = options,
                           .geometry = polygon_geometry_of(source->space),
                           .lookahead = options->tolerance > 0 ? STOP_LOOKAHEAD : 0,
                           .most = deepest > STOP_LOOKAHEAD ? deepest - STOP_LOOKAHEAD : 0,
                           .tests = memory_pool_array(&pool, edges, sizeof *search.tests),
                           .next = memory_pool_array(&pool, edges, sizeof *search.next),
                           .levels = levels};
    edge_run *runs = memory_pool_array(&pool, edges, sizeof *runs);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        status = begin_search(&search, keeps_points, edges, error);
    double done = 0;
    while (status == BAT_OK)
    {
        size_t count = collect_runs(&search, edges, runs);
        if (count == 0)
            break;
        progress_part part = {progress, done, (1 - done) / 2}; // a round is about half of what is left
        done += part.length;
        status = decide_round(&search, runs, count, threads, progress_of_part(&part), error);
        memcpy(search.tests, search.next, edges * sizeof *search.tests);
        if (status == BAT_OK)
            status = find_failure(&search, edges, error);
    }
    memory_pool_free(&pool);
    return status;
}

/// Compute the points of a run. Where edges of other levels lie between, they go by way of `scratch`, ITEM_POINTS + 1 rows.
static bat_status run_edges(const refine_source *source, const unsigned char *levels, const size_t *rows, edge_run run,
                            bool with_end, int threads, double *scratch, double *fine, bat_error *error)
{
    size_t level = levels[run.edge], dim = source->task.kernel.dim, points = (size_t)1 << level;
    bool alike = true;
    for (size_t i = 0; i < run.count; i++)
        alike = alike && levels[run.edge + i] == level;
    double *to = alike ? fine + rows[run.edge] * dim : scratch;
    bat_status status = refine_source_run(source, level, run.edge, 0, run.count * points + with_end, threads, to, error);
    for (size_t i = 0; i < run.count && !alike && status == BAT_OK; i++)
        if (levels[run.edge + i] == level)
            memcpy(fine + rows[run.edge + i] * dim, scratch + i * points * dim,
                   (points + (with_end && i + 1 == run.count)) * dim * sizeof *fine);
    return status;
}

bat_status stop_run(const refine_source *source, const unsigned char *levels, size_t edges, bool with_end, int threads,
                    bat_progress progress, double *fine, bat_error *error)
{
    memory_pool pool = {0};
    edge_run *runs = memory_pool_array(&pool, edges, sizeof *runs);
    size_t *rows = memory_pool_array(&pool, edges, sizeof *rows), dim = source->task.kernel.dim, row = 0;
    bat_status made = memory_pool_check(&pool, error);
    run_list list = {.runs = runs};
    for (size_t i = 0; i < edges && made == BAT_OK; i++)
    {
        rows[i] = row;
        row += (size_t)1 << levels[i];
        run_list_add(&list, &source->task.kernel, i, levels[i], true);
    }
    shared_work work = shared_work_make(list.count, progress);
    int team = threads_for(threads, list.count), inner = list.count < (size_t)threads_for(threads, SIZE_MAX) ? threads : 1;
    team = inner == 1 ? team : 1;
#pragma omp parallel num_threads(team) if (team > 1)
    {
        double *scratch = memory_array(ITEM_POINTS + 1, dim * sizeof *scratch);
#pragma omp for schedule(dynamic)
        for (size_t i = 0; i < list.count; i++)
        {
            if (!shared_work_wants(&work, i))
                continue;
            bat_error own;
            bool end = with_end && runs[i].edge + runs[i].count == edges;
            bat_status status = scratch != NULL ? run_edges(source, levels, rows, runs[i], end, inner, scratch, fine, &own)
                                                : error_memory(&own, ITEM_POINTS * dim * sizeof *scratch);
            shared_work_finish(&work, i, status, &own);
        }
        free(scratch);
    }
    memory_pool_free(&pool);
    return made == BAT_OK ? shared_work_end(&work, error) : made;
}
