#ifndef BATTEN_RESEARCH_SURFACE_SHAPES_H
#define BATTEN_RESEARCH_SURFACE_SHAPES_H

#include "batten/cloud.h"

BAT_C_BEGIN

/// @file
/// Clouds of our own making, with the parameters that they were sampled at.

/// A random Bézier cloud. Begin with bat_cloud_bezier_defaults().
typedef struct bat_cloud_bezier_options
{
    int degree;      ///< of both parameters, 1 to 15; default 2
    size_t interior; ///< points inside, uniformly distributed parameters; default 1000
    size_t side;     ///< points of a side, both corners included, equally spaced parameters, at least 2; 0: as dense as the
                 ///< interior, 34 for 1000 (2 + round of the root of `interior`); default 0
    double noise; ///< standard deviation of Gaussian noise on each coordinate; default 0
    bool turned;  ///< turned about a random axis by a random angle; default true
} bat_cloud_bezier_options;

BAT_API bat_cloud_bezier_options bat_cloud_bezier_defaults(void);

/// Sample a tensor-product Bézier surface whose control point (i, j) is drawn from [i/p - 1/(2p), i/p + 1/(2p)] x the same
/// of j x [-1, 1] (Giannelli et al., 2023, section 4.2, there for p = 2).
/// @param random     the stream that all is drawn from
/// @param cloud      receives the cloud, boundary first, counter-clockwise in parameters from (0, 0), with corners; release
/// it with
///                   bat_cloud_free()
/// @param parameters receives an array of count x 2 true parameters from malloc(); may be null
BAT_API bat_status bat_cloud_bezier(const bat_cloud_bezier_options *options, bat_random *random, bat_cloud *cloud,
                                    double **parameters, bat_error *error);

/// Engineering shapes and scans of our own making: "hull" (a ship's side from keel to deck, bow to stern, with knuckle and
/// bulb), "blade" (a turbine blade, twisted and tapered, round its leading edge), "scan" (a relief with noise, uneven
/// density and a gap, like what a hand-held scanner gives). Boundary first, with corners; the scan's order is shuffled and
/// its boundary unknown.
/// @param points     about how many, at least 200
/// @param parameters receives the true parameters, count x 2, from malloc(); may be null
/// @return BAT_OK; BAT_INVALID_ARGUMENT (an unknown name, too few points); BAT_NO_MEMORY
BAT_API bat_status bat_cloud_shape(const char *name, size_t points, uint64_t seed, bat_cloud *cloud, double **parameters,
                                   bat_error *error);
/// Their names, ended by null.
BAT_API const char *const *bat_cloud_shape_names(void);

BAT_C_END

#endif
