/// @file
/// Linear Hermite schemes by parallel transport, with which Hermite Lane-Riesenfeld schemes are compared.

#include "batten/research/motion_study.h"

#include "base/error.h"
#include "motion/hermite_average.h"

#include <math.h>
#include <string.h>

/// The tolerance of the sums of a mask's weights.
static const double SUM_TOLERANCE = 1e-12;

bat_hermite_mask bat_hermite_mask_merrien(double lambda, double mu)
{
    return (bat_hermite_mask){
        .coefficients = {{{0.5, lambda}, {0.5 * (1 - mu), 0.25 * mu}},
                         {{1, 0}, {0, 0.5}},
                         {{0.5, -lambda}, {-0.5 * (1 - mu), 0.25 * mu}}},
        .count = 3,
        .first = -1,
    };
}

/// Values of the cubic Hermite basis and half its derivatives at 1/4 and, mirrored, at 3/4.
bat_hermite_mask bat_hermite_mask_de_rham(void)
{
    return (bat_hermite_mask){
        .coefficients = {{{5.0 / 32, -3.0 / 64}, {9.0 / 16, -5.0 / 32}},
                         {{27.0 / 32, -9.0 / 64}, {9.0 / 16, 3.0 / 32}},
                         {{27.0 / 32, 9.0 / 64}, {-9.0 / 16, 3.0 / 32}},
                         {{5.0 / 32, 3.0 / 64}, {-9.0 / 16, -5.0 / 32}}},
        .count = 4,
        .first = -2,
    };
}

/// Whether A(first + k) goes to new data of a parity (0 or 1).
static bool has_parity(const bat_hermite_mask *mask, size_t k, int parity)
{
    return ((mask->first + (int)k) & 1) == parity;
}

/// Whether a mask is valid: finite matrices, and weights of points that sum to 1 for every new point and to 0 for
/// every new derivative, as invariance under translations requires.
/// @return BAT_OK or BAT_INVALID_ARGUMENT
static bat_status hermite_mask_check(const bat_hermite_mask *mask, bat_error *error)
{
    if (mask->count < 1 || mask->count > BAT_HERMITE_MASK_MAX || mask->first < -BAT_MASK_MAX || mask->first > BAT_MASK_MAX)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "a Hermite mask has 1 to %d matrices about index 0, not %zu from %d on", BAT_HERMITE_MASK_MAX,
                         mask->count, mask->first);
    for (int parity = 0; parity < 2; parity++)
    {
        double point = 0, derivative = 0;
        for (size_t k = 0; k < mask->count; k++)
        {
            const double(*a)[2] = mask->coefficients[k];
            if (!isfinite(a[0][0] + a[0][1] + a[1][0] + a[1][1]))
                return error_set(error, BAT_INVALID_ARGUMENT, k, 0, "matrix %zu of the Hermite mask is not finite", k);
            point += has_parity(mask, k, parity) ? a[0][0] : 0;
            derivative += has_parity(mask, k, parity) ? a[1][0] : 0;
        }
        if (!(fabs(point - 1) <= SUM_TOLERANCE && fabs(derivative) <= SUM_TOLERANCE))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "the weights of points in a Hermite mask sum to 1 and, for derivatives, to 0, not %g and %g",
                             point, derivative);
    }
    return BAT_OK;
}

/// The sums that make one new row: its point's logarithm and its derivative, both at the base, and its time.
typedef struct hermite_sum
{
    double point[BAT_SPACE_MAX_DIM], derivative[BAT_SPACE_MAX_DIM], time;
} hermite_sum;

/// Add an old row, whose logarithm and transported derivative at the base are given.
static void add_row(hermite_sum *sum, size_t n, const double a[2][2], const double *log, const double *derivative,
                    double time)
{
    for (size_t i = 0; i < n; i++)
    {
        sum->point[i] += a[0][0] * log[i] + a[0][1] * derivative[i];
        sum->derivative[i] += a[1][0] * log[i] + a[1][1] * derivative[i];
    }
    sum->time += a[0][0] * time;
}

typedef struct transport_data
{
    const bat_hermite_mask *mask;
    bat_curve_base base;
} transport_data;
_Static_assert(sizeof(transport_data) <= KERNEL_DATA, "a kernel has room for its data");

static const transport_data *data_of(const refine_kernel *kernel)
{
    return kernel_data_of(kernel);
}

/// The new rows of both parities from the old ones that they share. Row 0 is old row j.
static bat_status sum_rows(const refine_kernel *kernel, const double *base, const double *rows, hermite_sum sums[2])
{
    const bat_space *space = kernel->space;
    const bat_hermite_mask *mask = data_of(kernel)->mask;
    size_t n = space->tangent_dim, width = space->point_dim + n;
    double log[BAT_SPACE_MAX_DIM], derivative[BAT_SPACE_MAX_DIM];
    for (int parity = 0; parity < 2; parity++)
    {
        memset(sums[parity].point, 0, n * sizeof *log);
        memset(sums[parity].derivative, 0, n * sizeof *log);
        sums[parity].time = 0;
    }
    for (size_t k = 0; k < mask->count; k++)
    {
        // A(first + k) is that of new row 2 j + parity and old row j + (parity - first - k) / 2.
        int parity = (mask->first + (int)k) & 1, offset = (parity - mask->first - (int)k) / 2;
        const double *row = rows + (ptrdiff_t)offset * (ptrdiff_t)kernel->dim;
        bat_status status = space->log(space, base, row, log);
        if (status == BAT_OK)
            status = space->transport(space, row, base, row + space->point_dim, derivative);
        if (status != BAT_OK)
            return status;
        add_row(&sums[parity], n, mask->coefficients[k], log, derivative, width < kernel->dim ? row[width] : 0);
    }
    return BAT_OK;
}

/// Whether new rows of a parity are old points with their derivatives halved, or scaled by another factor, which is A(0)'s.
static bool keeps_points(const bat_hermite_mask *mask, int parity)
{
    bool found = false;
    for (size_t k = 0; k < mask->count; k++)
    {
        const double(*a)[2] = mask->coefficients[k];
        bool here = mask->first + (int)k == 0;
        if (!has_parity(mask, k, parity))
            continue;
        if (a[0][0] != 1 || a[0][1] != 0 || a[1][0] != 0 || !here)
            return false;
        found = true;
    }
    return found;
}

/// Such a row, without rounding of the point.
static void keep_row(const refine_kernel *kernel, const double *old, double *row)
{
    const bat_hermite_mask *mask = data_of(kernel)->mask;
    size_t n = kernel->space->point_dim, width = n + kernel->space->tangent_dim;
    memcpy(row, old, kernel->dim * sizeof *row);
    for (size_t i = n; i < width; i++)
        row[i] *= mask->coefficients[-mask->first][1][1];
}

static bat_status finish_row(const refine_kernel *kernel, const double *base, const hermite_sum *sum, double *row)
{
    const bat_space *space = kernel->space;
    size_t width = space->point_dim + space->tangent_dim;
    bat_status status = space->exp(space, base, sum->point, row);
    if (status == BAT_OK)
        status = space->transport(space, base, row, sum->derivative, row + space->point_dim);
    if (width < kernel->dim)
        row[width] = sum->time;
    return status;
}

static bat_status make_pair(const refine_kernel *kernel, const double *rows, double *fine)
{
    double middle[BAT_SPACE_MAX_DIM];
    const double *base = rows;
    hermite_sum sums[2];
    bat_status status = BAT_OK;
    if (data_of(kernel)->base == BAT_CURVE_BASE_MIDPOINT)
    {
        status = bat_space_geodesic(kernel->space, rows, rows + kernel->dim, 0.5, middle);
        base = middle;
    }
    if (status == BAT_OK)
        status = sum_rows(kernel, base, rows, sums);
    for (int parity = 0; parity < 2 && status == BAT_OK; parity++)
    {
        double *row = fine + (parity == 0 ? 0 : kernel->dim);
        if (keeps_points(data_of(kernel)->mask, parity))
            keep_row(kernel, rows, row);
        else
            status = finish_row(kernel, base, &sums[parity], row);
    }
    return status;
}

static bat_status run_transport(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, void *scratch,
                                size_t *fault)
{
    (void)scratch;
    for (size_t j = 0; j < pairs; j++)
    {
        bat_status status = make_pair(kernel, points + j * kernel->dim, fine + 2 * j * kernel->dim);
        if (status != BAT_OK)
        {
            *fault = j;
            return status;
        }
    }
    return BAT_OK;
}

/// A linear Hermite step on rows of a point, a derivative and, where dim has room for one, a time. The mask must outlive it.
static refine_kernel kernel_hermite_transport(const bat_space *space, size_t dim, const bat_hermite_mask *mask,
                                              bat_curve_base base)
{
    refine_kernel kernel = {
        .space = space,
        .dim = dim,
        .first = mask->first,
        .last = mask->first + (int)mask->count - 1,
        .run = run_transport,
    };
    transport_data *data = kernel_data(&kernel);
    *data = (transport_data){mask, base};
    return kernel;
}

bat_status bat_hermite_transport_refine(const bat_hermite_curve *coarse, const bat_hermite_linear *scheme,
                                        const bat_hermite_refine_options *options, bat_hermite_curve *fine, bat_error *error)
{
    const bat_space *space = coarse->space;
    if (scheme == NULL)
        return bat_hermite_refine(coarse, options, fine, error);
    bat_status status = hermite_mask_check(&scheme->mask, error);
    if (status != BAT_OK)
        return status;
    refine_kernel kernel = kernel_hermite_transport(
        space, space->point_dim + space->tangent_dim + (coarse->times != NULL ? 1 : 0), &scheme->mask, scheme->base);
    return hermite_refine_by(coarse, options, &kernel, fine, error);
}
