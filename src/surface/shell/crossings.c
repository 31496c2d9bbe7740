/// @file
/// Patches of a shell that cross others; see shell.h.
///
/// Each patch is sampled by triangles. A tree of boxes finds pairs that may cross: those without a common vertex of which
/// an edge of one passes through the inside of the other.

#include "surface/shell/shell.h"

#include "base/error.h"
#include "linalg/vector.h"
#include "search/nearest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLES 3 ///< of a patch and direction
#define LEAF 4    ///< most triangles of a leaf
#define DEPTH 64

typedef struct cross_box
{
    double low[3], high[3];
    uint32_t begin, end; ///< of the triangles below
    uint32_t right;      ///< the second child; the first one follows its parent; 0 for a leaf
} cross_box;

typedef struct cross_tree
{
    const bat_mesh *quads; ///< cut along the diagonal from corner 0
    keyed *order;          ///< triangles, leaf by leaf
    cross_box *boxes;
    size_t box_count;
    memory_pool pool;
} cross_tree;

/// The vertices of a triangle.
static void triangle_of(const cross_tree *tree, uint32_t triangle, uint32_t corners[3])
{
    const uint32_t *quad = tree->quads->faces + 4 * (size_t)(triangle / 2);
    corners[0] = quad[0];
    corners[1] = quad[1 + triangle % 2];
    corners[2] = quad[2 + triangle % 2];
}

static const double *place_of(const cross_tree *tree, uint32_t vertex)
{
    return tree->quads->positions + 3 * (size_t)vertex;
}

static uint32_t triangle_at(const cross_tree *tree, size_t place)
{
    return (uint32_t)tree->order[place].item;
}

/// Divide a range at `middle` by the centres of its triangles along an axis.
static void divide(cross_tree *tree, size_t begin, size_t end, size_t middle, size_t axis)
{
    for (size_t k = begin; k < end; k++)
    {
        uint32_t corners[3];
        triangle_of(tree, triangle_at(tree, k), corners);
        tree->order[k].key = 0;
        for (size_t c = 0; c < 3; c++)
            tree->order[k].key += place_of(tree, corners[c])[axis];
    }
    select_nth(tree->order + begin, end - begin, middle - begin);
}

/// Make the box of a range and those below. Returns its number.
static uint32_t grow(cross_tree *tree, size_t begin, size_t end)
{
    uint32_t number = (uint32_t)tree->box_count++;
    cross_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, (uint32_t)begin, (uint32_t)end, 0};
    for (size_t k = begin; k < end; k++)
    {
        uint32_t corners[3];
        triangle_of(tree, triangle_at(tree, k), corners);
        for (int c = 0; c < 3; c++)
            box_include(3, place_of(tree, corners[c]), box.low, box.high);
    }
    if (end - begin > LEAF)
    {
        size_t axis = 0, middle = begin + (end - begin) / 2;
        for (size_t d = 1; d < 3; d++)
            axis = box.high[d] - box.low[d] > box.high[axis] - box.low[axis] ? d : axis;
        divide(tree, begin, end, middle, axis);
        (void)grow(tree, begin, middle);
        box.right = grow(tree, middle, end);
    }
    tree->boxes[number] = box;
    return number;
}

/// Six times the volume of a tetrahedron.
static double volume_of(const double *a, const double *b, const double *c, const double *d)
{
    double p[3], q[3], r[3], product[3];
    vector3_subtract(b, a, p);
    vector3_subtract(c, a, q);
    vector3_subtract(d, a, r);
    vector3_cross(p, q, product);
    return vector3_dot(product, r);
}

/// Whether an edge of the first triangle passes through the second.
static bool passes(const double *const first[3], const double *const second[3])
{
    double sides[3];
    for (int k = 0; k < 3; k++)
        sides[k] = volume_of(second[0], second[1], second[2], first[k]);
    for (int k = 0; k < 3; k++)
    {
        const double *from = first[k], *to = first[(k + 1) % 3];
        if (!(sides[k] * sides[(k + 1) % 3] < 0))
            continue;
        double a = volume_of(from, to, second[0], second[1]), b = volume_of(from, to, second[1], second[2]),
               c = volume_of(from, to, second[2], second[0]);
        if ((a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0))
            return true;
    }
    return false;
}

static bool cross(const cross_tree *tree, uint32_t i, uint32_t j)
{
    uint32_t corners[2][3];
    const double *places[2][3];
    triangle_of(tree, i, corners[0]);
    triangle_of(tree, j, corners[1]);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            if (corners[0][a] == corners[1][b])
                return false;
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 2; k++)
            places[k][a] = place_of(tree, corners[k][a]);
    return passes(places[0], places[1]) || passes(places[1], places[0]);
}

static bool meet(const cross_box *a, const cross_box *b)
{
    bool meet = true;
    for (int d = 0; d < 3; d++)
        meet = meet && a->low[d] <= b->high[d] && b->low[d] <= a->high[d];
    return meet;
}

/// Mark the patches with triangles of a leaf that cross others.
static void search(const cross_tree *tree, const cross_box *leaf, bool *marks)
{
    uint32_t stack[DEPTH], depth = 0;
    stack[depth++] = 0;
    while (depth > 0)
    {
        uint32_t number = stack[--depth];
        const cross_box *box = &tree->boxes[number];
        // Each pair once.
        if (box->end <= leaf->begin || !meet(box, leaf))
            continue;
        if (box->right != 0)
        {
            stack[depth++] = number + 1;
            stack[depth++] = box->right;
            continue;
        }
        for (uint32_t a = leaf->begin; a < leaf->end; a++)
            for (uint32_t b = a + 1 > box->begin ? a + 1 : box->begin; b < box->end; b++)
            {
                uint32_t i = triangle_at(tree, a), k = triangle_at(tree, b);
                if (cross(tree, i, k))
                    marks[i / (2 * SAMPLES * SAMPLES)] = marks[k / (2 * SAMPLES * SAMPLES)] = true;
            }
    }
}

bat_status shell_count_crossings(const bat_shell *shell, size_t *crossings, bat_error *error)
{
    bat_mesh sampled = {0};
    cross_tree tree = {.quads = &sampled};
    bat_status status = bat_shell_tessellate(shell, SAMPLES, &sampled, error);
    if (status != BAT_OK)
        return status;
    size_t count = 2 * sampled.face_count;
    tree.order = memory_pool_array(&tree.pool, count, sizeof *tree.order);
    tree.boxes = memory_pool_array(&tree.pool, count, sizeof *tree.boxes);
    bool *marks = memory_pool_zeros(&tree.pool, shell->cage.face_count, sizeof *marks);
    status = memory_pool_check(&tree.pool, error);
    for (size_t k = 0; k < count && status == BAT_OK; k++)
        tree.order[k].item = k;
    *crossings = 0;
    if (status == BAT_OK)
    {
        (void)grow(&tree, 0, count);
        for (size_t k = 0; k < tree.box_count; k++)
            if (tree.boxes[k].right == 0)
                search(&tree, &tree.boxes[k], marks);
        for (size_t q = 0; q < shell->cage.face_count; q++)
            *crossings += marks[q];
    }
    memory_pool_free(&tree.pool);
    bat_mesh_free(&sampled);
    return status;
}
