#include "research/train/geometry_insert.h"

#include "base/lanes.h"
#include "research/train/geometry_block.h"
#include "space/builtin.h"

#include <float.h>

/// Of the tangent of the angle at which the sides over an edge of the disk become parallel.
static const double PARALLEL_SHARE = 0.9;

/// The new vertices of edges from row i to row i + 1.
typedef void insert_function(const geometry_rows *restrict rows, size_t edges, const double *restrict angles,
                             geometry_rows *restrict apexes);

/// Gradients with respect to the ends of the edges and the angles, given those with respect to the new vertices.
typedef void insert_back_function(const geometry_rows *restrict rows, size_t edges, const double *restrict angles,
                                  const geometry_rows *restrict gradients, geometry_rows *restrict starts,
                                  geometry_rows *restrict ends, double *restrict angle_gradients);

/// (p + q) / 2 + tan(angle) / 2 times the edge turned left.
LANES_CLONES
static void plane_insert(const geometry_rows *restrict rows, size_t edges, const double *restrict angles,
                         geometry_rows *restrict apexes)
{
    for (size_t j = 0; j < edges; j++)
    {
        double ex = rows->x[j + 1] - rows->x[j], ey = rows->y[j + 1] - rows->y[j], slope = lane_tan(angles[j]);
        apexes->x[j] = rows->x[j] + 0.5 * (ex - slope * ey);
        apexes->y[j] = rows->y[j] + 0.5 * (ey + slope * ex);
    }
}

LANES_CLONES
static void plane_insert_back(const geometry_rows *restrict rows, size_t edges, const double *restrict angles,
                              const geometry_rows *restrict gradients, geometry_rows *restrict starts,
                              geometry_rows *restrict ends, double *restrict angle_gradients)
{
    for (size_t j = 0; j < edges; j++)
    {
        double ex = rows->x[j + 1] - rows->x[j], ey = rows->y[j + 1] - rows->y[j], slope = lane_tan(angles[j]);
        double gx = gradients->x[j], gy = gradients->y[j];
        ends->x[j] = 0.5 * (gx + slope * gy);
        ends->y[j] = 0.5 * (gy - slope * gx);
        starts->x[j] = gx - ends->x[j];
        starts->y[j] = gy - ends->y[j];
        angle_gradients[j] = 0.5 * (1 + slope * slope) * (gy * ex - gx * ey);
    }
}

/// A point of the sphere as the direction of a vector.
typedef struct direction
{
    double x, y, z;
    double inverse; ///< 1 / length of the vector
} direction;

/// The direction of p + q + slope p x q, where `normal` is p x q.
static inline direction sphere_apex(const geometry_rows *rows, size_t j, double slope, const double normal[3])
{
    double x = rows->x[j] + rows->x[j + 1] + slope * normal[0];
    double y = rows->y[j] + rows->y[j + 1] + slope * normal[1];
    double z = rows->z[j] + rows->z[j + 1] + slope * normal[2];
    double inverse = 1 / sqrt(x * x + y * y + z * z);
    return (direction){x * inverse, y * inverse, z * inverse, inverse};
}

/// p x q from the chord, exact for near points.
static inline void sphere_normal(const geometry_rows *rows, size_t j, double normal[3])
{
    double px = rows->x[j], py = rows->y[j], pz = rows->z[j];
    double ex = rows->x[j + 1] - px, ey = rows->y[j + 1] - py, ez = rows->z[j + 1] - pz;
    normal[0] = py * ez - pz * ey;
    normal[1] = pz * ex - px * ez;
    normal[2] = px * ey - py * ex;
}

LANES_CLONES
static void sphere_insert(const geometry_rows *restrict rows, size_t edges, const double *restrict angles,
                          geometry_rows *restrict apexes)
{
    for (size_t j = 0; j < edges; j++)
    {
        double normal[3];
        sphere_normal(rows, j, normal);
        direction apex = sphere_apex(rows, j, lane_tan(angles[j]), normal);
        apexes->x[j] = apex.x;
        apexes->y[j] = apex.y;
        apexes->z[j] = apex.z;
    }
}

LANES_CLONES
static void sphere_insert_back(const geometry_rows *restrict rows, size_t edges, const double *restrict angles,
                               const geometry_rows *restrict gradients, geometry_rows *restrict starts,
                               geometry_rows *restrict ends, double *restrict angle_gradients)
{
    for (size_t j = 0; j < edges; j++)
    {
        double px = rows->x[j], py = rows->y[j], pz = rows->z[j];
        double qx = rows->x[j + 1], qy = rows->y[j + 1], qz = rows->z[j + 1];
        double slope = lane_tan(angles[j]), normal[3];
        sphere_normal(rows, j, normal);
        direction apex = sphere_apex(rows, j, slope, normal);
        double gx = gradients->x[j], gy = gradients->y[j], gz = gradients->z[j];
        double radial = gx * apex.x + gy * apex.y + gz * apex.z;
        gx = (gx - radial * apex.x) * apex.inverse;
        gy = (gy - radial * apex.y) * apex.inverse;
        gz = (gz - radial * apex.z) * apex.inverse;
        starts->x[j] = gx + slope * (qy * gz - qz * gy);
        starts->y[j] = gy + slope * (qz * gx - qx * gz);
        starts->z[j] = gz + slope * (qx * gy - qy * gx);
        ends->x[j] = gx + slope * (gy * pz - gz * py);
        ends->y[j] = gy + slope * (gz * px - gx * pz);
        ends->z[j] = gz + slope * (gx * py - gy * px);
        angle_gradients[j] = (1 + slope * slope) * (gx * normal[0] + gy * normal[1] + gz * normal[2]);
    }
}

/// Common to both directions in the disk: w = (-p) + q (a Möbius sum) with its denominator, and the new vertex relative to
/// p, z = scale (1 + i slope) w.
typedef struct disk_edge
{
    double p[2], q[2], w[2], denominator[2], z[2];
    double squared_length; ///< |w|^2
    double slope;          ///< limited
    bool limited;
    double root, scale;
} disk_edge;

static inline disk_edge disk_edge_of(const geometry_rows *rows, size_t j, double angle)
{
    disk_edge edge = {.p = {rows->x[j], rows->y[j]}, .q = {rows->x[j + 1], rows->y[j + 1]}};
    disk_centre(edge.p, edge.q, edge.w, edge.denominator);
    double dx = edge.denominator[0], dy = edge.denominator[1];
    double complement = disk_complement(edge.p) * disk_complement(edge.q) / (dx * dx + dy * dy); // 1 - |w|^2
    edge.squared_length = edge.w[0] * edge.w[0] + edge.w[1] * edge.w[1];
    double limit = PARALLEL_SHARE * sqrt(complement / (edge.squared_length > 0 ? edge.squared_length : DBL_MIN));
    double slope = lane_tan(angle);
    edge.limited = fabs(slope) > limit;
    edge.slope = edge.limited ? copysign(limit, slope) : slope;
    edge.root = sqrt(complement - edge.squared_length * edge.slope * edge.slope);
    edge.scale = 1 / (1 + edge.root);
    edge.z[0] = edge.scale * (edge.w[0] - edge.slope * edge.w[1]);
    edge.z[1] = edge.scale * (edge.w[1] + edge.slope * edge.w[0]);
    return edge;
}

LANES_CLONES
static void disk_insert(const geometry_rows *restrict rows, size_t edges, const double *restrict angles,
                        geometry_rows *restrict apexes)
{
    for (size_t j = 0; j < edges; j++)
    {
        disk_edge edge = disk_edge_of(rows, j, angles[j]);
        double apex[2];
        disk_translate(edge.p, edge.z, apex);
        apexes->x[j] = apex[0];
        apexes->y[j] = apex[1];
    }
}

/// Gradients as complex numbers g, for which a change dz of the argument changes the loss by Re(conj(g) dz).
/// For f(z, conj(z)) that gradient goes back to conj(df/dz) g + (df/dconj(z)) conj(g).
typedef struct disk_gradients
{
    double p[2], q[2], angle;
} disk_gradients;

/// Back through p + z = (p + z) / E, E = 1 + conj(p) z: derivatives (1 - |p|^2) / E^2 in z, 1 / E in p, -(p + z) z / E^2 in
/// conj(p).
static inline void disk_translate_back(const double p[2], const double z[2], const double g[2], double g_p[2], double g_z[2])
{
    double ex = 1 + p[0] * z[0] + p[1] * z[1], ey = p[0] * z[1] - p[1] * z[0];
    double inverse = 1 / (ex * ex + ey * ey);
    double vx = ex * inverse, vy = -ey * inverse; // 1 / E
    // conj(1 / E) g
    double hx = vx * g[0] + vy * g[1], hy = vx * g[1] - vy * g[0];
    double complement = disk_complement(p);
    g_z[0] = complement * (vx * hx + vy * hy);
    g_z[1] = complement * (vx * hy - vy * hx);
    // z / E and (p + z) / E; their product times conj(g).
    double ax = z[0] * vx - z[1] * vy, ay = z[0] * vy + z[1] * vx;
    double sx = p[0] + z[0], sy = p[1] + z[1];
    double mx = sx * vx - sy * vy, my = sx * vy + sy * vx;
    double kx = ax * mx - ay * my, ky = ax * my + ay * mx;
    g_p[0] = hx - (kx * g[0] + ky * g[1]);
    g_p[1] = hy - (ky * g[0] - kx * g[1]);
}

/// Back through w = (q - p) / D, D = 1 - conj(p) q: derivatives (1 - |p|^2) / D^2 in q, -1 / D in p, w q / D in conj(p).
static inline void disk_centre_back(const disk_edge *edge, const double g[2], double g_p[2], double g_q[2])
{
    double dx = edge->denominator[0], dy = edge->denominator[1];
    double inverse = 1 / (dx * dx + dy * dy);
    double vx = dx * inverse, vy = -dy * inverse;
    double hx = vx * g[0] + vy * g[1], hy = vx * g[1] - vy * g[0];
    double complement = disk_complement(edge->p);
    g_q[0] = complement * (vx * hx + vy * hy);
    g_q[1] = complement * (vx * hy - vy * hx);
    double ax = edge->q[0] * vx - edge->q[1] * vy, ay = edge->q[0] * vy + edge->q[1] * vx;
    double kx = ax * edge->w[0] - ay * edge->w[1], ky = ax * edge->w[1] + ay * edge->w[0];
    g_p[0] = kx * g[0] + ky * g[1] - hx;
    g_p[1] = ky * g[0] - kx * g[1] - hy;
}

/// Back through z = scale (1 + i slope) w, scale = 1 / (1 + root), root^2 = 1 - n (1 + slope^2), n = |w|^2, and through the
/// limit slope = +-share sqrt((1 - n) / n) where it holds.
static inline double disk_apex_back(const disk_edge *edge, const double g[2], double g_w[2])
{
    double t = edge->slope, n = edge->squared_length;
    double turned[2] = {edge->w[0] - t * edge->w[1], edge->w[1] + t * edge->w[0]};
    double g_root = -edge->scale * edge->scale * (g[0] * turned[0] + g[1] * turned[1]);
    double g_square = 0.5 * g_root / edge->root;
    double g_slope = edge->scale * (g[1] * edge->w[0] - g[0] * edge->w[1]) - 2 * n * t * g_square;
    double g_n = -(1 + t * t) * g_square;
    g_n += edge->limited ? -0.5 * g_slope * PARALLEL_SHARE * PARALLEL_SHARE / (t * n * n) : 0;
    g_w[0] = edge->scale * (g[0] + t * g[1]) + 2 * g_n * edge->w[0];
    g_w[1] = edge->scale * (g[1] - t * g[0]) + 2 * g_n * edge->w[1];
    return edge->limited ? 0 : g_slope * (1 + t * t);
}

LANES_CLONES
static void disk_insert_back(const geometry_rows *restrict rows, size_t edges, const double *restrict angles,
                             const geometry_rows *restrict gradients, geometry_rows *restrict starts,
                             geometry_rows *restrict ends, double *restrict angle_gradients)
{
    for (size_t j = 0; j < edges; j++)
    {
        disk_edge edge = disk_edge_of(rows, j, angles[j]);
        double g[2] = {gradients->x[j], gradients->y[j]}, outer[2], inner[2], g_z[2], g_w[2], g_q[2];
        disk_translate_back(edge.p, edge.z, g, outer, g_z);
        angle_gradients[j] = disk_apex_back(&edge, g_z, g_w);
        disk_centre_back(&edge, g_w, inner, g_q);
        starts->x[j] = outer[0] + inner[0];
        starts->y[j] = outer[1] + inner[1];
        ends->x[j] = g_q[0];
        ends->y[j] = g_q[1];
    }
}

static insert_function *const inserts[] = {disk_insert, plane_insert, sphere_insert};
static insert_back_function *const inserts_back[] = {disk_insert_back, plane_insert_back, sphere_insert_back};

void geometry_insert(const geometry_polygon *polygon, const double *insertion_angles, double *fine)
{
    size_t count = polygon->count, edges = geometry_edges(polygon), dim = geometry_dim(polygon->surface);
    geometry_rows rows, apexes;
    for (size_t done = 0; done < edges; done += GEOMETRY_BLOCK)
    {
        size_t block = edges - done < GEOMETRY_BLOCK ? edges - done : GEOMETRY_BLOCK;
        geometry_load(polygon->points, count, dim, done, block + 1, &rows);
        inserts[polygon->surface + 1](&rows, block, insertion_angles + done, &apexes);
        geometry_store(&rows, block, fine + 2 * done * dim, dim, 2);
        geometry_store(&apexes, block, fine + (2 * done + 1) * dim, dim, 2);
    }
    for (size_t i = 0; !polygon->closed && i < dim; i++)
        fine[2 * edges * dim + i] = polygon->points[edges * dim + i];
}

void geometry_insert_back(const geometry_polygon *polygon, const double *insertion_angles, const double *fine_gradients,
                          double *point_gradients, double *insertion_gradients)
{
    size_t count = polygon->count, edges = geometry_edges(polygon), dim = geometry_dim(polygon->surface);
    geometry_rows rows, gradients, starts, ends;
    double angle_gradients[GEOMETRY_BLOCK];
    for (size_t done = 0; done < edges; done += GEOMETRY_BLOCK)
    {
        size_t block = edges - done < GEOMETRY_BLOCK ? edges - done : GEOMETRY_BLOCK;
        geometry_load(polygon->points, count, dim, done, block + 1, &rows);
        geometry_load_strided(fine_gradients + (2 * done + 1) * dim, block, dim, 2, &gradients);
        inserts_back[polygon->surface + 1](&rows, block, insertion_angles + done, &gradients, &starts, &ends,
                                           angle_gradients);
        for (size_t j = 0; insertion_gradients != NULL && j < block; j++)
            insertion_gradients[done + j] += angle_gradients[j];
        if (point_gradients == NULL)
            continue;
        geometry_add(&starts, block, point_gradients, count, dim, done);
        geometry_add(&ends, block, point_gradients, count, dim, done + 1);
    }
    for (size_t j = 0; point_gradients != NULL && j < count; j++)
        for (size_t i = 0; i < dim; i++)
            point_gradients[j * dim + i] += fine_gradients[2 * j * dim + i];
}

static double angle_at(const geometry_polygon *polygon, geometry_profile profile, size_t edge, size_t offset)
{
    size_t count = polygon->count;
    // Vertex edge + offset - 1; an open polygon has angle 0 at its ends and none beyond.
    if (polygon->closed)
        return profile.angles[(edge + offset + count - 1) % count];
    return edge + offset == 0 || edge + offset > count ? 0 : profile.angles[edge + offset - 1];
}

/// Eq. (9) before the limit, with its sign as printed.
static double tension_angle(const geometry_polygon *polygon, geometry_profile profile, double tension, size_t edge)
{
    double outer = angle_at(polygon, profile, edge, 0) + angle_at(polygon, profile, edge, 3);
    double inner = angle_at(polygon, profile, edge, 1) + angle_at(polygon, profile, edge, 2);
    return 0.125 * (tension * outer + (1 - tension) * inner);
}

void geometry_tension_angles(const geometry_polygon *polygon, geometry_profile profile, double tension,
                             bat_curve_angle_sign sign, double *insertion_angles)
{
    size_t edges = geometry_edges(polygon);
    for (size_t j = 0; j < edges; j++)
    {
        double angle = tension_angle(polygon, profile, tension, j);
        angle = fmin(fmax(angle, -BAT_CURVE_ANGLE_LIMIT), BAT_CURVE_ANGLE_LIMIT);
        insertion_angles[j] = sign == BAT_CURVE_ANGLE_SIGN_OUTWARD ? -angle : angle;
    }
}

void geometry_tension_angles_back(const geometry_polygon *polygon, geometry_profile profile, double tension,
                                  bat_curve_angle_sign sign, const double *insertion_gradients, geometry_profile gradient)
{
    size_t count = polygon->count, edges = geometry_edges(polygon);
    for (size_t j = 0; j < edges; j++)
    {
        if (fabs(tension_angle(polygon, profile, tension, j)) > BAT_CURVE_ANGLE_LIMIT)
            continue;
        double share = (sign == BAT_CURVE_ANGLE_SIGN_OUTWARD ? -0.125 : 0.125) * insertion_gradients[j];
        for (size_t offset = 0; offset < 4; offset++)
        {
            bool inner = offset == 1 || offset == 2;
            if (!polygon->closed && (j + offset == 0 || j + offset > count))
                continue;
            gradient.angles[(j + offset + count - 1) % count] += share * (inner ? 1 - tension : tension);
        }
    }
}
