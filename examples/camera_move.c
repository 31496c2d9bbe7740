// A camera move from eight keyframes: poses at uneven times become 25 frames a second, whose velocities do not jump at the
// keyframes.
//
//     cc camera_move.c $(pkg-config --cflags --libs batten) -lm && ./a.out data/camera-keyframes.csv frames.tum

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double RATE = 25;
/// A metre further counts as much as a turn by half a radian.
static const double RADIANS_PER_METRE = 0.5;

/// The largest difference of velocities from one frame to the next, relative to the largest velocity.
static double largest_jump(const bat_hermite_curve *frames)
{
    const bat_space *space = frames->space;
    double largest = 0, fastest = 0;
    for (size_t i = 1; i < frames->count; i++)
    {
        const double *p = frames->points + (i - 1) * space->point_dim, *q = p + space->point_dim;
        const double *v = frames->tangents + (i - 1) * space->tangent_dim, *w = v + space->tangent_dim;
        double brought[6], difference[6];
        if (space->transport(space, p, q, v, brought) != BAT_OK)
            return NAN;
        for (size_t j = 0; j < 6; j++)
            difference[j] = w[j] - brought[j];
        largest = fmax(largest, sqrt(space->inner(space, q, difference, difference)));
        fastest = fmax(fastest, sqrt(space->inner(space, q, w, w)));
    }
    return largest / fastest;
}

/// How far the move is from the keyframes at their own times.
static double keyframe_error(const bat_hermite_curve *keys)
{
    const bat_space *space = keys->space;
    double largest = 0, pose[7];
    for (size_t i = 0; i < keys->count; i++)
    {
        if (bat_hermite_sample(keys, &keys->times[i], 1, pose, NULL, NULL) != BAT_OK)
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
    bat_hermite_curve keys = {0}, frames = {0};
    bat_error error;
    bat_motion_options options = bat_motion_defaults();
    options.rate = RATE;
    if (bat_curve_read(path, NULL, &poses, &error) != BAT_OK)
        return fail(path, &error);
    poses.space->weight = RADIANS_PER_METRE;

    // From file to file in one call …
    bat_status status = bat_motion_curves(&poses, &options, &move, NULL, &error);
    if (status == BAT_OK && argc > 2)
        status = bat_curve_write(argv[2], &move, NULL, &error);
    // … and step by step, with velocities to look at.
    if (status == BAT_OK)
        status = bat_motion_data(&poses, 0, &options, &keys, &error);
    if (status == BAT_OK)
        status = bat_hermite_sample_rate(&keys, RATE, &frames, &error);

    bool good = false;
    if (status == BAT_OK)
    {
        double jump = largest_jump(&frames), gap = keyframe_error(&keys);
        printf("%zu keyframes, %zu frames in %g seconds; velocity changes by at most %.1f %% from frame to frame\n",
               keys.count, frames.count, frames.times[frames.count - 1] - frames.times[0], 100 * jump);
        good = frames.count == 251 && move.curves[0].count == frames.count && gap < 1e-12 && jump < 0.1;
    }
    else
        (void)fail(path, &error);
    bat_hermite_free(&frames);
    bat_hermite_free(&keys);
    bat_curve_set_free(&move);
    bat_curve_set_free(&poses);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
