#ifndef BATTEN_MANIFOLD_H
#define BATTEN_MANIFOLD_H

#include "batten/space.h"

BAT_C_BEGIN

/// @file
/// Spaces beyond R^n, the sphere and the disk: rotations, rigid motions, tensors, hyperbolic space, products.

/// Rotations of R^3, SO(3), with the metric in which the distance is the angle from one to the other.
///
/// Points are unit quaternions (w, x, y, z), of unit length to 1e-9; q and -q are the same rotation. exp() and geodesic() go on
/// from the sign of `p`, so that quaternions along a curve do not jump. A tangent vector is the rotation vector in the moving
/// body's frame: exp_p(v) = p (cos|v|/2, sin|v|/2 v/|v|), and distances are lengths of rotation vectors. Half a turn is the cut
/// locus, BAT_CUT_LOCUS from 1e-14 short of it. Random points are uniform.
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
/// The rotation vector of length up to pi of a quaternion other than zero; of the two for half a turn, the one along (x, y, z).
BAT_API void bat_rotation_to_vector(const double *quaternion, double *vector);
/// @}

/// Symmetric positive-definite n x n matrices (tensors) with the affine-invariant metric, |V|_A^2 = trace(A^-1 V A^-1 V): distances
/// are the same after A -> G A G^T for every invertible G, and after A -> A^-1 (Pennec, Fillard and Ayache 2006).
///
/// Points are the n (n + 1) / 2 numbers of the upper triangle, row by row: xx, xy, xz, yy, yz, zz. Tangent vectors at A = L L^T (L lower
/// triangular, Cholesky) are as many numbers: the upper triangle of S = L^-1 V L^-T, entries off the diagonal times sqrt 2, so that
/// inner products are Euclidean; bat_tensor_tangent() and bat_tensor_velocity() convert from and to the symmetric matrix V.
///
/// The space has no cut locus. A point is not positive definite when a pivot of its Cholesky factor rounds to zero; what lies outside
/// has no nearest point inside. exp() gives BAT_INVALID_POINT where the result is not positive definite in rounding, distances above
/// 300 are BAT_INVALID_POINT in log(). Random points are exponentials at the identity of normal vectors of variance 1/n a number.
/// `n` is clipped to 1 … BAT_TENSOR_MAX_SIDE.
BAT_API bat_space bat_positive_definite(size_t n);

/// The largest matrices of bat_positive_definite().
#define BAT_TENSOR_MAX_SIDE 32

/// The tangent vector at a point of a bat_positive_definite() of a symmetric matrix, both by their upper triangle.
/// @return BAT_OK, or BAT_INVALID_POINT when `point` is not positive definite
BAT_API bat_status bat_tensor_tangent(const bat_space *space, const double *point, const double *velocity, double *tangent);
/// The symmetric matrix, by its upper triangle, of a tangent vector.
/// @return BAT_OK, or BAT_INVALID_POINT when `point` is not positive definite
BAT_API bat_status bat_tensor_velocity(const bat_space *space, const double *point, const double *tangent, double *velocity);

/// Hyperbolic space of dimension n, curvature -1, as the hyperboloid in R^(n+1): x0 = sqrt(1 + |x|^2).
///
/// Points are x0 and then the n numbers of x; x0 agrees with x to 1e-9 (relative), and only x counts. The apex is (1, 0, …, 0). Tangent
/// vectors are n numbers in the orthonormal frame that the boost from the apex to the point brings along: their Euclidean length is
/// their Riemannian length, and for n = 2 they are those of bat_disk(). Points at distance r from the apex are stored to
/// about 1e-16 e^r / 2, to which distances between them are accurate; the distance from the apex keeps its relative accuracy up to 345,
/// beyond which exp() gives BAT_INVALID_POINT. Random points are exponentials at the apex of normal vectors of variance 1/n a
/// number. `n` is clipped to 1 … BAT_SPACE_MAX_DIM - 1.
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
/// Points are 7 numbers: translation x, y, z, then quaternion w, x, y, z (trajectory files in the TUM format have the translation first, too,
/// but the quaternion's w last). Tangent vectors are 6: velocity in the fixed frame, then rotation vector in the body's frame.
/// Along a geodesic the origin of the body goes straight while the body turns evenly about it; the distance is the same
/// after any motion of the fixed frame. Random points are standard normal and uniform.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT for a weight that is not positive and finite
BAT_API bat_status bat_rigid(double translation_weight, bat_space *space, bat_error *error);

BAT_C_END

#endif
