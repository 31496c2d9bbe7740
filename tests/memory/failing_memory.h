#ifndef TESTS_MEMORY_FAILING_MEMORY_H
#define TESTS_MEMORY_FAILING_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

/// @file
/// An allocator that fails when it is told to. The linker sends it every allocation of the library and of the program
/// (`-Wl,--wrap=malloc` and so on); Jansson and Expat are told by their own means. Out of reach are
///   - cairo and fontconfig, which end the process when memory runs out,
///   - OpenBLAS and the OpenMP run-time, which do so at their start,
///   - Qhull, whose allocator is chosen when it is compiled,
///   - SuiteSparse, whose CHOLMOD 3 crashes when cholmod_solve2() has no memory for its workspace,
///   - what the C library allocates for itself.
/// Jansson drops the bytes of a string that it has no memory for and goes on. So it is refused memory only where nothing
/// else gets any afterwards either.

/// Which allocations fail.
typedef enum failing_mode
{
    FAIL_ONE, ///< the n-th alone
    FAIL_ALL  ///< the n-th and all after it
} failing_mode;

/// Begin to count: the n-th allocation from here on fails; none for n = 0.
void failing_memory_begin(size_t n, failing_mode mode);

/// What has happened since.
typedef struct failing_result
{
    size_t count;  ///< allocations that were asked for
    size_t failed; ///< those that were refused
    size_t left;   ///< blocks that nobody has freed
    size_t first;  ///< the number of the allocation that gave one of them, counted from 1
    size_t size;   ///< its bytes
} failing_result;

/// Stop to count; nothing fails any more.
failing_result failing_memory_end(void);

#endif
