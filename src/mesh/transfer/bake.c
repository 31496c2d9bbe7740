#include "base/error.h"
#include "base/option.h"
#include "base/threads.h"
#include "batten/mesh_transfer.h"
#include "mesh/check.h"
#include "mesh/decimate/map.h"
#include "mesh/labels.h"
#include "mesh/measure/closest.h"

/// @file
/// Images of a fine mesh by the texture coordinates of its decimation: each texel goes through the map.

enum
{
    CHANNELS = 3,
    WHOLE = 255
};

bat_mesh_bake_options bat_mesh_bake_defaults(void)
{
    return (bat_mesh_bake_options){.unwrap = bat_mesh_unwrap_defaults(), .normal = true, .rays = 64, .distance = 0.25};
}

static const option_field FIELDS[] = {
    OPTION_STRUCT(bat_mesh_bake_options, unwrap, bat_mesh_unwrap_fields),
    OPTION_FIELD(bat_mesh_bake_options, rays, OPTION_SIZE, 1, 65536),
    OPTION_FIELD(bat_mesh_bake_options, distance, OPTION_ABOVE, 0, INFINITY),
    OPTION_THREADS(bat_mesh_bake_options),
};

const bat_options_table bat_mesh_bake_fields = OPTIONS_TABLE(bat_mesh_bake_options, FIELDS, NULL);

void bat_mesh_baked_free(bat_mesh_baked *baked)
{
    free(baked->normal.pixels);
    free(baked->colour.pixels);
    free(baked->occlusion.pixels);
    free(baked->normals);
    *baked = (bat_mesh_baked){0};
}

typedef struct baking
{
    const bat_mesh_map *map;
    const bat_mesh *fine, *coarse;
    const bat_mesh_bake_options *options;
    size_t size;          ///< texels along a side
    uint32_t *owner;      ///< for each texel: the coarse face at its centre, or BAT_MESH_NONE
    double *fine_normals; ///< of the fine mesh's vertices
    double *tangents;     ///< of the coarse mesh's corners
    double *open;         ///< for each fine vertex: the share of directions without an occluder; null for none
    size_t colour_places[MESH_COLOURS];
    const bat_mesh_painter *painter; ///< of colours; null: the channels
    bat_mesh_baked *baked;
} baking;

/// The texture coordinates of a face's corners in texels, from the top.
static void texels_of(const baking *all, size_t face, double texels[3][2])
{
    for (size_t c = 0; c < 3; c++)
    {
        const double *at = all->coarse->texture + 2 * (size_t)all->coarse->texture_faces[3 * face + c];
        texels[c][0] = at[0] * (double)all->size;
        texels[c][1] = (1 - at[1]) * (double)all->size;
    }
}

/// The barycentric coordinates of a texel's centre; false for a centre outside.
static bool weights_at(double texels[3][2], size_t x, size_t y, double weights[3])
{
    const double at[2] = {(double)x + 0.5, (double)y + 0.5};
    double whole = vector2_turn(texels[0], texels[1], texels[2]);
    for (size_t c = 0; c < 3; c++)
        weights[c] = vector2_turn(texels[(c + 1) % 3], texels[(c + 2) % 3], at) / whole;
    return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
}

/// Find the face at each texel. Returns whether the texture coordinates are good for an image: within the unit square, and
/// without texels that lie inside several faces.
static bool own_texels(baking *all)
{
    static const double inside = 1e-6, outside = 1e-9;
    size_t size = all->size, shared = 0;
    all->baked->texels = 0;
    memset(all->owner, 0xff, size * size * sizeof *all->owner);
    for (size_t i = 0; i < 2 * all->coarse->texture_count; i++)
        if (!(all->coarse->texture[i] >= -outside && all->coarse->texture[i] <= 1 + outside))
            return false;
    for (size_t f = 0; f < all->coarse->face_count; f++)
    {
        double texels[3][2], w[3], most = (double)size - 1;
        texels_of(all, f, texels);
        double low_x = fmin(texels[0][0], fmin(texels[1][0], texels[2][0])),
               low_y = fmin(texels[0][1], fmin(texels[1][1], texels[2][1])),
               high_x = fmin(most, fmax(texels[0][0], fmax(texels[1][0], texels[2][0]))),
               high_y = fmin(most, fmax(texels[0][1], fmax(texels[1][1], texels[2][1])));
        for (size_t y = (size_t)fmax(0, low_y); (double)y <= high_y; y++)
            for (size_t x = (size_t)fmax(0, low_x); (double)x <= high_x; x++)
            {
                if (!weights_at(texels, x, y, w))
                    continue;
                uint32_t *owner = &all->owner[y * size + x];
                shared += *owner != BAT_MESH_NONE && w[0] > inside && w[1] > inside && w[2] > inside;
                all->baked->texels += *owner == BAT_MESH_NONE;
                *owner = *owner == BAT_MESH_NONE ? (uint32_t)f : *owner;
            }
    }
    return all->baked->texels > 0 && (double)shared <= 1e-3 * (double)all->baked->texels;
}

/// sum = the values at the corners, by weights
static void blend(const double *const corners[3], const double weights[3], double sum[3])
{
    for (size_t k = 0; k < 3; k++)
        sum[k] = weights[0] * corners[0][k] + weights[1] * corners[1][k] + weights[2] * corners[2][k];
}

/// The normal at a point of the fine mesh: that of its vertices, unless it is far from the face's own.
static void normal_at(const baking *all, const bat_mesh_point *point, double normal[3])
{
    static const double near = 0.7; // the cosine of 45 degrees
    const bat_mesh *fine = all->fine;
    double own[3];
    for (size_t k = 0; k < 3; k++)
        normal[k] = map_value_at(fine, all->fine_normals + k, 3, point);
    vector3_face(fine->positions, fine->faces + 3 * (size_t)point->face, own);
    bool flat = !vector3_normalize(own), smooth = vector3_normalize(normal);
    if (!flat && (!smooth || vector3_dot(own, normal) < near))
        memcpy(normal, own, sizeof own);
}

static unsigned char byte_of(double share)
{
    return (unsigned char)(fmin(1, fmax(0, share)) * WHOLE + 0.5);
}

/// Write a vector of tangent space, whose third number is raised to `least`. Returns the angle between a normal and what the
/// pixel says in the frame.
static double write_local(const double local[3], double least, double frame[3][3], const double normal[3],
                          unsigned char *pixel)
{
    double up = fmax(least, local[2]), side = hypot(local[0], local[1]),
           shrink = side > 0 ? fmin(1, sqrt(fmax(0, 1 - up * up)) / side) : 1, decoded[3] = {0};
    for (size_t k = 0; k < 3; k++)
    {
        pixel[k] = byte_of((k < 2 ? shrink * local[k] : up) / 2 + 0.5);
        vector_add(3, 2.0 * pixel[k] / WHOLE - 1, frame[k], decoded);
    }
    return vector3_angle(decoded, normal);
}

/// Write a normal in the tangent space of a point of the coarse mesh: upwards, as glTF wants it, unless that turns it too
/// far. Returns the angle between it and what the pixel says.
static double encode_normal(const baking *all, size_t face, const double weights[3], const double normal[3],
                            unsigned char *pixel)
{
    static const double least = 1.5 / WHOLE, far = 1; // of the third number, and radians
    const double *normals[3], *tangents[3];
    double frame[3][3], across[3], local[3], sign = 0;
    for (size_t c = 0; c < 3; c++)
    {
        normals[c] = all->baked->normals + 3 * (size_t)all->coarse->faces[3 * face + c];
        tangents[c] = all->tangents + 4 * (3 * face + c);
        sign += weights[c] * tangents[c][3];
    }
    blend(tangents, weights, frame[0]);
    blend(normals, weights, frame[2]);
    vector3_cross(frame[2], frame[0], frame[1]);
    for (size_t k = 0; k < 3 && sign < 0; k++)
        frame[1][k] = -frame[1][k];
    for (size_t k = 0; k < 3; k++)
    {
        vector3_cross(frame[(k + 1) % 3], frame[(k + 2) % 3], across);
        local[k] = vector3_dot(normal, across) * (sign < 0 ? -1 : 1);
    }
    if (!vector3_normalize(local))
        local[0] = local[1] = 0, local[2] = 1;
    double angle = write_local(local, least, frame, normal, pixel);
    return angle > far ? write_local(local, -1, frame, normal, pixel) : angle;
}

/// Bake a row of texels. `points` has room for a row. Returns the greatest angle.
static bat_status bake_row(const baking *all, size_t y, bat_mesh_point *points, double *most, bat_error *error)
{
    size_t count = 0, size = all->size, next = 0;
    double texels[3][2], weights[3];
    const uint32_t *owner = all->owner + y * size;
    for (size_t x = 0; x < size; x++)
    {
        if (owner[x] == BAT_MESH_NONE)
            continue;
        points[count].face = owner[x];
        texels_of(all, owner[x], texels);
        (void)weights_at(texels, x, y, points[count].barycentric);
        count++;
    }
    bat_status status = bat_mesh_map_to_fine(all->map, points, count, error);
    for (size_t x = 0; x < size && status == BAT_OK; x++)
    {
        if (owner[x] == BAT_MESH_NONE)
            continue;
        const bat_mesh_point *point = &points[next++];
        size_t at = CHANNELS * (y * size + x);
        double normal[3];
        texels_of(all, owner[x], texels);
        (void)weights_at(texels, x, y, weights);
        normal_at(all, point, normal);
        if (all->baked->normal.pixels != NULL)
            *most = fmax(*most, encode_normal(all, owner[x], weights, normal, all->baked->normal.pixels + at));
        if (all->baked->colour.pixels != NULL && all->painter != NULL)
            all->painter->paint(all->painter->context, point, all->baked->colour.pixels + at);
        for (size_t k = 0; k < CHANNELS && all->baked->colour.pixels != NULL && all->painter == NULL; k++)
            all->baked->colour.pixels[at + k] = byte_of(
                map_value_at(all->fine, all->fine->channels + all->colour_places[k], all->fine->channel_count, point));
        if (all->baked->occlusion.pixels != NULL)
            memset(all->baked->occlusion.pixels + at, byte_of(map_value_at(all->fine, all->open, 1, point)), CHANNELS);
    }
    return status;
}

/// Bake all texels. Points within faces are always on the map.
static bat_status bake_rows(baking *all, bat_error *error)
{
    size_t size = all->size;
    int threads = threads_for(all->options->threads, size);
    bat_mesh_point *points = memory_array((size_t)threads * size, sizeof *points);
    double most = 0;
    int failed = points == NULL;
#pragma omp parallel for schedule(dynamic) num_threads(threads) reduction(max : most, failed) if (points != NULL)
    for (size_t y = 0; y < size; y++)
        if (points != NULL)
            failed |= bake_row(all, y, points + (size_t)threads_current() * size, &most, NULL) != BAT_OK;
    free(points);
    all->baked->max_turn = most;
    return failed ? error_memory(error, (size_t)threads * size * sizeof *points) : BAT_OK;
}

/// Widen what is baked into the texels around, step by step, by means of the neighbours.
static void widen(const baking *all, bat_mesh_image *image, unsigned char *filled)
{
    size_t size = all->size;
    for (size_t i = 0; i < size * size; i++)
        filled[i] = all->owner[i] != BAT_MESH_NONE;
    for (size_t step = 1; step <= all->options->unwrap.padding; step++)
    {
        for (size_t y = 0; y < size; y++)
            for (size_t x = 0; x < size; x++)
            {
                unsigned sum[CHANNELS] = {0}, count = 0;
                if (filled[y * size + x] != 0)
                    continue;
                for (size_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < size; v++)
                    for (size_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < size; u++)
                    {
                        if (filled[v * size + u] == 0 || filled[v * size + u] > step)
                            continue;
                        count++;
                        for (size_t k = 0; k < CHANNELS; k++)
                            sum[k] += image->pixels[CHANNELS * (v * size + u) + k];
                    }
                if (count == 0)
                    continue;
                for (size_t k = 0; k < CHANNELS; k++)
                    image->pixels[CHANNELS * (y * size + x) + k] = (unsigned char)((sum[k] + count / 2) / count);
                filled[y * size + x] = (unsigned char)(step + 1);
            }
    }
}

/// The share of directions without an occluder at each fine vertex: cosine-weighted directions of low discrepancy (the
/// additive recurrence of Roberts, 2018, with the plastic number).
static bat_status find_open(baking *all, memory_pool *pool, bat_error *error)
{
    static const double plastic[2] = {0.7548776662466927, 0.5698402909980532}, lift = 1e-4, turn = ANGLE_TURN;
    const bat_mesh *fine = all->fine;
    closest_tree tree;
    double low[3], high[3];
    box_of_points(3, fine->positions, fine->vertex_count, low, high);
    double diagonal = vector3_distance(high, low);
    all->open = memory_pool_array(pool, fine->vertex_count, sizeof *all->open);
    bat_status status = memory_pool_check(pool, error);
    if (status == BAT_OK)
        status = closest_build(fine, closest_largest(fine->positions, 3 * fine->vertex_count, 0), &tree, error);
    if (status != BAT_OK)
        return status;
    size_t rays = all->options->rays;
    int threads = threads_for(all->options->threads, fine->vertex_count);
#pragma omp parallel for schedule(dynamic, 64) num_threads(threads)
    for (size_t v = 0; v < fine->vertex_count; v++)
    {
        const double *normal = all->fine_normals + 3 * v;
        double t[3] = {fabs(normal[0]) < 0.6, fabs(normal[0]) >= 0.6, 0}, b[3], origin[3], direction[3];
        size_t blocked = 0;
        vector3_cross(normal, t, b);
        (void)vector3_normalize(b);
        vector3_cross(b, normal, t);
        for (size_t k = 0; k < 3; k++)
            origin[k] = fine->positions[3 * v + k] + lift * diagonal * normal[k];
        for (size_t i = 0; i < rays; i++)
        {
            double square = fmod(0.5 + plastic[0] * (double)i, 1), angle = turn * fmod(0.5 + plastic[1] * (double)i, 1),
                   radius = sqrt(square), up = sqrt(1 - square);
            for (size_t k = 0; k < 3; k++)
                direction[k] = up * normal[k] + radius * (cos(angle) * t[k] + sin(angle) * b[k]);
            blocked += closest_blocked(&tree, origin, direction, all->options->distance * diagonal);
        }
        all->open[v] = 1 - (double)blocked / (double)rays;
    }
    closest_free(&tree);
    return BAT_OK;
}

/// An image of one colour.
static bat_status make_image(const baking *all, bool wanted, const unsigned char colour[CHANNELS], bat_mesh_image *image,
                             bat_error *error)
{
    size_t count = all->size * all->size;
    if (!wanted)
        return BAT_OK;
    *image = (bat_mesh_image){.pixels = memory_array(count, CHANNELS), .width = all->size, .height = all->size};
    for (size_t i = 0; i < count && image->pixels != NULL; i++)
        memcpy(image->pixels + CHANNELS * i, colour, CHANNELS);
    return image->pixels != NULL ? BAT_OK : error_memory(error, CHANNELS * count);
}

/// Turn the normals of the coarse vertices towards the faces around that they look away from, as the perceptron does. Only
/// where no normal serves all faces they stay behind one.
static void face_normals(const bat_mesh *mesh, double *normals)
{
    static const int STEPS = 100;
    static const double least = 0.25; // the cosine that all faces get
    bool wrong = true;
    for (int step = 0; step < STEPS && wrong; step++)
    {
        wrong = false;
        for (size_t f = 0; f < mesh->face_count; f++)
        {
            const uint32_t *corner = mesh->faces + 3 * f;
            double own[3];
            vector3_face(mesh->positions, corner, own);
            for (size_t c = 0; c < 3 && vector3_normalize(own); c++)
            {
                double *normal = normals + 3 * (size_t)corner[c], lack = least - vector3_dot(normal, own);
                for (size_t k = 0; k < 3 && lack > 0; k++)
                    normal[k] += (lack + 0.05) * own[k];
                wrong = wrong || lack > 0;
                (void)vector3_normalize(normal);
            }
        }
    }
}

/// Make an atlas where the texture coordinates do not serve, then the images.
static bat_status bake(baking *all, bat_mesh *coarse, memory_pool *pool, bat_error *error)
{
    static const unsigned char up[CHANNELS] = {128, 128, 255}, grey[CHANNELS] = {128, 128, 128},
                               white[CHANNELS] = {WHOLE, WHOLE, WHOLE};
    const bat_mesh_bake_options *options = all->options;
    bat_mesh_baked *baked = all->baked;
    all->owner = memory_pool_array(pool, all->size * all->size, sizeof *all->owner);
    all->fine_normals = memory_pool_array(pool, all->fine->vertex_count, 3 * sizeof *all->fine_normals);
    unsigned char *filled = memory_pool_array(pool, all->size * all->size, 1);
    bat_status status = memory_pool_check(pool, error);
    if (status == BAT_OK && (coarse->texture_faces == NULL || !own_texels(all)))
    {
        status = bat_mesh_unwrap(coarse, &options->unwrap, &baked->charts, error);
        if (status == BAT_OK)
            (void)own_texels(all);
    }
    if (status == BAT_OK)
        status = bat_mesh_vertex_normals(all->fine, BAT_MESH_NORMALS_ANGLE, all->fine_normals, error);
    if (status == BAT_OK)
        face_normals(coarse, baked->normals);
    if (status == BAT_OK)
        status = bat_mesh_tangents(coarse, baked->normals, &all->tangents, error);
    if (status == BAT_OK && options->occlusion)
        status = find_open(all, pool, error);
    if (status == BAT_OK)
        status = make_image(all, options->normal, up, &baked->normal, error);
    if (status == BAT_OK)
        status = make_image(all, options->colour, grey, &baked->colour, error);
    if (status == BAT_OK)
        status = make_image(all, options->occlusion, white, &baked->occlusion, error);
    if (status == BAT_OK)
        status = bake_rows(all, error);
    bat_mesh_image *const images[] = {&baked->normal, &baked->colour, &baked->occlusion};
    for (size_t i = 0; i < sizeof images / sizeof *images && status == BAT_OK; i++)
        if (images[i]->pixels != NULL)
            widen(all, images[i], filled);
    free(all->tangents);
    return status;
}

bat_status bat_mesh_bake(const bat_mesh_map *map, const bat_mesh *fine, bat_mesh *coarse,
                         const bat_mesh_bake_options *options, bat_mesh_baked *baked, bat_error *error)
{
    return bat_mesh_bake_painted(map, fine, coarse, options, NULL, baked, error);
}

bat_status bat_mesh_bake_painted(const bat_mesh_map *map, const bat_mesh *fine, bat_mesh *coarse,
                                 const bat_mesh_bake_options *options, const bat_mesh_painter *painter,
                                 bat_mesh_baked *baked, bat_error *error)
{
    const bat_mesh_bake_options defaults = bat_mesh_bake_defaults();
    bat_mesh_baked made = {0};
    memory_pool pool = {0};
    bat_mesh shape = {0};
    baking all = {.map = map, .fine = fine, .painter = painter, .baked = &made};
    all.options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_mesh_bake_fields, all.options, error);
    if (status == BAT_OK && all.options->colour && painter == NULL && mesh_colours(fine, all.colour_places) == 0)
        status = ERROR_ARGUMENT(error, "the fine mesh has no colours");
    if (status == BAT_OK)
        status = bat_mesh_copy(coarse, &shape, error);
    if (status != BAT_OK)
        return status;
    all.coarse = &shape;
    all.size = all.options->unwrap.size;
    status = bat_mesh_transfer(map, fine, &shape, &made.normals, error);
    if (status == BAT_OK)
        status = bake(&all, &shape, &pool, error);
    memory_pool_free(&pool);
    if (status == BAT_OK)
    {
        mesh_swap_texture(coarse, &shape);
        *baked = made;
    }
    else
        bat_mesh_baked_free(&made);
    bat_mesh_free(&shape);
    return status;
}
