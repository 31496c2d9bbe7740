#ifndef DRAW_CURVE_COMB_H
#define DRAW_CURVE_COMB_H

#include "draw/curve/stroke.h"
#include "draw/curve/view.h"

/// @file
/// Curvature combs: at every vertex a tooth as long as the curvature there, away from the centre of curvature.

/// The most vertices of a curve that a comb uses.
#define COMB_MAX_POINTS 8192

/// The teeth of a curve. The curvature at a vertex is its exterior angle over the mean length of its two edges, a curvature
/// vector being a tangent vector there of that length; 0 at the ends of an open curve.
typedef struct comb
{
    view_space space;
    size_t point_dim;
    size_t count;
    bool closed;
    double *points;  ///< count x point_dim: the vertices
    double *vectors; ///< count x point_dim: minus the curvature vectors. In the disk: in the frame that the Möbius
                     ///< translation from the origin brings
} comb;

/// The comb of a curve that was checked; release it with comb_free(). Closed curves of fewer than 3 and open ones of fewer
/// than 3 points have no teeth.
bat_status comb_make(const bat_curve *curve, comb *segments, bat_error *error);
void comb_free(comb *segments);

/// The scale at which the 95th percentile of the teeth is `usual` long, less where the longest would be beyond `longest`.
/// INFINITY when all curvatures vanish.
bat_status comb_natural_scale(const comb *segments, double usual, double longest, double *scale, bat_error *error);

/// The end of a tooth: the point reached from vertex `index` along its vector, `scale` times as far.
void comb_tip(const comb *segments, size_t index, double scale, double *tip);

/// @file
/// Combs on paper.

/// Draw the teeth of a comb and the line through their tips. The ends of an open curve, where curvature is not known, have
/// neither.
bat_status comb_lines_draw(cairo_t *cairo, const draw_view *view, const comb *segments, double scale, draw_colour colour,
                           bat_error *error);

#endif
