#include "motion/spline_system.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Reinsch's smoothing spline (Smoothing by spline functions, Numerische Mathematik 10, 1967), with geodesic residuals and
/// with vectors in a frame that is parallel along the keys: in it all components have one pentadiagonal system of numbers.
/// docs/algorithms/motion-splines.md derives it.

enum
{
    MAX_STEPS = 60,
    MAX_HALVINGS = 60,
    /// Rounds of Tukey's weights after Huber's motion. More of them leave good keys behind where the motion bends most.
    MAX_ROUNDS = 2
};

/// Weights of the penalty, with the mean interval as the unit of time.
static const double FIRST_WEIGHT = 1e-6, LAST_WEIGHT = 1e13, FACTOR = 10;
/// Steps below this share of sigma end the iteration: while the weight is sought, and at last.
static const double NEAR = 1e-4, SETTLED = 1e-10;
/// The weight is found to this relative accuracy of the mean square.
static const double ACCURACY = 1e-6;
/// Distances in units of sigma from which keys are outliers: Huber's and Tukey's constants, and the least weight.
static const double HUBER = BAT_MOTION_HUBER, TUKEY = BAT_MOTION_TUKEY, MIN_WEIGHT = 1e-6;
/// Keys farther than this, in units of sigma, from a motion whose mean square is CLOSE do not count in the mean square.
static const double OUTLYING = 3, CLOSE = 0.5;

typedef struct smoother
{
    memory_pool pool; ///< holds the arrays
    const spline_factor *f;
    size_t count, dim, n; ///< keys; numbers of a point and of a tangent vector
    double sigma;
    bat_motion_outliers outliers;
    const double *given;     ///< the measurements
    double *points;          ///< the motion
    double *lengths;         ///< count - 1, with mean 1
    double *frames;          ///< count x n x n: vectors of the frame; null for FACTOR_FLAT
    double *residuals;       ///< count x n: logarithms of the measurements, in the frame
    double *chords;          ///< count - 1 x n: mean velocities
    double *weights;         ///< count
    double *bends;           ///< count x n: right-hand sides, then the accelerations; rows 0 and count - 1 are 0
    unsigned char *outlying; ///< count: keys that the mean square leaves out
    double cut, target;      ///< of the mean square
    double *bands;           ///< count x 3: the factors L and D of the system
} smoother;

static double square(size_t n, const double *v)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += v[i] * v[i];
    return sum;
}

/// The components of a vector at a key.
static void to_frame(const smoother *s, size_t key, const double *vector, double *components)
{
    for (size_t k = 0; k < s->n; k++)
    {
        double sum = 0;
        for (size_t i = 0; s->frames != NULL && i < s->n; i++)
            sum += s->frames[(key * s->n + k) * s->n + i] * vector[i];
        components[k] = s->frames != NULL ? sum : vector[k];
    }
}

static void from_frame(const smoother *s, size_t key, const double *components, double *vector)
{
    for (size_t i = 0; i < s->n; i++)
    {
        double sum = 0;
        for (size_t k = 0; s->frames != NULL && k < s->n; k++)
            sum += s->frames[(key * s->n + k) * s->n + i] * components[k];
        vector[i] = s->frames != NULL ? sum : components[i];
    }
}

/// Frames, residuals and mean velocities of the motion.
static bat_status measure(smoother *s, bat_error *error)
{
    const bat_space *space = &s->f->space;
    double vector[BAT_SPACE_MAX_DIM];
    for (size_t k = 0; s->frames != NULL && k < s->n * s->n; k++)
        s->frames[k] = k % (s->n + 1) == 0 ? 1 : 0;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < s->count && status == BAT_OK; i++)
    {
        const double *p = s->points + i * s->dim, *q = p + s->dim;
        status = space->log(space, p, s->given + i * s->dim, vector);
        to_frame(s, i, vector, s->residuals + i * s->n);
        if (status != BAT_OK)
            return error_set(error, status, i, 0, "smoothing fails at point %zu, half a turn away; sigma is too large", i);
        if (i + 1 == s->count)
            break;
        status = space->log(space, p, q, vector);
        to_frame(s, i, vector, s->chords + i * s->n);
        for (size_t k = 0; k < s->n; k++)
            s->chords[i * s->n + k] /= s->lengths[i];
        for (size_t k = 0; s->frames != NULL && k < s->n && status == BAT_OK; k++)
            status =
                space->transport(space, p, q, s->frames + (i * s->n + k) * s->n, s->frames + ((i + 1) * s->n + k) * s->n);
        if (status != BAT_OK)
            return error_set(error, status, i + 1, 0, "smoothing fails at point %zu: neighbours are half a turn apart",
                             i + 1);
    }
    return status;
}

/// Weights by the residuals.
static void weigh(smoother *s, bat_motion_outliers rule)
{
    for (size_t i = 0; i < s->count; i++)
    {
        double u = sqrt(square(s->n, s->residuals + i * s->n)) / s->sigma, t = u / TUKEY;
        double weight = rule == BAT_MOTION_OUTLIERS_HUBER   ? (u > HUBER ? HUBER / u : 1)
                        : rule == BAT_MOTION_OUTLIERS_TUKEY ? (t < 1 ? (1 - t * t) * (1 - t * t) : 0)
                                                            : 1;
        s->weights[i] = fmax(weight, MIN_WEIGHT);
    }
}

/// The mean squared residual of the keys that count, in units of sigma squared and of the target.
static double mean_square(const smoother *s)
{
    double sum = 0, all = 0;
    for (size_t i = 0; i < s->count; i++)
    {
        double u = square(s->n, s->residuals + i * s->n) / (s->sigma * s->sigma);
        sum += s->outlying[i] != 0 ? 0 : fmin(u, s->cut);
        all += s->outlying[i] != 0 ? 0 : 1;
    }
    return all > 0 ? sum / all / s->target : 0;
}

/// The second difference Q^T at inner key j as numbers for the keys j - 1, j and j + 1.
static void difference(const smoother *s, size_t j, double q[3])
{
    q[0] = 1 / s->lengths[j - 1];
    q[2] = 1 / s->lengths[j];
    q[1] = -q[0] - q[2];
}

/// Factor R + weight Q^T W^-1 Q as L D L^T: bands have D, and L one and two below the diagonal.
static void factor_system(smoother *s, double weight)
{
    for (size_t j = 1; j + 1 < s->count; j++)
    {
        double q[3], next[3] = {0}, second[3] = {0}, row[3];
        const double *w = s->weights + j;
        difference(s, j, q);
        if (j + 2 < s->count)
            difference(s, j + 1, next);
        if (j + 3 < s->count)
            difference(s, j + 2, second);
        row[0] = (s->lengths[j - 1] + s->lengths[j]) / 3 +
                 weight * (q[0] * q[0] / w[-1] + q[1] * q[1] / w[0] + q[2] * q[2] / w[1]);
        row[1] = j + 2 < s->count ? s->lengths[j] / 6 + weight * (q[1] * next[0] / w[0] + q[2] * next[1] / w[1]) : 0;
        row[2] = weight * q[2] * second[0] / w[1];
        double *band = s->bands + 3 * j;
        if (j > 1)
        {
            row[0] -= band[-3] * band[-2] * band[-2];
            row[1] -= band[-3] * band[-2] * band[-1];
        }
        if (j > 2)
            row[0] -= band[-6] * band[-4] * band[-4];
        band[0] = row[0];
        band[1] = row[1] / row[0];
        band[2] = row[2] / row[0];
    }
}

/// Solve for the accelerations, from the second differences of the measurements.
static void solve(smoother *s)
{
    size_t n = s->n, last = s->count - 2;
    memset(s->bends, 0, n * sizeof(double));
    memset(s->bends + (s->count - 1) * n, 0, n * sizeof(double));
    for (size_t j = 1; j <= last; j++)
    {
        double q[3];
        difference(s, j, q);
        for (size_t k = 0; k < n; k++)
        {
            const double *r = s->residuals + j * n + k, *c = s->chords + j * n + k;
            double bend = c[0] - c[-(ptrdiff_t)n] + q[0] * r[-(ptrdiff_t)n] + q[1] * r[0] + q[2] * r[n];
            if (j > 1)
                bend -= s->bands[3 * (j - 1) + 1] * s->bends[(j - 1) * n + k];
            if (j > 2)
                bend -= s->bands[3 * (j - 2) + 2] * s->bends[(j - 2) * n + k];
            s->bends[j * n + k] = bend;
        }
    }
    for (size_t j = last; j >= 1; j--)
        for (size_t k = 0; k < n; k++)
        {
            const double *band = s->bands + 3 * j;
            double bend = s->bends[j * n + k] / band[0];
            if (j + 1 <= last)
                bend -= band[1] * s->bends[(j + 1) * n + k];
            if (j + 2 <= last)
                bend -= band[2] * s->bends[(j + 2) * n + k];
            s->bends[j * n + k] = bend;
        }
}

/// Move the points by r - weight W^-1 Q a. `*largest` receives the longest step.
static bat_status move(smoother *s, double weight, double *largest)
{
    const bat_space *space = &s->f->space;
    size_t n = s->n;
    bat_status status = BAT_OK;
    *largest = 0;
    for (size_t i = 0; i < s->count && status == BAT_OK; i++)
    {
        double step[BAT_SPACE_MAX_DIM], vector[BAT_SPACE_MAX_DIM], moved[BAT_SPACE_MAX_DIM];
        const double *bend = s->bends + i * n;
        for (size_t k = 0; k < n; k++)
        {
            double turned = 0;
            if (i + 1 < s->count)
                turned += (bend[n + k] - bend[k]) / s->lengths[i];
            if (i > 0)
                turned -= (bend[k] - bend[(ptrdiff_t)k - (ptrdiff_t)n]) / s->lengths[i - 1];
            step[k] = s->residuals[i * n + k] - weight * turned / s->weights[i];
        }
        *largest = fmax(*largest, sqrt(square(n, step)));
        from_frame(s, i, step, vector);
        status = space->exp(space, s->points + i * s->dim, vector, moved);
        memcpy(s->points + i * s->dim, moved, s->dim * sizeof *moved);
    }
    return status;
}

/// The motion for a weight of the penalty, with Tukey's weights as they are, by Gauss-Newton steps from the one that is
/// there. `*square_mean` receives the mean square.
static bat_status fit(smoother *s, bat_motion_outliers rule, double weight, double accuracy, double *square_mean,
                      bat_error *error)
{
    bat_status status = measure(s, error);
    double largest = INFINITY;
    for (int step = 0; step < MAX_STEPS && status == BAT_OK && largest > accuracy * s->sigma; step++)
    {
        if (rule != BAT_MOTION_OUTLIERS_TUKEY)
            weigh(s, rule);
        factor_system(s, weight);
        solve(s);
        status = move(s, weight, &largest);
        status = status == BAT_OK ? measure(s, error)
                                  : error_set(error, status, BAT_NO_INDEX, 0, "smoothing fails; sigma is too large");
    }
    *square_mean = mean_square(s);
    return status;
}

/// Find the weight with mean square 1 by the secant rule in logarithms (Illinois), from a weight with less.
static bat_status find_weight(smoother *s, bat_motion_outliers rule, double *weight, bat_error *error)
{
    double low = *weight, high, low_value, high_value, value;
    bat_status status = fit(s, rule, low, NEAR, &value, error);
    while (status == BAT_OK && value > 1 && low > FIRST_WEIGHT)
    {
        low /= FACTOR;
        status = fit(s, rule, low, NEAR, &value, error);
    }
    low_value = high_value = log(fmax(value, 1e-300));
    for (high = low; status == BAT_OK && high_value < 0 && high < LAST_WEIGHT;)
    {
        low = high;
        low_value = high_value;
        high *= FACTOR;
        status = fit(s, rule, high, NEAR, &value, error);
        high_value = log(fmax(value, 1e-300));
    }
    *weight = high;
    if (high_value <= 0 || low_value >= 0)
        return status;
    double a = log(low), b = log(high);
    for (int step = 0; step < MAX_HALVINGS && status == BAT_OK && b - a > ACCURACY; step++)
    {
        double share = -low_value / (high_value - low_value), middle = a + (b - a) * fmin(fmax(share, 0.01), 0.99);
        status = fit(s, rule, exp(middle), NEAR, &value, error);
        double found = log(fmax(value, 1e-300));
        *weight = exp(middle);
        if (fabs(found) < ACCURACY)
            break;
        if (found < 0)
        {
            a = middle;
            low_value = found;
            high_value /= 2;
        }
        else
        {
            b = middle;
            high_value = found;
            low_value /= 2;
        }
    }
    return status;
}

/// Find the outliers from a motion that follows the keys too closely, with Huber's weights: a stiffer one leaves good keys
/// behind where it is bent most.
static bat_status find_outliers(smoother *s, double *weight, bat_error *error)
{
    s->target = CLOSE;
    s->cut = HUBER * HUBER;
    bat_status status = find_weight(s, BAT_MOTION_OUTLIERS_HUBER, weight, error);
    for (size_t i = 0; i < s->count; i++)
        s->outlying[i] = square(s->n, s->residuals + i * s->n) > OUTLYING * OUTLYING * s->sigma * s->sigma;
    return status;
}

/// Tukey's weights have many solutions: begin with Huber's, and keep its weight of the penalty. Else keys would leave one
/// after the other as the motion gets stiffer.
static bat_status smooth(smoother *s, bat_error *error)
{
    double weight = FIRST_WEIGHT, mean;
    bool tukey = s->outliers == BAT_MOTION_OUTLIERS_TUKEY;
    bat_motion_outliers first = tukey ? BAT_MOTION_OUTLIERS_HUBER : s->outliers;
    bat_status status = first != BAT_MOTION_OUTLIERS_NONE ? find_outliers(s, &weight, error) : BAT_OK;
    s->target = 1;
    s->cut = INFINITY;
    if (status == BAT_OK)
        status = find_weight(s, first, &weight, error);
    if (status == BAT_OK)
        status = fit(s, first, weight, SETTLED, &mean, error);
    for (int round = 0; tukey && round < MAX_ROUNDS && status == BAT_OK; round++)
    {
        weigh(s, s->outliers);
        status = fit(s, s->outliers, weight, SETTLED, &mean, error);
    }
    return status;
}

bat_status spline_smooth(const spline_factor *f, size_t count, const double *lengths, double sigma,
                         bat_motion_outliers outliers, double *points, double *deviations, bat_error *error)
{
    size_t dim = f->space.point_dim, n = f->space.tangent_dim;
    smoother s = {.f = f, .count = count, .dim = dim, .n = n, .sigma = sigma, .outliers = outliers, .given = points};
    if (count < 3)
        return BAT_OK;
    bool turns = f->kind == FACTOR_ROTATION;
    s.points = memory_pool_array(&s.pool, count, dim * sizeof(double));
    s.lengths = memory_pool_array(&s.pool, count, sizeof(double));
    s.frames = turns ? memory_pool_array(&s.pool, count, n * n * sizeof(double)) : NULL;
    s.residuals = memory_pool_array(&s.pool, count, n * sizeof(double));
    s.chords = memory_pool_array(&s.pool, count, n * sizeof(double));
    s.weights = memory_pool_array(&s.pool, count, sizeof(double));
    s.bends = memory_pool_array(&s.pool, count, n * sizeof(double));
    s.bands = memory_pool_array(&s.pool, count, 3 * sizeof(double));
    s.outlying = memory_pool_zeros(&s.pool, count, 1);
    bat_status status = memory_pool_check(&s.pool, error);
    if (status == BAT_OK)
    {
        double total = 0;
        for (size_t i = 0; i + 1 < count; i++)
            total += lengths[i];
        for (size_t i = 0; i + 1 < count; i++)
            s.lengths[i] = lengths[i] / total * (double)(count - 1);
        memcpy(s.points, points, count * dim * sizeof *points);
        status = smooth(&s, error);
    }
    for (size_t i = 0; status == BAT_OK && i < count; i++)
        deviations[i] = fmax(deviations[i], sqrt(square(n, s.residuals + i * n)) / sigma);
    if (status == BAT_OK)
        memcpy(points, s.points, count * dim * sizeof *points);
    memory_pool_free(&s.pool);
    return status;
}
