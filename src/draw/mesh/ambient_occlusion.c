#include "draw/mesh/ambient_occlusion.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <math.h>
#include <stdlib.h>

/// Directions change from pixel to pixel in tiles of TILE x TILE, which a mean over as many evens out.
#define TILE 4
#define TAPS 16

/// Where to look from a pixel of a tile, in shares of the reach.
typedef struct tap_list
{
    float offsets[TILE * TILE][TAPS][2];
} tap_list;

static void spread_taps(tap_list *taps)
{
    const double golden = 2.39996322972865332;
    for (int cell = 0; cell < TILE * TILE; cell++)
        for (int tap = 0; tap < TAPS; tap++)
        {
            // A spiral, turned for every cell, the turns in an order that keeps neighbours different.
            double share = sqrt((tap + 0.35 + 0.3 * (cell % 3)) / TAPS);
            double angle = golden * tap + 6.283185307179586 * (cell * 7 % (TILE * TILE)) / (TILE * TILE);
            taps->offsets[cell][tap][0] = (float)(share * cos(angle));
            taps->offsets[cell][tap][1] = (float)(share * sin(angle));
        }
}

/// How much one place above the surface's plane takes away: the more, the steeper it is seen, and nothing from beyond the
/// reach.
static double shadow_of(const hollow_picture *picture, size_t here, size_t there, double across, double down)
{
    double depth = picture->depths[there];
    if (depth == -HUGE_VAL)
        return 0;
    const float *normal = picture->normals[here];
    double rise = depth - (double)picture->depths[here];
    double length = sqrt(across * across + down * down + rise * rise) + 1e-9;
    double height = (normal[0] * across - normal[1] * down + normal[2] * rise) / length;
    double nearness = length / picture->reach;
    return nearness >= 1.6 ? 0 : fmax(height - 0.08, 0) * fmin(1, (1.6 - nearness) / 0.6);
}

static double light_at(const hollow_picture *picture, const tap_list *taps, size_t column, size_t row)
{
    size_t here = row * picture->columns + column;
    double shadow = 0;
    for (int tap = 0; tap < TAPS; tap++)
    {
        const float *offset = taps->offsets[row % TILE * TILE + column % TILE][tap];
        double x = rint((double)column + offset[0] * picture->reach), y = rint((double)row + offset[1] * picture->reach);
        if (x < 0 || y < 0 || x >= (double)picture->columns || y >= (double)picture->rows)
            continue;
        size_t there = (size_t)y * picture->columns + (size_t)x;
        if (there != here)
            shadow += shadow_of(picture, here, there, x - (double)column, y - (double)row);
    }
    return fmax(0, 1 - 2.0 * shadow / TAPS);
}

/// The mean over a tile of those pixels that lie about as deep.
static float smooth_at(const hollow_picture *picture, const float *rough, size_t column, size_t row)
{
    size_t here = row * picture->columns + column;
    double sum = 0, weight = 0;
    for (size_t y = row < 2 ? 0 : row - 2; y < row + 2 && y < picture->rows; y++)
        for (size_t x = column < 2 ? 0 : column - 2; x < column + 2 && x < picture->columns; x++)
        {
            size_t there = y * picture->columns + x;
            if (fabsf(picture->depths[there] - picture->depths[here]) > 0.35 * picture->reach)
                continue;
            sum += rough[there];
            weight += 1;
        }
    return weight > 0 ? (float)(sum / weight) : rough[here];
}

bat_status hollow_light(const hollow_picture *picture, int threads, float *light, bat_error *error)
{
    tap_list taps;
    spread_taps(&taps);
    size_t columns = picture->columns, rows = picture->rows;
    float *rough = memory_array(columns * rows, sizeof *rough);
    if (rough == NULL)
        return error_memory(error, columns * rows * sizeof *rough);
    int count = threads_for(threads, rows / 16 + 1);
#pragma omp parallel for num_threads(count) schedule(static)
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++)
        {
            bool seen = picture->depths[row * columns + column] != -HUGE_VALF;
            rough[row * columns + column] = seen ? (float)light_at(picture, &taps, column, row) : 1;
        }
#pragma omp parallel for num_threads(count) schedule(static)
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++)
        {
            bool seen = picture->depths[row * columns + column] != -HUGE_VALF;
            light[row * columns + column] = seen ? smooth_at(picture, rough, column, row) : 1;
        }
    free(rough);
    return BAT_OK;
}
