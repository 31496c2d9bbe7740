#ifndef DRAW_MESH_RASTER_H
#define DRAW_MESH_RASTER_H

#include "draw/mesh/view.h"

/// @file
/// Which face is seen at each sample of a picture, by a z-buffer.

#define RASTER_NO_FACE UINT32_MAX

/// Samples are 1 apart, sample (0, 0) at the top left with its middle at (.5, .5); y runs downwards, z to the eye.
typedef struct mesh_raster
{
    size_t columns, rows;
    uint32_t *faces; ///< of each sample, row by row, or RASTER_NO_FACE
    float *depths;   ///< z of the face there
    double *places;  ///< vertex_count x 3: the vertices in samples
} mesh_raster;

/// Find the faces that are seen. Of faces equally near, the first is. Release the raster with mesh_raster_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_raster_make(const bat_mesh *mesh, const mesh_placing *placing, size_t columns, size_t rows, int threads,
                            mesh_raster *raster, bat_error *error);
void mesh_raster_free(mesh_raster *raster);

/// Draw a line from one vertex to another where nothing is in front of it by more than its width: set the samples' marks.
/// @param marks columns x rows, row by row
void mesh_raster_line(const mesh_raster *raster, uint32_t from, uint32_t to, double width, unsigned char *marks);

/// The barycentric coordinates of a point of the raster's plane in a face as it is seen. Points of a face's samples are
/// within it but for rounding; faces seen from their edge give whatever adds up to 1.
void mesh_raster_locate(const mesh_raster *raster, const uint32_t corners[3], double x, double y, double barycentric[3]);

#endif
