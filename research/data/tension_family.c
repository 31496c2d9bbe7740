/// @file
/// Draws from the families of all spaces; see tension_family.h.

#include "research/data/tension_family.h"

#include <math.h>

static tension_family_list families_of(bat_tension_space space, bool unseen)
{
    if (space == BAT_TENSION_SPACE_PLANE)
        return plane_families(unseen);
    return space == BAT_TENSION_SPACE_SPHERE ? sphere_families(unseen) : disk_families(unseen);
}

size_t tension_family_count(bat_tension_space space, bool unseen)
{
    return families_of(space, unseen).count;
}

const char *tension_family_name(bat_tension_space space, bool unseen, size_t family)
{
    return families_of(space, unseen).families[family].name;
}

/// Apply a uniformly random rotation, from a quaternion with four normal components, and normalize the points.
static void rotate_sphere(bat_random *random, size_t count, double *points)
{
    double a = bat_random_normal(random), b = bat_random_normal(random), c = bat_random_normal(random),
           d = bat_random_normal(random);
    const double rotation[3][3] = {
        {a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
        {2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)},
        {2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d},
    };
    for (size_t i = 0; i < count; i++)
    {
        double *p = points + 3 * i, turned[3];
        for (size_t row = 0; row < 3; row++)
            turned[row] = rotation[row][0] * p[0] + rotation[row][1] * p[1] + rotation[row][2] * p[2];
        double length = sqrt(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2]);
        for (size_t axis = 0; axis < 3; axis++)
            p[axis] = turned[axis] / length;
    }
}

void tension_family_draw(bat_tension_space space, bool unseen, size_t family, bat_random *random, size_t count,
                         double *points)
{
    families_of(space, unseen).families[family].draw(random, count, points);
    if (space == BAT_TENSION_SPACE_SPHERE)
        rotate_sphere(random, count, points);
}
