#include "curve/corner.h"

#include "base/error.h"
#include "curve/polygon.h"

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
            bat_status status = polygon_exterior_angle(curve->space, p + (i == 0 ? n - 1 : i - 1) * dim, p + i * dim,
                                                       p + (i + 1 == n ? 0 : i + 1) * dim, &turn);
            if (status != BAT_OK)
                return error_point(error, status, i, "there is no angle at point", " (%s)", bat_status_name(status));
            flags[i] = turn > angle;
        }
        *count += flags[i];
    }
    return BAT_OK;
}
