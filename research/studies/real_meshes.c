/// @file
/// Schemes on coarse meshes that other programs made: how near the refined meshes come to the shapes.

#include "batten/research/mesh_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "batten/mesh_file.h"
#include "batten/mesh_measure.h"
#include "linalg/vector.h"
#include "research/studies/folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    PATH_SIZE = 4096,
    MAX_LEVELS = 6,
    CLASSICAL = 3, ///< the first methods
    MAX_METHODS = 7,
    NAME_SIZE = BAT_REAL_MESHES_NAME
};

static const struct
{
    const char *name;
    bat_mesh_scheme scheme;
    double fairness; ///< negative: the default
    bool given;
} METHODS[MAX_METHODS] = {{"flat", BAT_MESH_SCHEME_MIDPOINT, -1, false},
                          {"butterfly", BAT_MESH_SCHEME_BUTTERFLY, -1, false},
                          {"loop", BAT_MESH_SCHEME_LOOP, -1, false},
                          {"learned", BAT_MESH_SCHEME_LEARNED, -1, false},
                          {"learned, fairness 0", BAT_MESH_SCHEME_LEARNED, 0, false},
                          {"learned, fairness 1", BAT_MESH_SCHEME_LEARNED, 1, false},
                          {"given", BAT_MESH_SCHEME_LEARNED, -1, true}};

bat_real_meshes_options bat_real_meshes_defaults(void)
{
    return (bat_real_meshes_options){.levels = 2, .samples = 100000};
}

// Files

static bool is_coarse(const char *name)
{
    const char *end = strrchr(name, '.');
    return end != NULL && strcmp(end, ".off") == 0;
}

/// The files of a folder whose names end in .off.
static bat_status list_coarse(const char *folder, folder_list *list, bat_error *error)
{
    char path[PATH_SIZE];
    (void)snprintf(path, sizeof path, "%s/coarse-by", folder);
    bat_status status = folder_read(path, is_coarse, list, error);
    if (status == BAT_OK && list->count == 0)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "%s: there are no files SHAPE-VERTICES-WAY.off", path);
    return status;
}

/// Split "SHAPE-VERTICES-WAY.off".
static bool split_name(const char *file, char shape[NAME_SIZE], char way[NAME_SIZE])
{
    const char *end = strrchr(file, '.'), *last = NULL, *middle = NULL;
    for (const char *c = file; c < end; c++)
        if (*c == '-')
        {
            middle = last;
            last = c;
        }
    if (middle == NULL || middle == file || middle - file >= NAME_SIZE || end - last > NAME_SIZE)
        return false;
    (void)snprintf(shape, NAME_SIZE, "%.*s", (int)(middle - file), file);
    (void)snprintf(way, NAME_SIZE, "%.*s", (int)(end - last - 1), last + 1);
    return true;
}

static bat_status read_shape(const char *folder, const char *shape, bat_mesh *mesh, bat_error *error)
{
    static const char *const ENDINGS[] = {"obj", "ply", "off"};
    char path[PATH_SIZE];
    for (size_t i = 0; i < sizeof ENDINGS / sizeof *ENDINGS; i++)
    {
        (void)snprintf(path, sizeof path, "%s/%s.%s", folder, shape, ENDINGS[i]);
        FILE *file = fopen(path, "rb");
        if (file == NULL)
            continue;
        (void)fclose(file);
        return folder_mesh_read(path, mesh, error);
    }
    return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "%s: there is no %s.obj, %s.ply or %s.off", folder, shape,
                     shape, shape);
}

// Measures

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void face_normal(const bat_mesh *mesh, size_t face, double normal[3])
{
    const uint32_t *corner = mesh->faces + 3 * face;
    vector3_triangle(mesh->positions + 3 * (size_t)corner[0], mesh->positions + 3 * (size_t)corner[1],
                     mesh->positions + 3 * (size_t)corner[2], normal);
}

/// The 95 % quantile of the angles between neighbouring faces.
static bat_status measure_angle(const bat_mesh *mesh, double *angle, bat_error *error)
{
    bat_mesh_connectivity links;
    size_t count = 0;
    bat_status status = bat_mesh_connect(mesh, &links, error);
    if (status != BAT_OK)
        return status;
    double *angles = memory_array(links.edge_count, sizeof *angles);
    for (size_t h = 0; h < 3 * mesh->face_count && angles != NULL; h++)
    {
        uint32_t twin = links.twin[h];
        double n[3], m[3], product[3];
        if (twin == BAT_MESH_NONE || twin < h)
            continue;
        face_normal(mesh, h / 3, n);
        face_normal(mesh, twin / 3, m);
        vector3_cross(n, m, product);
        angles[count++] = atan2(sqrt(vector3_dot(product, product)), vector3_dot(n, m));
    }
    if (angles == NULL)
        status = error_memory(error, links.edge_count * sizeof *angles);
    else
    {
        qsort(angles, count, sizeof *angles, compare_numbers);
        *angle = count > 0 ? angles[(size_t)(0.95 * (double)(count - 1))] : 0;
    }
    free(angles);
    bat_mesh_connectivity_free(&links);
    return status;
}

/// The same with all vertices moved to the closest points of the shape, in place.
static bat_status measure_true_angle(bat_mesh *fine, const bat_mesh *shape, int threads, double *angle, bat_error *error)
{
    bat_mesh_closest_point *closest = memory_array(fine->vertex_count, sizeof *closest);
    if (closest == NULL)
        return error_memory(error, fine->vertex_count * sizeof *closest);
    bat_status status = bat_mesh_closest(shape, fine->positions, fine->vertex_count, threads, closest, error);
    for (size_t v = 0; v < fine->vertex_count && status == BAT_OK; v++)
        memcpy(fine->positions + 3 * v, closest[v].position, sizeof closest[v].position);
    free(closest);
    return status == BAT_OK ? measure_angle(fine, angle, error) : status;
}

static bat_status measure_volume(const bat_mesh *fine, const bat_mesh *shape, double *volume, bat_error *error)
{
    bat_mesh_summary ours, theirs;
    bat_status status = bat_mesh_summarize(fine, &ours, error);
    if (status == BAT_OK)
        status = bat_mesh_summarize(shape, &theirs, error);
    if (status == BAT_OK)
        *volume = ours.volume / theirs.volume - 1;
    return status;
}

static bat_status measure_method(const bat_mesh *coarse, const bat_mesh *shape, size_t method,
                                 const bat_real_meshes_options *options, bat_real_meshes_row *row, bat_error *error)
{
    bat_mesh_refine_options refine = bat_mesh_refine_defaults();
    bat_mesh_compare_options compare = bat_mesh_compare_defaults();
    bat_mesh fine;
    bat_mesh_distance distance;
    refine.scheme = METHODS[method].scheme;
    refine.fairness = METHODS[method].fairness >= 0 ? METHODS[method].fairness : refine.fairness;
    refine.rule = METHODS[method].given ? bat_mesh_model_rule(options->model) : NULL;
    refine.levels = options->levels;
    refine.threads = compare.threads = options->threads;
    compare.samples = options->samples;
    row->method = METHODS[method].name;
    row->vertices = coarse->vertex_count;
    bat_status status = bat_mesh_refine(coarse, &refine, &fine, NULL, error);
    if (status != BAT_OK)
        return status;
    status = bat_mesh_compare(&fine, shape, &compare, &distance, error);
    if (status == BAT_OK)
    {
        row->mean = distance.mean / distance.diagonal;
        row->hausdorff = distance.hausdorff / distance.diagonal;
        status = measure_angle(&fine, &row->angle, error);
    }
    if (status == BAT_OK)
        status = measure_volume(&fine, shape, &row->volume, error);
    if (status == BAT_OK)
        status = measure_true_angle(&fine, shape, options->threads, &row->true_angle, error);
    bat_mesh_free(&fine);
    return status;
}

/// Measure all methods on one coarse mesh; `rows` has room for them.
static bat_status measure_file(const char *folder, const char *file, const bat_real_meshes_options *options, size_t methods,
                               bat_real_meshes_row *rows, bat_error *error)
{
    char name[NAME_SIZE], way[NAME_SIZE], path[PATH_SIZE];
    bat_mesh shape = {0}, coarse = {0};
    if (!split_name(file, name, way))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "%s: the name is not SHAPE-VERTICES-WAY.off", file);
    (void)snprintf(path, sizeof path, "%s/coarse-by/%s", folder, file);
    bat_status status = read_shape(folder, name, &shape, error);
    if (status == BAT_OK)
        status = folder_mesh_read(path, &coarse, error);
    double best = INFINITY;
    for (size_t i = 0; i < methods && status == BAT_OK; i++)
    {
        rows[i] = (bat_real_meshes_row){0};
        memcpy(rows[i].shape, name, sizeof name);
        memcpy(rows[i].way, way, sizeof way);
        status = measure_method(&coarse, &shape, i, options, &rows[i], error);
        best = i < CLASSICAL ? fmin(best, rows[i].mean) : best;
    }
    for (size_t i = 0; i < methods; i++)
        rows[i].relative = rows[i].mean / best;
    bat_mesh_free(&shape);
    bat_mesh_free(&coarse);
    return status;
}

bat_status bat_real_meshes(const char *folder, const bat_real_meshes_options *options, bat_real_meshes_row **rows,
                           size_t *count, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_real_meshes_options, levels, OPTION_SIZE, 1, MAX_LEVELS),
        OPTION_FIELD(bat_real_meshes_options, samples, OPTION_SIZE, 1, 1000000000),
        OPTION_THREADS(bat_real_meshes_options),
    };
    const bat_real_meshes_options defaults = bat_real_meshes_defaults();
    folder_list files = {0};
    options = options != NULL ? options : &defaults;
    bat_status status = OPTIONS_CHECK(options, FIELDS, error);
    if (status == BAT_OK)
        status = list_coarse(folder, &files, error);
    size_t methods = options->model != NULL ? MAX_METHODS : MAX_METHODS - 1;
    bat_real_meshes_row *made = NULL;
    if (status == BAT_OK)
    {
        made = memory_array(files.count, methods * sizeof *made);
        if (made == NULL)
            status = error_memory(error, files.count * methods * sizeof *made);
    }
    const bat_progress *progress = &options->progress;
    for (size_t i = 0; i < files.count && status == BAT_OK; i++)
    {
        if (progress->report != NULL && !progress->report(progress->context, (double)i / (double)files.count))
            status = error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the study was stopped");
        else
            status = measure_file(folder, files.names[i], options, methods, made + i * methods, error);
    }
    if (status == BAT_OK)
    {
        *rows = made;
        *count = files.count * methods;
    }
    else
        free(made);
    folder_list_free(&files);
    return status;
}
