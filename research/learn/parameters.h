#ifndef RESEARCH_LEARN_PARAMETERS_H
#define RESEARCH_LEARN_PARAMETERS_H

#include "learn/parameters.h"

/// @file
/// What trainings do with weights as a whole: draw, describe and write them.

void learn_parameter_fill(learn_parameters *set, size_t index, real value);
/// Independent normal numbers of mean 0, drawn row by row.
void learn_parameter_fill_normal(learn_parameters *set, size_t index, double deviation, bat_random *random);

/// Describe the arrays with the values of a block laid out like this one, for safetensors_write(). The descriptions refer to
/// `block`; names are `prefix` and the parameter's, written into `names`.
/// @param arrays,names room for set->count
void learn_parameters_describe(const learn_parameters *set, const real *block, const char *prefix, safetensors_array *arrays,
                               char (*names)[2 * LEARN_NAME_SIZE]);
/// Write the values alone into a safetensors file, with notes about their origin.
/// @return BAT_OK, BAT_NO_MEMORY or BAT_FILE_ACCESS
bat_status learn_parameters_write(const learn_parameters *set, const char *path, const safetensors_note *notes,
                                  size_t note_count, bat_error *error);

#endif
