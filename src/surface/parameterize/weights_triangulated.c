// Shape-preserving weights as published: an exact triangulation of each ball.

#include "surface/cloud/local_plane.h"
#include "surface/parameterize/star.h"
#include "surface/parameterize/triangulated_star.h"
#include "surface/parameterize/weights.h"

#include "base/error.h"

static bat_status fail_at(const weight_source *source, size_t point, bat_error *error, const char *why)
{
    size_t place = weights_input_place(source->cloud, point);
    return error_set(error, BAT_NO_CONVERGENCE, place, 0, "the neighbourhood of point %zu %s", place, why);
}

static size_t place_of(const neighbour_list *near, size_t point)
{
    size_t k = 0;
    while (near->entries[k].item != point)
        k++;
    return k;
}

/// Appends the weights of a ring, unfolded from space into the plane.
static bat_status append_ring(const weight_source *source, const neighbour_list *near, size_t point, const size_t *places,
                              size_t count, weight_chunk *chunk, bat_error *error)
{
    const double *points = source->cloud->points;
    double spokes[STAR_RING][3], ring[STAR_RING][2];
    bat_status status = weight_chunk_reserve(chunk, count, error);
    if (status != BAT_OK)
        return status;
    for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < 3; c++)
            spokes[k][c] = points[3 * (size_t)near->entries[places[k]].item + c] - points[3 * point + c];
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
    size_t ring[STAR_RING], count;
    local_plane plane = local_plane_fit(points, near);
    for (size_t k = 0; k < near->count; k++)
        local_plane_project(&plane, place, points + 3 * (size_t)near->entries[k].item, scratch->planar[k]);
    status =
        triangulated_star_find((const double(*)[2])scratch->planar, near->count, place_of(near, point), ring, &count, error);
    if (status == BAT_OK && count == 0)
        status = fail_at(source, point, error, "gives it fewer than three neighbours");
    return status == BAT_OK ? append_ring(source, near, point, ring, count, chunk, error) : status;
}
