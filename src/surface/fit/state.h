#ifndef SURFACE_FIT_STATE_H
#define SURFACE_FIT_STATE_H

#include "surface/fit/loop.h"

/// @file
/// The state of an adaptive fit between two rounds, which the caller keeps (`save` and `load` of bat_surface_fit_backend).

/// Keep the state. Nothing is done without `save`.
/// @return BAT_OK, BAT_NO_MEMORY, or the failures of `save`
bat_status fit_state_save(const fit_loop *loop, bat_error *error);

/// Take up the state of an earlier call, where there is one.
/// @return BAT_OK; BAT_BAD_FILE where it is not one of this fit; BAT_NO_MEMORY; the failures of `load`
bat_status fit_state_load(fit_loop *loop, bat_error *error);

#endif
