/// @file
/// Sampling of surfaces.
///
/// Even sampling: the surface is divided into strips of equal width across its longer direction. Each strip receives points
/// in proportion to its area, in a jittered pattern. Arc lengths and areas are tabulated on a grid and inverted by linear
/// interpolation.
///
/// Simulated scan along z: scan lines, denser along lines than across, a second sweep over a part, fewer points on steep
/// parts, a gap, noise, random order.

#include "research/shapes/cloud_sampling.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"
#include "research/data/wave.h"

#include <stdlib.h>

void sampled_cloud_free(sampled_cloud *sampled)
{
    free(sampled->cloud.points);
    free(sampled->parameters);
    *sampled = (sampled_cloud){0};
}

bat_status sampled_cloud_make(const size_t steps[4], size_t interior, sampled_cloud *sampled, bat_error *error)
{
    const size_t maximum = SIZE_MAX / (16 * sizeof(double)) / 8;
    bat_cloud cloud = {.has_corners = true};
    for (int s = 0; s < 4; s++)
    {
        if (steps[s] > maximum || interior > maximum)
            return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "a cloud of this many points is too large");
        cloud.corners[s] = cloud.boundary_count;
        cloud.boundary_count += steps[s];
    }
    cloud.count = cloud.boundary_count + interior;
    cloud.points = memory_array(cloud.count, 3 * sizeof(double));
    sampled_cloud made = {.cloud = cloud, .parameters = memory_array(cloud.count, 2 * sizeof(double))};
    if (made.cloud.points == NULL || made.parameters == NULL)
    {
        sampled_cloud_free(&made);
        return error_memory(error, cloud.count * 3 * sizeof(double));
    }
    *sampled = made;
    return BAT_OK;
}

void sampled_cloud_move(sampled_cloud *sampled, bat_cloud *cloud, double **parameters)
{
    *cloud = sampled->cloud;
    if (parameters != NULL)
        *parameters = sampled->parameters;
    else
        free(sampled->parameters);
    *sampled = (sampled_cloud){0};
}

void cloud_add_noise(bat_cloud *cloud, double deviation, bat_random *random)
{
    for (size_t i = 0; i < 3 * cloud->count; i++)
        cloud->points[i] += deviation * bat_random_normal(random);
}

/// Cells of the grid on which lengths and areas are measured, in each direction.
#define CELLS 192
/// Points are displaced from the pattern by up to half of this fraction of the spacing.
#define JITTER 0.6

/// Cumulative lengths and areas on a grid over the square, to be inverted.
typedef struct measured_surface
{
    int along;                       ///< the parameter direction in which the surface is longer
    double length[CELLS + 1];        ///< mean length along, up to a line of the grid
    double area[CELLS + 1];          ///< area up to a line of the grid
    double across[CELLS][CELLS + 1]; ///< for each strip of cells: area up to a line across
    double width[CELLS];             ///< length of each strip of cells across
    double sides[4][CELLS + 1];      ///< length of each side up to a line
} measured_surface;

/// The area of a quadrilateral cell, from its diagonals.
static double cell_area(const double *a, const double *b, const double *c, const double *d)
{
    double first[3], second[3], normal[3];
    vector3_subtract(c, a, first);
    vector3_subtract(d, b, second);
    vector3_cross(first, second, normal);
    return 0.5 * sqrt(vector3_dot(normal, normal));
}

/// A point of the grid; the first index is along.
static double *grid_point(double *grid, size_t i, size_t j)
{
    return grid + 3 * (i * (CELLS + 1) + j);
}

static void fill_grid(const surface_shape *shape, int along, double *grid)
{
    for (size_t i = 0; i <= CELLS; i++)
        for (size_t j = 0; j <= CELLS; j++)
        {
            double parameter[2];
            parameter[along] = (double)i / CELLS;
            parameter[1 - along] = (double)j / CELLS;
            shape->at(shape, parameter, grid_point(grid, i, j));
        }
}

/// The mean length of the grid lines along.
static double mean_length(double *grid)
{
    double sum = 0;
    for (size_t i = 0; i < CELLS; i++)
        for (size_t j = 0; j <= CELLS; j++)
            sum += vector3_distance(grid_point(grid, i, j), grid_point(grid, i + 1, j));
    return sum / (CELLS + 1);
}

static void measure_strips(double *grid, measured_surface *measured)
{
    measured->length[0] = measured->area[0] = 0;
    for (size_t i = 0; i < CELLS; i++)
    {
        double length = 0, *across = measured->across[i];
        across[0] = measured->width[i] = 0;
        for (size_t j = 0; j < CELLS; j++)
        {
            const double *a = grid_point(grid, i, j), *b = grid_point(grid, i + 1, j);
            const double *c = grid_point(grid, i + 1, j + 1), *d = grid_point(grid, i, j + 1);
            across[j + 1] = across[j] + cell_area(a, b, c, d);
            length += vector3_distance(a, b) / CELLS;
            measured->width[i] += vector3_distance(a, d);
        }
        measured->length[i + 1] = measured->length[i] + length;
        measured->area[i + 1] = measured->area[i] + across[CELLS];
    }
}

static void measure_sides(const surface_shape *shape, measured_surface *measured)
{
    for (int s = 0; s < 4; s++)
    {
        double before[3], at[3], parameter[2];
        square_side_at(s, 0, parameter);
        shape->at(shape, parameter, before);
        measured->sides[s][0] = 0;
        for (size_t i = 1; i <= CELLS; i++)
        {
            square_side_at(s, (double)i / CELLS, parameter);
            shape->at(shape, parameter, at);
            measured->sides[s][i] = measured->sides[s][i - 1] + vector3_distance(before, at);
            for (int c = 0; c < 3; c++)
                before[c] = at[c];
        }
    }
}

static bat_status measure_surface(const surface_shape *shape, measured_surface *measured, bat_error *error)
{
    const size_t count = (size_t)(CELLS + 1) * (CELLS + 1);
    double *grid = memory_array(count, 3 * sizeof *grid);
    if (grid == NULL)
        return error_memory(error, count * 3 * sizeof *grid);
    fill_grid(shape, 1, grid);
    double second = mean_length(grid);
    fill_grid(shape, 0, grid);
    measured->along = second > mean_length(grid);
    if (measured->along == 1)
        fill_grid(shape, 1, grid);
    measure_strips(grid, measured);
    measure_sides(shape, measured);
    free(grid);
    return BAT_OK;
}

/// Inverse of a cumulative table: the position in [0, 1] at which the sums reach a fraction of the total.
static double place_of_share(const double *sums, double share)
{
    double target = share * sums[CELLS];
    size_t low = 0, high = CELLS;
    while (high - low > 1)
    {
        size_t middle = (low + high) / 2;
        *(sums[middle] <= target ? &low : &high) = middle;
    }
    return fmin(((double)low + (target - sums[low]) / fmax(sums[high] - sums[low], 1e-300)) / CELLS, 1);
}

/// The cumulative sum at a position.
static double sum_at_place(const double *sums, double place)
{
    size_t cell = (size_t)fmin(place * CELLS, CELLS - 1);
    return sums[cell] + (place * CELLS - (double)cell) * (sums[cell + 1] - sums[cell]);
}

/// The spacing h of n points. area / h^2 points fill the surface. The boundary of length L replaces the points of half a
/// spacing along it by L / h points. Solves n h^2 - (L / 2) h - area = 0.
static double pattern_distance(const measured_surface *measured, size_t points)
{
    double area = measured->area[CELLS], half_perimeter = 0;
    for (int s = 0; s < 4; s++)
        half_perimeter += 0.5 * measured->sides[s][CELLS];
    double root = sqrt(half_perimeter * half_perimeter + 4 * area * (double)points);
    return (half_perimeter + root) / (2 * (double)points);
}

/// Map [0, 1] to an interval that leaves half a step free at both ends.
static double leave_ends(double share, double step)
{
    double margin = fmin(0.5 * step, 0.25);
    return margin + (1 - 2 * margin) * share;
}

static double jittered(double place, size_t count, bat_random *random)
{
    return fmin(fmax((place + JITTER * (bat_random_uniform(random) - 0.5)) / (double)count, 0), 1);
}

/// Set the parameters of the interior points.
static void spread_inside(const measured_surface *measured, double distance, bat_random *random, sampled_cloud *sampled)
{
    size_t interior = sampled->cloud.count - sampled->cloud.boundary_count, done = 0;
    double *parameter = sampled->parameters + 2 * sampled->cloud.boundary_count;
    double step = distance / measured->length[CELLS];
    size_t strips = (size_t)fmax(1, rint(1 / step) - 1);
    double begin = sum_at_place(measured->area, place_of_share(measured->length, leave_ends(0, step)));
    double complete = sum_at_place(measured->area, place_of_share(measured->length, leave_ends(1, step))) - begin;
    for (size_t strip = 0; strip < strips; strip++)
    {
        double end = place_of_share(measured->length, leave_ends((double)(strip + 1) / (double)strips, step));
        double share = strip + 1 < strips ? (sum_at_place(measured->area, end) - begin) / complete : 1;
        size_t until = (size_t)fmin(rint(share * (double)interior), (double)interior), count = until - done;
        for (size_t i = 0; i < count; i++, parameter += 2)
        {
            double place = place_of_share(measured->length, leave_ends(jittered((double)strip + 0.5, strips, random), step));
            size_t cell = (size_t)fmin(place * CELLS, CELLS - 1);
            // Consecutive strips are staggered.
            double stagger = strip % 2 == 0 ? 0.25 : 0.75;
            double across = leave_ends(jittered((double)i + stagger, count, random), distance / measured->width[cell]);
            parameter[measured->along] = place;
            parameter[1 - measured->along] = place_of_share(measured->across[cell], across);
        }
        done = until;
    }
}

static void spread_boundary(const measured_surface *measured, const size_t steps[4], double *parameter)
{
    for (int s = 0; s < 4; s++)
        for (size_t i = 0; i < steps[s]; i++, parameter += 2)
            square_side_at(s, place_of_share(measured->sides[s], (double)i / (double)steps[s]), parameter);
}

static bat_status spread_measured(const surface_shape *shape, const measured_surface *measured, size_t points,
                                  bat_random *random, sampled_cloud *sampled, bat_error *error)
{
    double distance = pattern_distance(measured, points);
    size_t steps[4], boundary = 0;
    for (int s = 0; s < 4; s++)
    {
        steps[s] = (size_t)fmax(1, rint(measured->sides[s][CELLS] / distance));
        boundary += steps[s];
    }
    bat_status status = sampled_cloud_make(steps, points > boundary ? points - boundary : 0, sampled, error);
    if (status != BAT_OK)
        return status;
    spread_boundary(measured, steps, sampled->parameters);
    spread_inside(measured, distance, random, sampled);
    for (size_t i = 0; i < sampled->cloud.count; i++)
        shape->at(shape, sampled->parameters + 2 * i, sampled->cloud.points + 3 * i);
    return BAT_OK;
}

bat_status cloud_sample_evenly(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                               bat_error *error)
{
    measured_surface *measured = malloc(sizeof *measured);
    if (measured == NULL)
        return error_memory(error, sizeof *measured);
    bat_status status = measure_surface(shape, measured, error);
    if (status == BAT_OK)
        status = spread_measured(shape, measured, points, random, sampled, error);
    free(measured);
    return status;
}

/// Standard deviation of the noise, for a shape about 1 long.
#define SCAN_NOISE 0.0012
/// Ratio of the distance between lines to the spacing of points along them.
#define LINE_DISTANCE 1.8
/// Cells of the grid on which the visible area is estimated, in each direction.
#define TRIAL_CELLS 64

/// Scan lines over a rectangle of parameters.
typedef struct scan_sweep
{
    int along; ///< direction of the lines
    double low[2], high[2];
} scan_sweep;

/// The first sweep covers the whole square, the second one a part of it in the other direction.
static const scan_sweep SWEEPS[] = {{0, {0, 0}, {1, 1}}, {1, {0.58, 0.3}, {0.9, 0.8}}};

enum
{
    SWEEP_COUNT = sizeof SWEEPS / sizeof SWEEPS[0]
};

/// Centre and semi-axes of the gap, in parameters.
static const double GAP_CENTRE[2] = {0.615, 0.405}, GAP_SIZE[2] = {0.034, 0.024};

/// The probability that a point is scanned: 0 in the gap, smaller where the surface is steep.
static double visibility_at(const surface_shape *shape, const double parameter[2])
{
    double x = (parameter[0] - GAP_CENTRE[0]) / GAP_SIZE[0], y = (parameter[1] - GAP_CENTRE[1]) / GAP_SIZE[1];
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

/// The expected scanned area of the parameter square, summed over the sweeps.
static double visible_area(const surface_shape *shape)
{
    double sum = 0;
    for (int i = 0; i < TRIAL_CELLS * TRIAL_CELLS; i++)
    {
        int column = i % TRIAL_CELLS, row = i / TRIAL_CELLS;
        double parameter[2] = {(column + 0.5) / TRIAL_CELLS, (row + 0.5) / TRIAL_CELLS};
        double visibility = visibility_at(shape, parameter);
        for (int s = 0; s < SWEEP_COUNT; s++)
            sum += within(&SWEEPS[s], parameter) ? visibility : 0;
    }
    return sum / (TRIAL_CELLS * TRIAL_CELLS);
}

/// The parameters of point `index` of `count` on line `line` of `lines`, with random start and waviness of the lines.
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

/// Perform all sweeps with a spacing along lines, in parameters.
/// @param parameters receives at most `room` x 2
/// @return the number of scanned points
static size_t sweep_surface(const surface_shape *shape, double distance, bat_random *random, size_t room, double *parameters)
{
    size_t count_visible = 0;
    for (int s = 0; s < SWEEP_COUNT; s++)
    {
        const scan_sweep *sweep = &SWEEPS[s];
        double along = sweep->high[sweep->along] - sweep->low[sweep->along];
        double across = sweep->high[1 - sweep->along] - sweep->low[1 - sweep->along];
        size_t lines = (size_t)fmax(1, rint(across / (LINE_DISTANCE * distance)));
        size_t count = (size_t)fmax(1, rint(along / distance));
        for (size_t line = 0; line < lines; line++)
            for (size_t i = 0; i < count && count_visible < room; i++)
            {
                double *parameter = parameters + 2 * count_visible;
                scan_point(sweep, line, lines, i, count, random, parameter);
                count_visible += bat_random_uniform(random) < visibility_at(shape, parameter);
            }
    }
    return count_visible;
}

static void shuffle(double *parameters, size_t count, bat_random *random)
{
    for (size_t i = count; i > 1; i--)
    {
        size_t other = (size_t)(bat_random_uniform(random) * (double)i);
        double *a = parameters + 2 * (i - 1), *b = parameters + 2 * other;
        for (int c = 0; c < 2; c++)
        {
            double swap = a[c];
            a[c] = b[c];
            b[c] = swap;
        }
    }
}

bat_status cloud_sample_scan(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                             bat_error *error)
{
    double distance = sqrt(visible_area(shape) / (LINE_DISTANCE * (double)points));
    size_t room = points + points / 4 + 64;
    sampled_cloud made = {.cloud.points = memory_array(room, 3 * sizeof(double)),
                          .parameters = memory_array(room, 2 * sizeof(double))};
    if (made.cloud.points == NULL || made.parameters == NULL)
    {
        sampled_cloud_free(&made);
        return error_memory(error, room * 3 * sizeof(double));
    }
    made.cloud.count = sweep_surface(shape, distance, random, room, made.parameters);
    shuffle(made.parameters, made.cloud.count, random);
    for (size_t i = 0; i < made.cloud.count; i++)
        shape->at(shape, made.parameters + 2 * i, made.cloud.points + 3 * i);
    cloud_add_noise(&made.cloud, SCAN_NOISE, random);
    *sampled = made;
    return BAT_OK;
}
