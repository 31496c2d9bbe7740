#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// @file
/// Disjoint sets of numbers (union-find with path halving): an array of each number's parent, itself at the root.

/// Make each number a set of its own.
static inline void sets_begin(uint32_t *parents, size_t count)
{
    for (size_t i = 0; i < count; i++)
        parents[i] = (uint32_t)i;
}

static inline uint32_t sets_root(uint32_t *parents, uint32_t item)
{
    while (parents[item] != item)
        item = parents[item] = parents[parents[item]];
    return item;
}

/// Join the sets of two numbers; the smaller root is that of both. Returns whether they were apart.
static inline bool sets_join(uint32_t *parents, uint32_t a, uint32_t b)
{
    a = sets_root(parents, a);
    b = sets_root(parents, b);
    parents[a > b ? a : b] = a < b ? a : b;
    return a != b;
}
