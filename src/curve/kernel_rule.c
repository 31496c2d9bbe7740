#include "curve/angle_block.h"
#include "curve/kernel.h"

enum
{
    /// Exterior angles, and edge lengths, that a run of edges may see.
    MEASURES = BAT_CURVE_ANGLE_RULE_EDGES + 2 * BAT_CURVE_ANGLE_RULE_REACH,
    /// Rules take a microsecond an edge or more: so many points are worth a thread's while.
    CHUNK_POINTS = 4 * BAT_CURVE_ANGLE_RULE_EDGES,
};

/// One thread's memory: what the kernel measures, and what it gets.
typedef struct rule_run
{
    double angles[MEASURES];
    double lengths[MEASURES];
    double insertion[BAT_CURVE_ANGLE_RULE_EDGES];
    _Alignas(64) unsigned char scratch[]; ///< the rule's own
} rule_run;

typedef struct rule_data
{
    const bat_curve_scheme *scheme;
    const angle_surface *surface; ///< the vector code of the space; null for a user's space
    double scale;                 ///< kernel_scale() of the polygon
    double mean_length;           ///< of the polygon's edges, where the rule uses it
    const double *root;           ///< row 0 of the polygon, where each level has a kernel of its own
} rule_data;
_Static_assert(sizeof(rule_data) <= KERNEL_DATA, "a kernel has room for its data");

/// The exterior angles of vertices 1 … count - 1 and the lengths of edges 0 … count - 1; points 0 … count are there.
static void measure_edges(const refine_kernel *kernel, const double *points, size_t count, double *angles, double *lengths)
{
    const bat_space *space = kernel->space;
    const rule_data *data = kernel_data_of(kernel);
    const angle_surface *where = data->surface;
    size_t dim = kernel->dim;
    if (where == NULL)
        for (size_t i = 0; i < count; i++)
        {
            const double *p = points + i * dim;
            lengths[i] = space->distance(space, p, p + dim);
            if (i + 1 < count)
                angles[i] = space->exterior_angle(space, p, p + dim, p + 2 * dim);
        }
    angle_block block;
    for (size_t done = 0; where != NULL && done < count; done += ANGLE_BLOCK_EDGES)
    {
        size_t edges = count - done < ANGLE_BLOCK_EDGES ? count - done : ANGLE_BLOCK_EDGES;
        size_t corners = done + edges < count ? edges : edges - 1;
        angle_block_load(&block, 0, points + done * dim, dim, corners + 2);
        where->lengths(&block, edges, data->scale);
        where->angles(&block, corners, data->scale);
        memcpy(lengths + done, block.length, edges * sizeof *lengths);
        memcpy(angles + done, block.angle, corners * sizeof *angles);
    }
}

LANES_CLONES
/// New vertices over at most ANGLE_BLOCK_EDGES edges. On failure *fault is the edge at fault.
static bat_status insert_block(const refine_kernel *kernel, const double *points, const double *insertion, size_t edges,
                               double *fine, size_t *fault)
{
    const rule_data *data = kernel_data_of(kernel);
    const angle_surface *where = data->surface;
    size_t dim = kernel->dim;
    angle_block block;
    for (size_t j = 0; j < edges; j++)
        block.slope[j] = angle_slope(insertion[j]);
    if (where != NULL)
    {
        angle_block_load(&block, 2, points, dim, edges + 1);
        where->insert(&block, edges);
        angle_block_store(&block, points, dim, edges, fine);
    }
    bat_status status = BAT_OK;
    for (size_t j = 0; j < edges && status == BAT_OK; j++)
    {
        const double *p = points + j * dim;
        *fault = j;
        status = isnan(block.slope[j]) ? BAT_INVALID_POINT : BAT_OK;
        if (status == BAT_OK && where != NULL)
            status = block.margin[j] > 0 ? BAT_OK : where->missing;
        else if (status == BAT_OK)
        {
            memcpy(fine + 2 * j * dim, p, dim * sizeof *p);
            status = kernel->space->apex(kernel->space, p, p + dim, atan(block.slope[j]), fine + (2 * j + 1) * dim);
        }
    }
    return status;
}

static bat_status run_rule(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, void *scratch,
                           size_t *fault)
{
    const rule_data *data = kernel_data_of(kernel);
    const bat_curve_angle_rule *rule = data->scheme->rule;
    size_t dim = kernel->dim, reach = rule->reach;
    rule_run *run = scratch;
    bat_status status = BAT_OK;
    for (size_t done = 0; done < pairs && status == BAT_OK; done += BAT_CURVE_ANGLE_RULE_EDGES)
    {
        size_t edges = pairs - done < BAT_CURVE_ANGLE_RULE_EDGES ? pairs - done : BAT_CURVE_ANGLE_RULE_EDGES;
        const double *here = points + done * dim;
        measure_edges(kernel, here - reach * dim, edges + 2 * reach, run->angles, run->lengths);
        bat_curve_angle_rule_view view = {.space = kernel->space,
                                          .count = edges,
                                          .angles = run->angles + reach - 1,
                                          .lengths = run->lengths + reach,
                                          .mean_length = data->mean_length,
                                          .fairness = data->scheme->fairness,
                                          .level = kernel->level,
                                          .first = rule->levels > 0 ? (here - data->root) / (ptrdiff_t)dim : 0};
        rule->angles(rule, &view, run->insertion, run->scratch);
        for (size_t j = 0; j < edges && status == BAT_OK; j += ANGLE_BLOCK_EDGES)
        {
            size_t count = edges - j < ANGLE_BLOCK_EDGES ? edges - j : ANGLE_BLOCK_EDGES;
            status = insert_block(kernel, here + j * dim, run->insertion + j, count, fine + 2 * (done + j) * dim, fault);
            *fault += done + j;
        }
    }
    return status;
}

/// The mean length of the edges first … end - 1, 0 when there are none.
static double mean_length(const refine_kernel *kernel, const double *points, size_t first, size_t end)
{
    double angles[ANGLE_BLOCK_EDGES], lengths[ANGLE_BLOCK_EDGES], sum = 0;
    for (size_t done = first; done < end; done += ANGLE_BLOCK_EDGES)
    {
        size_t count = end - done < ANGLE_BLOCK_EDGES ? end - done : ANGLE_BLOCK_EDGES;
        double part = 0;
        measure_edges(kernel, points + done * kernel->dim, count, angles, lengths);
        for (size_t i = 0; i < count; i++)
            part += lengths[i];
        sum += part;
    }
    return end > first ? sum / (double)(end - first) : 0;
}

static void measure(refine_kernel *kernel, const double *points, size_t count, bool closed)
{
    rule_data *data = kernel_data(kernel);
    data->scale = kernel_scale(points, count, kernel->dim);
    data->root = points;
    if (data->scheme->rule->wants_mean_length)
        data->mean_length = mean_length(kernel, points, 0, closed ? count : count - 1);
}

refine_kernel kernel_rule(const bat_space *space, const bat_curve_scheme *scheme)
{
    int support = 2 * (int)scheme->rule->reach + 1;
    refine_kernel kernel = {
        .space = space,
        .dim = space->point_dim,
        .first = -support,
        .last = support,
        .scratch_size = sizeof(rule_run) + scheme->rule->scratch_size,
        .chunk = CHUNK_POINTS,
        .run = run_rule,
        .measure = measure,
    };
    rule_data *data = kernel_data(&kernel);
    *data = (rule_data){.scheme = scheme, .surface = angle_surface_of(space)};
    return kernel;
}
