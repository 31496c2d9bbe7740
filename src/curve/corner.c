#include "curve/corner.h"

#include "base/error.h"
#include "base/memory.h"
#include "curve/pieces.h"

#include <string.h>

static const double RIGHT = ANGLE_TURN / 4;
/// A smaller turn is none.
static const double MIN_CORNER = 20;
/// A ring of so few vertices tells no curve: a lot, not an island.
static const size_t FEW = 4;

// Edges at right angles

/// How far edges at right angles may differ from them, in degrees: of surveyed lines, and of lines bent by a projection.
static const double WIDTHS[] = {3, 10};
/// Shares of the length at right angles from which right turns are corners, and short edges between are cut corners.
static const double MIN_SHARE = 0.4, SQUARE_SHARE = 0.7;
/// With which probability edges of random directions may be taken for edges at right angles.
static const double CHANCE = 0.01;
/// Right turns that follow each other are corners whatever the other edges do.
static const double PAIR_WIDTH = 2;

enum
{
    MIN_SQUARE_EDGES = 3,
    MAX_CUT_EDGES = 3 ///< of a cut corner
};

// Ends of straight runs

static const size_t RUN_VERTICES = 2; ///< inside of a run: it has three edges or more
/// The most that a vertex inside of a run turns, in degrees: what rounding makes of a straight line.
static const double RUN_TURN = 0.5;

// Simplified lines

/// A simplified line strays from what it was by a tolerance e at most, and its vertices deviate by e at least: MIN_NEAR of
/// them by NEAR e at most. Edges of arcs have the length 8 e over their turn, so longer ones are straight.
static const double NEAR = 4, MIN_NEAR = 0.4, MAX_ARC = 24;
static const size_t MIN_VERTICES = 6; ///< that tell whether a line was simplified

/// An edge's direction modulo a right angle.
typedef struct edge_direction
{
    double angle, length;
    size_t edge;
} edge_direction;

/// A curve whose corners are searched.
typedef struct corner_search
{
    const bat_curve *curve;
    size_t count, edges;
    double *turns;   ///< of the vertices; 0 at the ends of an open curve; with a sign in an oriented surface
    double *lengths; ///< of the edges
    edge_direction *directions;
    unsigned char *aligned; ///< edges at right angles to each other
    double median;          ///< length of the edges
    memory_pool pool;       ///< of all arrays
} corner_search;

bool corners_stay(const bat_curve_refine_options *options)
{
    return options->ends != BAT_CURVE_END_RULE_FREE &&
           (scheme_keeps_points(&options->scheme) ||
            (options->ends <= BAT_CURVE_END_RULE_REFLECT && mask_is_symmetric(&options->scheme.mask)));
}

bool corners_wanted(const bat_curve *curve, const bat_curve_refine_options *options)
{
    return curve->corners != NULL || options->corner_angle > 0 || (options->find_corners && corners_stay(options));
}

/// The exterior angle of every vertex, with a sign in an oriented surface.
static bat_status find_turns(const bat_curve *curve, double *turns, bat_error *error)
{
    if (bat_curve_exterior_angles(curve, turns, NULL) == BAT_OK)
        return BAT_OK;
    size_t n = curve->count, dim = curve->space->point_dim;
    const double *p = curve->points;
    for (size_t i = 0; i < n; i++)
    {
        bool end = !curve->closed && (i == 0 || i + 1 == n);
        turns[i] = 0;
        bat_status status = end ? BAT_OK
                                : polygon_exterior_angle(curve->space, p + (i == 0 ? n - 1 : i - 1) * dim, p + i * dim,
                                                         p + (i + 1 == n ? 0 : i + 1) * dim, &turns[i]);
        if (status != BAT_OK)
            return error_point(error, status, i, "there is no angle at point", " (%s)", bat_status_name(status));
    }
    return BAT_OK;
}

DEFINE_ORDER(compare_directions, edge_direction, angle, edge)

/// Find the directions of all edges modulo a right angle, sorted.
static void find_directions(corner_search *search)
{
    double direction = 0;
    for (size_t j = 0; j < search->edges; j++)
    {
        direction += j > 0 ? search->turns[j] : 0;
        double angle = direction - RIGHT * floor(direction / RIGHT);
        search->directions[j] = (edge_direction){angle, search->lengths[j], j};
    }
    qsort(search->directions, search->edges, sizeof *search->directions, compare_directions);
}

/// Whether `found` of `count` edges within a width are more than chance gives (Chernoff's bound, for each edge).
static bool is_significant(size_t found, size_t count, double width)
{
    double n = (double)count - 1, share = n > 0 ? ((double)found - 1) / n : 0, expected = width * ANGLE_DEGREE / RIGHT;
    if (found < MIN_SQUARE_EDGES || share <= expected)
        return false;
    double others = share < 1 ? (1 - share) * log((1 - share) / (1 - expected)) : 0;
    return n * (share * log(share / expected) + others) >= log((double)count / CHANCE);
}

/// Mark the edges at right angles to each other. Returns their share of the length; 0 where chance gives as many.
static double find_aligned(corner_search *search, double width)
{
    const edge_direction *sorted = search->directions;
    size_t n = search->edges, begin = 0, found = 0;
    double whole = 0, sum = 0, most = 0;
    for (size_t first = 0, end = 0; first < n; first++)
    {
        for (;
             end < first + n && sorted[end % n].angle + (end >= n ? RIGHT : 0) - sorted[first].angle <= width * ANGLE_DEGREE;
             end++)
            sum += sorted[end % n].length;
        if (sum > most)
        {
            most = sum;
            begin = first;
            found = end - first;
        }
        whole += sorted[first].length;
        sum -= sorted[first].length;
    }
    if (!is_significant(found, n, width))
        return 0;
    memset(search->aligned, 0, n);
    for (size_t k = begin; k < begin + found; k++)
        search->aligned[sorted[k % n].edge] = 1;
    return most / whole;
}

/// The edge before or after a vertex by `step` edges.
static size_t edge_at(const corner_search *search, size_t vertex, ptrdiff_t step)
{
    size_t n = search->edges;
    return (size_t)(((ptrdiff_t)vertex + step) % (ptrdiff_t)n + (ptrdiff_t)n) % n;
}

/// The number of vertices from `i` on, after an edge at right angles, up to the next one, if there are at most `most`
/// shorter edges between them and the line turns right or left there; else 0.
static size_t right_turn(const corner_search *search, size_t i, size_t most)
{
    bool closed = search->curve->closed;
    size_t edges = 0; // not at right angles
    double turn = search->turns[i], longest = 0, before = search->lengths[edge_at(search, i, -1)];
    if (!search->aligned[edge_at(search, i, -1)])
        return 0;
    while (!search->aligned[edge_at(search, i, (ptrdiff_t)edges)])
    {
        longest = fmax(longest, search->lengths[edge_at(search, i, (ptrdiff_t)edges)]);
        edges++;
        if (edges > most || (!closed && i + edges >= search->edges))
            return 0;
        turn += search->turns[(i + edges) % search->count];
    }
    double after = search->lengths[edge_at(search, i, (ptrdiff_t)edges)];
    return fabs(fabs(turn) - RIGHT) < RIGHT / 2 && longest <= fmin(before, after) ? edges + 1 : 0;
}

/// Flag the right turns, those that short edges cut off included. One alone is none.
static void flag_square(const corner_search *search, bool cut, unsigned char *flags)
{
    size_t n = search->count, first = search->curve->closed ? 0 : 1, end = search->curve->closed ? n : n - 1;
    size_t most = cut ? MAX_CUT_EDGES : 0, found = 0;
    for (size_t i = first; i < end; i++)
        found += right_turn(search, i, most) > 0;
    for (size_t i = first; i < end && found > 1; i++)
        for (size_t k = right_turn(search, i, most); k > 0; k--)
            flags[(i + k - 1) % n] = 1;
}

static bool is_right(double turn)
{
    return fabs(fabs(turn) - RIGHT) <= PAIR_WIDTH * ANGLE_DEGREE;
}

/// Whether a straight run ends at a vertex.
static bool ends_run(const corner_search *search, size_t i)
{
    size_t n = search->count;
    for (int side = -1; side <= 1; side += 2)
    {
        double most = 0;
        bool whole = search->curve->closed ? n > RUN_VERTICES + 1 : side < 0 ? i > RUN_VERTICES : i + RUN_VERTICES + 1 < n;
        for (size_t k = 1; k <= RUN_VERTICES && whole; k++)
            most = fmax(most, fabs(search->turns[(side < 0 ? i + n - k : i + k) % n]));
        if (whole && most <= RUN_TURN * ANGLE_DEGREE)
            return true;
    }
    return false;
}

/// How far a vertex lies from the chord between its neighbours.
static double deviation_at(const corner_search *search, size_t i)
{
    double before = search->lengths[edge_at(search, i, -1)], after = search->lengths[i];
    return 2 / (1 / before + 1 / after) * sin(fabs(search->turns[i]) / 2);
}

/// Whether a vertex turns between edges that are too long for arcs of a line of that tolerance.
static bool ends_long_edges(const corner_search *search, size_t i, double tolerance)
{
    double shorter = fmin(search->lengths[edge_at(search, i, -1)], search->lengths[i]), turn = fabs(search->turns[i]);
    return turn > MIN_CORNER * ANGLE_DEGREE && shorter > search->median && shorter * turn > MAX_ARC * tolerance;
}

/// Flag the vertices of a simplified line between long edges. One alone is none.
static void flag_simplified(const corner_search *search, unsigned char *flags)
{
    size_t n = search->count, first = search->curve->closed ? 0 : 1, end = search->curve->closed ? n : n - 1;
    size_t near = 0, found = 0;
    double least = INFINITY;
    for (size_t i = first; i < end; i++)
        least = fmin(least, deviation_at(search, i));
    for (size_t i = first; i < end; i++)
    {
        near += deviation_at(search, i) <= NEAR * least;
        found += ends_long_edges(search, i, least);
    }
    bool simplified = least > 0 && end >= first + MIN_VERTICES && (double)near >= MIN_NEAR * (double)(end - first);
    for (size_t i = first; i < end && simplified && found > 1; i++)
        flags[i] |= ends_long_edges(search, i, least);
}

static void flag_found(corner_search *search, unsigned char *flags)
{
    size_t n = search->count;
    const double *turns = search->turns;
    double whole = 0;
    for (size_t i = 0; i < n; i++)
        whole += turns[i];
    bool few =
        search->curve->closed && n <= FEW && fabs(whole) > CORNER_ANGLE_LIMIT; // of rings that do not cross themselves
    for (size_t i = 0; i < n; i++)
    {
        bool pair = is_right(turns[i]) && (is_right(turns[(i + 1) % n]) || is_right(turns[(i + n - 1) % n]));
        bool back = fabs(turns[i]) > (CORNER_ANGLE_LIMIT - PAIR_WIDTH * ANGLE_DEGREE);
        if (pair || back || (fabs(turns[i]) > MIN_CORNER * ANGLE_DEGREE && (few || ends_run(search, i))))
            flags[i] = 1;
    }
    bat_curve_edge_lengths(search->curve, search->lengths);
    flag_simplified(search, flags);
    if (search->curve->space->exterior_angle == NULL)
        return;
    find_directions(search);
    for (size_t w = 0; w < sizeof WIDTHS / sizeof *WIDTHS; w++)
    {
        double share = find_aligned(search, WIDTHS[w]);
        if (share >= MIN_SHARE)
            flag_square(search, share >= SQUARE_SHARE, flags);
    }
}

bat_status corners_find(const bat_curve *curve, const bat_curve_refine_options *options, unsigned char *flags, size_t *count,
                        bat_error *error)
{
    size_t n = curve->count;
    corner_search search = {.curve = curve, .count = n, .edges = polygon_edges(n, curve->closed)};
    bool searched = options->find_corners && corners_stay(options), turned = options->corner_angle > 0 || searched;
    search.turns = turned ? memory_pool_array(&search.pool, n, sizeof *search.turns) : NULL;
    search.lengths = searched ? memory_pool_array(&search.pool, n, sizeof *search.lengths) : NULL;
    search.directions = searched ? memory_pool_array(&search.pool, n, sizeof *search.directions) : NULL;
    search.aligned = searched ? memory_pool_array(&search.pool, n, 1) : NULL;
    bat_status status = memory_pool_check(&search.pool, error);
    if (status == BAT_OK && turned)
        status = find_turns(curve, search.turns, error);
    if (status == BAT_OK && searched)
        status = curves_median_edge(curve, 1, &search.median, error);
    for (size_t i = 0; i < n; i++)
        flags[i] = (curve->corners != NULL && curve->corners[i] != 0) ||
                   (status == BAT_OK && options->corner_angle > 0 && search.turns != NULL &&
                    fabs(search.turns[i]) > options->corner_angle);
    if (status == BAT_OK && searched)
        flag_found(&search, flags);
    *count = 0;
    for (size_t i = 0; i < n; i++)
        *count += flags[i];
    memory_pool_free(&search.pool);
    return status;
}
