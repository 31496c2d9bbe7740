#include "failing_memory.h"

#include <errno.h>
#include <expat.h>
#include <jansson.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

// The linker gives these names to the C library's functions.
// NOLINTBEGIN(bugprone-reserved-identifier)
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *block);
char *__real_realpath(const char *path, char *resolved);

void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *before, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *address);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t size);
char *__wrap_realpath(const char *path, char *resolved);
// The linker wants to see it from fontconfig, too, which goes on with Expat's own.
__attribute__((visibility("default"))) XML_Parser __wrap_XML_ParserCreate(const XML_Char *encoding);

/// A block that is in use.
typedef struct block
{
    void *address;       ///< null for a free place
    size_t number, size; ///< of the allocation
} block;

/// All of them, by open addressing.
static struct
{
    pthread_mutex_t lock;
    bool counting;
    failing_mode mode;
    size_t fail_at;
    failing_result result;
    block *blocks;
    size_t capacity, used; ///< the capacity is a power of two
} memory = {.lock = PTHREAD_MUTEX_INITIALIZER};

/// The place of an address, or the free one where it belongs.
static size_t place_of(const void *address)
{
    uint64_t hash = (uint64_t)(uintptr_t)address * UINT64_C(0x9E3779B97F4A7C15);
    size_t at = (size_t)(hash >> 20) & (memory.capacity - 1);
    while (memory.blocks[at].address != NULL && memory.blocks[at].address != address)
        at = (at + 1) & (memory.capacity - 1);
    return at;
}

static void put(block entry)
{
    if (2 * memory.used >= memory.capacity)
    {
        block *before = memory.blocks;
        size_t capacity = memory.capacity;
        memory.capacity = capacity == 0 ? 4096 : 2 * capacity;
        memory.blocks = __real_calloc(memory.capacity, sizeof *memory.blocks);
        if (memory.blocks == NULL)
            abort();
        for (size_t i = 0; i < capacity; i++)
            if (before[i].address != NULL)
                memory.blocks[place_of(before[i].address)] = before[i];
        __real_free(before);
    }
    size_t at = place_of(entry.address);
    memory.used += memory.blocks[at].address == NULL;
    memory.blocks[at] = entry;
}

/// Forget a block, if it is known, and move those up that had to make way for it.
static void take(const void *address)
{
    size_t at = memory.capacity > 0 ? place_of(address) : 0;
    if (memory.capacity == 0 || memory.blocks[at].address == NULL)
        return;
    memory.blocks[at].address = NULL;
    memory.used--;
    for (size_t next = (at + 1) & (memory.capacity - 1); memory.blocks[next].address != NULL;
         next = (next + 1) & (memory.capacity - 1))
    {
        block moved = memory.blocks[next];
        memory.blocks[next].address = NULL;
        memory.blocks[place_of(moved.address)] = moved;
    }
}

/// Whether the allocation that is asked for now is granted. One that is not robust is refused only where all are that follow
/// it.
static bool is_granted(bool robust, size_t *number)
{
    (void)pthread_mutex_lock(&memory.lock);
    *number = memory.counting ? ++memory.result.count : 0;
    bool from = memory.fail_at > 0 && *number >= memory.fail_at, at = robust && *number == memory.fail_at;
    bool fails = from && (memory.mode == FAIL_ALL || at);
    memory.result.failed += fails;
    (void)pthread_mutex_unlock(&memory.lock);
    if (fails)
        errno = ENOMEM;
    return !fails;
}

static void *remember(void *address, size_t number, size_t size)
{
    if (address == NULL || number == 0)
        return address;
    (void)pthread_mutex_lock(&memory.lock);
    put((block){address, number, size});
    (void)pthread_mutex_unlock(&memory.lock);
    return address;
}

static void forget(const void *address)
{
    (void)pthread_mutex_lock(&memory.lock);
    take(address);
    (void)pthread_mutex_unlock(&memory.lock);
}

static void *allocate(bool robust, size_t size)
{
    size_t number;
    return is_granted(robust, &number) ? remember(__real_malloc(size), number, size) : NULL;
}

static void *allocate_for_jansson(size_t size)
{
    return allocate(false, size);
}

void *__wrap_malloc(size_t size)
{
    return allocate(true, size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    size_t number;
    return is_granted(true, &number) ? remember(__real_calloc(count, size), number, count * size) : NULL;
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    size_t number;
    return is_granted(true, &number) ? remember(__real_aligned_alloc(alignment, size), number, size) : NULL;
}

void *__wrap_realloc(void *before, size_t size)
{
    size_t number;
    if (!is_granted(true, &number))
        return NULL;
    // Another thread may get the old address as soon as it is free.
    forget(before);
    return remember(__real_realloc(before, size), number, size);
}

void __wrap_free(void *address)
{
    if (address == NULL)
        return;
    forget(address);
    __real_free(address);
}

char *__wrap_strndup(const char *text, size_t size)
{
    size_t length = strnlen(text, size);
    char *copy = allocate(true, length + 1);
    if (copy == NULL)
        return NULL;
    memcpy(copy, text, length);
    copy[length] = '\0';
    return copy;
}

char *__wrap_strdup(const char *text)
{
    return __wrap_strndup(text, strlen(text));
}

char *__wrap_realpath(const char *path, char *resolved)
{
    size_t number;
    if (resolved != NULL)
        return __real_realpath(path, resolved);
    return is_granted(true, &number) ? remember(__real_realpath(path, NULL), number, 1) : NULL;
}

XML_Parser __wrap_XML_ParserCreate(const XML_Char *encoding)
{
    XML_Memory_Handling_Suite suite = {__wrap_malloc, __wrap_realloc, __wrap_free};
    return XML_ParserCreate_MM(encoding, &suite, NULL);
}
// NOLINTEND(bugprone-reserved-identifier)

void failing_memory_begin(size_t n, failing_mode mode)
{
    json_set_alloc_funcs(allocate_for_jansson, __wrap_free);
    memory.mode = mode;
    memory.fail_at = n;
    memory.counting = true;
}

failing_result failing_memory_end(void)
{
    (void)pthread_mutex_lock(&memory.lock);
    memory.counting = false;
    failing_result result = memory.result;
    result.left = memory.used;
    result.first = SIZE_MAX;
    for (size_t i = 0; i < memory.capacity; i++)
        if (memory.blocks[i].address != NULL && memory.blocks[i].number < result.first)
        {
            result.first = memory.blocks[i].number;
            result.size = memory.blocks[i].size;
        }
    (void)pthread_mutex_unlock(&memory.lock);
    return result;
}
