#include "batten/mesh.h"

#include "base/choice.h"
#include "base/error.h"
#include "linalg/vector.h"
#include "mesh/check.h"

#include <math.h>
#include <string.h>

static const bat_choice NORMALS[] = {
    CHOICE("none", "no normals", BAT_MESH_NORMALS_NONE),
    CHOICE("angle", "weighted by the faces' angles", BAT_MESH_NORMALS_ANGLE),
    CHOICE("area", "weighted by the faces' areas", BAT_MESH_NORMALS_AREA),
};
const bat_family bat_mesh_normals_family = FAMILY("kind of normals", NORMALS);

/// @file
/// Vertex normals as weighted sums of face normals: Thürmer and Wüthrich, "Computing vertex normals from polygonal facets"
/// (1998).

/// A power of two by which no product of coordinates overflows.
static double scale_of(const bat_mesh *mesh)
{
    double largest = 0;
    int exponent;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        largest = fmax(largest, fabs(mesh->positions[i]));
    (void)frexp(largest, &exponent);
    return largest > 0 ? ldexp(1.0, exponent < -1000 ? 1000 : -exponent) : 1.0;
}

/// Add the normal of a face to its three vertices.
static void add_face(const bat_mesh *mesh, size_t face, double scale, bat_mesh_normals weights, double *normals)
{
    const uint32_t *corner = mesh->faces + 3 * face;
    double edges[3][3], normal[3]; // edge c leads from corner c to the next one
    for (int c = 0; c < 3; c++)
        for (size_t k = 0; k < 3; k++)
            edges[c][k] = mesh->positions[3 * (size_t)corner[(c + 1) % 3] + k] * scale -
                          mesh->positions[3 * (size_t)corner[c] + k] * scale;
    vector3_cross(edges[0], edges[1], normal);
    double area = sqrt(vector3_dot(normal, normal)); // twice the area, also the product of two edges and the sine between
    if (!(area > 0))
        return;
    for (int c = 0; c < 3; c++)
    {
        double angle = atan2(area, -vector3_dot(edges[c], edges[(c + 2) % 3]));
        double weight = weights == BAT_MESH_NORMALS_AREA ? 1 : angle / area;
        for (size_t k = 0; k < 3; k++)
            normals[3 * (size_t)corner[c] + k] += weight * normal[k];
    }
}

bat_status bat_mesh_vertex_normals(const bat_mesh *mesh, bat_mesh_normals weights, double *normals, bat_error *error)
{
    if (weights != BAT_MESH_NORMALS_ANGLE && weights != BAT_MESH_NORMALS_AREA)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "normals need weights by angle or area");
    bat_status status = mesh_check_triangles(mesh, error);
    if (status != BAT_OK)
        return status;
    double scale = scale_of(mesh);
    memset(normals, 0, 3 * mesh->vertex_count * sizeof *normals);
    for (size_t f = 0; f < mesh->face_count; f++)
        add_face(mesh, f, scale, weights, normals);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        (void)vector3_normalize(normals + 3 * v);
    return BAT_OK;
}
