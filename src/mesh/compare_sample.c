#include "mesh/compare.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <math.h>
#include <stdlib.h>

/// The samples: number i lies on the face below (i + shift) / count of the area, so that each face has its share to less than
/// one sample, at the i-th point of Roberts' sequence R2 ("The unreasonable effectiveness of quasirandom sequences", 2018), which
/// covers the unit square evenly, folded into a triangle.
typedef struct sampler
{
    double *areas; ///< of the faces up to each, in the order of the tree
    size_t faces, count;
    double shift, shift_u, shift_v;
} sampler;

/// 1 / g and 1 / g^2 for the real root g of g^3 = g + 1.
static const double R2_U = 0.75487766624669276005, R2_V = 0.56984029099805326591;

static double area_of(const compare_side *side, uint32_t face)
{
    const double *a = compare_corner(side, face, 0), *b = compare_corner(side, face, 1), *c = compare_corner(side, face, 2);
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return sqrt(x * x + y * y + z * z) / 2;
}

static bat_status sampler_make(const compare_side *side, const bat_mesh_compare_options *options, sampler *made,
                               bat_error *error)
{
    size_t faces = side->mesh.face_count;
    bat_random random = bat_random_seed(options->seed);
    *made = (sampler){.areas = memory_array(faces, sizeof *made->areas), .faces = faces, .count = options->samples};
    if (made->areas == NULL)
        return error_memory(error, faces * sizeof *made->areas);
    made->shift = bat_random_uniform(&random);
    made->shift_u = bat_random_uniform(&random);
    made->shift_v = bat_random_uniform(&random);
    double sum = 0;
    for (size_t f = 0; f < faces; f++)
        made->areas[f] = sum += area_of(side, side->tree.faces[f]);
    return BAT_OK;
}

/// How much of the area lies before sample `i`.
static double area_before(const sampler *from, size_t i)
{
    return ((double)i + from->shift) / (double)from->count * from->areas[from->faces - 1];
}

/// The first face up to which there is more than that area.
static size_t face_at(const sampler *from, double area)
{
    size_t begin = 0, end = from->faces - 1;
    while (begin < end)
    {
        size_t middle = begin + (end - begin) / 2;
        if (from->areas[middle] > area)
            end = middle;
        else
            begin = middle + 1;
    }
    return begin;
}

static void sample_point(const sampler *from, const compare_side *side, size_t i, uint32_t face, double point[3])
{
    double u = from->shift_u + (double)i * R2_U, v = from->shift_v + (double)i * R2_V;
    u -= floor(u);
    v -= floor(v);
    if (u + v > 1)
    {
        u = 1 - u;
        v = 1 - v;
    }
    const double *a = compare_corner(side, face, 0), *b = compare_corner(side, face, 1), *c = compare_corner(side, face, 2);
    for (int k = 0; k < 3; k++)
        point[k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]);
}

static void sample_block(const sampler *from, const compare_way *way, size_t block, compare_tally *tally)
{
    const compare_side *side = way->from;
    size_t begin = block * COMPARE_BLOCK;
    size_t end = from->count - begin < COMPARE_BLOCK ? from->count : begin + COMPARE_BLOCK;
    size_t at = face_at(from, area_before(from, begin));
    *tally = (compare_tally){.greatest = -1};
    uint32_t place = side->places[side->mesh.faces[3 * (size_t)side->tree.faces[at]]];
    for (size_t i = begin; i < end; i++)
    {
        double area = area_before(from, i), point[3];
        while (at + 1 < from->faces && from->areas[at] <= area)
            at++;
        sample_point(from, side, i, side->tree.faces[at], point);
        compare_count(tally, closest_find(&way->onto->tree, point, &place), point);
    }
}

static bat_status take_samples(const sampler *from, compare_way *way, int threads, size_t first_piece, shared_work *work,
                               bat_error *error)
{
    size_t blocks = (from->count + COMPARE_BLOCK - 1) / COMPARE_BLOCK;
    compare_tally *tallies = memory_array(blocks, sizeof *tallies);
    if (tallies == NULL)
        return error_memory(error, blocks * sizeof *tallies);
    threads = threads_for(threads, blocks);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t block = 0; block < blocks; block++)
        if (shared_work_wants(work, first_piece + block))
        {
            sample_block(from, way, block, &tallies[block]);
            shared_work_finish(work, first_piece + block, BAT_OK, NULL);
        }
    if (!work->cancelled)
        compare_sum_up(tallies, blocks, from->count, way);
    free(tallies);
    return BAT_OK;
}

bat_status compare_samples(compare_way *way, const char *which, const bat_mesh_compare_options *options, size_t first_piece,
                           shared_work *work, bat_error *error)
{
    sampler from;
    bat_status status = sampler_make(way->from, options, &from, error);
    if (status == BAT_OK && !(from.areas[from.faces - 1] > 0))
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the %s mesh has no area", which);
    if (status == BAT_OK)
        status = take_samples(&from, way, options->threads, first_piece, work, error);
    free(from.areas);
    return status;
}
