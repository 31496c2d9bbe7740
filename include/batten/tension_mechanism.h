#ifndef BATTEN_TENSION_MECHANISM_H
#define BATTEN_TENSION_MECHANISM_H

#include "batten/measure.h"
#include "batten/tension_data.h"

BAT_C_BEGIN

/// @file
/// What a trained network does: section 9 and remark 4 of Ugail and Howard (2026).

/// Where effective tensions are cut off, as published.
#define BAT_TENSION_EFFECTIVE_LEAST (-3.0)
#define BAT_TENSION_EFFECTIVE_GREATEST 1.5
/// Bins of a histogram between them, each 0.1 wide.
#define BAT_TENSION_EFFECTIVE_BINS 45
/// Linear layers of the network.
#define BAT_TENSION_LAYERS 11

/// Effective tensions in one space. That of an insertion is the mu with which eq. (9) would give the network's angle:
///
///     (alpha - B) / (A - B),   A = (delta_j-1 + delta_j+2) / 8,   B = (delta_j + delta_j+1) / 8     (eq. 26)
///
/// Where all four angles are alike A = B and every mu gives the same; near that it takes any value.
typedef struct bat_tension_effective
{
    size_t insertions;   ///< looked at
    size_t undefined;    ///< of them with |A - B| < 1e-6, which count nowhere else
    size_t below, above; ///< of them cut off to BAT_TENSION_EFFECTIVE_LEAST and _GREATEST
    bat_summary summary; ///< as published, after cutting off
    double quantiles[5]; ///< 5, 25, 50, 75 and 95 %, without cutting off
    /// Bin i holds those from LEAST + i / 10 to LEAST + (i + 1) / 10; the first and last also those that were cut off.
    size_t histogram[BAT_TENSION_EFFECTIVE_BINS];
} bat_tension_effective;

/// One space.
typedef struct bat_tension_mechanism_space
{
    bat_tension_effective printed; ///< for eq. (9) with its printed sign, as published
    bat_tension_effective outward; ///< with the other sign, which is right: alpha is replaced by -alpha
    double published_mean;         ///< the paper's, of `printed`
    double published_deviation;    ///< NaN where it has none
    double
        largest_gradient; ///< greatest length, over these insertions, of the gradient of alpha by the 6 features of eq. (17)
    double centre;        ///< alpha for features of 0; theorem 2 wants 0
} bat_tension_mechanism_space;

typedef struct bat_tension_mechanism_report
{
    bat_tension_mechanism_space spaces[BAT_TENSION_SPACE_COUNT];
    double layers[BAT_TENSION_LAYERS]; ///< spectral norms of the linear layers' matrices, in the order of the network
    /// Their product, remark 4's bound. (It passes over what layer norms multiply by, the skips around blocks, GELU's slope of
    /// up to 1.13 and that of the sigmoid at the end of up to 0.38.)
    double product;
} bat_tension_mechanism_report;

/// How to look. Begin with bat_tension_mechanism_defaults().
typedef struct bat_tension_mechanism_options
{
    size_t curves; ///< of each space's validation curves, the first; at least 1; default 60, as published
    size_t levels; ///< whose insertions count, 1 to 10; default 3, with which the published means come out nearest
    bat_progress progress;
} bat_tension_mechanism_options;

/// The options' default values.
BAT_API bat_tension_mechanism_options bat_tension_mechanism_defaults(void);

/// Refine validation curves by a network and look at every insertion; and estimate the network's Lipschitz constant, by power
/// iteration on each layer. While it runs, OpenBLAS works on one thread in the whole process.
///
/// @param path    a file of the published recipe, as for bat_tension_model_read(); null for the network that the library holds
/// @param options null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_BAD_FILE, BAT_FILE_ACCESS, BAT_NO_CONVERGENCE, BAT_CANCELLED or BAT_NO_MEMORY
BAT_API bat_status bat_tension_mechanism(const char *path, const bat_tension_mechanism_options *options,
                                         bat_tension_mechanism_report *report, bat_error *error);

BAT_C_END

#endif
