#include "draw/mesh/shade.h"

#include "base/threads.h"
#include "linalg/vector.h"

/// @file
/// Scan conversion of triangles in bands of rows, one band for each thread.

/// The tolerance at the edges of faces, in samples, so that every sample belongs to a face.
#define EDGE_SLACK 1e-7

/// The smallest number of rows for a thread.
#define ROWS_PER_THREAD 64

/// The first and last of `count` samples with centres between `low` and `high`. False when there is none.
static bool sample_range(double low, double high, size_t from, size_t to, size_t *first, size_t *last)
{
    double begin = fmax(ceil(low - 0.5 - EDGE_SLACK), (double)from),
           end = fmin(floor(high - 0.5 + EDGE_SLACK), (double)to - 1);
    if (!(begin <= end))
        return false;
    *first = (size_t)begin;
    *last = (size_t)end;
    return true;
}

/// Draw a face into the rows from, …, to - 1.
static void draw_face(mesh_raster *raster, const uint32_t *corners, uint32_t face, size_t from, size_t to)
{
    const double *a = raster->places + 3 * (size_t)corners[0], *b = raster->places + 3 * (size_t)corners[1];
    const double *c = raster->places + 3 * (size_t)corners[2];
    size_t top, bottom, left, right;
    if (!sample_range(fmin(fmin(a[1], b[1]), c[1]), fmax(fmax(a[1], b[1]), c[1]), from, to, &top, &bottom) ||
        !sample_range(fmin(fmin(a[0], b[0]), c[0]), fmax(fmax(a[0], b[0]), c[0]), 0, raster->columns, &left, &right))
        return;
    double area = vector2_turn(a, b, c);
    if (area == 0)
        return;
    double inverse = 1 / area;
    // Barycentric coordinates for b and c; they are linear in x and y.
    double bx = (c[1] - a[1]) * inverse, by = (a[0] - c[0]) * inverse;
    double cx = (a[1] - b[1]) * inverse, cy = (b[0] - a[0]) * inverse;
    double slack = EDGE_SLACK * (fabs(bx) + fabs(by) + fabs(cx) + fabs(cy));
    for (size_t y = top; y <= bottom; y++)
    {
        double down = (double)y + 0.5 - a[1];
        for (size_t x = left; x <= right; x++)
        {
            double across = (double)x + 0.5 - a[0];
            double share_b = bx * across + by * down, share_c = cx * across + cy * down;
            if (share_b < -slack || share_c < -slack || share_b + share_c > 1 + slack)
                continue;
            float depth = (float)(a[2] + share_b * (b[2] - a[2]) + share_c * (c[2] - a[2]));
            size_t sample = y * raster->columns + x;
            if (raster->faces[sample] == RASTER_NO_FACE || depth > raster->depths[sample])
            {
                raster->faces[sample] = face;
                raster->depths[sample] = depth;
            }
        }
    }
}

bat_status mesh_raster_make(const bat_mesh *mesh, const mesh_placing *placing, size_t columns, size_t rows, int threads,
                            mesh_raster *raster, bat_error *error)
{
    *raster = (mesh_raster){.columns = columns, .rows = rows};
    raster->faces = memory_pool_array(&raster->pool, columns * rows, sizeof *raster->faces);
    raster->depths = memory_pool_array(&raster->pool, columns * rows, sizeof *raster->depths);
    raster->places = memory_pool_array(&raster->pool, mesh->vertex_count, 3 * sizeof *raster->places);
    if (raster->pool.missing > 0)
        return memory_pool_check(&raster->pool, error);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        mesh_place_point(placing, mesh->positions + 3 * v, raster->places + 3 * v);
    for (size_t i = 0; i < columns * rows; i++)
    {
        raster->faces[i] = RASTER_NO_FACE;
        raster->depths[i] = -HUGE_VALF;
    }
    int bands = threads_for(threads, rows / ROWS_PER_THREAD + 1);
#pragma omp parallel for num_threads(bands) schedule(static)
    for (int band = 0; band < bands; band++)
    {
        size_t from = rows * (size_t)band / (size_t)bands, to = rows * ((size_t)band + 1) / (size_t)bands;
        for (size_t f = 0; f < mesh->face_count; f++)
            draw_face(raster, mesh->faces + 3 * f, (uint32_t)f, from, to);
    }
    return BAT_OK;
}

void mesh_raster_line(const mesh_raster *raster, uint32_t from, uint32_t to, double width, unsigned char mark,
                      unsigned char *marks)
{
    const double *a = raster->places + 3 * (size_t)from, *b = raster->places + 3 * (size_t)to;
    double along[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, half = width / 2;
    double square = fmax(along[0] * along[0] + along[1] * along[1], 1e-12);
    size_t top, bottom, left, right;
    if (!sample_range(fmin(a[1], b[1]) - half, fmax(a[1], b[1]) + half, 0, raster->rows, &top, &bottom) ||
        !sample_range(fmin(a[0], b[0]) - half, fmax(a[0], b[0]) + half, 0, raster->columns, &left, &right))
        return;
    for (size_t y = top; y <= bottom; y++)
        for (size_t x = left; x <= right; x++)
        {
            double across = (double)x + 0.5 - a[0], down = (double)y + 0.5 - a[1];
            double share = fmin(fmax((across * along[0] + down * along[1]) / square, 0), 1);
            double depth = a[2] + share * along[2];
            size_t sample = y * raster->columns + x;
            if (hypot(across - share * along[0], down - share * along[1]) <= half &&
                (double)raster->depths[sample] <= depth + width)
                marks[sample] = mark;
        }
}

void mesh_raster_locate(const mesh_raster *raster, const uint32_t corners[3], double x, double y, double barycentric[3])
{
    const double *a = raster->places + 3 * (size_t)corners[0], *b = raster->places + 3 * (size_t)corners[1];
    const double *c = raster->places + 3 * (size_t)corners[2];
    double area = vector2_turn(a, b, c);
    double across = x - a[0], down = y - a[1];
    barycentric[1] = (across * (c[1] - a[1]) - down * (c[0] - a[0])) / area;
    barycentric[2] = (down * (b[0] - a[0]) - across * (b[1] - a[1])) / area;
    barycentric[0] = 1 - barycentric[1] - barycentric[2];
}
