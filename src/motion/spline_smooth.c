#include "motion/smoother.h"

#include "base/error.h"
#include "linalg/vector.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// The weight of the penalty: the least expected error of the motion, for a noise that is known (Mallows, Some comments on
/// C_p, 1973) or not (generalized cross-validation: Craven and Wahba, Smoothing noisy data with spline functions, 1979).

enum
{
    /// Steps of the search in a bracket.
    SEARCH_STEPS = 12,
    /// The fewest keys that tell a noise.
    MIN_KEYS = 12,
    /// Keys over which the activity is averaged, and the fewest that tell it.
    WINDOW = 15,
    MIN_ACTIVE = 30,
    /// Rounds with a rule for outliers: the first half have Huber's weights.
    ROUNDS = 6
};

/// Weights of the penalty, with the mean interval as the unit of time.
static const double FIRST_WEIGHT = 1e-6, LAST_WEIGHT = 1e13, FACTOR = 10;
/// Distances in units of sigma from which keys are outliers: Huber's and Tukey's constants, and the least weight.
static const double HUBER = BAT_MOTION_HUBER, TUKEY = BAT_MOTION_TUKEY, MIN_WEIGHT = 1e-6;
/// The least activity, relative to the mean.
static const double QUIET = 0.05;
/// Of steps, while the weight is sought, and at last.
static const double NEAR = 1e-4, SETTLED = 1e-8;

typedef struct noise_search
{
    smoother s;
    double sigma;      ///< of a component; 0 when unknown
    double all;        ///< the sum of the weights
    double cut;        ///< what the square of a component counts at most
    double *energy;    ///< count - 1: the mean square of the acceleration around each interval, relative to the whole
    double power;      ///< of the energy in the activity
    double weight;     ///< of the penalty
    double value;      ///< of the criterion
    double freedom;    ///< keys less degrees of freedom
    double *distances; ///< count: of the measurements
    double *sorted;    ///< count
    double *uncertainties, *wander; ///< see spline_smooth()
} noise_search;

/// The expected error of the motion for a weight of the penalty, up to constants. Infinite where there is no motion.
static double judge(noise_search *search, double weight)
{
    smoother *s = &search->s;
    size_t n = s->last - s->first;
    bat_status status = smoother_fit(s, weight, NEAR, NULL);
    if (status != BAT_OK)
    {
        memcpy(s->points, s->given, s->count * s->dim * sizeof *s->given);
        return INFINITY;
    }
    double squares = smoother_squares(s, search->cut * (double)n), freedom = smoother_influence(s, weight);
    double all = search->all;
    search->freedom = (double)s->count - freedom;
    if (search->sigma > 0)
        return squares / (search->sigma * search->sigma) + 2 * (double)n * freedom;
    return all > freedom ? log(fmax(squares, DBL_MIN)) - 2 * log(1 - freedom / all) : INFINITY;
}

/// The best weight between two, by golden sections of its logarithm. Takes it where it is better than what is known.
static void refine(noise_search *search, double low, double high, double power)
{
    static const double GOLDEN = 0.6180339887498949;
    double a = log(low), b = log(high), x[2], value[2];
    for (int i = 0; i < 2; i++)
    {
        x[i] = i == 0 ? b - GOLDEN * (b - a) : a + GOLDEN * (b - a);
        value[i] = judge(search, exp(x[i]));
    }
    for (int step = 0; step < SEARCH_STEPS; step++)
    {
        int better = value[0] <= value[1] ? 0 : 1;
        if (value[better] < search->value)
        {
            search->value = value[better];
            search->weight = exp(x[better]);
            search->power = power;
        }
        *(better == 0 ? &b : &a) = x[1 - better];
        x[1 - better] = x[better];
        value[1 - better] = value[better];
        x[better] = better == 0 ? b - GOLDEN * (b - a) : a + GOLDEN * (b - a);
        value[better] = judge(search, exp(x[better]));
    }
}

static void set_activity(noise_search *search, double power)
{
    for (size_t i = 0; i + 1 < search->s.count; i++)
        search->s.activity[i] = power > 0 ? pow(search->energy[i], power) : 1;
}

/// The mean square of the acceleration around each interval, relative to the mean over all and at least QUIET. False where
/// it tells nothing.
static bool measure_energy(noise_search *search)
{
    const smoother *s = &search->s;
    size_t n = s->last - s->first, half = WINDOW / 2;
    double sum = 0, mean = 0;
    for (size_t i = 1; i + 1 < s->count; i++)
        mean += vector_square(n, s->bends + i * s->n + s->first) / (double)(s->count - 2);
    if (s->count < MIN_ACTIVE || !(mean > 0) || !isfinite(mean))
        return false;
    // Sums over the keys i - half to i + half + 1, the ends of the interval i and those around it.
    for (size_t i = 0; i <= half; i++)
        sum += vector_square(n, s->bends + i * s->n + s->first);
    for (size_t i = 0; i + 1 < s->count; i++)
    {
        size_t from = i > half ? i - half : 0, to = i + half + 1 < s->count ? i + half + 1 : s->count - 1;
        if (i + half + 1 < s->count)
            sum += vector_square(n, s->bends + to * s->n + s->first);
        if (i > half)
            sum -= vector_square(n, s->bends + (from - 1) * s->n + s->first);
        search->energy[i] = fmax(sum, 0) / ((double)(to - from + 1) * mean) + QUIET;
    }
    return true;
}

/// Find the weight of the penalty, and how the activity changes along the motion, and move the points there.
static bat_status find_weight(noise_search *search, bat_error *error)
{
    static const double POWERS[] = {0.5, 1}, AROUND = 30;
    search->value = INFINITY;
    search->power = 0;
    search->weight = FIRST_WEIGHT;
    set_activity(search, 0);
    for (double weight = FIRST_WEIGHT; weight < LAST_WEIGHT; weight *= FACTOR)
    {
        double value = judge(search, weight);
        if (value < search->value)
        {
            search->value = value;
            search->weight = weight;
        }
        if (!(value < INFINITY) && search->value < INFINITY)
            break;
    }
    if (search->weight > FIRST_WEIGHT)
        refine(search, search->weight / FACTOR, search->weight * FACTOR, 0);
    double middle = search->weight;
    (void)judge(search, middle);
    bool active = middle > FIRST_WEIGHT && measure_energy(search);
    for (size_t i = 0; active && i < sizeof POWERS / sizeof *POWERS; i++)
    {
        set_activity(search, POWERS[i]);
        refine(search, middle / AROUND, middle * AROUND, POWERS[i]);
    }
    set_activity(search, search->power);
    bat_status status = smoother_fit(&search->s, search->weight, SETTLED, error);
    search->freedom = (double)search->s.count - smoother_influence(&search->s, search->weight);
    return status;
}

/// Weights of the measurements by their distances from the motion.
static void weigh(noise_search *search, bat_motion_outliers rule, double sigma)
{
    for (size_t i = 0; i < search->s.count; i++)
    {
        double u = search->distances[i] / sigma, t = u / TUKEY;
        double weight =
            rule == BAT_MOTION_OUTLIERS_HUBER ? (u > HUBER ? HUBER / u : 1) : (t < 1 ? (1 - t * t) * (1 - t * t) : 0);
        search->s.weights[i] = fmax(weight, MIN_WEIGHT);
    }
}

/// The distances of the measurements from the geodesics between their neighbours, as if these had no noise.
static void measure_neighbours(noise_search *search)
{
    const smoother *s = &search->s;
    const bat_space *space = &s->f->space;
    double before[BAT_SPACE_MAX_DIM], after[BAT_SPACE_MAX_DIM];
    for (size_t i = 1; i + 1 < s->count; i++)
    {
        const double *p = s->given + i * s->dim;
        double share = s->lengths[i] / (s->lengths[i - 1] + s->lengths[i]);
        bool near = space->log(space, p, p - s->dim, before) == BAT_OK && space->log(space, p, p + s->dim, after) == BAT_OK;
        for (size_t k = 0; k < s->n; k++)
            before[k] = near ? share * before[k] + (1 - share) * after[k] : 0;
        search->distances[i] = sqrt(vector_square(s->n, before) / (1 + share * share + (1 - share) * (1 - share)));
    }
    search->distances[0] = search->distances[1];
    search->distances[s->count - 1] = search->distances[s->count - 2];
}

static void measure_motion(noise_search *search)
{
    for (size_t i = 0; i < search->s.count; i++)
        search->distances[i] = sqrt(vector_square(search->s.n, search->s.residuals + i * search->s.n));
}

/// The noise by the median distance of the measurements, which few outliers do not change: of normal noise in n dimensions
/// the median is about sqrt(1 - 2 / (9 n))^3 of the root mean square (Wilson and Hilferty 1931).
static double median_sigma(noise_search *search)
{
    double part = 1 - 2.0 / (9 * (double)search->s.n);
    memcpy(search->sorted, search->distances, search->s.count * sizeof *search->sorted);
    qsort(search->sorted, search->s.count, sizeof *search->sorted, ascending);
    return search->sorted[search->s.count / 2] / sqrt(part * part * part);
}

/// Fit all components, each for itself but those of rotations, which have one weight of the penalty. `*sigma` receives the
/// noise of a key, where it is unknown.
static bat_status fit_all(noise_search *search, double *sigma, bat_error *error)
{
    smoother *s = &search->s;
    bat_status status = BAT_OK;
    size_t together = s->f->kind == FACTOR_ROTATION ? s->n : 1;
    double total = 0;
    search->all = 0;
    for (size_t i = 0; i < s->count; i++)
        search->all += s->weights[i];
    search->sigma = *sigma > 0 ? *sigma / sqrt((double)s->n) : 0;
    for (s->first = 0; s->first < s->n && status == BAT_OK; s->first += together)
    {
        s->last = s->first + together;
        status = find_weight(search, error);
        double degrees = fmax(search->all - ((double)s->count - search->freedom), 1) * (double)together;
        double variance = search->sigma > 0 ? search->sigma * search->sigma
                                            : smoother_squares(s, search->cut * (double)together) / degrees;
        total += variance * (double)together;
        for (size_t i = 0; i < s->count && status == BAT_OK; i++)
            for (size_t k = s->first; k < s->last; k++)
            {
                double span = s->lengths[i] / 2;
                search->uncertainties[i * s->n + k] = sqrt(fmax(variance * s->influence[i] / s->weights[i], 0));
                search->wander[i * s->n + k] = variance / search->weight * s->activity[i] * span * span * span / 24;
            }
    }
    s->first = 0;
    s->last = s->n;
    *sigma = sqrt(total);
    return status;
}

/// Fits with weights by the distances, which are Huber's at first: Tukey's have many solutions.
static bat_status smooth(noise_search *search, bat_motion_outliers rule, double *sigma, bat_error *error)
{
    /// Squares beyond this distance tell nothing of the motion.
    static const double FAR = 2.5, LEAST_SHARE = 0.1;
    double known = *sigma;
    search->cut = INFINITY;
    if (rule == BAT_MOTION_OUTLIERS_NONE)
        return fit_all(search, sigma, error);
    bat_status status = BAT_OK;
    measure_neighbours(search);
    for (int round = 0; round < ROUNDS && status == BAT_OK; round++)
    {
        double share = round > 0 ? fmax(search->freedom / (double)search->s.count, LEAST_SHARE) : 1, found = known;
        double scale = known > 0 ? known : median_sigma(search) / sqrt(share);
        scale = scale > 0 ? scale : search->s.scale;
        weigh(search, 2 * round >= ROUNDS ? rule : BAT_MOTION_OUTLIERS_HUBER, scale);
        search->cut = FAR * FAR * scale * scale / (double)search->s.n;
        status = fit_all(search, &found, error);
        measure_motion(search);
        *sigma = scale;
    }
    return status;
}

bat_status spline_smooth(const spline_factor *f, size_t count, const double *lengths, bat_motion_outliers outliers,
                         double *points, double *sigma, double *deviations, double *uncertainties, double *wander,
                         bat_error *error)
{
    noise_search search = {.uncertainties = uncertainties, .wander = wander};
    if (count < (size_t)(*sigma < 0 ? MIN_KEYS : 3))
    {
        *sigma = fmax(*sigma, 0);
        return BAT_OK;
    }
    smoother *s = &search.s;
    bat_status status = smoother_begin(s, f, count, lengths, points, error);
    search.energy = memory_pool_array(&s->pool, count, sizeof(double));
    search.distances = memory_pool_array(&s->pool, count, sizeof(double));
    search.sorted = memory_pool_array(&s->pool, count, sizeof(double));
    if (status == BAT_OK)
        status = memory_pool_check(&s->pool, error);
    double noise = fmax(*sigma, 0);
    if (status == BAT_OK)
        status = smooth(&search, outliers, &noise, error);
    for (size_t i = 0; status == BAT_OK && noise > 0 && i < count; i++)
        deviations[i] = fmax(deviations[i], sqrt(vector_square(s->n, s->residuals + i * s->n)) / noise);
    if (status == BAT_OK)
    {
        memcpy(points, s->points, count * s->dim * sizeof *points);
        *sigma = noise;
    }
    memory_pool_free(&s->pool);
    return status;
}
