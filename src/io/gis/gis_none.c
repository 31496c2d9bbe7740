#include "io/gis/gis.h"

/// @file
/// What a build without GDAL has in place of its formats.

static bat_status missing(bat_error *error)
{
    return ERROR_UNSUPPORTED(
        error, 0,
        "this needs GDAL, which this build of batten does without: run scripts/install-deps (or install "
        "libgdal-dev), then configure and build again");
}

bat_status gis_read(const char *path BAT_UNUSED, const char *drivers BAT_UNUSED,
                    const bat_curve_read_options *options BAT_UNUSED, bat_curve_set *set BAT_UNUSED, bat_error *error)
{
    return missing(error);
}

bat_status gis_write(const char *path BAT_UNUSED, const char *drivers BAT_UNUSED, const bat_curve_set *set BAT_UNUSED,
                     const bat_curve_write_options *options BAT_UNUSED, bat_error *error)
{
    return missing(error);
}

bat_status gis_text_read(const char *path BAT_UNUSED, const bat_limits *limits BAT_UNUSED, file_text *text BAT_UNUSED,
                         bat_error *error)
{
    return missing(error);
}

bat_status gis_text_write(const char *path BAT_UNUSED, const text_buffer *text BAT_UNUSED, bat_error *error)
{
    return missing(error);
}

bat_status gis_to_sphere(bat_curve_set *set BAT_UNUSED, bat_error *error)
{
    return missing(error);
}

bat_status gis_transform(const bat_curve_set *set BAT_UNUSED, const char *crs BAT_UNUSED, gis_target target BAT_UNUSED,
                         bat_curve_set *result BAT_UNUSED, bat_error *error)
{
    return missing(error);
}

bat_status gis_image_read(const void *bytes BAT_UNUSED, size_t size BAT_UNUSED, bat_mesh_image *image BAT_UNUSED,
                          bat_error *error)
{
    return missing(error);
}
