#ifndef CURVE_MAP_CHAIN_H
#define CURVE_MAP_CHAIN_H

#include "batten/curve.h"

/// @file
/// Lines that meet end to end, made one line for refinement and cut again after it.

/// Where a curve lies in its chain.
typedef struct chain_member
{
    size_t chain, first; ///< the first point of the curve, or the last of a reversed one, is point `first` of the chain
    bool reversed;
} chain_member;

/// Curves of which some are joined. All zero: no line goes on, and the given curves serve.
typedef struct line_chains
{
    bat_curve *curves;
    size_t count;
    chain_member *members; ///< of each given curve
    size_t joints;         ///< pairs of ends that were joined
} line_chains;

/// Join lines whose ends are at one point. There the set has two neighbouring points, equally many lines end on the side
/// of each, no end is a corner, and both ends have the same channels. A line whose ends meet becomes closed.
///
/// @param curves checked curves in one space
/// @param chains release it with line_chains_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status line_chains_make(const bat_curve *curves, size_t count, line_chains *chains, bat_error *error);

/// Replace a chain and a point of it by a given curve and its point. The point may be BAT_NO_INDEX.
void line_chains_find(const line_chains *chains, const bat_curve *curves, size_t count, size_t *curve, size_t *point);

/// Cut the line from row `first` to row `last` out of a refined chain; around the end of a closed one.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status line_chains_cut(const bat_curve *chain, size_t first, size_t last, bool reversed, bat_curve *line,
                           bat_error *error);

void line_chains_free(line_chains *chains);

#endif
