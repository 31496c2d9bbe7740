#ifndef BATTEN_RESEARCH_MASK_SWEEP_H
#define BATTEN_RESEARCH_MASK_SWEEP_H

#include "batten/research/curve_analysis.h"

BAT_C_BEGIN

/// @file
/// Smoothness over a family of masks: for which parameters the limits are smooth, with proofs for whole intervals.

/// A family of masks with one parameter. Coefficients must depend on it affinely, as a + parameter b.
typedef bat_mask (*bat_mask_family)(void *context, double parameter);

typedef struct bat_mask_sweep_options
{
    double begin;
    double end;
    size_t smoothness; ///< the k of C^k; 1 by default
    double tolerance;  ///< undecided intervals are halved down to this length; 0 stands for (end - begin) / 2^15
    bat_mask_analyze_options analysis; ///< of each interval
    bat_progress progress;
} bat_mask_sweep_options;

/// The default options.
BAT_API bat_mask_sweep_options bat_mask_sweep_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mask_sweep_fields;

/// Parameters from begin to end, both included, with one verdict for all of them. A single parameter has begin = end, and
/// then its verdict goes before those of the intervals beside it.
typedef struct bat_mask_interval
{
    double begin;
    double end;
    bat_analysis_verdict verdict; ///< whether limits are C^k
} bat_mask_interval;

/// For which parameters of a family the limits are C^k, proven for whole intervals, not samples: a polytope that maps into
/// itself under the matrices of both ends of an interval does so under all between.
///
/// @param intervals receives an array in rising order that covers the range; release it with free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT for an option out of range or an invalid mask; BAT_UNSUPPORTED for a family that is
///         not affine or changes its support, BAT_CANCELLED, BAT_NO_CONVERGENCE or BAT_NO_MEMORY
BAT_API bat_status bat_mask_sweep(bat_mask_family family, void *context, const bat_mask_sweep_options *options,
                                  bat_mask_interval **intervals, size_t *count, bat_error *error);

BAT_C_END

#endif
