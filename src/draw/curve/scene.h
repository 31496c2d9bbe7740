#pragma once

#include "base/memory.h"
#include "batten/curve_picture.h"
#include "draw/common/legend.h"
#include "draw/curve/view.h"

/// @file
/// The content of a picture's panels, and the drawing of one.

// Strokes of geodesic polylines with any number of points.

/// The allowed error of lines on the page.
#define STROKE_TOLERANCE 0.05

typedef struct drawn_line
{
    const draw_view *view;
    const double *points;
    size_t count;
    bool closed;
    view_side side;
} drawn_line;

/// Stroke a polyline. If too many points remain after simplification, its coverage mask is drawn.
bat_status stroke_line(cairo_t *cairo, const drawn_line *drawn, line_style line, bat_error *error);

/// A coverage mask marks the cells of a fine grid that a very rough line visits. Strokes of the marked cells look like a
/// stroke of the line, whatever its number of points.

/// The side of a cell. A point of the line is at most 0.2 points from the centre of a marked cell: half a diagonal plus half
/// a step along the line, (sqrt(1/2) + 1/8) 0.23.
#define COVERAGE_CELL 0.23

typedef struct coverage_map
{
    double low_x, low_y;
    size_t columns, rows;
    size_t stride; ///< words in a row
    uint64_t *words;
    double x, y; ///< the current point of the line
} coverage_map;

/// Make an empty mask for the rectangle from (low_x, low_y) to (high_x, high_y); release it with coverage_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status coverage_begin(double low_x, double low_y, double high_x, double high_y, coverage_map *map, bat_error *error);
/// A sink that marks the cells of a path within the rectangle.
path_sink coverage_sink(coverage_map *map);
/// Append the marked cells to cairo's current path, each run in a row as one line, for strokes with round caps.
void coverage_free(coverage_map *map);

// Curvature combs: at each vertex a segment, proportional to the curvature, away from the centre of curvature.

/// The most vertices of a comb.
#define COMB_MAX_POINTS 8192

/// The segments of a comb. The curvature at a vertex is its exterior angle divided by the mean length of its two edges; the
/// curvature vector is the tangent vector of this length. It is 0 at the ends of an open curve.
typedef struct comb
{
    memory_pool pool; ///< of all arrays
    view_space space;
    size_t point_dim;
    size_t count;
    bool closed;
    double *points;  ///< count x point_dim: the vertices
    double *vectors; ///< count x point_dim: negative curvature vectors; in the disk, transported from the origin by a Möbius
                     ///< translation
} comb;

/// Compute the comb of a checked curve; release its pool, also after a failure. Curves with fewer than 3 points have no
/// segments.
bat_status comb_make(const bat_curve *curve, comb *segments, bat_error *error);

/// The scale at which the 95th percentile of segments is `usual` long and none above `longest`. INFINITY: no curvature.
bat_status comb_natural_scale(const comb *segments, double usual, double longest, double *scale, bat_error *error);

/// The end of a segment: the point reached from vertex `index` along `scale` times its vector.
void comb_tip(const comb *segments, size_t index, double scale, double *tip);

/// Draw the segments of a comb and the line through their ends. Ends of an open curve have neither.
bat_status comb_lines_draw(cairo_t *cairo, const draw_view *view, const comb *segments, double scale, draw_colour colour,
                           bat_error *error);

// What a picture shows of the sphere.

/// The projection of panels on the sphere and the part of it that is seen.
typedef struct map_choice
{
    bat_curve_projection projection; ///< never BAT_CURVE_PROJECTION_AUTO
    double longitude, latitude;      ///< globe, local and both: the centre
    double meridian;                 ///< map and both: the middle
    double low[2], high[2];          ///< local: the range of u and v
} map_choice;

/// Choose for checked curves on the sphere. `polygons` says whether any of them is a ring.
map_choice map_choose(const bat_curve *const *curves, size_t count, bool polygons, const bat_curve_picture_options *options);

// Which edges of a map are drawn, and the colours of its features.

/// All zero for a panel without polygons.
typedef struct map_network
{
    memory_pool pool;     ///< of all arrays
    size_t *starts;       ///< layer_count + 1: the number of a layer's first edge, counted over the panel
    unsigned char *drawn; ///< for each edge: 1 unless an earlier layer of the same role and kind has the same edge
    int *colours;         ///< for each layer: the fill, 0 to MAP_COLOURS - 1
} map_network;

/// The number of fills.
#define MAP_COLOURS 6

/// Find equal edges of the layers and colour the features differently from neighbours.
/// @return BAT_OK or BAT_NO_MEMORY; without polygons `network` is all zero. Release its pool in any case.
bat_status map_network_make(const bat_curve_picture_panel *panel, map_network *network, bat_error *error);

// Proxies of spaces that have no drawing of their own: rotations, rigid motions and the hyperboloid.
//
// A curve of rotations becomes three curves on the sphere, the columns of the matrices; at control points a triangle joins
// the columns. A rigid motion becomes the path of the body's origin in R^3, with the body's axes along it. The hyperboloid
// of dimension 2 becomes the disk.

/// A panel in the proxy's space. `lines[i]` is the style of layer i; with width 0 it follows from the layer's role.
typedef struct proxy
{
    memory_pool pool; ///< of all arrays, those of the points too
    bat_space space;
    bat_curve *curves;
    bat_curve_picture_layer *layers;
    line_style *lines;
    size_t count;
    bat_curve_picture_panel panel;
} proxy;

/// Make the proxy of a checked panel; release it with proxy_free().
/// @return BAT_OK; BAT_CUT_LOCUS with the index of a point half a turn from the next; BAT_NO_MEMORY
bat_status proxy_make(const bat_curve_picture_panel *panel, const bat_curve_picture_options *options, proxy *made,
                      bat_error *error);
/// Release everything; does nothing to a proxy that is all zero.
void proxy_free(proxy *made);

/// The visible part of a panel's space. The panels of a row share it unless the options differ.
typedef struct scene_frame
{
    double low[2], high[2];         ///< flat spaces: the range of u and v
    double box_low[3], box_high[3]; ///< R^3: the range of the coordinates
    map_choice map;                 ///< sphere: the projection and its centre
    double comb_scale;              ///< 0 without combs
    double tensor_unit;             ///< tensors: the largest semi-axis
    size_t tensor_columns;          ///< tensors: the maximal number in a row
} scene_frame;

typedef struct scene_panel
{
    const bat_curve_picture_panel *source;
    const bat_curve_picture_panel *drawn; ///< the source, or its proxy's panel
    proxy proxied;                        ///< all zero where the source itself is drawn
    view_space space;                     ///< the space that is drawn
    size_t point_dim;
    comb *combs;         ///< one for each drawn layer, empty except for curves; null without combs
    bool polygons;       ///< whether a layer is a ring of a polygon
    bool given_only;     ///< whether no layer is a result; on a map the given curves stand for results then
    size_t given_points; ///< of all BAT_CURVE_LAYER_ROLE_CONTROL
    map_network network; ///< all zero without polygons
    scene_frame frame;
} scene_panel;

typedef struct scene
{
    const bat_curve_picture_options *options;
    scene_panel *panels;
    size_t count;
    size_t columns;
    size_t rows;
} scene;

/// Check and measure all panels. Release the scene with scene_free().
bat_status scene_make(const bat_curve_picture_panel *panels, size_t count, const bat_curve_picture_options *options,
                      scene *made, bat_error *error);
/// The same without the networks of maps, enough to know what is shown.
bat_status scene_measure(const bat_curve_picture_panel *panels, size_t count, const bat_curve_picture_options *options,
                         scene *made, bat_error *error);
void scene_free(scene *made);

/// The number of panels in a row for `count` panels. Unless the options prescribe it, there are at most five, and each has
/// at least `min_width` of a prescribed width.
size_t scene_columns(const bat_curve_picture_options *options, size_t count, double min_width);

bool scene_layer_shown(const bat_curve_picture_layer *layer, const bat_curve_picture_options *options);
bool scene_is_map(const scene_panel *panel);
/// Whether the given points of a panel are drawn: not where a map has many.
bool scene_points_shown(const scene_panel *panel, const bat_curve_picture_options *options);
int scene_colour(const bat_curve_picture_panel *panel, size_t index);

/// The aspect ratio of a flat panel, height over width.
static inline double scene_aspect(const scene_frame *frame)
{
    return (frame->high[1] - frame->low[1]) / (frame->high[0] - frame->low[0]);
}

/// A corner of the box in R^3; the bits of `corner` choose the high coordinates.
static inline void scene_corner(const scene_frame *frame, unsigned corner, double *point)
{
    for (unsigned k = 0; k < 3; k++)
        point[k] = (corner >> k & 1u) != 0 ? frame->box_high[k] : frame->box_low[k];
}

/// Curves of symmetric positive-definite matrices A are drawn as rows of ellipses or ellipsoids {x: x^T A^-1 x = 1}, whose
/// semi-axes are the square roots of the eigenvalues. Each layer is a row; positions in it are parameters of the curve.

/// Extend a frame by the rows of a panel.
/// @return BAT_OK, or BAT_NO_CONVERGENCE where eigenvalues cannot be computed
bat_status tensor_row_include(scene_frame *frame, const bat_curve_picture_panel *panel, bat_error *error);
/// Draw the rows of a panel. (u, v) are in units of the largest semi-axis.
bat_status tensor_row_draw(cairo_t *cairo, const draw_view *view, const scene_panel *panel, bat_error *error);

// Polygons and lines of maps.

line_style map_line(const scene_panel *panel, size_t index);
/// Fill the polygons of the results, or the given ones where there are no results.
void map_draw_fills(cairo_t *cairo, draw_view *view, const scene_panel *panel);
/// Draw the lines of a role, each distinct edge once. The panel has polygons.
bat_status map_draw_lines(cairo_t *cairo, const draw_view *view, const scene_panel *panel, bat_curve_layer_role role,
                          bat_error *error);

// One panel of a picture.

/// The preferred height of a panel for a width; a flat drawing is at most `tallest` times as high as wide.
double panel_height(const scene_panel *panel, const bat_curve_picture_options *options, double tallest, double width);
/// Draw a panel into the box (x, y, width, height), centred and with equal scales of both axes.
bat_status panel_draw(cairo_t *cairo, const scene_panel *panel, const bat_curve_picture_options *options,
                      const double box[4], bat_error *error);
/// The legend item of a layer; the label may be null.
legend_item panel_legend_item(const scene_panel *panel, size_t index, const bat_curve_picture_options *options);

// Backgrounds and frames of panels: graticules, tilings and axes.

/// Margins of a drawing.
typedef struct insets
{
    double left, top, right, bottom;
} insets;

/// Draw the sphere of a globe with soft shading; `sea` is a background for polygons.
void grid_globe_sphere(cairo_t *cairo, const draw_view *view, bool sea);
/// Draw the meridians and parallels of the front, every 15 or 30 degrees, with a stronger equator and zero meridian.
void grid_globe_lines(cairo_t *cairo, const draw_view *view);
/// Draw the outline of a globe, optionally with latitudes beside it and the coordinates of its centre below.
void grid_globe_limb(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool labels);
/// The margin for labels on each side of a globe.
#define GRID_GLOBE_MARGIN 22.0

/// Fill the frame of a world map; `sea` is a background for polygons.
void grid_map_ground(cairo_t *cairo, const draw_view *view, bool sea);
/// Draw the graticule of a world map, every 30 degrees.
void grid_map_lines(cairo_t *cairo, const draw_view *view);
/// Draw the frame of a world map and, with `labels`, the latitudes and longitudes beside it.
void grid_map_frame(cairo_t *cairo, const draw_view *view, bool labels);
/// Clip the following drawing to the frame of the map.
void grid_map_clip(cairo_t *cairo, const draw_view *view);
#define GRID_MAP_LEFT 20.0
#define GRID_MAP_BOTTOM 14.0
#define GRID_MAP_RIGHT 6.0

/// Fill the window of a local map; `sea` is a background for polygons.
void grid_local_ground(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool sea);
void grid_local_lines(cairo_t *cairo, const draw_view *view, const scene_frame *frame);
/// Draw the frame of a local map, its scale bar and, with `labels`, the latitudes and longitudes beside it.
void grid_local_frame(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool labels);
void grid_local_clip(cairo_t *cairo, const draw_view *view, const scene_frame *frame);
/// The margins for labels and the scale bar to the left, above, to the right and below.
insets grid_local_room(const scene_frame *frame, bool labels);

/// The largest step of a graticule, in seconds of arc, that a range of so many seconds holds three times: 30, 20, 10, 5, 2
/// or 1 degrees, minutes or seconds, or a decimal fraction of a second.
double grid_step(double range);
/// Write "64°30′N": degrees, with minutes and seconds as far as the step needs them.
void grid_angle_label(double seconds, double step, const char *positive, const char *negative, char *label, size_t size);
/// The length of a scale bar, 1, 2 or 5 times a power of ten, up to a quarter of `width`.
double grid_scale_length(double width);
/// Draw a scale bar with its left end at (x, y), of a drawing `width` points and `extent` units wide. "m" has km and cm,
/// too.
void grid_scale_bar(cairo_t *cairo, double x, double y, double width, double extent, const char *unit);
/// The height that a scale bar takes.
#define GRID_SCALE_HEIGHT 15.0

/// Draw the background of the disk and, with `lines`, the tiling by right-angled pentagons, four at each vertex.
void grid_disk(cairo_t *cairo, const draw_view *view, bool lines);
void grid_disk_circle(cairo_t *cairo, const draw_view *view);

/// Draw light lines at round numbers, with labels to the left and below, within the box (x, y, width, height).
void grid_plane(cairo_t *cairo, const draw_view *view, const scene_frame *frame, const double box[4]);
/// The margins for labels to the left, above, to the right and below.
insets grid_plane_room(const scene_frame *frame);

/// Draw the bounding box of curves in R^3, with its axes labelled at the lowest corner.
void grid_solid(cairo_t *cairo, const draw_view *view, const scene_frame *frame);
/// The margin for the labels of the axes.
#define GRID_SOLID_MARGIN 10.0
