#ifndef IO_CURVE_CSV_NAMES_H
#define IO_CURVE_CSV_NAMES_H

#include "curve/point_form.h"

/// @file
/// Names of CSV columns in the spellings that people use.

/// The unit that a name gives: "Longitude (deg)", "lon_rad", "easting [m]".
typedef enum name_unit
{
    NAME_UNIT_NONE,
    NAME_UNIT_DEGREES,
    NAME_UNIT_RADIANS,
    NAME_UNIT_LENGTH,
    NAME_UNIT_OTHER
} name_unit;

enum
{
    /// The most characters of a name that is recognized, and a zero.
    NAME_BASE_SIZE = 40,
    /// x, y, z, w
    MAX_NAMED_COORDINATES = 4
};

/// A name without quotes, unit, case, blanks and punctuation: "decimallongitude".
typedef struct name_parts
{
    char base[NAME_BASE_SIZE]; ///< empty for a longer one
    name_unit unit;
} name_parts;

name_parts name_parse(const char *name);

/// Whether a column of this name numbers rows: "id", "index", "fid", "no", "#", … or no name.
bool name_is_index(const char *name);
/// Whether whole numbers in a column of this name are codes, which have no values between them: "track_id", "osm_id", …
bool name_is_code(const char *name);
/// Whether the values of a column of this name may tell curves apart: "track", "trip_id", "segment", …
bool name_is_group(const char *name);

/// The columns of coordinates that names tell.
typedef struct named_coordinates
{
    size_t columns[MAX_NAMED_COORDINATES]; ///< longitude and latitude; or x, y, and z and w where they exist
    size_t count;                          ///< 0: the names tell none
    size_t altitude;                       ///< beside longitude and latitude, or BAT_NO_INDEX
    bool geographic;
    bool radians; ///< of geographic columns; else degrees
    bool spelled; ///< the names are other than lon, lng, long, longitude, lat, latitude, x, y, z
} named_coordinates;

named_coordinates names_find_coordinates(const column_names *names);

#endif
