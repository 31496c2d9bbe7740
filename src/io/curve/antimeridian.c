#include "io/curve/geojson_shape.h"
#include "linalg/vector.h"

#include <assert.h>

/// @file
/// Crossings of the antimeridian by geodesic edges, in exact units of the file's decimals.

degree_grid degree_grid_of(int decimals)
{
    int64_t degree = degree_units_per_degree(decimals);
    return (degree_grid){180 * degree, 90 * degree, degree_units_per_radian(decimals)};
}

static void globe_lines_add(globe_lines *lines, globe_position position)
{
    lines->failed = lines->failed || !ARRAY_ADD(lines->positions, lines->position_capacity, lines->position_count, position);
}

static void globe_lines_end(globe_lines *lines)
{
    lines->failed = lines->failed || !ARRAY_ADD(lines->ends, lines->capacity, lines->count, lines->position_count);
}

void globe_lines_free(globe_lines *lines)
{
    free(lines->positions);
    free(lines->ends);
    *lines = (globe_lines){0};
}

static globe_position globe_curve_position(const globe_curve *curve, size_t index)
{
    return (globe_position){.shown = curve->shown[index],
                            .values = curve->values != NULL ? curve->values + index * curve->value_stride : NULL};
}

void globe_curve_add(const globe_curve *curve, bool repeat_first, globe_lines *lines)
{
    for (size_t i = 0; i < curve->count; i++)
        globe_lines_add(lines, globe_curve_position(curve, i));
    if (repeat_first)
        globe_lines_add(lines, globe_curve_position(curve, 0));
    globe_lines_end(lines);
}

double globe_position_value(const globe_position *position, size_t index)
{
    double value = position->values[index];
    return position->share > 0 ? value + position->share * (position->after[index] - value) : value;
}

static bool on_pole(const degree_grid *grid, degree_units shown)
{
    return shown.latitude == grid->quarter_turn || shown.latitude == -grid->quarter_turn;
}

static bool on_meridian(const degree_grid *grid, degree_units shown)
{
    return shown.longitude == grid->half_turn || shown.longitude == -grid->half_turn;
}

/// Take the longitude of a vertex at a pole, or its sign on the antimeridian, from a neighbour.
static void assign_longitude(const degree_grid *grid, degree_units *shown, degree_units neighbour)
{
    if (on_pole(grid, *shown))
        shown->longitude = neighbour.longitude;
    else if (on_meridian(grid, *shown))
        shown->longitude = neighbour.longitude < 0 ? -grid->half_turn : grid->half_turn;
}

static void assign_longitudes(const degree_grid *grid, const globe_curve *curve)
{
    degree_units *shown = curve->shown;
    size_t count = curve->count, first = 0;
    while (first < count && (on_pole(grid, shown[first]) || on_meridian(grid, shown[first])))
        first++;
    if (first == count)
    {
        for (size_t i = 0; i < count; i++)
            assign_longitude(grid, &shown[i], (degree_units){0});
        return;
    }
    for (size_t i = first + 1; i < count; i++)
        assign_longitude(grid, &shown[i], shown[i - 1]);
    if (curve->closed)
        for (size_t i = 0; i < first; i++)
            assign_longitude(grid, &shown[i], shown[i == 0 ? count - 1 : i - 1]);
    else
        for (size_t i = first; i > 0; i--)
            assign_longitude(grid, &shown[i - 1], shown[i]);
}

/// How far a ring goes around the axis, and the integral of sin(latitude) over the longitude, in radians.
///
/// Let t_1, t_2 be the tangents of half the latitudes at the ends of an arc, and d its longitude difference. Then the
/// integral is 2 atan(tan(d / 2) (t_1 + t_2) / (1 + t_1 t_2)).
static void ring_integral(const degree_grid *grid, const globe_curve *ring, double *turn, double *integral)
{
    *turn = *integral = 0.0;
    for (size_t i = 0; i < ring->count; i++)
    {
        const degree_units a = ring->shown[i], b = ring->shown[i + 1 < ring->count ? i + 1 : 0];
        int64_t step = b.longitude - a.longitude;
        if (llabs(step) > grid->half_turn)
            step += step > 0 ? -2 * grid->half_turn : 2 * grid->half_turn;
        double angle = (double)step / grid->units_per_radian;
        double t1 = tan(0.5 * (double)a.latitude / grid->units_per_radian);
        double t2 = tan(0.5 * (double)b.latitude / grid->units_per_radian);
        *turn += angle;
        *integral += 2.0 * atan2(tan(0.5 * angle) * (t1 + t2), 1.0 + t1 * t2);
    }
}

/// Whether the smaller side of a ring around the axis contains the south pole, after globe_curve_show(). The integral over
/// the ring is positive when the area north of it is less than 2 pi.
static bool globe_ring_encloses_south(const degree_grid *grid, const globe_curve *ring)
{
    if (ring->pole != 0)
        return ring->pole < 0;
    double turn, integral;
    ring_integral(grid, ring, &turn, &integral);
    double north = turn < 0.0 ? -integral : integral;
    return north < 0.0 || (north == 0.0 && turn < 0.0);
}

static bool interior_is_left(const degree_grid *grid, const globe_curve *ring)
{
    double turn, integral;
    ring_integral(grid, ring, &turn, &integral);
    bool hole = ring->role == GLOBE_HOLE;
    if (fabs(turn) < 1.0)
        return (integral < 0.0) != hole;
    return ((turn > 0.0) != globe_ring_encloses_south(grid, ring)) != hole;
}

bool geojson_interior_is_left(const geojson_style *style, const globe_curve *ring)
{
    if (style->globe)
        return interior_is_left(&style->grid, ring);
    double area = 0;
    for (size_t i = 0; i < ring->count; i++)
    {
        const double *p = ring->points + 2 * i, *q = ring->points + 2 * (i + 1 < ring->count ? i + 1 : 0);
        area += p[0] * q[1] - q[0] * p[1];
    }
    return (area > 0) != (ring->role == GLOBE_HOLE);
}

/// Give vertices after edges along the antimeridian the sign of the interior: going north, 180 degrees when it is on the
/// left. At poles set the direction in which the interior lies.
static void assign_border_sides(const degree_grid *grid, globe_curve *ring)
{
    bool known = false, left = false;
    for (size_t i = 0; i < ring->count; i++)
    {
        const degree_units before = ring->shown[i > 0 ? i - 1 : ring->count - 1];
        degree_units *shown = &ring->shown[i];
        if (on_pole(grid, *shown) && ring->pole_turn == 0)
            ring->pole_turn = interior_is_left(grid, ring) ? -1 : 1;
        if (on_pole(grid, *shown) || !on_meridian(grid, *shown) || before.latitude == shown->latitude ||
            !(on_pole(grid, before) || on_meridian(grid, before)))
            continue;
        if (!known)
            left = interior_is_left(grid, ring);
        known = true;
        shown->longitude = (shown->latitude > before.latitude) == left ? grid->half_turn : -grid->half_turn;
    }
}

static size_t next_vertex(const globe_curve *curve, size_t index)
{
    return index + 1 < curve->count ? index + 1 : 0;
}

/// Whether the edge from a vertex to the next crosses the antimeridian. A shortest arc spans at most 180 degrees. At a pole
/// a polygon turns through its interior.
static bool crosses(const degree_grid *grid, const globe_curve *curve, size_t index)
{
    const degree_units here = curve->shown[index], next = curve->shown[next_vertex(curve, index)];
    if (curve->pole_turn != 0 && on_pole(grid, here))
        return here.latitude != next.latitude &&
               ((curve->pole_turn > 0) == (here.latitude > 0) ? next.longitude < here.longitude
                                                              : next.longitude > here.longitude);
    return llabs(here.longitude - next.longitude) > grid->half_turn;
}

bool globe_curve_show(const degree_grid *grid, globe_curve *curve)
{
    bool special = false;
    for (size_t i = 0; i < curve->count; i++)
    {
        const double *point = curve->points + 3 * i;
        if (!isfinite(point[0] + point[1] + point[2]))
            return false;
        curve->shown[i] = degrees_of_point(point, grid->units_per_radian);
        special = special || on_pole(grid, curve->shown[i]) || on_meridian(grid, curve->shown[i]);
    }
    if (special)
        assign_longitudes(grid, curve);
    curve->pole_turn = 0;
    if (special && curve->closed && curve->role != GLOBE_LINE)
        assign_border_sides(grid, curve);
    curve->cut_count = 0;
    for (size_t i = 0; i < (curve->closed ? curve->count : curve->count - 1); i++)
        curve->cut_count += crosses(grid, curve, i);
    return true;
}

/// The intersection of the edge from a vertex to the next with the antimeridian, on the vertex's side. On the arc from p to
/// q the point with y = 0 is parallel to |q_y| p + |p_y| q. An edge along a parallel, longer than a degree, is cut on it.
static globe_position crossing(const degree_grid *grid, const globe_curve *curve, size_t index)
{
    if (on_meridian(grid, curve->shown[index]))
        return globe_curve_position(curve, index);
    size_t next = next_vertex(curve, index);
    if (on_pole(grid, curve->shown[index])) // the border turns there to the longitude of the next vertex
    {
        globe_position pole = globe_curve_position(curve, index);
        pole.shown.longitude = pole.shown.longitude < 0 ? -grid->half_turn : grid->half_turn;
        return pole;
    }
    const double *p = curve->points + 3 * index, *q = curve->points + 3 * next;
    double weight_p = fabs(q[1]), weight_q = fabs(p[1]);
    double x = weight_p * p[0] + weight_q * q[0], z = weight_p * p[2] + weight_q * q[2];
    double length = hypot(x, z);
    globe_position before = globe_curve_position(curve, index), after = globe_curve_position(curve, next);
    double share = 0.5;
    int64_t latitude = llrint(atan2(z, fabs(x)) * grid->units_per_radian);
    int64_t to_cut = grid->half_turn - llabs(before.shown.longitude),
            from_cut = grid->half_turn - llabs(after.shown.longitude);
    if (llabs(before.shown.latitude - after.shown.latitude) <= 1 && to_cut + from_cut > grid->half_turn / 180)
    {
        latitude = before.shown.latitude; // the edge stays on its parallel
        share = (double)to_cut / (double)(to_cut + from_cut);
    }
    else if (length > 0.0)
    {
        const double c[3] = {x / length, 0.0, z / length};
        double to_p = chord_angle(p, c), to_q = chord_angle(c, q);
        share = to_p + to_q > 0.0 ? to_p / (to_p + to_q) : 0.5;
    }
    globe_position cut = {.shown.longitude = before.shown.longitude < 0 ? -grid->half_turn : grid->half_turn,
                          .shown.latitude = latitude,
                          .values = before.values,
                          .after = after.values,
                          .share = share};
    return cut;
}

static void end_piece(const degree_grid *grid, const globe_curve *curve, size_t index, globe_lines *pieces)
{
    if (!on_meridian(grid, curve->shown[index]))
        globe_lines_add(pieces, crossing(grid, curve, index));
    globe_lines_end(pieces);
}

static void begin_piece(const degree_grid *grid, const globe_curve *curve, size_t index, globe_lines *pieces)
{
    globe_position cut = crossing(grid, curve, index);
    cut.shown.longitude = -cut.shown.longitude;
    globe_lines_add(pieces, cut);
}

/// Cut a closed curve, starting at its first crossing.
static void cut_closed(const degree_grid *grid, const globe_curve *curve, size_t start, globe_lines *pieces)
{
    size_t first = 0;
    while (!crosses(grid, curve, first))
        first++;
    begin_piece(grid, curve, first, pieces);
    for (size_t step = 1, i = next_vertex(curve, first); step <= curve->count; step++, i = next_vertex(curve, i))
    {
        globe_position position = globe_curve_position(curve, i);
        position.start = i == 0 ? start : 0;
        globe_lines_add(pieces, position);
        if (!crosses(grid, curve, i))
            continue;
        end_piece(grid, curve, i, pieces);
        if (step < curve->count)
            begin_piece(grid, curve, i, pieces);
    }
}

void globe_curve_cut(const degree_grid *grid, const globe_curve *curve, size_t start, globe_lines *pieces)
{
    if (curve->closed)
        cut_closed(grid, curve, start, pieces);
    else
    {
        for (size_t i = 0; i + 1 < curve->count; i++)
        {
            globe_lines_add(pieces, globe_curve_position(curve, i));
            if (!crosses(grid, curve, i))
                continue;
            end_piece(grid, curve, i, pieces);
            begin_piece(grid, curve, i, pieces);
        }
        globe_lines_add(pieces, globe_curve_position(curve, curve->count - 1));
        globe_lines_end(pieces);
    }
}

// Polygons cut at the antimeridian: rings are cut into chains, whose ends are joined along the antimeridian in pairs.

/// A crossing of the antimeridian: one chain ends there, and a chain on the other side begins there.
typedef struct border_crossing
{
    int64_t latitude;
    size_t ending, beginning; ///< the indices of these chains
} border_crossing;

/// The chains of all rings that cross the antimeridian, and their order along it. The interior meets the antimeridian on
/// both sides between the same latitudes. So crossings sorted by latitude bound it in pairs. A single remaining crossing
/// bounds it together with a pole.
typedef struct border
{
    globe_lines chains;
    border_crossing *crossings; ///< sorted by latitude
    size_t count;
    size_t *ending, *beginning; ///< for each chain: the crossings at its end and its start
    bool *used;                 ///< for each chain
    bool south;                 ///< the interior contains the south pole
    bool odd;                   ///< the number of crossings is odd
    memory_pool pool;           ///< of all arrays but the chains
} border;

DEFINE_ORDER(compare_crossings, border_crossing, latitude, ending)

/// Cut the rings into chains and sort the crossings.
static bool border_begin(const degree_grid *grid, const globe_curve *rings, size_t ring_count, border *edge)
{
    for (size_t i = 0; i < ring_count; i++)
        if (rings[i].cut_count > 0)
            globe_curve_cut(grid, &rings[i], i + 1, &edge->chains);
    edge->count = edge->chains.count;
    edge->crossings = memory_pool_array(&edge->pool, edge->count, sizeof *edge->crossings);
    edge->ending = memory_pool_array(&edge->pool, edge->count, sizeof *edge->ending);
    edge->beginning = memory_pool_array(&edge->pool, edge->count, sizeof *edge->beginning);
    edge->used = memory_pool_zeros(&edge->pool, edge->count, sizeof *edge->used);
    if (edge->chains.failed || edge->pool.missing > 0)
        return false;
    size_t first = 0;
    bool south = false;
    for (size_t i = 0; i < ring_count; i++)
    {
        size_t chains = rings[i].cut_count;
        for (size_t k = 0; k < chains; k++)
        {
            int64_t latitude = edge->chains.positions[edge->chains.ends[first + k] - 1].shown.latitude;
            edge->crossings[first + k] = (border_crossing){latitude, first + k, first + (k + 1) % chains};
        }
        if (chains % 2 == 1)
        {
            edge->odd = !edge->odd;
            south = south || globe_ring_encloses_south(grid, &rings[i]);
        }
        first += chains;
    }
    edge->south = edge->odd && south;
    qsort(edge->crossings, edge->count, sizeof *edge->crossings, compare_crossings);
    for (size_t i = 0; i < edge->count; i++)
    {
        edge->ending[edge->crossings[i].ending] = i;
        edge->beginning[edge->crossings[i].beginning] = i;
    }
    return true;
}

/// The crossing that bounds the interior together with this one; itself when the other bound is a pole.
static size_t partner(const border *edge, size_t crossing)
{
    size_t first = edge->south ? 1 : 0;
    if (crossing < first)
        return crossing;
    size_t other = ((crossing - first) ^ 1) + first;
    return other < edge->count ? other : crossing;
}

static globe_position chain_position(const border *edge, size_t chain, bool at_end)
{
    return edge->chains.positions[at_end ? edge->chains.ends[chain] - 1 : globe_line_begin(&edge->chains, chain)];
}

static bool same_place(globe_position a, globe_position b)
{
    return a.shown.longitude == b.shown.longitude && a.shown.latitude == b.shown.latitude;
}

/// Append a position to the ring that begins at `begin`, unless it equals the last one.
static void add_to_ring(globe_lines *rings, size_t begin, globe_position position)
{
    globe_position *last = rings->position_count > begin ? &rings->positions[rings->position_count - 1] : NULL;
    if (last == NULL || !same_place(*last, position))
        globe_lines_add(rings, position);
    else if (last->start == 0)
        last->start = position.start;
}

/// Follow the antimeridian from the end of a chain to the start of the next.
static void follow_border(const degree_grid *grid, const border *edge, size_t *chain, bool *backward, size_t begin,
                          globe_lines *rings)
{
    globe_position exit = chain_position(edge, *chain, !*backward);
    size_t crossing = *backward ? edge->beginning[*chain] : edge->ending[*chain];
    size_t other = partner(edge, crossing);
    int64_t side = exit.shown.longitude;
    if (other == crossing)
    {
        int64_t pole = edge->south ? -grid->quarter_turn : grid->quarter_turn;
        exit.start = 0;
        exit.shown = (degree_units){side, pole};
        add_to_ring(rings, begin, exit);
        exit.shown.longitude = side = -side;
        add_to_ring(rings, begin, exit);
    }
    const border_crossing *enter = &edge->crossings[other];
    bool at_end = chain_position(edge, enter->ending, true).shown.longitude == side;
    *chain = at_end ? enter->ending : enter->beginning;
    *backward = at_end;
}

static void reverse(globe_position *positions, size_t count)
{
    for (size_t i = 0, j = count; i + 1 < j; i++, j--)
        SWAP(positions[i], positions[j - 1]);
}

/// Rotate a ring so that it begins at its vertex `start`.
static void rotate(globe_position *positions, size_t count, size_t start)
{
    if (start == 0)
        return;
    reverse(positions, start);
    reverse(positions + start, count - start);
    reverse(positions, count);
}

/// Rotate a ring so that it begins where the first of its given rings begins, if it contains such a vertex.
static void rotate_to_start(globe_position *positions, size_t count)
{
    size_t start = 0;
    for (size_t i = 0; i < count; i++)
        if (positions[i].start != 0 && (positions[start].start == 0 || positions[i].start < positions[start].start))
            start = i;
    rotate(positions, count, start);
}

static int64_t lesser(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/// Find an edge along the antimeridian that contains a vertex. Rotates the ring so that it begins at this vertex, and
/// returns the index of the edge; `count` when there is none.
static size_t find_touch(const degree_grid *grid, globe_position *positions, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        const globe_position at = positions[i], before = positions[i > 0 ? i - 1 : count - 1];
        const globe_position after = positions[i + 1 < count ? i + 1 : 0];
        int64_t side = at.shown.longitude;
        bool on_border = side == grid->half_turn || side == -grid->half_turn;
        // A vertex between two edges that leave the antimeridian.
        if (!on_border || before.shown.longitude == side || after.shown.longitude == side)
            continue;
        for (size_t k = 0; k < count; k++)
        {
            const degree_units p = positions[k].shown, q = positions[k + 1 < count ? k + 1 : 0].shown;
            int64_t low = lesser(p.latitude, q.latitude), high = -lesser(-p.latitude, -q.latitude);
            if (p.longitude != side || q.longitude != side || low >= at.shown.latitude || high <= at.shown.latitude)
                continue;
            rotate(positions, count, i);
            return (k + count - i) % count;
        }
    }
    return count;
}

/// End a ring. Where it touches the antimeridian inside one of its own edges there, it is two rings.
static void end_ring(const degree_grid *grid, size_t begin, size_t splits, globe_lines *rings)
{
    size_t count = rings->position_count - begin;
    size_t edge = splits > 0 ? find_touch(grid, rings->positions + begin, count) : count;
    if (edge < count)
    {
        size_t rest = count - edge - 1;
        globe_position touch = rings->positions[begin], *others = memory_array(rest, sizeof *others);
        if (others == NULL)
        {
            rings->failed = true;
            return;
        }
        memcpy(others, rings->positions + begin + edge + 1, rest * sizeof *others);
        rings->position_count = begin + edge + 1;
        end_ring(grid, begin, splits - 1, rings);
        size_t second = rings->position_count;
        touch.start = 0;
        globe_lines_add(rings, touch);
        for (size_t i = 0; i < rest; i++)
            globe_lines_add(rings, others[i]);
        free(others);
        if (!rings->failed)
            end_ring(grid, second, splits - 1, rings);
        return;
    }
    rotate_to_start(rings->positions + begin, count);
    // Rings must have three positions, also around a part without area.
    while (!rings->failed && rings->position_count - begin < 3)
        globe_lines_add(rings, rings->positions[begin]);
    globe_lines_end(rings);
}

/// Trace the boundary of one part of the interior.
static void trace_ring(const degree_grid *grid, border *edge, size_t chain, globe_lines *rings)
{
    static const int MAX_SPLITS = 1000; // a bound for the stack
    size_t begin = rings->position_count;
    bool backward = false;
    while (!edge->used[chain] && !rings->failed)
    {
        edge->used[chain] = true;
        size_t first = globe_line_begin(&edge->chains, chain), end = edge->chains.ends[chain];
        for (size_t i = first; i < end; i++)
            add_to_ring(rings, begin, edge->chains.positions[backward ? first + end - 1 - i : i]);
        follow_border(grid, edge, &chain, &backward, begin, rings);
    }
    if (rings->failed || rings->positions == NULL)
        return;
    size_t last = rings->position_count - 1;
    if (last > begin && same_place(rings->positions[begin], rings->positions[last]))
    {
        if (rings->positions[begin].start == 0)
            rings->positions[begin].start = rings->positions[last].start;
        rings->position_count--;
    }
    end_ring(grid, begin, MAX_SPLITS, rings);
}

/// Whether a point lies inside a ring in the plane of longitude and latitude.
static bool ring_holds(const globe_lines *rings, size_t ring, degree_units place)
{
    bool inside = false;
    size_t begin = globe_line_begin(rings, ring), end = rings->ends[ring];
    double x = (double)place.longitude, y = (double)place.latitude;
    for (size_t i = begin, j = end - 1; i < end; j = i++)
    {
        double xi = (double)rings->positions[i].shown.longitude, yi = (double)rings->positions[i].shown.latitude;
        double xj = (double)rings->positions[j].shown.longitude, yj = (double)rings->positions[j].shown.latitude;
        if ((yi > y) != (yj > y) && x < xi + (y - yi) / (yj - yi) * (xj - xi))
            inside = !inside;
    }
    return inside;
}

typedef struct ring_box
{
    degree_units low, high;
} ring_box;

static ring_box box_of(const globe_lines *rings, size_t ring)
{
    size_t begin = globe_line_begin(rings, ring);
    assert(rings->positions != NULL && begin < rings->ends[ring]);
    ring_box box = {rings->positions[begin].shown, rings->positions[begin].shown};
    for (size_t i = begin; i < rings->ends[ring]; i++)
    {
        degree_units shown = rings->positions[i].shown;
        box.low = (degree_units){lesser(box.low.longitude, shown.longitude), lesser(box.low.latitude, shown.latitude)};
        box.high =
            (degree_units){-lesser(-box.high.longitude, -shown.longitude), -lesser(-box.high.latitude, -shown.latitude)};
    }
    return box;
}

static bool box_holds(const ring_box *box, degree_units place)
{
    return box->low.longitude <= place.longitude && place.longitude <= box->high.longitude &&
           box->low.latitude <= place.latitude && place.latitude <= box->high.latitude;
}

/// The outer ring of a hole: the first one that contains a vertex of the hole.
static size_t owner_of(const globe_curve *hole, const globe_lines *outers, const ring_box *boxes)
{
    for (size_t i = 0; i < hole->count; i++)
        for (size_t k = 0; k < outers->count; k++)
            if (box_holds(&boxes[k], hole->shown[i]) && ring_holds(outers, k, hole->shown[i]))
                return k;
    return 0;
}

/// Combine the outer rings with the holes that do not cross the antimeridian.
static bool assemble(const globe_lines *outers, const globe_curve *holes, size_t hole_count, globe_polygons *parts)
{
    memory_pool pool = {0};
    ring_box *boxes = memory_pool_array(&pool, outers->count, sizeof *boxes);
    size_t *owners = memory_pool_array(&pool, hole_count, sizeof *owners);
    bool done =
        boxes != NULL && owners != NULL && ARRAY_GROW(parts->ring_counts, parts->capacity, parts->count + outers->count);
    for (size_t k = 0; k < outers->count && done; k++)
        boxes[k] = box_of(outers, k);
    // A hole that was cut is part of an outer ring already.
    for (size_t i = 0; i < hole_count && done; i++)
        owners[i] = holes[i].cut_count > 0 ? outers->count : owner_of(&holes[i], outers, boxes);
    for (size_t k = 0; k < outers->count && done; k++)
    {
        size_t rings_before = parts->rings.count;
        for (size_t i = globe_line_begin(outers, k); i < outers->ends[k]; i++)
            globe_lines_add(&parts->rings, outers->positions[i]);
        globe_lines_end(&parts->rings);
        for (size_t i = 0; i < hole_count; i++)
            if (owners[i] == k)
                globe_curve_add(&holes[i], false, &parts->rings);
        parts->ring_counts[parts->count++] = parts->rings.count - rings_before;
    }
    memory_pool_free(&pool);
    return done && !parts->rings.failed;
}

bool globe_polygon_cut(const degree_grid *grid, const globe_curve *rings, size_t ring_count, globe_polygons *parts)
{
    border edge = {0};
    globe_lines outers = {0};
    bool done = border_begin(grid, rings, ring_count, &edge);
    if (done)
    {
        if (rings[0].cut_count == 0)
            globe_curve_add(&rings[0], false, &outers);
        for (size_t chain = 0; chain < edge.count; chain++)
            if (!edge.used[chain])
                trace_ring(grid, &edge, chain, &outers);
        done = !outers.failed && assemble(&outers, rings + 1, ring_count - 1, parts);
    }
    globe_lines_free(&outers);
    globe_lines_free(&edge.chains);
    memory_pool_free(&edge.pool);
    return done;
}

void globe_polygons_free(globe_polygons *polygons)
{
    globe_lines_free(&polygons->rings);
    free(polygons->ring_counts);
    *polygons = (globe_polygons){0};
}
