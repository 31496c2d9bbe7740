#include "space/builtin.h"

static bool is_same(const bat_space *a, bat_space b)
{
    return a->dimension == b.dimension && a->point_dim == b.point_dim && a->tangent_dim == b.tangent_dim &&
           a->weight == b.weight && a->parameters == b.parameters && a->fault == b.fault && a->project == b.project &&
           a->distance == b.distance && a->log == b.log && a->exp == b.exp && a->transport == b.transport &&
           a->inner == b.inner && a->geodesic == b.geodesic && a->exterior_angle == b.exterior_angle && a->apex == b.apex;
}

bool space_is_euclidean(const bat_space *space)
{
    return is_same(space, bat_euclidean(space->dimension));
}

bool space_is_plane(const bat_space *space)
{
    return space->dimension == 2 && space_is_euclidean(space);
}

bool space_is_sphere(const bat_space *space)
{
    return is_same(space, bat_sphere(2));
}

bool space_is_disk(const bat_space *space)
{
    return is_same(space, bat_disk());
}

bool space_is_rotation(const bat_space *space)
{
    return is_same(space, bat_rotation());
}

bool space_is_rigid(const bat_space *space)
{
    bat_space ours;
    return space->weight > 0 && bat_rigid(space->weight, &ours, NULL) == BAT_OK && is_same(space, ours);
}

bool space_is_product(const bat_space *space)
{
    const bat_space line = bat_euclidean(1);
    const bat_product_factors one = {.spaces = &line, .count = 1};
    bat_space ours;
    if (bat_product(&one, &ours, NULL) != BAT_OK)
        return false;
    ours.dimension = space->dimension;
    ours.point_dim = space->point_dim;
    ours.tangent_dim = space->tangent_dim;
    ours.parameters = space->parameters;
    return is_same(space, ours);
}

bool space_is_curved(const bat_space *space, double *curvature)
{
    bool positive = is_same(space, bat_sphere(space->dimension));
    bool negative = is_same(space, bat_hyperbolic(space->dimension)) || space_is_disk(space);
    *curvature = positive ? 1 : -1;
    return positive || negative;
}

bool space_is_surface(const bat_space *space, int *curvature)
{
    bool disk = space_is_disk(space), sphere = space_is_sphere(space);
    if (!disk && !sphere && !space_is_plane(space))
        return false;
    *curvature = disk ? -1 : sphere ? 1 : 0;
    return true;
}
