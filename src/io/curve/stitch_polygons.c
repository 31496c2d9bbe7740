#include "io/curve/stitch.h"

#include "base/array_grow.h"
#include "base/bisect.h"

#include <math.h>

/// @file
/// Polygons that a file cuts at the seam, joined: edges on the seam are divided at each other's ends and cancelled.

typedef struct stitch_ring
{
    const bat_curve *curve;
    const double *degrees; ///< count x 2, of a closure over a pole on the seam
    size_t polygon;
    bool on_seam;  ///< has an edge on the seam, and therefore half-edges
    bool oriented; ///< the planar orientation is known: no edge crosses the map's border
    bool reversed; ///< half-edges run against the ring, so that the interior is on their left
} stitch_ring;

/// A directed edge of a ring, or a piece of one, from its origin to the origin of the next.
typedef struct stitch_half_edge
{
    size_t ring;
    size_t point; ///< the point at its origin, or before the origin of a piece
    size_t previous, next;
    double share;               ///< for the origin of a piece: from `point` to the next one; else 0
    double longitude, latitude; ///< the origin
    bool piece;                 ///< the origin divides an edge
    bool gone;                  ///< cancelled
    bool junction;              ///< edges before the origin have been cancelled
} stitch_half_edge;

typedef struct stitch_edges
{
    const stitch_geometry *geometry;
    const stitch_tolerance *tolerance;
    stitch_seam seam;
    stitch_ring *rings; ///< geometry->count
    double *snapped;    ///< the degrees of the rings
    stitch_half_edge *edges;
    size_t count, capacity;
    size_t *groups;      ///< for each polygon, another one that it is joined to, or itself at the root
    bool *changed;       ///< for each polygon, whether one of its edges was cancelled
    bool *north, *south; ///< for each polygon, whether a cancelled edge ends at the pole
    size_t cancelled;    ///< pairs of half-edges
    memory_pool pool;    ///< of all arrays but `edges`
} stitch_edges;

static const double QUARTER_TURN = 90.0, HALF_TURN = 180.0, TURN = 360.0;

/// Twice the signed area of a ring in longitude and latitude. False where an edge crosses the map's border, but for poles.
static bool planar_area(const stitch_edges *edges, const stitch_ring *ring, double *area)
{
    const double *degrees = ring->degrees;
    size_t count = ring->curve->count;
    *area = 0;
    for (size_t i = 0, j = count - 1; i < count; j = i++)
    {
        const double *a = degrees + 2 * j, *b = degrees + 2 * i;
        int pole = stitch_pole(&edges->seam, a[1]);
        bool along_pole = pole != 0 && pole == stitch_pole(&edges->seam, b[1]);
        // An edge along the whole map, such as the bottom of a box from -180 to 180 degrees, is one point of the seam.
        bool along_map = stitch_on_seam(&edges->seam, a[0]) && stitch_on_seam(&edges->seam, b[0]) && a[1] == b[1];
        if (fabs(a[0] - b[0]) > HALF_TURN && !along_pole && !along_map)
            return false;
        *area += (a[0] - degrees[0]) * (b[1] - degrees[1]) - (b[0] - degrees[0]) * (a[1] - degrees[1]);
    }
    return *area != 0;
}

/// The place of step `k` along the half-edges of a ring.
static size_t ring_point(const stitch_ring *ring, size_t k)
{
    size_t count = ring->curve->count;
    k %= count;
    return ring->reversed && k > 0 ? count - k : k;
}

/// Latitudes on the seam that differ by at most the tolerance are one node.
typedef struct seam_nodes
{
    double *latitudes; ///< the least one of each node, increasing
    size_t count;
    double tolerance;
} seam_nodes;

static void merge_nodes(seam_nodes *nodes)
{
    if (nodes->count > 0)
        qsort(nodes->latitudes, nodes->count, sizeof *nodes->latitudes, ascending);
    size_t count = 0;
    for (size_t i = 0; i < nodes->count; i++)
        if (count == 0 || nodes->latitudes[i] - nodes->latitudes[count - 1] > nodes->tolerance)
            nodes->latitudes[count++] = nodes->latitudes[i];
    nodes->count = count;
}

/// The last node that is not above a latitude.
static size_t node_of(const seam_nodes *nodes, double latitude)
{
    return bisect_reals(nodes->latitudes, 0, nodes->count, latitude);
}

static double clamped_latitude(const stitch_edges *edges, double latitude)
{
    int pole = stitch_pole(&edges->seam, latitude);
    return pole != 0 ? pole * QUARTER_TURN : latitude;
}

typedef enum edge_kind
{
    EDGE_ORDINARY,
    EDGE_SEAM,
    EDGE_VOID ///< both ends are one point
} edge_kind;

/// `nodes` may be null: then only equal points are one point.
static edge_kind kind_of(const stitch_edges *edges, const double *a, const double *b, const seam_nodes *nodes)
{
    const stitch_seam *seam = &edges->seam;
    int pole_a = stitch_pole(seam, a[1]), pole_b = stitch_pole(seam, b[1]);
    bool seam_a = stitch_on_seam(seam, a[0]), seam_b = stitch_on_seam(seam, b[0]);
    if (pole_a != 0 && pole_a == pole_b)
        return EDGE_VOID;
    if (!(seam_a || pole_a != 0) || !(seam_b || pole_b != 0) || !(seam_a || seam_b))
        return EDGE_ORDINARY;
    double from = clamped_latitude(edges, a[1]), to = clamped_latitude(edges, b[1]);
    bool same = nodes != NULL ? node_of(nodes, from) == node_of(nodes, to) : from == to;
    return same ? EDGE_VOID : EDGE_SEAM;
}

static const double *ring_degrees(const stitch_ring *ring, size_t k)
{
    return ring->degrees + 2 * ring_point(ring, k);
}

static bool find_nodes(stitch_edges *edges, seam_nodes *nodes)
{
    size_t capacity = 0;
    for (size_t r = 0; r < edges->geometry->count; r++)
    {
        stitch_ring *ring = &edges->rings[r];
        for (size_t k = 0; ring->curve != NULL && k < ring->curve->count; k++)
        {
            const double *a = ring_degrees(ring, k), *b = ring_degrees(ring, k + 1);
            if (kind_of(edges, a, b, NULL) != EDGE_SEAM)
                continue;
            ring->on_seam = true;
            if (!ARRAY_ADD(nodes->latitudes, capacity, nodes->count, clamped_latitude(edges, a[1])) ||
                !ARRAY_ADD(nodes->latitudes, capacity, nodes->count, clamped_latitude(edges, b[1])))
                return false;
        }
    }
    merge_nodes(nodes);
    return true;
}

/// A half-edge on the seam between a node and the next one above.
typedef struct seam_piece
{
    size_t interval; ///< the lower node
    size_t edge;
    bool up;
} seam_piece;

typedef struct seam_pieces
{
    seam_piece *pieces;
    size_t count, capacity;
} seam_pieces;

/// Add the half-edges of edge `k`, one for each interval between nodes when it lies on the seam.
static bool add_edge(stitch_edges *edges, const seam_nodes *nodes, size_t r, size_t k, seam_pieces *pieces)
{
    const stitch_ring *ring = &edges->rings[r];
    const double *a = ring_degrees(ring, k), *b = ring_degrees(ring, k + 1);
    stitch_half_edge half_edge = {.ring = r, .point = ring_point(ring, k), .longitude = a[0], .latitude = a[1]};
    edge_kind kind = kind_of(edges, a, b, nodes);
    if (kind == EDGE_VOID)
        return true;
    if (kind == EDGE_ORDINARY)
        return ARRAY_ADD(edges->edges, edges->capacity, edges->count, half_edge);
    double from = clamped_latitude(edges, a[1]), to = clamped_latitude(edges, b[1]);
    size_t low = node_of(nodes, from), high = node_of(nodes, to);
    bool up = low < high;
    size_t steps = up ? high - low : low - high;
    for (size_t i = 0; i < steps; i++)
    {
        size_t interval = up ? low + i : low - i - 1;
        if (i > 0)
        {
            half_edge.latitude = nodes->latitudes[up ? interval : interval + 1];
            half_edge.longitude = stitch_on_seam(&edges->seam, a[0]) ? a[0] : b[0];
            // Channels are those between the two points of the ring.
            half_edge.share = (half_edge.latitude - from) / (to - from);
            if (ring->reversed)
            {
                half_edge.point = ring_point(ring, k + 1);
                half_edge.share = 1 - half_edge.share;
            }
            half_edge.piece = true;
        }
        const seam_piece piece = {interval, edges->count, up};
        if (!ARRAY_ADD(pieces->pieces, pieces->capacity, pieces->count, piece) ||
            !ARRAY_ADD(edges->edges, edges->capacity, edges->count, half_edge))
            return false;
    }
    return true;
}

/// Make the half-edges of all rings with edges on the seam. Sets `*tangled` when there are too many.
static bool make_half_edges(stitch_edges *edges, const seam_nodes *nodes, seam_pieces *pieces, bool *tangled)
{
    // Valid polygons overlap nowhere, so that each interval has at most two edges; outlines of the whole map add some.
    static const size_t MAX_OVERLAPS = 64;
    for (size_t r = 0; r < edges->geometry->count && !*tangled; r++)
    {
        size_t first = edges->count;
        if (!edges->rings[r].on_seam)
            continue;
        for (size_t k = 0; k < edges->rings[r].curve->count && !*tangled; k++)
        {
            if (!add_edge(edges, nodes, r, k, pieces))
                return false;
            *tangled = pieces->count > MAX_OVERLAPS * (nodes->count + 1);
        }
        for (size_t i = first; i < edges->count; i++)
        {
            edges->edges[i].previous = i > first ? i - 1 : edges->count - 1;
            edges->edges[i].next = i + 1 < edges->count ? i + 1 : first;
        }
    }
    return true;
}

/// The root of a polygon's group: the first polygon of those that are joined.
static size_t stitch_edges_group(const stitch_edges *edges, size_t polygon)
{
    while (edges->groups[polygon] != polygon)
        polygon = edges->groups[polygon] = edges->groups[edges->groups[polygon]];
    return polygon;
}

static void link_edges(stitch_edges *edges, size_t before, size_t after)
{
    edges->edges[before].next = after;
    edges->edges[after].previous = before;
    edges->edges[after].junction = true;
}

static void mark(stitch_edges *edges, const stitch_half_edge *edge)
{
    size_t polygon = edges->rings[edge->ring].polygon;
    const stitch_half_edge *next = &edges->edges[edge->next];
    int begin = stitch_pole(&edges->seam, edge->latitude), end = stitch_pole(&edges->seam, next->latitude);
    edges->changed[polygon] = true;
    edges->north[polygon] = edges->north[polygon] || begin > 0 || end > 0;
    edges->south[polygon] = edges->south[polygon] || begin < 0 || end < 0;
}

/// Remove two opposite half-edges: what comes before one continues with what comes after the other.
static void cancel(stitch_edges *edges, size_t first, size_t second)
{
    stitch_half_edge *a = &edges->edges[first], *b = &edges->edges[second];
    mark(edges, a);
    mark(edges, b);
    size_t group = stitch_edges_group(edges, edges->rings[a->ring].polygon);
    size_t other = stitch_edges_group(edges, edges->rings[b->ring].polygon);
    edges->groups[group > other ? group : other] = group < other ? group : other;
    bool a_then_b = a->next == second, b_then_a = b->next == first; // a spike; both: nothing is left
    size_t before_a = a->previous, after_a = a->next, before_b = b->previous, after_b = b->next;
    if (!b_then_a)
        link_edges(edges, before_a, after_b);
    if (!a_then_b)
        link_edges(edges, before_b, after_a);
    a->gone = b->gone = true;
    edges->cancelled++;
}

static int compare_pieces(const void *a, const void *b)
{
    const seam_piece *p = a, *q = b;
    int order = p->interval != q->interval ? ORDER_OF(p->interval, q->interval) : ORDER_OF(q->up, p->up);
    return order != 0 ? order : ORDER_OF(p->edge, q->edge);
}

/// Cancel the half-edges of every interval that run up and down, in pairs.
static void cancel_all(stitch_edges *edges, seam_pieces *pieces)
{
    if (pieces->count > 0)
        qsort(pieces->pieces, pieces->count, sizeof *pieces->pieces, compare_pieces);
    for (size_t begin = 0, end; begin < pieces->count; begin = end)
    {
        const seam_piece *piece = pieces->pieces;
        size_t down = begin;
        while (down < pieces->count && piece[down].interval == piece[begin].interval && piece[down].up)
            down++;
        for (end = down; end < pieces->count && piece[end].interval == piece[begin].interval;)
            end++;
        for (size_t i = 0; begin + i < down && down + i < end; i++)
            cancel(edges, piece[begin + i].edge, piece[down + i].edge);
    }
}

/// Degrees by which a closure over a pole may end short of the seam: a kilometre on the equator, nothing at the pole.
static const double MAX_GAP = 1e-2;

/// The turn of a ring around the axis, but for its edges at poles.
static double turn_off_poles(const stitch_seam *seam, const double *degrees, size_t count)
{
    double turn = 0;
    for (size_t i = 0, j = count - 1; i < count; j = i++)
        if (stitch_pole(seam, degrees[2 * j + 1]) == 0 && stitch_pole(seam, degrees[2 * i + 1]) == 0)
            turn += remainder(degrees[2 * i] - degrees[2 * j], TURN);
    return turn;
}

/// Move the points after one at a pole, by `step` points each, onto the seam: those on one meridian near it.
static void snap_meridian(const stitch_seam *seam, const stitch_ring *ring, size_t pole, size_t step, double *snapped)
{
    const double *degrees = ring->degrees;
    size_t count = ring->curve->count, at = (pole + step) % count;
    double longitude = degrees[2 * at], gap = remainder(longitude - seam->longitude, TURN);
    while (fabs(gap) <= MAX_GAP + seam->near && snapped[2 * at] != longitude - gap &&
           stitch_pole(seam, degrees[2 * at + 1]) == 0 && fabs(degrees[2 * at] - longitude) <= seam->near)
    {
        snapped[2 * at] = longitude - gap;
        at = (at + step) % count;
    }
}

/// Give vertices that follow each other along the seam the same sign: no border goes around the Earth between two latitudes.
static void match_sides(const stitch_seam *seam, size_t count, double *degrees)
{
    size_t first = 0;
    while (first < count && stitch_on_seam(seam, degrees[2 * first]))
        first++;
    for (size_t k = 1; k < count && first < count; k++)
    {
        const double *before = degrees + 2 * ((first + k - 1) % count);
        double *here = degrees + 2 * ((first + k) % count);
        if (stitch_on_seam(seam, before[0]) && stitch_on_seam(seam, here[0]) && before[1] != here[1] &&
            fabs(before[0] - here[0]) > HALF_TURN)
            here[0] = before[0];
    }
}

/// Move a closure over a pole that ends short of the seam onto it. The ring then has its degrees in `snapped`.
static void snap_closure(const stitch_seam *seam, stitch_ring *ring, double *snapped)
{
    size_t count = ring->curve->count;
    memcpy(snapped, ring->degrees, 2 * count * sizeof *snapped);
    match_sides(seam, count, snapped);
    // A wedge with its tip at a pole does not go around the axis.
    bool around = fabs(turn_off_poles(seam, ring->degrees, count)) > HALF_TURN;
    for (size_t i = 0; i < count && around; i++)
        if (stitch_pole(seam, ring->degrees[2 * i + 1]) != 0)
        {
            snap_meridian(seam, ring, i, 1, snapped);
            snap_meridian(seam, ring, i, count - 1, snapped);
        }
    ring->degrees = snapped;
}

/// Make the half-edges of the rings with edges on the seam, and cancel opposite ones. Rings with very many overlapping edges
/// are left alone. False when out of memory.
static bool stitch_edges_make(const stitch_geometry *geometry, const double *degrees, const stitch_tolerance *tolerance,
                              stitch_edges *edges)
{
    *edges = (stitch_edges){.geometry = geometry, .tolerance = tolerance};
    size_t polygons = geometry->polygon_count, point = 0, ring = 0;
    edges->rings = memory_pool_zeros(&edges->pool, geometry->count + 1, sizeof *edges->rings);
    edges->groups = memory_pool_array(&edges->pool, polygons, sizeof *edges->groups);
    edges->changed = memory_pool_zeros(&edges->pool, polygons + 1, sizeof *edges->changed);
    edges->north = memory_pool_zeros(&edges->pool, polygons + 1, sizeof *edges->north);
    edges->south = memory_pool_zeros(&edges->pool, polygons + 1, sizeof *edges->south);
    if (edges->pool.missing > 0)
        return false;
    for (size_t i = 0; i < geometry->polygon_count; i++)
    {
        edges->groups[i] = i;
        for (size_t k = 0; k < geometry->polygons[i].rings; k++, ring++)
        {
            edges->rings[ring] =
                (stitch_ring){.curve = &geometry->curves[ring], .degrees = degrees + 2 * point, .polygon = i};
            point += geometry->curves[ring].count;
        }
    }
    edges->seam = stitch_seam_of(degrees, point);
    edges->snapped = memory_pool_array(&edges->pool, point, 2 * sizeof *edges->snapped);
    if (edges->snapped == NULL)
        return false;
    ring = 0;
    for (size_t i = 0; i < geometry->polygon_count; i++)
        for (size_t k = 0; k < geometry->polygons[i].rings; k++, ring++)
        {
            stitch_ring *made = &edges->rings[ring];
            snap_closure(&edges->seam, made, edges->snapped + (made->degrees - degrees));
            // The interior of the polygon is on the left of the half-edges.
            double area;
            made->oriented = planar_area(edges, made, &area);
            made->reversed = made->oriented && (area < 0) != (k > 0);
        }
    seam_nodes nodes = {.tolerance = tolerance->latitude};
    seam_pieces pieces = {0};
    bool tangled = false;
    bool done = find_nodes(edges, &nodes) && make_half_edges(edges, &nodes, &pieces, &tangled);
    if (done && !tangled)
        cancel_all(edges, &pieces);
    free(nodes.latitudes);
    free(pieces.pieces);
    return done;
}

// Polygons from the half-edges that are left: their rings, and what is inside.

/// A ring of half-edges, or a given ring without edges on the seam.
typedef struct traced_ring
{
    size_t first;   ///< the half-edge at which it begins, or BAT_NO_INDEX
    size_t given;   ///< the given ring at its start
    size_t group;   ///< the first polygon of its group
    double winding; ///< how often it goes around the axis, eastwards
    double area;    ///< of the side on its left, modulo 2 pi; without a meaning when it goes around the axis
} traced_ring;

typedef struct polygon_job
{
    stitch_edges edges;
    traced_ring *rings;
    size_t ring_count, ring_capacity;
    unsigned char *fates; ///< for each polygon that begins a group
    bool *several;        ///< for each such polygon, whether others are joined to it
} polygon_job;

/// What becomes of the polygons of a group.
typedef enum group_fate
{
    FATE_STAYS, ///< nothing was cancelled, or the rings are no polygon
    FATE_WHOLE, ///< the interior contains both poles; stays
    FATE_STITCHED
} group_fate;

/// Sum up the turn around the axis and the area on the left of a ring, edge by edge. The integral of sin(latitude) over the
/// longitude is that of globe_polygon_cut(). A pole has the longitude before it.
typedef struct ring_sums
{
    double longitude, half_tangent;
    double turn, integral;
    bool begun;
} ring_sums;

static void add_to_sums(ring_sums *sums, const stitch_seam *seam, double longitude, double latitude)
{
    static const double RADIAN = 57.295779513082320876798154814105;
    int pole = stitch_pole(seam, latitude);
    double half_tangent = pole != 0 ? pole : tan(0.5 * latitude / RADIAN);
    if (pole != 0 && sums->begun)
        longitude = sums->longitude;
    if (sums->begun)
    {
        double step = longitude - sums->longitude;
        if (fabs(step) > HALF_TURN)
            step -= TURN * rint(step / TURN);
        sums->turn += step;
        sums->integral +=
            2 * atan2(tan(0.5 * step / RADIAN) * (sums->half_tangent + half_tangent), 1 + sums->half_tangent * half_tangent);
    }
    sums->longitude = longitude;
    sums->half_tangent = half_tangent;
    sums->begun = true;
}

/// Whether a half-edge is the first of its ring.
static bool begins_ring(const stitch_edges *edges, size_t edge)
{
    return edge == 0 || edges->edges[edge - 1].ring != edges->edges[edge].ring;
}

/// Whether ring start `a` is a better start of a joined ring than `b`: off the seam, and earlier in the file.
static bool is_better_start(const stitch_edges *edges, size_t a, size_t b)
{
    const stitch_half_edge *p = &edges->edges[a], *q = &edges->edges[b];
    bool starts_p = begins_ring(edges, a), starts_q = begins_ring(edges, b);
    bool off_p = starts_p && !stitch_on_seam(&edges->seam, p->longitude);
    bool off_q = starts_q && !stitch_on_seam(&edges->seam, q->longitude);
    return off_p != off_q ? off_p : starts_p != starts_q ? starts_p : a < b;
}

static traced_ring trace(const stitch_edges *edges, size_t edge, bool *used)
{
    traced_ring ring = {.first = edge};
    ring_sums sums = {.begun = false};
    size_t at = edge;
    do
    {
        used[at] = true;
        if (is_better_start(edges, at, ring.first))
            ring.first = at;
        at = edges->edges[at].next;
    } while (at != edge);
    // Begin off the poles, which have no longitude.
    size_t begin = edge;
    while (stitch_pole(&edges->seam, edges->edges[begin].latitude) != 0 && edges->edges[begin].next != edge)
        begin = edges->edges[begin].next;
    at = begin;
    do
    {
        add_to_sums(&sums, &edges->seam, edges->edges[at].longitude, edges->edges[at].latitude);
        at = edges->edges[at].next;
    } while (at != begin);
    add_to_sums(&sums, &edges->seam, edges->edges[begin].longitude, edges->edges[begin].latitude);
    ring.winding = rint(sums.turn / TURN);
    ring.area = -sums.integral;
    ring.given = edges->edges[ring.first].ring;
    ring.group = stitch_edges_group(edges, edges->rings[ring.given].polygon);
    return ring;
}

/// All rings: those of half-edges, and the given ones without any.
static bool trace_all(polygon_job *job)
{
    const stitch_edges *edges = &job->edges;
    bool *used = calloc(edges->count + 1, sizeof *used);
    bool done = used != NULL;
    for (size_t i = 0; i < edges->count && done; i++)
        if (!used[i] && !edges->edges[i].gone)
            done = ARRAY_ADD(job->rings, job->ring_capacity, job->ring_count, trace(edges, i, used));
    free(used);
    for (size_t r = 0, before = BAT_NO_INDEX; r < edges->geometry->count && done; r++)
    {
        size_t polygon = edges->rings[r].polygon;
        bool outer = polygon != before;
        before = polygon;
        const traced_ring ring = {BAT_NO_INDEX, r, stitch_edges_group(edges, polygon), 0, outer ? 1 : -1};
        if (!edges->rings[r].on_seam)
            done = ARRAY_ADD(job->rings, job->ring_capacity, job->ring_count, ring);
    }
    return done;
}

/// Rings by group. In a group the outer one comes first, then the order is that of the file.
static int compare_rings(const void *a, const void *b)
{
    const traced_ring *p = a, *q = b;
    if (p->group != q->group)
        return p->group < q->group ? -1 : 1;
    bool outer_p = p->winding != 0 || p->area > 0, outer_q = q->winding != 0 || q->area > 0;
    if (outer_p != outer_q)
        return outer_p ? -1 : 1;
    if (p->given != q->given)
        return p->given < q->given ? -1 : 1;
    return (p->first > q->first) - (p->first < q->first);
}

/// The number of rings of the group that begins at `begin`.
static size_t group_size(const polygon_job *job, size_t begin)
{
    size_t end = begin;
    while (end < job->ring_count && job->rings[end].group == job->rings[begin].group)
        end++;
    return end - begin;
}

/// The edges that cancel join the interior on both sides. So the rings of a group bound one polygon: one outer ring, or one
/// around the axis with a pole inside, or two around it with a belt between them.
static group_fate decide(const traced_ring *rings, size_t count)
{
    size_t outer = 0, around = 0;
    double winding = 0;
    for (size_t i = 0; i < count; i++)
    {
        around += rings[i].winding != 0;
        outer += rings[i].winding == 0 && rings[i].area > 0;
        winding += rings[i].winding;
    }
    if (outer == 0 && around == 0)
        return FATE_WHOLE;
    if (outer + around == 1 || (outer == 0 && around == 2 && winding == 0))
        return FATE_STITCHED;
    return FATE_STAYS;
}

/// The pole in the interior of a polygon with one ring around the axis.
static int pole_of(const stitch_edges *edges, const traced_ring *rings, size_t count)
{
    double winding = 0;
    bool oriented = true, north = false, south = false;
    size_t group = rings[0].group;
    for (size_t i = 0; i < count; i++)
        winding += rings[i].winding;
    if (winding == 0)
        return 0;
    for (size_t r = 0; r < edges->geometry->count; r++)
    {
        size_t polygon = edges->rings[r].polygon;
        if (stitch_edges_group(edges, polygon) != group)
            continue;
        oriented = oriented && (edges->rings[r].oriented || !edges->rings[r].on_seam);
        north = north || edges->north[polygon];
        south = south || edges->south[polygon];
    }
    if (oriented)
        return winding > 0 ? 1 : -1;
    return (int)north - (int)south;
}

/// Collect the vertices of a ring, in the direction of the given ring at its start.
static bool collect(const stitch_edges *edges, const traced_ring *ring, stitch_path *path)
{
    path->count = 0;
    size_t at = ring->first;
    do
    {
        const stitch_half_edge *edge = &edges->edges[at];
        // A piece that follows the piece before it on the same edge needs no vertex.
        bool inner = edge->piece && !edge->junction;
        const stitch_vertex vertex = {.curve = edges->rings[edge->ring].curve,
                                      .point = edge->point,
                                      .share = edge->piece ? edge->share : 0,
                                      .longitude = edge->longitude,
                                      .latitude = edge->latitude,
                                      .junction = edge->junction};
        if (!inner && !ARRAY_ADD(path->vertices, path->capacity, path->count, vertex))
            return false;
        at = edge->next;
    } while (at != ring->first);
    if (!edges->rings[ring->given].reversed)
        return true;
    for (size_t i = 1, j = path->count; i + 1 < j; i++, j--)
        SWAP(path->vertices[i], path->vertices[j - 1]);
    return true;
}

static bool make_group(polygon_job *job, size_t begin, size_t count, stitch_path *path, stitch_geometry *made,
                       stitch_report *report)
{
    const traced_ring *rings = job->rings + begin;
    const stitch_edges *edges = &job->edges;
    for (size_t i = 0; i < count; i++, made->count++)
    {
        made->origins[made->count] = (stitch_origin){.part = rings[i].given};
        if (rings[i].first == BAT_NO_INDEX)
            continue; // a given ring, whose curve stays empty until everything has been made
        if (!collect(edges, &rings[i], path) ||
            !stitch_make_curve(path, true, edges->tolerance, &report->removed, &made->curves[made->count]))
            return false;
    }
    made->polygons[made->polygon_count++] = (stitch_polygon){count, pole_of(&job->edges, rings, count)};
    report->poles += rings[0].winding != 0;
    return true;
}

/// Make all polygons, in the order of their first parts.
static bool make_polygons(polygon_job *job, stitch_geometry *made, stitch_report *report)
{
    const stitch_geometry *geometry = job->edges.geometry;
    stitch_path path = {0};
    bool done = true;
    size_t first_ring = 0, at = 0;
    for (size_t i = 0; i < geometry->polygon_count && done; i++)
    {
        size_t group = stitch_edges_group(&job->edges, i);
        group_fate fate = (group_fate)job->fates[group];
        for (size_t r = 0; fate != FATE_STITCHED && r < geometry->polygons[i].rings; r++)
            made->origins[made->count++] = (stitch_origin){.part = first_ring + r};
        if (fate != FATE_STITCHED)
            made->polygons[made->polygon_count++] = geometry->polygons[i];
        first_ring += geometry->polygons[i].rings;
        if (fate == FATE_STITCHED && group != i)
        {
            report->joined++;
            report->joins += !job->several[group];
            job->several[group] = true;
        }
        if (group != i)
            continue;
        while (at < job->ring_count && job->rings[at].group < i)
            at++;
        if (fate == FATE_STITCHED)
            done = make_group(job, at, group_size(job, at), &path, made, report);
    }
    free(path.vertices);
    return done;
}

/// Decide on all groups. Returns whether any is stitched.
static bool decide_all(polygon_job *job, stitch_report *report)
{
    bool any = false;
    const stitch_edges *edges = &job->edges;
    for (size_t i = 0; i < edges->geometry->polygon_count; i++)
        if (stitch_edges_group(edges, i) == i && edges->changed[i])
            job->fates[i] = FATE_WHOLE; // when no ring is left
    for (size_t begin = 0, count; begin < job->ring_count; begin += count)
    {
        count = group_size(job, begin);
        size_t group = job->rings[begin].group;
        group_fate fate = edges->changed[group] ? decide(job->rings + begin, count) : FATE_STAYS;
        job->fates[group] = (unsigned char)fate;
    }
    for (size_t i = 0; i < edges->geometry->polygon_count; i++)
    {
        group_fate fate = (group_fate)job->fates[stitch_edges_group(edges, i)];
        any = any || fate == FATE_STITCHED;
        report->unrepresented += fate == FATE_WHOLE;
    }
    return any;
}

/// Take over the given rings that stay, and replace the arrays.
static void replace(stitch_geometry *geometry, stitch_geometry *made)
{
    for (size_t i = 0; i < made->count; i++)
    {
        size_t ring = made->origins[i].part;
        if (made->curves[i].points == NULL)
        {
            made->curves[i] = geometry->curves[ring];
            geometry->curves[ring] = (bat_curve){0};
        }
        made->origins[i] = geometry->origins[ring];
    }
    stitch_geometry_free(geometry);
    *geometry = *made;
}

static bool stitch(polygon_job *job, stitch_geometry *geometry, stitch_report *report)
{
    job->fates = memory_pool_zeros(&job->edges.pool, geometry->polygon_count, 1);
    job->several = memory_pool_zeros(&job->edges.pool, geometry->polygon_count, sizeof *job->several);
    if (job->fates == NULL || job->several == NULL || !trace_all(job))
        return false;
    if (job->ring_count > 0)
        qsort(job->rings, job->ring_count, sizeof *job->rings, compare_rings);
    if (!decide_all(job, report))
        return true;
    size_t curves = geometry->count + job->ring_count, polygons = geometry->polygon_count;
    stitch_geometry made = {.curves = calloc(curves, sizeof *made.curves),
                            .origins = memory_array(curves, sizeof *made.origins),
                            .polygons = memory_array(polygons, sizeof *made.polygons)};
    bool done = made.curves != NULL && made.origins != NULL && made.polygons != NULL && make_polygons(job, &made, report);
    if (done)
        replace(geometry, &made);
    else
        stitch_geometry_free(&made);
    return done;
}

bool stitch_polygons(stitch_geometry *geometry, const double *degrees, const stitch_tolerance *tolerance,
                     stitch_report *report)
{
    polygon_job job = {0};
    stitch_report found = {0};
    bool done = stitch_edges_make(geometry, degrees, tolerance, &job.edges);
    if (done && job.edges.cancelled > 0)
        done = stitch(&job, geometry, &found);
    if (done)
        *report = found;
    free(job.edges.edges);
    memory_pool_free(&job.edges.pool);
    free(job.rings);
    return done;
}
