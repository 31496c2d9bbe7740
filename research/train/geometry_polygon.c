#include "research/train/geometry_polygon.h"

#include "base/lanes.h"
#include "research/train/geometry_block.h"
#include "space/builtin.h"

// The derivative of angles needs no angle at a vertex, only edges: with arg(p, q) the direction from p to q,
// the exterior angle is arg(p, after) - arg(p, before) + pi, so that one edge (p, q) contributes
// (gradient at p) d arg(p, q) - (gradient at q) d arg(q, p).

/// Measures of the block's vertices i + 1 of the rows: their angles, and the lengths of the edges from there. In the disk
/// the lengths are to be replaced by 2 asinh of their values.
typedef void measure_function(const geometry_rows *restrict rows, size_t count, double *restrict angles,
                              double *restrict lengths);

LANES_CLONES
static void plane_measure(const geometry_rows *restrict rows, size_t count, double *restrict angles,
                          double *restrict lengths)
{
    const double *x = rows->x, *y = rows->y;
    for (size_t i = 0; i < count; i++)
    {
        double ax = x[i + 1] - x[i], ay = y[i + 1] - y[i];
        double bx = x[i + 2] - x[i + 1], by = y[i + 2] - y[i + 1];
        angles[i] = lane_atan2(ax * by - ay * bx, ax * bx + ay * by);
        lengths[i] = sqrt(bx * bx + by * by);
    }
}

/// See src/space/sphere.c: angles from chords, lengths from half angles.
LANES_CLONES
static void sphere_measure(const geometry_rows *restrict rows, size_t count, double *restrict angles,
                           double *restrict lengths)
{
    const double *x = rows->x, *y = rows->y, *z = rows->z;
    for (size_t i = 0; i < count; i++)
    {
        double px = x[i + 1], py = y[i + 1], pz = z[i + 1];
        double ax = px - x[i], ay = py - y[i], az = pz - z[i];
        double bx = x[i + 2] - px, by = y[i + 2] - py, bz = z[i + 2] - pz;
        double sx = x[i + 2] + px, sy = y[i + 2] + py, sz = z[i + 2] + pz;
        double sine = px * (ay * bz - az * by) + py * (az * bx - ax * bz) + pz * (ax * by - ay * bx);
        double ap = ax * px + ay * py + az * pz, bp = bx * px + by * py + bz * pz;
        angles[i] = lane_atan2(sine, ax * bx + ay * by + az * bz - ap * bp);
        lengths[i] = 2 * lane_atan2(sqrt(bx * bx + by * by + bz * bz), sqrt(sx * sx + sy * sy + sz * sz));
    }
}

/// See src/space/disk.c.
LANES_CLONES
static void disk_measure(const geometry_rows *restrict rows, size_t count, double *restrict angles, double *restrict lengths)
{
    const double *x = rows->x, *y = rows->y;
    for (size_t i = 0; i < count; i++)
    {
        double before[2] = {x[i], y[i]}, p[2] = {x[i + 1], y[i + 1]}, after[2] = {x[i + 2], y[i + 2]};
        double back[2], out[2], denominator[2];
        disk_centre(p, before, back, denominator);
        disk_centre(p, after, out, denominator);
        angles[i] = lane_atan2(back[1] * out[0] - back[0] * out[1], -back[0] * out[0] - back[1] * out[1]);
        double ex = after[0] - p[0], ey = after[1] - p[1];
        lengths[i] = sqrt((ex * ex + ey * ey) / (disk_complement(p) * disk_complement(after)));
    }
}

/// Gradients with respect to the two ends of edge i, from row i to row i + 1, given those with respect to the angles at its
/// ends, angles[i] and angles[i + 1], and its length.
typedef void edge_function(const geometry_rows *restrict rows, size_t count, const double *restrict angles,
                           const double *restrict lengths, geometry_rows *restrict starts, geometry_rows *restrict ends);

static inline double inverse_or_zero(double x)
{
    return x > 0 ? 1 / x : 0;
}

LANES_CLONES
static void plane_edges_back(const geometry_rows *restrict rows, size_t count, const double *restrict angles,
                             const double *restrict lengths, geometry_rows *restrict starts, geometry_rows *restrict ends)
{
    for (size_t i = 0; i < count; i++)
    {
        double ex = rows->x[i + 1] - rows->x[i], ey = rows->y[i + 1] - rows->y[i];
        double inverse = inverse_or_zero(sqrt(ex * ex + ey * ey));
        double across = (angles[i] - angles[i + 1]) * inverse * inverse, along = lengths[i] * inverse;
        ends->x[i] = along * ex - across * ey;
        ends->y[i] = along * ey + across * ex;
        starts->x[i] = -ends->x[i];
        starts->y[i] = -ends->y[i];
    }
}

/// With n the unit normal of the great circle: moving q by h along n turns the direction from p by h / sin e, moving p turns
/// it by -h / tan e; lengths grow along n x q and -n x p.
LANES_CLONES
static void sphere_edges_back(const geometry_rows *restrict rows, size_t count, const double *restrict angles,
                              const double *restrict lengths, geometry_rows *restrict starts, geometry_rows *restrict ends)
{
    for (size_t i = 0; i < count; i++)
    {
        double px = rows->x[i], py = rows->y[i], pz = rows->z[i];
        double qx = rows->x[i + 1], qy = rows->y[i + 1], qz = rows->z[i + 1];
        double ex = qx - px, ey = qy - py, ez = qz - pz;
        double nx = py * ez - pz * ey, ny = pz * ex - px * ez, nz = px * ey - py * ex;
        double inverse = inverse_or_zero(sqrt(nx * nx + ny * ny + nz * nz));
        double cosine = px * qx + py * qy + pz * qz, along = lengths[i] * inverse;
        double at_p = (angles[i + 1] - cosine * angles[i]) * inverse * inverse;
        double at_q = (angles[i] - cosine * angles[i + 1]) * inverse * inverse;
        starts->x[i] = at_p * nx - along * (ny * pz - nz * py);
        starts->y[i] = at_p * ny - along * (nz * px - nx * pz);
        starts->z[i] = at_p * nz - along * (nx * py - ny * px);
        ends->x[i] = at_q * nx + along * (ny * qz - nz * qy);
        ends->y[i] = at_q * ny + along * (nz * qx - nx * qz);
        ends->z[i] = at_q * nz + along * (nx * qy - ny * qx);
    }
}

/// arg(p, q) is the argument of (q - p) / D, D = 1 - conj(p) q; its derivatives with respect to q and p are, as covectors,
/// Im(k dq), k = (1 - |p|^2) / ((q - p) D), and Im(-dp / (q - p) + (q / D) conj(dp)).
LANES_CLONES
static void disk_edges_back(const geometry_rows *restrict rows, size_t count, const double *restrict angles,
                            const double *restrict lengths, geometry_rows *restrict starts, geometry_rows *restrict ends)
{
    for (size_t i = 0; i < count; i++)
    {
        double p[2] = {rows->x[i], rows->y[i]}, q[2] = {rows->x[i + 1], rows->y[i + 1]};
        double ex = q[0] - p[0], ey = q[1] - p[1], complement_p = disk_complement(p), complement_q = disk_complement(q);
        double dx = complement_p - (p[0] * ex + p[1] * ey), dy = p[1] * ex - p[0] * ey;
        double chord = sqrt(ex * ex + ey * ey), denominator = sqrt(dx * dx + dy * dy);
        double over_chord = inverse_or_zero(chord), over_denominator = 1 / denominator;
        // 1 / (q - p), 1 / D, and the products 1 / ((q - p) D) and 1 / ((q - p) conj(D)).
        double ux = ex * over_chord * over_chord, uy = -ey * over_chord * over_chord;
        double vx = dx * over_denominator * over_denominator, vy = -dy * over_denominator * over_denominator;
        double kx = ux * vx - uy * vy, ky = ux * vy + uy * vx;
        double lx = ux * vx + uy * vy, ly = uy * vx - ux * vy;
        // q / D and p / conj(D).
        double ax = q[0] * vx - q[1] * vy, ay = q[0] * vy + q[1] * vx;
        double bx = p[0] * vx + p[1] * vy, by = p[1] * vx - p[0] * vy;
        double at_p = angles[i], at_q = -angles[i + 1];
        double along = 2 * lengths[i] * over_chord * over_denominator, outward = 2 * lengths[i] * chord * over_denominator;
        starts->x[i] = at_p * (ay - uy) - at_q * complement_q * ly - along * ex + outward / complement_p * p[0];
        starts->y[i] = -at_p * (ax + ux) - at_q * complement_q * lx - along * ey + outward / complement_p * p[1];
        ends->x[i] = at_p * complement_p * ky + at_q * (by + uy) + along * ex + outward / complement_q * q[0];
        ends->y[i] = at_p * complement_p * kx - at_q * (bx - ux) + along * ey + outward / complement_q * q[1];
    }
}

static measure_function *const measures[] = {disk_measure, plane_measure, sphere_measure};
static edge_function *const edges_back[] = {disk_edges_back, plane_edges_back, sphere_edges_back};

void geometry_measure(const geometry_polygon *polygon, geometry_profile profile)
{
    size_t count = polygon->count, dim = geometry_dim(polygon->surface);
    geometry_rows rows;
    for (size_t done = 0; done < count; done += GEOMETRY_BLOCK)
    {
        size_t block = count - done < GEOMETRY_BLOCK ? count - done : GEOMETRY_BLOCK;
        geometry_load(polygon->points, count, dim, done == 0 ? count - 1 : done - 1, block + 2, &rows);
        measures[polygon->surface + 1](&rows, block, profile.angles + done, profile.lengths + done);
    }
    if (polygon->surface == GEOMETRY_DISK)
        for (size_t j = 0; j < count; j++)
            profile.lengths[j] = 2 * asinh(profile.lengths[j]);
    if (!polygon->closed)
        profile.angles[0] = profile.angles[count - 1] = profile.lengths[count - 1] = 0;
}

/// What an edge function needs of the gradients of edges first … first + block - 1.
static void load_gradients(const geometry_polygon *polygon, geometry_profile gradient, size_t first, size_t block,
                           double *angles, double *lengths)
{
    size_t count = polygon->count;
    for (size_t i = 0; i <= block; i++)
    {
        size_t vertex = first + i == count ? 0 : first + i;
        bool is_end = !polygon->closed && (vertex == 0 || vertex == count - 1);
        angles[i] = is_end ? 0 : gradient.angles[vertex];
        lengths[i] = !polygon->closed && vertex == count - 1 ? 0 : gradient.lengths[vertex];
    }
}

void geometry_measure_back(const geometry_polygon *polygon, geometry_profile gradient, double *point_gradients)
{
    size_t count = polygon->count, dim = geometry_dim(polygon->surface);
    geometry_rows rows, starts, ends;
    double angles[GEOMETRY_BLOCK + 1], lengths[GEOMETRY_BLOCK + 1];
    for (size_t done = 0; done < count; done += GEOMETRY_BLOCK)
    {
        size_t block = count - done < GEOMETRY_BLOCK ? count - done : GEOMETRY_BLOCK;
        geometry_load(polygon->points, count, dim, done, block + 1, &rows);
        load_gradients(polygon, gradient, done, block, angles, lengths);
        edges_back[polygon->surface + 1](&rows, block, angles, lengths, &starts, &ends);
        geometry_add(&starts, block, point_gradients, count, dim, done);
        geometry_add(&ends, block, point_gradients, count, dim, done + 1);
    }
}

double geometry_mean_length(const geometry_polygon *polygon, geometry_profile profile)
{
    size_t edges = geometry_edges(polygon);
    double sum = 0;
    for (size_t j = 0; j < edges; j++)
        sum += profile.lengths[j];
    return sum / (double)edges;
}

void geometry_mean_length_back(const geometry_polygon *polygon, double mean_gradient, geometry_profile gradient)
{
    size_t edges = geometry_edges(polygon);
    for (size_t j = 0; j < edges; j++)
        gradient.lengths[j] += mean_gradient / (double)edges;
}

// Isometries

static const double TWO_PI = 6.28318530717958647693;

/// The rotation of a uniform unit quaternion.
static void random_rotation(bat_random *random, double rotation[9])
{
    double q[4], square;
    do
    {
        square = 0;
        for (int i = 0; i < 4; i++)
        {
            q[i] = bat_random_normal(random);
            square += q[i] * q[i];
        }
    } while (square == 0);
    double w = q[0], x = q[1], y = q[2], z = q[3], s = 2 / square;
    const double entries[9] = {1 - s * (y * y + z * z), s * (x * y - w * z),     s * (x * z + w * y),
                               s * (x * y + w * z),     1 - s * (x * x + z * z), s * (y * z - w * x),
                               s * (x * z - w * y),     s * (y * z + w * x),     1 - s * (x * x + y * y)};
    for (int i = 0; i < 9; i++)
        rotation[i] = entries[i];
}

geometry_isometry geometry_isometry_random(geometry_surface surface, double reach, bat_random *random)
{
    geometry_isometry isometry = {.surface = surface};
    if (surface == GEOMETRY_SPHERE)
    {
        random_rotation(random, isometry.rotation);
        return isometry;
    }
    double angle = TWO_PI * bat_random_uniform(random), direction = TWO_PI * bat_random_uniform(random);
    double distance = reach * bat_random_uniform(random);
    double length = surface == GEOMETRY_DISK ? tanh(0.5 * distance) : distance;
    isometry.rotation[0] = isometry.rotation[3] = cos(angle);
    isometry.rotation[2] = sin(angle);
    isometry.rotation[1] = -isometry.rotation[2];
    isometry.shift[0] = length * cos(direction);
    isometry.shift[1] = length * sin(direction);
    return isometry;
}

static void rotate(const double *rotation, const double *point, size_t dim, double *rotated)
{
    for (size_t i = 0; i < dim; i++)
    {
        rotated[i] = 0;
        for (size_t k = 0; k < dim; k++)
            rotated[i] += rotation[i * dim + k] * point[k];
    }
}

void geometry_isometry_apply(const geometry_isometry *isometry, const double *points, size_t count, double *moved)
{
    size_t dim = geometry_dim(isometry->surface);
    for (size_t j = 0; j < count; j++, moved += dim)
    {
        double rotated[3];
        rotate(isometry->rotation, points + j * dim, dim, rotated);
        if (isometry->surface == GEOMETRY_DISK)
            disk_translate(isometry->shift, rotated, moved);
        else
            for (size_t i = 0; i < dim; i++)
                moved[i] = rotated[i] + (isometry->surface == GEOMETRY_PLANE ? isometry->shift[i] : 0);
    }
}
