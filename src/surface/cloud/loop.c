#include "surface/cloud/loop.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector3.h"

#include <math.h>
#include <stdlib.h>

bat_status cloud_loop_make(const double *points, size_t count, cloud_loop *loop, bat_error *error)
{
    cloud_loop made = {.points = points, .count = count, .arc = memory_array(count + 1, sizeof *made.arc)};
    if (made.arc == NULL)
        return error_memory(error, (count + 1) * sizeof *made.arc);
    made.arc[0] = 0;
    for (size_t i = 0; i < count; i++)
    {
        double side[3];
        vector3_subtract(points + 3 * ((i + 1) % count), points + 3 * i, side);
        made.arc[i + 1] = made.arc[i] + sqrt(vector3_dot(side, side));
    }
    *loop = made;
    return BAT_OK;
}

void cloud_loop_free(cloud_loop *loop)
{
    free(loop->arc);
    *loop = (cloud_loop){0};
}

void cloud_loop_at(const cloud_loop *loop, double length, double place[3])
{
    double whole = cloud_loop_length(loop);
    length -= whole * floor(length / whole);
    size_t low = 0, high = loop->count; // arc[low] <= length < arc[high], up to rounding at the end
    while (high - low > 1)
    {
        size_t middle = low + (high - low) / 2;
        if (loop->arc[middle] <= length)
            low = middle;
        else
            high = middle;
    }
    const double *from = loop->points + 3 * low, *to = loop->points + 3 * ((low + 1) % loop->count);
    double side = loop->arc[low + 1] - loop->arc[low], share = side > 0 ? (length - loop->arc[low]) / side : 0;
    for (int k = 0; k < 3; k++)
        place[k] = from[k] + share * (to[k] - from[k]);
}
