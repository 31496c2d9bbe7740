#ifndef RESEARCH_TRAIN_SURFACE_SAMPLE_H
#define RESEARCH_TRAIN_SURFACE_SAMPLE_H

#include "research/train/surface_network_training.h"

/// @file
/// Clouds to train on, and the loss of Giannelli et al., "BIDGCN" (2023), section 4.4.

/// What clouds are drawn from: the ranges of bat_surface_train_options.
typedef struct surface_sample_range
{
    size_t least_points, most_points;
    int least_degree, most_degree;
    double noise;
    double clean; ///< the share of clouds without noise
} surface_sample_range;

/// Draw a cloud and put it in the unit box. Near interior points follow each other.
/// @param sample release it with surface_sample_free()
bat_status surface_sample_draw(const surface_sample_range *range, bat_random *random, surface_sample *sample,
                               bat_error *error);
/// Does nothing to one that is all zero.
void surface_sample_free(surface_sample *sample);

/// The mean over all points and coordinates of the squares of what the best patch of the sample's bidegree leaves of the
/// points, the boundary with its own parameters, the interior with these. 1 x 1.
/// @param interior interior points x 2; the tape must end before the sample does
learn_array *surface_sample_residual(learn_tape *tape, const surface_sample *sample, learn_array *interior);

/// The same with all parameters as they were sampled: what noise leaves.
bat_status surface_sample_floor(const surface_sample *sample, double *error_left, bat_error *error);

#endif
