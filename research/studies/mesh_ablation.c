/// @file
/// Ablation of the learned mesh scheme (bat_mesh_ablate): Liu et al., "Neural Subdivision" (2020), section 6 and appendices
/// G and H. Every variant is trained on the same shapes and measured on a test shape.

#include "research/studies/mesh_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/progress.h"
#include "batten/mesh_decimate.h"
#include "batten/mesh_measure.h"
#include "batten/research/mesh_shapes.h"
#include "research/train/mesh_targets.h"

#include <math.h>
#include <stdlib.h>

enum
{
    LEVELS = BAT_MESH_TRAIN_LEVELS,
    TRIALS = 5,          ///< random decimations of the test shape
    LOOP_PATIENCE = 8,   ///< factor on the epochs for learning Loop's scheme, which is only compared with itself
    RESAMPLED_PART = 10, ///< one in this many of its coarse meshes is resampled in each epoch
    CANDIDATES = 100,    ///< candidate edges of a random decimation (appendix E)
    SHAPE_SIZE = 3000,   ///< vertices of the built-in shapes
    TRIAL_SEED = 100000  ///< seed of the first decimation
};

static const char *const NAMES[BAT_MESH_VARIANT_COUNT] = {"full",       "fixed-frames", "no-differences",
                                                          "last-level", "chamfer",      "learn-loop"};

/// The test shape with its decimations.
typedef struct probe
{
    const bat_mesh *shape;
    double diagonal;
    bat_mesh coarse; ///< decimated by quadric errors, as for table 2
    bat_mesh turned_shape, turned_coarse;
    bat_mesh trials[TRIALS];         ///< random decimations
    double *targets[TRIALS][LEVELS]; ///< images of their vertices under the map to the shape, at levels 1 and 2
} probe;

// Making the probe

/// Rotate a mesh by one radian about the direction (1, 1, 1), by Rodrigues' formula.
static void turn(bat_mesh *mesh)
{
    const double cosine = cos(1), sine = sin(1), unit = 1 / sqrt(3);
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        double *p = mesh->positions + 3 * v;
        const double x = p[0], y = p[1], z = p[2], along = (1 - cosine) * (x + y + z) / 3;
        p[0] = cosine * x + sine * unit * (z - y) + along;
        p[1] = cosine * y + sine * unit * (x - z) + along;
        p[2] = cosine * z + sine * unit * (y - x) + along;
    }
}

static bat_status turned_copy(const bat_mesh *mesh, bat_mesh *turned, bat_error *error)
{
    bat_status status = bat_mesh_copy(mesh, turned, error);
    if (status == BAT_OK)
        turn(turned);
    return status;
}

/// The number of vertices of a mesh after a number of levels.
static bat_status count_refined(const bat_mesh *mesh, size_t levels, size_t *count, bat_error *error)
{
    bat_mesh_point *points;
    bat_status status = bat_mesh_midpoints(mesh, levels, &points, count, error);
    if (status == BAT_OK)
        free(points);
    return status;
}

/// A random decimation as in training, with the targets of its vertices.
static bat_status trial_make(probe *p, size_t index, bat_error *error)
{
    const bat_mesh_train_options recipe = bat_mesh_train_defaults(BAT_RECIPE_PUBLISHED);
    bat_mesh_decimate_options how = bat_mesh_decimate_defaults();
    how.method = BAT_MESH_DECIMATE_METHOD_QUADRIC;
    how.attributes = 0;
    how.min_quality = 0.2;
    how.vertices = recipe.min_vertices + index * (recipe.max_vertices - recipe.min_vertices) / (TRIALS - 1);
    if (how.vertices > p->shape->vertex_count)
        how.vertices = p->shape->vertex_count;
    how.candidates = CANDIDATES;
    how.seed = TRIAL_SEED + index;
    bat_mesh_map *map = NULL;
    bat_mesh *coarse = &p->trials[index];
    bat_status status = bat_mesh_decimate(p->shape, &how, coarse, &map, error);
    for (size_t level = 0; level < LEVELS && status == BAT_OK; level++)
    {
        size_t count = 0;
        status = count_refined(coarse, level + 1, &count, error);
        if (status != BAT_OK)
            break;
        double *targets = p->targets[index][level] = memory_array(count, 3 * sizeof *targets);
        status = targets == NULL ? error_memory(error, count * 3 * sizeof *targets)
                                 : mesh_map_targets(map, p->shape, coarse, level + 1, targets, NULL, error);
    }
    bat_mesh_map_free(map);
    return status;
}

static bat_status probe_make(const bat_mesh *shape, const bat_mesh_study_options *options, probe *p, bat_error *error)
{
    bat_mesh_summary summary;
    p->shape = shape;
    bat_status status = bat_mesh_summarize(shape, &summary, error);
    if (status == BAT_OK)
        status = mesh_study_decimate(shape, options, (bat_progress){0}, &p->coarse, error);
    if (status == BAT_OK)
        status = turned_copy(shape, &p->turned_shape, error);
    if (status == BAT_OK)
        status = turned_copy(&p->coarse, &p->turned_coarse, error);
    for (size_t i = 0; i < TRIALS && status == BAT_OK; i++)
        status = trial_make(p, i, error);
    if (status == BAT_OK)
        p->diagonal = summary.diagonal;
    return status;
}

static void probe_free(probe *p)
{
    bat_mesh_free(&p->coarse);
    bat_mesh_free(&p->turned_shape);
    bat_mesh_free(&p->turned_coarse);
    for (size_t i = 0; i < TRIALS; i++)
    {
        bat_mesh_free(&p->trials[i]);
        for (size_t level = 0; level < LEVELS; level++)
            free(p->targets[i][level]);
    }
}

// Measuring

static double mean_distance(const double *points, const double *targets, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += hypot(hypot(points[3 * i] - targets[3 * i], points[3 * i + 1] - targets[3 * i + 1]),
                     points[3 * i + 2] - targets[3 * i + 2]);
    return sum / (double)count;
}

/// The mean distance of the vertices of a trial from their targets.
static bat_status trial_measure(const probe *p, size_t index, size_t levels, const bat_mesh_rule *rule, bool loop,
                                int threads, double *distance, bat_error *error)
{
    bat_mesh_refine_options how = bat_mesh_refine_defaults();
    bat_mesh fine, target = {0};
    how.levels = levels;
    how.threads = threads;
    how.scheme = BAT_MESH_SCHEME_LOOP;
    bat_status status = loop ? bat_mesh_refine(&p->trials[index], &how, &target, NULL, error) : BAT_OK;
    if (status != BAT_OK)
        return status;
    how.scheme = BAT_MESH_SCHEME_LEARNED;
    how.rule = rule;
    status = bat_mesh_refine(&p->trials[index], &how, &fine, NULL, error);
    if (status == BAT_OK)
    {
        const double *targets = loop ? target.positions : p->targets[index][levels - 1];
        *distance = mean_distance(fine.positions, targets, fine.vertex_count);
        bat_mesh_free(&fine);
    }
    bat_mesh_free(&target);
    return status;
}

static bat_status measure_trials(const probe *p, const bat_mesh_rule *rule, bool loop, int threads, double errors[LEVELS],
                                 bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t level = 0; level < LEVELS; level++)
    {
        errors[level] = 0;
        for (size_t i = 0; i < TRIALS && status == BAT_OK; i++)
        {
            double distance = 0;
            status = trial_measure(p, i, level + 1, rule, loop, threads, &distance, error);
            errors[level] += distance / p->diagonal / TRIALS;
        }
    }
    return status;
}

static bat_status measure_network(const probe *p, const bat_mesh_model *model, bat_mesh_variant variant,
                                  const bat_mesh_study_options *options, bat_mesh_ablation_row *row, bat_error *error)
{
    const bat_mesh_method method = {NAMES[variant], BAT_MESH_SCHEME_LEARNED, bat_mesh_model_rule(model)};
    const bat_progress silent = {0};
    bat_status status =
        measure_trials(p, method.rule, variant == BAT_MESH_VARIANT_LEARN_LOOP, options->threads, row->errors, error);
    if (status == BAT_OK)
        status = mesh_study_score(p->shape, &p->coarse, &method, options, silent, NULL, &row->straight, error);
    if (status == BAT_OK)
        status = mesh_study_score(&p->turned_shape, &p->turned_coarse, &method, options, silent, NULL, &row->turned, error);
    row->turned.diagonal = row->straight.diagonal; // the bounding box of the unrotated shape
    return status;
}

// The table

static bat_status run_variant(const bat_mesh *shapes, size_t count, const probe *p, bat_mesh_variant variant,
                              const bat_mesh_study_options *options, bat_progress progress, bat_mesh_ablation_row *row,
                              bat_error *error)
{
    bat_mesh_train_options recipe = mesh_study_recipe(options);
    bat_mesh_model *model = NULL;
    recipe.run.progress = progress;
    recipe.fixed_frames = variant == BAT_MESH_VARIANT_FIXED_FRAMES;
    recipe.no_differences = variant == BAT_MESH_VARIANT_NO_DIFFERENCES;
    recipe.last_level = variant == BAT_MESH_VARIANT_LAST_LEVEL;
    recipe.chamfer = variant == BAT_MESH_VARIANT_CHAMFER;
    recipe.learn_loop = variant == BAT_MESH_VARIANT_LEARN_LOOP;
    if (recipe.learn_loop)
    {
        recipe.run.epochs *= LOOP_PATIENCE;
        recipe.resampled = options->pairs / RESAMPLED_PART;
    }
    row->variant = NAMES[variant];
    bat_status status = mesh_study_train(shapes, count, options, NAMES[variant], recipe, &row->report, &model, error);
    if (status == BAT_OK)
        status = measure_network(p, model, variant, options, row, error);
    bat_mesh_model_free(model);
    return status;
}

static bat_status run_variants(const bat_mesh *shapes, size_t count, const probe *p, const bat_mesh_study_options *options,
                               bat_mesh_ablation_row *rows, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < BAT_MESH_VARIANT_COUNT && status == BAT_OK; i++)
    {
        const double share = 1.0 / BAT_MESH_VARIANT_COUNT;
        progress_part part = {options->progress, (double)i * share, share};
        status = run_variant(shapes, count, p, (bat_mesh_variant)i, options, progress_of_part(&part), &rows[i], error);
    }
    return status;
}

bat_status bat_mesh_ablate(const bat_mesh *shapes, size_t count, const bat_mesh *test, const bat_mesh_study_options *options,
                           bat_mesh_ablation_row *rows, bat_error *error)
{
    bat_mesh own = {0}, own_test = {0};
    probe p = {0};
    bat_status status = mesh_study_check_training(options, error);
    if (status == BAT_OK && shapes == NULL)
        status = bat_mesh_shape("creature", SHAPE_SIZE, 1, &own, error);
    if (status == BAT_OK && test == NULL)
        status = bat_mesh_shape("creature", SHAPE_SIZE, 2, &own_test, error);
    if (status == BAT_OK)
        status = probe_make(test != NULL ? test : &own_test, options, &p, error);
    if (status == BAT_OK)
        status = run_variants(shapes != NULL ? shapes : &own, shapes != NULL ? count : 1, &p, options, rows, error);
    probe_free(&p);
    bat_mesh_free(&own);
    bat_mesh_free(&own_test);
    return status;
}
