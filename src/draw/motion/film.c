#include "draw/motion/film.h"
#include "motion/spline_system.h"

#include "base/error.h"
#include "curve/curve_attributes.h"
#include "draw/curve/view.h"
#include "space/builtin.h"

#include <string.h>

enum
{
    /// Samples of a motion: as many, evenly divided among its intervals,
    SAMPLES = 4000,
    /// but at least and at most so many in each.
    MIN_PARTS = 2,
    MAX_PARTS = 256
};

static const double DEGREES = 57.295779513082320877;
/// Times are shown from the first one on where it exceeds the duration by this factor.
static const double FAR_TIMES = 10;
/// Numbers beyond it have no squares.
static const double LARGEST = 1e150;
/// Marked keys, in units of sigma: Huber's rule lets many good keys count a little less.
static const double HUBER_MARK = 3;

draw_colour film_axis_colour(size_t axis)
{
    static const draw_colour colours[] = {{0.80, 0.20, 0.16}, {0.16, 0.56, 0.24}, {0.15, 0.35, 0.78}};
    return colours[axis % 3];
}

static film_kind kind_of(const bat_space *space)
{
    if (space_is_rotation(space))
        return FILM_STRIP;
    view_space shown = view_space_of(space);
    if (shown == VIEW_SPHERE || shown == VIEW_DISK || shown == VIEW_HYPERBOLIC || shown == VIEW_TENSOR)
        return FILM_SHAPE;
    bool flat = space->point_dim == 2 && space_is_euclidean(space);
    return flat || shown == VIEW_SOLID || shown == VIEW_RIGID ? FILM_PATH : FILM_COORDINATES;
}

/// The units of a file, unless the options name them.
static void choose_units(const bat_motion_picture_options *options, film *made)
{
    const bat_curve_attributes *attributes = made->keyframes->attributes;
    bat_curve_format format = attributes != NULL ? attributes->format : BAT_CURVE_FORMAT_AUTO;
    bool metric = format == BAT_CURVE_FORMAT_TUM || format == BAT_CURVE_FORMAT_EUROC;
    bool seconds = metric || (attributes != NULL && (attributes->time_origin != 0 || attributes->time_text[0] != '\0'));
    bool earth =
        space_is_sphere(made->space) && attributes != NULL && (attributes_are_geojson(attributes) || attributes->degrees);
    bool metres = metric || format == BAT_CURVE_FORMAT_KITTI || earth;
    made->length_unit = options->length_unit != NULL ? options->length_unit : metres ? "m" : "";
    made->time_unit = options->time_unit != NULL         ? options->time_unit
                      : seconds                          ? "s"
                      : format == BAT_CURVE_FORMAT_KITTI ? "frame"
                                                         : "";
    made->length_factor = earth && options->length_unit == NULL ? BAT_EARTH_RADIUS : 1;
}

/// Speeds of `count` points; `turns` is null where there are none.
static bat_status find_speeds(const film *shown, const double *points, const double *velocities, size_t count,
                              double *speeds, double *turns, bat_error *error)
{
    const bat_space *space = shown->space;
    for (size_t i = 0; i < count; i++)
    {
        const double *v = velocities + i * space->tangent_dim, *p = points + i * space->point_dim;
        double angular = shown->kind == FILM_STRIP ? vector3_length(v) : shown->body ? vector3_length(v + 3) : 0;
        if (turns != NULL)
            turns[i] = DEGREES * angular;
        if (speeds != NULL)
            speeds[i] =
                shown->length_factor * (shown->body ? vector3_length(v) : sqrt(fmax(space->inner(space, p, v, v), 0)));
        bool good = (turns == NULL || turns[i] < LARGEST) && (speeds == NULL || speeds[i] < LARGEST);
        for (size_t c = 0; c < space->point_dim; c++)
            good = good && fabs(p[c]) < LARGEST;
        if (!good)
            return error_set(error, BAT_INVALID_POINT, BAT_NO_INDEX, 0,
                             "a coordinate or a speed of the motion is beyond 1e150: too large for a picture");
    }
    return BAT_OK;
}

static bool allocate(const film *shown, film_track *track)
{
    size_t dim = shown->space->point_dim, n = shown->space->tangent_dim, keys = track->key_count;
    bool turns = shown->body || shown->kind == FILM_STRIP, speeds = shown->kind != FILM_STRIP;
    double **arrays[] = {&track->key_times, &track->times,      &track->points, &track->velocities,
                         &track->speeds,    &track->key_speeds, &track->turns,  &track->key_turns};
    size_t sizes[] = {keys,
                      track->count,
                      track->count * dim,
                      track->count * n,
                      speeds ? track->count : 0,
                      speeds ? keys : 0,
                      turns ? track->count : 0,
                      turns ? keys : 0};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        *arrays[i] = sizes[i] > 0 ? memory_pool_array(&track->pool, sizes[i], sizeof(double)) : NULL;
    return track->pool.missing == 0;
}

/// Sample the spline of a track at the keys and between them.
static bat_status sample(const film *shown, film_track *track, size_t parts, bat_error *error)
{
    size_t intervals = (track->count - 1) / parts;
    bat_motion_keys keys = bat_motion_spline_keys(track->spline);
    double end = keys.end;
    memcpy(track->key_times, keys.times, keys.count * sizeof *keys.times);
    track->deviations = keys.deviations;
    for (size_t i = 0; i < track->count; i++)
    {
        size_t key = i / parts, part = i % parts;
        double from = key < track->key_count ? track->key_times[key] : end;
        double to = key + 1 < track->key_count ? track->key_times[key + 1] : end;
        track->times[i] = key < intervals ? from + (to - from) * ((double)part / (double)parts) : end;
    }
    bat_status status =
        bat_motion_spline_sample(track->spline, track->times, track->count, track->points, track->velocities, NULL, error);
    if (status == BAT_OK)
        status = find_speeds(shown, track->points, track->velocities, track->count, track->speeds, track->turns, error);
    return status == BAT_OK
               ? find_speeds(shown, keys.points, keys.velocities, keys.count, track->key_speeds, track->key_turns, error)
               : status;
}

static bat_status make_track(film *made, size_t index, bat_motion_spline *given, const bat_motion_curves_options *motion,
                             bat_error *error)
{
    film_track *track = &made->tracks[index];
    const bat_curve *curve = &made->keyframes->curves[index];
    bat_status status = BAT_OK;
    track->spline = given;
    track->owned = given == NULL;
    bat_motion_keys keys = {.space = made->space, .count = curve->count};
    if (given != NULL)
        keys = bat_motion_spline_keys(given);
    const bat_space *space = keys.space;
    if (space->point_dim != made->space->point_dim || space->tangent_dim != made->space->tangent_dim)
        status = error_set(error, BAT_INVALID_ARGUMENT, index, 0, "spline %zu lives in the space %s, its keyframes in %s",
                           index, space->name, made->space->name);
    else if (keys.count < curve->count)
        status = error_set(error, BAT_INVALID_ARGUMENT, index, 0, "curve %zu has %zu points, but its spline has %zu keys",
                           index, curve->count, keys.count);
    else if (given == NULL)
        status = bat_motion_curve_spline(made->keyframes, index, motion, &track->spline, error);
    if (status != BAT_OK)
        return status;
    keys = bat_motion_spline_keys(track->spline);
    bool same = keys.count == curve->count; // a gyroscope adds keys
    size_t intervals = curve->closed ? keys.count : keys.count - 1;
    size_t parts = SAMPLES / intervals;
    parts = parts < MIN_PARTS ? MIN_PARTS : parts > MAX_PARTS ? MAX_PARTS : parts;
    track->given = same ? curve->points : keys.points;
    track->key_count = keys.count;
    track->count = intervals * parts + 1;
    track->colour = style_palette(made->keyframes->count == 1 ? BAT_CURVE_PICTURE_COLOURS : (int)index + 1);
    if (!allocate(made, track))
        return error_memory(error, track->count * made->space->point_dim * sizeof(double));
    status = sample(made, track, parts, error);
    for (size_t i = 0; i < track->key_count && status == BAT_OK; i++)
        made->any_outlier = made->any_outlier || (made->outlying > 0 && track->deviations[i] > made->outlying);
    return status;
}

/// Move times to the origin.
static void shift_times(film *made)
{
    made->begin = INFINITY;
    made->end = -INFINITY;
    for (size_t k = 0; k < made->count; k++)
    {
        made->begin = fmin(made->begin, made->tracks[k].times[0]);
        made->end = fmax(made->end, made->tracks[k].times[made->tracks[k].count - 1]);
    }
    made->since = bat_curve_set_time_origin(made->keyframes);
    made->origin = made->since != 0 || fabs(made->begin) > FAR_TIMES * (made->end - made->begin) ? made->begin : 0;
    for (size_t k = 0; k < made->count; k++)
    {
        film_track *track = &made->tracks[k];
        for (size_t i = 0; i < track->count; i++)
            track->times[i] -= made->origin;
        for (size_t i = 0; i < track->key_count; i++)
            track->key_times[i] -= made->origin;
    }
    const bat_curve_attributes *attributes = made->keyframes->attributes;
    made->date = attributes != NULL && attributes->time_text[0] != '\0' && made->tracks[0].times[0] == 0
                     ? attributes->time_text
                     : NULL;
    made->begin -= made->origin;
    made->end -= made->origin;
}

bat_status film_make(const bat_curve_set *keyframes, bat_motion_spline *const *splines,
                     const bat_motion_curves_options *motion, const bat_motion_picture_options *options, film *made,
                     bat_error *error)
{
    *made = (film){.keyframes = keyframes, .space = keyframes->space, .poses = options->poses};
    if (keyframes->count == 0 || keyframes->count > BAT_MOTION_PICTURE_MOTIONS)
        return ERROR_UNSUPPORTED(error, 0, "a picture shows 1 to %d motions, not %zu", BAT_MOTION_PICTURE_MOTIONS,
                                 keyframes->count);
    made->kind = kind_of(made->space);
    made->body = space_is_rigid(made->space);
    choose_units(options, made);
    made->outlying = motion_outliers_threshold(motion->spline.outliers);
    if (motion->spline.outliers == BAT_MOTION_OUTLIERS_HUBER)
        made->outlying = HUBER_MARK;
    bat_status status = BAT_OK;
    for (; made->count < keyframes->count && status == BAT_OK; made->count++)
        status = make_track(made, made->count, splines != NULL ? splines[made->count] : NULL, motion, error);
    if (status == BAT_OK)
        shift_times(made);
    else
        film_free(made);
    return status;
}

void film_free(film *made)
{
    for (size_t k = 0; k < made->count; k++)
    {
        film_track *track = &made->tracks[k];
        if (track->owned)
            bat_motion_spline_free(track->spline);
        memory_pool_free(&track->pool);
    }
    made->count = 0;
}

bat_status film_at(const film *shown, const film_track *track, double time, double *point, bat_error *error)
{
    bat_motion_keys keys = bat_motion_spline_keys(track->spline);
    time = fmin(fmax(time + shown->origin, keys.begin), keys.end);
    return bat_motion_spline_at(track->spline, time, point, NULL, NULL, error);
}
