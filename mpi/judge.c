#include "judge.h"

#include "ranks.h"

#include <stdlib.h>
#include <string.h>

enum
{
    MAX_JUDGED = 50000,  ///< points
    PATCHES = 16,        ///< that tell the noise of more points,
    PATCH_POINTS = 3000, ///< of so many neighbours on the curve
    WIDTH = 7            ///< numbers of a point that is sent: its number, place, parameter and distance
};

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/// Collect rows of numbers on rank 0.
/// @param count receives the number of all rows
/// @return them in the order of ranks; null elsewhere
static double *collect(const double *rows, size_t mine, size_t *count)
{
    int ranks = ranks_count(), numbers = (int)(mine * WIDTH), *counts = ranks_allocate(2 * (size_t)ranks, sizeof *counts);
    int *places = counts + ranks, total = 0;
    (void)MPI_Gather(&numbers, 1, MPI_INT, counts, 1, MPI_INT, 0, MPI_COMM_WORLD);
    for (int rank = 0; rank < ranks; rank++)
    {
        places[rank] = total;
        total += counts[rank];
    }
    double *all = ranks_rank() == 0 ? ranks_allocate((size_t)total, sizeof *all) : NULL;
    (void)MPI_Gatherv(rows, numbers, MPI_DOUBLE, all, counts, places, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    free(counts);
    *count = (size_t)total / WIDTH;
    return all;
}

static void set_row(const fit_input *input, const double *distances, size_t i, double *row)
{
    row[0] = (double)input->numbers[i];
    memcpy(row + 1, input->points + 3 * i, 3 * sizeof *row);
    memcpy(row + 4, input->parameters + 2 * i, 2 * sizeof *row);
    row[6] = distances[i];
}

/// Rows of this rank for which `wanted` holds.
static double *choose(const fit_input *input, const double *distances, bool (*wanted)(size_t row, size_t total),
                      size_t *count)
{
    *count = 0;
    for (size_t i = 0; i < input->count; i++)
        *count += wanted(input->first + i, input->total);
    double *rows = ranks_allocate(*count * WIDTH, sizeof *rows);
    for (size_t i = 0, at = 0; i < input->count; i++)
        if (wanted(input->first + i, input->total))
            set_row(input, distances, i, rows + WIDTH * at++);
    return rows;
}

static bool is_judged(size_t row, size_t total)
{
    return row % ((total + MAX_JUDGED - 1) / MAX_JUDGED) == 0;
}

/// The first row of a patch.
static size_t patch_begin(size_t patch, size_t total)
{
    return total * (2 * patch + 1) / (2 * (size_t)PATCHES) - PATCH_POINTS / 2;
}

static bool is_in_patch(size_t row, size_t total)
{
    size_t patch = row * PATCHES / total;
    return row - patch_begin(patch, total) < PATCH_POINTS;
}

/// The median over patches.
static double noise_of_patches(const double *rows, size_t count)
{
    double noise[PATCHES], *points = ranks_allocate(3 * PATCH_POINTS, sizeof *points);
    bat_error error;
    for (size_t patch = 0; patch < PATCHES; patch++)
    {
        bat_cloud cloud = {.points = points, .count = PATCH_POINTS};
        for (size_t i = 0; i < PATCH_POINTS && patch * PATCH_POINTS + i < count; i++)
            memcpy(points + 3 * i, rows + (patch * PATCH_POINTS + i) * WIDTH + 1, 3 * sizeof *points);
        ranks_need(NULL, bat_cloud_noise(&cloud, &noise[patch], &error), &error);
    }
    free(points);
    qsort(noise, PATCHES, sizeof *noise, compare_numbers);
    return noise[PATCHES / 2];
}

/// Judge on rank 0 by rows of numbers.
static void judge_rows(const fit_input *input, const double *rows, size_t count, const bat_spline_surface *surface,
                       const bat_surface_fit_options *options, bat_surface_verdict *verdict, double *noise)
{
    double *numbers = ranks_allocate(count * 6, sizeof *numbers), *parameters = numbers + 3 * count;
    double *distances = parameters + 2 * count;
    bat_error error;
    for (size_t i = 0; i < count; i++)
    {
        memcpy(numbers + 3 * i, rows + WIDTH * i + 1, 3 * sizeof *numbers);
        memcpy(parameters + 2 * i, rows + WIDTH * i + 4, 2 * sizeof *numbers);
        distances[i] = rows[WIDTH * i + 6];
    }
    bat_cloud cloud = {.points = numbers, .count = count};
    if (count == input->total)
        cloud.boundary_count = input->boundary_count;
    ranks_need(NULL, bat_surface_judge(surface, &cloud, parameters, distances, options, verdict, &error), &error);
    if (count == input->total)
        ranks_need(NULL, bat_cloud_noise(&cloud, noise, &error), &error);
    free(numbers);
}

void judge_surface(const fit_input *input, const double *distances, const bat_spline_surface *surface,
                   const bat_surface_fit_options *options, bat_surface_verdict *verdict, double *noise)
{
    size_t mine, count;
    double *rows = choose(input, distances, is_judged, &mine), *all = collect(rows, mine, &count);
    free(rows);
    if (all != NULL)
    {
        // The order of the input, as on one machine.
        qsort(all, count, WIDTH * sizeof *all, compare_numbers);
        judge_rows(input, all, count, surface, options, verdict, noise);
    }
    free(all);
    if (input->total <= MAX_JUDGED)
        return;
    rows = choose(input, distances, is_in_patch, &mine);
    all = collect(rows, mine, &count);
    free(rows);
    if (all != NULL)
        *noise = noise_of_patches(all, count);
    free(all);
}
