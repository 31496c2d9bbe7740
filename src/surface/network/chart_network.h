#ifndef SURFACE_NETWORK_CHART_NETWORK_H
#define SURFACE_NETWORK_CHART_NETWORK_H

#include "batten/cloud.h"
#include "surface/network/model.h"
#include "surface/network/polynomial_patch.h"

/// @file
/// Parameterization by a chart and a small network.
///
/// A chart consists of initial parameters u of the interior points (biharmonic_extension.h), and of the Gauss-Newton steps
/// to their foot points on the polynomial patch (polynomial_patch.h). The network maps the features of the patch to
/// coefficients q and a gate, which give the parameters
///     u' = u + gate * step(x, u) + bubble(u) sum over a, b <= CHART_DEGREE of q_ab P_a(2 u - 1) P_b(2 v - 1),
///     bubble(u) = 16 u (1 - u) v (1 - v).
/// The bubble vanishes on the boundary. The steps remove noise tangential to the surface. The polynomial deforms the chart
/// so that splines of low degree fit well. The network has four layers with GELU activation, independent of the number of
/// points.

enum
{
    CHART_DEGREE = 4,
    CHART_TERMS = (CHART_DEGREE + 1) * (CHART_DEGREE + 1),
    CHART_MOVES = 2 * CHART_TERMS + 1 ///< q by term and parameter, then the logit of the gate minus 2
};

/// A chart of a cloud.
typedef struct surface_chart
{
    size_t count;                    ///< interior points
    double *parameters;              ///< count x 2: initial parameters, in [0, 1]
    double *steps;                   ///< count x 2: steps to the foot points
    double features[PATCH_FEATURES]; ///< input of the network
    bool has_features;               ///< false when the patch is degenerate; the features are then undefined
    bool folded;                     ///< the patch is far from the cloud: the initial parameters fold, as on deep shapes
} surface_chart;

/// Compute the chart of a cloud.
/// @param cloud    in the unit box, with a boundary
/// @param boundary cloud->boundary_count x 2
/// @param memory   4 x interior points numbers, used as long as the chart
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_NO_CONVERGENCE
bat_status surface_chart_make(const bat_cloud *cloud, const double *boundary, double *memory, surface_chart *chart,
                              bat_error *error);

/// Compute the parameters u'.
/// @param moves    CHART_MOVES outputs of the network
/// @param interior receives count x 2, in [0, 1]
void surface_chart_move(const surface_chart *chart, const double *moves, double *interior);
/// Backpropagate through surface_chart_move(). Clamping to [0, 1] is ignored.
/// @param by_interior count x 2: derivatives with respect to `interior`
/// @param by_moves    CHART_MOVES numbers, to which the derivatives are added
void surface_chart_move_back(const surface_chart *chart, const double *moves, const double *by_interior, double *by_moves);

enum
{
    CHART_WIDTH = 384,
    CHART_LAYERS = 4
};

extern const learn_network surface_network_batten;

#endif
