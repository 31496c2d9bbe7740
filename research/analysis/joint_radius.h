#pragma once

#include "base/memory.h"
#include "batten/base.h"

/// @file
/// Proven bounds of the joint spectral radius of a few matrices: the largest growth rate of their products,
/// lim over k of max |A_1 … A_k|^(1/k) over all choices of the factors.

/// The longest products looked at.
#define JOINT_RADIUS_MAX_LENGTH 24
/// Products that tie for the largest growth and are remembered.
#define JOINT_RADIUS_LEADERS 8

/// `count` square matrices of side `dimension`, one after the other, row-major.
typedef struct matrix_set
{
    size_t dimension;
    size_t count;
    double *entries;
} matrix_set;

/// Make room for matrices, and load what multiplies them.
/// @return BAT_OK, BAT_NO_MEMORY or the failure of blas_load()
bat_status matrix_set_make(size_t dimension, size_t count, matrix_set *set, bat_error *error);
void matrix_set_free(matrix_set *set);
static inline double *matrix_set_at(const matrix_set *set, size_t index)
{
    return set->entries + index * set->dimension * set->dimension;
}

/// Scale coordinates by powers of two, the same for all matrices, for similar sums of rows and columns (Osborne 1960).
void matrix_set_balance(matrix_set *set);

/// A product by the indices of its factors, leftmost first.
typedef struct matrix_word
{
    unsigned char letters[JOINT_RADIUS_MAX_LENGTH];
    size_t length;
    double growth; ///< (spectral radius)^(1 / length), as computed
} matrix_word;

/// product = letters[0] letters[1] …; `other` is room for a matrix.
/// @return how far it may be from the product of factors that are within `distance` of these, Frobenius norm, with rounding
double matrix_word_product(const matrix_set *set, const matrix_word *word, double distance, double *product, double *other);

typedef struct joint_radius_limits
{
    size_t depth;       ///< longest product for the lower bound, twice the rounds of growth for the upper; 1 … 24
    size_t vertices;    ///< of the polytope
    double tolerance;   ///< enough when upper <= (1 + tolerance) lower
    double stop_below;  ///< enough when upper is below this; 0 for never
    double stop_from;   ///< enough when lower is at least this; HUGE_VAL for never
    double known_upper; ///< an upper bound found otherwise, or HUGE_VAL
} joint_radius_limits;

/// lower <= joint spectral radius <= upper, both with an allowance for rounding in them.
typedef struct joint_radius
{
    double lower;
    double upper;
    matrix_word leaders[JOINT_RADIUS_LEADERS]; ///< the products that gave `lower`, the first one, and their near ties
    size_t leader_count;
    size_t length;   ///< every product up to this length was tried
    size_t vertices; ///< of the last polytope
} joint_radius;

/// Bound the joint spectral radius from both sides.
///
/// Lower: the spectral radius of every product up to `depth` factors, one for each class of cyclic shifts (Lyndon words),
/// Daubechies and Lagarias 1992. Upper: a polytope that starts with the leading eigenvectors of the best products and grows
/// by the images of its vertices, which is its own proof: the joint spectral radius is at most the largest norm of an image
/// of a vertex (Guglielmi and Protasov 2013). Deeper searches never give wider bounds.
///
/// @return BAT_OK, BAT_NO_MEMORY or BAT_NO_CONVERGENCE
bat_status joint_radius_bound(const matrix_set *set, const joint_radius_limits *limits, joint_radius *result,
                              bat_error *error);

/// A polytope symmetric about the origin, the convex hull of +-v over its vertices v: the unit ball of a norm on R^n.
/// Some listed vertices may lie inside; that costs time only.
typedef struct polytope
{
    memory_pool pool; ///< holds the arrays
    size_t dimension;
    size_t count;
    size_t capacity;
    double *vertices; ///< count x dimension; the first `dimension` are multiples of the unit vectors

    /// The simplex method's state, kept from one norm to the next: `dimension` vertices that span the space, and the inverse
    /// of the matrix that has them as columns.
    size_t *basis;
    double *inverse;
    double *scratch;
} polytope;

/// A polytope that grows by the images of its vertices under matrices divided by `rate`, until they all lie inside.
typedef struct polytope_growth
{
    const matrix_set *set;
    double rate;
    polytope hull;
    size_t frontier;       ///< the first vertex whose images have not been looked at
    double largest_inside; ///< the largest norm of an image that was found inside
    bool full;             ///< there was no room for a vertex: further rounds would prove nothing
} polytope_growth;

/// Start from `seed_count` vectors and small multiples of the unit vectors.
/// @param set must outlive the growth
bat_status polytope_growth_make(const matrix_set *set, double rate, const double *seeds, size_t seed_count, size_t capacity,
                                polytope_growth *growth, bat_error *error);
void polytope_growth_free(polytope_growth *growth);

/// One round: measure the images of the newest vertices, then add those outside.
/// @param bound receives rate times the largest norm of an image of a vertex of the polytope as it was before the round: an
///              upper bound of the joint spectral radius
/// @param closed receives whether no image was outside
bat_status polytope_growth_round(polytope_growth *growth, double *bound, bool *closed, bat_error *error);

/// Start a polytope for matrices `set` from the orbits of the leaders of a joint radius under `seed_set`.
/// @param phases   points of half the ellipse of a complex leading eigenvector
/// @param vertices as many as are wanted; fewer where the work would be too much
bat_status joint_radius_growth(const matrix_set *set, const matrix_set *seed_set, const joint_radius *radius, double rate,
                               size_t phases, size_t vertices, polytope_growth *growth, bat_error *error);
