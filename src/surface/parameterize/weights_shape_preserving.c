/// @file
/// Shape-preserving weights (Floater, "Parametrization and smooth approximation of surface triangulations", 1997) of the
/// Delaunay star of each point in its local plane (weights.h), in an adaptive and in the published variant.

#include "surface/parameterize/weights.h"

#include "base/error.h"
#include "linalg/vector.h"
#include "surface/cloud/local_plane.h"

// Shape-preserving weights that never fail.

static const int GROWTHS = 1; ///< number of times that a neighbourhood is doubled to close a star

/// Find the star in the best-fitting plane of at least `wanted` neighbours. The corners are indices into the list.
static bat_status find_star(const weight_source *source, weight_scratch *scratch, size_t point, size_t wanted,
                            size_t corners[STAR_MAX_RING], size_t *count, bool *closed, bat_error *error)
{
    const double *points = source->cloud->points, *place = points + 3 * point;
    neighbour_list *near = &scratch->near;
    local_plane plane;
    bat_status status = neighbourhood_find(source->tree, points, place, wanted, near, &plane, error);
    if (status == BAT_OK)
        status = weight_scratch_reserve(scratch, near->count, error);
    if (status != BAT_OK)
        return status;
    for (size_t k = 0; k < near->count; k++)
        local_plane_project(&plane, place, points + 3 * (size_t)near->entries[k].item, scratch->planar[k]);
    *count = star_find((const double(*)[2])scratch->planar, near->count, scratch->inverse, corners, closed);
    return BAT_OK;
}

/// The initial number of neighbours.
static bat_status first_wanted(const weight_source *source, weight_scratch *scratch, size_t point, size_t *wanted,
                               bat_error *error)
{
    *wanted = NEIGHBOURHOOD_MIN;
    if (source->radius == 0)
        return BAT_OK;
    bat_status status =
        neighbours_within(source->tree, source->cloud->points + 3 * point, source->radius, &scratch->near, error);
    if (status == BAT_OK && scratch->near.count > *wanted)
        *wanted = scratch->near.count;
    return status;
}

/// Positions of the corners about the origin: the planar ones if the star is closed, else unfolded from space, which closes
/// the gap. False if that is not possible.
static bool lay_out(const weight_source *source, const weight_scratch *scratch, size_t point, const size_t *corners,
                    size_t count, bool closed, double (*ring)[2])
{
    const double *points = source->cloud->points;
    double spokes[STAR_MAX_RING][3];
    for (size_t k = 0; k < count; k++)
    {
        ring[k][0] = scratch->planar[corners[k]][0];
        ring[k][1] = scratch->planar[corners[k]][1];
        vector3_subtract(points + 3 * (size_t)scratch->near.entries[corners[k]].item, points + 3 * point, spokes[k]);
    }
    return closed || (count >= 3 && star_unfold((const double(*)[3])spokes, count, ring));
}

bat_status weights_of_star(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                           bat_error *error)
{
    size_t first = 0, count = 0, corners[STAR_MAX_RING];
    bool closed = false, all = false;
    bat_status status = first_wanted(source, scratch, point, &first, error);
    for (size_t growth = 0, wanted = first; growth <= GROWTHS && status == BAT_OK && !closed && !all; growth++)
    {
        status = find_star(source, scratch, point, wanted, corners, &count, &closed, error);
        wanted = 2 * scratch->near.count;
        all = scratch->near.count == source->cloud->count;
    }
    if (status == BAT_OK)
        status = weight_chunk_reserve(chunk, count, error);
    if (status != BAT_OK)
        return status;
    double ring[STAR_MAX_RING][2];
    if (!lay_out(source, scratch, point, corners, count, closed, ring))
    {
        weight_source by_distance = *source;
        by_distance.method = BAT_CLOUD_PARAMETERIZATION_INVERSE_DISTANCE;
        by_distance.radius = 0;
        return weights_of_nearest(&by_distance, scratch, point, chunk, error);
    }
    star_shape_preserving((const double(*)[2])ring, count, chunk->values + chunk->count);
    for (size_t k = 0; k < count; k++)
        chunk->columns[chunk->count++] = scratch->near.entries[corners[k]].item;
    return BAT_OK;
}

// Shape-preserving weights as published: an exact triangulation of each ball.

static bat_status fail_at(const weight_source *source, size_t point, bat_error *error, const char *why)
{
    size_t place = cloud_input_index(source->cloud, point);
    return error_set(error, BAT_NO_CONVERGENCE, place, 0, "the neighbourhood of point %zu %s", place, why);
}

/// Append the weights of a ring that is unfolded from space to the plane.
static bat_status append_ring(const weight_source *source, const neighbour_list *near, size_t point, const size_t *places,
                              size_t count, weight_chunk *chunk, bat_error *error)
{
    const double *points = source->cloud->points;
    double spokes[STAR_MAX_RING][3], ring[STAR_MAX_RING][2];
    bat_status status = weight_chunk_reserve(chunk, count, error);
    if (status != BAT_OK)
        return status;
    for (size_t k = 0; k < count; k++)
        vector3_subtract(points + 3 * (size_t)near->entries[places[k]].item, points + 3 * point, spokes[k]);
    if (!star_unfold((const double(*)[3])spokes, count, ring))
        return fail_at(source, point, error, "has an angle of half a turn");
    star_shape_preserving((const double(*)[2])ring, count, chunk->values + chunk->count);
    for (size_t k = 0; k < count; k++)
        chunk->columns[chunk->count++] = near->entries[places[k]].item;
    return BAT_OK;
}

bat_status weights_of_triangulated_ball(const weight_source *source, weight_scratch *scratch, size_t point,
                                        weight_chunk *chunk, bat_error *error)
{
    const double *points = source->cloud->points, *place = points + 3 * point;
    neighbour_list *near = &scratch->near;
    bat_status status = neighbours_within(source->tree, place, source->radius, near, error);
    if (status == BAT_OK)
        status = weight_scratch_reserve(scratch, near->count, error);
    if (status != BAT_OK)
        return status;
    if (near->count < 4)
        return fail_at(source, point, error, "has fewer than three points");
    size_t ring[STAR_MAX_RING], count;
    local_plane plane = local_plane_fit(points, near);
    for (size_t k = 0; k < near->count; k++)
        local_plane_project(&plane, place, points + 3 * (size_t)near->entries[k].item, scratch->planar[k]);
    size_t own = 0;
    while (near->entries[own].item != point)
        own++;
    status = triangulated_star_find((const double(*)[2])scratch->planar, near->count, own, ring, &count, error);
    if (status == BAT_OK && count == 0)
        status = fail_at(source, point, error, "gives it fewer than three neighbours");
    return status == BAT_OK ? append_ring(source, near, point, ring, count, chunk, error) : status;
}
