#include "mesh/refine/sharpness.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/refine/split.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Sharpness of edges and vertices: from creases, corners and angles, through the levels, and back to creases and corners.

/// A half-edge between two vertices, in either direction; BAT_MESH_NONE when they are not neighbours.
static uint32_t find_half_edge(const bat_mesh *mesh, const bat_mesh_connectivity *links, uint32_t a, uint32_t b)
{
    uint32_t first = links->first[a], h = first;
    while (h != BAT_MESH_NONE)
    {
        if (mesh_end(mesh->faces, h) == b)
            return h;
        if (mesh_opposite(mesh->faces, h) == b)
            return bat_mesh_previous(h);
        h = bat_mesh_next_around(links, h);
        if (h == first)
            break;
    }
    return BAT_MESH_NONE;
}

static bat_status take_creases(const bat_mesh *mesh, const bat_mesh_connectivity *links, double *sharpness, bat_error *error)
{
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        const bat_mesh_crease *crease = &mesh->creases[i];
        uint32_t h = find_half_edge(mesh, links, crease->a, crease->b);
        if (h == BAT_MESH_NONE)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "crease %zu joins vertices %u and %u, which are not an edge",
                             i, crease->a, crease->b);
        double *edge = &sharpness[links->edge[h]];
        *edge = fmax(*edge, crease->sharpness);
    }
    return BAT_OK;
}

/// The normal of a face, with twice its area as length.
static void face_normal(const bat_mesh *mesh, size_t face, double normal[3])
{
    const uint32_t *corner = mesh->faces + 3 * face;
    const double *p = mesh->positions + 3 * (size_t)corner[0], *q = mesh->positions + 3 * (size_t)corner[1],
                 *r = mesh->positions + 3 * (size_t)corner[2];
    for (int i = 0; i < 3; i++)
    {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = (q[j] - p[j]) * (r[k] - p[k]) - (q[k] - p[k]) * (r[j] - p[j]);
    }
}

/// The angle between the normals of two faces, 0 to pi; 0 where a face has no area.
static double angle_between_faces(const bat_mesh *mesh, size_t f, size_t g)
{
    double m[3], n[3], cross = 0, dot = 0;
    face_normal(mesh, f, m);
    face_normal(mesh, g, n);
    for (int i = 0; i < 3; i++)
    {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double component = m[j] * n[k] - m[k] * n[j];
        cross += component * component;
        dot += m[i] * n[i];
    }
    return atan2(sqrt(cross), dot);
}

static void take_angles(const bat_mesh *mesh, const bat_mesh_connectivity *links, double crease_angle, double *sharpness)
{
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
    {
        uint32_t twin = links->twin[h];
        if (twin != BAT_MESH_NONE && h < twin && angle_between_faces(mesh, h / 3, twin / 3) > crease_angle)
            sharpness[links->edge[h]] = fmax(sharpness[links->edge[h]], BAT_MESH_SHARP);
    }
}

/// Allocate an array of zeros.
static bat_status make_sharpness(size_t count, double **sharpness, bat_error *error)
{
    *sharpness = memory_array(count, sizeof **sharpness);
    if (*sharpness == NULL)
        return error_memory(error, count * sizeof **sharpness);
    memset(*sharpness, 0, count * sizeof **sharpness);
    return BAT_OK;
}

/// Release an array of zeros and set it to null.
static void drop_if_zero(size_t count, double **sharpness)
{
    for (size_t i = 0; i < count; i++)
        if ((*sharpness)[i] > 0)
            return;
    free(*sharpness);
    *sharpness = NULL;
}

bat_status sharpness_of_edges(const bat_mesh *mesh, const bat_mesh_connectivity *links, double crease_angle,
                              double **sharpness, bat_error *error)
{
    *sharpness = NULL;
    if (mesh->crease_count == 0 && !(crease_angle > 0))
        return BAT_OK;
    bat_status status = make_sharpness(links->edge_count, sharpness, error);
    if (status == BAT_OK)
        status = take_creases(mesh, links, *sharpness, error);
    if (status != BAT_OK)
    {
        free(*sharpness);
        *sharpness = NULL;
        return status;
    }
    if (crease_angle > 0)
        take_angles(mesh, links, crease_angle, *sharpness);
    drop_if_zero(links->edge_count, sharpness);
    return BAT_OK;
}

bat_status sharpness_of_vertices(const bat_mesh *mesh, double **sharpness, bat_error *error)
{
    *sharpness = NULL;
    if (mesh->corner_count == 0)
        return BAT_OK;
    bat_status status = make_sharpness(mesh->vertex_count, sharpness, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < mesh->corner_count; i++)
    {
        double *vertex = &(*sharpness)[mesh->corners[i].vertex];
        *vertex = fmax(*vertex, mesh->corners[i].sharpness);
    }
    drop_if_zero(mesh->vertex_count, sharpness);
    return BAT_OK;
}

/// Runs on one thread: few edges are sharp.
bat_status sharpness_split(const double *sharpness, const bat_mesh_connectivity *links, const bat_mesh_connectivity *fine,
                           double **result, bat_error *error)
{
    bat_status status = make_sharpness(fine->edge_count, result, error);
    if (status != BAT_OK)
        return status;
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
        if (mesh_owns(links->twin, h))
        {
            double after = sharpness_after_level(sharpness[links->edge[h]]);
            (*result)[fine->edge[split_near(h)]] = after;
            (*result)[fine->edge[split_far(h)]] = after;
        }
    drop_if_zero(fine->edge_count, result);
    return BAT_OK;
}

/// Write both halves of each edge that remains sharp. With `creases` null only count them.
static size_t write_creases(const mesh_level *level, bat_mesh_crease *creases)
{
    const bat_mesh_connectivity *links = level->links;
    size_t count = 0;
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
    {
        double after = sharpness_after_level(level->edge_sharpness[links->edge[h]]);
        if (!mesh_owns(links->twin, h) || !(after > 0))
            continue;
        uint32_t middle = (uint32_t)links->vertex_count + links->edge[h];
        if (creases != NULL)
        {
            creases[count] = (bat_mesh_crease){level->faces[h], middle, after};
            creases[count + 1] = (bat_mesh_crease){middle, mesh_end(level->faces, h), after};
        }
        count += 2;
    }
    return count;
}

static size_t write_corners(const mesh_level *level, bat_mesh_corner *corners)
{
    size_t count = 0;
    for (uint32_t v = 0; v < level->coarse_count; v++)
    {
        double after = sharpness_after_level(level->vertex_sharpness[v]);
        if (!(after > 0))
            continue;
        if (corners != NULL)
            corners[count] = (bat_mesh_corner){v, after};
        count++;
    }
    return count;
}

bat_status sharpness_write(const mesh_level *level, bat_mesh *fine, bat_error *error)
{
    size_t creases = level->edge_sharpness != NULL ? write_creases(level, NULL) : 0;
    size_t corners = level->vertex_sharpness != NULL ? write_corners(level, NULL) : 0;
    if (creases > 0)
    {
        fine->creases = memory_array(creases, sizeof *fine->creases);
        if (fine->creases == NULL)
            return error_memory(error, creases * sizeof *fine->creases);
        fine->crease_count = write_creases(level, fine->creases);
    }
    if (corners > 0)
    {
        fine->corners = memory_array(corners, sizeof *fine->corners);
        if (fine->corners == NULL)
            return error_memory(error, corners * sizeof *fine->corners);
        fine->corner_count = write_corners(level, fine->corners);
    }
    return BAT_OK;
}

/// The sharp edges around a vertex: their number and the ends of the first two.
typedef struct sharp_count
{
    unsigned edges;
    uint32_t ends[2];
} sharp_count;

static void count_end(sharp_count *count, uint32_t end)
{
    if (count->edges < 2)
        count->ends[count->edges] = end;
    count->edges++;
}

static sharp_vertex kind_of(const sharp_count *count, double vertex_sharpness)
{
    sharp_vertex made = {.ends = {count->ends[0], count->ends[1]}};
    if (vertex_sharpness > 0 || count->edges > 2)
        made.kind = SHARP_CORNER;
    else if (count->edges == 2)
        made.kind = SHARP_CREASE;
    else
        made.kind = count->edges == 1 ? SHARP_DART : SHARP_SMOOTH;
    return made;
}

/// The values of sharpness that reach 0 in this level: their sum and number.
typedef struct fading_sum
{
    double sum;
    unsigned count;
} fading_sum;

static void fade(fading_sum *fading, double sharpness)
{
    if (sharpness > 0 && !(sharpness_after_level(sharpness) > 0))
    {
        fading->sum += sharpness;
        fading->count++;
    }
}

/// Count one edge around a vertex, on this level and the next.
static void count_edge(double sharpness, uint32_t end, sharp_count *now, sharp_count *after, fading_sum *fading)
{
    if (sharpness > 0)
        count_end(now, end);
    if (sharpness_after_level(sharpness) > 0)
        count_end(after, end);
    fade(fading, sharpness);
}

void sharpness_around(const mesh_level *level, uint32_t vertex, sharp_vertex *now, sharp_vertex *after, double *fading)
{
    const bat_mesh_connectivity *links = level->links;
    const double *edges = level->edge_sharpness;
    sharp_count count_now = {0}, count_after = {0};
    fading_sum faded = {0};
    uint32_t first = links->first[vertex], h = first, last = first;
    do
    {
        double sharpness = mesh_at_boundary(links, h) ? BAT_MESH_SHARP : edges != NULL ? edges[links->edge[h]] : 0;
        count_edge(sharpness, mesh_end(level->faces, h), &count_now, &count_after, &faded);
        last = h;
        h = bat_mesh_next_around(links, h);
    } while (h != BAT_MESH_NONE && h != first);
    if (h == BAT_MESH_NONE)
        count_edge(BAT_MESH_SHARP, mesh_opposite(level->faces, last), &count_now, &count_after, &faded);
    double own = level->vertex_sharpness != NULL && vertex < level->coarse_count ? level->vertex_sharpness[vertex] : 0;
    fade(&faded, own);
    *now = kind_of(&count_now, own);
    if (after == NULL)
        return;
    *after = kind_of(&count_after, sharpness_after_level(own));
    *fading = faded.count > 0 ? fmin(faded.sum / faded.count, 1) : 1;
}
