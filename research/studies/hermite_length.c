/// @file
/// The length of the curve of averages from one pair of a point and a direction to another: L_H of section 4.4 of Ben-Zion
/// Vardi, Dyn and Sharon.

#include "batten/research/motion_study.h"

#include "base/error.h"
#include "space/builtin.h"

#include <math.h>
#include <string.h>

enum
{
    FIRST_PARTS = 16, ///< of the weights 0 … 1, on the first level
    MAX_HALVINGS = 8, ///< and how many times they are halved
    MIN_HALVINGS = 2
};

/// The relative change of the extrapolated sums that ends the halving, and the largest that passes after the last.
static const double TOLERANCE = 1e-10, LAST_TOLERANCE = 1e-6;

/// A pair of Hermite data.
typedef struct length_pair
{
    const bat_space *space;
    const double *p0, *v0, *p1, *v1;
} length_pair;

/// The angle between two unit vectors at a point.
static double angle_between(const bat_space *space, const double *point, const double *u, const double *v)
{
    double difference[BAT_SPACE_MAX_DIM], sum[BAT_SPACE_MAX_DIM];
    for (size_t i = 0; i < space->tangent_dim; i++)
    {
        difference[i] = u[i] - v[i];
        sum[i] = u[i] + v[i];
    }
    return 2 * atan2(sqrt(fmax(space->inner(space, point, difference, difference), 0)),
                     sqrt(fmax(space->inner(space, point, sum, sum), 0)));
}

/// The sums over equal parts of the weights: of distances, and of angles between directions, one of them transported.
static bat_status sum_parts(const length_pair *pair, size_t parts, bat_hermite_length *sum)
{
    const bat_space *space = pair->space;
    double points[2][BAT_SPACE_MAX_DIM], directions[2][BAT_SPACE_MAX_DIM], brought[BAT_SPACE_MAX_DIM];
    *sum = (bat_hermite_length){0};
    for (size_t i = 0; i <= parts; i++)
    {
        double *point = points[i % 2], *direction = directions[i % 2], weight = (double)i / (double)parts;
        const double *before = points[(i + 1) % 2];
        bat_status status = bat_hermite_average(space, pair->p0, pair->v0, pair->p1, pair->v1, weight, point, direction);
        if (status == BAT_OK && i > 0)
            status = space->transport(space, before, point, directions[(i + 1) % 2], brought);
        if (status != BAT_OK)
            return status;
        if (i == 0)
            continue;
        sum->path += space->distance(space, before, point);
        sum->turn += angle_between(space, point, brought, direction);
    }
    return BAT_OK;
}

/// Sums along polygons fall short by even powers of the parts: extrapolate the second power.
static double extrapolate(double coarse, double fine)
{
    return fine + (fine - coarse) / 3;
}

static bat_status measure(const length_pair *pair, bat_hermite_length *length, bat_error *error)
{
    bat_hermite_length coarse, fine, best = {0}, before;
    double change = INFINITY;
    size_t parts = FIRST_PARTS;
    bat_status status = sum_parts(pair, parts, &coarse);
    for (int halving = 1; halving <= MAX_HALVINGS && status == BAT_OK; halving++)
    {
        parts *= 2;
        before = best;
        status = sum_parts(pair, parts, &fine);
        best = (bat_hermite_length){extrapolate(coarse.path, fine.path), extrapolate(coarse.turn, fine.turn)};
        change = fabs(best.path - before.path) + fabs(best.turn - before.turn);
        coarse = fine;
        if (halving >= MIN_HALVINGS && change <= TOLERANCE * (best.path + best.turn))
            break;
    }
    if (status != BAT_OK)
        return error_set(error, status, BAT_NO_INDEX, 0, "the pair has no curve of averages (%s)", bat_status_name(status));
    if (!(change <= LAST_TOLERANCE * (best.path + best.turn)))
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the curve of averages jumps or has a cusp: its length changes by %.3g from %zu to %zu parts",
                         change, parts / 2, parts);
    *length = best;
    return BAT_OK;
}

bat_status bat_hermite_length_of(const bat_space *space, const double *p0, const double *v0, const double *p1,
                                 const double *v1, bat_hermite_length *length, bat_error *error)
{
    bat_status status = space_check_complete(space, error);
    if (status != BAT_OK)
        return status;
    bool same = memcmp(v0, v1, space->tangent_dim * sizeof *v0) == 0;
    if (same && space->distance(space, p0, p1) == 0)
    {
        *length = (bat_hermite_length){0};
        return BAT_OK;
    }
    return measure(&(length_pair){space, p0, v0, p1, v1}, length, error);
}
