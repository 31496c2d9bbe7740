#include "research/train/curve_train.h"

#include <stdlib.h>

static const train_recipe *const RECIPES[TRAIN_RECIPES] = {
    [BAT_RECIPE_PUBLISHED] = &curve_recipe_published, [BAT_RECIPE_BATTEN] = &curve_recipe_batten};

bat_curve_train_options bat_curve_train_defaults(bat_recipe recipe)
{
    bat_curve_train_options options = {.run = {.seed = 1, .epochs = 300}, .recipe = recipe};
    if (recipe == BAT_RECIPE_BATTEN)
        return options;
    options.smoothness[BAT_TENSION_SPACE_PLANE] = options.smoothness[BAT_TENSION_SPACE_DISK] = 0.05;
    options.smoothness[BAT_TENSION_SPACE_SPHERE] = 0.15;
    options.bending = 1e-4;
    options.consistency = 0.1;
    return options;
}

bat_curve_train_score curve_mean_score(const bat_curve_train_score *scores, size_t count)
{
    bat_curve_train_score sum = {0};
    for (size_t i = 0; i < count; i++)
    {
        sum.mean_nn += scores[i].mean_nn;
        sum.bending += scores[i].bending;
        sum.g1 += scores[i].g1;
    }
    double n = (double)count;
    return (bat_curve_train_score){sum.mean_nn / n, sum.bending / n, sum.g1 / n};
}

static bat_status fill_scores(const curve_training *t, bat_curve_train_report *report, bat_error *error)
{
    bool published = t->options->recipe == BAT_RECIPE_PUBLISHED;
    report->fairness_count = published ? 1 : BAT_CURVE_TRAIN_FAIRNESSES;
    if (!published)
        return curve_batten_score(t, report->scores, error);
    return curve_published_validate(&t->base.parameters, t->options->embedding, t->size.data->validation,
                                    t->options->run.group, t->options->run.threads, report->scores[0], error);
}

static void training_free(curve_training *t)
{
    learn_parameters_free(&t->base.parameters);
    bat_tension_data_free(&t->own_data);
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        bat_tension_set_free(&t->validation[space]);
    free(t->order);
}

bat_status curve_train_sized(const bat_curve_train_options *options, const curve_train_size *size,
                             bat_curve_train_report *report, bat_error *error)
{
    curve_training t = {.base.options = &options->run, .options = options, .size = *size};
    bat_curve_train_report made = {0};
    bat_status status = train_run(RECIPES, options->recipe, &t, &made.run, error);
    if (status == BAT_OK && report != NULL)
    {
        status = fill_scores(&t, &made, error);
        if (status == BAT_OK)
            *report = made;
    }
    training_free(&t);
    return status;
}

bat_status bat_curve_train(const bat_curve_train_options *options, bat_curve_train_report *report, bat_error *error)
{
    const bat_curve_train_options defaults = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    return curve_train_sized(options != NULL ? options : &defaults, &(curve_train_size){0}, report, error);
}
