/// @file
/// Smooth test curves in manifolds and measurements on them; see motion_curves.h.

#include "research/studies/motion_curves.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PERIOD = 6.28318530717958647693;
/// Step of the finite differences in t.
static const double STEP = 1e-3;

static double inner(const bat_space *space, const double *p, const double *u, const double *v)
{
    return space->inner(space, p, u, v);
}

static void add_scaled(size_t n, double factor, const double *vector, double *sum)
{
    for (size_t i = 0; i < n; i++)
        sum[i] += factor * vector[i];
}

static void normalize(const bat_space *space, const double *p, double *vector)
{
    double length = sqrt(inner(space, p, vector, vector));
    for (size_t i = 0; i < space->tangent_dim; i++)
        vector[i] /= length;
}

/// A unit vector at the centre towards a random point, orthogonalized against the previous axes.
static bat_status make_axis(study_curve *curve, size_t axis, bat_random *random)
{
    enum
    {
        TRIALS = 100
    };
    const bat_space *space = curve->space;
    double goal[BAT_SPACE_MAX_DIM], *a = curve->axes[axis];
    for (int trial = 0; trial < TRIALS; trial++)
    {
        space->random_point(space, random, goal);
        if (space->log(space, curve->centre, goal, a) != BAT_OK)
            continue;
        normalize(space, curve->centre, a);
        for (size_t before = 0; before < axis; before++)
            add_scaled(space->tangent_dim, -inner(space, curve->centre, a, curve->axes[before]), curve->axes[before], a);
        if (inner(space, curve->centre, a, a) < 1e-3)
            continue;
        normalize(space, curve->centre, a);
        return BAT_OK;
    }
    return BAT_NO_CONVERGENCE;
}

bat_status study_curve_make(const bat_space *space, double radius, uint64_t seed, study_curve *curve, bat_error *error)
{
    size_t n = space->tangent_dim;
    bat_random random = bat_random_seed(seed);
    if (space->dimension < 2)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "a space of dimension 1 has no room for the curve");
    *curve = (study_curve){.space = space, .radius = radius};
    curve->centre = memory_array(space->point_dim + 3 * n, sizeof(double));
    if (curve->centre == NULL)
        return error_memory(error, (space->point_dim + 3 * n) * sizeof(double));
    space->random_point(space, &random, curve->centre);
    for (size_t axis = 0; axis < 3; axis++)
    {
        curve->axes[axis] = curve->centre + space->point_dim + axis * n;
        bool spare = axis >= space->dimension;
        bat_status status = spare ? BAT_OK : make_axis(curve, axis, &random);
        if (status != BAT_OK)
        {
            study_curve_free(curve);
            return error_set(error, status, BAT_NO_INDEX, 0, "no axis of the curve was found");
        }
        if (spare)
            memcpy(curve->axes[axis], curve->axes[0], n * sizeof(double));
    }
    return BAT_OK;
}

void study_curve_free(study_curve *curve)
{
    free(curve->centre);
    *curve = (study_curve){0};
}

bat_status study_curve_point(const study_curve *curve, double t, double *point)
{
    const bat_space *space = curve->space;
    double tangent[BAT_SPACE_MAX_DIM] = {0}, r = curve->radius;
    if (curve->form != NULL)
        return curve->form(curve, t, point);
    add_scaled(space->tangent_dim, r * cos(t), curve->axes[0], tangent);
    add_scaled(space->tangent_dim, r * 0.8 * sin(t), curve->axes[1], tangent);
    add_scaled(space->tangent_dim, r * 0.3 * sin(2 * t), curve->axes[2], tangent);
    return space->exp(space, curve->centre, tangent, point);
}

bat_status study_curve_velocity(const study_curve *curve, double t, const double *point, double *velocity)
{
    static const double steps[4] = {-2, -1, 1, 2}, weights[4] = {1, -8, 8, -1};
    const bat_space *space = curve->space;
    double near[BAT_SPACE_MAX_DIM], log[BAT_SPACE_MAX_DIM];
    memset(velocity, 0, space->tangent_dim * sizeof *velocity);
    for (int k = 0; k < 4; k++)
    {
        bat_status status = study_curve_point(curve, t + steps[k] * STEP, near);
        if (status == BAT_OK)
            status = space->log(space, point, near, log);
        if (status != BAT_OK)
            return status;
        add_scaled(space->tangent_dim, weights[k] / (12 * STEP), log, velocity);
    }
    return BAT_OK;
}

bat_status study_curve_sample(const study_curve *curve, const double *parameters, size_t count, bool closed,
                              bat_hermite_curve *samples, bat_error *error)
{
    const bat_space *space = curve->space;
    bat_hermite_curve made = {.space = space, .count = count, .closed = closed};
    made.points = memory_array(count, space->point_dim * sizeof(double));
    made.tangents = memory_array(count, space->tangent_dim * sizeof(double));
    made.times = memory_array(count, sizeof(double));
    made.closing_time = closed ? parameters[0] + PERIOD - parameters[count - 1] : 0;
    bool has_memory = made.points != NULL && made.tangents != NULL && made.times != NULL;
    bat_status status = has_memory ? BAT_OK : error_memory(error, count * space->point_dim * sizeof(double));
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        double *point = made.points + i * space->point_dim;
        made.times[i] = parameters[i];
        status = study_curve_point(curve, parameters[i], point);
        if (status == BAT_OK)
            status = study_curve_velocity(curve, parameters[i], point, made.tangents + i * space->tangent_dim);
        if (status != BAT_OK)
            (void)error_set(error, status, i, 0, "the curve has no sample %zu (%s)", i, bat_status_name(status));
    }
    if (status == BAT_OK)
        *samples = made;
    else
        bat_hermite_free(&made);
    return status;
}

/// Newton's method for the parameter at which the geodesic to the point is orthogonal to the curve.
bat_status study_curve_distance(const study_curve *curve, const double *point, double start, double *distance)
{
    enum
    {
        STEPS = 6
    };
    const bat_space *space = curve->space;
    double foot[BAT_SPACE_MAX_DIM], velocity[BAT_SPACE_MAX_DIM], way[BAT_SPACE_MAX_DIM], t = start;
    *distance = INFINITY;
    for (int step = 0; step < STEPS; step++)
    {
        bat_status status = study_curve_point(curve, t, foot);
        if (status == BAT_OK)
            status = study_curve_velocity(curve, t, foot, velocity);
        if (status == BAT_OK)
            status = space->log(space, foot, point, way);
        if (status != BAT_OK)
            return status;
        *distance = fmin(*distance, space->distance(space, foot, point));
        t += inner(space, foot, way, velocity) / inner(space, foot, velocity, velocity);
    }
    return BAT_OK;
}

bat_status study_curve_error(const study_curve *curve, const bat_hermite_curve *fine, double *largest)
{
    *largest = 0;
    for (size_t i = 0; i < fine->count; i++)
    {
        double distance;
        const double *point = fine->points + i * fine->space->point_dim;
        bat_status status = study_curve_distance(curve, point, fine->times[i], &distance);
        if (status != BAT_OK)
            return status;
        *largest = fmax(*largest, distance);
    }
    return BAT_OK;
}

/// The samples in the form that the scheme requires.
static bat_status sample_setup(const study_curve *curve, const study_setup *setup, bat_hermite_curve *samples,
                               bat_error *error)
{
    const double begin = 0.3;
    double *parameters = memory_array(setup->count, sizeof *parameters);
    if (parameters == NULL)
        return error_memory(error, setup->count * sizeof *parameters);
    double spacing = setup->closed ? PERIOD / (double)setup->count : 0.5 * PERIOD / (double)(setup->count - 1);
    for (size_t i = 0; i < setup->count; i++)
        parameters[i] = begin + spacing * ((double)i + (i % 2 == 1 ? setup->unevenness : 0));
    bat_status status = study_curve_sample(curve, parameters, setup->count, setup->closed, samples, error);
    free(parameters);
    if (status != BAT_OK)
        return status;
    if (setup->linear == NULL)
        return bat_hermite_normalize(samples, error);
    for (size_t i = 0; i < setup->count * curve->space->tangent_dim; i++)
        samples->tangents[i] *= spacing;
    return BAT_OK;
}

/// Replace the directions by estimates from the points alone, without the curve's times.
static bat_status forget_tangents(bat_hermite_curve *samples, bat_error *error)
{
    double *times = samples->times;
    samples->times = NULL;
    bat_status status = bat_hermite_estimate_tangents(samples, 4, error);
    samples->times = times;
    return status;
}

bat_status study_refinement_error(const study_curve *curve, const study_setup *setup, double *largest, bat_error *error)
{
    bat_hermite_curve coarse = {0}, fine = {0};
    bat_status status = sample_setup(curve, setup, &coarse, error);
    if (status == BAT_OK && setup->estimated)
        status = forget_tangents(&coarse, error);
    if (status == BAT_OK)
        status = bat_hermite_transport_refine(&coarse, setup->linear, setup->options, &fine, error);
    if (status == BAT_OK && study_curve_error(curve, &fine, largest) != BAT_OK)
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the refined curve is too far from the smooth one");
    bat_hermite_free(&coarse);
    bat_hermite_free(&fine);
    return status;
}

double study_longest_edge(const bat_hermite_curve *curve)
{
    const bat_space *space = curve->space;
    size_t edges = curve->closed ? curve->count : curve->count - 1;
    double longest = 0;
    for (size_t i = 0; i < edges; i++)
        longest = fmax(longest, space->distance(space, curve->points + i * space->point_dim,
                                                curve->points + (i + 1) % curve->count * space->point_dim));
    return longest;
}

double study_displacement(const bat_hermite_curve *coarse, const bat_hermite_curve *fine)
{
    const bat_space *space = coarse->space;
    double largest = 0;
    for (size_t i = 0; i < coarse->count && 2 * i < fine->count; i++)
        largest = fmax(
            largest, space->distance(space, coarse->points + i * space->point_dim, fine->points + 2 * i * space->point_dim));
    return largest;
}

/// The angle between two tangent vectors at a point, from the lengths of difference and sum of their directions.
static double angle_between(const bat_space *space, const double *p, const double *u, const double *v)
{
    double difference[BAT_SPACE_MAX_DIM] = {0}, sum[BAT_SPACE_MAX_DIM] = {0};
    double of_u = 1 / sqrt(inner(space, p, u, u)), of_v = 1 / sqrt(inner(space, p, v, v));
    for (size_t i = 0; i < space->tangent_dim; i++)
    {
        difference[i] = of_u * u[i] - of_v * v[i];
        sum[i] = of_u * u[i] + of_v * v[i];
    }
    return 2 * atan2(sqrt(inner(space, p, difference, difference)), sqrt(inner(space, p, sum, sum)));
}

/// The two angles of eq. (3.7).
static bat_status edge_angles(const bat_space *space, const double *p0, const double *v0, const double *p1, const double *v1,
                              double angles[2])
{
    double way[BAT_SPACE_MAX_DIM];
    bat_status status = space->log(space, p0, p1, way);
    if (status != BAT_OK)
        return status;
    angles[0] = angle_between(space, p0, v0, way);
    status = space->log(space, p1, p0, way);
    for (size_t i = 0; i < space->tangent_dim; i++)
        way[i] = -way[i];
    angles[1] = angle_between(space, p1, v1, way);
    return status;
}

bat_status study_proximity_of(const bat_space *space, const double *p0, const double *v0, const double *p1, const double *v1,
                              study_proximity *proximity)
{
    if (space->point_dim != space->tangent_dim)
        return BAT_UNSUPPORTED;
    bat_space around = bat_euclidean(space->point_dim);
    const bat_space *spaces[2] = {space, &around};
    double point[2][BAT_SPACE_MAX_DIM], direction[2][BAT_SPACE_MAX_DIM], angles[2][4];
    for (int i = 0; i < 2; i++)
    {
        bat_status status = bat_hermite_average(spaces[i], p0, v0, p1, v1, 0.5, point[i], direction[i]);
        if (status == BAT_OK)
            status = edge_angles(spaces[i], p0, v0, point[i], direction[i], angles[i]);
        if (status == BAT_OK)
            status = edge_angles(spaces[i], point[i], direction[i], p1, v1, angles[i] + 2);
        if (status != BAT_OK)
            return status;
    }
    *proximity =
        (study_proximity){.length = space->distance(space, p0, p1), .point = around.distance(&around, point[0], point[1])};
    for (int k = 0; k < 4; k++)
        proximity->angle = fmax(proximity->angle, fabs(angles[0][k] - angles[1][k]));
    return BAT_OK;
}
