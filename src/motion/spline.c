
#include "base/bisect.h"
#include "base/choice.h"
#include "base/error.h"
#include "base/number_digits.h"
#include "base/option.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/point_form.h"
#include "motion/hermite_average.h"
#include "motion/spline_system.h"
#include "space/builtin.h"
#include "space/quaternion.h"

#include <string.h>

enum
{
    /// A space has fewer factors than coordinates.
    MAX_FACTORS = BAT_SPACE_MAX_DIM,
    /// Times that a thread takes at once.
    BLOCK = 16384,
    /// Buckets of an interval.
    PARTS = 4,
    /// Times of an interval that follow each other, on average, from which on they go together.
    MIN_RUN = 8,
    CACHE_LINE = 8, ///< numbers
    /// Arithmetic operations of a point, roughly.
    OPERATIONS = 300
};

/// Half angles nearer to 0 or to half a turn than this have no direction of their own.
static const double SAME = 1e-9;
/// Velocities agree with keys within this angle, in at least this share of the intervals that have both.
static const double AGREED = 1, MOST_AGREE = 0.9;

struct bat_motion_spline
{
    memory_pool pool; ///< holds the arrays but for the factors
    bat_space space;
    spline_factor *factors;
    size_t factor_count;
    size_t count, intervals; ///< of keys and of intervals
    bool extrapolate;
    int threads;
    double *times;         ///< intervals + 1
    size_t *buckets;       ///< PARTS x intervals + 1: the interval at the beginning of each of the range's equal parts
    double bucket_rate;    ///< parts a unit of time
    double *points;        ///< count x point_dim; the signs of quaternions do not jump
    double *velocities;    ///< count x tangent_dim
    double *deviations;    ///< count: of the given keys from the motion, in units of sigma
    double *uncertainties; ///< count x tangent_dim
    double *wander;        ///< count x tangent_dim, of intervals; see spline_smooth()
    double sigmas[2];      ///< of the noise: of all but rotations of rigid motions, and of these
    double *records;       ///< intervals x record_size
    size_t record_size;
    size_t held, turned; ///< intervals, over all factors
    bat_motion_gyro_report gyro;
    bat_motion_force_report force;
    bool limited;         ///< the times are those of `timing`
    spline_timing timing; ///< within limits of speed and acceleration
};

static const bat_choice ENDS[] = {
    CHOICE("auto", "by how fast accelerations change; not-a-knot for smooth motions", BAT_MOTION_ENDS_AUTO),
    CHOICE("not-a-knot", "the first two intervals share one cubic, and the last two", BAT_MOTION_ENDS_NOT_A_KNOT),
    CHOICE("natural", "no acceleration at the ends", BAT_MOTION_ENDS_NATURAL),
    CHOICE("clamped", "given velocities at the ends, else none", BAT_MOTION_ENDS_CLAMPED),
};
const bat_family bat_motion_ends_family = FAMILY("kind of ends", ENDS);

static const bat_choice SHAPES[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "rests are kept", BAT_MOTION_SHAPE_AUTO),
    CHOICE("resting", "continuous acceleration, except at rests, gaps and jumps, beside which nothing overshoots",
           BAT_MOTION_SHAPE_RESTING),
    CHOICE("smooth", "continuous acceleration everywhere", BAT_MOTION_SHAPE_SMOOTH),
    CHOICE("limited", "monotone between neighbours (Fritsch and Carlson)", BAT_MOTION_SHAPE_LIMITED),
};
const bat_family bat_motion_shape_family = FAMILY("shape of motions", SHAPES);

static const bat_choice OUTLIERS[] = {
    CHOICE("kept", "count as much as all other keys", BAT_MOTION_OUTLIERS_NONE),
    CHOICE("huber", "count by their distance, not by its square", BAT_MOTION_OUTLIERS_HUBER),
    CHOICE("tukey", "do not count (Tukey's biweight)", BAT_MOTION_OUTLIERS_TUKEY),
};
const bat_family bat_motion_outliers_family = FAMILY("rule for outliers", OUTLIERS);

double motion_outliers_threshold(bat_motion_outliers outliers)
{
    return outliers == BAT_MOTION_OUTLIERS_HUBER   ? BAT_MOTION_HUBER
           : outliers == BAT_MOTION_OUTLIERS_TUKEY ? BAT_MOTION_TUKEY
                                                   : 0;
}

bat_motion_spline_options bat_motion_spline_defaults(void)
{
    return (bat_motion_spline_options){.ends = BAT_MOTION_ENDS_AUTO, .shape = BAT_MOTION_SHAPE_RESTING};
}

static const option_field FIELDS[] = {
    OPTION_FAMILY(bat_motion_spline_options, ends, bat_motion_ends_family),
    OPTION_FAMILY(bat_motion_spline_options, shape, bat_motion_shape_family),
    OPTION_FIELD(bat_motion_spline_options, sigma, OPTION_NUMBER, BAT_MOTION_SIGMA_AUTO, INFINITY),
    OPTION_FIELD(bat_motion_spline_options, angle_sigma, OPTION_NUMBER, BAT_MOTION_SIGMA_AUTO, INFINITY),
    OPTION_FAMILY(bat_motion_spline_options, outliers, bat_motion_outliers_family),
    OPTION_FIELD(bat_motion_spline_options, max_speed, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_motion_spline_options, max_angular_speed, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_motion_spline_options, max_acceleration, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_motion_spline_options, max_angular_acceleration, OPTION_NUMBER, 0, INFINITY),
    OPTION_THREADS(bat_motion_spline_options),
};

static bat_status motion_spline_options_check(const void *opaque, bat_error *error)
{
    const bat_motion_spline_options *options = opaque;
    const double sigmas[] = {options->sigma, options->angle_sigma};
    for (int i = 0; i < 2; i++)
        if (sigmas[i] < 0 && sigmas[i] != BAT_MOTION_SIGMA_AUTO)
            return error_option(error, i == 0 ? "sigma" : "angle_sigma", "is %g, but must be at least 0, or automatic",
                                sigmas[i]);
    if (options->outliers != BAT_MOTION_OUTLIERS_NONE && options->sigma == 0 && options->angle_sigma == 0)
        return ERROR_ARGUMENT(error, "outliers '%s' need sigma",
                              bat_choice_name(&bat_motion_outliers_family, (int)options->outliers));
    bool given = options->begin_velocity != NULL || options->end_velocity != NULL;
    if (given && options->ends != BAT_MOTION_ENDS_CLAMPED)
        return error_option(error, "begin_velocity", "and end_velocity go with clamped ends, not %s",
                            bat_choice_name(&bat_motion_ends_family, (int)options->ends));
    return BAT_OK;
}

const bat_options_table bat_motion_spline_fields =
    OPTIONS_TABLE(bat_motion_spline_options, FIELDS, motion_spline_options_check);

void bat_motion_spline_free(bat_motion_spline *spline)
{
    if (spline == NULL)
        return;
    free(spline->factors);
    memory_pool_free(&spline->pool);
    free(spline);
}

/// The checks of Hermite data, with zeros for tangents and numbers of tangents that are not there.
static bat_status check_keys(const bat_hermite_curve *keys, bat_error *error)
{
    bat_hermite_curve checked = *keys;
    bat_status status = space_check_complete(keys->space, error);
    if (status == BAT_OK && keys->tangents != NULL)
        status = hermite_check_velocities(keys, error);
    if (status != BAT_OK)
        return status;
    size_t numbers = keys->count * keys->space->tangent_dim;
    double *zeros = calloc(numbers > 0 ? numbers : 1, sizeof *zeros);
    if (zeros == NULL)
        return error_memory(error, numbers * sizeof *zeros);
    checked.tangents = zeros;
    for (size_t i = 0; keys->tangents != NULL && i < numbers; i++)
        zeros[i] = isnan(keys->tangents[i]) ? 0 : keys->tangents[i];
    status = hermite_check(&checked, (hermite_check_parts){0}, 1, error);
    free(zeros);
    return status;
}

static bat_status allocate(const bat_hermite_curve *keys, bat_motion_spline *spline, bat_error *error)
{
    const bat_space *space = &spline->space;
    if (array_make(&spline->factors, MAX_FACTORS, sizeof *spline->factors, error) != BAT_OK)
        return BAT_NO_MEMORY;
    spline->factor_count = spline_factors(space, spline->factors, MAX_FACTORS);
    if (spline->factor_count == 0)
        return ERROR_TOO_LARGE(error, "the product has more than %d factors", MAX_FACTORS);
    for (size_t i = 0; i < spline->factor_count; i++)
    {
        spline_factor *f = &spline->factors[i];
        f->quintic = f->kind == FACTOR_FLAT && keys->tangents != NULL;
        for (size_t k = 0; k < keys->count && f->quintic; k++)
            f->quintic = !isnan(keys->tangents[k * space->tangent_dim + f->tangent_at]);
        f->record_at = i > 0 ? f[-1].record_at + spline_factor_record_size(f - 1) : 0;
    }
    // Most spaces have one factor or two.
    spline_factor *fitted = realloc(spline->factors, spline->factor_count * sizeof *fitted);
    spline->factors = fitted != NULL ? fitted : spline->factors;
    const spline_factor *last = &spline->factors[spline->factor_count - 1];
    spline->record_size = last->record_at + spline_factor_record_size(last);
    size_t tangents = space->tangent_dim * sizeof(double);
    spline->times = memory_pool_array(&spline->pool, spline->intervals + 1, sizeof(double));
    spline->buckets = memory_pool_array(&spline->pool, PARTS * spline->intervals + 1, sizeof(size_t));
    spline->points = memory_pool_array(&spline->pool, keys->count, space->point_dim * sizeof(double));
    spline->velocities = memory_pool_array(&spline->pool, keys->count, tangents);
    spline->deviations = memory_pool_zeros(&spline->pool, keys->count, sizeof(double));
    spline->uncertainties = memory_pool_zeros(&spline->pool, keys->count, tangents);
    spline->wander = memory_pool_zeros(&spline->pool, keys->count, tangents);
    spline->records = memory_pool_array(&spline->pool, spline->intervals, spline->record_size * sizeof(double));
    return memory_pool_check(&spline->pool, error);
}

/// Columns `at` to `at + size` of rows of `stride` numbers.
static void gather(const double *rows, size_t count, size_t stride, size_t at, size_t size, double *columns)
{
    for (size_t i = 0; i < count; i++)
        memcpy(columns + i * size, rows + i * stride + at, size * sizeof *columns);
}

static void scatter(const double *columns, size_t count, size_t stride, size_t at, size_t size, double *rows)
{
    for (size_t i = 0; i < count; i++)
        memcpy(rows + i * stride + at, columns + i * size, size * sizeof *columns);
}

static void continue_signs(const spline_factor *f, size_t count, double *points, const double *ways)
{
    for (size_t i = 1; i < count && f->kind == FACTOR_ROTATION; i++)
    {
        double end[4];
        const double *before = points + 4 * (i - 1), *way = ways != NULL ? ways + 3 * (i - 1) : NULL;
        bool turned = way != NULL && !isnan(way[0]);
        if (turned)
            quaternion_turn(before, way[0], way[1], way[2], end);
        quaternion_continue(turned ? end : before, points + 4 * i);
    }
}

/// The way from p to q that is nearest to a wanted rotation vector. Returns its distance from that.
static double nearest_way(const double *p, const double *q, const double *wanted, double *way, bool *shortest)
{
    quaternion_step step = quaternion_step_between(p, q);
    double sine = sqrt(step.squared_sine), angle = 2 * atan2(sine, step.cosine), length = sqrt(vector_square(3, wanted));
    bool same = sine < SAME;
    const double axis[] = {same ? wanted[0] : step.x, same ? wanted[1] : step.y, same ? wanted[2] : step.z};
    double scale = same ? length : sine, along = scale > 0 ? vector_dot(3, axis, wanted) / scale : 0;
    double turns = round((along - angle) / ANGLE_TURN), apart = 0;
    for (size_t c = 0; c < 3; c++)
    {
        way[c] = scale > 0 ? (angle + turns * ANGLE_TURN) * axis[c] / scale : 0;
        apart += (way[c] - wanted[c]) * (way[c] - wanted[c]);
    }
    *shortest = turns == 0 && step.cosine > SAME;
    return sqrt(apart);
}

/// The ways that are not the shortest, by what is told of them: turns, or velocities that agree with the keys. NaN for
/// others.
static void find_ways(const bat_hermite_curve *keys, const double *turns, const spline_system *system, double *ways,
                      size_t *turned)
{
    double total = 0, agreed = 0;
    *turned = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < system->intervals; i++)
        {
            size_t next = i + 1 == system->count ? 0 : i + 1;
            const double *p = system->points + 4 * i, *q = system->points + 4 * next,
                         *turn = turns != NULL ? turns + 3 * i : NULL;
            const double *v = system->velocities + 3 * i, *w = system->velocities + 3 * next;
            double *way = ways + 3 * i, wanted[3];
            bool told = turn != NULL && !isnan(turn[0]), moves = keys->tangents != NULL && system->fixed[i] == KEY_GIVEN;
            bool shortest = true, known = told || (moves && system->fixed[next] == KEY_GIVEN);
            for (size_t c = 0; c < 3; c++)
                wanted[c] = told ? turn[c] : system->lengths[i] * (v[c] + w[c]) / 2;
            double apart = known ? nearest_way(p, q, wanted, way, &shortest) : 0;
            bool agrees = known && apart < AGREED;
            total += pass == 0 && known && !told;
            agreed += pass == 0 && agrees && !told;
            // Velocities of another unit or frame agree with few keys.
            bool takes = pass == 1 && !shortest && (told || (agrees && agreed >= MOST_AGREE * total));
            *turned += takes;
            for (size_t c = 0; c < 3 && !takes; c++)
                way[c] = NAN;
        }
}

/// Whether keys can be smoothed.
static bat_status check_sigma(const bat_hermite_curve *keys, const bat_motion_spline_options *options, bat_error *error)
{
    const bat_space *space = keys->space;
    bool rigid = space_is_rigid(space);
    const char *fault = NULL;
    if (!rigid && options->angle_sigma != 0)
        return error_option(error, "angle_sigma", "is of rigid motions, not of the space %s, which takes sigma alone",
                            space->name);
    if (options->sigma == 0 && options->angle_sigma == 0)
        return BAT_OK;
    if (!rigid && !space_is_euclidean(space) && !space_is_rotation(space))
        return ERROR_UNSUPPORTED(error, 0, "sigma is for R^n, rotations and rigid motions, not for the space %s",
                                 space->name);
    if (keys->closed)
        fault = "sigma does not go with closed motions";
    if (keys->tangents != NULL)
        fault = "sigma does not go with given velocities";
    return fault == NULL ? BAT_OK : ERROR_UNSUPPORTED(error, 0, "%s", fault);
}

/// The sigma of a factor of a space.
static double sigma_of(const bat_motion_spline *spline, const bat_motion_spline_options *options, size_t index)
{
    return space_is_rigid(&spline->space) && index > 0 ? options->angle_sigma : options->sigma;
}

/// Prepare one factor, whose keys are gathered, and fill its part of the records.
static bat_status prepare_system(spline_system *system, const bat_motion_spline_options *options, bat_motion_spline *spline,
                                 bat_error *error)
{
    const spline_factor *f = system->factor;
    const double *begin = options->begin_velocity, *end = options->end_velocity;
    if (space_is_positive_definite(&f->space))
        return spline_tensor_prepare(system, options->ends, options->shape, begin != NULL ? begin + f->tangent_at : NULL,
                                     end != NULL ? end + f->tangent_at : NULL, spline->records + f->record_at,
                                     spline->record_size, error);
    system->smoothed = sigma_of(spline, options, (size_t)(f - spline->factors)) != 0;
    bool natural = system->smoothed && options->ends == BAT_MOTION_ENDS_AUTO;
    bat_status status =
        spline_system_solve(system, natural ? BAT_MOTION_ENDS_NATURAL : options->ends, options->shape,
                            begin != NULL ? begin + f->tangent_at : NULL, end != NULL ? end + f->tangent_at : NULL, error);
    for (size_t i = 0; i < system->intervals && status == BAT_OK; i++)
        spline_system_record(system, i, spline->records + i * spline->record_size + f->record_at);
    return status;
}

/// Take the velocities of keys that have one: all of its numbers are there.
static bat_status take_velocities(const double *tangents, size_t stride, spline_system *system, bat_error *error)
{
    size_t n = system->factor->space.tangent_dim;
    for (size_t k = 0; k < system->count; k++)
    {
        const double *given = tangents + k * stride;
        size_t unknown = 0;
        for (size_t i = 0; i < n; i++)
            unknown += isnan(given[i]) ? 1 : 0;
        if (unknown > 0 && unknown < n)
            return error_set(error, BAT_INVALID_POINT, k, 0, "a number of the velocity of point %zu is NaN", k);
        if (unknown == n)
            continue;
        system->fixed[k] = KEY_GIVEN;
        memcpy(system->velocities + k * n, given, n * sizeof *given);
    }
    return BAT_OK;
}

static bat_status prepare_factor(const bat_hermite_curve *keys, const bat_motion_spline_options *options, size_t index,
                                 const double *lengths, bat_motion_spline *spline, bat_error *error)
{
    const spline_factor *f = &spline->factors[index];
    size_t dim = f->space.point_dim, n = f->space.tangent_dim, all = spline->space.point_dim;
    spline_system system = {.factor = f, .count = spline->count, .intervals = spline->intervals, .lengths = lengths};
    double *points = memory_pool_array(&system.pool, spline->count, dim * sizeof *points);
    double *ways = f->kind == FACTOR_ROTATION ? memory_pool_array(&system.pool, spline->intervals, 3 * sizeof *ways) : NULL;
    system.points = points;
    bat_status status = spline_system_allocate(&system, error);
    if (status == BAT_OK)
    {
        gather(keys->points, spline->count, all, f->point_at, dim, points);
        continue_signs(f, spline->count, points, NULL);
        double sigma = sigma_of(spline, options, index);
        if (sigma != 0)
        {
            // The velocities and slopes are found later: their memory holds the uncertainties here.
            memset(system.slopes, 0, spline->intervals * 2 * n * sizeof *system.slopes);
            status = spline_smooth(f, spline->count, lengths, options->outliers, points, &sigma, spline->deviations,
                                   system.velocities, system.slopes, error);
            scatter(system.slopes, spline->intervals, spline->space.tangent_dim, f->tangent_at, n, spline->wander);
            spline->sigmas[space_is_rigid(&spline->space) && index > 0] = sigma;
            scatter(system.velocities, spline->count, spline->space.tangent_dim, f->tangent_at, n, spline->uncertainties);
            continue_signs(f, spline->count, points, NULL);
        }
        memset(system.velocities, 0, spline->count * n * sizeof *system.velocities);
        if (keys->tangents != NULL && status == BAT_OK)
            status = take_velocities(keys->tangents + f->tangent_at, spline->space.tangent_dim, &system, error);
        if (ways != NULL && status == BAT_OK)
        {
            size_t turned;
            find_ways(keys, options->turns, &system, ways, &turned);
            continue_signs(f, spline->count, points, ways);
            system.ways = turned > 0 ? ways : NULL;
            spline->turned += turned;
        }
        scatter(points, spline->count, all, f->point_at, dim, spline->points);
        if (status == BAT_OK)
            status = prepare_system(&system, options, spline, error);
    }
    spline->held += system.held;
    if (status == BAT_OK)
        scatter(system.velocities, spline->count, spline->space.tangent_dim, f->tangent_at, n, spline->velocities);
    memory_pool_free(&system.pool);
    return status;
}

/// The times of the keys, and the lengths of intervals.
static bat_status take_times(const bat_hermite_curve *keys, bat_motion_spline *spline, double *lengths, bat_error *error)
{
    for (size_t i = 0; i < keys->count; i++)
        spline->times[i] = keys->times != NULL ? keys->times[i] : (double)i;
    if (keys->closed)
        spline->times[keys->count] = spline->times[keys->count - 1] + (keys->times != NULL ? keys->closing_time : 1);
    for (size_t i = 0; i < spline->intervals; i++)
    {
        lengths[i] = spline->times[i + 1] - spline->times[i];
        double square = lengths[i] * lengths[i];
        if (!(lengths[i] > 0 && isfinite(square) && isfinite(1 / square)))
            return error_set(error, BAT_INVALID_ARGUMENT, i + 1, 0, "the time from point %zu to the next, %.10g, is too %s",
                             i, lengths[i], lengths[i] > 1 ? "long" : "short");
    }
    return BAT_OK;
}

/// The part of the range with a time, which is in the range.
static size_t bucket_of(const bat_motion_spline *spline, double time)
{
    double part = (time - spline->times[0]) * spline->bucket_rate;
    return part < (double)(PARTS * spline->intervals) ? (size_t)part : PARTS * spline->intervals - 1;
}

/// Each bucket holds the interval of the first key's part: a time of part b lies in intervals buckets[b] to buckets[b + 1].
static void fill_buckets(bat_motion_spline *spline)
{
    size_t n = spline->intervals, filled = 0;
    spline->bucket_rate = (double)(PARTS * n) / (spline->times[n] - spline->times[0]);
    if (!isfinite(spline->bucket_rate))
        spline->bucket_rate = 0;
    // Interval i begins in part bucket_of(i): later parts begin in interval i or after it.
    for (size_t i = 0; i < n; i++)
    {
        size_t part = bucket_of(spline, spline->times[i]);
        for (; filled <= part; filled++)
            spline->buckets[filled] = i > 0 ? i - 1 : 0;
    }
    for (; filled <= PARTS * n; filled++)
        spline->buckets[filled] = n - 1;
}

// Evaluation

static bool is_closed(const bat_motion_spline *spline)
{
    return spline->intervals == spline->count;
}

/// The interval of a time: the later one at a key, but the last one at the end. `hint` is tried first.
static size_t find_interval(const bat_motion_spline *spline, double time, size_t hint)
{
    const double *times = spline->times;
    if (times[hint] <= time && time < times[hint + 1])
        return hint;
    size_t part = bucket_of(spline, time), low = spline->buckets[part], high = spline->buckets[part + 1];
    if (high - low <= 1) // without a branch on the time, which a processor cannot predict
        return low + (size_t)((high > low) & (times[high] <= time));
    return bisect_reals(times, low, high + 1, time);
}

/// Where a time is on the motion.
typedef struct place
{
    size_t interval;
    double share;
    double beyond; ///< how long the time is before the first key (negative) or after the last
    double rate;   ///< within limits: the derivative of the share by time
    double slope;  ///< and its second derivative
} place;

/// Find the share of a time that is in an interval.
static void find_share(const bat_motion_spline *spline, double time, place *at)
{
    if (spline->limited)
    {
        at->share = spline_timing_share(&spline->timing, at->interval, time, &at->rate, &at->slope);
        return;
    }
    double from = spline->times[at->interval];
    at->share = (time - from) / (spline->times[at->interval + 1] - from);
}

/// @return false when the time is not finite or not on the motion
static bool find_place(const bat_motion_spline *spline, double time, size_t hint, place *found)
{
    double begin = spline->times[0], end = spline->times[spline->intervals];
    found->beyond = 0;
    if (!(time >= begin && time <= end))
    {
        if (!isfinite(time) || (!is_closed(spline) && !spline->extrapolate))
            return false;
        if (is_closed(spline))
        {
            double since = fmod(time - begin, end - begin);
            time = begin + (since < 0 ? since + (end - begin) : since);
            time = time > end ? begin : time;
        }
        else
        {
            found->beyond = time < begin ? time - begin : time - end;
            time = time < begin ? begin : end;
        }
    }
    found->interval = find_interval(spline, time, hint);
    find_share(spline, time, found);
    return true;
}

static bat_status no_place(const bat_motion_spline *spline, double time, size_t index, bat_error *error)
{
    bat_motion_keys keys = bat_motion_spline_keys(spline);
    char digits[3][NUMBER_DIGITS_SIZE];
    (void)error_set(error, BAT_INVALID_ARGUMENT, index, 0, "time %s is not within those of the motion, %s to %s",
                    number_digits(time, digits[0]), number_digits(keys.begin, digits[1]),
                    number_digits(keys.end, digits[2]));
    return error_remedy(error, BAT_INVALID_ARGUMENT, "extrapolate", "goes on with constant velocity");
}

/// Beyond the keys: the geodesic from the nearest one with its velocity.
static bat_status extrapolate(const bat_motion_spline *spline, const place *at, double *point, double *velocity,
                              double *acceleration)
{
    const bat_space *space = &spline->space;
    size_t key = at->beyond < 0 ? 0 : spline->count - 1;
    const double *p = spline->points + key * space->point_dim, *v = spline->velocities + key * space->tangent_dim;
    double way[BAT_SPACE_MAX_DIM];
    for (size_t c = 0; c < space->tangent_dim; c++)
        way[c] = at->beyond * v[c];
    bat_status status = space->exp(space, p, way, point);
    if (status == BAT_OK && acceleration != NULL)
        memset(acceleration, 0, space->tangent_dim * sizeof *acceleration);
    if (status != BAT_OK || velocity == NULL)
        return status;
    // Transport from p would take the shortest way; the direction back to p is that of the way.
    for (size_t i = 0; i < spline->factor_count && status == BAT_OK; i++)
    {
        const spline_factor *f = &spline->factors[i];
        double *rate = velocity + f->tangent_at;
        if (f->kind == FACTOR_FLAT || f->kind == FACTOR_ROTATION)
            memcpy(rate, v + f->tangent_at, f->space.tangent_dim * sizeof *rate);
        else
            status = f->space.transport(&f->space, p + f->point_at, point + f->point_at, v + f->tangent_at, rate);
    }
    return status;
}

/// Keys themselves at their times, bit for bit.
static void copy_key(const bat_motion_spline *spline, const place *at, double *point, double *velocity)
{
    if (at->share != 0 && at->share != 1)
        return;
    size_t key = at->interval + (at->share == 1), dim = spline->space.point_dim, n = spline->space.tangent_dim;
    key = key == spline->count ? 0 : key;
    memcpy(point, spline->points + key * dim, dim * sizeof *point);
    if (velocity != NULL)
        memcpy(velocity, spline->velocities + key * n, n * sizeof *velocity);
}

/// BAT_INVALID_POINT where a coordinate is not finite.
static bat_status check_finite(const double *points, size_t count)
{
    int bad = 0;
    for (size_t i = 0; i < count; i++)
        bad |= !isfinite(points[i]);
    return bad ? BAT_INVALID_POINT : BAT_OK;
}

static bat_status evaluate(const bat_motion_spline *spline, const place *at, double *point, double *velocity,
                           double *acceleration)
{
    if (at->beyond != 0)
    {
        bat_status status = extrapolate(spline, at, point, velocity, acceleration);
        return status == BAT_OK ? check_finite(point, spline->space.point_dim) : status;
    }
    const double *record = spline->records + at->interval * spline->record_size;
    double made[BAT_SPACE_MAX_DIM], slope = spline->limited ? at->slope : 0;
    double rate = spline->limited ? at->rate : 1 / (spline->times[at->interval + 1] - spline->times[at->interval]);
    if (velocity == NULL && acceleration != NULL && slope != 0)
        velocity = made;
    for (size_t i = 0; i < spline->factor_count; i++)
    {
        const spline_factor *f = &spline->factors[i];
        bat_status status = spline_factor_at(f, record + f->record_at, at->share, point + f->point_at,
                                             velocity != NULL ? velocity + f->tangent_at : NULL,
                                             acceleration != NULL ? acceleration + f->tangent_at : NULL);
        if (status != BAT_OK)
            return status;
    }
    for (size_t c = 0; acceleration != NULL && c < spline->space.tangent_dim; c++)
        acceleration[c] = rate * rate * acceleration[c] + (slope != 0 ? slope * velocity[c] : 0);
    if (velocity != NULL)
        vector_scale(spline->space.tangent_dim, rate, velocity);
    copy_key(spline, at, point, velocity);
    return check_finite(point, spline->space.point_dim);
}

static bat_status leaves_space(const bat_motion_spline *spline, bat_status status, double time, size_t index,
                               bat_error *error)
{
    char digits[NUMBER_DIGITS_SIZE];
    return error_set(error, status, index, 0, "the motion leaves the space %s at time %s (%s)", spline->space.name,
                     number_digits(time, digits), bat_status_name(status));
}

bat_status bat_motion_spline_at(const bat_motion_spline *spline, double time, double *point, double *velocity,
                                double *acceleration, bat_error *error)
{
    place at;
    if (!find_place(spline, time, 0, &at))
        return no_place(spline, time, BAT_NO_INDEX, error);
    bat_status status = evaluate(spline, &at, point, velocity, acceleration);
    return status == BAT_OK ? BAT_OK : leaves_space(spline, status, time, BAT_NO_INDEX, error);
}

/// Points at up to SPLINE_RUN places, of one interval or of several.
static bat_status evaluate_run(const bat_motion_spline *spline, bool mixed, const uint32_t *intervals, const double *shares,
                               size_t count, double *points)
{
    size_t dim = spline->space.point_dim, size = spline->record_size;
    for (size_t i = 0; i < spline->factor_count; i++)
    {
        const spline_factor *f = &spline->factors[i];
        const double *records = spline->records + f->record_at;
        double *to = points + f->point_at;
        bat_status status = mixed ? spline_factor_mixed(f, records, size, intervals, shares, count, to, dim)
                                  : spline_factor_run(f, records + *intervals * size, shares, count, to, dim);
        if (status != BAT_OK)
            return status;
    }
    for (size_t j = 0; j < count; j++)
        copy_key(spline, &(place){.interval = intervals[j], .share = shares[j]}, points + j * dim, NULL);
    return check_finite(points, count * dim);
}

/// Points alone of up to SPLINE_RUN times, those of an interval together where they follow each other. False where they must
/// be found one by one.
static bool sample_run(const bat_motion_spline *spline, const double *times, size_t count, place *at, double *points)
{
    uint32_t intervals[SPLINE_RUN];
    double shares[SPLINE_RUN];
    size_t runs = 1;
    for (size_t i = 0; i < count; i++)
    {
        if (times[i] >= spline->times[at->interval] && times[i] < spline->times[at->interval + 1])
            find_share(spline, times[i], at);
        else if (!find_place(spline, times[i], at->interval, at) || at->beyond != 0 || at->interval > UINT32_MAX)
            return false;
        intervals[i] = (uint32_t)at->interval;
        shares[i] = at->share;
        if (i > 0 && intervals[i] == intervals[i - 1])
            continue;
        runs += i > 0;
        for (size_t k = 0; k < spline->record_size; k += CACHE_LINE)
            __builtin_prefetch(spline->records + at->interval * spline->record_size + k);
    }
    bool mixed = MIN_RUN * runs > count, done = true;
    for (size_t i = 0, next = 0; i < count && done; i = next)
    {
        while (next < count && (mixed || intervals[next] == intervals[i]))
            next++;
        done =
            evaluate_run(spline, mixed, intervals + i, shares + i, next - i, points + i * spline->space.point_dim) == BAT_OK;
    }
    return done;
}

/// Evaluate times `begin` to `end`.
static bat_status sample_block(const bat_motion_spline *spline, const double *times, size_t begin, size_t end,
                               double *points, double *velocities, double *accelerations, bat_error *error)
{
    size_t dim = spline->space.point_dim, n = spline->space.tangent_dim;
    place at = {0};
    size_t done = begin;
    for (size_t run = SPLINE_RUN; velocities == NULL && accelerations == NULL && done < end; done += run)
    {
        run = end - done < run ? end - done : run;
        if (!sample_run(spline, times + done, run, &at, points + done * dim))
            break;
    }
    for (size_t i = done; i < end; i++)
    {
        if (!find_place(spline, times[i], at.interval, &at))
            return no_place(spline, times[i], i, error);
        bat_status status = evaluate(spline, &at, points + i * dim, velocities != NULL ? velocities + i * n : NULL,
                                     accelerations != NULL ? accelerations + i * n : NULL);
        if (status != BAT_OK)
            return leaves_space(spline, status, times[i], i, error);
    }
    return BAT_OK;
}

bat_status bat_motion_spline_sample(const bat_motion_spline *spline, const double *times, size_t count, double *points,
                                    double *velocities, double *accelerations, bat_error *error)
{
    shared_work work = shared_work_make((count + BLOCK - 1) / BLOCK, (bat_progress){0});
    int threads = threads_worth(spline->threads, work.total, (double)OPERATIONS * (double)count);
    if (work.total == 1) // without what a team costs
        return sample_block(spline, times, 0, count, points, velocities, accelerations, error);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (size_t block = 0; block < work.total; block++)
    {
        if (!shared_work_wants(&work, block))
            continue;
        bat_error fault;
        size_t begin = block * BLOCK, end = count - begin < BLOCK ? count : begin + BLOCK;
        bat_status status = sample_block(spline, times, begin, end, points, velocities, accelerations, &fault);
        shared_work_finish(&work, block, status, &fault);
    }
    return shared_work_end(&work, error);
}

bat_status bat_motion_spline_uncertainty(const bat_motion_spline *spline, const double *times, size_t count,
                                         double *deviations, bat_error *error)
{
    size_t n = spline->space.tangent_dim, last = spline->count - 1, hint = 0;
    for (size_t i = 0; i < count; i++)
    {
        place at;
        if (!find_place(spline, times[i], hint, &at) || at.beyond != 0)
            return no_place(spline, times[i], i, error);
        hint = at.interval;
        size_t next = at.interval < last ? at.interval + 1 : 0;
        double s = at.share, r = 1 - s, between = 64 * s * s * s * r * r * r; // 1 in the middle
        for (size_t c = 0; c < n; c++)
        {
            double ends = r * spline->uncertainties[at.interval * n + c] + s * spline->uncertainties[next * n + c];
            deviations[i * n + c] = sqrt(ends * ends + between * spline->wander[at.interval * n + c]);
        }
    }
    return BAT_OK;
}

// Limits

/// The squares of velocities and accelerations of the path by its old times.
static bat_status rates_at(const void *context, size_t interval, double share, timing_rates rates[TIMING_PARTS])
{
    const bat_motion_spline *spline = context;
    const bat_space *space = &spline->space;
    double point[BAT_SPACE_MAX_DIM], v[BAT_SPACE_MAX_DIM], a[BAT_SPACE_MAX_DIM];
    bat_status status = evaluate(spline, &(place){.interval = interval, .share = share}, point, v, a);
    rates[0] = rates[1] = (timing_rates){0};
    for (size_t at = 0; space_is_rigid(space) && at < 6; at += 3)
        rates[at / 3] = (timing_rates){vector_square(3, v + at), vector_dot(3, v + at, a + at), vector_square(3, a + at)};
    if (!space_is_rigid(space) && status == BAT_OK)
        rates[0] = (timing_rates){space->inner(space, point, v, v), space->inner(space, point, v, a),
                                  space->inner(space, point, a, a)};
    return status;
}

/// Replace the times by the fastest ones within the limits.
static bat_status limit_times(bat_motion_spline *spline, const bat_motion_spline_options *options, bat_error *error)
{
    const timing_limits limits = {{options->max_speed, options->max_angular_speed},
                                  {options->max_acceleration, options->max_angular_acceleration}};
    bool turns = limits.speed[1] > 0 || limits.acceleration[1] > 0;
    if (turns && !space_is_rigid(&spline->space))
        return error_option(error, limits.speed[1] > 0 ? "max_angular_speed" : "max_angular_acceleration",
                            "is of rigid motions, not of the space %s", spline->space.name);
    if (!turns && limits.speed[0] == 0 && limits.acceleration[0] == 0)
        return BAT_OK;
    size_t n = spline->space.tangent_dim;
    timing_path path = {spline->intervals, is_closed(spline), spline->times, rates_at, spline};
    bat_status status = spline_timing_make(&path, &limits, &spline->pool, &spline->timing, error);
    if (status != BAT_OK)
        return status;
    for (size_t k = 0; k < spline->count; k++)
    {
        size_t i = k < spline->intervals ? k : k - 1;
        double rate, slope, length = spline->times[i + 1] - spline->times[i];
        (void)spline_timing_share(&spline->timing, i, spline->timing.times[k * spline->timing.cells], &rate, &slope);
        vector_scale(n, rate * length, spline->velocities + k * n);
    }
    for (size_t i = 0; i <= spline->intervals; i++)
        spline->times[i] = spline->timing.times[i * spline->timing.cells];
    spline->limited = true;
    fill_buckets(spline);
    return BAT_OK;
}

double spline_time_at(const bat_motion_spline *spline, size_t interval, double share)
{
    double from = spline->times[interval], to = spline->times[interval + 1];
    if (spline->limited)
        return spline_timing_time(&spline->timing, interval, share);
    return share == 0 ? from : from + (to - from) * share;
}

// Gyroscopes

/// Translations of rigid motions at times, with velocities and standard deviations of columns 0 to 3: the path that forces
/// tell, and a spline through what the keys are away from it.
static bat_status move_between(const bat_hermite_curve *keys, const bat_motion_spline_options *options,
                               const gyro_fusion *fused, bat_hermite_curve *made, double *deviations, double *sigma,
                               bat_motion_force_report *force, bat_error *error)
{
    const bat_space space = bat_euclidean(3);
    bat_motion_spline_options how = *options;
    how.angle_sigma = how.max_speed = how.max_acceleration = how.max_angular_speed = how.max_angular_acceleration = 0;
    how.outliers = how.sigma != 0 ? how.outliers : BAT_MOTION_OUTLIERS_NONE;
    how.turns = how.begin_velocity = how.end_velocity = NULL;
    how.ends = how.ends == BAT_MOTION_ENDS_CLAMPED ? BAT_MOTION_ENDS_AUTO : how.ends;
    how.gyro = NULL;
    size_t numbers = 3 * keys->count;
    double *rows = memory_array(4 * numbers, sizeof *rows), *path = calloc(fused->count, 6 * sizeof *path);
    bat_status status = rows != NULL && path != NULL ? BAT_OK : error_memory(error, fused->count * 6 * sizeof *path);
    force_rest rest = {rows + numbers, rows + 2 * numbers, rows + 3 * numbers, 0};
    if (status == BAT_OK)
        gather(keys->points, keys->count, 7, 0, 3, rows);
    if (status == BAT_OK && options->gyro->forces != NULL)
        status = force_path(fused, options->gyro, keys->times, rows, keys->count, how.sigma, path, &rest, force, error);
    bool settled = status == BAT_OK && force->used && how.sigma != 0 && how.outliers == BAT_MOTION_OUTLIERS_NONE;
    if (settled)
    {
        memcpy(rows, rest.keys, numbers * sizeof *rows);
        how.sigma = 0;
    }
    for (size_t i = 0, key = 0; status == BAT_OK && !settled && i < fused->count && key < keys->count; i++)
        if (fused->times[i] == keys->times[key])
        {
            vector_add(3, -1, path + 6 * i, rows + 3 * key);
            key++;
        }
    bat_hermite_curve moved = {.space = &space, .points = rows, .times = keys->times, .count = keys->count};
    bat_motion_spline *spline = NULL;
    if (status == BAT_OK)
        status = bat_motion_spline_make(&moved, &how, &spline, error);
    if (status == BAT_OK && settled)
    {
        memcpy(spline->uncertainties, rest.deviations, numbers * sizeof *rows);
        memcpy(spline->wander, rest.wander, numbers * sizeof *rows);
        spline->sigmas[0] = rest.sigma;
    }
    for (size_t i = 0; i < fused->count && status == BAT_OK; i++)
    {
        double *point = made->points + 7 * i, *velocity = made->tangents + 6 * i;
        status = bat_motion_spline_at(spline, fused->times[i], point, velocity, NULL, error);
        if (status == BAT_OK)
            status = bat_motion_spline_uncertainty(spline, &fused->times[i], 1, deviations + 6 * i, error);
        for (size_t c = 0; c < 3; c++)
        {
            point[c] += path[6 * i + c];
            velocity[c] += path[6 * i + 3 + c];
        }
    }
    free(rows);
    free(path);
    *sigma = spline != NULL ? spline->sigmas[0] : 0;
    bat_motion_spline_free(spline);
    return status;
}

/// The spline through fused rotations, and through translations at the same times.
static bat_status make_fused(const bat_hermite_curve *keys, const bat_motion_spline_options *options,
                             bat_motion_spline **spline, bat_error *error)
{
    bool rigid = space_is_rigid(keys->space);
    size_t dim = keys->space->point_dim, n = keys->space->tangent_dim, count = keys->count;
    const char *fault = !rigid && !space_is_rotation(keys->space) ? "is for rotations and rigid motions"
                        : keys->closed                            ? "does not go with closed motions"
                        : keys->tangents != NULL                  ? "does not go with given velocities"
                                                                  : NULL;
    if (fault != NULL)
        return error_option(error, "gyro", "%s", fault);
    gyro_fusion fused = {0};
    memory_pool pool = {0};
    double *times = memory_pool_array(&pool, count, sizeof *times),
           *rotations = memory_pool_array(&pool, count, 4 * sizeof *rotations);
    bat_status status = memory_pool_check(&pool, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        times[i] = keys->times != NULL ? keys->times[i] : (double)i;
    if (status == BAT_OK)
    {
        gather(keys->points, count, dim, dim - 4, 4, rotations);
        status =
            gyro_fuse(times, rotations, count, options->gyro, rigid ? options->angle_sigma : options->sigma, &fused, error);
    }
    bat_hermite_curve given = *keys, made = {.space = keys->space, .times = fused.times, .count = fused.count};
    double *deviations = memory_pool_zeros(&pool, fused.count + 1, n * sizeof *deviations), sigma = 0;
    bat_motion_force_report force = {0};
    given.times = times;
    made.points = memory_pool_array(&pool, fused.count + 1, dim * sizeof(double));
    made.tangents = memory_pool_array(&pool, fused.count + 1, n * sizeof(double));
    if (status == BAT_OK)
        status = memory_pool_check(&pool, error);
    if (status == BAT_OK && rigid)
        status = move_between(&given, options, &fused, &made, deviations, &sigma, &force, error);
    bat_motion_spline_options how = *options;
    how.sigma = how.angle_sigma = 0;
    how.outliers = BAT_MOTION_OUTLIERS_NONE;
    how.turns = NULL;
    how.gyro = NULL;
    for (size_t i = 0; i < fused.count && status == BAT_OK; i++)
    {
        memcpy(made.points + i * dim + dim - 4, fused.rotations + 4 * i, 4 * sizeof(double));
        for (size_t c = n - 3; c < n; c++)
        {
            made.tangents[i * n + c] = NAN;
            deviations[i * n + c] = fused.deviations[i];
        }
    }
    if (status == BAT_OK)
        status = bat_motion_spline_make(&made, &how, spline, error);
    if (status == BAT_OK)
    {
        memcpy((*spline)->uncertainties, deviations, fused.count * n * sizeof *deviations);
        (*spline)->gyro = fused.report;
        (*spline)->force = force;
        (*spline)->sigmas[0] = rigid ? sigma : fused.report.sigma;
        (*spline)->sigmas[1] = rigid ? fused.report.sigma : 0;
    }
    memory_pool_free(&fused.pool);
    memory_pool_free(&pool);
    return status;
}

bat_status bat_motion_spline_make(const bat_hermite_curve *keys, const bat_motion_spline_options *options,
                                  bat_motion_spline **spline, bat_error *error)
{
    bat_motion_spline_options defaults = bat_motion_spline_defaults();
    bat_status status = bat_options_check(&bat_motion_spline_fields, options, error);
    if (status == BAT_OK)
        status = check_keys(keys, error);
    options = options != NULL ? options : &defaults;
    if (status == BAT_OK)
        status = check_sigma(keys, options, error);
    if (status != BAT_OK || options->gyro != NULL)
        return status != BAT_OK ? status : make_fused(keys, options, spline, error);
    bat_motion_spline *made = calloc(1, sizeof *made);
    double *lengths = memory_array(keys->count, sizeof *lengths);
    status = made != NULL && lengths != NULL ? BAT_OK : error_memory(error, keys->count * sizeof *lengths);
    if (status == BAT_OK)
    {
        made->space = *keys->space;
        made->count = keys->count;
        made->intervals = keys->closed ? keys->count : keys->count - 1;
        made->extrapolate = options->extrapolate;
        made->threads = options->threads;
        status = allocate(keys, made, error);
    }
    if (status == BAT_OK)
        status = take_times(keys, made, lengths, error);
    if (status == BAT_OK)
        fill_buckets(made);
    for (size_t i = 0; status == BAT_OK && i < made->factor_count; i++)
        status = prepare_factor(keys, options, i, lengths, made, error);
    if (status == BAT_OK)
        status = limit_times(made, options, error);
    free(lengths);
    if (status == BAT_OK)
        *spline = made;
    else
        bat_motion_spline_free(made);
    return status;
}

bat_motion_keys bat_motion_spline_keys(const bat_motion_spline *spline)
{
    return (bat_motion_keys){.space = &spline->space,
                             .count = spline->count,
                             .begin = spline->times[0],
                             .end = spline->times[spline->intervals],
                             .times = spline->times,
                             .points = spline->points,
                             .velocities = spline->velocities,
                             .deviations = spline->deviations,
                             .uncertainties = spline->uncertainties,
                             .sigma = spline->sigmas[0],
                             .angle_sigma = spline->sigmas[1],
                             .held = spline->held,
                             .gyro = spline->gyro,
                             .force = spline->force,
                             .turned = spline->turned};
}
