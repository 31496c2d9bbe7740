#ifndef RESEARCH_DATA_TENSION_CURVES_H
#define RESEARCH_DATA_TENSION_CURVES_H

#include "batten/research/curve_data.h"
#include "research/data/mersenne.h"

/// @file
/// The closed curves of the data set of Ugail and Howard (2026), section 6.1, before rounding.

/// The seed of the published data set.
#define TENSION_SEED 42

/// Make curve `number` of a space: BAT_TENSION_TRUTH_POINTS points in double precision, before rounding. `stream` is shared
/// by all curves and must have generated all curves before this one.
void tension_curve(bat_tension_space space, size_t number, mersenne *stream, double *points);

/// Whether the published arrays contain, as control point `control` of curve `number`, the vertex after the one of
/// arc_samples(). The latter is at its fraction of the length up to ARC_SAMPLES_TOLERANCE.
bool tension_tie_takes_next(bat_tension_space space, size_t number, size_t control);

#endif
