#ifndef IO_CSV_COLUMNS_H
#define IO_CSV_COLUMNS_H

#include "io/curve_attributes.h"

/// A field of a row.
typedef struct csv_field
{
    const char *begin, *end; ///< without blanks at either end
} csv_field;

/// Take the names of a header row, which have no zero bytes. False when out of memory.
bool csv_columns_name(csv_columns *columns, const csv_field *fields, size_t count);

/// Find the columns that are called longitude and latitude, if both are there.
bool csv_columns_geographic(const csv_columns *columns, size_t *longitude, size_t *latitude);

/// Say that the coordinates are these two columns and the others are channels. False when out of memory.
bool csv_columns_use_degrees(csv_columns *columns, size_t longitude, size_t latitude);

#endif
