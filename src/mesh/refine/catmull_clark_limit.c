#include "mesh/refine/catmull_clark.h"

#include "base/error.h"
#include "batten/mesh_refine.h"
#include "linalg/vector3.h"
#include "mesh/refine/limit.h"
#include "mesh/refine/normal.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// Limit positions and normals of Catmull and Clark's scheme (Halstead, Kass and DeRose, "Efficient, fair interpolation
/// using Catmull-Clark surfaces", 1993).
///
/// They are the left eigenvectors of the local subdivision matrix, applied to the vertices around. The rows of the limit
/// position are given for the neighbours and the means of the faces, so that they hold for faces of any number of corners.

/// The mean of column `k` at a face's corners.
static double face_mean(const mesh_rows *rows, uint32_t face, size_t k)
{
    const mesh_level *level = rows->level;
    uint32_t begin = sides_begin(&level->sides, face), end = sides_begin(&level->sides, face + 1);
    double sum = 0;
    for (uint32_t c = begin; c < end; c++)
        sum += rows->from[level->faces[c] * rows->dim + k];
    return sum / (end - begin);
}

/// The weights around a dart, whose sharp edge leads to neighbour 0, with weight 1 for the vertex: of neighbour i, and of
/// the vertex opposite in the quad between the neighbours i and i + 1. In the equations of the left eigenvector, 7 w_i -
/// w_(i-1)
/// - w_(i+1) = 20 / n^2 for 0 < i < n, without the terms w_0 and w_n.
static double dart_inner_weight(unsigned valence, unsigned i)
{
    const double root = (7 - sqrt(45)) / 2;
    if (i == 0 || i == valence)
        return 0;
    double n = valence;
    return 4 / (n * n) * (1 - (pow(root, i) + pow(root, n - i)) / (1 + pow(root, n)));
}

static double dart_edge_weight(unsigned valence, unsigned i)
{
    double n = valence;
    if (i > 0)
        return dart_inner_weight(valence, i);
    return 10 / (3 * n * n) + dart_inner_weight(valence, 1) / 3;
}

static double dart_face_weight(unsigned valence, unsigned i)
{
    double n = valence;
    return 1 / (3 * n * n) + (dart_inner_weight(valence, i) + dart_inner_weight(valence, i + 1)) / 12;
}

/// The limit of a dart or a smooth vertex.
static void inner_limit(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp)
{
    const mesh_level *level = rows->level;
    size_t dim = rows->dim;
    unsigned valence = mesh_valence(level, vertex);
    bool is_dart = sharp->kind == SHARP_DART;
    double n = valence, total = 1;
    for (unsigned i = 0; is_dart && i < valence; i++)
        total += dart_edge_weight(valence, i) + dart_face_weight(valence, i);
    uint32_t h = is_dart ? mesh_half_edge_to(level, vertex, sharp->ends[0]) : level->links->first[vertex];
    const double *from = rows->from + vertex * dim;
    double *restrict to = rows->to + vertex * dim;
    double own = is_dart ? 1 / total : (n - 1) / (n + 5);
    for (size_t k = 0; k < dim; k++)
        to[k] = own * from[k];
    for (unsigned i = 0; i < valence; i++)
    {
        // The corner opposite in a quad is four times the face's mean less the other three corners.
        double edge = is_dart ? dart_edge_weight(valence, i) / total : 2 / (n * (n + 5));
        double mean_weight = is_dart ? 4 * dart_face_weight(valence, i) / total : 4 / (n * (n + 5));
        const double *neighbour = rows->from + level->faces[sides_next(&level->sides, h)] * dim,
                     *before = rows->from + level->faces[sides_previous(&level->sides, h)] * dim;
        for (size_t k = 0; k < dim; k++)
        {
            to[k] += edge * neighbour[k] + mean_weight * face_mean(rows, sides_face(&level->sides, h), k);
            if (is_dart)
                to[k] -= mean_weight / 4 * (from[k] + neighbour[k] + before[k]);
        }
        h = sides_next_around(level, h);
    }
}

void catmull_clark_limit(const mesh_rows *rows, int threads)
{
    limit_rows(rows, inner_limit, threads);
}

// Limit normals.

static const double PI = 3.14159265358979323846;

/// The vertex opposite to the begin of a half-edge in its quad.
static uint32_t opposite_in_quad(const mesh_level *level, uint32_t half_edge)
{
    return level->faces[half_edge ^ 2];
}

/// The normal of a smooth vertex of two quads. The eigenvalue 1/4 is threefold there, so that tangents in different
/// directions do not lie in one plane in general. The two antisymmetric ones give the normal.
static void normal_of_two(const normal_job *job, uint32_t half_edge, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t other = sides_next_around(level, half_edge);
    double edges[3] = {0}, faces[3] = {0};
    normal_add_way(job, 1, level->faces[sides_next(&level->sides, other)],
                   level->faces[sides_next(&level->sides, half_edge)], edges);
    normal_add_way(job, 1, opposite_in_quad(level, other), opposite_in_quad(level, half_edge), faces);
    vector3_cross(edges, faces, normal);
}

/// The normal of a smooth vertex.
static void smooth_normal(const normal_job *job, uint32_t vertex, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t h = level->links->first[vertex];
    unsigned valence = mesh_valence(level, vertex);
    if (valence == 2)
    {
        normal_of_two(job, h, normal);
        return;
    }
    double step = 2 * PI / valence;
    double eigenvalue = (5 + cos(step) + cos(step / 2) * sqrt(2 * (9 + cos(step)))) / 16;
    double face = 1 / (4 * eigenvalue - 1), a[3] = {0}, b[3] = {0};
    for (unsigned i = 0; i < valence; i++)
    {
        uint32_t end = level->faces[sides_next(&level->sides, h)], opposite = opposite_in_quad(level, h);
        double angle = i * step;
        normal_add_way(job, 4 * cos(angle), vertex, end, a);
        normal_add_way(job, 4 * sin(angle), vertex, end, b);
        normal_add_way(job, face * (cos(angle) + cos(angle + step)), vertex, opposite, a);
        normal_add_way(job, face * (sin(angle) + sin(angle + step)), vertex, opposite, b);
        h = sides_next_around(level, h);
    }
    vector3_cross(a, b, normal);
}

/// The eigenvalue along the crease is 1/2. The tangent across is that of Biermann, Levin and Zorin, "Piecewise smooth
/// subdivision surfaces with normal control" (2000).
static void side_normal(const normal_job *job, uint32_t half_edge, unsigned faces, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t vertex = level->faces[half_edge], end = level->faces[sides_next(&level->sides, half_edge)], h = half_edge;
    double angle = PI / faces;
    double side = faces == 1 ? 1 : -(1 + cos(angle)) / sin(angle) * (1 + 2 * cos(angle));
    double along[3] = {0}, across[3] = {0};
    normal_add_way(job, 1, vertex, end, along);
    normal_add_way(job, side, vertex, end, across);
    for (unsigned i = 0; i < faces; i++)
    {
        if (faces > 1)
            normal_add_way(job, sin(i * angle) + sin((i + 1) * angle), vertex, opposite_in_quad(level, h), across);
        end = level->faces[sides_previous(&level->sides, h)];
        normal_add_way(job, i + 1 < faces ? 4 * sin((i + 1) * angle) : side, vertex, end, across);
        h = sides_next_around(level, h);
    }
    normal_add_way(job, -1, vertex, end, along);
    vector3_cross(along, across, normal);
}

static void multiply_dart(unsigned valence, const double *row, double *product)
{
    const double n = valence, *edges = row + 1, *faces = row + 1 + valence;
    double *edges_to = product + 1, *faces_to = product + 1 + valence;
    product[0] = row[0] * (1 - 7 / (4 * n)) + edges[0] / 2;
    for (unsigned i = 0; i < valence; i++)
    {
        edges_to[i] = row[0] * 3 / (2 * n * n) + (i == 0 ? edges[0] / 2 : 3.0 / 8 * edges[i]);
        faces_to[i] = row[0] / (4 * n * n) + faces[i] / 4;
    }
    for (unsigned i = 0; i < valence; i++)
    {
        unsigned after = (i + 1) % valence, before = (i + valence - 1) % valence;
        product[0] += faces[i] / 4;
        edges_to[i] += faces[i] / 4;
        edges_to[after] += faces[i] / 4;
        if (i == 0)
            continue;
        product[0] += 3.0 / 8 * edges[i];
        edges_to[before] += edges[i] / 16;
        edges_to[after] += edges[i] / 16;
        faces_to[before] += edges[i] / 16;
        faces_to[i] += edges[i] / 16;
    }
}

const normal_rules catmull_clark_normals = {
    .quads = true, .smooth = smooth_normal, .side = side_normal, .multiply = multiply_dart};
