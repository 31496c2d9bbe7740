#ifndef SPACE_COMPLETE_H
#define SPACE_COMPLETE_H

#include "batten/space.h"

/// What a space lacks that every space has, in a few words ("function log"); null for nothing.
const char *space_lack(const bat_space *space);

/// Whether a space has all functions that are not optional, dimensions within bounds and an injectivity radius. Null is no
/// space.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names what is missing
bat_status space_check_complete(const bat_space *space, bat_error *error);

#endif
