#ifndef RESEARCH_TRAIN_SURFACE_SAMPLE_H
#define RESEARCH_TRAIN_SURFACE_SAMPLE_H

#include "batten/cloud.h"
#include "research/learn/operations.h"

/// @file
/// Clouds to train on, and the loss of Giannelli et al., "BIDGCN" (2023), section 4.4.

/// A training or validation cloud.
typedef struct surface_sample
{
    bat_cloud cloud;
    double *parameters; ///< cloud.count x 2: those that the points were sampled at. A network gets the boundary's, which
                        ///< come first; only a loss may use the others
    int degree;         ///< of the surface that the cloud was sampled from, in both parameters
} surface_sample;

/// The distribution of clouds: the ranges of bat_surface_train_options.
typedef struct surface_sample_range
{
    size_t min_points, max_points;
    int min_degree, max_degree;
    double noise;
    double clean; ///< the share of clouds without noise
} surface_sample_range;

/// Draw a cloud and scale it into the unit box. Interior points are in an order in which near points follow each other.
/// @param sample release it with surface_sample_free()
bat_status surface_sample_draw(const surface_sample_range *range, bat_random *random, surface_sample *sample,
                               bat_error *error);
/// Does nothing to one that is all zero.
void surface_sample_free(surface_sample *sample);

/// The mean square, over all points and coordinates, of the residual of the least-squares patch of the sample's bidegree.
/// The boundary has its own parameters, the interior these. 1 x 1.
/// @param interior interior points x 2; the sample must outlive the step on the tape
learn_array *surface_sample_residual(learn_tape *tape, const surface_sample *sample, learn_array *interior);

/// The same with all parameters at which the points were sampled: the part that is due to noise.
bat_status surface_sample_floor(const surface_sample *sample, double *error_left, bat_error *error);

#endif
