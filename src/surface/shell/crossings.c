/// @file
/// Patches of a shell that cross others; see shell.h.
///
/// Each patch is sampled by triangles. Patches whose boxes meet, found in the order of these along an axis, are compared:
/// two triangles without a common vertex cross where an edge of one passes through the inside of the other.

#include "surface/shell/shell.h"

#include "base/error.h"
#include "linalg/vector.h"

#include <string.h>

#define SAMPLES 3 ///< of a patch and direction
#define TRIANGLES (2 * SAMPLES * SAMPLES)

/// The box of a patch.
typedef struct cross_box
{
    double low[3], high[3];
    size_t patch;
} cross_box;

DEFINE_ORDER(compare_boxes, cross_box, low[0], patch)

/// The vertices of a triangle of quads that are cut along the diagonal from corner 0.
static void triangle_of(const bat_mesh *quads, size_t triangle, uint32_t corners[3])
{
    const uint32_t *quad = quads->faces + 4 * (triangle / 2);
    corners[0] = quad[0];
    corners[1] = quad[1 + triangle % 2];
    corners[2] = quad[2 + triangle % 2];
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

static bool cross(const bat_mesh *quads, size_t i, size_t j)
{
    uint32_t corners[2][3];
    const double *places[2][3];
    triangle_of(quads, i, corners[0]);
    triangle_of(quads, j, corners[1]);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            if (corners[0][a] == corners[1][b])
                return false;
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 2; k++)
            places[k][a] = quads->positions + 3 * (size_t)corners[k][a];
    for (int d = 0; d < 3; d++)
        if (fmin(fmin(places[0][0][d], places[0][1][d]), places[0][2][d]) >
                fmax(fmax(places[1][0][d], places[1][1][d]), places[1][2][d]) ||
            fmin(fmin(places[1][0][d], places[1][1][d]), places[1][2][d]) >
                fmax(fmax(places[0][0][d], places[0][1][d]), places[0][2][d]))
            return false;
    return passes(places[0], places[1]) || passes(places[1], places[0]);
}

/// Whether triangles of two patches cross, or of one.
static bool patches_cross(const bat_mesh *quads, size_t first, size_t second)
{
    for (size_t i = first * TRIANGLES; i < (first + 1) * TRIANGLES; i++)
        for (size_t k = first == second ? i + 1 : second * TRIANGLES; k < (second + 1) * TRIANGLES; k++)
            if (cross(quads, i, k))
                return true;
    return false;
}

static bool meet(const cross_box *a, const cross_box *b)
{
    bool meet = true;
    for (int d = 0; d < 3; d++)
        meet = meet && a->low[d] <= b->high[d] && b->low[d] <= a->high[d];
    return meet;
}

bat_status shell_count_crossings(const bat_shell *shell, size_t *crossings, bat_error *error)
{
    size_t count = shell->cage.face_count;
    bat_mesh sampled = {0};
    memory_pool pool = {0};
    cross_box *boxes = memory_pool_array(&pool, count, sizeof *boxes);
    bool *marks = memory_pool_zeros(&pool, count, sizeof *marks);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        status = bat_shell_tessellate(shell, SAMPLES, &sampled, error);
    for (size_t q = 0; q < count && status == BAT_OK; q++)
    {
        boxes[q] = (cross_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, q};
        for (size_t k = 2 * TRIANGLES * q; k < 2 * TRIANGLES * (q + 1); k++)
            box_include(3, sampled.positions + 3 * (size_t)sampled.faces[k], boxes[q].low, boxes[q].high);
    }
    *crossings = 0;
    if (status == BAT_OK)
    {
        qsort(boxes, count, sizeof *boxes, compare_boxes);
        for (size_t i = 0; i < count; i++)
            for (size_t k = i; k < count && boxes[k].low[0] <= boxes[i].high[0]; k++)
                if (meet(&boxes[i], &boxes[k]) && patches_cross(&sampled, boxes[i].patch, boxes[k].patch))
                    marks[boxes[i].patch] = marks[boxes[k].patch] = true;
        for (size_t q = 0; q < count; q++)
            *crossings += marks[q];
    }
    memory_pool_free(&pool);
    bat_mesh_free(&sampled);
    return status;
}
