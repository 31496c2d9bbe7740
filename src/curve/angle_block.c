#include "curve/angle_block.h"

#include "curve/kernel.h"
#include "space/builtin.h"

#include <float.h>

/// See disk_insert().
static const double PARALLEL_SHARE = 0.9;

// A function with clones must be static: compilers forget that a name with clones is hidden.

LANES_CLONES
static void load_points(angle_block *block, size_t entry, const double *points, size_t dim, size_t vertices)
{
    double *x = block->x + entry, *y = block->y + entry, *z = block->z + entry;
    if (dim == 2)
        for (size_t i = 0; i < vertices; i++)
        {
            x[i] = points[2 * i];
            y[i] = points[2 * i + 1];
        }
    else
        for (size_t i = 0; i < vertices; i++)
        {
            x[i] = points[3 * i];
            y[i] = points[3 * i + 1];
            z[i] = points[3 * i + 2];
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
static void sphere_angles(angle_block *block, size_t count, double scale BAT_UNUSED)
{
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
static void disk_angles(angle_block *block, size_t count, double scale BAT_UNUSED)
{
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

/// Chords; the scale keeps their squares within range.
LANES_CLONES
static void plane_lengths(angle_block *block, size_t count, double scale)
{
    const double *x = block->x, *y = block->y;
    double inverse = 1 / scale;
    for (size_t i = 0; i < count; i++)
    {
        double ex = scale * (x[i + 1] - x[i]), ey = scale * (y[i + 1] - y[i]);
        block->length[i] = inverse * sqrt(ex * ex + ey * ey);
    }
}

/// By half angles; see src/space/sphere.c.
LANES_CLONES
static void sphere_lengths(angle_block *block, size_t count, double scale BAT_UNUSED)
{
    const double *x = block->x, *y = block->y, *z = block->z;
    for (size_t i = 0; i < count; i++)
    {
        double ex = x[i + 1] - x[i], ey = y[i + 1] - y[i], ez = z[i + 1] - z[i];
        double sx = x[i + 1] + x[i], sy = y[i + 1] + y[i], sz = z[i + 1] + z[i];
        block->length[i] = 2 * lane_atan2(sqrt(ex * ex + ey * ey + ez * ez), sqrt(sx * sx + sy * sy + sz * sz));
    }
}

LANES_CLONES
static void disk_half_sines(angle_block *block, size_t count)
{
    const double *x = block->x, *y = block->y;
    for (size_t i = 0; i < count; i++)
    {
        double p[2] = {x[i], y[i]}, q[2] = {x[i + 1], y[i + 1]};
        double ex = q[0] - p[0], ey = q[1] - p[1];
        block->length[i] = sqrt((ex * ex + ey * ey) / (disk_complement(p) * disk_complement(q)));
    }
}

/// See src/space/disk.c.
static void disk_lengths(angle_block *block, size_t count, double scale BAT_UNUSED)
{
    disk_half_sines(block, count);
    for (size_t i = 0; i < count; i++)
        block->length[i] = 2 * asinh(block->length[i]);
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
        double complement =
            disk_complement(p) * disk_complement(q) / (denominator[0] * denominator[0] + denominator[1] * denominator[1]);
        double length = w[0] * w[0] + w[1] * w[1];
        double parallel = sqrt(complement / (length > 0 ? length : DBL_MIN));
        double slope = block->slope[j];
        slope = fabs(slope) > PARALLEL_SHARE * parallel ? copysign(PARALLEL_SHARE * parallel, slope) : slope;
        double scale = 1 / (1 + sqrt(complement - length * slope * slope));
        double z[2] = {scale * (w[0] - slope * w[1]), scale * (w[1] + slope * w[0])}, point[2];
        disk_translate(p, z, point);
        block->new_x[j] = point[0];
        block->new_y[j] = point[1];
        block->margin[j] = disk_complement(point);
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

static const angle_surface PLANE = {plane_angles, plane_lengths, plane_insert, BAT_INVALID_POINT};
static const angle_surface SPHERE = {sphere_angles, sphere_lengths, sphere_insert, BAT_CUT_LOCUS};
static const angle_surface DISK = {disk_angles, disk_lengths, disk_insert, BAT_INVALID_POINT};

const angle_surface *angle_surface_of(const bat_space *space)
{
    return space_is_plane(space) ? &PLANE : space_is_sphere(space) ? &SPHERE : space_is_disk(space) ? &DISK : NULL;
}

void angle_block_load(angle_block *block, size_t entry, const double *points, size_t dim, size_t vertices)
{
    load_points(block, entry, points, dim, vertices);
}

void angle_block_store(const angle_block *block, const double *points, size_t dim, size_t edges, double *restrict fine)
{
    store_points(block, points, dim, edges, fine);
}

double kernel_scale(const double *points, size_t count, size_t dim)
{
    static const int MAX_EXPONENT = 1000;
    double largest = vector_largest(count * dim, points);
    int exponent = largest > 0 && isfinite(largest) ? -ilogb(largest) : 0;
    exponent = exponent > MAX_EXPONENT ? MAX_EXPONENT : exponent < -MAX_EXPONENT ? -MAX_EXPONENT : exponent;
    return ldexp(1, exponent);
}
