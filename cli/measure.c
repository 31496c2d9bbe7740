#include "curve.h"

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int MAX_SAMPLES = 1000000000;

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

/// The job of `batten measure`.
typedef struct measure_job
{
    verb_call call;
    const char *paths[2]; ///< the second null when there is only A
    bool of_meshes;
    bat_error failure; ///< of telling meshes from curves; its status is BAT_OK where there was none
    bat_curve_read_options read;
    bat_curve_measure_options measure;
    bat_curve_set sets[2];
    results results; ///< of them
    bat_mesh_read_options read_mesh;
    bat_mesh_compare_options compare;
    bat_mesh_notes notes; ///< of reading meshes
    bat_mesh meshes[2];
    bat_mesh_summary summary;   ///< of one mesh
    bat_mesh_distance distance; ///< of two
} measure_job;

static const option_spec OPTIONS[] = {
    {"from", "FORMAT", INPUT, 0, "the format of the files, see `batten list formats`; default: by their endings or contents",
     NO_FIELD},
    {"mesh", NULL, INPUT, COMMON, "take the files as meshes; default: by their endings or contents", NO_FIELD},
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
    {"strict", NULL, INPUT, 0,
     "refuse meshes with values that are not finite or faces with a vertex twice; default: note them",
     FLAG(measure_job, read_mesh.strict)},
    {"picture", "FILE", PICTURE, COMMON | IS_DRAWN, "draw two meshes in the colours of their distances (.png, .svg or .pdf)",
     NO_FIELD},
    END_OF_OPTIONS,
};

/// The file at fault in a comparison: the one that the error names, else the second.
static const char *file_at_fault(const char *const paths[2], const bat_error *error)
{
    return error->operand == 0 || paths[1] == NULL ? paths[0] : paths[1];
}

// Curves

/// Report the mean and the median of one measure of all curves.
static bat_status report_measure(const results *all, measured in, const bat_measure *measure, double *values,
                                 json_t **object, bat_error *error)
{
    static const char *const OF[MEASURED] = {" of A", " of B", ""}, *const KEY_OF[MEASURED] = {"", "_b", ""};
    const char *bases[MEASURED] = {(const char *)all->fairness[0], (const char *)all->fairness[1],
                                   (const char *)all->distances};
    size_t size = in == DISTANCE ? sizeof *all->distances : sizeof *all->fairness[0];
    for (size_t i = 0; i < all->count; i++)
        memcpy(&values[i], bases[in] + i * size + measure->offset, sizeof *values);
    bat_curve_summary summary;
    bat_status status = bat_curve_summarize(values, all->count, &summary, error);
    if (status != BAT_OK)
        return status;
    bool as_json = *object != NULL;
    char name[64];
    (void)snprintf(name, sizeof name, "%s%s", as_json ? measure->name : measure->title, (as_json ? KEY_OF : OF)[in]);
    json_t *value =
        report_part(as_json, "{name:-36} {mean:14.8g}[several? {median:14.8g}]\n", "-name:s mean:n median:n -several:b",
                    name, summary.mean, summary.median, (int)(summary.count > 1));
    *object = as_json ? report_add(*object, name, value) : NULL;
    return as_json && *object == NULL ? BAT_NO_MEMORY : BAT_OK;
}

/// Report what was measured: distances first, then the fairness of each side.
static bat_status summarize(const results *all, bool compared, json_t **object, bat_error *error)
{
    static const measured ORDER[MEASURED] = {DISTANCE, FAIRNESS_OF_A, FAIRNESS_OF_B};
    double *values = calloc(all->count, sizeof *values);
    bat_status status = values != NULL ? BAT_OK : BAT_NO_MEMORY;
    bat_measure measure;
    for (size_t k = 0; k < MEASURED; k++)
        for (size_t i = 0; (compared || ORDER[k] == FAIRNESS_OF_A) && status == BAT_OK &&
                           bat_curve_measures(ORDER[k] == DISTANCE ? 2 : 1, i, &measure);
             i++)
            if (measure.form == BAT_MEASURE_FORM_NUMBER)
                status = report_measure(all, ORDER[k], &measure, values, object, error);
    free(values);
    return status;
}

static int report_results(const char *path, const results *all, bool compared, bool as_json)
{
    json_t *object = as_json ? report_object("curves:z", all->count) : NULL;
    if (as_json && object == NULL)
        return report_json(NULL);
    if (!as_json && all->count > 1)
        (void)printf("                                               mean         median\n");
    bat_error error = {.text = "out of memory"};
    if (summarize(all, compared, &object, &error) != BAT_OK)
    {
        json_decref(object);
        return report_failure(path, &error);
    }
    size_t simple = 0;
    for (size_t i = 0; i < all->count && all->simple != NULL; i++)
        simple += all->simple[i];
    if (as_json)
        return report_json(all->simple != NULL ? report_add(object, "simple", json_integer((json_int_t)simple)) : object);
    if (all->simple != NULL && all->count == 1)
        (void)printf("A is simple                          %14s\n", simple == 1 ? "yes" : "no");
    else if (all->simple != NULL)
        (void)printf("simple curves of A                   %14zu of %zu\n", simple, all->count);
    return EXIT_DONE;
}

/// Report which curve of a file is at fault.
static int report_curve(const char *path, const bat_curve_set *set, const bat_error *error)
{
    bat_error named = *error;
    size_t curve = error->curve;
    if (error->index != BAT_NO_INDEX && curve < set->count)
        named.line = bat_curve_set_line(set, curve, error->index);
    if (set->count > 1 && curve < set->count)
        (void)snprintf(named.text, sizeof named.text, "curve %zu: %.200s", curve, error->text);
    return report_failure(path, &named);
}

/// Measure the distances of the curves, or the fairness of a side.
static int measure_curves(const measure_job *job, measured what, results *all)
{
    const bat_curve_set *a = &job->sets[0], *b = &job->sets[1], *set = what == FAIRNESS_OF_B ? b : a;
    bool compares = what == DISTANCE;
    bat_curve_measure_options how = job->measure;
    how.progress = report_progress(compares ? "measuring distances" : "measuring fairness");
    bat_status status = compares ? bat_curves_compare(a->curves, b->curves, a->count, &how, all->distances, report_error())
                                 : bat_curves_fairness(set->curves, set->count, &how, all->fairness[what], report_error());
    report_progress_end();
    if (status == BAT_OK)
        return EXIT_DONE;
    const char *path = compares ? file_at_fault(job->paths, report_error()) : job->paths[what];
    return report_curve(path, path == job->paths[0] ? a : b, report_error());
}

/// Whether each curve of A is simple. Does nothing in spaces where curves do not cross.
static int measure_simple(const measure_job *job, bool **simple)
{
    const bat_curve_set *set = &job->sets[0];
    bat_curve_measure_options how = job->measure;
    bool *answers = calloc(set->count > 0 ? set->count : 1, sizeof *answers);
    if (answers == NULL)
        return report_failure(job->paths[0], &(bat_error){.text = "out of memory"});
    how.progress = report_progress("looking for crossings");
    bat_status status = bat_curves_are_simple(set->curves, set->count, &how, answers, report_error());
    report_progress_end();
    if (status == BAT_OK)
        *simple = answers;
    else
        free(answers);
    return status == BAT_OK || status == BAT_UNSUPPORTED ? EXIT_DONE : report_curve(job->paths[0], set, report_error());
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
    results *all = &job->results;
    all->count = a->count;
    all->distances = calloc(a->count, sizeof *all->distances);
    for (size_t k = 0; k < 2; k++)
        all->fairness[k] = calloc(a->count, sizeof *all->fairness[k]);
    if (all->fairness[0] == NULL || all->fairness[1] == NULL || all->distances == NULL)
        return report_failure(job->paths[0], &(bat_error){.text = "out of memory"});
    int code = measure_curves(job, FAIRNESS_OF_A, all);
    if (code == EXIT_DONE)
        code = measure_simple(job, &all->simple);
    if (code == EXIT_DONE && compared)
        code = measure_curves(job, DISTANCE, all);
    if (code == EXIT_DONE && compared)
        code = measure_curves(job, FAIRNESS_OF_B, all);
    return code == EXIT_DONE ? report_results(job->paths[0], all, compared, job->call.json) : code;
}

// Meshes

/// Whether the files are meshes: by --mesh or --from, else by the first file whose ending or content is clear. An OBJ file
/// is a mesh when its first element is a face. Pipes are not read.
/// @param failure untouched unless a file cannot be recognized for want of memory
static bool means_meshes(const arguments *given, bat_error *failure)
{
    bat_mesh_format format;
    const bat_choice *row;
    const char *from = argument(given, "from");
    if (argument(given, "mesh") != NULL)
        return true;
    if (from != NULL && bat_choice_find(&bat_mesh_format_family, from, &row, NULL) == BAT_OK &&
        bat_choice_find(&bat_curve_format_family, from, &row, NULL) != BAT_OK)
        return true;
    for (size_t i = 0; i < given->positional_count; i++)
    {
        const char *path = given->positional[i];
        const bat_choice *mesh, *curves;
        (void)bat_choice_of_path(&bat_mesh_format_family, path, false, &mesh, NULL);
        (void)bat_choice_of_path(&bat_curve_format_family, path, false, &curves, NULL);
        if (mesh == NULL && curves != NULL)
            return false;
        if (bat_mesh_format_of_file(path, &format, failure) != BAT_OK)
            return false;
        if (format != BAT_MESH_FORMAT_AUTO)
            return true;
    }
    return false;
}

/// Report one measure. Returns its value as JSON, or null where it is printed.
static json_t *report_mesh_measure(const bat_measure *at, const char *base, double diagonal, bool as_json)
{
    const void *value = base + at->offset;
    const double *numbers = value;
    bool whole =
        at->form == BAT_MEASURE_FORM_COUNT || at->form == BAT_MEASURE_FORM_SIGNED || at->form == BAT_MEASURE_FORM_GENUS;
    bool flag = at->form == BAT_MEASURE_FORM_FLAG, point = at->form == BAT_MEASURE_FORM_POINT;
    int64_t count = whole ? *(const int64_t *)value : 0;
    bool none = at->form == BAT_MEASURE_FORM_GENUS ? count < 0 : at->form == BAT_MEASURE_FORM_NUMBER && isnan(*numbers);
    if (as_json)
        return whole   ? (none ? json_null() : json_integer((json_int_t)count))
               : flag  ? json_boolean(*(const bool *)value)
               : point ? report_numbers(numbers, 3)
                       : report_number(*numbers);
    (void)printf("%-38s ", at->title);
    if (none || flag)
        (void)printf("%14s\n", none ? "none" : *(const bool *)value ? "yes" : "no");
    else if (whole)
        (void)printf("%14lld\n", (long long)count);
    else if (point)
        (void)printf("%14.8g %14.8g %14.8g\n", numbers[0], numbers[1], numbers[2]);
    else if (at->form == BAT_MEASURE_FORM_LENGTH)
        (void)printf("%14.8g %14.8g\n", *numbers, *numbers / diagonal);
    else
        (void)printf("%14.8g\n", *numbers);
    return NULL;
}

/// Report the measures of one mesh or of two, with notes where there are some.
static int report_measures(const measure_job *job, size_t meshes, const void *base, double diagonal)
{
    bat_measure measure;
    bool as_json = job->call.json;
    json_t *object = as_json ? json_object() : NULL;
    print_file_notes(&job->call, &job->notes);
    if (meshes == 2 && !as_json)
        (void)printf("                                                      of B's diagonal\n");
    for (size_t i = 0; bat_mesh_measures(meshes, i, &measure); i++)
    {
        json_t *value = report_mesh_measure(&measure, base, diagonal, as_json);
        object = as_json ? report_add(object, measure.name, value) : NULL;
    }
    if (as_json && job->notes.count > 0)
        object = report_add(object, "notes", file_notes_json(&job->notes));
    return as_json ? report_json(object) : EXIT_DONE;
}

/// Drop the faces with a vertex twice, as a repair does, with its note. The other faults of the mesh stay, to be counted.
static bool drop_degenerate(bat_mesh *mesh, bat_mesh_notes *notes)
{
    char note[96];
    size_t kept = 0, corner = 3 * sizeof *mesh->faces;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *at = mesh->faces + 3 * f;
        if (at[0] == at[1] || at[1] == at[2] || at[2] == at[0])
            continue;
        memmove(mesh->faces + 3 * kept, at, corner);
        if (mesh->texture_faces != NULL)
            memmove(mesh->texture_faces + 3 * kept, mesh->texture_faces + 3 * f, corner);
        if (mesh->face_labels != NULL)
            mesh->face_labels[kept] = mesh->face_labels[f];
        kept++;
    }
    if (kept == mesh->face_count)
        return true;
    (void)snprintf(note, sizeof note, "repaired: %zu faces with a vertex twice were dropped", mesh->face_count - kept);
    mesh->face_count = kept;
    return add_file_note(notes, note);
}

/// Draw both meshes, coloured by how far their vertices are from the other.
static int draw_distances(measure_job *job)
{
    const bat_mesh *meshes = job->meshes;
    double diagonal = job->distance.diagonal;
    bat_error error = {.text = "out of memory"};
    bat_mesh_picture_panel panels[2];
    double *shares[2] = {NULL, NULL};
    bat_status status = BAT_OK;
    for (size_t i = 0; i < 2 && status == BAT_OK; i++)
    {
        const bat_mesh *mesh = &meshes[i];
        shares[i] = calloc(mesh->vertex_count, sizeof *shares[i]);
        status = shares[i] == NULL
                     ? BAT_NO_MEMORY
                     : bat_mesh_vertex_distances(mesh, &meshes[1 - i], job->compare.threads, shares[i], &error);
        for (size_t v = 0; v < mesh->vertex_count && status == BAT_OK; v++)
            shares[i][v] *= 100 / diagonal;
        panels[i] = (bat_mesh_picture_panel){.mesh = mesh, .values = shares[i], .title = file_name(job->paths[i])};
    }
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.threads = job->compare.threads;
    options.value_label = "distance, % of the diagonal";
    if (status == BAT_OK)
        status = bat_mesh_picture_write(output_path(&job->call.files, "picture"), panels, 2, &options, &error);
    free(shares[0]);
    free(shares[1]);
    return status == BAT_OK ? EXIT_DONE : report_failure(job->call.picture, &error);
}

static int measure_meshes(measure_job *job)
{
    const bat_mesh *a = &job->meshes[0], *b = &job->meshes[1];
    job->read_mesh.notes = &job->notes;
    for (size_t i = 0; i < 2 && job->paths[i] != NULL; i++)
        if (bat_mesh_read(job->paths[i], &job->read_mesh, &job->meshes[i], report_error()) != BAT_OK)
            return report_bad_input(job->call.given, job->paths[i], report_error());
    if (job->read_mesh.keep_degenerate && !drop_degenerate(&job->meshes[0], &job->notes))
        return report_failure(job->paths[0], &(bat_error){.text = "out of memory"});
    if (job->paths[1] == NULL)
        return report_status(NULL, job->paths[0], bat_mesh_summarize(a, &job->summary, report_error()));
    job->compare.progress = report_progress("measuring distances");
    bat_status status = bat_mesh_compare(a, b, &job->compare, &job->distance, report_error());
    int code = report_status(NULL, file_at_fault(job->paths, report_error()), status);
    return code == EXIT_DONE && job->call.picture != NULL ? draw_distances(job) : code;
}

static bool check_meshes(measure_job *job)
{
    static const char *const FOR_CURVES[] = {"geodesic", "to-segments", "space", "closed", "open", "project", NULL};
    static const char *const FOR_TWO[] = {"at-vertices", "samples", "accuracy", "picture", NULL};
    const arguments *given = job->call.given;
    job->compare.threads = job->call.threads;
    job->read_mesh.triangulate = true;
    job->read_mesh.keep_degenerate =
        job->paths[1] == NULL && !job->read_mesh.strict; // a summary counts what a repair would change
    if (argument_first(given, FOR_CURVES) != NULL)
        return usage_refused(given, "--%s is for curves, but %s is a mesh", argument_first(given, FOR_CURVES),
                             job->call.input);
    if (argument_first(given, FOR_TWO) != NULL && job->paths[1] == NULL)
        return usage_refused(given, "--%s needs a second file to measure the distance from", argument_first(given, FOR_TWO));
    return argument_choice(given, "from", &bat_mesh_format_family, &job->read_mesh.format) &&
           usage_accepts(given, bat_options_check(&bat_mesh_compare_fields, &job->compare, report_error()));
}

// The verb

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
    static const char *const of_meshes[] = {"at-vertices", "samples", "accuracy", "picture", "strict", NULL};
    measure_job *job = of;
    const arguments *given = job->call.given;
    for (size_t i = 0; i < given->positional_count; i++)
        job->paths[i] = given->positional[i];
    job->of_meshes = means_meshes(given, &job->failure);
    if (job->of_meshes)
        return check_meshes(job);
    job->read.threads = job->measure.threads = job->call.threads;
    if (!argument_choice(given, "from", &bat_curve_format_family, &job->read.format))
        return false;
    const usage_rule rules[] = {
        {argument(given, "closed") != NULL && argument(given, "open") != NULL, "--closed and --open exclude each other"},
        {job->measure.geodesic && job->measure.to_segments, "--geodesic and --to-segments exclude each other"},
        {argument_first(given, of_meshes) != NULL,
         "--at-vertices, --samples, --accuracy, --picture and --strict are for meshes"},
        {job->paths[1] == NULL && (job->measure.geodesic || job->measure.to_segments),
         "--geodesic and --to-segments need a second file to measure the distance from"},
    };
    return usage_obeys(given, rules, sizeof rules / sizeof *rules, NULL, NULL);
}

static int make(void *of)
{
    measure_job *job = of;
    if (job->failure.status != BAT_OK)
        return report_bad_input(job->call.given, NULL, &job->failure);
    if (job->of_meshes)
        return measure_meshes(job);
    for (size_t i = 0; i < 2 && job->paths[i] != NULL; i++)
        if (bat_curve_read(job->paths[i], &job->read, &job->sets[i], report_error()) != BAT_OK)
            return report_bad_input(job->call.given, job->paths[i], report_error());
    return measure_sets(job);
}

static int report(void *of)
{
    const measure_job *job = of;
    if (!job->of_meshes)
        return EXIT_DONE;
    return job->paths[1] == NULL ? report_measures(job, 1, &job->summary, job->summary.diagonal)
                                 : report_measures(job, 2, &job->distance, job->distance.diagonal);
}

static void end(void *of)
{
    measure_job *job = of;
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_set_free(&job->sets[i]);
        bat_mesh_free(&job->meshes[i]);
        free(job->results.fairness[i]);
    }
    bat_mesh_notes_free(&job->notes);
    free(job->results.distances);
    free(job->results.simple);
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
    .options = {{OPTIONS, 0}, {CURVE_READ_OPTIONS, offsetof(measure_job, read)}, {THREADS_OPTION, 0}, {JSON_OPTION, 0}},
    .positional = {1, 2},
    .reads_files = true,
    .job_size = sizeof(measure_job),
    .calls = {begin, check, make, NULL, report, end},
};
