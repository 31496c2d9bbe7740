#include "base/error.h"
#include "mesh/check.h"
#include "mesh/decimate/collapse_error.h"
#include "mesh/decimate/map.h"
#include "mesh/labels.h"
#include "mesh/refine/level.h"

/// @file
/// Images of midpoint subdivisions under a decimation map, and the transfer of channels and texture.

// Transfer of texture coordinates through a decimation map, with seams.

/// The midpoint subdivision of a mesh, as points of that mesh, in the numbering of batten/mesh_refine.h.
typedef struct midpoint_mesh
{
    split_mesh own; ///< beyond level 0
    const uint32_t *faces;
    bat_mesh_point *points; ///< for each vertex
    size_t levels, face_count, vertex_count;
} midpoint_mesh;

enum
{
    /// Samples of a face across a seam: 5 rows of 1 to 5.
    ROWS = 5,
    SAMPLES = ROWS * (ROWS + 1) / 2
};

/// Points with a smaller barycentric coordinate lie on the opposite edge.
static const double ON_EDGE = 1e-9;
/// A seam separates two points whose texture coordinates differ by more than this factor times their distance times the
/// local scale of the texture.
static const double JUMP = 3;
/// Regularization of the affine fit towards a constant, where the samples do not determine it.
static const double DAMPING = 1e-4;

/// A point of the fine mesh and its texture coordinate.
typedef struct texture_point
{
    double position[3], texture[2];
    double scale; ///< the ratio of lengths in the texture to lengths in space
} texture_point;

/// The state of a transfer.
typedef struct texture_transfer
{
    const bat_mesh_map *map;
    const bat_mesh *fine;
    const bat_mesh_point *images;
    bat_mesh_connectivity connectivity; ///< of the fine mesh
    uint32_t *first;                    ///< for each vertex of the result: its first texture coordinate, or MAP_NONE
    uint32_t *next;                     ///< for each texture coordinate: another one of the same vertex, or MAP_NONE
    double (*texture)[2];
    uint32_t *faces;
    uint32_t count;
} texture_transfer;

/// Allocate the arrays, those of the texture as parts of `refined`.
static bat_status allocate_texture(const midpoint_mesh *split, texture_transfer *all, bat_mesh *refined, bat_error *error)
{
    size_t max_count = 3 * split->face_count;
    all->first = memory_array(split->vertex_count, sizeof *all->first);
    all->next = memory_array(max_count, sizeof *all->next);
    all->texture = memory_array(max_count, sizeof *all->texture);
    all->faces = memory_array(max_count, sizeof *all->faces);
    refined->texture = (double *)all->texture;
    refined->texture_faces = all->faces;
    if (all->first == NULL || all->next == NULL || all->texture == NULL || all->faces == NULL)
        return error_memory(error, max_count * sizeof *all->texture);
    memset(all->first, 0xff, split->vertex_count * sizeof *all->first);
    return BAT_OK;
}

/// The texture coordinate at a point of a face.
static texture_point texture_at(const bat_mesh *mesh, uint32_t face, const double *barycentric)
{
    texture_point point = {.scale = 0};
    const double *position[3], *texture[3];
    for (size_t c = 0; c < 3; c++)
    {
        position[c] = mesh->positions + 3 * (size_t)mesh->faces[3 * (size_t)face + c];
        texture[c] = mesh->texture + 2 * (size_t)mesh->texture_faces[3 * (size_t)face + c];
        vector_add(3, barycentric[c], position[c], point.position);
        vector_add(2, barycentric[c], texture[c], point.texture);
    }
    for (size_t c = 0; c < 3; c++)
    {
        double length = vector_distance(3, position[c], position[(c + 1) % 3]);
        if (length > 0)
            point.scale = fmax(point.scale, vector_distance(2, texture[c], texture[(c + 1) % 3]) / length);
    }
    return point;
}

/// Whether no seam separates two points.
static bool is_continuous(const texture_point *a, const texture_point *b)
{
    return vector_distance(2, a->texture, b->texture) <=
           JUMP * fmax(a->scale, b->scale) * vector_distance(3, a->position, b->position) + ON_EDGE;
}

/// The barycentric coordinates of a point in another face that contains it. False when it does not.
static bool barycentric_in(const bat_mesh *mesh, const bat_mesh_point *point, uint32_t face, double *barycentric)
{
    double sum = 0;
    for (size_t c = 0; c < 3; c++)
    {
        barycentric[c] = 0;
        for (size_t k = 0; k < 3; k++)
            if (mesh->faces[3 * (size_t)face + c] == mesh->faces[3 * (size_t)point->face + k])
                barycentric[c] = point->barycentric[k];
        sum += barycentric[c];
    }
    return sum >= 1 - 2 * ON_EDGE;
}

/// The texture coordinate at a point. Where several faces meet, the one nearest to `wanted`.
static texture_point texture_near(const texture_transfer *all, const bat_mesh_point *point, const double *wanted)
{
    const double *b = point->barycentric;
    texture_point best = texture_at(all->fine, point->face, b);
    if (fmin(b[0], fmin(b[1], b[2])) > ON_EDGE)
        return best;
    uint32_t corner = b[0] >= b[1] && b[0] >= b[2] ? 0 : b[1] >= b[2] ? 1 : 2;
    uint32_t first = all->connectivity.first[all->fine->faces[3 * (size_t)point->face + corner]], h = first;
    do
    {
        double barycentric[3];
        if (barycentric_in(all->fine, point, h / 3, barycentric))
        {
            texture_point other = texture_at(all->fine, h / 3, barycentric);
            if (vector_distance(2, other.texture, wanted) < vector_distance(2, best.texture, wanted))
                best = other;
        }
        h = bat_mesh_next_around(&all->connectivity, h);
    } while (h != BAT_MESH_NONE && h != first);
    return best;
}

/// The texture coordinates at the images of points of a face of the result, given by their weights of its corners.
static bat_status texture_at_images(const texture_transfer *all, const double (*corners)[3], uint32_t coarse_face,
                                    size_t count, const double (*shares)[3], texture_point *found, bat_error *error)
{
    bat_mesh_point points[SAMPLES];
    for (size_t i = 0; i < count; i++)
    {
        points[i] = (bat_mesh_point){coarse_face, {0}};
        for (size_t c = 0; c < 9; c++)
            points[i].barycentric[c % 3] += shares[i][c / 3] * corners[c / 3][c % 3];
    }
    bat_status status = bat_mesh_map_to_fine(all->map, points, count, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        found[i] = texture_at(all->fine, points[i].face, points[i].barycentric);
    return status;
}

/// The sample that no seam separates from the most other samples.
static size_t max_connected(const texture_point *samples)
{
    size_t best = 0, best_count = 0;
    for (size_t i = 0; i < SAMPLES; i++)
    {
        size_t count = 0;
        for (size_t k = 0; k < SAMPLES; k++)
            count += is_continuous(&samples[i], &samples[k]);
        if (count > best_count)
        {
            best = i;
            best_count = count;
        }
    }
    return best;
}

/// Fit an affine map to the samples on the side of `centre`; its values at the corners.
static void fit(const texture_point *samples, const double (*shares)[3], size_t centre, double (*fitted)[2])
{
    double right[3][2] = {{0}}, sum[2] = {0}, count = 0;
    quadric matrix = {0};
    for (size_t i = 0; i < SAMPLES; i++)
    {
        if (!is_continuous(&samples[centre], &samples[i]))
            continue;
        quadric_add_plane(&matrix, shares[i], 1);
        count++;
        for (size_t k = 0; k < 6; k++)
            right[k / 2][k % 2] += shares[i][k / 2] * samples[i].texture[k % 2];
        vector_add(2, 1, samples[i].texture, sum);
    }
    for (size_t k = 0; k < 2; k++)
    {
        double values[3] = {0}, pull = DAMPING * sum[k];
        matrix.x = -right[0][k] - pull;
        matrix.y = -right[1][k] - pull;
        matrix.z = -right[2][k] - pull;
        (void)quadric_minimize(&matrix, DAMPING * count, values);
        for (size_t c = 0; c < 3; c++)
            fitted[c][k] = values[c];
    }
}

/// The number of a vertex's texture coordinate, which is added if it is new.
static uint32_t number_of(texture_transfer *all, uint32_t vertex, const double *texture)
{
    uint32_t number = all->first[vertex];
    while (number != MAP_NONE && (all->texture[number][0] != texture[0] || all->texture[number][1] != texture[1]))
        number = all->next[number];
    if (number != MAP_NONE)
        return number;
    number = all->count++;
    all->next[number] = all->first[vertex];
    all->first[vertex] = number;
    memcpy(all->texture[number], texture, sizeof all->texture[number]);
    return number;
}

/// Assign texture coordinates to a face, on the side of `centre`. Corners beyond a seam get the value in `fitted`. Without
/// `fitted` the function returns false if there are any.
static bool assign_side(texture_transfer *all, const uint32_t *vertices, const texture_point *centre,
                        const double (*fitted)[2], uint32_t *numbers)
{
    double texture[3][2];
    for (int c = 0; c < 3; c++)
    {
        texture_point corner = texture_near(all, &all->images[vertices[c]], fitted != NULL ? fitted[c] : centre->texture);
        bool inside = is_continuous(centre, &corner);
        if (!inside && fitted == NULL)
            return false;
        memcpy(texture[c], inside ? corner.texture : fitted[c], sizeof texture[c]);
    }
    for (int c = 0; c < 3; c++)
        numbers[c] = number_of(all, vertices[c], texture[c]);
    return true;
}

/// The barycentric coordinates of a face's corners in the coarse face that it is a part of.
static void corners_of(const midpoint_mesh *split, size_t face, double corners[3][3])
{
    static const double WHOLE[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    memcpy(corners, WHOLE, sizeof WHOLE);
    for (size_t level = split->levels; level-- > 0;)
    {
        size_t child = face >> 2 * level & 3;
        double middle[3][3];
        for (size_t c = 0; c < 3; c++)
            for (size_t k = 0; k < 3; k++)
                middle[c][k] = (corners[c][k] + corners[(c + 1) % 3][k]) / 2;
        if (child < 3)
        {
            memmove(corners[0], corners[child], sizeof corners[0]);
            memcpy(corners[1], middle[child], sizeof corners[1]);
            memcpy(corners[2], middle[(child + 2) % 3], sizeof corners[2]);
        }
        else
            memcpy(corners, middle, sizeof middle);
    }
}

static bat_status transfer_face(texture_transfer *all, const midpoint_mesh *split, size_t face, bat_error *error)
{
    static const double MIDDLE[1][3] = {{1 / 3.0, 1 / 3.0, 1 / 3.0}};
    const uint32_t *vertices = split->faces + 3 * face;
    uint32_t coarse_face = (uint32_t)(face >> 2 * split->levels), *numbers = all->faces + 3 * face;
    double made[3][3], shares[SAMPLES][3], fitted[3][2];
    const double(*corners)[3] = (const double(*)[3])made;
    texture_point samples[SAMPLES];
    corners_of(split, face, made);
    bat_status status = texture_at_images(all, corners, coarse_face, 1, MIDDLE, samples, error);
    if (status != BAT_OK || assign_side(all, vertices, &samples[0], NULL, numbers))
        return status;
    size_t count = 0;
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; i + j < ROWS; j++, count++)
        {
            shares[count][0] = (i + 1 / 3.0) / ROWS;
            shares[count][1] = (j + 1 / 3.0) / ROWS;
            shares[count][2] = 1 - shares[count][0] - shares[count][1];
        }
    status = texture_at_images(all, corners, coarse_face, SAMPLES, (const double(*)[3])shares, samples, error);
    if (status != BAT_OK)
        return status;
    size_t centre = max_connected(samples);
    fit(samples, (const double(*)[3])shares, centre, fitted);
    (void)assign_side(all, vertices, &samples[centre], (const double(*)[2])fitted, numbers);
    return BAT_OK;
}

/// Set the texture coordinates of `refined`, which has none, from the fine mesh. `split` is the subdivided coarse mesh, and
/// its points are the images of its vertices on the fine mesh.
///
/// A corner gets the texture coordinate at its image; at a seam, the one on its face's side. A face across a seam belongs to
/// the side with most of its samples. Its corners on the other side get the values of an affine map fitted to these samples.
/// @return BAT_OK, BAT_NO_MEMORY, or a failure of bat_mesh_connect()
static bat_status map_texture_transfer(const bat_mesh_map *map, const bat_mesh *fine, const midpoint_mesh *split,
                                       bat_mesh *refined, bat_error *error)
{
    texture_transfer all = {.map = map, .fine = fine, .images = split->points};
    bat_status status = bat_mesh_connect(fine, &all.connectivity, error);
    if (status == BAT_OK)
        status = allocate_texture(split, &all, refined, error);
    for (size_t f = 0; f < split->face_count && status == BAT_OK; f++)
        status = transfer_face(&all, split, f, error);
    refined->texture_count = all.count;
    bat_mesh_connectivity_free(&all.connectivity);
    free(all.first);
    free(all.next);
    return status;
}

static void midpoint_mesh_free(midpoint_mesh *mesh)
{
    split_mesh_free(&mesh->own);
    free(mesh->points);
    *mesh = (midpoint_mesh){0};
}

static bat_status set_points(midpoint_mesh *mesh, bat_error *error)
{
    if (array_make(&mesh->points, mesh->vertex_count, sizeof *mesh->points, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        mesh->points[v].face = BAT_MESH_NONE;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        double corners[3][3];
        corners_of(mesh, f, corners);
        for (size_t c = 0; c < 3; c++)
        {
            bat_mesh_point *point = &mesh->points[mesh->faces[3 * f + c]];
            point->face = (uint32_t)(f >> 2 * mesh->levels);
            memcpy(point->barycentric, corners[c], sizeof point->barycentric);
        }
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->points[v].face == BAT_MESH_NONE)
            return error_set(error, BAT_INVALID_POINT, v, 0, "vertex %zu has no face", v);
    return BAT_OK;
}

/// Subdivide a mesh `levels` times.
/// @return as bat_mesh_midpoints()
static bat_status midpoint_mesh_make(const bat_mesh *coarse, size_t levels, midpoint_mesh *made, bat_error *error)
{
    midpoint_mesh mesh = {
        .faces = coarse->faces, .levels = levels, .face_count = coarse->face_count, .vertex_count = coarse->vertex_count};
    bat_status status = mesh_check_triangles(coarse, error);
    if (status == BAT_OK && levels > 0)
        status = bat_mesh_connect(coarse, &mesh.own.links, error);
    for (size_t level = 0; level < levels && status == BAT_OK; level++)
    {
        status = split_mesh_make(mesh.faces, &mesh.own.links, 1, &mesh.own, error);
        mesh.faces = mesh.own.faces;
        mesh.face_count = mesh.own.links.face_count;
        mesh.vertex_count = mesh.own.links.vertex_count;
    }
    if (status == BAT_OK)
        status = set_points(&mesh, error);
    if (status == BAT_OK)
        *made = mesh;
    else
        midpoint_mesh_free(&mesh);
    return status;
}

bat_status bat_mesh_midpoints(const bat_mesh *coarse, size_t levels, bat_mesh_point **points, size_t *count,
                              bat_error *error)
{
    midpoint_mesh mesh;
    bat_status status = midpoint_mesh_make(coarse, levels, &mesh, error);
    if (status != BAT_OK)
        return status;
    *points = mesh.points;
    *count = mesh.vertex_count;
    mesh.points = NULL;
    midpoint_mesh_free(&mesh);
    return BAT_OK;
}

/// The channels at the images, in a mesh that holds nothing else.
static bat_status set_channels(const bat_mesh *fine, const bat_mesh_point *images, size_t count, bat_mesh *signals,
                               bat_error *error)
{
    size_t width = fine->channel_count;
    if (width == 0)
        return BAT_OK;
    bat_status status = channels_make(fine, count, signals, error);
    for (size_t i = 0; i < width * count && status == BAT_OK; i++)
        signals->channels[i] = map_value_at(fine, fine->channels + i % width, width, &images[i / width]);
    return status;
}

bat_status bat_mesh_map_transfer(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, size_t levels,
                                 bat_mesh *refined, bat_error *error)
{
    midpoint_mesh split = {0};
    bat_mesh signals = {0};
    bat_status status = map_check(map, fine, coarse, error);
    if (status == BAT_OK)
        status = midpoint_mesh_make(coarse, levels, &split, error);
    if (status == BAT_OK) // the points become their images
        status = bat_mesh_map_to_fine(map, split.points, split.vertex_count, error);
    if (status == BAT_OK && (refined->vertex_count != split.vertex_count || refined->face_count != split.face_count))
        status = ERROR_ARGUMENT(error, "the mesh is not the coarse one subdivided %zu times: it has %zu vertices, not %zu",
                                levels, refined->vertex_count, split.vertex_count);
    if (status == BAT_OK)
        status = set_channels(fine, split.points, split.vertex_count, &signals, error);
    if (status == BAT_OK && fine->texture != NULL)
        status = map_texture_transfer(map, fine, &split, &signals, error);
    if (status == BAT_OK)
    {
        mesh_swap_texture(&signals, refined);
        mesh_swap_channels(&signals, refined);
    }
    bat_mesh_free(&signals);
    midpoint_mesh_free(&split);
    return status;
}
