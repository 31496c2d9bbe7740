#include "mesh/network/learned_network.h"

#include "base/error.h"
#include "learn/weights.h"
#include "mesh/measure/closest.h"
#include "mesh/refine/sharpness.h"

// Creases and corners

/// The level that is refined, where something on the mesh is sharp.
typedef struct sharp_level
{
    bool sharp;
    const uint32_t *faces;
    const bat_mesh_connectivity *links;
    double *edge, *vertex; ///< sharpness; null where none is sharp
    size_t coarse_count;
    // Of later levels:
    split_mesh own; ///< of a later level
} sharp_level;

static mesh_level level_of(const sharp_level *sharp)
{
    return (mesh_level){.faces = sharp->faces,
                        .links = sharp->links,
                        .edge_sharpness = sharp->edge,
                        .vertex_sharpness = sharp->vertex,
                        .coarse_count = sharp->coarse_count};
}

static bat_status sharp_begin(const bat_mesh *coarse, const bat_mesh_connectivity *links, double crease_angle,
                              sharp_level *level, bat_error *error)
{
    *level = (sharp_level){.faces = coarse->faces, .links = links, .coarse_count = coarse->vertex_count};
    const mesh_level begin = level_of(level);
    bat_status status = sharpness_of_edges(&begin, coarse, crease_angle, &level->edge, error);
    if (status == BAT_OK)
        status = sharpness_of_vertices(&begin, coarse, false, &level->vertex, error);
    level->sharp = level->edge != NULL || level->vertex != NULL;
    return status;
}

/// Go to the next level.
static bat_status sharp_advance(sharp_level *level, int threads, bat_error *error)
{
    if (!level->sharp)
        return BAT_OK;
    const mesh_level now = level_of(level);
    split_mesh next = {0};
    double *edge = NULL;
    bat_status status = split_mesh_make(level->faces, level->links, threads, &next, error);
    if (status == BAT_OK && level->edge != NULL)
    {
        status = sharpness_split(&now, &next.links, &edge, error);
        if (status != BAT_OK)
            split_mesh_free(&next);
    }
    if (status != BAT_OK)
        return status;
    for (size_t v = 0; level->vertex != NULL && v < level->coarse_count; v++)
        level->vertex[v] = sharpness_after_level(level->vertex[v]);
    free(level->edge);
    split_mesh_free(&level->own);
    level->edge = edge;
    level->own = next;
    level->faces = level->own.faces;
    level->links = &level->own.links;
    return BAT_OK;
}

/// Replace what lies on creases and corners by Loop's rules. Boundaries stay as they are.
static bat_status sharp_apply(const sharp_level *sharp, const double *from, int threads, double *to, bat_error *error)
{
    const bat_mesh_connectivity *links = sharp->links;
    size_t vertices = links->vertex_count, count = vertices + links->edge_count;
    if (!sharp->sharp)
        return BAT_OK;
    double *loop = memory_array(count, 3 * sizeof *loop);
    if (loop == NULL)
        return error_memory(error, count * 3 * sizeof *loop);
    const mesh_level level = level_of(sharp);
    const mesh_rows rows = {&level, from, loop, 3};
    loop_rule(&rows, threads);
    for (uint32_t v = 0; v < vertices; v++)
    {
        sharp_vertex now;
        if (links->first[v] == BAT_MESH_NONE || mesh_at_boundary(links, links->first[v]))
            continue;
        sharpness_around(&level, v, &now, NULL, NULL);
        if (now.kind >= SHARP_CREASE)
            memcpy(to + 3 * (size_t)v, loop + 3 * (size_t)v, 3 * sizeof *to);
    }
    for (size_t h = 0; h < 3 * links->face_count && sharp->edge != NULL; h++)
    {
        size_t row = 3 * (vertices + links->edge[h]);
        if (links->twin[h] != BAT_MESH_NONE && sharp->edge[links->edge[h]] > 0)
            memcpy(to + row, loop + row, 3 * sizeof *to);
    }
    free(loop);
    return BAT_OK;
}

// Levels

/// Refine the scaled positions `from` by all levels; `to` receives the last.
static bat_status run(const mesh_learned *network, const mesh_levels *levels, const bat_mesh_refine_options *options,
                      sharp_level *sharp, double *from, double *to, size_t *fallback, bat_error *error)
{
    mesh_learned_run shared;
    bat_status status = mesh_learned_begin(levels, &shared, error);
    for (size_t i = 0; i < levels->count && status == BAT_OK; i++)
    {
        const mesh_flaps *flaps = &levels->level[i];
        size_t old = i > 0 ? levels->level[i - 1].vertex_count : 0, failures = 0;
        status = mesh_learned_step(network, i, flaps, from, old, options->fairness, options->threads, &shared, to, &failures,
                                   error);
        *fallback += failures;
        if (status == BAT_OK)
            status = sharp_apply(sharp, from, options->threads, to, error);
        if (status == BAT_OK && i + 1 < levels->count)
        {
            status = sharp_advance(sharp, options->threads, error);
            memcpy(from, to, 3 * (flaps->vertex_count + flaps->edge_count) * sizeof *from);
        }
    }
    free(shared.state);
    free(shared.memory);
    return status;
}

static bat_status refine(const bat_mesh_rule *rule, const bat_mesh *coarse, const bat_mesh_connectivity *connectivity,
                         size_t levels, const bat_mesh_refine_options *options, bat_mesh *fine, size_t *fallback,
                         bat_error *error)
{
    mesh_levels all;
    sharp_level sharp = {0};
    bat_status status = mesh_levels_make(coarse->faces, connectivity, levels, options->threads, &all, error);
    if (status != BAT_OK)
        return status;
    double *from;
    status = array_make(&from, all.vertex_count, 3 * sizeof *from, error);
    if (status == BAT_OK)
        status = sharp_begin(coarse, connectivity, options->crease_angle, &sharp, error);
    // A power of two: coordinates keep their bits, and a boundary is the same on whichever mesh.
    double largest = closest_largest(coarse->positions, 3 * coarse->vertex_count, 0), scale = closest_scale(largest);
    *fallback = 0;
    if (status == BAT_OK)
    {
        for (size_t i = 0; i < 3 * coarse->vertex_count; i++)
            from[i] = scale * coarse->positions[i];
        status = run(rule->context, &all, options, &sharp, from, fine->positions, fallback, error);
    }
    for (size_t i = 0; i < 3 * all.vertex_count && status == BAT_OK; i++)
        fine->positions[i] /= scale;
    free(from);
    free(sharp.edge);
    free(sharp.vertex);
    split_mesh_free(&sharp.own);
    mesh_levels_free(&all);
    return status;
}

static const bat_mesh_rule RULE = {.levels = LEARNED_LEVELS_OF_MESH, .bounded = true, .refine = refine};

static bat_status make(const learn_source *source BAT_UNUSED, learn_parameters *parameters, bat_error *error)
{
    return mesh_learned_make(parameters, error);
}

static bat_status pack(const learn_source *source BAT_UNUSED, const learn_parameters *parameters, void **network,
                       bat_error *error)
{
    mesh_learned *made = malloc(sizeof *made);
    bat_status status = made == NULL ? error_memory(error, sizeof *made) : mesh_learned_pack(parameters, made, error);
    if (status == BAT_OK)
        *network = made;
    else
        free(made);
    return status;
}

static void release(void *network)
{
    if (network != NULL)
        free(((mesh_learned *)network)->memory);
    free(network);
}

const learn_network mesh_network_learned = {
    .array = "level.0.vertex_in.weight",
    .rule = &RULE,
    .make = make,
    .pack = pack,
    .free = release,
};

struct bat_mesh_model
{
    learn_model network;
    bat_mesh_rule rule;
};

static const learn_network *const NETWORKS[] = {&mesh_network_learned};
const learn_networks mesh_networks = {NETWORKS, 1, &weights_mesh};

bat_status mesh_model_read(const learn_networks *networks, const char *path, bat_mesh_model **model, bat_error *error)
{
    learn_model *read = NULL;
    bat_status status = learn_model_read(networks, path, sizeof **model, &read, error);
    if (status != BAT_OK)
        return status;
    *model = (bat_mesh_model *)read;
    (*model)->rule = *(const bat_mesh_rule *)read->kind->rule;
    (*model)->rule.context = read->network;
    return BAT_OK;
}

bat_status bat_mesh_model_read(const char *path, bat_mesh_model **model, bat_error *error)
{
    return mesh_model_read(&mesh_networks, path, model, error);
}

void bat_mesh_model_free(bat_mesh_model *model)
{
    learn_model_free((learn_model *)model);
}

const bat_mesh_rule *bat_mesh_model_rule(const bat_mesh_model *model)
{
    return &model->rule;
}
