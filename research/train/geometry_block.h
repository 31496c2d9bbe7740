#ifndef RESEARCH_TRAIN_GEOMETRY_BLOCK_H
#define RESEARCH_TRAIN_GEOMETRY_BLOCK_H

#include "research/train/geometry_polygon.h"

enum
{
    /// Vertices or edges treated at a time, so that their arrays stay in the first-level cache.
    GEOMETRY_BLOCK = 96,
};

/// Coordinates by axis, for vector code; two more than a block for a vertex's neighbours.
typedef struct geometry_rows
{
    double x[GEOMETRY_BLOCK + 2], y[GEOMETRY_BLOCK + 2], z[GEOMETRY_BLOCK + 2];
} geometry_rows;

/// Copy rows first, first + 1, … of a cyclic array of `count` rows.
static inline void geometry_load(const double *points, size_t count, size_t dim, size_t first, size_t rows,
                                 geometry_rows *loaded)
{
    for (size_t i = 0, row = first; i < rows; i++, row++)
    {
        row = row == count ? 0 : row;
        const double *point = points + row * dim;
        loaded->x[i] = point[0];
        loaded->y[i] = point[1];
        loaded->z[i] = dim == 3 ? point[2] : 0;
    }
}

/// Add to rows first, first + 1, … of a cyclic array of `count` rows.
static inline void geometry_add(const geometry_rows *added, size_t rows, double *points, size_t count, size_t dim,
                                size_t first)
{
    for (size_t i = 0, row = first; i < rows; i++, row++)
    {
        row = row == count ? 0 : row;
        double *point = points + row * dim;
        point[0] += added->x[i];
        point[1] += added->y[i];
        if (dim == 3)
            point[2] += added->z[i];
    }
}

/// Copy every `stride`-th row of an array.
static inline void geometry_load_strided(const double *points, size_t rows, size_t dim, size_t stride, geometry_rows *loaded)
{
    for (size_t i = 0; i < rows; i++, points += stride * dim)
    {
        loaded->x[i] = points[0];
        loaded->y[i] = points[1];
        loaded->z[i] = dim == 3 ? points[2] : 0;
    }
}

/// Write every `stride`-th row of an array.
static inline void geometry_store(const geometry_rows *stored, size_t rows, double *points, size_t dim, size_t stride)
{
    for (size_t i = 0; i < rows; i++, points += stride * dim)
    {
        points[0] = stored->x[i];
        points[1] = stored->y[i];
        if (dim == 3)
            points[2] = stored->z[i];
    }
}

#endif
