#include "io/curve/stitch_seam.h"

#include "base/array_grow.h"

#include <math.h>
#include <string.h>

static const double QUARTER_TURN = 90.0, HALF_TURN = 180.0, TURN = 360.0;

/// Twice the signed area of a ring in the plane of longitude and latitude. False when an edge crosses the border of the map,
/// except along a pole.
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

/// Orient the half-edges of a ring so that the interior of its polygon is on their left.
static void orient(const stitch_edges *edges, stitch_ring *ring, bool hole)
{
    double area;
    ring->oriented = planar_area(edges, ring, &area);
    ring->reversed = ring->oriented && (area < 0) != hole;
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

static int compare_doubles(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

static void merge_nodes(seam_nodes *nodes)
{
    if (nodes->count > 0)
        qsort(nodes->latitudes, nodes->count, sizeof *nodes->latitudes, compare_doubles);
    size_t count = 0;
    for (size_t i = 0; i < nodes->count; i++)
        if (count == 0 || nodes->latitudes[i] - nodes->latitudes[count - 1] > nodes->tolerance)
            nodes->latitudes[count++] = nodes->latitudes[i];
    nodes->count = count;
}

/// The last node that is not above a latitude.
static size_t node_of(const seam_nodes *nodes, double latitude)
{
    size_t low = 0, high = nodes->count;
    while (high - low > 1)
    {
        size_t middle = low + (high - low) / 2;
        if (nodes->latitudes[middle] <= latitude)
            low = middle;
        else
            high = middle;
    }
    return low;
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

/// Find the edges on the seam and their nodes.
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
    enum
    {
        MAX_OVERLAPS = 64
    };
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

size_t stitch_edges_group(const stitch_edges *edges, size_t polygon)
{
    while (edges->groups[polygon] != polygon)
        polygon = edges->groups[polygon] = edges->groups[edges->groups[polygon]];
    return polygon;
}

static void join_groups(stitch_edges *edges, size_t a, size_t b)
{
    a = stitch_edges_group(edges, a);
    b = stitch_edges_group(edges, b);
    edges->groups[a > b ? a : b] = a < b ? a : b;
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
    join_groups(edges, edges->rings[a->ring].polygon, edges->rings[b->ring].polygon);
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
    if (p->interval != q->interval)
        return p->interval < q->interval ? -1 : 1;
    if (p->up != q->up)
        return p->up ? -1 : 1;
    return (p->edge > q->edge) - (p->edge < q->edge);
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

static bool allocate(stitch_edges *edges)
{
    size_t rings = edges->geometry->count, polygons = edges->geometry->polygon_count;
    edges->rings = calloc(rings + 1, sizeof *edges->rings);
    edges->groups = memory_array(polygons, sizeof *edges->groups);
    edges->changed = calloc(polygons + 1, sizeof *edges->changed);
    edges->north = calloc(polygons + 1, sizeof *edges->north);
    edges->south = calloc(polygons + 1, sizeof *edges->south);
    return edges->rings != NULL && edges->groups != NULL && edges->changed != NULL && edges->north != NULL &&
           edges->south != NULL;
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

/// Move the points that follow one at a pole, by `step` points each, onto the seam: as long as they are on one meridian near
/// it.
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

/// Move a closure over a pole that ends short of the seam onto it. The ring then has its degrees in `snapped`.
static void snap_closure(const stitch_seam *seam, stitch_ring *ring, double *snapped)
{
    size_t count = ring->curve->count;
    memcpy(snapped, ring->degrees, 2 * count * sizeof *snapped);
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

bool stitch_edges_make(const stitch_geometry *geometry, const double *degrees, const stitch_tolerance *tolerance,
                       stitch_edges *edges)
{
    *edges = (stitch_edges){.geometry = geometry, .tolerance = tolerance};
    if (!allocate(edges))
        return false;
    size_t point = 0, ring = 0;
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
    edges->snapped = memory_array(point, 2 * sizeof *edges->snapped);
    if (edges->snapped == NULL)
        return false;
    ring = 0;
    for (size_t i = 0; i < geometry->polygon_count; i++)
        for (size_t k = 0; k < geometry->polygons[i].rings; k++, ring++)
        {
            snap_closure(&edges->seam, &edges->rings[ring], edges->snapped + (edges->rings[ring].degrees - degrees));
            orient(edges, &edges->rings[ring], k > 0);
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

void stitch_edges_free(stitch_edges *edges)
{
    free(edges->rings);
    free(edges->snapped);
    free(edges->edges);
    free(edges->groups);
    free(edges->changed);
    free(edges->north);
    free(edges->south);
    *edges = (stitch_edges){0};
}
