#pragma once

#include "batten/base.h"

/// @file
/// Choices by name: every family of schemes, formats and so on is one table, whose rows begin with a bat_choice.

/// The family of an array of rows.
#define FAMILY(what, rows) FAMILY_OF_PATHS(what, rows, NULL)
/// The family of an array of rows of formats, with bat_family::of_path.
#define FAMILY_OF_PATHS(what, rows, of_path)                                                                                \
    {                                                                                                                       \
        what, rows, sizeof *(rows), sizeof(rows) / sizeof *(rows), of_path                                                  \
    }

// NOLINTBEGIN(bugprone-macro-parentheses): initializers
/// A row: its name, its summary and its enumerator.
#define CHOICE(label, about, number) CHOICE_OF_USE(LISTED, label, about, number)
/// A row with a use of bat_choice_use.
#define CHOICE_OF_USE(how, label, about, number)                                                                            \
    {                                                                                                                       \
        .name = label, .summary = about, .value = number, .use = BAT_CHOICE_USE_##how                                       \
    }
/// A row whose name may have settings after it.
#define CHOICE_SET(label, defaults, about)                                                                                  \
    {                                                                                                                       \
        .name = label, .settings = defaults, .summary = about                                                               \
    }
/// The row of a format that is read and written, or one of both.
#define CHOICE_FORMAT(label, about, suffixes, number) CHOICE_FILE(true, true, label, about, suffixes, number)
#define CHOICE_FILE(read, written, label, about, suffixes, number)                                                          \
    {                                                                                                                       \
        .name = label, .summary = about, .endings = suffixes, .reads = read, .writes = written, .value = number             \
    }
// NOLINTEND(bugprone-macro-parentheses)

/// The bat_measure of a struct's field.
// NOLINTBEGIN(bugprone-macro-parentheses): `type` is a type
#define MEASURE(type, field, title, form)                                                                                   \
    {                                                                                                                       \
#field, title, BAT_MEASURE_FORM_##form, offsetof(type, field)                                                       \
    }
// NOLINTEND(bugprone-macro-parentheses)

/// The row of a number, also one that is not listed; null past the last.
const bat_choice *choice_at(const bat_family *family, size_t index);
/// The row of a name of `length` characters; null for none.
const bat_choice *choice_find(const bat_family *family, const char *name, size_t length);
/// The row with an enumerator; null for none.
const bat_choice *choice_of_value(const bat_family *family, int value);
/// The row whose endings have that of a path, in either case; null for none.
const bat_choice *choice_of_ending(const bat_family *family, const char *path);

/// The failure for an output whose format nothing names.
/// @return BAT_INVALID_ARGUMENT
bat_status choice_unnamed_output(const bat_family *family, bat_error *error);

// Settings behind a name: "angle:mu=-1/8,sign=printed".

/// How a setting is stored.
typedef enum setting_kind
{
    SETTING_NUMBER, ///< a double: a number, or a fraction of two
    SETTING_FLAG,   ///< a bool: 0 or 1
    SETTING_CHOICE  ///< an enumeration, by a name of `family`
} setting_kind;

/// A setting: a field of a struct.
typedef struct setting
{
    const char *key;
    setting_kind kind;
    size_t offset;
    const bat_family *family; ///< SETTING_CHOICE
} setting;

/// Read "key=value,key=value" into the fields of `values`; fields that the text does not name are untouched.
/// @param row  whose bat_choice::settings names the keys that are taken
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the part at fault
bat_status settings_read(const bat_choice *row, const char *text, const setting *settings, size_t count, void *values,
                         bat_error *error);

/// A finite number or a fraction of two; moves *text to the character after it.
bool settings_number(const char **text, double *value);
