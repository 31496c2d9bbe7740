#pragma once

#include "batten/base.h"

#include <stdlib.h> // free() of what is made here

/// True when a * b does not fit size_t; else the product is in *product.
static inline bool size_multiply_overflows(size_t a, size_t b, size_t *product)
{
    return __builtin_mul_overflow(a, b, product);
}

/// A 64-bit number as a size.
static inline size_t size_clipped(uint64_t number)
{
    return (size_t)(number < SIZE_MAX ? number : SIZE_MAX);
}

/// An uninitialized array of `count` elements of `size` bytes, aligned to 64 bytes but on Windows; release it with free().
/// Null when out of memory, when the size overflows; never null for a count of 0.
void *memory_array(size_t count, size_t size);

/// Let a pointer to any type, whose address is `pointer`, point to a memory_array(); null when out of memory.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status array_make(void *pointer, size_t count, size_t size, bat_error *error);
/// The same of calloc(): with all bytes 0.
bat_status array_zeros(void *pointer, size_t count, size_t size, bat_error *error);

/// memcpy past the caches where the machine can: for results much larger than the caches, which nobody reads soon.
/// Both addresses are multiples of 8.
void memory_stream(double *restrict to, const double *restrict from, size_t count);

/// Make what memory_stream() wrote visible to other threads.
void memory_stream_end(void);

/// The bytes of memory that the machine, or the process's control group, has to spare; 0 where that is not known.
size_t memory_available(void);

/// Arrays that are checked and released together. All zero: none.
typedef struct memory_pool
{
    void **arrays;
    size_t count, capacity;
    size_t missing; ///< bytes of the first array that could not be made; 0 for none
} memory_pool;

/// memory_array() that is released with the pool; null when out of memory.
void *memory_pool_array(memory_pool *pool, size_t count, size_t size);
/// The same with all bytes 0.
void *memory_pool_zeros(memory_pool *pool, size_t count, size_t size);
/// @return BAT_OK, or BAT_NO_MEMORY where an array could not be made
bat_status memory_pool_check(const memory_pool *pool, bat_error *error);
void memory_pool_free(memory_pool *pool);

/// Exchange two variables of one type.
#define SWAP(a, b)                                                                                                          \
    do                                                                                                                      \
    {                                                                                                                       \
        __typeof__(a) swapped = (a);                                                                                        \
        (a) = (b);                                                                                                          \
        (b) = swapped;                                                                                                      \
    } while (0)

/// The order of two numbers, for qsort(): the lesser first. Neither is NaN.
#define ORDER_OF(x, y) (((x) > (y)) - ((x) < (y)))

static inline int ascending(const void *a, const void *b)
{
    return ORDER_OF(*(const double *)a, *(const double *)b);
}

/// The upper median of at least one number; sorts them.
static inline double sort_median(double *values, size_t count)
{
    qsort(values, count, sizeof *values, ascending);
    return values[count / 2];
}

static inline int ascending_index(const void *a, const void *b)
{
    return ORDER_OF(*(const uint32_t *)a, *(const uint32_t *)b);
}

static inline int ascending_int(const void *a, const void *b)
{
    return ORDER_OF(*(const int *)a, *(const int *)b);
}

/// Define the order of structs by one member, and where it is equal by another one.
// NOLINTBEGIN(bugprone-macro-parentheses): `type` is a type
#define DEFINE_ORDER(name, type, first, second)                                                                             \
    static int name(const void *a, const void *b)                                                                           \
    {                                                                                                                       \
        const type *p = a, *q = b;                                                                                          \
        return p->first != q->first ? ORDER_OF(p->first, q->first) : ORDER_OF(p->second, q->second);                        \
    }
// NOLINTEND(bugprone-macro-parentheses)
