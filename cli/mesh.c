#include "verbs.h"

#include "arguments.h"
#include "many.h"
#include "outputs.h"
#include "report.h"
#include "terminal.h"

#include "batten/batten.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_LEVELS = 32
};

static const double DEGREE = 3.14159265358979323846 / 180;

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the refined mesh to OUT (- for standard output)"},
    {"scheme", 0, "NAME",
     "auto (default: catmull-clark for mostly quads or other polygons, loop for meshes with creases, corners or fewer than "
     "100 faces, else learned), learned, loop, catmull-clark, butterfly, midpoint or sqrt3"},
    {"fairness", 0, "F", "learned: 0 for the nearest surface, 1 for the smoothest one that keeps the volume; default 0.25"},
    {"model", 0, "FILE", "learned: a network of your own, a safetensors file; default: the one that comes with batten"},
    {"levels", 0, "K", "how often to refine; default 2"},
    {"then", 0, "NAME", "the scheme of the levels beyond the learned ones: loop, butterfly or midpoint; default loop"},
    {"limit", 0, NULL, "move the vertices onto the limit surface of loop or catmull-clark"},
    {"crease-angle", 0, "DEG", "learned, loop, catmull-clark: keep edges sharp at which faces meet at a greater angle"},
    {"boundary", 0, "RULE", "loop, catmull-clark: edges, corners (sharp) or none; default: as the file says, else edges"},
    {"creasing", 0, "RULE", "the same, for semi-sharp edges: uniform or chaikin; default: as the file says, else uniform"},
    {"texture", 0, "RULE", "the same, what stays linear: all, none, corners, corners-plus1, corners-plus2 or boundaries"},
    {"tolerance", 0, "E", "loop, catmull-clark: refine where needed, until faces are within E of the limit surface"},
    {"max-edge", 0, "L", "the same, until no edge is longer than L"},
    {"picture", 0, "FILE", "draw the mesh before and after, side by side (.png, .svg or .pdf)"},
    {"beside", 0, "NAME", "draw also what this scheme makes of the mesh"},
    {"triangulate", 0, NULL, "cut polygons of IN into triangles"},
    {"repair", 0, NULL, "split edges of more than two faces and vertices of several fans first"},
    {"normals", 0, NULL, "write vertex normals, with --limit those of the limit surface (OBJ, PLY, glTF)"},
    {"max-memory", 0, "GB", "refuse refinements that need more memory; default: what the machine has available"},
    {"from", 0, "FORMAT", "obj, ply, off, stl, gltf or glb; default: by content and ending"},
    {"to", 0, "FORMAT", "the same for OUT"},
    {"threads", 0, "N", "default: all"},
    MANY_OPTIONS,
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const file_option FILES[] = {{"output", FILE_WRITTEN}, {"picture", FILE_DRAWN}, {"model", FILE_READ}, {NULL, 0}};

static const verb_spec SPEC = {
    .usage = "batten mesh IN... [-o OUT] [--scheme NAME] [--levels K] [--picture FILE] [options]",
    .summary = "Refine a mesh by subdivision (`batten list formats`; - for standard input). Quads and other polygons are "
               "refined\n"
               "into quads by catmull-clark. Texture coordinates, values at the vertices, creases, corners, groups and "
               "materials go along as far as\n"
               "OUT's format holds them; notes tell what it does not hold.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = SIZE_MAX,
    .reads_files = true,
    .files = FILES,
};

/// The command line.
typedef struct mesh_job
{
    const arguments *given;
    const char *input, *output, *picture, *model; ///< all but the first may be null
    outputs files;
    bat_mesh_read_options read;
    bat_mesh_write_options write;
    bat_mesh_refine_options refine;
    bat_mesh_scheme beside; ///< where has_beside
    bool has_beside;
    bool json, quiet;
} mesh_job;

/// What becomes of it.
typedef struct mesh_result
{
    bat_mesh coarse, fine;                    ///< triangles; of polygons only for pictures
    bat_polygon_mesh polygons, fine_polygons; ///< where takes_polygons()
    bat_mesh_model *model;                    ///< of --model; null for none
    bat_mesh_repair_report repairs;
    size_t boundary_edges, fallback; ///< boundary edges of the coarse mesh
    double *normals;                 ///< of the limit surface; null for none
    bat_mesh_notes notes;
    bat_mesh_scheme scheme; ///< the one that refined
    const char *reason;     ///< for the scheme, where it was not given; else null
} mesh_result;

static bool read_refinement(const arguments *given, bat_mesh_refine_options *options)
{
    bat_error error;
    long levels;
    double degrees, gigabytes, fairness;
    bat_mesh_rules *rules = &options->rules;
    if (!argument_choice(given, "boundary", &bat_mesh_boundary_family, &rules->boundary) ||
        !argument_choice(given, "creasing", &bat_mesh_creasing_family, &rules->creasing) ||
        !argument_choice(given, "texture", &bat_mesh_linear_family, &rules->linear) ||
        !argument_choice(given, "scheme", &bat_mesh_scheme_family, &options->scheme) ||
        !argument_choice(given, "then", &bat_mesh_scheme_family, &options->then) ||
        !argument_whole(given, "levels", 0, MAX_LEVELS, (long)options->levels, &levels) ||
        !argument_threads(given, &options->threads) || !argument_number(given, "tolerance", 0, &options->tolerance) ||
        !argument_number(given, "max-edge", 0, &options->max_edge) ||
        !argument_number(given, "crease-angle", options->crease_angle / DEGREE, &degrees) ||
        !argument_number(given, "fairness", options->fairness, &fairness))
        return false;
    options->fairness = fairness;
    options->levels = (size_t)levels;
    options->crease_angle = degrees * DEGREE;
    options->limit = argument_flag(given, "limit");
    // These are of the learned scheme.
    if (options->scheme == BAT_MESH_SCHEME_AUTO &&
        (argument(given, "model") != NULL || argument(given, "then") != NULL || argument(given, "fairness") != NULL))
        options->scheme = BAT_MESH_SCHEME_LEARNED;
    if (!argument_number(given, "max-memory", 0, &gigabytes))
        return false;
    if (!(gigabytes >= 0 && gigabytes < 1e9) || (gigabytes == 0 && argument(given, "max-memory") != NULL))
    {
        (void)usage_error(given, "--max-memory takes a number of gigabytes above 0");
        return false;
    }
    options->max_memory = (size_t)(1e9 * gigabytes);
    if (!(degrees >= 0 && degrees <= 180))
    {
        (void)usage_error(given, "--crease-angle takes 0 to 180 degrees");
        return false;
    }
    if (bat_mesh_refine_options_check(options, &error) == BAT_OK)
        return true;
    (void)usage_error(given, "%s", error.text);
    return false;
}

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
static const char *find_fault(const arguments *given, const mesh_job *job)
{
    bool piped = is_standard_output(job->output);
    bool learned = job->refine.scheme == BAT_MESH_SCHEME_LEARNED;
    bool chosen = job->refine.scheme != BAT_MESH_SCHEME_AUTO;
    bat_mesh_scheme last = learned || !chosen ? job->refine.then : job->refine.scheme;
    if (job->output == NULL && job->picture == NULL && !job->json && job->quiet)
        return "there is no output: give -o OUT, --picture FILE or --json";
    if (job->json && (job->quiet || piped))
        return job->quiet ? "--json and --quiet exclude each other" : "--json and -o - both need standard output";
    if (!learned && chosen && (job->model != NULL || argument(given, "then") != NULL || argument(given, "fairness") != NULL))
        return "--model, --then and --fairness need --scheme learned";
    if (is_adaptive(job) && ((chosen && !has_rules(job->refine.scheme)) || argument(given, "levels") != NULL))
        return "--tolerance and --max-edge need --scheme loop or catmull-clark, and exclude --levels";
    if (job->has_beside && job->picture == NULL)
        return "--beside needs --picture FILE";
    bool ruled =
        argument(given, "boundary") != NULL || argument(given, "creasing") != NULL || argument(given, "texture") != NULL;
    if (!has_rules(last) && (job->refine.limit || ruled || argument(given, "crease-angle") != NULL))
        return "--limit, --crease-angle, --boundary, --creasing and --texture need --scheme loop or catmull-clark";
    return NULL;
}

/// False after a message.
static bool read_job(const arguments *given, mesh_job *job)
{
    *job = (mesh_job){.given = given,
                      .input = given->positional[0],
                      .output = argument(given, "output"),
                      .picture = argument(given, "picture"),
                      .model = argument(given, "model"),
                      .read = bat_mesh_read_defaults(),
                      .write = bat_mesh_write_defaults(),
                      .refine = bat_mesh_refine_defaults(),
                      .json = argument_flag(given, "json"),
                      .quiet = argument_flag(given, "quiet")};
    job->has_beside = argument(given, "beside") != NULL;
    if (!argument_choice(given, "beside", &bat_mesh_scheme_family, &job->beside))
        return false;
    job->read.triangulate = argument_flag(given, "triangulate");
    job->read.repair = argument_flag(given, "repair");
    if (!read_refinement(given, &job->refine) ||
        !argument_choice(given, "from", &bat_mesh_format_family, &job->read.format) ||
        !argument_choice(given, "to", &bat_mesh_format_family, &job->write.format))
        return false;
    job->write.threads = job->refine.threads;
    job->write.normals = argument_flag(given, "normals") ? BAT_MESH_NORMALS_ANGLE : BAT_MESH_NORMALS_NONE;
    const char *fault = find_fault(given, job);
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    job->quiet = job->quiet || is_standard_output(job->output);
    return fault == NULL && argument_ending(given, &bat_mesh_format_family, (int)job->write.format);
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
    const char *end = strstr(error->text, "; --triangulate cuts");
    if (end != NULL && !takes_polygons(job))
    {
        (void)snprintf(whole.text, sizeof whole.text,
                       "%.*s; --triangulate cuts it into triangles, and --scheme catmull-clark refines it as it is",
                       (int)(end - error->text), error->text);
        return report_failure(job->input, &whole);
    }
    return report_bad_input(job->given, job->input, error);
}

static int read_coarse(const mesh_job *job, mesh_result *result)
{
    bat_error error;
    bat_mesh_read_options options = job->read;
    bat_mesh_connectivity links;
    options.repairs = &result->repairs;
    options.notes = &result->notes;
    bat_status status = takes_polygons(job) ? bat_polygon_mesh_read(job->input, &options, &result->polygons, &error)
                                            : bat_mesh_read(job->input, &options, &result->coarse, &error);
    if (status == BAT_OK)
        status = takes_polygons(job) ? bat_polygon_mesh_connect(&result->polygons, &links, &error)
                                     : bat_mesh_connect(&result->coarse, &links, &error);
    if (status != BAT_OK)
        return report_bad_mesh(job, &error);
    result->boundary_edges = links.boundary_edge_count;
    result->scheme = job->refine.scheme;
    if (result->scheme == BAT_MESH_SCHEME_AUTO)
    {
        result->scheme = bat_polygon_mesh_scheme_for(&result->polygons);
        result->reason = result->scheme == BAT_MESH_SCHEME_CATMULL_CLARK ? "most faces have more than three corners"
                         : result->scheme == BAT_MESH_SCHEME_LOOP        ? "a cage: few faces, or creases"
                                                                         : "a mesh of many triangles without creases";
        if (is_adaptive(job) && !has_rules(result->scheme))
        {
            result->scheme = BAT_MESH_SCHEME_LOOP;
            result->reason = "adaptive refinement needs a limit surface";
        }
    }
    bat_mesh_connectivity_free(&links);
    return EXIT_DONE;
}

static int refine(const mesh_job *job, mesh_result *result)
{
    bat_error error;
    bat_mesh_refine_options options = job->refine;
    if (job->model != NULL)
    {
        if (bat_mesh_model_read(job->model, &result->model, &error) != BAT_OK)
            return report_failure(job->model, &error);
        options.rule = bat_mesh_model_rule(result->model);
    }
    options.progress = report_progress("refining");
    if (options.limit && argument_flag(job->given, "normals"))
        options.limit_normals = &result->normals;
    bat_status status =
        takes_polygons(job)
            ? bat_polygon_mesh_refine(&result->polygons, &options, &result->fine_polygons, &result->fallback, &error)
            : bat_mesh_refine(&result->coarse, &options, &result->fine, &result->fallback, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : report_bad_input(job->given, job->input, &error);
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
static bat_status refine_beside(const mesh_job *job, const mesh_result *result, bat_mesh *other, bat_error *error)
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
        return bat_mesh_refine(&result->coarse, &options, other, NULL, error);
    bat_polygon_mesh polygons = {0}, fine = {0};
    bat_status status = takes_polygons(job) ? bat_polygon_mesh_copy(&result->polygons, &polygons, error)
                                            : bat_polygon_mesh_of_triangles(&result->coarse, &polygons, error);
    if (status == BAT_OK)
        status = bat_polygon_mesh_refine(&polygons, &options, &fine, NULL, error);
    if (status == BAT_OK)
        status = bat_polygon_mesh_triangulate(&fine, other, error);
    bat_polygon_mesh_free(&polygons);
    bat_polygon_mesh_free(&fine);
    return status;
}

/// Cut polygons into triangles for pictures.
static bat_status cut_polygons(const mesh_job *job, mesh_result *result, bat_error *error)
{
    if (!takes_polygons(job))
        return BAT_OK;
    bat_status status = bat_polygon_mesh_triangulate(&result->polygons, &result->coarse, error);
    return status == BAT_OK ? bat_polygon_mesh_triangulate(&result->fine_polygons, &result->fine, error) : status;
}

static int draw(const mesh_job *job, mesh_result *result)
{
    bat_error error;
    bat_mesh other = {0};
    char title[80], beside_title[80];
    if (cut_polygons(job, result, &error) != BAT_OK)
        return report_bad_input(job->given, job->input, &error);
    if (job->has_beside && refine_beside(job, result, &other, &error) != BAT_OK)
        return report_bad_input(job->given, job->input, &error);
    make_title(job, result->scheme, title);
    make_title(job, job->beside, beside_title);
    bat_mesh_picture_panel panels[3] = {
        {.mesh = &result->coarse,
         .title = "coarse",
         .wires = true,
         .flat = true,
         .polygons = takes_polygons(job) ? &result->polygons : NULL},
        {.mesh = &result->fine, .title = title},
        {.mesh = &other, .title = beside_title},
    };
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.threads = job->refine.threads;
    bat_status status =
        bat_mesh_picture_write(output_path(&job->files, "picture"), panels, job->has_beside ? 3 : 2, &options, &error);
    bat_mesh_free(&other);
    return status == BAT_OK ? EXIT_DONE : report_failure(job->picture, &error);
}

static int write_mesh(const mesh_job *job, mesh_result *result, const char *path)
{
    bat_error error;
    if (path == NULL)
        return EXIT_DONE;
    bat_mesh_write_options options = job->write;
    options.vertex_normals = result->normals;
    options.notes = &result->notes;
    bat_status status = takes_polygons(job) ? bat_polygon_mesh_write(path, &result->fine_polygons, &options, &error)
                                            : bat_mesh_write(path, &result->fine, &options, &error);
    if (status == BAT_OK)
        return EXIT_DONE;
    return report_failure(job->output, &error);
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
static void warn(const mesh_job *job, const mesh_result *result)
{
    bool polygons = takes_polygons(job);
    bat_mesh_rules rules = polygons ? result->polygons.rules : result->coarse.rules;
    bool textured = (polygons ? result->polygons.texture_faces : result->coarse.texture_faces) != NULL;
    bool sharp = polygons ? result->polygons.crease_count + result->polygons.corner_count > 0
                          : result->coarse.crease_count + result->coarse.corner_count > 0;
    if (result->fallback > 0)
        terminal_print(stderr, "batten: %s: the learned rule fell back to a classical one at %zu places\n", job->input,
                       result->fallback);
    bat_mesh_scheme last = result->scheme == BAT_MESH_SCHEME_LEARNED ? job->refine.then : result->scheme;
    if ((rules.boundary != BAT_MESH_BOUNDARY_AUTO || rules.creasing != BAT_MESH_CREASING_AUTO ||
         rules.linear != BAT_MESH_LINEAR_AUTO) &&
        !has_rules(last))
        terminal_print(stderr, "batten: %s: %s does not know the file's rules of boundaries, creases and texture\n",
                       job->input, bat_choice_name(&bat_mesh_scheme_family, (int)last));
    if ((textured || sharp) && is_adaptive(job))
        terminal_print(stderr, "batten: %s: adaptive refinement leaves out texture coordinates, creases and corners\n",
                       job->input);
    if ((textured || sharp) && result->scheme == BAT_MESH_SCHEME_SQRT3)
        terminal_print(stderr, "batten: %s: sqrt3 turns edges over: texture coordinates, creases and corners are left out\n",
                       job->input);
}

static int report(const mesh_job *job, const mesh_result *result)
{
    mesh_size coarse = size_of(&result->coarse, &result->polygons), fine = size_of(&result->fine, &result->fine_polygons);
    if (job->json)
        return report_json(
            json_pack("{s:s, s:s?, s:I, s:o, s:o, s:I, s:I, s:I, s:o}", "scheme",
                      bat_choice_name(&bat_mesh_scheme_family, (int)result->scheme), "reason", result->reason, "levels",
                      (json_int_t)job->refine.levels, "coarse", size_json(coarse), "fine", size_json(fine), "boundary_edges",
                      (json_int_t)result->boundary_edges, "fallback", (json_int_t)result->fallback, "repaired",
                      (json_int_t)bat_mesh_repair_places(&result->repairs), "notes", report_notes_json(&result->notes)));
    if (!argument_flag(job->given, "quiet"))
        report_notes(&result->notes, is_standard_output(job->output) ? stderr : stdout);
    if (job->quiet)
        return EXIT_DONE;
    if (job->read.repair)
        (void)printf("%zu places repaired\n", bat_mesh_repair_places(&result->repairs));
    char levels[32];
    bool told = result->reason != NULL && result->scheme != BAT_MESH_SCHEME_LEARNED;
    (void)printf("%s%s%s%s, %s: %zu vertices, %zu faces -> %zu vertices, %zu faces; %s\n",
                 bat_choice_name(&bat_mesh_scheme_family, (int)result->scheme), told ? " (" : "", told ? result->reason : "",
                 told ? ")" : "", levels_text(job, result->scheme, levels), coarse.vertices, coarse.faces, fine.vertices,
                 fine.faces, result->boundary_edges > 0 ? "with boundary" : "closed");
    return EXIT_DONE;
}

/// Everything that can fail, the files included.
static int make(const mesh_job *job, mesh_result *result)
{
    int code = read_coarse(job, result);
    if (code == EXIT_DONE)
        code = refine(job, result);
    if (code == EXIT_DONE && job->picture != NULL)
        code = draw(job, result);
    return code == EXIT_DONE ? write_mesh(job, result, output_path(&job->files, "output")) : code;
}

static int run(const arguments *given)
{
    int code;
    mesh_job job;
    mesh_result result = {.model = NULL};
    if (!read_job(given, &job))
        return EXIT_BAD_USAGE;
    code = outputs_open(given, &job.files);
    if (code != EXIT_DONE)
        return code;
    code = outputs_close(&job.files, make(&job, &result));
    if (code == EXIT_DONE)
        warn(&job, &result);
    if (code == EXIT_DONE && is_standard_output(job.output))
        code = write_mesh(&job, &result, "-");
    if (code == EXIT_DONE)
        code = report(&job, &result);
    bat_mesh_free(&result.coarse);
    bat_mesh_free(&result.fine);
    free(result.normals);
    bat_mesh_notes_free(&result.notes);
    bat_polygon_mesh_free(&result.polygons);
    bat_polygon_mesh_free(&result.fine_polygons);
    bat_mesh_model_free(result.model);
    return code;
}

int verb_mesh(int argc, char **argv)
{
    return many_run(&SPEC, &bat_mesh_format_family, run, argc, argv);
}
