#include "io/curve/geojson_shape.h"

#include "base/error.h"
#include "curve/map/arc_refine.h"
#include "curve/polygon.h"
#include "linalg/vector.h"
#include "search/nearest.h"

/// @file
/// The judge of refined polygons. It looks at the positions that a file will hold, cuts and closures included, and shares
/// nothing with the refinement but exact predicates.

// Rings as a file holds them

/// The rings of a shape in plain coordinates. All zero: empty.
typedef struct flat_rings
{
    bat_space plane;
    bat_curve *rings;
    double *points;
    size_t count;
} flat_rings;

static void flat_rings_free(flat_rings *flat)
{
    free(flat->rings);
    free(flat->points);
}

/// Append a position unless it repeats the one before.
static void add_position(bat_curve *ring, double x, double y)
{
    double *last = ring->points + 2 * ring->count;
    if (ring->count > 0 && last[-2] == x && last[-1] == y)
        return;
    last[0] = x;
    last[1] = y;
    ring->count++;
}

static void add_shown(const geojson_style *style, bat_curve *ring, degree_units before, degree_units shown)
{
    if (geojson_turns_at_pole(style, before, shown))
        add_position(ring, (double)shown.longitude, (double)before.latitude);
    add_position(ring, (double)shown.longitude, (double)shown.latitude);
}

/// Put ring `index` of a shape at `ring->points`.
static void fill_ring(const geojson_shape *shape, const geojson_style *style, size_t index, bat_curve *ring)
{
    if (shape->cut)
    {
        const globe_lines *rings = &shape->parts.rings;
        size_t begin = globe_line_begin(rings, index), end = rings->ends[index];
        for (size_t i = begin; i < end; i++)
            add_shown(style, ring, rings->positions[i > begin ? i - 1 : end - 1].shown, rings->positions[i].shown);
    }
    else
    {
        const globe_curve *curve = &shape->curves[index];
        for (size_t i = 0; i < curve->count; i++)
            if (style->globe)
                add_shown(style, ring, curve->shown[i > 0 ? i - 1 : curve->count - 1], curve->shown[i]);
            else
                add_position(ring, curve->points[2 * i], curve->points[2 * i + 1]);
    }
    const double *p = ring->points;
    while (ring->count > 1 && p[0] == p[2 * ring->count - 2] && p[1] == p[2 * ring->count - 1])
        ring->count--;
}

static bat_status flat_rings_make(const geojson_shape *shape, const geojson_style *style, flat_rings *flat, bat_error *error)
{
    size_t room = shape->cut ? 2 * shape->parts.rings.position_count : 0;
    flat->plane = bat_euclidean(2);
    flat->count = shape->cut ? shape->parts.rings.count : shape->curve_count;
    for (size_t i = 0; i < shape->curve_count && !shape->cut; i++)
        for (size_t k = 0; k < shape->curves[i].count; k++)
            room += style->globe && llabs(shape->curves[i].shown[k].latitude) == style->grid.quarter_turn ? 2 : 1;
    flat->rings = memory_array(flat->count, sizeof *flat->rings);
    flat->points = memory_array(room, 2 * sizeof *flat->points);
    if (flat->rings == NULL || flat->points == NULL)
        return error_memory(error, room * 2 * sizeof *flat->points);
    double *at = flat->points;
    for (size_t i = 0; i < flat->count; i++)
    {
        flat->rings[i] = (bat_curve){.space = &flat->plane, .points = at, .closed = true};
        fill_ring(shape, style, i, &flat->rings[i]);
        at += 2 * flat->rings[i].count;
    }
    return BAT_OK;
}

// Crossings

/// A search for edges that cross, or overlap, or touch within a ring.
typedef struct fault_search
{
    const flat_rings *flat;
    const double *ends[4]; ///< of the two edges; null: nothing was found
} fault_search;

/// Whether two edges on one line have more in common than a point.
static bool overlap(const double *a, const double *b, const double *c, const double *d)
{
    int axis = fabs(b[0] - a[0]) >= fabs(b[1] - a[1]) ? 0 : 1;
    return fmin(fmax(a[axis], b[axis]), fmax(c[axis], d[axis])) > fmax(fmin(a[axis], b[axis]), fmin(c[axis], d[axis]));
}

static bool note_fault(void *context, edge_place first, edge_place second)
{
    fault_search *search = context;
    const bat_curve *r = &search->flat->rings[first.curve], *s = &search->flat->rings[second.curve];
    const double *a = r->points + 2 * first.edge, *b = r->points + 2 * ((first.edge + 1) % r->count);
    const double *c = s->points + 2 * second.edge, *d = s->points + 2 * ((second.edge + 1) % s->count);
    int sides = predicate_orientation(SURFACE_PLANE, a, b, c) * predicate_orientation(SURFACE_PLANE, a, b, d);
    int others = predicate_orientation(SURFACE_PLANE, c, d, a) * predicate_orientation(SURFACE_PLANE, c, d, b);
    bool line = sides == 0 && others == 0 && predicate_orientation(SURFACE_PLANE, a, b, c) == 0 &&
                predicate_orientation(SURFACE_PLANE, a, b, d) == 0;
    bool fault = line ? overlap(a, b, c, d) : first.curve == second.curve || (sides < 0 && others < 0);
    if (fault)
        memcpy(search->ends, (const double *[4]){a, b, c, d}, sizeof search->ends);
    return !fault;
}

/// Find a fault of a shape's rings. `search` receives it.
static bat_status find_fault(const flat_rings *flat, fault_search *search, bat_error *error)
{
    *search = (fault_search){.flat = flat};
    return edge_pairs_find(flat->rings, flat->count, 0, EDGE_PAIRS_ARCS, 1, note_fault, search, error);
}

/// Whether a ring leads there and back along a line, or touches itself at a fault of what became of it. Rounding can keep
/// the two ways apart, on the globe by two units.
static bool nearly_touches(const flat_rings *flat, bool globe, const fault_search *fault)
{
    for (size_t r = 0; r < flat->count; r++)
    {
        const double *points = flat->rings[r].points;
        size_t count = flat->rings[r].count;
        double apart = globe ? 2 : 0;
        size_t passes[4] = {0};
        for (size_t i = 0; i < 2 * count && !globe; i++)
            apart = fmax(apart, SNAP_ROUNDING_FLAT * fabs(points[i]));
        for (size_t i = 0; i < count; i++)
        {
            const double *tip = points + 2 * i, *p = points + 2 * ((i + count - 1) % count),
                         *q = points + 2 * ((i + 1) % count);
            double to[2] = {p[0] - tip[0], p[1] - tip[1]}, from[2] = {q[0] - tip[0], q[1] - tip[1]};
            double longer = fmax(hypot(to[0], to[1]), hypot(from[0], from[1]));
            if (vector_dot(2, to, from) > 0 && fabs(vector2_turn(tip, p, q)) <= apart * longer)
                return true;
            double square = 4 * apart * apart;
            for (size_t k = 0; k < 4; k++)
            {
                const double *place = fault->ends[k];
                passes[k] += segment_squared(tip, q, place, 2, 1) <= square && point_squared(q, place, 2, 1) > square;
                if (passes[k] > 1)
                    return true;
            }
        }
    }
    return false;
}

// Areas

/// Twice the area on the left of a ring.
static double ring_area(const bat_curve *ring)
{
    double sum = 0;
    const double *p = ring->points;
    for (size_t i = 1; i + 1 < ring->count; i++)
        sum += (p[2 * i] - p[0]) * (p[2 * i + 3] - p[1]) - (p[2 * i + 2] - p[0]) * (p[2 * i + 1] - p[1]);
    return sum;
}

/// Twice the area of a shape's polygons.
static double polygons_area(const geojson_shape *shape, const flat_rings *flat)
{
    double sum = 0;
    size_t polygons = shape->cut ? shape->parts.count : shape->polygon_count;
    for (size_t i = 0, ring = 0; i < polygons; i++)
    {
        size_t rings = shape->cut ? shape->parts.ring_counts[i] : shape->polygons[i].rings;
        for (size_t k = 0; k < rings; k++, ring++)
            sum += (k == 0 ? 1 : -1) * fabs(ring_area(&flat->rings[ring]));
    }
    return sum;
}

/// What lies between the rings of the given shape and those of the refined one.
typedef struct area_between
{
    double gain;    ///< twice the area that polygons gain
    double whole;   ///< the same without signs
    double slack;   ///< twice the area that a cut can move: the square of a cut edge's length
    bool all_found; ///< all given vertices are vertices of the refined rings
} area_between;

/// Position i of a curve; longitudes go on from `near`, and a pole at `i` has the longitude of the next vertex if `leaves`.
static void place_of(const geojson_style *style, const globe_curve *curve, size_t i, bool leaves, const double *near,
                     double *place)
{
    if (!style->globe)
    {
        memcpy(place, curve->points + 2 * i, 2 * sizeof *place);
        return;
    }
    degree_units shown = curve->shown[i];
    if (leaves && llabs(shown.latitude) == style->grid.quarter_turn)
        shown.longitude = curve->shown[(i + 1) % curve->count].longitude;
    double turn = 2 * (double)style->grid.half_turn, longitude = (double)shown.longitude;
    place[0] = near != NULL ? longitude - turn * rint((longitude - near[0]) / turn) : longitude;
    place[1] = (double)shown.latitude;
}

static bool is_vertex(const geojson_style *style, const globe_curve *given, size_t i, const globe_curve *fine, size_t j)
{
    return style->globe ? given->shown[i].latitude == fine->shown[j].latitude &&
                              (given->shown[i].longitude == fine->shown[j].longitude ||
                               llabs(given->shown[i].latitude) == style->grid.quarter_turn ||
                               llabs(given->shown[i].longitude - fine->shown[j].longitude) == 2 * style->grid.half_turn)
                        : given->points[2 * i] == fine->points[2 * j] && given->points[2 * i + 1] == fine->points[2 * j + 1];
}

/// Add the areas between the edges of a given ring and its refined pieces.
static void add_between(const geojson_style *style, const globe_curve *given, const globe_curve *fine, area_between *between)
{
    bool left = geojson_interior_is_left(style, given);
    size_t at = 0, n = fine->count;
    for (size_t i = 0; i < given->count && between->all_found; i++)
    {
        size_t next = (i + 1) % given->count;
        double start[2], before[2], here[2], twice = 0;
        place_of(style, fine, at % n, true, NULL, start);
        memcpy(before, start, sizeof before);
        do
        {
            at++;
            place_of(style, fine, at % n, false, before, here);
            twice += (before[0] - start[0]) * (here[1] - start[1]) - (here[0] - start[0]) * (before[1] - start[1]);
            memcpy(before, here, sizeof before);
        } while (at < n && !is_vertex(style, given, next, fine, at % n));
        between->all_found = (at < n) == (next > 0) && is_vertex(style, given, next, fine, at % n);
        between->gain += left ? twice : -twice;
        between->whole += fabs(twice);
        bool cut = style->globe && llabs(given->shown[i].longitude - given->shown[next].longitude) > style->grid.half_turn;
        double square = (here[0] - start[0]) * (here[0] - start[0]) + (here[1] - start[1]) * (here[1] - start[1]);
        between->slack += cut ? square : 0;
    }
}

/// Whether the refined polygons have the area of the given ones and what lies between.
static bool areas_agree(const geojson_shape *given, const geojson_shape *fine, const geojson_style *style,
                        const flat_rings *given_rings, const flat_rings *fine_rings)
{
    static const double SHARE = 1e-6, UNITS = 4; // of rounding: of the areas, and across the box
    area_between between = {.all_found = given->curve_count == fine->curve_count};
    for (size_t i = 0; i < given->curve_count && between.all_found; i++)
        add_between(style, &given->curves[i], &fine->curves[i], &between);
    if (!between.all_found)
        return true;
    double before = polygons_area(given, given_rings), after = polygons_area(fine, fine_rings);
    double rounding = style->globe ? UNITS * (double)style->grid.half_turn * (double)given->curve_count : 0;
    return fabs(after - before - between.gain) <= SHARE * (fabs(before) + between.whole) + 2 * between.slack + rounding;
}

bat_status judge_polygons(const geojson_shape *given, const geojson_shape *fine, const geojson_style *style, size_t first,
                          bat_error *error)
{
    flat_rings before = {0}, after = {0};
    fault_search found, given_fault = {0};
    bat_status status = flat_rings_make(fine, style, &after, error);
    if (status == BAT_OK)
        status = find_fault(&after, &found, error);
    bool crosses = status == BAT_OK && found.ends[0] != NULL;
    if (status == BAT_OK)
        status = flat_rings_make(given, style, &before, error);
    if (status == BAT_OK && crosses)
        status = find_fault(&before, &given_fault, error);
    bool crossed = given_fault.ends[0] != NULL;
    if (status == BAT_OK && crosses && !crossed)
        crossed = nearly_touches(&before, style->globe, &found);
    double unit = style->globe ? (double)style->grid.half_turn / 180 : 1;
    if (status == BAT_OK && crosses && !crossed)
        status =
            error_set(error, BAT_UNSUPPORTED, first, 0, "the refined polygon of curve %zu crosses itself near %.8g, %.8g",
                      first, found.ends[0][0] / unit, found.ends[0][1] / unit);
    if (status == BAT_OK && !crosses && !areas_agree(given, fine, style, &before, &after))
        status = error_set(error, BAT_UNSUPPORTED, first, 0,
                           "the refined polygon of curve %zu has another area than its borders say", first);
    flat_rings_free(&before);
    flat_rings_free(&after);
    return status;
}

// Borders

/// An edge of the given set, and a number for what became of it.
typedef struct judged_edge
{
    const double *ends[2]; ///< null: an empty place of the table
    size_t hash;
} judged_edge;

typedef struct border_judge
{
    size_t dim, mask;
    judged_edge *table;
} border_judge;

/// Note what became of an edge. False when the same edge became something else before.
static bool note_edge(border_judge *judge, const double *p, const double *q, size_t hash)
{
    size_t dim = judge->dim, slot = (doubles_hash(p, dim) + doubles_hash(q, dim)) & judge->mask;
    for (; judge->table[slot].ends[0] != NULL; slot = (slot + 1) & judge->mask)
    {
        const judged_edge *edge = &judge->table[slot];
        if ((points_equal(edge->ends[0], p, dim) && points_equal(edge->ends[1], q, dim)) ||
            (points_equal(edge->ends[0], q, dim) && points_equal(edge->ends[1], p, dim)))
            return edge->hash == hash;
    }
    judge->table[slot] = (judged_edge){{p, q}, hash};
    return true;
}

/// Walk along a curve and its refinement. Returns false where a given vertex is missing, or where `judge` has seen another
/// course of an edge before; null: look for the vertices alone.
static bool walk_curve(border_judge *judge, size_t dim, const bat_curve *given, const bat_curve *fine)
{
    size_t at = 0, edges = polygon_edges(given->count, given->closed), last = polygon_edges(fine->count, fine->closed);
    for (size_t i = 0; i < edges; i++)
    {
        const double *p = given->points + i * dim, *q = given->points + (i + 1) % given->count * dim;
        size_t hash = 0; // of the new points in either direction
        if (!points_equal(p, fine->points + at % fine->count * dim, dim))
            return false;
        while (++at < last && !points_equal(q, fine->points + at % fine->count * dim, dim))
            hash += judge != NULL ? doubles_hash(fine->points + at * dim, dim) : 0;
        if (at > last || !points_equal(q, fine->points + at % fine->count * dim, dim) ||
            (judge != NULL && !note_edge(judge, p, q, hash)))
            return false;
    }
    return at == last;
}

bat_status judge_borders(const bat_curve_set *given, const bat_curve_set *fine, bat_error *error)
{
    size_t edges = 0, size = 2;
    for (size_t i = 0; i < given->count; i++)
        edges += given->curves[i].count;
    while (size < edges + edges / 2)
        size *= 2;
    border_judge judge = {given->space->point_dim, size - 1, calloc(size, sizeof *judge.table)};
    if (judge.table == NULL)
        return error_memory(error, size * sizeof *judge.table);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < given->count && status == BAT_OK; i++)
        if (walk_curve(NULL, judge.dim, &given->curves[i], &fine->curves[i]) &&
            !walk_curve(&judge, judge.dim, &given->curves[i], &fine->curves[i]))
            status = error_set(error, BAT_UNSUPPORTED, i, 0,
                               "curve %zu would leave a border that it shares with a curve before it", i);
    free(judge.table);
    return status;
}
