#pragma once

#include "batten/cloud.h"

#include "batten/cloud_parameterize.h"
#include "learn/model.h"

/// @file
/// Networks that parameterize clouds, as rows of learn/model.h: training, files and bat_surface_model_parameterize() use
/// them. The recipe of a file tells its network.
///
/// Throughout, a cloud is scaled to the unit box (mesh/measure/unit_box.h), with one scale for all coordinates. Its boundary
/// points come first, and it has passed bat_cloud_check(). *Interior* points are all others, in order.

/// The rule of a network.
typedef struct surface_rule
{
    /// Compute the interior parameters. The result agrees with that of the tape up to rounding, except for clouds on which
    /// the network uses a classical method instead. Thread-safe; the result does not depend on `threads` (0: the default of
    /// OpenMP).
    /// @param interior receives interior points x 2, each in [0, 1]
    bat_status (*infer)(const void *network, const bat_cloud *cloud, const double *boundary, int threads, double *interior,
                        bat_error *error);
} surface_rule;
/// The table of networks.
extern const learn_networks surface_networks;

/// Read a model, a row's rule being a surface_rule.
bat_status surface_model_read(const learn_networks *networks, const char *path, bat_surface_model **model, bat_error *error);

// Parameterization by a chart and a small network.
//
// A chart consists of initial parameters u of the interior points, and of the Gauss-Newton steps
// to their foot points on the polynomial patch. The network maps the features of the patch to
// coefficients q and a gate, which give the parameters
//     u' = u + gate * step(x, u) + bubble(u) sum over a, b <= CHART_DEGREE of q_ab P_a(2 u - 1) P_b(2 v - 1),
//     bubble(u) = 16 u (1 - u) v (1 - v).
// The bubble vanishes on the boundary. The steps remove noise tangential to the surface. The polynomial deforms the chart
// so that splines of low degree fit well. The network has four layers with GELU activation, independent of the number of
// points.

// Least-squares polynomial patch through a cloud with parameters: features for a network, and foot points.
//     X(u, v) = sum over a, b <= PATCH_DEGREE of c_ab P_a(2 u - 1) P_b(2 v - 1)
// P_a is the Legendre polynomial of degree a. A small penalty on (a^2 + b^2)^2 |c_ab|^2 makes the fit unique where there
// are few points.

enum
{
    PATCH_DEGREE = 6,
    PATCH_TERMS = (PATCH_DEGREE + 1) * (PATCH_DEGREE + 1), ///< term (a, b) has index a (PATCH_DEGREE + 1) + b
    PATCH_FEATURES = 3 * (PATCH_TERMS - 1)                 ///< number of features of a patch
};

typedef struct polynomial_patch
{
    double terms[PATCH_TERMS][3]; ///< coefficients c_ab
    double residual;              ///< root mean square of |X(u_i) - x_i|
} polynomial_patch;

/// The Legendre polynomials of degrees 0 to `degree` (at least 1) at 2 t - 1.
void legendre_polynomials(double t, int degree, double *values);

/// Fit a patch.
/// @param points     count x 3, in the unit box, at least one
/// @param parameters count x 2
/// @param noise      standard deviation of a coordinate; increases the penalty
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_NO_CONVERGENCE for parameters that are not finite
bat_status polynomial_patch_fit(const double *points, const double *parameters, size_t count, double noise,
                                polynomial_patch *descriptor, bat_error *error);

/// One Gauss-Newton step from a point's parameters towards its foot on the patch.
void polynomial_patch_step(const polynomial_patch *descriptor, const double point[3], const double parameter[2],
                           double step[2]);

/// The coefficients except c_00, in a normalized frame: the first axis is along c_10, the second in the plane of c_10 and
/// c_01, and |c_10 x c_01| = 1. They are invariant under translation, rotation and scaling of the cloud. Under reflection
/// the third coordinates change sign.
/// @param features receives PATCH_FEATURES numbers
/// @return false when c_10 and c_01 are parallel or zero; `features` is then undefined
bool polynomial_patch_features(const polynomial_patch *descriptor, double *features);

// Extension of the parameters on the boundary loop to space by a biharmonic smoothing spline,
//     f(x) = a + B x - sum_k w_k |x - x_k|,   f(x_i) + lambda w_i = u_i,   sum_k w_k = 0,   sum_k w_k x_k = 0.
// The kernel |x| is that of the biharmonic spline in space (Duchon 1977; Wahba 1990, section 2.4). lambda grows with the
// noise of the loop, so that f smooths noisy loops instead of interpolating them.

/// The spline f.
typedef struct biharmonic_extension
{
    memory_pool pool;
    double *centres; ///< count x 3: the x_k, relative to `middle`
    double *weights; ///< (count + 4) x 2: w, a, B
    size_t count;
    double middle[3]; ///< mean of the loop
    double
        noise; ///< estimated standard deviation of a coordinate of the loop's points; about three quarters of the true one
} biharmonic_extension;

/// Compute the spline.
/// @param cloud    in the unit box
/// @param boundary cloud->boundary_count x 2
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_NO_CONVERGENCE when the system is singular
bat_status biharmonic_extension_make(const bat_cloud *cloud, const double *boundary, biharmonic_extension *extension,
                                     bat_error *error);
void biharmonic_extension_free(biharmonic_extension *extension);
/// Evaluate the spline, clamped to the unit square.
/// @param points     count x 3
/// @param parameters receives count x 2, in [0, 1]
void biharmonic_extension_evaluate(const biharmonic_extension *extension, const double *points, size_t count,
                                   double *parameters);

enum
{
    CHART_DEGREE = 4,
    CHART_TERMS = (CHART_DEGREE + 1) * (CHART_DEGREE + 1),
    CHART_GATE = 2 * CHART_TERMS,
    CHART_MOVES = CHART_GATE + 1 ///< q by term and parameter, then the logit of the gate minus 2
};

/// For a zero output of the network most of a step is taken.
static inline double chart_gate(const double *moves)
{
    return 1 / (1 + exp(-moves[CHART_GATE] - 2.0));
}

static inline double chart_bubble(const double parameter[2])
{
    return 16 * parameter[0] * (1 - parameter[0]) * parameter[1] * (1 - parameter[1]);
}

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

enum
{
    CHART_WIDTH = 384,
    CHART_LAYERS = 4
};

extern const learn_network surface_network_batten;
