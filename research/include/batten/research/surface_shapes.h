#ifndef BATTEN_RESEARCH_SURFACE_SHAPES_H
#define BATTEN_RESEARCH_SURFACE_SHAPES_H

#include "batten/cloud.h"

BAT_C_BEGIN

/// @file
/// Random clouds, with the parameters at which they were sampled.

/// Options of a random Bézier cloud. Begin with bat_cloud_bezier_defaults().
typedef struct bat_cloud_bezier_options
{
    int degree;      ///< of both parameters, 1 to 15; default 2
    size_t interior; ///< number of interior points, with uniformly distributed parameters; default 1000
    size_t side;  ///< number of points of a side, including both corners, with equally spaced parameters, at least 2; 0: 2 +
                  ///< round(sqrt(interior)), as dense as the interior; default 0
    double noise; ///< standard deviation of Gaussian noise on each coordinate; default 0
    bool turned;  ///< apply a random rotation; default true
} bat_cloud_bezier_options;

/// The options' default values.
BAT_API bat_cloud_bezier_options bat_cloud_bezier_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_cloud_bezier_fields;

/// Sample a tensor-product Bézier surface whose control point (i, j) is drawn from [i/p - 1/(2p), i/p + 1/(2p)] x the same
/// of j x [-1, 1] (Giannelli et al., 2023, section 4.2, there for p = 2).
/// @param random     random stream
/// @param cloud      receives the cloud, boundary first, counter-clockwise in parameters from (0, 0), with corners; release
/// it with
///                   bat_cloud_free()
/// @param parameters receives an array of count x 2 true parameters from malloc(); may be null
BAT_API bat_status bat_cloud_bezier(const bat_cloud_bezier_options *options, bat_random *random, bat_cloud *cloud,
                                    double **parameters, bat_error *error);

/// Sample engineering shapes and simulate scans: "hull" (a ship's side from keel to deck, bow to stern, with knuckle and
/// bulb), "blade" (a twisted and tapered turbine blade, around its leading edge), "scan" (a relief with noise, uneven
/// density and a gap, as from a hand-held scanner). Boundary points come first, with corners; a scan is in random order with
/// unknown boundary.
/// @param points     approximate number of points, at least 200
/// @param parameters receives the true parameters, count x 2, from malloc(); may be null
/// @return BAT_OK; BAT_INVALID_ARGUMENT (an unknown name, too few points); BAT_NO_MEMORY
BAT_API bat_status bat_cloud_shape(const char *name, size_t points, uint64_t seed, bat_cloud *cloud, double **parameters,
                                   bat_error *error);
/// The names of the shapes, terminated by null.
BAT_API const char *const *bat_cloud_shape_names(void);

/// Write a cloud. The ending chooses XYZ, CSV, PLY or OBJ; "-" is standard output in XYZ. The file appears whole or not at
/// all. All formats are text with all digits of the doubles, and hold boundary and corners in remarks at the top. PLY and
/// OBJ also hold the triangles.
/// @return BAT_OK; BAT_INVALID_ARGUMENT for an unknown ending; the failures of bat_cloud_check(); BAT_FILE_ACCESS or
///         BAT_NO_MEMORY
BAT_API bat_status bat_cloud_write(const char *path, const bat_cloud *cloud, bat_error *error);

BAT_C_END

#endif
