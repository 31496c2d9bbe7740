#ifndef BATTEN_CLOUD_PARAMETERIZE_H
#define BATTEN_CLOUD_PARAMETERIZE_H

#include "batten/cloud.h"

BAT_C_BEGIN

/// @file
/// Classical parameters of scattered points: each interior point's parameter is a convex combination of its neighbours', the
/// boundary's are given. Floater and Reimers, "Meshless parameterization and surface reconstruction" (2001).

/// The weights of the combination.
typedef enum bat_cloud_parameterization
{
    BAT_CLOUD_PARAMETERIZE_UNIFORM,            ///< all neighbours the same
    BAT_CLOUD_PARAMETERIZE_INVERSE_DISTANCE,   ///< 1 / distance
    BAT_CLOUD_PARAMETERIZE_SHAPE_PRESERVING,   ///< Floater (1997), on the Delaunay neighbours in the local plane
    BAT_CLOUD_PARAMETERIZE_MEAN_VALUE,         ///< Floater (2003), for clouds that were meshes
    BAT_CLOUD_PARAMETERIZE_STRETCH_MINIMIZING, ///< shape-preserving, then evened out: Yoshizawa, Belyaev and Seidel (2004)
    BAT_CLOUD_PARAMETERIZE_COUNT               ///< how many there are
} bat_cloud_parameterization;

/// A parameterization by name.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names them all
BAT_API bat_status bat_cloud_parameterization_by_name(const char *name, bat_cloud_parameterization *value, bat_error *error);
/// The name. Never null.
BAT_API const char *bat_cloud_parameterization_name(bat_cloud_parameterization value);
/// The table, row by row; `index` from 0 on.
/// @return false past the last
BAT_API bool bat_cloud_parameterization_list(size_t index, bat_choice *choice);

/// How. Begin with bat_cloud_parameterize_defaults().
typedef struct bat_cloud_parameterize_options
{
    bat_cloud_parameterization method; ///< default shape-preserving
    /// The published neighbourhoods: all points within `radius` in the cloud scaled to the unit box, for shape-preserving
    /// weights an exact Delaunay triangulation of each by Qhull, and a direct solution. A point with too few neighbours, or
    /// that no chain of neighbours joins to the boundary, is a failure. Mean values have no neighbourhoods to choose. False:
    /// neighbourhoods of each point's own, which never fail, and a solution by iteration; default false.
    bool published;
    /// In the cloud scaled to the unit box, that is over the longest side of the box around it. 0: 3 / sqrt(count), eq. (7)
    /// of Giannelli et al. (2023), for published neighbourhoods, and as many points as are needed for ours; where it is
    /// given, ours begin there. Default 0.
    double radius;
    int threads; ///< 0: as many as there are processors; the result is the same. Default 0
} bat_cloud_parameterize_options;

BAT_API bat_cloud_parameterize_options bat_cloud_parameterize_defaults(void);
/// Check options; null passes.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field out of range
BAT_API bat_status bat_cloud_parameterize_options_check(const bat_cloud_parameterize_options *options, bat_error *error);

/// Find the interior parameters.
/// @param cloud    with boundary
/// @param boundary boundary_count x 2
/// @param parameters receives count x 2, the boundary's first; within the convex hull of the boundary's, to rounding, and
///                   within their box exactly
/// @return BAT_OK; BAT_UNSUPPORTED for mean values without triangles; BAT_NO_CONVERGENCE with the place in the input of the
/// point whose
///         neighbourhood fails (published neighbourhoods) or that has no triangles (mean values); BAT_INVALID_ARGUMENT for a
///         cloud without boundary, boundary parameters that are not finite, or wrong options; what bat_cloud_check()
///         returns; BAT_NO_MEMORY
BAT_API bat_status bat_cloud_parameterize(const bat_cloud *cloud, const double *boundary,
                                          const bat_cloud_parameterize_options *options, double *parameters,
                                          bat_error *error);

/// How well parameters unfold a cloud.
typedef struct bat_cloud_parameters_report
{
    size_t folded;     ///< interior points around which the map from local plane to parameters turns over
    size_t first;      ///< the first of them; BAT_NO_INDEX
    size_t outside;    ///< parameters not in the square, or not numbers; on the boundary too
    size_t coincident; ///< interior points that share their parameter with another point, to 12 digits after the point
    double stretch;    ///< the median over interior points of the ratio of the local map's singular values, at least 1
} bat_cloud_parameters_report;

/// Look for folds. Around each interior point the affine map from the local plane to parameters is fitted to a neighbourhood
/// that is wide against its thickness; its orientation must be that of the boundary, whose loop has the patch to its left.
/// Normals are made to agree along the tree of neighbours whose planes differ least (Hoppe et al. 1992). Folds smaller than
/// the neighbourhood, of 16 points or a disc of four standard deviations of the noise, are not seen. In a cloud of triangles
/// the corners of triangles that are flat or turned over are counted instead, which misses nothing; its triangles must run
/// alike.
/// @param parameters count x 2
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a cloud without boundary; what bat_cloud_check() returns; BAT_NO_MEMORY
BAT_API bat_status bat_cloud_parameters_check(const bat_cloud *cloud, const double *parameters,
                                              bat_cloud_parameters_report *report, bat_error *error);
/// Unfold: points with faults of any kind and rings around them, which double each round, become averages with
/// shape-preserving weights (of triangles where there are some), until no fault is left. Where the whole interior is an
/// average and folds are left, it moves in steps to averages with uniform weights. The parameters with the fewest folds are
/// kept, the boundary's as they are. Clouds of more than 100,000 points get one round alone.
/// @param parameters count x 2, repaired in place
/// @param report     how they are afterwards; may be null
/// @return as bat_cloud_parameters_check(); BAT_INVALID_ARGUMENT for boundary parameters that are not finite too
BAT_API bat_status bat_cloud_parameters_repair(const bat_cloud *cloud, double *parameters,
                                               bat_cloud_parameters_report *report, bat_error *error);

// Learned parameters of scattered points: Giannelli, Imperatore, Mantzaflaris and Scholz, "BIDGCN: Boundary informed dynamic
// graph convolutional network for adaptive spline fitting of scattered data" (2023), and our own network.

/// A trained network. It does not change, and any number of calls may use it at once.
typedef struct bat_surface_model bat_surface_model;

/// Read a model from a safetensors file: what bat_surface_train() writes, either network. Of a checkpoint the best weights
/// so far.
/// @param model receives the model; release it with bat_surface_model_free()
/// @return BAT_OK; BAT_BAD_FILE; BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY; `*model` is untouched on failure
BAT_API bat_status bat_surface_model_read(const char *path, bat_surface_model **model, bat_error *error);
/// The model that comes with the library (weights/surface.md).
BAT_API bat_status bat_surface_model_builtin(bat_surface_model **model, bat_error *error);
/// Does nothing to null.
BAT_API void bat_surface_model_free(bat_surface_model *model);

/// Find the interior parameters of a cloud. They do not depend on the cloud's place and size.
/// @param boundary   boundary_count x 2
/// @param threads    0: as many as OpenMP gives; the result does not depend on it
/// @param parameters receives count x 2, the boundary's first
/// @return BAT_OK; what bat_cloud_check() returns; BAT_INVALID_ARGUMENT for a cloud whose size is not finite; BAT_NO_MEMORY;
/// with our network
///         BAT_INVALID_ARGUMENT for a cloud without boundary or boundary parameters that are not finite, and
///         BAT_NO_CONVERGENCE for such as are beyond all bounds
BAT_API bat_status bat_surface_model_parameterize(const bat_surface_model *model, const bat_cloud *cloud,
                                                  const double *boundary, int threads, double *parameters, bat_error *error);

BAT_C_END

#endif
