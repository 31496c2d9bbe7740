#ifndef RESEARCH_DATA_TENSION_SET_H
#define RESEARCH_DATA_TENSION_SET_H

#include "batten/research/curve_data.h"

/// @file
/// What all sets of curves share: their arrays, and random streams that never meet.

/// Coordinates of a point.
static inline size_t tension_dim(bat_tension_space space)
{
    return space == BAT_TENSION_SPHERE ? 3 : 2;
}

/// Allocate the arrays for set->count curves of set->dim coordinates. False when out of memory: bat_tension_set_free() frees
/// what there is.
bool tension_set_allocate(bat_tension_set *set);

/// What curves are drawn for.
typedef enum tension_purpose
{
    TENSION_TRAINING,
    TENSION_RESAMPLED_TEST,
    TENSION_UNSEEN_TEST
} tension_purpose;

/// The stream of one curve. Streams of different purposes, spaces, seeds or numbers begin in different states.
bat_random tension_stream(tension_purpose purpose, bat_tension_space space, uint64_t seed, uint64_t number);

#endif
