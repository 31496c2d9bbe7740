#include "io/curve/formats.h"

/// @file
/// What a build without expat has in place of the reader of GPX.

bat_status gpx_read(const file_text *text BAT_UNUSED, const bat_curve_read_options *options BAT_UNUSED,
                    bat_curve_set *set BAT_UNUSED, bat_error *error)
{
    return ERROR_UNSUPPORTED(error, 0, "this build of batten does not read GPX, which needs expat");
}
