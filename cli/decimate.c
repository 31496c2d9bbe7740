#include "mesh_files.h"
#include "report.h"

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// The job of `batten decimate`.
typedef struct decimate_job
{
    verb_call call;
    mesh_files files;
    bat_mesh_decimate_options decimate;
    const char *map_file; ///< null where not wanted
    bat_mesh fine, coarse;
    bat_mesh_map *map; ///< null when none was needed
    double distance;   ///< with --tolerance: the proven bound on the distance of the two surfaces
} decimate_job;

static const option_spec OPTIONS[] = {
    {"vertices", "N", METHOD, COMMON, "how many vertices to keep; more stay where no further collapse passes the checks",
     WHOLE(decimate_job, decimate.vertices, 1, BAT_MESH_NONE)},
    {"faces", "N", METHOD, COMMON, "instead: how many faces to keep",
     WHOLE(decimate_job, decimate.faces, 1, BAT_MESH_MAX_FACES)},
    {"ratio", "R", METHOD, COMMON, "instead: the share of the faces to keep, above 0 to 1",
     NUMBER(decimate_job, decimate.ratio)},
    {"tolerance", "E", METHOD, COMMON,
     "instead: as few as keep both surfaces within the distance E of each other, in the units of IN; with % of the diagonal "
     "of its box (0.1%)",
     NO_FIELD},
    {"method", "NAME", METHOD, COMMON,
     "{}; default memoryless. memoryless: squared volumes to the present faces, at preserved volume (Lindstrom and Turk); "
     "quadric: squared distances from the planes of all faces of IN, faster and less accurate; fast: quadric errors without "
     "a strict order to three times the target, then memoryless errors, for large meshes",
     CHOICE(decimate_job, decimate.method, bat_mesh_decimate_method_family)},
    {"attributes", "W", METHOD, 0,
     "the weight of texture and channels in the error; 0 drops them, and lets seams vanish; default 0.5",
     NUMBER(decimate_job, decimate.attributes)},
    {"random", "K", METHOD, 0, "each time collapse the edge of minimum error among K random ones; default: among all",
     WHOLE(decimate_job, decimate.candidates, 1, 1000000)},
    {"seed", "N", METHOD, 0, "of --random; default 1", WHOLE(decimate_job, decimate.seed, 0, 1000000000)},
    {"min-normal", "C", METHOD, 0, "the minimum cosine of the angle by which a collapse turns a face, -1 to 1; default 0.2",
     NUMBER(decimate_job, decimate.min_normal)},
    {"min-quality", "Q", METHOD, 0,
     "the minimum quality of a triangle after a collapse, from 0 to 1 for an equilateral one; default 0.1",
     NUMBER(decimate_job, decimate.min_quality)},
    {"boundary-weight", "W", METHOD, 0, "the weight of the error at a boundary, that of a face being 1; default 1000",
     NUMBER(decimate_job, decimate.boundary_weight)},
    {"map", "FILE", RESULT, COMMON | IS_WRITTEN, "write the bijective map between IN and OUT, a safetensors file",
     TEXT(decimate_job, map_file)},
    END_OF_OPTIONS,
};

/// The options that say where to stop.
static const char *const TARGETS[] = {"vertices", "faces", "ratio", "tolerance"};

enum
{
    TARGET_COUNT = sizeof TARGETS / sizeof *TARGETS
};

/// The option of TARGETS that was given; null after a message.
static const char *find_target(const arguments *given)
{
    const char *found = NULL;
    for (size_t i = 0; i < TARGET_COUNT; i++)
    {
        if (argument(given, TARGETS[i]) == NULL)
            continue;
        if (found != NULL)
        {
            (void)usage_error(given, "--%s and --%s exclude each other", found, TARGETS[i]);
            return NULL;
        }
        found = TARGETS[i];
    }
    if (found == NULL)
        (void)usage_error(given, "--vertices N, --faces N, --ratio R or --tolerance E is missing");
    return found;
}

/// --tolerance: a length, or a share of the diagonal with %. False after a message.
static bool read_tolerance(const arguments *given, bat_mesh_decimate_options *options)
{
    const char *text = argument(given, "tolerance");
    if (text == NULL)
        return true;
    char *end;
    options->tolerance = strtod(text, &end);
    options->relative_tolerance = strcmp(end, "%") == 0;
    if (options->relative_tolerance)
        options->tolerance /= 100;
    if (end != text && (*end == '\0' || options->relative_tolerance) && isfinite(options->tolerance) &&
        options->tolerance > 0)
        return true;
    return argument_refused(given, "tolerance", "a length or a share of the diagonal as 0.1%%, above 0");
}

static bool read_target(const arguments *given, bat_mesh_decimate_options *options)
{
    if (find_target(given) == NULL || !read_tolerance(given, options))
        return false;
    return argument(given, "ratio") == NULL || (options->ratio > 0 && options->ratio <= 1) ||
           argument_refused(given, "ratio", "above 0 and at most 1");
}

static void begin(void *to)
{
    decimate_job *job = to;
    mesh_files_begin(&job->files);
    job->decimate = bat_mesh_decimate_defaults();
}

static bool check(void *of)
{
    decimate_job *job = of;
    const arguments *given = job->call.given;
    bat_error error;
    job->decimate.threads = job->call.threads;
    if (job->call.output == NULL)
        (void)usage_error(given, "-o OUT is missing");
    else if (argument(given, "seed") != NULL && argument(given, "random") == NULL)
        (void)usage_error(given, "--seed needs --random K");
    else
        return read_target(given, &job->decimate) &&
               usage_accepts(given, bat_options_check(&bat_mesh_decimate_fields, &job->decimate, &error), &error) &&
               mesh_files_check(&job->files, &job->call);
    return false;
}

static int decimate(decimate_job *job)
{
    bat_error error;
    if (bat_mesh_read(job->call.input, &job->files.read, &job->fine, &error) != BAT_OK)
        return report_bad_input(job->call.given, job->call.input, &error);
    bat_mesh_decimate_options options = job->decimate;
    options.progress = report_progress("decimating");
    options.distance = &job->distance;
    bat_status status =
        bat_mesh_decimate(&job->fine, &options, &job->coarse, job->map_file != NULL ? &job->map : NULL, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : report_bad_input(job->call.given, job->call.input, &error);
}

static int make(void *of)
{
    decimate_job *job = of;
    bat_error error;
    int code = decimate(job);
    if (code != EXIT_DONE || job->map_file == NULL)
        return code;
    return bat_mesh_map_write(output_path(&job->call.files, "map"), job->map, &error) == BAT_OK
               ? EXIT_DONE
               : report_failure(job->map_file, &error);
}

static int write_mesh(void *of, const char *path)
{
    decimate_job *job = of;
    bat_error error;
    return bat_mesh_write(path, &job->coarse, &job->files.write, &error) == BAT_OK
               ? EXIT_DONE
               : report_bad_input(job->call.given, job->call.output, &error);
}

/// Whether the result has as few vertices or faces as wanted.
static bool is_reached(const bat_mesh_decimate_options *options, const bat_mesh *fine, const bat_mesh *coarse)
{
    if (options->vertices > 0)
        return coarse->vertex_count <= options->vertices;
    if (options->faces > 0)
        return coarse->face_count <= options->faces;
    return options->tolerance > 0 || (double)coarse->face_count <= fmax(1, options->ratio * (double)fine->face_count);
}

static int report(void *of)
{
    decimate_job *job = of;
    const bat_mesh *fine = &job->fine, *coarse = &job->coarse;
    const bat_mesh_decimate_options *how = &job->decimate;
    bool reached = is_reached(how, fine, coarse);
    double wanted = how->vertices > 0 ? (double)how->vertices
                    : how->faces > 0  ? (double)how->faces
                    : how->ratio > 0  ? how->ratio
                                      : how->tolerance;
    if (job->call.json)
        return report_json(json_pack("{s:{s:I, s:I}, s:{s:I, s:I}, s:s, s:s, s:o, s:b, s:o, s:I, s:s?, s:o}", "fine",
                                     "vertices", (json_int_t)fine->vertex_count, "faces", (json_int_t)fine->face_count,
                                     "coarse", "vertices", (json_int_t)coarse->vertex_count, "faces",
                                     (json_int_t)coarse->face_count, "method",
                                     bat_choice_name(&bat_mesh_decimate_method_family, (int)how->method), "target",
                                     find_target(job->call.given), "wanted", report_number(wanted), "reached", (int)reached,
                                     "distance", report_number(how->tolerance > 0 ? job->distance : NAN), "repaired",
                                     (json_int_t)bat_mesh_repair_places(&job->files.repairs), "map", job->map_file, "notes",
                                     report_notes_json(&job->files.notes)));
    mesh_files_report(&job->files, &job->call);
    if (job->call.quiet)
        return EXIT_DONE;
    (void)printf("%zu vertices, %zu faces -> %zu vertices, %zu faces\n", fine->vertex_count, fine->face_count,
                 coarse->vertex_count, coarse->face_count);
    if (how->tolerance > 0)
        (void)printf("no point of either surface is farther than %.6g from the other\n", job->distance);
    if (!reached)
        (void)printf("no further collapse passes the checks; lower --min-quality or --min-normal\n");
    return EXIT_DONE;
}

static void end(void *of)
{
    decimate_job *job = of;
    bat_mesh_free(&job->fine);
    bat_mesh_free(&job->coarse);
    bat_mesh_notes_free(&job->files.notes);
    bat_mesh_map_free(job->map);
}

const verb VERB_DECIMATE = {
    .name = "decimate",
    .arguments = "IN... -o OUT --vertices N|--faces N|--ratio R|--tolerance E [options]",
    .summary = "make a coarse mesh of a fine one, with a map between the two",
    .about =
        "Make a coarse triangle mesh of a fine one by collapsing its edges, those first that change the surface least "
        "(see `batten list formats`; - for standard input). Topology, boundaries, creases and seams of the texture stay; "
        "texture coordinates and values at the vertices count in the error and go along.",
    .example = "batten decimate scan.ply -o coarse.ply --tolerance 0.1%",
    .options = (const option_table[]){{OUTPUT_OPTION, 0},
                                      {OPTIONS, 0},
                                      {MESH_FILE_OPTIONS, offsetof(decimate_job, files)},
                                      {REPORT_OPTIONS, 0},
                                      {THREADS_OPTION, 0},
                                      {MANY_OPTIONS, 0},
                                      {NULL, 0}},
    .min_positional = 1,
    .max_positional = SIZE_MAX,
    .reads_files = true,
    .formats = &bat_mesh_format_family,
    .job_size = sizeof(decimate_job),
    .begin = begin,
    .check = check,
    .make = make,
    .write = write_mesh,
    .report = report,
    .end = end,
};
