#ifndef IO_COMMON_DEGREES_H
#define IO_COMMON_DEGREES_H

#include "io/common/number_text.h"

#include <math.h>

/// More decimals of a degree than this, and rounding could show 180 degrees as more.
enum
{
    DEGREE_MAX_DECIMALS = 12
};

/// Longitude and latitude in degrees as integers, in units of 10^-decimals degrees: what a file shows, compared and printed
/// without rounding.
typedef struct degree_units
{
    int64_t longitude; ///< -180 … 180 degrees
    int64_t latitude;  ///< -90 … 90 degrees
} degree_units;

/// Null when the longitude is within -360 to 360 degrees and the latitude within -90 to 90, else what is wrong.
const char *degrees_fault(double longitude, double latitude);

/// The unit vector of a longitude and latitude in degrees; exact at multiples of 90 degrees.
void degrees_to_point(double longitude, double latitude, double point[3]);

/// The number of units in a radian.
static inline double degree_units_per_radian(int decimals)
{
    static const double degrees_per_radian = 57.295779513082320876798154814105;
    return degrees_per_radian * (double)number_power_of_ten(decimals);
}

/// Longitude and latitude of a unit vector, rounded to units. Both come from atan2, so that they are accurate at the poles.
static inline degree_units degrees_of_point(const double point[3], double units_per_radian)
{
    double across = sqrt(point[0] * point[0] + point[1] * point[1]);
    return (degree_units){llrint(atan2(point[1], point[0]) * units_per_radian),
                          llrint(atan2(point[2], across) * units_per_radian)};
}

#endif
