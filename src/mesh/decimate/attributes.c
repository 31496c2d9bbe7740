#include "mesh/decimate/collapse_error.h"

#include "base/error.h"
#include "linalg/vector.h"
#include "mesh/labels.h"

/// @file
/// Gradients of values, their sums at owners, and what a collapse makes of them.

/// The share of the box's diagonal that the range of a channel counts for.
static const double RANGE_SHARE = 0.1;
/// A face of lesser quality has no gradients: twice its area over its longest squared edge.
static const double DEGENERATE = 1e-4;

#define MAX_PAIRS 2

/// The owners at the ends i and j of an edge that become one: one pair, or one on each side of a seam.
typedef struct owner_pairs
{
    uint32_t a[MAX_PAIRS], b[MAX_PAIRS];
    int count;
} owner_pairs;

static double *sums_of(const attribute_field *field, uint32_t owner)
{
    return field->sums + (1 + 4 * field->width) * (size_t)owner;
}

static double *values_of(const attribute_field *field, uint32_t owner)
{
    return field->values + field->width * (size_t)owner;
}

static uint32_t owner_at(const attribute_field *field, const collapse_mesh *mesh, uint32_t half_edge)
{
    return field->owner != NULL ? field->owner[half_edge] : mesh->corner[half_edge];
}

/// The power of two next to a positive number; 0 for others.
static double power_of_two(double number)
{
    if (!(number > 0 && isfinite(number)))
        return 0;
    int exponent;
    double fraction = frexp(number, &exponent);
    return ldexp(1, fraction < 0.70710678118654752 ? exponent - 1 : exponent);
}

static bat_status allocate(attribute_field *field, size_t owners, size_t width, memory_pool *pool, bat_error *error)
{
    field->width = width;
    field->owner_count = owners;
    field->values = memory_pool_array(pool, owners, width * sizeof *field->values);
    field->sums = memory_pool_zeros(pool, owners + 1, (1 + 4 * width) * sizeof *field->sums);
    field->scales = memory_pool_array(pool, width, sizeof *field->scales);
    return memory_pool_check(pool, error);
}

/// Number the sectors of each vertex between edges where its texture coordinate changes.
static void find_sectors(const bat_mesh *mesh, const collapse_mesh *topology, attribute_field *field)
{
    uint32_t count = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        uint32_t first = topology->first[v], h = first;
        if (h == BAT_MESH_NONE)
            continue;
        uint32_t begin = count;
        do
        {
            uint32_t before = topology->twin[h];
            bool joined = h != first && before != BAT_MESH_NONE && !collapse_texture_jumps(mesh, h, bat_mesh_next(before));
            count += !joined;
            field->owner[h] = count - 1;
            h = topology->twin[bat_mesh_previous(h)];
        } while (h != BAT_MESH_NONE && h != first);
        uint32_t last = topology->twin[first];
        if (last == BAT_MESH_NONE || count == begin + 1 || collapse_texture_jumps(mesh, first, bat_mesh_next(last)))
            continue;
        // The last sector goes on in the first.
        for (h = bat_mesh_next(last); field->owner[h] == count - 1; h = bat_mesh_next(topology->twin[h]))
            field->owner[h] = begin;
        count--;
    }
    field->owner_count = count;
}

/// The area of a mesh in space and in its texture.
static void measure_areas(const bat_mesh *mesh, double *space, double *texture)
{
    *space = *texture = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *at = mesh->texture_faces + 3 * f;
        const double *u = mesh->texture + 2 * (size_t)at[0], *v = mesh->texture + 2 * (size_t)at[1],
                     *w = mesh->texture + 2 * (size_t)at[2];
        double normal[3];
        vector3_face(mesh->positions, mesh->faces + 3 * f, normal);
        *space += sqrt(vector3_dot(normal, normal)) / 2;
        *texture += fabs(vector2_turn(u, v, w)) / 2;
    }
}

static bat_status set_texture(const bat_mesh *mesh, const collapse_mesh *topology, double weight, attribute_field *field,
                              memory_pool *pool, bat_error *error)
{
    double space, texture;
    field->owner = memory_pool_array(pool, mesh->face_count, 3 * sizeof *field->owner);
    bat_status status = memory_pool_check(pool, error);
    if (status != BAT_OK)
        return status;
    find_sectors(mesh, topology, field);
    status = allocate(field, field->owner_count, 2, pool, error);
    if (status != BAT_OK)
        return status;
    measure_areas(mesh, &space, &texture);
    double scale = power_of_two(weight * sqrt(space / texture));
    field->scales[0] = field->scales[1] = scale > 0 ? scale : 1;
    for (size_t h = 0; h < 3 * mesh->face_count; h++)
        for (size_t k = 0; k < 2; k++)
            values_of(field, field->owner[h])[k] = field->scales[k] * mesh->texture[2 * (size_t)mesh->texture_faces[h] + k];
    return BAT_OK;
}

static bat_status set_channels(const bat_mesh *mesh, double weight, attribute_field *field, memory_pool *pool,
                               bat_error *error)
{
    size_t width = mesh->channel_count;
    bat_status status = allocate(field, mesh->vertex_count, width, pool, error);
    if (status != BAT_OK)
        return status;
    double low[3], high[3];
    box_of_points(3, mesh->positions, mesh->vertex_count, low, high);
    double diagonal = vector3_distance(low, high);
    for (size_t k = 0; k < width; k++)
    {
        double least = INFINITY, greatest = -INFINITY;
        for (size_t v = 0; v < mesh->vertex_count; v++)
            box_include(1, &mesh->channels[width * v + k], &least, &greatest);
        double scale = power_of_two(weight * RANGE_SHARE * diagonal / (greatest - least));
        field->scales[k] = scale > 0 ? scale : 1;
        for (size_t v = 0; v < mesh->vertex_count; v++)
            field->values[width * v + k] = field->scales[k] * mesh->channels[width * v + k];
    }
    return BAT_OK;
}

/// Add the gradients of a face to the sums of its owners and to the errors of its vertices.
static void add_face(const bat_mesh *mesh, const collapse_mesh *topology, uint32_t face, attribute_field *field,
                     quadric *errors)
{
    const uint32_t *corner = mesh->faces + 3 * (size_t)face;
    const double *p = mesh->positions + 3 * (size_t)corner[0];
    double ab[3], ac[3], bc[3], normal[3], of_ab[3], of_ac[3];
    vector3_subtract(mesh->positions + 3 * (size_t)corner[1], p, ab);
    vector3_subtract(mesh->positions + 3 * (size_t)corner[2], p, ac);
    vector3_subtract(ac, ab, bc);
    vector3_cross(ab, ac, normal);
    double square = vector3_dot(normal, normal),
           longest = fmax(vector3_dot(ab, ab), fmax(vector3_dot(ac, ac), vector3_dot(bc, bc)));
    if (!(square > DEGENERATE * DEGENERATE * longest * longest))
        return;
    double area = sqrt(square) / 2;
    vector3_cross(ac, normal, of_ab);
    vector3_cross(normal, ab, of_ac);
    uint32_t owner[3];
    for (uint32_t c = 0; c < 3; c++)
    {
        owner[c] = owner_at(field, topology, 3 * face + c);
        *sums_of(field, owner[c]) += area;
    }
    for (size_t k = 0; k < field->width; k++)
    {
        double start = values_of(field, owner[0])[k], gradient[3], to_b = values_of(field, owner[1])[k] - start,
               to_c = values_of(field, owner[2])[k] - start;
        for (int d = 0; d < 3; d++)
            gradient[d] = (to_b * of_ab[d] + to_c * of_ac[d]) / square;
        for (size_t c = 0; c < 3; c++)
        {
            double *sum = sums_of(field, owner[c]) + 1 + 4 * k;
            vector_add(3, area, gradient, sum);
            quadric_add_plane(&errors[corner[c]], gradient, area);
        }
    }
}

bat_status attributes_make(const bat_mesh *mesh, const collapse_mesh *topology, double weight, memory_pool *pool,
                           attributes *made, bat_error *error)
{
    if (mesh->texture == NULL && mesh->channel_count == 0)
        return BAT_OK;
    made->errors = memory_pool_zeros(pool, mesh->vertex_count, sizeof *made->errors);
    bat_status status = memory_pool_check(pool, error);
    if (status == BAT_OK && mesh->texture != NULL)
        status = set_texture(mesh, topology, weight, &made->texture, pool, error);
    if (status == BAT_OK && mesh->channel_count > 0)
        status = set_channels(mesh, weight, &made->channels, pool, error);
    for (uint32_t f = 0; f < mesh->face_count && status == BAT_OK; f++)
    {
        if (made->texture.width > 0)
            add_face(mesh, topology, f, &made->texture, made->errors);
        if (made->channels.width > 0)
            add_face(mesh, topology, f, &made->channels, made->errors);
    }
    return status;
}

/// The owners that the collapse of the edge of a half-edge merges.
static owner_pairs pairs_of(const attribute_field *field, const collapse_mesh *mesh, uint32_t h)
{
    uint32_t twin = mesh->twin[h];
    owner_pairs pairs = {{owner_at(field, mesh, h)}, {owner_at(field, mesh, bat_mesh_next(h))}, 1};
    if (twin == BAT_MESH_NONE || field->owner == NULL)
        return pairs;
    pairs.a[1] = owner_at(field, mesh, bat_mesh_next(twin));
    pairs.b[1] = owner_at(field, mesh, twin);
    pairs.count = pairs.a[0] == pairs.a[1] && pairs.b[0] == pairs.b[1] ? 1 : 2;
    return pairs;
}

/// Put the error of an owner with a weight and the sums of a value about another value.
static void shift_quadric(double weight, const double *of_value, double shift, quadric *planes)
{
    planes->x += of_value[0] * shift;
    planes->y += of_value[1] * shift;
    planes->z += of_value[2] * shift;
    planes->constant += (2 * of_value[3] + weight * shift) * shift;
}

/// Turn the sum of two owners' errors, each about its own value, into that of their best value or of the one at `kept`.
static void minimize_pair(const attribute_field *field, uint32_t a, uint32_t b, const double *half, int kept,
                          quadric *planes)
{
    const double *sums_a = sums_of(field, a), *sums_b = sums_of(field, b), *value_a = values_of(field, a),
                 *value_b = values_of(field, b);
    double weight = sums_a[0] + sums_b[0];
    if (!(weight > 0))
        return;
    for (size_t k = 0; k < field->width; k++)
    {
        const double *of_a = sums_a + 1 + 4 * k, *of_b = sums_b + 1 + 4 * k;
        // Values relative to the one at a.
        double step = value_b[k] - value_a[k];
        const double moved_b[4] = {of_b[0], of_b[1], of_b[2], of_b[3] - vector3_dot(of_b, half)};
        double offset = of_a[3] + vector3_dot(of_a, half) + moved_b[3] + sums_b[0] * step;
        const double both[4] = {of_a[0] + of_b[0], of_a[1] + of_b[1], of_a[2] + of_b[2], offset};
        shift_quadric(sums_b[0], moved_b, step, planes);
        if (kept == 0)
            quadric_add_plane(planes, both, -1 / weight);
        // The best value, or that of the kept end: the sum of squares about it.
        shift_quadric(weight, both, kept == 0 ? -offset / weight : kept == 1 ? 0 : -step, planes);
    }
}

bool attributes_error(const attributes *all, const collapse_mesh *mesh, uint32_t edge, const double *half, uint32_t kept,
                      quadric *sum, double *weight)
{
    const attribute_field *fields[] = {&all->texture, &all->channels};
    if (all->errors == NULL)
        return false;
    const double back[3] = {-half[0], -half[1], -half[2]};
    uint32_t h = mesh->half_edge[edge], i = mesh->corner[h], j = mesh->corner[bat_mesh_next(h)];
    int end = kept == BAT_MESH_NONE ? 0 : kept == i ? 1 : 2;
    quadric of_i = quadric_moved(&all->errors[i], half), of_j = quadric_moved(&all->errors[j], back);
    *sum = quadric_sum(&of_i, &of_j);
    *weight = 0;
    for (int f = 0; f < 2; f++)
    {
        if (fields[f]->width == 0)
            continue;
        owner_pairs pairs = pairs_of(fields[f], mesh, h);
        for (int p = 0; p < pairs.count; p++)
        {
            minimize_pair(fields[f], pairs.a[p], pairs.b[p], half, end, sum);
            *weight += *sums_of(fields[f], pairs.a[p]) + *sums_of(fields[f], pairs.b[p]);
        }
    }
    return true;
}

/// The value k of a merged owner at a position that is `from_i` and `from_j` away from the ends, and the offset there
/// relative to it.
static double merged_value(const attribute_field *field, uint32_t a, uint32_t b, size_t k, const double *from_i,
                           const double *from_j, int kept, double *offset)
{
    const double *sums_a = sums_of(field, a), *sums_b = sums_of(field, b), *of_a = sums_a + 1 + 4 * k,
                 *of_b = sums_b + 1 + 4 * k;
    double value_a = values_of(field, a)[k], step = values_of(field, b)[k] - value_a, weight = sums_a[0] + sums_b[0];
    double sum = of_a[3] + vector3_dot(of_a, from_i) + of_b[3] + vector3_dot(of_b, from_j) + sums_b[0] * step;
    double shift = kept == 1 ? 0 : kept == 2 ? step : weight > 0 ? sum / weight : step / 2;
    *offset = sum - weight * shift;
    return kept == 2 ? values_of(field, b)[k] : value_a + shift;
}

static int kept_end(const collapse_ring *ring, uint32_t kept)
{
    return kept == BAT_MESH_NONE ? 0 : kept == ring->i ? 1 : 2;
}

bool attributes_stay_valid(const attributes *all, const collapse_mesh *mesh, const error_vertex *vertices,
                           const collapse_ring *ring, const double *position, uint32_t kept)
{
    const attribute_field *field = &all->texture;
    if (field->width == 0)
        return true;
    double from_i[3], from_j[3], merged[MAX_PAIRS][2], offset;
    int end = kept_end(ring, kept);
    vector3_subtract(position, vertices[ring->i].position, from_i);
    vector3_subtract(position, vertices[ring->j].position, from_j);
    owner_pairs pairs = pairs_of(field, mesh, ring->half_edge[ring->count]);
    for (int p = 0; p < pairs.count; p++)
        for (size_t k = 0; k < 2; k++)
            merged[p][k] = merged_value(field, pairs.a[p], pairs.b[p], k, from_i, from_j, end, &offset);
    for (uint32_t n = 0; n < ring->count; n++)
    {
        uint32_t h = ring->half_edge[n], owner = field->owner[h];
        const double *from = values_of(field, field->owner[bat_mesh_next(h)]),
                     *to = values_of(field, field->owner[bat_mesh_previous(h)]), *apex = values_of(field, owner);
        double before = vector2_turn(apex, from, to);
        for (int p = pairs.count; p-- > 0;)
            if (owner == pairs.a[p] || owner == pairs.b[p])
                apex = merged[p];
        double after = vector2_turn(apex, from, to);
        if (before != 0 && !(before > 0 ? after > 0 : after < 0))
            return false;
    }
    return true;
}

static void merge_pair(attribute_field *field, const collapse_ring *ring, uint32_t a, uint32_t b, const double *from_i,
                       const double *from_j, int kept, quadric *errors)
{
    bool into_b = kept == 2 && field->owner != NULL;
    uint32_t target = into_b ? b : a, other = into_b ? a : b;
    double *sums_a = sums_of(field, a), *sums_b = sums_of(field, b), *sums = sums_of(field, target);
    for (size_t k = 0; k < field->width; k++)
    {
        double *of_a = sums_a + 1 + 4 * k, *of_b = sums_b + 1 + 4 * k, *merged = sums + 1 + 4 * k, offset;
        double value = merged_value(field, a, b, k, from_i, from_j, kept, &offset);
        shift_quadric(sums_a[0], of_a, values_of(field, a)[k] - value, &errors[ring->i]);
        shift_quadric(sums_b[0], of_b, values_of(field, b)[k] - value, &errors[ring->j]);
        for (int c = 0; c < 3; c++)
            merged[c] = of_a[c] + of_b[c];
        merged[3] = offset;
        values_of(field, target)[k] = value;
    }
    sums[0] = sums_a[0] + sums_b[0];
    for (uint32_t n = 0; n < ring->count && field->owner != NULL; n++)
        if (field->owner[ring->half_edge[n]] == other)
            field->owner[ring->half_edge[n]] = target;
}

void attributes_merge(attributes *all, const collapse_mesh *mesh, const collapse_ring *ring, const double *position,
                      uint32_t kept, const error_vertex *vertices)
{
    if (all->errors == NULL)
        return;
    attribute_field *fields[] = {&all->texture, &all->channels};
    double from_i[3], from_j[3];
    vector3_subtract(position, vertices[ring->i].position, from_i);
    vector3_subtract(position, vertices[ring->j].position, from_j);
    for (int f = 0; f < 2; f++)
    {
        if (fields[f]->width == 0)
            continue;
        owner_pairs pairs = pairs_of(fields[f], mesh, ring->half_edge[ring->count]);
        for (int p = 0; p < pairs.count; p++)
            merge_pair(fields[f], ring, pairs.a[p], pairs.b[p], from_i, from_j, kept_end(ring, kept), all->errors);
    }
    quadric of_i = quadric_moved(&all->errors[ring->i], from_i), of_j = quadric_moved(&all->errors[ring->j], from_j);
    all->errors[ring->i] = quadric_sum(&of_i, &of_j);
}

/// The texture of the remaining faces, each owner once, in the order of the faces.
static bat_status finish_texture(const attribute_field *field, const collapse_mesh *mesh, bat_mesh *coarse, bat_error *error)
{
    uint32_t *number = memory_array(field->owner_count, sizeof *number), count = 0;
    coarse->texture_faces = memory_array(coarse->face_count, 3 * sizeof *coarse->texture_faces);
    coarse->texture = memory_array(3 * coarse->face_count, 2 * sizeof *coarse->texture);
    if (number == NULL || coarse->texture_faces == NULL || coarse->texture == NULL)
    {
        free(number);
        return error_memory(error, field->owner_count * sizeof *number);
    }
    memset(number, 0xff, field->owner_count * sizeof *number);
    uint32_t *to = coarse->texture_faces;
    for (size_t h = 0; h < 3 * mesh->face_count; h++)
    {
        if (mesh->corner[h] == BAT_MESH_NONE)
            continue;
        uint32_t owner = field->owner[h];
        if (number[owner] == BAT_MESH_NONE)
        {
            for (size_t k = 0; k < 2; k++)
                coarse->texture[2 * (size_t)count + k] = values_of(field, owner)[k] / field->scales[k];
            number[owner] = count++;
        }
        *to++ = number[owner];
    }
    free(number);
    coarse->texture_count = count;
    double *shrunk = realloc(coarse->texture, 2 * (size_t)count * sizeof *shrunk);
    coarse->texture = shrunk != NULL ? shrunk : coarse->texture;
    return BAT_OK;
}

static bat_status finish_channels(const attribute_field *field, const bat_mesh *fine, const collapse_mesh *mesh,
                                  bat_mesh *coarse, bat_error *error)
{
    bat_status status = channels_make(fine, coarse->vertex_count, coarse, error);
    for (uint32_t v = 0; v < mesh->vertex_count && status == BAT_OK; v++)
        for (size_t k = 0; k < field->width && mesh->first[v] != BAT_MESH_NONE; k++)
            coarse->channels[field->width * mesh->stamp[v] + k] = values_of(field, v)[k] / field->scales[k];
    if (status == BAT_OK)
        channels_bound(fine, coarse);
    return status;
}

bat_status attributes_finish(const attributes *all, const bat_mesh *fine, const collapse_mesh *mesh, bat_mesh *coarse,
                             bat_error *error)
{
    bat_status status = all->texture.width > 0 ? finish_texture(&all->texture, mesh, coarse, error) : BAT_OK;
    return status == BAT_OK && all->channels.width > 0 ? finish_channels(&all->channels, fine, mesh, coarse, error) : status;
}
