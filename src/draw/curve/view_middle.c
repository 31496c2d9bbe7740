#include "draw/curve/view.h"

#include "linalg/decompose.h"

#include <math.h>

/// The sums over the edges of curves on the sphere that place the middle of a globe.
typedef struct globe_moments
{
    double weight;
    double mean[3];
    double square[3][3];
} globe_moments;

static void add_direction(globe_moments *moments, const double *direction, double weight)
{
    moments->weight += weight;
    for (int i = 0; i < 3; i++)
    {
        moments->mean[i] += weight * direction[i];
        for (int j = 0; j < 3; j++)
        {
            moments->square[i][j] += weight * direction[i] * direction[j];
        }
    }
}

/// Add the middles of the edges, weighted with their lengths; of long curves those of an even choice of points.
static void add_curve(globe_moments *moments, const bat_curve *curve)
{
    const size_t enough = 65536;
    size_t stride = 1 + curve->count / enough;
    const double *last = curve->points + 3 * (curve->count - 1);
    const double *p = curve->closed ? last : curve->points;
    for (size_t i = 0; i < curve->count; i += stride)
    {
        const double *q = curve->points + 3 * i;
        double middle[3] = {p[0] + q[0], p[1] + q[1], p[2] + q[2]};
        double length = sqrt(middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2]);
        double chord = sqrt(pow(q[0] - p[0], 2.0) + pow(q[1] - p[1], 2.0) + pow(q[2] - p[2], 2.0));
        if (length > 0.0)
        {
            double direction[3] = {middle[0] / length, middle[1] / length, middle[2] / length};
            add_direction(moments, direction, 2.0 * atan2(chord, length));
        }
        p = q;
    }
    add_direction(moments, last, 1e-9);
}

/// A view 25 degrees above the best plane through the moments, from its northern side, towards where most of the curve is.
static void oblique_direction(globe_moments *moments, double *direction)
{
    const double elevation = 25.0 * 3.14159265358979323846 / 180.0;
    double values[3];
    if (decompose_symmetric(3, &moments->square[0][0], values, NULL) != BAT_OK)
    {
        return;
    }
    double normal[3];
    double axis[3];
    double along = 0.0;
    for (int k = 0; k < 3; k++)
    {
        double upwards = moments->square[2][0] < 0.0 ? -1.0 : 1.0;
        normal[k] = upwards * moments->square[k][0];
        axis[k] = moments->square[k][2];
        along += axis[k] * moments->mean[k];
    }
    for (int k = 0; k < 3; k++)
    {
        direction[k] = cos(elevation) * (along < 0.0 ? -axis[k] : axis[k]) + sin(elevation) * normal[k];
    }
}

void view_automatic(const bat_curve *const *curves, size_t count, double *longitude, double *latitude)
{
    const double telling = 0.3; // share of the length; below, the curve surrounds the sphere rather than lies on one side
    globe_moments moments = {0};
    for (size_t i = 0; i < count; i++)
    {
        add_curve(&moments, curves[i]);
    }
    double direction[3] = {moments.mean[0], moments.mean[1], moments.mean[2]};
    if (hypot(hypot(direction[0], direction[1]), direction[2]) < telling * moments.weight)
    {
        oblique_direction(&moments, direction);
    }
    *longitude = atan2(direction[1], direction[0]);
    *latitude = atan2(direction[2], hypot(direction[0], direction[1]));
}
