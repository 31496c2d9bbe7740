// Shape-preserving weights that never fail.

#include "cloud/local_plane.h"
#include "cloud/star.h"
#include "cloud/weights.h"

#include <math.h>

extern int STAR_NEAREST, STAR_WIDEST, STAR_SPACE;
extern double STAR_THICK;
int STAR_NEAREST = 20;
double STAR_THICK = 0.3;
int STAR_WIDEST = 400;
int STAR_SPACE = 0;

static bat_status append_star(const weight_scratch *scratch, const double (*ring)[2], const size_t *places, size_t count,
                              weight_chunk *chunk, bat_error *error)
{
    bat_status status = weight_chunk_reserve(chunk, count, error);
    if (status != BAT_OK)
        return status;
    star_shape_preserving(ring, count, chunk->values + chunk->count);
    for (size_t k = 0; k < count; k++)
        chunk->columns[chunk->count++] = scratch->near.entries[places[k]].item;
    return BAT_OK;
}

bat_status weights_of_star(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                           bat_error *error)
{
    const double *points = source->cloud->points, *place = points + 3 * point;
    size_t wanted = STAR_NEAREST + 1, all = source->cloud->count;
    bool open = true;
    for (;; wanted *= 2)
    {
        bat_status status = neighbours_nearest(source->tree, place, wanted, &scratch->near, error);
        if (status == BAT_OK)
            status = weight_scratch_reserve(scratch, scratch->near.count, error);
        if (status != BAT_OK)
            return status;
        const neighbour *near = scratch->near.entries;
        size_t count = scratch->near.count, ring[STAR_RING];
        local_plane plane = local_plane_fit(points, &scratch->near);
        double thickness = sqrt(plane.variance[2] / plane.variance[1]);
        bool last = count == all || wanted >= (size_t)STAR_WIDEST;
        if (thickness > STAR_THICK && !last)
            continue;
        for (size_t k = 0; k < count; k++)
            local_plane_project(&plane, place, points + 3 * (size_t)near[k].item, scratch->planar[k]);
        size_t corners = star_find((const double(*)[2])scratch->planar, count, scratch->inverse, ring);
        open = corners == 0;
        if (!open)
        {
            double spokes[STAR_RING][3], planar[STAR_RING][2];
            for (size_t k = 0; k < corners; k++)
            {
                for (size_t c = 0; c < 3; c++)
                    spokes[k][c] = points[3 * (size_t)near[ring[k]].item + c] - place[c];
                planar[k][0] = scratch->planar[ring[k]][0];
                planar[k][1] = scratch->planar[ring[k]][1];
            }
            if (STAR_SPACE)
            {
                double other[STAR_RING][2];
                if (star_unfold((const double(*)[3])spokes, corners, other))
                    for (size_t k = 0; k < corners; k++)
                    {
                        planar[k][0] = other[k][0];
                        planar[k][1] = other[k][1];
                    }
            }
            return append_star(scratch, (const double(*)[2])planar, ring, corners, chunk, error);
        }
        if (last)
        {
            weight_source s = *source;
            s.method = BAT_PARAMETERIZE_INVERSE_DISTANCE;
            s.radius = 0;
            return weights_of_nearest(&s, scratch, point, chunk, error);
        }
    }
}
