#ifndef BATTEN_SPACE_H
#define BATTEN_SPACE_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// Riemannian manifolds behind one interface.
///
/// A space is a plain struct of sizes and functions. The library makes the usual ones; a user defines another by filling a
/// bat_space. Points and tangent vectors are arrays of `point_dim` and `tangent_dim` doubles, in coordinates of the space's
/// own choice. No code outside of the space interprets them.

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
    double weight;          ///< a parameter of the space: the weight of translations in bat_rigid()
    const void *parameters; ///< further parameters of the space; not used by the library

    /// Null for a point of the space, else the reason in a few words ("not of unit length").
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
    /// Optional, for tests and studies only. A random point: uniform in spaces of finite volume, else from a documented
    /// distribution.
    void (*random_point)(const bat_space *space, bat_random *random, double *point);
    /// Optional: the point at share `t` of the shortest geodesic from `p` to `q` (any real t, 0 gives p, 1 gives q).
    /// Null means exp(t log).
    bat_status (*geodesic)(const bat_space *space, const double *p, const double *q, double t, double *point);
    /// Optional: exp(), log() and transport() of `count` rows, for functions whose call is what costs. A failure need not
    /// tell the row: rows are then done one by one.
    bat_status (*exp_rows)(const bat_space *space, const double *p, const double *tangents, size_t count, double *q);
    bat_status (*log_rows)(const bat_space *space, const double *p, const double *q, size_t count, double *tangents);
    bat_status (*transport_rows)(const bat_space *space, const double *p, const double *q, const double *tangents,
                                 size_t count, double *transported);
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
/// The mean radius of the Earth in metres, to convert lengths on the unit sphere: R1 = (2 a + b) / 3 of GRS 80 (Moritz,
/// Geodetic Reference System 1980, Journal of Geodesy 74, 2000).
#define BAT_EARTH_RADIUS 6371008.7714
/// The hyperbolic plane, curvature -1, as the Poincaré disk. Points are 2 numbers of length below 1. Tangent vectors are 2
/// numbers in the orthonormal frame that the Möbius translation z -> p + z brings from the origin: their Euclidean length
/// is their Riemannian length. Oriented. Random points are uniform by area in the disk of hyperbolic radius 3.
BAT_API bat_space bat_disk(void);

/// A space by name: "plane", "euclidean", "sphere", "disk", "rotation", "rigid" (of weight 1), "spd" or "hyperbolic".
/// `point_dim` is needed by "euclidean", "sphere" and "hyperbolic", where 0 stands for 3, and by "spd", where 0 stands for
/// 6; for the others it must be 0 or agree.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT for an unknown name or a `point_dim` that does not fit
BAT_API bat_status bat_space_by_name(const char *name, size_t point_dim, bat_space *space, bat_error *error);
/// The spaces by name.
extern BAT_API const bat_family bat_space_family;

/// The point at share `t` of the geodesic from `p` to `q`: the space's own geodesic() or exp(t log).
BAT_API bat_status bat_space_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point);

/// @name Batch forms
/// Row i of each array is one point or tangent vector. On failure `error->index` is the first row at fault and the rows
/// before it are done.
/// @{

/// Check a space and points of it: no function is missing that is not optional, and dimensions are 1 … BAT_SPACE_MAX_DIM.
/// The injectivity radius is positive. Then fault() of every point. A `count` of 0 checks the space alone: a self-test for
/// spaces of a user.
/// @return BAT_OK, BAT_INVALID_ARGUMENT with what the space lacks, or BAT_INVALID_POINT
BAT_API bat_status bat_space_check(const bat_space *space, const double *points, size_t count, bat_error *error);
/// The nearest points of the space: project().
/// @return BAT_OK or BAT_INVALID_POINT
BAT_API bat_status bat_space_project(const bat_space *space, const double *coordinates, size_t count, double *points,
                                     bat_error *error);
/// Geodesic distances of rows of `p` and `q`.
BAT_API void bat_space_distances(const bat_space *space, const double *p, const double *q, size_t count, double *distances);
/// Tangent vectors at rows of `p` to rows of `q`: log().
/// @return BAT_OK or BAT_CUT_LOCUS
BAT_API bat_status bat_space_logs(const bat_space *space, const double *p, const double *q, size_t count, double *tangents,
                                  bat_error *error);
/// End points of geodesics: exp().
/// @return BAT_OK or BAT_INVALID_POINT
BAT_API bat_status bat_space_exps(const bat_space *space, const double *p, const double *tangents, size_t count, double *q,
                                  bat_error *error);
/// Parallel transport from rows of `p` to rows of `q`: transport().
/// @return BAT_OK or BAT_CUT_LOCUS
BAT_API bat_status bat_space_transports(const bat_space *space, const double *p, const double *q, const double *tangents,
                                        size_t count, double *transported, bat_error *error);
/// Points at `shares` of geodesics: bat_space_geodesic().
/// @return BAT_OK, BAT_CUT_LOCUS or BAT_INVALID_POINT
BAT_API bat_status bat_space_geodesics(const bat_space *space, const double *p, const double *q, const double *shares,
                                       size_t count, double *points, bat_error *error);
/// @}

// Spaces beyond R^n, the sphere and the disk: rotations, rigid motions, tensors, hyperbolic space, products.

/// Rotations of R^3, SO(3), with the metric in which the distance is the angle from one to the other.
///
/// Points are unit quaternions (w, x, y, z), of unit length to 1e-9; q and -q are the same rotation. exp() and geodesic() go
/// on from the sign of `p`, so that quaternions along a curve do not jump. A tangent vector is the rotation vector in the
/// moving body's frame: exp_p(v) = p (cos|v|/2, sin|v|/2 v/|v|), and distances are lengths of rotation vectors. Half a turn
/// is the cut locus, BAT_CUT_LOCUS from 1e-14 short of it. Random points are uniform.
BAT_API bat_space bat_rotation(void);

/// @name Ways to write a rotation
/// Matrices are 9 numbers, row-major, and act on columns: x -> R x. Quaternions are (w, x, y, z).
/// @{

/// The quaternion with w >= 0 of a rotation matrix.
/// @return BAT_OK, or BAT_INVALID_POINT when the matrix is not finite, not orthogonal to 1e-9, or a reflection
BAT_API bat_status bat_rotation_from_matrix(const double *matrix, double *quaternion, bat_error *error);
/// The quaternion with w >= 0 of the rotation nearest to a matrix, in the sum of squared differences: for matrices that were
/// rounded in a file. (The eigenvector of Davenport's matrix; Keat 1977.)
/// @return BAT_OK, or BAT_INVALID_POINT when the matrix is not finite or no single rotation is nearest
BAT_API bat_status bat_rotation_nearest(const double *matrix, double *quaternion, bat_error *error);
/// The matrix of a quaternion other than zero, which need not be of unit length.
BAT_API void bat_rotation_to_matrix(const double *quaternion, double *matrix);
/// The quaternion of the rotation by |vector| radians about `vector`.
/// @return BAT_OK, or BAT_INVALID_POINT when the vector is not finite or its squares overflow
BAT_API bat_status bat_rotation_from_vector(const double *vector, double *quaternion, bat_error *error);
/// The rotation vector of length up to pi of a quaternion other than zero; of the two for half a turn, the one along (x, y,
/// z).
BAT_API void bat_rotation_to_vector(const double *quaternion, double *vector);
/// @}

/// Symmetric positive-definite n x n matrices (tensors) with the affine-invariant metric, |V|_A^2 = trace(A^-1 V A^-1 V):
/// distances are the same after A -> G A G^T for every invertible G, and after A -> A^-1 (Pennec, Fillard and Ayache 2006).
///
/// Points are the n (n + 1) / 2 numbers of the upper triangle, row by row: xx, xy, xz, yy, yz, zz. Tangent vectors at A = L
/// L^T (L lower triangular, Cholesky) are as many numbers: the upper triangle of S = L^-1 V L^-T, entries off the diagonal
/// times sqrt 2, so that inner products are Euclidean; bat_positive_definite_tangent() and bat_positive_definite_velocity()
/// convert from and to the symmetric matrix V.
///
/// The space has no cut locus. A point is not positive definite when a pivot of its Cholesky factor rounds to zero; what
/// lies outside has no nearest point inside. exp() gives BAT_INVALID_POINT where the result is not positive definite in
/// rounding, distances above 300 are BAT_INVALID_POINT in log(). Random points are exponentials at the identity of normal
/// vectors of variance 1/n a number. `n` is clipped to 1 … BAT_POSITIVE_DEFINITE_MAX_SIDE.
BAT_API bat_space bat_positive_definite(size_t n);

/// The largest matrices of bat_positive_definite().
#define BAT_POSITIVE_DEFINITE_MAX_SIDE 32

/// The tangent vector at a point of a bat_positive_definite() of a symmetric matrix, both by their upper triangle.
/// @return BAT_OK, or BAT_INVALID_POINT when `point` is not positive definite
BAT_API bat_status bat_positive_definite_tangent(const bat_space *space, const double *point, const double *velocity,
                                                 double *tangent);
/// The symmetric matrix, by its upper triangle, of a tangent vector.
/// @return BAT_OK, or BAT_INVALID_POINT when `point` is not positive definite
BAT_API bat_status bat_positive_definite_velocity(const bat_space *space, const double *point, const double *tangent,
                                                  double *velocity);

/// Hyperbolic space of dimension n, curvature -1, as the hyperboloid in R^(n+1): x0 = sqrt(1 + |x|^2).
///
/// Points are x0 and then the n numbers of x; x0 agrees with x to 1e-9 (relative), and only x counts. The apex is (1, 0, …,
/// 0). Tangent vectors are n numbers in the orthonormal frame that the boost from the apex to the point brings along: their
/// Euclidean length is their Riemannian length, and for n = 2 they are those of bat_disk(). Points at distance r from the
/// apex are stored to about 1e-16 e^r / 2, to which distances between them are accurate; the distance from the apex keeps
/// its relative accuracy up to 345, beyond which exp() gives BAT_INVALID_POINT. Random points are exponentials at the apex
/// of normal vectors of variance 1/n a number. `n` is clipped to 1 … BAT_SPACE_MAX_DIM - 1.
BAT_API bat_space bat_hyperbolic(size_t n);

/// The factors of a product of spaces. The caller keeps it, and what it points to, as long as the product is used.
typedef struct bat_product_factors
{
    const bat_space *spaces; ///< `count` of them
    const double *weights;   ///< what each factor's lengths are multiplied by; null for ones
    size_t count;            ///< at least 1
} bat_product_factors;

/// The product of spaces: a point is one of each factor, one after the other, and so is a tangent vector;
/// distance^2 = sum over the factors of (weight distance)^2. Geodesics and transport go factor by factor.
/// @param factors becomes the product's `parameters`; it is not copied
/// @return BAT_OK, BAT_INVALID_ARGUMENT (no factor, a weight not positive and finite) or BAT_TOO_LARGE (more than
///         BAT_SPACE_MAX_DIM coordinates)
BAT_API bat_status bat_product(const bat_product_factors *factors, bat_space *product, bat_error *error);

/// Rigid motions of R^3, SE(3), as the product of translations and rotations, with a weight on translations:
/// distance^2 = (weight |t_q - t_p|)^2 + angle^2. The weight is in radians per unit of length.
///
/// Points are 7 numbers: translation x, y, z, then quaternion w, x, y, z (trajectory files in the TUM format have the
/// translation first, too, but the quaternion's w last). Tangent vectors are 6: velocity in the fixed frame, then rotation
/// vector in the body's frame. Along a geodesic the origin of the body goes straight while the body turns evenly about it;
/// the distance is the same after any motion of the fixed frame. Random points are standard normal and uniform.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT for a weight that is not positive and finite
BAT_API bat_status bat_rigid(double translation_weight, bat_space *space, bat_error *error);

BAT_C_END

#endif
