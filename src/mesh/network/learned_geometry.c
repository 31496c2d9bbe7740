#include "mesh/network/learned_network.h"

#include "base/threads.h"
#include "mesh/refine/level.h"

#include <float.h>

enum
{
    REGULAR = 6, ///< valence
    TABLED = 12, ///< weights of smaller valences are tabulated
    CHUNK = 256, ///< edges that are worth a thread
    LANES = 32,  ///< edges that are measured side by side
    RING = 16    ///< edges of a vertex that are measured side by side
};

/// Normals whose sum is shorter than this share of the sum of their lengths have no mean: faces are folded there.
static const double MIN_NORMAL = 1e-3;
/// Heights below this share of a length have no clear sign.
static const double SIGN_FLOOR = 0.02;

// Small helpers

/// a / b, and 0 where b is 0.
static inline double ratio(double a, double b)
{
    return b > 0 ? a / b : 0;
}

static inline double soft_sign(double height, double length)
{
    double floor = SIGN_FLOOR * length;
    return ratio(height, sqrt(height * height + floor * floor));
}

static inline const double *place(const learned_geometry *g, uint32_t vertex)
{
    return g->positions + 3 * (size_t)vertex;
}

bool learned_at_boundary(const mesh_flaps *flaps, size_t vertex)
{
    uint32_t begin = flaps->first[vertex], end = flaps->first[vertex + 1];
    return begin < end && flaps->flap[end - 1].missing == MESH_FLAP_NO_LEFT;
}

// Rings

typedef double star_table[TABLED][TABLED];

/// The edges of a vertex: vectors, squares and lengths, side by side.
typedef struct ring_lanes
{
    double x[RING], y[RING], z[RING], square[RING], length[RING];
} ring_lanes;

/// Measure `count` edges, at most RING, from the half-flap `begin` on.
static void gather_ring(const learned_geometry *g, const double *own, uint32_t begin, uint32_t count, ring_lanes *ring)
{
    const mesh_flap *flap = g->flaps->flap + begin;
    for (uint32_t i = 0; i < count; i++)
    {
        const double *to = place(g, flap[i].corner[1]);
        ring->x[i] = to[0] - own[0];
        ring->y[i] = to[1] - own[1];
        ring->z[i] = to[2] - own[2];
    }
    for (uint32_t i = 0; i < count; i++)
    {
        ring->square[i] = ring->x[i] * ring->x[i] + ring->y[i] * ring->y[i] + ring->z[i] * ring->z[i];
        ring->length[i] = sqrt(ring->square[i]);
    }
}

/// Sums over the edges of a vertex.
typedef struct ring_sums
{
    double edges[3], length, squares;       ///< of the vectors, lengths and squared lengths
    double normal[3], areas;                ///< of the areas of faces, and of their squares
    double slope, slope_squares, low, high; ///< of the sines of edges against the tangent plane
} ring_sums;

static void add_edges(const ring_lanes *ring, uint32_t count, ring_sums *sums)
{
    for (uint32_t i = 0; i < count; i++)
    {
        sums->edges[0] += ring->x[i];
        sums->edges[1] += ring->y[i];
        sums->edges[2] += ring->z[i];
        sums->length += ring->length[i];
        sums->squares += ring->square[i];
    }
}

/// Add the face between two edges.
static inline void add_area(const double before[3], const double edge[3], ring_sums *sums)
{
    double area[3];
    vector3_cross(before, edge, area);
    vector_add(3, 1, area, sums->normal);
    sums->areas += vector3_dot(area, area);
}

static void add_slopes(const ring_lanes *ring, uint32_t count, const double n[3], ring_sums *sums)
{
    double rise[RING];
    for (uint32_t i = 0; i < count; i++)
    {
        double length = ring->length[i] > 0 ? ring->length[i] : 1;
        rise[i] = (n[0] * ring->x[i] + n[1] * ring->y[i] + n[2] * ring->z[i]) / length;
    }
    for (uint32_t i = 0; i < count; i++)
    {
        sums->slope += rise[i];
        sums->slope_squares += rise[i] * rise[i];
        sums->low = rise[i] < sums->low ? rise[i] : sums->low;
        sums->high = rise[i] > sums->high ? rise[i] : sums->high;
    }
}

/// Umbrella, size and normal of a vertex; how its edges leave its tangent plane, and how unequal they are.
static void measure_ring(learned_geometry *g, size_t v)
{
    uint32_t begin = g->flaps->first[v], end = g->flaps->first[v + 1], count;
    const double *own = place(g, (uint32_t)v);
    ring_lanes ring;
    ring_sums sums = {.low = INFINITY, .high = -INFINITY};
    double before[3] = {0}, first[3] = {0};
    // A ring has seldom more edges than lanes; then it is gathered twice, part by part.
    for (uint32_t f = begin; f < end; f += count)
    {
        count = end - f < RING ? end - f : RING;
        gather_ring(g, own, f, count, &ring);
        add_edges(&ring, count, &sums);
        for (uint32_t i = 0; i < count; i++)
        {
            const double now[3] = {ring.x[i], ring.y[i], ring.z[i]};
            if (f + i == begin)
                memcpy(first, now, sizeof first);
            else
                add_area(before, now, &sums);
            memcpy(before, now, sizeof before);
        }
    }
    if (begin < end && g->flaps->flap[end - 1].missing != MESH_FLAP_NO_LEFT)
        add_area(before, first, &sums);
    double share = begin < end ? 1 / (double)(end - begin) : 0, size = share * sums.length, *n = g->vertex_normal[v];
    for (int c = 0; c < 3; c++)
        g->umbrella[v][c] = share * sums.edges[c];
    g->size[v] = size;
    memcpy(n, sums.normal, sizeof sums.normal);
    // The square of the sum of lengths is at most the valence times the sum of squares.
    double length = vector3_length(n), min = MIN_NORMAL * sqrt((double)(end - begin) * sums.areas);
    vector_scale(3, length > min && length > DBL_MIN ? 1 / length : 0, n);
    for (uint32_t f = begin; f < end; f += count)
    {
        count = end - f < RING ? end - f : RING;
        if (end - begin > RING)
            gather_ring(g, own, f, count, &ring);
        add_slopes(&ring, count, n, &sums);
    }
    g->ring[v][0] = (real)(2 * share * fabs(sums.slope));
    g->ring[v][1] = (real)(2 * sqrt(share * sums.slope_squares));
    g->ring[v][2] = begin < end ? (real)(sums.high - sums.low) : 0;
    g->ring[v][3] = (real)(2 * sqrt(fmax(ratio(share * sums.squares, size * size) - 1, 0)));
}

static void measure_second(learned_geometry *g, size_t v)
{
    const mesh_flap *flap = g->flaps->flap;
    uint32_t begin = g->flaps->first[v], end = g->flaps->first[v + 1];
    double sum[3] = {0}, share = begin < end ? 1 / (double)(end - begin) : 0;
    for (uint32_t f = begin; f < end; f++)
        vector_add(3, 1, g->umbrella[flap[f].corner[1]], sum);
    for (int c = 0; c < 3; c++)
        g->second[v][c] = share * sum[c];
}

/// Add `share` times the star of one end of an edge, where the half-flap begins, from that end.
static inline void add_star(const learned_geometry *g, const star_table table, uint32_t half_flap, double share,
                            double star[3])
{
    const mesh_flap *flap = g->flaps->flap;
    uint32_t v = flap[half_flap].corner[0], begin = g->flaps->first[v], end = g->flaps->first[v + 1], f = half_flap;
    const double *own = place(g, v);
    unsigned valence = end - begin, j = 0;
    double sum[3] = {0};
    if (valence == REGULAR)
    {
        // The same by symmetry: neighbours j and 6 - j have one weight.
        const mesh_flap *ring = flap + begin;
        uint32_t at = half_flap - begin;
        const double *to[REGULAR];
        for (uint32_t i = 0; i < REGULAR; i++)
            to[i] = place(g, ring[at + i < REGULAR ? at + i : at + i - REGULAR].corner[1]);
        for (int c = 0; c < 3; c++)
            sum[c] = table[REGULAR][0] * (to[0][c] - own[c]) + table[REGULAR][1] * ((to[1][c] + to[5][c]) - 2 * own[c]) +
                     table[REGULAR][2] * ((to[2][c] + to[4][c]) - 2 * own[c]) + table[REGULAR][3] * (to[3][c] - own[c]);
        vector_add(3, share, sum, star);
        return;
    }
    do
    {
        double weight = valence < TABLED ? table[valence][j] : butterfly_weight(valence, j);
        const double *to = place(g, flap[f].corner[1]);
        for (int c = 0; c < 3; c++)
            sum[c] += weight * (to[c] - own[c]);
        f = f + 1 == end ? begin : f + 1;
        j++;
    } while (f != half_flap);
    vector_add(3, share, sum, star);
}

/// Edges side by side, so that loops over them become vector code.
typedef struct edge_lanes
{
    double j[3][LANES], k[3][LANES], l[3][LANES]; ///< from corner i to the others
    double umbrella[4][3][LANES];
    double star[3][LANES], at_boundary[LANES];
    // Results:
    double normal[3][LANES], bend[LANES];
    double features[LEARNED_EDGE_FEATURES][LANES];
} edge_lanes;

static void gather_edge(const learned_geometry *g, const star_table table, size_t e, size_t lane, edge_lanes *lanes)
{
    const uint32_t *pair = g->flaps->of_edge[e];
    const mesh_flap *flap = &g->flaps->flap[pair[0]];
    double to[3][3], *star = g->star[e];
    for (int c = 0; c < 3; c++)
        vector3_subtract(place(g, flap->corner[c + 1]), place(g, flap->corner[0]), to[c]);
    if (flap->missing != MESH_FLAP_WHOLE)
    {
        int there = flap->missing == MESH_FLAP_NO_LEFT ? 2 : 1;
        vector3_subtract(to[0], to[there], to[3 - there]);
    }
    bool at_boundary[2] = {learned_at_boundary(g->flaps, flap->corner[0]), learned_at_boundary(g->flaps, flap->corner[1])};
    memset(star, 0, sizeof g->star[e]);
    // An end on the boundary has no star. The other end's runs from that end, not from the middle.
    for (int end = 0; end < 2; end++)
        if (!at_boundary[end])
            add_star(g, table, pair[end], at_boundary[1 - end] ? 1 : 0.5, star);
    if (at_boundary[0] != at_boundary[1])
        vector_add(3, at_boundary[0] ? 0.5 : -0.5, to[0], star);
    for (int c = 0; c < 3; c++)
    {
        lanes->j[c][lane] = to[0][c];
        lanes->k[c][lane] = to[1][c];
        lanes->l[c][lane] = to[2][c];
        lanes->star[c][lane] = star[c];
        for (int i = 0; i < 4; i++)
            lanes->umbrella[i][c][lane] = g->umbrella[flap->corner[i]][c];
    }
    lanes->at_boundary[lane] = 0.5 * (at_boundary[0] + at_boundary[1]);
}

typedef struct triple
{
    double x, y, z;
} triple;

static inline triple lane_at(double (*numbers)[LANES], size_t lane)
{
    return (triple){numbers[0][lane], numbers[1][lane], numbers[2][lane]};
}

static inline triple combine(double a, triple u, double b, triple v)
{
    return (triple){a * u.x + b * v.x, a * u.y + b * v.y, a * u.z + b * v.z};
}

static inline double dot(triple a, triple b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline triple cross(triple a, triple b)
{
    return (triple){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// 1 / sqrt(x), or 0 where x is not above `min`.
static inline double inverse_root(double x, double min)
{
    bool enough = x > min;
    double root = sqrt(enough ? x : 1);
    return enough ? 1 / root : 0;
}

static inline double root_of(double x)
{
    return sqrt(x > 0 ? x : 0);
}

static inline double inverse(double x)
{
    return x > 0 ? 1 / (x > 0 ? x : 1) : 0;
}

/// Normals, bends and features of all lanes.
LANES_CLONES
static void measure_lanes(edge_lanes *s)
{
    for (size_t e = 0; e < LANES; e++)
    {
        triple j = lane_at(s->j, e), k = lane_at(s->k, e), l = lane_at(s->l, e), star = lane_at(s->star, e);
        triple kj = combine(1, k, -1, j), lj = combine(1, l, -1, j), kl = combine(1, k, -1, l);
        triple middle = combine(0.5, combine(1, k, 1, l), -0.5, j);
        double own = dot(j, j), left = dot(k, k) + dot(kj, kj), right = dot(l, l) + dot(lj, lj);
        double length = root_of((own + left + right) / 5), per = inverse(length), along = root_of(own),
               across = root_of(dot(kl, kl));
        triple n = cross(j, k), m = cross(l, j);
        double nn = dot(n, n), mm = dot(m, m), n_rate = inverse_root(nn, DBL_MIN), m_rate = inverse_root(mm, DBL_MIN);
        double quality[2] = {3.46410161513775459 * (nn * n_rate) * inverse(own + left),
                             3.46410161513775459 * (mm * m_rate) * inverse(own + right)};
        double cosine = n_rate * m_rate * dot(n, m);
        triple sum = combine(n_rate, n, m_rate, m);
        double rate = inverse_root(dot(sum, sum), 4 * MIN_NORMAL * MIN_NORMAL);
        triple normal = combine(rate, sum, 0, sum);
        double bend = dot(normal, middle), floor = SIGN_FLOOR * length;
        double sign = bend * inverse_root(bend * bend + floor * floor, 0);
        double h[4];
        for (int i = 0; i < 4; i++)
            h[i] = per * dot(normal, lane_at(s->umbrella[i], e));
        double rise = dot(normal, star), slide = root_of(dot(star, star) - rise * rise);
        double(*f)[LANES] = s->features;
        f[0][e] = 0.5 * (1 - cosine);
        f[1][e] = root_of(0.5 * (1 - cosine));
        f[2][e] = (along - length) * inverse(along + length);
        f[3][e] = (across - length) * inverse(across + length);
        f[4][e] = 0.5 * (quality[0] + quality[1]);
        f[5][e] = fabs(quality[0] - quality[1]);
        f[6][e] = fabs(bend) * per;
        f[7][e] = fabs(dot(middle, j)) * inverse(along) * per;
        f[8][e] = 2 * sign * (h[0] + h[1]);
        f[9][e] = 2 * fabs(h[0] - h[1]);
        f[10][e] = 2 * (fabs(h[0]) + fabs(h[1]));
        f[11][e] = 2 * sign * (h[2] + h[3]);
        f[12][e] = 2 * fabs(h[2] - h[3]);
        f[13][e] = 4 * sign * rise * per;
        f[14][e] = 2 * slide * per;
        f[15][e] = s->at_boundary[e];
        s->normal[0][e] = normal.x;
        s->normal[1][e] = normal.y;
        s->normal[2][e] = normal.z;
        s->bend[e] = bend;
    }
}

/// Normals, stars, bends and features of the edges begin, …, begin + count - 1.
static void measure_edges(learned_geometry *g, const star_table table, size_t begin, size_t count, edge_lanes *lanes)
{
    for (size_t lane = 0; lane < count; lane++)
        gather_edge(g, table, begin + lane, lane, lanes);
    measure_lanes(lanes);
    for (size_t lane = 0; lane < count; lane++)
    {
        real *row = g->edge_features + (begin + lane) * LEARNED_EDGE_FEATURES;
        for (size_t f = 0; f < LEARNED_EDGE_FEATURES; f++)
            row[f] = (real)lanes->features[f][lane];
        for (size_t c = 0; c < 3; c++)
            g->edge_normal[begin + lane][c] = lanes->normal[c][lane];
        g->bend[begin + lane] = (real)lanes->bend[lane];
    }
}

/// Mean and maximum of the features of a vertex's edges.
LANES_CLONES
static void summarize_edges(const real *restrict features, const mesh_flap *flap, size_t count, real *restrict mean,
                            real *restrict most)
{
    enum
    {
        F = LEARNED_EDGE_FEATURES
    };
    real sum[F] = {0}, max[F], share = 1 / (real)count;
    memcpy(max, features + flap[0].edge * (size_t)F, sizeof max);
    for (size_t f = 0; f < count; f++)
    {
        const real *row = features + flap[f].edge * (size_t)F;
        for (size_t i = 0; i < F; i++)
        {
            sum[i] += row[i];
            max[i] = row[i] > max[i] ? row[i] : max[i];
        }
    }
    for (size_t i = 0; i < F; i++)
    {
        mean[i] = share * sum[i];
        most[i] = max[i];
    }
}

void learned_vertex_inputs(const learned_geometry *g, size_t old, size_t v, real *row)
{
    const mesh_flap *flap = g->flaps->flap;
    uint32_t begin = g->flaps->first[v], end = g->flaps->first[v + 1];
    memset(row, 0, LEARNED_VERTEX_INPUTS * sizeof *row);
    if (begin == end)
        return;
    const double *n = g->vertex_normal[v], *u = g->umbrella[v], *s = g->second[v];
    double size = g->size[v], per = ratio(1, size), share = 1 / (double)(end - begin), sizes = 0, bends = 0, all_bends = 0;
    for (uint32_t f = begin; f < end; f++)
    {
        double bend = (double)g->bend[flap[f].edge];
        bends += bend;
        all_bends += fabs(bend);
        sizes += g->size[flap[f].corner[1]];
    }
    double rise = vector3_dot(n, u), second = vector3_dot(n, s);
    const double features[LEARNED_VERTEX_FEATURES] = {
        2 * per * vector3_length(u),
        2 * per * fabs(rise),
        (double)g->ring[v][0],
        (double)g->ring[v][1],
        (double)g->ring[v][2],
        6 * share - 1,
        learned_at_boundary(g->flaps, v),
        (double)g->ring[v][3],
        4 * soft_sign(rise, size) * per * second,
        ratio(fabs(bends), all_bends),
        v < old,
        ratio(size - share * sizes, size + share * sizes),
    };
    for (size_t f = 0; f < LEARNED_VERTEX_FEATURES; f++)
        row[f] = (real)features[f];
    real *mean = row + LEARNED_VERTEX_FEATURES;
    summarize_edges(g->edge_features, flap + begin, end - begin, mean, mean + LEARNED_EDGE_FEATURES);
}

// All

size_t learned_geometry_size(size_t vertices, size_t edges)
{
    // Per vertex three vectors and a size, per edge two vectors; then the features.
    size_t numbers = LEARNED_VERTEX_NUMBERS * vertices + LEARNED_EDGE_NUMBERS * edges;
    size_t features = (LEARNED_EDGE_FEATURES + 1) * edges + LEARNED_RING_NUMBERS * vertices;
    return numbers * sizeof(double) + features * sizeof(real);
}

static void lay_out(learned_geometry *g, void *memory)
{
    size_t vertices = g->flaps->vertex_count, edges = g->flaps->edge_count;
    g->umbrella = memory;
    g->second = g->umbrella + vertices;
    g->vertex_normal = g->second + vertices;
    g->edge_normal = g->vertex_normal + vertices;
    g->star = g->edge_normal + edges;
    g->size = (double *)(g->star + edges);
    g->edge_features = (real *)(g->size + vertices);
    g->bend = g->edge_features + LEARNED_EDGE_FEATURES * edges;
    g->ring = (real(*)[LEARNED_RING_NUMBERS])(g->bend + edges);
}

learned_geometry learned_geometry_in(const mesh_flaps *flaps, const double *positions, int threads, void *memory)
{
    (void)threads; // without OpenMP
    learned_geometry g = {.flaps = flaps, .positions = positions};
    size_t vertices = flaps->vertex_count, edges = flaps->edge_count;
    star_table table;
    lay_out(&g, memory);
    for (unsigned n = 2; n < TABLED; n++)
        for (unsigned j = 0; j < n; j++)
            table[n][j] = butterfly_weight(n, j);
#pragma omp parallel num_threads(threads_for(threads, edges / CHUNK + 1))
    {
#pragma omp for schedule(static)
        for (size_t v = 0; v < vertices; v++)
            measure_ring(&g, v);
#pragma omp for schedule(static)
        for (size_t v = 0; v < vertices; v++)
            measure_second(&g, v);
        edge_lanes lanes = {0};
#pragma omp for schedule(static)
        for (size_t e = 0; e < edges; e += LANES)
            measure_edges(&g, (const double(*)[TABLED])table, e, edges - e < LANES ? edges - e : LANES, &lanes);
    }
    return g;
}

// Candidates

static inline void project(const double normal[3], const double vector[3], double result[3])
{
    double height = vector3_dot(normal, vector);
    for (int c = 0; c < 3; c++)
        result[c] = height * normal[c];
}

void learned_vertex_candidates(const learned_geometry *g, size_t v, const double ring[3],
                               double candidate[LEARNED_VERTEX_CANDIDATES][3])
{
    const double *from[3] = {g->umbrella[v], g->second[v], ring};
    for (int k = 0; k < 3; k++)
    {
        memcpy(candidate[2 * k], from[k], sizeof candidate[0]);
        project(g->vertex_normal[v], from[k], candidate[2 * k + 1]);
    }
}

void learned_edge_candidates(const learned_geometry *g, size_t e, const double ring[3],
                             double candidate[LEARNED_EDGE_CANDIDATES][3])
{
    const mesh_flap *flap = &g->flaps->flap[g->flaps->of_edge[e][0]];
    const uint32_t *corner = flap->corner;
    const double *i = place(g, corner[0]), *j = place(g, corner[1]), *k = place(g, corner[2]), *l = place(g, corner[3]);
    double opposite[3];
    memcpy(candidate[0], g->star[e], sizeof candidate[0]);
    for (int c = 0; c < 3; c++)
    {
        candidate[1][c] = flap->missing == MESH_FLAP_WHOLE ? 0.5 * ((k[c] + l[c]) - (i[c] + j[c])) : 0;
        candidate[2][c] = 0.5 * (g->umbrella[corner[0]][c] + g->umbrella[corner[1]][c]);
        opposite[c] = 0.5 * (g->umbrella[corner[2]][c] + g->umbrella[corner[3]][c]);
        candidate[3][c] = ring[c];
    }
    for (int m = 0; m < 4; m++)
        project(g->edge_normal[e], m < 3 ? candidate[m] : ring, candidate[4 + m]);
    project(g->edge_normal[e], opposite, candidate[8]);
}

LANES_CLONES
static void find_factors(size_t count, double reach, const double (*restrict move)[3], const double *restrict size,
                         double *restrict factor)
{
    for (size_t i = 0; i < count; i++)
    {
        const double *m = move[i];
        double longest = reach * size[i], room = longest * longest, square = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
        double r2 = square / (room > DBL_MIN ? room : DBL_MIN);
        factor[i] = 1 / sqrt(sqrt(1 + r2 * r2));
    }
}

void learned_move_factors(size_t count, double reach, const double (*move)[3], const double *size, double *factor)
{
    find_factors(count, reach, move, size, factor);
}

double learned_edge_size(const learned_geometry *g, size_t e)
{
    const uint32_t *corner = g->flaps->flap[g->flaps->of_edge[e][0]].corner;
    return 0.5 * (g->size[corner[0]] + g->size[corner[1]]);
}

static uint32_t boundary_beyond(const mesh_flaps *flaps, uint32_t vertex, uint32_t end)
{
    uint32_t a = flaps->flap[flaps->first[vertex]].corner[1], b = flaps->flap[flaps->first[vertex + 1] - 1].corner[1];
    return a == end ? b : a;
}

void learned_boundary_point(const mesh_flaps *flaps, const double *positions, size_t edge, double point[3])
{
    const uint32_t *corner = flaps->flap[flaps->of_edge[edge][0]].corner;
    const double *i = positions + 3 * (size_t)corner[0], *j = positions + 3 * (size_t)corner[1];
    const double *before = positions + 3 * (size_t)boundary_beyond(flaps, corner[0], corner[1]);
    const double *after = positions + 3 * (size_t)boundary_beyond(flaps, corner[1], corner[0]);
    for (int c = 0; c < 3; c++)
        point[c] = 9.0 / 16 * (i[c] + j[c]) - 1.0 / 16 * (before[c] + after[c]);
}
