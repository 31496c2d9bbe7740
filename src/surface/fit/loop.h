#pragma once

#include "surface/fit/system.h"

/// @file
/// What the adaptive loop (adaptive.c) works on.

// Border curves of a fit. A smoothing spline with a weight of its own is fitted to the boundary points of each side. The
// boundary points themselves become free points of the surface; samples of the curves, at equidistant parameters, hold its
// border.
//
// A sample holds the surface only in the direction m that is tangent to the surface and normal to its border. After a
// correction its target is
//     S(t) + m (m . (c(s) - S(t)) + offset),   c(s): the foot of S(t) on the border curve,
// so that neither the parameter along the side nor the height of a rough loop is imposed on the surface. The boundary loop
// of points at random places runs inside the edge of the sheet. `offset` is the mean distance from its curve to the edge.

#define FIT_BORDER_SIDES 4 ///< v = 0, u = 1, v = 1, u = 0

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
    memory_pool pool; ///< all arrays, those of the sides too
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

/// As fit_points_make() for points and samples, which have the numbers after them. The data of a part have samples.
bat_status fit_border_points(const fit_border *border, const fit_team *team, const bat_surface_fit_data *data,
                             const uint32_t *numbers, bool centred, fit_points *points, bat_error *error);

/// Whether a boundary point takes part in the fit of the surface: in rough loops, which run inside the edge. Those that lie
/// on the edge are represented by their curve; the surface would follow the noise of half of them.
static inline bool fit_border_takes(const fit_border *border, size_t point)
{
    return border->sides[border->side[point]].offset > 0;
}

/// Move the targets of the samples. Requires parameters that were corrected on this surface. Every process moves all.
bat_status fit_border_update(fit_border *border, const fit_nets *nets, fit_points *points, bat_error *error);

/// Move the samples to their targets in the points.
void fit_border_move(const fit_border *border, fit_points *points);

/// The round with the least expected distance of new points.
typedef struct fit_best
{
    bat_hierarchical_space *space; ///< null for none
    double *parameter;             ///< points.count x 2, before the corrections of later rounds
    double *distance;              ///< points.count
    double expected;               ///< root of the expected squared distance
    double held_rms, held_largest; ///< distances of held-out points
    double left;                   ///< see fit_loop
    size_t round;
    double lambda;
} fit_best;

/// State of the adaptive loop.
typedef struct fit_loop
{
    const bat_surface_fit_options *options;
    const fit_team *team; ///< null for one process
    fit_points points;
    fit_border border; ///< empty without
    bat_hierarchical_space *space;
    fit_system system;
    fit_solver *solver;
    double *control; ///< functions x dimension
    fit_nets nets;
    double lambda; ///< smoothing weight of the last fit; 0 before the first
    double trace;  ///< of the influence matrix, at the last search for a weight
    double left;   ///< share of the degrees of freedom that residuals have at the last measurement; not positive: unknown
    size_t budget; ///< maximum number of functions; 0: none
    double size;   ///< the largest absolute coordinate of a point
    bool full;     ///< no further refinement fits the budget
    size_t outliers;
    size_t held_count;
    double *fixed; ///< points.count x 2: parameters that stay; null where they are corrected
    bool *held;    ///< points.count: rows that are held out; null without
    bool corrects; ///< parameters have been corrected, which leaves residuals across the surface only
    bool stalled;
    double held_rms, held_largest; ///< distances of the held-out points at the last measurement
    double expected;               ///< root of the expected squared distance of new points, at the last measurement
    fit_best best;
    bat_surface_fit_round *rounds; ///< iterations + 1
    size_t count;
    double begin, reported; ///< start time in seconds, and the progress last reported
} fit_loop;

// Marking of cells for refinement in the adaptive loop.

/// How to select the cells to refine.
typedef struct fit_marking
{
    double tolerance; ///< cells with a point at a larger distance are marked; 0: mark the cells with a fixed share of the
                      ///< total squared error
    size_t budget;    ///< maximum number of functions after refinement; 0: unlimited
    size_t fewest;    ///< cells with fewer points are not refined
    int neighbours;   ///< number of rings of cells refined around a marked cell
} fit_marking;

/// What the points of a cell tell.
typedef struct cell_points
{
    double sum;     ///< sum of weighted squared distances
    double largest; ///< largest distance
    double count;
    double low[2], high[2]; ///< bounding box of the parameters
} cell_points;

#define CELL_NO_POINTS ((cell_points){.low = {1, 1}})

void cell_points_add(cell_points *to, const cell_points *more);
/// Statistics of the points at places begin to end - 1.
cell_points cell_points_of_places(const fit_points *points, size_t begin, size_t end);
/// Statistics of the points of a cell that are here, from those of blocks.
cell_points cell_points_of(const fit_points *points, size_t cell);
/// The score of a cell, 0 for cells not to refine: all points within the tolerance, too few points, or last level. Without a
/// tolerance the score is multiplied by (n - 1) / n for n points, because few points determine the error less reliably.
double cell_score(const bat_hierarchical_space *space, const cell_points *gathered, size_t cell, const fit_marking *marking);

/// Refine the marked cells, and rings of active cells of the same level around them. Cells are ranked by the weighted sum of
/// squared distances of their points. If the budget does not allow all marked cells, only the highest-ranked ones are
/// refined.
/// @param refined receives the refined space; null when there is nothing to refine or nothing fits the budget
bat_status fit_mark_refine(const bat_hierarchical_space *space, const fit_points *points, const fit_marking *marking,
                           bat_hierarchical_space **refined, bat_error *error);

// Weights of points with outliers among them.

/// One step of iteratively re-weighted least squares with Tukey's biweight (Beaton and Tukey, 1974):
///     w_i = (1 - t^2)^2 for t < 1, else 0,   t = d_i / (4.685 s_i),   s_i = 1.4826 max(median of all d, median of the
///     neighbours' d).
/// The second median is that of the neighbours in Morton order. It prevents that a feature which the surface is still too
/// stiff to follow is taken for outliers.
/// @param outliers receives the number of points of weight 0
/// @param size     the largest absolute coordinate of all points
/// @return BAT_OK or BAT_NO_MEMORY
bat_status fit_robust_weights(fit_points *points, double size, size_t *outliers, bat_error *error);

/// bat_surface_fit() and bat_surface_fit_together().
/// @param team    null for one process
/// @param numbers of a part; null where all points are here
bat_status fit_all(const fit_team *team, bat_surface_fit_data *data, const uint32_t *numbers,
                   const bat_surface_fit_options *options, bat_spline_surface *surface, bat_surface_fit_report *report,
                   bat_error *error);
