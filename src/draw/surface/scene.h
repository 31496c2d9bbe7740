#pragma once

#include "batten/spline.h"
#include "batten/surface_picture.h"
#include "draw/mesh/shade.h"
#include "surface/shell/shell.h"

/// @file
/// The content of pictures of fitted surfaces, their panels, and the drawing of patches and dots.

#define SURFACE_CAPTION_SIZE 128

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
    const bat_shell *shell;        ///< instead of a surface, or null
    shell_place *places;           ///< of the points on the shell
    const double *distances;       ///< of the points; may be null
    uint32_t *outlines;            ///< vertices; each two are joined along the side of a shell's face
    size_t outline_count, samples; ///< vertices; of a shell's patch and direction
    memory_pool pool;              ///< of what a shell has
    bat_mesh patch;                ///< the triangulated surface or shell; no faces without one
    mesh_view view;
    mesh_frame frame;
    bool turned;    ///< the front is where -S_u x S_v points
    double *values; ///< at the vertices of the patch or corners of a shell's triangles, for views that are not shaded
    double *signed_distances; ///< of the points, positive in front; null without bands
    char captions[SURFACE_PANEL_KINDS][SURFACE_CAPTION_SIZE];
} surface_row;

static const draw_colour COLOUR_BOUNDARY_POINT = {0.835, 0.369, 0.0};
/// The size of boundary points relative to other points.
#define BOUNDARY_POINT_GROWTH 1.35

/// The colours of all rows.
typedef struct surface_colours
{
    bat_surface_inspection inspection;
    double highest, most_curved; ///< the ends of the colour scales of errors and of curvature
} surface_colours;

/// Draw a panel of a row into (x, y, width, height), with `per_point` pixels in a point.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status surface_view_draw(const surface_row *row, surface_panel_kind kind, const surface_colours *colours, cairo_t *cairo,
                             const double box[4], double per_point, bat_error *error);
bat_status surface_plane_draw(const surface_row *row, cairo_t *cairo, const double box[4], double per_point,
                              bat_error *error);

/// Triangulate a surface for shading. The vertices are a grid of parameters, whose lines pass along the borders of the
/// surface's cells, up to a number of lines. Boundary vertices come first, counter-clockwise from (0, 0).
/// @param mesh       receives the triangles; release it with bat_mesh_free()
/// @param parameters receives those of the vertices, from malloc()
/// @param loop_count receives the number of boundary vertices
/// @return BAT_OK, a failure of bat_spline_surface_evaluate(), or BAT_NO_MEMORY
bat_status surface_patch_make(const bat_spline_surface *surface, bat_mesh *mesh, double **parameters, size_t *loop_count,
                              bat_error *error);

/// Triangulate the shell of a row, find its outlines, and the places and distances of the points.
bat_status surface_shell_make(surface_row *row, bat_error *error);

/// The place on the shell of barycentric coordinates in a triangle.
shell_place surface_shell_place(const surface_row *row, size_t triangle, const double share[3]);

/// Remove the triangles with a vertex outside of a box.
void surface_patch_cut(bat_mesh *mesh, const double low[3], const double high[3]);

/// Orient the triangles so that their front faces `eye`; of a patch that is nearly closed, the outer side is the front.
/// @return whether they were turned over
bool surface_patch_turn(bat_mesh *mesh, const double eye[3]);

typedef struct patch_points
{
    const double *points; ///< count x 3
    size_t count;
    size_t loop_count; ///< the first points, in order around the boundary; 0 for an unknown boundary
} patch_points;

/// Choose the view of a patch. `direction` and `up` may be zero.
///
/// The default direction is slightly above and beside the mean normal, on the side where the patch bulges out of its
/// boundary. A patch that is nearly closed, or whose boundary is unknown, is seen across its broad side. A deep patch, like
/// a head above its neck, is seen from the side to which it leans. The default of `up` is z, or y where the patch faces z.
mesh_view surface_view_of(const patch_points *patch, const double direction[3], const double up[3]);

/// An image of four-byte pixels, cairo's ARGB32.
typedef struct dot_image
{
    unsigned char *pixels;
    size_t stride, columns, rows;
} dot_image;

/// A dot; dots with a greater `rank` are drawn later.
typedef struct image_dot
{
    double x, y, rank;
    size_t index; ///< of the point; of dots with equal ranks the lower index is drawn first
} image_dot;

/// The radius in pixels of `count` dots on an area in square pixels, with `per_point` pixels in a point.
double dot_radius(double area, size_t count, double per_point);
void dots_sort(image_dot *dots, size_t count);
/// Draw a disk with a soft edge.
void dot_draw(const dot_image *image, double x, double y, double radius, draw_colour colour);

/// The bands of signed distances, from the most positive one, 0, to 2 x band_count.
size_t surface_band_of(const bat_surface_inspection *inspection, double distance);
draw_colour surface_band_colour(const bat_surface_inspection *inspection, size_t band);
/// @param share of the points in the band
void surface_band_label(const bat_surface_inspection *inspection, size_t band, double share, char *label, size_t size);
/// Find the signed distances of a row, and its caption.
bat_status surface_row_sign(surface_row *row, bat_error *error);
/// Find stripes or curvatures at the vertices of the patch, which have these parameters, and its caption.
/// @param end raised to that of the scale of curvatures
bat_status surface_row_inspect(surface_row *row, bool zebra, const double *parameters, double *end, bat_error *error);
