#include "motion/spline_system.h"

#include "base/error.h"
#include "base/golden.h"
#include "base/number_digits.h"
#include "linalg/dense.h"
#include "space/quaternion.h"

#include <string.h>

// The rates, less a bias b, integrate to rotations G. With the true bias, rotations Y of keys are C exp(x) G exp(noise) with
// a constant C and a random walk x, the integral of the noise of the rates; an error d of the bias adds -M d to x, M being
// the integral of G. The filter of this local-level model (Harvey, Forecasting, Structural Time Series Models and the Kalman
// Filter, 1989, 4.1) gives the likelihood of the two noises and the generalized least squares of d; its smoother gives x.

enum
{
    ROUNDS = 12,
    SEARCH_STEPS = 40,
    /// The fewest keys that tell two noises and a bias.
    MIN_KEYS = 6,
    /// Columns that the filter takes together: x and M.
    COLUMNS = 12
};

/// Ratios of the walk in a mean step to the noise of a key, squared, and changes of the bias's turn that are rounding.
static const double LOW_RATIO = 1e-10, HIGH_RATIO = 1e6, SETTLED = 1e-10;

typedef struct gyro_work
{
    const double *times, *keys;
    const bat_motion_gyro *gyro;
    gyro_fusion *fused;
    size_t count;
    double known; ///< the noise of keys in a component; 0 when unknown
    double walk;  ///< the least one; see gyro_walk_of()
    double step;  ///< the mean time between keys
    double bias[3], constant[4];
    size_t *places;             ///< of the keys in the fused times
    double *turned;             ///< G: fused count x 4
    double *columns;            ///< count x COLUMNS
    double *levels, *variances; ///< of the filter: count x COLUMNS, count
    double ratio, noise, correction[3], spread[9];
} gyro_work;

static void multiply(const double *p, const double *q, double *product)
{
    const double made[] = {
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3], p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1]};
    memcpy(product, made, sizeof made);
}

void gyro_row_at(const bat_motion_gyro *gyro, const double *rows, double time, size_t *near, double *row)
{
    while (*near + 2 < gyro->count && gyro->times[*near + 1] <= time)
        ++*near;
    double from = gyro->times[*near], share = fmin(fmax((time - from) / (gyro->times[*near + 1] - from), 0), 1);
    for (const double *r = rows + 3 * *near, *end = r + 3; r < end; r++)
        *row++ = r[0] + share * (r[3] - r[0]);
}

/// The rates at a time, less the bias.
static void rates_at(const gyro_work *work, double time, size_t *near, double *rates)
{
    gyro_row_at(work->gyro, work->gyro->rates, time, near, rates);
    vector_add(3, -1, work->bias, rates);
}

/// Integrate the rates: the fourth-order term of Magnus's series for linear rates, and the trapezoidal rule for M.
static void integrate(gyro_work *work)
{
    size_t near = 0, key = 0;
    double rates[3], next[3], moved[9] = {0}, matrix[9], inverse[4], apart[4];
    const double *times = work->fused->times;
    memcpy(work->turned, (const double[]){1, 0, 0, 0}, 4 * sizeof(double));
    rates_at(work, times[0], &near, rates);
    for (size_t i = 0; i < work->fused->count; i++)
    {
        double *g = work->turned + 4 * i;
        if (i > 0)
        {
            double h = times[i] - times[i - 1], w[3];
            rates_at(work, times[i], &near, next);
            for (size_t c = 0; c < 3; c++)
            {
                size_t d = (c + 1) % 3, e = (c + 2) % 3;
                w[c] = h / 2 * (rates[c] + next[c]) + h * h / 12 * (rates[d] * next[e] - rates[e] * next[d]);
            }
            quaternion_turn(g - 4, w[0], w[1], w[2], g);
            for (size_t c = 0; c < 18; c++) // the trapezoid of two matrices
            {
                if (c % 9 == 0)
                    bat_rotation_to_matrix(c == 0 ? g - 4 : g, matrix);
                moved[c % 9] += h / 2 * matrix[c % 9];
            }
            memcpy(rates, next, sizeof rates);
        }
        if (i != work->places[key])
            continue;
        memcpy(inverse, (const double[]){g[0], -g[1], -g[2], -g[3]}, sizeof inverse);
        multiply(work->keys + 4 * key, inverse, apart);
        if (key == 0)
            memcpy(work->constant, apart, sizeof apart);
        quaternion_step step = quaternion_step_between(work->constant, apart);
        double scale = step.squared_sine > 0 ? 2 * atan2(sqrt(step.squared_sine), step.cosine) / sqrt(step.squared_sine) : 2;
        double *column = work->columns + COLUMNS * key;
        memcpy(column, (const double[]){scale * step.x, scale * step.y, scale * step.z}, 3 * sizeof(double));
        memcpy(column + 3, moved, sizeof moved);
        if (++key == work->count)
            return;
    }
}

/// Filter the columns; returns minus twice the logarithm of the likelihood for a ratio of the noises, up to a constant.
static double filter(gyro_work *work, double ratio)
{
    double squares = 0, logs = 0, mixed[3] = {0}, normal[9] = {0}, inverse[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    work->variances[0] = 1;
    memcpy(work->levels, work->columns, COLUMNS * sizeof(double));
    for (size_t i = 1; i < work->count; i++)
    {
        const double *column = work->columns + COLUMNS * i;
        double *level = work->levels + COLUMNS * i, v[COLUMNS];
        double before = work->variances[i - 1] + ratio * (work->times[i] - work->times[i - 1]) / work->step, f = before + 1;
        work->variances[i] = before / f;
        for (size_t c = 0; c < COLUMNS; c++)
        {
            v[c] = column[c] - level[(ptrdiff_t)c - COLUMNS];
            level[c] = level[(ptrdiff_t)c - COLUMNS] + before / f * v[c];
        }
        squares += vector_square(3, v) / f;
        logs += 3 * log(f);
        for (size_t j = 0; j < 3; j++)
            for (size_t r = 0; r < 3; r++)
            {
                mixed[j] += v[3 + 3 * r + j] * v[r] / f;
                for (size_t k = 0; k < 3; k++)
                    normal[3 * j + k] += v[3 + 3 * r + j] * v[3 + 3 * r + k] / f;
            }
    }
    if (decompose_solve(3, 3, normal, inverse, NULL) != BAT_OK)
        return INFINITY;
    for (size_t j = 0; j < 3; j++)
    {
        work->correction[j] = -vector_dot(3, inverse + 3 * j, mixed);
        squares += work->correction[j] * mixed[j];
    }
    double degrees = 3 * (double)(work->count - 1) - 3, variance = work->known * work->known;
    work->noise = work->known > 0 ? work->known : sqrt(fmax(squares, 0) / degrees);
    memcpy(work->spread, inverse, sizeof inverse);
    work->ratio = ratio;
    return work->known > 0 ? squares / variance + logs : degrees * log(fmax(squares, 1e-300)) + logs;
}

// Of normal noise in three dimensions the median of squares of third differences is 20 times 2.366 times the variance.
double gyro_walk_of(const bat_motion_gyro *gyro, const double *rows, double *sorted)
{
    size_t count = 0;
    double step = (gyro->times[gyro->count - 1] - gyro->times[0]) / (double)(gyro->count - 1);
    for (size_t i = 3; i < gyro->count; i++)
    {
        const double *r = rows + 3 * i;
        double sum = 0;
        for (size_t c = 0; c < 3; c++)
        {
            double d = r[c] - 3 * r[(ptrdiff_t)c - 3] + 3 * r[(ptrdiff_t)c - 6] - r[(ptrdiff_t)c - 9];
            sum += d * d;
        }
        sorted[count++] = sum;
    }
    return count > 0 ? sqrt(step * sort_median(sorted, count) / (20 * 2.366)) : 0;
}

/// The ratio of the greatest likelihood, by golden sections. Keys alone tell little of a small walk: it is at least that of
/// the rates' own noise.
static bool find_ratio(gyro_work *work)
{
    double least = work->noise > 0 ? work->walk * work->walk * work->step / (work->noise * work->noise) : 0;
    golden_search search = golden_begin(log(fmin(fmax(least, LOW_RATIO), HIGH_RATIO)), log(HIGH_RATIO));
    for (int step = 0; step <= SEARCH_STEPS; step++)
        golden_tell(&search, filter(work, exp(search.at)));
    return isfinite(filter(work, exp((search.low + search.high) / 2)));
}

/// A first bias: what the rates turn more than the keys, step by step.
static void guess_bias(gyro_work *work)
{
    for (int round = 0; round < 3; round++)
    {
        double sum[3] = {0};
        integrate(work);
        for (size_t i = 1; i < work->count; i++)
        {
            const double *g = work->turned + 4 * work->places[i - 1], *h = work->turned + 4 * work->places[i];
            double way[4], end[4], log[3];
            multiply((const double[]){g[0], -g[1], -g[2], -g[3]}, h, way);
            multiply(work->keys + 4 * (i - 1), way, end);
            bat_space rotation = bat_rotation();
            if (rotation.log(&rotation, work->keys + 4 * i, end, log) == BAT_OK)
                vector_add(3, 1, log, sum);
        }
        for (size_t c = 0; c < 3; c++)
            work->bias[c] += sum[c] / (work->times[work->count - 1] - work->times[0]);
    }
}

/// Whether the walk takes half of the turns between keys, beyond the rates' own noise, or the keys' noise more than all.
static bool contradicts(const gyro_work *work, double walk)
{
    static const double MIN_SHARE = 0.25, MIN_NOISES = 3, MIN_TURN = 0.05; // of squares; of the own walk; in a step
    double span = work->times[work->count - 1] - work->times[0], turns = 0, log[3];
    bat_space rotation = bat_rotation();
    for (size_t i = 1; i < work->count; i++)
        if (rotation.log(&rotation, work->keys + 4 * (i - 1), work->keys + 4 * i, log) == BAT_OK)
            turns += vector_square(3, log);
    double square = 3 * work->noise * work->noise, walked = 3 * walk * walk;
    return (walked * span > MIN_SHARE * turns && walk > MIN_NOISES * work->walk &&
            walked * work->step > MIN_TURN * MIN_TURN) ||
           (square * (double)work->count > turns && square > MIN_TURN * MIN_TURN);
}

/// What the bias is not known by, in a mean component: M less its smoothed level, between two keys.
static double spread_of_bias(const gyro_work *work, size_t key, const double *levels[2], double share)
{
    double sum = 0, d[3];
    for (size_t r = 0; r < 3; r++)
    {
        for (size_t c = 0; c < 3; c++)
        {
            size_t at = 3 + 3 * r + c;
            const double *m = work->columns + COLUMNS * key + at;
            d[c] = (1 - share) * (levels[0][at] - m[0]) + (share > 0 ? share * (levels[1][at] - m[COLUMNS]) : 0);
        }
        for (size_t c = 0; c < 3; c++)
            sum += d[c] * vector_dot(3, work->spread + 3 * c, d) / 3;
    }
    return sum;
}

/// The random walk at the keys, with variances, from the last one back; then the rotations between.
static void smooth(gyro_work *work)
{
    gyro_fusion *fused = work->fused;
    double later[COLUMNS] = {0}, spread = 0;
    for (size_t i = work->count; i-- > 0;)
    {
        double *level = work->levels + COLUMNS * i, variance = work->variances[i], between = 0, shared = 0;
        bool last = i + 1 == work->count;
        if (!last)
        {
            between = work->ratio * (work->times[i + 1] - work->times[i]) / work->step;
            double gain = variance / (variance + between);
            shared = gain * spread;
            for (size_t c = 0; c < COLUMNS; c++)
                level[c] += gain * (later[c] - level[c]);
            variance += gain * gain * (spread - variance - between);
        }
        for (size_t k = work->places[i]; k < fused->count && (k == work->places[i] || k < work->places[i + 1]); k++)
        {
            double s = last ? 0 : (fused->times[k] - work->times[i]) / (work->times[i + 1] - work->times[i]), r = 1 - s;
            double x[3], turned[4], own = r * r * variance + s * s * spread + 2 * r * s * shared + between * r * s;
            for (size_t c = 0; c < 3; c++)
                x[c] = last ? level[c] : r * level[c] + s * later[c];
            quaternion_turn(work->constant, x[0], x[1], x[2], turned);
            multiply(turned, work->turned + 4 * k, fused->rotations + 4 * k);
            quaternion_normalize(fused->rotations + 4 * k);
            own += spread_of_bias(work, i, (const double *[]){level, later}, s);
            fused->deviations[k] = work->noise * sqrt(fmax(own, 0));
        }
        memcpy(later, level, sizeof later);
        spread = variance;
    }
}

/// The times of the keys, and those of the rates between them.
static void merge_times(gyro_work *work)
{
    static const double SAME = 1e-2; // of a step of the rates
    const bat_motion_gyro *gyro = work->gyro;
    double apart = SAME * (gyro->times[gyro->count - 1] - gyro->times[0]) / (double)(gyro->count - 1);
    size_t made = 0, next = 0;
    for (size_t key = 0; key < work->count; key++)
    {
        for (; next < gyro->count && gyro->times[next] < work->times[key] + apart; next++)
            if (key > 0 && gyro->times[next] > work->times[key - 1] + apart && gyro->times[next] < work->times[key] - apart)
                work->fused->times[made++] = gyro->times[next];
        work->places[key] = made;
        work->fused->times[made++] = work->times[key];
    }
    work->fused->count = made;
}

static bat_status check_gyro(const double *times, size_t count, const bat_motion_gyro *gyro, bat_error *error)
{
    char digits[4][NUMBER_DIGITS_SIZE];
    if (count < MIN_KEYS || gyro->count < 2)
        return ERROR_UNSUPPORTED(error, 0, "a gyroscope needs %d keys and 2 rates at least, not %zu and %zu", MIN_KEYS,
                                 count, gyro->count);
    for (size_t i = 0; i < gyro->count; i++)
        if (!isfinite(gyro->times[i]) || (i > 0 && !(gyro->times[i] > gyro->times[i - 1])) ||
            !isfinite(vector_square(3, gyro->rates + 3 * i)) ||
            (gyro->forces != NULL && !isfinite(vector_square(3, gyro->forces + 3 * i))))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0,
                             "measurement %zu of the gyroscope is not finite, or not later than the one before", i);
    double first = gyro->times[0], last = gyro->times[gyro->count - 1], step = (last - first) / (double)(gyro->count - 1);
    if (first > times[0] + step || last < times[count - 1] - step)
        return ERROR_ARGUMENT(error, "the rates of the gyroscope, %s to %s, do not cover the keys, %s to %s",
                              number_digits(first, digits[0]), number_digits(last, digits[1]),
                              number_digits(times[0], digits[2]), number_digits(times[count - 1], digits[3]));
    return BAT_OK;
}

static bat_status allocate(gyro_work *work, bat_error *error)
{
    size_t most = work->count + work->gyro->count;
    gyro_fusion *fused = work->fused;
    work->places = memory_pool_array(&fused->pool, work->count + 1, sizeof *work->places);
    work->turned = memory_pool_array(&fused->pool, most, 4 * sizeof(double));
    work->columns = memory_pool_array(&fused->pool, work->count, COLUMNS * sizeof(double));
    work->levels = memory_pool_array(&fused->pool, work->count, COLUMNS * sizeof(double));
    work->variances = memory_pool_array(&fused->pool, work->count, sizeof(double));
    fused->times = memory_pool_array(&fused->pool, most, sizeof(double));
    fused->rotations = memory_pool_array(&fused->pool, most, 4 * sizeof(double));
    fused->deviations = memory_pool_array(&fused->pool, most, sizeof(double));
    return memory_pool_check(&fused->pool, error);
}

bat_status gyro_fuse(const double *times, const double *keys, size_t count, const bat_motion_gyro *gyro, double sigma,
                     gyro_fusion *fusion, bat_error *error)
{
    gyro_work work = {.times = times, .keys = keys, .gyro = gyro, .fused = fusion, .count = count};
    *fusion = (gyro_fusion){0};
    bat_status status = check_gyro(times, count, gyro, error);
    if (status != BAT_OK)
        return status;
    double span = times[count - 1] - times[0], change = INFINITY;
    work.step = span / (double)(count - 1);
    work.known = sigma > 0 ? sigma / sqrt(3) : 0;
    status = allocate(&work, error);
    if (status == BAT_OK)
    {
        work.walk = gyro_walk_of(gyro, gyro->rates, work.turned); // which is not in use yet
        merge_times(&work);
        guess_bias(&work);
    }
    bool found = true;
    for (int round = 0; round < ROUNDS && status == BAT_OK && found && change > SETTLED; round++)
    {
        integrate(&work);
        found = find_ratio(&work);
        vector_add(3, 1, work.correction, work.bias);
        change = sqrt(vector_square(3, work.correction)) * span;
    }
    if (status == BAT_OK && !(found && isfinite(change)))
        status = ERROR_UNSUPPORTED(error, 0, "the keys do not tell the bias of the gyroscope");
    if (status == BAT_OK && contradicts(&work, work.noise * sqrt(work.ratio / work.step)))
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                           "the rates of the gyroscope contradict the turns of the keys: check the order, the signs and the "
                           "unit of its axes, and its clock");
    if (status == BAT_OK)
    {
        smooth(&work);
        fusion->report.sigma = work.noise * sqrt(3);
        fusion->report.walk = work.noise * sqrt(work.ratio / work.step);
        for (size_t c = 0; c < 3; c++)
        {
            fusion->report.bias[c] = work.bias[c];
            fusion->report.bias_sigma[c] = work.noise * sqrt(work.spread[4 * c]);
        }
    }
    return status;
}
