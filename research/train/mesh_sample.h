#ifndef RESEARCH_TRAIN_MESH_SAMPLE_H
#define RESEARCH_TRAIN_MESH_SAMPLE_H

#include "research/train/mesh_network_tape.h"
#include "research/train/mesh_pairs.h"

/// @file
/// The loss of one training pair of Liu et al., "Neural Subdivision" (2020), section 4.4, as a graph on a tape.

/// The form of the loss.
typedef struct mesh_sample_loss_form
{
    bool last_level; ///< at the last level alone, instead of the sum over all (appendix H)
    bool chamfer;    ///< by the nearest targets instead of each vertex's own (figure 6)
    bool surface;    ///< by mesh_sample_off_surface(), where the pair has normals
} mesh_sample_loss_form;

/// The mean of the squares of the coordinates' errors, or half the Chamfer distance of squares, summed over levels. Coarse
/// mesh and targets are scaled by the coarse mesh's unit box.
/// @param error_at receives the loss of each level, levels + 1 numbers
learn_array *mesh_sample_loss(learn_tape *tape, mesh_network_form network, mesh_sample_loss_form form, const mesh_pair *pair,
                              double *error_at);

/// The mean over points of the squared distance to the nearest target, plus that of the targets to the nearest point,
/// over 6. Where every point's nearest target is its own, this is the mean square over coordinates.
/// @param state points in its first 3 columns, at least one
/// @param targets count x 3, at least one
learn_array *mesh_sample_chamfer(learn_tape *tape, learn_array *state, const double *targets, size_t count);

/// The mean over points of sqrt((n.r)^2 + (r^2 - (n.r)^2) / 10 + e^2) - e for r = point - target and the surface's unit
/// normal n there. Squared errors along the surface have a tenth of the weight of those off it. The loss grows linearly, so
/// that outliers do not dominate as in a mean of squares. It is close to the mean distance of surfaces, by which results are
/// measured.
/// @param state   points in its first 3 columns
/// @param targets, normals rows x 3
/// @param slack   e, below which the loss is quadratic; above 0
learn_array *mesh_sample_off_surface(learn_tape *tape, learn_array *state, const double *targets, const double *normals,
                                     double slack);

#endif
