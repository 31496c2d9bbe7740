#include "mesh/measure/closest.h"

#include "base/error.h"
#include "base/lanes.h"
#include "base/memory.h"
#include "base/threads.h"
#include "batten/mesh_measure.h"
#include "linalg/vector.h"
#include "mesh/check.h"

#include <float.h>

/// @file
/// Construction of the tree by repeated halving at medians, and search with a stack, nearest boxes first.

enum
{
    WIDTH = CLOSEST_WIDTH,
    /// Ranges of at least this many faces become tasks of their own.
    FACES_FOR_A_TASK = 8192
};

/// A face during sorting. Single precision suffices for the order.
typedef struct entry
{
    float centre[3];
    uint32_t face;
} entry;

void closest_free(closest_tree *tree)
{
    free(tree->packets);
    free(tree->nodes);
    free(tree->faces);
    free(tree->turns);
    *tree = (closest_tree){0};
}

double closest_largest(const double *values, size_t count, double min)
{
    return fmax(min, vector_largest(count, values));
}

double closest_scale(double largest)
{
    int exponent;
    (void)frexp(largest, &exponent);
    // Both the scale and its inverse are normal numbers.
    return largest == 0 ? 1 : ldexp(1, exponent > 1020 ? -1020 : exponent < -1020 ? 1020 : -exponent);
}

/// Partition entries begin, …, end - 1 into two non-empty parts, coordinates up to a pivot and from it on (Hoare, with the
/// median of three as pivot). Returns the start of the second part.
static size_t partition(entry *entries, size_t begin, size_t end, int axis)
{
    float a = entries[begin].centre[axis], b = entries[begin + (end - begin) / 2].centre[axis],
          c = entries[end - 1].centre[axis];
    float high_of_two = a > b ? a : b, low_of_two = a > b ? b : a;
    float pivot = c > high_of_two ? high_of_two : c < low_of_two ? low_of_two : c;
    size_t low = begin, high = end - 1;
    for (;;)
    {
        while (entries[low].centre[axis] < pivot)
            low++;
        while (entries[high].centre[axis] > pivot)
            high--;
        if (low >= high)
            return low == begin ? begin + 1 : low;
        entry swapped = entries[low];
        entries[low++] = entries[high];
        entries[high--] = swapped;
    }
}

/// Reorder the entries so that no entry before `nth` has a larger coordinate than any entry from there on.
static void select_nth(entry *entries, size_t begin, size_t end, size_t nth, int axis)
{
    while (end - begin > 1)
    {
        size_t middle = partition(entries, begin, end, axis);
        if (nth < middle)
            end = middle;
        else
            begin = middle;
    }
}

/// The axis with the largest extent of the centres.
static int longest_axis(const entry *entries, size_t begin, size_t end)
{
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (size_t i = begin; i < end; i++)
        for (int k = 0; k < 3; k++)
        {
            float x = entries[i].centre[k];
            low[k] = x < low[k] ? x : low[k];
            high[k] = x > high[k] ? x : high[k];
        }
    float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/// Sort the entries into the order of the tree. `part` is the number of faces below one box of the current node. Ranges are
/// halved at multiples of `part`; a single part becomes the range of a child node.
static void put_in_order(entry *entries, size_t begin, size_t end, size_t part)
{
    while (part > 1 && end - begin <= part)
        part /= WIDTH;
    if (part == 1)
        return;
    size_t parts = (end - begin + part - 1) / part, middle = begin + parts / 2 * part;
    select_nth(entries, begin, end, middle, longest_axis(entries, begin, end));
#pragma omp task if (end - begin >= FACES_FOR_A_TASK)
    put_in_order(entries, begin, middle, part);
    put_in_order(entries, middle, end, part);
#pragma omp taskwait
}

static double per(double squared)
{
    return squared > DBL_MIN ? 1 / squared : 0;
}

/// The corner where the longest edge begins.
static int longest_edge(double corners[3][3])
{
    double squared[3];
    for (int c = 0; c < 3; c++)
        squared[c] = chord_square(corners[c], corners[(c + 1) % 3]);
    return squared[0] >= squared[1] && squared[0] >= squared[2] ? 0 : squared[1] >= squared[2] ? 1 : 2;
}

/// Compute the component of `v` perpendicular to `u`; returns the coefficient of `u` in the other component. A second step
/// removes the rounding error along `u`, which dominates for slivers.
static double perpendicular(const double u[3], const double v[3], double per_squared_u, double height[3])
{
    double share = vector3_dot(u, v) * per_squared_u;
    for (int k = 0; k < 3; k++)
        height[k] = v[k] - share * u[k];
    double left = vector3_dot(u, height) * per_squared_u;
    vector_add(3, -left, u, height);
    return share + left;
}

/// Store a triangle in lane `i`; returns the face's corner that becomes corner 0.
static int fill_lane(closest_packet *packet, int i, double corners[3][3])
{
    int turn = longest_edge(corners);
    const double *a = corners[turn], *b = corners[(turn + 1) % 3], *c = corners[(turn + 2) % 3];
    double u[3], v[3], w[3], height[3];
    for (int k = 0; k < 3; k++)
    {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
        w[k] = v[k] - u[k];
    }
    packet->per_along[i] = per(vector3_dot(u, u));
    packet->per_aside[i] = per(vector3_dot(v, v));
    packet->per_across[i] = per(vector3_dot(w, w));
    packet->skew[i] = perpendicular(u, v, packet->per_along[i], height);
    double per_height = per(vector3_dot(height, height));
    for (int k = 0; k < 3; k++)
    {
        packet->corner[k][i] = a[k];
        packet->along[k][i] = u[k];
        packet->aside[k][i] = v[k];
        packet->height[k][i] = height[k] * per_height;
    }
    return turn;
}

static void widen(closest_node *node, int lane, const double low[3], const double high[3])
{
    for (int k = 0; k < 3; k++)
    {
        node->low[k][lane] = fmin(node->low[k][lane], low[k]);
        node->high[k][lane] = fmax(node->high[k][lane], high[k]);
    }
}

/// Fill packet `p` and its box in the lowest level of nodes.
static void fill_packet(const bat_mesh *mesh, closest_tree *tree, size_t p)
{
    closest_node *node = &tree->nodes[tree->begin[1] + p / WIDTH];
    for (int i = 0; i < WIDTH; i++)
    {
        double corners[3][3];
        size_t place = p * WIDTH + (size_t)i;
        const uint32_t *corner = mesh->faces + 3 * (size_t)tree->faces[place];
        for (int c = 0; c < 3; c++)
        {
            for (int k = 0; k < 3; k++)
                corners[c][k] = mesh->positions[3 * (size_t)corner[c] + (size_t)k] * tree->scale;
            widen(node, (int)(p % WIDTH), corners[c], corners[c]);
        }
        tree->turns[place] = (unsigned char)fill_lane(&tree->packets[p], i, corners);
    }
}

/// Set the number of nodes and the first node of each level. Returns the number of all nodes.
static size_t lay_out(closest_tree *tree, size_t packets)
{
    size_t nodes = 0, count = packets;
    do
    {
        tree->begin[++tree->root_level] = nodes;
        count = (count + WIDTH - 1) / WIDTH;
        nodes += count;
    } while (count > 1);
    return nodes;
}

static void fill_nodes(const bat_mesh *mesh, closest_tree *tree, size_t packets, size_t nodes)
{
    for (size_t n = 0; n < nodes; n++)
        for (int i = 0; i < WIDTH; i++)
            for (int k = 0; k < 3; k++)
            {
                tree->nodes[n].low[k][i] = INFINITY;
                tree->nodes[n].high[k][i] = -INFINITY;
            }
    int threads = threads_for(0, packets > FACES_FOR_A_TASK / WIDTH ? packets : 1);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (size_t group = 0; group < (packets + WIDTH - 1) / WIDTH; group++)
        for (size_t p = group * WIDTH; p < (group + 1) * WIDTH && p < packets; p++)
            fill_packet(mesh, tree, p);
    for (int level = 2; level <= tree->root_level; level++)
        for (size_t n = tree->begin[level - 1]; n < tree->begin[level]; n++)
        {
            size_t child = n - tree->begin[level - 1];
            const closest_node *below = &tree->nodes[n];
            for (int i = 0; i < WIDTH; i++)
            {
                double low[3] = {below->low[0][i], below->low[1][i], below->low[2][i]};
                double high[3] = {below->high[0][i], below->high[1][i], below->high[2][i]};
                widen(&tree->nodes[tree->begin[level] + child / WIDTH], (int)(child % WIDTH), low, high);
            }
        }
}

/// Choose the place of every face.
static bool choose_places(const bat_mesh *mesh, closest_tree *tree, size_t places)
{
    entry *entries = memory_array(mesh->face_count, sizeof *entries);
    if (entries == NULL)
        return false;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *corner = mesh->faces + 3 * f;
        entries[f].face = (uint32_t)f;
        const double *a = mesh->positions + 3 * (size_t)corner[0], *b = mesh->positions + 3 * (size_t)corner[1],
                     *c = mesh->positions + 3 * (size_t)corner[2];
        // Three times the centre; only the order matters.
        for (int k = 0; k < 3; k++)
            entries[f].centre[k] = (float)(tree->scale * a[k] + tree->scale * b[k] + tree->scale * c[k]);
    }
    size_t part = WIDTH;
    while (part < places)
        part *= WIDTH;
    int threads = threads_for(0, mesh->face_count / FACES_FOR_A_TASK);
#pragma omp parallel num_threads(threads)
#pragma omp single
    put_in_order(entries, 0, mesh->face_count, part);
    for (size_t i = 0; i < places; i++)
        tree->faces[i] = entries[i < mesh->face_count ? i : mesh->face_count - 1].face;
    free(entries);
    return true;
}

bat_status closest_build(const bat_mesh *mesh, double largest, closest_tree *tree, bat_error *error)
{
    double scale = closest_scale(largest);
    size_t packets = (mesh->face_count + WIDTH - 1) / WIDTH, places = packets * WIDTH;
    closest_tree made = {.face_count = mesh->face_count, .scale = scale, .unscale = 1 / scale};
    size_t nodes = lay_out(&made, packets);
    made.packets = memory_array(packets, sizeof *made.packets);
    made.nodes = memory_array(nodes, sizeof *made.nodes);
    made.faces = memory_array(places, sizeof *made.faces);
    made.turns = memory_array(places, sizeof *made.turns);
    if (made.packets == NULL || made.nodes == NULL || made.faces == NULL || made.turns == NULL ||
        !choose_places(mesh, &made, places))
    {
        closest_free(&made);
        return error_memory(error, packets * sizeof *made.packets);
    }
    fill_nodes(mesh, &made, packets, nodes);
    *tree = made;
    return BAT_OK;
}

/// An opened node leaves at most 7 of its boxes on the stack.
#define STACK ((WIDTH - 1) * CLOSEST_MAX_LEVELS + WIDTH)

/// An entry of the stack: a node or, on level 0, a packet.
typedef struct pending
{
    double squared; ///< squared distance of its box
    uint32_t index;
    int level;
} pending;

/// The best distance found and its place.
typedef struct answer
{
    double squared;
    uint32_t place;
} answer;

static inline double clamped(double t)
{
    t = t > 0 ? t : 0;
    return t < 1 ? t : 1;
}

static inline double squared_length(double x, double y, double z)
{
    return x * x + y * y + z * z;
}

/// The squared distance between a point and triangle `i` of a packet. It is the minimum over the closest points of the three
/// edges and, where it lies inside, the foot of the perpendicular. All candidates are computed as points of the triangle, so
/// errors in their place enter squared. The foot is computed from the longest edge, which keeps slivers accurate.
static inline double packet_squared(const closest_packet *packet, const double point[3], int i)
{
    double ux = packet->along[0][i], uy = packet->along[1][i], uz = packet->along[2][i];
    double vx = packet->aside[0][i], vy = packet->aside[1][i], vz = packet->aside[2][i];
    double dx = point[0] - packet->corner[0][i], dy = point[1] - packet->corner[1][i], dz = point[2] - packet->corner[2][i];

    double on_along = (dx * ux + dy * uy + dz * uz) * packet->per_along[i];
    double b = dx * packet->height[0][i] + dy * packet->height[1][i] + dz * packet->height[2][i];
    double a = on_along - b * packet->skew[i];
    double inside = squared_length(dx - a * ux - b * vx, dy - a * uy - b * vy, dz - a * uz - b * vz);

    double t = clamped(on_along);
    double smallest = squared_length(dx - t * ux, dy - t * uy, dz - t * uz);
    t = clamped((dx * vx + dy * vy + dz * vz) * packet->per_aside[i]);
    double aside = squared_length(dx - t * vx, dy - t * vy, dz - t * vz);
    smallest = aside < smallest ? aside : smallest;
    double wx = vx - ux, wy = vy - uy, wz = vz - uz;
    dx -= ux;
    dy -= uy;
    dz -= uz;
    t = clamped((dx * wx + dy * wy + dz * wz) * packet->per_across[i]);
    double across = squared_length(dx - t * wx, dy - t * wy, dz - t * wz);
    smallest = across < smallest ? across : smallest;
    // Without && and ||, which would be branches.
    bool within = (a >= 0) & (b >= 0) & (a + b <= 1) & (inside < smallest);
    return within ? inside : smallest;
}

/// Compare the best distance with the triangles of a packet.
static inline void try_packet(const closest_tree *tree, uint32_t index, const double point[3], answer *best)
{
    const closest_packet *packet = &tree->packets[index];
    double squared[WIDTH];
    for (int i = 0; i < WIDTH; i++)
        squared[i] = packet_squared(packet, point, i);
    for (int i = 0; i < WIDTH; i++)
        if (squared[i] < best->squared)
            *best = (answer){squared[i], WIDTH * index + (uint32_t)i};
}

/// Push those boxes of a node that are nearer than `nearer_than`, the nearest last. Returns the new height of the stack.
static inline int open_node(const closest_node *node, pending from, const double point[3], double nearer_than,
                            pending *stack, int height)
{
    double squared[WIDTH];
    for (int i = 0; i < WIDTH; i++)
    {
        double sum = 0;
        for (int k = 0; k < 3; k++)
        {
            double below = node->low[k][i] - point[k], above = point[k] - node->high[k][i];
            double out = below > above ? below : above;
            out = out > 0 ? out : 0;
            sum += out * out;
        }
        squared[i] = sum;
    }
    int bottom = height;
    for (int i = 0; i < WIDTH; i++)
    {
        if (!(squared[i] < nearer_than))
            continue;
        int at = height++;
        for (; at > bottom && stack[at - 1].squared < squared[i]; at--)
            stack[at] = stack[at - 1];
        stack[at] = (pending){squared[i], WIDTH * from.index + (uint32_t)i, from.level - 1};
    }
    return height;
}

LANES_CLONES static answer find_nearer(const closest_tree *tree, const double point[3], uint32_t guess)
{
    answer best = {INFINITY, guess};
    try_packet(tree, guess / WIDTH, point, &best);
    pending stack[STACK];
    int height = 0;
    stack[height++] = (pending){0, 0, tree->root_level};
    while (height > 0)
    {
        pending top = stack[--height];
        if (top.squared >= best.squared)
            continue;
        if (top.level == 0)
            try_packet(tree, top.index, point, &best);
        else
            height = open_node(&tree->nodes[tree->begin[top.level] + top.index], top, point, best.squared, stack, height);
    }
    return best;
}

/// Whether a ray from `origin` meets a box between 0 and `length`. `inverse` holds 1 / direction.
static bool meets_box(const closest_node *node, int lane, const double *origin, const double *inverse, double length)
{
    double begin = 0, end = node->low[0][lane] <= node->high[0][lane] ? length : -1; // unused boxes are empty
    for (int k = 0; k < 3; k++)
    {
        double a = (node->low[k][lane] - origin[k]) * inverse[k], b = (node->high[k][lane] - origin[k]) * inverse[k];
        begin = fmax(begin, fmin(a, b));
        end = fmin(end, fmax(a, b));
    }
    return begin <= end;
}

/// Whether a ray meets a triangle (Möller and Trumbore, 1997).
static bool meets_triangle(const closest_packet *packet, int lane, const double *origin, const double *direction,
                           double length)
{
    double along[3], aside[3], from[3], p[3], q[3];
    for (int k = 0; k < 3; k++)
    {
        along[k] = packet->along[k][lane];
        aside[k] = packet->aside[k][lane];
        from[k] = origin[k] - packet->corner[k][lane];
    }
    vector3_cross(direction, aside, p);
    vector3_cross(from, along, q);
    double volume = vector3_dot(along, p), u = vector3_dot(from, p) / volume, v = vector3_dot(direction, q) / volume,
           t = vector3_dot(aside, q) / volume;
    return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t <= length; // false for NaN
}

bool closest_blocked(const closest_tree *tree, const double origin[3], const double direction[3], double length)
{
    pending stack[STACK];
    double scaled[3], inverse[3];
    int count = 1;
    stack[0] = (pending){0, 0, tree->root_level};
    for (int k = 0; k < 3; k++)
    {
        scaled[k] = origin[k] * tree->scale;
        inverse[k] = 1 / direction[k];
    }
    while (count > 0)
    {
        pending next = stack[--count];
        for (int i = 0; i < WIDTH; i++)
        {
            if (next.level == 0)
            {
                if (meets_triangle(&tree->packets[next.index], i, scaled, direction, length * tree->scale))
                    return true;
            }
            else if (meets_box(&tree->nodes[tree->begin[next.level] + next.index], i, scaled, inverse, length * tree->scale))
                stack[count++] = (pending){0, next.index * WIDTH + (uint32_t)i, next.level - 1};
        }
    }
    return false;
}

double closest_find(const closest_tree *tree, const double point[3], uint32_t *place)
{
    const double scaled[3] = {point[0] * tree->scale, point[1] * tree->scale, point[2] * tree->scale};
    answer best = find_nearer(tree, scaled, *place);
    *place = best.place;
    return sqrt(best.squared) * tree->unscale;
}

double closest_to_place(const closest_tree *tree, const double point[3], uint32_t place)
{
    const double scaled[3] = {point[0] * tree->scale, point[1] * tree->scale, point[2] * tree->scale};
    return sqrt(packet_squared(&tree->packets[place / WIDTH], scaled, (int)(place % WIDTH))) * tree->unscale;
}

/// A point of a triangle: corner 0 + along (corner 1 - corner 0) + aside (corner 2 - corner 0).
typedef struct triangle_point
{
    double along, aside;
} triangle_point;

/// The candidate of packet_squared() with the minimal distance.
static triangle_point nearest_candidate(const closest_packet *packet, const double point[3], int i)
{
    double d[3], u[3], v[3], du = 0, dv = 0, dh = 0, ew = 0;
    for (int k = 0; k < 3; k++)
    {
        d[k] = point[k] - packet->corner[k][i];
        u[k] = packet->along[k][i];
        v[k] = packet->aside[k][i];
        du += d[k] * u[k];
        dv += d[k] * v[k];
        dh += d[k] * packet->height[k][i];
        ew += (d[k] - u[k]) * (v[k] - u[k]);
    }
    double on_along = du * packet->per_along[i], on_across = clamped(ew * packet->per_across[i]);
    triangle_point candidates[4] = {{clamped(on_along), 0},
                                    {0, clamped(dv * packet->per_aside[i])},
                                    {1 - on_across, on_across},
                                    {on_along - dh * packet->skew[i], dh}};
    bool inside = candidates[3].along >= 0 && dh >= 0 && candidates[3].along + dh <= 1;
    triangle_point best = candidates[0];
    double smallest = INFINITY;
    for (int c = 0; c < (inside ? 4 : 3); c++)
    {
        double r[3];
        for (int k = 0; k < 3; k++)
            r[k] = d[k] - candidates[c].along * u[k] - candidates[c].aside * v[k];
        double squared = squared_length(r[0], r[1], r[2]);
        if (squared < smallest)
        {
            smallest = squared;
            best = candidates[c];
        }
    }
    return best;
}

closest_hit closest_point_at(const closest_tree *tree, const double point[3], uint32_t place)
{
    const double scaled[3] = {point[0] * tree->scale, point[1] * tree->scale, point[2] * tree->scale};
    const closest_packet *packet = &tree->packets[place / WIDTH];
    int i = (int)(place % WIDTH), turn = tree->turns[place];
    triangle_point at = nearest_candidate(packet, scaled, i);
    closest_hit hit = {.face = tree->faces[place]};
    double rest = 1 - at.along - at.aside, squared = 0;
    hit.barycentric[turn] = rest > 0 ? rest : 0;
    hit.barycentric[(turn + 1) % 3] = at.along;
    hit.barycentric[(turn + 2) % 3] = at.aside;
    for (int k = 0; k < 3; k++)
    {
        double on = packet->corner[k][i] + at.along * packet->along[k][i] + at.aside * packet->aside[k][i];
        hit.point[k] = on * tree->unscale;
        squared += (scaled[k] - on) * (scaled[k] - on);
    }
    hit.distance = sqrt(squared) * tree->unscale;
    return hit;
}

// Closest points and distances for many points, in blocks on several threads.

/// Points of a block. Each block starts its search anew, so results do not depend on the number of threads.
#define BLOCK 1024

static bat_status check_points(const double *points, size_t count, const char *what, bat_error *error)
{
    for (size_t i = 0; i < 3 * count; i++)
        if (!(fabs(points[i]) <= DBL_MAX / 4))
            return error_set(error, BAT_INVALID_POINT, i / 3, 0, "%s %zu is not finite or too far from the origin", what,
                             i / 3);
    return BAT_OK;
}

/// Check the mesh and the points, and build a tree for queries with these points.
static bat_status tree_for(const bat_mesh *mesh, const double *points, size_t count, const char *what, closest_tree *tree,
                           bat_error *error)
{
    bat_status status = mesh_check_triangles(mesh, error);
    if (status == BAT_OK)
        status = check_points(mesh->positions, mesh->vertex_count, "vertex", error);
    if (status == BAT_OK)
        status = check_points(points, count, what, error);
    if (status != BAT_OK)
        return status;
    double largest = closest_largest(mesh->positions, 3 * mesh->vertex_count, 0);
    return closest_build(mesh, closest_largest(points, 3 * count, largest), tree, error);
}

/// Find the closest points of all points, which messages call `what`, or only their distances where `closest` is null.
static bat_status find_all(const bat_mesh *mesh, const double *points, size_t count, const char *what, int threads,
                           bat_mesh_closest_point *closest, double *distances, bat_error *error)
{
    closest_tree tree;
    bat_status status = tree_for(mesh, points, count, what, &tree, error);
    if (status != BAT_OK)
        return status;
    size_t blocks = count / BLOCK + (count % BLOCK > 0);
    threads = threads_for(threads, blocks);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t block = 0; block < blocks; block++)
    {
        size_t begin = block * BLOCK, end = count - begin < BLOCK ? count : begin + BLOCK;
        uint32_t place = 0;
        for (size_t i = begin; i < end; i++)
        {
            double distance = closest_find(&tree, points + 3 * i, &place);
            if (closest == NULL)
            {
                distances[i] = distance;
                continue;
            }
            closest_hit hit = closest_point_at(&tree, points + 3 * i, place);
            closest[i] = (bat_mesh_closest_point){.at = {.face = hit.face}, .distance = hit.distance};
            memcpy(closest[i].at.barycentric, hit.barycentric, sizeof hit.barycentric);
            memcpy(closest[i].position, hit.point, sizeof hit.point);
        }
    }
    closest_free(&tree);
    return BAT_OK;
}

bat_status bat_mesh_closest(const bat_mesh *mesh, const double *points, size_t count, int threads,
                            bat_mesh_closest_point *closest, bat_error *error)
{
    return find_all(mesh, points, count, "point", threads, closest, NULL, error);
}

bat_status bat_mesh_vertex_distances(const bat_mesh *from, const bat_mesh *onto, int threads, double *distances,
                                     bat_error *error)
{
    return find_all(onto, from->positions, from->vertex_count, "vertex", threads, NULL, distances, error);
}
