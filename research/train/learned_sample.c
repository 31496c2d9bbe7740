#include "research/train/learned_sample.h"

#include "curve/network/learned_network.h"
#include "research/train/tape_learned.h"

/// High enough to look at the largest angles, low enough to be smooth.
static const double ANGLE_POWER = 16;

/// The polygons of the tables, where a typical angle is known.
static const double FINEST_COUNT = BAT_TENSION_CONTROL_POINTS << 5;

tape_polygon *learned_step(learn_tape *tape, tape_polygon *polygon, double fairness)
{
    tape_fairing *sight = tape_fairing_see(tape, polygon, fairness);
    if (tape->status != BAT_OK)
        return NULL;
    learn_array *said = learned_network_apply(tape, sight->features);
    return tape_polygon_insert(tape, polygon, tape_fairing_angles(tape, sight, said));
}

learned_loss learned_sample_loss(learn_tape *tape, const tension_sample *sample, bat_tension_space space, size_t steps,
                                 double fairness, const learned_weights *weights)
{
    tape_polygon *polygon = tape_polygon_given(tape, &sample->control);
    for (size_t step = 0; step < steps; step++)
        polygon = learned_step(tape, polygon, fairness);
    learned_loss loss = {0};
    loss.distance = sample->control.closed ? tape_polygon_chamfer(tape, polygon, sample->truth, sample->truth_count)
                                           : tape_polygon_mean_nearest(tape, polygon, sample->truth, sample->truth_count);
    learn_array *bending = tape_polygon_bending(tape, polygon);
    loss.bending = learn_subtract(tape, learn_log(tape, bending),
                                  learn_log(tape, learn_add_number(tape, bending, (real)weights->bending_unit[space])));
    loss.angle = tape_polygon_angle_power_mean(tape, polygon, ANGLE_POWER);
    double fair = weights->least * pow(weights->most / weights->least, fairness);
    if (tape->status != BAT_OK)
        return loss;
    // Angles halve with every level: what is counted is how they compare on polygons of so many vertices.
    double angle_unit = weights->angle_unit[space] * FINEST_COUNT / (double)polygon->shape.count;
    learn_array *angle = learn_scale(tape, loss.angle, (real)(weights->angle / angle_unit));
    learn_array *roughness = learn_add(tape, loss.bending, angle);
    loss.total = learn_add(tape, learn_scale(tape, loss.distance, (real)(1 / weights->distance_unit[space])),
                           learn_scale(tape, roughness, (real)fair));
    return loss;
}
