#ifndef TESTS_SUPPORT_TEST_IO_HELPERS_H
#define TESTS_SUPPORT_TEST_IO_HELPERS_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "error_helpers.h"

#include "batten/curve_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static inline bat_status read_string(const char *text, bat_curve_format format, const char *space, bat_curve_set *set,
                                     bat_error *error)
{
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = format;
    options.space = space;
    return bat_curve_read_memory(text, strlen(text), &options, set, error);
}

static inline bat_curve_set must_read(const char *text, bat_curve_format format, const char *space)
{
    bat_curve_set set = {0};
    bat_error error = {0};
    if (read_string(text, format, space, &set, &error) != BAT_OK)
        fail_msg("line %zu: %s", error.line, error.text);
    return set;
}

/// Reading fails with BAT_BAD_FILE on this line, and the message contains this text.
static inline void assert_bad(const char *text, bat_curve_format format, const char *space, size_t line, const char *words)
{
    bat_curve_set set = {0};
    bat_error error = {0};
    bat_status status = read_string(text, format, space, &set, &error);
    if (status != BAT_BAD_FILE)
        fail_msg("status %s for: %s", bat_status_name(status), text);
    if (error.line != line)
        fail_msg("line %zu instead of %zu: %s", error.line, line, error.text);
    if (strstr(error_words(&error), words) == NULL || strchr(error.text, '\n') != NULL)
        fail_msg("message '%s' instead of one with '%s'", error_words(&error), words);
    assert_int_equal(error.status, BAT_BAD_FILE);
    assert_null(set.curves);
    assert_null(set.space);
    assert_int_equal(read_string(text, format, space, &set, NULL), BAT_BAD_FILE);
}

static inline char *must_write(const bat_curve_set *set, bat_curve_format format)
{
    bat_curve_write_options options = bat_curve_write_defaults();
    options.format = format;
    char *text = NULL;
    size_t size = 0;
    bat_error error = {0};
    if (bat_curve_write_memory(set, &options, &text, &size, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_int_equal(strlen(text), size);
    return text;
}

/// Reading and writing in one format gives this text.
static inline void assert_rewritten(const char *text, bat_curve_format format, const char *space, const char *expected)
{
    bat_curve_set set = must_read(text, format, space);
    char *written = must_write(&set, format);
    assert_string_equal(written, expected);
    free(written);
    bat_curve_set_free(&set);
}

#endif
