#include "curve/corner.h"

#include "base/error.h"

#include <math.h>

/// The angle between two tangent vectors at `p`, in [0, pi]: 2 atan2(|a - b|, |a + b|) for the unit vectors a and b of both
/// (Kahan 2006), which is accurate for all angles.
static double angle_between(const bat_space *space, const double *p, double *u, double *v)
{
    double length_u = sqrt(space->inner(space, p, u, u)), length_v = sqrt(space->inner(space, p, v, v));
    for (size_t i = 0; i < space->tangent_dim; i++)
    {
        double a = u[i] / length_u, b = v[i] / length_v;
        u[i] = a - b;
        v[i] = a + b;
    }
    return 2 * atan2(sqrt(space->inner(space, p, u, u)), sqrt(space->inner(space, p, v, v)));
}

/// The exterior angle at `p`, without a sign.
static bat_status exterior_angle(const bat_space *space, const double *before, const double *p, const double *after,
                                 double *angle)
{
    double in[BAT_SPACE_MAX_DIM], out[BAT_SPACE_MAX_DIM];
    bat_status status = space->log(space, p, before, in);
    if (status == BAT_OK)
        status = space->log(space, p, after, out);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < space->tangent_dim; i++)
        in[i] = -in[i];
    *angle = angle_between(space, p, in, out);
    return BAT_OK;
}

bat_status corners_find(const bat_curve *curve, double angle, unsigned char *flags, size_t *count, bat_error *error)
{
    size_t n = curve->count, dim = curve->space->point_dim;
    *count = 0;
    for (size_t i = 0; i < n; i++)
    {
        bool end = !curve->closed && (i == 0 || i + 1 == n);
        flags[i] = curve->corners != NULL && curve->corners[i] != 0;
        if (flags[i] == 0 && angle > 0 && !end)
        {
            double turn;
            const double *p = curve->points;
            bat_status status = exterior_angle(curve->space, p + (i == 0 ? n - 1 : i - 1) * dim, p + i * dim,
                                               p + (i + 1 == n ? 0 : i + 1) * dim, &turn);
            if (status != BAT_OK)
                return error_set(error, status, i, 0, "there is no angle at point %zu (%s)", i, bat_status_name(status));
            flags[i] = turn > angle;
        }
        *count += flags[i];
    }
    return BAT_OK;
}
