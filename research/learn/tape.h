#ifndef RESEARCH_LEARN_TAPE_H
#define RESEARCH_LEARN_TAPE_H

#include "learn/parameters.h"

/// @file
/// Reverse-mode differentiation over coarse operations. A tape is a stretch of memory into which operations write their
/// results, and a list of the backward passes. Every operation (research/learn/operations.h, or one's own) makes an array,
/// fills in its values, and records a function that computes the gradients of its inputs from the array's gradient.
///
///     learn_tape_begin(tape, parameters, gradient);
///     learn_array *x = learn_constant(tape, rows, columns, features);
///     learn_array *y = learn_linear(tape, x, learn_parameter_array(tape, 0), learn_parameter_array(tape, 1));
///     learn_array *loss = learn_mean_of_squares(tape, y);
///     learn_tape_backward(tape, loss, 1);
///     status = learn_tape_status(tape, error);
///
/// Nothing is freed between steps: after the first ones a step allocates no memory. After a failure (out of memory, no
/// OpenBLAS) the operations do nothing, and learn_tape_status() at the end reports it. Wrong shapes are programming errors,
/// which are asserted.

/// A matrix and, where needed, the derivative of the loss by its numbers. Lives until the tape begins the next step.
typedef struct learn_array
{
    size_t rows, columns;
    real *value;    ///< rows x columns
    real *gradient; ///< the same shape; null without a derivative
    bool begun;     ///< whether `gradient` holds numbers yet; it is zero where not
} learn_array;

/// The backward pass of an operation. It reads the gradients of its outputs and adds to those of its inputs, by
/// learn_gradient().
typedef void learn_backward(void *context);

typedef struct learn_tape
{
    struct tape_block *block;     ///< the memory, the newest block first
    size_t used;                  ///< bytes of the newest block
    struct tape_record *last;     ///< the newest operation
    learn_array *parameter_array; ///< one for each parameter
    size_t parameter_count;
    bool drops;            ///< whether learn_dropout() drops
    uint64_t dropout_key;  ///< of this step
    uint64_t dropout_uses; ///< by operations so far
    bat_status status;
    learn_array nothing; ///< the result of operations after a failure: no rows
} learn_tape;

/// A tape without memory, which it allocates as needed. It is all zero.
learn_tape learn_tape_make(void);
void learn_tape_free(learn_tape *tape);

/// Forget everything and begin a step.
/// @param parameters may be null for none
/// @param gradient the derivatives by parameters, in the order of their values, are added to it; null for none
void learn_tape_begin(learn_tape *tape, const learn_parameters *parameters, real *gradient);
/// Enable dropout. Its random numbers depend on `key` and on the order of the operations alone.
void learn_tape_drop(learn_tape *tape, uint64_t key);
/// Differentiate `loss` (1 x 1), times `weight`: fill in all gradients. At most once per step.
void learn_tape_backward(learn_tape *tape, learn_array *loss, real weight);
/// The status of the step so far.
/// @return BAT_OK, BAT_NO_MEMORY, BAT_TOO_LARGE for an array with more rows or columns than INT_MAX, or the failure of
///         blas_load()
bat_status learn_tape_status(const learn_tape *tape, bat_error *error);

/// The array of a parameter.
static inline learn_array *learn_parameter_array(learn_tape *tape, size_t index)
{
    return tape->status == BAT_OK ? &tape->parameter_array[index] : &tape->nothing;
}
/// A copy of given numbers, without derivative.
learn_array *learn_constant(learn_tape *tape, size_t rows, size_t columns, const real *values);

// For the implementation of operations.

/// A new array with values to be filled in.
/// @param wants whether it has a derivative
learn_array *learn_array_make(learn_tape *tape, size_t rows, size_t columns, bool wants);
/// Memory that lives as long as the step, aligned to 64 bytes and not initialized. Null after a failure.
void *learn_tape_memory(learn_tape *tape, size_t count, size_t size);
/// Record the backward pass of an operation. It is called only if `output` has a gradient by then. For an operation with
/// several outputs `output` is null, and the function checks the gradients itself.
void learn_tape_record(learn_tape *tape, learn_array *output, learn_backward *backward, void *context);

static inline bool learn_wants(const learn_array *array)
{
    return array->gradient != NULL;
}
/// The gradient of an array to add to.
real *learn_gradient(learn_array *array);
static inline size_t learn_size(const learn_array *array)
{
    return array->rows * array->columns;
}

#endif
