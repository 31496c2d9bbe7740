#include "mesh/measure/compare.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Branch and bound for the one-sided Hausdorff distance max_p d(p, mesh).
///
/// Each face carries an upper bound of the distances of its points. Faces whose bound exceeds the largest known distance by
/// more than the tolerance are bisected; distances at the midpoints increase the known distance (Guthe, Borodin and Klein,
/// "Fast and accurate Hausdorff distance calculation between meshes", 2005).

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

static double length_of(const double a[3], const double b[3])
{
    double x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return sqrt(x * x + y * y + z * z);
}

/// The bound from the Lipschitz constant 1 of the distance: along the edges from any corner, or from the nearest corner,
/// which is at most 1 / sqrt(3) times the longest edge away (Jung's theorem).
static double bound_by_way(const piece *part)
{
    static const double PER_ROOT_OF_THREE = 0.57735026918962576451;
    double edges[3], bound = INFINITY, longest = 0, greatest = 0;
    for (int c = 0; c < 3; c++)
        edges[c] = length_of(part->corners[c], part->corners[(c + 1) % 3]);
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

static double height_above(const cut *plane, const double point[3])
{
    double height = 0;
    for (int k = 0; k < 3; k++)
        height += plane->normal[k] * (point[k] - plane->point[k]);
    return height;
}

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
        heights[c] = height_above(&plane, part->corners[c]);
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
        double length = length_of(part->corners[c], part->corners[(c + 1) % 3]);
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
    enum
    {
        SHARE = 64
    };
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

bat_status compare_refine(compare_way *way, double diagonal, const bat_mesh_compare_options *options, shared_work *work,
                          bat_error *error)
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
        pieces kept = parts;
        parts = halves;
        halves = kept;
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
