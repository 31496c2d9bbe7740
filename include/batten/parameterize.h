#ifndef BATTEN_PARAMETERIZE_H
#define BATTEN_PARAMETERIZE_H

#include "batten/cloud.h"

BAT_C_BEGIN

/// @file
/// Classical parameters of scattered points: each interior point's parameter is a convex combination of its neighbours', the
/// boundary's are given. Floater and Reimers, "Meshless parameterization and surface reconstruction" (2001).

/// The weights of the combination.
typedef enum bat_parameterization
{
    BAT_PARAMETERIZE_UNIFORM,          ///< all neighbours the same
    BAT_PARAMETERIZE_INVERSE_DISTANCE, ///< 1 / distance
    BAT_PARAMETERIZE_SHAPE_PRESERVING, ///< Floater (1997), on the Delaunay neighbours in the local plane
    BAT_PARAMETERIZE_MEAN_VALUE,       ///< Floater (2003), for clouds that were meshes
    BAT_PARAMETERIZATIONS              ///< how many there are
} bat_parameterization;

/// The name, for example "shape-preserving". Never null.
BAT_API const char *bat_parameterization_name(bat_parameterization method);

/// How. Begin with bat_parameterize_defaults().
typedef struct bat_parameterize_options
{
    bat_parameterization method; ///< default shape-preserving
    /// The published neighbourhoods: all points within `radius` in the cloud scaled to the unit box, exact Delaunay triangulation of each
    /// by Qhull; a neighbourhood that is too small, or a point that no chain of neighbours joins to the boundary, is a failure.
    /// False: a radius of each point's own, grown until the neighbourhood holds; default false.
    bool published;
    double radius; ///< above 0; 0: 3 / sqrt(count), eq. (7) of Giannelli et al. (2023); default 0
    int threads;
} bat_parameterize_options;

BAT_API bat_parameterize_options bat_parameterize_defaults(void);

/// Find the interior parameters.
/// @param cloud    with boundary
/// @param boundary boundary_count x 2
/// @param parameters receives count x 2, the boundary's first
/// @return BAT_OK; BAT_UNSUPPORTED for mean values without triangles; BAT_NO_CONVERGENCE with the point whose neighbourhood fails
///         (published neighbourhoods only) or when the system cannot be solved; what bat_cloud_check() returns; BAT_NO_MEMORY
BAT_API bat_status bat_cloud_parameterize(const bat_cloud *cloud, const double *boundary,
                                          const bat_parameterize_options *options, double *parameters, bat_error *error);

/// How well parameters unfold a cloud.
typedef struct bat_parameters_report
{
    size_t folded;     ///< interior points around which the map from local plane to parameters turns over
    size_t first;      ///< the first of them; BAT_NO_INDEX
    size_t outside;    ///< parameters not in the square
    size_t coincident; ///< interior points that share their parameter with another point
    double stretch;    ///< the median over points of the ratio of the local map's singular values, at least 1
} bat_parameters_report;

/// Look for folds: around each interior point the affine map from the local plane to parameters is fitted to its neighbours; its
/// orientation must be that of the boundary.
BAT_API bat_status bat_parameters_check(const bat_cloud *cloud, const double *parameters, bat_parameters_report *report,
                                        bat_error *error);
/// Unfold: folded points and growing rings around them become convex combinations of their neighbours, until no fold is left or a
/// bound on rounds is met.
/// @param parameters count x 2, repaired in place
/// @param report     how they are afterwards; may be null
BAT_API bat_status bat_parameters_repair(const bat_cloud *cloud, double *parameters, bat_parameters_report *report,
                                         bat_error *error);

BAT_C_END

#endif
