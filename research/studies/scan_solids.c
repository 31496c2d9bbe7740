/// @file
/// Shells of clouds that are sampled from meshes, against the meshes.

#include "batten/research/mesh_study.h"
#include "batten/research/surface_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "base/progress.h"
#include "batten/mesh_measure.h"
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
    SAMPLES = 8,               ///< of a patch, for distances
    DISTANCE_SAMPLES = 100000, ///< on each surface
    CASES = 3                  ///< of a mesh
};

static const double NOISES[CASES] = {0, 0.001, 0.005};
static const double MAX_FAR = 0.02, MAX_VOLUME = 0.02;
/// Least density of a scanner, as a share of the largest.
static const double MIN_DENSITY = 0.1;

bat_scan_solids_options bat_scan_solids_defaults(void)
{
    return (bat_scan_solids_options){.points = 20000, .seed = 1};
}

/// The density of a scanner's points on a face: the cosine to the nearest of four views, the corners of a tetrahedron.
static double density_of(const void *context, const double normal[3])
{
    static const double VIEWS[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    double most = MIN_DENSITY;
    (void)context;
    for (size_t k = 0; k < 4; k++)
        most = fmax(most, vector3_dot(normal, VIEWS[k]) / sqrt(3));
    return most;
}

static bat_status measure(const bat_shell *shell, const bat_mesh *truth, const bat_mesh_summary *whole, int threads,
                          bat_scan_solids_row *row, bat_error *error)
{
    bat_mesh sampled = {0}, triangles = {0};
    bat_mesh_summary summary;
    bat_mesh_distance distance;
    bat_mesh_compare_options compare = bat_mesh_compare_defaults();
    compare.samples = DISTANCE_SAMPLES;
    compare.tolerance = 0.01;
    compare.threads = threads;
    bat_status status = bat_shell_tessellate(shell, SAMPLES, &sampled, error);
    if (status == BAT_OK)
        status = bat_mesh_triangulate(&sampled, &triangles, error);
    if (status == BAT_OK)
        status = bat_mesh_summarize(&triangles, &summary, error);
    if (status == BAT_OK)
        status = bat_mesh_compare(&triangles, truth, &compare, &distance, error);
    bat_mesh_free(&sampled);
    bat_mesh_free(&triangles);
    if (status != BAT_OK)
        return status;
    row->faces = shell->face_count;
    row->euler = summary.euler - whole->euler;
    row->rms = fmax(distance.rms_from_first, distance.rms_from_second) / whole->diagonal;
    row->largest = distance.hausdorff / whole->diagonal;
    row->volume = whole->closed && summary.closed ? summary.volume / whole->volume - 1 : NAN;
    row->is_right = summary.closed == whole->closed && row->euler == 0 && summary.components == 1 &&
                    row->largest <= MAX_FAR + 4 * row->noise && !(fabs(row->volume) > MAX_VOLUME);
    return BAT_OK;
}

static bat_status study_cloud(const bat_mesh *truth, const bat_mesh_summary *whole, const bat_scan_solids_options *options,
                              bat_random *random, bat_scan_solids_row *row, bat_error *error)
{
    bat_shell_reconstruct_options fit = bat_shell_reconstruct_defaults();
    bat_shell shell;
    bat_error failure = {0};
    fit.threads = options->threads;
    double *points = memory_array(options->points, 3 * sizeof *points);
    if (points == NULL)
        return error_memory(error, options->points * 3 * sizeof *points);
    bat_status status = mesh_points_draw(truth, row->scanner ? density_of : NULL, NULL, row->noise * whole->diagonal,
                                         options->points, random, points, error);
    if (status == BAT_OK)
        status = bat_shell_reconstruct(points, options->points, NULL, &fit, &shell, &row->report, &failure);
    free(points);
    if (status == BAT_NO_MEMORY)
        return error_copy(error, &failure);
    if (status != BAT_OK)
    {
        (void)snprintf(row->failure, sizeof row->failure, "%s", failure.text);
        return BAT_OK;
    }
    status = measure(&shell, truth, whole, options->threads, row, error);
    bat_shell_free(&shell);
    return status;
}

static bool is_mesh(const char *name)
{
    const char *end = strrchr(name, '.');
    return end != NULL && (strcmp(end, ".obj") == 0 || strcmp(end, ".off") == 0 || strcmp(end, ".ply") == 0) &&
           strncmp(name, "coarse-", 7) != 0 && strlen(name) < BAT_SCAN_VERDICT_NAME;
}

/// Refuse a mesh that cannot be read before the others are studied.
static bat_status check_mesh(const char *folder, const char *name, bat_error *error)
{
    char path[PATH_SIZE];
    bat_mesh mesh = {0};
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    bat_status status = folder_mesh_read(path, &mesh, error);
    bat_mesh_free(&mesh);
    return status;
}

/// Add the rows of a mesh of one piece.
static bat_status study_mesh(const char *folder, const char *name, const bat_scan_solids_options *options,
                             bat_scan_solids_row *rows, size_t *count, bat_error *error)
{
    char path[PATH_SIZE];
    bat_mesh mesh;
    bat_mesh_summary summary;
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    bat_status status = folder_mesh_read(path, &mesh, error);
    if (status != BAT_OK)
        return status;
    status = bat_mesh_summarize(&mesh, &summary, error);
    for (size_t k = 0; k < CASES && status == BAT_OK && summary.components == 1; k++)
    {
        bat_scan_solids_row *row = &rows[*count];
        bat_random random = bat_random_seed(options->seed + *count);
        *row = (bat_scan_solids_row){.noise = NOISES[k], .scanner = (options->seed + *count / CASES + k) % 3 == 0};
        strcpy(row->shape, name);
        status = progress_goes_on(options->progress, (double)k / CASES)
                     ? study_cloud(&mesh, &summary, options, &random, row, error)
                     : error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the study was stopped");
        *count += status == BAT_OK;
    }
    bat_mesh_free(&mesh);
    return status;
}

bat_status bat_scan_solids(const char *folder, const bat_scan_solids_options *options, bat_scan_solids_row **rows,
                           size_t *count, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_scan_solids_options, points, OPTION_SIZE, 1000, 10000000),
        OPTION_THREADS(bat_scan_solids_options),
    };
    const bat_scan_solids_options defaults = bat_scan_solids_defaults();
    options = options != NULL ? options : &defaults;
    folder_list list = {0};
    bat_scan_solids_row *all = NULL;
    size_t made = 0;
    bat_status status = OPTIONS_CHECK(options, FIELDS, error);
    if (status == BAT_OK)
        status = folder_read(folder, is_mesh, &list, error);
    if (status == BAT_OK && list.count == 0)
        status = error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "%s: there are no meshes (OBJ, OFF or PLY)", folder);
    if (status == BAT_OK && (all = memory_array(list.count * CASES, sizeof *all)) == NULL)
        status = error_memory(error, list.count * CASES * sizeof *all);
    for (size_t i = 0; i < list.count && status == BAT_OK; i++)
        status = check_mesh(folder, list.names[i], error);
    for (size_t i = 0; i < list.count && status == BAT_OK; i++)
    {
        progress_part part = {options->progress, (double)i / (double)list.count, 1 / (double)list.count};
        bat_scan_solids_options one = *options;
        one.progress = progress_of_part(&part);
        status = study_mesh(folder, list.names[i], &one, all, &made, error);
    }
    if (status == BAT_OK && made == 0)
        status = error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "%s: no mesh is of one piece", folder);
    folder_list_free(&list);
    if (status != BAT_OK)
    {
        free(all);
        return status;
    }
    *rows = all;
    *count = made;
    return BAT_OK;
}
