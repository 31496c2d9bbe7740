#ifndef TESTS_SUPPORT_CLOUD_HELPERS_H
#define TESTS_SUPPORT_CLOUD_HELPERS_H

// Clouds for tests: from functions of the square, shuffled, compared.

#include "check.h"

#include "batten/cloud.h"
#include "batten/cloud_file.h"

static inline double distance_of(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static inline double distance_to_segment(const double *p, const double *a, const double *b)
{
    double along = 0, whole = 0, foot[3];
    for (int k = 0; k < 3; k++)
    {
        along += (p[k] - a[k]) * (b[k] - a[k]);
        whole += (b[k] - a[k]) * (b[k] - a[k]);
    }
    double share = whole > 0 ? fmin(fmax(along / whole, 0), 1) : 0;
    for (int k = 0; k < 3; k++)
        foot[k] = a[k] + share * (b[k] - a[k]);
    return distance_of(p, foot);
}

/// The greatest and the mean distance of points from a closed line.
static inline double distance_to_loop(const double *points, size_t count, const double *loop, size_t loop_count,
                                      double *mean)
{
    double greatest = 0;
    *mean = 0;
    for (size_t i = 0; i < count; i++)
    {
        double least = INFINITY;
        for (size_t j = 0; j < loop_count; j++)
            least = fmin(least, distance_to_segment(points + 3 * i, loop + 3 * j, loop + 3 * ((j + 1) % loop_count)));
        greatest = fmax(greatest, least);
        *mean += least / (double)count;
    }
    return greatest;
}

/// Exchange points at random and forget the boundary.
static inline void shuffle_cloud(bat_cloud *cloud, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t i = cloud->count - 1; i > 0; i--)
    {
        size_t j = (size_t)(bat_random_bits(&random) % (i + 1));
        for (size_t k = 0; k < 3; k++)
        {
            double kept = cloud->points[3 * i + k];
            cloud->points[3 * i + k] = cloud->points[3 * j + k];
            cloud->points[3 * j + k] = kept;
        }
    }
    cloud->boundary_count = 0;
    cloud->has_corners = false;
}

static inline void add_point(bat_cloud *cloud, double x, double y, double z)
{
    cloud->points = realloc(cloud->points, (cloud->count + 1) * 3 * sizeof *cloud->points);
    double *point = cloud->points + 3 * cloud->count++;
    point[0] = x;
    point[1] = y;
    point[2] = z;
}

/// Append a ring of points about the z axis.
/// @param turn the angle of the first, in steps
static inline void add_ring(bat_cloud *cloud, double radius, double height, size_t count, double turn)
{
    for (size_t k = 0; k < count; k++)
    {
        double angle = 2 * 3.14159265358979323846 * ((double)k + turn) / (double)count;
        add_point(cloud, radius * cos(angle), radius * sin(angle), height);
    }
}

/// Where a side of the square is at a share of the way around it, counter-clockwise from (0, 0).
static inline void around_square(double share, double *u, double *v)
{
    double s = 4 * share;
    *u = s < 1 ? s : s < 2 ? 1 : s < 3 ? 3 - s : 0;
    *v = s < 1 ? 0 : s < 2 ? s - 1 : s < 3 ? 1 : 4 - s;
}

static inline bool is_same_loop(const double *a, const double *b, size_t count)
{
    for (size_t shift = 0; shift < count; shift++)
        for (int turned = 0; turned < 2; turned++)
        {
            size_t i = 0;
            while (i < count &&
                   memcmp(a + 3 * i, b + 3 * ((turned ? 2 * count + shift - i : shift + i) % count), 3 * sizeof *a) == 0)
                i++;
            if (i == count)
                return true;
        }
    return false;
}

#endif
