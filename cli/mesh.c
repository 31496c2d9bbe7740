#include "mesh_files.h"
#include "report.h"
#include "terminal.h"

#include "batten/batten.h"
#include "batten/research/networks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_LEVELS = 32
};

/// The job of `batten mesh`.
typedef struct mesh_job
{
    verb_call call;
    mesh_files files;
    const char *model_file; ///< null for none
    bat_mesh_refine_options refine;
    bat_mesh_scheme beside; ///< where has_beside
    bool has_beside;
    double gigabytes;
    bat_mesh coarse, fine;                    ///< triangles; of polygons only for pictures
    bat_polygon_mesh polygons, fine_polygons; ///< where takes_polygons()
    bat_mesh_model *model;                    ///< of --model; null for none
    size_t boundary_edges, fallback;          ///< boundary edges of the coarse mesh
    double *normals;                          ///< of the limit surface; null for none
    bat_mesh_scheme scheme;                   ///< the one that refined
    const char *reason;                       ///< for the scheme, where it was not given; else null
} mesh_job;

static const option_spec OPTIONS[] = {
    {"scheme", "NAME", METHOD, COMMON,
     "{}; default auto: catmull-clark for mostly quads or other polygons, loop for meshes with creases, corners or fewer "
     "than 100 faces, else learned",
     CHOICE(mesh_job, refine.scheme, bat_mesh_scheme_family)},
    {"levels", "K", METHOD, COMMON, "how often to refine; default 2", WHOLE(mesh_job, refine.levels, 0, MAX_LEVELS)},
    {"tolerance", "E", METHOD, COMMON,
     "loop, catmull-clark: refine where needed, until faces are within E of the limit surface",
     POSITIVE(mesh_job, refine.tolerance)},
    {"max-edge", "L", METHOD, 0, "the same, until no edge is longer than L", POSITIVE(mesh_job, refine.max_edge)},
    {"crease-angle", "DEG", METHOD, COMMON,
     "learned, loop, catmull-clark: keep edges sharp at which faces meet at a greater angle",
     DEGREES(mesh_job, refine.crease_angle, 0)},
    {"limit", NULL, METHOD, COMMON, "move the vertices onto the limit surface of loop or catmull-clark",
     FLAG(mesh_job, refine.limit)},
    {"fairness", "F", METHOD, 0,
     "learned: 0 for the nearest surface, 1 for the smoothest one that keeps the volume; default 0.25",
     NUMBER(mesh_job, refine.fairness)},
    {"model", "FILE", METHOD, IS_READ,
     "learned: a network of your own, a safetensors file; default: the one that comes with batten",
     TEXT(mesh_job, model_file)},
    {"then", "NAME", METHOD, 0,
     "the scheme of the levels beyond the learned ones: loop, butterfly or midpoint; default loop",
     CHOICE(mesh_job, refine.then, bat_mesh_scheme_family)},
    {"boundary", "RULE", METHOD, 0, "loop, catmull-clark: {}; default auto, as the file says, else edges",
     CHOICE(mesh_job, refine.rules.boundary, bat_mesh_boundary_family)},
    {"creasing", "RULE", METHOD, 0, "the same, for semi-sharp edges: {}; default auto, as the file says, else uniform",
     CHOICE(mesh_job, refine.rules.creasing, bat_mesh_creasing_family)},
    {"texture", "RULE", METHOD, 0, "the same, what stays linear: {}; default auto, as the file says, else all",
     CHOICE(mesh_job, refine.rules.linear, bat_mesh_linear_family)},
    {"max-memory", "GB", CALL, 0, "refuse refinements that need more memory; default: what the machine has available",
     POSITIVE(mesh_job, gigabytes)},
    {"picture", "FILE", PICTURE, COMMON | IS_DRAWN, "draw the mesh before and after, side by side (.png, .svg or .pdf)",
     NO_FIELD},
    {"beside", "NAME", PICTURE, 0, "draw also what this scheme makes of the mesh",
     CHOICE(mesh_job, beside, bat_mesh_scheme_family)},
    END_OF_OPTIONS,
};

/// Whether a scheme has limits, creases, and rules of boundaries and texture.
static bool has_rules(bat_mesh_scheme scheme)
{
    return scheme == BAT_MESH_SCHEME_LOOP || scheme == BAT_MESH_SCHEME_CATMULL_CLARK;
}

static bool is_adaptive(const mesh_job *job)
{
    return job->refine.tolerance > 0 || job->refine.max_edge > 0;
}

/// What options contradict each other; null for nothing.
static const char *find_fault(const mesh_job *job)
{
    static const char *const of_learned[] = {"model", "then", "fairness", NULL}, *const of_rules[] = {
                                                                                     "boundary",     "creasing", "texture",
                                                                                     "crease-angle", "limit",    NULL};
    const arguments *given = job->call.given;
    bool learned = job->refine.scheme == BAT_MESH_SCHEME_LEARNED;
    bool chosen = job->refine.scheme != BAT_MESH_SCHEME_AUTO;
    bat_mesh_scheme last = learned || !chosen ? job->refine.then : job->refine.scheme;
    if (!learned && chosen && argument_first(given, of_learned) != NULL)
        return "--model, --then and --fairness need --scheme learned";
    if (is_adaptive(job) && ((chosen && !has_rules(job->refine.scheme)) || argument(given, "levels") != NULL))
        return "--tolerance and --max-edge need --scheme loop or catmull-clark, and exclude --levels";
    if (job->has_beside && job->call.picture == NULL)
        return "--beside needs --picture FILE";
    if (!has_rules(last) && argument_first(given, of_rules) != NULL)
        return "--limit, --crease-angle, --boundary, --creasing and --texture need --scheme loop or catmull-clark";
    return NULL;
}

static void begin(void *to)
{
    mesh_job *job = to;
    mesh_files_begin(&job->files);
    job->refine = bat_mesh_refine_defaults();
}

static bool check(void *of)
{
    mesh_job *job = of;
    const arguments *given = job->call.given;
    static const char *const of_learned[] = {"model", "then", "fairness", NULL};
    bat_error error;
    job->has_beside = argument(given, "beside") != NULL;
    job->refine.threads = job->call.threads;
    if (job->refine.scheme == BAT_MESH_SCHEME_AUTO && argument_first(given, of_learned) != NULL)
        job->refine.scheme = BAT_MESH_SCHEME_LEARNED;
    if (job->gigabytes > 1e9)
        return argument_refused(given, "max-memory", "above 0 and at most 1e9 gigabytes");
    job->refine.max_memory = (size_t)(1e9 * job->gigabytes);
    if (!usage_accepts(given, bat_options_check(&bat_mesh_refine_fields, &job->refine, &error), &error))
        return false;
    const char *fault = find_fault(job);
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    return fault == NULL && mesh_files_check(&job->files, &job->call);
}

/// Whether the input is read as a mesh of polygons.
static bool takes_polygons(const mesh_job *job)
{
    return job->refine.scheme == BAT_MESH_SCHEME_CATMULL_CLARK || job->refine.scheme == BAT_MESH_SCHEME_AUTO;
}

/// Report a mesh that cannot be read or refined. Where it has polygons, catmull-clark is a way out, too.
static int report_bad_mesh(const mesh_job *job, const bat_error *error)
{
    bat_error whole = *error;
    size_t used = strlen(whole.remedy_effect);
    if (strcmp(error->remedy, "triangulate") == 0 && !takes_polygons(job))
        (void)snprintf(whole.remedy_effect + used, sizeof whole.remedy_effect - used,
                       ", and --scheme catmull-clark refines it as it is");
    return report_bad_input(job->call.given, job->call.input, &whole);
}

static int read_coarse(mesh_job *job)
{
    bat_error error;
    bat_mesh_connectivity links;
    bat_status status = takes_polygons(job)
                            ? bat_polygon_mesh_read(job->call.input, &job->files.read, &job->polygons, &error)
                            : bat_mesh_read(job->call.input, &job->files.read, &job->coarse, &error);
    if (status == BAT_OK)
        status = takes_polygons(job) ? bat_polygon_mesh_connect(&job->polygons, &links, &error)
                                     : bat_mesh_connect(&job->coarse, &links, &error);
    if (status != BAT_OK)
        return report_bad_mesh(job, &error);
    job->boundary_edges = links.boundary_edge_count;
    job->scheme = job->refine.scheme;
    if (job->scheme == BAT_MESH_SCHEME_AUTO)
    {
        job->scheme = bat_polygon_mesh_scheme_for(&job->polygons);
        job->reason = job->scheme == BAT_MESH_SCHEME_CATMULL_CLARK ? "most faces have more than three corners"
                      : job->scheme == BAT_MESH_SCHEME_LOOP        ? "a cage: few faces, or creases"
                                                                   : "a mesh of many triangles without creases";
        if (is_adaptive(job) && !has_rules(job->scheme))
        {
            job->scheme = BAT_MESH_SCHEME_LOOP;
            job->reason = "adaptive refinement needs a limit surface";
        }
    }
    bat_mesh_connectivity_free(&links);
    return EXIT_DONE;
}

static int refine(mesh_job *job)
{
    bat_error error;
    bat_mesh_refine_options options = job->refine;
    if (job->model_file != NULL)
    {
        if (bat_mesh_model_read_published(job->model_file, &job->model, &error) != BAT_OK)
            return report_failure(job->model_file, &error);
        options.rule = bat_mesh_model_rule(job->model);
    }
    options.progress = report_progress("refining");
    if (options.limit && job->files.normals)
        options.limit_normals = &job->normals;
    bat_status status = takes_polygons(job)
                            ? bat_polygon_mesh_refine(&job->polygons, &options, &job->fine_polygons, &job->fallback, &error)
                            : bat_mesh_refine(&job->coarse, &options, &job->fine, &job->fallback, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : report_bad_input(job->call.given, job->call.input, &error);
}

/// "adaptive", or the number of levels.
static const char *levels_text(const mesh_job *job, bat_mesh_scheme scheme, char text[32])
{
    size_t levels = job->refine.levels;
    if (is_adaptive(job) && has_rules(scheme))
        return "adaptive";
    (void)snprintf(text, 32, "%zu level%s", levels, levels == 1 ? "" : "s");
    return text;
}

static void make_title(const mesh_job *job, bat_mesh_scheme scheme, char title[80])
{
    char levels[32];
    (void)snprintf(title, 80, "%s, %s", bat_choice_name(&bat_mesh_scheme_family, (int)scheme),
                   levels_text(job, scheme, levels));
}

/// Refine by the scheme of --beside, which has no limit, creases by angles and rules unless it is Loop's or Catmull and
/// Clark's.
static bat_status refine_beside(const mesh_job *job, bat_mesh *other, bat_error *error)
{
    bat_mesh_refine_options options = job->refine;
    options.scheme = job->beside;
    if (!has_rules(options.scheme))
    {
        options.tolerance = options.max_edge = 0;
        options.limit = false;
        options.crease_angle = 0;
        options.rules = (bat_mesh_rules){0};
    }
    if (options.scheme != BAT_MESH_SCHEME_CATMULL_CLARK)
        return bat_mesh_refine(&job->coarse, &options, other, NULL, error);
    bat_polygon_mesh polygons = {0}, fine = {0};
    bat_status status = takes_polygons(job) ? bat_polygon_mesh_copy(&job->polygons, &polygons, error)
                                            : bat_polygon_mesh_of_triangles(&job->coarse, &polygons, error);
    if (status == BAT_OK)
        status = bat_polygon_mesh_refine(&polygons, &options, &fine, NULL, error);
    if (status == BAT_OK)
        status = bat_polygon_mesh_triangulate(&fine, other, error);
    bat_polygon_mesh_free(&polygons);
    bat_polygon_mesh_free(&fine);
    return status;
}

/// Cut polygons into triangles for pictures.
static bat_status cut_polygons(mesh_job *job, bat_error *error)
{
    if (!takes_polygons(job))
        return BAT_OK;
    bat_status status = bat_polygon_mesh_triangulate(&job->polygons, &job->coarse, error);
    return status == BAT_OK ? bat_polygon_mesh_triangulate(&job->fine_polygons, &job->fine, error) : status;
}

static int draw(mesh_job *job)
{
    bat_error error;
    bat_mesh other = {0};
    char title[80], beside_title[80];
    if (cut_polygons(job, &error) != BAT_OK)
        return report_bad_input(job->call.given, job->call.input, &error);
    if (job->has_beside && refine_beside(job, &other, &error) != BAT_OK)
        return report_bad_input(job->call.given, job->call.input, &error);
    make_title(job, job->scheme, title);
    make_title(job, job->beside, beside_title);
    bat_mesh_picture_panel panels[3] = {
        {.mesh = &job->coarse,
         .title = "coarse",
         .wires = true,
         .flat = true,
         .polygons = takes_polygons(job) ? &job->polygons : NULL},
        {.mesh = &job->fine, .title = title},
        {.mesh = &other, .title = beside_title},
    };
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.threads = job->refine.threads;
    bat_status status =
        bat_mesh_picture_write(output_path(&job->call.files, "picture"), panels, job->has_beside ? 3 : 2, &options, &error);
    bat_mesh_free(&other);
    return status == BAT_OK ? EXIT_DONE : report_failure(job->call.picture, &error);
}

static int write_mesh(void *of, const char *path)
{
    mesh_job *job = of;
    bat_error error;
    bat_mesh_write_options options = job->files.write;
    options.vertex_normals = job->normals;
    bat_status status = takes_polygons(job) ? bat_polygon_mesh_write(path, &job->fine_polygons, &options, &error)
                                            : bat_mesh_write(path, &job->fine, &options, &error);
    if (status == BAT_OK)
        return EXIT_DONE;
    return report_bad_input(job->call.given, job->call.output, &error);
}

/// The numbers of vertices and faces of a mesh.
typedef struct mesh_size
{
    size_t vertices, faces;
} mesh_size;

static mesh_size size_of(const bat_mesh *mesh, const bat_polygon_mesh *polygons)
{
    if (polygons->face_count > 0)
        return (mesh_size){polygons->vertex_count, polygons->face_count};
    return (mesh_size){mesh->vertex_count, mesh->face_count};
}

static json_t *size_json(mesh_size size)
{
    return json_pack("{s:I, s:I}", "vertices", (json_int_t)size.vertices, "faces", (json_int_t)size.faces);
}

/// Warn of what the result lacks, on standard error.
static void warn(const mesh_job *job)
{
    bool polygons = takes_polygons(job);
    bat_mesh_rules rules = polygons ? job->polygons.rules : job->coarse.rules;
    bool textured = (polygons ? job->polygons.texture_faces : job->coarse.texture_faces) != NULL;
    bool sharp = polygons ? job->polygons.crease_count + job->polygons.corner_count > 0
                          : job->coarse.crease_count + job->coarse.corner_count > 0;
    if (job->fallback > 0)
        terminal_print(stderr, "batten: %s: the learned rule fell back to a classical one at %zu places\n", job->call.input,
                       job->fallback);
    bat_mesh_scheme last = job->scheme == BAT_MESH_SCHEME_LEARNED ? job->refine.then : job->scheme;
    if ((rules.boundary != BAT_MESH_BOUNDARY_AUTO || rules.creasing != BAT_MESH_CREASING_AUTO ||
         rules.linear != BAT_MESH_LINEAR_AUTO) &&
        !has_rules(last))
        terminal_print(stderr, "batten: %s: %s does not know the file's rules of boundaries, creases and texture\n",
                       job->call.input, bat_choice_name(&bat_mesh_scheme_family, (int)last));
    if ((textured || sharp) && is_adaptive(job))
        terminal_print(stderr, "batten: %s: adaptive refinement leaves out texture coordinates, creases and corners\n",
                       job->call.input);
    if ((textured || sharp) && job->scheme == BAT_MESH_SCHEME_SQRT3)
        terminal_print(stderr, "batten: %s: sqrt3 turns edges over: texture coordinates, creases and corners are left out\n",
                       job->call.input);
}

static int report(void *of)
{
    mesh_job *job = of;
    warn(job);
    mesh_size coarse = size_of(&job->coarse, &job->polygons), fine = size_of(&job->fine, &job->fine_polygons);
    if (job->call.json)
        return report_json(json_pack(
            "{s:s, s:s?, s:I, s:o, s:o, s:I, s:I, s:I, s:o}", "scheme",
            bat_choice_name(&bat_mesh_scheme_family, (int)job->scheme), "reason", job->reason, "levels",
            (json_int_t)job->refine.levels, "coarse", size_json(coarse), "fine", size_json(fine), "boundary_edges",
            (json_int_t)job->boundary_edges, "fallback", (json_int_t)job->fallback, "repaired",
            (json_int_t)bat_mesh_repair_places(&job->files.repairs), "notes", report_notes_json(&job->files.notes)));
    mesh_files_report(&job->files, &job->call);
    if (job->call.quiet)
        return EXIT_DONE;
    char levels[32];
    bool told = job->reason != NULL && job->scheme != BAT_MESH_SCHEME_LEARNED;
    (void)printf("%s%s%s%s, %s: %zu vertices, %zu faces -> %zu vertices, %zu faces; %s\n",
                 bat_choice_name(&bat_mesh_scheme_family, (int)job->scheme), told ? " (" : "", told ? job->reason : "",
                 told ? ")" : "", levels_text(job, job->scheme, levels), coarse.vertices, coarse.faces, fine.vertices,
                 fine.faces, job->boundary_edges > 0 ? "with boundary" : "closed");
    return EXIT_DONE;
}

static int make(void *of)
{
    mesh_job *job = of;
    int code = read_coarse(job);
    if (code == EXIT_DONE)
        code = refine(job);
    return code == EXIT_DONE && job->call.picture != NULL ? draw(job) : code;
}

static void end(void *of)
{
    mesh_job *job = of;
    bat_mesh_free(&job->coarse);
    bat_mesh_free(&job->fine);
    free(job->normals);
    bat_mesh_notes_free(&job->files.notes);
    bat_polygon_mesh_free(&job->polygons);
    bat_polygon_mesh_free(&job->fine_polygons);
    bat_mesh_model_free(job->model);
}

const verb VERB_MESH = {
    .name = "mesh",
    .arguments = "IN... [-o OUT] [--scheme NAME] [--levels K] [--picture FILE] [options]",
    .summary = "refine a triangle mesh, to a file and a picture",
    .about =
        "Refine a mesh by subdivision (see `batten list formats`; - for standard input). Quads and other polygons are "
        "refined into quads by catmull-clark. Texture coordinates, values at the vertices, creases, corners, groups and "
        "materials go along as far as OUT's format holds them; notes tell what it does not hold.",
    .example = "batten mesh cage.obj -o smooth.obj --levels 3 --picture smooth.png",
    .options = (const option_table[]){{OUTPUT_OPTION, 0},
                                      {OPTIONS, 0},
                                      {MESH_FILE_OPTIONS, offsetof(mesh_job, files)},
                                      {REPORT_OPTIONS, 0},
                                      {THREADS_OPTION, 0},
                                      {MANY_OPTIONS, 0},
                                      {NULL, 0}},
    .min_positional = 1,
    .max_positional = SIZE_MAX,
    .reads_files = true,
    .formats = &bat_mesh_format_family,
    .job_size = sizeof(mesh_job),
    .begin = begin,
    .check = check,
    .make = make,
    .write = write_mesh,
    .report = report,
    .end = end,
};
