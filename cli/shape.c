#include "verbs.h"

#include "outputs.h"
#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the mesh, cloud or map to OUT (- for standard output; clouds as XYZ, maps as GeoJSON)"},
    {"vertices", 0, "N",
     "the approximate number of vertices or points, 200 to 1000000; default 10000, of clouds 9600; not for a cage or a map"},
    {"countries", 0, "N", "of a map, 12 to 5000; default 200"},
    {"detail", 0, "D",
     "of a map: a border between two cells has 2^D edges, 1 to 10; default 2. Of 250 countries, 7 gives "
     "600,000 vertices"},
    {"seed", 0, "S", "of the random numbers; another seed gives another shape of that kind; default 1"},
    {"picture", 0, "FILE", "draw the mesh, the cloud and its parameters, or the map (.png, .svg or .pdf)"},
    {"to", 0, "FORMAT", "of meshes: obj, ply, off or stl; default: by the file's ending"},
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const file_option FILES[] = {{"output", FILE_WRITTEN}, {"picture", FILE_DRAWN}, {NULL, 0}};

static const verb_spec SPEC = {
    .usage = "batten shape KIND [-o OUT] [--vertices N] [--seed S] [--picture FILE] [options]",
    .summary = "Make a triangle mesh, a cloud of points or a map for tests and trainings; `batten list shapes` names the\n"
               "kinds. The same kind, numbers and seed give the same shape.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = 1,
    .files = FILES,
};

/// The kind that is no mesh and no cloud.
static const char MAP[] = "map";

/// The command line.
typedef struct shape_job
{
    const char *kind, *output, *picture; ///< the last two may be null
    outputs files;
    size_t vertices;
    uint64_t seed;
    bat_mesh_write_options write;
    bat_shape_map_options map;
    bool is_cloud, is_map, json, quiet;
} shape_job;

static bool is_cloud_kind(const char *name)
{
    for (const char *const *kind = bat_cloud_shape_names(); *kind != NULL; kind++)
        if (strcmp(*kind, name) == 0)
            return true;
    return false;
}

static bool is_mesh_kind(const char *name)
{
    for (size_t i = 0; i < bat_mesh_shape_count(); i++)
        if (strcmp(bat_mesh_shape_at(i)->name, name) == 0)
            return true;
    return false;
}

/// The fault of the command line; null for none.
static const char *find_fault(const shape_job *job)
{
    bool piped = is_standard_output(job->output);
    if (!job->is_cloud && !job->is_map && !is_mesh_kind(job->kind))
        return "unknown kind of shape; `batten list shapes` names the kinds";
    if (job->output == NULL && job->picture == NULL && job->quiet)
        return "there is no output: give -o OUT or --picture FILE";
    if (job->json && job->quiet)
        return "--json and --quiet exclude each other";
    return job->json && piped ? "--json and -o - both need standard output" : NULL;
}

/// Read the numbers that are for one family of shapes alone. False after an error message.
static bool read_numbers(const arguments *given, shape_job *job)
{
    static const char *const OF_MAPS[] = {"countries", "detail"};
    long vertices, countries, detail;
    if (!argument_whole(given, "vertices", 200, 1000000, job->is_cloud ? 9600 : 10000, &vertices) ||
        !argument_whole(given, "countries", 0, LONG_MAX, (long)job->map.countries, &countries) ||
        !argument_whole(given, "detail", 0, LONG_MAX, (long)job->map.detail, &detail))
        return false;
    job->vertices = (size_t)vertices;
    job->map.countries = (size_t)countries;
    job->map.detail = (size_t)detail;
    job->map.seed = job->seed;
    bat_error error;
    for (size_t i = 0; i < sizeof OF_MAPS / sizeof *OF_MAPS; i++)
        if (!job->is_map && argument(given, OF_MAPS[i]) != NULL)
        {
            (void)usage_error(given, "--%s goes with the shape map", OF_MAPS[i]);
            return false;
        }
    if (job->is_map && argument(given, "vertices") != NULL)
        (void)usage_error(given, "--vertices does not go with the shape map; --countries and --detail do");
    else if (bat_shape_map_options_check(&job->map, &error) != BAT_OK)
        (void)usage_error(given, "%s", error.text);
    else
        return true;
    return false;
}

/// Returns false after an error message.
static bool read_job(const arguments *given, shape_job *job)
{
    long seed;
    const char *to = argument(given, "to");
    *job = (shape_job){.kind = given->positional[0],
                       .output = argument(given, "output"),
                       .picture = argument(given, "picture"),
                       .write = bat_mesh_write_defaults(),
                       .map = bat_shape_map_defaults(),
                       .is_cloud = is_cloud_kind(given->positional[0]),
                       .is_map = strcmp(given->positional[0], MAP) == 0,
                       .json = argument_flag(given, "json"),
                       .quiet = argument_flag(given, "quiet")};
    if (!argument_whole(given, "seed", 0, LONG_MAX, 1, &seed))
        return false;
    job->seed = (uint64_t)seed;
    if (!read_numbers(given, job))
        return false;
    const char *fault = find_fault(job);
    if (fault == NULL && to != NULL && (job->is_cloud || job->is_map))
        fault = "--to is for meshes; the file's ending says how a cloud or a map is written";
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    else if (!argument_choice(given, "to", &bat_mesh_format_family, &job->write.format))
        return false;
    else if (!job->is_cloud && !job->is_map && !argument_ending(given, &bat_mesh_format_family, (int)job->write.format))
        return false;
    job->quiet = job->quiet || is_standard_output(job->output);
    return fault == NULL;
}

static int draw_mesh(const shape_job *job, const bat_mesh *mesh)
{
    bat_error error;
    bat_mesh_picture_panel panel = {.mesh = mesh, .title = job->kind};
    return bat_mesh_picture_write(output_path(&job->files, "picture"), &panel, 1, NULL, &error) == BAT_OK
               ? EXIT_DONE
               : report_failure(job->picture, &error);
}

static int write_mesh(const shape_job *job, const bat_mesh *mesh, const char *path)
{
    bat_error error;
    if (path == NULL || bat_mesh_write(path, mesh, &job->write, &error) == BAT_OK)
        return EXIT_DONE;
    return report_failure(job->output, &error);
}

static int report_mesh(const shape_job *job, const bat_mesh *mesh)
{
    if (job->json)
        return report_json(json_pack("{s:s, s:I, s:I, s:I}", "shape", job->kind, "seed", (json_int_t)job->seed, "vertices",
                                     (json_int_t)mesh->vertex_count, "faces", (json_int_t)mesh->face_count));
    if (!job->quiet)
        (void)printf("%s: %zu vertices, %zu faces\n", job->kind, mesh->vertex_count, mesh->face_count);
    return EXIT_DONE;
}

static int make_mesh(shape_job *job)
{
    bat_mesh mesh = {0};
    bat_error error;
    int code = EXIT_DONE;
    if (bat_mesh_shape(job->kind, job->vertices, job->seed, &mesh, &error) != BAT_OK)
        code = report_failure(NULL, &error);
    if (code == EXIT_DONE && job->picture != NULL)
        code = draw_mesh(job, &mesh);
    if (code == EXIT_DONE)
        code = write_mesh(job, &mesh, output_path(&job->files, "output"));
    code = outputs_close(&job->files, code);
    if (code == EXIT_DONE && is_standard_output(job->output))
        code = write_mesh(job, &mesh, "-");
    if (code == EXIT_DONE)
        code = report_mesh(job, &mesh);
    bat_mesh_free(&mesh);
    return code;
}

static int draw_cloud(const shape_job *job, const bat_cloud *cloud, const double *parameters)
{
    bat_error error;
    bat_surface_picture_row panel = {.cloud = cloud, .title = job->kind, .parameters = parameters};
    return bat_surface_picture_write(output_path(&job->files, "picture"), &panel, 1, NULL, &error) == BAT_OK
               ? EXIT_DONE
               : report_failure(job->picture, &error);
}

static int write_cloud(const shape_job *job, const bat_cloud *cloud, const char *path)
{
    bat_error error;
    return bat_cloud_write(path, cloud, &error) == BAT_OK ? EXIT_DONE : report_failure(job->output, &error);
}

static int report_cloud(const shape_job *job, const bat_cloud *cloud)
{
    if (job->json)
        return report_json(json_pack("{s:s, s:I, s:I, s:I}", "shape", job->kind, "seed", (json_int_t)job->seed, "points",
                                     (json_int_t)cloud->count, "boundary", (json_int_t)cloud->boundary_count));
    if (!job->quiet)
        (void)printf("%s: %zu points, %zu known to be on the boundary\n", job->kind, cloud->count, cloud->boundary_count);
    return EXIT_DONE;
}

static int make_cloud(shape_job *job)
{
    bat_cloud cloud = {0};
    double *parameters = NULL;
    bat_error error;
    int code = EXIT_DONE;
    bool piped = is_standard_output(job->output);
    if (bat_cloud_shape(job->kind, job->vertices, job->seed, &cloud, &parameters, &error) != BAT_OK)
        code = report_failure(NULL, &error);
    if (code == EXIT_DONE && job->picture != NULL)
        code = draw_cloud(job, &cloud, parameters);
    if (code == EXIT_DONE && job->output != NULL && !piped)
        code = write_cloud(job, &cloud, output_path(&job->files, "output"));
    code = outputs_close(&job->files, code);
    if (code == EXIT_DONE && piped)
        code = write_cloud(job, &cloud, "-");
    if (code == EXIT_DONE)
        code = report_cloud(job, &cloud);
    bat_cloud_free(&cloud);
    free(parameters);
    return code;
}

static int draw_map(const shape_job *job, const bat_curve_set *map)
{
    bat_error error;
    bat_curve_picture_layer *layers = calloc(map->count, sizeof *layers);
    if (layers == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    for (size_t i = 0; i < map->count; i++)
    {
        size_t polygon = 0;
        layers[i] = (bat_curve_picture_layer){.curve = &map->curves[i], .colour = 1};
        if (bat_curve_set_polygon(map, i, &polygon, &layers[i].feature))
            layers[i].polygon = polygon + 1;
    }
    bat_curve_picture_panel panel = {.layers = layers, .layer_count = map->count};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    options.projection = BAT_CURVE_PROJECTION_MAP;
    bat_status status = bat_curve_picture_write(output_path(&job->files, "picture"), &panel, 1, &options, &error);
    free(layers);
    return status == BAT_OK ? EXIT_DONE : report_failure(job->picture, &error);
}

static int write_map(const shape_job *job, const bat_curve_set *map, const char *path)
{
    bat_error error;
    if (path == NULL || bat_curve_write(path, map, NULL, &error) == BAT_OK)
        return EXIT_DONE;
    return report_failure(job->output, &error);
}

static int report_map(const shape_job *job, const bat_curve_set *map)
{
    size_t points = 0;
    for (size_t i = 0; i < map->count; i++)
        points += map->curves[i].count;
    if (job->json)
        return report_json(json_pack("{s:s, s:I, s:I, s:I, s:I}", "shape", job->kind, "seed", (json_int_t)job->seed,
                                     "countries", (json_int_t)job->map.countries, "rings", (json_int_t)map->count, "points",
                                     (json_int_t)points));
    if (!job->quiet)
        (void)printf("%s: %zu countries, %zu rings of %zu points\n", job->kind, job->map.countries, map->count, points);
    return EXIT_DONE;
}

static int make_map(shape_job *job)
{
    bat_curve_set map = {0};
    bat_error error;
    int code = EXIT_DONE;
    if (bat_shape_map(&job->map, &map, &error) != BAT_OK)
        code = report_failure(NULL, &error);
    if (code == EXIT_DONE && job->picture != NULL)
        code = draw_map(job, &map);
    if (code == EXIT_DONE)
        code = write_map(job, &map, output_path(&job->files, "output"));
    code = outputs_close(&job->files, code);
    if (code == EXIT_DONE && is_standard_output(job->output))
        code = write_map(job, &map, "-");
    if (code == EXIT_DONE)
        code = report_map(job, &map);
    bat_curve_set_free(&map);
    return code;
}

int verb_shape(int argc, char **argv)
{
    arguments given;
    int code;
    shape_job job;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (!read_job(&given, &job))
        return EXIT_BAD_USAGE;
    code = outputs_open(&given, &job.files);
    if (code != EXIT_DONE)
        return code;
    return job.is_map ? make_map(&job) : job.is_cloud ? make_cloud(&job) : make_mesh(&job);
}
