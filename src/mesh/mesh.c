#include "base/choice.h"
#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"
#include "mesh/check.h"
#include "mesh/labels.h"
#include "mesh/measure/closest.h"
#include "mesh/sides.h"

/// @file
/// Copies and checks of a mesh's arrays; connectivity is checked by bat_mesh_connect().

void bat_mesh_free(bat_mesh *mesh)
{
    free(mesh->positions);
    free(mesh->faces);
    free(mesh->offsets);
    free(mesh->texture);
    free(mesh->texture_faces);
    free(mesh->channels);
    for (size_t i = 0; i < mesh->channel_count && mesh->channel_names != NULL; i++)
        free(mesh->channel_names[i]);
    free(mesh->channel_names);
    free(mesh->creases);
    free(mesh->corners);
    mesh_labels_free(mesh);
    *mesh = (bat_mesh){0};
}

bool mesh_copy_array(const void *from, size_t count, size_t size, void **to)
{
    *to = NULL;
    if (from == NULL || count == 0)
        return true;
    *to = memory_array(count, size);
    if (*to != NULL)
        memcpy(*to, from, count * size);
    return *to != NULL;
}

void mesh_swap_texture(bat_mesh *a, bat_mesh *b)
{
    SWAP(a->texture, b->texture);
    SWAP(a->texture_faces, b->texture_faces);
    SWAP(a->texture_count, b->texture_count);
}

void mesh_swap_channels(bat_mesh *a, bat_mesh *b)
{
    SWAP(a->channels, b->channels);
    SWAP(a->channel_names, b->channel_names);
    SWAP(a->channel_count, b->channel_count);
}

void mesh_move_rows(double *values, size_t rows, size_t dim, const uint32_t *numbers)
{
    uint32_t count = 0;
    for (size_t i = 0; values != NULL && i < rows; i++)
        if (numbers[i] == count)
            memmove(values + dim * count++, values + dim * i, dim * sizeof *values);
}

void mesh_renumber(bat_mesh *mesh, size_t count, const uint32_t *numbers)
{
    size_t creases = 0, corners = 0;
    mesh_move_rows(mesh->positions, mesh->vertex_count, 3, numbers);
    mesh_move_rows(mesh->channels, mesh->vertex_count, mesh->channel_count, numbers);
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        bat_mesh_crease crease = mesh->creases[i];
        uint32_t a = numbers[crease.a], b = numbers[crease.b];
        if (a != BAT_MESH_NONE && b != BAT_MESH_NONE && a != b)
            mesh->creases[creases++] = (bat_mesh_crease){a, b, crease.sharpness};
    }
    for (size_t i = 0; i < mesh->corner_count; i++)
    {
        bat_mesh_corner corner = mesh->corners[i];
        if (numbers[corner.vertex] != BAT_MESH_NONE)
            mesh->corners[corners++] = (bat_mesh_corner){numbers[corner.vertex], corner.sharpness};
    }
    mesh->vertex_count = count;
    mesh->crease_count = creases;
    mesh->corner_count = corners;
}

bat_status bat_mesh_copy(const bat_mesh *mesh, bat_mesh *copy, bat_error *error)
{
    size_t corner_count = mesh_corners_until(mesh, mesh->face_count);
    bat_mesh made = *mesh;
    made.channel_names = NULL;
    mesh_labels_forget(&made);
    bool positions = mesh_copy_array(mesh->positions, mesh->vertex_count, 3 * sizeof(double), (void **)&made.positions);
    bool faces = mesh_copy_array(mesh->faces, corner_count, sizeof(uint32_t), (void **)&made.faces);
    bool offsets = mesh_copy_array(mesh->offsets, mesh->face_count + 1, sizeof(uint32_t), (void **)&made.offsets);
    bool texture = mesh_copy_array(mesh->texture, mesh->texture_count, 2 * sizeof(double), (void **)&made.texture);
    bool texture_faces = mesh_copy_array(mesh->texture_faces, corner_count, sizeof(uint32_t), (void **)&made.texture_faces);
    bool channels =
        mesh_copy_array(mesh->channels, mesh->vertex_count, mesh->channel_count * sizeof(double), (void **)&made.channels);
    bool creases = mesh_copy_array(mesh->creases, mesh->crease_count, sizeof *mesh->creases, (void **)&made.creases);
    bool corners = mesh_copy_array(mesh->corners, mesh->corner_count, sizeof *mesh->corners, (void **)&made.corners);
    bool names = channels_set_names(&made, (const char *const *)mesh->channel_names, mesh->channel_count);
    bat_status status = BAT_OK;
    if (!positions || !faces || !offsets || !texture || !texture_faces || !channels || !creases || !corners || !names)
        status = error_memory(error, mesh->vertex_count * 3 * sizeof(double));
    if (status == BAT_OK)
        status = mesh_labels_carry(mesh, NULL, 1, &made, error);
    if (status == BAT_OK)
        *copy = made;
    else
        bat_mesh_free(&made);
    return status;
}

static bat_status check_vertices(const bat_mesh *mesh, bat_error *error)
{
    for (size_t i = 0; i < mesh->vertex_count * 3; i++)
        if (!isfinite(mesh->positions[i]))
            return error_set(error, BAT_INVALID_POINT, i / 3, 0, "vertex %zu is not finite", i / 3);
    for (size_t i = 0; i < mesh->vertex_count * mesh->channel_count; i++)
        if (!isfinite(mesh->channels[i]))
            return error_set(error, BAT_INVALID_POINT, i / mesh->channel_count, 0,
                             "vertex %zu carries a value that is not finite", i / mesh->channel_count);
    for (size_t i = 0; i < mesh->texture_count * 2; i++)
        if (!isfinite(mesh->texture[i]))
            return error_set(error, BAT_INVALID_POINT, i / 2, 0, "texture coordinate %zu is not finite", i / 2);
    return BAT_OK;
}

static bat_status check_counts(const bat_mesh *mesh, bat_error *error)
{
    if (mesh->face_count == 0)
        return ERROR_ARGUMENT(error, "the mesh has no faces");
    if (mesh->face_count > BAT_MESH_MAX_FACES || mesh->vertex_count >= BAT_MESH_NONE)
        return ERROR_TOO_LARGE(error, "the mesh has more than %zu faces or %zu vertices", BAT_MESH_MAX_FACES,
                               (size_t)BAT_MESH_NONE);
    return BAT_OK;
}

static bat_status check_faces(const bat_mesh *mesh, bat_error *error)
{
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *corner = mesh->faces + 3 * f;
        for (int c = 0; c < 3; c++)
            if (corner[c] >= mesh->vertex_count)
                return error_set(error, BAT_INVALID_POINT, f, 0, "face %zu names vertex %u, but there are %zu", f, corner[c],
                                 mesh->vertex_count);
    }
    for (size_t i = 0; mesh->texture_faces != NULL && i < mesh->face_count * 3; i++)
        if (mesh->texture_faces[i] >= mesh->texture_count)
            return error_set(error, BAT_INVALID_POINT, i / 3, 0, "face %zu names texture coordinate %u, but there are %zu",
                             i / 3, mesh->texture_faces[i], mesh->texture_count);
    return BAT_OK;
}

static bat_status check_marks(const bat_mesh *mesh, bat_error *error)
{
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        const bat_mesh_crease *crease = &mesh->creases[i];
        if (crease->a >= mesh->vertex_count || crease->b >= mesh->vertex_count || crease->a == crease->b)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "crease %zu joins vertices %u and %u, which are not an edge",
                             i, crease->a, crease->b);
        if (!(crease->sharpness >= 0))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "crease %zu has sharpness %g", i, crease->sharpness);
    }
    for (size_t i = 0; i < mesh->corner_count; i++)
        if (mesh->corners[i].vertex >= mesh->vertex_count || !(mesh->corners[i].sharpness >= 0))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "corner %zu names vertex %u with sharpness %g", i,
                             mesh->corners[i].vertex, mesh->corners[i].sharpness);
    return BAT_OK;
}

/// Check all but the faces: finite numbers, labels that exist, and creases and corners of existing vertices.
static bat_status check_data(const bat_mesh *mesh, bat_error *error)
{
    bat_status status = check_vertices(mesh, error);
    for (size_t f = 0; mesh->face_labels != NULL && f < mesh->face_count && status == BAT_OK; f++)
        if (mesh->face_labels[f] >= mesh->label_count)
            status = error_set(error, BAT_INVALID_POINT, f, 0, "face %zu has label %u, but there are %zu", f,
                               mesh->face_labels[f], mesh->label_count);
    return status == BAT_OK ? check_marks(mesh, error) : status;
}

bat_status mesh_check_except_degenerate(const bat_mesh *mesh, bat_error *error)
{
    bat_status status = BAT_OK;
    if (mesh->offsets != NULL)
        status = ERROR_UNSUPPORTED(error, 0, "the faces are polygons, but must be triangles");
    if (status == BAT_OK)
        status = check_counts(mesh, error);
    if (status == BAT_OK)
        status = check_faces(mesh, error);
    return status == BAT_OK ? check_data(mesh, error) : status;
}

bat_status mesh_check_triangles(const bat_mesh *mesh, bat_error *error)
{
    bat_status status = mesh_check_except_degenerate(mesh, error);
    for (size_t f = 0; f < mesh->face_count && status == BAT_OK; f++)
    {
        const uint32_t *corner = mesh->faces + 3 * f;
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            status = error_set(error, BAT_INVALID_POINT, f, 0, "face %zu has vertex %u twice", f,
                               corner[0] == corner[1] ? corner[0] : corner[2]);
    }
    return status;
}

bat_status mesh_check_coordinates(const bat_mesh *mesh, double most, bat_error *error)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        if (fabs(mesh->positions[i]) > most)
            return error_set(error, BAT_INVALID_POINT, i / 3, 0, "vertex %zu is too far from the origin", i / 3);
    return BAT_OK;
}

static bat_status check_offsets(const bat_mesh *mesh, bat_error *error)
{
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        if (mesh->offsets[f + 1] < mesh->offsets[f] || mesh->offsets[0] != 0)
            return error_set(error, BAT_INVALID_ARGUMENT, f, 0, "the offsets of face %zu decrease or do not begin with 0",
                             f);
        uint32_t size = mesh->offsets[f + 1] - mesh->offsets[f];
        if (size < 3)
            return error_set(error, BAT_INVALID_POINT, f, 0, "face %zu has %u corners, fewer than 3", f, size);
    }
    return BAT_OK;
}

/// Check that a face's corners exist and differ. `seen` holds for each vertex the last face that had it, plus 1.
static bat_status check_polygon(const bat_mesh *mesh, uint32_t face, uint32_t *seen, bat_error *error)
{
    for (uint32_t i = mesh->offsets[face]; i < mesh->offsets[face + 1]; i++)
    {
        uint32_t vertex = mesh->faces[i];
        if (vertex >= mesh->vertex_count)
            return error_set(error, BAT_INVALID_POINT, face, 0, "face %u names vertex %u, but there are %zu", face, vertex,
                             mesh->vertex_count);
        if (mesh->texture_faces != NULL && mesh->texture_faces[i] >= mesh->texture_count)
            return error_set(error, BAT_INVALID_POINT, face, 0, "face %u names texture coordinate %u, but there are %zu",
                             face, mesh->texture_faces[i], mesh->texture_count);
        if (seen[vertex] == face + 1)
            return error_remedy(error,
                                error_set(error, BAT_INVALID_POINT, face, 0, "face %u has vertex %u twice", face, vertex),
                                "repair", "drops the face");
        seen[vertex] = face + 1;
    }
    return BAT_OK;
}

bat_status bat_mesh_check(const bat_mesh *mesh, bat_error *error)
{
    if (mesh->offsets == NULL)
        return mesh_check_triangles(mesh, error);
    bat_status status = check_counts(mesh, error);
    if (status == BAT_OK)
        status = check_offsets(mesh, error);
    uint32_t *seen = NULL;
    if (status == BAT_OK)
        status = array_zeros(&seen, mesh->vertex_count, sizeof *seen, error);
    for (uint32_t f = 0; f < mesh->face_count && status == BAT_OK; f++)
        status = check_polygon(mesh, f, seen, error);
    free(seen);
    return status == BAT_OK ? check_data(mesh, error) : status;
}

// The tables of the rules that a mesh can carry.

static const bat_choice BOUNDARIES[] = {
    CHOICE("auto", "as the file says, else edges", BAT_MESH_BOUNDARY_AUTO),
    CHOICE("edges", "a smooth curve", BAT_MESH_BOUNDARY_EDGES),
    CHOICE("corners", "a smooth curve with sharp corners at vertices of one face", BAT_MESH_BOUNDARY_CORNERS),
    CHOICE("none", "the surface ends one face before it", BAT_MESH_BOUNDARY_NONE),
};
const bat_family bat_mesh_boundary_family = FAMILY("boundary rule", BOUNDARIES);

static const bat_choice CREASINGS[] = {
    CHOICE("auto", "as the file says, else uniform", BAT_MESH_CREASING_AUTO),
    CHOICE("uniform", "sharpness decreases by 1 a level", BAT_MESH_CREASING_UNIFORM),
    CHOICE("chaikin", "sharpness is also smoothed along creases", BAT_MESH_CREASING_CHAIKIN),
};
const bat_family bat_mesh_creasing_family = FAMILY("creasing rule", CREASINGS);

static const bat_choice LINEARS[] = {
    CHOICE("auto", "as the file says, else all", BAT_MESH_LINEAR_AUTO),
    CHOICE("all", "texture is linear everywhere", BAT_MESH_LINEAR_ALL),
    CHOICE("none", "texture and its seams are smooth", BAT_MESH_LINEAR_NONE),
    CHOICE("corners", "corners of one face stay", BAT_MESH_LINEAR_CORNERS),
    CHOICE("corners-plus1", "and points where more than two seams meet", BAT_MESH_LINEAR_CORNERS_PLUS1),
    CHOICE("corners-plus2", "and ends of seams and sides beside a corner", BAT_MESH_LINEAR_CORNERS_PLUS2),
    CHOICE("boundaries", "seams and boundaries are linear", BAT_MESH_LINEAR_BOUNDARIES),
};
const bat_family bat_mesh_linear_family = FAMILY("texture rule", LINEARS);

static const bat_choice NORMALS[] = {
    CHOICE("none", "no normals", BAT_MESH_NORMALS_NONE),
    CHOICE("angle", "weighted by the faces' angles", BAT_MESH_NORMALS_ANGLE),
    CHOICE("area", "weighted by the faces' areas", BAT_MESH_NORMALS_AREA),
};
const bat_family bat_mesh_normals_family = FAMILY("kind of normals", NORMALS);

// Vertex normals: Thürmer and Wüthrich, "Computing vertex normals from polygonal facets" (1998).

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
        vector_add(3, weight, normal, normals + 3 * (size_t)corner[c]);
    }
}

bat_status bat_mesh_vertex_normals(const bat_mesh *mesh, bat_mesh_normals weights, double *normals, bat_error *error)
{
    if (weights != BAT_MESH_NORMALS_ANGLE && weights != BAT_MESH_NORMALS_AREA)
        return ERROR_ARGUMENT(error, "normals need weights by angle or area");
    bat_status status = mesh_check_triangles(mesh, error);
    if (status != BAT_OK)
        return status;
    // A power of two, by which no product of coordinates overflows.
    double scale = closest_scale(closest_largest(mesh->positions, 3 * mesh->vertex_count, 0));
    memset(normals, 0, 3 * mesh->vertex_count * sizeof *normals);
    for (size_t f = 0; f < mesh->face_count; f++)
        add_face(mesh, f, scale, weights, normals);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        (void)vector3_normalize(normals + 3 * v);
    return BAT_OK;
}
