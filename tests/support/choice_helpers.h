#ifndef TESTS_CHOICE_HELPERS_H
#define TESTS_CHOICE_HELPERS_H

#include "batten/base.h"

/// @file
/// Choices as numbers.

/// The enumerator of a name; -1 for none.
static inline int choice_value(const bat_family *family, const char *name)
{
    const bat_choice *choice;
    return bat_choice_find(family, name, &choice, NULL) == BAT_OK ? choice->value : -1;
}

/// The enumerator of a path to read; 0 for none.
static inline int choice_value_of_path(const bat_family *family, const char *path)
{
    const bat_choice *choice;
    (void)bat_choice_of_path(family, path, false, &choice, NULL);
    return choice != NULL ? choice->value : 0;
}

#endif
