#ifndef SURFACE_FIT_POINTS_H
#define SURFACE_FIT_POINTS_H

#include "batten/surface_fit.h"

/// @file
/// The points of a fit in the order that makes passes over them quick: along a Morton curve of their first parameters, so
/// that the points of any cell lie close together in memory, and beside it by cells of the space at hand.

/// How a parameter may move.
typedef enum fit_freedom
{
    FIT_FREE,
    FIT_ALONG_U,
    FIT_ALONG_V,
    FIT_FIXED
} fit_freedom;

/// Release it with fit_points_free().
typedef struct fit_points
{
    size_t count, dimension;
    uint32_t *number;  ///< of a row among the caller's points
    double *position;  ///< count x dimension, less `centre`
    double *parameter; ///< count x 2
    double *weight;    ///< count
    double *distance;  ///< count: |S(u_i) - x_i| as last measured
    uint8_t *freedom;  ///< count: a fit_freedom
    double *centre;    ///< dimension: what has been taken off all positions
    uint32_t *order;   ///< rows by cells of the space
    uint32_t *cell;    ///< count: the cell of a row
    size_t *first;     ///< cells + 1: where the rows of a cell begin in `order`
    size_t cells;
} fit_points;

/// Check data: counts, points, parameters, and boundary parameters on the boundary.
bat_status fit_points_check(const bat_surface_fit_data *data, bat_error *error);

/// @param weights  count, or null for ones
/// @param centred  whether the mean is taken off the positions, for a basis whose functions add up to one
bat_status fit_points_make(const bat_surface_fit_data *data, const double *weights, bool centred, fit_points *points,
                           bat_error *error);
void fit_points_free(fit_points *points);

/// Find the cells of all points.
void fit_points_locate(fit_points *points, const bat_hierarchical_space *space, int threads);

/// Order the points, which know their cells, by them.
bat_status fit_points_sort(fit_points *points, const bat_hierarchical_space *space, bat_error *error);

/// Add the centre to all control points.
void fit_points_restore(const fit_points *points, size_t functions, double *control);

/// Hand parameters back to the caller.
/// @return how many differ from what they were there
size_t fit_points_return(const fit_points *points, bat_surface_fit_data *data);

#endif
