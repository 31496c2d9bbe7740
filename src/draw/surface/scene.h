#ifndef DRAW_SURFACE_SCENE_H
#define DRAW_SURFACE_SCENE_H

#include "batten/base.h"
#include "batten/mesh.h"
#include "batten/spline_hierarchical.h"
#include "batten/surface_picture.h"
#include "draw/common/style.h"
#include "draw/mesh/view.h"

/// @file
/// What the panels of fitted surfaces share, and the panels.

enum
{
    SURFACE_CAPTION_SIZE = 128
};

/// The panels of a row, from left to right.
typedef enum surface_panel_kind
{
    SURFACE_PANEL_CLOUD,
    SURFACE_PANEL_PATCH,
    SURFACE_PANEL_ERRORS,
    SURFACE_PANEL_PLANE,
    SURFACE_PANEL_KINDS
} surface_panel_kind;

typedef struct surface_row
{
    const bat_surface_picture_row *panel;
    bat_mesh patch; ///< the surface as triangles; no faces where there is none
    mesh_view view;
    mesh_frame frame;
    char captions[SURFACE_PANEL_KINDS][SURFACE_CAPTION_SIZE];
} surface_row;

static const draw_colour COLOUR_BOUNDARY_POINT = {0.835, 0.369, 0.0};
/// Boundary points are so many times as large as others.
#define BOUNDARY_POINT_GROWTH 1.35

/// Draw a row's panel into (x, y, width, height), pixels as dense as `per_point` says.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status surface_cloud_draw(const surface_row *row, cairo_t *cairo, const double box[4], double per_point,
                              bat_error *error);
bat_status surface_patch_draw(const surface_row *row, cairo_t *cairo, const double box[4], double per_point,
                              bat_error *error);
/// @param highest the end of the colour scale
bat_status surface_errors_draw(const surface_row *row, double highest, cairo_t *cairo, const double box[4], double per_point,
                               bat_error *error);
bat_status surface_plane_draw(const surface_row *row, cairo_t *cairo, const double box[4], double per_point,
                              bat_error *error);

/// The height that suits the parameter plane at a width.
double surface_plane_height(double width);

/// @file
/// A spline surface as triangles to be shaded.

/// The vertices are an even grid of parameters, fine enough for the surface's finest cells but no finer than pictures show,
/// the boundary's first, counter-clockwise from (0, 0).
/// @param mesh       receives the triangles; release it with bat_mesh_free()
/// @param loop_count receives the number of vertices on the boundary
/// @return BAT_OK, what bat_spline_surface_evaluate() returns, or BAT_NO_MEMORY
bat_status surface_patch_make(const bat_spline_surface *surface, bat_mesh *mesh, size_t *loop_count, bat_error *error);

/// Leave out the triangles with a vertex outside of a box.
void surface_patch_cut(bat_mesh *mesh, const double low[3], const double high[3]);

/// Make the side that is seen from a direction the front of the triangles; of a patch that nearly closes the outer side.
void surface_patch_turn(bat_mesh *mesh, const double eye[3]);

/// @file
/// From where patches of surface are seen.

/// Points of a patch.
typedef struct patch_points
{
    const double *points; ///< count x 3
    size_t count;
    size_t loop_count; ///< the first points, in order around the boundary; 0 when it is not known
} patch_points;

/// A view from a direction, with a direction upwards. Zeros leave it open: the eye is then a little above and beside the
/// mean normal, on the side to which the patch bulges out of its boundary; across the broad side of a patch that nearly
/// closes or whose boundary is not known; and on the side to which it leans where it is as deep as a head above its neck.
/// Upwards is z, or y where the patch faces z.
mesh_view surface_view_of(const patch_points *patch, const double direction[3], const double up[3]);

/// The smallest frame of what is seen of points.
mesh_frame surface_frame_of(const double *points, size_t count, const mesh_view *view);

/// @file
/// Many dots in an image.

/// Pixels of four bytes, cairo's ARGB32, that dots are drawn into.
typedef struct dot_image
{
    unsigned char *pixels;
    size_t stride, columns, rows;
} dot_image;

/// A dot; those of greater `rank` are drawn later.
typedef struct image_dot
{
    double x, y, rank;
    size_t index; ///< of the point; among equal ranks the lower is drawn first
} image_dot;

/// The radius in pixels that suits `count` dots over an area of so many square pixels, `per_point` of them to a point.
double dot_radius(double area, size_t count, double per_point);
void dots_sort(image_dot *dots, size_t count);
/// Draw a disk with a soft edge.
void dot_draw(const dot_image *image, double x, double y, double radius, draw_colour colour);

#endif
