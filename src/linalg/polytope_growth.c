#include "linalg/polytope_growth.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/dense.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/// Unit vectors are added at this size, so that the polytope has an interior whatever the seeds; seeds have largest entry 1.
#define UNIT_RADIUS 0x1p-8
/// An image with a norm up to this counts as inside.
#define INSIDE (1.0 + 1e-11)

bat_status polytope_growth_make(const matrix_set *set, double rate, const double *seeds, size_t seed_count, size_t capacity,
                                polytope_growth *growth, bat_error *error)
{
    const size_t n = set->dimension;
    *growth = (polytope_growth){.set = set, .rate = rate};
    if (capacity < n + seed_count)
        capacity = n + seed_count;
    const bat_status status = polytope_make(n, capacity, UNIT_RADIUS, &growth->hull, error);
    for (size_t i = 0; status == BAT_OK && i < seed_count; i++)
        polytope_add(&growth->hull, seeds + i * n);
    return status;
}

void polytope_growth_free(polytope_growth *growth)
{
    polytope_free(&growth->hull);
}

/// A vector of `n` numbers, what rounding may have done to each, and its norm.
typedef struct image
{
    double norm;
    size_t index;
} image;

static int compare_images(const void *left, const void *right)
{
    const image *a = left;
    const image *b = right;
    if (a->norm != b->norm)
        return a->norm < b->norm ? 1 : -1;
    return a->index < b->index ? -1 : a->index > b->index;
}

/// image = matrix vertex / rate, with a bound of the rounding in every entry.
static void map_vertex(size_t n, const double *matrix, const double *vertex, double rate, double *mapped,
                       double *uncertainty)
{
    for (size_t i = 0; i < n; i++)
    {
        double sum = 0.0;
        double size = 0.0;
        for (size_t j = 0; j < n; j++)
        {
            const double term = matrix[i * n + j] * vertex[j];
            sum += term;
            size += fabs(term);
        }
        mapped[i] = sum / rate;
        uncertainty[i] = (double)(n + 3) * DBL_EPSILON * size / rate;
    }
}

/// Map the frontier: image (v, m) is number v * count + m.
static void measure_images(polytope_growth *growth, size_t vertex_count, image *images, double *vectors)
{
    const matrix_set *set = growth->set;
    const size_t n = set->dimension;
    for (size_t index = 0; index < vertex_count * set->count; index++)
    {
        const double *vertex = growth->hull.vertices + (growth->frontier + index / set->count) * n;
        double *mapped = vectors + 2 * index * n;
        map_vertex(n, matrix_set_at(set, index % set->count), vertex, growth->rate, mapped, mapped + n);
        images[index] = (image){polytope_norm(&growth->hull, mapped, mapped + n, 1.0), index};
    }
}

/// Add the images outside, the farthest first: one may take others inside.
static void add_images(polytope_growth *growth, const image *images, size_t count, const double *vectors)
{
    const size_t n = growth->set->dimension;
    for (size_t i = 0; i < count; i++)
    {
        if (images[i].norm <= INSIDE)
        {
            growth->largest_inside = fmax(growth->largest_inside, images[i].norm);
            continue;
        }
        const double *vector = vectors + 2 * images[i].index * n;
        const double norm = polytope_norm(&growth->hull, vector, vector + n, 1.0);
        if (norm <= INSIDE)
            growth->largest_inside = fmax(growth->largest_inside, norm);
        else if (polytope_add(&growth->hull, vector))
            growth->largest_inside = fmax(growth->largest_inside, 1.0);
        else
            growth->full = true;
    }
}

bat_status polytope_growth_round(polytope_growth *growth, double *bound, bool *closed, bat_error *error)
{
    const size_t vertex_count = growth->hull.count - growth->frontier;
    const size_t count = vertex_count * growth->set->count;
    const size_t n = growth->set->dimension;
    image *images = memory_array(count, sizeof *images);
    double *vectors = memory_array(count, 2 * n * sizeof *vectors);
    if (images == NULL || vectors == NULL)
    {
        free(images);
        free(vectors);
        return error_memory(error, count * 2 * n * sizeof *vectors);
    }
    const size_t old_count = growth->hull.count;
    measure_images(growth, vertex_count, images, vectors);
    qsort(images, count, sizeof *images, compare_images);
    const double farthest = count > 0 ? images[0].norm : 0.0;
    *closed = farthest <= INSIDE;
    *bound = growth->rate * fmax(growth->largest_inside, farthest) * (1.0 + 4.0 * DBL_EPSILON);
    add_images(growth, images, count, vectors);
    growth->frontier = old_count;
    free(images);
    free(vectors);
    return BAT_OK;
}
