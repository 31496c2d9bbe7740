#ifndef DRAW_MESH_VIEW_H
#define DRAW_MESH_VIEW_H

#include "batten/mesh_picture.h"

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

/// The same placement in an image with `times` as many pixels in each direction.
static inline mesh_placing mesh_placing_zoom(const mesh_placing *placing, double times)
{
    return (mesh_placing){placing->view, times * placing->scale, {times * placing->origin[0], times * placing->origin[1]}};
}

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

#endif
