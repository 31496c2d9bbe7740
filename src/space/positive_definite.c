#include "linalg/symmetric.h"
#include "space/builtin.h"

enum
{
    SIDE = BAT_POSITIVE_DEFINITE_MAX_SIDE,
    AREA = SIDE * SIDE
};

// Symmetric matrices by their upper triangle, and the metric by a Cholesky factor. Whole ones are n x n, row-major.

/// Functions that are worth having once for each constant n.
#define FOR_EVERY_SIDE static inline __attribute__((always_inline))

/// The whole matrix of an upper triangle stored row by row, its entries off the diagonal times `scale`.
FOR_EVERY_SIDE void triangle_unpack(size_t n, const double *packed, double scale, double *a)
{
    for (size_t i = 0; i < n; i++)
    {
        a[i * n + i] = *packed++;
        for (size_t j = i + 1; j < n; j++)
            a[i * n + j] = a[j * n + i] = scale * *packed++;
    }
}

FOR_EVERY_SIDE void triangle_pack(size_t n, const double *a, double scale, double *packed)
{
    for (size_t i = 0; i < n; i++)
    {
        *packed++ = a[i * n + i];
        for (size_t j = i + 1; j < n; j++)
            *packed++ = scale * a[i * n + j];
    }
}

/// Whether a symmetric matrix is positive definite: no pivot is zero or below to rounding, none is infinite. Overwrites it.
FOR_EVERY_SIDE bool triangle_is_positive(size_t n, double *a)
{
    double diagonal[SIDE];
    for (size_t j = 0; j < n; j++)
        diagonal[j] = a[j * n + j];
    for (size_t j = 0; j < n; j++)
    {
        double pivot = a[j * n + j];
        if (!(pivot > (double)n * DBL_EPSILON * diagonal[j]) || pivot > DBL_MAX)
            return false;
        double inverse = 1 / pivot;
        for (size_t i = j + 1; i < n; i++)
        {
            double share = a[j * n + i] * inverse;
            for (size_t k = i; k < n; k++)
                a[i * n + k] -= share * a[j * n + k];
        }
    }
    return true;
}

/// a = l l^T with l lower triangular; its upper part is set to zero, and `inverse` receives 1 / l_ii.
/// False where a pivot is zero or below to rounding.
FOR_EVERY_SIDE bool triangle_cholesky(size_t n, const double *a, double *l, double *inverse)
{
    for (size_t j = 0; j < n; j++)
    {
        double pivot = a[j * n + j];
        for (size_t k = 0; k < j; k++)
            pivot -= l[j * n + k] * l[j * n + k];
        if (!(pivot > (double)n * DBL_EPSILON * a[j * n + j]) || pivot > DBL_MAX)
            return false;
        l[j * n + j] = sqrt(pivot);
        inverse[j] = 1 / l[j * n + j];
        for (size_t i = j + 1; i < n; i++)
        {
            double sum = a[i * n + j];
            for (size_t k = 0; k < j; k++)
                sum -= l[i * n + k] * l[j * n + k];
            l[i * n + j] = sum * inverse[j];
            l[j * n + i] = 0;
        }
    }
    return true;
}

/// l^-1 b, in place.
FOR_EVERY_SIDE void triangle_solve(size_t n, const double *l, const double *inverse, double *b)
{
    for (size_t i = 0; i < n; i++)
    {
        for (size_t k = 0; k < i; k++)
            for (size_t j = 0; j < n; j++)
                b[i * n + j] -= l[i * n + k] * b[k * n + j];
        for (size_t j = 0; j < n; j++)
            b[i * n + j] *= inverse[i];
    }
}

/// l^-1 s l^-T of a symmetric matrix, in place and exactly symmetric.
FOR_EVERY_SIDE void triangle_whiten(size_t n, const double *l, const double *inverse, double *s)
{
    triangle_solve(n, l, inverse, s);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++)
        {
            double sum = s[i * n + j];
            for (size_t k = 0; k < j; k++)
                sum -= s[i * n + k] * l[j * n + k];
            s[i * n + j] = sum * inverse[j];
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = i + 1; j < n; j++)
            s[i * n + j] = s[j * n + i];
}

/// base + sum over k of values_k r_k r_k^T for the rows r_k of `rows`: the upper triangle packed, what is added off the
/// diagonal times `scale`. `base` is packed; null stands for zero.
FOR_EVERY_SIDE void triangle_compose(size_t n, const double *rows, const double *values, const double *base, double scale,
                                     double *packed)
{
    for (size_t i = 0, at = 0; i < n; i++)
        for (size_t j = i; j < n; j++, at++)
        {
            double sum = 0;
            for (size_t k = 0; k < n; k++)
                sum += values[k] * rows[k * n + i] * rows[k * n + j];
            packed[at] = (base == NULL ? 0 : base[at]) + (i == j ? 1 : scale) * sum;
        }
}

/// Row k of `images` is l times row k of `rows`.
FOR_EVERY_SIDE void triangle_apply(size_t n, const double *l, const double *rows, double *images)
{
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < n; i++)
        {
            double sum = 0;
            for (size_t j = 0; j <= i; j++)
                sum += l[i * n + j] * rows[k * n + j];
            images[k * n + i] = sum;
        }
}

/// base + l s l^T for a symmetric s, the upper triangles packed; a null base stands for zero.
FOR_EVERY_SIDE void triangle_congruence(size_t n, const double *l, const double *s, const double *base, double *packed)
{
    double half[AREA];
    triangle_apply(n, l, s, half); // (l s)^T
    for (size_t i = 0, at = 0; i < n; i++)
        for (size_t j = i; j < n; j++, at++)
        {
            double sum = 0;
            for (size_t k = 0; k <= i; k++)
                sum += l[i * n + k] * half[k * n + j];
            packed[at] = (base == NULL ? 0 : base[at]) + sum;
        }
}

// Power series of 3 x 3 matrices with small eigenvalues, and the polar factor, without eigenvectors; 9 numbers by rows.

/// The largest Frobenius norm of a matrix that small_tensor_expm1() and small_tensor_log1p() take.
#define SMALL_TENSOR_NORM 0.5

/// Newton's iteration ends after ten steps or so, however far it starts.
static const int SMALL_TENSOR_MAX_STEPS = 40;

/// Up to this norm shorter series do.
static const double TINY_TENSOR_NORM = 0.125;

/// The square of a symmetric matrix.
static inline void small_tensor_square(const double *s, double *square)
{
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            square[3 * i + j] = square[3 * j + i] =
                s[3 * i] * s[3 * j] + s[3 * i + 1] * s[3 * j + 1] + s[3 * i + 2] * s[3 * j + 2];
}

/// Row i, column j: the cofactor, so that s (cofactors)^T = det(s) I.
static inline void small_tensor_cofactors(const double *s, double *c)
{
    c[0] = s[4] * s[8] - s[5] * s[7];
    c[1] = s[5] * s[6] - s[3] * s[8];
    c[2] = s[3] * s[7] - s[4] * s[6];
    c[3] = s[2] * s[7] - s[1] * s[8];
    c[4] = s[0] * s[8] - s[2] * s[6];
    c[5] = s[1] * s[6] - s[0] * s[7];
    c[6] = s[1] * s[5] - s[2] * s[4];
    c[7] = s[2] * s[3] - s[0] * s[5];
    c[8] = s[0] * s[4] - s[1] * s[3];
}

/// The sum over k < count of coefficients_k s^k, for a symmetric s, by Horner's rule in the three numbers a, b, c of a I + b
/// s + c s^2: the product with s is reduced by s^3 = trace s^2 - (sum of principal minors) s + determinant (Cayley and
/// Hamilton).
static inline void small_tensor_series(const double *s, const double *coefficients, size_t count, double *sum)
{
    double square[9];
    small_tensor_square(s, square);
    double minor = s[4] * s[8] - s[5] * s[5];
    double trace = s[0] + s[4] + s[8];
    double minors = minor + (s[0] * s[8] - s[2] * s[2]) + (s[0] * s[4] - s[1] * s[1]);
    double determinant = s[0] * minor - s[1] * (s[1] * s[8] - s[5] * s[2]) + s[2] * (s[1] * s[5] - s[4] * s[2]);
    double a = 0, b = 0, c = 0;
    for (size_t k = count; k-- > 0;)
    {
        double next = a - minors * c;
        a = coefficients[k] + determinant * c;
        c = b + trace * c;
        b = next;
    }
    for (int i = 0; i < 9; i++)
        sum[i] = b * s[i] + c * square[i] + (i % 4 == 0 ? a : 0);
}

/// e^s - I.
static inline void small_tensor_expm1(const double *s, double norm, double *result)
{
    static const double COEFFICIENTS[] = {0,
                                          1,
                                          1.0 / 2,
                                          1.0 / 6,
                                          1.0 / 24,
                                          1.0 / 120,
                                          1.0 / 720,
                                          1.0 / 5040,
                                          1.0 / 40320,
                                          1.0 / 362880,
                                          1.0 / 3628800,
                                          1.0 / 39916800,
                                          1.0 / 479001600,
                                          1.0 / 6227020800,
                                          1.0 / 87178291200};
    small_tensor_series(s, COEFFICIENTS, norm <= TINY_TENSOR_NORM ? 12 : 15, result);
}

/// log(I + s) = 2 artanh(z), z = s (2 I + s)^-1.
static inline void small_tensor_log1p(const double *s, double norm, double *result)
{
    static const double COEFFICIENTS[] = {2.0,      2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,  2.0 / 11,
                                          2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21, 2.0 / 23,
                                          2.0 / 25, 2.0 / 27, 2.0 / 29, 2.0 / 31, 2.0 / 33};
    double shifted[9], inverse[9], z[9], square[9], ratio[9];
    for (int i = 0; i < 9; i++)
        shifted[i] = s[i] + (i % 4 == 0 ? 2 : 0);
    small_tensor_cofactors(shifted, inverse);
    double scale = 1 / (shifted[0] * inverse[0] + shifted[1] * inverse[1] + shifted[2] * inverse[2]);
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            z[3 * i + j] = z[3 * j + i] =
                scale * (s[3 * i] * inverse[j] + s[3 * i + 1] * inverse[3 + j] + s[3 * i + 2] * inverse[6 + j]);
    small_tensor_square(z, square);
    small_tensor_series(square, COEFFICIENTS, norm <= TINY_TENSOR_NORM ? 7 : 17, ratio);
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            result[3 * i + j] = result[3 * j + i] =
                z[3 * i] * ratio[j] + z[3 * i + 1] * ratio[3 + j] + z[3 * i + 2] * ratio[6 + j];
}

/// The orthogonal factor u of k = p u, p positive definite, for a k of positive determinant: Newton's iteration x -> (x +
/// x^-T) / 2, scaled while x is far from orthogonal (Higham 1986). It squares the distance, so what a step of 1e-9 leads to
/// is exact.
static inline void small_tensor_polar(const double *k, double *u)
{
    double change = 1;
    for (int i = 0; i < 9; i++)
        u[i] = k[i];
    for (int step = 0; step < SMALL_TENSOR_MAX_STEPS && change > 1e-9; step++)
    {
        double inverse[9], own = 0, other = 0, scale = 1; // x^-T; squared norms of x and x^-T, both 3 when orthogonal
        small_tensor_cofactors(u, inverse);
        double reciprocal = 1 / (u[0] * inverse[0] + u[1] * inverse[1] + u[2] * inverse[2]);
        for (int i = 0; i < 9; i++)
        {
            inverse[i] *= reciprocal;
            own += u[i] * u[i];
            other += inverse[i] * inverse[i];
        }
        if (own + other > 8)
            scale = sqrt(sqrt(other / own));
        change = 0;
        for (int i = 0; i < 9; i++)
        {
            double next = 0.5 * (scale * u[i] + inverse[i] / scale);
            change = fmax(change, fabs(next - u[i]));
            u[i] = next;
        }
    }
}

// At A = L L^T a tangent vector V is stored as S = L^-1 V L^-T, and another point B is seen as M = L^-1 B L^-T:
//   exp_A(S) = L e^S L^T,   log_A(B) = log M,   d(A, B) = |log M|.
// Points near to A are seen as N = L^-1 (B - A) L^-T = M - I, in which nothing cancels.

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
    return sqrt(vector_square(n * n, a));
}

/// N = L^-1 (q - p) L^-T
FOR_EVERY_SIDE void whiten_difference(size_t n, const factor *f, const double *p, const double *q, double *whitened)
{
    double difference[SIDE * (SIDE + 1) / 2];
    vector_subtract(n * (n + 1) / 2, q, p, difference);
    triangle_unpack(n, difference, 1, whitened);
    triangle_whiten(n, f->l, f->inverse, whitened);
}

/// log M. For small tensors near to each other it is `m` itself, and `whole` is true; else it comes by eigenvectors, from N
/// where that is near, else from q. Its norm is all that `vectors` null leaves.
FOR_EVERY_SIDE bat_status find_logarithm(size_t n, const double *p, const double *q, factor *f, bool *whole, double *m,
                                         double *vectors, double *logarithms)
{
    if (!factorize(n, p, f))
        return BAT_INVALID_POINT;
    whiten_difference(n, f, p, q, m);
    double norm = norm_of(n, m);
    bool near = norm <= NEAR;
    *whole = n == 3 && near;
    if (*whole)
    {
        small_tensor_log1p(m, norm, m);
        return BAT_OK;
    }
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
    bool whole;
    double m[AREA], logarithms[SIDE];
    bat_status status = find_logarithm(n, p, q, &f, &whole, m, NULL, logarithms);
    if (status == BAT_OK)
        *distance = whole ? norm_of(n, m) : sqrt(vector_square(n, logarithms));
    return status;
}

FOR_EVERY_SIDE bat_status log_of(size_t n, const double *p, const double *q, double *tangent)
{
    factor f;
    bool whole;
    double m[AREA], vectors[AREA], logarithms[SIDE];
    bat_status status = find_logarithm(n, p, q, &f, &whole, m, vectors, logarithms);
    if (status == BAT_OK && whole)
        triangle_pack(n, m, SQRT2, tangent);
    else if (status == BAT_OK)
        triangle_compose(n, vectors, logarithms, NULL, SQRT2, tangent);
    return status;
}

/// L V e^values V^T L^T, V's columns being the rows of `vectors`.
FOR_EVERY_SIDE bat_status exp_of_eigenvalues(size_t n, const double *p, const factor *f, const double *vectors,
                                             double *values, double *q)
{
    double images[AREA];
    bool near = vector_largest(n, values) <= NEAR;
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
    bool whole;
    double m[AREA], vectors[AREA], values[SIDE];
    bat_status status = find_logarithm(n, p, q, &f, &whole, m, vectors, values);
    if (status != BAT_OK)
        return status;
    if (whole)
    {
        vector_scale(n * n, t, m);
        return exp_of_matrix(n, p, &f, m, point);
    }
    vector_scale(n, t, values);
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

/// A function of a side for `space`. The sides that users have most are compiled for themselves.
#define BY_SIDE(function, ...)                                                                                              \
    (space->point_dim == 6   ? function(3, __VA_ARGS__)                                                                     \
     : space->point_dim == 3 ? function(2, __VA_ARGS__)                                                                     \
                             : function(side_of(space), __VA_ARGS__))

static double distance(const bat_space *space, const double *p, const double *q)
{
    double d = NAN;
    (void)BY_SIDE(distance_of, p, q, &d);
    return d;
}

static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    return BY_SIDE(log_of, p, q, tangent);
}

static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    return BY_SIDE(exp_of, p, tangent, q);
}

static bat_status geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    return BY_SIDE(geodesic_of, p, q, t, point);
}

static bat_status transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    return BY_SIDE(transport_of, p, q, tangent, transported);
}

static const char *fault(const bat_space *space, const double *point)
{
    if (space_not_finite(space, point) != NULL)
        return space_not_finite(space, point);
    return is_positive(side_of(space), point) ? NULL : "not positive definite";
}

bool space_is_positive_definite(const bat_space *space)
{
    return space->log == logarithm;
}

void positive_definite_identity(const bat_space *space, double *point)
{
    size_t n = side_of(space);
    for (size_t i = 0; i < n; i++)
        for (size_t j = i; j < n; j++)
            *point++ = i == j ? 1 : 0;
}

static void random_point(const bat_space *space, bat_random *random, double *point)
{
    double identity[SIDE * (SIDE + 1) / 2], tangent[SIDE * (SIDE + 1) / 2];
    size_t n = side_of(space);
    positive_definite_identity(space, identity);
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
        .project = space_project_valid,
        SPACE_FUNCTIONS,
        .inner = space_inner,
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

// The derivative of the matrix exponential, between tensors and their logarithms.

/// Q^T A Q, in place.
static void turn(size_t n, const double *q, double *a)
{
    double once[AREA];
    multiply(n, q, true, a, once);
    multiply(n, once, false, q, a);
}

/// The derivative of the matrix exponential at a symmetric matrix, of a symmetric matrix, or its inverse: in the basis of
/// eigenvectors divided differences of exp (Higham, Functions of matrices, 2008, theorem 3.11). Overwrites `at`.
static void differentiate_exp(size_t n, double *at, bool inverse, double *vector)
{
    double rows[AREA], columns[AREA];
    symmetric_eigen(n, at, rows, SYMMETRIC_BY_NORM);
    for (size_t i = 0; i < n * n; i++)
        columns[i] = rows[i % n * n + i / n];
    turn(n, columns, vector);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
        {
            double x = at[i * n + i], y = at[j * n + j], half = (x - y) / 2;
            double quotient = exp((x + y) / 2) * (fabs(half) > 1e-6 ? sinh(half) / half : 1);
            vector[i * n + j] *= inverse ? 1 / quotient : quotient;
        }
    turn(n, rows, vector);
}

bat_status positive_definite_convert(const bat_space *space, const double *log, const double *point, const double *vector,
                                     bool to_log, double *result)
{
    double at[AREA], a[AREA], velocity[BAT_SPACE_MAX_DIM];
    size_t n = side_of(space);
    bat_status status = to_log ? bat_positive_definite_velocity(space, point, vector, velocity) : BAT_OK;
    if (status != BAT_OK)
        return status;
    triangle_unpack(n, log, SQRT_HALF, at);
    triangle_unpack(n, to_log ? velocity : vector, to_log ? 1 : SQRT_HALF, a);
    differentiate_exp(n, at, to_log, a);
    triangle_pack(n, a, to_log ? SQRT2 : 1, to_log ? result : velocity);
    return to_log ? BAT_OK : bat_positive_definite_tangent(space, point, velocity, result);
}
