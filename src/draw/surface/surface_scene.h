#ifndef DRAW_SURFACE_SURFACE_SCENE_H
#define DRAW_SURFACE_SURFACE_SCENE_H

#include "batten/surface_picture.h"
#include "draw/common/style.h"
#include "draw/mesh/mesh_view.h"

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

#endif
