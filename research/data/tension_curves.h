#ifndef RESEARCH_DATA_TENSION_CURVES_H
#define RESEARCH_DATA_TENSION_CURVES_H

#include "base/mersenne.h"
#include "batten/research/curve_data.h"

/// The seed of the published data set.
#define TENSION_SEED 42

/// Curve `number` of a space: BAT_TENSION_TRUTH_POINTS points in double precision, before rounding. `stream` is the stream
/// that all curves share; it must have made the curves before this one.
void tension_curve(bat_tension_space space, size_t number, mersenne *stream, double *points);

/// Whether control point `control` of curve `number` is, in the published arrays, the vertex after the one that
/// arc_samples() gives, although that one is at its share of the length to ARC_SAMPLES_TOLERANCE.
bool tension_tie_takes_next(bat_tension_space space, size_t number, size_t control);

#endif
