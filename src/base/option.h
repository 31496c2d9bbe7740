#pragma once

#include "batten/base.h"

#include <math.h>

/// @file
/// Ranges of options. One table describes the fields of an options struct; one text refuses a value out of its range.

/// How a field is stored, and what its range means.
typedef enum option_kind
{
    OPTION_CHOICE, ///< an enumeration: a row of `family` that options may have
    OPTION_INT,    ///< an int from `low` to `high`
    OPTION_SIZE,   ///< a size_t from `low` to `high`; INFINITY: no upper bound
    OPTION_NUMBER, ///< a finite double from `low` to `high`; -INFINITY and INFINITY: no bound
    OPTION_ABOVE,  ///< a finite double above `low`, up to `high`
    OPTION_ZERO,   ///< a double: 0 for an automatic value, or from `low` to `high`
    OPTION_ANGLE,  ///< a finite double from `low` to `high`, or NaN for an automatic value
    OPTION_TABLE   ///< a struct of options with a `table`
} option_kind;

/// A field of an options struct and its range.
typedef struct option_field
{
    const char *name;
    size_t offset;
    option_kind kind;
    double low, high;
    const bat_family *family;       ///< OPTION_CHOICE
    const bat_options_table *table; ///< OPTION_TABLE
} option_field;

/// The row of a field. `type` is the options struct.
#define OPTION_FIELD(type, field, kind, low, high)                                                                          \
    {                                                                                                                       \
#field, offsetof(type, field), kind, low, high, NULL, NULL                                                          \
    }
/// The row of an enumeration with names.
#define OPTION_FAMILY(type, field, family)                                                                                  \
    {                                                                                                                       \
#field, offsetof(type, field), OPTION_CHOICE, 0, 0, &(family), NULL                                                 \
    }
/// The row of a struct of options within the struct.
#define OPTION_STRUCT(type, field, fields)                                                                                  \
    {                                                                                                                       \
#field, offsetof(type, field), OPTION_TABLE, 0, 0, NULL, &(fields)                                                  \
    }

/// The largest number of threads that an option may ask for.
#define OPTION_MAX_THREADS 1024
/// The row of `threads`.
#define OPTION_THREADS(type) OPTION_FIELD(type, threads, OPTION_INT, 0, OPTION_MAX_THREADS)

/// Check the fields of `options` in the order of the table.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field, its value and its range
bat_status options_check(const void *options, const option_field *fields, size_t count, bat_error *error);

/// options_check() of a whole table.
#define OPTIONS_CHECK(options, fields, error) options_check(options, fields, sizeof(fields) / sizeof *(fields), error)

/// The bat_options_table of a struct; `check` may be null.
#define OPTIONS_TABLE(type, fields, check)                                                                                  \
    {                                                                                                                       \
#type, fields, sizeof(fields) / sizeof *(fields), check                                                             \
    }
