#ifndef BATTEN_TENSION_NOISE_H
#define BATTEN_TENSION_NOISE_H

#include "batten/measure.h"
#include "batten/scheme.h"

BAT_C_BEGIN

/// @file
/// Table 2 of Ugail and Howard (2026), section 7.7: how the largest exterior angle of a refined curve grows when its control
/// points are disturbed.

/// Strengths of noise in the table.
#define BAT_TENSION_NOISES 6
/// Methods that need no learning: four-point, six-point and the adaptive heuristic with either sign.
#define BAT_TENSION_NOISE_METHODS 6

/// How to disturb. Begin with bat_tension_noise_defaults().
typedef struct bat_tension_noise_options
{
    /// Standard deviations of both coordinates of a control point, as shares of its polygon's radius: the greatest distance of
    /// a control point from the mean of all. At least 0; default 0, 0.03, 0.06, 0.1, 0.15, 0.2, as published.
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
    bat_summary g1[BAT_TENSION_NOISES];             ///< over the curves: largest exterior angle
    double published_g1[BAT_TENSION_NOISES];        ///< the paper's mean; NaN where it has none for this method and noise
    double published_deviation[BAT_TENSION_NOISES]; ///< the same for its standard deviation
} bat_tension_noise_row;

/// Disturb the plane's validation polygons, refine them by every method that needs no learning, and measure the largest angles.
/// The heuristic's mu* is that of table 1, found on the undisturbed polygons at BAT_TENSION_LEVELS levels.
///
/// @param options null for the defaults
/// @param rows    receives BAT_TENSION_NOISE_METHODS rows
/// @return BAT_OK; BAT_INVALID_ARGUMENT (noise that is negative or not finite); BAT_CANCELLED, BAT_NO_MEMORY or what refining
///         returned
BAT_API bat_status bat_tension_table2(const bat_tension_noise_options *options, bat_tension_noise_row *rows,
                                      bat_error *error);

/// The same polygons by a scheme of one's own.
/// @param method what the row calls it, which stays the caller's; the published figures are filled in for
///               BAT_TENSION_LEARNED_PUBLISHED
BAT_API bat_status bat_tension_table2_method(const char *method, const bat_scheme *scheme,
                                             const bat_tension_noise_options *options, bat_tension_noise_row *row,
                                             bat_error *error);

BAT_C_END

#endif
