#include "mesh/decimate/map_transfer.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/decimate/quadric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Transfer of texture coordinates through a decimation map, with seams.

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

static void free_transfer(texture_transfer *all)
{
    bat_mesh_connectivity_free(&all->connectivity);
    free(all->first);
    free(all->next);
    free(all->texture);
    free(all->faces);
}

static bat_status allocate(const midpoint_mesh *split, texture_transfer *all, bat_error *error)
{
    size_t max_count = 3 * split->face_count;
    all->first = memory_array(split->vertex_count, sizeof *all->first);
    all->next = memory_array(max_count, sizeof *all->next);
    all->texture = memory_array(max_count, sizeof *all->texture);
    all->faces = memory_array(max_count, sizeof *all->faces);
    if (all->first == NULL || all->next == NULL || all->texture == NULL || all->faces == NULL)
        return error_memory(error, max_count * sizeof *all->texture);
    memset(all->first, 0xff, split->vertex_count * sizeof *all->first);
    return BAT_OK;
}

static double length_of(const double *a, const double *b, size_t dimension)
{
    double square = 0;
    for (size_t k = 0; k < dimension; k++)
        square += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(square);
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
        for (size_t k = 0; k < 3; k++)
            point.position[k] += barycentric[c] * position[c][k];
        for (size_t k = 0; k < 2; k++)
            point.texture[k] += barycentric[c] * texture[c][k];
    }
    for (size_t c = 0; c < 3; c++)
    {
        double length = length_of(position[c], position[(c + 1) % 3], 3);
        if (length > 0)
            point.scale = fmax(point.scale, length_of(texture[c], texture[(c + 1) % 3], 2) / length);
    }
    return point;
}

/// Whether no seam separates two points.
static bool is_continuous(const texture_point *a, const texture_point *b)
{
    return length_of(a->texture, b->texture, 2) <=
           JUMP * fmax(a->scale, b->scale) * length_of(a->position, b->position, 3) + ON_EDGE;
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
            if (length_of(other.texture, wanted, 2) < length_of(best.texture, wanted, 2))
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

static void spread_samples(double (*shares)[3])
{
    size_t count = 0;
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; i + j < ROWS; j++, count++)
        {
            shares[count][0] = (i + 1 / 3.0) / ROWS;
            shares[count][1] = (j + 1 / 3.0) / ROWS;
            shares[count][2] = 1 - shares[count][0] - shares[count][1];
        }
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
        sum[0] += samples[i].texture[0];
        sum[1] += samples[i].texture[1];
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
    all->texture[number][0] = texture[0];
    all->texture[number][1] = texture[1];
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

static bat_status transfer_face(texture_transfer *all, const midpoint_mesh *split, size_t face, size_t levels,
                                bat_error *error)
{
    static const double MIDDLE[1][3] = {{1 / 3.0, 1 / 3.0, 1 / 3.0}};
    const double(*corners)[3] = (const double(*)[3])split->corners[face];
    const uint32_t *vertices = split->faces + 3 * face;
    uint32_t coarse_face = (uint32_t)(face >> 2 * levels), *numbers = all->faces + 3 * face;
    double shares[SAMPLES][3], fitted[3][2];
    texture_point samples[SAMPLES];
    bat_status status = texture_at_images(all, corners, coarse_face, 1, MIDDLE, samples, error);
    if (status != BAT_OK || assign_side(all, vertices, &samples[0], NULL, numbers))
        return status;
    spread_samples(shares);
    status = texture_at_images(all, corners, coarse_face, SAMPLES, (const double(*)[3])shares, samples, error);
    if (status != BAT_OK)
        return status;
    size_t centre = max_connected(samples);
    fit(samples, (const double(*)[3])shares, centre, fitted);
    (void)assign_side(all, vertices, &samples[centre], (const double(*)[2])fitted, numbers);
    return BAT_OK;
}

bat_status map_texture_transfer(const bat_mesh_map *map, const bat_mesh *fine, const midpoint_mesh *split,
                                const bat_mesh_point *images, size_t levels, bat_mesh *refined, bat_error *error)
{
    texture_transfer all = {.map = map, .fine = fine, .images = images};
    bat_status status = bat_mesh_connect(fine, &all.connectivity, error);
    if (status == BAT_OK)
        status = allocate(split, &all, error);
    for (size_t f = 0; f < split->face_count && status == BAT_OK; f++)
        status = transfer_face(&all, split, f, levels, error);
    if (status == BAT_OK)
    {
        refined->texture = (double *)all.texture;
        refined->texture_faces = all.faces;
        refined->texture_count = all.count;
        all.texture = NULL;
        all.faces = NULL;
    }
    free_transfer(&all);
    return status;
}
