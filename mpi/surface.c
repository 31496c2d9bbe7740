#include "verbs.h"

#include "backend.h"
#include "chart.h"
#include "counts.h"
#include "group.h"
#include "judge.h"
#include "points.h"
#include "ranks.h"
#include "report.h"
#include "rows.h"
#include "verb.h"

#include "batten/batten.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum
{
    MAX_BOUNDARY = 1000000000,
    MIN_SAMPLE = 22000,      ///< more than BAT_SURFACE_ALL_POINTS, whatever points are drawn
    SAMPLE = 200000,         ///< points by which a chart is found
    POINTS_PER_FUNCTION = 30 ///< whose memory is that of a function in the matrix and its factors
};

static const char *const SOLVERS[] = {"cholesky", "direct", "iterative", NULL};

/// The command line.
typedef struct fit_job
{
    verb_call call;
    const char *input, *output, *parameters;
    char *checkpoint, *second_checkpoint; ///< of the second attempt at points without parameters
    bat_cloud_format from;
    size_t boundary, sample;
    bool finds; ///< the parameters
    bat_surface_reconstruct_options options;
    bat_surface_write_options write;
    int solver;
    bool strict, force;
} fit_job;

static const option_spec OPTIONS[] = {
    {"output", "OUT", RESULT, COMMON, "write the surface to OUT", TEXT(fit_job, output)},
    {"parameterization", "auto|FILE", METHOD, COMMON,
     "u v of each point of IN: found as by `batten surface` (auto), or in FILE; default: those that IN has after x y z "
     "(PLY: "
     "u and v), else auto",
     TEXT(fit_job, parameters)},
    {"sample", "N", METHOD, 0,
     "find boundary and parameters by about N points, on rank 0, from 22000; default 200000; with all points, the surface "
     "is "
     "that of one machine",
     WHOLE(fit_job, sample, MIN_SAMPLE, MAX_BOUNDARY)},
    {"boundary", "N", INPUT, 0,
     "the first N points are the boundary; given parameters of these stay; default: told in IN, else none is given",
     WHOLE(fit_job, boundary, 4, MAX_BOUNDARY)},
    {"solver", "NAME", METHOD, COMMON,
     "cholesky (default: on rank 0, the same bytes for any number of ranks), direct (MUMPS) or iterative (conjugate "
     "gradients "
     "with GAMG), both by PETSc",
     NO_FIELD},
    {"checkpoint", "FILE", RESULT, COMMON,
     "keep the state after each round in FILE, and go on from it; default: OUT.checkpoint", NO_FIELD},
    {"force", NULL, RESULT, 0, "write also a surface that the points prove wrong", FLAG(fit_job, force)},
    {"strict", NULL, INPUT, 0, "refuse points that repeat another instead of leaving them out", FLAG(fit_job, strict)},
    {"from", "FORMAT", INPUT, 0, "xyz or ply (binary, little-endian); default: by the file's ending",
     CHOICE(fit_job, from, bat_cloud_format_family)},
    {"threads", "N", CALL, 0, "of each rank; default 1; the result does not depend on it",
     WHOLE(fit_job, options.fit.threads, 1, MAX_THREADS)},
    END_OF_OPTIONS,
};

static const verb FIT = {
    .program = "mpirun -n RANKS batten-mpi",
    .name = "surface",
    .arguments = "IN -o OUT [--tolerance T|--functions N] [options]",
    .summary = "fit a spline surface to scattered points, to CAD files",
    .about =
        "Fit an adaptive spline surface to points, which are divided among the ranks (XYZ, binary PLY). The surface is that "
        "of `batten surface`.",
    .example = "mpirun -n 8 batten-mpi surface scan.ply -o scan.step --tolerance 0.05",
    .options = {{OPTIONS, 0},
                {SURFACE_FIT_OPTIONS, offsetof(fit_job, options.fit)},
                {SURFACE_WRITE_OPTIONS, offsetof(fit_job, write)},
                {REPORT_OPTIONS, 0}},
    .positional = {1, 1},
    .reads_files = true,
};

/// What is wrong with the command line; null for nothing.
static const char *find_fault(const fit_job *job)
{
    if (job->from != BAT_CLOUD_FORMAT_AUTO && job->from != BAT_CLOUD_FORMAT_XYZ && job->from != BAT_CLOUD_FORMAT_PLY)
        return "--from takes xyz or ply";
    if (job->output == NULL)
        return "-o OUT is missing";
    if (strcmp(job->output, "-") == 0)
        return "-o takes a file";
    return job->call.json && job->call.silent ? "--json and --quiet exclude each other" : NULL;
}

/// False after a message.
static bool read_job(const arguments *given, fit_job *job)
{
    *job = (fit_job){.input = given->positional[0], .options = bat_surface_reconstruct_defaults(), .sample = SAMPLE};
    job->options.fit.threads = 1;
    if (!arguments_store(given, job) || !argument_word(given, "solver", SOLVERS, FIT_SOLVER_CHOLESKY, &job->solver))
        return false;
    const char *fault = find_fault(job);
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    if (fault != NULL || !surface_check_fit(given, &job->options.fit) ||
        !argument_ending(given, &bat_surface_format_family, (int)job->write.format))
        return false;
    job->finds = job->parameters != NULL && strcmp(job->parameters, "auto") == 0;
    if (job->finds)
        job->parameters = NULL;
    return true;
}

static char *checkpoint_path(const arguments *given, const fit_job *job, const char *attempt)
{
    const char *path = argument(given, "checkpoint"), *ending = path != NULL ? "" : ".checkpoint";
    path = path != NULL ? path : job->output;
    size_t size = strlen(path) + strlen(ending) + strlen(attempt) + 1;
    char *joined = ranks_allocate(size, 1);
    (void)snprintf(joined, size, "%s%s%s", path, ending, attempt);
    return joined;
}

/// A number that options with another result do not have.
static uint64_t label_of(const fit_job *job)
{
    char text[400];
    const bat_surface_fit_options *fit = &job->options.fit;
    (void)snprintf(text, sizeof text, "%s %zu %d %d %.17g %.17g %zu %d %d %d %d %.17g %.17g %d %d %d %d", bat_version(),
                   job->finds ? job->sample : 0, fit->space.degree[0], fit->space.degree[1], fit->tolerance, fit->share,
                   fit->functions, fit->hold_out, fit->iterations, fit->neighbours, (int)fit->smoothing, fit->weight,
                   fit->noise, fit->corrections, fit->final_corrections, (int)fit->robust, job->solver);
    // FNV-1a.
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (const char *at = text; *at != '\0'; at++)
        hash = (hash ^ (uint64_t)(unsigned char)*at) * UINT64_C(0x100000001b3);
    return hash;
}

/// A fit with its report.
typedef struct fit_result
{
    fit_input input;
    bat_surface_result result;
    bat_cloud cloud; ///< for the report, without points
    size_t resumed;
    double seconds[3]; ///< of reading and distributing, of the fit, of the verdict
} fit_result;

/// Fit the points of all ranks.
/// @param border   taken; null for none
/// @param functions the budget
static bat_status fit_together(const fit_job *job, const char *checkpoint, bat_surface_border *border, size_t functions,
                               fit_result *made, bat_error *error)
{
    fit_input *input = &made->input;
    bat_surface_result *result = &made->result;
    fit_backend *backend = fit_backend_make((fit_solver_kind)job->solver, checkpoint, input->label ^ label_of(job));
    fit_backend_set_rows(backend, input->first, input->count, input->total);
    bat_surface_fit_data data = {.points = input->points,
                                 .parameters = input->parameters,
                                 .count = input->count,
                                 .dimension = 3,
                                 .boundary_count = input->boundary_count,
                                 .curves = border};
    bat_surface_fit_options options = job->options.fit;
    options.functions = functions;
    if (ranks_rank() == 0)
        options.progress = report_progress("fitting");
    bat_status status = bat_surface_fit_together(ranks_group(), fit_backend_interface(backend), &data, input->numbers,
                                                 &options, &result->surface, &result->report, error);
    report_progress_end();
    made->resumed = fit_backend_resumed(backend);
    fit_backend_free(backend);
    return status;
}

/// Fill what the report of one machine has besides.
static void describe(const fit_job *job, fit_result *made)
{
    bat_surface_result *result = &made->result;
    const bat_surface_fit_round *last = &result->report.rounds[result->report.count - 1];
    result->chosen = BAT_SURFACE_PARAMETERS_GIVEN;
    result->candidates[0] = (bat_surface_candidate){.parameters = BAT_SURFACE_PARAMETERS_GIVEN,
                                                    .functions = last->functions,
                                                    .mean_squared = last->mean_squared,
                                                    .reached = result->report.reached,
                                                    .verdict = result->verdict,
                                                    .fit_seconds = last->seconds};
    result->candidate_count = 1;
    result->trial_points = made->input.total;
    result->below_noise = bat_surface_below_noise(&job->options.fit, &result->report, made->input.total, result->noise);
    result->seconds[1] = made->seconds[2];
    result->seconds[2] = made->seconds[1];
}

/// Fit points with parameters. False after a message.
static bool make_fit(const fit_job *job, fit_result *made)
{
    bat_error error = {0};
    double begin = MPI_Wtime();
    fit_input *input = &made->input;
    bat_surface_result *result = &made->result;
    if (!fit_input_read(job->input, job->parameters, job->from, job->boundary, job->strict,
                        POINTS_PER_FUNCTION * job->options.fit.functions, input))
        return false;
    made->seconds[0] = MPI_Wtime() - begin;
    made->cloud =
        (bat_cloud){.count = input->total, .duplicates = input->duplicates, .boundary_count = input->boundary_count};
    bat_status status = fit_together(job, job->checkpoint, NULL, job->options.fit.functions, made, &error);
    if (!ranks_agree(job->input, status, &error))
        return false;
    made->seconds[1] = MPI_Wtime() - begin - made->seconds[0];
    judge_surface(input, result->report.distances, &result->surface, &job->options.fit, &result->verdict, &result->noise);
    made->seconds[2] = MPI_Wtime() - begin - made->seconds[0] - made->seconds[1];
    if (ranks_rank() == 0)
        describe(job, made);
    return true;
}

// Points without parameters

/// The surface of a few points, by rank 0.
static bat_status reconstruct_alone(const fit_job *job, shared_chart *shared, fit_result *made, bat_error *error)
{
    bat_surface_reconstruct_options options = job->options;
    options.force = true;
    options.fit.progress = report_progress("fitting");
    bat_status status = ranks_rank() == 0 ? bat_surface_reconstruct(&shared->cloud, &options, &made->result, error) : BAT_OK;
    report_progress_end();
    return status;
}

/// One attempt at the surface of many points. Every rank gets the status.
static bat_status reconstruct_together(const fit_job *job, file_part *part, const char *checkpoint, bool again,
                                       shared_chart *shared, fit_result *made, bat_error *error)
{
    bat_surface_reconstruct_options options = job->options;
    bat_surface_border *border = NULL;
    size_t functions = 0;
    if (ranks_rank() == 0)
        options.fit.progress = report_progress("boundary and parameters");
    bat_status status = shared_chart_find(part, &options, again, shared, error);
    report_progress_end();
    if (status == BAT_OK)
        status = shared_chart_distribute(shared, part, &job->options.fit, POINTS_PER_FUNCTION * job->options.fit.functions,
                                         &made->input, &border, &functions, error);
    made->input.duplicates = part->duplicates;
    if (status == BAT_OK)
        status = fit_together(job, checkpoint, border, functions, made, error);
    bat_surface_border_free(border);
    if (status == BAT_OK)
        status = shared_chart_finish(shared, &made->input, &made->result, error);
    return status;
}

static void fit_result_free(fit_result *made)
{
    bat_surface_result_free(&made->result);
    fit_input_free(&made->input);
    *made = (fit_result){0};
}

/// Read the points and fit their surface.
/// @param again  a second attempt, with a boundary that a smaller disc finds
/// @param unknown receives whether the boundary was unknown
/// @return false after a message
static bool find_surface(const fit_job *job, const char *checkpoint, bool again, fit_result *made, bool *unknown,
                         bat_status *status, bat_error *error)
{
    file_part part;
    shared_chart shared;
    double begin = MPI_Wtime();
    if (!file_part_read(job->input, job->from, job->boundary, job->strict, &part))
        return false;
    file_part_sort(&part);
    unsigned long long mine = part.count, total = 0;
    (void)MPI_Allreduce(&mine, &total, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
    shared_chart_sample(&part, (size_t)total, job->sample, &shared);
    made->seconds[0] = MPI_Wtime() - begin;
    *unknown = shared.found && total > BAT_SURFACE_ALL_POINTS;
    *status = total > BAT_SURFACE_ALL_POINTS ? reconstruct_together(job, &part, checkpoint, again, &shared, made, error)
                                             : reconstruct_alone(job, &shared, made, error);
    made->result.boundary_found = shared.found;
    made->result.below_noise =
        *status == BAT_OK && ranks_rank() == 0 &&
        bat_surface_below_noise(&job->options.fit, &made->result.report, (size_t)total, made->result.noise);
    made->seconds[1] = MPI_Wtime() - begin - made->seconds[0];
    made->result.seconds[0] += shared.seconds;
    if (total > BAT_SURFACE_ALL_POINTS)
        made->result.seconds[2] = made->seconds[1] - made->result.seconds[0] - made->result.seconds[1];
    *status = ranks_agree_on(*status, error);
    if (*status == BAT_OK)
        shared_chart_describe(&shared, &part, &made->result, &made->cloud);
    made->cloud.count = (size_t)total;
    made->cloud.duplicates = part.duplicates;
    file_part_free(&part);
    shared_chart_free(&shared);
    return true;
}

/// Find parameters and fit. False after a message.
static bool make_surface(const fit_job *job, fit_result *made)
{
    bat_status status;
    bat_error error = {0};
    bool unknown;
    if (!find_surface(job, job->checkpoint, false, made, &unknown, &status, &error) ||
        !ranks_agree(job->input, status, &error))
        return false;
    int wrong = made->result.verdict.fault != BAT_SURFACE_FAULT_NONE && unknown;
    (void)MPI_Bcast(&wrong, 1, MPI_INT, 0, MPI_COMM_WORLD);
    if (wrong == 0)
        return true;
    fit_result again = {0};
    if (!find_surface(job, job->second_checkpoint, true, &again, &unknown, &status, &error))
        return false;
    int better = status == BAT_OK && again.result.verdict.fault == BAT_SURFACE_FAULT_NONE;
    (void)MPI_Bcast(&better, 1, MPI_INT, 0, MPI_COMM_WORLD);
    if (better == 0)
    {
        fit_result_free(&again);
        return true;
    }
    fit_result_free(made);
    *made = again;
    return true;
}

static int report(const fit_job *job, const fit_result *made, const counts_summary *summary)
{
    bat_cloud cloud = made->cloud;
    // Given parameters have no corners to be printed.
    if (!job->finds && !job->call.json)
        cloud.boundary_count = 0;
    static const bat_mesh_notes NO_NOTES;
    bat_surface_primitive shape;
    if (cloud.points == NULL || bat_surface_find_primitive(&cloud, &made->result, &shape, NULL) != BAT_OK)
        shape.kind = BAT_SURFACE_PRIMITIVE_NONE;
    const surface_findings findings = {job->input, &cloud, &job->options, &made->result, &NO_NOTES, &shape, NULL};
    if (job->call.json)
    {
        json_t *object = surface_report(&findings, true);
        (void)json_object_set_new(object, "exchange", counts_json(summary));
        (void)json_object_set_new(object, "reading_seconds", json_real(made->seconds[0]));
        (void)json_object_set_new(object, "resumed", json_integer((json_int_t)made->resumed));
        return report_json(object);
    }
    if (job->call.silent)
        return EXIT_DONE;
    (void)surface_report(&findings, false);
    if (made->resumed > 0)
        (void)printf("went on after %zu rounds of the checkpoint\n", made->resumed);
    (void)printf("seconds to read and distribute the points: %.2f\n", made->seconds[0]);
    counts_print(summary, stdout);
    (void)printf("%.3g bytes a point and round\n",
                 summary->sum.bytes / ((double)made->cloud.count * (double)made->result.report.count));
    return EXIT_DONE;
}

/// Write the surface and report, on rank 0.
static int finish(const fit_job *job, fit_result *made, const counts_summary *summary)
{
    bat_error error = {0};
    if (!job->force && bat_surface_verdict_check(&made->result.verdict, &error) != BAT_OK)
    {
        size_t length = strlen(error.text);
        (void)snprintf(error.text + length, sizeof error.text - length, "; --force writes it nevertheless");
        return report_failure(job->input, &error);
    }
    if (bat_surface_write(job->output, &made->result.surface, &job->write, &error) != BAT_OK)
        return report_failure(job->output, &error);
    int code = report(job, made, summary);
    if (made->result.below_noise)
    {
        (void)fprintf(stderr,
                      "batten: %s: the tolerance is below the noise (about %.3g); the best surface so far is written\n",
                      job->input, made->result.noise);
        code = EXIT_BAD_INPUT;
    }
    return code;
}

/// Let OpenBLAS map its memory on rank 0, by a fit of a few points. Where it cannot, it tries for ever: that is found out
/// first.
static void take_memory_of_products(void)
{
    enum
    {
        PRODUCTS = 136, ///< MiB
        SIDE = 12
    };
    bat_error error = {.status = BAT_NO_MEMORY, .index = BAT_NO_INDEX};
    if (ranks_rank() != 0)
        return;
    void *volatile memory = malloc((size_t)PRODUCTS << 20);
    (void)snprintf(error.text, sizeof error.text, "rank 0 is out of memory (%d MiB for OpenBLAS); ulimit -d tells its limit",
                   PRODUCTS);
    ranks_need(NULL, memory != NULL ? BAT_OK : BAT_NO_MEMORY, &error);
    free(memory);
    double points[3 * SIDE * SIDE], parameters[2 * SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++)
    {
        double u = i % SIDE / (SIDE - 1.0), v = i / SIDE / (SIDE - 1.0);
        const double point[3] = {u, v, u * u * v};
        memcpy(points + 3 * (size_t)i, point, sizeof point);
        parameters[2 * i] = u;
        parameters[2 * i + 1] = v;
    }
    bat_surface_fit_data data = {.points = points, .parameters = parameters, .count = SIDE * SIDE, .dimension = 3};
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.threads = 1;
    options.space.spans[0] = options.space.spans[1] = 4;
    bat_spline_surface surface;
    ranks_need(NULL, bat_surface_fit(&data, &options, &surface, NULL, &error), &error);
    bat_spline_surface_free(&surface);
}

int verb_surface(int argc, char **argv)
{
    arguments given;
    fit_job job;
    fit_result made = {0};
    int code;
    if (!ranks_read_arguments(&FIT, argc, argv, &given, &code))
        return code;
    int silence = ranks_silence();
    bool good = read_job(&given, &job);
    ranks_speak(silence);
    if (!good)
        return EXIT_BAD_USAGE;
    job.checkpoint = checkpoint_path(&given, &job, "");
    job.second_checkpoint = checkpoint_path(&given, &job, ".again");
    if (job.parameters == NULL)
        job.finds = job.finds || !rows_have_parameters(job.input, job.from);
    if (!job.finds)
        job.options.parameters = BAT_SURFACE_PARAMETERS_GIVEN;
    code = EXIT_BAD_INPUT;
    take_memory_of_products();
    if (job.finds ? make_surface(&job, &made) : make_fit(&job, &made))
    {
        counts_summary summary = counts_collect();
        code = ranks_rank() == 0 ? finish(&job, &made, &summary) : EXIT_DONE;
        (void)MPI_Bcast(&code, 1, MPI_INT, 0, MPI_COMM_WORLD);
        if (code == EXIT_DONE && ranks_rank() == 0)
        {
            fit_backend_forget(job.checkpoint);
            fit_backend_forget(job.second_checkpoint);
        }
    }
    free(job.checkpoint);
    free(job.second_checkpoint);
    fit_result_free(&made);
    return code;
}
