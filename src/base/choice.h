#ifndef BASE_CHOICE_H
#define BASE_CHOICE_H

#include "batten/base.h"

/// @file
/// Choices by name: every family of schemes, formats and so on is one table, whose rows begin with a bat_choice.

typedef struct choice_table
{
    const char *what; ///< what a row is, for messages: "mesh scheme"
    const void *rows; ///< `count` rows of `size` bytes; each begins with a bat_choice
    size_t size, count;
} choice_table;

/// The table of an array of rows.
#define CHOICE_TABLE(what, rows)                                                                                            \
    {                                                                                                                       \
        what, rows, sizeof *(rows), sizeof(rows) / sizeof *(rows)                                                           \
    }

/// The bat_measure of a struct's field.
// NOLINTBEGIN(bugprone-macro-parentheses): `type` is a type
#define MEASURE(type, field, title, form)                                                                                   \
    {                                                                                                                       \
#field, title, BAT_MEASURE_##form, offsetof(type, field)                                                            \
    }
// NOLINTEND(bugprone-macro-parentheses)

/// The row of a number; null past the last.
const bat_choice *choice_at(const choice_table *table, size_t index);
/// The row of a name of `length` characters; null for none.
const bat_choice *choice_find(const choice_table *table, const char *name, size_t length);
/// The row with an enumerator; null for none.
const bat_choice *choice_of_value(const choice_table *table, int value);
/// The row whose endings have that of a path, in either case; null for none.
const bat_choice *choice_of_path(const choice_table *table, const char *path);

/// The endings of the rows that are read, or of those that are written, as ".csv, .txt, .obj". Returns `text`.
const char *choice_endings(const choice_table *table, bool writes, char *text, size_t size);
/// The row for a file that is read or written, by its ending: letters and digits, a letter among them, after the last dot of
/// the name. Null for a name without an ending.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT for an ending that no such row has, with a text that lists the known ones and
///         names `option`
bat_status choice_for_path(const choice_table *table, const char *path, bool writes, const char *option,
                           const bat_choice **row, bat_error *error);

/// What a public bat_..._list() does.
/// @return false past the last row
bool choice_list(const choice_table *table, size_t index, bat_choice *choice);
/// What a public bat_..._by_name() does.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names all rows
bat_status choice_by_name(const choice_table *table, const char *name, int *value, bat_error *error);
/// What a public bat_..._name() does: "unknown" for no row.
const char *choice_name(const choice_table *table, int value);

/// The public functions of a family with an enumeration: bat_..._list(), which begins at row `first`, bat_..._name() and
/// bat_..._by_name().
// NOLINTBEGIN(bugprone-macro-parentheses): `family` is a type
#define CHOICE_FUNCTIONS(family, table, first)                                                                              \
    bool family##_list(size_t index, bat_choice *choice)                                                                    \
    {                                                                                                                       \
        return choice_list(&(table), index + (first), choice);                                                              \
    }                                                                                                                       \
    const char *family##_name(family value)                                                                                 \
    {                                                                                                                       \
        return choice_name(&(table), (int)value);                                                                           \
    }                                                                                                                       \
    bat_status family##_by_name(const char *name, family *value, bat_error *error)                                          \
    {                                                                                                                       \
        int number;                                                                                                         \
        bat_status status = choice_by_name(&(table), name, &number, error);                                                 \
        if (status == BAT_OK)                                                                                               \
            *value = (family)number;                                                                                        \
        return status;                                                                                                      \
    }
// NOLINTEND(bugprone-macro-parentheses)

#endif
