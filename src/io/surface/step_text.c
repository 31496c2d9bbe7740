#include "io/surface/step.h"

#include "io/common/number_text.h"

#include <stdarg.h>
#include <stdio.h>

/// @file
/// Entities, lists and numbers in the clear-text encoding.

enum
{
    LONG_LINE = 100,
    FULL_TEXT = 1 << 16
};

void step_plain(step_text *step, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    text_append_string(&step->text, text);
}

void step_real(step_text *step, double value)
{
    char digits[NUMBER_TEXT_SIZE];
    const char *end = number_write(digits, value);
    char *out = text_reserve(&step->text, NUMBER_TEXT_SIZE + 1);
    if (out == NULL)
        return;
    bool point = false;
    for (const char *c = digits; c < end; c++)
    {
        point = point || *c == '.';
        if (*c == 'e' && !point)
            *out++ = '.';
        point = point || *c == 'e';
        *out++ = *c == 'e' ? 'E' : *c;
    }
    if (!point)
        *out++ = '.';
    text_advance(&step->text, out);
}

uint32_t step_begin(step_text *step, const char *text)
{
    step->line = step->text.size;
    step_plain(step, "#%u=%s", (unsigned)++step->count, text);
    return step->count;
}

static bat_status write_out(step_text *step, bat_error *error)
{
    bat_status status = sink_write(step->sink, &step->text, error);
    step->text.size = 0;
    return status;
}

bat_status step_end(step_text *step, const char *text, bat_error *error)
{
    step_plain(step, "%s;\n", text);
    return step->text.failed || step->text.size >= FULL_TEXT ? write_out(step, error) : BAT_OK;
}

void step_list_begin(step_text *step)
{
    text_append_string(&step->text, "(");
    step->separate = false;
}

static void begin_item(step_text *step)
{
    if (step->separate)
        text_append_string(&step->text, ",");
    step->separate = true;
    if (step->text.size - step->line < LONG_LINE)
        return;
    text_append_string(&step->text, "\n");
    step->line = step->text.size;
}

void step_list_reference(step_text *step, uint32_t entity)
{
    begin_item(step);
    step_plain(step, "#%u", (unsigned)entity);
}

void step_list_real(step_text *step, double value)
{
    begin_item(step);
    step_real(step, value);
}

void step_list_whole(step_text *step, size_t value)
{
    begin_item(step);
    step_plain(step, "%zu", value);
}

void step_list_end(step_text *step)
{
    text_append_string(&step->text, ")");
    step->separate = true;
}

uint32_t step_point(step_text *step, const double *point, size_t dimension)
{
    uint32_t entity = step_begin(step, "CARTESIAN_POINT('',");
    step_list_begin(step);
    for (size_t c = 0; c < dimension; c++)
        step_list_real(step, point[c]);
    step_list_end(step);
    text_append_string(&step->text, ");\n");
    return entity;
}

bat_status step_finish(step_text *step, bat_status status, bat_error *error)
{
    if (status == BAT_OK)
        status = write_out(step, error);
    text_free(&step->text);
    return status;
}
