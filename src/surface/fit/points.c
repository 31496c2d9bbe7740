/// @file
/// Sums over the points of all processes of a fit; see points.h. All of it is collection on rank 0 and broadcast from there,
/// so that every sum has one order.

#include "base/error.h"
#include "base/threads.h"
#include "surface/fit/loop.h"

#include <string.h>

bat_status team_gather(const fit_team *team, const void *bytes, size_t size, size_t **sizes, char **all, bat_error *error)
{
    if (team != NULL)
        return team->gather(team->group, bytes, size, sizes, all, error);
    *sizes = memory_array(1, sizeof **sizes);
    *all = memory_array(size, 1);
    if (*sizes == NULL || *all == NULL)
        return error_memory(error, size);
    **sizes = size;
    memcpy(*all, bytes, size);
    return BAT_OK;
}

bat_status fit_sum_rows(const fit_team *team, const double *rows, size_t count, size_t width, double *sums, bat_error *error)
{
    size_t *sizes = NULL, all_rows = count;
    char *all = NULL;
    bat_status status = BAT_OK;
    memset(sums, 0, width * sizeof *sums);
    if (team_count(team) > 1)
    {
        all_rows = 0;
        status = team_gather(team, rows, count * width * sizeof *rows, &sizes, &all, error);
        for (size_t rank = 0; status == BAT_OK && all != NULL && rank < team_count(team); rank++)
            all_rows += sizes[rank] / (width * sizeof *rows);
        rows = (const double *)(const void *)all;
    }
    for (size_t row = 0; status == BAT_OK && row < all_rows; row++)
        vector_add(width, 1, rows + row * width, sums);
    free(sizes);
    free(all);
    return status == BAT_OK ? team_broadcast(team, sums, width * sizeof *sums, error) : status;
}

bat_status fit_sum_points(const fit_team *team, size_t points, fit_terms *terms, const void *context, size_t width,
                          int threads, double *sums, bat_error *error)
{
    size_t blocks = fit_blocks(points);
    double *rows = calloc(blocks * width + 1, sizeof *rows);
    if (rows == NULL)
        return error_memory(error, blocks * width * sizeof *rows);
#pragma omp parallel for schedule(static) num_threads(threads_worth(threads, blocks, 10 * (double)points))
    for (size_t block = 0; block < blocks; block++)
    {
        double own[FIT_TERMS] = {0};
        size_t begin = block * FIT_BLOCK, end = begin + FIT_BLOCK;
        for (size_t row = begin; row < end && row < points; row++)
            terms(context, row, own);
        memcpy(rows + block * width, own, width * sizeof *own);
    }
    bat_status status = fit_sum_rows(team, rows, blocks, width, sums, error);
    free(rows);
    return status;
}

/// The value of this place among those of all ranks in ascending order. Values are not negative.
/// @param place less than the number of all values
static bat_status fit_select(const fit_team *team, const double *values, size_t count, uint64_t place, double *selected,
                             bat_error *error)
{
    enum
    {
        DIGIT = 16, ///< bits that one pass decides
        SIZE = 1 << DIGIT
    };
    // The bits of doubles that are not negative have the order of their values.
    uint64_t known = 0, *counts = memory_array(SIZE, sizeof *counts);
    if (counts == NULL)
        return error_memory(error, SIZE * sizeof *counts);
    bat_status status = BAT_OK;
    for (int shift = 64 - DIGIT; shift >= 0 && status == BAT_OK; shift -= DIGIT)
    {
        memset(counts, 0, SIZE * sizeof *counts);
        for (size_t i = 0; i < count; i++)
        {
            uint64_t bits;
            memcpy(&bits, &values[i], sizeof bits);
            if (shift == 64 - DIGIT || bits >> (shift + DIGIT) == known)
                counts[bits >> shift & (SIZE - 1)]++;
        }
        status = team_sum_counts(team, counts, SIZE, error);
        uint64_t digit = 0;
        while (digit < SIZE - 1 && place >= counts[digit])
            place -= counts[digit++];
        known = known << DIGIT | digit;
    }
    memcpy(selected, &known, sizeof known);
    free(counts);
    return status;
}

// Tukey's biweight.

#define NEIGHBOURS 48 ///< consecutive points in Morton order that share a scale

// Ratio of the standard deviation to the median absolute value of a normal distribution.
static const double NORMAL_SCALE = 1.4826;
// Tuning constant of Tukey's biweight: 95 per cent efficiency for normally distributed noise.
static const double TUKEY_REACH = 4.685;
// Lower bound of the scale, as a fraction of the size of the point set: residuals of rounding size are no outliers.
static const double MIN_SCALE = 1e-12;

bat_status fit_robust_weights(fit_points *points, double size, size_t *outliers, bat_error *error)
{
    double sorted[NEIGHBOURS], middle;
    bat_status status = fit_select(points->team, points->distance, points->count, points->total / 2, &middle, error);
    if (status != BAT_OK)
        return status;
    double global = fmax(NORMAL_SCALE * middle, MIN_SCALE * size);
    uint64_t found = 0;
    for (size_t begin = 0; begin < points->count; begin += NEIGHBOURS)
    {
        size_t end = begin + NEIGHBOURS < points->count ? begin + NEIGHBOURS : points->count;
        memcpy(sorted, points->distance + begin, (end - begin) * sizeof *sorted);
        double scale = fmax(NORMAL_SCALE * sort_median(sorted, end - begin), global);
        for (size_t row = begin; row < end; row++)
        {
            if (points->number[row] >= points->own)
                continue;
            double share = scale > 0 ? points->distance[row] / (TUKEY_REACH * scale) : 0, left = 1 - share * share;
            points->weight[row] = share < 1 ? left * left : 0;
            found += points->weight[row] == 0;
        }
    }
    status = team_sum_counts(points->team, &found, 1, error);
    *outliers = (size_t)found;
    return status;
}

_Static_assert(FIT_BLOCK % NEIGHBOURS == 0, "neighbours are of one block");

// The points of a fit in Morton order (Morton, 1966), by a radix sort of interleaved parameter bits, and sorted by cell.

enum
{
    MORTON_BITS = 16, ///< of each parameter in a Morton key
    RADIX_BITS = 11,  ///< sorted in one pass
    RADIX_PASSES = 3, ///< cover all 2 x MORTON_BITS bits
    RADIX_SIZE = 1 << RADIX_BITS,
    OPERATIONS_TO_LOCATE = 100 ///< estimate for one point, for threads_worth()
};

/// @param total number of points of all processes
static bat_status check_counts(const bat_surface_fit_data *data, size_t total, bat_error *error)
{
    size_t product;
    const char *wrong = NULL;
    if (data->dimension < 1)
        wrong = "the dimension of the points must be at least 1";
    else if (data->boundary_count > total)
        wrong = "there are more boundary points than points";
    if (wrong != NULL)
        return ERROR_ARGUMENT(error, "%s", wrong);
    if (total >= UINT32_MAX || size_multiply_overflows(data->count, data->dimension, &product))
        return ERROR_TOO_LARGE(error, "%zu points are more than a fit can process", total);
    return BAT_OK;
}

static bool is_end(double parameter)
{
    return parameter == 0 || parameter == 1;
}

/// @param number the place of point i among all points
static bat_status check_point(const bat_surface_fit_data *data, size_t i, size_t number, bat_error *error)
{
    const double *point = data->points + i * data->dimension, *at = data->parameters + 2 * i;
    if (!vector_is_finite(data->dimension, point))
        return error_set(error, BAT_INVALID_POINT, number, 0, "point %zu has a coordinate that is not finite", number);
    if (!(at[0] >= 0 && at[0] <= 1 && at[1] >= 0 && at[1] <= 1))
        return error_set(error, BAT_INVALID_POINT, number, 0,
                         "the parameter (%g, %g) of point %zu is outside the unit square", at[0], at[1], number);
    if (number < data->boundary_count && !is_end(at[0]) && !is_end(at[1]))
        return error_set(error, BAT_INVALID_POINT, number, 0,
                         "the parameter (%g, %g) of boundary point %zu is not on the boundary of the square", at[0], at[1],
                         number);
    return BAT_OK;
}

/// @param number the place of point i among all points
static fit_freedom freedom_of(const bat_surface_fit_data *data, size_t i, size_t number)
{
    const double *at = data->parameters + 2 * i;
    if (number >= data->boundary_count)
        return FIT_FREE;
    if (!data->slides || (is_end(at[0]) && is_end(at[1])))
        return FIT_FIXED;
    return is_end(at[0]) ? FIT_ALONG_V : FIT_ALONG_U;
}

/// The bits of a coordinate, each followed by a zero.
static uint64_t spread_bits(double parameter)
{
    uint64_t spread = 0, bits = (uint64_t)(parameter * ((1 << MORTON_BITS) - 1));
    for (int b = 0; b < MORTON_BITS; b++)
        spread |= (bits >> b & 1) << 2 * b;
    return spread;
}

uint32_t fit_points_place(const double parameter[2])
{
    return (uint32_t)(spread_bits(parameter[0]) | spread_bits(parameter[1]) << 1);
}

/// Radix sort by the upper 32 bits of the keys, which hold the Morton code; the lower 32 bits hold the point's index.
static void sort_keys(uint64_t *keys, uint64_t *other, size_t count)
{
    for (int pass = 0; pass < RADIX_PASSES; pass++)
    {
        size_t place[RADIX_SIZE] = {0}, sum = 0;
        int shift = 32 + pass * RADIX_BITS;
        for (size_t i = 0; i < count; i++)
            place[keys[i] >> shift & (RADIX_SIZE - 1)]++;
        for (size_t k = 0; k < RADIX_SIZE; k++)
        {
            size_t here = place[k];
            place[k] = sum;
            sum += here;
        }
        for (size_t i = 0; i < count; i++)
            other[place[keys[i] >> shift & (RADIX_SIZE - 1)]++] = keys[i];
        SWAP(keys, other);
    }
}

/// Order the points along the Morton curve.
static bat_status set_numbers(const bat_surface_fit_data *data, uint32_t *number, bat_error *error)
{
    uint64_t *keys = memory_array(data->count, 2 * sizeof *keys);
    if (keys == NULL)
        return error_memory(error, data->count * 2 * sizeof *keys);
    for (size_t i = 0; i < data->count; i++)
    {
        const double *at = data->parameters + 2 * i;
        keys[i] = (uint64_t)fit_points_place(at) << 32 | i;
    }
    sort_keys(keys, keys + data->count, data->count);
    // An odd number of passes leaves the result in the second half.
    for (size_t i = 0; i < data->count; i++)
        number[i] = (uint32_t)keys[data->count + i];
    free(keys);
    return BAT_OK;
}

/// Compute the mean position, and subtract it. The mean is that of the means of blocks.
static bat_status subtract_centre(fit_points *points, bat_error *error)
{
    size_t dimension = points->dimension, blocks = fit_blocks(points->count);
    double *rows = calloc(blocks * dimension + 1, sizeof *rows);
    if (rows == NULL)
        return error_memory(error, blocks * dimension * sizeof *rows);
    for (size_t row = 0; row < points->count; row++)
    {
        size_t block = row / FIT_BLOCK, before = row % FIT_BLOCK;
        for (size_t k = 0; k < dimension; k++)
        {
            double *mean = &rows[block * dimension + k];
            *mean += (points->position[row * dimension + k] - *mean) / (double)(before + 1);
        }
    }
    for (size_t block = 0; block < blocks; block++)
    {
        size_t left = points->count - block * FIT_BLOCK;
        double share = (double)(left < FIT_BLOCK ? left : FIT_BLOCK) / (double)points->total;
        vector_scale(dimension, share, rows + block * dimension);
    }
    bat_status status = fit_sum_rows(points->team, rows, blocks, dimension, points->centre, error);
    for (size_t k = 0; status == BAT_OK && k < points->count * dimension; k++)
        points->position[k] -= points->centre[k % dimension];
    free(rows);
    return status;
}

static bat_status allocate(fit_points *points, bat_error *error)
{
    size_t count = points->count;
    memory_pool *pool = &points->pool;
    points->number = memory_pool_array(pool, count, sizeof *points->number);
    points->position = memory_pool_array(pool, count * points->dimension, sizeof *points->position);
    points->parameter = memory_pool_array(pool, count, 2 * sizeof *points->parameter);
    points->weight = memory_pool_array(pool, count, sizeof *points->weight);
    points->distance = memory_pool_zeros(pool, count, sizeof *points->distance);
    points->freedom = memory_pool_array(pool, count, sizeof *points->freedom);
    points->centre = memory_pool_zeros(pool, points->dimension, sizeof *points->centre);
    points->order = memory_pool_array(pool, count, sizeof *points->order);
    points->cell = memory_pool_array(pool, count, sizeof *points->cell);
    return memory_pool_check(pool, error);
}

bat_status fit_points_make(const fit_team *team, const bat_surface_fit_data *data, const uint32_t *numbers, bool centred,
                           fit_points *points, bat_error *error)
{
    uint64_t total = data->count, before = 0;
    size_t own = numbers != NULL ? SIZE_MAX : data->count;
    *points = (fit_points){.team = team,
                           .is_part = numbers != NULL,
                           .own = own,
                           .guides = own,
                           .count = data->count,
                           .dimension = data->dimension};
    bat_status status = allocate(points, error);
    if (status == BAT_OK)
        status = team_sum_counts(team, &total, 1, error);
    if (status == BAT_OK)
        status = team_sum_before(team, data->count, &before, error);
    if (status == BAT_OK && numbers == NULL)
        status = set_numbers(data, points->number, error);
    if (status != BAT_OK)
        return status;
    points->total = (size_t)total;
    points->before = (size_t)before;
    if (numbers != NULL)
        memcpy(points->number, numbers, data->count * sizeof *numbers);
    for (size_t row = 0; row < points->count; row++)
    {
        size_t i = numbers != NULL ? row : points->number[row];
        memcpy(points->position + row * points->dimension, data->points + i * points->dimension,
               points->dimension * sizeof *points->position);
        memcpy(points->parameter + 2 * row, data->parameters + 2 * i, 2 * sizeof *points->parameter);
        points->weight[row] = 1;
        points->freedom[row] = (uint8_t)freedom_of(data, i, points->number[row]);
    }
    return centred ? subtract_centre(points, error) : BAT_OK;
}

/// Check that the points of a part follow the curve, and those before it are whole blocks.
static bat_status check_part(const fit_team *team, const bat_surface_fit_data *data, const uint32_t *numbers,
                             bat_error *error)
{
    uint64_t before = 0;
    bat_status status = team_sum_before(team, data->count, &before, error);
    if (status == BAT_OK && data->count > 0 && before % FIT_BLOCK != 0)
        status = ERROR_ARGUMENT(error, "the points before rank %zu are not whole blocks", team_rank(team));
    for (size_t i = 1; i < data->count && status == BAT_OK; i++)
    {
        uint32_t place = fit_points_place(data->parameters + 2 * i);
        uint32_t last = fit_points_place(data->parameters + 2 * i - 2);
        if (place < last || (place == last && numbers[i] <= numbers[i - 1]))
            status = error_set(error, BAT_INVALID_ARGUMENT, i, 0, "point %zu of this process is not in order", i);
    }
    return status;
}

bat_status fit_points_check(const fit_team *team, const bat_surface_fit_data *data, const uint32_t *numbers,
                            bat_error *error)
{
    uint64_t total = data->count;
    bat_status status = team_sum_counts(team, &total, 1, error);
    if (status == BAT_OK)
        status = check_counts(data, (size_t)total, error);
    if (status == BAT_OK && total < 1)
        status = ERROR_ARGUMENT(error, "there are no points to fit");
    for (size_t i = 0; i < data->count && status == BAT_OK; i++)
        status = check_point(data, i, numbers != NULL ? numbers[i] : i, error);
    if (numbers != NULL)
    {
        status = team_agree(team, status, error);
        return status == BAT_OK ? team_agree(team, check_part(team, data, numbers, error), error) : status;
    }
    for (size_t i = 0; i < 2 * data->guide_count && status == BAT_OK; i++)
        if (!(data->guide_parameters[i] >= 0 && data->guide_parameters[i] <= 1))
            status = error_set(error, BAT_INVALID_POINT, i / 2, 0, "the parameter of guide %zu is outside the unit square",
                               i / 2);
    for (size_t i = 0; i < data->dimension * data->guide_count && status == BAT_OK; i++)
        if (!isfinite(data->guides[i]))
            status = error_set(error, BAT_INVALID_POINT, i / data->dimension, 0,
                               "guide %zu has a coordinate that is not finite", i / data->dimension);
    return status;
}

void fit_points_free(fit_points *points)
{
    memory_pool_free(&points->pool);
    free(points->first);
    free(points->spread);
    *points = (fit_points){0};
}

void fit_points_locate(fit_points *points, const bat_hierarchical_space *space, int threads)
{
    double operations = OPERATIONS_TO_LOCATE * (double)points->count;
#pragma omp parallel for schedule(static) num_threads(threads_worth(threads, points->count, operations))
    for (size_t row = 0; row < points->count; row++)
        points->cell[row] =
            (uint32_t)bat_hierarchical_space_locate(space, points->parameter[2 * row], points->parameter[2 * row + 1]);
}

bat_status fit_points_sort(fit_points *points, const bat_hierarchical_space *space, bat_error *error)
{
    size_t cells = bat_hierarchical_space_cells(space);
    size_t *first = calloc(cells + 2, sizeof *first);
    if (first == NULL)
        return error_memory(error, (cells + 2) * sizeof *first);
    free(points->first);
    points->first = first;
    points->cells = cells;
    // Counting sort: counts are stored two entries ahead, so that offsets advance into place while the order is filled.
    for (size_t row = 0; row < points->count; row++)
        first[points->cell[row] + 2]++;
    for (size_t c = 0; c <= cells; c++)
        first[c + 1] += first[c];
    for (size_t row = 0; row < points->count; row++)
        points->order[first[points->cell[row] + 1]++] = (uint32_t)row;
    if (team_count(points->team) == 1)
        return BAT_OK;
    free(points->spread);
    if (array_make(&points->spread, cells, sizeof *points->spread, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t c = 0; c < cells; c++)
        points->spread[c] = first[c + 1] - first[c];
    return team_sum_counts(points->team, points->spread, cells, error);
}

void fit_points_restore(const fit_points *points, size_t functions, double *control)
{
    for (size_t f = 0; f < functions; f++)
        vector_add(points->dimension, 1, points->centre, control + f * points->dimension);
}

size_t fit_points_return(const fit_points *points, bat_surface_fit_data *data)
{
    size_t moved = 0;
    for (size_t row = 0; row < points->count; row++)
    {
        if (points->number[row] >= points->own)
            continue;
        double *at = data->parameters + 2 * (points->is_part ? row : (size_t)points->number[row]);
        const double *now = points->parameter + 2 * row;
        moved += at[0] != now[0] || at[1] != now[1];
        memcpy(at, now, 2 * sizeof *at);
    }
    return moved;
}
