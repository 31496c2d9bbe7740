/// @file
/// Tables 3 and 4 of Ugail and Howard (2026), section 7.8: the published recipe, trained with one change at a time.

#include "research/studies/tension_ablation.h"

#include "base/error.h"
#include "base/progress.h"
#include "batten/research/curve_study.h"
#include "research/train/curve_train.h"
#include "research/train/tension_sample.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum
{
    SPACES = BAT_TENSION_SPACE_COUNT,
    PATH_SIZE = 4096
};

static const char *const NAMES[BAT_TENSION_VARIANT_COUNT] = {"full",           "one-hot",    "no-embedding",
                                                             "no-consistency", "no-bending", "no-smoothness"};

bat_tension_ablation_options bat_tension_ablation_defaults(void)
{
    return (bat_tension_ablation_options){.seed = 1, .epochs = 100};
}

/// The published recipe with one change.
static bat_curve_train_options recipe_of(bat_tension_variant variant, const bat_tension_ablation_options *options)
{
    bat_curve_train_options recipe = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    recipe.run.seed = options->seed;
    recipe.run.epochs = options->epochs;
    recipe.run.threads = options->threads;
    recipe.run.resume = true;
    if (variant == BAT_TENSION_VARIANT_ONE_HOT)
        recipe.embedding = BAT_TENSION_EMBEDDING_ONE_HOT;
    if (variant == BAT_TENSION_VARIANT_NO_EMBEDDING)
        recipe.embedding = BAT_TENSION_EMBEDDING_NONE;
    if (variant == BAT_TENSION_VARIANT_NO_CONSISTENCY)
        recipe.consistency = 0;
    if (variant == BAT_TENSION_VARIANT_NO_BENDING)
        recipe.bending = 0;
    if (variant == BAT_TENSION_VARIANT_NO_SMOOTHNESS)
        memset(recipe.smoothness, 0, sizeof recipe.smoothness);
    return recipe;
}

static bat_status count_weights(bat_tension_embedding embedding, size_t *weights, bat_error *error)
{
    learn_parameters parameters = {0};
    bat_status status = tension_predictor_make(embedding, &parameters, error);
    if (status == BAT_OK)
        *weights = parameters.total;
    learn_parameters_free(&parameters);
    return status;
}

/// Reference of the bending energies: that of the four-point scheme as printed, on the published validation curves.
static bat_status measure_four_point(double bending[SPACES], int threads, bat_error *error)
{
    bat_tension_row rows[SPACES];
    bat_curve_scheme scheme = bat_curve_scheme_angle(BAT_CURVE_TENSION_FOUR_POINT);
    scheme.sign = BAT_CURVE_ANGLE_SIGN_PRINTED;
    const bat_tension_method method = {"four-point-printed", NAN, scheme};
    bat_status status =
        bat_tension_table1_methods(BAT_TENSION_SET_KIND_PUBLISHED, &method, 1, rows, threads, (bat_progress){0}, error);
    for (size_t space = 0; space < SPACES && status == BAT_OK; space++)
        bending[space] = rows[space].bending.mean;
    return status;
}

static bat_status run_variant(const bat_tension_data *data, bat_tension_variant variant,
                              const bat_tension_ablation_options *options, bat_progress progress,
                              bat_tension_ablation_row *row, bat_error *error)
{
    char folder[PATH_SIZE];
    bat_curve_train_options recipe = recipe_of(variant, options);
    recipe.run.progress = progress;
    if (options->folder != NULL)
    {
        int length = snprintf(folder, PATH_SIZE, "%s/seed-%llu/%s", options->folder, (unsigned long long)options->seed,
                              NAMES[variant]);
        if (length < 0 || length >= PATH_SIZE)
            return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "the name of the folder is too long");
        recipe.run.folder = folder;
    }
    row->variant = NAMES[variant];
    bat_status status = count_weights(recipe.embedding, &row->weights, error);
    if (status == BAT_OK)
        status = curve_train_sized(&recipe, &(curve_train_size){.data = data}, &row->report, error);
    return status;
}

static void fill_scores(bat_tension_ablation_row *row, const double four_point[SPACES])
{
    for (size_t space = 0; space < SPACES; space++)
    {
        const bat_curve_train_score *score = &row->report.scores[0][space];
        row->scores[space] = (bat_tension_ablation_score){score->mean_nn, score->g1, score->bending / four_point[space]};
        row->published[space] = (bat_tension_ablation_score){NAN, NAN, NAN};
    }
}

bat_status tension_ablate_on(const bat_tension_data *data, const bat_tension_variant *variants, size_t count,
                             const bat_tension_ablation_options *options, bat_tension_ablation_row *rows, bat_error *error)
{
    double four_point[SPACES];
    bat_status status = measure_four_point(four_point, options->threads, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        progress_part part = {options->progress, (double)i / (double)count, 1 / (double)count};
        status = run_variant(data, variants[i], options, progress_of_part(&part), &rows[i], error);
        if (status == BAT_OK)
            fill_scores(&rows[i], four_point);
    }
    return status;
}

// The tables

/// Plane, sphere, disk: mean-NN, G1, bending.
typedef bat_tension_ablation_score published_row[SPACES];

static const published_row TABLE3[BAT_TENSION_TABLE3_ROWS] = {
    {{0.01673, 0.219, NAN}, {0.05438, 0.256, NAN}, {0.00434, 0.167, NAN}},
    {{0.01660, 0.223, NAN}, {0.05498, 0.247, NAN}, {0.00422, 0.152, NAN}},
    {{0.01531, 0.267, NAN}, {0.05116, 0.263, NAN}, {0.00559, 0.249, NAN}},
};

static const published_row TABLE4[BAT_TENSION_TABLE4_ROWS] = {
    {{0.01842, 0.370, 0.075}, {0.05436, 0.296, 0.918}, {0.00414, 0.217, 0.033}},
    {{0.01651, 0.248, 0.012}, {0.05195, 0.322, 0.046}, {0.00418, 0.155, 0.021}},
    {{0.01681, 0.248, 0.018}, {0.05141, 0.254, 0.096}, {0.00450, 0.160, 0.023}},
    {{0.02211, 0.442, 0.029}, {0.05843, 1.121, 0.599}, {0.00751, 0.420, 0.043}},
};

static bat_status make_table(const bat_tension_variant *variants, const published_row *published, size_t count,
                             const bat_tension_ablation_options *options, bat_tension_ablation_row *rows, bat_error *error)
{
    bat_tension_ablation_options defaults = bat_tension_ablation_defaults();
    bat_tension_data data;
    bat_status status = bat_tension_data_make(&data, error);
    if (status != BAT_OK)
        return status;
    status = tension_ablate_on(&data, variants, count, options != NULL ? options : &defaults, rows, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        memcpy(rows[i].published, published[i], sizeof rows[i].published);
    bat_tension_data_free(&data);
    return status;
}

bat_status bat_tension_table3(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows, bat_error *error)
{
    static const bat_tension_variant variants[] = {BAT_TENSION_VARIANT_FULL, BAT_TENSION_VARIANT_ONE_HOT,
                                                   BAT_TENSION_VARIANT_NO_EMBEDDING};
    return make_table(variants, TABLE3, BAT_TENSION_TABLE3_ROWS, options, rows, error);
}

bat_status bat_tension_table4(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows, bat_error *error)
{
    static const bat_tension_variant variants[] = {BAT_TENSION_VARIANT_FULL, BAT_TENSION_VARIANT_NO_CONSISTENCY,
                                                   BAT_TENSION_VARIANT_NO_BENDING, BAT_TENSION_VARIANT_NO_SMOOTHNESS};
    return make_table(variants, TABLE4, BAT_TENSION_TABLE4_ROWS, options, rows, error);
}
