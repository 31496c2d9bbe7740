#ifndef DRAW_MESH_VIEW_H
#define DRAW_MESH_VIEW_H

#include "batten/mesh_picture.h"

/// @file
/// From where meshes are seen.

/// A view from far away: rows point to the right, upwards and to the eye.
typedef struct mesh_view
{
    double rotation[3][3];
} mesh_view;

/// A rectangle in the plane of a view.
typedef struct mesh_frame
{
    double low[2], high[2];
} mesh_frame;

/// The view that options ask for; what they leave open suits the mesh.
mesh_view mesh_view_of(const bat_mesh *mesh, const bat_mesh_picture_options *options);
/// The smallest frame of what is seen of a mesh.
mesh_frame mesh_frame_of(const bat_mesh *mesh, const mesh_view *view);
mesh_frame mesh_frame_join(const mesh_frame *a, const mesh_frame *b);

/// A point in coordinates that point to the right, upwards and to the eye.
static inline void mesh_view_turn(const mesh_view *view, const double *point, double turned[3])
{
    for (int i = 0; i < 3; i++)
        turned[i] = view->rotation[i][0] * point[0] + view->rotation[i][1] * point[1] + view->rotation[i][2] * point[2];
}

#endif
