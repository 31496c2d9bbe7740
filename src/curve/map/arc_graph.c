#include "curve/map/arc_refine.h"

#include "base/error.h"
#include "curve/polygon.h"

enum
{
    /// Neighbours of a vertex that are told apart. A vertex with more is a node in any case.
    MAX_NEIGHBOURS = 5,
    /// The neighbours where two lines cross.
    CROSSING_NEIGHBOURS = 4
};

/// A vertex of the set: a point, wherever it occurs.
typedef struct map_vertex
{
    size_t neighbours[CROSSING_NEIGHBOURS];
    size_t arc, place; ///< an arc with this vertex in its inside and the index there; BAT_NO_INDEX for none yet
    unsigned char neighbour_count;
    unsigned char passes; ///< times that a curve passes, counted up to MAX_NEIGHBOURS
    bool in_ring;
    bool node; ///< an end, a corner or the tip of a path that returns; at last, whether arcs end here
    bool crossing;
} map_vertex;

/// Work on the way to the graph.
typedef struct graph_job
{
    const bat_curve *curves;
    size_t count, dim, point_count;
    size_t *first_point; ///< of each curve, in `ids`
    size_t *ids;         ///< the vertex of each point
    map_vertex *vertices;
    size_t vertex_count;
    size_t *table; ///< of hashes; an entry is an index and 1, or 0
    size_t table_mask;
    size_t *edge_table; ///< of arcs of one edge
    size_t edge_mask;
    size_t *edge_ends; ///< two vertices for each arc of one edge, in the order of their arcs; others are not set
    arc_graph *graph;
    size_t used_points;
    memory_pool pool; ///< of all arrays
} graph_job;

/// A table of zeros for `count` entries at most half full.
static size_t *make_table(memory_pool *pool, size_t count, size_t *mask)
{
    size_t size = 2;
    while (size / 2 < count)
        size *= 2;
    *mask = size - 1;
    return memory_pool_zeros(pool, size, sizeof(size_t));
}

/// Number the vertices: the first point with new coordinates begins one.
static bat_status number_vertices(graph_job *job, bat_error *error)
{
    memory_pool scratch = {0};
    size_t *owners = memory_pool_array(&scratch, job->point_count, sizeof *owners); // of each vertex, its first point
    const double **points = memory_pool_array(&scratch, job->point_count, sizeof *points);
    job->ids = memory_pool_array(&job->pool, job->point_count, sizeof *job->ids);
    job->table = make_table(&job->pool, job->point_count, &job->table_mask);
    bat_status status = memory_pool_check(&job->pool, error);
    if (status == BAT_OK)
        status = memory_pool_check(&scratch, error);
    size_t at = 0;
    for (size_t c = 0; c < job->count && status == BAT_OK; c++)
        for (size_t i = 0; i < job->curves[c].count; i++, at++)
        {
            points[at] = job->curves[c].points + i * job->dim;
            size_t slot = doubles_hash(points[at], job->dim) & job->table_mask;
            while (job->table[slot] != 0 && !points_equal(points[owners[job->table[slot] - 1]], points[at], job->dim))
                slot = (slot + 1) & job->table_mask;
            if (job->table[slot] == 0)
            {
                owners[job->vertex_count++] = at;
                job->table[slot] = job->vertex_count;
            }
            job->ids[at] = job->table[slot] - 1;
        }
    memory_pool_free(&scratch);
    job->vertices = memory_pool_zeros(&job->pool, job->vertex_count, sizeof *job->vertices);
    return status == BAT_OK ? memory_pool_check(&job->pool, error) : status;
}

static void add_neighbour(map_vertex *vertex, size_t neighbour)
{
    for (size_t i = 0; i < vertex->neighbour_count && i < CROSSING_NEIGHBOURS; i++)
        if (vertex->neighbours[i] == neighbour)
            return;
    if (vertex->neighbour_count < CROSSING_NEIGHBOURS)
        vertex->neighbours[vertex->neighbour_count] = neighbour;
    if (vertex->neighbour_count < MAX_NEIGHBOURS)
        vertex->neighbour_count++;
}

/// Note how a curve passes its vertices.
static void pass_curve(graph_job *job, size_t c, const unsigned char *corners)
{
    const bat_curve *curve = &job->curves[c];
    const size_t *ids = job->ids + job->first_point[c];
    size_t count = curve->count;
    for (size_t i = 0; i < count; i++)
    {
        map_vertex *vertex = &job->vertices[ids[i]];
        bool has_before = i > 0 || curve->closed, has_after = i + 1 < count || curve->closed;
        size_t before = ids[i > 0 ? i - 1 : count - 1], after = ids[i + 1 < count ? i + 1 : 0];
        if (has_before)
            add_neighbour(vertex, before);
        if (has_after)
            add_neighbour(vertex, after);
        vertex->passes = (unsigned char)(vertex->passes < MAX_NEIGHBOURS ? vertex->passes + 1 : MAX_NEIGHBOURS);
        vertex->in_ring |= curve->closed;
        vertex->node |= !has_before || !has_after || before == after || (corners != NULL && corners[i] != 0);
    }
}

static void find_nodes(graph_job *job, unsigned char *const *corners, bool cross)
{
    for (size_t c = 0; c < job->count; c++)
        pass_curve(job, c, corners != NULL ? corners[c] : NULL);
    for (size_t i = 0; i < job->vertex_count; i++)
    {
        map_vertex *vertex = &job->vertices[i];
        vertex->arc = BAT_NO_INDEX;
        vertex->crossing = cross && !vertex->node && !vertex->in_ring && vertex->passes == 2 &&
                           vertex->neighbour_count == CROSSING_NEIGHBOURS;
        vertex->node |= vertex->neighbour_count > 2 && !vertex->crossing;
        job->graph->nodes += vertex->node;
    }
}

/// A run of a curve from node to node, or a whole ring without nodes.
typedef struct curve_run
{
    size_t curve, begin, count; ///< `count` points from point `begin` on, around the end of a ring
    bool closed;
} curve_run;

static size_t id_in_run(const graph_job *job, const curve_run *run, size_t i)
{
    size_t index = run->begin + i, count = job->curves[run->curve].count;
    return job->ids[job->first_point[run->curve] + (index >= count ? index - count : index)];
}

/// The arc of one edge between two vertices: the slot in the table of edges, with an entry or without.
static size_t edge_slot(const graph_job *job, size_t p, size_t q)
{
    size_t low = p < q ? p : q, high = p < q ? q : p;
    size_t slot = hash_mix(hash_mix(0, low), high) & job->edge_mask;
    for (; job->edge_table[slot] != 0; slot = (slot + 1) & job->edge_mask)
    {
        const size_t *ends = job->edge_ends + 2 * (job->edge_table[slot] - 1);
        if (ends[0] == low && ends[1] == high)
            break;
    }
    return slot;
}

/// The arc that a run was cut from before, or BAT_NO_INDEX. Lines over a crossing share no edge.
static size_t known_arc(const graph_job *job, const curve_run *run)
{
    if (run->count == 2 && !run->closed)
    {
        size_t slot = edge_slot(job, id_in_run(job, run, 0), id_in_run(job, run, 1));
        return job->edge_table[slot] != 0 ? job->edge_table[slot] - 1 : BAT_NO_INDEX;
    }
    for (size_t i = !run->closed; i < run->count - !run->closed; i++)
    {
        const map_vertex *vertex = &job->vertices[id_in_run(job, run, i)];
        if (!vertex->crossing)
            return vertex->arc;
    }
    return BAT_NO_INDEX;
}

static size_t add_arc(graph_job *job, const curve_run *run)
{
    arc_graph *graph = job->graph;
    const bat_curve *curve = &job->curves[run->curve];
    size_t arc = graph->arc_count++;
    double *points = graph->points + job->used_points * job->dim;
    graph->arcs[arc] = (bat_curve){.space = curve->space, .points = points, .count = run->count, .closed = run->closed};
    graph->origins[arc] = (arc_origin){run->curve, run->begin};
    for (size_t i = 0; i < run->count; i++)
    {
        size_t index = (run->begin + i) % curve->count;
        memcpy(points + i * job->dim, curve->points + index * job->dim, job->dim * sizeof *points);
        map_vertex *vertex = &job->vertices[id_in_run(job, run, i)];
        bool inside = run->closed || (i > 0 && i + 1 < run->count);
        if (inside && !vertex->crossing)
        {
            vertex->arc = arc;
            vertex->place = i;
        }
    }
    if (run->count == 2 && !run->closed)
    {
        size_t p = id_in_run(job, run, 0), q = id_in_run(job, run, 1);
        job->edge_table[edge_slot(job, p, q)] = arc + 1;
        job->edge_ends[2 * arc] = p < q ? p : q;
        job->edge_ends[2 * arc + 1] = p < q ? q : p;
    }
    job->used_points += run->count;
    return arc;
}

/// How a run goes over an arc that was cut from another run.
static arc_use use_of(const graph_job *job, const curve_run *run, size_t arc)
{
    const bat_curve *line = &job->graph->arcs[arc];
    arc_use use = {.arc = arc};
    if (run->closed)
    {
        size_t second = job->vertices[id_in_run(job, run, 1)].place;
        use.offset = job->vertices[id_in_run(job, run, 0)].place;
        use.reversed = second != (use.offset + 1) % line->count;
        return use;
    }
    const arc_origin *origin = &job->graph->origins[arc];
    const curve_run first = {origin->curve, origin->point, line->count, false};
    use.reversed =
        id_in_run(job, run, 1) != id_in_run(job, &first, 1) || id_in_run(job, run, 0) != id_in_run(job, &first, 0);
    return use;
}

static void add_use(graph_job *job, const curve_run *run)
{
    arc_graph *graph = job->graph;
    size_t arc = known_arc(job, run);
    graph->uses[graph->use_count++] = arc == BAT_NO_INDEX ? (arc_use){.arc = add_arc(job, run)} : use_of(job, run, arc);
}

static bool is_node(const graph_job *job, size_t c, size_t i)
{
    return job->vertices[job->ids[job->first_point[c] + i]].node;
}

/// Cut a curve at its nodes. A ring with a node begins and ends there, but its uses begin with the arc of its first edge:
/// they are stored in the order of the points from the first node on.
static void cut_curve(graph_job *job, size_t c)
{
    const bat_curve *curve = &job->curves[c];
    size_t edges = polygon_edges(curve->count, curve->closed), start = 0;
    while (start < curve->count && !is_node(job, c, start))
        start++;
    job->graph->begins[c] = start < curve->count ? start : 0;
    if (start == curve->count)
    {
        add_use(job, &(curve_run){c, 0, curve->count, true});
        return;
    }
    curve_run run = {.curve = c, .begin = start, .count = 1};
    for (size_t k = 1; k <= edges; k++)
    {
        size_t index = (start + k) % curve->count;
        run.count++;
        if (!is_node(job, c, index))
            continue;
        add_use(job, &run);
        run = (curve_run){.curve = c, .begin = index, .count = 1};
    }
}

static bat_status cut_all(graph_job *job, bat_error *error)
{
    arc_graph *graph = job->graph;
    // Every use but the last of a curve ends at a pass through a node; a point begins one use at most.
    size_t room = job->point_count + job->count;
    graph->first_use = memory_pool_array(&graph->pool, job->count + 1, sizeof *graph->first_use);
    graph->begins = memory_pool_array(&graph->pool, job->count, sizeof *graph->begins);
    graph->uses = memory_pool_array(&graph->pool, room, sizeof *graph->uses);
    graph->arcs = memory_pool_array(&graph->pool, room, sizeof *graph->arcs);
    graph->origins = memory_pool_array(&graph->pool, room, sizeof *graph->origins);
    graph->points = memory_pool_array(&graph->pool, 2 * room, job->dim * sizeof *graph->points);
    job->edge_table = make_table(&job->pool, room, &job->edge_mask);
    job->edge_ends = memory_pool_array(&job->pool, 2 * room, sizeof *job->edge_ends);
    if (graph->pool.missing > 0 || job->pool.missing > 0)
        return error_memory(error, 2 * room * job->dim * sizeof *graph->points);
    for (size_t c = 0; c < job->count; c++)
    {
        graph->first_use[c] = graph->use_count;
        cut_curve(job, c);
    }
    graph->first_use[job->count] = graph->use_count;
    return BAT_OK;
}

static bat_status count_shared(arc_graph *graph, bat_error *error)
{
    unsigned char *uses = calloc(graph->arc_count > 0 ? graph->arc_count : 1, 1);
    if (uses == NULL)
        return error_memory(error, graph->arc_count);
    for (size_t i = 0; i < graph->use_count; i++)
    {
        unsigned char *known = &uses[graph->uses[i].arc];
        graph->shared += *known == 1;
        *known = (unsigned char)(*known == 0 ? 1 : 2);
    }
    free(uses);
    return BAT_OK;
}

/// The root of an arc among joined arcs.
static size_t root_of(size_t *parents, size_t arc)
{
    while (parents[arc] != arc)
    {
        parents[arc] = parents[parents[arc]];
        arc = parents[arc];
    }
    return arc;
}

/// Number the connected parts: arcs that have a vertex in common belong together.
static bat_status number_components(graph_job *job, bat_error *error)
{
    arc_graph *graph = job->graph;
    size_t *parents = memory_pool_array(&job->pool, graph->arc_count, sizeof *parents);
    size_t *arc_at = memory_pool_array(&job->pool, job->vertex_count, sizeof *arc_at);
    graph->components = memory_pool_array(&graph->pool, graph->arc_count, sizeof *graph->components);
    if (job->pool.missing > 0 || graph->components == NULL)
        return error_memory(error, job->vertex_count * sizeof *arc_at);
    for (size_t i = 0; i < job->vertex_count; i++)
        arc_at[i] = BAT_NO_INDEX;
    for (size_t a = 0; a < graph->arc_count; a++)
        parents[a] = a;
    for (size_t a = 0; a < graph->arc_count; a++)
    {
        const curve_run run = {graph->origins[a].curve, graph->origins[a].point, graph->arcs[a].count, false};
        for (size_t i = 0; i < run.count; i++)
        {
            size_t *known = &arc_at[id_in_run(job, &run, i)];
            if (*known == BAT_NO_INDEX)
                *known = a;
            size_t p = root_of(parents, *known), q = root_of(parents, a);
            parents[p > q ? p : q] = p > q ? q : p;
        }
    }
    for (size_t a = 0; a < graph->arc_count; a++)
    {
        size_t root = root_of(parents, a);
        graph->components[a] = root == a ? graph->component_count++ : graph->components[root];
    }
    return BAT_OK;
}

bat_status arc_graph_make(const bat_curve *curves, size_t count, unsigned char *const *corners, bool cross, arc_graph *graph,
                          bat_error *error)
{
    *graph = (arc_graph){.has_corners = corners != NULL};
    graph_job job = {.curves = curves, .count = count, .graph = graph};
    job.dim = count > 0 ? curves[0].space->point_dim : 1;
    job.first_point = memory_pool_array(&job.pool, count, sizeof *job.first_point);
    bat_status status = memory_pool_check(&job.pool, error);
    for (size_t c = 0; c < count && status == BAT_OK; c++)
    {
        job.first_point[c] = job.point_count;
        job.point_count += curves[c].count;
    }
    if (status == BAT_OK)
        status = number_vertices(&job, error);
    if (status == BAT_OK)
    {
        find_nodes(&job, corners, cross);
        status = cut_all(&job, error);
    }
    if (status == BAT_OK)
        status = count_shared(graph, error);
    if (status == BAT_OK)
        status = number_components(&job, error);
    memory_pool_free(&job.pool);
    return status;
}

void arc_graph_free(arc_graph *graph)
{
    memory_pool_free(&graph->pool);
    *graph = (arc_graph){0};
}
