#include "research/shapes/surface_scan.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector3.h"
#include "research/data/wave.h"

#include <stdlib.h>

/// Standard deviation of the noise, of a shape about 1 long.
#define SCAN_NOISE 0.0012
/// Lines are so many times as far apart as points along them.
#define LINE_DISTANCE 1.8
/// The grid on which the share of points that are seen is estimated.
#define TRIAL_CELLS 64

/// Lines over a rectangle of the parameters.
typedef struct scan_sweep
{
    int along; ///< the parameter that lines run in
    double low[2], high[2];
} scan_sweep;

/// The first sweep takes everything, the second goes over a part once more, across.
static const scan_sweep SWEEPS[] = {{0, {0, 0}, {1, 1}}, {1, {0.58, 0.3}, {0.9, 0.8}}};

enum
{
    SWEEP_COUNT = sizeof SWEEPS / sizeof SWEEPS[0]
};

/// Beside the nose, in parameters: the middle of the gap and its half-axes.
static const double GAP[2] = {0.615, 0.405}, GAP_SIZE[2] = {0.034, 0.024};

/// The chance that a point is seen: none in the gap, less where the surface is steep.
static double chance_at(const surface_shape *shape, const double parameter[2])
{
    double x = (parameter[0] - GAP[0]) / GAP_SIZE[0], y = (parameter[1] - GAP[1]) / GAP_SIZE[1];
    if (x * x + y * y < 1)
        return 0;
    const double step = 1e-4;
    double at[3], right[3], above[3], normal[3];
    shape->at(shape, parameter, at);
    shape->at(shape, (double[2]){parameter[0] + step, parameter[1]}, right);
    shape->at(shape, (double[2]){parameter[0], parameter[1] + step}, above);
    vector3_subtract(right, at, right);
    vector3_subtract(above, at, above);
    vector3_cross(right, above, normal);
    double facing = normal[2] / sqrt(vector3_dot(normal, normal));
    return fmin(fmax(1.25 * facing, 0.25), 1);
}

static bool within(const scan_sweep *sweep, const double parameter[2])
{
    return parameter[0] >= sweep->low[0] && parameter[0] <= sweep->high[0] && parameter[1] >= sweep->low[1] &&
           parameter[1] <= sweep->high[1];
}

/// The area of the parameters that sweeps see, counted once for each sweep, points that are not seen less their chance.
static double seen_area(const surface_shape *shape)
{
    double sum = 0;
    for (int i = 0; i < TRIAL_CELLS * TRIAL_CELLS; i++)
    {
        int column = i % TRIAL_CELLS, row = i / TRIAL_CELLS;
        double parameter[2] = {(column + 0.5) / TRIAL_CELLS, (row + 0.5) / TRIAL_CELLS};
        double chance = chance_at(shape, parameter);
        for (int s = 0; s < SWEEP_COUNT; s++)
            sum += within(&SWEEPS[s], parameter) ? chance : 0;
    }
    return sum / (TRIAL_CELLS * TRIAL_CELLS);
}

/// The parameters of point `index` of `count` on line `line` of `lines`: every line begins a little elsewhere and wavers.
static void scan_point(const scan_sweep *sweep, size_t line, size_t lines, size_t index, size_t count, bat_random *random,
                       double parameter[2])
{
    int along = sweep->along;
    double share = ((double)index + bat_random_uniform(random)) / (double)count;
    double place =
        ((double)line + 0.5 + 0.1 * sin(9 * share + (double)line) + 0.06 * bat_random_normal(random)) / (double)lines;
    const double shares[2] = {along == 0 ? share : place, along == 0 ? place : share};
    for (int c = 0; c < 2; c++)
        parameter[c] = fmin(fmax(sweep->low[c] + shares[c] * (sweep->high[c] - sweep->low[c]), 0), 1);
}

/// Sweep with a distance between neighbours along lines, in parameters; hand back the number of points seen.
/// @param parameters receives `room` x 2 at most
static size_t sweep_all(const surface_shape *shape, double distance, bat_random *random, size_t room, double *parameters)
{
    size_t seen = 0;
    for (int s = 0; s < SWEEP_COUNT; s++)
    {
        const scan_sweep *sweep = &SWEEPS[s];
        double along = sweep->high[sweep->along] - sweep->low[sweep->along];
        double across = sweep->high[1 - sweep->along] - sweep->low[1 - sweep->along];
        size_t lines = (size_t)fmax(1, rint(across / (LINE_DISTANCE * distance)));
        size_t count = (size_t)fmax(1, rint(along / distance));
        for (size_t line = 0; line < lines; line++)
            for (size_t i = 0; i < count && seen < room; i++)
            {
                double *parameter = parameters + 2 * seen;
                scan_point(sweep, line, lines, i, count, random, parameter);
                seen += bat_random_uniform(random) < chance_at(shape, parameter);
            }
    }
    return seen;
}

static void shuffle(double *parameters, size_t count, bat_random *random)
{
    for (size_t i = count; i > 1; i--)
    {
        size_t other = (size_t)(bat_random_uniform(random) * (double)i);
        double *a = parameters + 2 * (i - 1), *b = parameters + 2 * other;
        for (int c = 0; c < 2; c++)
        {
            double kept = a[c];
            a[c] = b[c];
            b[c] = kept;
        }
    }
}

bat_status surface_scan(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                        bat_error *error)
{
    double distance = sqrt(seen_area(shape) / (LINE_DISTANCE * (double)points));
    size_t room = points + points / 4 + 64;
    sampled_cloud made = {.cloud.points = memory_array(room, 3 * sizeof(double)),
                          .parameters = memory_array(room, 2 * sizeof(double))};
    if (made.cloud.points == NULL || made.parameters == NULL)
    {
        sampled_cloud_free(&made);
        return error_memory(error, room * 3 * sizeof(double));
    }
    made.cloud.count = sweep_all(shape, distance, random, room, made.parameters);
    shuffle(made.parameters, made.cloud.count, random);
    for (size_t i = 0; i < made.cloud.count; i++)
        shape->at(shape, made.parameters + 2 * i, made.cloud.points + 3 * i);
    cloud_add_noise(&made.cloud, SCAN_NOISE, random);
    *sampled = made;
    return BAT_OK;
}
