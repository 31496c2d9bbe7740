#include "reproduce.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Giannelli et al. (2023), the BIDGCN paper.

enum
{
    DEFAULT_EPOCHS = 10, ///< of the networks of section 6.1
    FITTED = 4           ///< methods whose adaptive fits are compared
};

/// The methods of the figures, followed by additional ones.
static const bat_surface_method METHODS[] = {
    {"uniform", BAT_SURFACE_PARAMETERS_UNIFORM, true, NULL, false},
    {"inverse-distance", BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE, true, NULL, false},
    {"shape-preserving", BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, true, NULL, false},
    {"learned", BAT_SURFACE_PARAMETERS_LEARNED, false, NULL, false},
    {"uniform-own", BAT_SURFACE_PARAMETERS_UNIFORM, false, NULL, false},
    {"inverse-distance-own", BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE, false, NULL, false},
    {"shape-preserving-own", BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, false, NULL, false},
    {"stretch-minimizing", BAT_SURFACE_PARAMETERS_STRETCH_MINIMIZING, false, NULL, false},
};
enum
{
    METHOD_COUNT = sizeof METHODS / sizeof METHODS[0],
    // Indices in METHODS.
    SHAPE_PRESERVING = 2,
    LEARNED = 3,
    STRETCH_MINIMIZING = 7
};

/// Those of scans.
static const size_t SCAN_METHODS[] = {0, 1, SHAPE_PRESERVING, 6, STRETCH_MINIMIZING, LEARNED};
enum
{
    SCAN_METHOD_COUNT = sizeof SCAN_METHODS / sizeof SCAN_METHODS[0]
};

static bat_surface_study_options study_options(const reproduce_job *job)
{
    bat_surface_study_options options = bat_surface_study_defaults();
    options.seed = job->seed;
    if (job->clouds > 0)
        options.clouds = job->clouds;
    return options;
}

// Section 6.1

/// The two networks, with their published errors.
static const struct
{
    const char *name, *folder;
    double published;
} NETWORKS[2] = {{"boundary-informed", "informed", 6.38e-5}, {"uninformed", "uninformed", 2.93e-3}};

static int train_network(const reproduce_job *job, size_t which, char path[FOLDER_PATH_SIZE])
{
    char folder[FOLDER_PATH_SIZE];
    bat_surface_train_options options = bat_surface_train_defaults(BAT_RECIPE_PUBLISHED);
    int code = folder_path(job->folder, NETWORKS[which].folder, folder);
    if (code == EXIT_DONE)
        code = folder_path(folder, "model.safetensors", path);
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
    return report_status(NULL, folder, bat_surface_train(&options, NULL, report_error()));
}

/// Read the given networks, or train them.
static int get_network(const reproduce_job *job, size_t which, bat_surface_model **model)
{
    char trained[FOLDER_PATH_SIZE];
    const char *path = which == 0 ? job->model : job->uninformed;
    int code = path != NULL ? EXIT_DONE : train_network(job, which, trained);
    if (code != EXIT_DONE)
        return code;
    path = path != NULL ? path : trained;
    return report_status(NULL, path, bat_surface_model_read_published(path, model, report_error()));
}

static int print_ablation(const reproduce_job *job, const bat_surface_case *what, size_t clouds,
                          const bat_surface_score *scores)
{
    report_table table = report_begin(job->call.json);
    report_head(&table,
                "%zu clean clouds of %zu points, bidegree (%d, %d): mean squared error in the unit box\n\nnetwork           "
                "          ours   published   (ratio)\n",
                clouds, what->points, what->degree, what->degree);
    for (size_t m = 0; m < 2; m++)
        report_row(&table, "{network:-20} {mse:11.3g} {published:11.3g} ({ratio:7.3f})\n",
                   "network:s mse:n published:n succeeded:z -ratio:n", NETWORKS[m].name, scores[m].mse,
                   NETWORKS[m].published, scores[m].succeeded, scores[m].mse / NETWORKS[m].published);
    return report_print(job->call.json,
                        "uninformed/informed  {ratio:11.3g} {published_ratio:11.3g}\n[trained?\nTrained for {epochs} epochs "
                        "with AdamW; the paper's networks saw 100,000 clouds.\n]",
                        "rows:o ratio:n published_ratio:n -trained:b -epochs:z", table.rows, scores[1].mse / scores[0].mse,
                        NETWORKS[1].published / NETWORKS[0].published, (int)(job->model == NULL),
                        job->epochs > 0 ? job->epochs : (size_t)DEFAULT_EPOCHS);
}

int reproduce_surface_ablation(const reproduce_job *job)
{
    static const bat_surface_case WHAT = {1000, 0, 2};
    bat_surface_model *models[2] = {NULL, NULL};
    bat_surface_score scores[2];
    int code = get_network(job, 0, &models[0]);
    if (code == EXIT_DONE)
        code = get_network(job, 1, &models[1]);
    if (code == EXIT_DONE)
    {
        bat_surface_method methods[2];
        for (size_t m = 0; m < 2; m++)
            methods[m] = (bat_surface_method){NETWORKS[m].name, BAT_SURFACE_PARAMETERS_LEARNED, false, models[m], false};
        bat_surface_study_options options = study_options(job);
        options.progress = report_progress("measuring");
        code = report_status(NULL, NULL, bat_surface_study_clouds(&WHAT, methods, 2, &options, scores, report_error()));
        if (code == EXIT_DONE)
            code = print_ablation(job, &WHAT, options.clouds, scores);
    }
    bat_surface_model_free(models[0]);
    bat_surface_model_free(models[1]);
    return code;
}

// Random clouds

/// The ratio is meaningful only if both excesses are positive: parameters that fit the noise leave smaller errors than the
/// true ones.
static void report_score(report_table *table, const bat_surface_case *what, const char *method,
                         const bat_surface_score *score, const bat_surface_score *reference)
{
    report_row(
        table,
        "{points:6} {method:-22} [succeeded?{mse:11.4g} {excess:11.4g} [compared?({ratio:7.3f})][!compared?         ] "
        "{1000 seconds:12.3f}][!succeeded?          -           -                      -] {succeeded:9}\n",
        "points:z noise:n degree:i method:s mse:n excess:n seconds:n succeeded:z -compared:b -ratio:n", what->points,
        what->noise, what->degree, method, score->mse, score->excess, score->seconds, score->succeeded,
        (int)(score->excess > 0 && reference->excess > 0), score->excess / reference->excess);
}

static int run_case(const bat_surface_case *what, const bat_surface_method *methods, const bat_surface_study_options *study,
                    report_table *table)
{
    char label[80];
    bat_surface_score scores[METHOD_COUNT];
    bat_surface_study_options options = *study;
    (void)snprintf(label, sizeof label, "%zu points, noise %g, bidegree %d", what->points, what->noise, what->degree);
    options.progress = report_progress(label);
    int code =
        report_status(NULL, NULL, bat_surface_study_clouds(what, methods, METHOD_COUNT, &options, scores, report_error()));
    for (size_t m = 0; m < METHOD_COUNT && code == EXIT_DONE; m++)
        report_score(table, what, methods[m].name, &scores[m], &scores[SHAPE_PRESERVING]);
    return code;
}

static int run_cases(const reproduce_job *job, const bat_surface_method *methods, const bat_surface_study_options *options,
                     report_table *table)
{
    static const number_list POINTS = {{50, 100, 200, 500, 1000, 2000, 5000}, 7}, NOISES = {{0, 0.005, 0.01, 0.05}, 4},
                             DEGREES = {{2, 3, 4, 5}, 4};
    const number_list *points = job->points.count > 0 ? &job->points : &POINTS;
    const number_list *noises = job->noises.count > 0 ? &job->noises : &NOISES;
    const number_list *degrees = job->degrees.count > 0 ? &job->degrees : &DEGREES;
    int code = EXIT_DONE;
    for (size_t d = 0; d < degrees->count; d++)
        for (size_t n = 0; n < noises->count; n++)
        {
            double degree = degrees->numbers[d], noise = noises->numbers[n];
            report_head(
                table,
                "\nbidegree (%g, %g), noise %g: means over those of %zu clouds that could be parameterized\n\npoints method "
                "                        mse      excess   (ratio) milliseconds succeeded\n",
                degree, degree, noise, options->clouds);
            for (size_t p = 0; p < points->count && code == EXIT_DONE; p++)
                code =
                    run_case(&(bat_surface_case){(size_t)points->numbers[p], noise, (int)degree}, methods, options, table);
        }
    return code;
}

int reproduce_surface_clouds(const reproduce_job *job)
{
    bat_surface_method methods[METHOD_COUNT];
    bat_surface_study_options options = study_options(job);
    bat_surface_model *model = NULL;
    int code = report_status(NULL, job->model, bat_surface_model_read_published(job->model, &model, report_error()));
    if (code != EXIT_DONE)
        return code;
    memcpy(methods, METHODS, sizeof METHODS);
    methods[LEARNED].model = model;
    report_table table = report_begin(job->call.json);
    code = run_cases(job, methods, &options, &table);
    bat_surface_model_free(model);
    if (code != EXIT_DONE)
        return report_drop(&table, code);
    return report_print(
        job->call.json,
        "\nErrors are in the unit box of each cloud; excess is less those with the true parameters, negative where "
        "parameters follow\nthe noise; the ratio is to the excess of the published shape-preserving parameters; times are "
        "of one thread.\n\n"
        "What Giannelli et al. (2023) say, in figures without numbers:\n"
        "  figure 5, no noise      learned about as good as shape-preserving, both much better than the others; two orders\n"
        "                          of magnitude faster than shape-preserving\n"
        "  figure 5, noise         learned much better than all others\n"
        "  figures 6 and 7         noise 0.05: learned always succeeds, the others often fail on few points\n"
        "  figures 8 and 9         higher degrees: about the same without noise, learned better with noise 0.01\n",
        "clouds:z seed:z rows:o", options.clouds, (size_t)options.seed, table.rows);
}

// Scans and shapes

/// A study of scans: its output and its network.
typedef struct scan_study
{
    const reproduce_job *job;
    bat_surface_model *model; ///< null: the built-in one
    report_table clouds, fits, ratios;
} scan_study;

static int study_begin(const reproduce_job *job, scan_study *study)
{
    bool json = job->call.json;
    *study =
        (scan_study){.job = job, .clouds = report_begin(json), .fits = report_begin(json), .ratios = report_begin(json)};
    return report_status(NULL, job->model,
                         job->model != NULL ? bat_surface_model_read_published(job->model, &study->model, report_error())
                                            : BAT_OK);
}

/// Print the JSON where it is wanted, and release everything.
static int study_end(scan_study *study, int code)
{
    bat_surface_model_free(study->model);
    if (code == EXIT_DONE)
        return report_print(study->job->call.json, "", "clouds:o fits:o ratios:o", study->clouds.rows, study->fits.rows,
                            study->ratios.rows);
    (void)report_drop(&study->clouds, code);
    (void)report_drop(&study->fits, code);
    return report_drop(&study->ratios, code);
}

static int read_cloud(const scan_study *study, const char *file, bat_cloud *cloud)
{
    char path[FOLDER_PATH_SIZE];
    int code = folder_path(study->job->data, file, path);
    if (code != EXIT_DONE)
        return code;
    bat_status status = bat_cloud_read(path, NULL, cloud, report_error());
    if (status == BAT_OK && cloud->boundary_count == 0)
    {
        status = bat_cloud_find_boundary(cloud, report_error());
        if (status != BAT_OK)
            bat_cloud_free(cloud);
    }
    return report_status(NULL, path, status);
}

/// One patch through a scan.
static int study_scan(scan_study *study, const char *file)
{
    bat_cloud cloud;
    bat_surface_method methods[SCAN_METHOD_COUNT];
    bat_surface_score scores[SCAN_METHOD_COUNT];
    for (size_t m = 0; m < SCAN_METHOD_COUNT; m++)
        methods[m] = METHODS[SCAN_METHODS[m]];
    methods[SCAN_METHOD_COUNT - 1].model = study->model;
    int code = read_cloud(study, file, &cloud);
    if (code != EXIT_DONE)
        return code;
    code = report_status(NULL, file, bat_surface_study_scan(&cloud, 2, methods, SCAN_METHOD_COUNT, scores, report_error()));
    for (size_t m = 0; m < SCAN_METHOD_COUNT && code == EXIT_DONE; m++)
        report_row(&study->clouds,
                   "{points:6} {method:-22} [succeeded?{mse:11.4g} {1000 seconds:12.3f}][!succeeded?     failed]\n",
                   "file:s points:z degree:i method:s mse:n seconds:n succeeded:z", file, cloud.count, 2, methods[m].name,
                   scores[m].mse, scores[m].seconds, scores[m].succeeded);
    bat_cloud_free(&cloud);
    return code;
}

/// A fit of the paper with the published mean squared errors in the file's units; 0 if there are none.
typedef struct published_fit
{
    const char *name; ///< also the name of the picture
    int degree[2];
    size_t functions;
    double shape_preserving, learned;
    bool no_restarts;
} published_fit;

static json_t *degrees_json(const published_fit *what)
{
    return json_pack("[i, i]", what->degree[0], what->degree[1]);
}

static void report_fit(scan_study *study, const published_fit *what, const char *method, double published,
                       const bat_surface_trial *trial)
{
    const bat_surface_fit_report *report = &trial->result.report;
    const bat_surface_fit_round *last = &report->rounds[report->count - 1];
    const bat_surface_candidate *candidate = &trial->result.candidates[0];
    report_row(&study->fits,
               "{cloud:-12} ({p}, {q}) {method:-20} {functions:9} {mse:11.4g} {largest:11.4g} {held_out_square:11.4g} "
               "[published_mse?{published_mse:11.3g}][!published_mse?           ] {folds:8} {folds_corrected:9}"
               "[own_neighbourhoods?  (our neighbourhoods: the published ones fail)]\n",
               "cloud:s -p:i -q:i degree:o method:s own_neighbourhoods:b functions:z mse:n largest:n held_out:n "
               "-held_out_square:n parameter_seconds:n fit_seconds:n folds:z folds_repaired:z folds_corrected:z "
               "published_mse:n?",
               what->name, what->degree[0], what->degree[1], degrees_json(what), method, (int)trial->own, last->functions,
               last->mean_squared, last->largest, report->held_out_rms, report->held_out_rms * report->held_out_rms,
               candidate->seconds, candidate->fit_seconds, candidate->folds.folded,
               candidate->folds.folded - candidate->repaired.folded, trial->result.folds.folded,
               published > 0 ? published : NAN);
}

static void report_ratio(scan_study *study, const published_fit *what, const bat_surface_trial *trials)
{
    double errors[FITTED];
    for (size_t m = 0; m < FITTED; m++)
        errors[m] = trials[m].result.report.rounds[trials[m].result.report.count - 1].mean_squared;
    bool known = what->shape_preserving > 0 && what->learned > 0;
    report_row(&study->ratios,
               "{cloud:-12} ({p}, {q}) shape-preserving / learned: {ratio:.3f}, unfolded {ratio_unfolded:.3f}[published?, "
               "published {published:.2f}]\n",
               "cloud:s -p:i -q:i degree:o ratio:n ratio_unfolded:n published:n?", what->name, what->degree[0],
               what->degree[1], degrees_json(what), errors[0] / errors[1], errors[0] / errors[2],
               known ? what->shape_preserving / what->learned : NAN);
}

static int study_fit(scan_study *study, const published_fit *what, const bat_cloud *cloud)
{
    const double published[FITTED] = {what->shape_preserving, what->learned, 0, 0};
    bat_surface_method methods[FITTED] = {METHODS[SHAPE_PRESERVING],
                                          METHODS[LEARNED],
                                          {"learned-unfolded", BAT_SURFACE_PARAMETERS_LEARNED, false, NULL, true},
                                          METHODS[STRETCH_MINIMIZING]};
    bat_surface_trial trials[FITTED] = {0};
    bat_surface_fit_options fit = bat_surface_fit_defaults();
    methods[1].model = methods[2].model = study->model;
    fit.functions = what->functions;
    fit.corrections = study->job->corrections;
    fit.restarts = !what->no_restarts;
    fit.progress = report_progress(what->name);
    memcpy(fit.space.degree, what->degree, sizeof what->degree);
    bat_status status = BAT_OK;
    for (size_t m = 0; m < FITTED && status == BAT_OK; m++)
        status = bat_surface_study_fit(cloud, &methods[m], &fit, &trials[m], report_error());
    int code = report_status(NULL, what->name, status);
    for (size_t m = 0; m < FITTED && code == EXIT_DONE; m++)
        report_fit(study, what, methods[m].name, published[m], &trials[m]);
    if (code == EXIT_DONE)
        report_ratio(study, what, trials);
    char file[80];
    output_file picture;
    bool drawn = code == EXIT_DONE && study->job->folder != NULL;
    (void)snprintf(file, sizeof file, "%s-%d-%d.png", what->name, what->degree[0], what->degree[1]);
    if (drawn)
        code = output_add(&study->job->call, study->job->folder, file, &picture);
    if (drawn && code == EXIT_DONE)
        code = report_status(NULL, picture.path,
                             bat_surface_study_draw(picture.write_to, cloud, methods, trials, FITTED, report_error()));
    for (size_t m = 0; m < FITTED; m++)
        bat_surface_trial_free(&trials[m]);
    return code;
}

/// The two fits of a result.
static int study_fits(scan_study *study, const published_fit fits[2], const bat_cloud *cloud, const char *units)
{
    report_head(&study->fits,
                "adaptive fits, errors in %s: mean squared and largest distance, and mean squared distance of held-out "
                "points\n\ncloud               parameters           functions         mse     largest    held out   "
                "published    folds corrected\n",
                units);
    int code = EXIT_DONE;
    for (size_t i = 0; i < 2 && code == EXIT_DONE; i++)
    {
        static const size_t POINTS = 9636;
        bat_cloud shape = {0};
        if (cloud == NULL)
            code = report_status(NULL, fits[i].name, bat_cloud_shape(fits[i].name, POINTS, 1, &shape, NULL, report_error()));
        if (code == EXIT_DONE)
            code = study_fit(study, &fits[i], cloud != NULL ? cloud : &shape);
        bat_cloud_free(&shape);
    }
    return code;
}

/// A result: scans, each with one patch, and two adaptive fits.
typedef struct fit_result
{
    const char *scans[6]; ///< the last one is also fitted
    const char *cloud;    ///< what is fitted where there are no scans; null: the shapes that the fits name
    const char *units;
    published_fit fits[2];
} fit_result;

static int reproduce_fits(const reproduce_job *job, const fit_result *what)
{
    scan_study study;
    bat_cloud cloud = {0};
    const char *fitted = what->cloud;
    int code = study_begin(job, &study);
    if (code == EXIT_DONE && what->scans[0] != NULL)
        report_head(&study.clouds, "one biquadratic patch through each cloud: mean squared error in its unit box\n\npoints "
                                   "method                         mse milliseconds\n");
    for (size_t i = 0; i < sizeof what->scans / sizeof *what->scans && what->scans[i] != NULL && code == EXIT_DONE; i++)
        code = study_scan(&study, fitted = what->scans[i]);
    if (code == EXIT_DONE && what->scans[0] != NULL)
        report_head(
            &study.clouds,
            "\nFigure 12 of the paper, in words: uniform and inverse-distance errors are in general much higher than\n"
            "shape-preserving and learned ones, which are similar; learned is the fastest of all.\n\n");
    if (code == EXIT_DONE && fitted != NULL)
        code = read_cloud(&study, fitted, &cloud);
    if (code == EXIT_DONE)
        code = study_fits(&study, what->fits, fitted != NULL ? &cloud : NULL, what->units);
    bat_cloud_free(&cloud);
    return study_end(&study, code);
}

int reproduce_surface_nefertiti(const reproduce_job *job)
{
    static const fit_result WHAT = {.scans = {"nefertiti-532.xyz", "nefertiti-1043.xyz", "nefertiti-2062.xyz",
                                              "nefertiti-3253.xyz", "nefertiti-6024.xyz", "nefertiti-8818.xyz"},
                                    .units = "the file's units",
                                    .fits = {{"nefertiti", {2, 2}, 5300, 9.32e-4, 6.32e-4, false},
                                             {"no-restarts", {2, 2}, 5300, 9.32e-4, 6.32e-4, true}}};
    return reproduce_fits(job, &WHAT);
}

int reproduce_surface_face(const reproduce_job *job)
{
    static const fit_result WHAT = {
        .cloud = "face-9283.xyz",
        .units = "the file's units",
        .fits = {{"face", {3, 3}, 2700, 0, 6.86e-5, false}, {"face", {4, 4}, 2800, 0, 6.08e-5, false}}};
    return reproduce_fits(job, &WHAT);
}

int reproduce_surface_shapes(const reproduce_job *job)
{
    static const fit_result WHAT = {
        .units = "the units of the shapes, which are ours; the published ones are of other shapes",
        .fits = {{"hull", {5, 2}, 4100, 0, 3.38e-6, false}, {"blade", {5, 2}, 2450, 0, 5.61e-6, false}}};
    return reproduce_fits(job, &WHAT);
}
