#ifndef MESH_DECIMATE_QUADRIC_H
#define MESH_DECIMATE_QUADRIC_H

#include <stdbool.h>

/// @file
/// Sums of squared distances from planes (Garland and Heckbert, "Surface simplification using quadric error metrics", 1997),
/// about a centre: the error of the point centre + d is d^T A d + 2 b^T d + c. A centre at the vertex avoids cancellation on
/// meshes far from the origin.

typedef struct quadric
{
    double xx, xy, xz, yy, yz, zz; ///< A
    double x, y, z;                ///< b
    double constant;               ///< c
} quadric;

/// Add the plane through the centre with the unit normal `normal`.
static inline void quadric_add_plane(quadric *sum, const double *normal, double weight)
{
    sum->xx += weight * normal[0] * normal[0];
    sum->xy += weight * normal[0] * normal[1];
    sum->xz += weight * normal[0] * normal[2];
    sum->yy += weight * normal[1] * normal[1];
    sum->yz += weight * normal[1] * normal[2];
    sum->zz += weight * normal[2] * normal[2];
}

static inline double quadric_error(const quadric *q, const double *d)
{
    double x = q->xx * d[0] + q->xy * d[1] + q->xz * d[2] + 2 * q->x;
    double y = q->xy * d[0] + q->yy * d[1] + q->yz * d[2] + 2 * q->y;
    double z = q->xz * d[0] + q->yz * d[1] + q->zz * d[2] + 2 * q->z;
    return q->constant + d[0] * x + d[1] * y + d[2] * z;
}

/// The same sum about the centre + d.
static inline quadric quadric_moved(const quadric *q, const double *d)
{
    quadric moved = *q;
    moved.x += q->xx * d[0] + q->xy * d[1] + q->xz * d[2];
    moved.y += q->xy * d[0] + q->yy * d[1] + q->yz * d[2];
    moved.z += q->xz * d[0] + q->yz * d[1] + q->zz * d[2];
    moved.constant = quadric_error(q, d);
    return moved;
}

/// The sum of two quadrics about the same centre.
static inline quadric quadric_sum(const quadric *p, const quadric *q)
{
    return (quadric){p->xx + q->xx, p->xy + q->xy, p->xz + q->xz, p->yy + q->yy, p->yz + q->yz,
                     p->zz + q->zz, p->x + q->x,   p->y + q->y,   p->z + q->z,   p->constant + q->constant};
}

/// The total weight of the planes.
static inline double quadric_weight(const quadric *q)
{
    return q->xx + q->yy + q->zz;
}

/// Minimize the error: solve (A + damping I) d = -b by Cholesky factorization. Damping keeps d short in directions that no
/// plane determines. False when the matrix is not positive definite.
static inline bool quadric_minimize(const quadric *q, double damping, double *d)
{
    double xx = q->xx + damping;
    if (!(xx > 0))
        return false;
    double yx = q->xy / xx, zx = q->xz / xx;
    double yy = q->yy + damping - yx * q->xy;
    if (!(yy > 0))
        return false;
    double below = q->yz - zx * q->xy, zy = below / yy;
    double zz = q->zz + damping - zx * q->xz - zy * below;
    if (!(zz > 0))
        return false;
    double y = -q->y + yx * q->x;
    d[2] = (-q->z + zx * q->x - zy * y) / zz;
    d[1] = y / yy - zy * d[2];
    d[0] = -q->x / xx - yx * d[1] - zx * d[2];
    return true;
}

#endif
