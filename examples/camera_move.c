// A camera move from eight keyframes: poses at uneven times become 25 frames a second, whose velocities and accelerations
// do not jump at the keyframes.
//
//     cc camera_move.c $(pkg-config --cflags --libs batten) -lm && ./a.out data/camera-keyframes.csv frames.tum

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double RATE = 25;
/// A metre further counts as much as a turn by half a radian.
static const double RADIANS_PER_METRE = 0.5;

/// The largest change of the velocity from frame to frame, relative to the largest velocity.
static double largest_jump(const bat_motion_spline *spline, size_t frames)
{
    const bat_space *space = bat_motion_spline_keys(spline).space;
    double largest = 0, fastest = 0, pose[2][7], velocity[2][6];
    for (size_t i = 0; i < frames; i++)
    {
        double *p = pose[(i + 1) % 2], *q = pose[i % 2], *v = velocity[(i + 1) % 2], *w = velocity[i % 2];
        double brought[6], difference[6];
        if (bat_motion_spline_at(spline, (double)i / RATE, q, w, NULL, NULL) != BAT_OK ||
            (i > 0 && space->transport(space, p, q, v, brought) != BAT_OK))
            return NAN;
        for (size_t j = 0; j < 6; j++)
            difference[j] = i > 0 ? w[j] - brought[j] : 0;
        largest = fmax(largest, sqrt(space->inner(space, q, difference, difference)));
        fastest = fmax(fastest, sqrt(space->inner(space, q, w, w)));
    }
    return largest / fastest;
}

/// How far the move is from the keyframes at their own times.
static double keyframe_error(const bat_motion_spline *spline, const bat_hermite_curve *keys)
{
    const bat_space *space = keys->space;
    double largest = 0, pose[7];
    for (size_t i = 0; i < keys->count; i++)
    {
        if (bat_motion_spline_at(spline, keys->times[i], pose, NULL, NULL, NULL) != BAT_OK)
            return NAN;
        largest = fmax(largest, space->distance(space, pose, keys->points + i * space->point_dim));
    }
    return largest;
}

static int fail(const char *what, const bat_error *error)
{
    fprintf(stderr, "%s:%zu: %s\n", what, error->line, error->text);
    return EXIT_FAILURE;
}

int main(int argc, char **argv)
{
    const char *path = argc > 1 ? argv[1] : "examples/data/camera-keyframes.csv";
    bat_curve_set poses = {0}, move = {0};
    bat_hermite_curve keys = {0};
    bat_motion_spline *spline = NULL;
    bat_error error;
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.rate = RATE;
    if (bat_curve_read(path, NULL, &poses, &error) != BAT_OK)
        return fail(path, &error);
    poses.space->weight = RADIANS_PER_METRE;

    // From file to file in one call …
    bat_status status = bat_motion_curves(&poses, &options, &move, &error);
    if (status == BAT_OK && argc > 2)
        status = bat_curve_write(argv[2], &move, NULL, &error);
    // … and step by step, with velocities to look at.
    if (status == BAT_OK)
        status = bat_motion_data(&poses, 0, &options, &keys, &error);
    if (status == BAT_OK)
        status = bat_motion_spline_make(&keys, NULL, &spline, &error);

    bool good = false;
    if (status == BAT_OK)
    {
        size_t frames = move.curves[0].count;
        double jump = largest_jump(spline, frames), gap = keyframe_error(spline, &keys);
        bat_motion_keys made = bat_motion_spline_keys(spline);
        printf("%zu keyframes, %zu frames in %g seconds; velocity changes by at most %.1f %% from frame to frame\n",
               keys.count, frames, made.end - made.begin, 100 * jump);
        good = frames == 251 && gap < 1e-12 && jump < 0.1;
    }
    else
        (void)fail(path, &error);
    bat_motion_spline_free(spline);
    bat_hermite_free(&keys);
    bat_curve_set_free(&move);
    bat_curve_set_free(&poses);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
