#include "base/choice.h"
#include "base/option.h"
#include "base/progress.h"
#include "base/threads.h"
#include "batten/mesh_measure.h"
#include "mesh/check.h"
#include "mesh/decimate/collapse_error.h"
#include "mesh/decimate/map.h"
#include "mesh/labels.h"

/// @file
/// Options and targets of decimation, and the measured bound on the distance.

// Decimation by edge collapses in order of their errors, optionally with a bijective map to the result (Liu et al., "Neural
// Subdivision", 2020, section 4).

/// Where a run ends: at either number.
typedef struct decimation_target
{
    size_t vertices, faces;
} decimation_target;

enum
{
    /// Attempts between two reports of progress.
    REPORT_INTERVAL = 1024,
    /// Arithmetic operations of an edge's error, roughly.
    ERROR_OPERATIONS = 300,
    /// Quadric sweeps end when this many times the wanted vertices or faces are left, and at this number at the latest.
    SWEEP_TARGET_FAST = 6,
    SWEEP_TARGET_BALANCED = 8,
    SWEEP_MIN_LEFT = 100,
    /// Errors from which a sweep takes its threshold.
    SWEEP_SAMPLES = 1024
};

/// The share of the edges below the threshold of a sweep; the largest one by memoryless errors.
static const double SWEEP_SHARE = 0.6, SWEEP_SHARE_MEMORYLESS = 0.5;
/// A refused edge comes again at so many times the threshold.
static const double REFUSED = 2;
/// The first guess of a sweep's decrease of the faces, divided by its share of the edges.
static const double SWEEP_YIELD = 0.9;
/// The share of the faces above the target that a memoryless sweep removes, and more of them by this share of all.
static const double SWEEP_STEP = 0.7, SWEEP_SLACK = 0.01;

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
    bool sweeping;      ///< without a queue; memoryless sums are updated, not set
    double *errors;     ///< for each edge; infinite where it must not collapse
    uint32_t *changed;  ///< for each vertex: the last collapse that changed its error; null for quadric errors in order
    uint32_t *computed; ///< for each edge: the last collapse before its error was computed; null as `changed`
    uint32_t now;       ///< the number of the last collapse
    uint8_t *waiting;   ///< for each vertex: whether one of its edges was refused and waits for changes nearby
    double *corners;    ///< for each vertex: its sharpness as a corner; null for a mesh without corners
    bat_mesh_map *map;  ///< null without a map
    flat_workspace *workspace; ///< null without a map
    memory_pool pool;          ///< of the arrays, the queue, the fields and the workspace
    collapse_ring ring;        ///< of the current edge
    double points[FLAT_POINTS][3], flat[FLAT_POINTS][2];
} decimation;

static bat_status allocate(const bat_mesh *fine, bool mapped, decimation *all, bat_error *error)
{
    all->vertices = memory_pool_array(&all->pool, fine->vertex_count, sizeof *all->vertices);
    all->errors = memory_pool_array(&all->pool, all->mesh.edge_count, sizeof *all->errors);
    all->waiting = memory_pool_zeros(&all->pool, fine->vertex_count + 1, sizeof *all->waiting);
    all->corners = fine->corner_count > 0 ? memory_pool_zeros(&all->pool, fine->vertex_count, sizeof *all->corners) : NULL;
    bool dated = all->options->method != BAT_MESH_DECIMATE_METHOD_QUADRIC;
    all->changed = dated ? memory_pool_zeros(&all->pool, fine->vertex_count, sizeof *all->changed) : NULL;
    all->computed = dated ? memory_pool_zeros(&all->pool, all->mesh.edge_count, sizeof *all->computed) : NULL;
    all->workspace = mapped ? memory_pool_array(&all->pool, 1, sizeof *all->workspace) : NULL;
    bat_status status = memory_pool_check(&all->pool, error);
    if (status == BAT_OK)
        status = edge_queue_make(all->mesh.edge_count, all->options->candidates, all->options->seed, &all->pool, &all->queue,
                                 error);
    all->map = mapped ? calloc(1, sizeof *all->map) : NULL;
    return status == BAT_OK && mapped && all->map == NULL ? error_memory(error, sizeof *all->map) : status;
}

/// Compute the new vertex of an edge, and the end where it must be, or BAT_MESH_NONE. False where it must not collapse.
static bool place(const decimation *all, uint32_t edge, uint32_t *kept, error_placement *placed)
{
    if (!collapse_edge_is_allowed(&all->mesh, edge, kept))
        return false;
    *placed = all->memoryless ? memoryless_place(&all->mesh, all->vertices, &all->fields, edge, *kept, all->sweeping)
                              : error_place(&all->mesh, all->vertices, &all->fields, edge, *kept);
    return isfinite(placed->error);
}

/// The error of an edge; infinite where it must not collapse.
static double error_of(const decimation *all, uint32_t edge)
{
    error_placement placed;
    uint32_t kept;
    return place(all, edge, &kept, &placed) ? placed.error : INFINITY;
}

/// Compute the error of an edge again and update the queue.
static void update_error(decimation *all, uint32_t edge)
{
    all->errors[edge] = error_of(all, edge);
    if (all->computed != NULL)
        all->computed[edge] = all->now;
    if (isfinite(all->errors[edge]))
        edge_queue_put(&all->queue, edge, all->errors[edge]);
    else
        edge_queue_remove(&all->queue, edge);
}

/// Compute the errors of all edges; before sweeps they are 0, which stands for unknown.
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
            all->errors[e] = mesh->half_edge[e] == BAT_MESH_NONE ? INFINITY : all->sweeping ? 0 : error_of(all, (uint32_t)e);
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
    for (size_t v = 0; v < fine->vertex_count; v++)
        memcpy(all->vertices[v].position, fine->positions + 3 * v, sizeof all->vertices->position);
    if (all->options->attributes > 0)
        status = attributes_make(fine, &all->mesh, all->options->attributes, &all->pool, &all->fields, error);
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

/// Whether an edge that left the queue still comes first: its error is that of the present mesh. Else it is computed again,
/// and the edge goes back.
static bool comes_first(decimation *all, uint32_t edge)
{
    uint32_t h = all->mesh.half_edge[edge], a = all->mesh.corner[h], b = all->mesh.corner[bat_mesh_next(h)];
    if (all->changed == NULL || (all->changed[a] <= all->computed[edge] && all->changed[b] <= all->computed[edge]))
        return true;
    update_error(all, edge);
    return false;
}

/// Collapse the edge of the current ring; what depends on the faces around it is out of date.
static void merge(decimation *all, const error_placement *placed, uint32_t kept, uint32_t *gone, uint32_t *gone_count)
{
    const collapse_ring *ring = &all->ring;
    attributes_merge(&all->fields, &all->mesh, ring, placed->position, kept, all->vertices);
    if (all->sweeping && all->memoryless)
        memoryless_merge(all->vertices, ring, placed->position);
    else
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

/// A threshold that about a share of the finite errors do not exceed; below all numbers when there is none. An error of 0
/// may be unknown.
static double sweep_threshold(const decimation *all, double share)
{
    double samples[SWEEP_SAMPLES];
    size_t count = 0, live = 0, step, seen = 0;
    for (size_t e = 0; e < all->mesh.edge_count; e++)
        live += isfinite(all->errors[e]) ? 1 : 0;
    step = live / SWEEP_SAMPLES + 1;
    for (size_t e = 0; e < all->mesh.edge_count; e++)
    {
        if (!isfinite(all->errors[e]) || seen++ % step != 0)
            continue;
        double sample = all->errors[e] > 0 ? all->errors[e] : error_of(all, (uint32_t)e);
        if (isfinite(sample))
            samples[count++] = sample;
    }
    if (count == 0)
        return -INFINITY;
    qsort(samples, count, sizeof *samples, ascending);
    return samples[(size_t)(share * (double)count)];
}

/// Collapse an edge if its present error does not exceed a threshold and all checks allow it. Errors of the edges around are
/// out of date from then on, but too small rather than too large, since sums of squares and faces grow.
static bat_status sweep_edge(decimation *all, uint32_t edge, double threshold, bat_error *error)
{
    error_placement placed;
    uint32_t kept, gone[3], gone_count;
    bool allowed = place(all, edge, &kept, &placed);
    all->errors[edge] = allowed ? placed.error : INFINITY;
    if (!allowed || placed.error > threshold)
        return BAT_OK;
    if (!collapse_ring_find(&all->mesh, edge, &all->ring) || !is_sound(all, placed.position, kept))
    {
        if (all->options->method == BAT_MESH_DECIMATE_METHOD_FAST)
            all->errors[edge] = REFUSED * threshold;
        return BAT_OK;
    }
    bat_status status = all->map == NULL ? BAT_OK : map_append(all->map, &all->ring, (const double(*)[2])all->flat, error);
    if (status != BAT_OK)
        return status;
    merge(all, &placed, kept, gone, &gone_count);
    for (uint32_t k = 0; k < gone_count; k++)
        all->errors[gone[k]] = INFINITY;
    return BAT_OK;
}

/// Sweep over the edges in the order of their numbers and collapse those of small errors, until a sweep changes little or
/// the target is reached. Memoryless sweeps take fewer edges near it, so that the last one comes to its end.
static bat_status sweep(decimation *all, decimation_target until, bat_error *error)
{
    bat_status status = BAT_OK;
    double yield = SWEEP_YIELD, share = SWEEP_SHARE;
    for (bool more = true; more && !has_reached(all, until) && status == BAT_OK;)
    {
        double before = (double)all->mesh.faces_left,
               left = fmin(before - (double)until.faces, 2 * ((double)all->mesh.vertices_left - (double)until.vertices));
        if (all->memoryless)
            share = fmin(SWEEP_SHARE_MEMORYLESS, (SWEEP_STEP * left / before + SWEEP_SLACK) / yield);
        double threshold = sweep_threshold(all, share);
        for (uint32_t e = 0; e < all->mesh.edge_count && status == BAT_OK && !has_reached(all, until); e++)
        {
            if (all->errors[e] <= threshold)
                status = sweep_edge(all, e, threshold, error);
            if (status == BAT_OK && e % REPORT_INTERVAL == 0)
                status = report(all, error);
        }
        double gone = before - (double)all->mesh.faces_left;
        yield = fmax(gone / (share * before), yield / 4);
        more = all->memoryless ? share < SWEEP_SHARE_MEMORYLESS || gone > left / 8 : gone > floor(before / 64);
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
    const decimation_target target = *all->target;
    all->initial = (decimation_target){all->mesh.vertices_left, all->mesh.faces_left};
    const bat_mesh_decimate_method method = all->options->method;
    bool fast = method == BAT_MESH_DECIMATE_METHOD_FAST, counted = target.vertices + target.faces > 0;
    bool balanced = counted && (method == BAT_MESH_DECIMATE_METHOD_BALANCED || method == BAT_MESH_DECIMATE_METHOD_AUTO);
    size_t times = fast ? SWEEP_TARGET_FAST : SWEEP_TARGET_BALANCED;
    const decimation_target until = {times * target.vertices + SWEEP_MIN_LEFT, times * target.faces + SWEEP_MIN_LEFT};
    all->sweeping = (fast || balanced) && !has_reached(all, until);
    all->memoryless = method != BAT_MESH_DECIMATE_METHOD_QUADRIC && !all->sweeping;
    if (!all->memoryless)
        error_vertices_set(&all->mesh, all->options->boundary_weight, all->vertices);
    if (all->sweeping)
    {
        compute_errors(all);
        status = sweep(all, until, error);
        all->memoryless = true;
    }
    all->sweeping = fast && counted && all->options->candidates == 0;
    if (all->sweeping && status == BAT_OK)
    {
        compute_errors(all);
        status = sweep(all, target, error);
    }
    all->sweeping = false;
    if (status != BAT_OK || has_reached(all, target))
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
    if (coarse->positions != NULL && coarse->faces != NULL && (creases == 0 || coarse->creases != NULL) &&
        (corners == 0 || coarse->corners != NULL))
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

/// Copy the remaining faces; `kept` receives their numbers before.
static void copy_faces(const decimation *all, uint32_t *kept, bat_mesh *coarse)
{
    const collapse_mesh *mesh = &all->mesh;
    size_t count = 0, crease = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        if (mesh->corner[3 * f] == BAT_MESH_NONE)
            continue;
        for (size_t c = 0; c < 3; c++)
            coarse->faces[3 * count + c] = mesh->stamp[mesh->corner[3 * f + c]];
        kept[count++] = (uint32_t)f;
    }
    for (size_t e = 0; e < mesh->edge_count && coarse->creases != NULL; e++)
    {
        uint32_t h = mesh->half_edge[e];
        if (h != BAT_MESH_NONE && mesh->sharpness[e] > 0)
            coarse->creases[crease++] = (bat_mesh_crease){mesh->stamp[mesh->corner[h]],
                                                          mesh->stamp[mesh->corner[bat_mesh_next(h)]], mesh->sharpness[e]};
    }
}

static bat_status finish(const bat_mesh *fine, decimation *all, bat_mesh *coarse, bat_error *error)
{
    uint32_t *kept = memory_array(all->mesh.faces_left, sizeof *kept);
    bat_status status = kept != NULL ? allocate_coarse(all, coarse, error) : error_memory(error, all->mesh.faces_left);
    if (status == BAT_OK)
    {
        copy_vertices(all, coarse);
        copy_faces(all, kept, coarse);
        status = attributes_finish(&all->fields, fine, &all->mesh, coarse, error);
    }
    if (status == BAT_OK)
        status = mesh_labels_carry(fine, kept, 1, coarse, error);
    if (all->map != NULL)
        all->map->kept = kept;
    else
        free(kept);
    if (status == BAT_OK && all->map != NULL)
        status = map_finish(all->map, fine, coarse, error);
    if (status != BAT_OK)
        bat_mesh_free(coarse);
    return status;
}

/// Collapse edges until the target is reached or no further collapse passes the checks.
/// @param options checked; the targets among them are not read
/// @param bound   null, or the tolerance of a fresh run
/// @return as bat_mesh_decimate()
static bat_status decimation_run(const bat_mesh *fine, const bat_mesh_decimate_options *options,
                                 const decimation_target *target, tolerance *bound, bat_mesh *coarse, bat_mesh_map **map,
                                 bat_error *error)
{
    decimation *all = calloc(1, sizeof *all);
    if (all == NULL)
        return error_memory(error, sizeof *all);
    all->options = options;
    all->target = target;
    all->bound = bound;
    bat_status status = begin(fine, map != NULL, all, error);
    if (status == BAT_OK)
        status = run(all, error);
    if (status == BAT_OK)
        status = finish(fine, all, coarse, error);
    if (status == BAT_OK && map != NULL)
        SWAP(*map, all->map);
    collapse_mesh_free(&all->mesh);
    memory_pool_free(&all->pool);
    bat_mesh_map_free(all->map);
    free(all);
    return status;
}

enum
{
    /// Runs with ever smaller tolerances until the measured distance keeps the bound.
    MAX_RUNS = 8,
    /// The most samples of a measurement for each given face, beside the default ones, and the factor between attempts.
    MAX_SAMPLES_PER_FACE = 200,
    SAMPLE_FACTOR = 4
};

/// The greatest such ratio where the bound is not exceeded but not proven either.
static const double UNPROVEN = 2;
/// The relative accuracy of the measured distance.
static const double ACCURACY = 0.01;

/// The factor between a tolerance and the next one, beside the ratio by which the result exceeded the bound.
static const double SHRINK = 0.98;

static const bat_choice METHODS[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "balanced", BAT_MESH_DECIMATE_METHOD_AUTO),
    CHOICE("quadric", "squared distances from the planes of the given faces (Garland and Heckbert)",
           BAT_MESH_DECIMATE_METHOD_QUADRIC),
    CHOICE("memoryless", "squared volumes to the present faces, at preserved volume (Lindstrom and Turk)",
           BAT_MESH_DECIMATE_METHOD_MEMORYLESS),
    CHOICE("fast", "quadric errors in sweeps to six times the target, then memoryless errors",
           BAT_MESH_DECIMATE_METHOD_FAST),
    CHOICE("even", "memoryless errors twice, the second time within three fifths of the greatest distance",
           BAT_MESH_DECIMATE_METHOD_EVEN),
    CHOICE("balanced", "quadric errors in sweeps to eight times the target, then memoryless errors",
           BAT_MESH_DECIMATE_METHOD_BALANCED),
};
const bat_family bat_mesh_decimate_method_family = FAMILY("decimation method", METHODS);

bat_mesh_decimate_options bat_mesh_decimate_defaults(void)
{
    return (bat_mesh_decimate_options){.method = BAT_MESH_DECIMATE_METHOD_BALANCED,
                                       .seed = 1,
                                       .min_normal = 0.2,
                                       .min_quality = 0.1,
                                       .boundary_weight = 1000,
                                       .attributes = 0.5};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_mesh_decimate_options, ratio, OPTION_NUMBER, 0, 1),
    OPTION_FIELD(bat_mesh_decimate_options, tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_FAMILY(bat_mesh_decimate_options, method, bat_mesh_decimate_method_family),
    OPTION_FIELD(bat_mesh_decimate_options, min_normal, OPTION_NUMBER, -1, 1),
    OPTION_FIELD(bat_mesh_decimate_options, min_quality, OPTION_NUMBER, 0, 1),
    OPTION_FIELD(bat_mesh_decimate_options, boundary_weight, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_mesh_decimate_options, attributes, OPTION_NUMBER, 0, INFINITY),
    OPTION_THREADS(bat_mesh_decimate_options),
};

static bat_status mesh_decimate_options_check(const void *opaque, bat_error *error)
{
    const bat_mesh_decimate_options *options = opaque;
    int targets = (options->vertices > 0) + (options->faces > 0) + (options->ratio > 0) + (options->tolerance > 0);
    if (targets <= 1)
        return BAT_OK;
    return ERROR_ARGUMENT(error, "vertices, faces, ratio and error exclude each other, but %d of them are set", targets);
}

const bat_options_table bat_mesh_decimate_fields =
    OPTIONS_TABLE(bat_mesh_decimate_options, FIELDS, mesh_decimate_options_check);

/// The numbers of vertices and faces to stop at.
static bat_status find_target(const bat_mesh *fine, const bat_mesh_decimate_options *options, decimation_target *target,
                              bat_error *error)
{
    if (options->vertices > fine->vertex_count)
        return ERROR_ARGUMENT(error, "the mesh has %zu vertices, fewer than the %zu wanted", fine->vertex_count,
                              options->vertices);
    if (options->faces > fine->face_count)
        return ERROR_ARGUMENT(error, "the mesh has %zu faces, fewer than the %zu wanted", fine->face_count, options->faces);
    *target = (decimation_target){options->vertices, options->faces};
    if (options->ratio > 0)
        target->faces = (size_t)fmax(1, options->ratio * (double)fine->face_count);
    return BAT_OK;
}

/// The bound on the distance as a length.
static double bound_of(const bat_mesh *fine, const bat_mesh_decimate_options *options)
{
    if (!options->relative_tolerance)
        return options->tolerance;
    double low[3], high[3];
    box_clear(3, low, high);
    for (size_t i = 0; i < 3 * fine->face_count; i++)
        box_include(3, fine->positions + 3 * (size_t)fine->faces[i], low, high);
    return options->tolerance * vector3_distance(low, high);
}

/// Release a result.
static void drop(bat_mesh *coarse, bat_mesh_map **map)
{
    bat_mesh_free(coarse);
    if (map == NULL)
        return;
    bat_mesh_map_free(*map);
    *map = NULL;
}

/// The part of the progress that one of several attempts gets: half of what remains.
static progress_part part_of_attempt(progress_part whole, int attempt)
{
    double begin = 1 - ldexp(1, -attempt);
    return (progress_part){whole.whole, whole.begin + begin * whole.length, (1 - begin) / 2 * whole.length};
}

/// Measure a result. Samples are added as long as the greatest distance found keeps the bound and the proven one does not.
/// The proof need not be sharper than the bound.
static bat_status measure(const bat_mesh *fine, const bat_mesh *coarse, const bat_mesh_decimate_options *options,
                          double bound, progress_part progress, bat_mesh_distance *distance, bat_error *error)
{
    bat_mesh_compare_options how = bat_mesh_compare_defaults();
    bat_status status = BAT_OK;
    how.threads = options->threads;
    how.tolerance = ACCURACY;
    size_t most = how.samples + MAX_SAMPLES_PER_FACE * fine->face_count;
    bool again = true;
    for (int attempt = 0; again && status == BAT_OK; attempt++, how.samples *= SAMPLE_FACTOR)
    {
        progress_part part = part_of_attempt(progress, attempt);
        how.progress = progress_of_part(&part);
        status = bat_mesh_compare(coarse, fine, &how, distance, error);
        again = distance->hausdorff <= bound && distance->hausdorff_bound > bound && SAMPLE_FACTOR * how.samples <= most;
        if (again && distance->hausdorff > 0)
            how.tolerance = fmax(ACCURACY, (1 - ACCURACY) * (bound / distance->hausdorff - 1));
    }
    if (status == BAT_CANCELLED)
        return error_set(error, status, BAT_NO_INDEX, 0, "decimation was stopped while its distance was measured");
    return status;
}

/// Decimate with one tolerance and measure the result. The first half of the progress belongs to collapses.
static bat_status run_once(const bat_mesh *fine, const bat_mesh_connectivity *topology,
                           const bat_mesh_decimate_options *options, double allowed, double bound, progress_part progress,
                           bat_mesh *coarse, bat_mesh_map **map, bat_mesh_distance *distance, bat_error *error)
{
    static const decimation_target END = {0, 0};
    bat_mesh_decimate_options how = *options;
    tolerance checks;
    bat_status status = tolerance_make(fine, topology, allowed, &checks, error);
    if (status != BAT_OK)
        return status;
    progress_part first = part_of_attempt(progress, 0), second = part_of_attempt(progress, 1);
    second.length *= 2;
    how.progress = progress_of_part(&first);
    status = decimation_run(fine, &how, &END, &checks, coarse, map, error);
    tolerance_free(&checks);
    if (status != BAT_OK)
        return status;
    status = measure(fine, coarse, options, bound, second, distance, error);
    if (status != BAT_OK)
        drop(coarse, map);
    return status;
}

/// Run with smaller and smaller tolerances until the measured distance keeps the bound. If none does, nothing collapses.
static bat_status run_within(const bat_mesh *fine, const bat_mesh_decimate_options *options, bat_mesh *coarse,
                             bat_mesh_map **map, bat_error *error)
{
    const decimation_target whole = {fine->vertex_count, fine->face_count};
    const progress_part progress = {options->progress, 0, 1};
    double bound = bound_of(fine, options), allowed = bound;
    bat_mesh_connectivity topology;
    bat_mesh_distance distance = {0};
    bat_status status = bat_mesh_connect(fine, &topology, error);
    if (status != BAT_OK)
        return status;
    bool kept = false;
    for (int run = 0; run < MAX_RUNS && status == BAT_OK && !kept; run++)
    {
        status = run_once(fine, &topology, options, allowed, bound, part_of_attempt(progress, run), coarse, map, &distance,
                          error);
        kept = status == BAT_OK && distance.hausdorff_bound <= bound;
        if (status != BAT_OK || kept)
            break;
        drop(coarse, map);
        double exceeded = distance.hausdorff > bound ? distance.hausdorff : fmin(distance.hausdorff_bound, UNPROVEN * bound);
        allowed *= bound / exceeded * SHRINK;
    }
    bat_mesh_connectivity_free(&topology);
    if (status == BAT_OK && !kept)
    {
        distance.hausdorff_bound = 0;
        status = decimation_run(fine, options, &whole, NULL, coarse, map, error);
    }
    if (status == BAT_OK && options->distance != NULL)
        *options->distance = distance.hausdorff_bound;
    return status;
}

/// Decimate by memoryless errors, then again with ever less strict bounds on the distance, shares of the greatest one that
/// came out. The first run that reaches the target under its bound gives the result, else the one without a bound.
static bat_status run_even(const bat_mesh *fine, const bat_mesh_decimate_options *options, const decimation_target *target,
                           bat_mesh *coarse, bat_mesh_map **map, bat_error *error)
{
    static const double shares[] = {0.6, 0.75, 0.9};
    const size_t RUNS = sizeof shares / sizeof *shares;
    bat_mesh_decimate_options how = *options;
    bat_mesh_connectivity topology;
    bat_mesh_distance distance;
    progress_part part = {options->progress, 0, 1.0 / (double)(RUNS + 1)};
    how.method = BAT_MESH_DECIMATE_METHOD_MEMORYLESS;
    how.progress = progress_of_part(&part);
    bat_status status = bat_mesh_connect(fine, &topology, error);
    if (status != BAT_OK)
        return status;
    status = decimation_run(fine, &how, target, NULL, coarse, map, error);
    if (status == BAT_OK)
        status = measure(fine, coarse, options, INFINITY, (progress_part){{0}, 0, 1}, &distance, error);
    bool reached = false;
    for (size_t run = 0; run < RUNS && status == BAT_OK && !reached && distance.hausdorff > 0; run++)
    {
        bat_mesh even = {0};
        bat_mesh_map *even_map = NULL;
        tolerance bound;
        part.begin = (double)(run + 1) / (double)(RUNS + 1);
        status = tolerance_make(fine, &topology, shares[run] * distance.hausdorff, &bound, error);
        if (status != BAT_OK)
            break;
        status = decimation_run(fine, &how, target, &bound, &even, map != NULL ? &even_map : NULL, error);
        tolerance_free(&bound);
        reached = status == BAT_OK && even.face_count <= coarse->face_count;
        if (reached)
        {
            drop(coarse, map);
            *coarse = even;
            if (map != NULL)
                *map = even_map;
        }
        else
            drop(&even, &even_map);
    }
    bat_mesh_connectivity_free(&topology);
    if (status != BAT_OK)
        drop(coarse, map);
    return status;
}

bat_status bat_mesh_decimate(const bat_mesh *fine, const bat_mesh_decimate_options *options, bat_mesh *coarse,
                             bat_mesh_map **map, bat_error *error)
{
    const bat_mesh_decimate_options defaults = bat_mesh_decimate_defaults();
    decimation_target target;
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_mesh_decimate_fields, options, error);
    if (status == BAT_OK)
        status = mesh_check_triangles(fine, error);
    if (status == BAT_OK)
        status = find_target(fine, options, &target, error);
    if (status != BAT_OK)
        return status;
    bat_mesh made = {0};
    bat_mesh_map *made_map = NULL, **to = map != NULL ? &made_map : NULL;
    if (options->tolerance > 0)
        status = run_within(fine, options, &made, to, error);
    else if (options->method == BAT_MESH_DECIMATE_METHOD_EVEN)
        status = run_even(fine, options, &target, &made, to, error);
    else
        status = decimation_run(fine, options, &target, NULL, &made, to, error);
    if (status != BAT_OK)
        return status;
    *coarse = made;
    if (map != NULL)
        *map = made_map;
    return BAT_OK;
}
