#include "space/degrees.h"

#include <stddef.h>

/// @file
/// Trigonometric functions of degrees, exact at multiples of 90 degrees.

int64_t degree_units_per_degree(int decimals)
{
    int64_t units = 1;
    for (int i = 0; i < decimals; i++)
        units *= 10;
    return units;
}

const char *degrees_fault(double longitude, double latitude)
{
    if (!(fabs(latitude) <= 90.0))
        return "a latitude outside -90 to 90 degrees";
    if (!(fabs(longitude) <= 360.0))
        return "a longitude outside -360 to 360 degrees";
    return NULL;
}

/// Sine and cosine for |degrees| <= 360, reduced exactly to |angle| <= 45 degrees.
static void degrees_sine_cosine(double degrees, double *sine, double *cosine)
{
    static const double radians_per_degree = 0.017453292519943295769236907684886;
    double quarter = nearbyint(degrees / 90.0);
    double rest = (degrees - 90.0 * quarter) * radians_per_degree;
    const double s = sin(rest), c = cos(rest), turned[] = {s, c, -s, -c};
    int quarters = (int)quarter & 3;
    *sine = turned[quarters];
    *cosine = turned[(quarters + 1) & 3];
}

void degrees_to_point(double longitude, double latitude, double point[3])
{
    double sine_longitude, cosine_longitude, sine_latitude, cosine_latitude;
    degrees_sine_cosine(longitude, &sine_longitude, &cosine_longitude);
    degrees_sine_cosine(latitude, &sine_latitude, &cosine_latitude);
    // Adding zero replaces -0 by 0.
    point[0] = cosine_latitude * cosine_longitude + 0.0;
    point[1] = cosine_latitude * sine_longitude + 0.0;
    point[2] = sine_latitude;
}
