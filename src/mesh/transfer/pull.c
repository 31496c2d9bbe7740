#include "base/error.h"
#include "batten/mesh_measure.h"
#include "batten/mesh_transfer.h"
#include "mesh/check.h"
#include "mesh/decimate/map.h"
#include "mesh/hash_table.h"
#include "mesh/labels.h"

/// @file
/// Values and labels of a decimated mesh: projections in the mean square over the fine mesh, through the map. Chains of
/// decimated meshes.

enum
{
    SAMPLES = 4, ///< of a fine face: the centres of its midpoint triangles
    STEPS = 24
};

static const double SHARES[SAMPLES][3] = {
    {1 / 3.0, 1 / 3.0, 1 / 3.0}, {2 / 3.0, 1 / 6.0, 1 / 6.0}, {1 / 6.0, 2 / 3.0, 1 / 6.0}, {1 / 6.0, 1 / 6.0, 2 / 3.0}};

/// The equations (M + D) c = b + D p of one value c at the coarse vertices, with the mass matrix M of the samples, the
/// values p at the vertices' images, and a small diagonal D.
typedef struct pull
{
    const bat_mesh *fine, *coarse;
    bat_mesh_point *samples; ///< SAMPLES for each fine face, on the coarse mesh
    bat_mesh_point *images;  ///< of the coarse vertices, on the fine mesh
    double *weights;         ///< for each fine face: that of a sample, a part of its area
    double *anchor;          ///< of D
    double *rows;            ///< the sums of the rows of M + D
    double *numbers[5];      ///< workspace, of the coarse vertices
} pull;

/// Solve the equations by steps of the residual over the rows' sums. These halve the error or better, but for few parts of
/// it: the eigenvalues of the scaled mass matrix of triangles lie between 1/4 and 1.
static void solve(const pull *all, const double *right, double *residual, double *c)
{
    size_t n = all->coarse->vertex_count;
    for (int step = 0; step < STEPS; step++)
    {
        for (size_t v = 0; v < n; v++)
            residual[v] = right[v] - all->anchor[v] * c[v];
        for (size_t i = 0; i < SAMPLES * all->fine->face_count; i++)
        {
            const uint32_t *corner = all->coarse->faces + 3 * (size_t)all->samples[i].face;
            const double *b = all->samples[i].barycentric;
            double value = all->weights[i / SAMPLES] * (b[0] * c[corner[0]] + b[1] * c[corner[1]] + b[2] * c[corner[2]]);
            for (size_t k = 0; k < 3; k++)
                residual[corner[k]] -= b[k] * value;
        }
        for (size_t v = 0; v < n; v++)
            c[v] += residual[v] / all->rows[v];
    }
}

/// The point of a sample on the fine mesh.
static bat_mesh_point sample_of(size_t sample)
{
    const double *shares = SHARES[sample % SAMPLES];
    return (bat_mesh_point){(uint32_t)(sample / SAMPLES), {shares[0], shares[1], shares[2]}};
}

/// Carry one value of the fine vertices. It stays within the range of the samples around each vertex.
static void pull_values(pull *all, const double *from, double *to, size_t width)
{
    size_t n = all->coarse->vertex_count;
    double *right = all->numbers[0], *low = all->numbers[1], *high = all->numbers[2], *c = all->numbers[3];
    for (size_t v = 0; v < n; v++)
    {
        double here = map_value_at(all->fine, from, width, &all->images[v]);
        low[v] = high[v] = here;
        right[v] = all->anchor[v] * here;
    }
    for (size_t i = 0; i < SAMPLES * all->fine->face_count; i++)
    {
        const bat_mesh_point sample = sample_of(i);
        double value = map_value_at(all->fine, from, width, &sample);
        for (size_t k = 0; k < 3; k++)
        {
            uint32_t v = all->coarse->faces[3 * (size_t)all->samples[i].face + k];
            right[v] += all->weights[i / SAMPLES] * all->samples[i].barycentric[k] * value;
            low[v] = fmin(low[v], value);
            high[v] = fmax(high[v], value);
        }
    }
    for (size_t v = 0; v < n; v++)
        c[v] = right[v] / all->rows[v];
    solve(all, right, all->numbers[4], c);
    for (size_t v = 0; v < n; v++)
        to[width * v] = fmin(high[v], fmax(low[v], c[v]));
}

/// Map the samples and the vertices, and set up the equations.
static bat_status begin(const bat_mesh_map *map, pull *all, memory_pool *pool, bat_error *error)
{
    static const double share = 0.01; // of the rows' sums, in D
    const bat_mesh *fine = all->fine, *coarse = all->coarse;
    size_t count = SAMPLES * fine->face_count, n = coarse->vertex_count;
    all->samples = memory_pool_array(pool, count, sizeof *all->samples);
    all->images = memory_pool_array(pool, n, sizeof *all->images);
    all->weights = memory_pool_array(pool, fine->face_count, sizeof *all->weights);
    all->rows = memory_pool_zeros(pool, n, sizeof *all->rows);
    all->anchor = memory_pool_array(pool, n, sizeof *all->anchor);
    for (size_t i = 0; i < sizeof all->numbers / sizeof *all->numbers; i++)
        all->numbers[i] = memory_pool_array(pool, n, sizeof *all->numbers[i]);
    bat_status status = memory_pool_check(pool, error);
    if (status != BAT_OK)
        return status;
    double total = 0;
    for (size_t f = 0; f < fine->face_count; f++)
    {
        double normal[3];
        vector3_face(fine->positions, fine->faces + 3 * f, normal);
        all->weights[f] = vector3_length(normal);
        total += all->weights[f];
        for (size_t s = SAMPLES * f; s < SAMPLES * (f + 1); s++)
            all->samples[s] = sample_of(s);
    }
    bat_mesh_point *points;
    size_t points_count;
    status = bat_mesh_map_to_coarse(map, all->samples, count, error);
    if (status == BAT_OK)
        status = bat_mesh_midpoints(coarse, 0, &points, &points_count, error);
    if (status != BAT_OK)
        return status;
    memcpy(all->images, points, n * sizeof *points);
    free(points);
    for (size_t f = 0; f < fine->face_count; f++)
        all->weights[f] = total > 0 ? all->weights[f] / total : 1;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++)
            all->rows[coarse->faces[3 * (size_t)all->samples[i].face + k]] +=
                all->weights[i / SAMPLES] * all->samples[i].barycentric[k];
    for (size_t v = 0; v < n; v++)
    {
        all->anchor[v] = share * all->rows[v] + 1e-9 / (double)n;
        all->rows[v] += all->anchor[v];
    }
    return bat_mesh_map_to_fine(map, all->images, n, error);
}

/// Give every coarse face the label with most of the fine area in it.
static bat_status pull_labels(const pull *all, const bat_mesh *coarse, uint32_t *labels, bat_error *error)
{
    key_map numbers = {0};
    size_t count = SAMPLES * all->fine->face_count, used = 0;
    double *area = memory_array(count, sizeof *area), *most = calloc(coarse->face_count, sizeof *most);
    bool room = area != NULL && most != NULL;
    for (size_t i = 0; i < count && room; i++)
    {
        uint32_t face = all->samples[i].face, label = all->fine->face_labels[i / SAMPLES];
        uint32_t *number = key_map_at(&numbers, (uint64_t)face << 32 | label);
        room = number != NULL;
        if (!room)
            break;
        if (*number == UINT32_MAX)
        {
            *number = (uint32_t)used;
            area[used++] = 0;
        }
        area[*number] += all->weights[i / SAMPLES];
        if (area[*number] > most[face])
        {
            most[face] = area[*number];
            labels[face] = label;
        }
    }
    key_map_free(&numbers);
    free(area);
    free(most);
    return room ? BAT_OK : error_memory(error, count * sizeof *area);
}

/// Carry the normals of the fine vertices; `normals` receives an array.
static bat_status pull_normals(pull *all, double **normals, bat_error *error)
{
    size_t n = all->coarse->vertex_count;
    double *from = memory_array(all->fine->vertex_count, 3 * sizeof *from), *to = memory_array(n, 3 * sizeof *to),
           *own = memory_array(n, 3 * sizeof *own);
    bat_status status = from != NULL && to != NULL && own != NULL ? BAT_OK : error_memory(error, 3 * n * sizeof *to);
    if (status == BAT_OK)
        status = bat_mesh_vertex_normals(all->fine, BAT_MESH_NORMALS_ANGLE, from, error);
    if (status == BAT_OK)
        status = bat_mesh_vertex_normals(all->coarse, BAT_MESH_NORMALS_ANGLE, own, error);
    for (size_t k = 0; k < 3 && status == BAT_OK; k++)
        pull_values(all, from + k, to + k, 3);
    for (size_t v = 0; v < n && status == BAT_OK; v++)
        if (!vector3_normalize(to + 3 * v))
            memcpy(to + 3 * v, own + 3 * v, 3 * sizeof *to);
    free(from);
    free(own);
    if (status == BAT_OK)
        *normals = to;
    else
        free(to);
    return status;
}

/// Carry channels and labels into `made`, which holds nothing else.
static bat_status pull_all(pull *all, bat_mesh *made, bat_error *error)
{
    const bat_mesh *fine = all->fine, *coarse = all->coarse;
    bat_status status = fine->channel_count > 0 ? channels_make(fine, coarse->vertex_count, made, error) : BAT_OK;
    for (size_t k = 0; k < fine->channel_count && status == BAT_OK; k++)
        pull_values(all, fine->channels + k, made->channels + k, fine->channel_count);
    if (coarse->face_labels == NULL || coarse->label_count != fine->label_count || status != BAT_OK)
        return status;
    if (!mesh_copy_array(coarse->face_labels, coarse->face_count, sizeof *made->face_labels, (void **)&made->face_labels))
        return error_memory(error, coarse->face_count * sizeof *made->face_labels);
    return pull_labels(all, coarse, made->face_labels, error);
}

bat_status bat_mesh_transfer(const bat_mesh_map *map, const bat_mesh *fine, bat_mesh *coarse, double **normals,
                             bat_error *error)
{
    pull all = {.fine = fine, .coarse = coarse};
    memory_pool pool = {0};
    bat_mesh made = {0};
    double *carried = NULL;
    bat_status status = map_check(map, fine, coarse, error);
    if (status == BAT_OK)
        status = begin(map, &all, &pool, error);
    if (status == BAT_OK)
        status = pull_all(&all, &made, error);
    if (status == BAT_OK && normals != NULL)
        status = pull_normals(&all, &carried, error);
    if (status == BAT_OK && fine->texture_faces != NULL && coarse->texture_faces == NULL)
        status = bat_mesh_map_transfer(map, fine, coarse, 0, coarse, error);
    memory_pool_free(&pool);
    if (status == BAT_OK)
    {
        mesh_swap_channels(coarse, &made);
        if (made.face_labels != NULL)
            SWAP(coarse->face_labels, made.face_labels);
        if (normals != NULL)
            *normals = carried;
    }
    else
        free(carried);
    bat_mesh_free(&made);
    return status;
}

// Chains

bat_status bat_mesh_lods(const bat_mesh *fine, const double *shares, size_t count, const bat_mesh_decimate_options *options,
                         bat_mesh *levels, double *distances, bat_error *error)
{
    bat_mesh_decimate_options how = options != NULL ? *options : bat_mesh_decimate_defaults();
    how.vertices = 0;
    how.ratio = how.tolerance = 0;
    for (size_t i = 0; i < count; i++)
        if (!(shares[i] > 0 && shares[i] <= 1) || (i > 0 && shares[i] >= shares[i - 1]))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0,
                             "the shares of faces must decrease from at most 1 to above 0, but number %zu is %g", i,
                             shares[i]);
    bat_mesh *made = calloc(count + 1, sizeof *made);
    bat_status status = made != NULL ? BAT_OK : error_memory(error, count * sizeof *made);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        bat_mesh_distance measured = {0};
        how.faces = (size_t)fmax(1, round(shares[i] * (double)fine->face_count));
        status = shares[i] < 1 ? bat_mesh_decimate(i > 0 ? &made[i - 1] : fine, &how, &made[i], NULL, error)
                               : bat_mesh_copy(fine, &made[i], error);
        if (status == BAT_OK && shares[i] < 1 && distances != NULL)
            status = bat_mesh_compare(&made[i], fine, NULL, &measured, error);
        if (status == BAT_OK && distances != NULL)
            distances[i] = measured.hausdorff;
    }
    for (size_t i = 0; i < count && made != NULL; i++)
        if (status == BAT_OK)
            levels[i] = made[i];
        else
            bat_mesh_free(&made[i]);
    free(made);
    return status;
}
