#include "mesh/decimate/decimation.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "mesh/decimate/collapse.h"
#include "mesh/decimate/collapse_error.h"
#include "mesh/decimate/edge_queue.h"
#include "mesh/decimate/flatten.h"
#include "mesh/decimate/map.h"
#include "mesh/decimate/memoryless.h"
#include "mesh/labels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Decimation by edge collapses in order of their errors, optionally with a bijective map to the result (Liu et al., "Neural
/// Subdivision", 2020, section 4).

enum
{
    /// Attempts between two reports of progress.
    REPORT_INTERVAL = 1024,
    /// Arithmetic operations of an edge's error, roughly.
    ERROR_OPERATIONS = 300,
    /// Sweeps end when this many times the wanted vertices or faces are left, and at this number at the latest.
    SWEEP_TARGET = 3,
    SWEEP_MIN_LEFT = 100,
    /// Errors from which a sweep takes its threshold.
    SWEEP_SAMPLES = 1024
};

/// The share of the edges below the threshold of a sweep.
static const double SWEEP_SHARE = 0.6;

/// The state of a decimation.
typedef struct decimation
{
    const bat_mesh_decimate_options *options;
    const decimation_target *target;
    decimation_target initial; ///< the numbers of vertices with faces and of faces of the given mesh
    tolerance *bound;          ///< null without a bound on the distance
    attributes fields;
    collapse_mesh mesh;
    error_vertex *vertices;
    edge_queue queue;
    bool memoryless;    ///< the errors are memoryless, not quadric
    double *errors;     ///< for each edge; infinite where it must not collapse
    uint32_t *changed;  ///< for each vertex: the last collapse that changed its error; null for quadric errors in order
    uint32_t *computed; ///< for each edge: the last collapse before its error was computed; null as `changed`
    uint32_t now;       ///< the number of the last collapse
    uint8_t *waiting;   ///< for each vertex: whether one of its edges was refused and waits for changes nearby
    double *corners;    ///< for each vertex: its sharpness as a corner; null for a mesh without corners
    bat_mesh_map *map;  ///< null without a map
    flat_workspace *workspace; ///< null without a map
    collapse_ring ring;        ///< of the current edge
    double points[FLAT_POINTS][3], flat[FLAT_POINTS][2];
} decimation;

static void free_all(decimation *all)
{
    collapse_mesh_free(&all->mesh);
    edge_queue_free(&all->queue);
    free(all->vertices);
    free(all->errors);
    free(all->changed);
    free(all->computed);
    free(all->waiting);
    free(all->corners);
    free(all->workspace);
    attributes_free(&all->fields);
    bat_mesh_map_free(all->map);
    free(all);
}

static bat_status allocate(const bat_mesh *fine, bool mapped, decimation *all, bat_error *error)
{
    all->vertices = memory_array(fine->vertex_count, sizeof *all->vertices);
    all->errors = memory_array(all->mesh.edge_count, sizeof *all->errors);
    all->waiting = calloc(fine->vertex_count + 1, sizeof *all->waiting);
    all->corners = fine->corner_count > 0 ? calloc(fine->vertex_count, sizeof *all->corners) : NULL;
    bool dated = all->options->method != BAT_MESH_DECIMATE_METHOD_QUADRIC;
    all->changed = dated ? calloc(fine->vertex_count, sizeof *all->changed) : NULL;
    all->computed = dated ? calloc(all->mesh.edge_count, sizeof *all->computed) : NULL;
    all->workspace = mapped ? malloc(sizeof *all->workspace) : NULL;
    if (all->vertices == NULL || all->errors == NULL || all->waiting == NULL || (mapped && all->workspace == NULL) ||
        (dated && (all->changed == NULL || all->computed == NULL)) || (fine->corner_count > 0 && all->corners == NULL))
        return error_memory(error, fine->vertex_count * sizeof *all->vertices);
    bat_status status =
        edge_queue_make(all->mesh.edge_count, all->options->candidates, all->options->seed, &all->queue, error);
    return status == BAT_OK && mapped ? map_make(fine->face_count, &all->map, error) : status;
}

/// Compute the new vertex of an edge, and the end where it must be, or BAT_MESH_NONE. False where it must not collapse.
static bool place(const decimation *all, uint32_t edge, uint32_t *kept, error_placement *placed)
{
    if (!collapse_edge_is_allowed(&all->mesh, edge, kept))
        return false;
    if (all->memoryless)
        *placed = memoryless_place(&all->mesh, all->vertices, &all->fields, edge, *kept);
    else
        *placed = error_place(&all->mesh, all->vertices, &all->fields, edge, *kept);
    return isfinite(placed->error);
}

/// Compute the error of an edge again and update the queue.
static void update_error(decimation *all, uint32_t edge)
{
    error_placement placed;
    uint32_t kept;
    bool allowed = place(all, edge, &kept, &placed);
    all->errors[edge] = allowed ? placed.error : INFINITY;
    if (all->computed != NULL)
        all->computed[edge] = all->now;
    if (allowed)
        edge_queue_put(&all->queue, edge, placed.error);
    else
        edge_queue_remove(&all->queue, edge);
}

/// Compute the errors of all edges.
static void compute_errors(decimation *all)
{
    collapse_mesh *mesh = &all->mesh;
    int threads = threads_worth(all->options->threads, mesh->edge_count, (double)mesh->edge_count * ERROR_OPERATIONS);
#pragma omp parallel num_threads(threads)
    {
#pragma omp for schedule(static)
        for (size_t v = 0; v < mesh->vertex_count; v++)
            if (all->memoryless)
                memoryless_vertex_set(mesh, all->vertices, (uint32_t)v);
#pragma omp for schedule(static)
        for (size_t e = 0; e < mesh->edge_count; e++)
        {
            error_placement placed;
            uint32_t kept;
            bool allowed = mesh->half_edge[e] != BAT_MESH_NONE && place(all, (uint32_t)e, &kept, &placed);
            all->errors[e] = allowed ? placed.error : INFINITY;
        }
    }
}

static bat_status begin(const bat_mesh *fine, bool mapped, decimation *all, bat_error *error)
{
    bat_status status = collapse_mesh_make(fine, all->options->attributes > 0, &all->mesh, error);
    if (status == BAT_OK)
        status = allocate(fine, mapped, all, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < fine->corner_count; i++)
        all->corners[fine->corners[i].vertex] = fine->corners[i].sharpness;
    error_vertices_set(fine, &all->mesh, all->options->boundary_weight, all->vertices);
    if (all->options->attributes > 0)
        status = attributes_make(fine, &all->mesh, all->options->attributes, &all->fields, error);
    return status;
}

/// Flatten the ring before and after the collapse. False where that gives no valid map.
static bool flatten(decimation *all, const double *position)
{
    const collapse_ring *ring = &all->ring;
    memcpy(all->points[FLAT_I], all->vertices[ring->i].position, sizeof all->points[0]);
    memcpy(all->points[FLAT_J], all->vertices[ring->j].position, sizeof all->points[0]);
    memcpy(all->points[FLAT_NEW], position, sizeof all->points[0]);
    for (uint32_t k = 0; k < collapse_ring_vertices(ring); k++)
        memcpy(all->points[FLAT_RING + k], all->vertices[ring->vertex[k]].position, sizeof all->points[0]);
    return flatten_ring(ring, (const double(*)[3])all->points, all->workspace, all->flat) &&
           flat_is_valid(ring, (const double(*)[2])all->flat, all->options->min_quality);
}

/// Put the refused edges around a vertex back into the queue.
static void retry_around(decimation *all, uint32_t vertex)
{
    const collapse_mesh *mesh = &all->mesh;
    uint32_t first = mesh->first[vertex], h = first;
    all->waiting[vertex] = 0;
    do
    {
        const uint32_t edges[2] = {mesh->edge[h], mesh->edge[bat_mesh_previous(h)]};
        for (int k = 0; k < 2; k++)
            if (isfinite(all->errors[edges[k]]) && !edge_queue_has(&all->queue, edges[k]))
                edge_queue_put(&all->queue, edges[k], all->errors[edges[k]]);
        h = mesh->twin[bat_mesh_previous(h)];
    } while (h != BAT_MESH_NONE && h != first);
}

/// Set the memoryless sums of the new vertex and those around it. The errors of their edges are out of date.
static void update_sums(decimation *all)
{
    const collapse_ring *ring = &all->ring;
    all->now++;
    memoryless_vertex_set(&all->mesh, all->vertices, ring->i);
    for (uint32_t k = 0; k < collapse_ring_vertices(ring); k++)
    {
        memoryless_vertex_set(&all->mesh, all->vertices, ring->vertex[k]);
        all->changed[ring->vertex[k]] = all->now;
    }
}

/// Whether the error of an edge is that of the present mesh.
static bool is_current(const decimation *all, uint32_t edge)
{
    if (all->changed == NULL)
        return true;
    uint32_t h = all->mesh.half_edge[edge], a = all->mesh.corner[h], b = all->mesh.corner[bat_mesh_next(h)];
    return all->changed[a] <= all->computed[edge] && all->changed[b] <= all->computed[edge];
}

/// Whether an edge that left the queue still comes first. Else its error is computed again, and it goes back.
static bool comes_first(decimation *all, uint32_t edge)
{
    if (is_current(all, edge))
        return true;
    update_error(all, edge);
    return false;
}

/// Collapse the edge of the current ring; what depends on the faces around it is out of date.
static void merge(decimation *all, const error_placement *placed, uint32_t kept, uint32_t *gone, uint32_t *gone_count)
{
    const collapse_ring *ring = &all->ring;
    attributes_merge(&all->fields, &all->mesh, ring, placed->position, kept, all->vertices);
    error_merge(all->vertices, ring->i, ring->j, placed->position);
    if (all->bound != NULL)
        tolerance_apply(all->bound, ring);
    collapse_apply(&all->mesh, ring, gone, gone_count);
    if (all->corners != NULL)
        all->corners[ring->i] = fmax(all->corners[ring->i], all->corners[ring->j]);
}

/// Collapse the edge of the current ring and bring errors and queue up to date.
static void collapse(decimation *all, const error_placement *placed, uint32_t kept)
{
    const collapse_ring *ring = &all->ring;
    uint32_t gone[3], gone_count;
    merge(all, placed, kept, gone, &gone_count);
    for (uint32_t k = 0; k < gone_count; k++)
        edge_queue_remove(&all->queue, gone[k]);
    all->waiting[ring->i] = 0;
    if (all->memoryless)
        update_sums(all);
    for (uint32_t k = 0; k < ring->count; k++)
        update_error(all, all->mesh.edge[ring->half_edge[k]]);
    if (!ring->closed)
        update_error(all, all->mesh.edge[bat_mesh_previous(ring->half_edge[ring->count - 1])]);
    for (uint32_t k = 0; k < collapse_ring_vertices(ring); k++)
        if (all->waiting[ring->vertex[k]])
            retry_around(all, ring->vertex[k]);
}

/// Whether all checks allow the collapse of an edge to a position.
static bool is_sound(decimation *all, const double *position, uint32_t kept)
{
    const bat_mesh_decimate_options *options = all->options;
    return error_faces_stay_valid(all->vertices, &all->ring, position, options->min_normal, options->min_quality) &&
           attributes_stay_valid(&all->fields, &all->mesh, all->vertices, &all->ring, position, kept) &&
           (all->bound == NULL || tolerance_allows(all->bound, all->vertices, &all->ring, position)) &&
           (all->map == NULL || flatten(all, position));
}

/// Collapse an edge if all checks allow it. Otherwise the edge waits for changes nearby.
static bat_status attempt(decimation *all, uint32_t edge, bat_error *error)
{
    error_placement placed;
    uint32_t h = all->mesh.half_edge[edge], kept;
    bool sound = collapse_ring_find(&all->mesh, edge, &all->ring) && place(all, edge, &kept, &placed) &&
                 is_sound(all, placed.position, kept);
    if (!sound)
    {
        all->waiting[all->mesh.corner[h]] = all->waiting[all->mesh.corner[bat_mesh_next(h)]] = 1;
        return BAT_OK;
    }
    bat_status status = all->map == NULL ? BAT_OK : map_append(all->map, &all->ring, (const double(*)[2])all->flat, error);
    if (status == BAT_OK)
        collapse(all, &placed, kept);
    return status;
}

static bool has_reached(const decimation *all, decimation_target target)
{
    return all->mesh.vertices_left <= target.vertices || all->mesh.faces_left <= target.faces;
}

static bat_status report(const decimation *all, bat_error *error)
{
    const bat_progress *progress = &all->options->progress;
    const collapse_mesh *mesh = &all->mesh;
    size_t initial_vertices = all->initial.vertices, initial_faces = all->initial.faces;
    if (progress->report == NULL)
        return BAT_OK;
    double of_vertices = (double)(initial_vertices - mesh->vertices_left) /
                         fmax(1, (double)initial_vertices - (double)all->target->vertices),
           of_faces =
               (double)(initial_faces - mesh->faces_left) / fmax(1, (double)initial_faces - (double)all->target->faces);
    return progress->report(progress->context, fmin(1, fmax(of_vertices, of_faces)))
               ? BAT_OK
               : error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "decimation was stopped at %zu vertices",
                           mesh->vertices_left);
}

static int compare_errors(const void *a, const void *b)
{
    double of_a = *(const double *)a, of_b = *(const double *)b;
    return (of_a > of_b) - (of_a < of_b);
}

/// A threshold that about SWEEP_SHARE of the finite errors do not exceed; below all numbers when there is none. An error of
/// 0 may be unknown.
static double sweep_threshold(const decimation *all, double *samples)
{
    size_t count = 0, live = 0, step, seen = 0;
    for (size_t e = 0; e < all->mesh.edge_count; e++)
        live += isfinite(all->errors[e]) ? 1 : 0;
    step = live / SWEEP_SAMPLES + 1;
    for (size_t e = 0; e < all->mesh.edge_count; e++)
    {
        error_placement placed;
        uint32_t kept;
        if (!isfinite(all->errors[e]) || seen++ % step != 0)
            continue;
        if (all->errors[e] > 0)
            samples[count++] = all->errors[e];
        else if (place(all, (uint32_t)e, &kept, &placed))
            samples[count++] = placed.error;
    }
    if (count == 0)
        return -INFINITY;
    qsort(samples, count, sizeof *samples, compare_errors);
    return samples[(size_t)(SWEEP_SHARE * (double)count)];
}

/// Collapse an edge if its present error does not exceed a threshold and all checks allow it. Errors of the edges around are
/// out of date from then on, but too small rather than too large, since sums of squares grow.
static bat_status sweep_edge(decimation *all, uint32_t edge, double threshold, bat_error *error)
{
    error_placement placed;
    uint32_t kept, gone[3], gone_count;
    bool allowed = place(all, edge, &kept, &placed);
    all->errors[edge] = allowed ? placed.error : INFINITY;
    if (!allowed || placed.error > threshold || !collapse_ring_find(&all->mesh, edge, &all->ring) ||
        !is_sound(all, placed.position, kept))
        return BAT_OK;
    bat_status status = all->map == NULL ? BAT_OK : map_append(all->map, &all->ring, (const double(*)[2])all->flat, error);
    if (status != BAT_OK)
        return status;
    merge(all, &placed, kept, gone, &gone_count);
    for (uint32_t k = 0; k < gone_count; k++)
        all->errors[gone[k]] = INFINITY;
    return BAT_OK;
}

/// Sweep over the edges in the order of their numbers and collapse those of small errors, until a sweep changes little or
/// the target is near.
static bat_status sweep(decimation *all, bat_error *error)
{
    const decimation_target *target = all->target;
    const decimation_target until = {SWEEP_TARGET * target->vertices + SWEEP_MIN_LEFT,
                                     SWEEP_TARGET * target->faces + SWEEP_MIN_LEFT};
    double samples[SWEEP_SAMPLES];
    bat_status status = BAT_OK;
    for (size_t before = SIZE_MAX;
         all->mesh.faces_left < before - before / 64 && !has_reached(all, until) && status == BAT_OK;)
    {
        before = all->mesh.faces_left;
        double threshold = sweep_threshold(all, samples);
        for (uint32_t e = 0; e < all->mesh.edge_count && status == BAT_OK && !has_reached(all, until); e++)
        {
            if (all->errors[e] <= threshold)
                status = sweep_edge(all, e, threshold, error);
            if (status == BAT_OK && e % REPORT_INTERVAL == 0)
                status = report(all, error);
        }
    }
    return status;
}

/// Collapse edges in the order of their errors.
static bat_status run_in_order(decimation *all, bat_error *error)
{
    bat_status status = BAT_OK;
    edge_queue_fill(&all->queue, all->errors, all->mesh.edge_count);
    for (size_t i = 1; !has_reached(all, *all->target) && status == BAT_OK; i++)
    {
        uint32_t edge = edge_queue_take(&all->queue);
        if (edge == EDGE_QUEUE_ABSENT)
            break;
        if (comes_first(all, edge))
            status = attempt(all, edge, error);
        if (status == BAT_OK && i % REPORT_INTERVAL == 0)
            status = report(all, error);
    }
    return status;
}

static bat_status run(decimation *all, bat_error *error)
{
    bat_status status = BAT_OK;
    all->initial = (decimation_target){all->mesh.vertices_left, all->mesh.faces_left};
    all->memoryless =
        all->options->method == BAT_MESH_DECIMATE_METHOD_AUTO || all->options->method == BAT_MESH_DECIMATE_METHOD_MEMORYLESS;
    if (all->options->method == BAT_MESH_DECIMATE_METHOD_FAST)
    {
        memset(all->errors, 0, all->mesh.edge_count * sizeof *all->errors);
        status = sweep(all, error);
        all->memoryless = true;
    }
    if (status != BAT_OK)
        return status;
    compute_errors(all);
    return run_in_order(all, error);
}

// The result

static bat_status allocate_coarse(const decimation *all, bat_mesh *coarse, bat_error *error)
{
    const collapse_mesh *mesh = &all->mesh;
    size_t creases = 0, corners = 0;
    for (size_t e = 0; e < mesh->edge_count && mesh->sharpness != NULL; e++)
        creases += mesh->half_edge[e] != BAT_MESH_NONE && mesh->sharpness[e] > 0;
    for (size_t v = 0; v < mesh->vertex_count && all->corners != NULL; v++)
        corners += mesh->first[v] != BAT_MESH_NONE && all->corners[v] > 0;
    *coarse = (bat_mesh){.vertex_count = mesh->vertices_left,
                         .face_count = mesh->faces_left,
                         .crease_count = creases,
                         .corner_count = corners};
    coarse->positions = memory_array(mesh->vertices_left, 3 * sizeof(double));
    coarse->faces = memory_array(mesh->faces_left, 3 * sizeof(uint32_t));
    coarse->creases = creases > 0 ? memory_array(creases, sizeof *coarse->creases) : NULL;
    coarse->corners = corners > 0 ? memory_array(corners, sizeof *coarse->corners) : NULL;
    if (all->map != NULL)
        all->map->kept = memory_array(mesh->faces_left, sizeof *all->map->kept);
    if (coarse->positions != NULL && coarse->faces != NULL && (creases == 0 || coarse->creases != NULL) &&
        (corners == 0 || coarse->corners != NULL) && (all->map == NULL || all->map->kept != NULL))
        return BAT_OK;
    bat_mesh_free(coarse);
    return error_memory(error, mesh->vertices_left * 3 * sizeof(double));
}

/// Copy the remaining vertices. The stamp of a vertex becomes its new number.
static void copy_vertices(decimation *all, bat_mesh *coarse)
{
    collapse_mesh *mesh = &all->mesh;
    uint32_t count = 0, corner = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        if (mesh->first[v] == BAT_MESH_NONE)
            continue;
        memcpy(coarse->positions + 3 * (size_t)count, all->vertices[v].position, 3 * sizeof(double));
        if (coarse->corners != NULL && all->corners[v] > 0)
            coarse->corners[corner++] = (bat_mesh_corner){count, all->corners[v]};
        mesh->stamp[v] = count++;
    }
}

static void copy_faces(const decimation *all, bat_mesh *coarse)
{
    const collapse_mesh *mesh = &all->mesh;
    size_t count = 0, crease = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        if (mesh->corner[3 * f] == BAT_MESH_NONE)
            continue;
        for (size_t c = 0; c < 3; c++)
            coarse->faces[3 * count + c] = mesh->stamp[mesh->corner[3 * f + c]];
        if (all->map != NULL)
            all->map->kept[count] = (uint32_t)f;
        count++;
    }
    for (size_t e = 0; e < mesh->edge_count && coarse->creases != NULL; e++)
    {
        uint32_t h = mesh->half_edge[e];
        if (h != BAT_MESH_NONE && mesh->sharpness[e] > 0)
            coarse->creases[crease++] = (bat_mesh_crease){mesh->stamp[mesh->corner[h]],
                                                          mesh->stamp[mesh->corner[bat_mesh_next(h)]], mesh->sharpness[e]};
    }
}

/// Every coarse face keeps the label of the fine face that it remained from.
static bat_status carry_labels(const bat_mesh *fine, const collapse_mesh *mesh, bat_mesh *coarse, bat_error *error)
{
    size_t count = 0;
    uint32_t *kept = memory_array(coarse->face_count, sizeof *kept);
    if (kept == NULL)
        return error_memory(error, coarse->face_count * sizeof *kept);
    for (size_t f = 0; f < mesh->face_count; f++)
        if (mesh->corner[3 * f] != BAT_MESH_NONE)
            kept[count++] = (uint32_t)f;
    bat_status status = mesh_labels_carry(fine, kept, 1, coarse, error);
    free(kept);
    return status;
}

static bat_status finish(const bat_mesh *fine, decimation *all, bat_mesh *coarse, bat_error *error)
{
    bat_status status = allocate_coarse(all, coarse, error);
    if (status != BAT_OK)
        return status;
    copy_vertices(all, coarse);
    copy_faces(all, coarse);
    status = attributes_finish(&all->fields, fine, &all->mesh, coarse, error);
    if (status == BAT_OK)
        status = carry_labels(fine, &all->mesh, coarse, error);
    if (status == BAT_OK && all->map != NULL)
        status = map_finish(all->map, fine, coarse, error);
    if (status != BAT_OK)
        bat_mesh_free(coarse);
    return status;
}

bat_status decimation_run(const bat_mesh *fine, const bat_mesh_decimate_options *options, const decimation_target *target,
                          tolerance *bound, bat_mesh *coarse, bat_mesh_map **map, bat_error *error)
{
    decimation *all = calloc(1, sizeof *all);
    if (all == NULL)
        return error_memory(error, sizeof *all);
    all->options = options;
    all->target = target;
    all->bound = bound;
    bat_mesh made = {0};
    bat_status status = begin(fine, map != NULL, all, error);
    if (status == BAT_OK)
        status = run(all, error);
    if (status == BAT_OK)
        status = finish(fine, all, &made, error);
    if (status == BAT_OK)
    {
        *coarse = made;
        if (map != NULL)
            *map = all->map;
        all->map = NULL;
    }
    free_all(all);
    return status;
}
