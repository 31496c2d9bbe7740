#ifndef RESEARCH_SHAPES_BLENDED_BODY_H
#define RESEARCH_SHAPES_BLENDED_BODY_H

#include "batten/base.h"

/// @file
/// Implicit bodies by smooth blends of signed distances, with a noise displacement:
///     f(x) = smooth minimum over parts k of d_k(x)  +  noise(x),   the body is f < 0.
/// Noise is gradient noise (Perlin, "Improving noise", 2002); the smooth minimum is cubic (Quilez).

/// Gradient noise with pseudo-random gradients from a seed: zero at integer points, between about -1 and 1, twice
/// continuously differentiable, with gradients up to about 2.
double noise_at(uint64_t seed, double x, double y, double z);

/// Fractal noise: sum over k < octaves of amplitude gain^k noise(2^k frequency x).
typedef struct noise_sum
{
    uint64_t seed;
    double frequency; ///< frequency of the first octave
    double amplitude; ///< amplitude of the first octave
    double gain;      ///< ratio of consecutive amplitudes
    int octaves;
    double ridge; ///< 0: plain noise; positive: ridged noise 1 - 2 |noise|, smoothed over this height
} noise_sum;

/// An upper bound of the absolute value.
double noise_sum_reach(const noise_sum *noise);

double noise_sum_at(const noise_sum *noise, const double point[3]);

enum
{
    BLENDED_BODY_MAX_PARTS = 96
};

typedef enum blended_body_kind
{
    BLENDED_BODY_ROUND_CONE, ///< the convex hull of two balls, approximately
    BLENDED_BODY_ELLIPSOID,  ///< an ellipsoid with arbitrary axes
    BLENDED_BODY_TORUS,      ///< a torus
    BLENDED_BODY_BOX         ///< a box with arbitrary axes and rounded edges
} blended_body_kind;

/// A part, given by its approximate signed distance.
typedef struct blended_body_part
{
    blended_body_kind kind;
    double a[3], b[3]; ///< round cone: centres of both balls; others: a is the centre; box: b[0] is the radius of the edges
    double axes[3][3]; ///< unit vectors; a torus is perpendicular to axes[2]
    double radius[3];  ///< round cone: both radii; ellipsoid, box: half widths along the axes; torus: radius, and radius of
                       ///< the tube
    double blend;      ///< width of the blend with the parts before
    bool subtracted;   ///< subtracted instead of added
} blended_body_part;

/// A blend of parts with noise.
typedef struct blended_body
{
    blended_body_part parts[BLENDED_BODY_MAX_PARTS];
    size_t count;
    noise_sum noise;        ///< displacement; amplitude 0 for none
    noise_sum ridged_noise; ///< a second displacement
    double ridges;          ///< relative height of ridges along round cones; 0 for none
    double ridge_count;     ///< number of ridges around a round cone
    double low[3], high[3]; ///< bounding box of the parts
} blended_body;

/// Initialize a body without parts.
void blended_body_begin(blended_body *body);
/// Add a round cone. Returns the part for further changes.
blended_body_part *blended_body_round_cone(blended_body *body, const double a[3], const double b[3], double radius_a,
                                           double radius_b, double blend);
/// Add an axis-aligned ellipsoid.
blended_body_part *blended_body_ellipsoid(blended_body *body, const double middle[3], double x, double y, double z,
                                          double blend);
/// Add a torus perpendicular to a unit vector.
blended_body_part *blended_body_ring(blended_body *body, const double middle[3], const double across[3], double radius,
                                     double tube, double blend);
/// Add an axis-aligned box with half widths x, y and z.
blended_body_part *blended_body_box(blended_body *body, const double middle[3], double x, double y, double z,
                                    double rounding, double blend);
/// Rotate the axes of a part about x, then y, then z.
void blended_body_turn(blended_body_part *part, double x, double y, double z);

/// The function f of a blended_body, as a solid_function.
double blended_body_value(const void *context, const double point[3]);

#endif
