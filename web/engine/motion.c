#include "engine.h"

#include <stdlib.h>

static const engine_option SPLINE_OPTIONS[] = {
    ENGINE_OPTION_CHOICE(bat_motion_spline_options, ends, &bat_motion_ends_family),
    ENGINE_OPTION_CHOICE(bat_motion_spline_options, shape, &bat_motion_shape_family),
    ENGINE_OPTION(bat_motion_spline_options, sigma, ENGINE_NUMBER),
    ENGINE_OPTION(bat_motion_spline_options, angle_sigma, ENGINE_NUMBER),
    ENGINE_OPTION(bat_motion_spline_options, max_speed, ENGINE_NUMBER),
    ENGINE_OPTION(bat_motion_spline_options, max_acceleration, ENGINE_NUMBER),
    ENGINE_OPTION(bat_motion_spline_options, max_angular_speed, ENGINE_NUMBER),
    ENGINE_OPTION(bat_motion_spline_options, max_angular_acceleration, ENGINE_NUMBER),
    ENGINE_OPTION(bat_motion_spline_options, extrapolate, ENGINE_BOOL),
};

/// Smooth curves of a set of keyframes, by a scheme or as a spline.
static bat_status motion_curves(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION(bat_motion_curves_options, rate, ENGINE_NUMBER),
        ENGINE_OPTION(bat_motion_curves_options, tangent_order, ENGINE_SIZE),
        ENGINE_OPTION(bat_motion_curves_options, velocities, ENGINE_BOOL),
        {"levels", offsetof(bat_motion_curves_options, scheme.levels), ENGINE_SIZE, NULL},
        {"ends", offsetof(bat_motion_curves_options, spline.ends), ENGINE_CHOICE, &bat_motion_ends_family},
        {"shape", offsetof(bat_motion_curves_options, spline.shape), ENGINE_CHOICE, &bat_motion_shape_family},
        {"sigma", offsetof(bat_motion_curves_options, spline.sigma), ENGINE_NUMBER, NULL},
        {"angle_sigma", offsetof(bat_motion_curves_options, spline.angle_sigma), ENGINE_NUMBER, NULL},
    };
    static const char *const ALSO[] = {"scheme", NULL};
    bat_motion_curves_options options = bat_motion_curves_defaults();
    const char *name = NULL;
    bat_status status = engine_text(call->options, "scheme", &name, error);
    if (status == BAT_OK && name != NULL)
        status = bat_motion_scheme_by_name(name, &options, error);
    if (status == BAT_OK)
        status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), ALSO, &options, error);
    return status == BAT_OK ? bat_motion_curves(&call->inputs[0]->set, &options, &result->set, error) : status;
}

/// Sample the spline through the first curve of a set, whose channel, where there is one, is the time. The bytes of the call
/// are the times of the samples.
static bat_status sample_spline(const engine_call *call, engine_object *result, bat_error *error)
{
    static const char *const NONE[] = {NULL};
    bat_motion_spline_options options = bat_motion_spline_defaults();
    bat_status status = engine_options(call->options, SPLINE_OPTIONS, ENGINE_COUNT(SPLINE_OPTIONS), NONE, &options, error);
    const bat_curve *curve = &call->inputs[0]->set.curves[0];
    if (status == BAT_OK && curve->channel_count > 1)
        return engine_fail(error, BAT_INVALID_ARGUMENT, "keyframes have one time each", "");
    bat_hermite_curve keys = {.space = curve->space,
                              .points = curve->points,
                              .times = curve->channel_count == 1 ? curve->channels : NULL,
                              .count = curve->count,
                              .closed = curve->closed,
                              .kind = BAT_HERMITE_TANGENTS_VELOCITIES};
    size_t count = call->size / sizeof(double);
    const bat_space *space = curve->space;
    double *points = engine_own(result, malloc((count * space->point_dim + 1) * sizeof *points));
    double *velocities = engine_own(result, malloc((count * space->tangent_dim + 1) * sizeof *velocities));
    double *accelerations = engine_own(result, malloc((count * space->tangent_dim + 1) * sizeof *accelerations));
    if (points == NULL || velocities == NULL || accelerations == NULL)
        return engine_fail(error, BAT_NO_MEMORY, "memory is used up", "");
    bat_motion_spline *spline = NULL;
    if (status == BAT_OK)
        status = bat_motion_spline_make(&keys, &options, &spline, error);
    if (status == BAT_OK)
        status = bat_motion_spline_sample(spline, call->bytes, count, points, velocities, accelerations, error);
    bat_motion_spline_free(spline);
    if (status != BAT_OK)
        return status;
    engine_set(result->report, "points", engine_array("f64", points, count * space->point_dim));
    engine_set(result->report, "velocities", engine_array("f64", velocities, count * space->tangent_dim));
    engine_set(result->report, "accelerations", engine_array("f64", accelerations, count * space->tangent_dim));
    return BAT_OK;
}

const engine_row ENGINE_MOTION_ROWS[] = {
    {"bat_motion_curves", motion_curves, {ENGINE_CURVES}, ENGINE_CURVES},
    {"bat_motion_spline_sample", sample_spline, {ENGINE_CURVES}, ENGINE_VALUES},
    {NULL, NULL, {ENGINE_VALUES}, ENGINE_VALUES},
};
