#ifndef LEARN_TAPE_H
#define LEARN_TAPE_H

#include "learn/parameters.h"

/// @file
/// Reverse-mode differentiation over coarse operations. A tape is a stretch of memory into which operations write their
/// results, and a list of what to do backwards. Every operation (learn/operations.h, or one's own) makes an array, fills in
/// its values, and records a function that turns the array's gradient into gradients of what it was made from.
///
///     learn_tape_begin(tape, parameters, gradient);
///     learn_array *x = learn_constant(tape, rows, columns, features);
///     learn_array *y = learn_linear(tape, x, learn_parameter_array(tape, 0), learn_parameter_array(tape, 1));
///     learn_array *loss = learn_mean_of_squares(tape, y);
///     learn_tape_backward(tape, loss, 1);
///     status = learn_tape_status(tape, error);
///
/// Nothing is freed between steps: after the first ones a step allocates no memory. A failure (out of memory) is kept, the
/// operations after it do nothing, and one question at the end is enough. Wrong shapes are mistakes of the program and
/// asserted.

/// A matrix of numbers and, where one is wanted, the derivative of the loss by them. Lives until the tape begins anew.
typedef struct learn_array
{
    size_t rows, columns;
    real *value;    ///< rows x columns
    real *gradient; ///< the same shape; null when no derivative is wanted
    bool begun;     ///< whether `gradient` holds numbers yet; it is zero where not
} learn_array;

/// What an operation does backwards. Reads the gradient of the arrays it made, adds to those it was made from, by
/// learn_gradient().
typedef void learn_backward(void *context);

typedef struct learn_tape
{
    struct tape_block *block;     ///< where memory comes from, the newest first
    size_t used;                  ///< bytes of the newest block
    struct tape_record *last;     ///< the newest operation
    learn_array *parameter_array; ///< one for each parameter
    size_t parameter_count;
    bool drops;            ///< whether learn_dropout() drops
    uint64_t dropout_key;  ///< of this step
    uint64_t dropout_uses; ///< by operations so far
    bat_status status;
    learn_array nothing; ///< what operations give after a failure: no rows
} learn_tape;

/// A tape without memory, which it gets as needed. An all-zero tape is one too.
learn_tape learn_tape_make(void);
void learn_tape_free(learn_tape *tape);

/// Forget everything and begin a step.
/// @param parameters may be null for none
/// @param gradient receives, is added to, the derivatives by parameters, laid out like their values; null when they are not
/// wanted
void learn_tape_begin(learn_tape *tape, const learn_parameters *parameters, real *gradient);
/// From here on dropout drops, by random numbers that depend on `key` and on the order of the operations alone.
void learn_tape_drop(learn_tape *tape, uint64_t key);
/// Differentiate `loss` (1 x 1), times `weight`: fill in all gradients. Once for a step.
void learn_tape_backward(learn_tape *tape, learn_array *loss, real weight);
/// How the step went so far.
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_TOO_LARGE for an array of more rows or columns than an int counts
bat_status learn_tape_status(const learn_tape *tape, bat_error *error);

/// The array of a parameter.
static inline learn_array *learn_parameter_array(learn_tape *tape, size_t index)
{
    return tape->status == BAT_OK ? &tape->parameter_array[index] : &tape->nothing;
}
/// A copy of numbers that are given, without derivative.
learn_array *learn_constant(learn_tape *tape, size_t rows, size_t columns, const real *values);

// What operations are made of.

/// A new array with values to be filled in.
/// @param wants whether a derivative by it is wanted
learn_array *learn_array_make(learn_tape *tape, size_t rows, size_t columns, bool wants);
/// Memory that lives as long as the step, aligned to 64 bytes and not initialized. Null after a failure.
void *learn_tape_memory(learn_tape *tape, size_t count, size_t size);
/// Record what an operation does backwards. It is called only when `output` has a gradient by then; for an operation that
/// makes several arrays `output` is null and the function looks for itself.
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
