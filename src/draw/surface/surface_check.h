#ifndef DRAW_SURFACE_SURFACE_CHECK_H
#define DRAW_SURFACE_SURFACE_CHECK_H

#include "batten/surface_picture.h"

/// Whether rows and options can be drawn: what bat_surface_picture_write() returns for those that cannot.
bat_status surface_picture_check(const bat_surface_picture_row *rows, size_t count,
                                 const bat_surface_picture_options *options, bat_error *error);

#endif
