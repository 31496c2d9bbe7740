#include "mesh/decimate/tolerance.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector3.h"

#include <stdlib.h>
#include <string.h>

void tolerance_free(tolerance *all)
{
    closest_free(&all->tree);
    free(all->first);
    free(all->next);
    free(all->place);
    free(all->moved);
    free(all->nearest);
    *all = (tolerance){0};
}

bat_status tolerance_make(const bat_mesh *fine, double bound, tolerance *made, bat_error *error)
{
    double largest = closest_largest(fine->positions, 3 * fine->vertex_count, 0);
    *made = (tolerance){.bound = bound, .positions = fine->positions};
    bat_status status = closest_build(fine, largest, &made->tree, error);
    if (status != BAT_OK)
        return status;
    made->first = memory_array(fine->face_count, sizeof *made->first);
    made->next = memory_array(fine->vertex_count, sizeof *made->next);
    made->place = calloc(fine->vertex_count + 1, sizeof *made->place);
    made->moved = memory_array(fine->vertex_count, sizeof *made->moved);
    made->nearest = memory_array(fine->vertex_count, sizeof *made->nearest);
    if (made->first == NULL || made->next == NULL || made->place == NULL || made->moved == NULL || made->nearest == NULL)
    {
        tolerance_free(made);
        return error_memory(error, fine->vertex_count * sizeof *made->next);
    }
    memset(made->first, 0xff, fine->face_count * sizeof *made->first);
    memset(made->next, 0xff, fine->vertex_count * sizeof *made->next);
    // The vertex of a face gets its first face; `moved` marks the vertices that have one.
    memset(made->moved, 0, fine->vertex_count * sizeof *made->moved);
    for (size_t h = 0; h < 3 * fine->face_count; h++)
    {
        uint32_t vertex = fine->faces[h];
        if (made->moved[vertex] != 0)
            continue;
        made->moved[vertex] = 1;
        made->next[vertex] = made->first[h / 3];
        made->first[h / 3] = vertex;
    }
    for (uint32_t place = 0; place < made->tree.face_count; place++)
        for (size_t c = 0; c < 3; c++)
            made->place[fine->faces[3 * (size_t)made->tree.faces[place] + c]] = place;
    return BAT_OK;
}

/// A triangle from the new vertex to an edge of the ring, with what the distances from it need.
typedef struct target
{
    double origin[3], along[3], aside[3], normal[3];
    double along_along, along_aside, aside_aside, normal_normal;
} target;

static void set_target(const double *a, const double *b, const double *c, target *made)
{
    memcpy(made->origin, a, sizeof made->origin);
    vector3_subtract(b, a, made->along);
    vector3_subtract(c, a, made->aside);
    vector3_cross(made->along, made->aside, made->normal);
    made->along_along = vector3_dot(made->along, made->along);
    made->along_aside = vector3_dot(made->along, made->aside);
    made->aside_aside = vector3_dot(made->aside, made->aside);
    made->normal_normal = vector3_dot(made->normal, made->normal);
}

static double clamped(double number)
{
    return fmin(fmax(number, 0), 1);
}

/// The squared distance of a point from origin + u along + v aside.
static double squared_distance(const target *to, const double *point, double u, double v)
{
    double square = 0;
    for (int c = 0; c < 3; c++)
    {
        double step = point[c] - u * to->along[c] - v * to->aside[c];
        square += step * step;
    }
    return square;
}

/// The squared distance of a point, given relative to the triangle's origin, from the triangle.
static double squared_distance_to(const target *to, const double *point)
{
    double p = vector3_dot(point, to->along), q = vector3_dot(point, to->aside);
    double u = p * to->aside_aside - q * to->along_aside, v = q * to->along_along - p * to->along_aside;
    if (u >= 0 && v >= 0 && u + v <= to->normal_normal && to->normal_normal > 0)
    {
        double height = vector3_dot(point, to->normal);
        return height * height / to->normal_normal;
    }
    // The nearest point of the three edges.
    double on_along = to->along_along > 0 ? clamped(p / to->along_along) : 0,
           on_aside = to->aside_aside > 0 ? clamped(q / to->aside_aside) : 0,
           across = to->along_along + to->aside_aside - 2 * to->along_aside,
           on_across = across > 0 ? clamped((q - p + to->along_along - to->along_aside) / across) : 0;
    double nearest = fmin(squared_distance(to, point, on_along, 0), squared_distance(to, point, 0, on_aside));
    return fmin(nearest, squared_distance(to, point, 1 - on_across, on_across));
}

/// Whether a sample of the result is near the given mesh.
static bool is_near(const tolerance *all, const double *point, uint32_t *place)
{
    return closest_find(&all->tree, point, place) <= all->bound;
}

/// Whether the new faces are near the given mesh at their vertices and middles.
static bool result_is_near(const tolerance *all, const error_vertex *vertices, const collapse_ring *ring,
                           const double *position)
{
    uint32_t place = all->place[ring->i];
    if (!is_near(all, position, &place))
        return false;
    uint32_t spokes = collapse_ring_vertices(ring);
    for (uint32_t k = 0; k < spokes; k++)
    {
        const double *from = vertices[ring->vertex[k]].position,
                     *to = vertices[ring->vertex[k + 1 < spokes ? k + 1 : 0]].position;
        double middle[3], centre[3];
        uint32_t near = place;
        for (int c = 0; c < 3; c++)
        {
            middle[c] = (position[c] + from[c]) / 2;
            centre[c] = (position[c] + from[c] + to[c]) / 3;
        }
        if (!is_near(all, middle, &near) || (k < ring->count && !is_near(all, centre, &near)))
            return false;
    }
    return true;
}

bool tolerance_allows(tolerance *all, const error_vertex *vertices, const collapse_ring *ring, const double *position)
{
    target targets[COLLAPSE_MAX_FACES];
    double bound = all->bound * all->bound;
    if (!result_is_near(all, vertices, ring, position))
        return false;
    for (uint32_t k = 0; k < ring->count; k++)
        set_target(position, vertices[ring->vertex[k]].position, vertices[ring->vertex[k + 1]].position, &targets[k]);
    all->moved_count = 0;
    for (uint32_t k = 0; k < ring->count + ring->vanishing; k++)
        for (uint32_t sample = all->first[ring->half_edge[k] / 3]; sample != BAT_MESH_NONE; sample = all->next[sample])
        {
            double point[3], least = INFINITY;
            uint8_t nearest = 0;
            vector3_subtract(all->positions + 3 * (size_t)sample, position, point);
            for (uint32_t n = 0; n < ring->count; n++)
            {
                double square = squared_distance_to(&targets[n], point);
                if (square < least)
                {
                    least = square;
                    nearest = (uint8_t)n;
                }
            }
            if (!(least <= bound))
                return false;
            all->moved[all->moved_count] = sample;
            all->nearest[all->moved_count++] = nearest;
        }
    return true;
}

void tolerance_apply(tolerance *all, const collapse_ring *ring)
{
    for (uint32_t k = 0; k < ring->count + ring->vanishing; k++)
        all->first[ring->half_edge[k] / 3] = BAT_MESH_NONE;
    for (size_t m = 0; m < all->moved_count; m++)
    {
        uint32_t *first = &all->first[ring->half_edge[all->nearest[m]] / 3];
        all->next[all->moved[m]] = *first;
        *first = all->moved[m];
    }
}
