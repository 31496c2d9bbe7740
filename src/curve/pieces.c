#include "curve/pieces.h"

#include "base/memory.h"
#include "base/progress.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/corner.h"
#include "curve/parametric.h"
#include "curve/topology/draw_back.h"

#include <limits.h>
#include <string.h>

/// From this many pieces a thread on, each thread refines whole pieces; of fewer, the threads share each one's points.
static const size_t MANY = 4;

/// At a joint of lines, which may be drawn apart, a reader sees a turn of more than 3 degrees; a sharp turn becomes a fifth.
static const double JOINT_TURN = 0.0523598775598299, JOINT_SHARE = 0.2;

#define JOINT_LEVELS 6 ///< the most for the sake of a joint

/// A run of edges between two corners, or between ends, or a whole closed curve.
typedef struct piece
{
    size_t edge;  ///< the first, from `first` of the curve on
    size_t edges; ///< how many
    bool closed;  ///< the whole curve, without corners
    bool straight;
    bool cut[2];          ///< whether it begins and ends at a corner
    refine_plan plan;     ///< without stops, of a piece that is not straight
    size_t row;           ///< its first row, from the first corner on
    size_t count;         ///< its rows, that of its end included
    refine_source source; ///< of its points, from the search for levels to the refinement; without buffer: none
} piece;

/// How a curve is refined.
typedef struct pieces
{
    refine_plan plan; ///< of the whole curve; its options and its stencil hold for every piece
    bat_curve coarse; ///< the points from vertex `first` on; of a closed curve with corners, that vertex again at the end
    bool owned;       ///< `coarse` is a copy
    bool stops;
    bool keeps_points;
    size_t vertices, first, edges;
    unsigned char *corners;      ///< flags of the given vertices
    const unsigned char *joints; ///< pieces_refine()
    size_t corner_count;
    piece *list;
    size_t count;
    unsigned char *levels; ///< of each edge, from `first` on
    size_t rows;           ///< of the refined curve
    size_t before;         ///< rows from `first` to vertex 0
    int threads;           ///< for a piece
    int team;              ///< threads that share the pieces
} pieces;

static void pieces_free(pieces *all)
{
    for (size_t i = 0; i < all->count; i++)
        refine_source_free(&all->list[i].source);
    free(all->corners);
    free(all->list);
    free(all->levels);
    if (all->owned)
        bat_curve_free(&all->coarse);
}

/// The vertex of the given curve that begins an edge counted from `first` on.
static size_t vertex_of(const pieces *all, size_t edge)
{
    return (all->first + edge) % all->vertices;
}

/// The piece as a curve of its own.
static bat_curve curve_of(const pieces *all, const piece *part)
{
    bat_curve curve = all->coarse;
    curve.points += part->edge * curve.space->point_dim;
    if (curve.channel_count > 0)
        curve.channels += part->edge * curve.channel_count;
    curve.count = part->edges + !part->closed;
    curve.closed = part->closed;
    curve.corners = NULL;
    return curve;
}

/// The points from the first corner on, round to it again.
static bat_status turn(pieces *all, const bat_curve *coarse, bat_error *error)
{
    bat_status status = curve_room(coarse, coarse->count + 1, false, &all->coarse, error);
    all->coarse.closed = false;
    all->owned = true;
    for (size_t i = 0; i <= coarse->count && status == BAT_OK; i++)
        curve_copy_row(coarse, vertex_of(all, i), &all->coarse, i);
    return status;
}

/// Cut the curve: the pieces with their edges.
static bat_status cut(pieces *all, const bat_curve *coarse, bat_error *error)
{
    bool turned = coarse->closed && all->corner_count > 0;
    while (turned && all->corners[all->first] == 0)
        all->first++;
    bat_status status = turned ? turn(all, coarse, error) : BAT_OK;
    if (status != BAT_OK)
        return status;
    if (array_make(&all->list, all->corner_count + 1, sizeof *all->list, error) != BAT_OK)
        return BAT_NO_MEMORY;
    bool whole = coarse->closed && !turned;
    for (size_t edge = 0; edge < all->edges;)
    {
        piece *part = &all->list[all->count++];
        *part = (piece){.edge = edge, .closed = whole, .cut = {!whole && all->corners[vertex_of(all, edge)] != 0}};
        do
            edge++;
        while (edge < all->edges && (whole || all->corners[vertex_of(all, edge)] == 0));
        part->edges = edge - part->edge;
        part->cut[1] = !whole && all->corners[vertex_of(all, edge)] != 0;
        part->straight = part->edges == 1 && (part->cut[0] || part->cut[1]);
    }
    return BAT_OK;
}

/// Whether the scheme's curves end where their polygon does, or can be made to.
static bat_status check_scheme(const pieces *all, bat_error *error)
{
    const bat_curve_refine_options *options = &all->plan.options;
    bool is_cut = all->count > 1 || all->list[0].cut[0] || all->list[0].cut[1];
    if (is_cut && options->ends == BAT_CURVE_END_RULE_FREE)
        return ERROR_UNSUPPORTED(error, 0, "corners do not go with free ends; choose another rule");
    if (is_cut && !corners_stay(options))
        return ERROR_UNSUPPORTED(
            error, 0, "corners stay only by a scheme that keeps its points, or by a symmetric mask with ends by reflection");
    return all->stops ? stop_check(&all->plan.options, error) : BAT_OK;
}

typedef bat_status piece_work(pieces *all, piece *part, void *context, bat_progress progress, bat_error *error);

/// Work on piece i.
static void for_piece(pieces *all, size_t i, piece_work *work_on, void *context, bat_progress progress, shared_work *work)
{
    if (!shared_work_wants(work, i))
        return;
    bat_error own = {.index = BAT_NO_INDEX};
    progress_part part = {progress, (double)i / (double)all->count, 1 / (double)all->count};
    bat_progress inner = all->team > 1 ? (bat_progress){0} : progress_of_part(&part);
    bat_status status = work_on(all, &all->list[i], context, inner, &own);
    if (status != BAT_OK && own.index != BAT_NO_INDEX)
        error_renumber(&own, vertex_of(all, all->list[i].edge + own.index));
    shared_work_finish(work, i, status, &own);
}

/// Work on all pieces. Threads share the pieces, or each of them.
static bat_status for_each(pieces *all, piece_work *work_on, void *context, bat_progress progress, bat_error *error)
{
    shared_work work = shared_work_make(all->count, all->team > 1 ? progress : (bat_progress){0});
    if (all->team == 1)
        for (size_t i = 0; i < all->count; i++)
            for_piece(all, i, work_on, context, progress, &work);
    else
    {
#pragma omp parallel for schedule(dynamic) num_threads(all->team)
        for (size_t i = 0; i < all->count; i++)
            for_piece(all, i, work_on, context, progress, &work);
    }
    return shared_work_end(&work, error);
}

/// The least levels of the edges before and after a joint at which the curve turns by no more than JOINT_TURN there, or by
/// JOINT_SHARE of the given turn.
static bat_status smooth_joint(const refine_source *source, size_t before, size_t after, unsigned char *levels,
                               bat_error *error)
{
    const bat_space *space = source->space;
    unsigned char level = levels[before] > levels[after] ? levels[before] : levels[after];
    double last[BAT_SPACE_MAX_DIM], next[BAT_SPACE_MAX_DIM];
    const double *joint = refine_source_vertex(source, after);
    double given =
        space->exterior_angle(space, refine_source_vertex(source, before), joint, refine_source_vertex(source, after + 1));
    double limit = fmax(JOINT_TURN, JOINT_SHARE * fabs(given));
    bat_status status = BAT_OK;
    for (; level < JOINT_LEVELS && status == BAT_OK; level++)
    {
        status = refine_source_run(source, level, before, ((size_t)1 << level) - 1, 1, 1, last, error);
        if (status == BAT_OK)
            status = refine_source_run(source, level, after, 1, 1, 1, next, error);
        if (status != BAT_OK || fabs(space->exterior_angle(space, last, joint, next)) <= limit)
            break;
    }
    levels[before] = levels[before] < level ? level : levels[before];
    levels[after] = levels[after] < level ? level : levels[after];
    return status;
}

static bat_status smooth_joints(const pieces *all, const piece *part, bat_error *error)
{
    bat_status status = BAT_OK;
    size_t most = all->plan.options.max_levels;
    bool wanted = all->joints != NULL && part->source.space->exterior_angle != NULL && most >= JOINT_LEVELS;
    for (size_t e = !part->closed; wanted && e < part->edges && status == BAT_OK; e++)
        if (all->joints[vertex_of(all, part->edge + e)] != 0)
            status = smooth_joint(&part->source, (e > 0 ? e : part->edges) - 1, e, all->levels + part->edge, error);
    return status;
}

/// Find the levels of a piece's edges.
static bat_status choose_levels(pieces *all, piece *part, void *context BAT_UNUSED, bat_progress progress, bat_error *error)
{
    const bat_curve_refine_options *options = &all->plan.options;
    bat_curve curve = curve_of(all, part);
    unsigned char *levels = all->levels + part->edge;
    if (part->edges == 1 && !part->closed && options->relative_tolerance > 0)
    {
        part->straight = true;
        levels[0] = 0;
        return BAT_OK;
    }
    if (part->straight)
    {
        double length = curve.space->distance(curve.space, curve.points, curve.points + curve.space->point_dim);
        size_t needed = stop_levels_of_geodesic(options, length);
        levels[0] = (unsigned char)needed;
        return needed != SIZE_MAX ? BAT_OK : stop_needs_more(0, options->max_levels, error);
    }
    size_t deepest = stop_deepest(options, part->edges);
    refine_kernel kernel = scheme_kernel(curve.space, &options->scheme);
    bat_status status = refine_source_make(curve.space, curve.points, &curve, &options->scheme, &kernel, &all->plan, deepest,
                                           &part->source, error);
    if (status != BAT_OK)
        return status;
    status =
        stop_levels(&part->source, options, all->keeps_points, part->edges, deepest, all->threads, progress, levels, error);
    return status == BAT_OK ? smooth_joints(all, part, error) : status;
}

/// Plan a piece of the same levels everywhere.
static bat_status plan_piece(pieces *all, piece *part, void *context BAT_UNUSED, bat_progress progress BAT_UNUSED,
                             bat_error *error)
{
    if (part->straight)
        return BAT_OK;
    part->plan = all->plan;
    part->plan.options.threads = all->threads;
    if (all->count == 1 && !all->owned)
        return BAT_OK; // the whole curve
    bat_curve curve = curve_of(all, part);
    bat_curve_refine_options options = part->plan.options;
    return refine_plan_make(&curve, &options, &part->plan, error);
}

/// Count the rows of the pieces, one after the other; a corner that two share counts once.
static bat_status count_rows(pieces *all, bat_error *error)
{
    size_t limit = all->plan.options.max_points, rows = 0;
    for (size_t i = 0; i < all->count; i++)
    {
        piece *part = &all->list[i];
        part->row = rows;
        part->count = !part->closed;
        bool planned = !all->stops && !part->straight;
        for (size_t e = 0; e < part->edges && !planned && part->count <= limit; e++)
        {
            size_t level = all->levels[part->edge + e];
            part->count = level < CHAR_BIT * sizeof(size_t) - 1 ? part->count + ((size_t)1 << level) : SIZE_MAX;
        }
        part->count = planned ? part->plan.count : part->count;
        if (part->count > limit || rows > limit - part->count)
            return ERROR_TOO_LARGE(error, "the refined curve has more than %zu points", limit);
        rows += part->count - !part->closed;
    }
    all->rows = rows + !(all->owned || all->list[0].closed);
    return BAT_OK;
}

/// The row at which an edge of a piece begins, from the piece's first on.
static size_t row_in_piece(const pieces *all, const piece *part, size_t edge)
{
    size_t row = 0;
    if (!all->stops)
    {
        const refine_plan *plan = &part->plan;
        ptrdiff_t at = (ptrdiff_t)(edge << all->plan.options.levels);
        if (!part->straight && plan->options.ends == BAT_CURVE_END_RULE_FREE && !part->closed)
            at -= plan->points.begin;
        at = at < 0 ? 0 : at;
        at += !part->straight && plan->ends_added && edge > 0;
        return (size_t)at < part->count ? (size_t)at : part->count - 1;
    }
    for (size_t e = 0; e < edge; e++)
        row += (size_t)1 << all->levels[part->edge + e];
    return row;
}

/// Everything but the points. `all` is to be freed in any case.
static bat_status pieces_make(const bat_curve *coarse, const bat_curve_refine_options *options, const unsigned char *joints,
                              bat_progress progress, pieces *all, bat_error *error)
{
    bat_curve_refine_options whole = options != NULL ? *options : bat_curve_refine_defaults();
    *all = (pieces){.coarse = *coarse, .vertices = coarse->count, .joints = joints};
    size_t levels = whole.levels;
    whole.levels = stop_wanted(&whole) ? 0 : levels;
    bat_status status = refine_plan_make(coarse, &whole, &all->plan, error);
    if (status == BAT_OK && whole.relative_tolerance > 0 && !(whole.tolerance > 0))
    {
        whole = all->plan.options;
        status = stop_resolve(coarse, 1, &whole, error);
        whole.levels = stop_wanted(&whole) ? 0 : levels;
        status = status == BAT_OK ? refine_plan_make(coarse, &whole, &all->plan, error) : status;
    }
    if (status != BAT_OK)
        return status;
    all->stops = stop_wanted(&whole);
    const bat_curve_scheme *scheme = &all->plan.options.scheme;
    all->keeps_points = scheme_keeps_points(scheme);
    all->edges = polygon_edges(coarse->count, coarse->closed);
    all->corners = memory_array(coarse->count, 1);
    all->levels = memory_array(all->edges, 1);
    if (all->corners == NULL || all->levels == NULL)
        return error_memory(error, coarse->count);
    memset(all->levels, (int)whole.levels, all->edges);
    status = corners_find(coarse, &all->plan.options, all->corners, &all->corner_count, error);
    if (status == BAT_OK)
        status = cut(all, coarse, error);
    if (status == BAT_OK)
        status = check_scheme(all, error);
    int threads = threads_for(all->plan.options.threads, SIZE_MAX);
    bool shared = all->count >= MANY * (size_t)threads;
    all->team = shared ? threads : 1;
    all->threads = shared ? 1 : all->plan.options.threads;
    if (status == BAT_OK)
        status = for_each(all, all->stops ? choose_levels : plan_piece, NULL, progress, error);
    if (status == BAT_OK)
        status = count_rows(all, error);
    if (status == BAT_OK && all->owned && all->first > 0)
    {
        const piece *last = &all->list[all->count - 1];
        all->before = last->row + row_in_piece(all, last, coarse->count - all->first - last->edge);
    }
    return status;
}

/// Evenly spaced points on the geodesic of a piece of one edge.
static bat_status run_straight(const bat_curve *curve, size_t levels, double *points, double *channels, bat_error *error)
{
    const bat_space *space = curve->space;
    size_t last = (size_t)1 << levels, dim = space->point_dim, channel_count = curve->channel_count;
    for (size_t i = 0; i <= last; i++)
    {
        double share = ldexp((double)i, -(int)levels);
        const double *p = curve->points, *u = curve->channels;
        bat_status status = BAT_OK;
        if (i > 0 && i < last)
            status = bat_space_geodesic(space, p, p + dim, share, points + i * dim);
        if (status != BAT_OK)
            return error_point(error, status, 0, "there is no new point after point", " (%s)", bat_status_name(status));
        for (size_t c = 0; channels != NULL && c < channel_count; c++)
            channels[i * channel_count + c] = (1 - share) * u[c] + share * u[channel_count + c];
    }
    return BAT_OK;
}

/// Rows with levels of their own, from a source that is released.
static bat_status run_source(const pieces *all, const piece *part, refine_source *source, bat_progress progress,
                             double *fine, bat_error *error)
{
    size_t dim = source->space->point_dim;
    bat_status status =
        stop_run(source, all->levels + part->edge, part->edges, !part->closed, all->threads, progress, fine, error);
    refine_source_free(source);
    return status != BAT_OK || vector_is_finite(part->count * dim, fine)
               ? status
               : error_set(error, BAT_INVALID_POINT, BAT_NO_INDEX, 0, "new points are too large for doubles");
}

/// The same from rows.
static bat_status run_stopped(const pieces *all, const piece *part, const bat_curve *curve, const bat_space *space,
                              const double *rows, const bat_curve_scheme *scheme, const refine_kernel *kernel,
                              bat_progress progress, double *fine, bat_error *error)
{
    size_t deepest = stop_deepest(&all->plan.options, part->edges);
    refine_source source;
    bat_status status = refine_source_make(space, rows, curve, scheme, kernel, &all->plan, deepest, &source, error);
    return status == BAT_OK ? run_source(all, part, &source, progress, fine, error) : status;
}

/// Points with levels of their own, then channels.
static bat_status run_separate(const pieces *all, piece *part, const bat_curve *curve, bat_progress progress, double *points,
                               double *channels, bat_error *error)
{
    double dim = (double)curve->space->point_dim, share = channels != NULL ? dim / (dim + (double)curve->channel_count) : 1;
    progress_part parts[2] = {{progress, 0, share}, {progress, share, 1 - share}};
    const bat_curve_scheme *scheme = &all->plan.options.scheme;
    bat_status status = run_source(all, part, &part->source, progress_of_part(&parts[0]), points, error);
    if (status != BAT_OK || channels == NULL)
        return status;
    bat_space values = bat_euclidean(curve->channel_count);
    bat_curve_scheme mask = scheme_of_channels(scheme);
    refine_kernel kernel = scheme_kernel(&values, &mask);
    return run_stopped(all, part, curve, &values, curve->channels, &mask, &kernel, progress_of_part(&parts[1]), channels,
                       error);
}

/// The same for the scheme that interpolates channels at the parameters of the points.
static bat_status run_joined(const pieces *all, const piece *part, const bat_curve *curve, bat_progress progress,
                             double *points, double *channels, bat_error *error)
{
    size_t point_dim = curve->space->point_dim, dim = point_dim + curve->channel_count;
    row_space rows;
    memory_pool pool = {0};
    double *joined = memory_pool_array(&pool, curve->count, dim * sizeof *joined),
           *fine = memory_pool_array(&pool, part->count, dim * sizeof *fine);
    bat_status status = row_space_make(curve->space, curve->channel_count, &rows, error);
    if (status == BAT_OK)
        status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        const bat_curve_scheme *scheme = &all->plan.options.scheme;
        refine_kernel kernel = kernel_four_point(curve->space, curve->channel_count, scheme);
        rows_join(curve, curve->channel_count, joined);
        status = run_stopped(all, part, curve, &rows.space, joined, scheme, &kernel, progress, fine, error);
    }
    if (status == BAT_OK)
        rows_split(fine, part->count, point_dim, curve->channel_count, points, channels);
    memory_pool_free(&pool);
    return status;
}

/// Put given rows at the ends of refined ones.
static void keep_ends(const piece *part, const double *rows, size_t dim, double *fine)
{
    memcpy(fine, rows, dim * sizeof *fine);
    memcpy(fine + (part->count - 1) * dim, rows + part->edges * dim, dim * sizeof *fine);
}

/// The points and channels of a piece, part->count rows.
static bat_status run_rows(const pieces *all, piece *part, bat_progress progress, double *points, double *channels,
                           bat_error *error)
{
    bat_curve curve = curve_of(all, part);
    const bat_space *space = curve.space;
    bool has_channels = channels != NULL && curve.channel_count > 0;
    bat_status status = BAT_OK;
    if (part->straight)
        status = run_straight(&curve, all->levels[part->edge], points, has_channels ? channels : NULL, error);
    else if (all->stops && has_channels && scheme_kind_of(&all->plan.options.scheme)->beside_channels)
        status = run_joined(all, part, &curve, progress, points, channels, error);
    else if (all->stops)
        status = run_separate(all, part, &curve, progress, points, has_channels ? channels : NULL, error);
    else
    {
        refine_plan plan = part->plan;
        plan.options.progress = progress;
        status = refine_carry_out(&curve, &plan, progress, points, has_channels ? channels : NULL, error);
    }
    const bat_curve_refine_options *options = &all->plan.options;
    bool reflected = options->ends <= BAT_CURVE_END_RULE_REFLECT && mask_is_symmetric(&options->scheme.mask);
    bool kept = part->cut[0] || part->cut[1] || part->straight || (all->stops && (all->keeps_points || reflected));
    if (status != BAT_OK || part->closed || !kept)
        return status;
    keep_ends(part, curve.points, space->point_dim, points);
    if (has_channels)
        keep_ends(part, curve.channels, curve.channel_count, channels);
    return BAT_OK;
}

/// Where the rows go.
typedef struct result_rows
{
    double *points, *channels;
} result_rows;

/// Put rows of a piece to their places, round the end of a closed curve.
static void place_rows(const pieces *all, const piece *part, const double *from, size_t dim, double *to)
{
    bool shares_end = part->edge + part->edges < all->edges || all->owned; // the next piece has that row
    size_t count = part->count - (!part->closed && shares_end);
    size_t row = part->row >= all->before ? part->row - all->before : part->row + all->rows - all->before;
    size_t fit = count < all->rows - row ? count : all->rows - row;
    memcpy(to + row * dim, from, fit * dim * sizeof *to);
    memcpy(to, from + fit * dim, (count - fit) * dim * sizeof *to);
}

/// Refine a piece: alone into its place, beside others by way of memory of its own.
static bat_status run_piece(pieces *all, piece *part, void *context, bat_progress progress, bat_error *error)
{
    const result_rows *result = context;
    if (all->count == 1 && !all->owned)
        return run_rows(all, part, progress, result->points, result->channels, error);
    size_t dim = all->coarse.space->point_dim, channel_count = result->channels != NULL ? all->coarse.channel_count : 0;
    memory_pool pool = {0};
    double *points = memory_pool_array(&pool, part->count, dim * sizeof *points);
    double *channels = channel_count > 0 ? memory_pool_array(&pool, part->count, channel_count * sizeof *channels) : NULL;
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        status = run_rows(all, part, progress, points, channels, error);
    if (status == BAT_OK)
        place_rows(all, part, points, dim, result->points);
    if (status == BAT_OK && channel_count > 0)
        place_rows(all, part, channels, channel_count, result->channels);
    memory_pool_free(&pool);
    return status;
}

/// The rows at which the edges of the given curve begin.
static void fill_starts(const pieces *all, size_t *starts)
{
    bool open = !all->owned && !all->list[0].closed;
    for (size_t i = 0; i < all->count; i++)
    {
        const piece *part = &all->list[i];
        size_t next = row_in_piece(all, part, 0);
        for (size_t e = 0; e < part->edges; e++)
        {
            size_t row = part->row + next;
            starts[open ? part->edge + e : vertex_of(all, part->edge + e)] =
                row >= all->before ? row - all->before : row + all->rows - all->before;
            next = all->stops ? next + ((size_t)1 << all->levels[part->edge + e]) : row_in_piece(all, part, e + 1);
        }
    }
    starts[all->edges] = open ? all->rows - 1 : all->rows;
}

/// The parts of the work: a search for levels takes about as long as the refinement, a test for crossings less.
static const double SEARCH_SHARE = 0.4, RUN_SHARE = 0.4;

/// The points once all is decided, where the edges begin, and what keeps the curve simple.
static bat_status pieces_run(pieces *all, const bat_curve *coarse, double *points, double *channels, size_t *starts,
                             bat_error *error)
{
    bat_curve_refine_options options = all->plan.options;
    double begin = SEARCH_SHARE + RUN_SHARE;
    progress_part parts[2] = {{options.progress, SEARCH_SHARE, RUN_SHARE}, {options.progress, begin, 1 - begin}};
    result_rows result = {points, channels};
    bat_status status = for_each(all, run_piece, &result, progress_of_part(&parts[0]), error);
    if (status != BAT_OK)
        return status;
    fill_starts(all, starts);
    size_t least = all->levels[0], most = all->levels[0];
    for (size_t e = 1; e < all->edges; e++)
    {
        least = all->levels[e] < least ? all->levels[e] : least;
        most = all->levels[e] > most ? all->levels[e] : most;
    }
    options.levels = most;
    bat_curve fine = {.space = coarse->space, .points = points, .count = all->rows, .closed = coarse->closed};
    bat_curve_refine_report report;
    status = keep_simple(coarse, &options, &fine, all->stops ? starts : NULL, progress_of_part(&parts[1]), &report, error);
    if (status != BAT_OK)
        return status;
    report.corners = all->corner_count;
    report.stopped = all->stops;
    report.min_levels = least;
    report.max_levels = most;
    if (options.report != NULL)
        *options.report = report;
    if (options.progress.report != NULL)
        (void)options.progress.report(options.progress.context, 1); // a wish to stop comes too late
    return BAT_OK;
}

bat_status pieces_count(const bat_curve *coarse, const bat_curve_refine_options *options, size_t *count, bat_error *error)
{
    pieces all;
    bat_status status = pieces_make(coarse, options, NULL, (bat_progress){0}, &all, error);
    if (status == BAT_OK)
        *count = all.rows;
    pieces_free(&all);
    return status;
}

/// The rows of a refined curve, to be filled: new ones, or those of `room` unless it is null.
static bat_status refined_rows(const bat_curve *coarse, size_t count, bool corners, const refine_room *room, bat_curve *fine,
                               bat_error *error)
{
    if (room == NULL)
        return curve_room(coarse, count, corners, fine, error);
    *fine = (bat_curve){.points = room->points, .channels = room->channels, .count = count};
    return count <= room->capacity
               ? BAT_OK
               : ERROR_TOO_LARGE(error, "the refined curve has %zu points, there is room for %zu", count, room->capacity);
}

bat_status pieces_refine(const bat_curve *coarse, const bat_curve_refine_options *options, const unsigned char *joints,
                         const refine_room *room, bat_curve *fine, size_t **starts, bat_error *error)
{
    pieces all;
    bat_curve result = {0};
    size_t *rows = NULL;
    progress_part part = {options != NULL ? options->progress : (bat_progress){0}, 0, SEARCH_SHARE};
    bat_status status = pieces_make(coarse, options, joints, progress_of_part(&part), &all, error);
    if (status == BAT_OK)
        status = refined_rows(coarse, all.rows, corners_wanted(coarse, &all.plan.options), room, &result, error);
    rows = status == BAT_OK ? memory_array(all.edges + 1, sizeof *rows) : NULL;
    if (status == BAT_OK && rows == NULL)
        status = error_memory(error, all.edges * sizeof *rows);
    if (status == BAT_OK)
        status = pieces_run(&all, coarse, result.points, result.channels, rows, error);
    if (status == BAT_OK)
    {
        for (size_t i = 0; result.corners != NULL && i < all.vertices; i++)
            if (all.corners[i] != 0)
                result.corners[rows[i]] = 1;
        *fine = result;
    }
    else if (room == NULL)
        bat_curve_free(&result);
    if (status == BAT_OK && starts != NULL)
        *starts = rows;
    else
        free(rows);
    pieces_free(&all);
    return status;
}
