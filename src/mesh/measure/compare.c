#include "base/bisect.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "batten/mesh_measure.h"
#include "linalg/vector.h"
#include "mesh/check.h"
#include "mesh/measure/closest.h"

#include <float.h>
#include <string.h>

/// @file
/// Distances between two meshes: the mean, root mean square and Hausdorff distance in each direction (Cignoni, Rocchini and
/// Scopigno, "Metro: measuring error on simplified surfaces", 1998).
///
/// Means are integrals over faces, exact for quadratic functions; compare_refine.c encloses the Hausdorff distance.

// Branch and bound for the one-sided Hausdorff distance max_p d(p, mesh).
//
// Each face carries an upper bound of the distances of its points. Faces whose bound exceeds the largest known distance by
// more than the tolerance are bisected; distances at the midpoints increase the known distance (Guthe, Borodin and Klein,
// "Fast and accurate Hausdorff distance calculation between meshes", 2005).

/// Distances of a block.
#define COMPARE_BLOCK 1024

/// One of the two meshes. Its faces are processed in the order of its tree, where neighbours are close.
typedef struct compare_side
{
    bat_mesh mesh; ///< with borrowed faces and its own positions
    closest_tree tree;
    uint32_t *vertices; ///< the vertices that have a face, in the order of the tree's faces
    size_t vertex_count;
    double *distances; ///< for each such vertex: its distance from the other mesh
    uint32_t *places;  ///< for each such vertex: the place of the closest triangle in the other tree
    size_t *samples;   ///< the first sample of each face, in the order of the tree, then their number; or null
    double area;       ///< the area of all faces; set with the samples
    double wanted;     ///< the requested number of samples
    memory_pool pool;  ///< of all arrays
} compare_side;

/// The distances of one mesh from the other, in one direction.
typedef struct compare_way
{
    const compare_side *from, *onto;
    double mean, mean_square;
    double greatest;    ///< the largest distance found
    double farthest[3]; ///< the point of the largest distance
    double most;        ///< an upper bound of the one-sided Hausdorff distance
} compare_way;

/// Sums and maximum of some distances.
typedef struct compare_tally
{
    double weight, sum, squares;
    double greatest;
    double farthest[3];
} compare_tally;

static inline void compare_count(compare_tally *tally, double distance, double weight, const double point[3])
{
    tally->weight += weight;
    tally->sum += weight * distance;
    tally->squares += weight * (distance * distance);
    if (distance <= tally->greatest)
        return;
    tally->greatest = distance;
    memcpy(tally->farthest, point, sizeof tally->farthest);
}

static inline const double *compare_corner(const compare_side *side, uint32_t face, int corner)
{
    return side->mesh.positions + 3 * (size_t)side->mesh.faces[3 * (size_t)face + (size_t)corner];
}

/// A triangle of one mesh that may contain a distance above the largest known one.
typedef struct piece
{
    double corners[3][3];
    double distances[3]; ///< for each corner: its distance from the other mesh
    uint32_t places[3];  ///< for each corner: the place of its closest triangle
    double bound;        ///< an upper bound of the distances of all points
} piece;

/// An array of pieces.
typedef struct pieces
{
    piece *list;
    size_t count, room;
} pieces;

/// The bound from the Lipschitz constant 1 of the distance: along the edges from any corner, or from the nearest corner,
/// which is at most 1 / sqrt(3) times the longest edge away (Jung's theorem).
static double bound_by_way(const piece *part)
{
    static const double PER_ROOT_OF_THREE = 0.57735026918962576451;
    double edges[3], bound = INFINITY, longest = 0, greatest = 0;
    for (int c = 0; c < 3; c++)
        edges[c] = vector3_distance(part->corners[c], part->corners[(c + 1) % 3]);
    for (int c = 0; c < 3; c++)
    {
        bound = fmin(bound, part->distances[c] + fmax(edges[c], edges[(c + 2) % 3]));
        longest = fmax(longest, edges[c]);
        greatest = fmax(greatest, part->distances[c]);
    }
    return fmin(bound, greatest + longest * PER_ROOT_OF_THREE);
}

/// The bound of bound_by_triangles() for the triangle closest to the centre.
static double bound_by_centre(const piece *part, const closest_tree *onto)
{
    double centre[3], greatest = 0;
    uint32_t place = part->places[0];
    for (int k = 0; k < 3; k++)
        centre[k] = (part->corners[0][k] + part->corners[1][k] + part->corners[2][k]) / 3;
    (void)closest_find(onto, centre, &place);
    for (int c = 0; c < 3; c++)
        greatest = fmax(greatest, closest_to_place(onto, part->corners[c], place));
    return greatest;
}

/// The bound from convexity. The distance from one triangle of the other mesh is convex, so its maximum is at a corner; the
/// distance from the whole mesh is not larger. The triangles closest to the corners are tried.
static double bound_by_triangles(const piece *part, const closest_tree *onto)
{
    double bound = INFINITY;
    for (int t = 0; t < 3; t++)
    {
        double greatest = part->distances[t];
        for (int c = 0; c < 3; c++)
            if (part->places[c] != part->places[t])
                greatest = fmax(greatest, closest_to_place(onto, part->corners[c], part->places[t]));
            else
                greatest = fmax(greatest, part->distances[c]);
        bound = fmin(bound, greatest);
    }
    return bound;
}

/// A plane through an edge of a triangle, perpendicular to the triangle.
typedef struct cut
{
    const double *point;
    double normal[3]; ///< towards the triangle; of any length
} cut;

/// Find the plane between the triangles at two places, which must share an edge.
static bool find_cut(const compare_side *onto, uint32_t place, uint32_t other, cut *plane)
{
    uint32_t face = onto->tree.faces[place], next = onto->tree.faces[other];
    const uint32_t *corner = onto->mesh.faces + 3 * (size_t)face, *there = onto->mesh.faces + 3 * (size_t)next;
    int apex = -1, shared = 0;
    for (int c = 0; c < 3; c++)
        if (corner[c] == there[0] || corner[c] == there[1] || corner[c] == there[2])
            shared++;
        else
            apex = c;
    if (shared != 2)
        return false;
    const double *from = compare_corner(onto, face, (apex + 1) % 3), *to = compare_corner(onto, face, (apex + 2) % 3),
                 *tip = compare_corner(onto, face, apex);
    double along = 0, aside = 0;
    for (int k = 0; k < 3; k++)
    {
        along += (to[k] - from[k]) * (to[k] - from[k]);
        aside += (to[k] - from[k]) * (tip[k] - from[k]);
    }
    double share = along > 0 ? aside / along : 0;
    plane->point = from;
    for (int k = 0; k < 3; k++)
        plane->normal[k] = tip[k] - from[k] - share * (to[k] - from[k]);
    return true;
}

/// The bound from convexity on both sides of a plane between two neighbouring triangles: the greatest distance of the part
/// on each side from its triangle is at a corner or where the plane meets an edge. Infinite without such a plane.
static double bound_by_cut(const piece *part, const compare_side *onto, uint32_t place, uint32_t other)
{
    cut plane;
    double heights[3], bound = 0;
    if (place == other || !find_cut(onto, place, other, &plane))
        return INFINITY;
    for (int c = 0; c < 3; c++)
    {
        double from[3];
        vector3_subtract(part->corners[c], plane.point, from);
        heights[c] = vector3_dot(plane.normal, from);
        bound = fmax(bound, closest_to_place(&onto->tree, part->corners[c], heights[c] >= 0 ? place : other));
    }
    for (int c = 0; c < 3; c++)
    {
        int d = (c + 1) % 3;
        if ((heights[c] >= 0) == (heights[d] >= 0))
            continue;
        double share = heights[c] / (heights[c] - heights[d]), point[3];
        for (int k = 0; k < 3; k++)
            point[k] = part->corners[c][k] + share * (part->corners[d][k] - part->corners[c][k]);
        bound = fmax(bound, closest_to_place(&onto->tree, point, place));
        bound = fmax(bound, closest_to_place(&onto->tree, point, other));
    }
    return bound;
}

/// Compute the bound, as accurately as the comparison with `limit` requires.
static void find_bound(piece *part, const compare_side *onto, double limit)
{
    part->bound = bound_by_way(part);
    if (part->bound > limit)
        part->bound = fmin(part->bound, bound_by_triangles(part, &onto->tree));
    for (int c = 0; c < 3 && part->bound > limit; c++)
        part->bound = fmin(part->bound, bound_by_cut(part, onto, part->places[c], part->places[(c + 1) % 3]));
    if (part->bound > limit)
        part->bound = fmin(part->bound, bound_by_centre(part, &onto->tree));
}

static piece whole_face(const compare_side *side, uint32_t face)
{
    piece part;
    for (int c = 0; c < 3; c++)
    {
        uint32_t vertex = side->mesh.faces[3 * (size_t)face + (size_t)c];
        memcpy(part.corners[c], side->mesh.positions + 3 * (size_t)vertex, sizeof part.corners[c]);
        part.distances[c] = side->distances[vertex];
        part.places[c] = side->places[vertex];
    }
    return part;
}

static int longest_edge(const piece *part)
{
    int longest = 0;
    double greatest = -1;
    for (int c = 0; c < 3; c++)
    {
        double length = vector3_distance(part->corners[c], part->corners[(c + 1) % 3]);
        if (length > greatest)
        {
            greatest = length;
            longest = c;
        }
    }
    return longest;
}

/// Bisect a piece at the midpoint of its longest edge.
static void halve(const piece *part, const compare_side *onto, double limit, piece halves[2])
{
    int a = longest_edge(part), b = (a + 1) % 3;
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = part->corners[a][k] / 2 + part->corners[b][k] / 2;
    uint32_t place = part->places[a];
    double distance = closest_find(&onto->tree, middle, &place);
    for (int h = 0; h < 2; h++)
    {
        int corner = h == 0 ? b : a;
        halves[h] = *part;
        memcpy(halves[h].corners[corner], middle, sizeof middle);
        halves[h].distances[corner] = distance;
        halves[h].places[corner] = place;
        find_bound(&halves[h], onto, limit);
    }
}

static bool make_room(pieces *parts, size_t count)
{
    if (parts->list != NULL && count <= parts->room)
        return true;
    size_t room = count + count / 2;
    free(parts->list);
    parts->list = memory_array(room, sizeof *parts->list);
    parts->room = parts->list == NULL ? 0 : room;
    return parts->list != NULL;
}

/// Pieces with a bound above this value are bisected.
static double limit_of(const compare_way *way, double diagonal, double tolerance)
{
    static const double MIN_SHARE = 1e-6;
    return way->greatest + tolerance * fmax(way->greatest, MIN_SHARE * diagonal);
}

/// Keep the pieces with bounds above the limit. The bounds of the others enter way->most.
static void drop_settled(pieces *parts, double limit, compare_way *way)
{
    size_t kept = 0;
    for (size_t i = 0; i < parts->count; i++)
        if (parts->list[i].bound > limit)
            parts->list[kept++] = parts->list[i];
        else
            way->most = fmax(way->most, parts->list[i].bound);
    parts->count = kept;
}

/// Collect the faces with bounds above the limit.
static bool first_pieces(compare_way *way, double limit, int threads, pieces *parts)
{
    const compare_side *side = way->from;
    size_t count = side->mesh.face_count, blocks = (count + COMPARE_BLOCK - 1) / COMPARE_BLOCK, open = 0;
    double *bounds = memory_array(count, sizeof *bounds);
    if (bounds == NULL)
        return false;
    threads = threads_for(threads, blocks);
#pragma omp parallel for schedule(dynamic, COMPARE_BLOCK) num_threads(threads) reduction(+ : open) if (threads > 1)
    for (size_t f = 0; f < count; f++)
    {
        piece part = whole_face(side, side->tree.faces[f]);
        find_bound(&part, way->onto, limit);
        bounds[f] = part.bound;
        open += part.bound > limit;
    }
    bool made = make_room(parts, open);
    for (size_t f = 0; made && f < count; f++)
    {
        if (bounds[f] > limit)
        {
            parts->list[parts->count] = whole_face(side, side->tree.faces[f]);
            parts->list[parts->count++].bound = bounds[f];
        }
        else
            way->most = fmax(way->most, bounds[f]);
    }
    free(bounds);
    return made;
}

/// Bisect all pieces and update the largest known distance.
static bool halve_all(compare_way *way, double limit, int threads, const pieces *parts, pieces *halves)
{
    if (!make_room(halves, 2 * parts->count))
        return false;
    static const size_t SHARE = 64;
    size_t count = parts->count;
    threads = threads_for(threads, count / SHARE);
#pragma omp parallel for schedule(dynamic, SHARE) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < count; i++)
        halve(&parts->list[i], way->onto, limit, &halves->list[2 * i]);
    halves->count = 2 * count;
    for (size_t i = 0; i < halves->count; i++)
        for (int c = 0; c < 3; c++)
            if (halves->list[i].distances[c] > way->greatest)
            {
                way->greatest = halves->list[i].distances[c];
                memcpy(way->farthest, halves->list[i].corners[c], sizeof way->farthest);
            }
    return true;
}

/// Enclose the one-sided Hausdorff distance to the options' tolerance: increase way->greatest and set way->most.
/// @param diagonal of the bounding box
static bat_status compare_refine(compare_way *way, double diagonal, const bat_mesh_compare_options *options,
                                 shared_work *work, bat_error *error)
{
    pieces parts = {0}, halves = {0};
    size_t left = options->tolerance > 0 ? options->samples : 0;
    double limit = limit_of(way, diagonal, options->tolerance);
    way->most = way->greatest;
    bool in_memory = work->cancelled || first_pieces(way, limit, options->threads, &parts);
    while (in_memory && parts.count > 0 && parts.count <= left && shared_work_wants(work, work->total))
    {
        left -= parts.count;
        shared_work_poll(work);
        in_memory = halve_all(way, limit, options->threads, &parts, &halves);
        if (!in_memory)
            break;
        SWAP(parts, halves);
        limit = limit_of(way, diagonal, options->tolerance);
        drop_settled(&parts, limit, way);
    }
    for (size_t i = 0; in_memory && i < parts.count; i++)
        way->most = fmax(way->most, parts.list[i].bound);
    way->most = fmax(way->most, way->greatest);
    free(parts.list);
    free(halves.list);
    return in_memory ? BAT_OK : error_memory(error, 2 * parts.count * sizeof *halves.list);
}

/// Sample points of a small triangle.
#define POINTS 3

/// Combine the sums of all blocks, in order, into means and the largest distance.
static void sum_up(const compare_tally *tallies, size_t blocks, compare_way *way)
{
    compare_tally all = {.greatest = -1};
    for (size_t b = 0; b < blocks; b++)
    {
        all.weight += tallies[b].weight;
        all.sum += tallies[b].sum;
        all.squares += tallies[b].squares;
        if (tallies[b].greatest > all.greatest)
        {
            all.greatest = tallies[b].greatest;
            memcpy(all.farthest, tallies[b].farthest, sizeof all.farthest);
        }
    }
    way->mean = all.sum / all.weight;
    way->mean_square = all.squares / all.weight;
    if (all.greatest > way->greatest)
    {
        way->greatest = all.greatest;
        memcpy(way->farthest, all.farthest, sizeof all.farthest);
    }
}

/// The number of blocks of samples; 0 without samples.
static size_t sample_blocks(const compare_side *side)
{
    return side->samples == NULL ? 0 : (side->samples[side->mesh.face_count] + COMPARE_BLOCK - 1) / COMPARE_BLOCK;
}

static double area_of(const compare_side *side, uint32_t face)
{
    const double *a = compare_corner(side, face, 0), *b = compare_corner(side, face, 1), *c = compare_corner(side, face, 2);
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return sqrt(x * x + y * y + z * z) / 2;
}

/// The number of parts into which each edge of a face is divided.
static double parts_of(const compare_side *side, double area)
{
    return fmax(1, round(sqrt(area / side->area * side->wanted / POINTS)));
}

/// Plan the samples. Each face is divided into k^2 congruent triangles with three points each, at barycentric coordinates
/// 2/3, 1/6, 1/6. This rule is exact for quadratic functions (Strang and Fix, "An analysis of the finite element method",
/// 1973, section 4.3). 3 k^2 is near the face's share of `samples` by area, with k >= 1.
/// @param which "first" or "second", for the message
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a mesh without area; BAT_NO_MEMORY
static bat_status plan_samples(compare_side *side, const char *which, size_t samples, bat_error *error)
{
    size_t faces = side->mesh.face_count;
    side->wanted = (double)samples;
    side->area = 0;
    for (size_t f = 0; f < faces; f++)
        side->area += area_of(side, side->tree.faces[f]);
    if (!(side->area > 0))
        return ERROR_ARGUMENT(error, "the %s mesh has no area", which);
    side->samples = memory_pool_array(&side->pool, faces + 1, sizeof *side->samples);
    if (side->samples == NULL)
        return error_memory(error, faces * sizeof *side->samples);
    side->samples[0] = 0;
    for (size_t f = 0; f < faces; f++)
    {
        double parts = parts_of(side, area_of(side, side->tree.faces[f]));
        side->samples[f + 1] = side->samples[f] + (size_t)(POINTS * parts * parts);
    }
    return BAT_OK;
}

/// Sample `i` of a face whose edges are divided into `parts`. Row r of small triangles, from corner 0, has 2 r + 1
/// triangles, which point alternately towards corner 0 and away from it. Column c is offset by c parts of the edge from
/// corner 1 to corner 2.
static void sample_point(const compare_side *side, uint32_t face, size_t i, double parts, double point[3])
{
    static const double NEAR = 2.0 / 3, FAR = 1.0 / 6;
    size_t number = i / POINTS;
    double triangle = (double)number, row = floor(sqrt(triangle)), at = triangle - row * row, column = floor(at / 2);
    bool away = at != 2 * column;
    const double rows[POINTS] = {row, away ? row : row + 1, row + 1};
    const double columns[POINTS] = {column, away ? column + 1 : column, column + 1};
    double down = 0, across = 0;
    for (size_t corner = 0; corner < POINTS; corner++)
    {
        double weight = (corner == i % POINTS ? NEAR : FAR) / parts;
        down += weight * rows[corner];
        across += weight * columns[corner];
    }
    const double *a = compare_corner(side, face, 0), *b = compare_corner(side, face, 1), *c = compare_corner(side, face, 2);
    for (int k = 0; k < 3; k++)
        point[k] = a[k] + (down - across) * (b[k] - a[k]) + across * (c[k] - a[k]);
}

/// The distances of the vertices must be known.
static void measure_samples(const compare_way *way, size_t block, compare_tally *tally)
{
    const compare_side *side = way->from;
    const closest_tree *onto = &way->onto->tree;
    size_t i = block * COMPARE_BLOCK, count = side->samples[side->mesh.face_count];
    size_t end = count - i < COMPARE_BLOCK ? count : i + COMPARE_BLOCK;
    *tally = (compare_tally){.greatest = -1};
    for (size_t f = bisect_sizes(side->samples, 0, side->mesh.face_count, i); i < end; f++)
    {
        uint32_t face = side->tree.faces[f], place = side->places[side->mesh.faces[3 * (size_t)face]];
        double area = area_of(side, face), parts = parts_of(side, area), weight = area / (POINTS * parts * parts);
        for (; i < end && i < side->samples[f + 1]; i++)
        {
            double point[3];
            sample_point(side, face, i - side->samples[f], parts, point);
            compare_count(tally, closest_find(onto, point, &place), weight, point);
        }
    }
}

/// Distances of a block of samples, or of vertices, from the other mesh.
typedef void block_measure(const compare_way *way, size_t block, compare_tally *tally);

/// Compute the means and the largest distance over blocks, each a piece of `work`, from `first_piece` on.
/// @return BAT_OK, also when `work` was cancelled, or BAT_NO_MEMORY
static bat_status measure_blocks(compare_way *way, size_t blocks, block_measure *measure, int threads, size_t first_piece,
                                 shared_work *work, bat_error *error)
{
    compare_tally *tallies = memory_array(blocks, sizeof *tallies);
    if (tallies == NULL)
        return error_memory(error, blocks * sizeof *tallies);
    threads = threads_for(threads, blocks);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t block = 0; block < blocks; block++)
        if (shared_work_wants(work, first_piece + block))
        {
            measure(way, block, &tallies[block]);
            shared_work_finish(work, first_piece + block, BAT_OK, NULL);
        }
    if (!work->cancelled)
        sum_up(tallies, blocks, way);
    free(tallies);
    return BAT_OK;
}

/// The most samples. Their number stays exact in a double and fits size_t, also with 3 k^2 rounded for each face.
static const size_t MAX_SAMPLES = SIZE_MAX / 64 < 1ULL << 40 ? SIZE_MAX / 64 : (size_t)(1ULL << 40);

bat_mesh_compare_options bat_mesh_compare_defaults(void)
{
    return (bat_mesh_compare_options){.samples = BAT_MESH_SAMPLES, .tolerance = 1e-4};
}

static size_t blocks_of(size_t count)
{
    return (count + COMPARE_BLOCK - 1) / COMPARE_BLOCK;
}

static void measure_vertices(const compare_way *way, size_t block, compare_tally *tally)
{
    const compare_side *from = way->from, *onto = way->onto;
    uint32_t place = 0;
    *tally = (compare_tally){.greatest = -1};
    for (size_t i = block * COMPARE_BLOCK; i < (block + 1) * COMPARE_BLOCK && i < from->vertex_count; i++)
    {
        uint32_t vertex = from->vertices[i];
        const double *point = from->mesh.positions + 3 * (size_t)vertex;
        double distance = closest_find(&onto->tree, point, &place);
        from->distances[vertex] = distance;
        from->places[vertex] = place;
        compare_count(tally, distance, 1, point);
    }
}

static void side_free(compare_side *side)
{
    memory_pool_free(&side->pool);
    closest_free(&side->tree);
}

/// List the vertices that have a face.
static void list_vertices(compare_side *side)
{
    const size_t face_count = side->mesh.face_count;
    // Distances are not negative, so -1 marks vertices that are not listed yet.
    for (size_t v = 0; v < side->mesh.vertex_count; v++)
        side->distances[v] = -1;
    for (size_t i = 0; i < 3 * face_count; i++)
    {
        uint32_t vertex = side->mesh.faces[3 * (size_t)side->tree.faces[i / 3] + i % 3];
        if (side->distances[vertex] == 0)
            continue;
        side->distances[vertex] = 0;
        side->vertices[side->vertex_count++] = vertex;
    }
}

/// Prepare a mesh. `side` is all zero on entry; free it on failure as well.
static bat_status side_make(const bat_mesh *mesh, const char *which, double scale, const bat_mesh_compare_options *options,
                            compare_side *side, bat_error *error)
{
    size_t count = mesh->vertex_count;
    side->mesh = (bat_mesh){.faces = mesh->faces, .face_count = mesh->face_count, .vertex_count = count};
    side->mesh.positions = memory_pool_array(&side->pool, count, 3 * sizeof *side->mesh.positions);
    side->vertices = memory_pool_array(&side->pool, count, sizeof *side->vertices);
    side->distances = memory_pool_array(&side->pool, count, sizeof *side->distances);
    side->places = memory_pool_array(&side->pool, count, sizeof *side->places);
    bat_status status = memory_pool_check(&side->pool, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < 3 * count; i++)
        side->mesh.positions[i] = mesh->positions[i] * scale;
    closest_tree tree;
    status = closest_build(&side->mesh, 1, &tree, error);
    if (status != BAT_OK)
        return status;
    side->tree = tree;
    list_vertices(side);
    return options->vertices ? BAT_OK : plan_samples(side, which, options->samples, error);
}

/// The diagonal of the bounding box of the faces.
static double diagonal_of(const compare_side *side)
{
    double low[3], high[3];
    box_clear(3, low, high);
    for (size_t i = 0; i < side->vertex_count; i++)
        box_include(3, side->mesh.positions + 3 * (size_t)side->vertices[i], low, high);
    return hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
}

/// Compute the distances in both directions.
static bat_status measure_ways(compare_side sides[2], const bat_mesh_compare_options *options, compare_way ways[2],
                               bat_error *error)
{
    size_t count = 0, done = 0;
    for (int s = 0; s < 2; s++)
        count += blocks_of(sides[s].vertex_count) + sample_blocks(&sides[s]);
    shared_work work = shared_work_make(count, options->progress);
    bat_status status = BAT_OK;
    double diagonal = diagonal_of(&sides[1]);
    for (int w = 0; w < 2 && status == BAT_OK; w++)
    {
        size_t blocks = blocks_of(sides[w].vertex_count), samples = sample_blocks(&sides[w]);
        ways[w] = (compare_way){.from = &sides[w], .onto = &sides[1 - w], .greatest = -1, .most = INFINITY};
        status = measure_blocks(&ways[w], blocks, measure_vertices, options->threads, done, &work, error);
        done += blocks;
        if (options->vertices)
            continue;
        if (status == BAT_OK)
            status = measure_blocks(&ways[w], samples, measure_samples, options->threads, done, &work, error);
        done += samples;
        if (status == BAT_OK)
            status = compare_refine(&ways[w], diagonal, options, &work, error);
    }
    return status == BAT_OK ? shared_work_end(&work, error) : status;
}

/// The result in the unit of length of the meshes.
static bat_mesh_distance put_together(const compare_way ways[2], double diagonal, double unscale)
{
    const compare_way *there = &ways[0], *back = &ways[1];
    bat_mesh_distance distance = {
        .hausdorff_from_first = there->greatest * unscale,
        .hausdorff_from_second = back->greatest * unscale,
        .hausdorff = fmax(there->greatest, back->greatest) * unscale,
        .hausdorff_bound = fmax(there->most, back->most) * unscale,
        .mean_from_first = there->mean * unscale,
        .mean_from_second = back->mean * unscale,
        .mean = (there->mean + back->mean) / 2 * unscale,
        .mean_max = fmax(there->mean, back->mean) * unscale,
        .rms_from_first = sqrt(there->mean_square) * unscale,
        .rms_from_second = sqrt(back->mean_square) * unscale,
        .diagonal = diagonal * unscale,
    };
    for (int k = 0; k < 3; k++)
    {
        distance.farthest_from_first[k] = there->farthest[k] * unscale;
        distance.farthest_from_second[k] = back->farthest[k] * unscale;
    }
    return distance;
}

/// Check a mesh, and that differences of its coordinates do not overflow.
static bat_status check_side(const bat_mesh *mesh, const char *which, bat_error *error)
{
    bat_status status = mesh_check_triangles(mesh, error);
    if (status == BAT_OK)
        status = mesh_check_coordinates(mesh, DBL_MAX / 4, error);
    return status == BAT_OK ? BAT_OK : error_prefix(error, status, "the %s mesh: ", which);
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_mesh_compare_options, samples, OPTION_SIZE, 1, MAX_SAMPLES),
    OPTION_FIELD(bat_mesh_compare_options, tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_THREADS(bat_mesh_compare_options),
};

const bat_options_table bat_mesh_compare_fields = OPTIONS_TABLE(bat_mesh_compare_options, FIELDS, NULL);

bat_status bat_mesh_compare(const bat_mesh *first, const bat_mesh *second, const bat_mesh_compare_options *options,
                            bat_mesh_distance *distance, bat_error *error)
{
    bat_mesh_compare_options defaults = bat_mesh_compare_defaults();
    options = options == NULL ? &defaults : options;
    bat_status status = bat_options_check(&bat_mesh_compare_fields, options, error);
    if (status == BAT_OK)
        status = error_operand(error, check_side(first, "first", error), 0);
    if (status == BAT_OK)
        status = error_operand(error, check_side(second, "second", error), 1);
    if (status != BAT_OK)
        return status;
    double largest = closest_largest(first->positions, 3 * first->vertex_count, 0);
    double scale = closest_scale(closest_largest(second->positions, 3 * second->vertex_count, largest));
    compare_side sides[2] = {0};
    compare_way ways[2];
    status = error_operand(error, side_make(first, "first", scale, options, &sides[0], error), 0);
    if (status == BAT_OK)
        status = error_operand(error, side_make(second, "second", scale, options, &sides[1], error), 1);
    if (status == BAT_OK)
        status = measure_ways(sides, options, ways, error);
    if (status == BAT_OK)
        *distance = put_together(ways, diagonal_of(&sides[1]), 1 / scale);
    side_free(&sides[0]);
    side_free(&sides[1]);
    return status;
}
