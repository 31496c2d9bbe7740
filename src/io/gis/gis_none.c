#include "io/gis/gis.h"

/// @file
/// What a build without GDAL has in place of its formats.

static bat_status missing(bat_error *error)
{
    return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                     "this needs GDAL, which this build of batten does without: run scripts/install-deps (or install "
                     "libgdal-dev), then configure and build again");
}

bat_status gis_read(const char *path, const char *drivers, const bat_curve_read_options *options, bat_curve_set *set,
                    bat_error *error)
{
    (void)path;
    (void)drivers;
    (void)options;
    (void)set;
    return missing(error);
}

bat_status gis_write(const char *path, const char *drivers, const bat_curve_set *set, const bat_curve_write_options *options,
                     bat_error *error)
{
    (void)path;
    (void)drivers;
    (void)set;
    (void)options;
    return missing(error);
}

bat_status gis_text_read(const char *path, file_text *text, bat_error *error)
{
    (void)path;
    (void)text;
    return missing(error);
}

bat_status gis_text_write(const char *path, const text_buffer *text, bat_error *error)
{
    (void)path;
    (void)text;
    return missing(error);
}

bat_status gis_to_sphere(bat_curve_set *set, bat_error *error)
{
    (void)set;
    return missing(error);
}

bat_status gis_to_plane(const bat_curve_set *set, bat_curve_set *plane, bat_error *error)
{
    (void)set;
    (void)plane;
    return missing(error);
}

bat_status gis_to_wgs84(const bat_curve_set *set, const char *crs, bat_curve_set *globe, bat_error *error)
{
    (void)set;
    (void)crs;
    (void)globe;
    return missing(error);
}
