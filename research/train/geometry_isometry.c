#include "research/train/geometry_isometry.h"

#include "space/disk.h"

static const double TWO_PI = 6.28318530717958647693;

/// The rotation of a uniform unit quaternion.
static void random_rotation(bat_random *random, double rotation[9])
{
    double q[4], square;
    do
    {
        square = 0;
        for (int i = 0; i < 4; i++)
        {
            q[i] = bat_random_normal(random);
            square += q[i] * q[i];
        }
    } while (square == 0);
    double w = q[0], x = q[1], y = q[2], z = q[3], s = 2 / square;
    const double entries[9] = {1 - s * (y * y + z * z), s * (x * y - w * z),     s * (x * z + w * y),
                               s * (x * y + w * z),     1 - s * (x * x + z * z), s * (y * z - w * x),
                               s * (x * z - w * y),     s * (y * z + w * x),     1 - s * (x * x + y * y)};
    for (int i = 0; i < 9; i++)
        rotation[i] = entries[i];
}

geometry_isometry geometry_isometry_random(geometry_surface surface, double reach, bat_random *random)
{
    geometry_isometry isometry = {.surface = surface};
    if (surface == GEOMETRY_SPHERE)
    {
        random_rotation(random, isometry.rotation);
        return isometry;
    }
    double angle = TWO_PI * bat_random_uniform(random), direction = TWO_PI * bat_random_uniform(random);
    double distance = reach * bat_random_uniform(random);
    double length = surface == GEOMETRY_DISK ? tanh(0.5 * distance) : distance;
    isometry.rotation[0] = isometry.rotation[3] = cos(angle);
    isometry.rotation[2] = sin(angle);
    isometry.rotation[1] = -isometry.rotation[2];
    isometry.shift[0] = length * cos(direction);
    isometry.shift[1] = length * sin(direction);
    return isometry;
}

static void rotate(const double *rotation, const double *point, size_t dim, double *rotated)
{
    for (size_t i = 0; i < dim; i++)
    {
        rotated[i] = 0;
        for (size_t k = 0; k < dim; k++)
            rotated[i] += rotation[i * dim + k] * point[k];
    }
}

void geometry_isometry_apply(const geometry_isometry *isometry, const double *points, size_t count, double *moved)
{
    size_t dim = geometry_dim(isometry->surface);
    for (size_t j = 0; j < count; j++, moved += dim)
    {
        double rotated[3];
        rotate(isometry->rotation, points + j * dim, dim, rotated);
        if (isometry->surface == GEOMETRY_DISK)
            disk_translate(isometry->shift, rotated, moved);
        else
            for (size_t i = 0; i < dim; i++)
                moved[i] = rotated[i] + (isometry->surface == GEOMETRY_PLANE ? isometry->shift[i] : 0);
    }
}
