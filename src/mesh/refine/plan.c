#include "mesh/refine/plan.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "mesh/refine/brake.h"

/// @file
/// Options of a refinement, checked, and the sizes of all levels.

/// The largest crease angle: pi, with rounding.
#define LARGEST_ANGLE 3.1415926535897936

#define MAX_LEVELS 32

bat_mesh_refine_options bat_mesh_refine_defaults(void)
{
    return (bat_mesh_refine_options){
        .scheme = BAT_MESH_SCHEME_AUTO, .fairness = 0.25, .then = BAT_MESH_SCHEME_LOOP, .levels = 2};
}

/// The scheme of all levels after the learned ones.
static const mesh_scheme *last_scheme(const bat_mesh_refine_options *options)
{
    const mesh_scheme *scheme = mesh_scheme_of(options->scheme);
    return scheme->learned ? mesh_scheme_of(options->then) : scheme;
}

static const option_field FIELDS[] = {
    OPTION_FAMILY(bat_mesh_refine_options, scheme, bat_mesh_scheme_family),
    OPTION_FIELD(bat_mesh_refine_options, fairness, OPTION_NUMBER, 0, 1),
    OPTION_FAMILY(bat_mesh_refine_options, then, bat_mesh_scheme_family),
    OPTION_FIELD(bat_mesh_refine_options, levels, OPTION_SIZE, 0, MAX_LEVELS),
    OPTION_FIELD(bat_mesh_refine_options, crease_angle, OPTION_NUMBER, 0, LARGEST_ANGLE),
    OPTION_FIELD(bat_mesh_refine_options, max_memory, OPTION_SIZE, 0, INFINITY),
    OPTION_FIELD(bat_mesh_refine_options, tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_mesh_refine_options, max_edge, OPTION_NUMBER, 0, INFINITY),
    OPTION_FAMILY(bat_mesh_refine_options, rules.boundary, bat_mesh_boundary_family),
    OPTION_FAMILY(bat_mesh_refine_options, rules.creasing, bat_mesh_creasing_family),
    OPTION_FAMILY(bat_mesh_refine_options, rules.linear, bat_mesh_linear_family),
    OPTION_THREADS(bat_mesh_refine_options),
};

static bat_status mesh_refine_options_check(const void *opaque, bat_error *error)
{
    const bat_mesh_refine_options *options = opaque;
    if (!mesh_scheme_of(options->then)->continues)
        return error_option(error, "then", "is %s, but only midpoint, loop or butterfly can follow learned levels",
                            bat_choice_name(&bat_mesh_scheme_family, (int)options->then));
    if (options->rule != NULL && (options->rule->levels == 0 || options->rule->refine == NULL))
        return error_option(error, "rule", "has no levels or no function");
    if (options->limit_normals != NULL && (!options->limit || !last_scheme(options)->creases))
        return error_option(error, "limit_normals", "need limit and Loop's or Catmull and Clark's scheme at the end");
    return BAT_OK;
}

const bat_options_table bat_mesh_refine_fields = OPTIONS_TABLE(bat_mesh_refine_options, FIELDS, mesh_refine_options_check);

static bat_status check_support(const bat_mesh_refine_options *options, bat_error *error)
{
    const mesh_scheme *last = last_scheme(options);
    if (options->crease_angle > 0 && !last->creases)
        return ERROR_UNSUPPORTED(error, 0, "only Loop's and Catmull and Clark's schemes make creases");
    if ((options->tolerance > 0 || options->max_edge > 0) && !mesh_scheme_of(options->scheme)->creases)
        return ERROR_UNSUPPORTED(error, 0, "adaptive refinement needs a scheme with a limit surface: loop or catmull-clark");
    if ((options->tolerance > 0 || options->max_edge > 0) && options->limit_normals != NULL)
        return ERROR_UNSUPPORTED(error, 0, "adaptive refinement has no limit normals");
    const bat_mesh_rules *rules = &options->rules;
    if ((rules->boundary != BAT_MESH_BOUNDARY_AUTO || rules->creasing != BAT_MESH_CREASING_AUTO ||
         rules->linear != BAT_MESH_LINEAR_AUTO) &&
        !last->creases)
        return ERROR_UNSUPPORTED(
            error, 0, "the scheme %s has no rules of boundaries, creases and texture; loop and catmull-clark have",
            last->choice.name);
    if (!last->turns)
        return BAT_OK;
    if (options->limit)
        return ERROR_UNSUPPORTED(error, 0, "limit positions of square-root-three subdivision are not supported");
    return BAT_OK;
}

bat_mesh_rules mesh_rules_or(bat_mesh_rules rules, bat_mesh_rules others)
{
    if (rules.boundary == BAT_MESH_BOUNDARY_AUTO)
        rules.boundary = others.boundary;
    if (rules.creasing == BAT_MESH_CREASING_AUTO)
        rules.creasing = others.creasing;
    if (rules.linear == BAT_MESH_LINEAR_AUTO)
        rules.linear = others.linear;
    return rules;
}

/// The rules of the options, else of the mesh, else the defaults.
static bat_mesh_rules rules_of(const bat_mesh *coarse, const bat_mesh_refine_options *options)
{
    static const bat_mesh_rules DEFAULTS = {BAT_MESH_BOUNDARY_EDGES, BAT_MESH_CREASING_UNIFORM, BAT_MESH_LINEAR_ALL};
    bat_mesh_rules rules = mesh_rules_or(mesh_rules_or(options->rules, coarse->rules), DEFAULTS);
    if (!last_scheme(options)->creases)
        rules.boundary = BAT_MESH_BOUNDARY_EDGES;
    return rules;
}

bat_status mesh_plan_make(const bat_mesh *coarse, const bat_mesh_refine_options *options, mesh_plan *plan, bat_error *error)
{
    bat_status status = check_support(options, error);
    if (status != BAT_OK)
        return status;
    *plan = (mesh_plan){.options = *options, .rules = rules_of(coarse, options)};
    if (mesh_scheme_of(options->scheme)->learned)
        plan->learned_levels = options->levels < options->rule->levels ? options->levels : options->rule->levels;
    plan->limit = options->limit ? last_scheme(options)->limit : NULL;
    return BAT_OK;
}

const mesh_scheme *mesh_plan_scheme(const mesh_plan *plan, size_t level)
{
    return level < plan->learned_levels ? mesh_scheme_of(plan->options.scheme) : last_scheme(&plan->options);
}

/// The number of elements of a mesh.
typedef struct mesh_size
{
    uint64_t vertices, edges, faces, corners, boundary_edges;
} mesh_size;

static mesh_size size_of(const mesh_sides *sides, const bat_mesh_connectivity *links)
{
    return (mesh_size){links->vertex_count, links->edge_count, links->face_count, sides_corners(sides, links->face_count),
                       links->boundary_edge_count};
}

/// The size after a level of square-root-three subdivision, with or without a trisection of boundary edges.
static mesh_size size_of_turned(mesh_size size, bool cut)
{
    mesh_size made = {.vertices = size.vertices + size.faces + (cut ? size.boundary_edges : 0),
                      .faces = 3 * size.faces,
                      .corners = 9 * size.faces,
                      .boundary_edges = (cut ? 3 : 1) * size.boundary_edges};
    made.edges = (3 * made.faces + made.boundary_edges) / 2;
    return made;
}

static mesh_size size_of_next(const mesh_scheme *scheme, mesh_size size, size_t level)
{
    if (scheme->polygons)
        return (mesh_size){size.vertices + size.edges + size.faces, 2 * size.edges + size.corners, size.corners,
                           4 * size.corners, 2 * size.boundary_edges};
    if (scheme->turns)
        return size_of_turned(size, level % 2 == 1);
    return (mesh_size){size.vertices + size.edges, 2 * size.edges + 3 * size.faces, 4 * size.faces, 12 * size.faces,
                       2 * size.boundary_edges};
}

static bool is_numbered(mesh_size size)
{
    return size.corners < BAT_MESH_NONE && size.vertices < BAT_MESH_NONE;
}

/// What the learned scheme holds for each vertex of a level that it refines: half-flaps, states, features, candidates.
static const double LEARNED_VERTEX_BYTES = 1300;

/// The sizes of a level: of the mesh, and of its texture.
typedef struct level_size
{
    mesh_size mesh, texture;
} level_size;

/// Bytes of the arrays of a level that become a mesh.
static double bytes_of_mesh(const bat_mesh *coarse, level_size size)
{
    double vertex = (double)(3 + coarse->channel_count) * sizeof(double);
    return vertex * (double)size.mesh.vertices + 2 * sizeof(double) * (double)size.texture.vertices +
           sizeof(uint32_t) * (double)(size.mesh.corners + size.texture.corners);
}

/// Bytes of the connectivity of a level.
static double bytes_of_links(level_size size)
{
    return 2 * sizeof(uint32_t) * (double)(size.mesh.corners + size.texture.corners) +
           sizeof(uint32_t) * (double)size.mesh.vertices;
}

/// Bytes that the last level takes beside its mesh.
static double bytes_of_end(const mesh_plan *plan, const bat_mesh *coarse, level_size size)
{
    bool polygons = last_scheme(&plan->options)->polygons;
    double bytes = 0, vertices = (double)size.mesh.vertices, faces = (double)size.mesh.faces;
    if (plan->options.limit)
        bytes += bytes_of_links(size) + 3 * sizeof(double) * vertices;
    if (plan->options.limit_normals != NULL)
        bytes += bytes_of_links(size) + 3 * sizeof(double) * vertices;
    if (plan->rules.boundary == BAT_MESH_BOUNDARY_NONE)
        bytes += sizeof(uint32_t) * fmax(vertices, (double)size.texture.vertices);
    if (coarse->face_labels != NULL)
        bytes += (polygons ? 2.0 : 1.0) * sizeof(uint32_t) * faces;
    return polygons ? bytes + sizeof(uint32_t) * faces : bytes;
}

/// The most bytes that a refinement by `levels` known levels holds at once: two levels, the rest of a third, sharpness.
static double bytes_of_levels(const mesh_plan *plan, const bat_mesh *coarse, const level_size *sizes, size_t levels)
{
    bool sharp = coarse->crease_count > 0 || plan->options.crease_angle > 0;
    double most = 0;
    for (size_t level = 0; level < levels; level++)
    {
        level_size before = level > 0 ? sizes[level - 1] : (level_size){{0}, {0}}, now = sizes[level],
                   next = sizes[level + 1];
        double bytes = bytes_of_links(before) + sizeof(uint32_t) * (double)before.mesh.corners + bytes_of_mesh(coarse, now) +
                       bytes_of_links(now) + bytes_of_mesh(coarse, next);
        bytes += level + 1 < levels ? bytes_of_links(next) : bytes_of_end(plan, coarse, next);
        if (level < plan->learned_levels)
            bytes += LEARNED_VERTEX_BYTES * (double)now.mesh.vertices + 3 * sizeof(double) * (double)next.mesh.vertices;
        if (plan->learned_levels > 0)
            bytes += BRAKE_VERTEX_BYTES * (double)(now.mesh.vertices + next.mesh.vertices);
        if (sharp)
            bytes += sizeof(double) * (double)(now.mesh.edges + next.mesh.edges);
        if (sharp && plan->rules.creasing == BAT_MESH_CREASING_CHAIKIN)
            bytes += sizeof(double) * (double)now.mesh.corners;
        most = fmax(most, bytes);
    }
    return most;
}

/// Compare the memory with the limit.
static bat_status check_memory(const mesh_plan *plan, const bat_mesh *coarse, const level_size *sizes, bat_error *error)
{
    static const double gigabyte = 1e9, unasked = 1 << 26; // bytes that need no question
    size_t levels = plan->options.levels, given = plan->options.max_memory;
    double bytes = bytes_of_levels(plan, coarse, sizes, levels);
    if (given == 0 && bytes < unasked)
        return BAT_OK;
    double most = given > 0 ? (double)given : (double)memory_available();
    if (most == 0 || bytes <= most)
        return BAT_OK;
    size_t fitting = levels;
    while (fitting > 0 && bytes_of_levels(plan, coarse, sizes, fitting) > most)
        fitting--;
    (void)ERROR_TOO_LARGE(error, "%zu levels take %.3g GB of memory for %.3g faces, more than the %.3g GB %s", levels,
                          bytes / gigabyte, (double)sizes[levels].mesh.faces, most / gigabyte,
                          given > 0 ? "allowed" : "available");
    return error_remedy(error, BAT_TOO_LARGE, "levels", "%zu fits", fitting);
}

bat_status mesh_plan_check_size(const mesh_plan *plan, const bat_mesh *coarse, const mesh_sides *sides,
                                const bat_mesh_connectivity *links, const bat_mesh_connectivity *texture_links,
                                bat_error *error)
{
    mesh_size mesh = size_of(sides, links), texture = {0};
    if (texture_links->face_count > 0)
        texture = size_of(sides, texture_links);
    level_size sizes[MAX_LEVELS + 1] = {{mesh, texture}};
    for (size_t level = 0; level < plan->options.levels; level++)
    {
        const mesh_scheme *scheme = mesh_plan_scheme(plan, level);
        mesh = size_of_next(scheme, mesh, level);
        texture = size_of_next(scheme, texture, 0);
        if (!is_numbered(mesh) || !is_numbered(texture))
        {
            (void)ERROR_TOO_LARGE(
                error,
                "level %zu of %zu has more faces or vertices than 32-bit indices can number: the mesh has %zu "
                "faces already",
                level + 1, plan->options.levels, coarse->face_count);
            return error_remedy(error, BAT_TOO_LARGE, "levels", "%zu is possible", level);
        }
        sizes[level + 1] = (level_size){mesh, texture};
    }
    return check_memory(plan, coarse, sizes, error);
}

double mesh_plan_share(const mesh_plan *plan, size_t level)
{
    double growth = mesh_scheme_of(plan->options.scheme)->turns ? 3 : 4;
    return (pow(growth, (double)level) - 1) / (pow(growth, (double)plan->options.levels) - 1);
}
