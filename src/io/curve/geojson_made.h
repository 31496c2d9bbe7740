#ifndef IO_CURVE_GEOJSON_MADE_H
#define IO_CURVE_GEOJSON_MADE_H

#include "io/curve/geojson.h"

/// @file
/// Collections of GeoJSON that the readers of other formats make, so that the reader of GeoJSON does the rest.

/// What is known of the positions of a collection.
typedef struct geojson_made
{
    double low[2], high[2]; ///< of x and y
    int srid;               ///< the EPSG code of their system; 0 for none
    bool degrees;           ///< without a system they are longitude and latitude, if they can be
    bool measures;          ///< as in geojson_document
    bool lines;             ///< features begin on the lines of the file
} geojson_made;

geojson_made geojson_made_start(void);

/// Take x or y of a position into account.
static inline void geojson_made_take(geojson_made *made, size_t axis, double value)
{
    made->low[axis] = value < made->low[axis] ? value : made->low[axis];
    made->high[axis] = value > made->high[axis] ? value : made->high[axis];
}

/// The begin of a collection, up to its first feature.
extern const char GEOJSON_MADE_BEGIN[];

/// Append line breaks up to the line of a position, so that features begin on the lines of the file.
/// @param counted where the last call ended
void geojson_made_pad(const char *at, const char **counted, text_buffer *geojson);

/// End a collection and read it as a set of a format.
bat_status geojson_made_read(const geojson_made *made, text_buffer *geojson, bat_curve_format format,
                             const bat_curve_read_options *options, bat_curve_set *set, bat_error *error);

#endif
