/// @file
/// Shells of clouds that are sampled from meshes, or from open bodies with smooth rims, against those.

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
    CASES = 3,                 ///< of a mesh
    BODIES = 6,
    FEW_POINTS = 2000, ///< of every second cloud of a body
    AROUND = 512,      ///< sides of a body's rings
    ALONG = 128
};

static const double NOISES[CASES] = {0, 0.001, 0.005};
static const double MAX_FAR = 0.02, MAX_VOLUME = 0.02;
/// Largest distance of a body in spacings, and error of its area.
static const double MAX_SPACINGS = 2, MAX_AREA = 0.03;
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

static const char *const BODY_NAMES[BODIES] = {"pipe", "elbow", "bowl", "band", "cone", "cut pipe"};

/// A place on a body: along its axis and around it, both from 0 to 1.
static void place_on(size_t body, double along, double around, double place[3])
{
    double turn = 2 * ANGLE_PI * around, radius = 1, height = 3 * along;
    if (body == 1)
    {
        double bend = 2 * along, arm = 2.5 + cos(turn);
        place[0] = arm * cos(bend);
        place[1] = arm * sin(bend);
        place[2] = sin(turn);
        return;
    }
    if (body == 2 || body == 3)
    {
        double angle = body == 2 ? 1.8 * along : 0.7 + (ANGLE_PI - 1.4) * along;
        radius = sin(angle);
        height = -cos(angle);
    }
    if (body == 4)
    {
        radius = 0.4 + 1.1 * along;
        height = 2 * radius;
    }
    if (body == 5)
        height = (3 + 0.7 * cos(turn)) * along;
    place[0] = radius * cos(turn);
    place[1] = radius * sin(turn);
    place[2] = height;
}

/// A mesh of a body. All places of a bowl's first ring are one.
static bat_status make_body(size_t body, bat_mesh *mesh, bat_error *error)
{
    bool pole = body == 2;
    bat_mesh made = {.vertex_count = AROUND * (ALONG + 1),
                     .positions = memory_array(AROUND * (ALONG + 1), 3 * sizeof(double)),
                     .faces = memory_array(2 * AROUND * ALONG, 3 * sizeof(uint32_t))};
    if (made.positions == NULL || made.faces == NULL)
    {
        bat_mesh_free(&made);
        return error_memory(error, 3 * AROUND * (ALONG + 1) * sizeof(double));
    }
    for (size_t v = 0; v < made.vertex_count; v++)
    {
        size_t ring = v / AROUND, side = v % AROUND;
        place_on(body, (double)ring / ALONG, (double)side / AROUND, made.positions + 3 * v);
    }
    for (uint32_t j = 0; j < ALONG; j++)
        for (uint32_t i = 0; i < AROUND; i++)
        {
            uint32_t next = (i + 1) % AROUND, low[2] = {j * AROUND + i, j * AROUND + next},
                     high[2] = {low[0] + AROUND, low[1] + AROUND};
            if (pole && j == 0)
                low[0] = low[1] = 0;
            const uint32_t faces[2][3] = {{low[0], high[1], high[0]}, {low[0], low[1], high[1]}};
            for (size_t k = 0; k < 2; k++)
                if (faces[k][0] != faces[k][1])
                    memcpy(made.faces + 3 * made.face_count++, faces[k], sizeof faces[k]);
        }
    *mesh = made;
    return BAT_OK;
}

static bat_status measure(const bat_shell *shell, const bat_mesh *truth, const bat_mesh_summary *whole, bool is_body,
                          int threads, bat_scan_solids_row *row, bat_error *error)
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
    row->volume = !whole->closed   ? summary.area / whole->area - 1
                  : summary.closed ? summary.volume / whole->volume - 1
                                   : NAN;
    double far = is_body ? fmax(MAX_FAR, MAX_SPACINGS * row->report.spacing / whole->diagonal) : MAX_FAR,
           most = whole->closed ? MAX_VOLUME
                  : is_body     ? MAX_AREA
                                : INFINITY;
    row->is_right = summary.closed == whole->closed && row->euler == 0 && summary.components == 1 &&
                    row->largest <= far + 4 * row->noise && !(fabs(row->volume) > most);
    return BAT_OK;
}

static bat_status study_cloud(const bat_mesh *truth, const bat_mesh_summary *whole, bool is_body,
                              const bat_scan_solids_options *options, bat_random *random, bat_scan_solids_row *row,
                              bat_error *error)
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
    status = measure(&shell, truth, whole, is_body, options->threads, row, error);
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

/// Add the rows of a mesh of one piece, which it releases.
static bat_status study_mesh(bat_mesh mesh, const char *name, bool is_body, const bat_scan_solids_options *options,
                             bat_scan_solids_row *rows, size_t *count, bat_error *error)
{
    bat_mesh_summary summary;
    bat_status status = bat_mesh_summarize(&mesh, &summary, error);
    for (size_t k = 0; k < CASES && status == BAT_OK && summary.components == 1; k++)
    {
        bat_scan_solids_row *row = &rows[*count];
        bat_random random = bat_random_seed(options->seed + *count);
        *row = (bat_scan_solids_row){.noise = NOISES[k], .scanner = (options->seed + *count / CASES + k) % 3 == 0};
        strcpy(row->shape, name);
        status = progress_goes_on(options->progress, (double)k / CASES)
                     ? study_cloud(&mesh, &summary, is_body, options, &random, row, error)
                     : error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the study was stopped");
        *count += status == BAT_OK;
    }
    bat_mesh_free(&mesh);
    return status;
}

static bat_status study_bodies(const bat_scan_solids_options *options, bat_scan_solids_row *rows, size_t *count,
                               bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t k = 0; k < 2 * BODIES && status == BAT_OK; k++)
    {
        bat_mesh body;
        progress_part part = {options->progress, (double)k / (2 * BODIES), 1.0 / (2 * BODIES)};
        bat_scan_solids_options one = *options;
        one.progress = progress_of_part(&part);
        one.points = k % 2 == 0 ? FEW_POINTS : options->points;
        status = make_body(k / 2, &body, error);
        if (status == BAT_OK)
            status = study_mesh(body, BODY_NAMES[k / 2], true, &one, rows, count, error);
    }
    return status;
}

static bat_status study_folder(const char *folder, const folder_list *list, const bat_scan_solids_options *options,
                               bat_scan_solids_row *rows, size_t *count, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < list->count && status == BAT_OK; i++)
        status = check_mesh(folder, list->names[i], error);
    for (size_t i = 0; i < list->count && status == BAT_OK; i++)
    {
        char path[PATH_SIZE];
        bat_mesh mesh;
        progress_part part = {options->progress, (double)i / (double)list->count, 1 / (double)list->count};
        bat_scan_solids_options one = *options;
        one.progress = progress_of_part(&part);
        (void)snprintf(path, sizeof path, "%s/%s", folder, list->names[i]);
        status = folder_mesh_read(path, &mesh, error);
        if (status == BAT_OK)
            status = study_mesh(mesh, list->names[i], false, &one, rows, count, error);
    }
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
    if (status == BAT_OK && folder != NULL)
        status = folder_read(folder, is_mesh, &list, error);
    if (status == BAT_OK && folder != NULL && list.count == 0)
        status = error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "%s: there are no meshes (OBJ, OFF or PLY)", folder);
    size_t most = (folder != NULL ? list.count : 2 * BODIES) * CASES;
    if (status == BAT_OK && (all = memory_array(most, sizeof *all)) == NULL)
        status = error_memory(error, most * sizeof *all);
    if (status == BAT_OK)
        status = folder != NULL ? study_folder(folder, &list, options, all, &made, error)
                                : study_bodies(options, all, &made, error);
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
