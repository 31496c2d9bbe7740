#ifndef BATTEN_RESEARCH_CURVE_SHAPES_H
#define BATTEN_RESEARCH_CURVE_SHAPES_H

#include "batten/curve.h"

BAT_C_BEGIN

/// @file
/// Eight control polygons of everyday objects, to demonstrate plane curve schemes: the shapes named in Alam, *Study of
/// Subdivision Curve Schemes* (2025), sections 3.3, 4.3 and 5.3. The study prints no coordinates; these are original
/// drawings.

/// Maximum number of schemes that the study applies to a shape.
#define BAT_SHAPE_MAX_SCHEMES 3
/// Maximum number of outlines of a shape.
#define BAT_SHAPE_MAX_OUTLINES 5

/// One polygon of a shape, in the plane.
typedef struct bat_shape_outline
{
    const double (*points)[2]; ///< `count` points: x to the right, y up
    size_t count;
    bool closed; ///< the last point joins the first
} bat_shape_outline;

/// One figure of the study: a scheme applied to a shape.
typedef struct bat_shape_figure
{
    const char *number; ///< "3.2"
    const char *scheme; ///< as bat_curve_scheme_by_name() takes it
} bat_shape_figure;

/// A drawing of one or more polygons, two or three units across. The polygons are simple, and so are their limit curves
/// under the schemes of the figures.
typedef struct bat_curve_shape
{
    const char *name;    ///< "jar", "mango", "pi", "car", "rabbit", "hand", "U" or "mug"
    const char *summary; ///< short description
    const bat_shape_outline *outlines;
    size_t outline_count;
    bat_shape_figure figures[BAT_SHAPE_MAX_SCHEMES];
    size_t figure_count;
} bat_curve_shape;

/// The number of shapes.
BAT_API size_t bat_curve_shape_count(void);
/// A shape, `index` from 0 on; null past the last. It has static storage duration.
BAT_API const bat_curve_shape *bat_curve_shape_at(size_t index);

/// A copy of one outline as a curve.
///
/// @param outline index of the outline in the shape
/// @param plane   R^2, as bat_euclidean(2) gives it; must outlive the curve
/// @param curve   receives the points; release it with bat_curve_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT (no such outline, not R^2) or BAT_NO_MEMORY; `curve` is untouched on failure
BAT_API bat_status bat_curve_shape_curve(const bat_curve_shape *shape, size_t outline, const bat_space *plane,
                                         bat_curve *curve, bat_error *error);

/// The panels of a figure: levels 0, 1, 2, 10 and 20.
#define BAT_CURVE_FIGURE_PANELS 5

/// A figure of the study made anew: a shape at every level, and its measurements.
typedef struct bat_curve_figure
{
    const bat_curve_shape *shape;
    const bat_shape_figure *study;
    bat_curve curves[BAT_CURVE_FIGURE_PANELS][BAT_SHAPE_MAX_OUTLINES];
    char name[64];           ///< "curve-figures-SCHEME-SHAPE"
    size_t vertices, points; ///< of the first level and of the last one
    double seconds;          ///< time to refine to the last level
    double chord;            ///< largest distance of the points of level 20 from the edges of level 10
    double middle_off_limit; ///< largest distance of a vertex of level 10 from its limit
    double last_off_limit;   ///< the same for level 20
    bat_progress progress;
} bat_curve_figure;

/// Make a figure.
///
/// @param plane  R^2, as bat_euclidean(2) gives it; must outlive the figure
/// @param figure receives it; release it with bat_curve_figure_free(). Empty on failure
/// @return BAT_OK, BAT_CANCELLED, BAT_NO_MEMORY or what refining and measuring return
BAT_API bat_status bat_curve_figure_make(const bat_curve_shape *shape, const bat_shape_figure *study, const bat_space *plane,
                                         bat_progress progress, bat_curve_figure *figure, bat_error *error);
/// Release a figure. An empty one is ignored.
BAT_API void bat_curve_figure_free(bat_curve_figure *figure);
/// Draw the panels side by side.
///
/// @param path .png, .svg or .pdf
/// @return BAT_OK or the status of bat_curve_picture_write()
BAT_API bat_status bat_curve_figure_draw(const char *path, const bat_curve_figure *figure, bat_error *error);

BAT_C_END

#endif
