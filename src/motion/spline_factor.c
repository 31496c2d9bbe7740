#include "motion/spline_system.h"

#include "base/lanes.h"
#include "space/builtin.h"
#include "space/quaternion.h"

enum
{
    DIM = BAT_SPACE_MAX_DIM,
    /// Terms of the series for arguments up to 1.
    TERMS = 9,
    /// Steps of the inverse of a differential by differences in one call.
    PULL_STEPS = 2
};

/// The step of differences. Formulas of sixth order have an error of its sixth power over 140 and 560, below 1e-11 of the
/// derivatives that they leave out, and rounding of 1e-16 over its square.
static const double STEP = 1.0 / 32;
/// The same of tensors: first differences of exact velocities lose less to rounding.
static const double TENSOR_STEP = 1.0 / 128;
/// First and second derivatives at 0 of a function that is 0 there, from its values at -3, -2, -1, 1, 2 and 3 steps.
static const double PLACES[6] = {-3, -2, -1, 1, 2, 3};
static const double FIRST[6] = {-1.0 / 60, 3.0 / 20, -3.0 / 4, 3.0 / 4, -3.0 / 20, 1.0 / 60};
static const double SECOND[6] = {1.0 / 90, -3.0 / 20, 3.0 / 2, 3.0 / 2, -3.0 / 20, 1.0 / 90};

/// 1 / n!
static const double INVERSE_FACTORIALS[] = {1 / 1.0,
                                            1 / 1.0,
                                            1 / 2.0,
                                            1 / 6.0,
                                            1 / 24.0,
                                            1 / 120.0,
                                            1 / 720.0,
                                            1 / 5040.0,
                                            1 / 40320.0,
                                            1 / 362880.0,
                                            1 / 3628800.0,
                                            1 / 39916800.0,
                                            1 / 479001600.0,
                                            1 / 6227020800.0,
                                            1 / 87178291200.0,
                                            1 / 1307674368000.0,
                                            1 / 20922789888000.0,
                                            1 / 355687428096000.0,
                                            1 / 6402373705728000.0,
                                            1 / 121645100408832000.0,
                                            1 / 2432902008176640000.0,
                                            1 / 51090942171709440000.0};

/// The sum over k of factor_k (-x)^k / (2 k + first)!, factor_k = k + 1 where `differentiated`, else 1; `first` <= 5.
static inline double series(double x, int first, bool differentiated)
{
    double sum = 0;
    for (int k = TERMS - 1; k >= 0; k--)
        sum = (differentiated ? k + 1 : 1) * INVERSE_FACTORIALS[2 * k + first] - x * sum;
    return sum;
}

// Rotations

spline_turning spline_turning_of(double x)
{
    spline_turning t;
    double excess; // 2 (a - 1/2) / x
    if (x < 1)
    {
        t.a = series(x, 2, false);
        t.b = series(x, 3, false);
        t.a_slope = -2 * series(x, 4, true);
        t.b_slope = -2 * series(x, 5, true);
        excess = -2 * series(x, 4, false);
    }
    else
    {
        double r = sqrt(x), sine = sin(r), half = sin(0.5 * r), versine = 2 * half * half;
        t.a = versine / x;
        t.b = (r - sine) / (x * r);
        t.a_slope = (r * sine - 2 * versine) / (x * x);
        t.b_slope = (3 * sine - 2 * r - r * cos(r)) / (x * x * r);
        excess = (2 * t.a - 1) / x;
    }
    t.inverse = (excess + t.b) / (2 * t.a);
    return t;
}

void spline_rotate(const double *e, const double *v, double *rotated)
{
    double x = vector_dot(3, e, e), once[3], twice[3];
    spline_turning t = spline_turning_of(x);
    vector3_cross(e, v, once);
    vector3_cross(e, once, twice);
    for (int i = 0; i < 3; i++)
        rotated[i] = v[i] + (1 - t.b * x) * once[i] + t.a * twice[i];
}

/// Velocity and acceleration: w = c' - a c x c' + b c x (c x c') and its derivative. `velocity` may be null.
static void rotation_rates(const spline_turning *t, const double *c, const double *first, const double *second,
                           double *velocity, double *acceleration)
{
    double along = vector_dot(3, c, first), once[3], twice[3], other[3], bent[3], other_twice[3];
    vector3_cross(c, first, once);
    vector3_cross(c, once, twice);
    vector3_cross(c, second, other);
    vector3_cross(c, other, other_twice);
    vector3_cross(first, once, bent);
    for (int i = 0; i < 3; i++)
    {
        double value = first[i] - t->a * once[i] + t->b * twice[i];
        acceleration[i] = second[i] - t->a * other[i] + t->b * (bent[i] + other_twice[i]) +
                          along * (t->b_slope * twice[i] - t->a_slope * once[i]);
        if (velocity != NULL)
            velocity[i] = value;
    }
}

// Constant curvature. In a frame that is parallel along the geodesics from m, exp_m(c(s)) has the velocity
// V = S c' + G <c, c'> c, and the acceleration V' + E (c <c', V> - c' <c, V>).

/// The functions of x = |c|^2: S = sn(r) / r, G = (1 - S) / x, E = (1 - cs(r)) / x, and the derivatives of S and G by x.
typedef struct bending
{
    double s, g, e, s_slope, g_slope;
} bending;

static bending bending_of(double x, double curvature)
{
    bending t;
    double y = curvature * x;
    if (x < 1)
    {
        t.s = series(y, 1, false);
        t.g = curvature * series(y, 3, false);
        t.e = curvature * series(y, 2, false);
        t.s_slope = -curvature * series(y, 3, true);
        t.g_slope = -series(y, 5, true);
    }
    else
    {
        double r = sqrt(x), cosine = curvature > 0 ? cos(r) : cosh(r);
        t.s = (curvature > 0 ? sin(r) : sinh(r)) / r;
        t.g = (1 - t.s) / x;
        t.e = (1 - cosine) / x;
        t.s_slope = (cosine - t.s) / (2 * x);
        t.g_slope = -(t.s_slope + t.g) / x;
    }
    return t;
}

/// The part along c stays; the part across is divided by S.
static bat_status curved_pull(const spline_factor *f, const double *middle, const double *c, const double *q,
                              const double *v, double *pulled)
{
    double brought[DIM];
    size_t n = f->space.tangent_dim;
    bending t = bending_of(vector_dot(n, c, c), f->curvature);
    bat_status status = f->space.transport(&f->space, q, middle, v, brought);
    double along = t.g * vector_dot(n, c, brought);
    for (size_t i = 0; i < n; i++)
        pulled[i] = (brought[i] - along * c[i]) / t.s;
    return status;
}

static bat_status curved_acceleration(const spline_factor *f, const double *middle, const tangent_jet *c, const double *q,
                                      double *acceleration)
{
    double turned[DIM];
    size_t n = f->space.tangent_dim;
    const double *value = c->value, *first = c->first, *second = c->second;
    bending t = bending_of(vector_dot(n, value, value), f->curvature);
    double along = vector_dot(n, value, first), squared = vector_dot(n, first, first), x = vector_dot(n, value, value);
    double growth = squared + vector_dot(n, value, second);
    double of_value = 2 * t.g_slope * along * along + t.g * growth, of_first = (2 * t.s_slope + t.g) * along;
    // V = s c' + g along c
    double first_v = t.s * squared + t.g * along * along, value_v = t.s * along + t.g * along * x;
    of_value += t.e * first_v;
    of_first -= t.e * value_v;
    for (size_t i = 0; i < n; i++)
        turned[i] = t.s * second[i] + of_value * value[i] + of_first * first[i];
    return f->space.transport(&f->space, middle, q, turned, acceleration);
}

// Any space

double spline_place_of(size_t place)
{
    return PLACES[place] * STEP;
}

void spline_differences(size_t n, const double *rows, double *first, double *second)
{
    memset(first, 0, n * sizeof *first);
    memset(second, 0, n * sizeof *second);
    for (size_t k = 0; k < SPLINE_PLACES; k++)
    {
        vector_add(n, FIRST[k] / STEP, rows + k * n, first);
        vector_add(n, SECOND[k] / (STEP * STEP), rows + k * n, second);
    }
}

/// Derivatives at q of exp_m(c(s)): differences of logarithms, which are normal coordinates at q. Either may be null.
static bat_status any_rates(const spline_factor *f, const double *middle, const tangent_jet *c, const double *q,
                            double *velocity, double *acceleration)
{
    const bat_space *space = &f->space;
    size_t n = space->tangent_dim;
    double near[DIM], moved[DIM], log[DIM];
    if (velocity != NULL)
        memset(velocity, 0, n * sizeof *velocity);
    if (acceleration != NULL)
        memset(acceleration, 0, n * sizeof *acceleration);
    for (int k = 0; k < 6; k++)
    {
        double s = PLACES[k] * STEP;
        for (size_t i = 0; i < n; i++)
            moved[i] = c->value[i] + s * (c->first[i] + s * (c->second[i] / 2 + s * c->third[i] / 6));
        bat_status status = space->exp(space, middle, moved, near);
        if (status == BAT_OK)
            status = space->log(space, q, near, log);
        if (status != BAT_OK)
            return status;
        if (velocity != NULL)
            vector_add(n, FIRST[k] / STEP, log, velocity);
        if (acceleration != NULL)
            vector_add(n, SECOND[k] / (STEP * STEP), log, acceleration);
    }
    return BAT_OK;
}

/// The same of tensors, whose velocities are exact: the covariant acceleration by differences of these, transported to q.
static bat_status tensor_rates(const spline_factor *f, const double *identity, const tangent_jet *c, const double *q,
                               double *velocity, double *acceleration)
{
    const bat_space *space = &f->space;
    size_t n = space->tangent_dim;
    double near[DIM], log[DIM], slope[DIM], rate[DIM], moved[DIM];
    bat_status status = BAT_OK;
    if (velocity != NULL)
        status = positive_definite_convert(space, c->value, q, c->first, false, velocity);
    if (acceleration != NULL)
        memset(acceleration, 0, n * sizeof *acceleration);
    for (int k = 0; k < 6 && acceleration != NULL && status == BAT_OK; k++)
    {
        double s = PLACES[k] * TENSOR_STEP;
        for (size_t i = 0; i < n; i++)
        {
            log[i] = c->value[i] + s * (c->first[i] + s * (c->second[i] / 2 + s * c->third[i] / 6));
            slope[i] = c->first[i] + s * (c->second[i] + s * c->third[i] / 2);
        }
        status = space->exp(space, identity, log, near);
        if (status == BAT_OK)
            status = positive_definite_convert(space, log, near, slope, false, rate);
        if (status == BAT_OK)
            status = space->transport(space, near, q, rate, moved);
        if (status == BAT_OK)
            vector_add(n, FIRST[k] / TENSOR_STEP, moved, acceleration);
    }
    return status;
}

/// The differential is parallel transport but for terms of the square of |c|: correct by the transported residual.
static bat_status any_pull(const spline_factor *f, const double *middle, const double *c, const double *q, const double *v,
                           double *pulled)
{
    const bat_space *space = &f->space;
    static const double zeros[DIM];
    double residual[DIM], brought[DIM];
    for (int step = 0; step < PULL_STEPS; step++)
    {
        bat_status status = any_rates(f, middle, &(tangent_jet){c, pulled, zeros, zeros}, q, residual, NULL);
        for (size_t i = 0; i < space->tangent_dim; i++)
            residual[i] = v[i] - residual[i];
        if (status == BAT_OK)
            status = space->transport(space, q, middle, residual, brought);
        if (status != BAT_OK)
            return status;
        vector_add(space->tangent_dim, 1, brought, pulled);
    }
    return BAT_OK;
}

// All

/// Add the factors of a space to `count` others. Returns their number, or `limit` + 1 when there are more.
static size_t append(const bat_space *space, size_t point_at, size_t tangent_at, spline_factor *factors, size_t count,
                     size_t limit)
{
    double curvature = 0;
    if (space_is_product(space))
    {
        const bat_product_factors *parts = space->parameters;
        for (size_t i = 0; i < parts->count && count <= limit; i++)
        {
            count = append(&parts->spaces[i], point_at, tangent_at, factors, count, limit);
            point_at += parts->spaces[i].point_dim;
            tangent_at += parts->spaces[i].tangent_dim;
        }
        return count;
    }
    if (space_is_rigid(space))
    {
        bat_space translation = bat_euclidean(3), rotation = bat_rotation();
        count = append(&translation, point_at, tangent_at, factors, count, limit);
        return count <= limit ? append(&rotation, point_at + 3, tangent_at + 3, factors, count, limit) : count;
    }
    if (count == limit)
        return limit + 1;
    spline_factor *f = &factors[count];
    factor_kind kind = space_is_euclidean(space)            ? FACTOR_FLAT
                       : space_is_rotation(space)           ? FACTOR_ROTATION
                       : space_is_curved(space, &curvature) ? FACTOR_CURVED
                       : space_is_positive_definite(space)  ? FACTOR_TENSOR
                                                            : FACTOR_ANY;
    *f = (spline_factor){kind, *space, curvature, point_at, tangent_at, 0, false};
    return count + 1;
}

size_t spline_factors(const bat_space *space, spline_factor *factors, size_t limit)
{
    size_t count = append(space, 0, 0, factors, 0, limit);
    return count <= limit ? count : 0;
}

size_t spline_factor_record_size(const spline_factor *f)
{
    return (f->kind == FACTOR_FLAT ? 0 : f->space.point_dim) + (f->quintic ? 6 : 4) * f->space.tangent_dim;
}

/// The share of a long way of the middle. The differential of exp is singular at whole turns.
static double middle_share(const double *way)
{
    static const double SHARES[] = {0.5, 0.4, 0.3}, FAR = 0.1;
    double turns = sqrt(vector_dot(3, way, way)) / ANGLE_TURN;
    for (size_t i = 0; i < sizeof SHARES / sizeof *SHARES; i++)
    {
        double before = SHARES[i] * turns, after = turns - before;
        bool near =
            (before > 0.5 && fabs(before - round(before)) < FAR) || (after > 0.5 && fabs(after - round(after)) < FAR);
        if (!near)
            return SHARES[i];
    }
    return 0.5;
}

bat_status spline_middle(const spline_factor *f, const double *p, const double *q, const double *way, double *middle,
                         double *log_p, double *log_q)
{
    const bat_space *space = &f->space;
    size_t n = space->tangent_dim;
    if (way != NULL && !isnan(way[0]))
    {
        double share = middle_share(way);
        for (size_t i = 0; i < n; i++)
        {
            log_p[i] = -share * way[i];
            log_q[i] = way[i] + log_p[i];
        }
        quaternion_turn(p, -log_p[0], -log_p[1], -log_p[2], middle);
        return BAT_OK;
    }
    if (f->kind == FACTOR_FLAT)
    {
        for (size_t i = 0; i < n; i++)
        {
            middle[i] = p[i];
            log_p[i] = 0;
            log_q[i] = q[i] - p[i];
        }
        return BAT_OK;
    }
    bat_status status = bat_space_geodesic(space, p, q, 0.5, middle);
    if (status == BAT_OK)
        status = space->log(space, middle, p, log_p);
    return status == BAT_OK ? space->log(space, middle, q, log_q) : status;
}

bat_status spline_pull(const spline_factor *f, const double *middle, const double *c, const double *q, const double *vector,
                       const spline_turning *turning, double *pulled)
{
    if (f->kind == FACTOR_FLAT)
        memcpy(pulled, vector, f->space.tangent_dim * sizeof *pulled);
    else if (f->kind == FACTOR_ROTATION)
    {
        double once[3], twice[3];
        vector3_cross(c, vector, once);
        vector3_cross(c, once, twice);
        for (int i = 0; i < 3; i++)
            pulled[i] = vector[i] + 0.5 * once[i] + turning->inverse * twice[i];
    }
    else
        return f->kind == FACTOR_CURVED ? curved_pull(f, middle, c, q, vector, pulled)
                                        : any_pull(f, middle, c, q, vector, pulled);
    return BAT_OK;
}

bat_status spline_acceleration(const spline_factor *f, const double *middle, const tangent_jet *c, const double *q,
                               const spline_turning *turning, double *acceleration)
{
    if (f->kind == FACTOR_FLAT)
        memcpy(acceleration, c->second, f->space.tangent_dim * sizeof *acceleration);
    else if (f->kind == FACTOR_ROTATION)
        rotation_rates(turning, c->value, c->first, c->second, NULL, acceleration);
    else
        return f->kind == FACTOR_CURVED ? curved_acceleration(f, middle, c, q, acceleration)
                                        : any_rates(f, middle, c, q, NULL, acceleration);
    return BAT_OK;
}

/// The polynomial of a degree with coefficients c at s, and its derivatives where wanted.
static void polynomial_at(size_t n, size_t degree, const double *c, double s, double *value, double *first, double *second)
{
    for (size_t i = 0; i < n; i++)
    {
        double v = 0, slope = 0, bend = 0;
        for (size_t k = degree + 1; k-- > 0;)
        {
            bend = bend * s + slope;
            slope = slope * s + v;
            v = v * s + c[k * n + i];
        }
        value[i] = v;
        if (first != NULL)
            first[i] = slope;
        if (second != NULL)
            second[i] = 2 * bend;
    }
}

static void rotation_at(const double *record, double share, double *point, double *velocity, double *acceleration)
{
    const double *coefficients = record + 4;
    double c[3], first[3], second[3];
    bool rates = velocity != NULL || acceleration != NULL;
    polynomial_at(3, 3, coefficients, share, c, rates ? first : NULL, acceleration != NULL ? second : NULL);
    quaternion_turn(record, c[0], c[1], c[2], point);
    if (acceleration != NULL)
    {
        spline_turning turning = spline_turning_of(vector_dot(3, c, c));
        rotation_rates(&turning, c, first, second, velocity, acceleration);
    }
    else if (velocity != NULL)
    {
        spline_turning t = spline_turning_of(vector_dot(3, c, c));
        double once[3], twice[3];
        vector3_cross(c, first, once);
        vector3_cross(c, once, twice);
        for (int i = 0; i < 3; i++)
            velocity[i] = first[i] - t.a * once[i] + t.b * twice[i];
    }
}

static bat_status curve_at(const spline_factor *f, const double *record, double share, double *point, double *velocity,
                           double *acceleration)
{
    const bat_space *space = &f->space;
    const double *coefficients = record + space->point_dim;
    size_t n = space->tangent_dim;
    double c[DIM], first[DIM], second[DIM], third[DIM] = {0};
    c[0] = 0; // where there are no coordinates
    bool rates = velocity != NULL || acceleration != NULL;
    polynomial_at(n, 3, coefficients, share, c, rates ? first : NULL, rates ? second : NULL);
    bat_status status = space->exp(space, record, c, point);
    if (status != BAT_OK || !rates)
        return status;
    for (size_t i = 0; i < n; i++)
        third[i] = 6 * coefficients[3 * n + i];
    tangent_jet jet = {c, first, second, third};
    if (f->kind == FACTOR_TENSOR)
        return tensor_rates(f, record, &jet, point, velocity, acceleration);
    if (f->kind == FACTOR_ANY)
        return any_rates(f, record, &jet, point, velocity, acceleration);
    if (velocity != NULL)
    {
        double turned[DIM];
        bending t = bending_of(vector_dot(n, c, c), f->curvature);
        double along = t.g * vector_dot(n, c, first);
        for (size_t i = 0; i < n; i++)
            turned[i] = t.s * first[i] + along * c[i];
        status = f->space.transport(&f->space, record, point, turned, velocity);
    }
    return status == BAT_OK && acceleration != NULL ? curved_acceleration(f, record, &jet, point, acceleration) : status;
}

bat_status spline_factor_at(const spline_factor *f, const double *record, double share, double *point, double *velocity,
                            double *acceleration)
{
    if (f->kind == FACTOR_FLAT)
        polynomial_at(f->space.point_dim, f->quintic ? 5 : 3, record, share, point, velocity, acceleration);
    else if (f->kind == FACTOR_ROTATION)
        rotation_at(record, share, point, velocity, acceleration);
    else
        return curve_at(f, record, share, point, velocity, acceleration);
    return BAT_OK;
}

/// Points of FACTOR_FLAT. Runs of one interval share its coefficients.
static void flat_run(size_t n, const double *c, const double *shares, size_t count, double *points, size_t stride)
{
    for (size_t i = 0; i < n; i++)
    {
        const double c0 = c[i], c1 = c[n + i], c2 = c[2 * n + i], c3 = c[3 * n + i];
        for (size_t j = 0; j < count; j++)
            points[j * stride + i] = c0 + shares[j] * (c1 + shares[j] * (c2 + shares[j] * c3));
    }
}

/// Whether the rotation vectors of an interval are shorter than 2 pi, by the sum of their coefficients' lengths.
static bool is_short(const double *c)
{
    double bound = 0;
    for (size_t k = 0; k < 4; k++)
        bound += sqrt(vector_dot(3, c + 3 * k, c + 3 * k));
    return bound < ANGLE_TURN;
}

/// Coordinates of quaternion i, one array each, so that no store is scattered: m times that of a turn by twice (x, y, z),
/// which is no longer than pi.
static inline void turn_lane(double m0, double m1, double m2, double m3, double x, double y, double z, size_t i,
                             double *restrict made)
{
    double squared = x * x + y * y + z * z, cosine = lane_cos_root(squared), ratio = lane_sinc_root(squared);
    x *= ratio;
    y *= ratio;
    z *= ratio;
    made[i] = m0 * cosine - m1 * x - m2 * y - m3 * z;
    made[SPLINE_RUN + i] = m0 * x + m1 * cosine + m2 * z - m3 * y;
    made[2 * SPLINE_RUN + i] = m0 * y + m2 * cosine + m3 * x - m1 * z;
    made[3 * SPLINE_RUN + i] = m0 * z + m3 * cosine + m1 * y - m2 * x;
}

LANES_CLONES
static void turn_by_lanes(const double *record, const double *restrict shares, size_t count, double *restrict made)
{
    const double m0 = record[0], m1 = record[1], m2 = record[2], m3 = record[3], *c = record + 4;
    const double x0 = 0.5 * c[0], x1 = 0.5 * c[3], x2 = 0.5 * c[6], x3 = 0.5 * c[9];
    const double y0 = 0.5 * c[1], y1 = 0.5 * c[4], y2 = 0.5 * c[7], y3 = 0.5 * c[10];
    const double z0 = 0.5 * c[2], z1 = 0.5 * c[5], z2 = 0.5 * c[8], z3 = 0.5 * c[11];
    for (size_t i = 0; i < count; i++)
    {
        double s = shares[i];
        turn_lane(m0, m1, m2, m3, x0 + s * (x1 + s * (x2 + s * x3)), y0 + s * (y1 + s * (y2 + s * y3)),
                  z0 + s * (z1 + s * (z2 + s * z3)), i, made);
    }
}

/// The same of the middles and half turns in `rows`, seven arrays.
LANES_CLONES
static void turn_rows(const double *restrict rows, size_t count, double *restrict made)
{
    for (size_t i = 0; i < count; i++)
    {
        const double *row = rows + i;
        turn_lane(row[0], row[SPLINE_RUN], row[2 * SPLINE_RUN], row[3 * SPLINE_RUN], row[4 * SPLINE_RUN],
                  row[5 * SPLINE_RUN], row[6 * SPLINE_RUN], i, made);
    }
}

static void store_quaternions(const double *made, size_t count, double *quaternions, size_t stride)
{
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 4; c++)
            quaternions[i * stride + c] = made[c * SPLINE_RUN + i];
}

static void rotation_run(const double *record, const double *shares, size_t count, double *quaternions, size_t stride)
{
    double made[4 * SPLINE_RUN];
    if (is_short(record + 4))
    {
        turn_by_lanes(record, shares, count, made);
        store_quaternions(made, count, quaternions, stride);
        return;
    }
    for (size_t i = 0; i < count; i++)
        rotation_at(record, shares[i], quaternions + i * stride, NULL, NULL);
}

static void rotation_mixed(const double *records, size_t size, const uint32_t *intervals, const double *shares, size_t count,
                           double *quaternions, size_t stride)
{
    double rows[7 * SPLINE_RUN], made[4 * SPLINE_RUN], squares[SPLINE_RUN];
    rows[0] = 0;
    for (size_t i = 0; i < count; i++)
    {
        const double *record = records + intervals[i] * size, *c = record + 4, s = shares[i];
        for (size_t k = 0; k < 4; k++)
            rows[k * SPLINE_RUN + i] = record[k];
        squares[i] = 0;
        for (size_t k = 0; k < 3; k++)
        {
            double half = 0.5 * (c[k] + s * (c[3 + k] + s * (c[6 + k] + s * c[9 + k])));
            rows[(4 + k) * SPLINE_RUN + i] = half;
            squares[i] += half * half;
        }
    }
    turn_rows(rows, count, made);
    store_quaternions(made, count, quaternions, stride);
    for (size_t i = 0; i < count; i++)
        if (!(4 * squares[i] < ANGLE_TURN * ANGLE_TURN))
            rotation_at(records + intervals[i] * size, shares[i], quaternions + i * stride, NULL, NULL);
}

bat_status spline_factor_mixed(const spline_factor *f, const double *records, size_t size, const uint32_t *intervals,
                               const double *shares, size_t count, double *points, size_t stride)
{
    bat_status status = BAT_OK;
    if (f->kind == FACTOR_ROTATION)
        rotation_mixed(records, size, intervals, shares, count, points, stride);
    for (size_t i = 0; i < count && f->kind != FACTOR_ROTATION && status == BAT_OK; i++)
        status = spline_factor_run(f, records + intervals[i] * size, shares + i, 1, points + i * stride, stride);
    return status;
}

bat_status spline_factor_run(const spline_factor *f, const double *record, const double *shares, size_t count,
                             double *points, size_t stride)
{
    bat_status status = BAT_OK;
    if (f->kind == FACTOR_FLAT && !f->quintic)
        flat_run(f->space.point_dim, record, shares, count, points, stride);
    else if (f->kind == FACTOR_ROTATION)
        rotation_run(record, shares, count, points, stride);
    else
        for (size_t i = 0; i < count && status == BAT_OK; i++)
            status = spline_factor_at(f, record, shares[i], points + i * stride, NULL, NULL);
    return status;
}
