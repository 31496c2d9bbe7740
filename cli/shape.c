#include "curve.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// What is made.
typedef enum shape_family
{
    OF_MESHES,
    OF_CLOUDS,
    OF_MAPS,
    UNKNOWN
} shape_family;

/// The job of `batten shape`.
typedef struct shape_job
{
    verb_call call;
    shape_family family;
    size_t vertices;
    uint64_t seed;
    bat_mesh_write_options write;
    bat_shape_map_options map;
    bat_mesh mesh;
    bat_cloud cloud;
    double *parameters; ///< of the cloud
    bat_curve_set borders;
} shape_job;

static const option_spec OPTIONS[] = {
    {"output", "OUT", RESULT, COMMON | IS_WRITTEN,
     "write the mesh, cloud or map to OUT (- for standard output; clouds as XYZ, maps as GeoJSON)", NO_FIELD},
    {"to", "FORMAT", RESULT, 0, "the format of a mesh; default: by the file's ending",
     CHOICE(shape_job, write.format, bat_mesh_format_family)},
    {"vertices", "N", METHOD, COMMON,
     "the approximate number of vertices or points, 200 to 1000000; default 10000, of clouds 9600; not for a cage or a map",
     WHOLE(shape_job, vertices, 200, 1000000)},
    {"seed", "S", METHOD, COMMON, "of the random numbers; another seed gives another shape of that kind; default 1",
     WHOLE(shape_job, seed, 0, LONG_MAX)},
    {"countries", "N", METHOD, COMMON, "of a map, 12 to 5000; default 200", WHOLE(shape_job, map.countries, 0, LONG_MAX)},
    {"detail", "D", METHOD, COMMON,
     "of a map: a border between two cells has 2^D edges, 1 to 10; default 2. Of 250 countries, 7 gives 600,000 vertices",
     WHOLE(shape_job, map.detail, 0, LONG_MAX)},
    {"picture", "FILE", PICTURE, COMMON | IS_DRAWN,
     "draw the mesh, the cloud and its parameters, or the map (.png, .svg or .pdf)", NO_FIELD},
    END_OF_OPTIONS,
};

static shape_family family_of(const char *kind)
{
    for (size_t i = 0; i < bat_mesh_shape_count(); i++)
        if (strcmp(bat_mesh_shape_at(i)->name, kind) == 0)
            return OF_MESHES;
    for (const char *const *name = bat_cloud_shape_names(); *name != NULL; name++)
        if (strcmp(*name, kind) == 0)
            return OF_CLOUDS;
    return strcmp(kind, "map") == 0 ? OF_MAPS : UNKNOWN;
}

static bat_status draw_map(const bat_curve_set *map, const char *path, bat_error *error)
{
    bat_curve_picture_layer *layers = calloc(map->count, sizeof *layers);
    *error = (bat_error){.text = "out of memory"};
    if (layers == NULL)
        return BAT_NO_MEMORY;
    for (size_t i = 0; i < map->count; i++)
        layers[i] = (bat_curve_picture_layer){.curve = &map->curves[i], .colour = 1};
    curve_layers_group(map, layers);
    bat_curve_picture_panel panel = {.layers = layers, .layer_count = map->count};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    options.projection = BAT_CURVE_PROJECTION_MAP;
    bat_status status = bat_curve_picture_write(path, &panel, 1, &options, error);
    free(layers);
    return status;
}

static void begin(void *to)
{
    shape_job *job = to;
    job->write = bat_mesh_write_defaults();
    job->map = bat_shape_map_defaults();
    job->seed = 1;
}

static bool check(void *of)
{
    static const char *const of_maps[] = {"countries", "detail", NULL};
    shape_job *job = of;
    const arguments *given = job->call.given;
    job->family = family_of(job->call.input);
    job->map.seed = job->seed;
    bool map = job->family == OF_MAPS, mesh = job->family == OF_MESHES;
    if (job->family == UNKNOWN)
        return usage_refused(given, "unknown kind of shape; `batten list shapes` names the kinds");
    if (!map && argument_first(given, of_maps) != NULL)
        return usage_refused(given, "--%s goes with the shape map", argument_first(given, of_maps));
    if (map && argument(given, "vertices") != NULL)
        return usage_refused(given, "--vertices does not go with the shape map; --countries and --detail do");
    if (!mesh && argument(given, "to") != NULL)
        return usage_refused(given, "--to is for meshes; the file's ending says how a cloud or a map is written");
    return usage_accepts(given, bat_options_check(&bat_shape_map_fields, &job->map, report_error())) &&
           (!mesh || argument_ending(given, &bat_mesh_format_family, (int)job->write.format));
}

static int make(void *of)
{
    shape_job *job = of;
    const char *kind = job->call.input;
    size_t count = job->vertices > 0 ? job->vertices : job->family == OF_MESHES ? 10000 : 9600;
    bat_status status = job->family == OF_MESHES ? bat_mesh_shape(kind, count, job->seed, &job->mesh, report_error())
                        : job->family == OF_CLOUDS
                            ? bat_cloud_shape(kind, count, job->seed, &job->cloud, &job->parameters, report_error())
                            : bat_shape_map(&job->map, &job->borders, report_error());
    int code = report_status(NULL, NULL, status);
    if (code != EXIT_DONE || job->call.picture == NULL)
        return code;
    const char *path = output_path(&job->call.files, "picture");
    bat_mesh_picture_panel mesh = {.mesh = &job->mesh, .title = kind};
    bat_surface_picture_row cloud = {.cloud = &job->cloud, .title = kind, .parameters = job->parameters};
    status = job->family == OF_MESHES   ? bat_mesh_picture_write(path, &mesh, 1, NULL, report_error())
             : job->family == OF_CLOUDS ? bat_surface_picture_write(path, &cloud, 1, NULL, report_error())
                                        : draw_map(&job->borders, path, report_error());
    return report_status(NULL, job->call.picture, status);
}

static int write(void *of, const char *path)
{
    const shape_job *job = of;
    return report_status(NULL, job->call.output,
                         job->family == OF_MESHES   ? bat_mesh_write(path, &job->mesh, &job->write, report_error())
                         : job->family == OF_CLOUDS ? bat_cloud_write(path, &job->cloud, report_error())
                                                    : bat_curve_write(path, &job->borders, NULL, report_error()));
}

static int report(void *of)
{
    const shape_job *job = of;
    const verb_call *call = &job->call;
    if (call->quiet)
        return EXIT_DONE;
    if (job->family == OF_MESHES)
        return report_print(call->json, "{shape}: {vertices} vertices, {faces} faces\n", "shape:s seed:z vertices:z faces:z",
                            call->input, (size_t)job->seed, job->mesh.vertex_count, job->mesh.face_count);
    if (job->family == OF_CLOUDS)
        return report_print(call->json, "{shape}: {points} points, {boundary} known to be on the boundary\n",
                            "shape:s seed:z points:z boundary:z", call->input, (size_t)job->seed, job->cloud.count,
                            job->cloud.boundary_count);
    size_t points = 0;
    for (size_t i = 0; i < job->borders.count; i++)
        points += job->borders.curves[i].count;
    return report_print(call->json, "{shape}: {countries} countries, {rings} rings of {points} points\n",
                        "shape:s seed:z countries:z rings:z points:z", call->input, (size_t)job->seed,
                        (size_t)job->map.countries, job->borders.count, points);
}

static void end(void *of)
{
    shape_job *job = of;
    bat_mesh_free(&job->mesh);
    bat_cloud_free(&job->cloud);
    free(job->parameters);
    bat_curve_set_free(&job->borders);
}

const verb VERB_SHAPE = {
    .name = "shape",
    .arguments = "KIND [-o OUT] [--vertices N] [--seed S] [--picture FILE] [options]",
    .summary = "make a test shape: creatures, machine parts, knots, a cage, clouds of points",
    .about =
        "Make a triangle mesh, a cloud of points or a map for tests and trainings; `batten list shapes` names the kinds. "
        "The same kind, numbers and seed give the same shape.",
    .example = "batten shape creature -o creature.ply --vertices 5000",
    .options = {{OPTIONS, 0}, {REPORT_OPTIONS, 0}},
    .positional = {1, 1},
    .list = "shapes",
    .job_size = sizeof(shape_job),
    .calls = {begin, check, make, write, report, end},
};
