/// @file
/// Studies of parameterizations: Giannelli, Imperatore, Mantzaflaris and Scholz, "BIDGCN" (2023), section 6. Errors are mean
/// squared residuals of the least-squares Bezier patch for the parameters of a method, or results of adaptive fits.

#include "batten/research/surface_study.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "batten/surface_picture.h"
#include "linalg/blas_single.h"
#include "mesh/measure/unit_box.h"
#include "research/train/bezier_fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

bat_surface_study_options bat_surface_study_defaults(void)
{
    return (bat_surface_study_options){.clouds = 100, .seed = 1};
}

/// CPU time of this thread in seconds.
static double thread_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bat_status check_methods(const bat_surface_method *methods, size_t count, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
        if (methods[i].parameters <= BAT_SURFACE_PARAMETERS_AUTO || methods[i].parameters >= BAT_SURFACE_PARAMETERS_GIVEN)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "method %zu is none that a study can try", i);
    return BAT_OK;
}

// One cloud

/// A cloud in the unit box, with the workspace of its fits.
typedef struct study_cloud
{
    bat_cloud boxed; ///< only its points are owned
    double *parameters;
    bezier_fit fit;
} study_cloud;

static void study_cloud_free(study_cloud *study)
{
    free(study->boxed.points);
    free(study->parameters);
    free(study->fit.residual);
}

static bat_status study_cloud_make(const bat_cloud *cloud, int degree, study_cloud *study, bat_error *error)
{
    size_t count = cloud->count;
    *study = (study_cloud){.boxed = *cloud, .parameters = memory_array(count, 2 * sizeof *study->parameters)};
    study->boxed.points = memory_array(count, 3 * sizeof *study->boxed.points);
    study->fit.residual = memory_array(count, 3 * sizeof *study->fit.residual);
    study->fit.patch.degree = degree;
    if (study->boxed.points == NULL || study->parameters == NULL || study->fit.residual == NULL)
    {
        study_cloud_free(study);
        return error_memory(error, count * 8 * sizeof(double));
    }
    unit_box box = unit_box_of(cloud->points, count);
    for (size_t i = 0; i < 3 * count; i++)
        study->boxed.points[i] = unit_box_in(&box, i, cloud->points[i]);
    return BAT_OK;
}

/// The mean squared residual of the patch for some parameters.
static bat_status fit_patch(study_cloud *study, const double *parameters, bat_error *error)
{
    return bezier_fit_make(study->boxed.points, parameters, study->boxed.count, &study->fit, error);
}

static bat_status parameterize(const bat_cloud *cloud, const double *boundary, const bat_surface_method *method,
                               double *parameters, bat_error *error)
{
    static const bat_cloud_parameterization CLASSICAL[BAT_SURFACE_PARAMETERS_COUNT] = {
        [BAT_SURFACE_PARAMETERS_UNIFORM] = BAT_CLOUD_PARAMETERIZATION_UNIFORM,
        [BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE] = BAT_CLOUD_PARAMETERIZATION_INVERSE_DISTANCE,
        [BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING] = BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING,
        [BAT_SURFACE_PARAMETERS_MEAN_VALUE] = BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE,
        [BAT_SURFACE_PARAMETERS_STRETCH_MINIMIZING] = BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING,
    };
    if (method->parameters == BAT_SURFACE_PARAMETERS_LEARNED)
        return bat_surface_model_parameterize(method->model, cloud, boundary, 1, parameters, error);
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.method = CLASSICAL[method->parameters];
    options.published = method->published;
    options.threads = 1;
    return bat_cloud_parameterize(cloud, boundary, &options, parameters, error);
}

/// The result of a method on a cloud.
typedef struct outcome
{
    bool succeeded;
    double mse, floor, seconds;
} outcome;

/// Whether a failure is a result of the method, and not a lack of memory.
static bat_status run_method(study_cloud *study, const double *boundary, const bat_surface_method *method, outcome *came,
                             bat_error *error)
{
    double begin = thread_seconds();
    bat_status status = parameterize(&study->boxed, boundary, method, study->parameters, error);
    if (status == BAT_OK)
        status = fit_patch(study, study->parameters, error);
    came->seconds = thread_seconds() - begin;
    came->succeeded = status == BAT_OK;
    came->mse = study->fit.error;
    return status == BAT_NO_CONVERGENCE ? BAT_OK : status;
}

static bat_status run_methods(const bat_cloud *cloud, const double *truth, const bat_surface_case *what,
                              const bat_surface_method *methods, size_t count, outcome *outcomes, bat_error *error)
{
    study_cloud study;
    bat_status status = study_cloud_make(cloud, what->degree, &study, error);
    if (status != BAT_OK)
        return status;
    status = fit_patch(&study, truth, error);
    double left = study.fit.error;
    for (size_t m = 0; m < count && status == BAT_OK; m++)
    {
        outcomes[m].floor = left;
        status = run_method(&study, truth, &methods[m], &outcomes[m], error);
    }
    study_cloud_free(&study);
    return status;
}

// Many

/// The random stream of a cloud, from its number and the seed, so that cases that differ only in noise use the same
/// surfaces.
static bat_random stream_of(uint64_t seed, size_t number)
{
    static const char purpose[] = "surface study";
    uint64_t words[2] = {seed, number};
    return bat_random_seed(hash_bytes(hash_bytes(HASH_BEGIN, purpose, sizeof purpose), words, sizeof words));
}

static bat_status study_number(const bat_surface_case *what, size_t number, uint64_t seed, const bat_surface_method *methods,
                               size_t count, outcome *outcomes, bat_error *error)
{
    bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
    options.degree = what->degree;
    options.interior = what->points;
    options.noise = what->noise;
    bat_random random = stream_of(seed, number);
    bat_cloud cloud;
    double *truth;
    bat_status status = bat_cloud_bezier(&options, &random, &cloud, &truth, error);
    if (status != BAT_OK)
        return status;
    status = run_methods(&cloud, truth, what, methods, count, outcomes, error);
    bat_cloud_free(&cloud);
    free(truth);
    return status;
}

static void compute_means(const outcome *outcomes, size_t clouds, size_t count, bat_surface_score *scores)
{
    for (size_t m = 0; m < count; m++)
    {
        bat_surface_score score = {0};
        for (size_t i = 0; i < clouds; i++)
        {
            const outcome *came = &outcomes[i * count + m];
            if (!came->succeeded)
                continue;
            score.succeeded++;
            score.mse += came->mse;
            score.excess += came->mse - came->floor;
            score.seconds += came->seconds;
        }
        double successes = (double)score.succeeded;
        scores[m] =
            (bat_surface_score){score.succeeded, score.mse / successes, score.excess / successes, score.seconds / successes};
    }
}

static bat_status run_clouds(const bat_surface_case *what, const bat_surface_method *methods, size_t count,
                             const bat_surface_study_options *options, outcome *outcomes, bat_error *error)
{
    shared_work work = shared_work_make(options->clouds, options->progress);
    int threads = threads_for(options->threads, options->clouds);
    blas_single_begin();
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (size_t i = 0; i < options->clouds; i++)
    {
        bat_error found;
        if (!shared_work_wants(&work, i))
            continue;
        bat_status status = study_number(what, i, options->seed, methods, count, outcomes + i * count, &found);
        shared_work_finish(&work, i, status, &found);
    }
    blas_single_end();
    return shared_work_end(&work, error);
}

/// The methods, with the built-in model where none is named.
typedef struct ready_methods
{
    bat_surface_method *methods;
    bat_surface_model *builtin; ///< null if not needed
} ready_methods;

static void ready_free(ready_methods *ready)
{
    free(ready->methods);
    bat_surface_model_free(ready->builtin);
}

static bat_status ready_make(const bat_surface_method *methods, size_t count, ready_methods *ready, bat_error *error)
{
    *ready = (ready_methods){.methods = memory_array(count, sizeof *methods)};
    if (ready->methods == NULL)
        return error_memory(error, count * sizeof *methods);
    bat_status status = check_methods(methods, count, error);
    for (size_t m = 0; m < count && status == BAT_OK; m++)
    {
        ready->methods[m] = methods[m];
        if (methods[m].parameters != BAT_SURFACE_PARAMETERS_LEARNED || methods[m].model != NULL)
            continue;
        if (ready->builtin == NULL)
            status = bat_surface_model_read(NULL, &ready->builtin, error);
        ready->methods[m].model = ready->builtin;
    }
    if (status != BAT_OK)
        ready_free(ready);
    return status;
}

bat_status bat_surface_study_clouds(const bat_surface_case *what, const bat_surface_method *methods, size_t count,
                                    const bat_surface_study_options *options, bat_surface_score *scores, bat_error *error)
{
    ready_methods ready;
    bat_status status = ready_make(methods, count, &ready, error);
    if (status != BAT_OK)
        return status;
    outcome *outcomes = options->clouds > 0 ? calloc(options->clouds, count * sizeof *outcomes) : NULL;
    if (options->clouds == 0)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a study needs clouds");
    else if (outcomes == NULL)
        status = error_memory(error, options->clouds * count * sizeof *outcomes);
    if (status == BAT_OK)
        status = run_clouds(what, ready.methods, count, options, outcomes, error);
    if (status == BAT_OK)
        compute_means(outcomes, options->clouds, count, scores);
    free(outcomes);
    ready_free(&ready);
    return status;
}

// Scans

static bat_status run_scan(const bat_cloud *cloud, int degree, const bat_surface_method *methods, size_t count,
                           bat_surface_score *scores, bat_error *error)
{
    study_cloud study;
    double *boundary = memory_array(cloud->boundary_count, 2 * sizeof *boundary);
    if (boundary == NULL)
        return error_memory(error, cloud->boundary_count * 2 * sizeof *boundary);
    bat_status status = bat_cloud_boundary_parameters(cloud, BAT_CLOUD_SIDES_CHORD_LENGTH, boundary, error);
    if (status == BAT_OK)
        status = study_cloud_make(cloud, degree, &study, error);
    if (status != BAT_OK)
    {
        free(boundary);
        return status;
    }
    blas_single_begin();
    for (size_t m = 0; m < count && status == BAT_OK; m++)
    {
        outcome came = {0};
        status = run_method(&study, boundary, &methods[m], &came, error);
        scores[m] = (bat_surface_score){came.succeeded, came.succeeded ? came.mse : NAN, NAN, came.seconds};
    }
    blas_single_end();
    study_cloud_free(&study);
    free(boundary);
    return status;
}

bat_status bat_surface_study_scan(const bat_cloud *cloud, int degree, const bat_surface_method *methods, size_t count,
                                  bat_surface_score *scores, bat_error *error)
{
    ready_methods ready;
    bat_status status = bat_cloud_check(cloud, error);
    if (status == BAT_OK)
        status = ready_make(methods, count, &ready, error);
    if (status != BAT_OK)
        return status;
    status = run_scan(cloud, degree, ready.methods, count, scores, error);
    ready_free(&ready);
    return status;
}

enum
{
    TITLE_SIZE = 160
};

void bat_surface_trial_free(bat_surface_trial *trial)
{
    bat_surface_result_free(&trial->result);
    *trial = (bat_surface_trial){0};
}

bat_status bat_surface_study_fit(const bat_cloud *cloud, const bat_surface_method *method,
                                 const bat_surface_fit_options *fit, bat_surface_trial *trial, bat_error *error)
{
    bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
    options.fit = *fit;
    options.parameters = method->parameters;
    options.published = method->published;
    options.model = method->model;
    options.repair = method->unfolded;
    bat_surface_trial made = {0};
    bat_cloud copy;
    bat_status status = bat_cloud_copy(cloud, &copy, error);
    if (status != BAT_OK)
        return status;
    status = bat_surface_reconstruct(&copy, &options, &made.result, error);
    if (status == BAT_NO_CONVERGENCE && options.published)
    {
        options.published = false;
        made.own = true;
        status = bat_surface_reconstruct(&copy, &options, &made.result, error);
    }
    bat_cloud_free(&copy);
    if (status == BAT_OK)
        *trial = made;
    return status;
}

bat_status bat_surface_study_draw(const char *path, const bat_cloud *cloud, const bat_surface_method *methods,
                                  const bat_surface_trial *trials, size_t count, bat_error *error)
{
    bat_surface_picture_row *rows = memory_array(count, sizeof *rows);
    char(*titles)[TITLE_SIZE] = memory_array(count, sizeof *titles);
    if (rows == NULL || titles == NULL)
    {
        free(rows);
        free(titles);
        return error_memory(error, count * sizeof *titles);
    }
    for (size_t i = 0; i < count; i++)
    {
        const bat_surface_result *result = &trials[i].result;
        (void)snprintf(titles[i], TITLE_SIZE, "%s parameters", methods[i].name);
        rows[i] = (bat_surface_picture_row){.title = titles[i],
                                            .cloud = cloud,
                                            .surface = &result->surface,
                                            .distances = result->report.distances,
                                            .parameters = result->parameters};
    }
    bat_status status = bat_surface_picture_write(path, rows, count, NULL, error);
    free(rows);
    free(titles);
    return status;
}
