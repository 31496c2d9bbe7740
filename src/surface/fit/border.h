#ifndef SURFACE_FIT_BORDER_H
#define SURFACE_FIT_BORDER_H

#include "surface/fit/foot_points.h"
#include "surface/fit/points.h"

/// @file
/// Border curves of a fit. A smoothing spline with a weight of its own is fitted to the boundary points of each side. The
/// boundary points themselves become free points of the surface; samples of the curves, at equidistant parameters, hold its
/// border.
///
/// A sample holds the surface only in the direction m that is tangent to the surface and normal to its border. After a
/// correction its target is
///     S(t) + m (m . (c(s) - S(t)) + offset),   c(s): the foot of S(t) on the border curve,
/// so that neither the parameter along the side nor the height of a rough loop is imposed on the surface. The boundary loop
/// of points at random places runs inside the edge of the sheet. `offset` is the mean distance from its curve to the edge.

enum
{
    FIT_BORDER_SIDES = 4 ///< v = 0, u = 1, v = 1, u = 0
};

/// The border curve of a side, and what its points tell.
typedef struct fit_border_side
{
    bat_spline_surface curve; ///< constant in its second parameter
    size_t count;             ///< boundary points
    double *points;           ///< count x dimension
    double *at;               ///< count x 2: their parameters on the curve, (t, 0)
    size_t first, samples;    ///< of all samples
    double offset;            ///< from the curve to the edge, outwards
} fit_border_side;

/// The border of a fit; empty without. Release it with fit_border_free().
typedef struct bat_surface_border fit_border;
struct bat_surface_border
{
    size_t dimension, samples;
    size_t boundary_count;
    uint8_t *side; ///< boundary_count: a side of each boundary point
    fit_border_side sides[FIT_BORDER_SIDES];
    double *points; ///< samples x dimension: places on the curves; the last four are the corners
    double *at;     ///< samples x 2: parameters on the surface
    double *foot;   ///< samples x 2: parameters on the curves, (s, 0)
    double *target; ///< samples x dimension: places less the centre of the points, after an update
    bool moved;     ///< there was an update
};

/// Fit the border curves. The border stays empty where a side has too few points.
bat_status fit_border_make(const bat_surface_fit_data *data, const bat_surface_fit_options *options, fit_border *border,
                           bat_error *error);
void fit_border_free(fit_border *border);

/// As fit_points_make() for the points and the samples, whose numbers follow those of the points.
bat_status fit_border_points(const fit_border *border, const bat_surface_fit_data *data, bool centred, fit_points *points,
                             bat_error *error);
/// As fit_points_make_part(), for data that have the samples.
bat_status fit_border_points_part(const fit_border *border, const bat_group *group, const bat_surface_fit_data *data,
                                  const uint32_t *numbers, bool centred, fit_points *points, bat_error *error);

/// Whether a boundary point takes part in the fit of the surface: in rough loops, which run inside the edge. Those that lie
/// on the edge are represented by their curve; the surface would follow the noise of half of them.
static inline bool fit_border_takes(const fit_border *border, size_t point)
{
    return border->sides[border->side[point]].offset > 0;
}

/// Move the targets of the samples. Requires parameters that were corrected on this surface. Every process moves all.
bat_status fit_border_update(fit_border *border, const fit_nets *nets, fit_points *points, bat_error *error);

/// Bytes of what updates have changed.
size_t fit_border_state_size(const fit_border *border);
void fit_border_save(const fit_border *border, char *bytes);
/// Take up what fit_border_save() has written, in the points too.
void fit_border_load(fit_border *border, const char *bytes, fit_points *points);

#endif
