#pragma once

#include "batten/curve_file.h"
#include "batten/mesh_transfer.h"
#include "io/common/file_text.h"

#include <strings.h>

/// @file
/// Formats and coordinate systems of geographic information systems, by GDAL and PROJ (https://gdal.org). GDAL is loaded at
/// the first use. Without it every function fails with BAT_UNSUPPORTED and a text that says what to install.
///
/// A layer is read as the GeoJSON document of its features, and written from one, so that both share the treatment of rings,
/// of the antimeridian and of repeated points.

/// Read the lines and polygons of one layer.
///
/// @param drivers the drivers of GDAL that may read it, separated by commas; null for all
/// @return BAT_OK, BAT_INVALID_ARGUMENT (options->layer), BAT_UNSUPPORTED, BAT_FILE_ACCESS, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status gis_read(const char *path, const char *drivers, const bat_curve_read_options *options, bat_curve_set *set,
                    bat_error *error);

/// Write a set as one layer. The file, or all files of a Shapefile, appear whole or not at all.
///
/// @param drivers the drivers of GDAL that may write it, the first that exists does; null: by the ending of the path
bat_status gis_write(const char *path, const char *drivers, const bat_curve_set *set, const bat_curve_write_options *options,
                     bat_error *error);

/// Whether only GDAL opens a path: "/vsi...", as GDAL names what is remote or inside of an archive, or "....gz".
static inline bool gis_is_virtual(const char *path)
{
    static const char ENDING[] = ".gz";
    size_t length = strlen(path), size = sizeof ENDING - 1;
    return strncmp(path, "/vsi", 4) == 0 || (length > size && strcasecmp(path + length - size, ENDING) == 0);
}

/// Read a text that may be compressed, as file_text_read() does. A limit of 0 bytes is that of a stream.
bat_status gis_text_read(const char *path, const bat_limits *limits, file_text *text, bat_error *error);

/// Write a text, compressed, to a path that ends in ".gz".
bat_status gis_text_write(const char *path, const text_buffer *text, bat_error *error);

/// Move a set from its system's plane to longitude and latitude, unless it is there. The set is unchanged on failure.
/// @return BAT_OK, BAT_INVALID_ARGUMENT (no coordinate system), BAT_UNSUPPORTED, BAT_INVALID_POINT or BAT_NO_MEMORY
bat_status gis_to_sphere(bat_curve_set *set, bat_error *error);

/// Where a set of a coordinate system goes.
typedef enum gis_target
{
    GIS_SPHERE, ///< longitude and latitude on the ellipsoid of its system
    GIS_PLANE,  ///< back
    GIS_WGS84
} gis_target;

/// Make a set of the transformed curves, which shares the attributes.
bat_status gis_transform(const bat_curve_set *set, const char *crs, gis_target target, bat_curve_set *result,
                         bat_error *error);

/// The most pixels of images that are read: 16384 x 16384.
#define IMAGE_MAX_PIXELS (1 << 28)

/// Decode a JPEG, PNG, WebP, TIFF or BMP of 8 bits a channel without a palette, in place of the pixels that there are.
bat_status gis_image_read(const void *bytes, size_t size, bat_mesh_image *image, bat_error *error);
