/// @file
/// Style transfer by training (bat_mesh_style_make): Liu et al., "Neural Subdivision" (2020), figures 26 and 27. One network
/// learns from a smooth shape, one from a sharp one; both subdivide the same cage.

#include "research/studies/mesh_study.h"

#include "base/progress.h"
#include "batten/mesh_picture.h"
#include "batten/research/mesh_shapes.h"

#include <math.h>

enum
{
    SHAPE_SIZE = 4000, ///< vertices of the built-in shapes
    CAGE_SIZE = 400,
    MIN_VERTICES = 25, ///< minimum number of vertices of the coarse training meshes
    MAX_VERTICES = 100
};

static const double SHARP_ANGLE = 60 * 3.14159265358979323846 / 180;

/// Twice the vector area of a face.
static void face_normal(const bat_mesh *mesh, size_t face, double normal[3])
{
    const uint32_t *corners = mesh->faces + 3 * face;
    const double *a = mesh->positions + 3 * corners[0], *b = mesh->positions + 3 * corners[1],
                 *c = mesh->positions + 3 * corners[2];
    for (size_t i = 0; i < 3; i++)
    {
        size_t j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
    }
}

static bool is_sharp(const bat_mesh *mesh, size_t face, size_t other)
{
    double n[3], m[3], product = 0, lengths[2] = {0};
    face_normal(mesh, face, n);
    face_normal(mesh, other, m);
    for (size_t i = 0; i < 3; i++)
    {
        product += n[i] * m[i];
        lengths[0] += n[i] * n[i];
        lengths[1] += m[i] * m[i];
    }
    return product < cos(SHARP_ANGLE) * sqrt(lengths[0] * lengths[1]);
}

/// The fraction of interior edges with a dihedral angle above SHARP_ANGLE.
static bat_status measure_sharp_edges(const bat_mesh *mesh, double *share, bat_error *error)
{
    bat_mesh_connectivity links;
    bat_status status = bat_mesh_connect(mesh, &links, error);
    if (status != BAT_OK)
        return status;
    size_t edges = 0, sharp = 0;
    for (size_t h = 0; h < 3 * mesh->face_count; h++)
        if (links.twin[h] != BAT_MESH_NONE && h < links.twin[h])
        {
            edges++;
            sharp += is_sharp(mesh, h / 3, links.twin[h] / 3);
        }
    bat_mesh_connectivity_free(&links);
    *share = edges > 0 ? (double)sharp / (double)edges : 0;
    return BAT_OK;
}

/// A copy of a shape, or a built-in one for null.
static bat_status copy_shape(const bat_mesh *given, const char *own, size_t vertices, bat_mesh *shape, bat_error *error)
{
    return given != NULL ? bat_mesh_copy(given, shape, error) : bat_mesh_shape(own, vertices, 1, shape, error);
}

/// Train on a shape and subdivide the cage.
static bat_status subdivide(const bat_mesh *shape, const char *name, const bat_mesh *cage,
                            const bat_mesh_study_options *options, bat_progress progress, bat_mesh_train_report *report,
                            bat_mesh *fine, bat_error *error)
{
    bat_mesh_train_options recipe = mesh_study_recipe(options);
    bat_mesh_model *model = NULL;
    // Coarse meshes with angles similar to those of a cage.
    recipe.min_vertices = MIN_VERTICES;
    recipe.max_vertices = MAX_VERTICES;
    recipe.relative = true;
    recipe.run.progress = progress;
    bat_status status = mesh_study_train(shape, 1, options, name, recipe, report, &model, error);
    if (status == BAT_OK)
    {
        bat_mesh_refine_options how = bat_mesh_refine_defaults();
        how.scheme = BAT_MESH_SCHEME_LEARNED;
        how.rule = bat_mesh_model_rule(model);
        how.levels = options->levels;
        how.threads = options->threads;
        status = bat_mesh_refine(cage, &how, fine, NULL, error);
    }
    bat_mesh_model_free(model);
    return status;
}

bat_status bat_mesh_style_make(const bat_mesh *smooth, const bat_mesh *sharp, const bat_mesh *cage,
                               const bat_mesh_study_options *options, bat_mesh_style *style, bat_error *error)
{
    *style = (bat_mesh_style){0};
    bat_status status = mesh_study_check_training(options, error);
    if (status == BAT_OK)
        status = copy_shape(smooth, "stone", SHAPE_SIZE, &style->smooth, error);
    if (status == BAT_OK)
        status = copy_shape(sharp, "bracket", SHAPE_SIZE, &style->sharp, error);
    if (status == BAT_OK)
        status = copy_shape(cage, "cage", CAGE_SIZE, &style->cage, error);
    const bat_mesh *const shapes[2] = {&style->smooth, &style->sharp};
    bat_mesh *const fine[2] = {&style->by_smooth, &style->by_sharp};
    static const char *const NAMES[2] = {"smooth", "sharp"};
    for (int i = 0; i < 2 && status == BAT_OK; i++)
    {
        progress_part part = {options->progress, i / 2.0, 1 / 2.0};
        status = subdivide(shapes[i], NAMES[i], &style->cage, options, progress_of_part(&part), &style->reports[i], fine[i],
                           error);
        if (status == BAT_OK)
            status = measure_sharp_edges(fine[i], &style->sharp_edges[i], error);
    }
    if (status != BAT_OK)
        bat_mesh_style_free(style);
    return status;
}

static bat_status draw_row(const char *path, const bat_mesh_picture_panel *panels, size_t count, int threads,
                           bat_error *error)
{
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.columns = count;
    options.own_frames = true;
    options.threads = threads;
    options.title = "One cage, two teachers";
    return bat_mesh_picture_write(path, panels, count, &options, error);
}

bat_status bat_mesh_style_draw(const char *path, const bat_mesh_style *style, int threads, bat_error *error)
{
    const bat_mesh_picture_panel panels[] = {
        {.mesh = &style->cage, .title = "cage", .wires = true, .flat = true},
        {.mesh = &style->by_smooth, .title = "learned from the smooth shape"},
        {.mesh = &style->by_sharp, .title = "learned from the sharp shape"},
        {.mesh = &style->smooth, .title = "the smooth shape"},
        {.mesh = &style->sharp, .title = "the sharp shape"},
    };
    return draw_row(path, panels, sizeof panels / sizeof *panels, threads, error);
}

void bat_mesh_style_free(bat_mesh_style *style)
{
    bat_mesh_free(&style->smooth);
    bat_mesh_free(&style->sharp);
    bat_mesh_free(&style->cage);
    bat_mesh_free(&style->by_smooth);
    bat_mesh_free(&style->by_sharp);
}
