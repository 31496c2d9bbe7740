#ifndef SURFACE_CHART_H
#define SURFACE_CHART_H

#include "batten/distributed.h"
#include "batten/surface.h"
#include "surface/cloud/local_plane.h"

/// @file
/// Charts: parameters that a part of a cloud tells for all its points.

struct reconstruction;

struct bat_surface_chart
{
    unit_frame frame;           ///< of the whole cloud
    bat_cloud part;             ///< points whose parameters are known
    double *of_part;            ///< part.count x 2: these parameters, on the surface
    bat_spline_surface surface; ///< through the part
    double *loop;               ///< loop_count x 3: the boundary of the cloud
    double *loop_parameters;    ///< loop_count x 2
    size_t loop_count;
    size_t functions; ///< budget of the fit to all points

    // Of the process that has found the chart.

    struct reconstruction *work; ///< null in others
    bat_surface_reconstruct_options options;
};

/// Free all but what belongs to `work`.
void chart_free_shared(bat_surface_chart *chart);

#endif
