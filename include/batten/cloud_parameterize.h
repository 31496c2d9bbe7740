#ifndef BATTEN_CLOUD_PARAMETERIZE_H
#define BATTEN_CLOUD_PARAMETERIZE_H

#include "batten/cloud.h"

BAT_C_BEGIN

/// @file
/// Parameters of scattered points: classical ones and those of networks.
/// The parameter of an interior point is a convex combination of its neighbours' parameters; those of the boundary are
/// given. Source: Floater and Reimers, "Meshless parameterization and surface reconstruction" (2001).

/// The weights of the combination.
typedef enum bat_cloud_parameterization
{
    BAT_CLOUD_PARAMETERIZATION_AUTO,               ///< the default: BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING
    BAT_CLOUD_PARAMETERIZATION_UNIFORM,            ///< equal weights
    BAT_CLOUD_PARAMETERIZATION_INVERSE_DISTANCE,   ///< 1 / distance
    BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING,   ///< Floater (1997), on the Delaunay neighbours in the local plane
    BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE,         ///< Floater (2003), for clouds that were meshes
    BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, ///< shape-preserving, then evened out: Yoshizawa, Belyaev and Seidel
                                                   ///< (2004)
    BAT_CLOUD_PARAMETERIZATION_ISOMETRIC, ///< least symmetric Dirichlet energy of triangles: Rabinovich et al. (2017)
    BAT_CLOUD_PARAMETERIZATION_COUNT      ///< how many there are
} bat_cloud_parameterization;

/// The parameterizations by name.
extern BAT_API const bat_family bat_cloud_parameterization_family;

/// Options of bat_cloud_parameterize(). Begin with bat_cloud_parameterize_defaults().
typedef struct bat_cloud_parameterize_options
{
    bat_cloud_parameterization method; ///< default shape-preserving
    /// True: the published neighbourhoods, all points within `radius`, and a direct solution. Shape-preserving weights use
    /// an exact Delaunay triangulation of each neighbourhood by Qhull. A point with too few neighbours, or without a path to
    /// the boundary, is a failure. Mean values ignore this option. False: adaptive neighbourhoods, which never fail, and an
    /// iterative solution. Default false.
    bool published;
    /// Radius of neighbourhoods, as a share of the longest side of the bounding box. 0: for published neighbourhoods
    /// 3 / sqrt(count), eq. (7) of Giannelli et al. (2023); adaptive ones choose it. Adaptive ones begin with a given
    /// radius. Default 0.
    double radius;
    int threads;           ///< 0 to 1024; 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress; ///< of the rounds of iterative methods; default: none
} bat_cloud_parameterize_options;

/// The default options.
BAT_API bat_cloud_parameterize_options bat_cloud_parameterize_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_cloud_parameterize_fields;

/// Compute the parameters of the interior points.
/// @param cloud      with boundary
/// @param boundary   boundary_count x 2
/// @param options    null for the defaults
/// @param parameters receives count x 2, the boundary's first. They lie within the box of the boundary's, and to rounding
///                   within their convex hull
/// @return BAT_OK; BAT_UNSUPPORTED for mean values without triangles; BAT_NO_CONVERGENCE with the index in the input of a
///         point whose neighbourhood fails or that has no triangles; BAT_INVALID_ARGUMENT for a cloud without boundary,
///         boundary parameters that are not finite, or options out of range; the failures of bat_cloud_check();
///         BAT_NO_MEMORY; `parameters` are untouched where an argument is refused
BAT_API bat_status bat_cloud_parameterize(const bat_cloud *cloud, const double *boundary,
                                          const bat_cloud_parameterize_options *options, double *parameters,
                                          bat_error *error);

/// The quality of parameters.
typedef struct bat_cloud_parameters_report
{
    size_t folded;     ///< interior points where the map from the local plane to parameters reverses orientation
    size_t first;      ///< the first of them; BAT_NO_INDEX
    size_t outside;    ///< parameters outside of the unit square or NaN, the boundary's included
    size_t coincident; ///< interior points whose parameter equals another one to 1e-12
    double stretch;    ///< median over interior points of the ratio of the local map's singular values, at least 1
} bat_cloud_parameters_report;

/// Count folds. An affine map from the local plane to parameters is fitted around each interior point. Its orientation must
/// be that of the boundary, whose loop has the patch to its left. Normals are oriented along the minimum spanning tree of
/// Hoppe et al. (1992). Folds smaller than the neighbourhood are not found: 16 points, or a disk of four standard deviations
/// of the noise. In a cloud with triangles, the corners of flat and reversed triangles are counted instead, which is exact.
/// @param parameters count x 2
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a cloud without boundary; the failures of bat_cloud_check(); BAT_NO_MEMORY
BAT_API bat_status bat_cloud_parameters_check(const bat_cloud *cloud, const double *parameters,
                                              bat_cloud_parameters_report *report, bat_error *error);
/// Remove folds. Faulty points and rings of neighbours around them get shape-preserving averages as parameters. The rings
/// double each round, until no fault is left. If folds remain, the interior moves in steps to averages with equal weights.
/// The result is the round with the fewest folds; boundary parameters stay. Clouds of more than 100,000 points get one
/// round.
/// @param parameters count x 2, repaired in place
/// @param report     the quality afterwards; may be null
/// @return as bat_cloud_parameters_check(); also BAT_INVALID_ARGUMENT for boundary parameters that are not finite
BAT_API bat_status bat_cloud_parameters_repair(const bat_cloud *cloud, double *parameters,
                                               bat_cloud_parameters_report *report, bat_error *error);

// Learned parameters.

/// A trained network. It is constant, and any number of calls may use it at once.
typedef struct bat_surface_model bat_surface_model;

/// Read a model from a safetensors file of `batten train surface --recipe batten`. Of a checkpoint, the best weights are
/// taken. batten/research/networks.h reads published networks too.
/// @param path  null: the model that comes with the library (weights/surface.md)
/// @param model receives the model; release it with bat_surface_model_free()
/// @return BAT_OK; BAT_BAD_FILE, BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY; `*model` is untouched on failure
BAT_API bat_status bat_surface_model_read(const char *path, bat_surface_model **model, bat_error *error);
/// Does nothing to null.
BAT_API void bat_surface_model_free(bat_surface_model *model);

/// Compute the parameters of the interior points with a network. They do not depend on the cloud's position and size.
/// @param boundary   boundary_count x 2
/// @param threads    0: as many as OpenMP gives; the result does not depend on it
/// @param parameters receives count x 2, the boundary's first
/// @return BAT_OK; the failures of bat_cloud_check(); BAT_INVALID_ARGUMENT for a cloud whose size is not finite;
///         BAT_NO_MEMORY. Batten's network also returns BAT_INVALID_ARGUMENT for a cloud without boundary or boundary
///         parameters that are not finite, and BAT_NO_CONVERGENCE for parameters that overflow
BAT_API bat_status bat_surface_model_parameterize(const bat_surface_model *model, const bat_cloud *cloud,
                                                  const double *boundary, int threads, double *parameters, bat_error *error);

BAT_C_END

#endif
