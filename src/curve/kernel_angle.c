#include "curve/kernel.h"

#include "base/lanes.h"
#include "space/disk.h"
#include "space/known.h"
#include "space/sphere.h"

#include <float.h>
#include <string.h>

enum
{
    /// Edges refined at a time; the arrays below stay in the first-level cache.
    BLOCK = 128,
    /// Exterior angles that the stencil reaches beyond the block's own vertices: one before, two behind.
    ANGLES = BLOCK + 3,
    /// Vertices those angles are made of.
    VERTICES = ANGLES + 2,
};

/// Adaptive tension (Ugail and Howard, section 7.1): slope and clip range of the tension.
static const double ADAPTIVE_SLOPE = -0.5;
static const double ADAPTIVE_LOW = -0.5, ADAPTIVE_HIGH = 0.1;

/// See disk_insert().
static const double PARALLEL_SHARE = 0.9;

/// One block: vertex i of the block is entry i + 2 of the coordinate arrays; its exterior angle is entry i + 1 of `angle`.
typedef struct angle_block
{
    double x[VERTICES], y[VERTICES], z[VERTICES];
    double angle[ANGLES];
    double slope[BLOCK];  ///< tangent of the insertion angle, positive to the left of the edge
    double margin[BLOCK]; ///< positive where the new vertex exists
    double new_x[BLOCK], new_y[BLOCK], new_z[BLOCK];
} angle_block;

LANES_CLONES
static void load_points(angle_block *block, const double *points, size_t dim, size_t vertices)
{
    if (dim == 2)
        for (size_t i = 0; i < vertices; i++)
        {
            block->x[i] = points[2 * i];
            block->y[i] = points[2 * i + 1];
        }
    else
        for (size_t i = 0; i < vertices; i++)
        {
            block->x[i] = points[3 * i];
            block->y[i] = points[3 * i + 1];
            block->z[i] = points[3 * i + 2];
        }
}

/// Eq. (1). The scale is a power of two, which changes no angle.
LANES_CLONES
static void plane_angles(angle_block *block, size_t count, double scale)
{
    const double *x = block->x, *y = block->y;
    for (size_t i = 0; i < count; i++)
    {
        double ax = scale * (x[i + 1] - x[i]), ay = scale * (y[i + 1] - y[i]);
        double bx = scale * (x[i + 2] - x[i + 1]), by = scale * (y[i + 2] - y[i + 1]);
        block->angle[i] = lane_atan2(ax * by - ay * bx, ax * bx + ay * by);
    }
}

/// sin ~ det(p, a, b), cos ~ <a, b> - <a, p> <b, p> with the chords a = p - before, b = after - p.
LANES_CLONES
static void sphere_angles(angle_block *block, size_t count, double scale)
{
    (void)scale;
    const double *x = block->x, *y = block->y, *z = block->z;
    for (size_t i = 0; i < count; i++)
    {
        double px = x[i + 1], py = y[i + 1], pz = z[i + 1];
        double ax = px - x[i], ay = py - y[i], az = pz - z[i];
        double bx = x[i + 2] - px, by = y[i + 2] - py, bz = z[i + 2] - pz;
        double sine = px * (ay * bz - az * by) + py * (az * bx - ax * bz) + pz * (ax * by - ay * bx);
        double ap = ax * px + ay * py + az * pz, bp = bx * px + by * py + bz * pz;
        block->angle[i] = lane_atan2(sine, ax * bx + ay * by + az * bz - ap * bp);
    }
}

/// With p moved to the origin, the angle from -w(before) to w(after).
LANES_CLONES
static void disk_angles(angle_block *block, size_t count, double scale)
{
    (void)scale;
    const double *x = block->x, *y = block->y;
    for (size_t i = 0; i < count; i++)
    {
        double p[2] = {x[i + 1], y[i + 1]}, before[2] = {x[i], y[i]}, after[2] = {x[i + 2], y[i + 2]};
        double back[2], out[2], denominator[2];
        disk_centre(p, before, back, denominator);
        disk_centre(p, after, out, denominator);
        block->angle[i] = lane_atan2(back[1] * out[0] - back[0] * out[1], -back[0] * out[0] - back[1] * out[1]);
    }
}

/// Eq. (9), limited to the admissible interval.
static inline double slope_of(const double *angle, double tension, double sign)
{
    double insertion = sign * 0.125 * (tension * (angle[0] + angle[3]) + (1 - tension) * (angle[1] + angle[2]));
    insertion = insertion > BAT_ANGLE_LIMIT ? BAT_ANGLE_LIMIT : insertion;
    insertion = insertion < -BAT_ANGLE_LIMIT ? -BAT_ANGLE_LIMIT : insertion;
    return lane_tan(insertion);
}

LANES_CLONES
static void fixed_slopes(angle_block *block, size_t edges, double tension, double sign)
{
    for (size_t j = 0; j < edges; j++)
        block->slope[j] = slope_of(block->angle + j, tension, sign);
}

/// Section 7.1 with absolute angles, so that the rule does not change when the curve is mirrored or reversed.
static inline double adaptive_slope(const double *angle, double tension, double sign, double mean)
{
    double local = 0.25 * (fabs(angle[0]) + fabs(angle[1]) + fabs(angle[2]) + fabs(angle[3]));
    double mu = tension + ADAPTIVE_SLOPE * (local - mean);
    mu = mu < ADAPTIVE_LOW ? ADAPTIVE_LOW : mu;
    mu = mu > ADAPTIVE_HIGH ? ADAPTIVE_HIGH : mu;
    return slope_of(angle, mu, sign);
}

LANES_CLONES
static void adaptive_slopes(angle_block *block, size_t edges, double tension, double sign, double mean)
{
    for (size_t j = 0; j < edges; j++)
        block->slope[j] = adaptive_slope(block->angle + j, tension, sign, mean);
}

/// Eq. (6): the midpoint moved sideways by tan(angle) times half the edge.
LANES_CLONES
static void plane_insert(angle_block *block, size_t edges)
{
    const double *x = block->x + 2, *y = block->y + 2;
    for (size_t j = 0; j < edges; j++)
    {
        double ex = x[j + 1] - x[j], ey = y[j + 1] - y[j], slope = block->slope[j];
        block->new_x[j] = x[j] + 0.5 * (ex - slope * ey);
        block->new_y[j] = y[j] + 0.5 * (ey + slope * ex);
        // 1, or NaN where the new vertex is not finite
        block->margin[j] = 1 + 0 * (block->new_x[j] + block->new_y[j]);
    }
}

/// Eq. (7) as the direction of p + q + tan(angle) p x q; see src/space/sphere.c.
LANES_CLONES
static void sphere_insert(angle_block *block, size_t edges)
{
    const double *x = block->x + 2, *y = block->y + 2, *z = block->z + 2;
    for (size_t j = 0; j < edges; j++)
    {
        double px = x[j], py = y[j], pz = z[j], qx = x[j + 1], qy = y[j + 1], qz = z[j + 1];
        double cx = qx - px, cy = qy - py, cz = qz - pz;
        double sx = px + qx, sy = py + qy, sz = pz + qz;
        double slope = block->slope[j];
        double nx = sx + slope * (py * cz - pz * cy);
        double ny = sy + slope * (pz * cx - px * cz);
        double nz = sz + slope * (px * cy - py * cx);
        double inverse = 1 / sqrt(nx * nx + ny * ny + nz * nz);
        block->new_x[j] = nx * inverse;
        block->new_y[j] = ny * inverse;
        block->new_z[j] = nz * inverse;
        block->margin[j] = sx * sx + sy * sy + sz * sz - SPHERE_ANTIPODAL_SQUARED_LENGTH;
    }
}

/// Eq. (8) corrected; see src/space/disk.c. The two sides meet only below the angle of parallelism of half the edge,
/// cos(angle) = tanh(e/2); the tangent of the insertion angle is limited to PARALLEL_SHARE of its value there.
LANES_CLONES
static void disk_insert(angle_block *block, size_t edges)
{
    const double *x = block->x + 2, *y = block->y + 2;
    for (size_t j = 0; j < edges; j++)
    {
        double p[2] = {x[j], y[j]}, q[2] = {x[j + 1], y[j + 1]}, w[2], denominator[2];
        disk_centre(p, q, w, denominator);
        double rim = disk_rim(p) * disk_rim(q) / (denominator[0] * denominator[0] + denominator[1] * denominator[1]);
        double length = w[0] * w[0] + w[1] * w[1];
        double parallel = sqrt(rim / (length > 0 ? length : DBL_MIN));
        double slope = block->slope[j];
        slope = fabs(slope) > PARALLEL_SHARE * parallel ? copysign(PARALLEL_SHARE * parallel, slope) : slope;
        double scale = 1 / (1 + sqrt(rim - length * slope * slope));
        double z[2] = {scale * (w[0] - slope * w[1]), scale * (w[1] + slope * w[0])}, point[2];
        disk_translate(p, z, point);
        block->new_x[j] = point[0];
        block->new_y[j] = point[1];
        block->margin[j] = disk_rim(point);
    }
}

LANES_CLONES
static void store_points(const angle_block *block, const double *points, size_t dim, size_t edges, double *restrict fine)
{
    if (dim == 2)
        for (size_t j = 0; j < edges; j++)
        {
            fine[4 * j] = points[2 * j];
            fine[4 * j + 1] = points[2 * j + 1];
            fine[4 * j + 2] = block->new_x[j];
            fine[4 * j + 3] = block->new_y[j];
        }
    else
        for (size_t j = 0; j < edges; j++)
        {
            fine[6 * j] = points[3 * j];
            fine[6 * j + 1] = points[3 * j + 1];
            fine[6 * j + 2] = points[3 * j + 2];
            fine[6 * j + 3] = block->new_x[j];
            fine[6 * j + 4] = block->new_y[j];
            fine[6 * j + 5] = block->new_z[j];
        }
}

/// What differs between the oriented surfaces that have vector code.
typedef struct surface
{
    void (*angles)(angle_block *block, size_t count, double scale);
    void (*insert)(angle_block *block, size_t edges);
    bat_status missing; ///< what it means that a new vertex does not exist
} surface;

static const surface PLANE = {plane_angles, plane_insert, BAT_INVALID_POINT};
static const surface SPHERE = {sphere_angles, sphere_insert, BAT_CUT_LOCUS};
static const surface DISK = {disk_angles, disk_insert, BAT_INVALID_POINT};

static const surface *surface_of(const bat_space *space)
{
    return space_is_plane(space) ? &PLANE : space_is_sphere(space) ? &SPHERE : space_is_disk(space) ? &DISK : NULL;
}

static bat_status run_blocks(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, size_t *fault)
{
    const surface *where = surface_of(kernel->space);
    const bat_scheme *scheme = kernel->scheme;
    size_t dim = kernel->dim;
    double sign = scheme->sign == BAT_ANGLE_OUTWARD ? -1 : 1;
    angle_block block;
    for (size_t done = 0; done < pairs; done += BLOCK)
    {
        size_t edges = pairs - done < BLOCK ? pairs - done : BLOCK;
        const double *here = points + done * dim;
        load_points(&block, here - 2 * dim, dim, edges + 5);
        where->angles(&block, edges + 3, kernel->scale);
        if (scheme->adaptive)
            adaptive_slopes(&block, edges, scheme->tension, sign, kernel->mean_angle);
        else
            fixed_slopes(&block, edges, scheme->tension, sign);
        where->insert(&block, edges);
        for (size_t j = 0; j < edges; j++)
            if (!(block.margin[j] > 0))
            {
                *fault = done + j;
                return where->missing;
            }
        store_points(&block, here, dim, edges, fine + 2 * done * dim);
    }
    return BAT_OK;
}

/// Any other oriented surface, through its own functions.
static bat_status run_any(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, size_t *fault)
{
    const bat_space *space = kernel->space;
    const bat_scheme *scheme = kernel->scheme;
    size_t dim = kernel->dim;
    double sign = scheme->sign == BAT_ANGLE_OUTWARD ? -1 : 1;
    for (size_t j = 0; j < pairs; j++)
    {
        const double *p = points + j * dim;
        double angle[4], slope;
        for (size_t i = 0; i < 4; i++)
            angle[i] = space->exterior_angle(space, p + i * dim - 2 * dim, p + i * dim - dim, p + i * dim);
        if (scheme->adaptive)
            slope = adaptive_slope(angle, scheme->tension, sign, kernel->mean_angle);
        else
            slope = slope_of(angle, scheme->tension, sign);
        memcpy(fine + 2 * j * dim, p, dim * sizeof *p);
        bat_status status = space->apex(space, p, p + dim, atan(slope), fine + (2 * j + 1) * dim);
        if (status != BAT_OK)
        {
            *fault = j;
            return status;
        }
    }
    return BAT_OK;
}

refine_kernel kernel_angle(const bat_space *space, const bat_scheme *scheme)
{
    return (refine_kernel){
        .space = space,
        .scheme = scheme,
        .dim = space->point_dim,
        .first = -5,
        .last = 5,
        .run = surface_of(space) != NULL ? run_blocks : run_any,
    };
}

double kernel_angle_mean(const refine_kernel *kernel, const double *points, size_t first, size_t end)
{
    const bat_space *space = kernel->space;
    const surface *where = surface_of(space);
    size_t dim = space->point_dim;
    double sum = 0;
    angle_block block;
    for (size_t done = first; done < end; done += BLOCK)
    {
        size_t count = end - done < BLOCK ? end - done : BLOCK;
        const double *before = points + done * dim - dim;
        if (where != NULL)
        {
            load_points(&block, before, dim, count + 2);
            where->angles(&block, count, kernel->scale);
        }
        for (size_t i = 0; i < count; i++)
            sum += fabs(where != NULL ? block.angle[i]
                                      : space->exterior_angle(space, before + i * dim, before + (i + 1) * dim,
                                                              before + (i + 2) * dim));
    }
    return end > first ? sum / (double)(end - first) : 0;
}
