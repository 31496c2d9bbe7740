#include "batten/motion.h"
#include "base/choice.h"
#include "base/error.h"
#include "base/number_digits.h"
#include "base/option.h"
#include "curve/curve_attributes.h"
#include "curve/polygon.h"
#include "motion/hermite_average.h"
#include "motion/spline_system.h"
#include "space/builtin.h"
#include "space/quaternion.h"

#include <float.h>
#include <inttypes.h>
#include <string.h>

static const bat_choice METHODS[] = {
    CHOICE("auto", "spline where there are times or a rate, else hermite", BAT_MOTION_METHOD_AUTO),
    CHOICE("spline", "a motion in time through its keys", BAT_MOTION_METHOD_SPLINE),
    CHOICE("hermite", "a Hermite scheme, level by level", BAT_MOTION_METHOD_HERMITE),
};
const bat_family bat_motion_method_family = FAMILY("method of motions", METHODS);

bat_motion_curves_options bat_motion_curves_defaults(void)
{
    return (bat_motion_curves_options){.spline = bat_motion_spline_defaults(), .scheme = bat_hermite_refine_defaults()};
}

/// The form in which the points and velocities of a set are written.
static const point_form *form_of(const bat_curve_set *set)
{
    const point_form *form = set->attributes != NULL ? set->attributes->form : NULL;
    return form != NULL ? form : point_form_first(set->space->name, set->space->point_dim);
}

/// Whether a set has no names for columns of times and velocities: GeoJSON has no columns at all.
static bool is_nameless(const bat_curve_set *set)
{
    const bat_curve_attributes *attributes = set->attributes;
    if (attributes != NULL && (attributes_are_geojson(attributes) || attributes->degrees))
        return attributes_are_geojson(attributes);
    return form_of(set) == NULL;
}

static motion_channels channels_of(const bat_curve_set *set)
{
    const bat_curve_attributes *attributes = set->attributes;
    if (attributes == NULL || attributes->channel_count != set->curves[0].channel_count)
        return (motion_channels){.time = BAT_NO_INDEX};
    return attributes->channels;
}

/// Whether velocities are there for all parts of poses.
static bool has_whole_velocities(const motion_channels *channels)
{
    size_t whole = 0;
    while (whole < channels->velocity_count && channels->velocity[whole] != BAT_NO_INDEX)
        whole++;
    return whole == channels->velocity_count;
}

bool bat_motion_has_times(const bat_curve_set *set)
{
    return channels_of(set).time != BAT_NO_INDEX;
}

bool bat_motion_has_velocities(const bat_curve_set *set)
{
    return channels_of(set).velocity_count > 0;
}

bat_motion_method bat_motion_method_for(const bat_curve_set *set, const bat_motion_curves_options *options)
{
    if (options != NULL && options->rate > 0)
        return BAT_MOTION_METHOD_SPLINE;
    if (options != NULL && options->method != BAT_MOTION_METHOD_AUTO)
        return options->method;
    if (options != NULL && options->scheme.order != 1)
        return BAT_MOTION_METHOD_HERMITE;
    bool timed = bat_motion_has_times(set) || (options != NULL && options->times != NULL);
    return timed ? BAT_MOTION_METHOD_SPLINE : BAT_MOTION_METHOD_HERMITE;
}

bool bat_motion_suits(const bat_curve_set *set)
{
    static const char *const spaces[] = {"rotation", "rigid", "spd"};
    for (size_t i = 0; i < sizeof spaces / sizeof *spaces; i++)
        if (strcmp(set->space->name, spaces[i]) == 0)
            return bat_motion_has_times(set) || bat_motion_has_velocities(set);
    return false;
}

/// Of points relative to the size of a motion, and of times.
static const double ROUNDING = 1e-9;

/// Whether a closed motion ends with its first point again, up to rounding.
static bool repeats_begin(const bat_hermite_curve *keys)
{
    const bat_space *space = keys->space;
    const double *first = keys->points, *last = first + (keys->count - 1) * space->point_dim;
    double apart = 0;
    for (size_t i = 1; i < keys->count; i++)
        apart = fmax(apart, space->distance(space, first, first + i * space->point_dim));
    return keys->closed && keys->count > 3 && space->distance(space, first, last) <= ROUNDING * apart;
}

/// The times of a curve. The time from the last point of a closed one to its first is the rest of the period. Where none is
/// given and the first point comes again, the period is the time between; else it goes on with the mean step.
static bat_status take_times(const bat_curve *curve, size_t channel, double period, bat_hermite_curve *keys,
                             bat_error *error)
{
    for (size_t i = 0; i < keys->count; i++)
    {
        keys->times[i] = channel != BAT_NO_INDEX ? curve->channels[i * curve->channel_count + channel] : (double)i;
        char digits[2][NUMBER_DIGITS_SIZE];
        if (i > 0 && !(keys->times[i] > keys->times[i - 1]))
            return error_set(error, BAT_INVALID_POINT, i, 0, "the time %s does not come after %s",
                             number_digits(keys->times[i], digits[0]), number_digits(keys->times[i - 1], digits[1]));
    }
    if (!keys->closed || keys->count < 2)
        return BAT_OK;
    double span = keys->times[keys->count - 1] - keys->times[0], step = span / (double)(keys->count - 1);
    bool ends = period <= (1 + ROUNDING) * span; // else a key that repeats the first is one as all others
    if (ends && channel != BAT_NO_INDEX && repeats_begin(keys))
    {
        keys->count--;
        period = period > 0 ? period : span;
        span = keys->times[keys->count - 1] - keys->times[0];
    }
    keys->closing_time = period > 0 ? period - span : step;
    return keys->closing_time > 0 ? BAT_OK : error_option(error, "period", "is %g, but the keys last %g", period, span);
}

static bat_status take_velocities(const bat_curve *curve, const point_form *form, const motion_channels *channels,
                                  bat_hermite_curve *keys, bat_error *error)
{
    const bat_space *space = keys->space;
    for (size_t i = 0; i < keys->count; i++)
    {
        double velocity[MAX_VELOCITIES];
        for (size_t j = 0; j < channels->velocity_count; j++)
            velocity[j] = channels->velocity[j] != BAT_NO_INDEX
                              ? curve->channels[i * curve->channel_count + channels->velocity[j]]
                              : NAN;
        if (!point_form_tangent(form, space, keys->points + i * space->point_dim, velocity,
                                keys->tangents + i * space->tangent_dim))
            return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu has no velocities", i);
    }
    return BAT_OK;
}

/// Whether the way from a key to the next is known though they are half a turn apart: the file told it, or both have angular
/// velocities. `*turn` receives what the file told, else NaN.
static bool knows_turn(const bat_curve_set *set, const bat_hermite_curve *keys, bool given, size_t key, double turn[3])
{
    const bat_space *space = keys->space;
    size_t place = quaternion_place(space), n = space->tangent_dim, next = key + 1 < keys->count ? key + 1 : 0;
    turn[0] = turn[1] = turn[2] = NAN;
    if (place == BAT_NO_INDEX)
        return false;
    const double *p = keys->points + key * space->point_dim + place, *q = keys->points + next * space->point_dim + place;
    double dot = quaternion_dot(p, q);
    if (set->attributes != NULL && set->attributes->turned && fabs(dot) < QUATERNION_ABOUT_HALF)
    {
        quaternion_step step = quaternion_step_between(p, q);
        double sign = dot < 0 ? -1 : 1, sine = sqrt(step.squared_sine), angle = 2 * atan2(sine, dot);
        turn[0] = sign * angle * step.x / sine;
        turn[1] = sign * angle * step.y / sine;
        turn[2] = sign * angle * step.z / sine;
        return true;
    }
    size_t last = n - 1; // an angular velocity
    return given && !isnan(keys->tangents[key * n + last]) && !isnan(keys->tangents[next * n + last]);
}

/// Neighbours must have one shortest geodesic, and be distinct where distance is the parameter. Names both lines.
static bat_status check_neighbours(const bat_curve_set *set, size_t curve, const bat_hermite_curve *keys, bool splined,
                                   bool given, bool distinct, bat_error *error)
{
    const bat_space *space = keys->space;
    double turn[3];
    double log[BAT_SPACE_MAX_DIM];
    for (size_t i = keys->closed ? 0 : 1; i < keys->count; i++)
    {
        size_t before = i > 0 ? i - 1 : keys->count - 1;
        const double *p = keys->points + before * space->point_dim, *q = keys->points + i * space->point_dim;
        bool repeats = distinct && !(space->distance(space, p, q) > 0);
        bool unique = repeats || space->log(space, p, q, log) == BAT_OK;
        if (!repeats && (unique || (splined && knows_turn(set, keys, given, before, turn))))
            continue;
        size_t lines[] = {bat_curve_set_line(set, curve, before), bat_curve_set_line(set, curve, i)};
        char where[64] = "";
        if (lines[0] > 0 && lines[1] > 0)
            (void)snprintf(where, sizeof where, " (lines %zu and %zu)", lines[0], lines[1]);
        if (repeats)
            return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu repeats point %zu%s", i, before, where);
        return error_set(error, BAT_CUT_LOCUS, i, 0, "points %zu and %zu%s %s", before, i, where,
                         quaternion_place(space) != BAT_NO_INDEX
                             ? "are half a turn apart: the way to turn is not unique, and no angular "
                               "velocities, rotation vectors or roll, pitch and yaw "
                               "tell it"
                             : "have no unique shortest geodesic");
    }
    return BAT_OK;
}

/// Let angles go the shorter way from key to key. Those that make whole rounds in a period lose their mean velocity, the
/// drift, after which they return: a spline of the rest and the drift together is that of the angles.
/// @param drift receives point_dim numbers
static bat_status unwrap(double turn, bat_hermite_curve *keys, double *drift, bat_error *error)
{
    size_t n = keys->space->point_dim;
    memset(drift, 0, n * sizeof *drift);
    if (turn > 0 && !space_is_euclidean(keys->space))
        return error_option(error, "wrap", "is for numbers, not for the space %s", keys->space->name);
    for (size_t i = n; turn > 0 && i < keys->count * n; i++)
        keys->points[i] -= turn * round((keys->points[i] - keys->points[i - n]) / turn);
    const double *last = keys->points + (keys->count - 1) * n;
    for (size_t c = 0; turn > 0 && keys->closed && keys->times != NULL && c < n; c++)
        drift[c] = turn * round((last[c] - keys->points[c]) / turn) /
                   (keys->times[keys->count - 1] - keys->times[0] + keys->closing_time);
    return BAT_OK;
}

static bool has_drift(const bat_space *space, const double *drift)
{
    return vector_square(space->point_dim, drift) > 0;
}

/// Add the drift from a time on, with a sign, to points and to velocities where there are some.
static void add_drift(bat_hermite_curve *curve, const double *drift, double begin, double sign)
{
    size_t n = curve->space->point_dim;
    for (size_t i = 0; has_drift(curve->space, drift) && i < curve->count * n; i++)
    {
        curve->points[i] += sign * drift[i % n] * (curve->times[i / n] - begin);
        if (curve->tangents != NULL)
            curve->tangents[i] += sign * drift[i % n];
    }
}

/// Bring angles back into the range of the given ones.
static void wrap(const bat_curve *given, double turn, bat_hermite_curve *smooth)
{
    size_t n = smooth->space->point_dim;
    double low = 0;
    for (size_t i = 0; i < given->count * n; i++)
        low = given->points[i] < 0 ? -turn / 2 : low;
    for (size_t i = 0; i < smooth->count * n; i++)
        smooth->points[i] -= turn * floor((smooth->points[i] - low) / turn);
}

/// The order of tangents that are estimated for splines; 0: they solve for them. At a rate a Hermite scheme is a spline.
static size_t order_of(const bat_motion_curves_options *options)
{
    bool hermite = options->method == BAT_MOTION_METHOD_HERMITE && options->rate > 0;
    return hermite && options->tangent_order == 0 ? 2 : options->tangent_order;
}

/// Missing velocities for splines: null where the system of the spline gives them.
static bat_status make_velocities(bat_hermite_curve *keys, size_t order, bat_error *error)
{
    if (order != 0)
        return bat_hermite_estimate_tangents(keys, order, error);
    free(keys->tangents);
    keys->tangents = NULL;
    return BAT_OK;
}

/// Convert velocities to directions for Hermite schemes, or estimate what is missing.
static bat_status make_tangents(bat_hermite_curve *keys, bool given, bat_motion_method method,
                                const bat_motion_curves_options *options, bat_error *error)
{
    double *times = keys->times;
    if (method == BAT_MOTION_METHOD_SPLINE)
        return given ? BAT_OK : make_velocities(keys, order_of(options), error);
    if (given)
        return bat_hermite_normalize(keys, error);
    keys->times = NULL;
    bat_status status = bat_hermite_estimate_tangents(keys, options->tangent_order > 0 ? options->tangent_order : 2, error);
    keys->times = times;
    return status;
}

static bat_status fill_data(const bat_curve_set *set, size_t curve, const bat_motion_curves_options *options,
                            const motion_channels *channels, bat_hermite_curve *keys, double *drift, bat_error *error)
{
    const bat_curve *from = &set->curves[curve];
    bat_motion_method method = bat_motion_method_for(set, options);
    bool splined = method == BAT_MOTION_METHOD_SPLINE && order_of(options) == 0;
    bool given = channels->velocity_count > 0 && (splined || has_whole_velocities(channels));
    memcpy(keys->points, from->points, from->count * from->space->point_dim * sizeof(double));
    bat_status status = keys->times != NULL ? take_times(from, channels->time, options->period, keys, error) : BAT_OK;
    if (status == BAT_OK)
        status = hermite_check_counts(keys, error);
    if (status == BAT_OK)
        status = unwrap(options->wrap, keys, drift, error);
    if (status == BAT_OK && !splined && has_drift(from->space, drift))
        status = error_option(error, "wrap", "turns by whole rounds in a period, which needs splines without an order");
    if (!given)
        memset(keys->tangents, 0, keys->count * from->space->tangent_dim * sizeof *keys->tangents);
    if (status == BAT_OK && given)
        status = take_velocities(from, form_of(set), channels, keys, error);
    if (status == BAT_OK && keys->times != NULL)
        add_drift(keys, drift, keys->times[0], -1);
    if (status == BAT_OK)
        status = check_neighbours(set, curve, keys, splined, given, method == BAT_MOTION_METHOD_HERMITE, error);
    keys->kind = BAT_HERMITE_TANGENTS_VELOCITIES;
    return status == BAT_OK ? make_tangents(keys, given, method, options, error) : status;
}

static bat_status motion_curves_options_check(const void *opaque, bat_error *error)
{
    const bat_motion_curves_options *options = opaque;
    char digits[2][NUMBER_DIGITS_SIZE];
    if (options->tangent_order % 2 == 1)
        return error_option(error, "tangent_order", "is %zu, but must be 0, 2 or 4", options->tangent_order);
    if (options->times == NULL && options->time_count > 0)
        return error_option(error, "time_count", "is %zu, but times is null", options->time_count);
    if (options->times != NULL && (options->time_count == 0 || options->rate > 0))
        return options->rate > 0 ? error_option(error, "times", "and rate exclude each other")
                                 : error_option(error, "time_count", "is 0, but must be at least 1");
    if (options->times != NULL && options->method == BAT_MOTION_METHOD_HERMITE)
        return error_option(error, "times", "go with splines, not with Hermite schemes");
    for (size_t i = 0; i < options->time_count; i++)
        if (!isfinite(options->times[i]) || (i > 0 && !(options->times[i] > options->times[i - 1])))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "time %zu, %s, does not come after %s", i,
                             number_digits(options->times[i], digits[0]),
                             number_digits(i > 0 ? options->times[i - 1] : -INFINITY, digits[1]));
    return BAT_OK;
}

static const option_field FIELDS[] = {
    OPTION_FAMILY(bat_motion_curves_options, method, bat_motion_method_family),
    OPTION_FIELD(bat_motion_curves_options, rate, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_motion_curves_options, period, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_motion_curves_options, wrap, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_motion_curves_options, tangent_order, OPTION_SIZE, 0, 4),
    OPTION_STRUCT(bat_motion_curves_options, spline, bat_motion_spline_fields),
    OPTION_STRUCT(bat_motion_curves_options, scheme, bat_hermite_refine_fields),
};

const bat_options_table bat_motion_curves_fields =
    OPTIONS_TABLE(bat_motion_curves_options, FIELDS, motion_curves_options_check);

/// Whether the options fit the columns of a set.
static bat_status check_columns(const bat_curve_set *set, const bat_motion_curves_options *options,
                                const motion_channels *channels, bat_error *error)
{
    size_t known = motion_channels_count(channels);
    for (size_t i = 0; i < set->count; i++)
        if (set->curves[i].channel_count != known)
            return ERROR_UNSUPPORTED(
                error, 0,
                "motions have points, times and velocities; other columns, here %zu, have no place: a "
                "table of times and points is read (batten curve IN -o TABLE.csv --levels 0 writes one)",
                set->curves[i].channel_count - known);
    bool closed = options->period == 0;
    for (size_t i = 0; i < set->count; i++)
        closed = closed || set->curves[i].closed;
    if (!closed)
        return error_option(error, "period", "is of closed motions, but all are open");
    for (size_t i = 0; i < set->count; i++)
        if (set->curves[i].corners != NULL)
            return ERROR_UNSUPPORTED(error, 0, "motions have no corners: a column of corners has no place");
    bool degrees = set->attributes != NULL && set->attributes->degrees;
    if (options->uncertainty && options->spline.sigma == 0 && options->spline.angle_sigma == 0 &&
        options->spline.gyro == NULL)
        return error_option(error, "uncertainty", "is of smoothed motions: sigma smooths");
    if ((options->velocities || options->uncertainty) && (is_nameless(set) || degrees))
        return ERROR_UNSUPPORTED(error, 0, "files have no columns for velocities in the space %s%s", set->space->name,
                                 degrees ? " in degrees" : "");
    return BAT_OK;
}

/// Hand over a failure, with the line of the point at fault.
static bat_status tell_line(const bat_curve_set *set, size_t curve, bat_status status, const bat_error *fault,
                            bat_error *error)
{
    if (status == BAT_OK || error == NULL)
        return status;
    *error = *fault;
    error->line = fault->index != BAT_NO_INDEX ? bat_curve_set_line(set, curve, fault->index) : 0;
    return status;
}

/// bat_motion_data(), but with null tangents where a spline is to find velocities.
static bat_status take_data(const bat_curve_set *set, size_t curve, const bat_motion_curves_options *options,
                            bat_hermite_curve *keys, double drift[BAT_SPACE_MAX_DIM], bat_error *error)
{
    const bat_curve *from = &set->curves[curve];
    bat_hermite_curve made = {.space = from->space, .count = from->count, .closed = from->closed};
    bat_error fault = {.index = BAT_NO_INDEX};
    motion_channels channels = channels_of(set);
    bat_status status = bat_options_check(&bat_motion_curves_fields, options, &fault);
    if (status == BAT_OK)
        status = check_columns(set, options, &channels, &fault);
    bool timed = channels.time != BAT_NO_INDEX || bat_motion_method_for(set, options) == BAT_MOTION_METHOD_SPLINE;
    if (status == BAT_OK)
        status = hermite_allocate(&made, timed, &fault);
    if (status == BAT_OK)
        status = fill_data(set, curve, options, &channels, &made, drift, &fault);
    if (status == BAT_OK)
        *keys = made;
    else
        bat_hermite_free(&made);
    return tell_line(set, curve, status, &fault, error);
}

static bat_status make_spline(const bat_curve_set *set, size_t curve, const bat_motion_curves_options *options,
                              const bat_hermite_curve *keys, bat_motion_spline **spline, bat_error *error)
{
    bat_error fault;
    bat_motion_spline_options how = options->spline;
    double *turns = NULL;
    if (set->attributes != NULL && set->attributes->turned && how.turns == NULL)
    {
        how.turns = turns = memory_array(keys->count, 3 * sizeof *turns);
        if (turns == NULL)
            return error_memory(error, keys->count * 3 * sizeof *turns);
        for (size_t i = 0; i < keys->count; i++)
            (void)knows_turn(set, keys, false, i, turns + 3 * i);
    }
    bat_status status = bat_motion_spline_make(keys, &how, spline, &fault);
    free(turns);
    return tell_line(set, curve, status, &fault, error);
}

bat_status bat_motion_data(const bat_curve_set *set, size_t curve, const bat_motion_curves_options *options,
                           bat_hermite_curve *keys, bat_error *error)
{
    bat_motion_curves_options defaults = bat_motion_curves_defaults();
    bat_motion_spline *spline;
    bat_hermite_curve made;
    double drift[BAT_SPACE_MAX_DIM];
    options = options != NULL ? options : &defaults;
    bat_status status = take_data(set, curve, options, &made, drift, error);
    if (status == BAT_OK && made.tangents == NULL)
    {
        status = make_spline(set, curve, options, &made, &spline, error);
        if (status == BAT_OK)
        {
            status = array_make(&made.tangents, made.count, made.space->tangent_dim * sizeof(double), error);
            if (status == BAT_OK)
                memcpy(made.tangents, bat_motion_spline_keys(spline).velocities,
                       made.count * made.space->tangent_dim * sizeof(double));
            bat_motion_spline_free(spline);
        }
        if (status != BAT_OK)
            bat_hermite_free(&made);
    }
    if (status == BAT_OK)
    {
        if (made.times != NULL)
            add_drift(&made, drift, made.times[0], 1);
        *keys = made;
    }
    return status;
}

bat_status bat_motion_curve_spline(const bat_curve_set *set, size_t curve, const bat_motion_curves_options *options,
                                   bat_motion_spline **spline, bat_error *error)
{
    bat_motion_curves_options defaults = bat_motion_curves_defaults();
    bat_hermite_curve keys;
    double drift[BAT_SPACE_MAX_DIM];
    options = options != NULL ? options : &defaults;
    if (bat_motion_method_for(set, options) != BAT_MOTION_METHOD_SPLINE)
        return ERROR_UNSUPPORTED(error, 0, "the points get a Hermite scheme, not a spline");
    bat_status status = take_data(set, curve, options, &keys, drift, error);
    if (status != BAT_OK)
        return status;
    status = has_drift(keys.space, drift) ? error_option(error, "wrap", "turns by whole rounds in a period")
                                          : make_spline(set, curve, options, &keys, spline, error);
    bat_hermite_free(&keys);
    return status;
}

/// The columns of the result, and what its curves tell together.
typedef struct result_columns
{
    bat_curve_attributes *attributes;
    const point_form *form; ///< of points and velocities; null without
    motion_channels channels;
    size_t channel_count;
    double squares[2];  ///< see add_conflict()
    double *deviations; ///< of the samples of a curve; null without
} result_columns;

/// The columns of the keyframes where they suffice, else columns in the order times, points, velocities.
static bat_status choose_columns(const bat_curve_set *set, const bat_motion_curves_options *options, result_columns *result,
                                 bat_error *error)
{
    motion_channels given = channels_of(set);
    const point_form *form = form_of(set);
    bool sampled = bat_motion_method_for(set, options) == BAT_MOTION_METHOD_SPLINE;
    bool time_missing = given.time == BAT_NO_INDEX && sampled;
    bool velocities_missing = options->velocities && (given.velocity_count == 0 || !has_whole_velocities(&given));
    *result = (result_columns){set->attributes, form, given, set->curves[0].channel_count, {0}, NULL};
    if (time_missing && is_nameless(set))
        time_missing = false; // rows then follow each other by the rate
    velocities_missing = velocities_missing || options->uncertainty;
    if (!time_missing && !velocities_missing)
    {
        attributes_share(set->attributes);
        return BAT_OK;
    }
    motion_channels wanted = {.time = time_missing || given.time != BAT_NO_INDEX ? 0 : BAT_NO_INDEX};
    wanted.velocity_count = velocities_missing || given.velocity_count > 0 ? form->velocity_count : 0;
    for (size_t i = 0; i < wanted.velocity_count; i++)
        wanted.velocity[i] = (wanted.time == 0) + i;
    size_t columns = wanted.velocity_count + (wanted.time == 0);
    wanted.deviation = options->uncertainty ? columns : 0;
    columns += options->uncertainty ? wanted.velocity_count : 0;
    bat_curve_format format = set->attributes != NULL && set->attributes->format == BAT_CURVE_FORMAT_TUM
                                  ? BAT_CURVE_FORMAT_TUM
                                  : BAT_CURVE_FORMAT_CSV;
    *result = (result_columns){attributes_new(format), form, wanted, columns, {0}, NULL};
    bool good = result->attributes != NULL;
    if (good)
    {
        result->attributes->degrees = set->attributes != NULL && set->attributes->degrees;
        result->attributes->form = result->attributes->degrees ? NULL : form;
        result->attributes->channels = wanted;
        result->attributes->channel_count = result->channel_count;
    }
    if (good && set->attributes != NULL)
    {
        result->attributes->time_origin = set->attributes->time_origin;
        result->attributes->time_decimals = set->attributes->time_decimals;
        memcpy(result->attributes->time_text, set->attributes->time_text, sizeof result->attributes->time_text);
    }
    const char *note;
    for (size_t i = 0; good && (note = bat_curve_set_note(set, i)) != NULL; i++)
        good = attributes_note(result->attributes, "%s", note);
    if (good)
        return BAT_OK;
    attributes_release(result->attributes);
    return error_memory(error, sizeof *result->attributes);
}

static bat_status fill_channels(const bat_hermite_curve *smooth, const result_columns *columns, bat_curve *curve,
                                bat_error *error)
{
    const bat_space *space = smooth->space;
    const motion_channels *places = &columns->channels;
    for (size_t i = 0; i < curve->count; i++)
    {
        double *row = curve->channels + i * curve->channel_count, velocity[MAX_VELOCITIES];
        if (places->time != BAT_NO_INDEX)
            row[places->time] = smooth->times[i];
        if (places->velocity_count > 0 && !point_form_velocity(columns->form, space, smooth->points + i * space->point_dim,
                                                               smooth->tangents + i * space->tangent_dim, velocity))
            return error_set(error, BAT_INVALID_POINT, BAT_NO_INDEX, 0, "new point %zu has no velocity", i);
        for (size_t j = 0; j < places->velocity_count; j++)
            if (places->velocity[j] != BAT_NO_INDEX)
                row[places->velocity[j]] = velocity[j];
        for (size_t j = 0; j < space->tangent_dim && columns->deviations != NULL; j++)
            row[places->deviation + j] = columns->deviations[i * space->tangent_dim + j];
    }
    return BAT_OK;
}

/// Make a curve with channels of Hermite data. The curve takes over the points.
static bat_status make_curve(bat_hermite_curve *smooth, const result_columns *columns, bat_curve *curve, bat_error *error)
{
    size_t dim = smooth->space->point_dim, place = quaternion_place(smooth->space);
    for (size_t i = 1; place != BAT_NO_INDEX && i < smooth->count; i++)
        quaternion_continue(smooth->points + (i - 1) * dim + place, smooth->points + i * dim + place);
    *curve = (bat_curve){
        .space = smooth->space, .count = smooth->count, .closed = smooth->closed, .channel_count = columns->channel_count};
    if (curve->channel_count > 0)
    {
        if (array_make(&curve->channels, curve->count, curve->channel_count * sizeof(double), error) != BAT_OK)
            return BAT_NO_MEMORY;
        bat_status status = fill_channels(smooth, columns, curve, error);
        if (status != BAT_OK)
            return status;
    }
    curve->points = smooth->points;
    smooth->points = NULL;
    return BAT_OK;
}

/// The distance from a point to the one before it, or 0 at the beginning of an open curve, and the time between them.
static double step_before(const bat_hermite_curve *curve, size_t index, double *time)
{
    const bat_space *space = curve->space;
    bool first = index == 0;
    *time = 0;
    if (first && !curve->closed)
        return 0;
    size_t before = first ? curve->count - 1 : index - 1;
    *time = first ? curve->closing_time : curve->times[index] - curve->times[before];
    return space->distance(space, curve->points + before * space->point_dim, curve->points + index * space->point_dim);
}

/// Convert directions to velocities: the speed is the distance to both neighbours divided by the time between them.
static void speed_up(bat_hermite_curve *smooth)
{
    if (smooth->times == NULL)
        return;
    smooth->kind = BAT_HERMITE_TANGENTS_VELOCITIES;
    size_t dim = smooth->space->tangent_dim;
    for (size_t i = 0; i < smooth->count; i++)
    {
        double time_before, time_after = 0, after = 0, before = step_before(smooth, i, &time_before);
        if (i + 1 < smooth->count || smooth->closed)
            after = step_before(smooth, i + 1 < smooth->count ? i + 1 : 0, &time_after);
        for (size_t j = 0; j < dim; j++)
            smooth->tangents[i * dim + j] *= (before + after) / (time_before + time_after);
    }
}

static bat_status count_samples(const bat_motion_spline *spline, const bat_hermite_curve *keys,
                                const bat_motion_curves_options *options, size_t *count, bat_error *error)
{
    /// The last sample of a rate may be this share of a step late, beside the rounding of times.
    static const double RATE_TOLERANCE = 1e-9;
    double wanted = (double)options->time_count;
    bat_motion_keys range = bat_motion_spline_keys(spline);
    size_t intervals = keys->closed ? range.count : range.count - 1; // with a gyroscope there are more than keyframes
    if (options->rate > 0)
    {
        double steps = (range.end - range.begin) * options->rate;
        double late = RATE_TOLERANCE + DBL_EPSILON * fmax(fabs(range.begin), fabs(range.end)) * options->rate;
        wanted = fmax(keys->closed ? ceil(steps - late) : floor(steps + late) + 1, 1);
    }
    else if (options->times == NULL)
        wanted = ldexp((double)intervals, (int)options->scheme.levels) + (keys->closed ? 0 : 1);
    if (!(wanted <= (double)options->scheme.max_points))
        return ERROR_TOO_LARGE(error, "%.15g points would be made, but at most %zu are allowed%s", wanted,
                               options->scheme.max_points, options->rate > 0 ? "; a lower rate makes fewer" : "");
    *count = (size_t)wanted;
    return BAT_OK;
}

static void fill_times(const bat_motion_spline *spline, const bat_hermite_curve *keys,
                       const bat_motion_curves_options *options, bat_hermite_curve *smooth)
{
    double begin = bat_motion_spline_keys(spline).begin, end = bat_motion_spline_keys(spline).end;
    size_t parts = (size_t)1 << options->scheme.levels,
           intervals = bat_motion_spline_keys(spline).count - (keys->closed ? 0 : 1);
    for (size_t i = 0; i < smooth->count; i++)
    {
        size_t key = i / parts, part = i % parts;
        if (options->times != NULL)
            smooth->times[i] = options->times[i];
        else if (options->rate > 0)
            smooth->times[i] = fmin(begin + (double)i / options->rate, end);
        else
            smooth->times[i] = key < intervals ? spline_time_at(spline, key, (double)part / (double)parts) : end;
    }
    smooth->closing_time = keys->closed ? end - smooth->times[smooth->count - 1] : 0;
}

/// Raise the peaks of a report to those of samples: of all, or of the translations and the rotations of rigid motions.
static void add_peaks(const bat_hermite_curve *samples, const double *accelerations, bat_motion_report *report)
{
    const bat_space *space = samples->space;
    size_t n = space->tangent_dim, parts = space_is_rigid(space) ? 2 : 1;
    double before[BAT_SPACE_MAX_DIM], change[BAT_SPACE_MAX_DIM] = {0};
    for (size_t i = 0; i < samples->count; i++)
    {
        const double *p = samples->points + i * space->point_dim, *a = accelerations + i * n;
        const double *vectors[] = {samples->tangents + i * n, a, change};
        double step = i > 0 ? samples->times[i] - samples->times[i - 1] : 1;
        bool near = i > 0 && space->transport(space, p - space->point_dim, p, a - n, before) == BAT_OK;
        for (size_t c = 0; c < n; c++)
            change[c] = near ? (a[c] - before[c]) / step : 0;
        for (size_t part = 0; part < parts; part++)
            for (size_t k = 0; k < 3; k++)
            {
                double squared =
                    parts > 1 ? vector_square(3, vectors[k] + 3 * part) : space->inner(space, p, vectors[k], vectors[k]);
                report->peaks[part][k] = fmax(report->peaks[part][k], sqrt(fmax(squared, 0)));
            }
    }
}

static bat_status sample_spline(const bat_motion_spline *spline, const bat_hermite_curve *keys, const double *drift,
                                const bat_motion_curves_options *options, bat_hermite_curve *smooth, bat_error *error)
{
    const bat_space *space = keys->space;
    *smooth = (bat_hermite_curve){
        .space = space, .closed = keys->closed && options->times == NULL, .kind = BAT_HERMITE_TANGENTS_VELOCITIES};
    bat_status status = count_samples(spline, keys, options, &smooth->count, error);
    if (status != BAT_OK)
        return status;
    status = hermite_allocate(smooth, true, error);
    if (status != BAT_OK)
        return status;
    fill_times(spline, keys, options, smooth);
    double *accelerations = NULL;
    bat_motion_report *report = options->report;
    if (report != NULL)
    {
        if (array_make(&accelerations, smooth->count, space->tangent_dim * sizeof(double), error) != BAT_OK)
            return BAT_NO_MEMORY;
    }
    status = bat_motion_spline_sample(spline, smooth->times, smooth->count, smooth->points, smooth->tangents, accelerations,
                                      error);
    if (status == BAT_OK)
        add_drift(smooth, drift, keys->times[0], 1);
    if (report != NULL && status == BAT_OK)
    {
        add_peaks(smooth, accelerations, report);
        report->duration = fmax(report->duration, bat_motion_spline_keys(spline).end - keys->times[0]);
        report->given_duration =
            fmax(report->given_duration, keys->times[keys->count - 1] + keys->closing_time - keys->times[0]);
    }
    free(accelerations);
    return status;
}

/// The squares of the mean velocities between keys, and of what the given ones differ from them.
static void add_conflict(const bat_hermite_curve *keys, double squares[2])
{
    const bat_space *space = keys->space;
    size_t n = space->tangent_dim;
    double log[BAT_SPACE_MAX_DIM];
    for (size_t i = 0; keys->tangents != NULL && i + 1 < keys->count; i++)
    {
        const double *p = keys->points + i * space->point_dim, *v = keys->tangents + i * n;
        if (space->log(space, p, p + space->point_dim, log) != BAT_OK)
            continue;
        double length = keys->times[i + 1] - keys->times[i];
        for (size_t c = 0; c < n; c++)
            if (!isnan(v[c]) && !isnan(v[n + c]))
            {
                double mean = log[c] / length, apart = (v[c] + v[n + c]) / 2 - mean;
                squares[0] += mean * mean;
                squares[1] += apart * apart;
            }
    }
}

/// Count the keys and the outliers of a curve.
static void add_report(const bat_motion_spline *spline, size_t curve, bat_motion_report *report)
{
    bat_motion_keys keys = bat_motion_spline_keys(spline);
    report->keys += keys.count;
    report->held += keys.held;
    report->turned += keys.turned;
    report->gyro = keys.gyro;
    report->force = keys.force;
    report->sigma = fmax(report->sigma, keys.sigma);
    report->angle_sigma = fmax(report->angle_sigma, keys.angle_sigma);
    for (size_t i = 0; report->threshold > 0 && i < keys.count; i++)
    {
        if (!(keys.deviations[i] > report->threshold))
            continue;
        if (report->outliers++ == 0)
        {
            report->outlier = i;
            report->outlier_curve = curve;
            report->outlier_time = keys.times[i];
        }
    }
}

static bat_status smooth_by_spline(const bat_curve_set *set, size_t index, const bat_motion_curves_options *options,
                                   const bat_hermite_curve *keys, const double *drift, result_columns *columns,
                                   bat_hermite_curve *smooth, bat_error *error)
{
    bat_motion_spline *spline = NULL;
    bat_status status = make_spline(set, index, options, keys, &spline, error);
    if (status == BAT_OK)
        status = sample_spline(spline, keys, drift, options, smooth, error);
    if (status == BAT_OK && options->uncertainty)
    {
        columns->deviations = memory_array(smooth->count, set->space->tangent_dim * sizeof(double));
        status = columns->deviations == NULL
                     ? error_memory(error, smooth->count * set->space->tangent_dim * sizeof(double))
                     : bat_motion_spline_uncertainty(spline, smooth->times, smooth->count, columns->deviations, error);
    }
    if (status == BAT_OK && options->report != NULL)
    {
        add_report(spline, index, options->report);
        add_conflict(keys, columns->squares);
    }
    bat_motion_spline_free(spline);
    if (status == BAT_OK || error == NULL || error->line > 0)
        return status;
    error->index = BAT_NO_INDEX; // of a sample, not of a keyframe
    size_t used = strlen(error->text);
    int64_t origin = bat_curve_set_time_origin(set);
    if (origin != 0)
        (void)snprintf(error->text + used, sizeof error->text - used, " (times from %" PRId64 " on)", origin);
    return status;
}

static bat_status smooth_one(const bat_curve_set *set, size_t index, const bat_motion_curves_options *options,
                             result_columns *columns, bat_curve *curve, bat_error *error)
{
    bat_hermite_curve keys, smooth = {.space = set->space};
    bool splined = bat_motion_method_for(set, options) == BAT_MOTION_METHOD_SPLINE;
    double drift[BAT_SPACE_MAX_DIM];
    bat_status status = take_data(set, index, options, &keys, drift, error);
    if (status != BAT_OK)
        return status;
    status = splined ? smooth_by_spline(set, index, options, &keys, drift, columns, &smooth, error)
                     : bat_hermite_refine(&keys, &options->scheme, &smooth, error);
    if (status == BAT_OK && !splined)
        speed_up(&smooth);
    else if (status != BAT_OK && error != NULL && error->index != BAT_NO_INDEX && !splined)
        error->line = bat_curve_set_line(set, index, error->index);
    if (status == BAT_OK && options->wrap > 0)
        wrap(&set->curves[index], options->wrap, &smooth);
    if (status == BAT_OK)
        status = make_curve(&smooth, columns, curve, error);
    if (status != BAT_OK)
        bat_curve_free(curve);
    free(columns->deviations);
    columns->deviations = NULL;
    bat_hermite_free(&keys);
    bat_hermite_free(&smooth);
    return status;
}

bat_status bat_motion_curves(const bat_curve_set *keyframes, const bat_motion_curves_options *options, bat_curve_set *fine,
                             bat_error *error)
{
    bat_motion_curves_options defaults = bat_motion_curves_defaults();
    result_columns columns;
    bat_curve_set made;
    options = options != NULL ? options : &defaults;
    motion_channels channels = channels_of(keyframes);
    bat_status status = bat_options_check(&bat_motion_curves_fields, options, error);
    if (status == BAT_OK)
        status = check_columns(keyframes, options, &channels, error);
    if (status == BAT_OK)
        status = choose_columns(keyframes, options, &columns, error);
    if (status != BAT_OK)
        return status;
    if (options->report != NULL)
        *options->report = (bat_motion_report){.threshold = motion_outliers_threshold(options->spline.outliers),
                                               .outlier = BAT_NO_INDEX,
                                               .outlier_curve = BAT_NO_INDEX};
    bat_curve *curves = calloc(keyframes->count, sizeof *curves);
    status = curves != NULL ? BAT_OK : error_memory(error, keyframes->count * sizeof *curves);
    size_t count = 0;
    for (; count < keyframes->count && status == BAT_OK; count++)
        status = error_curve(error, smooth_one(keyframes, count, options, &columns, &curves[count], error), count);
    if (status == BAT_OK && options->report != NULL)
        options->report->conflict = columns.squares[0] > 0 ? sqrt(columns.squares[1] / columns.squares[0]) : 0;
    if (status == BAT_OK)
        status = bat_curve_set_take(curves, keyframes->count, &made, error);
    if (status == BAT_OK)
    {
        made.attributes = columns.attributes;
        *fine = made;
        return BAT_OK;
    }
    curves_free(curves, keyframes->count);
    attributes_release(columns.attributes);
    return status;
}

// Schemes by name

/// The values of the settings of a name.
typedef struct settings
{
    double order;
} settings;

typedef struct entry
{
    bat_choice choice;
    bat_motion_method method;
} entry;

static const entry ENTRIES[] = {
    {{.name = "spline", .summary = "a motion in time through its keys, with continuous velocity and acceleration"},
     BAT_MOTION_METHOD_SPLINE},
    {CHOICE_SET("hermite", "order=1", "by points and tangents, order 1 through the points; any space"),
     BAT_MOTION_METHOD_HERMITE},
};
const bat_family bat_motion_scheme_family = FAMILY("scheme", ENTRIES);

bat_status bat_motion_scheme_by_name(const char *name, bat_motion_curves_options *options, bat_error *error)
{
    static const setting SETTINGS[] = {
        {"order", SETTING_NUMBER, offsetof(settings, order), NULL},
    };
    static const option_field ORDER[] = {OPTION_FIELD(settings, order, OPTION_NUMBER, 1, BAT_HERMITE_MAX_ORDER)};
    size_t length = strcspn(name, ":");
    const char *text = name[length] == ':' ? name + length + 1 : name + length;
    const entry *e = (const entry *)(const void *)choice_find(&bat_motion_scheme_family, name, length);
    if (e == NULL)
        return ERROR_ARGUMENT(error, "there is no scheme '%.*s'; `batten list schemes` names them", (int)length, name);
    settings s = {.order = 1};
    bat_status status = settings_read(&e->choice, text, SETTINGS, sizeof SETTINGS / sizeof *SETTINGS, &s, error);
    if (status == BAT_OK && s.order != floor(s.order))
        status = error_option(error, "order", "is %.10g, but must be a whole number", s.order);
    if (status == BAT_OK)
        status = OPTIONS_CHECK(&s, ORDER, error);
    if (status == BAT_OK && e->method == BAT_MOTION_METHOD_HERMITE)
        options->scheme.order = (size_t)s.order;
    if (status == BAT_OK)
        options->method = e->method;
    return status;
}
