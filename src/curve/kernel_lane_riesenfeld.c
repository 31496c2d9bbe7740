#include "curve/kernel.h"

#include <math.h>
#include <string.h>

enum
{
    /// Numbers in the rows averaged at a time.
    BLOCK_NUMBERS = 2048,
    /// A block is at least this many times the order, so that what blocks compute twice stays small.
    BLOCK_ORDERS = 8
};

typedef struct lane_riesenfeld_data
{
    row_average *average; ///< takes the place of the arithmetic mean
    size_t order;         ///< rounds of averaging
} lane_riesenfeld_data;
_Static_assert(sizeof(lane_riesenfeld_data) <= KERNEL_DATA, "a kernel has room for its data");

static const lane_riesenfeld_data *data_of(const refine_kernel *kernel)
{
    return kernel_data_of(kernel);
}

static size_t block_pairs(const refine_kernel *kernel)
{
    size_t pairs = BLOCK_NUMBERS / kernel->dim, least = BLOCK_ORDERS * data_of(kernel)->order;
    return pairs < least ? least : pairs;
}

/// The first round: an old row and the average of it and the next, in turn, `count` rows in all.
static bat_status insert_averages(const refine_kernel *kernel, const double *points, size_t count, double *rows,
                                  size_t *fault)
{
    size_t dim = kernel->dim;
    for (size_t i = 0; i < count; i += 2)
        memcpy(rows + i * dim, points + i / 2 * dim, dim * sizeof *rows);
    return data_of(kernel)->average(kernel, points, count / 2, rows + dim, 2 * dim, fault);
}

/// All rounds for new points 2 j, 2 j + 1 with j < pairs. Round r makes row i from the rows i and i + 1 of the round before,
/// so that order - 1 rounds move the rows by half that many places, which the first round makes up for.
static bat_status run_block(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, double *rows,
                            size_t *fault)
{
    size_t dim = kernel->dim, rounds = data_of(kernel)->order - 1;
    ptrdiff_t begin = -(ptrdiff_t)(rounds / 2), first_pair = floor_half(begin);
    size_t skipped = (size_t)(begin - 2 * first_pair), count = skipped + 2 * pairs + rounds;
    bat_status status = insert_averages(kernel, points + first_pair * (ptrdiff_t)dim, count, rows, fault);
    rows += skipped * dim;
    for (size_t round = rounds; round > 0 && status == BAT_OK; round--)
    {
        status = data_of(kernel)->average(kernel, rows, 2 * pairs + round - 1, rows, dim, fault);
        *fault /= 2;
    }
    if (status == BAT_OK)
        memcpy(fine, rows, 2 * pairs * dim * sizeof *fine);
    return status;
}

static bat_status run(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, void *scratch,
                      size_t *fault)
{
    if (data_of(kernel)->order == 1)
        return insert_averages(kernel, points, 2 * pairs, fine, fault);
    size_t dim = kernel->dim, most = block_pairs(kernel);
    bat_status status = BAT_OK;
    for (size_t done = 0; done < pairs && status == BAT_OK; done += most)
    {
        size_t count = pairs - done < most ? pairs - done : most;
        *fault = 0;
        status = run_block(kernel, points + done * dim, count, fine + 2 * done * dim, scratch, fault);
        *fault += done;
    }
    return status;
}

refine_kernel kernel_lane_riesenfeld(const bat_space *space, size_t dim, size_t order, row_average *average)
{
    bat_mask mask = bat_mask_lane_riesenfeld(order);
    refine_kernel kernel = {
        .space = space,
        .dim = dim,
        .first = mask.first,
        .last = mask.first + (int)mask.count - 1,
        .run = run,
    };
    lane_riesenfeld_data *data = kernel_data(&kernel);
    *data = (lane_riesenfeld_data){average, order};
    size_t rows = 2 * block_pairs(&kernel) + order + 2;
    kernel.scratch_size = order == 1 ? 0 : rows * dim * sizeof(double);
    return kernel;
}

static bat_status average_points(const refine_kernel *kernel, const double *rows, size_t count, double *averages,
                                 size_t stride, size_t *fault)
{
    size_t dim = kernel->dim;
    double middle[BAT_SPACE_MAX_DIM];
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        const double *row = rows + i * dim;
        *fault = i;
        status = bat_space_geodesic(kernel->space, row, row + dim, 0.5, middle);
        memcpy(averages + i * stride, middle, status == BAT_OK ? dim * sizeof *middle : 0);
    }
    return status;
}

/// Whether a mask is that of bat_mask_lane_riesenfeld() of some order.
static bool kernel_is_lane_riesenfeld(const bat_mask *mask)
{
    bat_mask expected = bat_mask_lane_riesenfeld(mask->count < 3 ? 1 : mask->count - 2);
    bool same = mask->count == expected.count && mask->first == expected.first;
    for (size_t k = 0; k < expected.count && same; k++)
        same = mask->coefficients[k] == expected.coefficients[k];
    return same;
}

/// Whether a new point is a convex mean of two neighbours.
static bool is_cut(const mask_taps *taps)
{
    static const double TOLERANCE = 1e-9;
    double second = taps->count == 2 ? taps->weights[1] : 0;
    bool convex = taps->count >= 1 && taps->count <= 2 && taps->weights[0] >= 0 && second >= 0;
    return convex && fabs(taps->weights[0] + second - 1) <= TOLERANCE;
}

bool kernel_has_geodesic(const bat_mask *mask)
{
    if (kernel_is_lane_riesenfeld(mask))
        return true;
    bat_mask trimmed = mask_trimmed(mask);
    mask_taps even = mask_taps_of(&trimmed, 0), odd = mask_taps_of(&trimmed, 1);
    return is_cut(&even) && is_cut(&odd);
}

/// A new point at a ratio of the geodesic from old point j + start to the next.
typedef struct cut
{
    double ratio;
    ptrdiff_t start;
} cut;

typedef struct cutting_data
{
    cut cuts[2]; ///< of new points 2 j and 2 j + 1
} cutting_data;
_Static_assert(sizeof(cutting_data) <= KERNEL_DATA, "a kernel has room for its data");

static bat_status cut_edges(const refine_kernel *kernel, const double *points, size_t pairs, double *fine,
                            void *scratch BAT_UNUSED, size_t *fault)
{
    const cutting_data *data = kernel_data_of(kernel);
    size_t dim = kernel->dim;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < 2 * pairs && status == BAT_OK; i++)
    {
        const cut *wanted = &data->cuts[i & 1];
        const double *from = points + ((ptrdiff_t)(i / 2) + wanted->start) * (ptrdiff_t)dim;
        *fault = i / 2;
        if (wanted->ratio > 0)
            status = bat_space_geodesic(kernel->space, from, from + dim, wanted->ratio, fine + i * dim);
        else
            memcpy(fine + i * dim, from, dim * sizeof *fine);
    }
    return status;
}

/// Corner cutting: both new points lie on geodesics between neighbours.
static refine_kernel kernel_cutting(const bat_space *space, const bat_mask *given)
{
    bat_mask mask = mask_trimmed(given);
    refine_kernel kernel = {.space = space,
                            .dim = space->point_dim,
                            .first = mask.first,
                            .last = mask.first + (int)mask.count - 1,
                            .run = cut_edges};
    cutting_data *data = kernel_data(&kernel);
    for (int parity = 0; parity < 2; parity++)
    {
        mask_taps taps = mask_taps_of(&mask, parity);
        data->cuts[parity] = (cut){taps.count == 2 ? taps.weights[1] : 0, taps.start};
    }
    return kernel;
}

refine_kernel kernel_geodesic(const bat_space *space, const bat_curve_scheme *scheme)
{
    if (!kernel_is_lane_riesenfeld(&scheme->mask))
        return kernel_cutting(space, &scheme->mask);
    return kernel_lane_riesenfeld(space, space->point_dim, scheme->mask.count - 2, average_points);
}
