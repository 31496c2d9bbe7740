#include "mesh/measure/compare.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <math.h>
#include <stdlib.h>

enum
{
    /// The points of a small triangle, each near one of its corners.
    POINTS = 3
};

static double area_of(const compare_side *side, uint32_t face)
{
    const double *a = compare_corner(side, face, 0), *b = compare_corner(side, face, 1), *c = compare_corner(side, face, 2);
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return sqrt(x * x + y * y + z * z) / 2;
}

/// Into how many parts a face's edges are cut.
static double parts_of(const compare_side *side, double area)
{
    return fmax(1, round(sqrt(area / side->area * side->wanted / POINTS)));
}

bat_status compare_plan_samples(compare_side *side, const char *which, size_t samples, bat_error *error)
{
    size_t faces = side->mesh.face_count;
    side->wanted = (double)samples;
    side->area = 0;
    for (size_t f = 0; f < faces; f++)
        side->area += area_of(side, side->tree.faces[f]);
    if (!(side->area > 0))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the %s mesh has no area", which);
    side->samples = memory_array(faces + 1, sizeof *side->samples);
    if (side->samples == NULL)
        return error_memory(error, faces * sizeof *side->samples);
    side->samples[0] = 0;
    for (size_t f = 0; f < faces; f++)
    {
        double parts = parts_of(side, area_of(side, side->tree.faces[f]));
        side->samples[f + 1] = side->samples[f] + (size_t)(POINTS * parts * parts);
    }
    return BAT_OK;
}

/// The face (by its number in the tree's order) that a sample lies on.
static size_t face_of(const compare_side *side, size_t sample)
{
    size_t begin = 0, end = side->mesh.face_count;
    while (end - begin > 1)
    {
        size_t middle = begin + (end - begin) / 2;
        if (side->samples[middle] <= sample)
            begin = middle;
        else
            end = middle;
    }
    return begin;
}

/// Point number `i` of a face whose edges are cut in `parts`. Row r of small triangles, counted from corner 0, has 2 r + 1
/// of them, by turns with the tip towards corner 0 and away from it; column c is as many parts of the third edge away from
/// the first.
static void sample_point(const compare_side *side, uint32_t face, size_t i, double parts, double point[3])
{
    static const double NEAR = 2.0 / 3, FAR = 1.0 / 6;
    size_t number = i / POINTS;
    double triangle = (double)number, row = floor(sqrt(triangle)), at = triangle - row * row, column = floor(at / 2);
    bool away = at != 2 * column;
    const double rows[POINTS] = {row, away ? row : row + 1, row + 1};
    const double columns[POINTS] = {column, away ? column + 1 : column, column + 1};
    double down = 0, across = 0;
    for (size_t corner = 0; corner < POINTS; corner++)
    {
        double weight = (corner == i % POINTS ? NEAR : FAR) / parts;
        down += weight * rows[corner];
        across += weight * columns[corner];
    }
    const double *a = compare_corner(side, face, 0), *b = compare_corner(side, face, 1), *c = compare_corner(side, face, 2);
    for (int k = 0; k < 3; k++)
        point[k] = a[k] + (down - across) * (b[k] - a[k]) + across * (c[k] - a[k]);
}

static void sample_block(const compare_side *side, const closest_tree *onto, size_t block, compare_tally *tally)
{
    size_t i = block * COMPARE_BLOCK, count = side->samples[side->mesh.face_count];
    size_t end = count - i < COMPARE_BLOCK ? count : i + COMPARE_BLOCK;
    *tally = (compare_tally){.greatest = -1};
    for (size_t f = face_of(side, i); i < end; f++)
    {
        uint32_t face = side->tree.faces[f], place = side->places[side->mesh.faces[3 * (size_t)face]];
        double area = area_of(side, face), parts = parts_of(side, area), weight = area / (POINTS * parts * parts);
        for (; i < end && i < side->samples[f + 1]; i++)
        {
            double point[3];
            sample_point(side, face, i - side->samples[f], parts, point);
            compare_count(tally, closest_find(onto, point, &place), weight, point);
        }
    }
}

bat_status compare_samples(compare_way *way, int threads, size_t first_piece, shared_work *work, bat_error *error)
{
    size_t blocks = compare_sample_blocks(way->from);
    compare_tally *tallies = memory_array(blocks, sizeof *tallies);
    if (tallies == NULL)
        return error_memory(error, blocks * sizeof *tallies);
    threads = threads_for(threads, blocks);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t block = 0; block < blocks; block++)
        if (shared_work_wants(work, first_piece + block))
        {
            sample_block(way->from, &way->onto->tree, block, &tallies[block]);
            shared_work_finish(work, first_piece + block, BAT_OK, NULL);
        }
    if (!work->cancelled)
        compare_sum_up(tallies, blocks, way);
    free(tallies);
    return BAT_OK;
}
