#include "draw/mesh/shade.h"

#include "base/threads.h"
#include "linalg/vector.h"

/// @file
/// Angle-limited vertex normals of non-manifold meshes.

/// The cosine of 40 degrees.
#define SMOOTH_COSINE 0.766044443118978

/// The faces at each vertex: faces[begin[v]], …, faces[begin[v + 1] - 1].
typedef struct fan_list
{
    memory_pool pool;
    size_t *begin;
    uint32_t *faces;
} fan_list;

static bat_status fans_make(const bat_mesh *mesh, fan_list *fans, bat_error *error)
{
    fans->begin = memory_pool_zeros(&fans->pool, mesh->vertex_count + 2, sizeof *fans->begin);
    fans->faces = memory_pool_array(&fans->pool, 3 * mesh->face_count, sizeof *fans->faces);
    if (fans->pool.missing > 0)
        return memory_pool_check(&fans->pool, error);
    // Counts are stored two places ahead and sums one place ahead. Filling the list then shifts the sums into place.
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        fans->begin[mesh->faces[i] + 2]++;
    for (size_t v = 2; v <= mesh->vertex_count; v++)
        fans->begin[v] += fans->begin[v - 1];
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        fans->faces[fans->begin[mesh->faces[i] + 1]++] = (uint32_t)(i / 3);
    return BAT_OK;
}

static void set_unit(const double normal[3], float unit[3])
{
    double length = sqrt(vector3_dot(normal, normal));
    for (int c = 0; c < 3; c++)
        unit[c] = length > 0 ? (float)(normal[c] / length) : 0;
}

/// The mean normal of the faces that continue smoothly at a corner.
static void corner_normal(const bat_mesh *mesh, const fan_list *fans, uint32_t vertex, const double own[3], float normal[3])
{
    double sum[3] = {0, 0, 0}, size = vector3_dot(own, own);
    for (size_t i = fans->begin[vertex]; i < fans->begin[vertex + 1]; i++)
    {
        double other[3];
        vector3_face(mesh->positions, mesh->faces + 3 * (size_t)fans->faces[i], other);
        if (vector3_dot(own, other) >= SMOOTH_COSINE * sqrt(size * vector3_dot(other, other)))
            vector_add(3, 1, other, sum);
    }
    set_unit(sum, normal);
}

static bool has_other_face(const bat_mesh *mesh, const fan_list *fans, size_t face, uint32_t from, uint32_t to)
{
    for (size_t i = fans->begin[from]; i < fans->begin[from + 1]; i++)
    {
        const uint32_t *corner = mesh->faces + 3 * (size_t)fans->faces[i];
        if (fans->faces[i] != face && (corner[0] == to || corner[1] == to || corner[2] == to))
            return true;
    }
    return false;
}

static void describe_face(const bat_mesh *mesh, const fan_list *fans, bool flat, size_t face, mesh_surface *surface)
{
    double own[3];
    vector3_face(mesh->positions, mesh->faces + 3 * face, own);
    const uint32_t *corner = mesh->faces + 3 * face;
    surface->marks[face] = 0;
    for (size_t c = 0; c < 3; c++)
    {
        if (flat)
            set_unit(own, surface->normals[3 * face + c]);
        else
            corner_normal(mesh, fans, corner[c], own, surface->normals[3 * face + c]);
        if (!has_other_face(mesh, fans, face, corner[c], corner[(c + 1) % 3]))
            surface->marks[face] |= (unsigned char)(1u << c);
    }
}

/// Whether the corners a and b follow each other in a polygon.
static bool are_neighbours(const uint32_t *corner, size_t count, uint32_t a, uint32_t b)
{
    for (size_t c = 0; c < count; c++)
    {
        uint32_t here = corner[c], next = corner[c + 1 < count ? c + 1 : 0];
        if ((here == a && next == b) || (here == b && next == a))
            return true;
    }
    return false;
}

/// Mark the edges of triangles that lie within polygons, and give flat triangles the mean normal of their polygon.
static void describe_polygons(const bat_mesh *mesh, const bat_mesh *polygons, bool flat, mesh_surface *surface)
{
    size_t face = 0;
    for (size_t p = 0; p < polygons->face_count; p++)
    {
        const uint32_t *corner = polygons->faces + polygons->offsets[p];
        size_t count = polygons->offsets[p + 1] - polygons->offsets[p], end = face + count - 2;
        double sum[3] = {0}, own[3];
        for (size_t f = face; f < end; f++)
        {
            vector3_face(mesh->positions, mesh->faces + 3 * f, own);
            vector_add(3, 1, own, sum);
        }
        for (; face < end; face++)
            for (size_t c = 0; c < 3; c++)
            {
                const uint32_t *own_corner = mesh->faces + 3 * face;
                if (!are_neighbours(corner, count, own_corner[c], own_corner[(c + 1) % 3]))
                    surface->marks[face] |= (unsigned char)(8u << c);
                if (flat)
                    set_unit(sum, surface->normals[3 * face + c]);
            }
    }
}

bat_status mesh_surface_make(const bat_mesh *mesh, const bat_mesh *polygons, bool flat, int threads, mesh_surface *surface,
                             bat_error *error)
{
    fan_list fans = {0};
    *surface = (mesh_surface){0};
    surface->normals = memory_pool_array(&surface->pool, 3 * mesh->face_count, sizeof *surface->normals);
    surface->marks = memory_pool_array(&surface->pool, mesh->face_count, sizeof *surface->marks);
    bat_status status = memory_pool_check(&surface->pool, error);
    if (status == BAT_OK)
        status = fans_make(mesh, &fans, error);
    if (status == BAT_OK)
    {
        int count = threads_for(threads, mesh->face_count / 4096 + 1);
#pragma omp parallel for num_threads(count) schedule(static)
        for (size_t f = 0; f < mesh->face_count; f++)
            describe_face(mesh, &fans, flat, f, surface);
        if (polygons != NULL)
            describe_polygons(mesh, polygons, flat, surface);
    }
    memory_pool_free(&fans.pool);
    return status;
}
