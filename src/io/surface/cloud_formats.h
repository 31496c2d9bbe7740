#pragma once

#include "batten/cloud_file.h"
#include "io/common/file_text.h"

/// @file
/// Readers and writers of cloud formats.

/// The points of a file. All zero: empty.
typedef struct point_listing
{
    double *points; ///< count x 3
    size_t count, capacity;
} point_listing;

/// Add a point, which the caller sets; null when out of memory.
static inline double *listing_next(point_listing *listing)
{
    return ARRAY_GROW(listing->points, listing->capacity, 3 * (listing->count + 1)) ? listing->points + 3 * listing->count++
                                                                                    : NULL;
}

/// Read the points of a text, which may be none. Free the listing also on failure.
/// @return BAT_OK; BAT_BAD_FILE or, for a point that is not finite, BAT_INVALID_POINT, with line and point; BAT_NO_MEMORY
/// Points that are marked as missing, withheld or noise are left out.
typedef bat_status cloud_reader(const file_text *text, const bat_cloud_read_options *options, point_listing *listing,
                                bat_error *error);
cloud_reader cloud_rows_read, cloud_ptx_read, cloud_pcd_read, cloud_las_read;
/// Whether a text begins as such files do.
bool cloud_ptx_resembles(const file_text *text);
bool cloud_pcd_resembles(const file_text *text);
bool cloud_las_resembles(const file_text *text);

#define LAS_CLASSES 256
/// Read a list of classes, as in "2,8". False where it is none.
bool las_classes_read(const char *list, bool wanted[LAS_CLASSES]);

/// The line of a point in a text that was read before.
size_t cloud_rows_line_of_point(const file_text *text, size_t point);

/// The content of comments before the first point.
typedef struct cloud_remarks
{
    size_t boundary; ///< the number of boundary points, which come first; 0 when not given
    size_t boundary_line;
    size_t corners[4]; ///< indices in the boundary, from 0
    bool has_corners;
} cloud_remarks;

cloud_remarks cloud_remarks_read(const file_text *text);

/// Make a cloud from a text and a second one with the boundary, which may be null. The formats are known.
bat_status cloud_text_read(const file_text *text, bat_cloud_format format, const file_text *boundary_text,
                           bat_cloud_format boundary_format, const bat_cloud_read_options *options, bat_cloud *cloud,
                           bat_error *error);

/// The format of a text, by its content.
bat_cloud_format cloud_format_of_text(const file_text *text);
