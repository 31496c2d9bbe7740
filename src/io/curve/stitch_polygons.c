#include "io/curve/stitch_seam.h"

#include "base/array_grow.h"

#include <math.h>
#include <string.h>

/// @file
/// Polygons from the half-edges that are left: their rings, and what is inside.

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
    static const double HALF_TURN = 180.0, TURN = 360.0, RADIAN = 57.295779513082320876798154814105;
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
    if (off_p != off_q)
        return off_p;
    if (starts_p != starts_q)
        return starts_p;
    return a < b;
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
    static const double TURN = 360.0;
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
    {
        if (used[i] || edges->edges[i].gone)
            continue;
        done = ARRAY_ADD(job->rings, job->ring_capacity, job->ring_count, trace(edges, i, used));
    }
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
    for (size_t i = 1, j = path->count - 1; i < j; i++, j--)
    {
        stitch_vertex other = path->vertices[i];
        path->vertices[i] = path->vertices[j];
        path->vertices[j] = other;
    }
    return true;
}

/// Append one ring of a group. A given ring is moved when everything has been made; until then its curve is empty here.
static bool make_ring(polygon_job *job, const traced_ring *ring, stitch_path *path, stitch_geometry *made,
                      stitch_report *report)
{
    const stitch_edges *edges = &job->edges;
    made->origins[made->count] = (stitch_origin){.part = ring->given};
    bat_curve *curve = &made->curves[made->count];
    if (ring->first != BAT_NO_INDEX)
    {
        if (!collect(edges, ring, path))
            return false;
        if (!stitch_make_curve(path, true, edges->tolerance, &report->removed, curve))
            return false;
    }
    made->count++;
    return true;
}

static bool make_group(polygon_job *job, size_t begin, size_t count, stitch_path *path, stitch_geometry *made,
                       stitch_report *report)
{
    const traced_ring *rings = job->rings + begin;
    for (size_t i = 0; i < count; i++)
        if (!make_ring(job, &rings[i], path, made, report))
            return false;
    made->polygons[made->polygon_count++] = (stitch_polygon){count, pole_of(&job->edges, rings, count)};
    report->poles += rings[0].winding != 0;
    return true;
}

/// Append a given polygon as it is.
static void keep_polygon(const polygon_job *job, size_t polygon, size_t first_ring, stitch_geometry *made)
{
    const stitch_geometry *geometry = job->edges.geometry;
    for (size_t i = 0; i < geometry->polygons[polygon].rings; i++)
        made->origins[made->count++] = (stitch_origin){.part = first_ring + i};
    made->polygons[made->polygon_count++] = geometry->polygons[polygon];
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
        if (fate != FATE_STITCHED)
            keep_polygon(job, i, first_ring, made);
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
    job->fates = calloc(geometry->polygon_count + 1, 1);
    job->several = calloc(geometry->polygon_count + 1, sizeof *job->several);
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
    stitch_edges_free(&job.edges);
    free(job.rings);
    free(job.fates);
    free(job.several);
    return done;
}
