/// @file
/// The verdict on surfaces of scans, against the truth: discs cut from meshes, and deep shapes of formulas.
///
/// A crop is the part of a mesh within a graph distance of a vertex; it is one if it is a topological disc. Its vertices,
/// with noise, are the cloud, or as many places as a scanner sees them; its triangles are the truth. A surface is right if
/// 99 % of the truth's vertices are within MAX_MISSED of it, 99 % of its own area are within MAX_STRAY of the truth, both as
/// shares of the size and beside the noise, and the areas agree to AREA.

#include "batten/research/mesh_study.h"
#include "batten/research/surface_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "base/progress.h"
#include "batten/mesh_file.h"
#include "batten/mesh_measure.h"
#include "io/surface/step.h"
#include "linalg/vector.h"
#include "research/studies/folder.h"
#include "research/studies/mesh_points.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    PATH_SIZE = 4096,
    TRIES = 60,     ///< seeds of a crop
    MIN_CROP = 600, ///< vertices
    MAX_CROP = 8000,
    SCAN_MIN = 2000, ///< points of a scanner
    SCAN_MAX = 15000,
    GRID = 96, ///< cells of a formula, in each direction
    SHAPE_POINTS = 3000,
    EDGE_POINTS = 240 ///< of these, along the boundary
};

static const double MAX_MISSED = 0.02, MAX_STRAY = 0.03;
static const double AREA[2] = {0.8, 1.25};
static const double NOISES[] = {0, 0.0005, 0.002, 0.005};
static const double PI = 3.14159265358979323846;

bat_scan_verdict_options bat_scan_verdict_defaults(void)
{
    return (bat_scan_verdict_options){.crops = 3, .seed = 1};
}

// Shapes of formulas over the unit square

static void roll(double u, double v, double p[3])
{
    double angle = 2.5 * PI * u, radius = 0.3 + 0.25 * u;
    p[0] = radius * cos(angle);
    p[1] = radius * sin(angle);
    p[2] = v;
}

static void tube(double u, double v, double p[3])
{
    double angle = 340 * PI / 180 * u;
    p[0] = 0.3 * cos(angle);
    p[1] = 0.3 * sin(angle);
    p[2] = v + 0.1 * sin(angle) * v;
}

static void ear(double u, double v, double p[3])
{
    double x = 2 * u - 1, y = 2 * v - 1, radius = fmax(fabs(x), fabs(y)), angle = atan2(y, x), polar = 0.72 * PI * radius;
    p[0] = 0.5 * sin(polar) * cos(angle);
    p[1] = 0.35 * sin(polar) * sin(angle);
    p[2] = -0.5 * cos(polar);
}

static void saddle(double u, double v, double p[3])
{
    p[0] = u;
    p[1] = v;
    p[2] = 1.5 * (u - 0.5) * (u - 0.5) - 1.5 * (v - 0.5) * (v - 0.5);
}

static void terrain(double u, double v, double p[3])
{
    p[0] = u;
    p[1] = v;
    p[2] = 0.08 * sin(7 * u + 1) * cos(6 * v) + 0.03 * sin(19 * u * v + 3 * v) + 0.02 * cos(17 * u);
}

static void hull(double u, double v, double p[3])
{
    double width = 0.2 * sin(PI * (0.1 + 0.8 * u)), angle = PI * v;
    p[0] = u;
    p[1] = width * cos(angle);
    p[2] = -1.2 * width * sin(angle);
}

static void hand(double u, double v, double p[3])
{
    double bend = 0.6 * PI * u * u;
    p[0] = 0.6 * sin(bend) + 0.4 * u;
    p[1] = v * (0.7 + 0.3 * u);
    p[2] = 0.6 * cos(bend) + 0.05 * cos(8 * PI * v) * u;
}

static const struct
{
    const char *name;
    void (*at)(double u, double v, double p[3]);
} SHAPES[] = {{"roll", roll},       {"tube", tube}, {"ear", ear},  {"saddle", saddle},
              {"terrain", terrain}, {"hull", hull}, {"hand", hand}};
enum
{
    SHAPE_COUNT = sizeof SHAPES / sizeof *SHAPES
};

/// The parameters of a vertex of the grid.
static void grid_place(size_t vertex, double at[2])
{
    size_t column = vertex % (GRID + 1), row = vertex / (GRID + 1);
    at[0] = (double)column / GRID;
    at[1] = (double)row / GRID;
}

/// A truth of a formula, random points on it, and points along its boundary.
static bat_status make_shape(size_t shape, bat_random *random, bat_mesh *truth, bat_cloud *cloud, bat_error *error)
{
    bat_status status = mesh_of_grid(GRID, truth, error);
    if (status != BAT_OK)
        return status;
    for (size_t v = 0; v < truth->vertex_count; v++)
    {
        double at[2];
        grid_place(v, at);
        SHAPES[shape].at(at[0], at[1], truth->positions + 3 * v);
    }
    *cloud = (bat_cloud){.points = malloc(SHAPE_POINTS * 3 * sizeof *cloud->points), .count = SHAPE_POINTS};
    if (cloud->points == NULL)
        return error_memory(error, SHAPE_POINTS * 3 * sizeof *cloud->points);
    for (size_t i = 0; i < SHAPE_POINTS; i++)
    {
        double u = bat_random_uniform(random), v = bat_random_uniform(random);
        if (i < EDGE_POINTS)
            *(i % 2 == 0 ? &u : &v) = i % 4 < 2 ? 0 : 1;
        SHAPES[shape].at(u, v, cloud->points + 3 * i);
    }
    return BAT_OK;
}

// Crops

/// Mark the vertices within `wanted` steps of breadth-first search from a vertex.
static size_t grow(const bat_mesh *mesh, const uint32_t *starts, const uint32_t *around, uint32_t seed, size_t wanted,
                   uint32_t *queue, bool *inside)
{
    size_t head = 0, tail = 0;
    memset(inside, 0, mesh->vertex_count * sizeof *inside);
    queue[tail++] = seed;
    inside[seed] = true;
    while (head < tail && tail < wanted)
    {
        uint32_t v = queue[head++];
        for (uint32_t k = starts[v]; k < starts[v + 1]; k++)
            if (!inside[around[k]])
            {
                inside[around[k]] = true;
                queue[tail++] = around[k];
            }
    }
    return tail;
}

/// The neighbours of vertex v along faces are around[starts[v]] to around[starts[v + 1] - 1], twice inside the mesh.
static bat_status find_around(const bat_mesh *mesh, uint32_t **starts, uint32_t **around, bat_error *error)
{
    *starts = calloc(mesh->vertex_count + 2, sizeof **starts);
    *around = malloc((6 * mesh->face_count + 1) * sizeof **around);
    if (*starts == NULL || *around == NULL)
        return error_memory(error, 6 * mesh->face_count * sizeof **around);
    for (size_t h = 0; h < 3 * mesh->face_count; h++)
        (*starts)[mesh->faces[h] + 2] += 2;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        (*starts)[v + 2] += (*starts)[v + 1];
    for (size_t h = 0; h < 3 * mesh->face_count; h++)
        for (size_t k = 1; k < 3; k++)
            (*around)[(*starts)[mesh->faces[h] + 1]++] = mesh->faces[h / 3 * 3 + (h % 3 + k) % 3];
    return BAT_OK;
}

/// The part of a mesh with the marked vertices that have a face.
static bat_status cut(const bat_mesh *mesh, const bool *inside, bat_mesh *part, bat_error *error)
{
    uint32_t *place = malloc(mesh->vertex_count * sizeof *place);
    *part = (bat_mesh){.positions = malloc(mesh->vertex_count * 3 * sizeof *part->positions),
                       .faces = malloc(mesh->face_count * 3 * sizeof *part->faces)};
    if (place == NULL || part->positions == NULL || part->faces == NULL)
    {
        free(place);
        bat_mesh_free(part);
        return error_memory(error, mesh->vertex_count * 3 * sizeof *part->positions);
    }
    memset(place, 0xff, mesh->vertex_count * sizeof *place);
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *face = mesh->faces + 3 * f;
        if (!inside[face[0]] || !inside[face[1]] || !inside[face[2]])
            continue;
        for (int c = 0; c < 3; c++)
        {
            uint32_t v = face[c];
            if (place[v] == BAT_MESH_NONE)
            {
                memcpy(part->positions + 3 * part->vertex_count, mesh->positions + 3 * (size_t)v, 3 * sizeof(double));
                place[v] = (uint32_t)part->vertex_count++;
            }
            part->faces[3 * part->face_count + (size_t)c] = place[v];
        }
        part->face_count++;
    }
    free(place);
    return BAT_OK;
}

/// Cut a disc from a mesh. `cloud` receives its vertices without their connectivity; `count` 0 where none is found.
static bat_status make_crop(const bat_mesh *mesh, bat_random *random, bat_mesh *truth, bat_cloud *cloud, bat_error *error)
{
    uint32_t *starts = NULL, *around = NULL, *queue = malloc((mesh->vertex_count + 1) * sizeof *queue);
    bool *inside = malloc(mesh->vertex_count + 1);
    bat_status status = queue == NULL || inside == NULL ? error_memory(error, mesh->vertex_count)
                                                        : find_around(mesh, &starts, &around, error);
    size_t most = mesh->vertex_count * 2 / 5 < MAX_CROP ? mesh->vertex_count * 2 / 5 : MAX_CROP;
    for (int k = 0; k < TRIES && status == BAT_OK && cloud->count == 0 && most > MIN_CROP; k++)
    {
        uint32_t seed = (uint32_t)(bat_random_uniform(random) * (double)mesh->vertex_count);
        size_t wanted = MIN_CROP + (size_t)(bat_random_uniform(random) * (double)(most - MIN_CROP));
        if (grow(mesh, starts, around, seed, wanted, queue, inside) < MIN_CROP)
            continue;
        bat_mesh part;
        status = cut(mesh, inside, &part, error);
        if (status != BAT_OK)
            break;
        bat_cloud disc = {0};
        if (bat_cloud_from_mesh(&part, &disc, NULL) == BAT_OK && disc.count >= MIN_CROP)
        {
            free(disc.triangles);
            free(disc.order);
            *cloud = (bat_cloud){.points = disc.points, .count = disc.count};
            *truth = part;
        }
        else
        {
            bat_cloud_free(&disc);
            bat_mesh_free(&part);
        }
    }
    free(starts);
    free(around);
    free(queue);
    free(inside);
    return status;
}

// Scanners

/// The direction that a scanner looks from: the mean normal of a mesh, tilted at random.
static void choose_view(const bat_mesh *mesh, bat_random *random, double view[3])
{
    static const double TILT = 0.4;
    double normal[3], sum[3] = {0};
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const double *corners[3];
        for (size_t k = 0; k < 3; k++)
            corners[k] = mesh->positions + 3 * (size_t)mesh->faces[3 * f + k];
        vector3_triangle(corners[0], corners[1], corners[2], normal);
        for (int k = 0; k < 3; k++)
            sum[k] += normal[k];
    }
    (void)vector3_normalize(sum);
    for (int k = 0; k < 3; k++)
        view[k] = sum[k] + TILT * bat_random_normal(random);
    (void)vector3_normalize(view);
}

/// The least density of points, as a share of the largest.
static const double MIN_DENSITY = 0.08;

/// The density of points on a face: the cosine of the angle of view.
static double density_of(const void *view, const double normal[3])
{
    return fmax(fabs(vector3_dot(normal, view)), MIN_DENSITY);
}

/// Replace a cloud by four times as many random places of a mesh, at least 2,000 and at most 15,000.
static bat_status see(const bat_mesh *mesh, const double view[3], bat_random *random, bat_cloud *cloud, bat_error *error)
{
    size_t count = cloud->count < SCAN_MIN / 4 ? SCAN_MIN : cloud->count > SCAN_MAX / 4 ? SCAN_MAX : 4 * cloud->count;
    double *sums = memory_array(mesh->face_count + 1, sizeof *sums);
    double *points = realloc(cloud->points, count * 3 * sizeof *points);
    cloud->points = points != NULL ? points : cloud->points;
    if (sums == NULL || points == NULL)
    {
        free(sums);
        return error_memory(error, (mesh->face_count + 1) * sizeof *sums);
    }
    cloud->count = count;
    mesh_face_sums(mesh, density_of, view, sums);
    for (size_t i = 0; i < cloud->count; i++)
    {
        double wanted = bat_random_uniform(random) * sums[mesh->face_count];
        double u = bat_random_uniform(random), v = bat_random_uniform(random);
        const uint32_t *face = mesh->faces + 3 * mesh_face_at(sums, mesh->face_count, wanted);
        const double shares[3] = {u + v > 1 ? u + v - 1 : 1 - u - v, u + v > 1 ? 1 - u : u, u + v > 1 ? 1 - v : v};
        for (size_t d = 0; d < 3; d++)
        {
            cloud->points[3 * i + d] = 0;
            for (size_t k = 0; k < 3; k++)
                cloud->points[3 * i + d] += shares[k] * mesh->positions[3 * (size_t)face[k] + d];
        }
    }
    free(sums);
    return BAT_OK;
}

// Judgement by the truth

static double size_of(const bat_mesh *mesh)
{
    double size = 0;
    for (size_t k = 0; k < 3; k++)
    {
        double low = INFINITY, high = -INFINITY;
        for (size_t v = 0; v < mesh->vertex_count; v++)
        {
            low = fmin(low, mesh->positions[3 * v + k]);
            high = fmax(high, mesh->positions[3 * v + k]);
        }
        size = fmax(size, high - low);
    }
    return size;
}

static double area_of_face(const bat_mesh *mesh, size_t face)
{
    const double *corners[3];
    double normal[3];
    for (size_t k = 0; k < 3; k++)
        corners[k] = mesh->positions + 3 * (size_t)mesh->faces[3 * face + k];
    vector3_triangle(corners[0], corners[1], corners[2], normal);
    return 0.5 * sqrt(vector3_dot(normal, normal));
}

static double area_of(const bat_mesh *mesh)
{
    double area = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
        area += area_of_face(mesh, f);
    return area;
}

/// A distance and its weight, for sorting.
typedef struct weighted_distance
{
    double distance, weight;
} weighted_distance;

static int compare_weighted(const void *a, const void *b)
{
    const weighted_distance *x = a, *y = b;
    return ascending(&x->distance, &y->distance);
}

/// Add a third of the area of each triangle to its vertices.
static void weigh_by_area(const bat_mesh *mesh, weighted_distance *vertices)
{
    for (size_t f = 0; f < mesh->face_count; f++)
        for (int k = 0; k < 3; k++)
            vertices[mesh->faces[3 * f + (size_t)k]].weight += area_of_face(mesh, f) / 3;
}

/// The distance from another mesh that 99 % of a mesh has at most: of its vertices, or of its area.
static bat_status distance_quantile(const bat_mesh *from, const bat_mesh *onto, bool by_area, int threads, double *quantile,
                                    bat_error *error)
{
    size_t count = from->vertex_count;
    double *distances = memory_array(count, sizeof *distances), total = 0, below = 0;
    weighted_distance *sorted = memory_array(count, sizeof *sorted);
    bat_status status = distances == NULL || sorted == NULL
                            ? error_memory(error, count * sizeof *sorted)
                            : bat_mesh_vertex_distances(from, onto, threads, distances, error);
    if (status == BAT_OK)
    {
        for (size_t v = 0; v < count; v++)
            sorted[v] = (weighted_distance){distances[v], by_area ? 0 : 1};
        if (by_area)
            weigh_by_area(from, sorted);
        for (size_t v = 0; v < count; v++)
            total += sorted[v].weight;
        qsort(sorted, count, sizeof *sorted, compare_weighted);
        size_t last = 0;
        while (last + 1 < count && (below += sorted[last].weight) < 0.99 * total)
            last++;
        *quantile = sorted[last].distance;
    }
    free(distances);
    free(sorted);
    return status;
}

static bat_status measure(const bat_spline_surface *surface, const bat_mesh *truth, int threads, bat_scan_verdict_row *row,
                          bat_error *error)
{
    surface_tessellation samples;
    bat_status status = surface_tessellate(surface, 0, &samples, error);
    if (status != BAT_OK)
        return status;
    const bat_mesh sampled = {.positions = samples.positions,
                              .vertex_count = samples.vertex_count,
                              .faces = samples.triangles,
                              .face_count = samples.triangle_count};
    status = distance_quantile(truth, &sampled, false, threads, &row->distance_from_surface, error);
    if (status == BAT_OK)
        status = distance_quantile(&sampled, truth, true, threads, &row->distance_from_points, error);
    row->distance_from_surface /= size_of(truth);
    row->distance_from_points /= size_of(truth);
    row->area = area_of(&sampled) / area_of(truth);
    row->is_right = row->distance_from_surface <= MAX_MISSED + 2 * row->noise &&
                    row->distance_from_points <= MAX_STRAY + 2 * row->noise && row->area >= AREA[0] && row->area <= AREA[1];
    tessellation_free(&samples);
    return status;
}

static bat_status judge(const bat_mesh *truth, bat_cloud *cloud, bat_random *random, const bat_scan_verdict_options *options,
                        bat_scan_verdict_row *row, bat_error *error)
{
    double deviation = row->noise * size_of(truth), view[3];
    if (options->scanner)
    {
        choose_view(truth, random, view);
        bat_status seen = see(truth, view, random, cloud, error);
        if (seen != BAT_OK)
            return seen;
        for (size_t i = 0; i < cloud->count; i++)
        {
            double error_along = deviation * bat_random_normal(random);
            for (size_t k = 0; k < 3; k++)
                cloud->points[3 * i + k] += error_along * view[k];
        }
    }
    for (size_t k = 0; k < 3 * cloud->count && !options->scanner; k++)
        cloud->points[k] += deviation * bat_random_normal(random);
    bat_surface_reconstruct_options fit = bat_surface_reconstruct_defaults();
    bat_surface_result result;
    bat_error failure = {0};
    fit.force = true;
    fit.fit.threads = options->threads;
    row->points = cloud->count;
    bat_status status = bat_surface_reconstruct(cloud, &fit, &result, &failure);
    if (status == BAT_NO_MEMORY)
        return error_set(error, status, failure.index, failure.line, "%s", failure.text);
    if (status != BAT_OK)
    {
        (void)snprintf(row->failure, sizeof row->failure, "%s", failure.text);
        return BAT_OK;
    }
    row->fault = result.verdict.fault;
    row->doubt = result.verdict.doubt;
    row->is_accepted = row->fault == BAT_SURFACE_FAULT_NONE;
    status = measure(&result.surface, truth, options->threads, row, error);
    bat_surface_result_free(&result);
    return status;
}

// Files

static bool is_mesh(const char *name)
{
    const char *end = strrchr(name, '.');
    return end != NULL && (strcmp(end, ".obj") == 0 || strcmp(end, ".off") == 0 || strcmp(end, ".ply") == 0);
}

/// The meshes of a folder: OBJ, OFF and PLY.
static bat_status list_meshes(const char *folder, folder_list *list, bat_error *error)
{
    bat_status status = folder_read(folder, is_mesh, list, error);
    for (size_t i = 0; i < list->count && status == BAT_OK; i++)
        if (strlen(list->names[i]) >= BAT_SCAN_VERDICT_NAME)
            status = error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "%s/%s: the name has more than %d bytes", folder,
                               list->names[i], BAT_SCAN_VERDICT_NAME - 1);
    return status != BAT_OK || list->count > 0
               ? status
               : error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "%s: there are no meshes (OBJ, OFF or PLY)", folder);
}

/// Crop a mesh and judge the crops; rows are added. Meshes without discs add none.
static bat_status study_mesh(const char *folder, const char *name, const bat_scan_verdict_options *options,
                             bat_random *random, bat_scan_verdict_row *rows, size_t *count, bat_error *error)
{
    char path[PATH_SIZE];
    bat_mesh mesh = {0};
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    bat_status status = folder_mesh_read(path, &mesh, error);
    for (size_t k = 0; k < options->crops && status == BAT_OK; k++)
    {
        bat_mesh truth = {0};
        bat_cloud cloud = {0};
        status = make_crop(&mesh, random, &truth, &cloud, error);
        if (status == BAT_OK && cloud.count > 0)
        {
            bat_scan_verdict_row *row = &rows[*count];
            *row = (bat_scan_verdict_row){.noise = NOISES[*count % (sizeof NOISES / sizeof *NOISES)]};
            strcpy(row->shape, name);
            status = judge(&truth, &cloud, random, options, row, error);
            *count += status == BAT_OK;
        }
        bat_mesh_free(&truth);
        bat_cloud_free(&cloud);
    }
    bat_mesh_free(&mesh);
    return status;
}

static bat_status study_shapes(const bat_scan_verdict_options *options, bat_random *random, bat_scan_verdict_row *rows,
                               size_t *count, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t shape = 0; shape < SHAPE_COUNT && status == BAT_OK; shape++)
    {
        bat_mesh truth = {0};
        bat_cloud cloud = {0};
        status = make_shape(shape, random, &truth, &cloud, error);
        bat_scan_verdict_row *row = &rows[*count];
        *row = (bat_scan_verdict_row){.noise = NOISES[*count % (sizeof NOISES / sizeof *NOISES)]};
        strcpy(row->shape, SHAPES[shape].name);
        if (status == BAT_OK)
            status = judge(&truth, &cloud, random, options, row, error);
        *count += status == BAT_OK;
        bat_mesh_free(&truth);
        bat_cloud_free(&cloud);
    }
    return status;
}

bat_status bat_scan_verdict(const char *folder, const bat_scan_verdict_options *options, bat_scan_verdict_row **rows,
                            size_t *count, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_scan_verdict_options, crops, OPTION_SIZE, 1, 1000),
        OPTION_THREADS(bat_scan_verdict_options),
    };
    const bat_scan_verdict_options defaults = bat_scan_verdict_defaults();
    options = options != NULL ? options : &defaults;
    size_t made = 0;
    folder_list files = {0};
    bat_status status = OPTIONS_CHECK(options, FIELDS, error);
    if (status != BAT_OK)
        return status;
    status = list_meshes(folder, &files, error);
    bat_scan_verdict_row *all = NULL;
    if (status == BAT_OK)
    {
        all = memory_array(files.count * options->crops + SHAPE_COUNT, sizeof *all);
        if (all == NULL)
            status = error_memory(error, (files.count * options->crops + SHAPE_COUNT) * sizeof *all);
    }
    bat_random random = bat_random_seed(options->seed);
    for (size_t i = 0; i < files.count && status == BAT_OK; i++)
        status = progress_goes_on(options->progress, (double)i / (double)(files.count + 1))
                     ? study_mesh(folder, files.names[i], options, &random, all, &made, error)
                     : error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the study was stopped");
    if (status == BAT_OK)
        status = study_shapes(options, &random, all, &made, error);
    folder_list_free(&files);
    if (status == BAT_OK)
    {
        *rows = all;
        *count = made;
    }
    else
        free(all);
    return status;
}
