#include "curve/smooth_back.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int REACH = 8; ///< so many points beside a marked edge come back with it, by shares that fall evenly

/// Below this share a point goes back to where it was given.
static const double LEAST_SHARE = 1.0 / 16;

bat_status smooth_back_make(const bat_curve *given, smooth_back *back, bat_error *error)
{
    size_t n = given->count, row = given->space->point_dim * sizeof(double);
    *back = (smooth_back){.given = {.space = given->space, .count = n, .closed = given->closed}};
    back->given.points = memory_pool_array(&back->pool, n, row);
    back->smoothed = memory_pool_array(&back->pool, n, row);
    back->shares = memory_pool_array(&back->pool, n, sizeof(double));
    back->factors = memory_pool_array(&back->pool, n, sizeof(double));
    bat_status status = memory_pool_check(&back->pool, error);
    if (status == BAT_OK)
        memcpy(back->given.points, given->points, n * row);
    return status;
}

void smooth_back_free(smooth_back *back)
{
    memory_pool_free(&back->pool);
    *back = (smooth_back){0};
}

void smooth_back_begin(smooth_back *back, const double *points)
{
    memcpy(back->smoothed, points, back->given.count * back->given.space->point_dim * sizeof(double));
    for (size_t i = 0; i < back->given.count; i++)
        back->shares[i] = back->factors[i] = 1;
}

void smooth_back_mark(smooth_back *back, size_t edge)
{
    ptrdiff_t n = (ptrdiff_t)back->given.count;
    for (ptrdiff_t k = -REACH; k <= REACH + 1; k++)
    {
        ptrdiff_t i = (ptrdiff_t)edge + k, away = k > 0 ? k - 1 : -k;
        if (!back->given.closed && (i < 0 || i >= n))
            continue;
        double *factor = &back->factors[(i % n + n) % n];
        *factor = fmin(*factor, 0.5 + 0.5 * (double)away / (REACH + 1));
    }
    back->marked = true;
}

bat_status smooth_back_move(smooth_back *back, double *points, bool *moved)
{
    const bat_space *space = back->given.space;
    size_t dim = space->point_dim;
    for (size_t i = 0; i < back->given.count && back->marked; i++)
    {
        double share = back->shares[i] * back->factors[i], middle[BAT_SPACE_MAX_DIM];
        const double *from = back->given.points + i * dim, *to = back->smoothed + i * dim;
        back->factors[i] = 1;
        if (share == back->shares[i])
            continue;
        share = share < LEAST_SHARE ? 0 : share;
        back->shares[i] = share;
        bool stays = share == 0 || memcmp(from, to, dim * sizeof *to) == 0;
        bat_status status = stays ? BAT_OK : bat_space_geodesic(space, from, to, share, middle);
        if (status != BAT_OK)
            return status;
        memcpy(points + i * dim, stays ? from : middle, dim * sizeof *points);
        *moved = true;
    }
    back->marked = false;
    return BAT_OK;
}
