#include "curve/kernel.h"

#include "base/lanes.h"
#include "space/known.h"

#include <string.h>

enum
{
    /// Edges refined at a time on the sphere.
    BLOCK = 128
};

/// Squared length of p + q below which two points of the sphere count as antipodal.
static const double ANTIPODAL_SQUARED_LENGTH = 1e-28;
/// Squared length of a tangent vector up to which the polynomials of lanes.h hold.
static const double SQUARED_PI = 9.8696044010893586188;

/// One edge in any space: the weighted mean of logarithms in the tangent space of the base point. The new vertex over the
/// edge from p_0 to p_1 averages with the odd coefficients of the mask.
static bat_status new_vertex(const bat_space *space, const mask_taps *taps, bat_log_exp_base where, const double *p,
                             double *fine)
{
    size_t dim = space->point_dim, tangent_dim = space->tangent_dim;
    double middle[BAT_SPACE_MAX_DIM], tangent[BAT_SPACE_MAX_DIM], sum[BAT_SPACE_MAX_DIM];
    const double *base = p;
    if (where == BAT_BASE_MIDPOINT)
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
        for (size_t i = 0; i < tangent_dim; i++)
            sum[i] += taps->weights[k] * tangent[i];
    }
    return space->exp(space, base, sum, fine);
}

static bat_status run_any(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, size_t *fault)
{
    size_t dim = kernel->dim;
    for (size_t j = 0; j < pairs; j++)
    {
        const double *p = points + j * dim;
        memcpy(fine + 2 * j * dim, p, dim * sizeof *p);
        bat_status status = new_vertex(kernel->space, &kernel->odd, kernel->scheme->base, p, fine + (2 * j + 1) * dim);
        if (status != BAT_OK)
        {
            *fault = j;
            return status;
        }
    }
    return BAT_OK;
}

/// One block of edges on the sphere: base points, and the sums of weighted logarithms.
typedef struct sphere_block
{
    double x[BLOCK], y[BLOCK], z[BLOCK];
    double sum_x[BLOCK], sum_y[BLOCK], sum_z[BLOCK];
    double margin[BLOCK]; ///< positive where no point of the stencil is antipodal to the base
    double squared_length[BLOCK];
} sphere_block;

LANES_CLONES
static void sphere_bases(sphere_block *block, const double *p, size_t edges, bool midpoint)
{
    for (size_t j = 0; j < edges; j++)
    {
        double x = p[3 * j], y = p[3 * j + 1], z = p[3 * j + 2];
        double mx = x + p[3 * j + 3], my = y + p[3 * j + 4], mz = z + p[3 * j + 5];
        double squared = mx * mx + my * my + mz * mz;
        double inverse = 1 / sqrt(squared > 0 ? squared : 1);
        block->x[j] = midpoint ? mx * inverse : x;
        block->y[j] = midpoint ? my * inverse : y;
        block->z[j] = midpoint ? mz * inverse : z;
        block->sum_x[j] = block->sum_y[j] = block->sum_z[j] = 0;
        block->margin[j] = squared - ANTIPODAL_SQUARED_LENGTH;
    }
}

/// Add weight log_b(q): theta / sin(theta) times the part of q - b orthogonal to b, where with c = |q - b| and s = |q + b|
/// theta = 2 atan2(c, s) and sin(theta) = c s / 2.
LANES_CLONES
static void sphere_add_logs(sphere_block *block, const double *q, size_t edges, double weight)
{
    for (size_t j = 0; j < edges; j++)
    {
        double x = block->x[j], y = block->y[j], z = block->z[j];
        double dx = q[3 * j] - x, dy = q[3 * j + 1] - y, dz = q[3 * j + 2] - z;
        double sx = q[3 * j] + x, sy = q[3 * j + 1] + y, sz = q[3 * j + 2] + z;
        double difference = dx * dx + dy * dy + dz * dz, sum = sx * sx + sy * sy + sz * sz;
        // Near the antipode the sum has the same orthogonal part as the difference and loses less.
        bool near = difference < sum;
        double ox = near ? dx : sx, oy = near ? dy : sy, oz = near ? dz : sz;
        double along = ox * x + oy * y + oz * z;
        double c = sqrt(difference), s = sqrt(sum);
        double product = c * s;
        double scale = weight * (product > 0 ? 4 * lane_atan2(c, s) / product : 1);
        block->sum_x[j] += scale * (ox - along * x);
        block->sum_y[j] += scale * (oy - along * y);
        block->sum_z[j] += scale * (oz - along * z);
        double margin = sum - ANTIPODAL_SQUARED_LENGTH;
        block->margin[j] = margin < block->margin[j] ? margin : block->margin[j];
    }
}

/// exp of the sums, brought back to unit length.
LANES_CLONES
static void sphere_exponentials(sphere_block *block, const double *p, size_t edges, double *fine)
{
    for (size_t j = 0; j < edges; j++)
    {
        double x = block->sum_x[j], y = block->sum_y[j], z = block->sum_z[j];
        double squared = x * x + y * y + z * z;
        double cosine = lane_cos_root(squared), ratio = lane_sinc_root(squared);
        x = cosine * block->x[j] + ratio * x;
        y = cosine * block->y[j] + ratio * y;
        z = cosine * block->z[j] + ratio * z;
        double inverse = 1 / sqrt(x * x + y * y + z * z);
        fine[6 * j] = p[3 * j];
        fine[6 * j + 1] = p[3 * j + 1];
        fine[6 * j + 2] = p[3 * j + 2];
        fine[6 * j + 3] = x * inverse;
        fine[6 * j + 4] = y * inverse;
        fine[6 * j + 5] = z * inverse;
        block->squared_length[j] = squared;
    }
}

static bat_status run_sphere(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, size_t *fault)
{
    const mask_taps *taps = &kernel->odd;
    bool midpoint = kernel->scheme->base == BAT_BASE_MIDPOINT;
    sphere_block block;
    for (size_t done = 0; done < pairs; done += BLOCK)
    {
        size_t edges = pairs - done < BLOCK ? pairs - done : BLOCK;
        const double *p = points + 3 * done;
        sphere_bases(&block, p, edges, midpoint);
        for (size_t k = 0; k < taps->count; k++)
        {
            ptrdiff_t row = taps->start + (ptrdiff_t)k;
            if (midpoint || row != 0)
                sphere_add_logs(&block, p + 3 * row, edges, taps->weights[k]);
        }
        sphere_exponentials(&block, p, edges, fine + 6 * done);
        for (size_t j = 0; j < edges; j++)
        {
            if (!(block.margin[j] > 0))
            {
                *fault = done + j;
                return BAT_CUT_LOCUS;
            }
            if (block.squared_length[j] > SQUARED_PI)
            {
                double tangent[3] = {block.sum_x[j], block.sum_y[j], block.sum_z[j]};
                double base[3] = {block.x[j], block.y[j], block.z[j]};
                kernel->space->exp(kernel->space, base, tangent, fine + 6 * (done + j) + 3);
            }
        }
    }
    return BAT_OK;
}

refine_kernel kernel_log_exp(const bat_space *space, const bat_scheme *scheme)
{
    mask_taps odd = mask_taps_of(&scheme->mask, 1);
    // The stencil always holds the edge's own ends.
    int low = odd.start < 0 ? (int)odd.start : 0;
    int high = (int)odd.start + (int)odd.count - 1;
    high = high > 1 ? high : 1;
    return (refine_kernel){
        .space = space,
        .scheme = scheme,
        .dim = space->point_dim,
        .first = 1 - 2 * high,
        .last = 1 - 2 * low,
        .odd = odd,
        .run = space_is_sphere(space) ? run_sphere : run_any,
    };
}
