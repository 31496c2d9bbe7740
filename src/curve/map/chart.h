#ifndef CURVE_MAP_CHART_H
#define CURVE_MAP_CHART_H

#include "curve/topology/draw_back.h"

/// @file
/// The plane in which the curves of a map must not cross. Curves of the plane and the disk are their own charts. Those of
/// the sphere have the chart of longitude and latitude, in units of the last decimal that a file holds, because readers of
/// the file see straight lines between these numbers (RFC 7946, section 3.1.1).

/// A chart of a space.
typedef struct map_chart
{
    bat_space space;         ///< the plane or the disk
    bool globe;              ///< the chart of the sphere; else the curves are their own charts
    double units_per_degree; ///< globe
    double units_per_radian; ///< globe
    double turn;             ///< globe: 360 degrees in units; else 0
} map_chart;

/// The charts of many curves. All zero: empty.
typedef struct chart_curves
{
    bat_curve *curves; ///< the points of a globe's chart are in `points`; others are those of the curves themselves
    double *points;
    size_t count;
} chart_curves;

/// The chart of a space; false where there is none.
/// @param decimals of degrees on the sphere
bool chart_of_space(const bat_space *space, int decimals, map_chart *chart);

/// Make the charts of curves. Longitudes go on without jumps along a curve. A ring around a pole becomes an open curve whose
/// last point repeats the first one turn further.
///
/// @param curves checked curves
/// @param coarse the charts of the curves from which these were refined, whose points they keep; null for none
/// @param starts of each curve: coarse point i is point starts[i]; null, or null for a curve: every edge has equally many
///               new points
/// @param charts release it with chart_curves_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status chart_curves_make(const map_chart *chart, const bat_curve *curves, size_t count, const chart_curves *coarse,
                             size_t *const *starts, int threads, chart_curves *charts, bat_error *error);
void chart_curves_free(chart_curves *charts);

/// Move the points begin + 1 … end - 1 of a refined curve of the sphere, in the chart, for edge `edge` of the curve before.
/// @param coarse the chart of the curve before
/// @param flat   the chart of the refined curve; its points move as well
void chart_move(const map_chart *chart, const bat_curve *coarse, bat_curve *fine, bat_curve *flat, size_t edge, size_t begin,
                size_t end, draw_move move);

#endif
