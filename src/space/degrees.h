#pragma once

#include <math.h>
#include <stdint.h>

/// @file
/// Longitudes and latitudes in degrees, as files write them, and unit vectors.

/// The most decimals of a degree. With more, rounding could give more than 180 degrees.
#define DEGREE_MAX_DECIMALS 12

/// Longitude and latitude as integers, in units of 10^-decimals degrees as a file has them: nothing is rounded.
typedef struct degree_units
{
    int64_t longitude; ///< -180 … 180 degrees
    int64_t latitude;  ///< -90 … 90 degrees
} degree_units;

/// Null for a longitude within -360 … 360 degrees and a latitude within -90 … 90 degrees, else a text that states the error.
const char *degrees_fault(double longitude, double latitude);

/// The unit vector for a longitude and latitude in degrees; exact at multiples of 90 degrees.
void degrees_to_point(double longitude, double latitude, double point[3]);

/// The number of units in one degree, 10^decimals; `decimals` from 0 to DEGREE_MAX_DECIMALS.
int64_t degree_units_per_degree(int decimals);

/// The number of units in one radian.
static inline double degree_units_per_radian(int decimals)
{
    static const double degrees_per_radian = 57.295779513082320876798154814105;
    return degrees_per_radian * (double)degree_units_per_degree(decimals);
}

/// The longitude and latitude of a unit vector, rounded to units. Both use atan2, which is accurate at the poles.
static inline degree_units degrees_of_point(const double point[3], double units_per_radian)
{
    double across = sqrt(point[0] * point[0] + point[1] * point[1]);
    return (degree_units){llrint(atan2(point[1], point[0]) * units_per_radian),
                          llrint(atan2(point[2], across) * units_per_radian)};
}
