#include "mesh/decimate/collapse_error.h"

#include "base/error.h"
#include "linalg/vector.h"

#include <string.h>

void tolerance_free(tolerance *all)
{
    closest_free(&all->tree);
    memory_pool_free(&all->pool);
    *all = (tolerance){0};
}

/// Add a sample to a face: the mean of its first `count` corners from `corner` on.
static void add_sample(tolerance *all, const bat_mesh *fine, size_t face, size_t corner, size_t count)
{
    double *sample = all->samples + 3 * all->sample_count;
    for (size_t k = 0; k < 3; k++)
    {
        sample[k] = 0;
        for (size_t c = 0; c < count; c++)
            sample[k] += fine->positions[3 * (size_t)fine->faces[3 * face + (corner + c) % 3] + k];
        sample[k] /= (double)count;
    }
    all->next[all->sample_count] = all->first[face];
    all->first[face] = (uint32_t)all->sample_count++;
}

bat_status tolerance_make(const bat_mesh *fine, const bat_mesh_connectivity *topology, double bound, tolerance *made,
                          bat_error *error)
{
    size_t count = fine->vertex_count + topology->edge_count + fine->face_count;
    *made = (tolerance){.bound = bound};
    if (count >= BAT_MESH_NONE)
        return ERROR_TOO_LARGE(error, "a bound on the distance needs %zu samples, more than %u", count, BAT_MESH_NONE - 1);
    bat_status status = closest_build(fine, closest_largest(fine->positions, 3 * fine->vertex_count, 0), &made->tree, error);
    if (status != BAT_OK)
        return status;
    made->samples = memory_pool_array(&made->pool, count, 3 * sizeof *made->samples);
    made->first = memory_pool_array(&made->pool, fine->face_count, sizeof *made->first);
    made->next = memory_pool_array(&made->pool, count, sizeof *made->next);
    made->place = memory_pool_zeros(&made->pool, fine->vertex_count + 1, sizeof *made->place);
    made->moved = memory_pool_array(&made->pool, count, sizeof *made->moved);
    made->nearest = memory_pool_array(&made->pool, count, sizeof *made->nearest);
    status = memory_pool_check(&made->pool, error);
    if (status != BAT_OK)
    {
        tolerance_free(made);
        return status;
    }
    memset(made->first, 0xff, fine->face_count * sizeof *made->first);
    for (size_t h = 0; h < 3 * fine->face_count; h++)
    {
        if (topology->first[fine->faces[h]] == h)
            add_sample(made, fine, h / 3, h % 3, 1);
        if (topology->twin[h] > h)
            add_sample(made, fine, h / 3, h % 3, 2);
        if (h % 3 == 0)
            add_sample(made, fine, h / 3, 0, 3);
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

/// Whether the point of a new face with some shares of its corners is near the given mesh.
static bool is_near(const tolerance *all, const double *const corners[3], const double *shares, uint32_t *place)
{
    double point[3];
    for (int c = 0; c < 3; c++)
        point[c] = shares[0] * corners[0][c] + shares[1] * corners[1][c] + shares[2] * corners[2][c];
    return closest_find(&all->tree, point, place) <= all->bound;
}

/// Whether the new faces are near the given mesh at their samples.
static bool result_is_near(const tolerance *all, const error_vertex *vertices, const collapse_ring *ring,
                           const double *position)
{
    static const double SPOKE[][3] = {{0.5, 0.5, 0}, {0.75, 0.25, 0}, {0.25, 0.75, 0}},
                        FACE[][3] = {{1 / 3.0, 1 / 3.0, 1 / 3.0},
                                     {2 / 3.0, 1 / 6.0, 1 / 6.0},
                                     {1 / 6.0, 2 / 3.0, 1 / 6.0},
                                     {1 / 6.0, 1 / 6.0, 2 / 3.0}};
    uint32_t place = all->place[ring->i];
    if (!(closest_find(&all->tree, position, &place) <= all->bound))
        return false;
    uint32_t spokes = collapse_ring_vertices(ring);
    for (uint32_t k = 0; k < spokes; k++)
    {
        const double *corners[3] = {position, vertices[ring->vertex[k]].position,
                                    vertices[ring->vertex[k + 1 < spokes ? k + 1 : 0]].position};
        uint32_t near = place;
        for (size_t n = 0; n < sizeof SPOKE / sizeof *SPOKE; n++)
            if (!is_near(all, corners, SPOKE[n], &near))
                return false;
        for (size_t n = 0; n < sizeof FACE / sizeof *FACE && k < ring->count; n++)
            if (!is_near(all, corners, FACE[n], &near))
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
            vector3_subtract(all->samples + 3 * (size_t)sample, position, point);
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
