#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>

enum
{
    DEFAULT_EPOCHS = 10
};

/// The two networks, with their published errors.
static const struct
{
    const char *name, *folder;
    double published;
} NETWORKS[2] = {{"boundary-informed", "informed", 6.38e-5}, {"uninformed", "uninformed", 2.93e-3}};

static size_t clouds_of(const reproduce_job *job)
{
    return job->clouds > 0 ? job->clouds : bat_surface_study_defaults().clouds;
}

static int train_network(const reproduce_job *job, size_t which, char path[REPRODUCE_PATH_SIZE])
{
    bat_error error;
    char folder[REPRODUCE_PATH_SIZE];
    bat_surface_train_options options = bat_surface_train_defaults(BAT_RECIPE_PUBLISHED);
    int code = reproduce_path(job->folder, NETWORKS[which].folder, folder);
    if (code == EXIT_DONE)
        code = reproduce_path(folder, "model.safetensors", path);
    if (code != EXIT_DONE)
        return code;
    options.run.seed = job->seed;
    options.uninformed = which == 1;
    options.run.epochs = job->epochs > 0 ? job->epochs : DEFAULT_EPOCHS;
    options.adam = true;
    options.rate = 1e-3;
    options.run.folder = folder;
    options.run.resume = true;
    options.run.progress = report_progress(NETWORKS[which].name);
    bat_status status = bat_surface_train(&options, NULL, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : report_failure(folder, &error);
}

/// Read the given networks, or train them.
static int get_network(const reproduce_job *job, size_t which, bat_surface_model **model)
{
    bat_error error;
    char trained[REPRODUCE_PATH_SIZE];
    const char *path = which == 0 ? job->model : job->uninformed;
    int code = path != NULL ? EXIT_DONE : train_network(job, which, trained);
    if (code != EXIT_DONE)
        return code;
    path = path != NULL ? path : trained;
    return bat_surface_model_read_published(path, model, &error) == BAT_OK ? EXIT_DONE : report_failure(path, &error);
}

static int print_ablation(const reproduce_job *job, const bat_surface_case *what, const bat_surface_score *scores)
{
    json_t *rows = json_array();
    if (!job->call.json)
        (void)printf("%zu clean clouds of %zu points, bidegree (%d, %d): mean squared error in the unit box\n\n%-20s %11s "
                     "%11s %9s\n",
                     clouds_of(job), what->points, what->degree, what->degree, "network", "ours", "published", "(ratio)");
    for (size_t m = 0; m < 2; m++)
    {
        (void)json_array_append_new(rows, json_pack("{s:s, s:o, s:f, s:I}", "network", NETWORKS[m].name, "mse",
                                                    report_number(scores[m].mse), "published", NETWORKS[m].published,
                                                    "succeeded", (json_int_t)scores[m].succeeded));
        if (!job->call.json)
            (void)printf("%-20s %11.3g %11.3g (%7.3f)\n", NETWORKS[m].name, scores[m].mse, NETWORKS[m].published,
                         scores[m].mse / NETWORKS[m].published);
    }
    double ratio = scores[1].mse / scores[0].mse, published = NETWORKS[1].published / NETWORKS[0].published;
    if (job->call.json)
        return report_json(
            json_pack("{s:o, s:o, s:f}", "rows", rows, "ratio", report_number(ratio), "published_ratio", published));
    json_decref(rows);
    (void)printf("%-20s %11.3g %11.3g\n", "uninformed/informed", ratio, published);
    if (job->model == NULL)
        (void)printf("\nTrained for %zu epochs with AdamW; the paper's networks saw 100,000 clouds.\n",
                     job->epochs > 0 ? job->epochs : (size_t)DEFAULT_EPOCHS);
    return EXIT_DONE;
}

int reproduce_surface_ablation(const reproduce_job *job)
{
    static const bat_surface_case WHAT = {1000, 0, 2};
    bat_surface_model *models[2] = {NULL, NULL};
    bat_surface_score scores[2];
    bat_error error;
    int code = get_network(job, 0, &models[0]);
    if (code == EXIT_DONE)
        code = get_network(job, 1, &models[1]);
    if (code == EXIT_DONE)
    {
        bat_surface_method methods[2];
        for (size_t m = 0; m < 2; m++)
            methods[m] = (bat_surface_method){NETWORKS[m].name, BAT_SURFACE_PARAMETERS_LEARNED, false, models[m], false};
        bat_surface_study_options options = bat_surface_study_defaults();
        options.seed = job->seed;
        options.clouds = clouds_of(job);
        options.progress = report_progress("measuring");
        bat_status status = bat_surface_study_clouds(&WHAT, methods, 2, &options, scores, &error);
        report_progress_end();
        code = status == BAT_OK ? print_ablation(job, &WHAT, scores) : report_failure(NULL, &error);
    }
    bat_surface_model_free(models[0]);
    bat_surface_model_free(models[1]);
    return code;
}
