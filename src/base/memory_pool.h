#ifndef BASE_MEMORY_POOL_H
#define BASE_MEMORY_POOL_H

#include "batten/base.h"

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

#endif
