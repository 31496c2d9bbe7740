#ifndef SURFACE_NETWORK_CHART_NETWORK_H
#define SURFACE_NETWORK_CHART_NETWORK_H

#include "batten/cloud.h"
#include "surface/network/model.h"
#include "surface/network/polynomial_patch.h"

/// @file
/// First parameters of a cloud's interior, and how a network's few numbers move them:
///
///     u' = u + gate * step(x, u) + bubble(u) sum over a, b up to CHART_DEGREE of q_ab P_a(2 u - 1) P_b(2 v - 1)
///
/// The bubble 16 u (1 - u) v (1 - v) leaves the boundary where it is. The step takes a point to its foot on the polynomial
/// patch that fits the cloud at its first parameters: it takes noise along the surface out. The field bends the chart so
/// that a spline of low degree follows.

enum
{
    CHART_DEGREE = 4,
    CHART_TERMS = (CHART_DEGREE + 1) * (CHART_DEGREE + 1),
    CHART_MOVES = 2 * CHART_TERMS + 1 ///< q by term and parameter, then what the gate is the sigmoid of, less 2
};

typedef struct surface_chart
{
    size_t count;                    ///< interior points
    double *parameters;              ///< count x 2: the first ones; 0 to 1
    double *steps;                   ///< count x 2
    double features[PATCH_FEATURES]; ///< what the network sees; zeros when there is nothing to see
    bool has_features;
    bool folded; ///< the patch at the first parameters is far from the cloud: a deep shape, which the extension folds
} surface_chart;

/// @param cloud    in the unit box, with a boundary
/// @param boundary cloud->boundary_count x 2
/// @param memory   4 x interior points numbers that the chart keeps
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_NO_CONVERGENCE
bat_status surface_chart_make(const bat_cloud *cloud, const double *boundary, double *memory, surface_chart *chart,
                              bat_error *error);

/// @param moves    CHART_MOVES numbers
/// @param interior receives count x 2, in [0, 1]
void surface_chart_move(const surface_chart *chart, const double *moves, double *interior);
/// The derivative of a function of `interior` by `moves`; parameters that were held at 0 or 1 count as if they were not.
/// @param by_interior count x 2
/// @param by_moves    CHART_MOVES numbers, added to
void surface_chart_move_back(const surface_chart *chart, const double *moves, const double *by_interior, double *by_moves);

/// @file
/// Our network: what it sees of a cloud is the polynomial patch at the cloud's first parameters, in that patch's own frame
/// and scale; what it says is how to bend the chart (src/surface/network/surface_chart.h). Four layers with GELU between,
/// whatever the number of points.

enum
{
    CHART_WIDTH = 384,
    CHART_LAYERS = 4
};

extern const surface_network_kind surface_network_batten;

#endif
