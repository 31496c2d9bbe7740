#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <string.h>

enum
{
    FITTED = 4 ///< methods whose adaptive fits are compared
};

/// The methods of the figures.
static const bat_surface_method METHODS[] = {
    {"uniform", BAT_SURFACE_PARAMETERS_UNIFORM, true, NULL, false},
    {"inverse-distance", BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE, true, NULL, false},
    {"shape-preserving", BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, true, NULL, false},
    {"shape-preserving-own", BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, false, NULL, false},
    {"stretch-minimizing", BAT_SURFACE_PARAMETERS_STRETCH_MINIMIZING, false, NULL, false},
    {"learned", BAT_SURFACE_PARAMETERS_LEARNED, false, NULL, false},
};
enum
{
    METHOD_COUNT = sizeof METHODS / sizeof METHODS[0],
    SHAPE_PRESERVING = 2, ///< index in METHODS
    STRETCH_MINIMIZING = 4,
    LEARNED = 5
};

/// A study of scans: its output and its network.
typedef struct scan_study
{
    const reproduce_job *job;
    bat_surface_model *model; ///< null: the built-in one
    json_t *clouds, *fits, *ratios;
} scan_study;

static int study_begin(const reproduce_job *job, scan_study *study)
{
    bat_error error;
    *study = (scan_study){.job = job, .clouds = json_array(), .fits = json_array(), .ratios = json_array()};
    bat_status status = job->model != NULL ? bat_surface_model_read_published(job->model, &study->model, &error) : BAT_OK;
    return status == BAT_OK ? EXIT_DONE : report_failure(job->model, &error);
}

/// Print the JSON where it is wanted, and release everything.
static int study_end(scan_study *study, int code)
{
    if (code == EXIT_DONE && study->job->call.json)
        code =
            report_json(json_pack("{s:O, s:O, s:O}", "clouds", study->clouds, "fits", study->fits, "ratios", study->ratios));
    json_decref(study->clouds);
    json_decref(study->fits);
    json_decref(study->ratios);
    bat_surface_model_free(study->model);
    return code;
}

static int read_cloud(const scan_study *study, const char *file, bat_cloud *cloud)
{
    bat_error error;
    char path[REPRODUCE_PATH_SIZE];
    int code = reproduce_path(study->job->data, file, path);
    if (code != EXIT_DONE)
        return code;
    bat_status status = bat_cloud_read(path, NULL, cloud, &error);
    if (status == BAT_OK && cloud->boundary_count == 0)
    {
        status = bat_cloud_find_boundary(cloud, &error);
        if (status != BAT_OK)
            bat_cloud_free(cloud);
    }
    return status == BAT_OK ? EXIT_DONE : report_failure(path, &error);
}

// One patch through a scan

static void print_scores(const scan_study *study, const char *file, const bat_cloud *cloud, const bat_surface_score *scores)
{
    for (size_t m = 0; m < METHOD_COUNT; m++)
    {
        const bat_surface_score *score = &scores[m];
        (void)json_array_append_new(
            study->clouds, json_pack("{s:s, s:I, s:i, s:s, s:o, s:o, s:I}", "file", file, "points", (json_int_t)cloud->count,
                                     "degree", 2, "method", METHODS[m].name, "mse", report_number(score->mse), "seconds",
                                     report_number(score->seconds), "succeeded", (json_int_t)score->succeeded));
        if (study->job->call.json)
            continue;
        (void)printf("%6zu %-22s", cloud->count, METHODS[m].name);
        if (score->succeeded == 0)
            (void)printf(" %11s\n", "failed");
        else
            (void)printf(" %11.4g %12.3f\n", score->mse, 1e3 * score->seconds);
    }
    (void)fflush(stdout);
}

static int study_scan(const scan_study *study, const char *file)
{
    bat_error error;
    bat_cloud cloud;
    bat_surface_method methods[METHOD_COUNT];
    bat_surface_score scores[METHOD_COUNT];
    memcpy(methods, METHODS, sizeof METHODS);
    methods[LEARNED].model = study->model;
    int code = read_cloud(study, file, &cloud);
    if (code != EXIT_DONE)
        return code;
    if (bat_surface_study_scan(&cloud, 2, methods, METHOD_COUNT, scores, &error) == BAT_OK)
        print_scores(study, file, &cloud, scores);
    else
        code = report_failure(file, &error);
    bat_cloud_free(&cloud);
    return code;
}

// Adaptive fits

/// A fit of the paper with the published mean squared errors in the file's units; 0 if there are none.
typedef struct published_fit
{
    const char *name; ///< also the name of the picture
    int degree[2];
    size_t functions;
    double shape_preserving, learned;
    bool no_restarts;
} published_fit;

static void print_fit(const scan_study *study, const published_fit *what, const char *method, double published,
                      const bat_surface_trial *trial)
{
    const bat_surface_fit_report *report = &trial->result.report;
    const bat_surface_fit_round *last = &report->rounds[report->count - 1];
    const bat_surface_candidate *candidate = &trial->result.candidates[0];
    json_t *row = json_pack(
        "{s:s, s:[ii], s:s, s:b, s:I, s:o, s:o, s:o, s:o, s:o, s:I, s:I, s:I}", "cloud", what->name, "degree",
        what->degree[0], what->degree[1], "method", method, "own_neighbourhoods", (int)trial->own, "functions",
        (json_int_t)last->functions, "mse", report_number(last->mean_squared), "largest", report_number(last->largest),
        "held_out", report_number(report->held_out_rms), "parameter_seconds", report_number(candidate->seconds),
        "fit_seconds", report_number(candidate->fit_seconds), "folds", (json_int_t)candidate->folds.folded, "folds_repaired",
        (json_int_t)(candidate->folds.folded - candidate->repaired.folded), "folds_corrected",
        (json_int_t)trial->result.folds.folded);
    if (published > 0)
        (void)json_object_set_new(row, "published_mse", json_real(published));
    (void)json_array_append_new(study->fits, row);
    if (study->job->call.json)
        return;
    (void)printf("%-12s (%d, %d) %-20s %9zu %11.4g %11.4g %11.4g", what->name, what->degree[0], what->degree[1], method,
                 last->functions, last->mean_squared, last->largest, report->held_out_rms * report->held_out_rms);
    if (published > 0)
        (void)printf(" %11.3g", published);
    else
        (void)printf(" %11s", "");
    (void)printf(" %8zu %9zu%s\n", candidate->folds.folded, trial->result.folds.folded,
                 trial->own ? "  (our neighbourhoods: the published ones fail)" : "");
}

static void print_ratio(const scan_study *study, const published_fit *what, const bat_surface_trial *trials)
{
    double errors[FITTED];
    for (size_t m = 0; m < FITTED; m++)
        errors[m] = trials[m].result.report.rounds[trials[m].result.report.count - 1].mean_squared;
    double ratio = errors[0] / errors[1], unfolded = errors[0] / errors[2];
    bool known = what->shape_preserving > 0 && what->learned > 0;
    json_t *row = json_pack("{s:s, s:[ii], s:o, s:o}", "cloud", what->name, "degree", what->degree[0], what->degree[1],
                            "ratio", report_number(ratio), "ratio_unfolded", report_number(unfolded));
    if (known)
        (void)json_object_set_new(row, "published", json_real(what->shape_preserving / what->learned));
    (void)json_array_append_new(study->ratios, row);
    if (study->job->call.json)
        return;
    (void)printf("%-12s (%d, %d) shape-preserving / learned: %.3f, unfolded %.3f", what->name, what->degree[0],
                 what->degree[1], ratio, unfolded);
    if (known)
        (void)printf(", published %.2f", what->shape_preserving / what->learned);
    (void)printf("\n");
}

static int draw_fits(const scan_study *study, const published_fit *what, const bat_cloud *cloud,
                     const bat_surface_method *methods, const bat_surface_trial *trials)
{
    bat_error error;
    char file[80];
    reproduce_picture picture;
    (void)snprintf(file, sizeof file, "%s-%d-%d.png", what->name, what->degree[0], what->degree[1]);
    int code = reproduce_picture_add(study->job, file, &picture);
    if (code == EXIT_DONE && bat_surface_study_draw(picture.write_to, cloud, methods, trials, FITTED, &error) != BAT_OK)
        code = report_failure(picture.path, &error);
    return code;
}

static int study_fits(const scan_study *study, const published_fit *what, const bat_cloud *cloud)
{
    bat_error error;
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
    for (int k = 0; k < 2; k++)
        fit.space.degree[k] = what->degree[k];
    bat_status status = BAT_OK;
    for (size_t m = 0; m < FITTED && status == BAT_OK; m++)
        status = bat_surface_study_fit(cloud, &methods[m], &fit, &trials[m], &error);
    report_progress_end();
    int code = status == BAT_OK ? EXIT_DONE : report_failure(what->name, &error);
    for (size_t m = 0; m < FITTED && code == EXIT_DONE; m++)
        print_fit(study, what, methods[m].name, published[m], &trials[m]);
    if (code == EXIT_DONE)
        print_ratio(study, what, trials);
    if (code == EXIT_DONE && study->job->folder != NULL)
        code = draw_fits(study, what, cloud, methods, trials);
    for (size_t m = 0; m < FITTED; m++)
        bat_surface_trial_free(&trials[m]);
    return code;
}

static void print_fit_head(const scan_study *study, const char *units)
{
    if (study->job->call.json)
        return;
    (void)printf(
        "adaptive fits, errors in %s: mean squared and largest distance, and mean squared distance of held-out points\n\n",
        units);
    (void)printf("%-12s %6s %-20s %9s %11s %11s %11s %11s %8s %9s\n", "cloud", "", "parameters", "functions", "mse",
                 "largest", "held out", "published", "folds", "corrected");
}

// The results

int reproduce_surface_nefertiti(const reproduce_job *job)
{
    static const char *const FILES[] = {"nefertiti-532.xyz",  "nefertiti-1043.xyz", "nefertiti-2062.xyz",
                                        "nefertiti-3253.xyz", "nefertiti-6024.xyz", "nefertiti-8818.xyz"};
    static const published_fit FITS[] = {{"nefertiti", {2, 2}, 5300, 9.32e-4, 6.32e-4, false},
                                         {"no-restarts", {2, 2}, 5300, 9.32e-4, 6.32e-4, true}};
    scan_study study;
    bat_cloud cloud;
    int code = study_begin(job, &study);
    if (code == EXIT_DONE && !job->call.json)
        (void)printf("one biquadratic patch through each cloud: mean squared error in its unit box\n\n%6s %-22s %11s %12s\n",
                     "points", "method", "mse", "milliseconds");
    for (size_t i = 0; i < sizeof FILES / sizeof FILES[0] && code == EXIT_DONE; i++)
        code = study_scan(&study, FILES[i]);
    if (code == EXIT_DONE && !job->call.json)
        (void)printf(
            "\nFigure 12 of the paper, in words: uniform and inverse-distance errors are in general much higher than\n"
            "shape-preserving and learned ones, which are similar; learned is the fastest of all.\n\n");
    if (code == EXIT_DONE)
        code = read_cloud(&study, FILES[sizeof FILES / sizeof FILES[0] - 1], &cloud);
    if (code == EXIT_DONE)
    {
        print_fit_head(&study, "the file's units");
        for (size_t i = 0; i < sizeof FITS / sizeof FITS[0] && code == EXIT_DONE; i++)
            code = study_fits(&study, &FITS[i], &cloud);
        bat_cloud_free(&cloud);
    }
    return study_end(&study, code);
}

int reproduce_surface_face(const reproduce_job *job)
{
    static const published_fit FITS[] = {{"face", {3, 3}, 2700, 0, 6.86e-5, false},
                                         {"face", {4, 4}, 2800, 0, 6.08e-5, false}};
    scan_study study;
    bat_cloud cloud = {0};
    int code = study_begin(job, &study);
    if (code == EXIT_DONE)
        code = read_cloud(&study, "face-9283.xyz", &cloud);
    if (code == EXIT_DONE)
        print_fit_head(&study, "the file's units");
    for (size_t i = 0; i < sizeof FITS / sizeof FITS[0] && code == EXIT_DONE; i++)
        code = study_fits(&study, &FITS[i], &cloud);
    bat_cloud_free(&cloud);
    return study_end(&study, code);
}

int reproduce_surface_shapes(const reproduce_job *job)
{
    static const published_fit FITS[] = {{"hull", {5, 2}, 4100, 0, 3.38e-6, false},
                                         {"blade", {5, 2}, 2450, 0, 5.61e-6, false}};
    static const size_t POINTS = 9636;
    scan_study study;
    bat_error error;
    int code = study_begin(job, &study);
    if (code == EXIT_DONE)
        print_fit_head(&study, "the units of the shapes, which are ours; the published ones are of other shapes");
    for (size_t i = 0; i < sizeof FITS / sizeof FITS[0] && code == EXIT_DONE; i++)
    {
        bat_cloud cloud = {0};
        if (bat_cloud_shape(FITS[i].name, POINTS, 1, &cloud, NULL, &error) != BAT_OK)
            code = report_failure(FITS[i].name, &error);
        if (code == EXIT_DONE)
            code = study_fits(&study, &FITS[i], &cloud);
        bat_cloud_free(&cloud);
    }
    return study_end(&study, code);
}
