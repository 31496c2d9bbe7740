#ifndef SEARCH_SELECT_H
#define SEARCH_SELECT_H

#include <stddef.h>

/// A number and what it belongs to; ordered by key, then by item.
typedef struct keyed
{
    double key;
    size_t item;
} keyed;

/// Reorder the entries so that entry `nth` is the one that sorting would put there, none before it is greater and none
/// behind it is smaller. The items must differ. Expected time O(count), whatever the keys.
void select_nth(keyed *entries, size_t count, size_t nth);

#endif
