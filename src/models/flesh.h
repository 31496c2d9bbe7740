#ifndef MODELS_FLESH_H
#define MODELS_FLESH_H

#include "models/noise.h"

/// @file
/// Bodies of bones and muscles that grow together smoothly, with a skin of noise: what creatures are made of.

enum
{
    FLESH_MOST_PARTS = 96
};

typedef enum flesh_kind
{
    FLESH_BONE,      ///< a round cone from one ball to another
    FLESH_ELLIPSOID, ///< with its own axes
    FLESH_TORUS,     ///< a ring
    FLESH_BOX        ///< with its own axes and rounded edges
} flesh_kind;

/// One part. Its own function is a distance, or nearly.
typedef struct flesh_part
{
    flesh_kind kind;
    double a[3], b[3]; ///< the ends of a bone; of others, a is the middle; of a box, b[0] is the rounding
    double axes[3][3]; ///< of ellipsoids and rings: unit vectors; a ring lies across axes[2]
    double radius
        [3];      ///< of a bone's two ends; of an ellipsoid or box, half of its width along its axes; of a ring and its tube
    double blend; ///< the width over which the part grows together with those before
    bool hollow;  ///< taken away rather than added
} flesh_part;

/// The least of all parts, blended, moved by the noise.
typedef struct flesh
{
    flesh_part parts[FLESH_MOST_PARTS];
    size_t count;
    noise_sum skin;  ///< amplitude 0 for none
    noise_sum folds; ///< a second layer, likewise
    double ridges;   ///< the height of ridges along bones, around which there are `ridge_count`; 0 for none
    double ridge_count;
    double low[3], high[3]; ///< a box around it, as parts are added
} flesh;

/// A flesh without parts.
void flesh_begin(flesh *body);
/// Add a bone. Returns the part, to be changed further.
flesh_part *flesh_bone(flesh *body, const double a[3], const double b[3], double radius_a, double radius_b, double blend);
/// Add an ellipsoid whose axes are those of space.
flesh_part *flesh_ellipsoid(flesh *body, const double middle[3], double x, double y, double z, double blend);
/// Add a ring across a unit vector.
flesh_part *flesh_ring(flesh *body, const double middle[3], const double across[3], double radius, double tube,
                       double blend);
/// Add a box of half the widths x, y and z, whose axes are those of space.
flesh_part *flesh_box(flesh *body, const double middle[3], double x, double y, double z, double rounding, double blend);
/// Turn a part's axes by angles about x, then y, then z.
void flesh_turn(flesh_part *part, double x, double y, double z);

/// A solid_function of a flesh.
double flesh_value(const void *context, const double point[3]);

#endif
