#ifndef SURFACE_NETWORK_SURFACE_CHART_NETWORK_H
#define SURFACE_NETWORK_SURFACE_CHART_NETWORK_H

#include "surface/network/surface_network_kind.h"

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
