#include "batten/space.h"

#include "linalg/symmetric.h"
#include "space/small_tensor.h"
#include "space/triangular.h"

#include <float.h>
#include <math.h>
#include <string.h>

// At A = L L^T a tangent vector V is stored as S = L^-1 V L^-T, and another point B is seen as M = L^-1 B L^-T:
//   exp_A(S) = L e^S L^T,   log_A(B) = log M,   d(A, B) = |log M|.
// Points near to A are seen as N = L^-1 (B - A) L^-T = M - I, in which nothing cancels.

enum
{
    SIDE = BAT_POSITIVE_DEFINITE_MAX_SIDE,
    AREA = SIDE * SIDE
};

static const double SQRT2 = 1.4142135623730950488;
static const double SQRT_HALF = 0.70710678118654752440;
/// Steps whose norm or eigenvalues are at most this go by differences from the identity.
static const double NEAR = SMALL_TENSOR_NORM;
/// Eigenvalues of M above this are farther than the method's squares reach; their logarithm is about 300.
static const double FARTHEST = 1e130;

typedef struct factor
{
    double l[AREA];
    double inverse[SIDE];
} factor;

FOR_EVERY_SIDE bool factorize(size_t n, const double *point, factor *f)
{
    double a[AREA];
    triangle_unpack(n, point, 1, a);
    return triangle_cholesky(n, a, f->l, f->inverse);
}

FOR_EVERY_SIDE bool is_positive(size_t n, const double *point)
{
    double a[AREA];
    triangle_unpack(n, point, 1, a);
    return triangle_is_positive(n, a);
}

FOR_EVERY_SIDE double norm_of(size_t n, const double *a)
{
    double sum = 0;
    for (size_t i = 0; i < n * n; i++)
        sum += a[i] * a[i];
    return sqrt(sum);
}

/// N = L^-1 (q - p) L^-T
FOR_EVERY_SIDE void whiten_difference(size_t n, const factor *f, const double *p, const double *q, double *whitened)
{
    double difference[SIDE * (SIDE + 1) / 2];
    for (size_t i = 0; i < n * (n + 1) / 2; i++)
        difference[i] = q[i] - p[i];
    triangle_unpack(n, difference, 1, whitened);
    triangle_whiten(n, f->l, f->inverse, whitened);
}

/// log M by eigenvectors, from N of norm `norm` where that is near, else from q. Its norm is all that `vectors` null leaves.
FOR_EVERY_SIDE bat_status eigen_logarithm(size_t n, const factor *f, const double *q, double norm, double *m,
                                          double *vectors, double *logarithms)
{
    bool near = norm <= NEAR;
    if (!near)
    {
        triangle_unpack(n, q, 1, m);
        triangle_whiten(n, f->l, f->inverse, m);
        if (!(norm_of(n, m) <= FARTHEST))
            return BAT_INVALID_POINT;
    }
    symmetric_eigen(n, m, vectors, near ? SYMMETRIC_BY_NORM : SYMMETRIC_BY_DIAGONAL);
    for (size_t i = 0; i < n; i++)
    {
        double value = m[i * n + i];
        if (!near && !(value > 1 / FARTHEST))
            return BAT_INVALID_POINT;
        logarithms[i] = near ? log1p(value) : log(value);
    }
    return BAT_OK;
}

FOR_EVERY_SIDE bat_status distance_of(size_t n, const double *p, const double *q, double *distance)
{
    factor f;
    double m[AREA], logarithms[SIDE];
    if (!factorize(n, p, &f))
        return BAT_INVALID_POINT;
    whiten_difference(n, &f, p, q, m);
    double norm = norm_of(n, m);
    if (n == 3 && norm <= NEAR)
    {
        small_tensor_log1p(m, norm, m);
        *distance = norm_of(n, m);
        return BAT_OK;
    }
    bat_status status = eigen_logarithm(n, &f, q, norm, m, NULL, logarithms);
    if (status != BAT_OK)
        return status;
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += logarithms[i] * logarithms[i];
    *distance = sqrt(sum);
    return BAT_OK;
}

FOR_EVERY_SIDE bat_status log_of(size_t n, const double *p, const double *q, double *tangent)
{
    factor f;
    double m[AREA], vectors[AREA], logarithms[SIDE];
    if (!factorize(n, p, &f))
        return BAT_INVALID_POINT;
    whiten_difference(n, &f, p, q, m);
    double norm = norm_of(n, m);
    if (n == 3 && norm <= NEAR)
    {
        small_tensor_log1p(m, norm, m);
        triangle_pack(n, m, SQRT2, tangent);
        return BAT_OK;
    }
    bat_status status = eigen_logarithm(n, &f, q, norm, m, vectors, logarithms);
    if (status == BAT_OK)
        triangle_compose(n, vectors, logarithms, NULL, SQRT2, tangent);
    return status;
}

/// L V e^values V^T L^T, V's columns being the rows of `vectors`.
FOR_EVERY_SIDE bat_status exp_of_eigenvalues(size_t n, const double *p, const factor *f, const double *vectors,
                                             double *values, double *q)
{
    double largest = 0, images[AREA];
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, fabs(values[i]));
    bool near = largest <= NEAR;
    for (size_t i = 0; i < n; i++)
        values[i] = near ? expm1(values[i]) : exp(values[i]);
    triangle_apply(n, f->l, vectors, images);
    triangle_compose(n, images, values, near ? p : NULL, 1, q);
    return is_positive(n, q) ? BAT_OK : BAT_INVALID_POINT;
}

/// L e^S L^T; overwrites S.
FOR_EVERY_SIDE bat_status exp_of_matrix(size_t n, const double *p, const factor *f, double *s, double *q)
{
    double norm = norm_of(n, s), power[AREA], vectors[AREA], values[SIDE];
    if (!(norm <= FARTHEST))
        return BAT_INVALID_POINT;
    if (n == 3 && norm <= NEAR)
    {
        small_tensor_expm1(s, norm, power);
        triangle_congruence(n, f->l, power, p, q);
        return is_positive(n, q) ? BAT_OK : BAT_INVALID_POINT;
    }
    symmetric_eigen(n, s, vectors, SYMMETRIC_BY_NORM);
    for (size_t i = 0; i < n; i++)
        values[i] = s[i * n + i];
    return exp_of_eigenvalues(n, p, f, vectors, values, q);
}

FOR_EVERY_SIDE bat_status exp_of(size_t n, const double *p, const double *tangent, double *q)
{
    factor f;
    double s[AREA];
    triangle_unpack(n, tangent, SQRT_HALF, s);
    return factorize(n, p, &f) ? exp_of_matrix(n, p, &f, s, q) : BAT_INVALID_POINT;
}

/// L M^t L^T
FOR_EVERY_SIDE bat_status geodesic_of(size_t n, const double *p, const double *q, double t, double *point)
{
    factor f;
    double m[AREA], vectors[AREA], values[SIDE];
    if (!factorize(n, p, &f))
        return BAT_INVALID_POINT;
    whiten_difference(n, &f, p, q, m);
    double norm = norm_of(n, m);
    if (n == 3 && norm <= NEAR)
    {
        small_tensor_log1p(m, norm, m);
        for (size_t i = 0; i < n * n; i++)
            m[i] *= t;
        return exp_of_matrix(n, p, &f, m, point);
    }
    bat_status status = eigen_logarithm(n, &f, q, norm, m, vectors, values);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < n; i++)
        values[i] *= t;
    return exp_of_eigenvalues(n, p, &f, vectors, values, point);
}

/// product = a b, or a^T b
FOR_EVERY_SIDE void multiply(size_t n, const double *a, bool transposed, const double *b, double *product)
{
    for (size_t i = 0; i < n; i++)
    {
        for (size_t j = 0; j < n; j++)
            product[i * n + j] = 0;
        for (size_t k = 0; k < n; k++)
            for (size_t j = 0; j < n; j++)
                product[i * n + j] += (transposed ? a[k * n + i] : a[i * n + k]) * b[k * n + j];
    }
}

/// X (3 I - X^T X) / 2 squares the distance of X from being orthogonal.
FOR_EVERY_SIDE void orthogonalize(size_t n, const double *x, double *result)
{
    double gram[AREA];
    multiply(n, x, true, x, gram);
    for (size_t i = 0; i < n * n; i++)
        gram[i] = (i % (n + 1) == 0 ? 1.5 : 0) - 0.5 * gram[i];
    multiply(n, x, false, gram, result);
}

/// The orthogonal factor U of K = P U with P = (K K^T)^(1/2), for a lower triangular K.
FOR_EVERY_SIDE void polar_factor(size_t n, const double *k, double *u)
{
    if (n == 2)
    {
        double cosine = k[0] + k[3], inverse = 1 / sqrt(cosine * cosine + k[2] * k[2]);
        u[0] = u[3] = cosine * inverse;
        u[2] = k[2] * inverse;
        u[1] = -u[2];
        return;
    }
    if (n == 3)
    {
        small_tensor_polar(k, u);
        return;
    }
    double square[AREA], vectors[AREA], turned[AREA], product[AREA];
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++)
        {
            double sum = 0;
            for (size_t l = 0; l <= j; l++)
                sum += k[i * n + l] * k[j * n + l];
            square[i * n + j] = square[j * n + i] = sum;
        }
    symmetric_eigen(n, square, vectors, SYMMETRIC_BY_DIAGONAL);
    multiply(n, vectors, false, k, turned);
    for (size_t i = 0; i < n; i++)
    {
        double scale = 1 / sqrt(square[i * n + i]);
        for (size_t j = 0; j < n; j++)
            turned[i * n + j] *= scale;
    }
    multiply(n, vectors, true, turned, product);
    orthogonalize(n, product, u);
}

/// With K = L_p^-1 L_q and its polar factor U, the transport E V E^T, E = (B A^-1)^(1/2), takes S to U^T S U.
FOR_EVERY_SIDE bat_status transport_of(size_t n, const double *p, const double *q, const double *tangent,
                                       double *transported)
{
    factor from, to;
    if (!factorize(n, p, &from) || !factorize(n, q, &to))
        return BAT_INVALID_POINT;
    triangle_solve(n, from.l, from.inverse, to.l);
    if (!(norm_of(n, to.l) <= sqrt(FARTHEST)))
        return BAT_INVALID_POINT;
    double u[AREA], s[AREA], product[AREA];
    polar_factor(n, to.l, u);
    triangle_unpack(n, tangent, SQRT_HALF, s);
    multiply(n, s, false, u, product);
    multiply(n, u, true, product, s);
    triangle_pack(n, s, SQRT2, transported);
    return BAT_OK;
}

static size_t side_of(const bat_space *space)
{
    // n (n + 1) / 2 is the number of coordinates.
    return (size_t)(sqrt(2 * (double)space->point_dim));
}

// The sides that users have most are compiled for themselves.

static double distance(const bat_space *space, const double *p, const double *q)
{
    double d = NAN;
    if (space->point_dim == 6)
        (void)distance_of(3, p, q, &d);
    else if (space->point_dim == 3)
        (void)distance_of(2, p, q, &d);
    else
        (void)distance_of(side_of(space), p, q, &d);
    return d;
}

static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    if (space->point_dim == 6)
        return log_of(3, p, q, tangent);
    if (space->point_dim == 3)
        return log_of(2, p, q, tangent);
    return log_of(side_of(space), p, q, tangent);
}

static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    if (space->point_dim == 6)
        return exp_of(3, p, tangent, q);
    if (space->point_dim == 3)
        return exp_of(2, p, tangent, q);
    return exp_of(side_of(space), p, tangent, q);
}

static bat_status geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    if (space->point_dim == 6)
        return geodesic_of(3, p, q, t, point);
    if (space->point_dim == 3)
        return geodesic_of(2, p, q, t, point);
    return geodesic_of(side_of(space), p, q, t, point);
}

static bat_status transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    if (space->point_dim == 6)
        return transport_of(3, p, q, tangent, transported);
    if (space->point_dim == 3)
        return transport_of(2, p, q, tangent, transported);
    return transport_of(side_of(space), p, q, tangent, transported);
}

static const char *fault(const bat_space *space, const double *point)
{
    for (size_t i = 0; i < space->point_dim; i++)
        if (!isfinite(point[i]))
            return "not finite";
    return is_positive(side_of(space), point) ? NULL : "not positive definite";
}

static bat_status project(const bat_space *space, const double *coordinates, double *point)
{
    if (fault(space, coordinates) != NULL)
        return BAT_INVALID_POINT;
    memmove(point, coordinates, space->point_dim * sizeof *point);
    return BAT_OK;
}

static double inner(const bat_space *space, const double *p, const double *u, const double *v)
{
    (void)p;
    double sum = 0;
    for (size_t i = 0; i < space->tangent_dim; i++)
        sum += u[i] * v[i];
    return sum;
}

static void set_identity(size_t n, double *point)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = i; j < n; j++)
            *point++ = i == j ? 1 : 0;
}

static void random_point(const bat_space *space, bat_random *random, double *point)
{
    double identity[SIDE * (SIDE + 1) / 2], tangent[SIDE * (SIDE + 1) / 2];
    size_t n = side_of(space);
    set_identity(n, identity);
    do
    {
        for (size_t i = 0; i < space->tangent_dim; i++)
            tangent[i] = bat_random_normal(random) / sqrt((double)n);
    } while (exponential(space, identity, tangent, point) != BAT_OK);
}

bat_space bat_positive_definite(size_t n)
{
    n = n < 1 ? 1 : n > SIDE ? SIDE : n;
    size_t numbers = n * (n + 1) / 2;
    return (bat_space){
        .name = "spd",
        .dimension = numbers,
        .point_dim = numbers,
        .tangent_dim = numbers,
        .injectivity = INFINITY,
        .fault = fault,
        .project = project,
        .distance = distance,
        .log = logarithm,
        .exp = exponential,
        .transport = transport,
        .inner = inner,
        .random_point = random_point,
        .geodesic = geodesic,
    };
}

bat_status bat_positive_definite_tangent(const bat_space *space, const double *point, const double *velocity,
                                         double *tangent)
{
    factor f;
    double s[AREA];
    size_t n = side_of(space);
    if (!factorize(n, point, &f))
        return BAT_INVALID_POINT;
    triangle_unpack(n, velocity, 1, s);
    triangle_whiten(n, f.l, f.inverse, s);
    triangle_pack(n, s, SQRT2, tangent);
    return BAT_OK;
}

bat_status bat_positive_definite_velocity(const bat_space *space, const double *point, const double *tangent,
                                          double *velocity)
{
    factor f;
    double s[AREA];
    size_t n = side_of(space);
    if (!factorize(n, point, &f))
        return BAT_INVALID_POINT;
    triangle_unpack(n, tangent, SQRT_HALF, s);
    triangle_congruence(n, f.l, s, NULL, velocity);
    return BAT_OK;
}
