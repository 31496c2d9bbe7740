#include "report.h"
#include "verb.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct shape_family;

/// The job of `batten shape`.
typedef struct shape_job
{
    verb_call call;
    const struct shape_family *family;
    size_t vertices;
    uint64_t seed;
    bat_mesh_write_options write;
    bat_shape_map_options map;
    bat_mesh mesh;
    bat_cloud cloud;
    double *parameters; ///< of the cloud
    bat_curve_set borders;
} shape_job;

/// Meshes, clouds of points, or maps.
typedef struct shape_family
{
    bool (*has)(const char *kind);
    bat_status (*make)(shape_job *job, bat_error *error);
    bat_status (*draw)(const shape_job *job, const char *path, bat_error *error);
    bat_status (*write)(const shape_job *job, const char *path, bat_error *error);
    json_t *(*describe)(const shape_job *job);
    void (*print)(const shape_job *job);
} shape_family;

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

// Meshes

static bool is_mesh(const char *kind)
{
    for (size_t i = 0; i < bat_mesh_shape_count(); i++)
        if (strcmp(bat_mesh_shape_at(i)->name, kind) == 0)
            return true;
    return false;
}

static bat_status make_mesh(shape_job *job, bat_error *error)
{
    return bat_mesh_shape(job->call.input, job->vertices > 0 ? job->vertices : 10000, job->seed, &job->mesh, error);
}

static bat_status draw_mesh(const shape_job *job, const char *path, bat_error *error)
{
    bat_mesh_picture_panel panel = {.mesh = &job->mesh, .title = job->call.input};
    return bat_mesh_picture_write(path, &panel, 1, NULL, error);
}

static bat_status write_mesh(const shape_job *job, const char *path, bat_error *error)
{
    return bat_mesh_write(path, &job->mesh, &job->write, error);
}

static json_t *describe_mesh(const shape_job *job)
{
    return json_pack("{s:I, s:I}", "vertices", (json_int_t)job->mesh.vertex_count, "faces",
                     (json_int_t)job->mesh.face_count);
}

static void print_mesh(const shape_job *job)
{
    (void)printf("%s: %zu vertices, %zu faces\n", job->call.input, job->mesh.vertex_count, job->mesh.face_count);
}

// Clouds of points

static bool is_cloud(const char *kind)
{
    for (const char *const *name = bat_cloud_shape_names(); *name != NULL; name++)
        if (strcmp(*name, kind) == 0)
            return true;
    return false;
}

static bat_status make_cloud(shape_job *job, bat_error *error)
{
    return bat_cloud_shape(job->call.input, job->vertices > 0 ? job->vertices : 9600, job->seed, &job->cloud,
                           &job->parameters, error);
}

static bat_status draw_cloud(const shape_job *job, const char *path, bat_error *error)
{
    bat_surface_picture_row panel = {.cloud = &job->cloud, .title = job->call.input, .parameters = job->parameters};
    return bat_surface_picture_write(path, &panel, 1, NULL, error);
}

static bat_status write_cloud(const shape_job *job, const char *path, bat_error *error)
{
    return bat_cloud_write(path, &job->cloud, error);
}

static json_t *describe_cloud(const shape_job *job)
{
    return json_pack("{s:I, s:I}", "points", (json_int_t)job->cloud.count, "boundary",
                     (json_int_t)job->cloud.boundary_count);
}

static void print_cloud(const shape_job *job)
{
    (void)printf("%s: %zu points, %zu known to be on the boundary\n", job->call.input, job->cloud.count,
                 job->cloud.boundary_count);
}

// Maps

static bool is_map(const char *kind)
{
    return strcmp(kind, "map") == 0;
}

static bat_status make_map(shape_job *job, bat_error *error)
{
    return bat_shape_map(&job->map, &job->borders, error);
}

static bat_status draw_map(const shape_job *job, const char *path, bat_error *error)
{
    const bat_curve_set *map = &job->borders;
    bat_curve_picture_layer *layers = calloc(map->count, sizeof *layers);
    *error = (bat_error){.text = "out of memory"};
    if (layers == NULL)
        return BAT_NO_MEMORY;
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
    bat_status status = bat_curve_picture_write(path, &panel, 1, &options, error);
    free(layers);
    return status;
}

static bat_status write_map(const shape_job *job, const char *path, bat_error *error)
{
    return bat_curve_write(path, &job->borders, NULL, error);
}

static size_t count_points(const bat_curve_set *map)
{
    size_t points = 0;
    for (size_t i = 0; i < map->count; i++)
        points += map->curves[i].count;
    return points;
}

static json_t *describe_map(const shape_job *job)
{
    return json_pack("{s:I, s:I, s:I}", "countries", (json_int_t)job->map.countries, "rings", (json_int_t)job->borders.count,
                     "points", (json_int_t)count_points(&job->borders));
}

static void print_map(const shape_job *job)
{
    (void)printf("%s: %zu countries, %zu rings of %zu points\n", job->call.input, job->map.countries, job->borders.count,
                 count_points(&job->borders));
}

// The verb

static const shape_family FAMILIES[] = {
    {is_mesh, make_mesh, draw_mesh, write_mesh, describe_mesh, print_mesh},
    {is_cloud, make_cloud, draw_cloud, write_cloud, describe_cloud, print_cloud},
    {is_map, make_map, draw_map, write_map, describe_map, print_map},
};

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
    bat_error error;
    for (size_t i = 0; i < sizeof FAMILIES / sizeof *FAMILIES && job->family == NULL; i++)
        if (FAMILIES[i].has(job->call.input))
            job->family = &FAMILIES[i];
    job->map.seed = job->seed;
    bool map = is_map(job->call.input), mesh = job->family == FAMILIES;
    if (job->family == NULL)
        (void)usage_error(given, "unknown kind of shape; `batten list shapes` names the kinds");
    else if (!map && argument_first(given, of_maps) != NULL)
        (void)usage_error(given, "--%s goes with the shape map", argument_first(given, of_maps));
    else if (map && argument(given, "vertices") != NULL)
        (void)usage_error(given, "--vertices does not go with the shape map; --countries and --detail do");
    else if (!mesh && argument(given, "to") != NULL)
        (void)usage_error(given, "--to is for meshes; the file's ending says how a cloud or a map is written");
    else
        return usage_accepts(given, bat_options_check(&bat_shape_map_fields, &job->map, &error), &error) &&
               (!mesh || argument_ending(given, &bat_mesh_format_family, (int)job->write.format));
    return false;
}

static int make(void *of)
{
    shape_job *job = of;
    bat_error error;
    if (job->family->make(job, &error) != BAT_OK)
        return report_failure(NULL, &error);
    if (job->call.picture != NULL && job->family->draw(job, output_path(&job->call.files, "picture"), &error) != BAT_OK)
        return report_failure(job->call.picture, &error);
    return EXIT_DONE;
}

static int write(void *of, const char *path)
{
    shape_job *job = of;
    bat_error error;
    return job->family->write(job, path, &error) == BAT_OK ? EXIT_DONE : report_failure(job->call.output, &error);
}

static int report(void *of)
{
    shape_job *job = of;
    if (job->call.json)
    {
        json_t *object = json_pack("{s:s, s:I}", "shape", job->call.input, "seed", (json_int_t)job->seed),
               *numbers = job->family->describe(job);
        (void)json_object_update(object, numbers);
        json_decref(numbers);
        return report_json(object);
    }
    if (!job->call.quiet)
        job->family->print(job);
    return EXIT_DONE;
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
    .options = (const option_table[]){{OPTIONS, 0}, {REPORT_OPTIONS, 0}, {NULL, 0}},
    .min_positional = 1,
    .max_positional = 1,
    .list = "shapes",
    .job_size = sizeof(shape_job),
    .begin = begin,
    .check = check,
    .make = make,
    .write = write,
    .report = report,
    .end = end,
};
