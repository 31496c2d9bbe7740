#include "mesh/refine/loop.h"

#include "base/error.h"
#include "batten/mesh_refine.h"
#include "linalg/vector3.h"
#include "mesh/refine/limit.h"
#include "mesh/refine/normal.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// Limit positions and normals of Loop's scheme (Loop, 1987; Halstead, Kass and DeRose, "Efficient, fair interpolation using
/// Catmull-Clark surfaces", 1993).
///
/// A limit position is l^T (v, v_1, …, v_n), where l is the left eigenvector of the local subdivision matrix for the
/// eigenvalue 1. For a smooth vertex l has the weights 1 - n w and w with w = 1 / (n + 3 / (8 b)). Creases are cubic
/// B-splines with (1, 4, 1) / 6.

/// The weight w of each neighbour in the limit position of a smooth vertex.
static double limit_ring_weight(unsigned valence)
{
    return 1 / (valence + 3 / (8 * loop_ring_weight(valence)));
}

/// The limit weights around a dart, whose sharp edge leads to neighbour 0. With b = loop_ring_weight() and weight 1 for the
/// vertex, 5 w_i - w_(i-1) - w_(i+1) = 8 b for 0 < i < n, without the terms w_0 and w_n, and w_0 = 2 b + (w_1 + w_(n-1))
/// / 4.
typedef struct dart_weights
{
    unsigned valence;
    double ring, total;
} dart_weights;

static double dart_weight(const dart_weights *dart, unsigned i)
{
    const double root = (5 - sqrt(21)) / 2;
    if (i == 0)
        return 2 * dart->ring + dart_weight(dart, 1) / 2;
    double there = pow(root, i), back = pow(root, dart->valence - i), around = pow(root, dart->valence);
    return 8 * dart->ring / 3 * (1 - (there + back) / (1 + around));
}

static dart_weights dart_make(unsigned valence)
{
    dart_weights dart = {valence, loop_ring_weight(valence), 1};
    for (unsigned i = 0; i < valence; i++)
        dart.total += dart_weight(&dart, i);
    return dart;
}

static void inner_limit(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp)
{
    const mesh_level *level = rows->level;
    size_t dim = rows->dim;
    bool is_dart = sharp->kind == SHARP_DART;
    unsigned valence = mesh_valence(level, vertex);
    dart_weights dart = is_dart ? dart_make(valence) : (dart_weights){0};
    double ring = is_dart ? 0 : limit_ring_weight(valence);
    double own = is_dart ? 1 / dart.total : 1 - valence * ring;
    uint32_t h = is_dart ? mesh_half_edge_to(level, vertex, sharp->ends[0]) : level->links->first[vertex];
    const double *from = rows->from + vertex * dim;
    double *restrict to = rows->to + vertex * dim;
    for (size_t i = 0; i < dim; i++)
        to[i] = own * from[i];
    for (unsigned n = 0; n < valence; n++)
    {
        const double *neighbour = rows->from + mesh_end(level->faces, h) * dim;
        double weight = is_dart ? dart_weight(&dart, n) / dart.total : ring;
        for (size_t i = 0; i < dim; i++)
            to[i] += weight * neighbour[i];
        h = bat_mesh_next_around(level->links, h);
    }
}

void loop_limit(const mesh_rows *rows, int threads)
{
    limit_rows(rows, inner_limit, threads);
}

// Limit normals.

static const double PI = 3.14159265358979323846;

/// The normal of a smooth vertex, for the double eigenvalue 3/8 + cos(2 pi / n) / 4.
static void smooth_normal(const normal_job *job, uint32_t vertex, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t h = level->links->first[vertex];
    unsigned valence = mesh_valence(level, vertex);
    double a[3] = {0}, b[3] = {0};
    for (unsigned j = 0; j < valence; j++)
    {
        double angle = 2 * PI * j / valence;
        normal_add_way(job, cos(angle), vertex, mesh_end(level->faces, h), a);
        normal_add_way(job, sin(angle), vertex, mesh_end(level->faces, h), b);
        h = bat_mesh_next_around(level->links, h);
    }
    vector3_cross(a, b, normal);
}

/// The eigenvalue along the crease is 1/2; the one across is 3/8 + cos(pi / faces) / 4, or 1/4 for a single face.
static void side_normal(const normal_job *job, uint32_t half_edge, unsigned faces, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t vertex = level->faces[half_edge], end = mesh_end(level->faces, half_edge), h = half_edge;
    double angle = PI / faces;
    double side = faces == 1 ? 1 : -sin(angle) * cos(angle) / ((1 - cos(angle)) * (1 + 2 * cos(angle)));
    double along[3] = {0}, across[3] = {0};
    normal_add_way(job, 1, vertex, end, along);
    normal_add_way(job, side, vertex, end, across);
    for (unsigned j = 1; j <= faces; j++)
    {
        end = mesh_opposite(level->faces, h);
        normal_add_way(job, j < faces ? sin(j * angle) : side, vertex, end, across);
        h = bat_mesh_next_around(level->links, h);
    }
    normal_add_way(job, -1, vertex, end, along);
    vector3_cross(along, across, normal);
}

static void multiply_dart(unsigned valence, const double *row, double *product)
{
    double ring = loop_ring_weight(valence);
    const double *from = row + 1;
    double *to = product + 1;
    product[0] = row[0] * (1 - valence * ring) + from[0] / 2;
    for (unsigned i = 0; i < valence; i++)
        to[i] = row[0] * ring + (i == 0 ? from[0] / 2 : 3.0 / 8 * from[i]);
    for (unsigned i = 1; i < valence; i++)
    {
        product[0] += 3.0 / 8 * from[i];
        to[i - 1] += from[i] / 8;
        to[(i + 1) % valence] += from[i] / 8;
    }
}

const normal_rules loop_normals = {.smooth = smooth_normal, .side = side_normal, .multiply = multiply_dart};
