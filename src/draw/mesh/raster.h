#ifndef DRAW_MESH_RASTER_H
#define DRAW_MESH_RASTER_H

#include "draw/mesh/view.h"

/// @file
/// The visible face at each sample of a picture, by a z-buffer.

#define RASTER_NO_FACE UINT32_MAX

/// Samples have the spacing 1. Sample (0, 0) is at the top left with its centre at (.5, .5); y points downwards and z to the
/// eye.
typedef struct mesh_raster
{
    size_t columns, rows;
    uint32_t *faces; ///< for each sample, row by row: its face, or RASTER_NO_FACE
    float *depths;   ///< z of that face
    double *places;  ///< vertex_count x 3: the vertices in the coordinates of samples
} mesh_raster;

/// Find the visible faces; of faces at equal depth, the first. Release the raster with mesh_raster_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_raster_make(const bat_mesh *mesh, const mesh_placing *placing, size_t columns, size_t rows, int threads,
                            mesh_raster *raster, bat_error *error);
void mesh_raster_free(mesh_raster *raster);

/// Mark the samples of a line between two vertices where nothing is in front of it by more than its width.
/// @param marks columns x rows, row by row
void mesh_raster_line(const mesh_raster *raster, uint32_t from, uint32_t to, double width, unsigned char *marks);

/// The barycentric coordinates of a point of the image in the projection of a face. They are in 0 … 1 up to rounding for the
/// face's samples. For faces seen edge-on they only have the sum 1.
void mesh_raster_locate(const mesh_raster *raster, const uint32_t corners[3], double x, double y, double barycentric[3]);

#endif
