/// @file
/// Study of mesh subdivision after decimation: Liu et al., "Neural Subdivision" (2020), table 2. Reading of meshes,
/// trainings, scores and pictures.

#include "research/studies/mesh_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/progress.h"
#include "batten/mesh_decimate.h"
#include "batten/mesh_file.h"
#include "batten/mesh_measure.h"
#include "batten/mesh_picture.h"
#include "batten/research/networks.h"
#include "research/studies/folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    PATH_SIZE = 4096,
    TITLE_SIZE = 128,
    MAX_EPOCHS = 1000000000
};

bat_mesh_study_options bat_mesh_study_defaults(void)
{
    return (bat_mesh_study_options){
        .vertices = 400, .levels = 2, .samples = BAT_MESH_SAMPLES, .seed = 1, .epochs = 60, .pairs = 50};
}

// Reading

static bat_status check_manifold(const bat_mesh *mesh, bat_error *error)
{
    bat_mesh_connectivity connectivity;
    bat_status status = bat_mesh_connect(mesh, &connectivity, error);
    if (status == BAT_OK)
        bat_mesh_connectivity_free(&connectivity);
    return status;
}

bat_status bat_mesh_study_read(const char *path, bat_mesh *mesh, bool *repaired, bat_mesh_repair_report *report,
                               bat_error *error)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    options.triangulate = true;
    options.keep_degenerate = true;
    bat_mesh_repair_report done = {0};
    bat_mesh made;
    bat_status status = bat_mesh_read(path, &options, &made, error);
    if (status != BAT_OK)
        return status;
    bool sound = check_manifold(&made, NULL) == BAT_OK;
    if (!sound)
    {
        bat_mesh broken = made;
        made = (bat_mesh){0};
        status = bat_mesh_repair(&broken, &done, &made, error);
        bat_mesh_free(&broken);
        if (status == BAT_OK)
            status = check_manifold(&made, error);
    }
    if (status != BAT_OK)
    {
        bat_mesh_free(&made);
        return status;
    }
    *mesh = made;
    if (repaired != NULL)
        *repaired = !sound;
    if (report != NULL)
        *report = done;
    return BAT_OK;
}

// Training

bat_status mesh_study_check_training(const bat_mesh_study_options *options, bat_error *error)
{
    if (options == NULL || options->folder == NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a study that trains needs a folder");
    if (options->epochs == 0 || options->epochs > MAX_EPOCHS)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "%llu epochs: there must be 1 to %d",
                         (unsigned long long)options->epochs, MAX_EPOCHS);
    return BAT_OK;
}

bat_mesh_train_options mesh_study_recipe(const bat_mesh_study_options *options)
{
    bat_mesh_train_options recipe = bat_mesh_train_defaults(BAT_RECIPE_PUBLISHED);
    recipe.run.seed = options->seed;
    recipe.run.epochs = options->epochs;
    recipe.pairs = options->pairs;
    recipe.run.threads = options->threads;
    recipe.cosine_decay = true;
    recipe.run.resume = true;
    return recipe;
}

bat_status mesh_study_train(const bat_mesh *shapes, size_t count, const bat_mesh_study_options *options, const char *name,
                            bat_mesh_train_options recipe, bat_mesh_train_report *report, bat_mesh_model **model,
                            bat_error *error)
{
    char folder[PATH_SIZE], path[PATH_SIZE];
    int length = snprintf(folder, sizeof folder, "%s/%s", options->folder, name);
    if (length < 0 || (size_t)length >= sizeof folder ||
        (size_t)snprintf(path, sizeof path, "%s/%s/model.safetensors", options->folder, name) >= sizeof path)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "the name of the folder is too long");
    recipe.run.folder = folder;
    bat_status status = bat_mesh_train(shapes, count, &recipe, report, error);
    return status == BAT_OK ? bat_mesh_model_read_published(path, model, error) : status;
}

// Scores

bat_status mesh_study_decimate(const bat_mesh *shape, const bat_mesh_study_options *options, bat_progress progress,
                               bat_mesh *coarse, bat_error *error)
{
    bat_mesh_decimate_options how = bat_mesh_decimate_defaults();
    how.method = BAT_MESH_DECIMATE_METHOD_QUADRIC;
    how.attributes = 0;
    how.min_quality = 0.2;
    how.vertices = options->vertices;
    how.progress = progress;
    if (how.vertices < 4)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "shapes decimated to %zu vertices: 4 are needed",
                         how.vertices);
    if (how.vertices > shape->vertex_count)
        how.vertices = shape->vertex_count;
    return bat_mesh_decimate(shape, &how, coarse, NULL, error);
}

bat_status mesh_study_score(const bat_mesh *shape, const bat_mesh *coarse, const bat_mesh_method *method,
                            const bat_mesh_study_options *options, bat_progress progress, bat_mesh *fine,
                            bat_mesh_score *score, bat_error *error)
{
    bat_mesh_refine_options refine = bat_mesh_refine_defaults();
    refine.scheme = method->scheme;
    refine.rule = method->rule;
    refine.levels = options->levels;
    refine.threads = options->threads;
    bat_mesh_compare_options compare = bat_mesh_compare_defaults();
    compare.samples = options->samples;
    compare.threads = options->threads;
    compare.progress = progress;
    bat_mesh made;
    bat_mesh_distance distance;
    size_t fallback = 0;
    bat_status status = bat_mesh_refine(coarse, &refine, &made, &fallback, error);
    if (status != BAT_OK)
        return status;
    status = bat_mesh_compare(&made, shape, &compare, &distance, error);
    if (status == BAT_OK)
        *score = (bat_mesh_score){distance.hausdorff, distance.mean, distance.diagonal, fallback};
    if (status == BAT_OK && fine != NULL)
        *fine = made;
    else
        bat_mesh_free(&made);
    return status;
}

bat_status bat_mesh_study_shape(const bat_mesh *shape, const bat_mesh_method *methods, size_t count,
                                const bat_mesh_study_options *options, bat_mesh *coarse, bat_mesh *fine,
                                bat_mesh_score *scores, bat_error *error)
{
    bat_mesh_study_options defaults = bat_mesh_study_defaults();
    if (options == NULL)
        options = &defaults;
    *coarse = (bat_mesh){0};
    for (size_t i = 0; i < count && fine != NULL; i++)
        fine[i] = (bat_mesh){0};
    if (count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there must be a way to subdivide");
    double share = 1 / (double)(count + 1);
    progress_part part = {options->progress, 0, share};
    bat_status status = mesh_study_decimate(shape, options, progress_of_part(&part), coarse, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        part.begin = (double)(i + 1) * share;
        status = mesh_study_score(shape, coarse, &methods[i], options, progress_of_part(&part),
                                  fine != NULL ? &fine[i] : NULL, &scores[i], error);
    }
    if (status != BAT_OK)
    {
        bat_mesh_free(coarse);
        for (size_t i = 0; i < count && fine != NULL; i++)
            bat_mesh_free(&fine[i]);
    }
    return status;
}

// Pictures

/// The distance of each vertex from the shape, in per cent of `diagonal`.
static bat_status measure_vertices(const bat_mesh *shape, const bat_mesh *mesh, double diagonal, int threads,
                                   double **values, bat_error *error)
{
    size_t count = mesh->vertex_count;
    bat_mesh_closest_point *closest = memory_array(count, sizeof *closest);
    double *made = memory_array(count, sizeof *made);
    bat_status status = closest == NULL || made == NULL ? error_memory(error, count * sizeof *closest) : BAT_OK;
    if (status == BAT_OK)
        status = bat_mesh_closest(shape, mesh->positions, count, threads, closest, error);
    for (size_t v = 0; v < count && status == BAT_OK; v++)
        made[v] = 100 * closest[v].distance / diagonal;
    free(closest);
    if (status == BAT_OK)
        *values = made;
    else
        free(made);
    return status;
}

static bat_status draw_panels(const char *path, const char *title, const bat_mesh_picture_panel *panels, size_t count,
                              double high, int threads, bat_error *error)
{
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.title = title;
    options.columns = count;
    options.value_low = 0;
    options.value_high = high;
    options.value_label = "distance, % of the diagonal";
    options.threads = threads;
    return bat_mesh_picture_write(path, panels, count, &options, error);
}

bat_status bat_mesh_study_draw(const char *path, const char *title, const bat_mesh *shape, const bat_mesh *coarse,
                               const bat_mesh_method *methods, const bat_mesh *fine, const bat_mesh_score *scores,
                               size_t count, int threads, bat_error *error)
{
    enum
    {
        MAX = 14
    };
    // The colour scale ends at five times the largest mean distance, because single outliers would otherwise compress it.
    const double SCALE = 5;
    bat_mesh_picture_panel panels[MAX + 2] = {{.mesh = coarse, .title = "coarse", .wires = true, .flat = true}};
    char titles[MAX][TITLE_SIZE];
    double *values[MAX] = {NULL}, high = 0;
    if (count > MAX)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a picture of %zu methods: %d are the most", count,
                         MAX);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        double percent = 100 / scores[i].diagonal;
        (void)snprintf(titles[i], TITLE_SIZE, "%s: mean %.3f %%", methods[i].name, scores[i].mean * percent);
        high = fmax(high, SCALE * scores[i].mean * percent);
        status = measure_vertices(shape, &fine[i], scores[i].diagonal, threads, &values[i], error);
        panels[i + 1] = (bat_mesh_picture_panel){.mesh = &fine[i], .title = titles[i], .values = values[i]};
    }
    panels[count + 1] = (bat_mesh_picture_panel){.mesh = shape, .title = "original"};
    if (status == BAT_OK)
        status = draw_panels(path, title, panels, count + 2, high > 0 ? high : 1, threads, error);
    for (size_t i = 0; i < count; i++)
        free(values[i]);
    return status;
}

// Files

static bool is_test_shape(const char *name)
{
    static const char *const LEARNED_FROM[] = {"bob", "spot"};
    const char *end = strrchr(name, '.');
    const bat_choice *format;
    (void)bat_choice_of_path(&bat_mesh_format_family, name, false, &format, NULL);
    bool wanted = format != NULL && strncmp(name, "coarse-", strlen("coarse-")) != 0;
    for (size_t i = 0; i < sizeof LEARNED_FROM / sizeof *LEARNED_FROM && wanted; i++)
        wanted =
            strlen(LEARNED_FROM[i]) != (size_t)(end - name) || strncmp(name, LEARNED_FROM[i], (size_t)(end - name)) != 0;
    return wanted;
}

bat_status bat_mesh_study_list(const char *folder, char ***paths, size_t *count, bat_error *error)
{
    folder_list list;
    bat_status status = folder_read(folder, is_test_shape, &list, error);
    if (status == BAT_OK && list.count == 0)
        status = error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0,
                           "%s: no shapes in a format of meshes to test on in the folder", folder);
    for (size_t i = 0; i < list.count && status == BAT_OK; i++)
    {
        size_t size = strlen(folder) + strlen(list.names[i]) + 2;
        char *path = malloc(size);
        if (path == NULL)
            status = error_memory(error, size);
        else
        {
            (void)snprintf(path, size, "%s/%s", folder, list.names[i]);
            free(list.names[i]);
            list.names[i] = path;
        }
    }
    if (status != BAT_OK)
    {
        folder_list_free(&list);
        return status;
    }
    *paths = list.names;
    *count = list.count;
    return BAT_OK;
}
