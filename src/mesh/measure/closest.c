#include "mesh/measure/closest.h"

#include "base/lanes.h"

#include <math.h>

enum
{
    WIDTH = CLOSEST_WIDTH,
    /// A node leaves at most 7 of its entries on the stack when the eighth is opened.
    STACK = (WIDTH - 1) * CLOSEST_MOST_LEVELS + WIDTH
};

/// What is still to be opened: a node, or on level 0 a packet.
typedef struct pending
{
    double squared; ///< distance of its box
    uint32_t index;
    int level;
} pending;

/// The best so far.
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

/// Squared distance of a point from triangle `i` of a packet: that of the closest point on the three edges and, where the
/// foot of the perpendicular lies inside, of the foot. All four are points of the triangle, computed as such, so that an
/// error in where they lie counts only squared; and the foot is found from the longest edge, so that slivers are as good as
/// others.
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
    double least = squared_length(dx - t * ux, dy - t * uy, dz - t * uz);
    t = clamped((dx * vx + dy * vy + dz * vz) * packet->per_aside[i]);
    double aside = squared_length(dx - t * vx, dy - t * vy, dz - t * vz);
    least = aside < least ? aside : least;
    double wx = vx - ux, wy = vy - uy, wz = vz - uz;
    dx -= ux;
    dy -= uy;
    dz -= uz;
    t = clamped((dx * wx + dy * wy + dz * wz) * packet->per_across[i]);
    double across = squared_length(dx - t * wx, dy - t * wy, dz - t * wz);
    least = across < least ? across : least;
    // Without short cuts, which would be branches.
    bool within = (a >= 0) & (b >= 0) & (a + b <= 1) & (inside < least);
    return within ? inside : least;
}

/// Compare the best with the triangles of a packet.
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

/// Put those boxes of a node on the stack that are nearer than the best, the nearest on top. Returns the new height.
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

/// A triangle's corners a and b at along = 1, aside = 1, and what is left to corner 0.
typedef struct triangle_point
{
    double along, aside;
} triangle_point;

/// Which of the candidates of packet_squared() it was.
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
    double least = INFINITY;
    for (int c = 0; c < (inside ? 4 : 3); c++)
    {
        double r[3];
        for (int k = 0; k < 3; k++)
            r[k] = d[k] - candidates[c].along * u[k] - candidates[c].aside * v[k];
        double squared = squared_length(r[0], r[1], r[2]);
        if (squared < least)
        {
            least = squared;
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
