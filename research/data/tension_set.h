#ifndef RESEARCH_DATA_TENSION_SET_H
#define RESEARCH_DATA_TENSION_SET_H

#include "batten/research/curve_data.h"

/// @file
/// Sets of curves: memory, and disjoint random streams.

/// The number of coordinates of a point.
static inline size_t tension_dim(bat_tension_space space)
{
    return space == BAT_TENSION_SPACE_SPHERE ? 3 : 2;
}

/// Allocate the arrays for set->count curves with set->dim coordinates. Returns false when out of memory;
/// bat_tension_set_free() releases a partial allocation.
bool tension_set_allocate(bat_tension_set *set);

/// The purpose of drawn curves.
typedef enum tension_purpose
{
    TENSION_TRAINING,
    TENSION_RESAMPLED_TEST,
    TENSION_UNSEEN_TEST
} tension_purpose;

/// The random stream of one curve. Streams differ for different purposes, spaces, seeds or numbers.
bat_random tension_stream(tension_purpose purpose, bat_tension_space space, uint64_t seed, uint64_t number);

#endif
