#include "base/memory.h"

#include "base/array_grow.h"
#include "base/error.h"

#include <stdlib.h>
#include <string.h>

void *memory_pool_array(memory_pool *pool, size_t count, size_t size)
{
    void *arrays = pool->arrays, *made = NULL;
    bool grown = array_grow(&arrays, &pool->capacity, pool->count + 1, sizeof *pool->arrays);
    pool->arrays = arrays;
    if (grown)
        made = pool->arrays[pool->count++] = memory_array(count, size);
    if (made == NULL && pool->missing == 0)
        pool->missing = count * size > 0 ? count * size : SIZE_MAX;
    return made;
}

void *memory_pool_zeros(memory_pool *pool, size_t count, size_t size)
{
    void *made = memory_pool_array(pool, count, size);
    if (made != NULL)
        memset(made, 0, count * size);
    return made;
}

bat_status memory_pool_check(const memory_pool *pool, bat_error *error)
{
    return pool->missing == 0 ? BAT_OK : error_memory(error, pool->missing);
}

void memory_pool_free(memory_pool *pool)
{
    for (size_t k = 0; k < pool->count; k++)
        free(pool->arrays[k]);
    free(pool->arrays);
    *pool = (memory_pool){0};
}
