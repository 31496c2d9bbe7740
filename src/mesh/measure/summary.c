#include "batten/mesh_measure.h"

#include "base/choice.h"
#include "base/counting_sort.h"
#include "base/disjoint_sets.h"
#include "base/exact_sum.h"
#include "linalg/vector.h"
#include "mesh/check.h"
#include "mesh/measure/closest.h"

/// @file
/// Counts, connectivity and geometry of a mesh that need not be manifold.
///
/// The Euler characteristic is V - E + F without isolated vertices; a closed oriented manifold of c components has the genus
/// c - (V - E + F) / 2. The quality of a triangle is 4 sqrt(3) area / (a^2 + b^2 + c^2). The volume is the sum of (p_1 .
/// (p_2 x p_3)) / 6. A measure is a field of bat_mesh_summary and a row of MEASURES.

/// Half-edges grouped by edge: edge e has order[begin[e]], …, order[begin[e + 1] - 1], in increasing order.
typedef struct edge_groups
{
    uint32_t *order; ///< 3 x face_count half-edges
    uint32_t *begin; ///< count + 1
    size_t count;
} edge_groups;

static size_t lesser_end(const void *context, uint32_t half_edge)
{
    const uint32_t *faces = context;
    uint32_t a = faces[half_edge], b = faces[bat_mesh_next(half_edge)];
    return a < b ? a : b;
}

static size_t greater_end(const void *context, uint32_t half_edge)
{
    const uint32_t *faces = context;
    uint32_t a = faces[half_edge], b = faces[bat_mesh_next(half_edge)];
    return a < b ? b : a;
}

/// Find the first half-edge of each edge in the sorted order.
static void mark_edges(const bat_mesh *mesh, edge_groups *groups)
{
    uint32_t count = (uint32_t)(3 * mesh->face_count), edges = 0;
    for (uint32_t i = 0; i < count; i++)
    {
        uint32_t h = groups->order[i], before = i > 0 ? groups->order[i - 1] : h;
        if (i == 0 || lesser_end(mesh->faces, h) != lesser_end(mesh->faces, before) ||
            greater_end(mesh->faces, h) != greater_end(mesh->faces, before))
            groups->begin[edges++] = i;
    }
    groups->begin[edges] = count;
    groups->count = edges;
}

/// The connectivity of a mesh.
typedef struct topology
{
    const bat_mesh *mesh;
    edge_groups edges;
    uint32_t *vertex_sets; ///< sets of vertices joined by edges
    uint32_t *fans;        ///< sets of corners, numbered as half-edges, joined around their vertex
    uint32_t *loops;       ///< sets of corners that are also joined along the boundary
    uint32_t *valence;
    memory_pool pool; ///< of all arrays
} topology;

static bat_status topology_make(const bat_mesh *mesh, topology *made, bat_error *error)
{
    size_t corners = 3 * mesh->face_count, vertices = mesh->vertex_count;
    *made = (topology){.mesh = mesh};
    made->vertex_sets = memory_pool_array(&made->pool, vertices, sizeof *made->vertex_sets);
    made->fans = memory_pool_array(&made->pool, corners, sizeof *made->fans);
    made->loops = memory_pool_array(&made->pool, corners, sizeof *made->loops);
    made->valence = memory_pool_zeros(&made->pool, vertices, sizeof *made->valence);
    made->edges.order = memory_pool_array(&made->pool, corners, sizeof *made->edges.order);
    made->edges.begin = memory_pool_array(&made->pool, corners + 1, sizeof *made->edges.begin);
    size_t *starts = memory_pool_array(&made->pool, vertices + 1, sizeof *starts);
    bat_status status = memory_pool_check(&made->pool, error);
    if (status != BAT_OK)
        return status;
    sets_begin(made->vertex_sets, vertices);
    sets_begin(made->fans, corners);
    counting_sort(NULL, corners, greater_end, mesh->faces, vertices, starts, made->edges.begin);
    counting_sort(made->edges.begin, corners, lesser_end, mesh->faces, vertices, starts, made->edges.order);
    mark_edges(mesh, &made->edges);
    return BAT_OK;
}

/// Join the corners of two faces at both ends of their common edge.
static void join_corners(const topology *made, uint32_t h, uint32_t other)
{
    const uint32_t *faces = made->mesh->faces;
    uint32_t begin = other, end = bat_mesh_next(other);
    bool against = faces[h] != faces[other];
    (void)sets_join(made->fans, h, against ? end : begin);
    (void)sets_join(made->fans, bat_mesh_next(h), against ? begin : end);
}

/// Join the sets at one edge and count it.
static void count_edge(const topology *made, size_t edge, bat_mesh_summary *summary)
{
    const uint32_t *faces = made->mesh->faces, *half_edges = made->edges.order + made->edges.begin[edge];
    uint32_t count = made->edges.begin[edge + 1] - made->edges.begin[edge];
    uint32_t a = faces[half_edges[0]], b = faces[bat_mesh_next(half_edges[0])];
    (void)sets_join(made->vertex_sets, a, b);
    made->valence[a]++;
    made->valence[b]++;
    for (uint32_t i = 1; i < count; i++)
        join_corners(made, half_edges[0], half_edges[i]);
    summary->boundary_edges += count == 1;
    summary->nonmanifold_edges += count > 2;
    summary->reversed_edges += count == 2 && faces[half_edges[1]] == a;
}

/// The number of boundary loops. Where several fans meet in a vertex, each belongs to its own loop.
static size_t count_loops(const topology *made)
{
    size_t corners = 3 * made->mesh->face_count, count = 0;
    memcpy(made->loops, made->fans, corners * sizeof *made->loops);
    for (size_t e = 0; e < made->edges.count; e++)
        if (made->edges.begin[e + 1] - made->edges.begin[e] == 1)
        {
            uint32_t h = made->edges.order[made->edges.begin[e]];
            // An edge within one set closes a loop.
            uint32_t a = sets_root(made->loops, h), b = sets_root(made->loops, bat_mesh_next(h));
            count += a == b;
            (void)sets_join(made->loops, a, b);
        }
    return count;
}

/// Count components, isolated vertices, vertices with several fans, and valences. Overwrites the valences.
static void count_vertices(const topology *made, bat_mesh_summary *summary)
{
    const bat_mesh *mesh = made->mesh;
    summary->min_valence = SIZE_MAX;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
    {
        size_t valence = made->valence[v];
        summary->isolated_vertices += valence == 0;
        summary->components += valence > 0 && sets_root(made->vertex_sets, v) == v;
        summary->max_valence = valence > summary->max_valence ? valence : summary->max_valence;
        if (valence > 0 && valence < summary->min_valence)
            summary->min_valence = valence;
    }
    uint32_t *fan_count = made->valence;
    memset(fan_count, 0, mesh->vertex_count * sizeof *fan_count);
    for (uint32_t corner = 0; corner < 3 * mesh->face_count; corner++)
        if (sets_root(made->fans, corner) == corner)
            summary->pinched_vertices += ++fan_count[mesh->faces[corner]] == 2;
}

static void sum_up_topology(const topology *made, bat_mesh_summary *summary)
{
    for (size_t e = 0; e < made->edges.count; e++)
        count_edge(made, e, summary);
    count_vertices(made, summary);
    summary->edges = made->edges.count;
    summary->boundary_loops = count_loops(made);
    summary->euler = (int64_t)(summary->vertices - summary->isolated_vertices + summary->faces) - (int64_t)summary->edges;
    summary->manifold = summary->nonmanifold_edges == 0 && summary->pinched_vertices == 0;
    summary->oriented = summary->nonmanifold_edges == 0 && summary->reversed_edges == 0;
    summary->closed = summary->boundary_edges == 0;
    bool has_genus = summary->manifold && summary->oriented && summary->closed;
    summary->genus = has_genus ? (int64_t)summary->components - summary->euler / 2 : -1;
}

/// A mesh scaled by a power of two and shifted to the centre of its box, so that products do not overflow.
typedef struct scaled_mesh
{
    const bat_mesh *mesh;
    double scale, middle[3];
} scaled_mesh;

static void corner_of(const scaled_mesh *scaled, size_t corner, double point[3])
{
    const double *position = scaled->mesh->positions + 3 * (size_t)scaled->mesh->faces[corner];
    for (int k = 0; k < 3; k++)
        point[k] = position[k] * scaled->scale - scaled->middle[k];
}

/// A face of the scaled mesh.
typedef struct face_shape
{
    double corners[3][3], edges[3][3]; ///< edge c runs from corner c to the next
    double normal[3], twice_area;      ///< the normal's length is twice the area
    double squares, longest;           ///< of the edges' lengths: the sum, and the greatest
    double angles[3];                  ///< at the corners
} face_shape;

static void face_shape_of(const scaled_mesh *scaled, size_t face, face_shape *shape)
{
    shape->squares = shape->longest = 0;
    for (size_t c = 0; c < 3; c++)
        corner_of(scaled, 3 * face + c, shape->corners[c]);
    for (int c = 0; c < 3; c++)
    {
        vector3_subtract(shape->corners[(c + 1) % 3], shape->corners[c], shape->edges[c]);
        double square = vector3_dot(shape->edges[c], shape->edges[c]);
        shape->squares += square;
        shape->longest = fmax(shape->longest, square);
    }
    vector3_cross(shape->edges[0], shape->edges[1], shape->normal);
    shape->twice_area = vector3_length(shape->normal);
    for (int c = 0; c < 3; c++)
        shape->angles[c] = atan2(shape->twice_area, -vector3_dot(shape->edges[c], shape->edges[(c + 2) % 3]));
}

static double area_of(const face_shape *face)
{
    return face->twice_area / 2;
}

static double volume_of(const face_shape *face)
{
    return vector3_dot(face->corners[0], face->normal) / 6;
}

static double quality_of(const face_shape *face)
{
    return face->squares > 0 ? 2 * sqrt(3) * face->twice_area / face->squares : 0;
}

static double min_angle_of(const face_shape *face)
{
    return fmin(fmin(face->angles[0], face->angles[1]), face->angles[2]);
}

static double max_angle_of(const face_shape *face)
{
    return fmax(fmax(face->angles[0], face->angles[1]), face->angles[2]);
}

/// How the values of all faces, or the lengths of all edges, become one number.
typedef enum reduction
{
    NONE, ///< the number is none of these
    SUM,
    MEAN,
    MIN,
    MAX
} reduction;

/// A row of the table of measures.
typedef struct mesh_measure
{
    bat_measure row;
    reduction of_edges, of_faces;
    double (*value)(const face_shape *face); ///< of a face
    int power;                               ///< of the unit of length in the number
} mesh_measure;

#define ROW(field, title, form, ...)                                                                                        \
    {                                                                                                                       \
        MEASURE(bat_mesh_summary, field, title, form), __VA_ARGS__                                                          \
    }
#define GIVEN(field, title, form) ROW(field, title, form, NONE, NONE, NULL, 0)
#define OF_EDGES(field, title, how) ROW(field, title, NUMBER, how, NONE, NULL, 1)
#define OF_FACES(field, title, how, value, power) ROW(field, title, NUMBER, NONE, how, value, power)

static const mesh_measure MEASURES[] = {
    GIVEN(vertices, "vertices", COUNT),
    GIVEN(isolated_vertices, "  without a face", COUNT),
    GIVEN(edges, "edges", COUNT),
    GIVEN(boundary_edges, "  at a boundary", COUNT),
    GIVEN(nonmanifold_edges, "  of more than two faces", COUNT),
    GIVEN(reversed_edges, "  of faces that run against each other", COUNT),
    GIVEN(faces, "faces", COUNT),
    GIVEN(degenerate_faces, "  degenerate", COUNT),
    GIVEN(components, "components", COUNT),
    GIVEN(boundary_loops, "boundary loops", COUNT),
    GIVEN(pinched_vertices, "vertices of several fans of faces", COUNT),
    GIVEN(manifold, "manifold", FLAG),
    GIVEN(oriented, "oriented", FLAG),
    GIVEN(closed, "closed", FLAG),
    GIVEN(euler, "Euler characteristic", SIGNED),
    GIVEN(genus, "genus", GENUS),
    OF_FACES(area, "area", SUM, area_of, 2),
    OF_FACES(volume, "volume", SUM, volume_of, 3),
    GIVEN(low, "lowest coordinates", POINT),
    GIVEN(high, "highest coordinates", POINT),
    GIVEN(diagonal, "diagonal of the bounding box", NUMBER),
    OF_EDGES(min_edge, "shortest edge", MIN),
    OF_EDGES(mean_edge, "mean edge", MEAN),
    OF_EDGES(max_edge, "longest edge", MAX),
    OF_FACES(min_quality, "least triangle quality", MIN, quality_of, 0),
    GIVEN(min_quality_face, "  of face", COUNT),
    OF_FACES(mean_quality, "mean triangle quality", MEAN, quality_of, 0),
    OF_FACES(min_angle, "least angle, radians", MIN, min_angle_of, 0),
    OF_FACES(max_angle, "largest angle, radians", MAX, max_angle_of, 0),
    GIVEN(min_valence, "least valence", COUNT),
    GIVEN(max_valence, "greatest valence", COUNT),
};

#define MEASURE_COUNT (sizeof MEASURES / sizeof *MEASURES)

/// A measure that faces or edges are added to.
typedef struct reduced
{
    const mesh_measure *measure;
    reduction how;
    exact_sum sum;
    double extreme;
    size_t count, where; ///< the values so far, and the first that is the extreme
} reduced;

static void reduced_add(reduced *into, double value)
{
    bool better = into->how == MIN ? value < into->extreme : into->how == MAX && value > into->extreme;
    if (into->how == SUM || into->how == MEAN)
        sum_add(&into->sum, value);
    if (better)
    {
        into->extreme = value;
        into->where = into->count;
    }
    into->count++;
}

/// Begin the measures of faces, or of edges. Returns how many there are.
static size_t reduced_begin(bool of_edges, reduced into[MEASURE_COUNT])
{
    size_t count = 0;
    for (size_t i = 0; i < MEASURE_COUNT; i++)
    {
        reduction how = of_edges ? MEASURES[i].of_edges : MEASURES[i].of_faces;
        if (how != NONE)
            into[count++] = (reduced){.measure = &MEASURES[i], .how = how, .extreme = how == MIN ? INFINITY : 0};
    }
    return count;
}

/// Store the measures in the unit of the mesh.
static void reduced_end(const reduced *from, size_t count, double scale, bat_mesh_summary *summary)
{
    for (size_t i = 0; i < count; i++)
    {
        double value = from[i].how == SUM || from[i].how == MEAN ? sum_total(&from[i].sum) : from[i].extreme;
        if (from[i].how == MEAN)
            value /= (double)from[i].count;
        for (int k = 0; k < from[i].measure->power; k++)
            value /= scale;
        size_t offset = from[i].measure->row.offset;
        memcpy((char *)summary + offset, &value, sizeof value);
        if (offset == offsetof(bat_mesh_summary, min_quality))
            summary->min_quality_face = from[i].where;
    }
}

static void measure_faces(const scaled_mesh *scaled, bat_mesh_summary *summary)
{
    static const double MIN_HEIGHT = 1e-14;
    reduced measures[MEASURE_COUNT];
    size_t count = reduced_begin(false, measures);
    for (size_t f = 0; f < scaled->mesh->face_count; f++)
    {
        face_shape shape;
        face_shape_of(scaled, f, &shape);
        summary->degenerate_faces += shape.twice_area <= MIN_HEIGHT * shape.longest;
        for (size_t i = 0; i < count; i++)
            reduced_add(&measures[i], measures[i].measure->value(&shape));
    }
    reduced_end(measures, count, scaled->scale, summary);
}

static void measure_edges(const scaled_mesh *scaled, const edge_groups *edges, bat_mesh_summary *summary)
{
    reduced measures[MEASURE_COUNT];
    size_t count = reduced_begin(true, measures);
    for (size_t e = 0; e < edges->count; e++)
    {
        uint32_t h = edges->order[edges->begin[e]];
        double a[3], b[3], edge[3];
        corner_of(scaled, h, a);
        corner_of(scaled, bat_mesh_next(h), b);
        vector3_subtract(b, a, edge);
        for (size_t i = 0; i < count; i++)
            reduced_add(&measures[i], vector3_length(edge));
    }
    reduced_end(measures, count, scaled->scale, summary);
}

static void find_box(const bat_mesh *mesh, bat_mesh_summary *summary)
{
    box_clear(3, summary->low, summary->high);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        box_include(3, mesh->positions + 3 * (size_t)mesh->faces[i], summary->low, summary->high);
    summary->diagonal = hypot(hypot(summary->high[0] - summary->low[0], summary->high[1] - summary->low[1]),
                              summary->high[2] - summary->low[2]);
}

static void sum_up_geometry(const bat_mesh *mesh, const edge_groups *edges, bat_mesh_summary *summary)
{
    find_box(mesh, summary);
    scaled_mesh scaled = {.mesh = mesh, .scale = closest_scale(closest_largest(mesh->positions, 3 * mesh->vertex_count, 0))};
    for (int k = 0; k < 3; k++)
        scaled.middle[k] = summary->low[k] * scaled.scale / 2 + summary->high[k] * scaled.scale / 2;
    measure_faces(&scaled, summary);
    measure_edges(&scaled, edges, summary);
    if (!summary->closed || !summary->oriented)
        summary->volume = NAN;
}

static const bat_measure DISTANCES[] = {
    MEASURE(bat_mesh_distance, hausdorff_from_first, "greatest distance, A to B", LENGTH),
    MEASURE(bat_mesh_distance, hausdorff_from_second, "greatest distance, B to A", LENGTH),
    MEASURE(bat_mesh_distance, hausdorff, "Hausdorff distance", LENGTH),
    MEASURE(bat_mesh_distance, hausdorff_bound, "  proven to be at most", LENGTH),
    MEASURE(bat_mesh_distance, mean_from_first, "mean distance, A to B", LENGTH),
    MEASURE(bat_mesh_distance, mean_from_second, "mean distance, B to A", LENGTH),
    MEASURE(bat_mesh_distance, mean, "mean distance, both ways", LENGTH),
    MEASURE(bat_mesh_distance, mean_max, "greater of the two means", LENGTH),
    MEASURE(bat_mesh_distance, rms_from_first, "root mean square, A to B", LENGTH),
    MEASURE(bat_mesh_distance, rms_from_second, "root mean square, B to A", LENGTH),
    MEASURE(bat_mesh_distance, diagonal, "diagonal of B's bounding box", LENGTH),
    MEASURE(bat_mesh_distance, farthest_from_first, "farthest point of A", POINT),
    MEASURE(bat_mesh_distance, farthest_from_second, "farthest point of B", POINT),
};

bool bat_mesh_measures(size_t meshes, size_t index, bat_measure *measure)
{
    bool of_one = meshes == 1 && index < MEASURE_COUNT, of_two = meshes == 2 && index < sizeof DISTANCES / sizeof *DISTANCES;
    if (of_one || of_two)
        *measure = of_one ? MEASURES[index].row : DISTANCES[index];
    return of_one || of_two;
}

bat_status bat_mesh_summarize(const bat_mesh *mesh, bat_mesh_summary *summary, bat_error *error)
{
    bat_status status = mesh_check_triangles(mesh, error);
    if (status != BAT_OK)
        return status;
    topology made;
    bat_mesh_summary sum = {.vertices = mesh->vertex_count, .faces = mesh->face_count};
    status = topology_make(mesh, &made, error);
    if (status == BAT_OK)
    {
        sum_up_topology(&made, &sum);
        sum_up_geometry(mesh, &made.edges, &sum);
        *summary = sum;
    }
    memory_pool_free(&made.pool);
    return status;
}
