#include "curve/topology/edge_tree.h"

#include <math.h>

/// Half the distance from 1 to the next double: the largest relative error of a rounded operation.
#define ROUNDOFF 0x1p-53
/// More than what underflow can add to a determinant.
#define UNDERFLOW_SLACK 1e-300

/// The most terms added to a sum: 6 products of two coordinates and a weight of 5 terms in the disk, with 18 terms each.
#define MAX_TERMS (6 * 18 + 1)

/// A sum without rounding: terms that do not overlap, the smallest first. The last one has the sign of the sum.
typedef struct expansion
{
    size_t count;
    double terms[MAX_TERMS];
} expansion;

/// a + b = sum + error, exactly (Knuth).
static inline double two_sum(double a, double b, double *error)
{
    double sum = a + b, b_part = sum - a, a_part = sum - b_part;
    *error = (a - a_part) + (b - b_part);
    return sum;
}

/// a * b = product + error, exactly, without underflow.
static inline double two_product(double a, double b, double *error)
{
    double product = a * b;
    *error = fma(a, b, -product);
    return product;
}

/// Grow-Expansion with elimination of zeros (Shewchuk, theorem 10).
static void add_term(expansion *sum, double term)
{
    size_t kept = 0;
    for (size_t i = 0; i < sum->count; i++)
    {
        double error;
        term = two_sum(term, sum->terms[i], &error);
        if (error != 0)
            sum->terms[kept++] = error;
    }
    if (term != 0)
        sum->terms[kept++] = term;
    sum->count = kept;
}

static void add_product(expansion *sum, double a, double b, double c)
{
    double low, high = two_product(a, b, &low), error;
    double high_product = two_product(high, c, &error);
    add_term(sum, error);
    add_term(sum, high_product);
    if (low == 0)
        return;
    double low_product = two_product(low, c, &error);
    add_term(sum, error);
    add_term(sum, low_product);
}

/// Add a * b * (1 + x^2 + y^2): `p` is (x, y).
static void add_weighted(expansion *sum, double a, double b, const double *p)
{
    add_product(sum, a, b, 1);
    for (int k = 0; k < 2; k++)
    {
        double low, high = two_product(p[k], p[k], &low);
        add_product(sum, a, b, high);
        if (low != 0)
            add_product(sum, a, b, low);
    }
}

static int sign_of(double value)
{
    return (value > 0) - (value < 0);
}

static int expansion_sign(const expansion *sum)
{
    return sum->count == 0 ? 0 : sign_of(sum->terms[sum->count - 1]);
}

/// The sign of a b - c d. Rounding is monotone, so products that round to different numbers compare as they do.
static int minor_sign(double a, double b, double c, double d)
{
    double low[2], first = two_product(a, b, &low[0]), second = two_product(c, d, &low[1]);
    return first != second ? sign_of(first - second) : sign_of(low[0] - low[1]);
}

/// The six terms of a determinant: rows, and the sign of the permutation.
static const struct
{
    int x, y, z;
    double sign;
} PERMUTATIONS[] = {{0, 1, 2, 1}, {1, 2, 0, 1}, {2, 0, 1, 1}, {1, 0, 2, -1}, {0, 2, 1, -1}, {2, 1, 0, -1}};

static int exact_orientation(surface_kind kind, const double *const rows[3])
{
    expansion sum = {.count = 0};
    for (size_t k = 0; k < sizeof PERMUTATIONS / sizeof *PERMUTATIONS; k++)
    {
        double x = PERMUTATIONS[k].sign * rows[PERMUTATIONS[k].x][0], y = rows[PERMUTATIONS[k].y][1];
        const double *last = rows[PERMUTATIONS[k].z];
        if (kind == SURFACE_DISK)
            add_weighted(&sum, x, y, last);
        else
            add_product(&sum, x, y, kind == SURFACE_SPHERE ? last[2] : 1);
    }
    return expansion_sign(&sum);
}

/// Shewchuk's orient2d filter: the error is at most (3 + 16 e) e times the sum of both products' absolute values.
static int orientation_plane(const double *a, const double *b, const double *c)
{
    double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]);
    double value = left - right;
    if (fabs(value) > (3 + 16 * ROUNDOFF) * ROUNDOFF * (fabs(left) + fabs(right)) + UNDERFLOW_SLACK)
        return sign_of(value);
    return exact_orientation(SURFACE_PLANE, (const double *const[3]){a, b, c});
}

/// det[a, u, v] of vectors, with the sum of its products' absolute values.
static double determinant(const double *a, const double *u, const double *v, double *bound)
{
    double yz = u[1] * v[2], zy = u[2] * v[1], zx = u[2] * v[0], xz = u[0] * v[2], xy = u[0] * v[1], yx = u[1] * v[0];
    *bound = fabs(a[0]) * (fabs(yz) + fabs(zy)) + fabs(a[1]) * (fabs(zx) + fabs(xz)) + fabs(a[2]) * (fabs(xy) + fabs(yx));
    return a[0] * (yz - zy) + a[1] * (zx - xz) + a[2] * (xy - yx);
}

/// det[a, b, c] = det[a, b - a, c - a]. Each difference is rounded once, each of the 6 products goes through 2
/// multiplications and 3 additions: the error is at most 8 e times the sum of absolute values.
static int orientation_sphere(const double *a, const double *b, const double *c)
{
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]}, bound;
    double value = determinant(a, u, v, &bound);
    if (fabs(value) > 10 * ROUNDOFF * bound + UNDERFLOW_SLACK)
        return sign_of(value);
    return exact_orientation(SURFACE_SPHERE, (const double *const[3]){a, b, c});
}

/// The same with weights 1 + x^2 + y^2. The weight of b - a is (bx - ax)(bx + ax) + (by - ay)(by + ay), with an error of 4 e
/// relative to its two products; `bounds` has their absolute values in place of the weight.
static int orientation_disk(const double *a, const double *b, const double *c)
{
    double u[3] = {b[0] - a[0], b[1] - a[1], 0}, v[3] = {c[0] - a[0], c[1] - a[1], 0};
    double u_weights[2] = {u[0] * (b[0] + a[0]), u[1] * (b[1] + a[1])};
    double v_weights[2] = {v[0] * (c[0] + a[0]), v[1] * (c[1] + a[1])};
    double base[3] = {a[0], a[1], 1 + a[0] * a[0] + a[1] * a[1]}, bound;
    u[2] = fabs(u_weights[0]) + fabs(u_weights[1]);
    v[2] = fabs(v_weights[0]) + fabs(v_weights[1]);
    (void)determinant(base, u, v, &bound);
    u[2] = u_weights[0] + u_weights[1];
    v[2] = v_weights[0] + v_weights[1];
    double ignored, value = determinant(base, u, v, &ignored);
    if (fabs(value) > 16 * ROUNDOFF * bound + UNDERFLOW_SLACK)
        return sign_of(value);
    return exact_orientation(SURFACE_DISK, (const double *const[3]){a, b, c});
}

int predicate_orientation(surface_kind kind, const double *a, const double *b, const double *c)
{
    return kind == SURFACE_SPHERE ? orientation_sphere(a, b, c)
           : kind == SURFACE_DISK ? orientation_disk(a, b, c)
                                  : orientation_plane(a, b, c);
}

/// The sign of a_k w(b) - b_k w(a), w = 1 + x^2 + y^2: how Klein's coordinate k changes from b to a.
static int weighted_minor_sign(const double *a, const double *b, int k)
{
    expansion sum = {.count = 0};
    add_weighted(&sum, a[k], 1, b);
    add_weighted(&sum, -b[k], 1, a);
    return expansion_sign(&sum);
}

/// The signs of the minors of two vectors, those of their cross product.
static void cross_signs(surface_kind kind, const double *a, const double *b, int signs[3])
{
    signs[2] = minor_sign(a[0], b[1], a[1], b[0]);
    if (kind == SURFACE_DISK)
    {
        signs[0] = weighted_minor_sign(a, b, 1);
        signs[1] = weighted_minor_sign(b, a, 0);
        return;
    }
    signs[0] = minor_sign(a[1], b[2], a[2], b[1]);
    signs[1] = minor_sign(a[2], b[0], a[0], b[2]);
}

static bool is_between(double value, double end, double other)
{
    return end <= other ? end <= value && value <= other : other <= value && value <= end;
}

/// c = s a + t b with s, t >= 0: c x b and a x c have the direction of a x b, or are 0.
static bool predicate_on_edge(surface_kind kind, const double *a, const double *b, const double *c)
{
    if (kind == SURFACE_PLANE)
        return is_between(c[0], a[0], b[0]) && is_between(c[1], a[1], b[1]);
    int whole[3], first[3], second[3];
    cross_signs(kind, a, b, whole);
    cross_signs(kind, a, c, first);
    cross_signs(kind, c, b, second);
    for (int k = 0; k < 3; k++)
        if (whole[k] != 0)
            return first[k] * whole[k] >= 0 && second[k] * whole[k] >= 0;
    return false;
}

/// Two great circles meet in two antipodal points. The edges cross in the same one when all four triangles agree.
bool predicate_edges_meet(surface_kind kind, const double *a, const double *b, const double *c, const double *d)
{
    int abc = predicate_orientation(kind, a, b, c), abd = predicate_orientation(kind, a, b, d);
    if (abc == abd && abc != 0)
        return false;
    int cda = predicate_orientation(kind, c, d, a), cdb = predicate_orientation(kind, c, d, b);
    if (cda == cdb && cda != 0)
        return false;
    if (abc != 0 && abd != 0 && cda != 0 && cdb != 0)
        return abc == cdb;
    return (abc == 0 && predicate_on_edge(kind, a, b, c)) || (abd == 0 && predicate_on_edge(kind, a, b, d)) ||
           (cda == 0 && predicate_on_edge(kind, c, d, a)) || (cdb == 0 && predicate_on_edge(kind, c, d, b));
}

bool predicate_folds_back(surface_kind kind, const double *a, const double *b, const double *c)
{
    return predicate_orientation(kind, a, b, c) == 0 &&
           (predicate_on_edge(kind, a, b, c) || predicate_on_edge(kind, b, c, a));
}
