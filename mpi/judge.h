#ifndef MPI_JUDGE_H
#define MPI_JUDGE_H

#include "points.h"

#include "batten/research/surface_chart.h"

/// @file
/// The verdict on a distributed surface. Rank 0 judges by all points, or by an even part of many: every k-th along the
/// curve. The noise of many points is estimated on patches of neighbouring points. Neither depends on the number of ranks.

/// @param distances input->count: of this rank's points
/// @param verdict   of rank 0, and the noise
void judge_surface(const fit_input *input, const double *distances, const bat_spline_surface *surface,
                   const bat_surface_fit_options *options, bat_surface_verdict *verdict, double *noise);

#endif
