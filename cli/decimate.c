#include "verbs.h"

#include "arguments.h"
#include "outputs.h"
#include "report.h"

#include "batten/batten.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the decimated mesh to OUT (- for standard output)"},
    {"vertices", 0, "N", "how many vertices to keep; more stay where no further collapse passes the checks"},
    {"map", 0, "FILE", "write the bijective map between IN and OUT, a safetensors file"},
    {"random", 0, "K", "each time collapse the edge of least error among K random ones; default: among all"},
    {"seed", 0, "N", "of --random; default 1"},
    {"min-normal", 0, "C", "the minimum cosine of the angle by which a collapse turns a face, -1 to 1; default 0.2"},
    {"min-quality", 0, "Q",
     "the minimum quality of a triangle after a collapse, from 0 to 1 for an equilateral one; default 0.2"},
    {"boundary-weight", 0, "W", "the weight of the error at a boundary, that of a face being 1; default 1000"},
    {"triangulate", 0, NULL, "cut polygons of IN into triangles"},
    {"repair", 0, NULL, "split edges of more than two faces and vertices of several fans first"},
    {"normals", 0, NULL, "write vertex normals (OBJ, PLY, glTF)"},
    {"from", 0, "FORMAT", "obj, ply, off, stl, gltf or glb; default: by content and ending"},
    {"to", 0, "FORMAT", "the same for OUT"},
    {"threads", 0, "N", "of writing; default: all; the result does not depend on it"},
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const file_option FILES[] = {{"output", FILE_WRITTEN}, {"map", FILE_WRITTEN}, {NULL, 0}};

static const verb_spec SPEC = {
    .usage = "batten decimate IN -o OUT --vertices N [--map FILE] [options]",
    .summary =
        "Make a coarse triangle mesh of a fine one by collapsing its edges, those first that change the surface least\n"
        "(OBJ, PLY, OFF, STL, glTF; - for standard input). Topology, boundaries and creases stay; texture coordinates and\n"
        "values at the vertices go along by the map between the two meshes.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = 1,
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
} decimate_result;

static bool read_numbers(const arguments *given, bat_mesh_decimate_options *options)
{
    long vertices, candidates, seed;
    if (!argument_whole(given, "vertices", 0, BAT_MESH_NONE, -1, &vertices) ||
        !argument_whole(given, "random", 1, 1000000, (long)options->candidates, &candidates) ||
        !argument_whole(given, "seed", 0, 1000000000, (long)options->seed, &seed) ||
        !argument_number(given, "min-normal", options->least_normal, &options->least_normal) ||
        !argument_number(given, "min-quality", options->least_quality, &options->least_quality) ||
        !argument_number(given, "boundary-weight", options->boundary_weight, &options->boundary_weight))
        return false;
    options->vertices = vertices < 0 ? 0 : (size_t)vertices;
    options->candidates = (size_t)candidates;
    options->seed = (uint64_t)seed;
    bat_error error;
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
    if (!read_numbers(given, &job->decimate) || !argument_mesh_format(given, "from", &job->read.format) ||
        !argument_mesh_format(given, "to", &job->write.format) || !argument_threads(given, &job->write.threads))
        return false;
    bool piped = is_standard_output(job->output);
    const char *fault = NULL;
    if (job->output == NULL)
        fault = "-o OUT is missing";
    else if (argument(given, "vertices") == NULL)
        fault = "--vertices N is missing";
    else if (argument(given, "seed") != NULL && argument(given, "random") == NULL)
        fault = "--seed needs --random K";
    else if (job->json && (job->quiet || piped))
        fault = job->quiet ? "--json and --quiet exclude each other" : "--json and -o - both need standard output";
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    job->quiet = job->quiet || piped;
    return fault == NULL && argument_mesh_ending(given, job->write.format);
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
    bool carried = result->fine.channel_count > 0 || result->fine.texture != NULL;
    options.progress = report_progress("decimating");
    bat_status status = bat_mesh_decimate(&result->fine, &options, &result->coarse,
                                          carried || job->map != NULL ? &result->map : NULL, &error);
    report_progress_end();
    if (status == BAT_OK && carried)
        status = bat_mesh_map_transfer(result->map, &result->fine, &result->coarse, 0, &result->coarse, &error);
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

static int report(const decimate_job *job, const decimate_result *result)
{
    const bat_mesh *fine = &result->fine, *coarse = &result->coarse;
    bool reached = coarse->vertex_count <= job->decimate.vertices;
    if (job->json)
        return report_json(json_pack("{s:{s:I, s:I}, s:{s:I, s:I}, s:I, s:b, s:I, s:s?, s:o}", "fine", "vertices",
                                     (json_int_t)fine->vertex_count, "faces", (json_int_t)fine->face_count, "coarse",
                                     "vertices", (json_int_t)coarse->vertex_count, "faces", (json_int_t)coarse->face_count,
                                     "wanted", (json_int_t)job->decimate.vertices, "reached", (int)reached, "repaired",
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

int verb_decimate(int argc, char **argv)
{
    arguments given;
    int code;
    decimate_job job;
    decimate_result result = {.map = NULL};
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (!read_job(&given, &job))
        return EXIT_BAD_USAGE;
    code = outputs_open(&given, &job.files);
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
