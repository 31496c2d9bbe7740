// Splines in time: poses of 10,000 keys at a million times on one thread, with and without velocities and accelerations,
// over scipy's RotationSpline and CubicSpline in the same run (bench/peer_motion_spline.py, run by $PYTHON or
// /usr/bin/python3, where there is one); and one query alone. Making the splines counts on both sides. And splines of a
// user's rotations over those of the library.

#include "timing.h"

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum
{
    KEYS = 10000,
    QUERIES = 1000000,
    SINGLE = 200000,
    ROUNDS = 5,
    PATH = 512
};

/// Seconds of the processor, which other programs disturb less.
static double processor_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double points[KEYS * 7], times[KEYS], queries[QUERIES], poses[QUERIES * 7], velocities[QUERIES * 6],
    accelerations[QUERIES * 6], peer_poses[QUERIES * 7];

static void make_keys(void)
{
    bat_random random = bat_random_seed(1);
    for (size_t i = 0; i < KEYS; i++)
    {
        double t = times[i] = (double)i + 0.4 * bat_random_uniform(&random), *p = points + 7 * i;
        const double vector[3] = {sin(0.3 * t), cos(0.2 * t), sin(0.11 * t)};
        (void)bat_rotation_from_vector(vector, p + 3, NULL);
        p[0] = 20 * sin(0.07 * t);
        p[1] = 30 * cos(0.03 * t);
        p[2] = sin(0.2 * t);
    }
}

static void make_queries(bool sorted)
{
    bat_random random = bat_random_seed(2);
    double begin = times[0], end = times[KEYS - 1];
    for (size_t i = 0; i < QUERIES; i++)
        queries[i] = begin + (end - begin) * (sorted ? (double)i / (QUERIES - 1) : bat_random_uniform(&random));
}

/// Seconds of a spline and QUERIES poses, one thread.
static double time_sampling(const bat_hermite_curve *keys, bool rates)
{
    bat_motion_spline_options options = bat_motion_spline_defaults();
    double spent[ROUNDS];
    options.threads = 1;
    for (int round = 0; round < ROUNDS; round++)
    {
        bat_motion_spline *spline;
        double start = processor_seconds();
        if (bat_motion_spline_make(keys, &options, &spline, NULL) != BAT_OK ||
            bat_motion_spline_sample(spline, queries, QUERIES, poses, rates ? velocities : NULL,
                                     rates ? accelerations : NULL, NULL) != BAT_OK)
            (void)fprintf(stderr, "the spline failed\n");
        spent[round] = processor_seconds() - start;
        bat_motion_spline_free(spline);
    }
    double least = spent[0];
    for (int round = 1; round < ROUNDS; round++)
        least = fmin(least, spent[round]);
    return least;
}

/// Seconds of one query.
static double time_query(const bat_hermite_curve *keys, bool rates)
{
    bat_motion_spline *spline;
    double pose[7], velocity[6], acceleration[6], sum = 0;
    if (bat_motion_spline_make(keys, NULL, &spline, NULL) != BAT_OK)
        return NAN;
    double start = processor_seconds();
    for (size_t i = 0; i < SINGLE; i++)
    {
        (void)bat_motion_spline_at(spline, queries[i], pose, rates ? velocity : NULL, rates ? acceleration : NULL, NULL);
        sum += pose[3];
    }
    double spent = processor_seconds() - start;
    bat_motion_spline_free(spline);
    return isfinite(sum) ? spent / SINGLE : NAN;
}

static bat_status slow_log(const bat_space *space, const double *p, const double *q, double *tangent)
{
    const bat_space *rotation = space->parameters;
    return rotation->log(rotation, p, q, tangent);
}

/// The time to make splines through the rotations of the keys, as a user's space, over that of the library's.
static double compare_user(void)
{
    static double rotations[KEYS * 4];
    bat_space spaces[2] = {bat_rotation(), bat_rotation()};
    double least[2] = {INFINITY, INFINITY};
    spaces[1].name = "user's rotations";
    spaces[1].log = slow_log;
    spaces[1].parameters = &spaces[0];
    for (size_t i = 0; i < KEYS; i++)
        memcpy(rotations + 4 * i, points + 7 * i + 3, 4 * sizeof *rotations);
    for (int round = 0; round < 2 * ROUNDS; round++)
    {
        bat_hermite_curve keys = {.space = &spaces[round % 2], .points = rotations, .times = times, .count = KEYS};
        bat_motion_spline *spline = NULL;
        double start = processor_seconds();
        if (bat_motion_spline_make(&keys, NULL, &spline, NULL) == BAT_OK)
            least[round % 2] = fmin(least[round % 2], processor_seconds() - start);
        bat_motion_spline_free(spline);
    }
    return least[1] / least[0];
}

static bool write_doubles(const char *path, const double *values, size_t count)
{
    FILE *file = fopen(path, "wb");
    bool written = file != NULL && fwrite(values, sizeof *values, count, file) == count;
    return file != NULL && fclose(file) == 0 && written;
}

/// Run the peer; false where there is none.
static bool run_peer(double seconds[2])
{
    static double rows[KEYS * 8];
    char folder[] = "/tmp/bench-XXXXXX", command[4 * PATH], keys[PATH], at[PATH], made[PATH];
    const char *python = getenv("PYTHON") != NULL ? getenv("PYTHON") : "/usr/bin/python3";
    if (mkdtemp(folder) == NULL)
        return false;
    (void)snprintf(keys, PATH, "%s/keys", folder);
    (void)snprintf(at, PATH, "%s/times", folder);
    (void)snprintf(made, PATH, "%s/poses", folder);
    for (size_t i = 0; i < KEYS; i++)
    {
        rows[8 * i] = times[i];
        memcpy(rows + 8 * i + 1, points + 7 * i, 7 * sizeof *rows);
    }
    bool done = write_doubles(keys, rows, (size_t)KEYS * 8) && write_doubles(at, queries, QUERIES);
    (void)snprintf(command, sizeof command,
                   "OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 '%s' '%s/peer_motion_spline.py' '%s' %d '%s' '%s'", python,
                   BENCH_FOLDER, keys, QUERIES, at, made);
    FILE *peer = done ? popen(command, "r") : NULL;
    done = peer != NULL && fscanf(peer, "%lf %lf", &seconds[0], &seconds[1]) == 2;
    done = peer != NULL && pclose(peer) == 0 && done;
    FILE *file = done ? fopen(made, "rb") : NULL;
    done = file != NULL && fread(peer_poses, sizeof *peer_poses, (size_t)QUERIES * 7, file) == (size_t)QUERIES * 7;
    if (file != NULL)
        (void)fclose(file);
    (void)remove(keys);
    (void)remove(at);
    (void)remove(made);
    (void)rmdir(folder);
    return done;
}

int main(void)
{
    bat_space rigid;
    (void)bat_rigid(1, &rigid, NULL);
    make_keys();
    bat_hermite_curve keys = {.space = &rigid, .points = points, .times = times, .count = KEYS};
    for (int sorted = 1; sorted >= 0; sorted--)
    {
        double peer[2];
        make_queries(sorted != 0);
        bool compared = run_peer(peer);
        double rates = time_sampling(&keys, true), alone = time_sampling(&keys, false), apart = 0;
        for (size_t i = 0; i < QUERIES && compared; i++)
            apart = fmax(apart, rigid.distance(&rigid, poses + 7 * i, peer_poses + 7 * i));
        (void)printf("a million %s times: poses %.0f ns each, with velocities and accelerations %.0f ns",
                     sorted ? "sorted" : "random", 1e9 * alone / QUERIES, 1e9 * rates / QUERIES);
        if (compared)
            (void)printf("; scipy takes %.1f and %.1f times as long (floors 20 and 10); poses at most %.2g apart",
                         peer[0] / alone, peer[1] / rates, apart);
        (void)printf("\n");
    }
    (void)printf("one random query: pose %.3f microseconds (floor 0.3), with velocity and acceleration %.3f\n",
                 1e6 * time_query(&keys, false), 1e6 * time_query(&keys, true));
    (void)printf("a user's rotations: %.2f times the library's time (floor 3)\n", compare_user());
    return EXIT_SUCCESS;
}
