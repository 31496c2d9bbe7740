#ifndef RESEARCH_TRAIN_TAPE_LEARNED_H
#define RESEARCH_TRAIN_TAPE_LEARNED_H

#include "curve/network/learned_features.h"
#include "research/train/tape_polygon.h"

/// @file
/// The shipped rule's geometry on a tape: from a polygon to what its edges see, and from what the network says to angles.

/// All edges of a polygon.
typedef struct tape_fairing
{
    tape_polygon *polygon;
    double fairness;
    learn_array *features;      ///< edges x LEARNED_FEATURES
    learned_features *sights;   ///< of the edges
    learned_features *gradient; ///< the same, by the loss
    double *angles,
        *lengths; ///< of the polygon continued beyond its ends; entry LEARNED_REACH + i is that of the polygon's i
} tape_fairing;

/// Look at a polygon. An open one is continued by point reflection in its ends (BAT_CURVE_END_REFLECT).
tape_fairing *tape_fairing_see(learn_tape *tape, tape_polygon *polygon, double fairness);
/// The insertion angles base + scale tanh(said), clipped to BAT_CURVE_ANGLE_LIMIT.
/// @param said edges x 1
learn_array *tape_fairing_angles(learn_tape *tape, tape_fairing *sight, learn_array *said);

#endif
