#include "research/learn/tape.h"

#include "base/error.h"
#include "linalg/blas.h"

#include <assert.h>
#include <limits.h>

enum
{
    LINE = 64,
    FIRST_BLOCK = 1 << 16
};

/// The header of a block of memory.
typedef struct tape_block
{
    struct tape_block *older;
    size_t size; ///< bytes behind the header
    char padding[LINE - sizeof(struct tape_block *) - sizeof(size_t)];
} tape_block;

typedef struct tape_record
{
    struct tape_record *older;
    learn_array *output;
    learn_backward *backward;
    void *context;
} tape_record;

learn_tape learn_tape_make(void)
{
    return (learn_tape){0};
}

void learn_tape_free(learn_tape *tape)
{
    for (tape_block *block = tape->block; block != NULL;)
    {
        tape_block *older = block->older;
        free(block);
        block = older;
    }
    *tape = learn_tape_make();
}

static bool add_block(learn_tape *tape, size_t size)
{
    tape_block *block = size <= SIZE_MAX - sizeof *block ? memory_array(size + sizeof *block, 1) : NULL;
    if (block == NULL)
        return false;
    block->older = tape->block;
    block->size = size;
    tape->block = block;
    tape->used = 0;
    return true;
}

/// Replace several blocks by one, in which the next step of this size has room.
static void join_blocks(learn_tape *tape)
{
    if (tape->block == NULL || tape->block->older == NULL)
        return;
    size_t size = 0;
    for (tape_block *block = tape->block; block != NULL; block = block->older)
        size += block->size;
    learn_tape_free(tape);
    (void)add_block(tape, size);
}

void *learn_tape_memory(learn_tape *tape, size_t count, size_t size)
{
    size_t bytes;
    if (tape->status != BAT_OK)
        return NULL;
    if (size_multiply_overflows(count, size, &bytes) || bytes > SIZE_MAX / 4)
    {
        tape->status = BAT_TOO_LARGE;
        return NULL;
    }
    bytes = (bytes + LINE - 1) / LINE * LINE;
    if (tape->block == NULL || bytes > tape->block->size - tape->used)
    {
        size_t wanted = tape->block == NULL ? FIRST_BLOCK : 2 * tape->block->size;
        if (!add_block(tape, bytes > wanted ? bytes : wanted))
        {
            tape->status = BAT_NO_MEMORY;
            return NULL;
        }
    }
    char *memory = (char *)(tape->block + 1) + tape->used;
    tape->used += bytes;
    return memory;
}

void learn_tape_begin(learn_tape *tape, const learn_parameters *parameters, real *gradient)
{
    join_blocks(tape);
    *tape = (learn_tape){.block = tape->block, .status = blas_load(NULL)};
    if (parameters == NULL)
        return;
    tape->parameter_count = parameters->count;
    tape->parameter_array = learn_tape_memory(tape, parameters->count, sizeof(learn_array));
    if (tape->parameter_array == NULL)
        return;
    for (size_t i = 0; i < parameters->count; i++)
    {
        const learn_parameter *parameter = &parameters->list[i];
        tape->parameter_array[i] = (learn_array){
            .rows = parameter->rows,
            .columns = parameter->columns,
            .value = parameters->values + parameter->offset,
            .gradient = gradient != NULL ? gradient + parameter->offset : NULL,
            .begun = true,
        };
    }
}

void learn_tape_drop(learn_tape *tape, uint64_t key)
{
    tape->drops = true;
    tape->dropout_key = key;
}

bat_status learn_tape_status(const learn_tape *tape, bat_error *error)
{
    bat_status loaded = blas_load(error);
    if (loaded != BAT_OK)
        return loaded;
    if (tape->status == BAT_NO_MEMORY)
        return error_set(error, BAT_NO_MEMORY, BAT_NO_INDEX, 0, "out of memory for the layers of a network");
    if (tape->status == BAT_TOO_LARGE)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "a layer of a network has more than %d rows or columns",
                         INT_MAX);
    if (tape->status != BAT_OK)
        return error_set(error, tape->status, BAT_NO_INDEX, 0, "the geometry that a network works on cannot be computed");
    return BAT_OK;
}

learn_array *learn_array_make(learn_tape *tape, size_t rows, size_t columns, bool wants)
{
    size_t size = 0;
    if (tape->status == BAT_OK && (rows > INT_MAX || columns > INT_MAX || size_multiply_overflows(rows, columns, &size)))
        tape->status = BAT_TOO_LARGE;
    learn_array *array = learn_tape_memory(tape, 1, sizeof *array);
    real *value = learn_tape_memory(tape, size, sizeof *value);
    real *gradient = wants ? learn_tape_memory(tape, size, sizeof *gradient) : NULL;
    if (tape->status != BAT_OK)
        return &tape->nothing;
    *array = (learn_array){.rows = rows, .columns = columns, .value = value, .gradient = gradient};
    return array;
}

learn_array *learn_constant(learn_tape *tape, size_t rows, size_t columns, const real *values)
{
    learn_array *array = learn_array_make(tape, rows, columns, false);
    if (tape->status == BAT_OK)
        memcpy(array->value, values, learn_size(array) * sizeof *values);
    return array;
}

void learn_tape_record(learn_tape *tape, learn_array *output, learn_backward *backward, void *context)
{
    tape_record *record = learn_tape_memory(tape, 1, sizeof *record);
    if (record == NULL)
        return;
    *record = (tape_record){.older = tape->last, .output = output, .backward = backward, .context = context};
    tape->last = record;
}

real *learn_gradient(learn_array *array)
{
    if (!array->begun)
    {
        memset(array->gradient, 0, learn_size(array) * sizeof *array->gradient);
        array->begun = true;
    }
    return array->gradient;
}

void learn_tape_backward(learn_tape *tape, learn_array *loss, real weight)
{
    if (tape->status != BAT_OK || !learn_wants(loss))
        return;
    assert(loss->rows == 1 && loss->columns == 1);
    *learn_gradient(loss) += weight;
    for (tape_record *record = tape->last; record != NULL; record = record->older)
        if (record->output == NULL || record->output->begun)
            record->backward(record->context);
}
