#include "research/train/mesh_pairs.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "batten/mesh_decimate.h"
#include "batten/mesh_refine.h"
#include "research/train/mesh_targets.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum
{
    CANDIDATES = 100 ///< random edges, of which the one of smallest error is collapsed (appendix E)
};

static size_t vertices_at(const mesh_levels *levels, size_t level)
{
    return level < levels->count ? levels->level[level].vertex_count : levels->vertex_count;
}

// Targets

/// The map's images of the vertices. Vertices keep their indices from level to level, so all levels share one array.
static bat_status map_targets(const bat_mesh *shape, const bat_mesh_map *map, mesh_pair *pair, bat_error *error)
{
    size_t numbers = 3 * pair->levels.vertex_count;
    pair->memory = memory_array(2 * numbers, sizeof *pair->memory);
    if (pair->memory == NULL)
        return error_memory(error, 2 * numbers * sizeof *pair->memory);
    for (size_t level = 0; level <= pair->levels.count; level++)
        pair->target[level] = pair->memory;
    pair->normals = pair->memory + numbers;
    return mesh_map_targets(map, shape, &pair->coarse, pair->levels.count, pair->memory, pair->memory + numbers, error);
}

/// Loop's refinements of the coarse mesh, level after level.
static bat_status loop_targets(mesh_pair *pair, bat_error *error)
{
    size_t levels = pair->levels.count, total = 0;
    for (size_t level = 0; level <= levels; level++)
        total += 3 * vertices_at(&pair->levels, level);
    pair->memory = memory_array(total, sizeof *pair->memory);
    if (pair->memory == NULL)
        return error_memory(error, total * sizeof *pair->memory);
    double *to = pair->memory;
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LOOP;
    options.threads = 1;
    for (size_t level = 0; level <= levels; level++)
    {
        bat_mesh fine;
        options.levels = level;
        bat_status status = bat_mesh_refine(&pair->coarse, &options, &fine, NULL, error);
        if (status != BAT_OK)
            return status;
        assert(fine.vertex_count == vertices_at(&pair->levels, level));
        memcpy(to, fine.positions, 3 * fine.vertex_count * sizeof *to);
        pair->target[level] = to;
        to += 3 * fine.vertex_count;
        bat_mesh_free(&fine);
    }
    return BAT_OK;
}

// One pair

static bat_status make_levels(const bat_mesh *coarse, size_t count, mesh_levels *levels, bat_error *error)
{
    bat_mesh_connectivity connectivity;
    bat_status status = bat_mesh_connect(coarse, &connectivity, error);
    if (status != BAT_OK)
        return status;
    status = mesh_levels_make(coarse->faces, &connectivity, count, 1, levels, error);
    bat_mesh_connectivity_free(&connectivity);
    return status;
}

bat_status mesh_pair_make(const bat_mesh *shape, const mesh_pair_plan *plan, uint64_t seed, mesh_pair *pair,
                          bat_error *error)
{
    assert(plan->levels >= 1 && plan->levels <= MESH_PAIR_MAX_LEVELS);
    bat_random random = bat_random_seed(seed);
    double spread = (double)(plan->max_vertices - plan->min_vertices + 1);
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.method = BAT_MESH_DECIMATE_METHOD_QUADRIC;
    options.attributes = 0;
    options.vertices = plan->min_vertices + (size_t)(spread * bat_random_uniform(&random));
    if (options.vertices > shape->vertex_count)
        options.vertices = shape->vertex_count;
    options.candidates = CANDIDATES;
    options.seed = bat_random_bits(&random);
    options.min_normal = plan->min_normal;
    options.min_quality = plan->min_quality;
    mesh_pair made = {0};
    bat_mesh_map *map = NULL;
    bat_status status = bat_mesh_decimate(shape, &options, &made.coarse, plan->loop ? NULL : &map, error);
    if (status == BAT_OK)
        status = make_levels(&made.coarse, plan->levels, &made.levels, error);
    if (status == BAT_OK)
        status = plan->loop ? loop_targets(&made, error) : map_targets(shape, map, &made, error);
    bat_mesh_map_free(map);
    if (status == BAT_OK)
        *pair = made;
    else
        mesh_pair_free(&made);
    return status;
}

void mesh_pair_free(mesh_pair *pair)
{
    bat_mesh_free(&pair->coarse);
    mesh_levels_free(&pair->levels);
    free(pair->memory);
    *pair = (mesh_pair){0};
}

// Many

bat_status mesh_pairs_begin(const bat_mesh *shapes, size_t shape_count, size_t count, const mesh_pair_plan *plan,
                            uint64_t seed, size_t resampled, mesh_pairs *pairs, bat_error *error)
{
    mesh_pairs made = {.shapes = shapes,
                       .shape_count = shape_count,
                       .plan = *plan,
                       .seed = seed,
                       .resampled = resampled < count ? resampled : count,
                       .pair = calloc(count, sizeof *made.pair),
                       .made_for = calloc(count, sizeof *made.made_for),
                       .count = count};
    if (made.pair == NULL || made.made_for == NULL)
    {
        free(made.pair);
        free(made.made_for);
        return error_memory(error, count * sizeof *made.pair);
    }
    *pairs = made;
    return BAT_OK;
}

uint64_t mesh_pair_epoch(size_t count, size_t resampled, size_t p, uint64_t epoch)
{
    uint64_t renewed = epoch * resampled;
    if (renewed <= p)
        return 0;
    uint64_t last = (renewed - 1 - p) / count * count + p;
    return last / resampled + 1;
}

uint64_t mesh_pair_seed(uint64_t seed, size_t p, uint64_t epoch)
{
    bat_random random = bat_random_seed(seed);
    uint64_t of_pair = bat_random_bits(&random) + p;
    random = bat_random_seed(of_pair);
    return bat_random_bits(&random) + epoch;
}

static bat_status renew_pair(mesh_pairs *pairs, size_t p, uint64_t epoch, bat_error *error)
{
    mesh_pair made;
    bat_status status = mesh_pair_make(&pairs->shapes[p % pairs->shape_count], &pairs->plan,
                                       mesh_pair_seed(pairs->seed, p, epoch), &made, error);
    if (status != BAT_OK)
        return status;
    mesh_pair_free(&pairs->pair[p]);
    pairs->pair[p] = made;
    pairs->made_for[p] = epoch + 1;
    return BAT_OK;
}

bat_status mesh_pairs_renew(mesh_pairs *pairs, uint64_t epoch, const bool *wanted, int threads, bat_progress progress,
                            bat_error *error)
{
    shared_work work = shared_work_make(pairs->count, progress);
#pragma omp parallel for schedule(dynamic) num_threads(threads_for(threads, pairs->count))
    for (size_t p = 0; p < pairs->count; p++)
    {
        bat_error own;
        bat_status status = BAT_OK;
        uint64_t from = mesh_pair_epoch(pairs->count, pairs->resampled, p, epoch);
        if (!shared_work_wants(&work, p))
            continue;
        if ((wanted == NULL || wanted[p]) && pairs->made_for[p] != from + 1)
            status = renew_pair(pairs, p, from, &own);
        shared_work_finish(&work, p, status, &own);
    }
    return shared_work_end(&work, error);
}

void mesh_pairs_free(mesh_pairs *pairs)
{
    for (size_t p = 0; p < pairs->count && pairs->pair != NULL; p++)
        mesh_pair_free(&pairs->pair[p]);
    free(pairs->pair);
    free(pairs->made_for);
    *pairs = (mesh_pairs){0};
}
