#ifndef BATTEN_RESEARCH_CURVE_STUDY_H
#define BATTEN_RESEARCH_CURVE_STUDY_H

#include "batten/curve_measure.h"
#include "batten/curve_scheme.h"
#include "batten/research/curve_analysis.h"
#include "batten/research/curve_data.h"
#include "batten/research/curve_train.h"

BAT_C_BEGIN

/// @file
/// Tables 1 and 5 of Ugail and Howard (2026), recomputed for every scheme without learned parameters, with both signs of the
/// insertion angle. Other schemes, also learned ones, can be added. Table 1 is also available on curves that no training has
/// used.

/// Options of the search for a tension. Begin with bat_tension_search_defaults().
typedef struct bat_tension_search_options
{
    bat_curve_scheme scheme; ///< angle-based scheme whose tension is replaced; default: outward, not adaptive
    double low, high;        ///< range of tensions, ends included; default -0.5 and 0.05, as published
    size_t count;            ///< number of equally spaced tensions, at least 2; default 23, steps of 0.025
    size_t levels;           ///< number of refinement levels; default 5
    int threads;             ///< 0: as many as OpenMP gives; default 0
    bat_progress progress;
} bat_tension_search_options;

/// The options' default values.
BAT_API bat_tension_search_options bat_tension_search_defaults(void);

/// Search the tension that minimizes the mean, over the curves, of the mean nearest-neighbour distance between refined and
/// true curve (the "oracle" of section 7.1). A minimum at an end of the range may indicate a better tension outside.
///
/// @param coarse,truth `count` curves each, at least 1
/// @param options      null for the defaults
/// @param tension      receives the best tension
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_CANCELLED, BAT_NO_MEMORY or the status of refining or comparing
BAT_API bat_status bat_tension_search(const bat_curve *coarse, const bat_curve *truth, size_t count,
                                      const bat_tension_search_options *options, double *tension, bat_error *error);

/// A row of a table: a method in a space, over a set of curves.
typedef struct bat_tension_row
{
    const char *space;  ///< "plane", "sphere" or "disk"
    const char *method; ///< "four-point-printed", … see docs/algorithms/tension-network.md
    double tension;     ///< mu of an angle-based method of eq. (9), NaN for others
    double fairness;    ///< fairness setting of a learned method; NaN for others
    bat_curve_summary mean_nn;
    bat_curve_summary hausdorff;
    bat_curve_summary bending;
    bat_curve_summary g1;
    double published_mean_nn; ///< the published values for this method and these curves; NaN if there are none
    double published_bending;
    double published_g1;
} bat_tension_row;

/// A method for the tables.
typedef struct bat_tension_method
{
    const char *name; ///< name in its rows; not copied
    double fairness;  ///< fairness in its rows; NaN for none
    bat_curve_scheme scheme;
} bat_tension_method;

/// Number of built-in methods in each space.
#define BAT_TENSION_METHODS 10
/// The method whose published values are those of the paper's learned predictor.
#define BAT_TENSION_LEARNED_PUBLISHED "learned-published"
/// Rows of table 1: every built-in method in the three spaces.
#define BAT_TENSION_TABLE1_ROWS (3 * BAT_TENSION_METHODS)

/// The refinement level of all measurements.
#define BAT_TENSION_LEVELS 5

/// Refine every curve by every built-in method and measure the result against the true curve (section 7.1).
///
/// The oracles search tensions from -0.5 to 0.05 in steps of 0.025 for the minimum of the mean of mean_nn, as in the paper;
/// the adaptive heuristics use the result as mu*.
///
/// @param curves BAT_TENSION_SET_KIND_PUBLISHED: the 240 validation curves; else BAT_TENSION_TEST_CURVES curves in each
/// space from
///               bat_tension_set_make() with the seed BAT_TENSION_TEST_SEED
/// @param rows   receives BAT_TENSION_TABLE1_ROWS rows: plane, sphere, disk
/// @return BAT_OK, BAT_INVALID_ARGUMENT (no such curves), BAT_CANCELLED or BAT_NO_MEMORY
BAT_API bat_status bat_tension_table1(bat_tension_set_kind curves, bat_tension_row *rows, int threads, bat_progress progress,
                                      bat_error *error);

/// The same for the ground track of section 8: its 16 control points against its 520 points.
///
/// @param rows receives BAT_TENSION_METHODS rows
BAT_API bat_status bat_tension_table5(bat_tension_row *rows, int threads, bat_progress progress, bat_error *error);

/// Other methods on the curves of table 1, which are generated once for all of them.
///
/// @param methods `count` methods, at least 1; published values are filled in for BAT_TENSION_LEARNED_PUBLISHED
/// @param rows    receives 3 x count rows: all methods in the plane, on the sphere, in the disk
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_CANCELLED, BAT_NO_MEMORY or what refining returned
BAT_API bat_status bat_tension_table1_methods(bat_tension_set_kind curves, const bat_tension_method *methods, size_t count,
                                              bat_tension_row *rows, int threads, bat_progress progress, bat_error *error);

/// The same for the ground track of table 5: `count` rows.
BAT_API bat_status bat_tension_table5_methods(const bat_tension_method *methods, size_t count, bat_tension_row *rows,
                                              int threads, bat_progress progress, bat_error *error);

// Table 2 of Ugail and Howard (2026), section 7.7: the largest exterior angle of refined curves with disturbed control
// points.

/// Number of noise levels in the table.
#define BAT_TENSION_NOISES 6
/// Number of methods without learned parameters: four-point, six-point and the adaptive heuristic with either sign.
#define BAT_TENSION_NOISE_METHODS 6

/// Options of the disturbance. Begin with bat_tension_noise_defaults().
typedef struct bat_tension_noise_options
{
    /// Standard deviations of both coordinates of a control point, relative to the radius of its polygon, the largest
    /// distance of a control point from their mean. At least 0; default 0, 0.03, 0.06, 0.1, 0.15, 0.2, as published.
    double noise[BAT_TENSION_NOISES];
    size_t levels; ///< default 5: the caption states 4, but the published values without noise are those of table 1
    uint64_t seed; ///< seed of the noise, which is the same for all methods and, up to its scale, for all levels; default 1
    int threads;   ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_tension_noise_options;

/// The options' default values.
BAT_API bat_tension_noise_options bat_tension_noise_defaults(void);

/// A row: a method. Arrays are indexed by the noise level.
typedef struct bat_tension_noise_row
{
    const char *method;                             ///< name, as in bat_tension_row
    double tension;                                 ///< mu of a method of eq. (9), NaN for others
    bat_curve_summary g1[BAT_TENSION_NOISES];       ///< over the curves: largest exterior angle
    double published_g1[BAT_TENSION_NOISES];        ///< the published mean; NaN if there is none
    double published_deviation[BAT_TENSION_NOISES]; ///< the published standard deviation
} bat_tension_noise_row;

/// Disturb the validation polygons in the plane, refine them by every method without learned parameters, and measure the
/// largest angles. The heuristic uses mu* of table 1, found on undisturbed polygons at BAT_TENSION_LEVELS levels.
///
/// @param options null for the defaults
/// @param rows    receives BAT_TENSION_NOISE_METHODS rows
/// @return BAT_OK; BAT_INVALID_ARGUMENT (noise that is negative or not finite); BAT_CANCELLED, BAT_NO_MEMORY or the status
///        of refining
BAT_API bat_status bat_tension_table2(const bat_tension_noise_options *options, bat_tension_noise_row *rows,
                                      bat_error *error);

/// The same polygons by another scheme.
/// @param method name in the row, not copied; published values are filled in for BAT_TENSION_LEARNED_PUBLISHED
BAT_API bat_status bat_tension_table2_method(const char *method, const bat_curve_scheme *scheme,
                                             const bat_tension_noise_options *options, bat_tension_noise_row *row,
                                             bat_error *error);

// Tables 3 and 4 of Ugail and Howard (2026), section 7.8: the published recipe, trained with one change at a time.

/// The change to the published recipe.
typedef enum bat_tension_variant
{
    BAT_TENSION_VARIANT_FULL,           ///< nothing: "full"
    BAT_TENSION_VARIANT_ONE_HOT,        ///< BAT_TENSION_EMBEDDING_ONE_HOT: "one-hot"
    BAT_TENSION_VARIANT_NO_EMBEDDING,   ///< BAT_TENSION_EMBEDDING_NONE: "no-embedding"
    BAT_TENSION_VARIANT_NO_CONSISTENCY, ///< without eq. (22): "no-consistency"
    BAT_TENSION_VARIANT_NO_BENDING,     ///< without eq. (21): "no-bending"
    BAT_TENSION_VARIANT_NO_SMOOTHNESS,  ///< without eq. (20): "no-smoothness"
    BAT_TENSION_VARIANT_COUNT
} bat_tension_variant;

/// Rows of table 3: full, one-hot, no-embedding.
#define BAT_TENSION_TABLE3_ROWS 3
/// Rows of table 4: full, no-consistency, no-bending, no-smoothness.
#define BAT_TENSION_TABLE4_ROWS 4

/// Options of the trainings. Begin with bat_tension_ablation_defaults().
typedef struct bat_tension_ablation_options
{
    uint64_t seed; ///< of every training; default 1
    uint64_t
        epochs; ///< of every training, at least 1, with cosine decay of the learning rate to 0; default 100, as published
    /// The files of a training (bat_curve_train_options) are written to the subfolder seed-SEED/VARIANT. Trainings found
    /// there are resumed; finished ones are not repeated. Both tables may share a folder. Null: no files; default null.
    const char *folder;
    int threads;           ///< as in bat_curve_train_options; default 0
    bat_progress progress; ///< called before every batch; cancelling writes a checkpoint first
} bat_tension_ablation_options;

/// The options' default values.
BAT_API bat_tension_ablation_options bat_tension_ablation_defaults(void);

/// Scores of the best weights on the validation curves of one space: means over the curves.
typedef struct bat_tension_ablation_score
{
    double mean_nn, g1;
    double bending; ///< relative to the mean bending of the four-point scheme as printed
} bat_tension_ablation_score;

typedef struct bat_tension_ablation_row
{
    const char *variant; ///< name of the variant
    size_t weights;      ///< number of weights of the network
    bat_curve_train_report report;
    bat_tension_ablation_score scores[BAT_TENSION_SPACE_COUNT];
    bat_tension_ablation_score published[BAT_TENSION_SPACE_COUNT]; ///< published values; NaN if there are none
} bat_tension_ablation_row;

/// Train the networks of table 3. A training with the defaults takes minutes.
///
/// @param options null for the defaults
/// @param rows    receives BAT_TENSION_TABLE3_ROWS rows
/// @return as bat_curve_train(); BAT_INVALID_ARGUMENT also if the folder contains trainings with another number of epochs
BAT_API bat_status bat_tension_table3(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows,
                                      bat_error *error);

/// The same for table 4: BAT_TENSION_TABLE4_ROWS rows.
BAT_API bat_status bat_tension_table4(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows,
                                      bat_error *error);

// Curves that people have: control points that were sampled from dense curves in several ways, and the dense curves.

/// The longest name of a family or a sampling, with a final zero.
#define BAT_REAL_CURVES_NAME 64
/// Radius of the cap of the sphere that a plane curve is laid on, in radians: 20 degrees.
#define BAT_REAL_CURVES_CAP 0.3490658503988659

/// Options of the study. Begin with bat_real_curves_defaults().
typedef struct bat_real_curves_options
{
    const bat_tension_method *methods; ///< further methods, `method_count` of them; default none
    size_t method_count;
    size_t levels; ///< of refinement, 0 to 12; default 5
    int threads;   ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_real_curves_options;

/// The options' default values.
BAT_API bat_real_curves_options bat_real_curves_defaults(void);

/// A method on all curves of a family with one sampling. Distances are relative to the mean edge of the control polygon.
typedef struct bat_real_curves_row
{
    const char *space; ///< "plane" or "sphere"
    char family[BAT_REAL_CURVES_NAME];
    char sampling[BAT_REAL_CURVES_NAME];
    const char *method; ///< a name for bat_curve_scheme_by_name(), "default", "polygon", "akima" or that of a further method
    size_t curves;
    double distance; ///< mean over the curves of half the sum of both one-sided mean distances
    double relative; ///< the same over that of the control polygons
    double largest;  ///< mean over the curves of the largest distance
    double turn;     ///< median of the largest turning angle, radians
    size_t crossed;  ///< curves that cross themselves though their control polygon does not
} bat_real_curves_row;

/// Refine control points by the default, other schemes and splines, and measure the results against the true curves, in the
/// plane and on the sphere. On the sphere, the azimuthal equidistant map lays the circle around the bounding box of each
/// true curve on a cap of radius BAT_REAL_CURVES_CAP. Each curve is measured by 8000 points at equal steps of length, of
/// which every fourth one searches the nearest point of the other curve.
///
/// @param folder  has files FAMILY-truth.csv and FAMILY-SAMPLING.csv with equally many curves of the plane, in one order
/// @param options null for the defaults
/// @param rows    receives the rows, by space, family, sampling and method; release them with free(). A method that does not
///                exist in a space has no row there
/// @return BAT_OK; BAT_FILE_ACCESS or BAT_BAD_FILE (no such files, or files that do not match); BAT_INVALID_ARGUMENT,
///         BAT_CANCELLED, BAT_NO_MEMORY or the status of reading or refining
BAT_API bat_status bat_real_curves(const char *folder, const bat_real_curves_options *options, bat_real_curves_row **rows,
                                   size_t *count, bat_error *error);

// Analysis of a trained network: section 9 and remark 4 of Ugail and Howard (2026).

/// Range to which effective tensions are clipped, as published.
#define BAT_TENSION_EFFECTIVE_MIN (-3.0)
#define BAT_TENSION_EFFECTIVE_MAX 1.5
/// Number of bins of a histogram of this range, each 0.1 wide.
#define BAT_TENSION_EFFECTIVE_BINS 45
/// Number of linear layers of the network.
#define BAT_TENSION_LAYERS 11

/// Effective tensions in one space. The effective tension of an insertion is the mu for which eq. (9) gives the network's
/// angle:
///
///     (alpha - B) / (A - B),   A = (delta_j-1 + delta_j+2) / 8,   B = (delta_j + delta_j+1) / 8     (eq. 26)
///
/// If all four angles are equal, A = B, and every mu gives the same angle; close to this case the value is arbitrary.
typedef struct bat_tension_effective
{
    size_t insertions;         ///< number of insertions
    size_t undefined;          ///< insertions with |A - B| < 1e-6, excluded from the other members
    size_t below, above;       ///< insertions clipped to BAT_TENSION_EFFECTIVE_MIN and _MAX
    bat_curve_summary summary; ///< after clipping, as published
    double quantiles[5];       ///< 5, 25, 50, 75 and 95 per cent, without clipping
    /// Bin i counts tensions from MIN + i / 10 to MIN + (i + 1) / 10; the first and the last also count clipped ones.
    size_t histogram[BAT_TENSION_EFFECTIVE_BINS];
} bat_tension_effective;

/// The analysis of one space.
typedef struct bat_tension_mechanism_space
{
    bat_tension_effective printed; ///< for eq. (9) with its printed sign, as published
    bat_tension_effective outward; ///< for eq. (9) with the opposite, correct sign: alpha is replaced by -alpha
    double published_mean;         ///< published mean of `printed`
    double published_deviation;    ///< published standard deviation; NaN if there is none
    double largest_gradient;       ///< maximum norm of the gradient of alpha with respect to the 6 features of eq. (17)
    double centre;                 ///< alpha for zero features; theorem 2 requires 0
} bat_tension_mechanism_space;

/// The analysis of a network.
typedef struct bat_tension_mechanism_report
{
    bat_tension_mechanism_space spaces[BAT_TENSION_SPACE_COUNT];
    double layers[BAT_TENSION_LAYERS]; ///< spectral norms of the matrices of the linear layers, in the order of the network
    /// Their product, the bound of remark 4. (It neglects the gains of layer norms, the skip connections, the slope of GELU
    /// of up to 1.13, and the slope of the final sigmoid of up to 0.38.)
    double product;
} bat_tension_mechanism_report;

/// Options of the analysis. Begin with bat_tension_mechanism_defaults().
typedef struct bat_tension_mechanism_options
{
    size_t curves; ///< number of validation curves in each space, at least 1; default 60, as published
    size_t
        levels; ///< refinement levels whose insertions count, 1 to 10; default 3, which reproduces the published means best
    bat_progress progress;
} bat_tension_mechanism_options;

/// The options' default values.
BAT_API bat_tension_mechanism_options bat_tension_mechanism_defaults(void);

/// Refine validation curves by a network and analyze every insertion; estimate the network's Lipschitz constant by power
/// iteration on each layer. Meanwhile OpenBLAS uses one thread in the whole process.
///
/// @param path    file of the published recipe, as for bat_curve_model_read(); null for the built-in network
/// @param options null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_BAD_FILE, BAT_FILE_ACCESS, BAT_NO_CONVERGENCE, BAT_CANCELLED or BAT_NO_MEMORY
BAT_API bat_status bat_tension_mechanism(const char *path, const bat_tension_mechanism_options *options,
                                         bat_tension_mechanism_report *report, bat_error *error);

// Pictures of the tables.

/// Draw the rows of table 1, `count` in all: distance to the truth against fairness, in each space.
///
/// @param path .png, .svg or .pdf
/// @return BAT_OK or the status of bat_chart_write()
BAT_API bat_status bat_tension_frontier_draw(const char *path, const bat_tension_row *rows, size_t count, bat_error *error);
/// Draw the effective tensions as histograms, in each space and for both signs.
///
/// @param path .png, .svg or .pdf
/// @return BAT_OK or the status of bat_chart_write()
BAT_API bat_status bat_tension_mechanism_draw(const char *path, const bat_tension_mechanism_report *report,
                                              bat_error *error);
/// Draw the ground track of table 5, its control points and the four-point scheme.
///
/// @param path .png, .svg or .pdf
/// @return BAT_OK or the status of bat_curve_picture_write()
BAT_API bat_status bat_tension_iss_draw(const char *path, bat_error *error);

/// @name Convergence of refinement
/// The chordal distance of a refined polygon from its limit, in O(n).
/// Of the options (null for the defaults) threads and progress count. Both return BAT_OK; BAT_INVALID_ARGUMENT (too few
/// points, numbers of coordinates that differ); BAT_INVALID_POINT (a coordinate as in bat_curve_compare(), or a distance
/// that a double cannot hold) or BAT_CANCELLED; `distance` is untouched on failure.
/// @{

/// The greatest distance of a vertex of `fine` from the polygon `coarse` that it was refined from. A vertex is compared with
/// the five edges around its own parameter, so that other parts of the polygon do not count.
/// @param coarse at least 2 points
/// @param fine   at least 1 point
BAT_API bat_status bat_curve_chord_distance(const bat_curve *coarse, const bat_curve *fine,
                                            const bat_curve_measure_options *options, double *distance, bat_error *error);

/// The greatest distance of a vertex from the limit that a linear scheme takes it to. Vertices of an open curve whose
/// stencil reaches its ends are left out; 0 when none is left.
/// @param curve   at least 1 point, in a Euclidean space (else BAT_UNSUPPORTED)
/// @param stencil the scheme's limit stencil, as bat_mask_limit_stencil() gives it; its weights add up to 1
BAT_API bat_status bat_curve_limit_distance(const bat_curve *curve, const bat_mask_stencil *stencil,
                                            const bat_curve_measure_options *options, double *distance, bat_error *error);
/// @}

BAT_C_END

#endif
