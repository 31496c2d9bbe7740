#ifndef BATTEN_CURVE_MEASURE_H
#define BATTEN_CURVE_MEASURE_H

#include "batten/curve.h"

BAT_C_BEGIN

/// @file
/// Distances between curves, the fairness of curves, and both over sets: Ugail and Howard (2026), sections 3.2 and 3.5.

/// The default of bat_curve_measure_options::bending_offset. (The paper prints only "epsilon".)
#define BAT_CURVE_BENDING_OFFSET 1e-7

/// Options of measures. Begin with bat_curve_measure_defaults().
typedef struct bat_curve_measure_options
{
    /// Geodesic distances. Default false: Euclidean distances of the stored coordinates ("chordal"), in the disk too, as in
    /// the paper's figures.
    bool geodesic;
    /// Distances to the other curve's edges, as chords, instead of its vertices, so that they do not depend on how densely
    /// it is sampled. Chordal only. Default false, as in the paper.
    bool to_segments;
    /// Added to the mean edge length in the bending energy, in the unit of the space; 0 or more. Default
    /// BAT_CURVE_BENDING_OFFSET.
    double bending_offset;
    int threads;           ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress; ///< of comparisons and of sets; default: none
} bat_curve_measure_options;

/// The options' default values.
BAT_API bat_curve_measure_options bat_curve_measure_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_curve_measure_fields;

/// Distances between two curves. A point's distance is that to the nearest vertex (or edge) of the other curve.
typedef struct bat_curve_distance
{
    double mean_nn;               ///< mean over the points of the first curve (eq. 10)
    double mean_nn_from_second;   ///< mean over the points of the second curve
    double mean_symmetric;        ///< half the sum of the two (eq. 19)
    double hausdorff_from_first;  ///< greatest over the points of the first curve
    double hausdorff_from_second; ///< greatest over the points of the second curve
    double hausdorff;             ///< the greater of the two (eq. 11)
    size_t farthest_from_first;   ///< the point of the first curve where hausdorff_from_first is reached, the first such
    size_t farthest_from_second;  ///< the point of the second curve where hausdorff_from_second is reached, the first such
} bat_curve_distance;

/// Measure the distances of two curves from each other, in O(n log n). Coordinates may have any size up to DBL_MAX / 2:
/// squares neither overflow nor underflow.
///
/// @param first, second at least one point each; geodesic distances: in the same space; else with equally many coordinates
/// @param options       null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT (no points, spaces that differ); BAT_INVALID_POINT with the index of a point that is
///         not finite, beyond DBL_MAX / 2, not in its space, or whose distance overflows; BAT_UNSUPPORTED (geodesic
///         distances to edges); BAT_NO_MEMORY or BAT_CANCELLED; `distance` is untouched on failure
BAT_API bat_status bat_curve_compare(const bat_curve *first, const bat_curve *second,
                                     const bat_curve_measure_options *options, bat_curve_distance *distance,
                                     bat_error *error);

/// bat_curve_compare() of first[i] with second[i] for many pairs. Threads share the pairs, or the points of each where there
/// are few pairs.
/// @param distances    receives `count` results; some of them on failure
/// @param error     its `curve` is the first pair at fault
BAT_API bat_status bat_curves_compare(const bat_curve *first, const bat_curve *second, size_t count,
                                      const bat_curve_measure_options *options, bat_curve_distance *distances,
                                      bat_error *error);

/// Measures of fairness.
typedef struct bat_curve_fairness_values
{
    double bending; ///< mean over the vertices of (exterior angle / (mean length of the two edges + offset))^2 (eq. 5)
    double g1;      ///< largest absolute exterior angle, radians (eq. 4)
    double length;  ///< sum of the edges' lengths
} bat_curve_fairness_values;

/// Measure the fairness of a curve. Angles and lengths are those of the space. Spaces above dimension 2 have no signed
/// angles: there they are the angles between the edges, in 0 … pi. The ends of an open curve have no angle and are not in
/// the mean. A point equal to the one before it is skipped. A curve without an angle has both measures 0.
///
/// @param curve   at least one point, each in its space
/// @param options null for the defaults; only bending_offset counts
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_INVALID_POINT (also where the length or the bending energy overflows) or
///         BAT_CUT_LOCUS (antipodal neighbours), with the index of the point; `fairness` is untouched on failure
BAT_API bat_status bat_curve_fairness(const bat_curve *curve, const bat_curve_measure_options *options,
                                      bat_curve_fairness_values *fairness, bat_error *error);

/// bat_curve_fairness() for many curves, which the threads share.
/// @param fairness     receives `count` results; some of them on failure
/// @param error    its `curve` is the first one at fault
/// @return as bat_curve_fairness(), and BAT_CANCELLED
BAT_API bat_status bat_curves_fairness(const bat_curve *curves, size_t count, const bat_curve_measure_options *options,
                                       bat_curve_fairness_values *fairness, bat_error *error);

/// The measures of a curve, in the order of a report.
/// @param curves  1: the fields of bat_curve_fairness_values; 2: those of bat_curve_distance
/// @param measure receives row `index` of the table
/// @return false past the last row
BAT_API bool bat_curve_measures(size_t curves, size_t index, bat_measure *measure);

/// Whether a curve is simple: its edges are geodesics that meet nowhere but at the vertices that neighbours share. Edges
/// that touch, and neighbours that fold back onto each other, make it not simple. Points that repeat their neighbour do not.
/// An open curve whose last point equals its first is a ring. The answer is exact for the coordinates as they are stored,
/// except that a coordinate below 2^-480 (plane; of the largest one where that is out of range), 2^-300 (sphere) or 2^-200
/// (disk) counts as 0. O(n log n) for curves whose pieces lie near in space where they are near in order.
///
/// @param curve  at least one point, in the plane, on the sphere S^2 or in the disk
/// @param simple receives the answer; untouched on failure
/// @return BAT_OK; BAT_UNSUPPORTED in other spaces; BAT_INVALID_ARGUMENT; BAT_INVALID_POINT or BAT_CUT_LOCUS with the index
/// of
///         the point; or BAT_NO_MEMORY
BAT_API bat_status bat_curve_is_simple(const bat_curve *curve, bool *simple, bat_error *error);

/// bat_curve_is_simple() for many curves, each by itself. Threads share the curves.
/// @param options      null for the defaults; only threads and progress count
/// @param simple       receives `count` answers; some of them on failure
/// @param error    its `curve` is the first one at fault
/// @return as bat_curve_is_simple(), and BAT_CANCELLED
BAT_API bat_status bat_curves_are_simple(const bat_curve *curves, size_t count, const bat_curve_measure_options *options,
                                         bool *simple, bat_error *error);

/// The number of edges that a refinement left straight: its points lie within 1/1400 of the edge's length of it. An edge
/// whose end is no point of `fine` does not count, nor do those after the seventeenth.
/// @param fine the refined curve; it begins with the first point of `coarse`
BAT_API size_t bat_curve_straight_edges(const bat_curve *coarse, const bat_curve *fine);

/// Statistics of a set of numbers.
typedef struct bat_curve_summary
{
    size_t count;
    double mean;
    double deviation; ///< standard deviation of the set itself (divisor `count`)
    double median;    ///< half the sum of the middle two when the count is even
    double least, greatest;
} bat_curve_summary;

/// Summarize a set of numbers. Finite numbers have a finite mean, deviation and median, however large they are.
/// @param values at least one, none of them NaN
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY
BAT_API bat_status bat_curve_summarize(const double *values, size_t count, bat_curve_summary *summary, bat_error *error);

BAT_C_END

#endif
