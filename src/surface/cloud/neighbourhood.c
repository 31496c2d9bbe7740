#include "surface/cloud/neighbourhood.h"

/// The largest variance across the plane, in proportion to the smaller one along it.
static const double THICKEST = 0.25;

bat_status neighbourhood_find(const neighbour_tree *tree, const double *points, const double place[3], size_t wanted,
                              neighbour_list *near, local_plane *plane, bat_error *error)
{
    for (;; wanted *= 2)
    {
        bat_status status = neighbours_nearest(tree, place, wanted, near, error);
        if (status != BAT_OK)
            return status;
        *plane = local_plane_fit(points, near);
        if (plane->variance[2] <= THICKEST * plane->variance[1] || wanted >= NEIGHBOURHOOD_MOST ||
            near->count == tree->count)
            return BAT_OK;
    }
}
