#ifndef RESEARCH_DATA_TENSION_CURVES_H
#define RESEARCH_DATA_TENSION_CURVES_H

#include "base/mersenne.h"
#include "batten/research/curve_data.h"

/// The seed of the published data set.
#define TENSION_SEED 42

/// Curve `number` of a space: BAT_TENSION_TRUTH_POINTS points in double precision, before rounding. `stream` is the stream
/// that all curves share; it must have made the curves before this one.
void tension_curve(bat_tension_space space, size_t number, mersenne *stream, double *points);

#endif
