#ifndef BATTEN_RESEARCH_HARM_STUDY_H
#define BATTEN_RESEARCH_HARM_STUDY_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// A search for harm: random inputs with a known truth, and each default beside the simplest thing that a user could do.

/// Options of bat_harm_study(). Begin with bat_harm_study_defaults().
typedef struct bat_harm_study_options
{
    size_t count;  ///< cases of each kind, 1 to 100000; default 20
    uint64_t seed; ///< another seed makes other cases; default 1
    int threads;   ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_harm_study_options;

/// The options' default values.
BAT_API bat_harm_study_options bat_harm_study_defaults(void);

/// The default is harmful where its error is this many times that of the simplest rival.
#define BAT_HARM_RATIO 1.1

/// A kind of input, and what its cases gave. Their errors are distances from the truth.
typedef struct bat_harm_row
{
    const char *system, *kind, *rival; ///< static texts
    size_t tried, harmed;
    size_t refused;    ///< cases without a result
    double median;     ///< of the ratios of errors, default over rival; NaN where all are refused
    double worst;      ///< the largest; NaN where all are refused
    size_t worst_case; ///< its number
} bat_harm_row;

/// Run all kinds.
/// @param rows    receives `*row_count` rows; release them with free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_CANCELLED or BAT_NO_MEMORY; results are untouched on failure
BAT_API bat_status bat_harm_study(const bat_harm_study_options *options, bat_harm_row **rows, size_t *row_count,
                                  bat_error *error);

BAT_C_END

#endif
