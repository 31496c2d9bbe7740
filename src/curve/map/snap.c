#include "curve/map/arc_refine.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "curve/pieces.h"
#include "space/builtin.h"

enum
{
    MAX_DIM = 3,
    /// The size of a cell in tolerances: where many points lie within one, and where hardly two do. Cells next to a point's
    /// own are searched where the point is near to their border.
    CELL_TOLERANCES = 4,
    CELL_ROUNDINGS = 256
};

/// Items in cells of a grid.
typedef struct cell_grid
{
    size_t dim;
    double cell;
    size_t *heads; ///< of each hash: an item and 1, or 0
    size_t mask;
    size_t *items, *next; ///< what lies in a cell, and the next entry and 1
    size_t count, item_capacity, next_capacity;
} cell_grid;

/// A point that becomes a vertex of an edge.
typedef struct added_vertex
{
    size_t curve, edge; ///< in the curves with joined points
    double share;       ///< where on the edge
    const double *point;
} added_vertex;

typedef struct snap_job
{
    const bat_curve *curves;
    size_t count, dim, point_count;
    double tolerance;
    bool sphere;
    size_t *first;         ///< of each curve, its first point
    const double **points; ///< of each point
    size_t *targets;       ///< of each point, the point where it goes; itself where it stays
    cell_grid grid;
    const map_chart *chart;
    chart_curves charts;     ///< of the curves with joined points
    double chart_tolerance;  ///< the tolerance in the unit of the chart
    const bat_curve *joined; ///< the curves with joined points
    added_vertex *added;
    size_t added_count, added_capacity;
    snapped_curves *result;
} snap_job;

static void grid_make(size_t dim, double cell, size_t count, memory_pool *pool, cell_grid *grid)
{
    size_t size = 2;
    while (size < count)
        size *= 2;
    *grid = (cell_grid){.dim = dim, .cell = cell, .mask = size - 1};
    grid->heads = memory_pool_zeros(pool, size, sizeof *grid->heads);
}

static size_t cell_hash(const cell_grid *grid, const double *cell)
{
    return doubles_hash(cell, grid->dim) & grid->mask;
}

static bool grid_add(cell_grid *grid, const double *cell, size_t item)
{
    if (!ARRAY_GROW(grid->items, grid->item_capacity, grid->count + 1) ||
        !ARRAY_GROW(grid->next, grid->next_capacity, grid->count + 1))
        return false;
    size_t *head = &grid->heads[cell_hash(grid, cell)];
    grid->items[grid->count] = item;
    grid->next[grid->count] = *head;
    *head = ++grid->count;
    return true;
}

/// The point within the tolerance that is nearest to point `i`, among those that stay; the first of equally near ones.
static size_t nearest_point(const snap_job *job, size_t i)
{
    const cell_grid *grid = &job->grid;
    const double *point = job->points[i];
    size_t best = i, cells = 1;
    double least = job->tolerance, low[MAX_DIM] = {0}, sides[MAX_DIM] = {0};
    for (size_t c = 0; c < job->dim; c++)
    {
        low[c] = floor((point[c] - job->tolerance) / grid->cell);
        sides[c] = floor((point[c] + job->tolerance) / grid->cell) - low[c];
        cells *= 1 + (size_t)sides[c];
    }
    for (size_t k = 0; k < cells; k++)
    {
        double cell[MAX_DIM] = {0};
        size_t rest = k;
        for (size_t c = 0; c < job->dim; c++)
        {
            size_t sizes = 1 + (size_t)sides[c];
            cell[c] = low[c] + (double)(rest % sizes);
            rest /= sizes;
        }
        for (size_t entry = grid->heads[cell_hash(grid, cell)]; entry != 0 && grid->count > 0; entry = grid->next[entry - 1])
        {
            size_t other = grid->items[entry - 1];
            double d = vector_distance(job->dim, point, job->points[other]);
            if (d < least || (d == least && other < best))
            {
                least = d;
                best = other;
            }
        }
    }
    return best;
}

/// The cell of a point; the rest of the numbers is 0.
static void cell_of(const snap_job *job, size_t point, double *cell)
{
    for (size_t c = 0; c < MAX_DIM; c++)
        cell[c] = c < job->dim ? floor(job->points[point][c] / job->grid.cell) : 0;
}

/// Find where each point goes.
static bat_status join_points(snap_job *job, bat_error *error)
{
    static const size_t AHEAD = 16; // points: their cells lie anywhere in memory, and are asked for before they are needed
    for (size_t i = 0; i < job->point_count; i++)
    {
        double cell[MAX_DIM];
        if (i + AHEAD < job->point_count)
        {
            cell_of(job, i + AHEAD, cell);
            __builtin_prefetch(&job->grid.heads[cell_hash(&job->grid, cell)]);
        }
        size_t target = nearest_point(job, i);
        job->targets[i] = target;
        if (target != i)
        {
            double way = vector_distance(job->dim, job->points[i], job->points[target]);
            job->result->moved += way > 0;
            job->result->largest = fmax(job->result->largest, way);
            continue;
        }
        cell_of(job, i, cell);
        if (!grid_add(&job->grid, cell, i))
            return error_memory(error, job->point_count * sizeof(size_t));
    }
    return BAT_OK;
}

/// Drop points of a list that repeat the one before.
static size_t drop_repeats(const snap_job *job, size_t first, size_t *list, size_t count, bool closed)
{
    const size_t *to = job->targets + first;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (kept == 0 || to[list[kept - 1]] != to[list[i]])
            list[kept++] = list[i];
    while (closed && kept > 1 && to[list[kept - 1]] == to[list[0]])
        kept--;
    return kept;
}

/// The same with the points where the rows come from.
static bat_status make_room(const bat_curve *like, size_t count, bat_curve *made, size_t **origins, bat_error *error)
{
    *origins = memory_array(count, sizeof **origins);
    bat_status status = curve_room(like, count, like->corners != NULL, made, error);
    return *origins != NULL ? status : error_memory(error, count * sizeof **origins);
}

static bat_status copy_curve(const snap_job *job, size_t curve, const size_t *list, size_t count, bat_error *error)
{
    bat_curve *copy = &job->result->curves[curve];
    size_t **origins = &job->result->origins[curve];
    bat_status status = make_room(&job->curves[curve], count, copy, origins, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        curve_copy_row(&job->curves[curve], list[i], copy, i);
        memcpy(copy->points + i * job->dim, job->points[job->targets[job->first[curve] + list[i]]],
               job->dim * sizeof(double));
        (*origins)[i] = list[i];
    }
    return status;
}

/// Copy the curves with their points moved.
static bat_status copy_curves(snap_job *job, bat_error *error)
{
    snapped_curves *result = job->result;
    result->count = job->count;
    result->curves = calloc(job->count, sizeof *result->curves);
    result->origins = calloc(job->count, sizeof *result->origins);
    size_t *list = memory_array(job->point_count, sizeof *list);
    bat_status status = BAT_OK;
    if (result->curves == NULL || result->origins == NULL || list == NULL)
        status = error_memory(error, job->point_count * sizeof *list);
    for (size_t c = 0; c < job->count && status == BAT_OK; c++)
    {
        size_t n = job->curves[c].count, least = job->curves[c].closed ? 3 : 2;
        for (size_t i = 0; i < n; i++)
            list[i] = i;
        size_t kept = drop_repeats(job, job->first[c], list, n, job->curves[c].closed);
        if (kept < least)
        {
            for (kept = 0; kept < n; kept++)
            {
                list[kept] = kept;
                job->targets[job->first[c] + kept] = job->first[c] + kept;
            }
        }
        status = copy_curve(job, c, list, kept, error);
    }
    free(list);
    return status;
}

// Points on edges

/// Note a point of one edge that lies near the inside of another.
/// @param flat  the point in the chart, moved to the edge's turn
/// @return false when out of memory
static bool note_near(snap_job *job, edge_place edge, const double *flat, const double *point)
{
    const bat_curve *chart = &job->charts.curves[edge.curve], *curve = &job->joined[edge.curve];
    const double *p = chart->points + 2 * edge.edge,
                 *q = chart->points + 2 * (edge.edge + 1 == chart->count ? 0 : edge.edge + 1);
    const double *ends[2] = {curve->points + edge.edge * job->dim,
                             curve->points + (edge.edge + 1) % curve->count * job->dim};
    double narrow = job->sphere ? cos(flat[1] / job->chart->units_per_degree * ANGLE_DEGREE) : 1;
    double along[2] = {(q[0] - p[0]) * narrow, q[1] - p[1]}, to[2] = {(flat[0] - p[0]) * narrow, flat[1] - p[1]};
    double square = along[0] * along[0] + along[1] * along[1];
    double share = (to[0] * along[0] + to[1] * along[1]) / square;
    if (!(share > 0 && share < 1) || fabs(to[0] * along[1] - to[1] * along[0]) > job->chart_tolerance * sqrt(square))
        return true;
    for (int k = 0; k < 2; k++)
        if (memcmp(ends[k], point, job->dim * sizeof *point) == 0)
            return true;
    return ARRAY_ADD(job->added, job->added_capacity, job->added_count, (added_vertex){edge.curve, edge.edge, share, point});
}

static bool note_pair(void *context, edge_place first, edge_place second)
{
    snap_job *job = context;
    edge_place places[2] = {first, second};
    bool ok = true;
    for (int k = 0; k < 2 && ok; k++)
    {
        const bat_curve *chart = &job->charts.curves[places[!k].curve], *other = &job->charts.curves[places[k].curve];
        const bat_curve *curve = &job->joined[places[!k].curve];
        for (size_t end = 0; end < 2 && ok; end++)
        {
            size_t i = places[!k].edge + end;
            double flat[2] = {chart->points[2 * (i % chart->count)], chart->points[2 * (i % chart->count) + 1]};
            double turn = job->chart->turn;
            if (turn > 0)
                flat[0] -= turn * rint((flat[0] - other->points[2 * places[k].edge]) / turn);
            ok = note_near(job, places[k], flat, curve->points + i % curve->count * job->dim);
        }
    }
    return ok;
}

static int compare_added(const void *a, const void *b)
{
    const added_vertex *p = a, *q = b;
    int order = p->curve != q->curve ? ORDER_OF(p->curve, q->curve) : ORDER_OF(p->edge, q->edge);
    return order != 0 ? order : ORDER_OF(p->share, q->share);
}

/// Find the points that lie near edges of other curves, or of other parts of their own.
static bat_status find_near(snap_job *job, int threads, bat_error *error)
{
    bat_status status = chart_curves_make(job->chart, job->joined, job->count, NULL, NULL, threads, &job->charts, error);
    if (status != BAT_OK)
        return status;
    double highest = 0, slack = job->chart_tolerance;
    static const double HIGHEST = 89; // degrees; nearer to the poles some near points are not found
    for (size_t c = 0; c < job->count && job->sphere; c++)
        for (size_t i = 0; i < job->charts.curves[c].count; i++)
            highest = fmax(highest, fabs(job->charts.curves[c].points[2 * i + 1]));
    if (job->sphere)
        slack /= cos(fmin(highest / job->chart->units_per_degree, HIGHEST) * ANGLE_DEGREE);
    edge_tree tree;
    status = edge_tree_make(job->charts.curves, job->count, slack, threads, &tree, error);
    tree.turn = job->chart->turn;
    if (status == BAT_OK && !edge_tree_search(&tree, EDGE_PAIRS_NEAR, false, note_pair, job))
        status = error_memory(error, job->added_count * sizeof *job->added);
    edge_tree_free(&tree);
    if (job->added_count > 0)
        qsort(job->added, job->added_count, sizeof *job->added, compare_added);
    return status;
}

/// Move a row of a curve to an earlier one.
static void move_row(bat_curve *curve, size_t *origins, size_t from, size_t to)
{
    curve_copy_row(curve, from, curve, to);
    origins[to] = origins[from];
}

static bool rows_agree(const bat_curve *curve, size_t i, size_t j)
{
    size_t dim = curve->space->point_dim;
    return memcmp(curve->points + i * dim, curve->points + j * dim, dim * sizeof(double)) == 0;
}

/// Whether a row is the tip of a spike no longer than `limit`, between two rows that agree.
static bool is_tip(const bat_curve *curve, size_t before, size_t tip, size_t after, double limit)
{
    size_t dim = curve->space->point_dim;
    return rows_agree(curve, before, after) &&
           curve->space->distance(curve->space, curve->points + before * dim, curve->points + tip * dim) <= limit;
}

/// Drop the spikes of a ring: edges that lead there and back, which rounding had kept apart. Those longer than `limit` stay.
static void drop_spikes(bat_curve *curve, size_t *origins, double limit)
{
    static const int FEWEST = 3;
    size_t kept = 0, count = curve->count;
    for (size_t i = 0; i < count; i++)
    {
        if (kept >= 2 && is_tip(curve, kept - 2, kept - 1, i, limit))
            kept--; // the tip; row i repeats the row that is last now
        else
        {
            if (kept != i)
                move_row(curve, origins, i, kept);
            kept++;
        }
    }
    size_t begin = 0;
    while (kept - begin > FEWEST)
    {
        bool last_is_tip = is_tip(curve, kept - 2, kept - 1, begin, limit);
        if (!last_is_tip && !is_tip(curve, begin + 1, begin, kept - 1, limit))
            break;
        kept -= last_is_tip ? 2 : 1;
        begin += last_is_tip ? 0 : 1;
    }
    if (kept - begin < FEWEST)
        return;
    for (size_t i = begin; i < kept && begin > 0; i++)
        move_row(curve, origins, i, i - begin);
    curve->count = kept - begin;
}

/// Copy a curve with its added vertices, which begin with number `*next`.
static bat_status add_to_curve(snap_job *job, size_t c, size_t *next, bat_curve *copy, size_t **origins, bat_error *error)
{
    const bat_curve *curve = &job->joined[c];
    size_t end = *next, channels = curve->channel_count, dim = job->dim;
    while (end < job->added_count && job->added[end].curve == c)
        end++;
    size_t row = 0;
    bat_status status = make_room(curve, curve->count + end - *next, copy, origins, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < curve->count; i++)
    {
        size_t after = i + 1 == curve->count ? 0 : i + 1;
        const double *here = channels > 0 ? curve->channels + i * channels : NULL;
        const double *there = channels > 0 ? curve->channels + after * channels : NULL;
        size_t origin = job->result->origins != NULL ? job->result->origins[c][i] : i;
        curve_copy_row(curve, i, copy, row);
        (*origins)[row++] = origin;
        for (; *next < end && job->added[*next].edge == i; ++*next)
        {
            const added_vertex *vertex = &job->added[*next];
            if (*next > 0 && vertex[-1].curve == c && vertex[-1].edge == i &&
                memcmp(vertex[-1].point, vertex->point, dim * sizeof(double)) == 0) // it is there already
                continue;
            memcpy(copy->points + row * dim, vertex->point, dim * sizeof(double));
            for (size_t k = 0; k < channels; k++)
                copy->channels[row * channels + k] = here[k] + vertex->share * (there[k] - here[k]);
            (*origins)[row++] = origin;
            job->result->added++;
        }
    }
    copy->count = row;
    if (!curve->closed || row == curve->count)
        return BAT_OK;
    double median = 0;
    status = curves_median_edge(curve, 1, &median, error);
    if (status != BAT_OK)
        return status;
    drop_spikes(copy, *origins, median / 2);
    job->result->spikes += row - copy->count;
    return BAT_OK;
}

/// Drop loops of a ring that are shorter than `limit` in all: joined points made the ring touch itself there.
static bool drop_loops(bat_curve *curve, size_t *origins, double limit)
{
    static const int FEWEST = 3;
    size_t kept = 0, mask, dim = curve->space->point_dim, *table, size = 2;
    while (size / 2 < curve->count)
        size *= 2;
    mask = size - 1;
    table = calloc(size, sizeof *table); // of the kept rows, each and 1
    double *ways = memory_array(curve->count + 1, sizeof *ways);
    bool done = table != NULL && ways != NULL;
    double way = 0;
    for (size_t i = 0; i < curve->count && done; i++)
    {
        const cell_grid grid = {.dim = dim, .mask = mask};
        const double *point = curve->points + i * dim;
        if (kept > 0)
            way += curve->space->distance(curve->space, curve->points + (kept - 1) * dim, point);
        size_t slot = cell_hash(&grid, point);
        while (table[slot] != 0 && (table[slot] > kept || !rows_agree(curve, table[slot] - 1, i)))
            slot = (slot + 1) & mask;
        if (table[slot] != 0 && way - ways[table[slot] - 1] < limit)
        {
            kept = table[slot];
            way = ways[kept - 1];
            continue;
        }
        if (kept != i)
            move_row(curve, origins, i, kept);
        ways[kept++] = way;
        table[slot] = kept;
    }
    if (done && kept >= FEWEST)
        curve->count = kept;
    free(table);
    free(ways);
    return done;
}

static void free_curves(bat_curve *curves, size_t **origins, size_t count)
{
    for (size_t i = 0; i < count && origins != NULL; i++)
        free(origins[i]);
    free(origins);
    curves_free(curves, count);
}

/// Copy the curves with joined points, and with the added vertices.
static bat_status add_vertices(snap_job *job, bat_error *error)
{
    bat_curve *curves = calloc(job->count, sizeof *curves);
    size_t **origins = calloc(job->count, sizeof *origins), next = 0;
    bat_status status = curves == NULL || origins == NULL ? error_memory(error, job->count * sizeof *curves) : BAT_OK;
    for (size_t c = 0; c < job->count && status == BAT_OK; c++)
        status = add_to_curve(job, c, &next, &curves[c], &origins[c], error);
    if (status != BAT_OK)
    {
        free_curves(curves, origins, job->count);
        return status;
    }
    free_curves(job->result->curves, job->result->origins, job->count);
    job->result->curves = curves;
    job->result->origins = origins;
    job->result->count = job->count;
    return BAT_OK;
}

static double default_tolerance(const snap_job *job)
{
    static const double SHARE = 1.4143; // of a unit of the file: only points nearer to each other are rounded to one
    double largest = 0;
    if (job->sphere)
        return fmax(SNAP_ROUNDING_SPHERE, SHARE / job->chart->units_per_radian);
    for (size_t i = 0; i < job->point_count; i++)
        for (size_t c = 0; c < job->dim; c++)
            largest = fmax(largest, fabs(job->points[i][c]));
    return SNAP_ROUNDING_FLAT * largest;
}

bat_status snapped_curves_make(const bat_curve *curves, size_t count, const map_chart *chart, double tolerance, int threads,
                               snapped_curves *snapped, bat_error *error)
{
    *snapped = (snapped_curves){0};
    snap_job job = {.curves = curves, .count = count, .chart = chart, .joined = curves, .result = snapped};
    if (count == 0)
        return BAT_OK;
    job.dim = curves[0].space->point_dim;
    job.sphere = space_is_sphere(curves[0].space);
    for (size_t i = 0; i < count; i++)
        job.point_count += curves[i].count;
    memory_pool pool = {0};
    job.first = memory_pool_array(&pool, count, sizeof *job.first);
    job.points = memory_pool_array(&pool, job.point_count, sizeof *job.points);
    job.targets = memory_pool_array(&pool, job.point_count, sizeof *job.targets);
    bat_status status = memory_pool_check(&pool, error);
    for (size_t c = 0, at = 0; c < count && status == BAT_OK; c++)
    {
        job.first[c] = at;
        for (size_t i = 0; i < curves[c].count; i++)
            job.points[at++] = curves[c].points + i * job.dim;
    }
    if (status == BAT_OK)
    {
        job.tolerance = fmax(tolerance, default_tolerance(&job));
        double cell = job.tolerance * (tolerance > 0 ? CELL_TOLERANCES : CELL_ROUNDINGS);
        grid_make(job.dim, cell, job.point_count, &pool, &job.grid);
        status = memory_pool_check(&pool, error);
    }
    if (status == BAT_OK && job.tolerance > 0)
        status = join_points(&job, error);
    if (status == BAT_OK && snapped->moved > 0)
        status = copy_curves(&job, error);
    if (status == BAT_OK && !space_is_disk(curves[0].space))
    {
        job.joined = snapped->curves != NULL ? snapped->curves : curves;
        job.chart_tolerance = chart->globe ? job.tolerance * chart->units_per_radian : job.tolerance;
        status = find_near(&job, threads, error);
    }
    if (status == BAT_OK && job.added_count > 0)
        status = add_vertices(&job, error);
    static const double LOOP = 8; // tolerances
    for (size_t c = 0; c < snapped->count && status == BAT_OK && tolerance > 0; c++)
        if (snapped->curves[c].closed && !drop_loops(&snapped->curves[c], snapped->origins[c], LOOP * tolerance))
            status = error_memory(error, snapped->curves[c].count * sizeof(size_t));
    chart_curves_free(&job.charts);
    free(job.added);
    free(job.grid.items);
    free(job.grid.next);
    memory_pool_free(&pool);
    return status;
}

void snapped_curves_free(snapped_curves *snapped)
{
    free_curves(snapped->curves, snapped->origins, snapped->count);
    *snapped = (snapped_curves){0};
}
