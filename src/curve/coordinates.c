#include "curve/coordinates.h"

#include "base/error.h"

#include <float.h>
#include <math.h>

bat_status coordinates_check(const bat_curve *curve, const char *which, bat_error *error)
{
    size_t dim = curve->space->point_dim;
    for (size_t i = 0; i < curve->count * dim; i++)
        if (!(fabs(curve->points[i]) <= DBL_MAX / 2))
            return error_set(error, BAT_INVALID_POINT, i / dim, 0, "point %zu of the %s curve %s", i / dim, which,
                             isfinite(curve->points[i]) ? "has a coordinate beyond 8.9e307" : "is not finite");
    return BAT_OK;
}
