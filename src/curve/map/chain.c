#include "curve/map/arc_refine.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "curve/polygon.h"
#include "space/degrees.h"

/// A point where lines end. End 2 i is the first point of curve i, end 2 i + 1 the last.
typedef struct line_joint
{
    size_t end;               ///< the first that was found here; BAT_NO_INDEX for an empty place of the table
    const double *sides[2];   ///< the points before, at most two different ones
    size_t first[2], last[2]; ///< the ends that come from each of them, a list by `next`; BAT_NO_INDEX for none
    size_t counts[2];
    bool blocked; ///< lines can't go on here
} line_joint;

typedef struct chain_job
{
    const bat_curve *curves;
    size_t count, dim;
    line_joint *table;
    size_t mask;
    size_t *next;  ///< of each end, the next one in the list of a joint
    size_t *links; ///< of each end, the one that goes on; BAT_NO_INDEX for none
} chain_job;

static const double *point_at(const chain_job *job, size_t end, size_t step)
{
    const bat_curve *curve = &job->curves[end / 2];
    return curve->points + (end % 2 == 0 ? step : curve->count - 1 - step) * job->dim;
}

/// The joint at a point, or the empty place for it.
static line_joint *joint_at(const chain_job *job, const double *point)
{
    size_t slot = doubles_hash(point, job->dim) & job->mask;
    while (job->table[slot].end != BAT_NO_INDEX && !points_equal(point_at(job, job->table[slot].end, 0), point, job->dim))
        slot = (slot + 1) & job->mask;
    return &job->table[slot];
}

/// The side of a joint on which a neighbour is, or 2, and the joint is blocked.
static size_t side_of(const chain_job *job, line_joint *joint, const double *neighbour)
{
    for (size_t side = 0; side < 2; side++)
    {
        if (joint->sides[side] == NULL)
            joint->sides[side] = neighbour;
        if (points_equal(joint->sides[side], neighbour, job->dim))
            return side;
    }
    joint->blocked = true;
    return 2;
}

static void add_end(chain_job *job, size_t end)
{
    const bat_curve *curve = &job->curves[end / 2];
    line_joint *joint = joint_at(job, point_at(job, end, 0));
    if (joint->end == BAT_NO_INDEX)
        joint->end = end;
    joint->blocked |= curve->corners != NULL && curve->corners[end % 2 == 0 ? 0 : curve->count - 1] != 0;
    size_t side = side_of(job, joint, point_at(job, end, 1));
    job->next[end] = BAT_NO_INDEX;
    if (side == 2)
        return;
    if (joint->counts[side]++ == 0)
        joint->first[side] = end;
    else
        job->next[joint->last[side]] = end;
    joint->last[side] = end;
}

/// Block the joints that a curve passes another way.
static void pass_joints(const chain_job *job, const bat_curve *curve)
{
    size_t n = curve->count;
    for (size_t i = curve->closed ? 0 : 1; i + !curve->closed < n; i++)
    {
        line_joint *joint = joint_at(job, curve->points + i * job->dim);
        if (joint->end == BAT_NO_INDEX)
            continue;
        size_t before = side_of(job, joint, curve->points + (i > 0 ? i - 1 : n - 1) * job->dim);
        size_t after = side_of(job, joint, curve->points + (i + 1 < n ? i + 1 : 0) * job->dim);
        joint->blocked |= before == after || (curve->corners != NULL && curve->corners[i] != 0);
    }
}

/// Whether two ends hold the same channels.
static bool channels_agree(const chain_job *job, size_t p, size_t q)
{
    const bat_curve *a = &job->curves[p / 2], *b = &job->curves[q / 2];
    size_t channels = a->channel_count;
    return channels == b->channel_count && (channels == 0 || memcmp(a->channels + (p % 2 == 0 ? 0 : a->count - 1) * channels,
                                                                    b->channels + (q % 2 == 0 ? 0 : b->count - 1) * channels,
                                                                    channels * sizeof *a->channels) == 0);
}

/// Link the ends of a joint in pairs, one of each side. Returns the number of pairs.
static size_t link_joint(chain_job *job, const line_joint *joint)
{
    size_t pairs = 0;
    if (joint->blocked || joint->counts[0] != joint->counts[1])
        return 0;
    for (size_t p = joint->first[0], q = joint->first[1]; p != BAT_NO_INDEX; p = job->next[p], q = job->next[q])
        if (channels_agree(job, p, q))
        {
            job->links[p] = q;
            job->links[q] = p;
            pairs++;
        }
    return pairs;
}

static bat_status find_links(chain_job *job, line_chains *chains, bat_error *error)
{
    size_t ends = 0, size = 4;
    for (size_t i = 0; i < job->count; i++)
        ends += job->curves[i].closed || job->curves[i].count < 2 ? 0 : 2;
    if (ends == 0)
        return BAT_OK;
    while (size < 2 * ends)
        size *= 2;
    job->mask = size - 1;
    job->table = memory_array(size, sizeof *job->table);
    job->next = memory_array(2 * job->count, sizeof *job->next);
    job->links = memory_array(2 * job->count, sizeof *job->links);
    if (job->table == NULL || job->next == NULL || job->links == NULL)
        return error_memory(error, size * sizeof *job->table);
    for (size_t i = 0; i < size; i++)
        job->table[i] = (line_joint){BAT_NO_INDEX, {NULL, NULL}, {BAT_NO_INDEX, BAT_NO_INDEX}, {0, 0}, {0, 0}, false};
    for (size_t end = 0; end < 2 * job->count; end++)
    {
        const bat_curve *curve = &job->curves[end / 2];
        job->links[end] = BAT_NO_INDEX;
        if (!curve->closed && curve->count >= 2)
            add_end(job, end);
    }
    for (size_t i = 0; i < job->count; i++)
        pass_joints(job, &job->curves[i]);
    for (size_t i = 0; i < size; i++)
        if (job->table[i].end != BAT_NO_INDEX)
            chains->pairs += link_joint(job, &job->table[i]);
    return BAT_OK;
}

/// Put a curve into the last chain, from its end `end` on. Its first point is there already unless the chain is empty.
static void add_member(const chain_job *job, size_t end, line_chains *chains)
{
    const bat_curve *from = &job->curves[end / 2];
    bat_curve *chain = &chains->curves[chains->count - 1];
    size_t first = chain->count > 0 ? chain->count - 1 : 0;
    chains->members[end / 2] = (chain_member){chains->count - 1, first, end % 2 != 0};
    for (size_t i = 0; i < from->count; i++)
        curve_copy_row(from, end % 2 == 0 ? i : from->count - 1 - i, chain, first + i);
    chain->count = first + from->count;
}

/// Walk the chain that begins with end `end`, and add its members to `chains`.
static bat_status add_chain(const chain_job *job, size_t end, line_chains *chains, bat_error *error)
{
    const bat_curve *like = &job->curves[end / 2];
    size_t points = 0, at = end;
    bool corners = false;
    do
    {
        points += job->curves[at / 2].count;
        corners |= job->curves[at / 2].corners != NULL;
        at = job->links[at ^ 1];
    } while (at != BAT_NO_INDEX && at != end);
    bat_curve *chain = &chains->curves[chains->count++];
    unsigned char flag = 0;
    bat_curve shape = *like; // with corners if a member has any
    shape.corners = corners ? &flag : NULL;
    shape.closed = like->closed || at == end;
    bat_status status = curve_room(&shape, points, shape.corners != NULL, chain, error);
    chain->count = 0;
    if (status != BAT_OK)
        return status;
    at = end;
    do
    {
        add_member(job, at, chains);
        at = job->links[at ^ 1];
    } while (at != BAT_NO_INDEX && at != end);
    chain->count -= chain->closed && !like->closed; // the last point is the first
    return BAT_OK;
}

static bat_status make_chains(const chain_job *job, line_chains *chains, bat_error *error)
{
    chains->curves = calloc(job->count, sizeof *chains->curves);
    chains->members = memory_array(job->count, sizeof *chains->members);
    if (chains->curves == NULL || chains->members == NULL)
        return error_memory(error, job->count * sizeof *chains->members);
    for (size_t i = 0; i < job->count; i++)
        chains->members[i].chain = BAT_NO_INDEX;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < job->count && status == BAT_OK; i++)
    {
        size_t end = 2 * i; // walk back to where the chain begins
        if (chains->members[i].chain != BAT_NO_INDEX)
            continue;
        while (job->links[end] != BAT_NO_INDEX && (job->links[end] ^ 1) != 2 * i)
            end = job->links[end] ^ 1;
        status = add_chain(job, end, chains, error);
    }
    return status;
}

/// Flag the points of the chains where curves were joined.
static bat_status flag_joints(const chain_job *job, line_chains *chains, bat_error *error)
{
    chains->joints = calloc(chains->count, sizeof *chains->joints);
    for (size_t c = 0; c < chains->count && chains->joints != NULL; c++)
        if ((chains->joints[c] = calloc(2, chains->curves[c].count)) == NULL)
            return error_memory(error, 2 * chains->curves[c].count);
    for (size_t i = 0; i < job->count && chains->joints != NULL; i++)
    {
        size_t chain = chains->members[i].chain, first = chains->members[i].first;
        if (!job->curves[i].closed && (first > 0 || chains->curves[chain].closed))
            chains->joints[chain][first] = chains->joints[chain][first + chains->curves[chain].count] = 1;
    }
    return chains->joints != NULL ? BAT_OK : error_memory(error, chains->count * sizeof *chains->joints);
}

bat_status line_chains_make(const bat_curve *curves, size_t count, line_chains *chains, bat_error *error)
{
    *chains = (line_chains){0};
    chain_job job = {.curves = curves, .count = count, .dim = count > 0 ? curves[0].space->point_dim : 1};
    bat_status status = find_links(&job, chains, error);
    if (status == BAT_OK && chains->pairs > 0)
        status = make_chains(&job, chains, error);
    if (status == BAT_OK && chains->pairs > 0)
        status = flag_joints(&job, chains, error);
    free(job.table);
    free(job.next);
    free(job.links);
    return status;
}

void line_chains_find(const line_chains *chains, const bat_curve *curves, size_t count, size_t *curve, size_t *point)
{
    for (size_t i = 0; i < count; i++)
    {
        chain_member member = chains->members[i];
        size_t points = chains->curves[*curve].count;
        if (member.chain != *curve)
            continue;
        size_t step = *point == BAT_NO_INDEX ? 0 : (*point + points - member.first) % points;
        if (step >= curves[i].count)
            continue;
        if (*point != BAT_NO_INDEX)
            *point = member.reversed ? curves[i].count - 1 - step : step;
        *curve = i;
        return;
    }
}

bat_status line_chains_cut(const bat_curve *chain, size_t first, size_t last, bool reversed, bat_curve *line,
                           bat_error *error)
{
    size_t count = last >= first && !(last == first && chain->closed) ? last - first + 1 : last + chain->count - first + 1;
    bat_status status = curve_room(chain, count, chain->corners != NULL, line, error);
    line->closed = false;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        curve_copy_row(chain, (first + i) % chain->count, line, reversed ? count - 1 - i : i);
    return status;
}

void line_chains_free(line_chains *chains)
{
    curves_free(chains->curves, chains->count);
    for (size_t c = 0; c < chains->count && chains->joints != NULL; c++)
        free(chains->joints[c]);
    free(chains->joints);
    free(chains->members);
    *chains = (line_chains){0};
}

static int compare_pairs(const void *a, const void *b)
{
    const met_pair *p = a, *q = b;
    for (int k = 0; k < 2; k++)
    {
        int order = ORDER_OF(p->places[k].curve, q->places[k].curve);
        if (order == 0)
            order = ORDER_OF(p->places[k].edge, q->places[k].edge);
        if (order != 0)
            return order;
    }
    return 0;
}

static bool note_pair(void *context, edge_place first, edge_place second)
{
    met_edges *met = context;
    return ARRAY_ADD(met->pairs, met->capacity, met->count, (met_pair){{first, second}}) &&
           ARRAY_ADD(met->pairs, met->capacity, met->count, (met_pair){{second, first}});
}

bat_status met_edges_find(const chart_curves *charts, const map_chart *chart, int threads, met_edges *met, bat_error *error)
{
    edge_tree tree;
    *met = (met_edges){0};
    bat_status status = edge_tree_make(charts->curves, charts->count, 0, threads, &tree, error);
    tree.turn = chart->turn;
    if (status == BAT_OK && !edge_tree_search(&tree, EDGE_PAIRS_ARCS, false, note_pair, met))
        status = error_memory(error, met->count * sizeof *met->pairs);
    edge_tree_free(&tree);
    if (met->count > 0)
        qsort(met->pairs, met->count, sizeof *met->pairs, compare_pairs);
    return status;
}

void met_edges_free(met_edges *met)
{
    free(met->pairs);
    *met = (met_edges){0};
}

bool met_edges_near(const met_edges *met, const bat_curve *arcs, edge_place first, edge_place second)
{
    if (met->count == 0)
        return false;
    size_t edges[2] = {polygon_edges(arcs[first.curve].count, arcs[first.curve].closed),
                       polygon_edges(arcs[second.curve].count, arcs[second.curve].closed)};
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
        {
            met_pair pair = {{{first.curve, (first.edge + i + edges[0] - 1) % edges[0]},
                              {second.curve, (second.edge + j + edges[1] - 1) % edges[1]}}};
            if (bsearch(&pair, met->pairs, met->count, sizeof pair, compare_pairs) != NULL)
                return true;
        }
    return false;
}

static const double DEGREES_PER_RADIAN = 57.295779513082320876798154814105;
/// Runs that are shorter, in degrees or in units of the coarsest coordinates, are not meant.
static const double MIN_DEGREES = 1, MIN_UNITS = 20;

/// The way in degrees from one point of the sphere to another. A pole has the longitude of the other point.
static void degrees_along(const double *p, const double *q, double *from, double *along)
{
    static const double POLE = 90 - 1e-9;
    double to[2];
    for (int side = 0; side < 2; side++)
    {
        const double *point = side == 0 ? p : q;
        double *place = side == 0 ? from : to;
        place[0] = atan2(point[1], point[0]) * DEGREES_PER_RADIAN;
        place[1] = atan2(point[2], hypot(point[0], point[1])) * DEGREES_PER_RADIAN;
    }
    if (fabs(from[1]) > POLE)
        from[0] = to[0];
    along[0] = fabs(to[1]) > POLE ? 0 : to[0] - from[0] - 360 * rint((to[0] - from[0]) / 360);
    along[1] = to[1] - from[1];
}

/// Whether an edge of this kind can be straight in degrees.
static bool is_kind(const double *along, const degree_edges *how)
{
    double least = fmin(fabs(along[0]), fabs(along[1]));
    return how->edges == BAT_CURVE_MAP_EDGES_STRAIGHT || (how->edges == BAT_CURVE_MAP_EDGES_AUTO && least <= how->unit);
}

/// Whether an edge goes on in the direction of the edge before.
static bool goes_on(const double *before, const double *after, const degree_edges *how)
{
    double cross = before[0] * after[1] - before[1] * after[0], dot = before[0] * after[0] + before[1] * after[1];
    return dot > 0 && fabs(cross) <= how->unit * (hypot(before[0], before[1]) + hypot(after[0], after[1]));
}

bool degrees_straight(const bat_curve *arc, const degree_edges *how)
{
    double from[2], before[2], along[2];
    for (size_t i = 0; i + 1 < arc->count; i++)
    {
        degrees_along(arc->points + 3 * i, arc->points + 3 * (i + 1), from, along);
        if (!is_kind(along, how) || (i > 0 && !goes_on(before, along, how)))
            return false;
        memcpy(before, along, sizeof before);
    }
    return !arc->closed;
}

void degrees_edge_point(const double *p, const double *q, double share, double *point)
{
    double from[2], along[2];
    degrees_along(p, q, from, along);
    double longitude = from[0] + share * along[0];
    degrees_to_point(longitude - 360 * rint(longitude / 360), from[1] + share * along[1], point);
}

/// The unit of the coarsest power of ten that all coordinates are multiples of.
static double unit_of(const bat_curve *curve, const degree_edges *how)
{
    double unit = 1, from[2], along[2];
    for (size_t i = 0; i < curve->count && unit > how->unit; i++)
    {
        degrees_along(curve->points + 3 * i, curve->points + 3 * i, from, along);
        for (int c = 0; c < 2; c++)
            while (unit > how->unit && fabs(from[c] - unit * rint(from[c] / unit)) > how->unit)
                unit /= 10;
    }
    return unit;
}

/// Whether a vertex is a pole, where no point is by chance.
static bool is_pole(const bat_curve *curve, size_t vertex)
{
    const double *point = curve->points + 3 * (vertex % curve->count);
    return hypot(point[0], point[1]) < 1e-11;
}

/// Flag the vertices of a run of edges if it is long enough, or ends at a pole.
static void flag_run(const bat_curve *curve, size_t first, size_t edges, double length, double least, unsigned char *flags)
{
    bool meant = edges > 0 && (length >= least || is_pole(curve, first) || is_pole(curve, first + edges));
    for (size_t k = 0; k <= edges && meant; k++)
        flags[(first + k) % curve->count] = 1;
}

bat_status degrees_flag_runs(const bat_curve *curve, const degree_edges *how, unsigned char *flags, bat_error *error)
{
    size_t edges = polygon_edges(curve->count, curve->closed), start = 0;
    double(*along)[2] = memory_array(edges, sizeof *along), from[2];
    if (along == NULL)
        return error_memory(error, edges * sizeof *along);
    for (size_t j = 0; j < edges; j++)
        degrees_along(curve->points + 3 * j, curve->points + 3 * ((j + 1) % curve->count), from, along[j]);
    double least = how->edges == BAT_CURVE_MAP_EDGES_AUTO ? fmax(MIN_DEGREES, MIN_UNITS * unit_of(curve, how)) : MIN_DEGREES;
    while (curve->closed && start + 1 < edges && goes_on(along[(start + edges - 1) % edges], along[start], how))
        start++;
    size_t run = 0; // edges of the present run, and its length
    double length = 0;
    for (size_t k = 0; k < edges; k++)
    {
        const double *edge = along[(start + k) % edges];
        if (run > 0 && (!is_kind(edge, how) || !goes_on(along[(start + k - 1) % edges], edge, how)))
        {
            flag_run(curve, start + k - run, run, length, least, flags);
            run = 0;
            length = 0;
        }
        run += is_kind(edge, how);
        length += is_kind(edge, how) ? hypot(edge[0], edge[1]) : 0;
    }
    flag_run(curve, start + edges - run, run, length, least, flags);
    free(along);
    return BAT_OK;
}
