#include "verbs.h"

#include "arguments.h"
#include "mesh_input.h"
#include "report.h"

#include "batten/batten.h"
#include "batten/mesh.h"
#include "batten/mesh_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the decimated mesh to OUT (- for standard output)"},
    {"vertices", 0, "N", "how many vertices to keep; more stay where no further collapse passes the checks"},
    {"map", 0, "FILE", "write the bijective map between IN and OUT, a safetensors file"},
    {"random", 0, "K", "each time collapse the edge of least error among K random ones; default: among all"},
    {"seed", 0, "N", "of --random; default 1"},
    {"least-normal", 0, "C", "the least cosine of a face's turn in a collapse, -1 to 1; default 0.2"},
    {"least-quality", 0, "Q",
     "the least quality of a triangle after a collapse, from 0 to 1 for an equilateral one; default 0.2"},
    {"boundary-weight", 0, "W", "how much more a boundary's error counts than a face's; default 1000"},
    {"triangulate", 0, NULL, "cut polygons of IN into triangles"},
    {"repair", 0, NULL, "split edges of more than two faces and vertices of several fans first"},
    {"from", 0, "FORMAT", "obj, ply, off or stl; default: by the file's ending"},
    {"to", 0, "FORMAT", "the same for OUT"},
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten decimate IN -o OUT --vertices N [--map FILE] [options]",
    .summary =
        "Make a coarse triangle mesh of a fine one by collapsing its edges, those first that change the surface least\n"
        "(OBJ, PLY, OFF, STL; - for standard input). Topology, boundaries and creases stay; texture coordinates and\n"
        "values at the vertices go along by the map between the two meshes.",
    .options = OPTIONS,
    .least_positional = 1,
    .most_positional = 1,
};

/// What the command line asks for.
typedef struct decimate_job
{
    const char *input, *output, *map;
    bat_mesh_read_options read;
    bat_mesh_write_options write;
    bat_mesh_decimate_options decimate;
    bool repair, json, quiet;
} decimate_job;

/// A job's meshes.
typedef struct decimate_result
{
    bat_mesh fine, coarse;
    bat_mesh_map *map; ///< null when none was needed
    bat_mesh_repair_report repairs;
} decimate_result;

static bool read_numbers(const arguments *given, bat_mesh_decimate_options *options)
{
    long vertices, candidates, seed;
    if (!argument_whole(given, "vertices", 0, BAT_MESH_NONE, -1, &vertices) ||
        !argument_whole(given, "random", 1, 1000000, 0, &candidates) ||
        !argument_whole(given, "seed", 0, 1000000000, 1, &seed) ||
        !argument_number(given, "least-normal", options->least_normal, &options->least_normal) ||
        !argument_number(given, "least-quality", options->least_quality, &options->least_quality) ||
        !argument_number(given, "boundary-weight", options->boundary_weight, &options->boundary_weight))
        return false;
    const char *fault = NULL;
    if (!(options->least_normal >= -1 && options->least_normal <= 1))
        fault = "--least-normal is from -1 to 1";
    else if (!(options->least_quality >= 0 && options->least_quality <= 1))
        fault = "--least-quality is from 0 to 1";
    else if (!(options->boundary_weight >= 0))
        fault = "--boundary-weight is 0 or above";
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    options->vertices = vertices < 0 ? 0 : (size_t)vertices;
    options->candidates = (size_t)candidates;
    options->seed = (uint64_t)seed;
    return fault == NULL;
}

/// False after a message.
static bool read_job(const arguments *given, decimate_job *job)
{
    *job = (decimate_job){.input = given->positional[0],
                          .output = argument(given, "output"),
                          .map = argument(given, "map"),
                          .read = bat_mesh_read_defaults(),
                          .write = bat_mesh_write_defaults(),
                          .decimate = bat_mesh_decimate_defaults(),
                          .repair = argument_flag(given, "repair"),
                          .json = argument_flag(given, "json"),
                          .quiet = argument_flag(given, "quiet")};
    job->read.triangulate = argument_flag(given, "triangulate");
    if (!read_numbers(given, &job->decimate) || !mesh_format_argument(given, "from", &job->read.format) ||
        !mesh_format_argument(given, "to", &job->write.format))
        return false;
    bool piped = job->output != NULL && strcmp(job->output, "-") == 0;
    const char *fault = NULL;
    if (job->output == NULL)
        fault = "-o OUT is missing";
    else if (argument(given, "vertices") == NULL)
        fault = "--vertices N is missing";
    else if (argument(given, "seed") != NULL && argument(given, "random") == NULL)
        fault = "--seed needs --random K";
    else if (job->json && (job->quiet || piped))
        fault = job->quiet ? "--json and --quiet exclude each other" : "--json and -o - both need standard output";
    else if (job->map != NULL && strcmp(job->map, "-") == 0)
        fault = "--map cannot be standard output";
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    job->quiet = job->quiet || piped;
    return fault == NULL;
}

static int read_fine(const decimate_job *job, decimate_result *result)
{
    bat_error error;
    if (mesh_input_read(job->input, &job->read, job->repair, &result->repairs, &result->fine, &error) != BAT_OK)
        return report_failure(job->input, &error);
    return EXIT_DONE;
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
    return status == BAT_OK ? EXIT_DONE : report_failure(job->input, &error);
}

static int write_files(const decimate_job *job, const decimate_result *result)
{
    bat_error error;
    if (job->map != NULL && bat_mesh_map_write(job->map, result->map, &error) != BAT_OK)
        return report_failure(job->map, &error);
    if (bat_mesh_write(job->output, &result->coarse, &job->write, &error) != BAT_OK)
        return report_failure(job->output, &error);
    return EXIT_DONE;
}

static int report(const decimate_job *job, const decimate_result *result)
{
    const bat_mesh *fine = &result->fine, *coarse = &result->coarse;
    bool reached = coarse->vertex_count <= job->decimate.vertices;
    if (job->json)
        return report_json(json_pack("{s:{s:I, s:I}, s:{s:I, s:I}, s:I, s:b, s:I, s:s?}", "fine", "vertices",
                                     (json_int_t)fine->vertex_count, "faces", (json_int_t)fine->face_count, "coarse",
                                     "vertices", (json_int_t)coarse->vertex_count, "faces", (json_int_t)coarse->face_count,
                                     "wanted", (json_int_t)job->decimate.vertices, "reached", (int)reached, "repaired",
                                     (json_int_t)mesh_input_repaired(&result->repairs), "map", job->map));
    if (job->quiet)
        return EXIT_DONE;
    if (job->repair)
        (void)printf("%zu places repaired\n", mesh_input_repaired(&result->repairs));
    (void)printf("%zu vertices, %zu faces -> %zu vertices, %zu faces\n", fine->vertex_count, fine->face_count,
                 coarse->vertex_count, coarse->face_count);
    if (!reached)
        (void)printf("no further collapse passes the checks; --least-quality and --least-normal lower them\n");
    return EXIT_DONE;
}

int verb_decimate(int argc, char **argv)
{
    arguments given;
    int code;
    decimate_job job;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (!read_job(&given, &job))
        return EXIT_BAD_USAGE;
    decimate_result result = {.map = NULL};
    code = read_fine(&job, &result);
    if (code == EXIT_DONE)
        code = decimate(&job, &result);
    if (code == EXIT_DONE)
        code = write_files(&job, &result);
    if (code == EXIT_DONE)
        code = report(&job, &result);
    bat_mesh_free(&result.fine);
    bat_mesh_free(&result.coarse);
    bat_mesh_map_free(result.map);
    return code;
}
