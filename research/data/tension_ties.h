#ifndef RESEARCH_DATA_TENSION_TIES_H
#define RESEARCH_DATA_TENSION_TIES_H

#include "batten/research/curve_data.h"

/// Whether control point `control` of curve `number` is, in the published arrays, the vertex after the one that
/// arc_samples() gives, although that one is at its share of the length to ARC_SAMPLES_TOLERANCE.
bool tension_tie_takes_next(bat_tension_space space, size_t number, size_t control);

#endif
