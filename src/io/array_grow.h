#ifndef IO_ARRAY_GROW_H
#define IO_ARRAY_GROW_H

// Growing arrays are part of the base.
#include "base/array_grow.h"

#endif
