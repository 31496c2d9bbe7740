#include "verbs.h"

#include "arguments.h"
#include "many.h"
#include "outputs.h"
#include "report.h"

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the decimated mesh to OUT (- for standard output)"},
    {"vertices", 0, "N", "how many vertices to keep; more stay where no further collapse passes the checks"},
    {"faces", 0, "N", "instead: how many faces to keep"},
    {"ratio", 0, "R", "instead: the share of the faces to keep, above 0 to 1"},
    {"tolerance", 0, "E",
     "instead: as few as keep both surfaces within the distance E of each other, in the units of IN; with % of the\n"
     "diagonal of its box (0.1%)"},
    {"method", 0, "NAME",
     "memoryless (default): squared volumes to the present faces, at preserved volume (Lindstrom and Turk); quadric:\n"
     "squared distances from the planes of all faces of IN, faster and less accurate; fast: quadric errors without a\n"
     "strict order to three times the target, then memoryless errors, for large meshes"},
    {"attributes", 0, "W",
     "the weight of texture and channels in the error; 0 drops them, and lets seams vanish; default 0.5"},
    {"map", 0, "FILE", "write the bijective map between IN and OUT, a safetensors file"},
    {"random", 0, "K", "each time collapse the edge of least error among K random ones; default: among all"},
    {"seed", 0, "N", "of --random; default 1"},
    {"min-normal", 0, "C", "the minimum cosine of the angle by which a collapse turns a face, -1 to 1; default 0.2"},
    {"min-quality", 0, "Q",
     "the minimum quality of a triangle after a collapse, from 0 to 1 for an equilateral one; default 0.1"},
    {"boundary-weight", 0, "W", "the weight of the error at a boundary, that of a face being 1; default 1000"},
    {"triangulate", 0, NULL, "cut polygons of IN into triangles"},
    {"repair", 0, NULL, "split edges of more than two faces and vertices of several fans first"},
    {"normals", 0, NULL, "write vertex normals (OBJ, PLY, glTF)"},
    {"from", 0, "FORMAT", "obj, ply, off, stl, gltf or glb; default: by content and ending"},
    {"to", 0, "FORMAT", "the same for OUT"},
    {"threads", 0, "N",
     "of the first errors, of --tolerance and of writing; default: all; the result does not depend on it"},
    MANY_OPTIONS,
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const file_option FILES[] = {{"output", FILE_WRITTEN}, {"map", FILE_WRITTEN}, {NULL, 0}};

static const verb_spec SPEC = {
    .usage = "batten decimate IN... -o OUT --vertices N | --faces N | --ratio R | --tolerance E [--map FILE] [options]",
    .summary =
        "Make a coarse triangle mesh of a fine one by collapsing its edges, those first that change the surface least\n"
        "(`batten list formats`; - for standard input). Topology, boundaries, creases and seams of the\n"
        "texture stay; texture coordinates and values at the vertices count in the error and go along.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = SIZE_MAX,
    .reads_files = true,
    .files = FILES,
};

/// The command line.
typedef struct decimate_job
{
    const arguments *given;
    const char *input, *output, *map;
    outputs files;
    bat_mesh_read_options read;
    bat_mesh_write_options write;
    bat_mesh_decimate_options decimate;
    bool json, quiet;
} decimate_job;

/// A job's meshes.
typedef struct decimate_result
{
    bat_mesh fine, coarse;
    bat_mesh_map *map; ///< null when none was needed
    bat_mesh_repair_report repairs;
    bat_mesh_notes notes;
    double distance; ///< with --tolerance: the proven bound on the distance of the two surfaces
} decimate_result;

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
    options->error = strtod(text, &end);
    options->relative_error = strcmp(end, "%") == 0;
    if (options->relative_error)
        options->error /= 100;
    if (end != text && (*end == '\0' || options->relative_error) && isfinite(options->error) && options->error > 0)
        return true;
    (void)usage_error(given, "--tolerance takes a length or a share of the diagonal as 0.1%%, above 0, not '%s'", text);
    return false;
}

static bool read_target(const arguments *given, bat_mesh_decimate_options *options)
{
    long vertices, faces;
    const char *target = find_target(given);
    if (target == NULL || !argument_whole(given, "vertices", 1, BAT_MESH_NONE, 0, &vertices) ||
        !argument_whole(given, "faces", 1, BAT_MESH_MAX_FACES, 0, &faces) ||
        !argument_number(given, "ratio", 0, &options->ratio) || !read_tolerance(given, options))
        return false;
    options->vertices = (size_t)vertices;
    options->faces = (size_t)faces;
    if (strcmp(target, "ratio") != 0 || (options->ratio > 0 && options->ratio <= 1))
        return true;
    (void)usage_error(given, "ratio is %.10g, but must be above 0 and at most 1", options->ratio);
    return false;
}

static bool read_numbers(const arguments *given, bat_mesh_decimate_options *options)
{
    bat_error error;
    long candidates, seed;
    if (!argument_choice(given, "method", &bat_mesh_decimate_method_family, &options->method) ||
        !argument_whole(given, "random", 1, 1000000, (long)options->candidates, &candidates) ||
        !argument_whole(given, "seed", 0, 1000000000, (long)options->seed, &seed) ||
        !argument_number(given, "min-normal", options->least_normal, &options->least_normal) ||
        !argument_number(given, "min-quality", options->least_quality, &options->least_quality) ||
        !argument_number(given, "boundary-weight", options->boundary_weight, &options->boundary_weight) ||
        !argument_number(given, "attributes", options->attributes, &options->attributes) ||
        !argument_threads(given, &options->threads))
        return false;
    options->candidates = (size_t)candidates;
    options->seed = (uint64_t)seed;
    if (bat_mesh_decimate_options_check(options, &error) == BAT_OK)
        return true;
    (void)usage_error(given, "%s", error.text);
    return false;
}

/// False after a message.
static bool read_job(const arguments *given, decimate_job *job)
{
    *job = (decimate_job){.given = given,
                          .input = given->positional[0],
                          .output = argument(given, "output"),
                          .map = argument(given, "map"),
                          .read = bat_mesh_read_defaults(),
                          .write = bat_mesh_write_defaults(),
                          .decimate = bat_mesh_decimate_defaults(),
                          .json = argument_flag(given, "json"),
                          .quiet = argument_flag(given, "quiet")};
    job->read.triangulate = argument_flag(given, "triangulate");
    job->read.repair = argument_flag(given, "repair");
    if ((job->output != NULL && !read_target(given, &job->decimate)) || !read_numbers(given, &job->decimate) ||
        !argument_choice(given, "from", &bat_mesh_format_family, &job->read.format) ||
        !argument_choice(given, "to", &bat_mesh_format_family, &job->write.format))
        return false;
    job->write.threads = job->decimate.threads;
    bool piped = is_standard_output(job->output);
    const char *fault = NULL;
    if (job->output == NULL)
        fault = "-o OUT is missing";
    else if (argument(given, "seed") != NULL && argument(given, "random") == NULL)
        fault = "--seed needs --random K";
    else if (job->json && (job->quiet || piped))
        fault = job->quiet ? "--json and --quiet exclude each other" : "--json and -o - both need standard output";
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    job->quiet = job->quiet || piped;
    return fault == NULL && argument_ending(given, &bat_mesh_format_family, (int)job->write.format);
}

static int read_fine(const decimate_job *job, decimate_result *result)
{
    bat_error error;
    bat_mesh_read_options options = job->read;
    options.repairs = &result->repairs;
    options.notes = &result->notes;
    return bat_mesh_read(job->input, &options, &result->fine, &error) == BAT_OK
               ? EXIT_DONE
               : report_bad_input(job->given, job->input, &error);
}

static int decimate(const decimate_job *job, decimate_result *result)
{
    bat_error error;
    bat_mesh_decimate_options options = job->decimate;
    options.progress = report_progress("decimating");
    options.distance = &result->distance;
    bat_status status =
        bat_mesh_decimate(&result->fine, &options, &result->coarse, job->map != NULL ? &result->map : NULL, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : report_bad_input(job->given, job->input, &error);
}

static int write_mesh(const decimate_job *job, decimate_result *result, const char *path)
{
    bat_error error;
    bat_mesh_write_options options = job->write;
    options.normals = argument_flag(job->given, "normals") ? BAT_MESH_NORMALS_ANGLE : BAT_MESH_NORMALS_NONE;
    options.notes = &result->notes;
    if (path == NULL || bat_mesh_write(path, &result->coarse, &options, &error) == BAT_OK)
        return EXIT_DONE;
    return report_failure(job->output, &error);
}

static int write_map(const decimate_job *job, const bat_mesh_map *map)
{
    bat_error error;
    const char *path = output_path(&job->files, "map");
    return bat_mesh_map_write(path, map, &error) == BAT_OK ? EXIT_DONE : report_failure(job->map, &error);
}

/// Whether the result has as few vertices or faces as wanted.
static bool is_reached(const bat_mesh_decimate_options *options, const bat_mesh *fine, const bat_mesh *coarse)
{
    if (options->vertices > 0)
        return coarse->vertex_count <= options->vertices;
    if (options->faces > 0)
        return coarse->face_count <= options->faces;
    return options->error > 0 || (double)coarse->face_count <= fmax(1, options->ratio * (double)fine->face_count);
}

static int report(const decimate_job *job, const decimate_result *result)
{
    const bat_mesh *fine = &result->fine, *coarse = &result->coarse;
    const bat_mesh_decimate_options *how = &job->decimate;
    bool reached = is_reached(how, fine, coarse);
    double wanted = how->vertices > 0 ? (double)how->vertices
                    : how->faces > 0  ? (double)how->faces
                    : how->ratio > 0  ? how->ratio
                                      : how->error;
    if (job->json)
        return report_json(json_pack("{s:{s:I, s:I}, s:{s:I, s:I}, s:s, s:s, s:o, s:b, s:o, s:I, s:s?, s:o}", "fine",
                                     "vertices", (json_int_t)fine->vertex_count, "faces", (json_int_t)fine->face_count,
                                     "coarse", "vertices", (json_int_t)coarse->vertex_count, "faces",
                                     (json_int_t)coarse->face_count, "method",
                                     bat_choice_name(&bat_mesh_decimate_method_family, (int)how->method), "target",
                                     find_target(job->given), "wanted", report_number(wanted), "reached", (int)reached,
                                     "distance", report_number(how->error > 0 ? result->distance : NAN), "repaired",
                                     (json_int_t)bat_mesh_repair_places(&result->repairs), "map", job->map, "notes",
                                     report_notes_json(&result->notes)));
    if (!argument_flag(job->given, "quiet"))
        report_notes(&result->notes, is_standard_output(job->output) ? stderr : stdout);
    if (job->quiet)
        return EXIT_DONE;
    if (job->read.repair)
        (void)printf("%zu places repaired\n", bat_mesh_repair_places(&result->repairs));
    (void)printf("%zu vertices, %zu faces -> %zu vertices, %zu faces\n", fine->vertex_count, fine->face_count,
                 coarse->vertex_count, coarse->face_count);
    if (how->error > 0)
        (void)printf("no point of either surface is farther than %.6g from the other\n", result->distance);
    if (!reached)
        (void)printf("no further collapse passes the checks; lower --min-quality or --min-normal\n");
    return EXIT_DONE;
}

/// Everything that can fail, the files included.
static int make(const decimate_job *job, decimate_result *result)
{
    int code = read_fine(job, result);
    if (code == EXIT_DONE)
        code = decimate(job, result);
    if (code == EXIT_DONE && job->map != NULL)
        code = write_map(job, result->map);
    return code == EXIT_DONE ? write_mesh(job, result, output_path(&job->files, "output")) : code;
}

static int run(const arguments *given)
{
    int code;
    decimate_job job;
    decimate_result result = {.map = NULL};
    if (!read_job(given, &job))
        return EXIT_BAD_USAGE;
    code = outputs_open(given, &job.files);
    if (code != EXIT_DONE)
        return code;
    code = outputs_close(&job.files, make(&job, &result));
    if (code == EXIT_DONE && is_standard_output(job.output))
        code = write_mesh(&job, &result, "-");
    if (code == EXIT_DONE)
        code = report(&job, &result);
    bat_mesh_free(&result.fine);
    bat_mesh_free(&result.coarse);
    bat_mesh_notes_free(&result.notes);
    bat_mesh_map_free(result.map);
    return code;
}

int verb_decimate(int argc, char **argv)
{
    return many_run(&SPEC, &bat_mesh_format_family, run, argc, argv);
}
