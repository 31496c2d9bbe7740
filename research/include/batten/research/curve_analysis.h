#ifndef BATTEN_RESEARCH_CURVE_ANALYSIS_H
#define BATTEN_RESEARCH_CURVE_ANALYSIS_H

#include "batten/curve_scheme.h"

BAT_C_BEGIN

/// @file
/// The limit of a linear subdivision scheme, from its mask: convergence, limit points and tangents, reproduced polynomials,
/// smoothness with proven bounds. `docs/algorithms/curve-analysis.md` explains the mathematics.
///
/// Point i of level k has the parameter (i + shift) / 2^k, with shift = a'(1) / 2. Data p_i = i then have the limit x -> x,
/// where the scheme reproduces straight lines. For a symmetric mask the shift is its centre. The *index parametrization* has
/// no shift: point i at i / 2^k.
///
/// Results hold for the exact mask within rounding of the given one. Bounds include an allowance for rounding; an equality
/// that holds to 1e-12 counts as one.

/// The largest depth of a search.
#define BAT_ANALYSIS_MAX_DEPTH 24
/// Bounds within this share of a power of two count as equal to it.
#define BAT_ANALYSIS_EQUALITY 1e-12

/// Whether a statement holds.
typedef enum bat_analysis_verdict
{
    BAT_ANALYSIS_VERDICT_UNDECIDED, ///< a deeper search may tell
    BAT_ANALYSIS_VERDICT_PROVEN,
    BAT_ANALYSIS_VERDICT_DISPROVEN
} bat_analysis_verdict;

/// The names of the verdicts.
extern BAT_API const bat_family bat_analysis_verdict_family;

/// Options of an analysis: the effort. Begin with bat_mask_analyze_defaults().
typedef struct bat_mask_analyze_options
{
    size_t depth;     ///< the longest products of difference matrices tried, 1 … BAT_ANALYSIS_MAX_DEPTH; 12 by default
    double tolerance; ///< stop when the bounds of the joint spectral radius are this close, relative; 1e-10 by default
    size_t vertices;  ///< the most vertices of the polytope that proves the upper bound; 1000 by default
} bat_mask_analyze_options;

/// The default options.
BAT_API bat_mask_analyze_options bat_mask_analyze_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mask_analyze_fields;

/// An eigenvalue of the local subdivision matrix, with all its eigenvectors.
typedef struct bat_analysis_eigenvalue
{
    double real;
    double imaginary;
    size_t multiplicity; ///< as a zero of the characteristic polynomial
    size_t vector; ///< its right eigenvectors are rows vector … vector + vector_count - 1 of bat_analysis::eigenvectors
    size_t vector_count; ///< dimension of the eigenspace; below the multiplicity when the matrix cannot be diagonalized
} bat_analysis_eigenvalue;

/// The result of bat_mask_analyze().
typedef struct bat_analysis
{
    /// @name The symbol a(z) = sum a(k) z^k = (1 + z)^multiplicity quotient(z)
    /// @{
    bat_mask mask; ///< without zeros at its ends
    size_t multiplicity;
    bat_mask quotient;
    double remainder; ///< the largest coefficient of what the division left, at rounding level
    bool is_interpolatory;
    bool is_symmetric;
    double shift;               ///< a'(1) / 2, where the mask's centre lies
    size_t generation_degree;   ///< polynomials up to this degree are limits of polynomial data: multiplicity - 1
    size_t reproduction_degree; ///< and are limits of their own values at the points' parameters
    /// @}

    /// @name The local subdivision matrix
    /// Points matrix_first … matrix_first + matrix_size - 1 are the smallest set that determines itself on the next level.
    /// They determine the limit at 0 of the index parametrization: a vertex for four-point, the middle of an edge for
    /// Chaikin. Entry (i, j) is a(i - 2 j); see also Alam 2025, sections 3.2, 4.2 and 5.2.
    /// @{
    int matrix_first;
    size_t matrix_size;
    double *matrix;                       ///< matrix_size x matrix_size, row-major
    bat_analysis_eigenvalue *eigenvalues; ///< of falling modulus
    size_t eigenvalue_count;              ///< distinct ones
    double *eigenvectors; ///< rows of matrix_size complex numbers (real part, imaginary part), largest entry 1
    /// @}

    bat_analysis_verdict converges; ///< to a continuous limit, for every data

    /// @name Stencils; their count is 0 unless the scheme is proven to converge
    /// @{
    bat_mask_stencil limit;   ///< limit point at 0 of the index parametrization
    bat_mask_stencil tangent; ///< derivative there with respect to the parameter; count 0 where the matrix does not give one
    bat_mask_stencil vertex;  ///< limit point at the parameter of point 0: bat_mask_limit_stencil()
    /// @}

    /// @name Smoothness
    /// The limit functions have Hölder exponent -log2(radius): their derivative of order l < exponent satisfies
    /// |f(x) - f(y)| <= C |x - y|^e for every e < min(1, exponent - l).
    /// @{
    double radius_lower; ///< bounds of the joint spectral radius of the two matrices of the quotient
    double radius_upper;
    char product[BAT_ANALYSIS_MAX_DEPTH + 1]; ///< the product of them, as 0s and 1s, that gives the lower bound
    size_t depth;                             ///< products up to this length were tried
    bool is_stable;        ///< integer shifts of the basic limit function are proven stable, so that upper bounds are valid
    double exponent_lower; ///< proven: -log2(radius_upper)
    double exponent_upper; ///< proven: -log2(radius_lower); INFINITY unless the scheme is stable
    int smooth_proven;     ///< the largest k with limits proven C^k; -1 for none
    int smooth_disproven;  ///< the smallest k with limits proven not to be C^k in general; -1 for none
    /// Whether the derivative of order smooth_proven is Lipschitz continuous, which an exponent of 1 does not tell.
    bat_analysis_verdict lipschitz;
    /// @}
} bat_analysis;

/// Analyse the scheme of a mask, which must sum to 1 over its even indices and over its odd ones.
/// @param options null for the defaults
/// @param analysis receives the result; release it with bat_analysis_free()
/// @return BAT_OK, whatever the verdicts; BAT_INVALID_ARGUMENT for a malformed mask or an option out of range,
///         BAT_NO_CONVERGENCE when an eigenvalue iteration fails, or BAT_NO_MEMORY; `analysis` is untouched on failure
BAT_API bat_status bat_mask_analyze(const bat_mask *mask, const bat_mask_analyze_options *options, bat_analysis *analysis,
                                    bat_error *error);
/// Free what an analysis owns and make it empty.
BAT_API void bat_analysis_free(bat_analysis *analysis);

/// Bounds of the Hölder exponent of the derivative of an order, both between 0 and 1.
/// @return false when limits are not proven to have a continuous derivative of that order
BAT_API bool bat_analysis_derivative_exponent(const bat_analysis *analysis, size_t order, double *lower, double *upper);

/// The mask that refines the differences of an order, a(z) / (1 + z)^order: with d_i = p_i - p_(i-1) for order 1.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT for a malformed mask or an order above the multiplicity of 1 + z
BAT_API bat_status bat_mask_difference(const bat_mask *mask, size_t order, bat_mask *difference, bat_error *error);

/// Values of the basic limit function, the limit of the data 1 at point 0 and 0 elsewhere, in the index parametrization.
typedef struct bat_basis
{
    double *values; ///< values[i] is the value at first + i / 2^level
    size_t count;   ///< (last - first) 2^level + 1
    size_t level;
    int first; ///< the function vanishes outside first … last
    int last;
} bat_basis;

/// Sample the basic limit function at multiples of 2^-level: exact values at the integers, refined by the scheme.
/// @return as bat_mask_limit_stencil(), and BAT_TOO_LARGE
BAT_API bat_status bat_mask_basis(const bat_mask *mask, size_t level, bat_basis *basis, bat_error *error);
/// Free what a basis owns and make it empty.
BAT_API void bat_basis_free(bat_basis *basis);

BAT_C_END

#endif
