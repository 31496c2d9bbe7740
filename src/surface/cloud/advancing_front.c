/// @file
/// Greedy surface reconstruction; see boundary.h.
///
/// The boundary of the surface consists of half-edges in loops. The half-edge from p to q misses a face on its left side; a
/// triangle (p, q, x) that is added has the same direction. There are four ways to add it:
///     a new point x:         p q becomes p x, x q;
///     an ear at the end:     p q, q x becomes p x;
///     an ear at the begin:   x p, p q becomes x q;
///     both:                  the loop p q, q x, x p closes;
///     x elsewhere in the loop: the loop is split in two at x.

#include "base/bisect.h"
#include "surface/cloud/boundary.h"

#include "base/array_grow.h"
#include "base/progress.h"
#include "mesh/hash_table.h"
#include "surface/cloud/delaunay.h"

enum
{
    SPACING_POINTS = 7, ///< with the point itself: the distance of the last is its spacing
    PROGRESS_STEP = 1024,
    MIN_SEAM = 4,    ///< points at which the boundary of a one-sided surface meets itself
    SEAM_APART = 10, ///< one tenth of the boundary is between points that meet
    SMALL_HOLE = 10  ///< edges of a hole without a place that is far from points
};

/// Largest ratio of the radius of the empty ball of a triangle to the mean spacing of its corners. The second is for
/// triangles with a new point, where no others are left.
static const double MAX_RADIUS[2] = {1.3, 2.6};
/// Cosine of the angle of normals up to which a triangle continues the surface smoothly: 30 degrees.
static const double SMOOTH_COSINE = 0.8660254037844386;
/// The same, beyond which a triangle is folded back: 150 degrees.
static const double FOLD_COSINE = -0.8660254037844386;
/// Where thin parts are spared, a triangle without a new point counts as larger by this factor times what its cosine lacks
/// to SMOOTH_COSINE.
static const double TURN_COST = 1;
/// Least cosine of the normals of a triangle and of the surface at a point of its boundary that it joins.
static const double JOIN_COSINE = -0.2;
/// Longest loop that is filled, as a share of the longest loop: of many edges, and of at most SMALL_HOLE.
static const double MAX_HOLE[2] = {0.25, 0.5};
/// Distance of points of the boundary that meet, in spacings, and the cosine of their normals.
static const double SEAM_REACH = 1.5, SEAM_COSINE = 0.7;
/// Fewest points of the boundary, in roots of the number of points.
static const double MIN_BOUNDARY_ROOTS = 1;
/// Largest share of points that are no corners.
static const double MAX_LEFT = 0.1;
/// Smallest ratio of six times the volume of a tetrahedron to the cube of its size that is not flat.
static const double MIN_VOLUME = 1e-10;

static const uint32_t NONE = UINT32_MAX;

typedef struct front_triangle
{
    uint32_t corners[3]; ///< ascending
    double radius;       ///< of the smallest empty ball through the corners
} front_triangle;

typedef struct front_side
{
    uint64_t key;
    uint32_t triangle;
} front_side;

/// A half-edge of the boundary.
typedef struct front_edge
{
    uint32_t from, to, opposite; ///< the third corner of its face
    uint32_t next, previous;
    uint32_t next_out; ///< another half-edge from the same point
    double normal[3];  ///< unit normal of the face
    bool alive;
} front_edge;

typedef struct front_candidate
{
    double grade; ///< the greatest is first
    uint32_t edge, corner;
} front_candidate;

typedef struct front
{
    memory_pool pool; ///< of the arrays that do not grow
    const double *points;
    size_t count;
    double *spacing; ///< count
    front_triangle *triangles;
    size_t triangle_count;
    front_side *sides; ///< 3 x triangle_count, sorted by key
    front_edge *edges;
    size_t edge_count, edge_capacity;
    uint32_t *first_out; ///< count: half-edges of the boundary from a point
    bool *used;          ///< count: corners of faces
    key_map uses;        ///< number of faces of an edge
    front_candidate *queue;
    size_t queue_count, queue_capacity;
    uint32_t *faces; ///< face_count x 3
    size_t face_count, face_capacity;
    advancing_front_options options;
    double max_radius; ///< of the balls of triangles, in mean spacings
    bool only_new;     ///< triangles with a new point alone are taken
} front;

static void front_free(front *work)
{
    memory_pool_free(&work->pool);
    free(work->edges);
    key_map_free(&work->uses);
    free(work->queue);
    free(work->faces);
}

static const double *point_of(const front *work, uint32_t point)
{
    return work->points + 3 * (size_t)point;
}

// Triangles of the Delaunay triangulation

/// A triangle of a tetrahedron.
typedef struct tetrahedron_side
{
    uint32_t corners[3]; ///< ascending
    uint32_t apex;
} tetrahedron_side;

static int compare_tetrahedron_sides(const void *a, const void *b)
{
    const tetrahedron_side *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->corners[k] != q->corners[k])
            return ORDER_OF(p->corners[k], q->corners[k]);
    return ORDER_OF(p->apex, q->apex);
}

DEFINE_ORDER(compare_sides, front_side, key, triangle)

/// The centre of the circle through the corners of a triangle; false for a degenerate one.
static bool circle_of(const double *a, const double *b, const double *c, double centre[3], double normal[3])
{
    double u[3], v[3], first[3], second[3];
    vector3_subtract(b, a, u);
    vector3_subtract(c, a, v);
    vector3_cross(u, v, normal);
    double square = vector3_dot(normal, normal), uu = vector3_dot(u, u), vv = vector3_dot(v, v);
    if (!(square > 1e-20 * uu * vv))
        return false;
    vector3_cross(v, normal, first);
    vector3_cross(normal, u, second);
    double length = sqrt(square);
    for (int k = 0; k < 3; k++)
    {
        centre[k] = a[k] + (uu * first[k] + vv * second[k]) / (2 * square);
        normal[k] /= length;
    }
    return true;
}

/// The radius of the smallest empty ball through the corners: its centre is on the Voronoi edge that is dual to the
/// triangle, between the centres of the balls of the tetrahedra on both sides.
static double empty_radius(const double *points, const uint32_t corners[3], const uint32_t *apices, size_t apex_count)
{
    double centre[3], normal[3], arm[3], low = -INFINITY, high = INFINITY;
    const double *a = points + 3 * (size_t)corners[0];
    if (!circle_of(a, points + 3 * (size_t)corners[1], points + 3 * (size_t)corners[2], centre, normal))
        return INFINITY;
    vector3_subtract(a, centre, arm);
    double square = vector3_dot(arm, arm);
    for (size_t k = 0; k < apex_count; k++)
    {
        vector3_subtract(points + 3 * (size_t)apices[k], centre, arm);
        double height = vector3_dot(arm, normal), length = vector3_dot(arm, arm);
        if (fabs(height) < MIN_VOLUME * sqrt(length + square))
            continue;
        // |apex - centre - t normal|^2 = radius^2 + t^2
        double place = (length - square) / (2 * height);
        if (height > 0)
            high = fmin(high, place);
        else
            low = fmax(low, place);
    }
    double nearest = low > 0 ? low : high < 0 ? high : 0;
    return sqrt(square + nearest * nearest);
}

static bat_status gather_triangles(front *work, const simplices *tetrahedra, bat_error *error)
{
    static const int SIDES[4][4] = {{1, 2, 3, 0}, {0, 2, 3, 1}, {0, 1, 3, 2}, {0, 1, 2, 3}};
    size_t count = 4 * tetrahedra->count;
    tetrahedron_side *all = memory_array(count, sizeof *all);
    work->triangles = memory_pool_array(&work->pool, count, sizeof *work->triangles);
    work->sides = memory_pool_array(&work->pool, count, 3 * sizeof *work->sides);
    if (all == NULL || work->triangles == NULL || work->sides == NULL)
    {
        free(all);
        return error_memory(error, count * 3 * sizeof *work->sides);
    }
    for (size_t s = 0; s < count; s++)
    {
        const uint32_t *corners = tetrahedra->corners + s / 4 * 4;
        for (int k = 0; k < 3; k++)
            all[s].corners[k] = corners[SIDES[s % 4][k]];
        all[s].apex = corners[SIDES[s % 4][3]];
        qsort(all[s].corners, 3, sizeof *all[s].corners, ascending_index);
    }
    qsort(all, count, sizeof *all, compare_tetrahedron_sides);
    for (size_t s = 0, end; s < count; s = end)
    {
        uint32_t apices[2];
        size_t found = 0;
        for (end = s; end < count && memcmp(all[end].corners, all[s].corners, sizeof all[s].corners) == 0; end++)
            if (found < 2)
                apices[found++] = all[end].apex;
        front_triangle *triangle = &work->triangles[work->triangle_count];
        memcpy(triangle->corners, all[s].corners, sizeof triangle->corners);
        triangle->radius = empty_radius(work->points, triangle->corners, apices, found);
        for (size_t k = 0; k < 3; k++)
            work->sides[3 * work->triangle_count + k] = (front_side){
                key_of_pair(triangle->corners[k], triangle->corners[(k + 1) % 3]), (uint32_t)work->triangle_count};
        work->triangle_count++;
    }
    free(all);
    qsort(work->sides, 3 * work->triangle_count, sizeof *work->sides, compare_sides);
    return BAT_OK;
}

static double mean_spacing(const front *work, const uint32_t corners[3])
{
    return (work->spacing[corners[0]] + work->spacing[corners[1]] + work->spacing[corners[2]]) / 3;
}

static bat_status measure_spacing(front *work, const nearest_tree *tree, bat_error *error)
{
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (size_t i = 0; i < work->count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(tree, work->points + 3 * i, SPACING_POINTS, &near, error);
        if (status == BAT_OK)
            work->spacing[i] = sqrt(near.entries[near.count - 1].squared);
    }
    neighbour_list_free(&near);
    return status;
}

// The boundary

static uint32_t uses_of(const front *work, uint32_t a, uint32_t b)
{
    uint32_t uses = key_map_find(&work->uses, key_of_pair(a, b));
    return uses == NONE ? 0 : uses;
}

static void detach(front *work, uint32_t edge)
{
    uint32_t *link = &work->first_out[work->edges[edge].from];
    while (*link != edge)
        link = &work->edges[*link].next_out;
    *link = work->edges[edge].next_out;
    work->edges[edge].alive = false;
}

/// Add a half-edge; false when out of memory. Its number is the count before.
static bool add_edge(front *work, uint32_t from, uint32_t to, uint32_t opposite, const double normal[3])
{
    if (!ARRAY_GROW(work->edges, work->edge_capacity, work->edge_count + 1))
        return false;
    front_edge *edge = &work->edges[work->edge_count];
    *edge = (front_edge){.from = from, .to = to, .opposite = opposite, .next_out = work->first_out[from], .alive = true};
    memcpy(edge->normal, normal, sizeof edge->normal);
    work->first_out[from] = (uint32_t)work->edge_count++;
    return true;
}

static void link_edges(front *work, uint32_t first, uint32_t second)
{
    work->edges[first].next = second;
    work->edges[second].previous = first;
}

/// Whether a half-edge is in the loop of another one.
static bool in_loop(const front *work, uint32_t edge, uint32_t wanted)
{
    for (uint32_t e = work->edges[edge].next; e != edge; e = work->edges[e].next)
        if (e == wanted)
            return true;
    return edge == wanted;
}

/// The unit normal of a triangle; false for a degenerate one.
static bool normal_of(const front *work, uint32_t a, uint32_t b, uint32_t c, double normal[3])
{
    double u[3], v[3];
    vector3_subtract(point_of(work, b), point_of(work, a), u);
    vector3_subtract(point_of(work, c), point_of(work, a), v);
    vector3_cross(u, v, normal);
    double length = sqrt(vector3_dot(normal, normal));
    if (!(length > 1e-10 * sqrt(vector3_dot(u, u) * vector3_dot(v, v))))
        return false;
    for (int k = 0; k < 3; k++)
        normal[k] /= length;
    return true;
}

/// The half-edge from a point at which the triangle of a half-edge joins the loop of the latter; NONE where it does not.
static uint32_t joint_of(const front *work, uint32_t edge, uint32_t corner, const double normal[3])
{
    for (uint32_t out = work->first_out[corner]; out != NONE; out = work->edges[out].next_out)
    {
        const front_edge *other = &work->edges[out], *before = &work->edges[other->previous];
        if (vector3_dot(other->normal, normal) >= JOIN_COSINE && vector3_dot(before->normal, normal) >= JOIN_COSINE &&
            in_loop(work, edge, out))
            return out;
    }
    return NONE;
}

/// Whether a triangle can be added to a half-edge.
/// @param is_new receives whether the point is new
static bool fits(const front *work, uint32_t number, uint32_t corner, const double normal[3], bool *is_new)
{
    const front_edge *edge = &work->edges[number];
    const front_edge *next = &work->edges[edge->next], *previous = &work->edges[edge->previous];
    *is_new = !work->used[corner];
    if (*is_new)
        return true;
    if (work->only_new || work->first_out[corner] == NONE)
        return false;
    bool ends = next->to == corner, begins = previous->from == corner;
    if ((ends && vector3_dot(next->normal, normal) < FOLD_COSINE) ||
        (begins && vector3_dot(previous->normal, normal) < FOLD_COSINE))
        return false;
    if (ends && begins)
        return next->next == edge->previous;
    if (ends)
        return uses_of(work, edge->from, corner) == 0;
    if (begins)
        return uses_of(work, edge->to, corner) == 0;
    return uses_of(work, edge->from, corner) == 0 && uses_of(work, edge->to, corner) == 0 &&
           joint_of(work, number, corner, normal) != NONE;
}

// The queue: a binary heap

static bool comes_before(const front_candidate *a, const front_candidate *b)
{
    return a->grade != b->grade ? a->grade > b->grade : a->edge < b->edge;
}

static bool queue_push(front *work, front_candidate candidate)
{
    if (!ARRAY_GROW(work->queue, work->queue_capacity, work->queue_count + 1))
        return false;
    size_t at = work->queue_count++;
    for (; at > 0 && comes_before(&candidate, &work->queue[(at - 1) / 2]); at = (at - 1) / 2)
        work->queue[at] = work->queue[(at - 1) / 2];
    work->queue[at] = candidate;
    return true;
}

static front_candidate queue_pop(front *work)
{
    front_candidate first = work->queue[0], last = work->queue[--work->queue_count];
    size_t at = 0;
    for (size_t child; (child = 2 * at + 1) < work->queue_count; at = child)
    {
        if (child + 1 < work->queue_count && comes_before(&work->queue[child + 1], &work->queue[child]))
            child++;
        if (!comes_before(&work->queue[child], &last))
            break;
        work->queue[at] = work->queue[child];
    }
    if (work->queue_count > 0)
        work->queue[at] = last;
    return first;
}

/// Find the best triangle of a half-edge, and put it into the queue. False when out of memory.
static bool find_candidate(front *work, uint32_t number)
{
    const front_edge edge = work->edges[number];
    uint64_t key = key_of_pair(edge.from, edge.to);
    size_t low = 0, high = 3 * work->triangle_count;
    BISECT(low, high, middle, work->sides[middle].key < key)
    front_candidate best = {.edge = number, .corner = NONE};
    double least = INFINITY;
    for (; low < 3 * work->triangle_count && work->sides[low].key == key; low++)
    {
        const front_triangle *triangle = &work->triangles[work->sides[low].triangle];
        uint32_t corner = triangle->corners[0] ^ triangle->corners[1] ^ triangle->corners[2] ^ edge.from ^ edge.to;
        double normal[3], mean = mean_spacing(work, triangle->corners);
        bool is_new;
        if (corner == edge.opposite || !(triangle->radius < least) || triangle->radius > work->max_radius * mean ||
            !normal_of(work, edge.from, edge.to, corner, normal))
            continue;
        double cosine = vector3_dot(normal, edge.normal);
        if (cosine < FOLD_COSINE || !fits(work, number, corner, normal, &is_new))
            continue;
        double cost = triangle->radius;
        if (work->options.spares_thin && !is_new)
            cost *= 1 + TURN_COST * fmax(SMOOTH_COSINE - cosine, 0);
        if (!(cost < least))
            continue;
        least = cost;
        best.corner = corner;
        best.grade = cosine >= SMOOTH_COSINE ? 1 / triangle->radius : cosine - 1;
    }
    return best.corner == NONE || queue_push(work, best);
}

static bool add_face(front *work, uint32_t a, uint32_t b, uint32_t c)
{
    bool grown = ARRAY_GROW(work->faces, work->face_capacity, 3 * (work->face_count + 1));
    const uint32_t corners[3] = {a, b, c};
    for (size_t k = 0; k < 3 && grown; k++)
    {
        uint32_t *uses = key_map_at(&work->uses, key_of_pair(corners[k], corners[(k + 1) % 3]));
        grown = uses != NULL;
        if (grown)
            *uses = *uses == NONE ? 1 : *uses + 1;
    }
    if (grown)
        memcpy(work->faces + 3 * work->face_count++, corners, sizeof corners);
    return grown;
}

/// Add a triangle that fits to a half-edge, and find candidates of the new half-edges. False when out of memory.
static bool add_triangle(front *work, uint32_t number, uint32_t corner, const double normal[3])
{
    const front_edge edge = work->edges[number];
    uint32_t next = edge.next, previous = edge.previous, after = work->edges[next].next,
             before = work->edges[previous].previous, added = (uint32_t)work->edge_count;
    bool is_new = !work->used[corner], ends = work->edges[next].to == corner, begins = work->edges[previous].from == corner;
    uint32_t out = is_new || ends || begins ? NONE : joint_of(work, number, corner, normal);
    if (!add_face(work, edge.from, edge.to, corner))
        return false;
    work->used[corner] = true;
    detach(work, number);
    if (ends)
        detach(work, next);
    if (begins)
        detach(work, previous);
    if (ends && begins)
        return true;
    if (ends)
    {
        if (!add_edge(work, edge.from, corner, edge.to, normal))
            return false;
        link_edges(work, previous, added);
        link_edges(work, added, after);
        return find_candidate(work, added);
    }
    if (begins)
    {
        if (!add_edge(work, corner, edge.to, edge.from, normal))
            return false;
        link_edges(work, before, added);
        link_edges(work, added, next);
        return find_candidate(work, added);
    }
    if (!add_edge(work, edge.from, corner, edge.to, normal) || !add_edge(work, corner, edge.to, edge.from, normal))
        return false;
    link_edges(work, previous, added);
    link_edges(work, added + 1, next);
    if (out == NONE)
        link_edges(work, added, added + 1);
    else
    {
        link_edges(work, work->edges[out].previous, added + 1);
        link_edges(work, added, out);
    }
    return find_candidate(work, added) && find_candidate(work, added + 1);
}

/// Add triangles as long as there are candidates.
/// @param goes_on receives false where the caller is to stop
static bool advance(front *work, bat_progress progress, bool *goes_on)
{
    for (size_t step = 0; work->queue_count > 0; step++)
    {
        front_candidate candidate = queue_pop(work);
        const front_edge *edge = &work->edges[candidate.edge];
        double normal[3];
        bool is_new;
        if (!edge->alive)
            continue;
        if (step % PROGRESS_STEP == 0 && !progress_goes_on(progress, 0))
        {
            *goes_on = false;
            return true;
        }
        bool fitting = normal_of(work, edge->from, edge->to, candidate.corner, normal) &&
                       fits(work, candidate.edge, candidate.corner, normal, &is_new);
        if (!(fitting ? add_triangle(work, candidate.edge, candidate.corner, normal) : find_candidate(work, candidate.edge)))
            return false;
    }
    return true;
}

/// Begin with the triangle of the smallest ball whose corners are not used, and whose ball is not much smaller than the
/// spacing. False when out of memory.
static bool begin_at(front *work, uint32_t triangle)
{
    const uint32_t *corners = work->triangles[triangle].corners;
    double normal[3], back[3];
    uint32_t first = (uint32_t)work->edge_count;
    if (!normal_of(work, corners[0], corners[1], corners[2], normal))
        return true;
    for (int k = 0; k < 3; k++)
        back[k] = normal[k];
    if (!add_face(work, corners[0], corners[1], corners[2]))
        return false;
    // The missing faces are on the other sides of the edges.
    for (size_t k = 0; k < 3; k++)
    {
        size_t from = (3 - k) % 3, to = (2 - k) % 3;
        work->used[corners[k]] = true;
        if (!add_edge(work, corners[from], corners[to], corners[3 - from - to], back))
            return false;
    }
    for (uint32_t k = 0; k < 3; k++)
        link_edges(work, first + k, first + (k + 1) % 3);
    for (uint32_t k = 0; k < 3; k++)
        if (!find_candidate(work, first + k))
            return false;
    return true;
}

/// Let the surface grow from a triangle: first with small triangles, then with larger ones that reach new points.
static bat_status grow(front *work, uint32_t first, bat_progress progress, bat_error *error)
{
    bool complete = true, goes_on = true;
    work->max_radius = work->options.scale * MAX_RADIUS[0];
    work->only_new = false;
    complete = begin_at(work, first) && advance(work, progress, &goes_on);
    for (size_t faces = 0; complete && goes_on && faces < work->face_count;)
    {
        faces = work->face_count;
        for (int pass = 0; pass < 3 && complete && goes_on; pass++)
        {
            work->only_new = pass == 1;
            work->max_radius = work->only_new ? MAX_RADIUS[1] : work->options.scale * MAX_RADIUS[0];
            size_t edges = work->edge_count;
            for (size_t e = 0; e < edges && complete; e++)
                if (work->edges[e].alive)
                    complete = find_candidate(work, (uint32_t)e);
            complete = complete && advance(work, progress, &goes_on);
        }
    }
    if (!goes_on)
        return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
    return complete ? BAT_OK : error_memory(error, work->triangle_count * sizeof *work->triangles);
}

/// A triangle to begin with, and how little it fits to its neighbourhood.
typedef struct front_seed
{
    double misfit;
    uint32_t triangle;
} front_seed;

DEFINE_ORDER(compare_seeds, front_seed, misfit, triangle)

enum
{
    SEEDS = 256, ///< triangles that are compared
    TRIES = 8    ///< of them, those that are tried
};
/// Largest radius of a triangle to begin with, in mean spacings.
static const double MAX_SEED_RADIUS = 0.8;
/// The share of the points from which on a surface is not begun again.
static const double MIN_SHARE = 0.6;

/// Choose triangles that lie in the tangent planes of flat neighbourhoods, the best first.
static bat_status find_seeds(const front *work, const nearest_tree *tree, front_seed seeds[SEEDS], size_t *count,
                             bat_error *error)
{
    neighbour_list near = {0};
    size_t stride = work->triangle_count / SEEDS + 1;
    bat_status status = BAT_OK;
    *count = 0;
    for (size_t begin = 0; begin < work->triangle_count && status == BAT_OK; begin += stride)
    {
        // The first small triangle of each block.
        size_t t = begin, end = begin + stride < work->triangle_count ? begin + stride : work->triangle_count;
        while (t < end && work->triangles[t].radius > MAX_SEED_RADIUS * mean_spacing(work, work->triangles[t].corners))
            t++;
        const uint32_t *corners = work->triangles[t < end ? t : begin].corners;
        double normal[3];
        if (t == end || !normal_of(work, corners[0], corners[1], corners[2], normal))
            continue;
        local_plane plane;
        status = neighbours_nearest(tree, point_of(work, corners[0]), NEIGHBOURHOOD_MIN, &near, error);
        if (status != BAT_OK)
            break;
        plane = local_plane_fit(work->points, &near);
        double cosine = fabs(vector3_dot(plane.axes[2], normal));
        double flatness = plane.variance[1] > 0 ? sqrt(plane.variance[2] / plane.variance[1]) : 1;
        seeds[(*count)++] = (front_seed){flatness + 1 - cosine, (uint32_t)t};
    }
    neighbour_list_free(&near);
    qsort(seeds, *count, sizeof *seeds, compare_seeds);
    return status;
}

/// Let the surface grow from one triangle after another, until it has most of the points.
static bat_status grow_from_best(front *work, const nearest_tree *tree, bat_progress progress, bat_error *error)
{
    front_seed seeds[SEEDS];
    size_t count, used = 0;
    bat_status status = find_seeds(work, tree, seeds, &count, error);
    for (size_t k = 0; k < count && k < TRIES && status == BAT_OK && (double)used < MIN_SHARE * (double)work->count; k++)
    {
        memset(work->first_out, 0xff, work->count * sizeof *work->first_out);
        memset(work->used, 0, work->count * sizeof *work->used);
        key_map_free(&work->uses);
        work->uses = (key_map){0};
        work->edge_count = work->queue_count = work->face_count = 0;
        status = grow(work, seeds[k].triangle, progress, error);
        used = 0;
        for (size_t i = 0; i < work->count; i++)
            used += work->used[i];
    }
    if (status == BAT_OK && used == 0)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the points have no triangulation");
    return status;
}

// Loops

static double loop_length(const front *work, uint32_t edge, size_t *count)
{
    double length = 0;
    uint32_t e = edge;
    *count = 0;
    do
    {
        ++*count;
        length += vector3_distance(point_of(work, work->edges[e].from), point_of(work, work->edges[e].to));
        e = work->edges[e].next;
    } while (e != edge);
    return length;
}

/// Fill a loop: cut off the ear with the shortest new edge, until a triangle is left. False when out of memory, or where no
/// ear is left.
static bool fill_loop(front *work, uint32_t edge, bool *filled)
{
    for (;;)
    {
        uint32_t e = edge, best = NONE;
        double shortest = INFINITY;
        if (work->edges[work->edges[edge].next].next == edge)
        {
            *filled = false;
            return true;
        }
        bool last = work->edges[work->edges[work->edges[edge].next].next].next == edge;
        do
        {
            const front_edge *here = &work->edges[e], *next = &work->edges[here->next];
            double length = vector3_distance(point_of(work, here->from), point_of(work, next->to));
            if (length < shortest && (last || uses_of(work, here->from, next->to) == 0) && here->from != next->to)
            {
                shortest = length;
                best = e;
            }
            e = here->next;
        } while (e != edge);
        if (best == NONE)
        {
            *filled = false;
            return true;
        }
        const front_edge here = work->edges[best];
        uint32_t corner = work->edges[here.next].to, after = work->edges[here.next].next, added;
        if (!add_face(work, here.from, here.to, corner))
            return false;
        detach(work, best);
        detach(work, here.next);
        if (last)
        {
            detach(work, after);
            return true;
        }
        added = (uint32_t)work->edge_count;
        if (!add_edge(work, here.from, corner, here.to, here.normal))
            return false;
        link_edges(work, here.previous, added);
        link_edges(work, added, after);
        edge = added;
    }
}

/// Whether the boundary meets itself turned over, as that of a one-sided surface does which is cut: points of it are in each
/// other's tangent planes, with opposite normals.
static bool is_turned(const front *work, uint32_t outer)
{
    size_t turned = 0, count = 0, at = 0;
    (void)loop_length(work, outer, &count);
    for (uint32_t e = outer; at < count; e = work->edges[e].next, at++)
    {
        const front_edge *here = &work->edges[e];
        size_t place = 0;
        bool found = false;
        for (uint32_t o = outer; place < count && !found; o = work->edges[o].next, place++)
        {
            const front_edge *other = &work->edges[o];
            size_t apart = place > at ? place - at : at - place;
            double arm[3], reach = SEAM_REACH * (work->spacing[here->from] + work->spacing[other->from]) / 2;
            vector3_subtract(point_of(work, other->from), point_of(work, here->from), arm);
            double length = sqrt(vector3_dot(arm, arm));
            found = SEAM_APART * (apart < count - apart ? apart : count - apart) > count && length < reach &&
                    vector3_dot(here->normal, other->normal) < -SEAM_COSINE &&
                    fabs(vector3_dot(arm, here->normal)) < length * (1 - SEAM_COSINE);
        }
        turned += found;
    }
    return turned >= MIN_SEAM;
}

/// Fill the shorter part of loops that touch themselves.
/// @param outer   an edge of the longest loop, and of what is left of it
/// @param longest its length
/// @param filled  receives false for a part that is too long to be a hole
/// @return false where memory runs out
static bool fill_touching(front *work, uint32_t *outer, double longest, bool *filled)
{
    bool complete = true;
    uint32_t e = *outer;
    for (size_t steps = 0; complete && *filled && steps <= work->edge_count; steps++)
    {
        uint32_t other = NONE;
        for (uint32_t out = work->first_out[work->edges[e].from]; out != NONE; out = work->edges[out].next_out)
            if (out != e)
                other = out;
        if (other == NONE)
        {
            e = work->edges[e].next;
            if (e == *outer)
                break;
            continue;
        }
        // Split the loop at the point that it visits twice.
        uint32_t before_first = work->edges[e].previous, before_second = work->edges[other].previous;
        link_edges(work, before_second, e);
        link_edges(work, before_first, other);
        size_t counts[2];
        double lengths[2] = {loop_length(work, e, &counts[0]), loop_length(work, other, &counts[1])};
        *filled = fmin(lengths[0], lengths[1]) <= MAX_HOLE[counts[lengths[0] >= lengths[1]] <= SMALL_HOLE] * longest;
        *outer = lengths[0] >= lengths[1] ? e : other;
        if (*filled)
            complete = fill_loop(work, lengths[0] >= lengths[1] ? other : e, filled);
        e = *outer;
        steps = 0;
    }
    return complete;
}

/// Fill all loops but the longest, which visits each point once at the end.
static bat_status close_holes(front *work, bat_error *error)
{
    uint32_t outer = NONE;
    double longest = 0;
    bool complete = true, filled = true, *visited = calloc(work->edge_count + 1, sizeof *visited);
    if (visited == NULL)
        return error_memory(error, work->edge_count);
    size_t edges = work->edge_count;
    for (int pass = 0; pass < 2 && complete && filled; pass++)
    {
        memset(visited, 0, edges * sizeof *visited);
        uint32_t kept = outer;
        for (uint32_t e = kept, k = 0; pass == 1 && kept != NONE && (k == 0 || e != kept); k++, e = work->edges[e].next)
            visited[e] = true;
        for (uint32_t e = 0; e < edges && complete && filled; e++)
        {
            if (!work->edges[e].alive || visited[e])
                continue;
            for (uint32_t k = e; !visited[k]; k = work->edges[k].next)
                visited[k] = true;
            size_t count;
            double length = loop_length(work, e, &count);
            if (pass == 0 && length > longest)
            {
                longest = length;
                outer = e;
            }
            if (pass == 0)
                continue;
            filled = length <= MAX_HOLE[count <= SMALL_HOLE] * longest;
            if (filled)
                complete = fill_loop(work, e, &filled);
        }
    }
    free(visited);
    complete = complete && (!filled || outer == NONE || fill_touching(work, &outer, longest, &filled));
    if (!complete)
        return error_memory(error, work->edge_count * sizeof *work->edges);
    if (filled && outer != NONE && is_turned(work, outer))
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the points are on a one-sided surface");
    return filled && outer != NONE
               ? BAT_OK
               : error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the triangles of the points are no disc");
}

// Points that are left over

/// The squared distance of a point from a triangle (Ericson, "Real-time collision detection", 2005, section 5.1.5).
static double triangle_distance(const double *p, const double *a, const double *b, const double *c)
{
    double ab[3], ac[3], ap[3], nearest[3], bp[3], cp[3];
    vector3_subtract(b, a, ab);
    vector3_subtract(c, a, ac);
    vector3_subtract(p, a, ap);
    vector3_subtract(p, b, bp);
    vector3_subtract(p, c, cp);
    double d1 = vector3_dot(ab, ap), d2 = vector3_dot(ac, ap), d3 = vector3_dot(ab, bp), d4 = vector3_dot(ac, bp),
           d5 = vector3_dot(ab, cp), d6 = vector3_dot(ac, cp), v, w;
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (d1 <= 0 && d2 <= 0)
        v = w = 0;
    else if (d3 >= 0 && d4 <= d3)
        v = 1, w = 0;
    else if (d6 >= 0 && d5 <= d6)
        v = 0, w = 1;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0)
        v = d1 / (d1 - d3), w = 0;
    else if (vb <= 0 && d2 >= 0 && d6 <= 0)
        v = 0, w = d2 / (d2 - d6);
    else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        w = (d4 - d3) / (d4 - d3 + d5 - d6), v = 1 - w;
    else
        v = vb / (va + vb + vc), w = vc / (va + vb + vc);
    for (int k = 0; k < 3; k++)
        nearest[k] = p[k] - a[k] - v * ab[k] - w * ac[k];
    return vector3_dot(nearest, nearest);
}

/// Split the nearest triangle of each point that is left over.
static bat_status add_left(front *work, bat_error *error)
{
    size_t left = 0;
    for (size_t i = 0; i < work->count; i++)
        left += !work->used[i];
    if ((double)left > MAX_LEFT * (double)work->count)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "%zu points are not on the triangles of the others",
                         left);
    for (uint32_t i = 0; i < work->count; i++)
    {
        double least = INFINITY;
        size_t nearest = 0;
        if (work->used[i])
            continue;
        for (size_t f = 0; f < work->face_count; f++)
        {
            const uint32_t *face = work->faces + 3 * f;
            double distance = triangle_distance(point_of(work, i), point_of(work, face[0]), point_of(work, face[1]),
                                                point_of(work, face[2]));
            if (distance < least)
            {
                least = distance;
                nearest = f;
            }
        }
        uint32_t *face = work->faces + 3 * nearest, a = face[0], b = face[1], c = face[2];
        face[2] = i;
        if (!add_face(work, b, c, i) || !add_face(work, c, a, i))
            return error_memory(error, work->face_count * 3 * sizeof *work->faces);
        work->used[i] = true;
    }
    return BAT_OK;
}

static bat_status front_make(const bat_cloud *cloud, const double *points, bat_progress progress, front *work,
                             bat_error *error)
{
    size_t count = cloud->count;
    nearest_tree tree = {0};
    simplices tetrahedra = {0};
    work->points = points;
    work->count = count;
    work->spacing = memory_pool_array(&work->pool, count, sizeof *work->spacing);
    work->first_out = memory_pool_array(&work->pool, count, sizeof *work->first_out);
    work->used = memory_pool_zeros(&work->pool, count, sizeof *work->used);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status == BAT_OK)
        status = neighbours_build(points, count, &tree, error);
    if (status == BAT_OK)
        status = measure_spacing(work, &tree, error);
    if (status == BAT_OK)
        status = spatial_delaunay(points, count, &tetrahedra, error);
    if (status == BAT_OK)
        status = gather_triangles(work, &tetrahedra, error);
    simplices_free(&tetrahedra);
    if (status == BAT_OK)
        status = grow_from_best(work, &tree, progress, error);
    nearest_free(&tree);
    if (status == BAT_OK)
        status = close_holes(work, error);
    return status == BAT_OK ? add_left(work, error) : status;
}

bat_status advancing_front_triangulate(const bat_cloud *cloud, advancing_front_options options, bat_progress progress,
                                       bat_cloud *disc, bat_error *error)
{
    front work = {.options = options};
    bat_cloud made = {0};
    double *points = points_to_unit_size(cloud->points, cloud->count);
    bat_status status = points == NULL ? error_memory(error, cloud->count * 3 * sizeof *points)
                                       : front_make(cloud, points, progress, &work, error);
    if (status == BAT_OK)
    {
        const bat_mesh mesh = {
            .positions = cloud->points, .faces = work.faces, .vertex_count = cloud->count, .face_count = work.face_count};
        status = bat_cloud_from_mesh(&mesh, &made, error);
    }
    if (status == BAT_OK &&
        (made.count != cloud->count || (double)made.boundary_count < MIN_BOUNDARY_ROOTS * sqrt((double)cloud->count)))
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the triangles of the points are no disc");
    // bat_cloud_from_mesh() reports a mesh that is no disc as unsupported.
    if (status != BAT_OK && status != BAT_NO_MEMORY && status != BAT_CANCELLED)
        status = BAT_NO_CONVERGENCE;
    for (size_t i = 0; i < made.count && status == BAT_OK; i++)
        made.order[i] = cloud_input_index(cloud, made.order[i]);
    front_free(&work);
    free(points);
    if (status == BAT_OK)
    {
        made.duplicates = cloud->duplicates;
        *disc = made;
    }
    else
        bat_cloud_free(&made);
    return status;
}
