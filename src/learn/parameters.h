#pragma once

#include "learn/real.h"
#include "learn/safetensors.h"

/// @file
/// The weights of a network: named arrays one after the other in one block of numbers, so that whatever treats all alike
/// (clipping, an optimizer, a checkpoint) is a single loop.

#define LEARN_NAME_SIZE 64

/// One array: a vector (rank 1) or a matrix (rank 2).
typedef struct learn_parameter
{
    char name[LEARN_NAME_SIZE];
    size_t rank;
    size_t rows, columns; ///< of a vector: 1 and its length
    size_t offset;        ///< where it begins in the block
} learn_parameter;

/// All of them. Fill it with learn_parameters_add(), then allocate.
typedef struct learn_parameters
{
    learn_parameter *list;
    size_t count, capacity;
    size_t total;      ///< numbers in all
    real *values;      ///< null until allocated
    bat_status status; ///< of the calls so far
} learn_parameters;

/// Add an array of zeros at the end; returns its index. A failure is reported by learn_parameters_allocate().
/// @param rows 0 for a vector
/// @param name distinct from the others
size_t learn_parameters_add(learn_parameters *set, size_t rows, size_t columns, const char *name);
/// Allocate the block, all zero. After a failure the set is empty.
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_TOO_LARGE when the numbers cannot be counted or a name is too long
bat_status learn_parameters_allocate(learn_parameters *set, bat_error *error);
void learn_parameters_free(learn_parameters *set);

static inline real *learn_parameter_values(const learn_parameters *set, size_t index)
{
    return set->values + set->list[index].offset;
}

/// Fill a block laid out like this one from the arrays named `prefix` and the parameter's name, of single or double
/// precision and the same shapes. Arrays of other names are left alone.
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY; `block` may be half filled on failure
bat_status learn_parameters_extract(const learn_parameters *set, const safetensors *content, const char *prefix, real *block,
                                    bat_error *error);
