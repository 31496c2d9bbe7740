#ifndef BATTEN_CURVE_PICTURE_H
#define BATTEN_CURVE_PICTURE_H

#include "batten/motion.h"

BAT_C_BEGIN

/// @file
/// Pictures of curves and of motions as SVG, PNG or PDF.
///
/// A picture is a grid of panels; a panel shows curves in one space. Euclidean spaces are drawn flat and at true aspect: R^3
/// in an axonometric view, R^n by its first two coordinates. The sphere S^2 is a globe, a world map or a map of a region,
/// the hyperbolic plane the Poincaré disk. Edges are geodesics: great-circle arcs, or circular arcs orthogonal to the unit
/// circle.
///
/// Layers that are rings of polygons make a map of their panel: polygons are filled in light colours, different for
/// neighbours, and an edge that several rings have is drawn once. The given lines are thin and grey beneath the results, and
/// given points are shown where there are at most 400. A local projection is drawn in the same style.
///
/// Rotations are drawn as the three columns of their matrices on the sphere. Rigid motions are a path in R^3 with the axes
/// of the body. Symmetric positive-definite 2 x 2 and 3 x 3 matrices are a row of ellipses or ellipsoids for each curve.
/// Hyperboloids of dimension 2 are drawn as the disk.

/// The map projection of the sphere.
typedef enum bat_curve_projection
{
    BAT_CURVE_PROJECTION_AUTO, ///< local for curves within a cap of 30 degrees around its centre, for polygons of 80; beyond
                               ///< it the map for polygons, and the globe for other curves. The default.
    BAT_CURVE_PROJECTION_GLOBE, ///< orthographic; the far side is faint, but hidden behind polygons
    BAT_CURVE_PROJECTION_MAP, ///< Equal Earth, which keeps areas; cut at the meridian opposite to the middle one. Šavrič,
                              ///< Patterson and Jenny, "The Equal Earth map projection", IJGIS 33 (2019)
    BAT_CURVE_PROJECTION_LOCAL, ///< Lambert's azimuthal equal-area projection about the centre of the curves, with a scale
                                ///< bar that is true there. Snyder, "Map projections" (1987), pages 182-190
    BAT_CURVE_PROJECTION_BOTH   ///< the globe, and the map to its right
} bat_curve_projection;

/// The projections by name.
extern BAT_API const bat_family bat_curve_projection_family;

/// The role of a curve in its panel, which decides its style.
typedef enum bat_curve_layer_role
{
    BAT_CURVE_LAYER_ROLE_CURVE,   ///< a result: a solid line in a strong colour
    BAT_CURVE_LAYER_ROLE_CONTROL, ///< the given points: a thin dashed line through small open circles
    BAT_CURVE_LAYER_ROLE_TRUTH    ///< the expected result: a dashed grey line
} bat_curve_layer_role;

/// The number of distinct colours; further curves repeat them with long dashes, then with short ones.
#define BAT_CURVE_PICTURE_COLOURS 7

/// One curve of a panel. All zero but `curve` is a sensible layer.
typedef struct bat_curve_picture_layer
{
    const bat_curve *curve; ///< at least one point, every one finite and in its space; never null
    bat_curve_layer_role role;
    const char *label; ///< UTF-8, for the legend; null or "" for none
    int colour;        ///< 1, 2, …: that colour of the fixed order; 0: the place among the panel's curves
    size_t
        polygon; ///< R^2 and the sphere, 1, 2, …: the polygon that this ring bounds, filled even-odd with the layers beside
                 ///< it of the same number and role; 0: none. On the sphere a ring encloses the side of smaller area
    size_t feature; ///< polygons of one feature have the same fill
} bat_curve_picture_layer;

/// One panel of a picture.
typedef struct bat_curve_picture_panel
{
    const bat_curve_picture_layer
        *layers; ///< at least one, all in the same space; drawn from the first to the last within a role
    size_t layer_count;
    const char *title; ///< UTF-8, drawn beneath the panel; null or "" for none
} bat_curve_picture_panel;

/// Options of pictures. Begin with bat_curve_picture_defaults().
typedef struct bat_curve_picture_options
{
    double width;                    ///< in points, up to 10000; 0: from the number of columns and the content; default 0
    double height;                   ///< in points, up to 10000; 0: from the content; default 0
    double pixels_per_point;         ///< PNG only, 0.1 to 20; default 2
    size_t columns;                  ///< panels in a row; 0: up to five as `width` allows, evenly filled; default 0
    bool own_frames;                 ///< every panel has its own scale and view, else a row shares them; default false
    bat_curve_projection projection; ///< default BAT_CURVE_PROJECTION_AUTO
    double longitude;                ///< of the middle of the globe or map, radians; NaN: automatic; default NaN
    double latitude;                 ///< the same, -pi/2 to pi/2; automatic when either is NaN; default NaN
    bool control_polygon;            ///< draw the edges of BAT_CURVE_LAYER_ROLE_CONTROL; default true
    bool control_points; ///< draw the points of BAT_CURVE_LAYER_ROLE_CONTROL, if there are at most 5000; default true
    bool comb;           ///< R^n, sphere, disk: draw the curvature combs of BAT_CURVE_LAYER_ROLE_CURVE; default false
    double comb_scale;   ///< length of a comb's line per curvature, in the space's unit squared; 0: automatic; default 0
    bool grid;           ///< curved spaces: graticule, or the tiling by right-angled pentagons; default true
    bool axes;           ///< flat panels: a light grid with numbers (R^2), a box (R^3); default false
    const char *unit;    ///< the unit of R^2, UTF-8, for the scale bar of panels with polygons and without axes; "m" counts
                         ///< kilometres, too; null: none; default null
    bool legend;         ///< explain the labels below the panels; default true
    const char *title;   ///< UTF-8, above the panels; null or "" for none; default null
} bat_curve_picture_options;

/// Whether a picture can be written to a path: its ending must be .svg, .png or .pdf, in either case.
/// @return BAT_OK or BAT_INVALID_ARGUMENT
BAT_API bat_status bat_picture_check(const char *path, bat_error *error);

/// The options' default values.
BAT_API bat_curve_picture_options bat_curve_picture_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_curve_picture_fields;

/// Draw panels into a file, whose ending chooses the format: .svg, .png or .pdf, in small or capital letters.
///
/// The panels fill the rows from left to right. The file appears whole or not at all; an existing one survives a failure.
/// The same input gives the same bytes. Curves of millions of points are simplified to within 0.05 points of the true line.
/// One that would keep more than 30000 points is drawn as a coverage mask, to within 0.2 points. A comb uses at most 8192
/// vertices of a curve, evenly chosen. The curvature at a vertex is its exterior angle over the mean of its two edges'
/// lengths.
///
/// @param options null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT for another ending, an option out of range, no room for the titles, a text that is
///         not UTF-8 or has control characters, two spaces in one panel, or an empty panel or curve (with the index of the
///         panel or layer); BAT_INVALID_POINT or BAT_CUT_LOCUS with the index of the point; BAT_UNSUPPORTED for a space
///         without a picture; BAT_TOO_LARGE for more than 10000 points of height or 32767 pixels; BAT_NO_MEMORY;
///         BAT_FILE_ACCESS
BAT_API bat_status bat_curve_picture_write(const char *path, const bat_curve_picture_panel *panels, size_t count,
                                           const bat_curve_picture_options *options, bat_error *error);

/// The projection that BAT_CURVE_PROJECTION_AUTO stands for in the first panel on the sphere, or the one that the options
/// name.
/// @param options null for the defaults
/// @param taken   receives it; BAT_CURVE_PROJECTION_AUTO when no panel is on the sphere
/// @return BAT_OK, or as bat_curve_picture_write()
BAT_API bat_status bat_curve_picture_projection(const bat_curve_picture_panel *panels, size_t count,
                                                const bat_curve_picture_options *options, bat_curve_projection *taken,
                                                bat_error *error);

// Motions in time: the path with frames of the body or a strip of poses, and below it the speeds over time.

/// Options of pictures of motions. Begin with bat_motion_picture_defaults().
typedef struct bat_motion_picture_options
{
    double width;            ///< in points, 100 to 10000; 0: 520; default 0
    double height;           ///< in points, up to 10000; 0: from the content; default 0
    double pixels_per_point; ///< PNG only, 0.1 to 20; default 2
    size_t poses;            ///< frames along a path, poses of a strip, up to 1000; 0: by the motion; default 0
    const char *length_unit; ///< UTF-8; null: m for TUM, EuRoC and KITTI files, else none; default null
    const char *time_unit;   ///< the same; null: s for TUM and EuRoC files, and dates, else none; default null
    bool legend;             ///< explain lines and marks; default true
    const char *title;       ///< UTF-8, above the picture; null or "" for none; default null
} bat_motion_picture_options;

/// The largest number of motions in a picture.
#define BAT_MOTION_PICTURE_MOTIONS 7

/// The options' default values.
BAT_API bat_motion_picture_options bat_motion_picture_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_motion_picture_fields;

/// Draw the splines of the keyframes in a set over their whole duration into a file, whose ending chooses the format: .svg,
/// .png or .pdf.
///
/// R^2, R^3 and rigid motions are a path with axes at true aspect. R^3 is seen from above at 28 degrees of elevation, or 55
/// for a level path, turned so that the path is broad; z is upwards, or the axis across which the path is flat (minus y for
/// y, as cameras have it). Rigid motions have frames at equal times, fewer where they would cover each other: the body's
/// axes x, y and z in red, green and blue. Rotations are a strip of poses at equal times: a block that is long in the body's
/// x, broad in y and thin in z. Curves on the sphere S^2, in the hyperbolic plane and of 2 x 2 and 3 x 3 tensors are drawn
/// as in bat_curve_picture_write(). Of other spaces the coordinates are drawn over time, at most seven.
///
/// Below are the speed, that is the length of the velocity, and of rigid motions and rotations the angular speed in degrees.
/// Keyframes are circles, those that a rule for outliers lets count less are marked (beyond 3 sigma for Huber's).
///
/// @param keyframes 1 to BAT_MOTION_PICTURE_MOTIONS curves, which bat_motion_method_for() gives BAT_MOTION_METHOD_SPLINE
/// @param motion    as for bat_motion_curves(); null for the defaults
/// @param options   null for the defaults
/// @return as bat_motion_curve_spline(); BAT_INVALID_ARGUMENT; BAT_UNSUPPORTED for too many curves; BAT_INVALID_POINT for
///         coordinates or speeds beyond 1e150; BAT_TOO_LARGE; BAT_NO_MEMORY; BAT_FILE_ACCESS
BAT_API bat_status bat_motion_picture_write(const char *path, const bat_curve_set *keyframes,
                                            const bat_motion_curves_options *motion,
                                            const bat_motion_picture_options *options, bat_error *error);

/// Draw splines that exist, as bat_motion_picture_write() draws those that it makes.
///
/// @param keyframes a curve for each spline: the points that it was made of, and whether it is closed. `space` is that of
///                  the splines; `attributes` may be null
/// @param splines   keyframes->count of them
/// @param outliers  the rule that the splines were made with, whose outliers are marked
/// @return as bat_motion_picture_write(); BAT_INVALID_ARGUMENT where a spline has another space or number of keys than its
/// curve
BAT_API bat_status bat_motion_splines_picture_write(const char *path, const bat_curve_set *keyframes,
                                                    bat_motion_spline *const *splines, bat_motion_outliers outliers,
                                                    const bat_motion_picture_options *options, bat_error *error);

BAT_C_END

#endif
