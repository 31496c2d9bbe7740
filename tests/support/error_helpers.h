#ifndef TESTS_SUPPORT_ERROR_HELPERS_H
#define TESTS_SUPPORT_ERROR_HELPERS_H

#include "batten/base.h"

#include <stdio.h>
#include <string.h>

/// The text of a failure, then the field that leads out and what it does, as in "the mesh is closed; trim cuts it open". It
/// is overwritten by the next call.
static inline const char *error_words(const bat_error *error)
{
    static char words[sizeof(bat_error)];
    bool led = error->remedy[0] != '\0';
    (void)snprintf(words, sizeof words, "%s%s%s%s%s", error->text, led ? "; " : "", error->remedy, led ? " " : "",
                   error->remedy_effect);
    return words;
}

#endif
