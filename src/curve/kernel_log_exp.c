#include "curve/kernel.h"

#include "base/lanes.h"
#include "space/builtin.h"

/// Edges refined at a time on the sphere.
#define BLOCK 128

/// Squared length of a tangent vector up to which the polynomials of lanes.h hold.
static const double SQUARED_PI = 9.8696044010893586188;

/// One new point in any space: the weighted mean of logarithms in the tangent space of the base point, which is the first
/// point of the edge from p_0 to p_1 or its middle. The new vertex over the edge averages with the odd coefficients of the
/// mask.
static bat_status new_vertex(const bat_space *space, const mask_taps *taps, bat_curve_base where, const double *p,
                             double *fine)
{
    size_t dim = space->point_dim, tangent_dim = space->tangent_dim;
    double middle[BAT_SPACE_MAX_DIM], tangent[BAT_SPACE_MAX_DIM], sum[BAT_SPACE_MAX_DIM];
    const double *base = p;
    if (where == BAT_CURVE_BASE_MIDPOINT)
    {
        bat_status status = bat_space_geodesic(space, p, p + dim, 0.5, middle);
        if (status != BAT_OK)
            return status;
        base = middle;
    }
    memset(sum, 0, tangent_dim * sizeof *sum);
    for (size_t k = 0; k < taps->count; k++)
    {
        ptrdiff_t row = taps->start + (ptrdiff_t)k;
        if (base == p && row == 0)
            continue;
        bat_status status = space->log(space, base, p + row * (ptrdiff_t)dim, tangent);
        if (status != BAT_OK)
            return status;
        vector_add(tangent_dim, taps->weights[k], tangent, sum);
    }
    return space->exp(space, base, sum, fine);
}

typedef struct log_exp_data
{
    mask_taps even; ///< of masks that keep no point
    mask_taps odd;
    bat_curve_base base;
} log_exp_data;
_Static_assert(sizeof(log_exp_data) <= KERNEL_DATA, "a kernel has room for its data");

/// Edge by edge. Masks that keep no point make both new points of an edge; the base of those that belong to a vertex is the
/// vertex.
static bat_status run_any(const refine_kernel *kernel, const double *points, size_t pairs, double *fine,
                          void *scratch BAT_UNUSED, size_t *fault)
{
    const log_exp_data *data = kernel_data_of(kernel);
    size_t dim = kernel->dim;
    bool smooths = data->even.count > 0, has_vertices = ((kernel->first + kernel->last) & 1) == 0;
    bat_curve_base even_base = has_vertices ? BAT_CURVE_BASE_VERTEX : data->base;
    bat_status status = BAT_OK;
    for (size_t j = 0; j < pairs && status == BAT_OK; j++)
    {
        const double *p = points + j * dim;
        double *made = fine + 2 * j * dim;
        *fault = j;
        if (smooths)
            status = new_vertex(kernel->space, &data->even, even_base, p, made);
        else
            memcpy(made, p, dim * sizeof *p);
        if (status == BAT_OK)
            status = new_vertex(kernel->space, &data->odd, data->base, p, made + dim);
    }
    return status;
}

/// One block of edges on the sphere, by coordinates: the stencils' points, base points, sums of logarithms, new points.
typedef struct sphere_block
{
    double point_x[BLOCK + BAT_MASK_MAX], point_y[BLOCK + BAT_MASK_MAX], point_z[BLOCK + BAT_MASK_MAX];
    double base_x[BLOCK], base_y[BLOCK], base_z[BLOCK];
    double sum_x[BLOCK], sum_y[BLOCK], sum_z[BLOCK];
    double new_x[BLOCK], new_y[BLOCK], new_z[BLOCK];
    double margin[BLOCK]; ///< positive where no point of the stencil is antipodal to the base
    double squared_length[BLOCK];
} sphere_block;

LANES_CLONES
static void sphere_load(sphere_block *block, const double *points, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        block->point_x[i] = points[3 * i];
        block->point_y[i] = points[3 * i + 1];
        block->point_z[i] = points[3 * i + 2];
    }
}

/// The base of edge j, whose first point is entry j + first of the points.
LANES_CLONES
static void sphere_bases(sphere_block *block, size_t first, size_t edges, bool midpoint)
{
    const double *x = block->point_x + first, *y = block->point_y + first, *z = block->point_z + first;
    for (size_t j = 0; j < edges; j++)
    {
        double mx = x[j] + x[j + 1], my = y[j] + y[j + 1], mz = z[j] + z[j + 1];
        double squared = mx * mx + my * my + mz * mz;
        double inverse = 1 / sqrt(squared > 0 ? squared : 1);
        block->base_x[j] = midpoint ? mx * inverse : x[j];
        block->base_y[j] = midpoint ? my * inverse : y[j];
        block->base_z[j] = midpoint ? mz * inverse : z[j];
        block->sum_x[j] = block->sum_y[j] = block->sum_z[j] = 0;
        block->margin[j] = squared - SPHERE_ANTIPODAL_SQUARED_LENGTH;
    }
}

/// Differences and sums of one point of each stencil, beginning at entry `at`, and the base points.
static inline void chords(const sphere_block *block, size_t at, size_t j, double *d, double *s)
{
    double q[3] = {block->point_x[at + j], block->point_y[at + j], block->point_z[at + j]};
    double b[3] = {block->base_x[j], block->base_y[j], block->base_z[j]};
    for (int c = 0; c < 3; c++)
    {
        d[c] = q[c] - b[c];
        s[c] = q[c] + b[c];
    }
}

static inline double squared(const double *v)
{
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

/// Whether every point is within pi/4 of its base, so that the tangent of half the angle is below tan(pi/8).
LANES_CLONES
static bool sphere_all_near(const sphere_block *block, size_t at, size_t edges)
{
    int far = 0;
    for (size_t j = 0; j < edges; j++)
    {
        double d[3], s[3];
        chords(block, at, j, d, s);
        far |= squared(d) > LANES_TAN_PI_8 * LANES_TAN_PI_8 * squared(s);
    }
    return far == 0;
}

static inline void add_tangent(sphere_block *block, size_t j, double scale, const double *chord)
{
    double x = block->base_x[j], y = block->base_y[j], z = block->base_z[j];
    double along = chord[0] * x + chord[1] * y + chord[2] * z;
    block->sum_x[j] += scale * (chord[0] - along * x);
    block->sum_y[j] += scale * (chord[1] - along * y);
    block->sum_z[j] += scale * (chord[2] - along * z);
}

/// Add weight log_b(q): theta / sin(theta) times the part of q - b orthogonal to b, where with c = |q - b| and s = |q + b|
/// theta = 2 atan2(c, s) and sin(theta) = c s / 2. Near the antipode q + b has the same orthogonal part and loses less.
LANES_CLONES
static void sphere_add_logs(sphere_block *block, size_t at, size_t edges, double weight)
{
    for (size_t j = 0; j < edges; j++)
    {
        double d[3], s[3];
        chords(block, at, j, d, s);
        double difference = squared(d), sum = squared(s);
        bool near = difference < sum;
        double chord[3] = {near ? d[0] : s[0], near ? d[1] : s[1], near ? d[2] : s[2]};
        double c = sqrt(difference), r = sqrt(sum), product = c * r;
        add_tangent(block, j, weight * (product > 0 ? 4 * lane_atan2(c, r) / product : 1), chord);
        double margin = sum - SPHERE_ANTIPODAL_SQUARED_LENGTH;
        block->margin[j] = margin < block->margin[j] ? margin : block->margin[j];
    }
}

/// The same within pi/4, where theta / sin(theta) = 4 / s^2 times atan(t) / t at t^2 = c^2 / s^2 needs no root.
LANES_CLONES
static void sphere_add_near_logs(sphere_block *block, size_t at, size_t edges, double weight)
{
    for (size_t j = 0; j < edges; j++)
    {
        double d[3], s[3];
        chords(block, at, j, d, s);
        double inverse = 1 / squared(s);
        add_tangent(block, j, 4 * weight * inverse * lane_atan_over_root(squared(d) * inverse), d);
    }
}

/// exp of the sums, brought back to unit length, in their place.
LANES_CLONES
static void sphere_exponentials(sphere_block *block, size_t edges)
{
    for (size_t j = 0; j < edges; j++)
    {
        double x = block->sum_x[j], y = block->sum_y[j], z = block->sum_z[j];
        double length = x * x + y * y + z * z;
        double cosine = lane_cos_root(length), ratio = lane_sinc_root(length);
        x = cosine * block->base_x[j] + ratio * x;
        y = cosine * block->base_y[j] + ratio * y;
        z = cosine * block->base_z[j] + ratio * z;
        double inverse = 1 / sqrt(x * x + y * y + z * z);
        block->new_x[j] = x * inverse;
        block->new_y[j] = y * inverse;
        block->new_z[j] = z * inverse;
        block->squared_length[j] = length;
    }
}

/// Old points, whose first is entry `first`, and new ones in turn.
LANES_CLONES
static void sphere_store(const sphere_block *block, size_t first, size_t edges, double *restrict fine)
{
    for (size_t j = 0; j < edges; j++)
    {
        fine[6 * j] = block->point_x[first + j];
        fine[6 * j + 1] = block->point_y[first + j];
        fine[6 * j + 2] = block->point_z[first + j];
        fine[6 * j + 3] = block->new_x[j];
        fine[6 * j + 4] = block->new_y[j];
        fine[6 * j + 5] = block->new_z[j];
    }
}

/// Vectors too long for the polynomials, and points without a logarithm.
static bat_status sphere_finish(const refine_kernel *kernel, const sphere_block *block, size_t edges, double *fine,
                                size_t *fault)
{
    bat_status status = BAT_OK;
    for (size_t j = 0; j < edges && status == BAT_OK; j++)
    {
        *fault = j;
        if (!(block->margin[j] > 0))
            status = BAT_CUT_LOCUS;
        else if (!(block->squared_length[j] <= SQUARED_PI))
        {
            double tangent[3] = {block->sum_x[j], block->sum_y[j], block->sum_z[j]};
            double base[3] = {block->base_x[j], block->base_y[j], block->base_z[j]};
            status = kernel->space->exp(kernel->space, base, tangent, fine + 6 * j + 3);
        }
    }
    return status;
}

static bat_status run_sphere(const refine_kernel *kernel, const double *points, size_t pairs, double *fine,
                             void *scratch BAT_UNUSED, size_t *fault)
{
    const log_exp_data *data = kernel_data_of(kernel);
    const mask_taps *taps = &data->odd;
    bool midpoint = data->base == BAT_CURVE_BASE_MIDPOINT;
    ptrdiff_t low = (1 - kernel->last) / 2, high = (1 - kernel->first) / 2;
    size_t first = (size_t)-low;
    sphere_block block;
    bat_status status = BAT_OK;
    for (size_t done = 0; done < pairs && status == BAT_OK; done += BLOCK)
    {
        size_t edges = pairs - done < BLOCK ? pairs - done : BLOCK;
        sphere_load(&block, points + 3 * ((ptrdiff_t)done + low), edges + (size_t)(high - low));
        sphere_bases(&block, first, edges, midpoint);
        for (size_t k = 0; k < taps->count; k++)
        {
            size_t at = (size_t)(taps->start - low) + k;
            if (!midpoint && at == first)
                continue;
            if (sphere_all_near(&block, at, edges))
                sphere_add_near_logs(&block, at, edges, taps->weights[k]);
            else
                sphere_add_logs(&block, at, edges, taps->weights[k]);
        }
        sphere_exponentials(&block, edges);
        sphere_store(&block, first, edges, fine + 6 * done);
        status = sphere_finish(kernel, &block, edges, fine + 6 * done, fault);
        *fault += done;
    }
    return status;
}

/// The support is that of the mask, widened to both sides alike until it holds both ends of the edge.
static refine_kernel smoothing_kernel(const bat_space *space, const bat_curve_scheme *scheme)
{
    mask_taps even = mask_taps_of(&scheme->mask, 0), odd = mask_taps_of(&scheme->mask, 1);
    bat_mask mask = mask_trimmed(&scheme->mask);
    int first = mask.first, last = mask.first + (int)mask.count - 1, grow = 0;
    grow = grow < first + 2 ? first + 2 : grow;
    grow = grow < 1 - last ? 1 - last : grow;
    refine_kernel kernel = {
        .space = space,
        .dim = space->point_dim,
        .first = first - grow,
        .last = last + grow,
        .run = run_any,
    };
    log_exp_data *data = kernel_data(&kernel);
    *data = (log_exp_data){even, odd, scheme->base};
    return kernel;
}

refine_kernel kernel_log_exp(const bat_space *space, const bat_curve_scheme *scheme)
{
    if (!mask_is_interpolatory(&scheme->mask))
        return smoothing_kernel(space, scheme);
    mask_taps odd = mask_taps_of(&scheme->mask, 1);
    // The stencil always holds the edge's own ends.
    int low = odd.start < 0 ? (int)odd.start : 0;
    int high = (int)odd.start + (int)odd.count - 1;
    high = high > 1 ? high : 1;
    refine_kernel kernel = {
        .space = space,
        .dim = space->point_dim,
        .first = 1 - 2 * high,
        .last = 1 - 2 * low,
        .run = space_is_sphere(space) ? run_sphere : run_any,
    };
    log_exp_data *data = kernel_data(&kernel);
    *data = (log_exp_data){.odd = odd, .base = scheme->base};
    return kernel;
}
