#ifndef BATTEN_SPACE_H
#define BATTEN_SPACE_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// Riemannian manifolds behind one interface.
///
/// A space is a plain struct of sizes and functions. The library makes the usual ones (bat_euclidean(), bat_sphere(),
/// bat_disk(); more are in manifold.h); a user makes another by filling a bat_space. Points and tangent vectors are arrays of `point_dim` and
/// `tangent_dim` doubles in whatever coordinates the space's maker chose; nothing outside the space looks inside them.

/// The largest `point_dim` or `tangent_dim` the library handles.
#define BAT_SPACE_MAX_DIM 1024

typedef struct bat_space bat_space;

/// A Riemannian manifold. Every function is given the space itself, so that one function serves a family (R^n for all n).
/// Inputs and outputs may not overlap. Functions marked optional may be null.
struct bat_space
{
    const char *name;       ///< "plane", "euclidean", "sphere", "disk", …
    size_t dimension;       ///< of the manifold: 2 for the sphere of unit vectors in R^3
    size_t point_dim;       ///< numbers that store a point: 3 for that sphere
    size_t tangent_dim;     ///< numbers that store a tangent vector
    double injectivity;     ///< injectivity radius, in the unit of distance(); INFINITY where geodesics never meet again
    double weight;          ///< one number that the maker needs: the weight of translations in bat_rigid()
    const void *parameters; ///< whatever else the maker needs; the library does not touch it

    /// Null when `point` belongs to the space, else a few words that say why not ("not of unit length").
    const char *(*fault)(const bat_space *space, const double *point);
    /// The nearest point of the space in the coordinates' own metric; removes rounding and input error. `coordinates` and
    /// `point` may be the same.
    /// BAT_INVALID_POINT where there is none (the origin, for a sphere).
    bat_status (*project)(const bat_space *space, const double *coordinates, double *point);
    /// Geodesic distance.
    double (*distance)(const bat_space *space, const double *p, const double *q);
    /// The tangent vector at `p` that exp() takes to `q` along the shortest geodesic. BAT_CUT_LOCUS where it is not unique.
    bat_status (*log)(const bat_space *space, const double *p, const double *q, double *tangent);
    /// The point reached from `p` along the geodesic that starts with velocity `tangent`, after unit time.
    /// BAT_INVALID_POINT where it cannot be represented (it rounds to the rim of the disk).
    bat_status (*exp)(const bat_space *space, const double *p, const double *tangent, double *q);
    /// Parallel transport of `tangent` from `p` to `q` along the shortest geodesic. BAT_CUT_LOCUS where it is not unique.
    bat_status (*transport)(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported);
    /// The Riemannian inner product of two tangent vectors at `p`.
    double (*inner)(const bat_space *space, const double *p, const double *u, const double *v);
    /// A random point: uniform where the space has finite volume, else from a fixed distribution that the maker documents.
    void (*random_point)(const bat_space *space, bat_random *random, double *point);
    /// Optional: the point at share `t` of the shortest geodesic from `p` to `q` (any real t, 0 gives p, 1 gives q).
    /// Null means exp(t log).
    bat_status (*geodesic)(const bat_space *space, const double *p, const double *q, double t, double *point);
    /// Optional, oriented surfaces only: the signed exterior angle at `p` of the geodesic polyline `before`, `p`, `after`,
    /// in [-pi, pi], positive for a left turn.
    double (*exterior_angle)(const bat_space *space, const double *before, const double *p, const double *after);
    /// Optional, oriented surfaces only: the apex of the isosceles geodesic triangle over the edge from `p` to `q` whose
    /// base angles are `angle`, left of the edge when positive; |angle| < pi/2. BAT_INVALID_POINT where there is no such
    /// triangle (in the hyperbolic plane, from the angle of parallelism of half the edge on).
    bat_status (*apex)(const bat_space *space, const double *p, const double *q, double angle, double *point);
};

/// Euclidean space R^n with its usual metric; bat_euclidean(2) is named "plane" and is oriented.
/// Points and tangent vectors are n numbers. Random points are standard normal. `n` is clipped to 1 … BAT_SPACE_MAX_DIM.
BAT_API bat_space bat_euclidean(size_t n);
/// The unit sphere S^n in R^(n+1), curvature 1. Points are n + 1 numbers of unit length (to 1e-9), tangent vectors n + 1
/// numbers orthogonal to their point; S^2 is oriented by its outer normal. Random points are uniform.
/// `n` is clipped to 1 … BAT_SPACE_MAX_DIM - 1.
BAT_API bat_space bat_sphere(size_t n);
/// The hyperbolic plane, curvature -1, as the Poincaré disk. Points are 2 numbers of length below 1. Tangent vectors are 2
/// numbers in the orthonormal frame that the Möbius translation z -> p + z brings from the origin: their Euclidean length
/// is their Riemannian length. Oriented. Random points are uniform by area in the disk of hyperbolic radius 3.
BAT_API bat_space bat_disk(void);

/// A space by the name that the program uses: "plane", "euclidean", "sphere", "disk", and of manifold.h "rotation", "rigid" (of weight
/// 1), "spd" and "hyperbolic". `point_dim` is needed by "euclidean", "sphere" and "hyperbolic", where 0 stands for 3, and by "spd",
/// where 0 stands for 6; for the others it must be 0 or agree.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT for an unknown name or a `point_dim` that does not fit
BAT_API bat_status bat_space_by_name(const char *name, size_t point_dim, bat_space *space, bat_error *error);

/// The point at share `t` of the geodesic from `p` to `q`: the space's own geodesic() or exp(t log).
BAT_API bat_status bat_space_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point);

/// @name Batch forms
/// Row i of each array is one point or tangent vector. On failure `error->index` is the first row at fault and the rows
/// before it are done.
/// @{
BAT_API bat_status bat_space_check(const bat_space *space, const double *points, size_t count, bat_error *error);
BAT_API bat_status bat_space_project(const bat_space *space, const double *coordinates, size_t count, double *points,
                                     bat_error *error);
BAT_API void bat_space_distances(const bat_space *space, const double *p, const double *q, size_t count, double *distances);
BAT_API bat_status bat_space_logs(const bat_space *space, const double *p, const double *q, size_t count, double *tangents,
                                  bat_error *error);
BAT_API bat_status bat_space_exps(const bat_space *space, const double *p, const double *tangents, size_t count, double *q,
                                  bat_error *error);
BAT_API bat_status bat_space_transports(const bat_space *space, const double *p, const double *q, const double *tangents,
                                        size_t count, double *transported, bat_error *error);
BAT_API bat_status bat_space_geodesics(const bat_space *space, const double *p, const double *q, const double *shares,
                                       size_t count, double *points, bat_error *error);
/// @}

BAT_C_END

#endif
