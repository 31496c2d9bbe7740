#ifndef DRAW_CURVE_COMB_H
#define DRAW_CURVE_COMB_H

#include "draw/curve/stroke.h"
#include "draw/curve/view.h"

/// @file
/// Curvature combs: at each vertex a segment whose length is proportional to the curvature, away from the centre of
/// curvature.

/// The most vertices of a comb.
#define COMB_MAX_POINTS 8192

/// The segments of a comb. The curvature at a vertex is its exterior angle divided by the mean length of its two edges; the
/// curvature vector is the tangent vector of this length. It is 0 at the ends of an open curve.
typedef struct comb
{
    view_space space;
    size_t point_dim;
    size_t count;
    bool closed;
    double *points;  ///< count x point_dim: the vertices
    double *vectors; ///< count x point_dim: negative curvature vectors; in the disk, transported from the origin by a Möbius
                     ///< translation
} comb;

/// Compute the comb of a checked curve; release it with comb_free(). Curves with fewer than 3 points have no segments.
bat_status comb_make(const bat_curve *curve, comb *segments, bat_error *error);
void comb_free(comb *segments);

/// The scale at which the 95th percentile of the segments has the length `usual` and none is longer than `longest`. INFINITY
/// when all curvatures vanish.
bat_status comb_natural_scale(const comb *segments, double usual, double longest, double *scale, bat_error *error);

/// The end of a segment: the point reached from vertex `index` along `scale` times its vector.
void comb_tip(const comb *segments, size_t index, double scale, double *tip);

/// Draw the segments of a comb and the line through their ends. The ends of an open curve, with unknown curvature, have
/// neither.
bat_status comb_lines_draw(cairo_t *cairo, const draw_view *view, const comb *segments, double scale, draw_colour colour,
                           bat_error *error);

#endif
