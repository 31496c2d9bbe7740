#ifndef RESEARCH_SHAPES_BLENDED_BODY_H
#define RESEARCH_SHAPES_BLENDED_BODY_H

#include "batten/base.h"

/// @file
/// Smooth random functions of space.

/// Gradient noise (Perlin, "Improving Noise", 2002) with the gradients of a seed: zero at points of whole numbers, about -1
/// to 1, with two continuous derivatives and slopes up to about 2.
double noise_at(uint64_t seed, double x, double y, double z);

/// Several octaves of it: sum over k < octaves of amplitude gain^k noise(2^k frequency p).
typedef struct noise_sum
{
    uint64_t seed;
    double frequency; ///< of the first octave, per unit of length
    double amplitude; ///< of the first octave
    double gain;      ///< from one octave to the next
    int octaves;
    double ridge; ///< 0: as it is; above: octaves are folded, 1 - 2 |noise| smoothed over this height, which gives ridges
} noise_sum;

/// No value is farther from zero than this.
double noise_sum_reach(const noise_sum *noise);

double noise_sum_at(const noise_sum *noise, const double point[3]);

/// @file
/// Bodies of bones and muscles that grow together smoothly, with a skin of noise: what creatures are made of.

enum
{
    BLENDED_BODY_MAX_PARTS = 96
};

typedef enum blended_body_kind
{
    BLENDED_BODY_ROUND_CONE, ///< a round cone from one ball to another
    BLENDED_BODY_ELLIPSOID,  ///< with its own axes
    BLENDED_BODY_TORUS,      ///< a ring
    BLENDED_BODY_BOX         ///< with its own axes and rounded edges
} blended_body_kind;

/// One part. Its own function is a distance, or nearly.
typedef struct blended_body_part
{
    blended_body_kind kind;
    double a[3], b[3]; ///< the ends of a bone; of others, a is the middle; of a box, b[0] is the rounding
    double axes[3][3]; ///< of ellipsoids and rings: unit vectors; a ring lies across axes[2]
    double radius[3];  ///< of a bone's two ends; of an ellipsoid or box, half of its width along its axes; of a ring and its
                       ///< tube
    double blend;      ///< the width over which the part grows together with those before
    bool subtracted;   ///< taken away rather than added
} blended_body_part;

/// The least of all parts, blended, moved by the noise.
typedef struct blended_body
{
    blended_body_part parts[BLENDED_BODY_MAX_PARTS];
    size_t count;
    noise_sum noise;        ///< amplitude 0 for none
    noise_sum ridged_noise; ///< a second layer, likewise
    double ridges;          ///< the height of ridges along bones, around which there are `ridge_count`; 0 for none
    double ridge_count;
    double low[3], high[3]; ///< a box around it, as parts are added
} blended_body;

/// A blended_body without parts.
void blended_body_begin(blended_body *body);
/// Add a bone. Returns the part, to be changed further.
blended_body_part *blended_body_round_cone(blended_body *body, const double a[3], const double b[3], double radius_a,
                                           double radius_b, double blend);
/// Add an ellipsoid whose axes are those of space.
blended_body_part *blended_body_ellipsoid(blended_body *body, const double middle[3], double x, double y, double z,
                                          double blend);
/// Add a ring across a unit vector.
blended_body_part *blended_body_ring(blended_body *body, const double middle[3], const double across[3], double radius,
                                     double tube, double blend);
/// Add a box of half the widths x, y and z, whose axes are those of space.
blended_body_part *blended_body_box(blended_body *body, const double middle[3], double x, double y, double z,
                                    double rounding, double blend);
/// Turn a part's axes by angles about x, then y, then z.
void blended_body_turn(blended_body_part *part, double x, double y, double z);

/// A solid_function of a blended_body.
double blended_body_value(const void *context, const double point[3]);

#endif
