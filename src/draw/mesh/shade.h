#pragma once

#include "base/memory.h"
#include "batten/mesh.h"
#include "batten/mesh_picture.h"
#include "draw/common/legend.h"

/// @file
/// Orthographic views of meshes.

/// A view; the rows are the directions to the right, upwards and to the eye.
typedef struct mesh_view
{
    double rotation[3][3];
} mesh_view;

/// A rectangle in the plane of a view.
typedef struct mesh_frame
{
    double low[2], high[2];
} mesh_frame;

/// The map from a view's plane to an image: x = origin[0] + scale u, y = origin[1] - scale v, downwards.
typedef struct mesh_placing
{
    const mesh_view *view;
    double scale, origin[2];
} mesh_placing;

/// The margin around a frame, relative to the panel's width.
#define FRAME_PADDING 0.025

/// The view for the options; unspecified angles follow from the mesh.
mesh_view mesh_view_of(const bat_mesh *mesh, const bat_mesh_picture_options *options);
/// The bounding rectangle of points in a view.
/// @param indices of the points, [count]; null: all
mesh_frame mesh_frame_of(const double *points, const uint32_t *indices, size_t count, const mesh_view *view);
mesh_frame mesh_frame_join(const mesh_frame *a, const mesh_frame *b);

/// Place a frame in the centre of an image, as large as its margin allows.
mesh_placing mesh_frame_place(const mesh_frame *frame, const mesh_view *view, size_t columns, size_t rows);

/// Rotate a point into the directions to the right, upwards and to the eye.
static inline void mesh_view_turn(const mesh_view *view, const double *point, double turned[3])
{
    for (int i = 0; i < 3; i++)
        turned[i] = view->rotation[i][0] * point[0] + view->rotation[i][1] * point[1] + view->rotation[i][2] * point[2];
}

/// The position of a point in the image; the third coordinate increases towards the eye.
static inline void mesh_place_point(const mesh_placing *placing, const double *point, double place[3])
{
    double turned[3];
    mesh_view_turn(placing->view, point, turned);
    place[0] = placing->origin[0] + placing->scale * turned[0];
    place[1] = placing->origin[1] - placing->scale * turned[1];
    place[2] = placing->scale * turned[2];
}

// The visible face at each sample of a picture, by a z-buffer.

#define RASTER_NO_FACE UINT32_MAX

/// Samples have the spacing 1. Sample (0, 0) is at the top left, with its centre at (.5, .5); y downwards, z to the eye.
typedef struct mesh_raster
{
    memory_pool pool; ///< of all arrays
    size_t columns, rows;
    uint32_t *faces; ///< for each sample, row by row: its face, or RASTER_NO_FACE
    float *depths;   ///< z of that face
    double *places;  ///< vertex_count x 3: the vertices in the coordinates of samples
} mesh_raster;

/// Find the visible faces; of faces at equal depth, the first. Release the pool, also after a failure.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_raster_make(const bat_mesh *mesh, const mesh_placing *placing, size_t columns, size_t rows, int threads,
                            mesh_raster *raster, bat_error *error);

/// Mark the samples of a line between two vertices where nothing is in front of it by more than its width.
/// @param marks columns x rows, row by row; receives `mark`
void mesh_raster_line(const mesh_raster *raster, uint32_t from, uint32_t to, double width, unsigned char mark,
                      unsigned char *marks);

/// The barycentric coordinates of a point of the image in the projection of a face. They are in 0 … 1 up to rounding for the
/// face's samples. For faces seen edge-on they only have the sum 1.
void mesh_raster_locate(const mesh_raster *raster, const uint32_t corners[3], double x, double y, double barycentric[3]);

// Normals at the corners of faces and boundary edges, for shading of meshes that need not be manifold.

typedef struct mesh_surface
{
    memory_pool pool;     ///< of both arrays
    float (*normals)[3];  ///< 3 x face_count unit vectors at the corners; zero where a face has no area
    unsigned char *marks; ///< face_count bit sets: bit c marks a boundary edge at corner c, bit 3 + c one within a polygon
} mesh_surface;

/// Bits of mesh_surface::marks, for the edge at corner c.
static inline bool mesh_edge_at_boundary(const mesh_surface *surface, size_t face, size_t c)
{
    return (surface->marks[face] >> c & 1) != 0;
}

static inline bool mesh_edge_within_polygon(const mesh_surface *surface, size_t face, size_t c)
{
    return (surface->marks[face] >> (3 + c) & 1) != 0;
}

/// Compute normals and boundary edges. Release the pool, also after a failure.
/// @param polygons that the mesh is cut from, or null: flat faces have their polygon's mean normal
/// @param flat use the faces' normals; otherwise the area-weighted mean of those faces at the vertex whose normals differ by
/// less than 40 degrees
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_surface_make(const bat_mesh *mesh, const bat_mesh *polygons, bool flat, int threads, mesh_surface *surface,
                             bat_error *error);

// Shading of a mesh into pixels.

/// Samples of a pixel in each direction.
#define SHADE_SAMPLES 3

typedef struct shade_task
{
    const bat_mesh *mesh;     ///< triangles
    const bat_mesh *polygons; ///< that the mesh is cut from, or null
    const double *values;     ///< at the vertices, or null
    bool by_corner;           ///< the values are at the corners of the triangles
    const uint32_t *outlines; ///< vertices; each two are joined by a line
    size_t outline_count;     ///< of vertices
    double value_low, value_high;
    colour_scale *scale; ///< of the values; null: colour_scale_at()
    bool grey;           ///< without the values
    bool wires, flat, occlusion, boundaries;
    mesh_placing placing; ///< in pixels
    double line;          ///< the width of wires in pixels
    size_t columns, rows; ///< in pixels
    int threads;
} shade_task;

/// Draw into pixels of four bytes, cairo's ARGB32 (premultiplied, in native byte order), with rows `stride` bytes apart.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_shade(const shade_task *task, unsigned char *pixels, size_t stride, bat_error *error);
