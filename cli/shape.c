#include "verbs.h"

#include "arguments.h"
#include "report.h"
#include "shape_cloud.h"

#include "batten/batten.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the mesh or cloud to OUT (- for standard output)"},
    {"vertices", 0, "N", "about so many vertices or points, 200 to 1000000; default 10000. A cage has its own number"},
    {"seed", 0, "S", "another number, another shape of that kind; default 1"},
    {"picture", 0, "FILE", "draw it (.png, .svg or .pdf)"},
    {"to", 0, "FORMAT",
     "of meshes: obj, ply, off or stl; default: by the file's ending. Clouds go to .xyz, .csv, .ply, .obj"},
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten shape KIND [-o OUT] [--vertices N] [--seed S] [--picture FILE] [options]",
    .summary =
        "Make a triangle mesh or a cloud of points to try things on and to train with; `batten list shapes` names the "
        "kinds.\n"
        "The same kind, number and seed give the same shape.",
    .options = OPTIONS,
    .least_positional = 1,
    .most_positional = 1,
};

/// What the command line asks for.
typedef struct shape_job
{
    const char *kind, *output, *picture; ///< the last two may be null
    size_t vertices;
    uint64_t seed;
    bat_mesh_write_options write;
    bool json, quiet;
} shape_job;

static bool is_kind(const char *name)
{
    if (shape_cloud_is_kind(name))
        return true;
    for (size_t i = 0; i < bat_mesh_shape_count(); i++)
        if (strcmp(bat_mesh_shape_at(i)->name, name) == 0)
            return true;
    return false;
}

/// What is wrong with the command line; null for nothing.
static const char *find_fault(const shape_job *job)
{
    bool piped = job->output != NULL && strcmp(job->output, "-") == 0;
    if (!is_kind(job->kind))
        return "there is no shape of that kind; `batten list shapes` names them";
    if (job->output == NULL && job->picture == NULL && job->quiet)
        return "nothing is asked for: give -o OUT or --picture FILE";
    if (job->json && job->quiet)
        return "--json and --quiet exclude each other";
    if (shape_cloud_is_kind(job->kind) && job->write.format != BAT_MESH_FORMAT_AUTO)
        return "--to goes with meshes: a cloud's format is that of OUT's ending, XYZ on standard output";
    return job->json && piped ? "--json and -o - both need standard output" : NULL;
}

/// False after a message.
static bool read_job(const arguments *given, shape_job *job)
{
    long vertices, seed;
    bat_error error;
    const char *to = argument(given, "to");
    *job = (shape_job){.kind = given->positional[0],
                       .output = argument(given, "output"),
                       .picture = argument(given, "picture"),
                       .write = bat_mesh_write_defaults(),
                       .json = argument_flag(given, "json"),
                       .quiet = argument_flag(given, "quiet")};
    if (!argument_whole(given, "vertices", 200, 1000000, 10000, &vertices) ||
        !argument_whole(given, "seed", 0, LONG_MAX, 1, &seed))
        return false;
    job->vertices = (size_t)vertices;
    job->seed = (uint64_t)seed;
    const char *fault = NULL;
    if (to != NULL && bat_mesh_format_by_name(to, &job->write.format, &error) != BAT_OK)
        fault = error.text;
    if (fault == NULL)
        fault = find_fault(job);
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    job->quiet = job->quiet || (job->output != NULL && strcmp(job->output, "-") == 0);
    return fault == NULL;
}

static int write_files(const shape_job *job, const bat_mesh *mesh)
{
    bat_error error;
    bat_mesh_panel panel = {.mesh = mesh, .title = job->kind};
    if (job->picture != NULL && bat_mesh_picture_write(job->picture, &panel, 1, NULL, &error) != BAT_OK)
        return report_failure(job->picture, &error);
    if (job->output != NULL && bat_mesh_write(job->output, mesh, &job->write, &error) != BAT_OK)
        return report_failure(job->output, &error);
    return EXIT_DONE;
}

static int report(const shape_job *job, const bat_mesh *mesh)
{
    if (job->json)
        return report_json(json_pack("{s:s, s:I, s:I, s:I}", "shape", job->kind, "seed", (json_int_t)job->seed, "vertices",
                                     (json_int_t)mesh->vertex_count, "faces", (json_int_t)mesh->face_count));
    if (!job->quiet)
        (void)printf("%s: %zu vertices, %zu faces\n", job->kind, mesh->vertex_count, mesh->face_count);
    return EXIT_DONE;
}

int verb_shape(int argc, char **argv)
{
    arguments given;
    int code;
    shape_job job;
    bat_mesh mesh;
    bat_error error;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (!read_job(&given, &job))
        return EXIT_BAD_USAGE;
    if (shape_cloud_is_kind(job.kind))
        return shape_cloud_make(
            &(shape_cloud_job){job.kind, job.output, job.picture, job.vertices, job.seed, job.json, job.quiet});
    if (bat_mesh_shape(job.kind, job.vertices, job.seed, &mesh, &error) != BAT_OK)
        return report_failure(NULL, &error);
    code = write_files(&job, &mesh);
    if (code == EXIT_DONE)
        code = report(&job, &mesh);
    bat_mesh_free(&mesh);
    return code;
}
