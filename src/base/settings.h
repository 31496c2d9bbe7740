#ifndef BASE_SETTINGS_H
#define BASE_SETTINGS_H

#include "batten/base.h"

/// @file
/// Settings behind a name: "angle:mu=-1/8,sign=printed".

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

#endif
