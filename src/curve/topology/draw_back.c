#include "curve/topology/draw_back.h"

#include "base/bisect.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/threads.h"
#include "batten/curve_measure.h"
#include "curve/polygon.h"
#include "linalg/vector.h"

#include <string.h>

static size_t cell_along(const anchor_grid *grid, double value, int axis)
{
    size_t cells = axis == 0 ? grid->columns : grid->rows;
    double place = (value - grid->low[axis]) / grid->cell[axis];
    return !(place > 0) ? 0 : place >= (double)cells ? cells - 1 : (size_t)place;
}

static size_t cell_of(const anchor_grid *grid, const double *point)
{
    return cell_along(grid, point[1], 1) * grid->columns + cell_along(grid, point[0], 0);
}

/// About one anchor a cell.
static void lay_out(const double *points, anchor_grid *grid)
{
    double high[2];
    box_of_points(2, points, grid->count, grid->low, high);
    grid->columns = grid->rows = 1 + (size_t)sqrt((double)grid->count);
    for (size_t k = 0; k < 2; k++)
    {
        double size = (high[k] - grid->low[k]) / (double)grid->columns;
        grid->cell[k] = size > 0 ? size : 1;
    }
}

bat_status anchor_grid_make(const double *points, const size_t *components, size_t count, anchor_grid *grid,
                            bat_error *error)
{
    *grid = (anchor_grid){.count = count};
    if (count == 0)
        return BAT_OK;
    lay_out(points, grid);
    size_t cells = grid->columns * grid->rows;
    grid->points = memory_array(count, 2 * sizeof(double));
    grid->components = memory_array(count, sizeof(size_t));
    grid->begins = calloc(cells + 1, sizeof(size_t));
    size_t *next = memory_array(cells, sizeof *next);
    if (grid->points == NULL || grid->components == NULL || grid->begins == NULL || next == NULL)
    {
        free(next);
        anchor_grid_free(grid);
        return error_memory(error, (count + cells) * sizeof(size_t));
    }
    for (size_t i = 0; i < count; i++)
        grid->begins[cell_of(grid, points + 2 * i) + 1]++;
    for (size_t i = 0; i < cells; i++)
    {
        next[i] = grid->begins[i];
        grid->begins[i + 1] += grid->begins[i];
    }
    for (size_t i = 0; i < count; i++)
    {
        size_t place = next[cell_of(grid, points + 2 * i)]++;
        memcpy(grid->points + 2 * place, points + 2 * i, 2 * sizeof(double));
        grid->components[place] = components[i];
    }
    free(next);
    return BAT_OK;
}

void anchor_grid_free(anchor_grid *grid)
{
    free(grid->points);
    free(grid->components);
    free(grid->begins);
    *grid = (anchor_grid){0};
}

static bool is_inside(const double *polygon, size_t count, const double *point)
{
    bool inside = false;
    for (size_t i = 0, j = count - 1; i < count; j = i++)
    {
        const double *a = polygon + 2 * j, *b = polygon + 2 * i;
        if ((a[1] > point[1]) == (b[1] > point[1]))
            continue;
        int side = predicate_orientation(SURFACE_PLANE, a, b, point);
        inside ^= b[1] > a[1] ? side > 0 : side < 0;
    }
    return inside;
}

bool anchor_grid_inside(const anchor_grid *grid, const double *polygon, size_t count, size_t component)
{
    if (grid->count == 0)
        return false;
    double low[2], high[2];
    box_of_points(2, polygon, count, low, high);
    size_t last_column = cell_along(grid, high[0], 0), last_row = cell_along(grid, high[1], 1);
    for (size_t row = cell_along(grid, low[1], 1); row <= last_row; row++)
        for (size_t column = cell_along(grid, low[0], 0); column <= last_column; column++)
        {
            size_t cell = row * grid->columns + column;
            for (size_t i = grid->begins[cell]; i < grid->begins[cell + 1]; i++)
            {
                const double *point = grid->points + 2 * i;
                bool near = point[0] >= low[0] && point[0] <= high[0] && point[1] >= low[1] && point[1] <= high[1];
                if (near && grid->components[i] != component && is_inside(polygon, count, point))
                    return true;
            }
        }
    return false;
}

/// Arithmetic operations that the search for an anchor takes for an edge, roughly.
#define ANCHOR_WORK 50.0

enum
{
    /// After so many halvings an edge becomes straight.
    MAX_HALVINGS = 4,
    STRAIGHT = MAX_HALVINGS + 1,
    /// Where rounding makes a straight edge meet another one, its new points go to its start.
    COLLAPSED = STRAIGHT + 1,
    /// From this round on an edge becomes straight at once.
    PATIENCE = 40
};

/// The state of an edge of a polygon.
typedef struct edge_state
{
    unsigned char halvings; ///< STRAIGHT: lambda is 0; or COLLAPSED
    bool meets;             ///< one of its refined edges meets another, or they passed over an anchor
    bool moved;             ///< in the last round
} edge_state;

typedef struct draw_back_job
{
    const drawn_curve *drawn;
    bat_curve *fine;
    size_t count;
    const draw_rules *rules;
    size_t *first; ///< of each curve, its first edge in `edges`
    edge_state *edges;
    size_t edge_count, crossings, allowed;
    edge_place stuck; ///< an edge that is straight and meets a straight one; curve BAT_NO_INDEX for none
} draw_back_job;

static size_t edges_of(const bat_curve *curve)
{
    return polygon_edges(curve->count, curve->closed);
}

/// The place of coarse point i in the refined curve; i may be the number of edges of a closed curve.
static size_t start_of(const bat_curve *coarse, const bat_curve *fine, const size_t *starts, size_t i)
{
    return starts != NULL ? starts[i] : i * (edges_of(fine) / edges_of(coarse));
}

bool contains_points(const bat_curve *coarse, const bat_curve *fine, const size_t *starts)
{
    size_t dim = coarse->space->point_dim;
    if (starts == NULL && edges_of(fine) % edges_of(coarse) != 0)
        return false;
    for (size_t i = 0; i < coarse->count; i++)
    {
        const double *p = coarse->points + i * dim, *q = fine->points + start_of(coarse, fine, starts, i) * dim;
        for (size_t c = 0; c < dim; c++)
            if (p[c] != q[c])
                return false;
    }
    return true;
}

/// The edge of the polygon that a refined edge belongs to.
static size_t edge_under(const draw_back_job *job, edge_place place)
{
    const drawn_curve *drawn = &job->drawn[place.curve];
    size_t count = edges_of(drawn->coarse);
    if (drawn->starts == NULL)
        return place.edge / (edges_of(&job->fine[place.curve]) / count);
    return bisect_sizes(drawn->starts, 0, count, place.edge);
}

/// Whether two edges of one polygon share a vertex.
static bool are_neighbours(const draw_back_job *job, const edge_place places[2])
{
    size_t low = places[0].edge < places[1].edge ? places[0].edge : places[1].edge;
    size_t high = places[0].edge + places[1].edge - low;
    const bat_curve *coarse = job->drawn[places[0].curve].coarse;
    return places[0].curve == places[1].curve &&
           (high - low <= 1 || (coarse->closed && low == 0 && high + 1 == coarse->count));
}

static bool note_pair(void *context, edge_place first, edge_place second)
{
    draw_back_job *job = context;
    edge_place places[2] = {first, second};
    bool all_straight = true;
    for (int k = 0; k < 2; k++)
        places[k].edge = edge_under(job, places[k]);
    if (job->rules->may_meet != NULL && job->rules->may_meet(job->rules->context, places[0], places[1]))
    {
        job->allowed++;
        return true;
    }
    edge_state *edges[2];
    for (int k = 0; k < 2; k++)
    {
        edges[k] = &job->edges[job->first[places[k].curve] + places[k].edge];
        all_straight &= edges[k]->halvings == (job->rules->move != NULL ? COLLAPSED : STRAIGHT);
    }
    if (all_straight && job->rules->move != NULL && are_neighbours(job, places))
        return true; // points at the start of an edge meet the edge before
    if (all_straight)
        job->stuck = places[0];
    if (all_straight && job->rules->straight_may_meet)
        return true;
    job->crossings++;
    edges[0]->meets = edges[1]->meets = true;
    return !all_straight;
}

/// Move the new points of edge `e` half of the way to the edge, or onto it.
static bat_status move_points(const bat_curve *coarse, bat_curve *fine, const size_t *starts, size_t e, bool onto_edge)
{
    const bat_space *space = coarse->space;
    size_t dim = space->point_dim, begin = start_of(coarse, fine, starts, e), end = start_of(coarse, fine, starts, e + 1);
    const double *p = coarse->points + e * dim, *q = coarse->points + (e + 1 == coarse->count ? 0 : e + 1) * dim;
    for (size_t i = begin + 1; i < end; i++)
    {
        double on_edge[3], middle[3], *point = fine->points + i * dim;
        bat_status status = polygon_edge_point(space, p, q, i - begin, end - begin, on_edge);
        if (status == BAT_OK && !onto_edge)
            status = bat_space_geodesic(space, on_edge, point, 0.5, middle);
        if (status != BAT_OK)
            return status;
        memcpy(point, onto_edge ? on_edge : middle, dim * sizeof *point);
    }
    return BAT_OK;
}

/// Move the new points of edge `e` of a curve as the rules say.
static bool move_edge(draw_back_job *job, size_t c, size_t e, unsigned char halvings)
{
    draw_move move = halvings == COLLAPSED ? DRAW_TO_START : halvings == STRAIGHT ? DRAW_ON_EDGE : DRAW_HALF;
    const drawn_curve *drawn = &job->drawn[c];
    bat_curve *fine = &job->fine[c];
    if (job->rules->move == NULL)
        return move_points(drawn->coarse, fine, drawn->starts, e, move == DRAW_ON_EDGE) == BAT_OK;
    return job->rules->move(job->rules->context, c, e, start_of(drawn->coarse, fine, drawn->starts, e),
                            start_of(drawn->coarse, fine, drawn->starts, e + 1), move);
}

/// Draw back every edge that meets another.
static bat_status draw_all(draw_back_job *job, edge_tree *tree, size_t round, bat_error *error)
{
    for (size_t c = 0; c < job->count; c++)
    {
        const drawn_curve *drawn = &job->drawn[c];
        for (size_t e = 0; e < edges_of(drawn->coarse); e++)
        {
            edge_state *edge = &job->edges[job->first[c] + e];
            bool moves = edge->meets && edge->halvings < (job->rules->move != NULL ? COLLAPSED : STRAIGHT);
            edge->meets = false;
            edge->moved = moves;
            if (!moves)
                continue;
            bool halved = round < PATIENCE || edge->halvings >= STRAIGHT;
            edge->halvings = halved ? (unsigned char)(edge->halvings + 1) : STRAIGHT;
            if (!move_edge(job, c, e, edge->halvings))
                return error_set(error, BAT_INVALID_POINT, e, 0,
                                 "the new points after point %zu cannot be drawn back to their edge", e);
            edge_tree_mark(tree, c, start_of(drawn->coarse, &job->fine[c], drawn->starts, e),
                           start_of(drawn->coarse, &job->fine[c], drawn->starts, e + 1));
        }
    }
    return edge_tree_update(tree, error);
}

#define ROOM (1 << 10)

/// Whether the new points of edge `e` of a curve have an anchor between them and the edge.
static bool passes_anchor(const draw_back_job *job, size_t c, size_t e)
{
    const drawn_curve *drawn = &job->drawn[c];
    const bat_curve *fine = &job->fine[c];
    size_t begin = start_of(drawn->coarse, fine, drawn->starts, e),
           end = start_of(drawn->coarse, fine, drawn->starts, e + 1);
    size_t component = job->rules->components[c];
    if (end < fine->count)
        return anchor_grid_inside(job->rules->anchors, fine->points + 2 * begin, end - begin + 1, component);
    double rows[2 * ROOM]; // the last edge of a closed curve ends at the first point
    size_t count = end - begin + 1;
    if (count > ROOM)
        return false;
    memcpy(rows, fine->points + 2 * begin, 2 * (count - 1) * sizeof *rows);
    memcpy(rows + 2 * (count - 1), fine->points, 2 * sizeof *rows);
    return anchor_grid_inside(job->rules->anchors, rows, count, component);
}

/// Find edges that passed over anchors, in later rounds among those that were moved.
static void note_anchors(draw_back_job *job, bool moved_only)
{
    size_t found = 0;
    if (job->rules->anchors == NULL || job->rules->anchors->count == 0)
        return;
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads_worth(job->rules->threads, job->count, ANCHOR_WORK *(double)job->edge_count)) reduction(+ : found)
    for (size_t c = 0; c < job->count; c++)
        for (size_t e = 0; e < edges_of(job->drawn[c].coarse); e++)
        {
            edge_state *edge = &job->edges[job->first[c] + e];
            if ((moved_only && !edge->moved) || edge->halvings >= STRAIGHT || !passes_anchor(job, c, e))
                continue;
            edge->meets = true;
            found++;
        }
    job->crossings += found;
}

static bat_status run_rounds(draw_back_job *job, edge_tree *tree, bat_progress progress, draw_back_counts *counts,
                             bat_error *error)
{
    for (size_t round = 0;; round++)
    {
        job->crossings = 0;
        (void)edge_tree_search(tree, job->rules->pairs, round > 0, note_pair, job);
        note_anchors(job, round > 0);
        if (round == 0)
        {
            counts->crossings = job->crossings;
            counts->allowed = job->allowed;
        }
        if (job->stuck.curve != BAT_NO_INDEX && !job->rules->straight_may_meet)
        {
            (void)error_set(error, BAT_INVALID_POINT, job->stuck.edge, 0,
                            "the edge after point %zu comes so near to another one that rounding makes their new points "
                            "cross",
                            job->stuck.edge);
            return job->rules->pairs == EDGE_PAIRS_SAME_CURVE
                       ? error_remedy(error, BAT_INVALID_POINT, "simple", "rings leaves what overlaps itself")
                       : error_remedy(error, BAT_INVALID_POINT, "precision", "can keep more decimals");
        }
        if (job->crossings == 0)
            return BAT_OK;
        double fraction = 1 - 1 / ((double)round + 2);
        bat_status status = progress_check(progress, fraction, error);
        edge_tree_settle(tree);
        if (status == BAT_OK)
            status = draw_all(job, tree, round, error);
        if (status != BAT_OK)
            return status;
    }
}

bat_status draw_back(const drawn_curve *drawn, bat_curve *fine, size_t count, const draw_rules *rules, bat_progress progress,
                     draw_back_counts *counts, bat_error *error)
{
    draw_back_job job = {.drawn = drawn, .fine = fine, .count = count, .rules = rules, .stuck = {.curve = BAT_NO_INDEX}};
    edge_tree tree;
    *counts = (draw_back_counts){.stuck = {BAT_NO_INDEX, BAT_NO_INDEX}};
    bat_status status = edge_tree_make(fine, count, 0, rules->threads, &tree, error);
    tree.turn = rules->turn;
    if (status == BAT_OK)
        status = array_make(&job.first, count, sizeof *job.first, error);
    for (size_t c = 0; c < count && status == BAT_OK; c++)
    {
        job.first[c] = job.edge_count;
        job.edge_count += edges_of(drawn[c].coarse);
    }
    if (status == BAT_OK)
        status = array_zeros(&job.edges, job.edge_count, sizeof *job.edges, error);
    if (status == BAT_OK)
        status = run_rounds(&job, &tree, progress, counts, error);
    counts->stuck = job.stuck;
    for (size_t e = 0; e < job.edge_count && status == BAT_OK; e++)
    {
        counts->edges += job.edges[e].halvings > 0;
        counts->straight += job.edges[e].halvings >= STRAIGHT;
    }
    free(job.first);
    free(job.edges);
    edge_tree_free(&tree);
    return status;
}

static bool stop_at_first(void *apart, edge_place first BAT_UNUSED, edge_place second BAT_UNUSED)
{
    return *(bool *)apart = false;
}

bat_status curve_edges_are_apart(const bat_curve *curve, bool *apart, bat_error *error)
{
    *apart = true;
    return edge_pairs_find(curve, 1, 0, EDGE_PAIRS_SAME_CURVE, 1, stop_at_first, apart, error);
}

/// The number of pairs of edges that meet, and the first of them.
typedef struct pair_count
{
    size_t pairs, first;
} pair_count;

static bool count_pair(void *context, edge_place first, edge_place second BAT_UNUSED)
{
    pair_count *count = context;
    count->first = count->pairs == 0 || first.edge < count->first ? first.edge : count->first;
    count->pairs++;
    return true;
}

/// A curve that does not contain the given points has no edges to be drawn back to.
static bat_status only_count(const bat_curve *fine, bool must, bat_curve_refine_report *report, bat_error *error)
{
    pair_count count = {0, 0};
    bat_status status = edge_pairs_find(fine, 1, 0, EDGE_PAIRS_SAME_CURVE, 1, count_pair, &count, error);
    if (status != BAT_OK)
        return status;
    if (must && count.pairs > 0)
        return ERROR_UNSUPPORTED(
            error, 0,
            "the refined curve crosses itself after its point %zu, and the scheme does not keep the given "
            "points, to which it could be drawn back",
            count.first);
    report->crossings = count.pairs;
    report->crossing = report->left_crossing = count.pairs > 0;
    return BAT_OK;
}

/// A curve that crosses itself stays as it is, or is refused.
static bat_status leave_crossing(const bat_curve_refine_options *options, bat_error *error)
{
    return !options->strict ? BAT_OK
                            : error_set(error, BAT_INVALID_POINT, BAT_NO_INDEX, 0, "the curve crosses or overlaps itself");
}

bool wants_simple(const bat_curve *coarse, const bat_curve_refine_options *options)
{
    surface_kind kind;
    bool wanted =
        options->simple == BAT_CURVE_SIMPLE_ALWAYS || (options->simple <= BAT_CURVE_SIMPLE_RINGS && coarse->closed);
    return wanted && options->levels > 0 && surface_of_space(coarse->space, &kind);
}

bat_status keep_simple(const bat_curve *coarse, const bat_curve_refine_options *options, bat_curve *fine,
                       const size_t *starts, bat_progress progress, bat_curve_refine_report *report, bat_error *error)
{
    *report = (bat_curve_refine_report){0};
    if (!wants_simple(coarse, options))
        return BAT_OK;
    bool apart;
    bat_status status = curve_edges_are_apart(coarse, &apart, error);
    if (status != BAT_OK)
        return status;
    report->checked = 1;
    report->given_crossing = !apart;
    if (!apart)
        return leave_crossing(options, error);
    if (!contains_points(coarse, fine, starts))
        return only_count(fine, options->strict || options->simple == BAT_CURVE_SIMPLE_ALWAYS, report, error);
    draw_back_counts counts;
    drawn_curve drawn = {.coarse = coarse, .starts = starts};
    draw_rules rules = {.pairs = EDGE_PAIRS_SAME_CURVE, .straight_may_meet = options->simple <= BAT_CURVE_SIMPLE_RINGS};
    status = draw_back(&drawn, fine, 1, &rules, progress, &counts, error);
    if (status != BAT_OK)
        return status;
    report->crossing = counts.crossings > 0;
    report->crossings = counts.crossings;
    report->drawn_back = counts.edges;
    report->straight = counts.straight;
    report->left_crossing = counts.stuck.curve != BAT_NO_INDEX;
    return report->left_crossing ? leave_crossing(options, error) : BAT_OK;
}

/// Edges need a unique geodesic.
static bat_status check_edges(const bat_curve *curve, bat_error *error)
{
    const bat_space *space = curve->space;
    size_t edges = polygon_edges(curve->count, curve->closed);
    for (size_t i = 0; i < edges; i++)
    {
        size_t next = i + 1 == curve->count ? 0 : i + 1;
        double tangent[3];
        if (space->log(space, curve->points + i * space->point_dim, curve->points + next * space->point_dim, tangent) !=
            BAT_OK)
            return error_set(error, BAT_CUT_LOCUS, next, 0, "point %zu is antipodal to point %zu", next, i);
    }
    return BAT_OK;
}

bat_status bat_curve_is_simple(const bat_curve *curve, bool *simple, bat_error *error)
{
    surface_kind kind;
    if (!surface_of_space(curve->space, &kind))
        return ERROR_UNSUPPORTED(
            error, 0, "curves cross only in surfaces (plane, sphere in R^3, disk), not in the %s of dimension %zu",
            curve->space->name, curve->space->dimension);
    if (curve->count == 0)
        return ERROR_ARGUMENT(error, "a curve without points");
    bat_status status = bat_space_check(curve->space, curve->points, curve->count, error);
    if (status == BAT_OK && kind == SURFACE_SPHERE)
        status = check_edges(curve, error);
    return status == BAT_OK ? curve_edges_are_apart(curve, simple, error) : status;
}
