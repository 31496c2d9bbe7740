#ifndef BATTEN_RESEARCH_CURVE_STUDY_H
#define BATTEN_RESEARCH_CURVE_STUDY_H

#include "batten/curve_measure.h"
#include "batten/curve_scheme.h"
#include "batten/research/curve_data.h"
#include "batten/research/curve_train.h"

BAT_C_BEGIN

/// @file
/// Tables 1 and 5 of Ugail and Howard (2026), computed anew for every scheme that needs no learning, with both signs of the
/// insertion angle, and for any schemes of one's own, learned ones too. Table 1 also on curves that no training has seen.

/// How to search for a tension. Begin with bat_tension_search_defaults().
typedef struct bat_tension_search_options
{
    bat_curve_scheme scheme; ///< angle-based; all of it stays but the tension; default: outward, not adaptive
    double low, high;        ///< the tensions tried lie in between, ends included; default -0.5 and 0.05, as published
    size_t count;            ///< how many, evenly spaced, at least 2; default 23, steps of 0.025
    size_t levels;           ///< how often the curves are refined; default 5
    int threads;             ///< 0: as many as OpenMP gives; default 0
    bat_progress progress;
} bat_tension_search_options;

/// The options' default values.
BAT_API bat_tension_search_options bat_tension_search_defaults(void);

/// Search the tension whose refined curves are nearest to their truths: the least mean, over the curves, of the mean
/// nearest-neighbour distance (the "oracle" of section 7.1). A best tension at an end of the range may mean that a better
/// one lies outside.
///
/// @param coarse,truth `count` curves each, at least 1
/// @param options      null for the defaults
/// @param tension      receives the best
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_CANCELLED, BAT_NO_MEMORY or what refining or comparing returned
BAT_API bat_status bat_tension_search(const bat_curve *coarse, const bat_curve *truth, size_t count,
                                      const bat_tension_search_options *options, double *tension, bat_error *error);

/// One row: a method in a space, over a set of curves.
typedef struct bat_tension_row
{
    const char *space;  ///< "plane", "sphere" or "disk"
    const char *method; ///< "four-point-printed", … see docs/tension.md
    double tension;     ///< mu of an angle-based method of eq. (9), NaN for others
    double fairness;    ///< how far a learned method was asked to prefer fair curves to near ones; NaN for others
    bat_curve_summary mean_nn;
    bat_curve_summary hausdorff;
    bat_curve_summary bending;
    bat_curve_summary g1;
    double published_mean_nn; ///< the paper's figures for this method on these curves; NaN where it has none
    double published_bending;
    double published_g1;
} bat_tension_row;

/// A method of one's own for the tables.
typedef struct bat_tension_method
{
    const char *name; ///< what its rows call it; stays the caller's
    double fairness;  ///< what its rows say of it; NaN for none
    bat_curve_scheme scheme;
} bat_tension_method;

/// The built-in methods in each space.
#define BAT_TENSION_METHODS 10
/// The method whose published figures are those of the paper's learned predictor.
#define BAT_TENSION_LEARNED_PUBLISHED "learned-published"
/// Rows of table 1: every built-in method in the three spaces.
#define BAT_TENSION_TABLE1_ROWS (3 * BAT_TENSION_METHODS)

/// The levels that all figures are taken at.
#define BAT_TENSION_LEVELS 5

/// Refine every curve by every built-in method and measure the result against its truth (section 7.1).
///
/// The oracles search the tension from -0.5 to 0.05 in steps of 0.025 for the least mean of mean_nn, as the paper does; the
/// adaptive heuristics take theirs as mu*.
///
/// @param curves BAT_TENSION_PUBLISHED: the 240 validation curves; else the BAT_TENSION_TEST_CURVES curves a space that
///               bat_tension_set_make() draws for BAT_TENSION_TEST_SEED
/// @param rows   receives BAT_TENSION_TABLE1_ROWS rows: plane, sphere, disk
/// @return BAT_OK, BAT_INVALID_ARGUMENT (no such curves), BAT_CANCELLED or BAT_NO_MEMORY
BAT_API bat_status bat_tension_table1(bat_tension_set_kind curves, bat_tension_row *rows, int threads, bat_progress progress,
                                      bat_error *error);

/// The same for the ground track of section 8: its 16 control points against its 520 points.
///
/// @param rows receives BAT_TENSION_METHODS rows
BAT_API bat_status bat_tension_table5(bat_tension_row *rows, int threads, bat_progress progress, bat_error *error);

/// Methods of one's own on the curves of table 1, which are made once for all of them.
///
/// @param methods `count` of them, at least 1; the published figures are filled in for BAT_TENSION_LEARNED_PUBLISHED
/// @param rows    receives 3 x count rows: all methods in the plane, on the sphere, in the disk
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_CANCELLED, BAT_NO_MEMORY or what refining returned
BAT_API bat_status bat_tension_table1_methods(bat_tension_set_kind curves, const bat_tension_method *methods, size_t count,
                                              bat_tension_row *rows, int threads, bat_progress progress, bat_error *error);

/// The same for the ground track of table 5: `count` rows.
BAT_API bat_status bat_tension_table5_methods(const bat_tension_method *methods, size_t count, bat_tension_row *rows,
                                              int threads, bat_progress progress, bat_error *error);

// Table 2 of Ugail and Howard (2026), section 7.7: how the largest exterior angle of a refined curve grows when its control
// points are disturbed.

/// Strengths of noise in the table.
#define BAT_TENSION_NOISES 6
/// Methods that need no learning: four-point, six-point and the adaptive heuristic with either sign.
#define BAT_TENSION_NOISE_METHODS 6

/// How to disturb. Begin with bat_tension_noise_defaults().
typedef struct bat_tension_noise_options
{
    /// Standard deviations of both coordinates of a control point, as shares of its polygon's radius: the greatest distance
    /// of a control point from the mean of all. At least 0; default 0, 0.03, 0.06, 0.1, 0.15, 0.2, as published.
    double noise[BAT_TENSION_NOISES];
    size_t levels; ///< default 5: the caption says 4, but the published figures without noise are those of table 1
    uint64_t seed; ///< of the noise, which is the same for all methods and, but for its size, all strengths; default 1
    int threads;   ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_tension_noise_options;

/// The options' default values.
BAT_API bat_tension_noise_options bat_tension_noise_defaults(void);

/// One method; the arrays go by the strength of the noise.
typedef struct bat_tension_noise_row
{
    const char *method;                             ///< as in tension_table.h
    double tension;                                 ///< mu of a method of eq. (9), NaN for others
    bat_curve_summary g1[BAT_TENSION_NOISES];       ///< over the curves: largest exterior angle
    double published_g1[BAT_TENSION_NOISES];        ///< the paper's mean; NaN where it has none for this method and noise
    double published_deviation[BAT_TENSION_NOISES]; ///< the same for its standard deviation
} bat_tension_noise_row;

/// Disturb the plane's validation polygons, refine them by every method that needs no learning, and measure the largest
/// angles. The heuristic's mu* is that of table 1, found on the undisturbed polygons at BAT_TENSION_LEVELS levels.
///
/// @param options null for the defaults
/// @param rows    receives BAT_TENSION_NOISE_METHODS rows
/// @return BAT_OK; BAT_INVALID_ARGUMENT (noise that is negative or not finite); BAT_CANCELLED, BAT_NO_MEMORY or what
/// refining
///         returned
BAT_API bat_status bat_tension_table2(const bat_tension_noise_options *options, bat_tension_noise_row *rows,
                                      bat_error *error);

/// The same polygons by a scheme of one's own.
/// @param method what the row calls it, which stays the caller's; the published figures are filled in for
///               BAT_TENSION_LEARNED_PUBLISHED
BAT_API bat_status bat_tension_table2_method(const char *method, const bat_curve_scheme *scheme,
                                             const bat_tension_noise_options *options, bat_tension_noise_row *row,
                                             bat_error *error);

// Tables 3 and 4 of Ugail and Howard (2026), section 7.8: the published recipe trained anew with one thing changed.

/// What a training differs in from the published recipe.
typedef enum bat_tension_variant
{
    BAT_TENSION_FULL,           ///< nothing: "full"
    BAT_TENSION_ONE_HOT,        ///< BAT_TENSION_EMBEDDING_ONE_HOT: "one-hot"
    BAT_TENSION_NO_EMBEDDING,   ///< BAT_TENSION_EMBEDDING_NONE: "no-embedding"
    BAT_TENSION_NO_CONSISTENCY, ///< without eq. (22): "no-consistency"
    BAT_TENSION_NO_BENDING,     ///< without eq. (21): "no-bending"
    BAT_TENSION_NO_SMOOTHNESS,  ///< without eq. (20): "no-smoothness"
    BAT_TENSION_VARIANT_COUNT
} bat_tension_variant;

/// Rows of table 3: full, one-hot, no-embedding.
#define BAT_TENSION_TABLE3_ROWS 3
/// Rows of table 4: full, no-consistency, no-bending, no-smoothness.
#define BAT_TENSION_TABLE4_ROWS 4

/// How to train the variants. Begin with bat_tension_ablation_defaults().
typedef struct bat_tension_ablation_options
{
    uint64_t seed;   ///< of every training; default 1
    uint64_t epochs; ///< of every training, at least 1; the learning rate falls to 0 over as many; default 100, as published
    /// A training's files (bat_tension_train_options) go to the folder's subfolder seed-SEED/VARIANT, and what is there
    /// already is gone on with: a finished training is not repeated. Both tables may share a folder. Null for no files;
    /// default null.
    const char *folder;
    int threads;           ///< as in bat_tension_train_options; default 0
    bat_progress progress; ///< asked before every batch; when it says stop, the training's checkpoint is written first
} bat_tension_ablation_options;

/// The options' default values.
BAT_API bat_tension_ablation_options bat_tension_ablation_defaults(void);

/// What the best weights do to the validation curves of one space: means over the curves.
typedef struct bat_tension_ablation_score
{
    double mean_nn, g1;
    double bending; ///< over the mean bending of the four-point scheme as printed
} bat_tension_ablation_score;

typedef struct bat_tension_ablation_row
{
    const char *variant; ///< its name
    size_t weights;      ///< of the network
    bat_tension_train_report report;
    bat_tension_ablation_score scores[BAT_TENSION_SPACE_COUNT];
    bat_tension_ablation_score published[BAT_TENSION_SPACE_COUNT]; ///< the paper's; NaN where it has none
} bat_tension_ablation_row;

/// Train the networks of table 3. With the defaults a training takes minutes.
///
/// @param options null for the defaults
/// @param rows    receives BAT_TENSION_TABLE3_ROWS rows
/// @return as bat_tension_train(); BAT_INVALID_ARGUMENT also for a folder that holds trainings of another number of epochs
BAT_API bat_status bat_tension_table3(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows,
                                      bat_error *error);

/// The same for table 4: BAT_TENSION_TABLE4_ROWS rows.
BAT_API bat_status bat_tension_table4(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows,
                                      bat_error *error);

// What a trained network does: section 9 and remark 4 of Ugail and Howard (2026).

/// Where effective tensions are cut off, as published.
#define BAT_TENSION_EFFECTIVE_MIN (-3.0)
#define BAT_TENSION_EFFECTIVE_MAX 1.5
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
    size_t insertions;         ///< looked at
    size_t undefined;          ///< of them with |A - B| < 1e-6, which count nowhere else
    size_t below, above;       ///< of them cut off to BAT_TENSION_EFFECTIVE_MIN and _GREATEST
    bat_curve_summary summary; ///< as published, after cutting off
    double quantiles[5];       ///< 5, 25, 50, 75 and 95 %, without cutting off
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
    /// Their product, remark 4's bound. (It passes over what layer norms multiply by, the skips around blocks, GELU's slope
    /// of up to 1.13 and that of the sigmoid at the end of up to 0.38.)
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

/// Refine validation curves by a network and look at every insertion; and estimate the network's Lipschitz constant, by
/// power iteration on each layer. While it runs, OpenBLAS works on one thread in the whole process.
///
/// @param path    a file of the published recipe, as for bat_curve_model_read(); null for the network that the library holds
/// @param options null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_BAD_FILE, BAT_FILE_ACCESS, BAT_NO_CONVERGENCE, BAT_CANCELLED or BAT_NO_MEMORY
BAT_API bat_status bat_tension_mechanism(const char *path, const bat_tension_mechanism_options *options,
                                         bat_tension_mechanism_report *report, bat_error *error);

BAT_C_END

#endif
