/// @file
/// Motions of which every k-th pose is kept, and how well the others come back.

#include "batten/research/motion_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/curve_file.h"
#include "batten/motion.h"
#include "research/studies/motion_keyframes_data.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    POSE = 7,
    PATH_SIZE = 4096
};

static const double DEGREES = 57.295779513082320877;
static const char RECORDED[] = "fr1-xyz";

/// Poses in time.
typedef struct trajectory
{
    double *times, *poses;
    size_t count;
} trajectory;

static void trajectory_free(trajectory *motion)
{
    free(motion->times);
    free(motion->poses);
    *motion = (trajectory){0};
}

static bat_status trajectory_allocate(size_t count, trajectory *motion, bat_error *error)
{
    motion->count = count;
    motion->times = memory_array(count, sizeof(double));
    motion->poses = memory_array(count, POSE * sizeof(double));
    if (motion->times != NULL && motion->poses != NULL)
        return BAT_OK;
    trajectory_free(motion);
    return error_memory(error, count * POSE * sizeof(double));
}

// The formulas of scripts/motion-keyframes-peers.py.

static void normalize(double *v)
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++)
        v[i] /= length;
}

static void cross(const double *u, const double *v, double *w)
{
    w[0] = u[1] * v[2] - u[2] * v[1];
    w[1] = u[2] * v[0] - u[0] * v[2];
    w[2] = u[0] * v[1] - u[1] * v[0];
}

/// The quaternion of a rotation with these columns.
static void quaternion_of_axes(const double *x, const double *y, const double *z, double *quaternion)
{
    const double matrix[9] = {x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]};
    (void)bat_rotation_nearest(matrix, quaternion, NULL);
}

/// Turn a quaternion by a rotation vector in the body's frame.
static void turn_by(double *quaternion, double x, double y, double z)
{
    bat_space rotation = bat_rotation();
    const double vector[3] = {x, y, z};
    double turned[4];
    (void)rotation.exp(&rotation, quaternion, vector, turned);
    memcpy(quaternion, turned, sizeof turned);
}

static void quadrotor_at(double t, double *pose)
{
    static const double waves[3][3] = {{1.5, 0.9, 0}, {0.8, 1.7, 1}, {0.3, 3.1, 2}};
    double z[3] = {0, 0, 9.81}, x[3], y[3], yaw = 0.5 * sin(0.3 * t) + 0.1 * t;
    const double heading[3] = {cos(yaw), sin(yaw), 0};
    for (int axis = 0; axis < 3; axis++)
    {
        pose[axis] = 0;
        for (int w = 0; w < 3; w++)
        {
            double size = waves[w][0] * (axis == 2 ? 0.3 : 1), rate = waves[w][1] * (1 + 0.1 * axis);
            double wave = size * sin(rate * t + waves[w][2] + 2 * axis);
            pose[axis] += wave;
            z[axis] -= rate * rate * wave;
        }
    }
    normalize(z);
    cross(z, heading, y);
    normalize(y);
    cross(y, z, x);
    quaternion_of_axes(x, y, z, pose + 3);
}

static void car_at(double t, double *pose)
{
    double x[3] = {9 * cos(0.15 * t) + 2.48 * cos(0.31 * t), -9 * sin(0.15 * t) + 1.38 * cos(0.23 * t + 1),
                   0.12 * cos(0.4 * t)};
    const double up[3] = {0, 0, 1};
    double y[3], z[3];
    pose[0] = 60 * sin(0.15 * t) + 8 * sin(0.31 * t);
    pose[1] = 60 * cos(0.15 * t) + 6 * sin(0.23 * t + 1);
    pose[2] = 0.3 * sin(0.4 * t);
    normalize(x);
    cross(up, x, y);
    normalize(y);
    cross(x, y, z);
    quaternion_of_axes(x, y, z, pose + 3);
}

/// Rest for 1.1, move for 1.6 with velocity and acceleration 0 at both ends.
static void arm_at(double t, double *pose)
{
    const double period = 2.7, rest = 1.1, move = 1.6;
    double stop = floor(t / period), s = fmin(fmax((t - period * stop - rest) / move, 0), 1);
    double places[2][3], attitudes[2][4], turn[3];
    bat_space rotation = bat_rotation();
    s = s * s * s * (10 - s * (15 - 6 * s));
    for (int end = 0; end < 2; end++)
    {
        double j = stop + end;
        const double place[3] = {0.4 * sin(1.7 * j), 0.3 * cos(2.3 * j), 0.2 * sin(0.9 * j + 1)};
        const double vector[3] = {0.6 * sin(1.1 * j), 0.5 * cos(1.9 * j), 0.7 * sin(2.7 * j)};
        memcpy(places[end], place, sizeof place);
        (void)bat_rotation_from_vector(vector, attitudes[end], NULL);
    }
    for (int i = 0; i < 3; i++)
        pose[i] = places[0][i] + s * (places[1][i] - places[0][i]);
    (void)rotation.log(&rotation, attitudes[0], attitudes[1], turn);
    memcpy(pose + 3, attitudes[0], sizeof attitudes[0]);
    turn_by(pose + 3, s * turn[0], s * turn[1], s * turn[2]);
}

static void satellite_at(double t, double *pose)
{
    static const double slews[4][3] = {{60, 120, 0.8}, {200, 290, -1.2}, {350, 420, 0.9}, {480, 560, -0.5}};
    const double orbit = 0.0022 * t, identity[4] = {1, 0, 0, 0};
    double slew = 0;
    pose[0] = 7000 * cos(orbit);
    pose[1] = 4200 * sin(orbit);
    pose[2] = 5600 * sin(orbit);
    for (int i = 0; i < 4; i++)
    {
        double s = fmin(fmax((t - slews[i][0]) / (slews[i][1] - slews[i][0]), 0), 1);
        slew += slews[i][2] * (s < 0.5 ? 2 * s * s : 1 - 2 * (1 - s) * (1 - s));
    }
    memcpy(pose + 3, identity, sizeof identity);
    turn_by(pose + 3, 0, -0.8 * orbit, 0.6 * orbit);
    turn_by(pose + 3, 0.6 * slew, 0.8 * slew, 0);
    turn_by(pose + 3, 0.02 * sin(0.05 * t), 0, 0.03 * cos(0.03 * t));
}

/// Uniform in -1 to 1.
static double noise_of(size_t pose, int channel)
{
    double x = 1e4 * sin(12.9898 * ((double)pose + 1) + 78.233 * (channel + 1));
    return 2 * (x - floor(x)) - 1;
}

/// Move every pose by up to half the mean step in each coordinate.
static void disturb(trajectory *motion)
{
    bat_space rotation = bat_rotation();
    double length = 0, angle = 0;
    for (size_t i = 1; i < motion->count; i++)
    {
        const double *p = motion->poses + (i - 1) * POSE, *q = p + POSE;
        length += hypot(hypot(q[0] - p[0], q[1] - p[1]), q[2] - p[2]);
        angle += rotation.distance(&rotation, p + 3, q + 3);
    }
    length *= 0.5 / (double)(motion->count - 1);
    angle *= 0.5 / (double)(motion->count - 1);
    for (size_t i = 0; i < motion->count; i++)
    {
        double *pose = motion->poses + i * POSE;
        for (int c = 0; c < 3; c++)
            pose[c] += length * noise_of(i, c);
        turn_by(pose + 3, angle * noise_of(i, 3), angle * noise_of(i, 4), angle * noise_of(i, 5));
    }
}

/// Motions by formulas.
static const struct
{
    const char *name;
    double step;
    void (*at)(double t, double *pose);
} MOTIONS[] = {
    {"quadrotor", 0.02, quadrotor_at}, {"car", 0.1, car_at}, {"arm", 0.02, arm_at}, {"satellite", 0.5, satellite_at}};

static bat_status make_motion(const keyframe_facts *facts, trajectory *motion, bat_error *error)
{
    bat_status status = trajectory_allocate(facts->poses, motion, error);
    for (size_t m = 0; m < sizeof MOTIONS / sizeof *MOTIONS && status == BAT_OK; m++)
        for (size_t i = 0; i < facts->poses && strcmp(MOTIONS[m].name, facts->motion) == 0; i++)
        {
            motion->times[i] = (double)i * MOTIONS[m].step;
            MOTIONS[m].at(motion->times[i], motion->poses + i * POSE);
        }
    if (status == BAT_OK && facts->noisy)
        disturb(motion);
    return status;
}

static bat_status read_motion(const char *folder, const keyframe_facts *facts, trajectory *motion, bat_error *error)
{
    char path[PATH_SIZE];
    bat_curve_set set;
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = BAT_CURVE_FORMAT_TUM;
    int length = snprintf(path, sizeof path, "%s/%s.txt", folder, facts->motion);
    if (length < 0 || length >= (int)sizeof path)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "the folder's name is too long");
    bat_status status = bat_curve_read(path, &options, &set, error);
    if (status != BAT_OK)
        return error_prefix(error, status, "%s: ", path);
    const bat_curve *curve = &set.curves[0];
    if (curve->count != facts->poses)
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "%s: %zu poses, but the figures are of %zu", path,
                           curve->count, facts->poses);
    if (status == BAT_OK)
        status = trajectory_allocate(curve->count, motion, error);
    if (status == BAT_OK)
    {
        memcpy(motion->poses, curve->points, curve->count * POSE * sizeof(double));
        for (size_t i = 0; i < curve->count; i++)
            motion->times[i] = curve->channels[i * curve->channel_count];
    }
    bat_curve_set_free(&set);
    return status;
}

/// Keep every `step`th pose, and measure the spline at the others.
static bat_status measure(const trajectory *motion, size_t step, bat_motion_shape shape, double errors[2], bat_error *error)
{
    bat_space rigid, rotation = bat_rotation();
    trajectory kept;
    bat_motion_spline *spline;
    bat_motion_spline_options options = bat_motion_spline_defaults();
    size_t count = (motion->count - 1) / step + 1, between = 0;
    options.shape = shape;
    bat_status status = bat_rigid(1, &rigid, error);
    if (status == BAT_OK)
        status = trajectory_allocate(count, &kept, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < count; i++)
    {
        kept.times[i] = motion->times[i * step];
        memcpy(kept.poses + i * POSE, motion->poses + i * step * POSE, POSE * sizeof(double));
    }
    const bat_hermite_curve keys = {.space = &rigid, .points = kept.poses, .times = kept.times, .count = count};
    status = bat_motion_spline_make(&keys, &options, &spline, error);
    errors[0] = errors[1] = 0;
    for (size_t i = 0; status == BAT_OK && i < (count - 1) * step; i++)
    {
        const double *pose = motion->poses + i * POSE;
        double made[POSE];
        if (i % step == 0)
            continue;
        status = bat_motion_spline_at(spline, motion->times[i], made, NULL, NULL, error);
        double moved = hypot(hypot(made[0] - pose[0], made[1] - pose[1]), made[2] - pose[2]);
        double turned = rotation.distance(&rotation, made + 3, pose + 3) * DEGREES;
        errors[0] += moved * moved;
        errors[1] += turned * turned;
        between++;
    }
    if (status == BAT_OK)
        bat_motion_spline_free(spline);
    for (int e = 0; e < 2; e++)
        errors[e] = sqrt(errors[e] / (double)(between > 0 ? between : 1));
    trajectory_free(&kept);
    return status;
}

static bat_status measure_row(const char *folder, const keyframe_facts *facts, bat_keyframes_row *row, bat_error *error)
{
    trajectory motion = {0};
    bool recorded = strcmp(facts->motion, RECORDED) == 0;
    bat_status status = recorded ? read_motion(folder, facts, &motion, error) : make_motion(facts, &motion, error);
    *row = (bat_keyframes_row){.motion = facts->motion, .noisy = facts->noisy, .step = facts->step};
    if (status == BAT_OK)
        status = measure(&motion, facts->step, BAT_MOTION_SHAPE_RESTING, row->errors, error);
    if (status == BAT_OK)
        status = measure(&motion, facts->step, BAT_MOTION_SHAPE_LIMITED, row->limited, error);
    memcpy(row->peers, facts->peers, sizeof row->peers);
    trajectory_free(&motion);
    return status;
}

bat_status bat_keyframes_measure(const char *folder, bat_progress progress, bat_keyframes_row **rows, size_t *count,
                                 bat_error *error)
{
    bat_keyframes_row *made = memory_array(KEYFRAME_FACT_COUNT, sizeof *made);
    bat_status status = made != NULL ? BAT_OK : error_memory(error, KEYFRAME_FACT_COUNT * sizeof *made);
    size_t used = 0;
    for (size_t i = 0; i < KEYFRAME_FACT_COUNT && status == BAT_OK; i++)
    {
        if (progress.report != NULL && !progress.report(progress.context, (double)i / KEYFRAME_FACT_COUNT))
            status = error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "measuring was cancelled");
        else if (folder != NULL || strcmp(KEYFRAME_FACTS[i].motion, RECORDED) != 0)
            status = measure_row(folder, &KEYFRAME_FACTS[i], &made[used++], error);
    }
    if (status != BAT_OK)
    {
        free(made);
        return status;
    }
    *rows = made;
    *count = used;
    return BAT_OK;
}
