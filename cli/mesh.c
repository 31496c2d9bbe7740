#include "paint.h"
#include "verb.h"

#include "batten/batten.h"
#include "batten/research/networks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int MAX_LEVELS = 32;

#define MAX_LODS 16

/// The job of `batten mesh` and `batten decimate`, which make a mesh of a mesh.
typedef struct mesh_job
{
    verb_call call;
    bat_mesh_read_options read;
    bat_mesh_write_options write;
    bool normals; ///< of vertices, are written
    bat_mesh_repair_report repairs;
    bat_mesh_notes notes;
    bat_mesh given, made;

    // Of `batten mesh`.
    const char *model_file; ///< null for none
    bat_mesh_refine_options refine;
    bat_mesh_scheme beside; ///< where has_beside
    bool has_beside;
    bat_mesh_model *model;           ///< of --model; null for none
    size_t boundary_edges, fallback; ///< boundary edges of the given mesh
    double *limit_normals;           ///< of the limit surface; null for none
    bat_mesh_scheme scheme;          ///< the one that refined
    const char *reason;              ///< for the scheme, where it was not given; else null
    bool solid;                      ///< refined by the learned scheme, or adaptively

    // Of `batten decimate`.
    bat_mesh_decimate_options decimate;
    const char *map_file; ///< null where not wanted
    bat_mesh_map *map;    ///< null when none was needed
    double distance;      ///< with --tolerance: the proven bound on the distance of the two surfaces
    bool transfer;
    const char *bake_text;     ///< null for none
    char *bake_parts;          ///< a copy, cut
    const char *bake_files[3]; ///< of BAKED; null for none
    bat_mesh_bake_options bake;
    bat_mesh_baked baked;
    mesh_paints *paints;   ///< the colours of materials of IN; null for none
    const char *lods_text; ///< null for none
    double lod_shares[MAX_LODS], lod_distances[MAX_LODS];
    bat_mesh lods[MAX_LODS];
    size_t lod_count;
} mesh_job;

static const option_spec FILE_OPTIONS[] = {
    {"triangulate", NULL, INPUT, COMMON, "cut polygons of IN into triangles", FLAG(mesh_job, read.triangulate)},
    {"repair", NULL, INPUT, COMMON,
     "join equal vertices, drop what is degenerate or not finite, orient the faces, split what is no manifold",
     FLAG(mesh_job, read.repair)},
    {"fill-holes", "N", INPUT, COMMON, "repair, and close holes of up to N edges",
     WHOLE(mesh_job, read.fill_holes, 1, BAT_MESH_MAX_HOLE)},
    {"strict", NULL, INPUT, 0, "refuse a mesh that needs a repair; default: do what is harmless, and say so",
     FLAG(mesh_job, read.strict)},
    {"weld", "D", INPUT, 0,
     "join vertices of IN within the distance D; 0: none; default: 1e-7 of the diagonal for STL, triangles with vertices "
     "of their own and with --repair",
     NUMBER(mesh_job, read.weld)},
    {"max-points", "N", INPUT, 0,
     "the most points that compression and copies in IN may make; default: 2^20, and one for each byte",
     WHOLE(mesh_job, read.limits.points, 1, 1e12)},
    {"from", "FORMAT", INPUT, 0, "the format of IN, see `batten list formats`; default: by content and ending",
     CHOICE(mesh_job, read.format, bat_mesh_format_family)},
    {"normals", NULL, RESULT, 0,
     "write vertex normals (OBJ, PLY, glTF), with `batten mesh --limit` those of the limit surface",
     FLAG(mesh_job, normals)},
    {"to", "FORMAT", RESULT, 0, "the format of OUT; default: by its ending",
     CHOICE(mesh_job, write.format, bat_mesh_format_family)},
    END_OF_OPTIONS,
};

// What the two verbs share

static void begin(void *to)
{
    mesh_job *job = to;
    job->read = bat_mesh_read_defaults();
    job->write = bat_mesh_write_defaults();
    job->read.repairs = &job->repairs;
    job->read.notes = job->write.notes = &job->notes;
    job->refine = bat_mesh_refine_defaults();
    job->decimate = bat_mesh_decimate_defaults();
    job->bake = bat_mesh_bake_defaults();
    job->bake.normal = false;
}

/// Finish the options of the files. False after a message.
static bool check_files(mesh_job *job)
{
    if (argument(job->call.given, "weld") != NULL && !(job->read.weld >= 0))
        return argument_refused(job->call.given, "weld", "0 or a distance above it");
    job->write.threads = job->call.threads;
    job->write.normals = job->normals ? BAT_MESH_NORMALS_ANGLE : BAT_MESH_NORMALS_NONE;
    return argument_ending(job->call.given, &bat_mesh_format_family, (int)job->write.format);
}

static int write_mesh(void *of, const char *path)
{
    mesh_job *job = of;
    bat_mesh_write_options options = job->write;
    options.vertex_normals = job->limit_normals != NULL ? job->limit_normals : job->baked.normals;
    options.tangents = job->bake.normal;
    if (job->lod_count > 0)
    {
        options.lods = job->lods;
        options.lod_distances = job->lod_distances;
        options.lod_count = job->lod_count;
    }
    return report_status(job->call.given, job->call.output, bat_mesh_write(path, &job->made, &options, report_error()));
}

/// Print notes and repairs, as far as the call wants them. Returns whether more is to be printed.
static bool report_files(const mesh_job *job)
{
    const verb_call *call = &job->call;
    if (call->json)
        return true;
    print_file_notes(call, &job->notes);
    if (!call->quiet && job->read.repair)
        (void)printf("%zu places repaired\n", bat_mesh_repair_places(&job->repairs));
    return !call->quiet;
}

static void end(void *of)
{
    mesh_job *job = of;
    bat_mesh_free(&job->given);
    bat_mesh_free(&job->made);
    free(job->limit_normals);
    bat_mesh_notes_free(&job->notes);
    bat_mesh_model_free(job->model);
    bat_mesh_map_free(job->map);
    bat_mesh_baked_free(&job->baked);
    mesh_paints_free(job->paints);
    free(job->bake_parts);
    for (size_t i = 0; i < MAX_LODS; i++)
        bat_mesh_free(&job->lods[i]);
}

// Refinement

static const option_spec REFINE_OPTIONS[] = {
    {"scheme", "NAME", METHOD, COMMON,
     "{}; default auto: catmull-clark for mostly quads or other polygons, loop for meshes with creases or corners, and of "
     "fewer than 100 faces but solids and cones, else learned",
     CHOICE(mesh_job, refine.scheme, bat_mesh_scheme_family)},
    {"levels", "K", METHOD, COMMON, "how often to refine; default 2", WHOLE(mesh_job, refine.levels, 0, MAX_LEVELS)},
    {"tolerance", "E", METHOD, COMMON,
     "loop, catmull-clark: refine where needed, until faces are within E of the limit surface",
     POSITIVE(mesh_job, refine.tolerance)},
    {"max-edge", "L", METHOD, 0, "the same, until no edge is longer than L", POSITIVE(mesh_job, refine.max_edge)},
    {"crease-angle", "DEG", METHOD, COMMON,
     "learned, loop, catmull-clark: keep edges sharp at which faces meet at a greater angle; default: found on "
     "solids by learned, else none",
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

static const char *const OF_LEARNED[] = {"model", "then", "fairness", NULL};

/// Whether options contradict each other. False after a message.
static bool check_schemes(const mesh_job *job)
{
    static const char *const of_rules[] = {"boundary", "creasing", "texture", "crease-angle", "limit", NULL};
    const arguments *given = job->call.given;
    bat_mesh_scheme scheme = job->refine.scheme;
    bool learned = scheme == BAT_MESH_SCHEME_LEARNED, chosen = scheme != BAT_MESH_SCHEME_AUTO;
    const usage_rule rules[] = {
        {!learned && chosen && argument_first(given, OF_LEARNED) != NULL,
         "--model, --then and --fairness need --scheme learned"},
        {is_adaptive(job) && ((chosen && !has_rules(scheme)) || argument(given, "levels") != NULL),
         "--tolerance and --max-edge need --scheme loop or catmull-clark, and exclude --levels"},
        {job->has_beside && job->call.picture == NULL, "--beside needs --picture FILE"},
        {!has_rules(learned || !chosen ? job->refine.then : scheme) && argument_first(given, of_rules) != NULL,
         "--limit, --crease-angle, --boundary, --creasing and --texture need --scheme loop or catmull-clark"},
    };
    return usage_obeys(given, rules, sizeof rules / sizeof *rules, NULL, NULL);
}

static bool check_refinement(void *of)
{
    mesh_job *job = of;
    const arguments *given = job->call.given;
    job->has_beside = argument(given, "beside") != NULL;
    job->refine.threads = job->call.threads;
    if (job->refine.scheme == BAT_MESH_SCHEME_AUTO && argument_first(given, OF_LEARNED) != NULL)
        job->refine.scheme = BAT_MESH_SCHEME_LEARNED;
    job->refine.max_memory = (size_t)fmin(1e6 * job->call.max_memory, 1e18);
    job->read.polygons = job->refine.scheme == BAT_MESH_SCHEME_CATMULL_CLARK || job->refine.scheme == BAT_MESH_SCHEME_AUTO;
    return usage_accepts(given, bat_options_check(&bat_mesh_refine_fields, &job->refine, report_error())) &&
           check_schemes(job) && check_files(job);
}

/// Read the mesh and choose the scheme.
static int read_given(mesh_job *job)
{
    bat_mesh_connectivity links;
    bat_status status = bat_mesh_read(job->call.input, &job->read, &job->given, report_error());
    if (status == BAT_OK)
        status = bat_mesh_connect(&job->given, &links, report_error());
    bat_error *error = report_error();
    size_t used = strlen(error->remedy_effect);
    if (status != BAT_OK && strcmp(error->remedy, "triangulate") == 0 && !job->read.polygons)
        (void)snprintf(error->remedy_effect + used, sizeof error->remedy_effect - used,
                       ", and --scheme catmull-clark refines it as it is");
    if (status != BAT_OK)
        return report_bad_input(job->call.given, job->call.input, error);
    job->boundary_edges = links.boundary_edge_count;
    bat_mesh_connectivity_free(&links);
    job->scheme = job->refine.scheme == BAT_MESH_SCHEME_AUTO ? bat_mesh_scheme_for(&job->given) : job->refine.scheme;
    if (job->scheme == BAT_MESH_SCHEME_AUTO)
        return report_bad_input(job->call.given, job->call.input, &(bat_error){.text = "out of memory"});
    if (job->scheme == BAT_MESH_SCHEME_LEARNED && job->refine.crease_angle == 0 &&
        bat_mesh_is_solid(&job->given, &job->solid, error) != BAT_OK)
        return report_bad_input(job->call.given, job->call.input, error);
    if (job->refine.scheme == BAT_MESH_SCHEME_AUTO)
    {
        job->reason = job->scheme == BAT_MESH_SCHEME_CATMULL_CLARK ? "most faces have more than three corners"
                      : job->scheme == BAT_MESH_SCHEME_LOOP        ? "a cage: few faces, or creases"
                                                                   : "a mesh of many triangles without creases";
        if (is_adaptive(job) && !has_rules(job->scheme))
        {
            job->scheme = BAT_MESH_SCHEME_LOOP;
            job->reason = job->solid ? "adaptive; a solid: sharp edges stay; --crease-angle 180 rounds them"
                                     : "adaptive refinement needs a limit surface";
        }
    }
    if (job->solid && job->scheme == BAT_MESH_SCHEME_LEARNED)
        job->reason = "a solid: flat faces and sharp edges stay; --scheme loop rounds them";
    return EXIT_DONE;
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
    if (options.scheme == BAT_MESH_SCHEME_CATMULL_CLARK || job->given.offsets == NULL)
        return bat_mesh_refine(&job->given, &options, other, NULL, error);
    bat_mesh triangles;
    bat_status status = bat_mesh_triangulate(&job->given, &triangles, error);
    if (status != BAT_OK)
        return status;
    status = bat_mesh_refine(&triangles, &options, other, NULL, error);
    bat_mesh_free(&triangles);
    return status;
}

static int draw(mesh_job *job)
{
    bat_mesh other = {0};
    char title[80], beside_title[80];
    bat_status status = job->has_beside ? refine_beside(job, &other, report_error()) : BAT_OK;
    if (status != BAT_OK)
        return report_bad_input(job->call.given, job->call.input, report_error());
    make_title(job, job->scheme, title);
    make_title(job, job->beside, beside_title);
    bat_mesh_picture_panel panels[3] = {
        {.mesh = &job->given, .title = "coarse", .wires = true, .flat = true},
        {.mesh = &job->made, .title = title},
        {.mesh = &other, .title = beside_title},
    };
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.threads = job->refine.threads;
    status = bat_mesh_picture_write(output_path(&job->call.files, "picture"), panels, job->has_beside ? 3 : 2, &options,
                                    report_error());
    bat_mesh_free(&other);
    return report_status(NULL, job->call.picture, status);
}

/// Warn of what the result lacks, on standard error.
static void warn(const mesh_job *job)
{
    bat_mesh_rules rules = job->given.rules;
    bool textured = job->given.texture_faces != NULL;
    bool sharp = job->given.crease_count + job->given.corner_count > 0;
    bat_mesh_scheme last = job->scheme == BAT_MESH_SCHEME_LEARNED ? job->refine.then : job->scheme;
    if ((rules.boundary != BAT_MESH_BOUNDARY_AUTO || rules.creasing != BAT_MESH_CREASING_AUTO ||
         rules.linear != BAT_MESH_LINEAR_AUTO) &&
        !has_rules(last))
        report_text(stderr, "batten: %s: %s does not know the file's rules of boundaries, creases and texture\n",
                    job->call.input, bat_choice_name(&bat_mesh_scheme_family, (int)last));
    if ((textured || sharp) && is_adaptive(job))
        report_text(stderr, "batten: %s: adaptive refinement leaves out texture coordinates, creases and corners\n",
                    job->call.input);
    if ((textured || sharp) && job->scheme == BAT_MESH_SCHEME_SQRT3)
        report_text(stderr, "batten: %s: sqrt3 turns edges over: texture coordinates, creases and corners are left out\n",
                    job->call.input);
}

static int report_refinement(void *of)
{
    mesh_job *job = of;
    const bat_mesh *given = &job->given, *made = &job->made;
    char levels[32];
    warn(job);
    if (!report_files(job))
        return EXIT_DONE;
    return report_print(
        job->call.json,
        "{scheme}[told? ({reason})], {how}: {coarse.vertices} vertices, {coarse.faces} faces -> {fine.vertices} vertices, "
        "{fine.faces} faces; [boundary_edges?with boundary][!boundary_edges?closed]"
        "[fallback?; as by midpoint at {fallback} places]\n",
        "scheme:s reason:s -told:b levels:z -how:s coarse.vertices:z coarse.faces:z fine.vertices:z fine.faces:z "
        "boundary_edges:z fallback:z repaired:z notes:o",
        bat_choice_name(&bat_mesh_scheme_family, (int)job->scheme), job->reason,
        (int)(job->reason != NULL && (job->solid || job->scheme != BAT_MESH_SCHEME_LEARNED)), job->refine.levels,
        levels_text(job, job->scheme, levels), given->vertex_count, given->face_count, made->vertex_count, made->face_count,
        job->boundary_edges, job->fallback, bat_mesh_repair_places(&job->repairs), file_notes_json(&job->notes));
}

static int make_refinement(void *of)
{
    mesh_job *job = of;
    if (read_given(job) != EXIT_DONE)
        return EXIT_BAD_INPUT;
    bat_mesh_refine_options options = job->refine;
    if (job->model_file != NULL)
    {
        if (bat_mesh_model_read_published(job->model_file, &job->model, report_error()) != BAT_OK)
            return report_failure(job->model_file, report_error());
        options.rule = bat_mesh_model_rule(job->model);
    }
    options.progress = report_progress("refining");
    if (options.limit && job->normals)
        options.limit_normals = &job->limit_normals;
    bat_status status = bat_mesh_refine(&job->given, &options, &job->made, &job->fallback, report_error());
    int code = report_status(job->call.given, job->call.input, status);
    return code == EXIT_DONE && job->call.picture != NULL ? draw(job) : code;
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
    .options = {{REFINE_OPTIONS, 0}, {FILE_OPTIONS, 0}},
    .formats = &bat_mesh_format_family,
    .job_size = sizeof(mesh_job),
    .calls = {begin, check_refinement, make_refinement, write_mesh, report_refinement, end},
};

// Decimation

static const option_spec DECIMATE_OPTIONS[] = {
    {"vertices", "N", METHOD, COMMON, "how many vertices to keep; more stay where no further collapse passes the checks",
     WHOLE(mesh_job, decimate.vertices, 1, BAT_MESH_NONE)},
    {"faces", "N", METHOD, COMMON, "instead: how many faces to keep",
     WHOLE(mesh_job, decimate.faces, 1, BAT_MESH_MAX_FACES)},
    {"ratio", "R", METHOD, COMMON, "instead: the share of the faces to keep, above 0 to 1",
     NUMBER(mesh_job, decimate.ratio)},
    {"tolerance", "E", METHOD, COMMON,
     "instead: as few as keep both surfaces within the distance E of each other, in the units of IN; with % of the diagonal "
     "of its box (0.1%)",
     NO_FIELD},
    {"method", "NAME", METHOD, COMMON,
     "{}; default balanced. memoryless: squared volumes to the present faces, at preserved volume (Lindstrom and Turk); "
     "quadric: squared distances from the planes of all faces of IN, faster and less accurate; balanced and fast: quadric "
     "errors without a strict order to eight and six times the target, then memoryless errors; even: memoryless within "
     "three fifths of its greatest distance, in six times its time",
     CHOICE(mesh_job, decimate.method, bat_mesh_decimate_method_family)},
    {"attributes", "W", METHOD, 0,
     "the weight of texture and channels in the error; 0 drops them, and lets seams vanish; default 0.5",
     NUMBER(mesh_job, decimate.attributes)},
    {"random", "K", METHOD, 0, "each time collapse the edge of minimum error among K random ones; default: among all",
     WHOLE(mesh_job, decimate.candidates, 1, 1000000)},
    {"seed", "N", METHOD, 0, "of --random; default 1", WHOLE(mesh_job, decimate.seed, 0, 1000000000)},
    {"min-normal", "C", METHOD, 0, "the minimum cosine of the angle by which a collapse turns a face, -1 to 1; default 0.2",
     NUMBER(mesh_job, decimate.min_normal)},
    {"min-quality", "Q", METHOD, 0,
     "the minimum quality of a triangle after a collapse, from 0 to 1 for an equilateral one; default 0.1",
     NUMBER(mesh_job, decimate.min_quality)},
    {"boundary-weight", "W", METHOD, 0, "the weight of the error at a boundary, that of a face being 1; default 1000",
     NUMBER(mesh_job, decimate.boundary_weight)},
    {"map", "FILE", RESULT, COMMON | IS_WRITTEN, "write the bijective map between IN and OUT, a safetensors file",
     TEXT(mesh_job, map_file)},
    {"transfer", NULL, METHOD, COMMON,
     "carry colours, values, labels and normals of IN through the map, by area; without it the vertices that remain keep "
     "theirs",
     FLAG(mesh_job, transfer)},
    {"bake", "KIND=FILE,...", RESULT, COMMON,
     "bake normal, color (of materials with their images, else of vertices) and occlusion of IN into PNG files, by the "
     "texture of OUT or an atlas; OUT as glTF holds them, too",
     TEXT(mesh_job, bake_text)},
    {"size", "N", RESULT, 0, "the texels along a side of baked images; default 1024",
     WHOLE(mesh_job, bake.unwrap.size, 16, 16384)},
    {"lods", "R,...", RESULT, COMMON,
     "write a chain of levels of detail into a glTF file: shares of the faces, as 1,0.5,0.25; what is baked serves all",
     TEXT(mesh_job, lods_text)},
    END_OF_OPTIONS,
};

static const char *const BAKED[3] = {"normal", "color", "occlusion"};

/// --bake: kinds, each with `=` and a file, or alone. False after a message.
static bool read_bake(mesh_job *job)
{
    bool *const wanted[3] = {&job->bake.normal, &job->bake.colour, &job->bake.occlusion};
    char *next;
    job->bake_parts = job->bake_text != NULL ? strdup(job->bake_text) : NULL;
    for (char *kind = job->bake_parts != NULL ? strtok_r(job->bake_parts, ",", &next) : NULL; kind != NULL;
         kind = strtok_r(NULL, ",", &next))
    {
        char *part = strchr(kind, '=');
        if (part != NULL)
            *part++ = '\0';
        size_t k = 0;
        while (k < 3 && strcmp(BAKED[k], kind) != 0)
            k++;
        if (k == 3 || (part != NULL && *part == '\0'))
            return argument_refused(job->call.given, "bake",
                                    "kinds of normal, color and occlusion, as normal=n.png,color=c.png");
        *wanted[k] = true;
        job->bake_files[k] = part;
    }
    return true;
}

/// --lods: numbers with commas between them. False after a message.
static bool read_lods(mesh_job *job)
{
    const char *at = job->lods_text;
    for (char *end; at != NULL && *at != '\0'; at = *end == ',' ? end + 1 : end)
    {
        double share = strtod(at, &end);
        bool good = end != at && (*end == ',' || *end == '\0') && job->lod_count < MAX_LODS && share > 0 &&
                    share <= (job->lod_count > 0 ? job->lod_shares[job->lod_count - 1] : 1);
        if (!good)
            return argument_refused(job->call.given, "lods", "decreasing shares of the faces from at most 1, as 1,0.5,0.25");
        job->lod_shares[job->lod_count++] = share;
    }
    return true;
}

/// The option that says where to stop; null after a message.
static const char *find_target(const arguments *given)
{
    static const char *const TARGETS[] = {"vertices", "faces", "ratio", "tolerance"};
    const char *found = NULL;
    for (size_t i = 0; i < sizeof TARGETS / sizeof *TARGETS; i++)
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
    if (argument(given, "lods") != NULL)
        return found == NULL ? "lods" : (usage_error(given, "--%s and --lods exclude each other", found), NULL);
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

static bool check_decimation(void *of)
{
    mesh_job *job = of;
    const arguments *given = job->call.given;
    bat_mesh_decimate_options *options = &job->decimate;
    options->threads = job->call.threads;
    if (job->call.output == NULL)
        return usage_refused(given, "-o OUT is missing");
    if (argument(given, "seed") != NULL && argument(given, "random") == NULL)
        return usage_refused(given, "--seed needs --random K");
    if (find_target(given) == NULL || !read_tolerance(given, options) || !read_bake(job) || !read_lods(job))
        return false;
    if (job->lod_count > 0 && job->map_file != NULL)
        return usage_refused(given, "--map needs one mesh, and --lods makes several");
    if (argument(given, "size") != NULL && job->bake_text == NULL)
        return usage_refused(given, "--size needs --bake");
    if (argument(given, "ratio") != NULL && !(options->ratio > 0 && options->ratio <= 1))
        return argument_refused(given, "ratio", "above 0 and at most 1");
    return usage_accepts(given, bat_options_check(&bat_mesh_decimate_fields, options, report_error())) && check_files(job);
}

/// Note that the images of materials are lost where an atlas replaces their texture coordinates.
static bool note_images(mesh_job *job)
{
    static const char note[] = "images of materials are left out but for baked ones: an atlas replaces the texture "
                               "coordinates, which overlap or leave the unit square; without --bake they stay";
    json_t *materials = job->made.material_json != NULL ? json_loads(job->made.material_json, 0, NULL) : NULL;
    bool lost =
        job->baked.charts > 0 && job->given.texture != NULL && json_array_size(json_object_get(materials, "images")) > 0;
    json_decref(materials);
    return !lost || add_file_note(&job->notes, note);
}

/// Whether the result is written as glTF.
static bool writes_gltf(const mesh_job *job)
{
    const bat_choice *row = NULL;
    int format = (int)job->write.format;
    if (format == BAT_MESH_FORMAT_AUTO)
        (void)bat_choice_of_path(&bat_mesh_format_family, job->call.output, true, &row, NULL);
    format = row != NULL ? row->value : format;
    return format == BAT_MESH_FORMAT_GLTF || format == BAT_MESH_FORMAT_GLB;
}

/// Bake the images, write their files, and put them into the materials of the result.
static int bake(mesh_job *job)
{
    const bat_mesh_image *const images[3] = {&job->baked.normal, &job->baked.colour, &job->baked.occlusion};
    job->bake.threads = job->call.threads;
    bat_status status = BAT_OK;
    if (job->bake.colour)
        status = mesh_paints_read(&job->given, job->call.input, job->bake.unwrap.size, &job->paints, report_error());
    const bat_mesh_painter painter = {mesh_paints_at, job->paints};
    if (status == BAT_OK)
        status = bat_mesh_bake_painted(job->map, &job->given, &job->made, &job->bake, job->paints != NULL ? &painter : NULL,
                                       &job->baked, report_error());
    int code = report_status(job->call.given, job->call.input, status);
    for (size_t k = 0; k < 3 && code == EXIT_DONE; k++)
    {
        const char *path;
        if (job->bake_files[k] == NULL)
            continue;
        code = report_status(NULL, job->bake_files[k],
                             bat_outputs_add(job->call.files.files, job->bake_files[k], &path, report_error()));
        if (code == EXIT_DONE)
            code = report_status(NULL, job->bake_files[k], bat_mesh_image_write(path, images[k], report_error()));
    }
    if (code == EXIT_DONE && ((job->paints != NULL && !mesh_paints_reset(&job->made)) || !note_images(job)))
        code = report_failure(job->call.output, &(bat_error){.text = "out of memory"});
    if (code == EXIT_DONE && writes_gltf(job))
        code = report_status(NULL, job->call.output, bat_mesh_baked_attach(&job->baked, &job->made, report_error()));
    return code;
}

/// Decimate a mesh, and carry over what --transfer wants. `*map` receives the map, unless it is null.
static bat_status decimate(mesh_job *job, const bat_mesh *fine, const bat_mesh_decimate_options *options, bat_mesh *made,
                           bat_mesh_map **map, double **normals)
{
    bat_status status = bat_mesh_decimate(fine, options, made, map, report_error());
    return status == BAT_OK && job->transfer ? bat_mesh_transfer(*map, fine, made, normals, report_error()) : status;
}

/// Make the chain of --lods: its first mesh is the result.
static int make_plain_lods(mesh_job *job, const bat_mesh_decimate_options *options)
{
    int code = report_status(
        job->call.given, job->call.input,
        bat_mesh_lods(&job->given, job->lod_shares, job->lod_count, options, job->lods, job->lod_distances, report_error()));
    if (code != EXIT_DONE)
        return code;
    job->made = job->lods[0];
    memmove(job->lods, job->lods + 1, (MAX_LODS - 1) * sizeof *job->lods);
    job->lods[MAX_LODS - 1] = (bat_mesh){0};
    memmove(job->lod_distances, job->lod_distances + 1, (MAX_LODS - 1) * sizeof *job->lod_distances);
    job->lod_count--;
    return EXIT_DONE;
}

/// Make the further levels of --lods of the result. They carry its values and its texture coordinates, so that what is
/// baked serves them, too.
static int make_further_lods(mesh_job *job, const bat_mesh_decimate_options *given)
{
    bat_mesh_decimate_options options = *given;
    bat_status status = BAT_OK;
    job->lod_count--;
    options.ratio = 0;
    for (size_t i = 0; i < job->lod_count && status == BAT_OK; i++)
    {
        const bat_mesh *before = i > 0 ? &job->lods[i - 1] : &job->made;
        bat_mesh_map *map = NULL;
        bat_mesh_distance distance = {0};
        options.faces = (size_t)fmax(1, round(job->lod_shares[i + 1] * (double)job->given.face_count));
        status = decimate(job, before, &options, &job->lods[i], job->transfer ? &map : NULL, NULL);
        bat_mesh_map_free(map);
        if (status == BAT_OK)
            status = bat_mesh_compare(&job->lods[i], &job->given, NULL, &distance, report_error());
        job->lod_distances[i] = distance.hausdorff;
    }
    return report_status(job->call.given, job->call.input, status);
}

static int make_decimation(void *of)
{
    mesh_job *job = of;
    if (bat_mesh_read(job->call.input, &job->read, &job->given, report_error()) != BAT_OK)
        return report_bad_input(job->call.given, job->call.input, report_error());
    bat_mesh_decimate_options options = job->decimate;
    options.progress = report_progress("decimating");
    options.distance = &job->distance;
    bool with_map = job->map_file != NULL || job->transfer || job->bake_text != NULL;
    if (job->lod_count > 0 && !with_map)
        return make_plain_lods(job, &options);
    if (job->lod_count > 0)
        options.ratio = job->lod_shares[0];
    int code = report_status(job->call.given, job->call.input,
                             decimate(job, &job->given, &options, &job->made, with_map ? &job->map : NULL,
                                      job->normals ? &job->limit_normals : NULL));
    if (code == EXIT_DONE && job->map_file != NULL)
        code = report_status(NULL, job->map_file,
                             bat_mesh_map_write(output_path(&job->call.files, "map"), job->map, report_error()));
    if (code == EXIT_DONE && job->bake_text != NULL)
        code = bake(job);
    return code == EXIT_DONE && job->lod_count > 0 ? make_further_lods(job, &options) : code;
}

/// Whether the result has as few vertices or faces as wanted.
static bool is_reached(const mesh_job *job)
{
    const bat_mesh_decimate_options *options = &job->decimate;
    if (options->vertices > 0)
        return job->made.vertex_count <= options->vertices;
    if (options->faces > 0)
        return job->made.face_count <= options->faces;
    if (job->lods_text != NULL)
        return true;
    return options->tolerance > 0 || (double)job->made.face_count <= fmax(1, options->ratio * (double)job->given.face_count);
}

static int report_decimation(void *of)
{
    mesh_job *job = of;
    const bat_mesh *fine = &job->given, *coarse = &job->made;
    const bat_mesh_decimate_options *how = &job->decimate;
    double wanted = how->vertices > 0 ? (double)how->vertices
                    : how->faces > 0  ? (double)how->faces
                    : how->ratio > 0  ? how->ratio
                                      : how->tolerance;
    if (!report_files(job))
        return EXIT_DONE;
    for (size_t i = 0; i < job->lod_count && !job->call.json; i++)
        (void)printf("level %zu: %zu faces, at most %.6g away\n", i + 1, job->lods[i].face_count, job->lod_distances[i]);
    return report_print(
        job->call.json,
        "{fine.vertices} vertices, {fine.faces} faces -> {coarse.vertices} vertices, {coarse.faces} faces\n"
        "[distance?no point of either surface is farther than {distance:.6g} from the other\n]"
        "[texels?baked {texels} texels[charts? in {charts} charts][normal_turn?; normals within {normal_turn:.3g} "
        "degrees]\n]"
        "[!reached?no further collapse passes the checks; lower --min-quality or --min-normal\n]",
        "fine.vertices:z fine.faces:z coarse.vertices:z coarse.faces:z method:s target:s wanted:n reached:b distance:n "
        "repaired:z map:s texels:z charts:z normal_turn:n notes:o",
        fine->vertex_count, fine->face_count, coarse->vertex_count, coarse->face_count,
        bat_choice_name(&bat_mesh_decimate_method_family, (int)how->method), find_target(job->call.given), wanted,
        (int)is_reached(job), how->tolerance > 0 ? job->distance : NAN, bat_mesh_repair_places(&job->repairs), job->map_file,
        job->baked.texels, job->baked.charts, job->bake.normal ? job->baked.max_turn * 57.29577951308232 : NAN,
        file_notes_json(&job->notes));
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
    .options = {{DECIMATE_OPTIONS, 0}, {FILE_OPTIONS, 0}},
    .formats = &bat_mesh_format_family,
    .job_size = sizeof(mesh_job),
    .calls = {begin, check_decimation, make_decimation, write_mesh, report_decimation, end},
};
