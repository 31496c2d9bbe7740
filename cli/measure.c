#include "measure.h"

#include "curve.h"
#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_SAMPLES = 1000000000
};

static const option_spec OPTIONS[] = {
    {"from", "FORMAT", INPUT, 0, "the format of the files, see `batten list formats`; default: by their endings or contents",
     NO_FIELD},
    {"mesh", NULL, INPUT, COMMON, "take the files as meshes; default: by their endings or contents", NO_FIELD},
    {"triangulate", NULL, INPUT, 0, "cut faces of meshes of more than three corners into triangles",
     FLAG(measure_job, read_mesh.triangulate)},
    {"geodesic", NULL, METHOD, COMMON, "geodesic distances; default: straight ones between coordinates, as published",
     FLAG(measure_job, measure.geodesic)},
    {"to-segments", NULL, METHOD, COMMON, "distances to the other curve's edges instead of its points",
     FLAG(measure_job, measure.to_segments)},
    {"at-vertices", NULL, METHOD, COMMON, "distances of meshes from their vertices alone; default: from the whole surface",
     FLAG(measure_job, compare.vertices)},
    {"samples", "N", METHOD, 0, "points on the surface of each mesh; default: 200000",
     WHOLE(measure_job, compare.samples, 1, MAX_SAMPLES)},
    {"accuracy", "SHARE", METHOD, 0, "of the Hausdorff distance of meshes; 0: that of the samples; default: 1e-4",
     NUMBER(measure_job, compare.tolerance)},
    {"picture", "FILE", PICTURE, COMMON | IS_DRAWN, "draw two meshes in the colours of their distances (.png, .svg or .pdf)",
     NO_FIELD},
    END_OF_OPTIONS,
};

/// What is measured of a set of curves, one result each.
typedef enum measured
{
    FAIRNESS_OF_A,
    FAIRNESS_OF_B,
    DISTANCE,
    MEASURED
} measured;

/// The results of all curves.
typedef struct results
{
    size_t count;
    bat_curve_fairness_values *fairness[2]; ///< of A and B
    bat_curve_distance *distances;
    bool *simple; ///< of A; null in spaces where curves do not cross
} results;

/// Print the mean and the median of one measure of all curves, or put them into `object` where it is not null.
static bat_status report_measure(const results *all, measured in, const bat_measure *measure, double *values, json_t *object,
                                 bat_error *error)
{
    static const char *const OF[MEASURED] = {" of A", " of B", ""}, *const KEY_OF[MEASURED] = {"", "_b", ""};
    const char *bases[MEASURED] = {(const char *)all->fairness[0], (const char *)all->fairness[1],
                                   (const char *)all->distances};
    size_t size = in == DISTANCE ? sizeof *all->distances : sizeof *all->fairness[0];
    for (size_t i = 0; i < all->count; i++)
        memcpy(&values[i], bases[in] + i * size + measure->offset, sizeof *values);
    bat_curve_summary summary;
    bat_status status = bat_curve_summarize(values, all->count, &summary, error);
    char name[64];
    if (status == BAT_OK && object != NULL)
    {
        (void)snprintf(name, sizeof name, "%s%s", measure->name, KEY_OF[in]);
        json_t *value =
            json_pack("{s:o, s:o}", "mean", report_number(summary.mean), "median", report_number(summary.median));
        return json_object_set_new(object, name, value) == 0 ? BAT_OK : BAT_NO_MEMORY;
    }
    if (status != BAT_OK)
        return status;
    (void)snprintf(name, sizeof name, "%s%s", measure->title, OF[in]);
    (void)printf("%-36s %14.8g", name, summary.mean);
    if (summary.count > 1)
        (void)printf(" %14.8g", summary.median);
    (void)printf("\n");
    return BAT_OK;
}

/// Report what was measured: distances first, then the fairness of each side.
static bat_status summarize(const results *all, bool compared, json_t *object, bat_error *error)
{
    static const measured ORDER[MEASURED] = {DISTANCE, FAIRNESS_OF_A, FAIRNESS_OF_B};
    double *values = calloc(all->count, sizeof *values);
    bat_status status = values != NULL ? BAT_OK : BAT_NO_MEMORY;
    bat_measure measure;
    for (size_t k = 0; k < MEASURED; k++)
        for (size_t i = 0; (compared || ORDER[k] == FAIRNESS_OF_A) && status == BAT_OK &&
                           bat_curve_measures(ORDER[k] == DISTANCE ? 2 : 1, i, &measure);
             i++)
            if (measure.form == BAT_MEASURE_NUMBER)
                status = report_measure(all, ORDER[k], &measure, values, object, error);
    free(values);
    return status;
}

/// Report how many curves of A are simple.
static bat_status report_simple(const results *all, json_t *object)
{
    size_t simple = 0;
    if (all->simple == NULL)
        return BAT_OK;
    for (size_t i = 0; i < all->count; i++)
        simple += all->simple[i];
    if (object != NULL)
        return json_object_set_new(object, "simple", json_integer((json_int_t)simple)) == 0 ? BAT_OK : BAT_NO_MEMORY;
    if (all->count == 1)
        (void)printf("%-36s %14s\n", "A is simple", simple == 1 ? "yes" : "no");
    else
        (void)printf("%-36s %14zu of %zu\n", "simple curves of A", simple, all->count);
    return BAT_OK;
}

static int report_results(const char *path, const results *all, bool compared, bool as_json)
{
    json_t *object = as_json ? json_pack("{s:I}", "curves", (json_int_t)all->count) : NULL;
    if (as_json && object == NULL)
        return report_json(NULL);
    if (!as_json && all->count > 1)
        (void)printf("%-36s %14s %14s\n", "", "mean", "median");
    bat_error error = {.text = "out of memory"};
    bat_status status = summarize(all, compared, object, &error);
    if (status == BAT_OK)
        status = report_simple(all, object);
    if (status == BAT_OK && as_json)
        return report_json(object);
    json_decref(object);
    return status == BAT_OK ? EXIT_DONE : report_failure(path, &error);
}

/// Report which curve of a file is at fault.
static int report_curve(const char *path, const bat_curve_set *set, size_t curve, bat_error *error)
{
    bat_error named = *error;
    if (error->index != BAT_NO_INDEX && curve < set->count)
        named.line = bat_curve_set_line(set, curve, error->index);
    if (set->count > 1 && curve < set->count)
        (void)snprintf(named.text, sizeof named.text, "curve %zu: %.200s", curve, error->text);
    return report_failure(path, &named);
}

static int measure_fairness(const char *path, const bat_curve_set *set, const bat_curve_measure_options *options,
                            bat_curve_fairness_values *fairness)
{
    bat_error error;
    size_t failed = BAT_NO_INDEX;
    bat_curve_measure_options how = *options;
    how.progress = report_progress("measuring fairness");
    bat_status status = bat_curves_fairness(set->curves, set->count, &how, fairness, &failed, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : report_curve(path, set, failed, &error);
}

/// Whether each curve is simple. Does nothing in spaces where curves do not cross.
static int measure_simple(const measure_job *job, const bat_curve_set *set, bool **simple)
{
    bat_error error;
    size_t failed = BAT_NO_INDEX;
    bat_curve_measure_options how = job->measure;
    bool *answers = calloc(set->count > 0 ? set->count : 1, sizeof *answers);
    if (answers == NULL)
        return report_failure(job->paths[0], &(bat_error){.text = "out of memory"});
    how.progress = report_progress("looking for crossings");
    bat_status status = bat_curves_are_simple(set->curves, set->count, &how, answers, &failed, &error);
    report_progress_end();
    if (status == BAT_OK)
        *simple = answers;
    else
        free(answers);
    return status == BAT_OK || status == BAT_UNSUPPORTED ? EXIT_DONE : report_curve(job->paths[0], set, failed, &error);
}

static int measure_distances(const char *const paths[2], const bat_curve_set *a, const bat_curve_set *b,
                             const bat_curve_measure_options *options, bat_curve_distance *distances)
{
    bat_error error;
    size_t failed = BAT_NO_INDEX;
    bat_curve_measure_options how = *options;
    how.progress = report_progress("measuring distances");
    bat_status status = bat_curves_compare(a->curves, b->curves, a->count, &how, distances, &failed, &error);
    report_progress_end();
    if (status == BAT_OK)
        return EXIT_DONE;
    const char *path = measure_file_at_fault(paths, &error);
    return report_curve(path, path == paths[0] ? a : b, failed, &error);
}

static int measure_sets(measure_job *job)
{
    const bat_curve_set *a = &job->sets[0], *b = &job->sets[1];
    bool compared = job->paths[1] != NULL;
    if (compared && a->count != b->count)
    {
        bat_error error = {.line = 0};
        (void)snprintf(error.text, sizeof error.text, "%zu curves cannot be compared with the %zu of %s", b->count, a->count,
                       job->paths[0]);
        return report_failure(job->paths[1], &error);
    }
    results all = {
        .count = a->count,
        .fairness = {calloc(a->count, sizeof *all.fairness[0]), calloc(a->count, sizeof *all.fairness[1])},
        .distances = calloc(a->count, sizeof *all.distances),
    };
    int code = EXIT_DONE;
    if (all.fairness[0] == NULL || all.fairness[1] == NULL || all.distances == NULL)
        code = report_failure(job->paths[0], &(bat_error){.text = "out of memory"});
    if (code == EXIT_DONE)
        code = measure_fairness(job->paths[0], a, &job->measure, all.fairness[0]);
    if (code == EXIT_DONE)
        code = measure_simple(job, a, &all.simple);
    if (code == EXIT_DONE && compared)
        code = measure_distances(job->paths, a, b, &job->measure, all.distances);
    if (code == EXIT_DONE && compared)
        code = measure_fairness(job->paths[1], b, &job->measure, all.fairness[1]);
    if (code == EXIT_DONE)
        code = report_results(job->paths[0], &all, compared, job->call.json);
    free(all.fairness[0]);
    free(all.fairness[1]);
    free(all.distances);
    free(all.simple);
    return code;
}

static void begin(void *to)
{
    measure_job *job = to;
    job->read = bat_curve_read_defaults();
    job->measure = bat_curve_measure_defaults();
    job->read_mesh = bat_mesh_read_defaults();
    job->compare = bat_mesh_compare_defaults();
}

static bool check(void *of)
{
    static const char *const of_meshes[] = {"at-vertices", "samples", "accuracy", "picture", "triangulate", NULL};
    measure_job *job = of;
    const arguments *given = job->call.given;
    for (size_t i = 0; i < given->positional_count; i++)
        job->paths[i] = given->positional[i];
    job->of_meshes = measure_means_meshes(given, &job->failure);
    if (job->of_meshes)
        return measure_check_meshes(job);
    job->read.threads = job->measure.threads = job->call.threads;
    if (!argument_choice(given, "from", &bat_curve_format_family, &job->read.format))
        return false;
    const char *fault = NULL;
    if (argument_flag(given, "closed") && argument_flag(given, "open"))
        fault = "--closed and --open exclude each other";
    else if (job->measure.geodesic && job->measure.to_segments)
        fault = "--geodesic and --to-segments exclude each other";
    else if (argument_first(given, of_meshes) != NULL)
        fault = "--at-vertices, --samples, --accuracy, --picture and --triangulate are for meshes";
    else if (job->paths[1] == NULL && (job->measure.geodesic || job->measure.to_segments))
        fault = "--geodesic and --to-segments need a second file to measure the distance from";
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    return fault == NULL;
}

static int make(void *of)
{
    measure_job *job = of;
    bat_error error;
    if (job->failure.status != BAT_OK)
        return report_failure(NULL, &job->failure);
    if (job->of_meshes)
        return measure_meshes(job);
    for (size_t i = 0; i < 2 && job->paths[i] != NULL; i++)
        if (bat_curve_read(job->paths[i], &job->read, &job->sets[i], &error) != BAT_OK)
            return report_bad_input(job->call.given, job->paths[i], &error);
    return measure_sets(job);
}

static int report(void *of)
{
    const measure_job *job = of;
    return job->of_meshes ? measure_report_meshes(job) : EXIT_DONE;
}

static void end(void *of)
{
    measure_job *job = of;
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_set_free(&job->sets[i]);
        bat_mesh_free(&job->meshes[i]);
    }
}

const verb VERB_MEASURE = {
    .name = "measure",
    .arguments = "A [B] [options]",
    .summary = "measure curves or meshes, and the distances between two",
    .about =
        "Measure the fairness of the curves of A and B (bending energy, largest exterior angle), whether those of A are "
        "simple, and their distances: nearest-neighbour and Hausdorff, curve i of A with curve i of B. Files of several "
        "curves give the mean and the median over the curves. Of one mesh: size, topology, area, volume, quality; of "
        "two: the Hausdorff and mean distances of their surfaces, by Metro's definitions.",
    .example = "batten measure coarse.ply fine.ply --picture distances.png",
    .options = (const option_table[]){{OPTIONS, 0},
                                      {CURVE_READ_OPTIONS, offsetof(measure_job, read)},
                                      {THREADS_OPTION, 0},
                                      {JSON_OPTION, 0},
                                      {NULL, 0}},
    .min_positional = 1,
    .max_positional = 2,
    .reads_files = true,
    .job_size = sizeof(measure_job),
    .begin = begin,
    .check = check,
    .make = make,
    .report = report,
    .end = end,
};
