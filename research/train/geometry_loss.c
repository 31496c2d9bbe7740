#include "research/train/geometry_loss.h"

#include <math.h>

/// The first vertex with an angle.
static size_t first_corner(const geometry_polygon *polygon)
{
    return polygon->closed ? 0 : 1;
}

double geometry_smoothness(const geometry_polygon *polygon, geometry_profile profile)
{
    // The ends of an open polygon have angle 0.
    double sum = 0;
    for (size_t j = 0; j < polygon->count; j++)
        sum += profile.angles[j] * profile.angles[j];
    return sum / (double)geometry_corners(polygon);
}

void geometry_smoothness_back(const geometry_polygon *polygon, geometry_profile profile, double loss_gradient,
                              geometry_profile gradient)
{
    double factor = 2 * loss_gradient / (double)geometry_corners(polygon);
    for (size_t j = 0; j < polygon->count; j++)
        gradient.angles[j] += factor * profile.angles[j];
}

double geometry_bending(const geometry_polygon *polygon, geometry_profile profile, double offset)
{
    size_t corners = geometry_corners(polygon), first = first_corner(polygon);
    double sum = 0;
    for (size_t i = 0; i < corners; i++)
    {
        size_t j = first + i, before = j == 0 ? polygon->count - 1 : j - 1;
        double curvature = profile.angles[j] / (0.5 * (profile.lengths[before] + profile.lengths[j]) + offset);
        sum += curvature * curvature;
    }
    return sum / (double)corners;
}

void geometry_bending_back(const geometry_polygon *polygon, geometry_profile profile, double offset, double loss_gradient,
                           geometry_profile gradient)
{
    size_t corners = geometry_corners(polygon), first = first_corner(polygon);
    double factor = 2 * loss_gradient / (double)corners;
    for (size_t i = 0; i < corners; i++)
    {
        size_t j = first + i, before = j == 0 ? polygon->count - 1 : j - 1;
        double inverse = 1 / (0.5 * (profile.lengths[before] + profile.lengths[j]) + offset);
        double by_angle = factor * profile.angles[j] * inverse * inverse;
        double by_length = -0.5 * by_angle * profile.angles[j] * inverse;
        gradient.angles[j] += by_angle;
        gradient.lengths[before] += by_length;
        gradient.lengths[j] += by_length;
    }
}

/// Pairs of neighbouring vertices that both have an angle; pair i is that of vertex first_corner() + i and the next.
static size_t neighbour_pairs(const geometry_polygon *polygon)
{
    size_t corners = geometry_corners(polygon);
    return polygon->closed ? corners : corners - 1;
}

double geometry_angle_variation(const geometry_polygon *polygon, geometry_profile profile)
{
    size_t pairs = neighbour_pairs(polygon), first = first_corner(polygon);
    double sum = 0;
    for (size_t i = 0; i < pairs; i++)
    {
        size_t j = first + i, next = j + 1 == polygon->count ? 0 : j + 1;
        double difference = profile.angles[next] - profile.angles[j];
        sum += difference * difference;
    }
    return pairs > 0 ? sum / (double)pairs : 0;
}

void geometry_angle_variation_back(const geometry_polygon *polygon, geometry_profile profile, double loss_gradient,
                                   geometry_profile gradient)
{
    size_t pairs = neighbour_pairs(polygon), first = first_corner(polygon);
    double factor = 2 * loss_gradient / (double)pairs;
    for (size_t i = 0; i < pairs; i++)
    {
        size_t j = first + i, next = j + 1 == polygon->count ? 0 : j + 1;
        double difference = profile.angles[next] - profile.angles[j];
        gradient.angles[next] += factor * difference;
        gradient.angles[j] -= factor * difference;
    }
}

double geometry_angle_power_mean(const geometry_polygon *polygon, geometry_profile profile, double power)
{
    double largest = 0, sum = 0;
    for (size_t j = 0; j < polygon->count; j++)
        largest = fmax(largest, fabs(profile.angles[j]));
    if (largest == 0)
        return 0;
    // Divided by the largest, no power overflows and not all underflow.
    for (size_t j = 0; j < polygon->count; j++)
        sum += pow(fabs(profile.angles[j]) / largest, power);
    return largest * pow(sum / (double)geometry_corners(polygon), 1 / power);
}

void geometry_angle_power_mean_back(const geometry_polygon *polygon, geometry_profile profile, double power,
                                    double loss_gradient, geometry_profile gradient)
{
    double mean = geometry_angle_power_mean(polygon, profile, power);
    if (mean == 0)
        return;
    double factor = loss_gradient / (double)geometry_corners(polygon);
    for (size_t j = 0; j < polygon->count; j++)
        gradient.angles[j] += copysign(factor * pow(fabs(profile.angles[j]) / mean, power - 1), profile.angles[j]);
}
