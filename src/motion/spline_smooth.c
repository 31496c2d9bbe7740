#include "base/error.h"
#include "base/golden.h"
#include "curve/smooth_fit.h"
#include "linalg/vector.h"
#include "motion/spline_system.h"

#include <float.h>
#include <string.h>

// Penalized splines of noisy keys for one weight of the penalty: its system, its solution, and the influence of each key.

/// Noisy keys of one factor, in a frame that is parallel along the keys: of R^n by components, of rotations together.
typedef struct smoother
{
    memory_pool pool; ///< holds the arrays
    const spline_factor *f;
    size_t count, dim, n; ///< keys; numbers of a point and of a tangent vector
    size_t first;         ///< the component that is fitted, or all of rotations: fit.dim of them
    double scale;         ///< a hundredth of the mean distance of neighbours, to tell when steps are small
    const double *given;  ///< the measurements
    double *points;       ///< the motion
    double *frames;       ///< count x n x n: vectors of the frame; null for FACTOR_FLAT
    double *influence;    ///< count: of each measurement on its own key
    smooth_fit fit;       ///< with vectors in the frame; its variances tell how much the velocity changes
} smoother;

/// @file
/// Reinsch's smoothing spline (Smoothing by spline functions, Numerische Mathematik 10, 1967), with geodesic residuals and
/// with vectors in a frame that is parallel along the keys: in it all components have one pentadiagonal system of numbers.
/// docs/algorithms/motion-splines.md derives it.

#define MAX_STEPS 60

/// The sum of the weighted squares of the residuals of the components that are fitted, of which none counts more than `cut`.
static double smoother_squares(const smoother *s, double cut)
{
    double sum = 0;
    for (size_t i = 0; i < s->count; i++)
        sum += fmin(vector_square(s->fit.dim, s->fit.residuals + i * s->fit.dim) / s->fit.slacks[i], cut);
    return sum;
}

/// The components of a vector at a key or, `back`, the vector of components.
static void turn_frame(const smoother *s, size_t key, bool back, const double *from, double *to)
{
    const double *frame = s->frames != NULL ? s->frames + key * s->n * s->n : NULL;
    for (size_t k = 0; k < s->n; k++)
    {
        double sum = 0;
        for (size_t i = 0; frame != NULL && i < s->n; i++)
            sum += frame[back ? i * s->n + k : k * s->n + i] * from[i];
        to[k] = frame != NULL ? sum : from[k];
    }
}

/// Frames, residuals, and ways from key to key.
static bat_status measure(smoother *s, bat_error *error)
{
    const bat_space *space = &s->f->space;
    size_t dim = s->fit.dim;
    double vector[BAT_SPACE_MAX_DIM], turned[BAT_SPACE_MAX_DIM];
    for (size_t k = 0; s->frames != NULL && k < s->n * s->n; k++)
        s->frames[k] = k % (s->n + 1) == 0 ? 1 : 0;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < s->count && status == BAT_OK; i++)
    {
        const double *p = s->points + i * s->dim, *q = p + s->dim;
        status = space->log(space, p, s->given + i * s->dim, vector);
        turn_frame(s, i, false, vector, turned);
        memcpy(s->fit.residuals + i * dim, turned + s->first, dim * sizeof *turned);
        if (status != BAT_OK)
            return error_set(error, status, i, 0, "smoothing fails at point %zu, half a turn away from the motion", i);
        if (i + 1 == s->count)
            break;
        status = space->log(space, p, q, vector);
        turn_frame(s, i, false, vector, turned);
        for (size_t k = 0; k < dim; k++)
        {
            s->fit.ahead[i * dim + k] = turned[s->first + k];
            s->fit.behind[(i + 1) * dim + k] = -turned[s->first + k];
        }
        for (size_t k = 0; s->frames != NULL && k < s->n && status == BAT_OK; k++)
            status =
                space->transport(space, p, q, s->frames + (i * s->n + k) * s->n, s->frames + ((i + 1) * s->n + k) * s->n);
        if (status != BAT_OK)
            return error_set(error, status, i + 1, 0, "smoothing fails at point %zu: neighbours are half a turn apart",
                             i + 1);
    }
    return status;
}

/// Move the points by r - weight W^-1 Q a. `*largest` receives the longest step.
static bat_status move(smoother *s, double weight, double *largest)
{
    const bat_space *space = &s->f->space;
    bat_status status = BAT_OK;
    *largest = 0;
    for (size_t i = 0; i < s->count && status == BAT_OK; i++)
    {
        double step[BAT_SPACE_MAX_DIM] = {0}, vector[BAT_SPACE_MAX_DIM], moved[BAT_SPACE_MAX_DIM];
        smooth_fit_bend_back(&s->fit, i, weight, step + s->first);
        vector_add(s->fit.dim, 1, s->fit.residuals + i * s->fit.dim, step + s->first);
        *largest = fmax(*largest, sqrt(vector_square(s->n, step)));
        turn_frame(s, i, true, step, vector);
        status = space->exp(space, s->points + i * s->dim, vector, moved);
        memcpy(s->points + i * s->dim, moved, s->dim * sizeof *moved);
    }
    return status;
}

/// Move the points to the penalized spline, by Gauss-Newton steps from where they are.
/// @param accuracy of the steps, relative to the scale
/// @return BAT_OK; BAT_CUT_LOCUS where the motion leaves a measurement by half a turn
static bat_status smoother_fit(smoother *s, double weight, double accuracy, bat_error *error)
{
    bat_status status = measure(s, error);
    double largest = INFINITY;
    (void)smooth_fit_factor(&s->fit, weight);
    for (int step = 0; step < MAX_STEPS && status == BAT_OK && largest > accuracy * s->scale; step++)
    {
        (void)smooth_fit_bend(&s->fit);
        status = move(s, weight, &largest);
        status = status == BAT_OK ? measure(s, error)
                                  : error_set(error, status, BAT_NO_INDEX, 0, "smoothing fails; sigma is too large");
        if (s->f->kind == FACTOR_FLAT)
            break;
    }
    return status;
}

/// Fill `influence` after a fit. Returns the sum, the degrees of freedom of a component.
static double smoother_influence(smoother *s, double weight)
{
    double sum = 0;
    smooth_fit_invert(&s->fit);
    for (size_t i = 0; i < s->count; i++)
    {
        s->influence[i] = 1 - smooth_fit_variance(&s->fit, i, weight) / s->fit.slacks[i];
        sum += s->influence[i];
    }
    return sum;
}

/// Allocate the arrays, and begin with the measurements, which stay the caller's.
static bat_status smoother_begin(smoother *s, const spline_factor *f, size_t count, const double *lengths,
                                 const double *given, bat_error *error)
{
    size_t dim = f->space.point_dim, n = f->space.tangent_dim;
    *s = (smoother){.f = f, .count = count, .dim = dim, .n = n, .given = given};
    s->points = memory_pool_array(&s->pool, count, dim * sizeof(double));
    s->frames = f->kind == FACTOR_ROTATION ? memory_pool_array(&s->pool, count, n * n * sizeof(double)) : NULL;
    s->influence = memory_pool_array(&s->pool, count, sizeof(double));
    bat_status status = memory_pool_check(&s->pool, error);
    if (status == BAT_OK)
        status = smooth_fit_make(count, f->kind == FACTOR_ROTATION ? n : 1, false, &s->fit, error);
    if (status != BAT_OK)
        return status;
    double total = 0, way = 0;
    for (size_t i = 0; i + 1 < count; i++)
    {
        total += lengths[i];
        way += f->space.distance(&f->space, given + i * dim, given + (i + 1) * dim);
    }
    s->scale = way > 0 ? 0.01 * way / (double)count : 1;
    for (size_t i = 0; i < count; i++)
    {
        s->fit.steps[i] = i + 1 < count ? lengths[i] / total * (double)(count - 1) : 0;
        s->fit.slacks[i] = 1;
    }
    memcpy(s->points, given, count * dim * sizeof *given);
    return BAT_OK;
}

// Keys so near in time that their step says nothing of the velocity: an accelerated spline through them would leave the
// data on both sides, since a small error of a point is a large one of the velocity.

#define DIM BAT_SPACE_MAX_DIM

/// An interval is a jolt if it is this many times shorter than both neighbours, and as many times faster or slower.
static const double SHORTER = 4, RATIO = 4;

double spline_speed(const spline_system *system, size_t interval)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim;
    const double *b = system->logs + 2 * interval * n, *a = b + n;
    double chord[DIM];
    vector_subtract(n, a, b, chord);
    double squared = space->inner(space, system->middles + interval * space->point_dim, chord, chord);
    return sqrt(fmax(squared, 0)) / system->lengths[interval];
}

static bool is_jolt(const spline_system *system, size_t interval)
{
    bool closed = system->intervals == system->count;
    if (!closed && (interval == 0 || interval + 1 == system->intervals))
        return false;
    size_t before = spline_interval_beside(system, interval, -1), after = spline_interval_beside(system, interval, 1);
    const double *h = system->lengths;
    if (before == after || SHORTER * h[interval] > fmin(h[before], h[after]))
        return false;
    double speed = spline_speed(system, interval), left = spline_speed(system, before), right = spline_speed(system, after);
    return speed > RATIO * fmax(left, right) || RATIO * speed < fmin(left, right);
}

/// Give both keys of a jolt the velocity of the parabola through the keys around it, as if they were one.
static bat_status set_velocities(spline_system *system, size_t interval)
{
    size_t n = system->factor->space.tangent_dim, first = interval, second = (interval + 1) % system->count;
    size_t before = spline_interval_beside(system, interval, -1), after = spline_interval_beside(system, interval, 1);
    double h = system->lengths[before], next = system->lengths[after], back[DIM], forth[DIM], moved[DIM];
    bat_status status = spline_chord(system, before, AT_END, back);
    if (status == BAT_OK)
        status = spline_chord(system, after, AT_BEGIN, forth);
    if (status == BAT_OK)
        status = spline_transport(system, interval, AT_END, AT_BEGIN, forth, moved);
    if (status != BAT_OK)
        return status;
    double *velocity = system->velocities + first * n;
    for (size_t c = 0; c < n; c++)
        velocity[c] = (moved[c] * h / next + back[c] * next / h) / (h + next);
    system->fixed[first] = system->fixed[second] = KEY_GIVEN;
    return spline_transport(system, interval, AT_BEGIN, AT_END, velocity, system->velocities + second * n);
}

bat_status spline_system_hold(spline_system *system, size_t *held)
{
    bat_status status = BAT_OK;
    *held = 0;
    for (size_t i = 0; i < system->intervals && status == BAT_OK; i++)
        if (is_jolt(system, i) && !(system->fixed[i] == KEY_GIVEN && system->fixed[(i + 1) % system->count] == KEY_GIVEN))
        {
            status = set_velocities(system, i);
            ++*held;
        }
    return status;
}

// The weight of the penalty: the least expected error of the motion, for a noise that is known (Mallows, Some comments on
// C_p, 1973) or not (generalized cross-validation: Craven and Wahba, Smoothing noisy data with spline functions, 1979).

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
    bool mixes;                     ///< whether uncertainties are those of all weights: see mix_weights()
    double *means;                  ///< count x n: mean residuals over the weights
    double activity;                ///< mean variance of the acceleration over the weights
} noise_search;

/// The expected error of the motion for a weight of the penalty, up to constants. Infinite where there is no motion.
static double judge(noise_search *search, double weight)
{
    smoother *s = &search->s;
    size_t n = s->fit.dim;
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
    golden_search golden = golden_begin(log(low), log(high));
    for (int step = 0; step <= SEARCH_STEPS; step++)
    {
        double weight = exp(golden.at), value = judge(search, weight);
        golden_tell(&golden, value);
        if (value < search->value)
        {
            search->value = value;
            search->weight = weight;
            search->power = power;
        }
    }
}

static void set_activity(noise_search *search, double power)
{
    for (size_t i = 0; i + 1 < search->s.count; i++)
        search->s.fit.variances[i] = power > 0 ? pow(search->energy[i], power) : 1;
}

/// The mean square acceleration around each interval, relative to that over all, at least QUIET. False: it tells nothing.
static bool measure_energy(noise_search *search)
{
    const smoother *s = &search->s;
    size_t n = s->fit.dim, half = WINDOW / 2;
    double sum = 0, mean = 0, *squares = s->fit.buffer; // of the accelerations, which are none at both ends
    squares[0] = squares[s->count - 1] = 0;
    for (size_t i = 1; i + 1 < s->count; i++)
    {
        squares[i] = vector_square(n, s->fit.bends + (i - 1) * n);
        mean += squares[i] / (double)(s->count - 2);
    }
    if (s->count < MIN_ACTIVE || !(mean > 0) || !isfinite(mean))
        return false;
    // Sums over the keys i - half to i + half + 1, the ends of the interval i and those around it.
    for (size_t i = 0; i <= half; i++)
        sum += squares[i];
    for (size_t i = 0; i + 1 < s->count; i++)
    {
        size_t from = i > half ? i - half : 0, to = i + half + 1 < s->count ? i + half + 1 : s->count - 1;
        if (i + half + 1 < s->count)
            sum += squares[to];
        if (i > half)
            sum -= squares[from - 1];
        search->energy[i] = fmax(sum, 0) / ((double)(to - from + 1) * mean) + QUIET;
    }
    return true;
}

/// The noise of the component or components that were fitted, squared: given, or that of the residuals.
static double variance_of(const noise_search *search)
{
    const smoother *s = &search->s;
    double n = (double)s->fit.dim, degrees = fmax(search->all - ((double)s->count - search->freedom), 1) * n;
    return search->sigma > 0 ? search->sigma * search->sigma : smoother_squares(s, search->cut * n) / degrees;
}

/// Add the fit for a weight, by a share, to the mean residuals and to `uncertainties`, the mean squares with variances.
/// @param likely the noise by the restricted likelihood, squared; that of the residuals alone is often too small
static void mix(noise_search *search, double share, double weight, double likely)
{
    const smoother *s = &search->s;
    const size_t n = s->fit.dim;
    const double variance = sqrt(variance_of(search) * likely);
    search->activity += share * (variance / weight - search->activity);
    for (size_t i = 0; i < s->count * n; i++)
    {
        size_t key = i / n, at = key * s->n + s->first + i % n;
        double r = s->fit.residuals[i], square = r * r + variance * s->influence[key] * s->fit.slacks[key];
        search->means[at] += share * (r - search->means[at]);
        search->uncertainties[at] += share * (square - search->uncertainties[at]);
    }
}

/// What an unknown noise leaves open: the motion may follow noise, so that all larger weights count, too, by their
/// restricted likelihood and by a prior against motions that follow the noise, the share of freedom.
static void mix_weights(noise_search *search)
{
    static const double UNLIKELY = 12;
    smoother *s = &search->s;
    const size_t n = s->fit.dim;
    double numbers = (double)((s->count - 2) * n), best = -INFINITY, likely = 0, total = 0;
    for (double weight = search->weight; (weight <= search->weight || weight < LAST_WEIGHT) && !(likely < best - UNLIKELY);
         weight *= sqrt(FACTOR))
    {
        if (smoother_fit(s, weight, NEAR, NULL) != BAT_OK)
        {
            memcpy(s->points, s->given, s->count * s->dim * sizeof *s->given);
            return;
        }
        double determinant = smooth_fit_factor(&s->fit, weight), sum = fmax(smooth_fit_bend(&s->fit), DBL_MIN);
        search->freedom = (double)s->count - smoother_influence(s, weight);
        likely = log(fmax(search->freedom, DBL_MIN)) - (numbers * log(sum) + (double)n * determinant) / 2;
        double share = exp(fmin(likely - best, 0));
        total = total * exp(fmin(best - likely, 0)) + share;
        best = fmax(best, likely);
        mix(search, share / total, weight, weight * sum / numbers);
    }
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
    if (search->mixes)
        mix_weights(search);
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
        search->s.fit.slacks[i] = 1 / fmax(weight, MIN_WEIGHT);
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
        const double *steps = s->fit.steps + i;
        double share = steps[0] / (steps[-1] + steps[0]);
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
        search->distances[i] = search->s.f->space.distance(&search->s.f->space, search->s.points + i * search->s.dim,
                                                           search->s.given + i * search->s.dim);
}

/// The noise by the median distance of the measurements, which few outliers do not change: of normal noise in n dimensions
/// the median is about sqrt(1 - 2 / (9 n))^3 of the root mean square (Wilson and Hilferty 1931).
static double median_sigma(noise_search *search)
{
    double part = 1 - 2.0 / (9 * (double)search->s.n);
    memcpy(search->sorted, search->distances, search->s.count * sizeof *search->sorted);
    return sort_median(search->sorted, search->s.count) / sqrt(part * part * part);
}

/// Fit all components, those of rotations with one weight of the penalty. `*sigma` receives an unknown noise.
static bat_status fit_all(noise_search *search, double *sigma, bat_error *error)
{
    smoother *s = &search->s;
    bat_status status = BAT_OK;
    size_t together = s->fit.dim;
    double total = 0;
    search->all = 0;
    for (size_t i = 0; i < s->count; i++)
        search->all += 1 / s->fit.slacks[i];
    search->sigma = *sigma > 0 ? *sigma / sqrt((double)s->n) : 0;
    for (s->first = 0; s->first < s->n && status == BAT_OK; s->first += together)
    {
        status = find_weight(search, error);
        const double variance = variance_of(search);
        total += variance * (double)together;
        for (size_t i = 0; i < s->count && status == BAT_OK; i++)
            for (size_t k = s->first; k < s->first + together; k++)
            {
                double span = s->fit.steps[i] / 2, *square = search->uncertainties + i * s->n + k;
                double r = s->fit.residuals[i * together + k - s->first];
                *square = search->mixes ? *square + r * (r - 2 * search->means[i * s->n + k])
                                        : variance * s->influence[i] * s->fit.slacks[i];
                *square = sqrt(fmax(*square, 0));
                search->wander[i * s->n + k] = (search->mixes ? search->activity : variance / search->weight) *
                                               s->fit.variances[i] * span * span * span / 24;
            }
    }
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
    search->mixes = rule == BAT_MOTION_OUTLIERS_NONE && known == 0;
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
        search->mixes = round + 1 == ROUNDS && known == 0;
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
    search.means = memory_pool_zeros(&s->pool, count, f->space.tangent_dim * sizeof(double));
    if (status == BAT_OK)
        status = memory_pool_check(&s->pool, error);
    double noise = fmax(*sigma, 0);
    if (status == BAT_OK)
        status = smooth(&search, outliers, &noise, error);
    if (status == BAT_OK)
        measure_motion(&search);
    for (size_t i = 0; status == BAT_OK && noise > 0 && i < count; i++)
        deviations[i] = fmax(deviations[i], search.distances[i] / noise);
    if (status == BAT_OK)
    {
        memcpy(points, s->points, count * s->dim * sizeof *points);
        *sigma = noise;
    }
    smooth_fit_free(&s->fit);
    memory_pool_free(&s->pool);
    return status;
}
