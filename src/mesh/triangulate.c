#include "mesh/check.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"

/// @file
/// Triangulation of a polygon in space: quads along the better diagonal, convex polygons as a fan, others by ear clipping
/// (Meisters, "Polygons have ears", 1975).
///
/// The polygon is projected along Newell's normal n = sum_i p_i x p_(i+1), twice its area as a vector.

/// The most corners of a concave polygon. Ear clipping takes time in proportion to their square.
#define MAX_EARS 10000

/// A polygon, translated and scaled so that no product overflows.
typedef struct outline
{
    const double *positions;
    const uint32_t *corners;
    size_t count;
    double scale; ///< the factor of all coordinates
    double normal[3];
} outline;

/// Corner `i` relative to corner 0, scaled.
static void corner_at(const outline *polygon, size_t i, double point[3])
{
    const double *origin = polygon->positions + 3 * (size_t)polygon->corners[0];
    const double *position = polygon->positions + 3 * (size_t)polygon->corners[i];
    for (int k = 0; k < 3; k++)
        point[k] = position[k] * polygon->scale - origin[k] * polygon->scale;
}

/// A triangle of three corners, projected along the normal.
typedef struct corner_triangle
{
    double area;    ///< twice the signed area times the length of the normal; negative when clockwise
    double squares; ///< the sum of the squared edge lengths
} corner_triangle;

static corner_triangle triangle_at(const outline *polygon, size_t i, size_t j, size_t k)
{
    double a[3], b[3], c[3], ab[3], ac[3], bc[3], normal[3];
    corner_at(polygon, i, a);
    corner_at(polygon, j, b);
    corner_at(polygon, k, c);
    for (int d = 0; d < 3; d++)
    {
        ab[d] = b[d] - a[d];
        ac[d] = c[d] - a[d];
        bc[d] = c[d] - b[d];
    }
    vector3_cross(ab, ac, normal);
    return (corner_triangle){vector3_dot(normal, polygon->normal),
                             vector3_dot(ab, ab) + vector3_dot(ac, ac) + vector3_dot(bc, bc)};
}

/// Choose the scale and compute Newell's normal.
static outline outline_of(const double *positions, const uint32_t *corners, size_t count)
{
    outline made = {positions, corners, count, 1.0, {0}};
    double largest = 0.0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            largest = fmax(largest, fabs(positions[3 * (size_t)corners[i] + (size_t)k]));
    int exponent;
    (void)frexp(largest, &exponent);
    made.scale = largest > 0 ? ldexp(1.0, -(exponent < -1000 ? -1000 : exponent)) : 1.0;
    double before[3], after[3], product[3];
    corner_at(&made, count - 1, before);
    for (size_t i = 0; i < count; i++)
    {
        corner_at(&made, i, after);
        vector3_cross(before, after, product);
        for (int k = 0; k < 3; k++)
        {
            made.normal[k] += product[k];
            before[k] = after[k];
        }
    }
    return made;
}

static void put_triangle(uint32_t **out, size_t a, size_t b, size_t c)
{
    (*out)[0] = (uint32_t)a;
    (*out)[1] = (uint32_t)b;
    (*out)[2] = (uint32_t)c;
    *out += 3;
}

/// The lower quality of two triangles: area over squared edge lengths, largest for equilateral triangles.
static double min_quality(corner_triangle a, corner_triangle b)
{
    double first = a.squares > 0 ? a.area / a.squares : 0.0, second = b.squares > 0 ? b.area / b.squares : 0.0;
    return fmin(first, second);
}

static void cut_quad(const outline *quad, uint32_t *out)
{
    double even = min_quality(triangle_at(quad, 0, 1, 2), triangle_at(quad, 0, 2, 3));
    double odd = min_quality(triangle_at(quad, 1, 2, 3), triangle_at(quad, 1, 3, 0));
    size_t begin = odd > even ? 1 : 0;
    put_triangle(&out, begin, begin + 1, begin + 2);
    put_triangle(&out, begin, begin + 2, (begin + 3) % 4);
}

static bool is_convex(const outline *polygon)
{
    size_t count = polygon->count;
    for (size_t i = 0; i < count; i++)
        if (!(triangle_at(polygon, i, (i + 1) % count, (i + 2) % count).area > 0))
            return false;
    return true;
}

/// The remaining polygon during ear clipping: a doubly linked ring of corners.
typedef struct ear_ring
{
    const outline *polygon;
    uint32_t *next, *previous;
    uint32_t *ear; ///< 1 for a corner that is an ear
} ear_ring;

static bool same_place(const outline *polygon, size_t i, size_t j)
{
    double a[3], b[3];
    corner_at(polygon, i, a);
    corner_at(polygon, j, b);
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/// Whether a corner is an ear: convex, with no other corner in its triangle. Corners that coincide with one of the
/// triangle's three are ignored, because outlines joined to holes visit points twice.
static bool is_ear(const ear_ring *ring, uint32_t b)
{
    const outline *polygon = ring->polygon;
    uint32_t a = ring->previous[b], c = ring->next[b];
    if (!(triangle_at(polygon, a, b, c).area > 0))
        return false;
    for (uint32_t i = ring->next[c]; i != a; i = ring->next[i])
        if (triangle_at(polygon, a, b, i).area >= 0 && triangle_at(polygon, b, c, i).area >= 0 &&
            triangle_at(polygon, c, a, i).area >= 0 && !same_place(polygon, i, a) && !same_place(polygon, i, b) &&
            !same_place(polygon, i, c))
            return false;
    return true;
}

/// Clip ears until a triangle remains. Where an outline has no ear, as it crosses itself, any corner is clipped.
static void cut_ears(const ear_ring *ring, uint32_t *out)
{
    uint32_t count = (uint32_t)ring->polygon->count;
    for (uint32_t i = 0; i < count; i++)
    {
        ring->next[i] = i + 1 < count ? i + 1 : 0;
        ring->previous[i] = i > 0 ? i - 1 : count - 1;
    }
    for (uint32_t i = 0; i < count; i++)
        ring->ear[i] = is_ear(ring, i);
    uint32_t at = 0;
    for (uint32_t left = count; left > 3; left--)
    {
        for (uint32_t tried = 0; tried < left && !ring->ear[at]; tried++)
            at = ring->next[at];
        uint32_t before = ring->previous[at], after = ring->next[at];
        put_triangle(&out, before, at, after);
        ring->next[before] = after;
        ring->previous[after] = before;
        ring->ear[before] = is_ear(ring, before);
        ring->ear[after] = is_ear(ring, after);
        at = ring->next[after]; // skip the neighbour, which would give a fan of slivers
    }
    put_triangle(&out, ring->previous[at], at, ring->next[at]);
}

/// Triangulate a polygon of `count` >= 3 corners.
/// @param corners   the vertices at the corners
/// @param triangles receives 3 x (count - 2) corner numbers, each 0 to count - 1, with the orientation of the polygon
/// @param room      workspace, 3 x count numbers
/// @return false for a concave polygon of more than MAX_EARS corners
static bool cut_polygon(const double *positions, const uint32_t *corners, size_t count, uint32_t *triangles, uint32_t *room)
{
    outline polygon = outline_of(positions, corners, count);
    if (count == 4)
        cut_quad(&polygon, triangles);
    else if (count == 3 || is_convex(&polygon))
        for (size_t i = 1; i + 1 < count; i++)
            put_triangle(&triangles, 0, i, i + 1);
    else if (count > MAX_EARS)
        return false;
    else
        cut_ears(&(ear_ring){&polygon, room, room + count, room + 2 * count}, triangles);
    return true;
}

/// Cut all faces, into arrays that have the room.
/// @param labels   receives the labels of the triangles; null for none
/// @param workspace 6 numbers for each corner of the largest polygon
static bat_status cut_faces(const bat_mesh *mesh, uint32_t *faces, uint32_t *texture_faces, uint32_t *labels,
                            uint32_t *workspace, size_t largest, bat_error *error)
{
    size_t corner = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        uint32_t begin = mesh->offsets[f], size = mesh->offsets[f + 1] - begin;
        if (!cut_polygon(mesh->positions, mesh->faces + begin, size, workspace, workspace + 3 * largest))
            return error_set(error, BAT_TOO_LARGE, f, 0, "face %zu is not convex and has %u corners, more than %d", f, size,
                             MAX_EARS);
        for (uint32_t i = 0; i < 3 * (size - 2); i++, corner++)
        {
            faces[corner] = mesh->faces[begin + workspace[i]];
            if (texture_faces != NULL)
                texture_faces[corner] = mesh->texture_faces[begin + workspace[i]];
            if (labels != NULL)
                labels[corner / 3] = mesh->face_labels[f];
        }
    }
    return BAT_OK;
}

static void replace(uint32_t **array, uint32_t *by)
{
    free(*array);
    *array = by;
}

bat_status mesh_cut_polygons(bat_mesh *mesh, uint32_t **offsets, bat_error *error)
{
    size_t count = mesh->offsets[mesh->face_count] - 2 * mesh->face_count, largest = 0;
    if (count > BAT_MESH_MAX_FACES)
        return ERROR_TOO_LARGE(error, "the mesh has more than %zu triangles", BAT_MESH_MAX_FACES);
    for (size_t f = 0; f < mesh->face_count; f++)
        largest = mesh->offsets[f + 1] - mesh->offsets[f] > largest ? mesh->offsets[f + 1] - mesh->offsets[f] : largest;
    bool textured = mesh->texture_faces != NULL, labelled = mesh->face_labels != NULL;
    uint32_t *faces = memory_array(3 * count, sizeof *faces), *workspace = memory_array(6 * largest, sizeof *workspace);
    uint32_t *texture_faces = textured ? memory_array(3 * count, sizeof *texture_faces) : NULL;
    uint32_t *labels = labelled ? memory_array(count, sizeof *labels) : NULL;
    bat_status status = BAT_OK;
    if (faces == NULL || workspace == NULL || (textured && texture_faces == NULL) || (labelled && labels == NULL))
        status = error_memory(error, 3 * count * sizeof *faces);
    else
        status = cut_faces(mesh, faces, texture_faces, labels, workspace, largest, error);
    free(workspace);
    if (status != BAT_OK)
    {
        free(faces);
        free(texture_faces);
        free(labels);
        return status;
    }
    replace(&mesh->faces, faces);
    replace(&mesh->texture_faces, texture_faces);
    replace(&mesh->face_labels, labels);
    *offsets = mesh->offsets;
    mesh->offsets = NULL;
    mesh->face_count = count;
    return BAT_OK;
}

bat_status bat_mesh_triangulate(const bat_mesh *mesh, bat_mesh *triangles, bat_error *error)
{
    bat_mesh made;
    uint32_t *offsets = NULL;
    bat_status status = bat_mesh_check(mesh, error);
    if (status == BAT_OK)
        status = bat_mesh_copy(mesh, &made, error);
    if (status != BAT_OK)
        return status;
    if (made.offsets != NULL)
        status = mesh_cut_polygons(&made, &offsets, error);
    free(offsets);
    if (status == BAT_OK)
        *triangles = made;
    else
        bat_mesh_free(&made);
    return status;
}
