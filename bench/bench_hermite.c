// Refinement of Hermite data of order 1: new points for every second of one core, and the share of that time that
// exponentials and logarithms take. Times are the processor's, so that other programs disturb them less. A function of a
// space is measured by itself, between neighbours of the refined curve in the same run, and counted while it refines.

#include "timing.h"

#include "base/lanes.h"
#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

enum
{
    ROUNDS = 15,
    COARSE = 4096,
    LEVELS = 5,
    LANES = 4096
};

static double processor_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/// Calls of the functions that cost, and seconds that one call takes.
typedef struct usage
{
    double logs, exps, geodesics, transports;
} usage;

static usage counted;

static bat_status count_log(const bat_space *space, const double *p, const double *q, double *tangent)
{
    const bat_space *real = space->parameters;
    counted.logs++;
    return real->log(real, p, q, tangent);
}

static bat_status count_exp(const bat_space *space, const double *p, const double *tangent, double *q)
{
    const bat_space *real = space->parameters;
    counted.exps++;
    return real->exp(real, p, tangent, q);
}

static bat_status count_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    const bat_space *real = space->parameters;
    counted.geodesics++;
    return bat_space_geodesic(real, p, q, t, point);
}

static bat_status count_transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                                  double *transported)
{
    const bat_space *real = space->parameters;
    counted.transports++;
    return real->transport(real, p, q, tangent, transported);
}

static double real_inner(const bat_space *space, const double *p, const double *u, const double *v)
{
    const bat_space *real = space->parameters;
    return real->inner(real, p, u, v);
}

static double real_distance(const bat_space *space, const double *p, const double *q)
{
    const bat_space *real = space->parameters;
    return real->distance(real, p, q);
}

static const char *real_fault(const bat_space *space, const double *point)
{
    const bat_space *real = space->parameters;
    return real->fault(real, point);
}

/// The same space with functions that count their calls.
static bat_space counting(const bat_space *real)
{
    bat_space space = *real;
    space.parameters = real;
    space.log = count_log;
    space.exp = count_exp;
    space.geodesic = count_geodesic;
    space.transport = count_transport;
    space.inner = real_inner;
    space.distance = real_distance;
    space.fault = real_fault;
    return space;
}

/// A smooth walk: steps of 0.1 whose direction turns a little at each of COARSE points.
static bool make_coarse(const bat_space *space, bat_hermite_curve *coarse)
{
    size_t n = space->point_dim, k = space->tangent_dim;
    *coarse = (bat_hermite_curve){.space = space, .count = COARSE};
    coarse->points = calloc(COARSE * n, sizeof(double));
    coarse->tangents = calloc(COARSE * k, sizeof(double));
    if (coarse->points == NULL || coarse->tangents == NULL)
        return false;
    bat_random random = bat_random_seed(1);
    double goal[BAT_SPACE_MAX_DIM], way[BAT_SPACE_MAX_DIM];
    space->random_point(space, &random, coarse->points);
    for (size_t i = 0; i < COARSE; i++)
    {
        double *p = coarse->points + i * n, *v = coarse->tangents + i * k;
        space->random_point(space, &random, goal);
        if (space->log(space, p, goal, way) != BAT_OK)
            return false;
        double length = sqrt(space->inner(space, p, way, way));
        for (size_t c = 0; c < k; c++)
            v[c] += 0.3 * way[c] / length;
        length = sqrt(space->inner(space, p, v, v));
        for (size_t c = 0; c < k; c++)
        {
            v[c] /= length;
            way[c] = 0.1 * v[c];
        }
        if (i + 1 < COARSE &&
            (space->exp(space, p, way, p + n) != BAT_OK || space->transport(space, p, p + n, v, v + k) != BAT_OK))
            return false;
    }
    return true;
}

static bool refine(const bat_space *space, const bat_hermite_curve *coarse, bat_hermite_curve *fine)
{
    bat_error error;
    bat_hermite_curve data = *coarse;
    bat_hermite_refine_options options = bat_hermite_refine_defaults();
    options.levels = LEVELS;
    options.threads = 1;
    data.space = space;
    if (bat_hermite_refine(&data, &options, fine, &error) == BAT_OK)
        return true;
    (void)fprintf(stderr, "%s: %s\n", space->name, error.text);
    return false;
}

/// Seconds that a call of each function takes between neighbours of a curve.
static usage prices_on(const bat_space *space, const bat_hermite_curve *curve)
{
    size_t n = space->point_dim, calls = curve->count - 1;
    double tangent[BAT_SPACE_MAX_DIM], made[BAT_SPACE_MAX_DIM], times[5];
    for (int function = 0; function < 4; function++)
    {
        times[function] = processor_seconds();
        for (size_t i = 0; i < calls; i++)
        {
            const double *p = curve->points + i * n, *q = p + n;
            if (function == 0)
                (void)space->log(space, p, q, tangent);
            else if (function == 1)
                (void)space->exp(space, p, tangent, made);
            else if (function == 2)
                (void)bat_space_geodesic(space, p, q, 0.5, made);
            else
                (void)space->transport(space, p, q, tangent, made);
        }
    }
    times[4] = processor_seconds();
    double share = 1 / (double)calls;
    return (usage){share * (times[1] - times[0]), share * (times[2] - times[1]), share * (times[3] - times[2]),
                   share * (times[4] - times[3])};
}

LANES_CLONES
static void vector_functions(double *x, double *y)
{
    for (size_t i = 0; i < LANES; i++)
        x[i] = lane_atan2(x[i], 1) + lane_cos_root(y[i]) + lane_sinc_root(y[i]);
}

/// Seconds for an arc tangent, a sine and a cosine by vector code: the angle of an edge and the exponential of the reach,
/// which are all that an average takes on the sphere and of rotations.
static double vector_price(void)
{
    enum
    {
        REPEATS = 200
    };
    static double x[LANES], y[LANES];
    double start = processor_seconds();
    for (int repeat = 0; repeat < REPEATS; repeat++)
    {
        for (size_t i = 0; i < LANES; i++)
            y[i] = x[i] = 1e-4 * (double)i;
        vector_functions(x, y);
    }
    return (processor_seconds() - start) / (REPEATS * (double)LANES);
}

/// Seconds of the space's functions that refining takes, from counts and prices on the refined curve.
static double seconds_in_functions(const bat_space *space, const bat_hermite_curve *coarse, const bat_hermite_curve *fine)
{
    bat_space own = counting(space);
    bat_hermite_curve again = {0};
    usage price = prices_on(space, fine);
    counted = (usage){0};
    bool ready = refine(&own, coarse, &again);
    bat_hermite_free(&again);
    double seconds = counted.logs * price.logs + counted.exps * price.exps + counted.geodesics * price.geodesics +
                     counted.transports * price.transports;
    return ready ? seconds : NAN;
}

/// @param vectors whether the space has vector code
static void bench_space(const bat_space *space, bool vectors, double floor)
{
    bat_hermite_curve coarse, fine = {0};
    double seconds[ROUNDS], shares[ROUNDS], made = 0;
    bool ready = make_coarse(space, &coarse) && refine(space, &coarse, &fine);
    for (int round = 0; round < ROUNDS && ready; round++)
    {
        bat_hermite_free(&fine);
        double start = processor_seconds();
        ready = refine(space, &coarse, &fine);
        seconds[round] = processor_seconds() - start;
        made = (double)(fine.count - coarse.count);
        double inside = vectors ? made * vector_price() : ready ? seconds_in_functions(space, &coarse, &fine) : 0;
        shares[round] = inside / seconds[round];
    }
    bat_hermite_free(&fine);
    bat_hermite_free(&coarse);
    if (!ready)
        return;
    (void)printf("%-10s R^%zu %7.2f million new points a second", space->name, space->point_dim,
                 1e-6 * made / median_of(seconds, ROUNDS));
    if (floor > 0)
        (void)printf(" (floor %g)", floor);
    if (vectors)
        (void)printf("; arc tangent, sine and cosine by vector code");
    else
        (void)printf("; %.1f logarithms, %.1f exponentials and %.1f geodesics a point", counted.logs / made,
                     counted.exps / made, counted.geodesics / made);
    (void)printf(": %.2f of the time\n", median_of(shares, ROUNDS));
}

/// The most memory that the program held while a million rotations with times were refined by 3 levels, over the result's.
static void bench_memory(const bat_space *rotation)
{
    const size_t count = 1000000, levels = 3, turns = 1000;
    const size_t row = (rotation->point_dim + rotation->tangent_dim + 1) * sizeof(double);
    bat_hermite_curve coarse = {.space = rotation, .count = count}, fine = {0};
    coarse.points = calloc(count * rotation->point_dim, sizeof(double));
    coarse.tangents = calloc(count * rotation->tangent_dim, sizeof(double));
    coarse.times = calloc(count, sizeof(double));
    bat_hermite_refine_options options = bat_hermite_refine_defaults();
    options.levels = levels;
    options.threads = 1;
    for (size_t i = 0; i < count && coarse.points != NULL && coarse.tangents != NULL && coarse.times != NULL; i++)
    {
        double half = 3.14159265358979323846 * (double)(turns * i) / (double)count;
        coarse.times[i] = (double)i;
        coarse.points[4 * i] = cos(half);
        coarse.points[4 * i + 1] = sin(half);
        coarse.tangents[3 * i] = 1;
    }
    bat_error error = {.text = "out of memory"};
    struct rusage used;
    if (coarse.times != NULL && bat_hermite_refine(&coarse, &options, &fine, &error) == BAT_OK &&
        getrusage(RUSAGE_SELF, &used) == 0)
        (void)printf(
            "a million rotations with times, %zu levels: %.0f MB at most in the whole program, %.2f times the result "
            "(floor 3)\n",
            levels, 1e-3 * (double)used.ru_maxrss, 1024 * (double)used.ru_maxrss / (double)(fine.count * row));
    else
        (void)fprintf(stderr, "memory: %s\n", error.text);
    bat_hermite_free(&fine);
    bat_hermite_free(&coarse);
}

int main(void)
{
    bat_space sphere = bat_sphere(2), rotation = bat_rotation(), tensor = bat_positive_definite(3), rigid, disk = bat_disk(),
              solid = bat_euclidean(3);
    (void)printf("Hermite Lane-Riesenfeld of order 1, one thread\n");
    bench_space(&sphere, true, 5);
    bench_space(&rotation, true, 3);
    bench_space(&tensor, false, 0.3);
    bench_space(&disk, false, 0);
    if (bat_rigid(1, &rigid, NULL) == BAT_OK)
        bench_space(&rigid, false, 0);
    bench_space(&solid, false, 0);
    bench_memory(&rotation);
    return 0;
}
