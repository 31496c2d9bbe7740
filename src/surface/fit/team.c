/// @file
/// Exchange between the processes of a fit; see team.h. All of it is collection on rank 0 and broadcast from there, so that
/// every sum has one order.

#include "surface/fit/team.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bat_status team_broadcast(const bat_surface_team *team, void *bytes, size_t size, bat_error *error)
{
    return team == NULL || team->count == 1 || size == 0 ? BAT_OK : team->broadcast(team->context, bytes, size, error);
}

bat_status team_agree(const bat_surface_team *team, bat_status status, bat_error *error)
{
    bat_error own = {0}, *shared = error != NULL ? error : &own;
    if (team == NULL || team->count == 1)
        return status;
    bat_error sent = status == BAT_OK ? (bat_error){0} : *shared;
    sent.status = status;
    bat_status done = team_broadcast(team, &sent, sizeof sent, error);
    if (done == BAT_OK && sent.status != BAT_OK)
        *shared = sent;
    return done != BAT_OK ? done : sent.status;
}

bat_status team_gather(const bat_surface_team *team, const void *bytes, size_t size, size_t **sizes, char **all,
                       bat_error *error)
{
    void *received = NULL;
    size_t count = team == NULL ? 1 : team->count;
    *all = NULL;
    *sizes = memory_array(count, sizeof **sizes);
    if (*sizes == NULL)
        return error_memory(error, count * sizeof **sizes);
    if (team != NULL && count > 1)
    {
        bat_status status = team->gather(team->context, bytes, size, *sizes, &received, error);
        *all = received;
        return status;
    }
    (*sizes)[0] = size;
    *all = memory_array(size, 1);
    if (*all == NULL)
        return error_memory(error, size);
    memcpy(*all, bytes, size);
    return BAT_OK;
}

bat_status team_agree_all(const bat_surface_team *team, bat_status status, bat_error *error)
{
    if (team == NULL || team->count == 1)
        return status;
    bat_error own = status != BAT_OK && error != NULL ? *error : (bat_error){0};
    own.status = status;
    size_t *sizes;
    char *all;
    bat_status done = team_gather(team, &own, sizeof own, &sizes, &all, error);
    const bat_error *found = (const bat_error *)(void *)all;
    for (size_t rank = team->count; done == BAT_OK && found != NULL && rank-- > 0;)
        if (found[rank].status != BAT_OK)
            own = found[rank];
    free(sizes);
    free(all);
    if (done == BAT_OK)
        done = team_broadcast(team, &own, sizeof own, error);
    if (done == BAT_OK && error != NULL && own.status != BAT_OK)
        *error = own;
    return done != BAT_OK ? done : own.status;
}

/// Combine the numbers of all ranks on rank 0, and broadcast the result.
/// @param add combines a rank's numbers with those of lower ranks, in `numbers`
static bat_status reduce(const bat_surface_team *team, void *numbers, size_t size,
                         void (*add)(void *numbers, const void *more, size_t size), bat_error *error)
{
    if (team == NULL || team->count == 1)
        return BAT_OK;
    size_t *sizes;
    char *all;
    bat_status status = team_gather(team, numbers, size, &sizes, &all, error);
    for (size_t rank = 1; status == BAT_OK && all != NULL && rank < team->count; rank++)
        add(numbers, all + rank * size, size);
    free(sizes);
    free(all);
    return status == BAT_OK ? team_broadcast(team, numbers, size, error) : status;
}

static void add_counts(void *numbers, const void *more, size_t size)
{
    uint64_t *to = numbers;
    const uint64_t *from = more;
    for (size_t k = 0; k < size / sizeof *to; k++)
        to[k] += from[k];
}

bat_status team_sum_counts(const bat_surface_team *team, uint64_t *numbers, size_t count, bat_error *error)
{
    return reduce(team, numbers, count * sizeof *numbers, add_counts, error);
}

static void add_largest(void *numbers, const void *more, size_t size)
{
    double *to = numbers;
    const double *from = more;
    for (size_t k = 0; k < size / sizeof *to; k++)
        to[k] = fmax(to[k], from[k]);
}

bat_status team_largest(const bat_surface_team *team, double *numbers, size_t count, bat_error *error)
{
    return reduce(team, numbers, count * sizeof *numbers, add_largest, error);
}

bat_status team_sum_before(const bat_surface_team *team, uint64_t number, uint64_t *sum, bat_error *error)
{
    *sum = 0;
    if (team == NULL || team->count == 1)
        return BAT_OK;
    uint64_t *each = calloc(team->count, sizeof *each);
    if (each == NULL)
        return error_memory(error, team->count * sizeof *each);
    each[team->rank] = number;
    bat_status status = team_sum_counts(team, each, team->count, error);
    for (size_t rank = 0; rank < team->rank; rank++)
        *sum += each[rank];
    free(each);
    return status;
}

bat_status team_sum_rows(const bat_surface_team *team, const double *rows, size_t count, size_t width, double *sums,
                         bat_error *error)
{
    size_t *sizes = NULL, all_rows = count;
    char *all = NULL;
    bat_status status = BAT_OK;
    memset(sums, 0, width * sizeof *sums);
    if (team != NULL && team->count > 1)
    {
        all_rows = 0;
        status = team_gather(team, rows, count * width * sizeof *rows, &sizes, &all, error);
        for (size_t rank = 0; status == BAT_OK && all != NULL && rank < team->count; rank++)
            all_rows += sizes[rank] / (width * sizeof *rows);
        rows = (const double *)(const void *)all;
    }
    for (size_t row = 0; status == BAT_OK && row < all_rows; row++)
        for (size_t k = 0; k < width; k++)
            sums[k] += rows[row * width + k];
    free(sizes);
    free(all);
    return status == BAT_OK ? team_broadcast(team, sums, width * sizeof *sums, error) : status;
}

bat_status team_sum_points(const bat_surface_team *team, size_t points, team_terms *terms, const void *context, size_t width,
                           int threads, double *sums, bat_error *error)
{
    size_t blocks = team_blocks(points);
    double *rows = calloc(blocks * width + 1, sizeof *rows);
    if (rows == NULL)
        return error_memory(error, blocks * width * sizeof *rows);
#pragma omp parallel for schedule(static) num_threads(threads_worth(threads, blocks, 10 * (double)points))
    for (size_t block = 0; block < blocks; block++)
    {
        double own[TEAM_TERMS] = {0};
        size_t begin = block * BAT_SURFACE_FIT_BLOCK, end = begin + BAT_SURFACE_FIT_BLOCK;
        for (size_t row = begin; row < end && row < points; row++)
            terms(context, row, own);
        memcpy(rows + block * width, own, width * sizeof *own);
    }
    bat_status status = team_sum_rows(team, rows, blocks, width, sums, error);
    free(rows);
    return status;
}

bat_status team_select(const bat_surface_team *team, const double *values, size_t count, uint64_t place, double *selected,
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
