#ifndef BATTEN_H
#define BATTEN_H

/// @file
/// Everything batten offers.

#include "batten/base.h"
#include "batten/curve.h"
#include "batten/scheme.h"
#include "batten/space.h"

#endif
