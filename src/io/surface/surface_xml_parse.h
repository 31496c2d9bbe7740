#ifndef IO_SURFACE_SURFACE_XML_PARSE_H
#define IO_SURFACE_SURFACE_XML_PARSE_H

#include "io/common/file_text.h"
#include "io/surface/surface_space.h"

/// @file
/// The elements of a G+Smo file that say a surface, with their numbers as they stand there.

/// Numbers between two tags.
typedef struct xml_numbers
{
    double *values;
    size_t count;
    size_t line; ///< of the first; 0 when the element was not there
} xml_numbers;

/// A geometry of two parameters.
typedef struct xml_surface
{
    bool hierarchical, truncated;
    size_t line; ///< where it begins
    int degree[2];
    xml_numbers knots[2];
    size_t directions; ///< how many knot vectors there are so far
    surface_box *boxes;
    size_t box_count, box_capacity;
    size_t dimension;
    xml_numbers control;
} xml_surface;

/// @return BAT_OK with all elements there; BAT_BAD_FILE or BAT_UNSUPPORTED with the line; BAT_NO_MEMORY. Release `surface`
///         in any case
bat_status xml_surface_parse(const file_text *text, xml_surface *surface, bat_error *error);
void xml_surface_free(xml_surface *surface);

#endif
