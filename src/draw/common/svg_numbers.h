#ifndef DRAW_COMMON_SVG_NUMBERS_H
#define DRAW_COMMON_SVG_NUMBERS_H

#include <stdbool.h>
#include <stddef.h>

/// Cairo numbers the surfaces of a process and writes the numbers into SVG as names. Number them from 1 in the order in
/// which they appear there, so that equal pictures are equal files.
/// @param data from malloc(); may move
/// @return false without memory; the file is then as it was
bool svg_renumber(unsigned char **data, size_t *size);

#endif
