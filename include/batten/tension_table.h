#ifndef BATTEN_TENSION_TABLE_H
#define BATTEN_TENSION_TABLE_H

#include "batten/measure.h"
#include "batten/tension_data.h"

BAT_C_BEGIN

/// @file
/// Tables 1 and 5 of Ugail and Howard (2026), computed anew for every scheme that needs no learning, with both signs of the
/// insertion angle, and for any schemes of one's own, learned ones too. Table 1 also on curves that no training has seen.

/// How to search for a tension. Begin with bat_tension_search_defaults().
typedef struct bat_tension_search_options
{
    bat_scheme scheme; ///< angle-based; all of it stays but the tension; default: outward, not adaptive
    double low, high;  ///< the tensions tried lie in between, ends included; default -0.5 and 0.05, as published
    size_t count;      ///< how many, evenly spaced, at least 2; default 23, steps of 0.025
    size_t levels;     ///< how often the curves are refined; default 5
    int threads;       ///< 0: as many as OpenMP gives; default 0
    bat_progress progress;
} bat_tension_search_options;

/// The options' default values.
BAT_API bat_tension_search_options bat_tension_search_defaults(void);

/// Search the tension whose refined curves are nearest to their truths: the least mean, over the curves, of the mean
/// nearest-neighbour distance (the "oracle" of section 7.1). A best tension at an end of the range may mean that a better one
/// lies outside.
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
    bat_summary mean_nn;
    bat_summary hausdorff;
    bat_summary bending;
    bat_summary g1;
    double published_mean_nn; ///< the paper's figures for this method on these curves; NaN where it has none
    double published_bending;
    double published_g1;
} bat_tension_row;

/// A method of one's own for the tables.
typedef struct bat_tension_method
{
    const char *name; ///< what its rows call it; stays the caller's
    double fairness;  ///< what its rows say of it; NaN for none
    bat_scheme scheme;
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

BAT_C_END

#endif
