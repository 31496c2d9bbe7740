#include "terminal.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/// The bytes of the UTF-8 character at the start of a text; 0 where there is none.
static size_t character_length(const unsigned char *text)
{
    size_t length = *text < 0x80                    ? 1
                    : *text >= 0xc2 && *text < 0xe0 ? 2
                    : *text >= 0xe0 && *text < 0xf0 ? 3
                    : *text >= 0xf0 && *text < 0xf5 ? 4
                                                    : 0;
    for (size_t i = 1; i < length; i++)
        if ((text[i] & 0xc0) != 0x80)
            return 0;
    return length;
}

void terminal_clean(char *text)
{
    for (unsigned char *at = (unsigned char *)text; *at != '\0';)
    {
        size_t length = character_length(at);
        bool c1 = length == 2 && at[0] == 0xc2 && at[1] < 0xa0;
        bool control = length == 0 || at[0] < 0x20 || at[0] == 0x7f || c1;
        length += length == 0;
        if (control)
            memset(at, '?', length);
        at += length;
    }
}

void terminal_print_list(FILE *stream, const char *format, va_list list)
{
    va_list again;
    va_copy(again, list);
    char usual[1024], *text = usual;
    int length = vsnprintf(usual, sizeof usual, format, list);
    if (length >= (int)sizeof usual)
    {
        text = malloc((size_t)length + 1);
        // Without memory the beginning is shown.
        if (text != NULL)
            (void)vsnprintf(text, (size_t)length + 1, format, again);
        else
            text = usual;
    }
    va_end(again);
    size_t format_length = strlen(format);
    bool ends = format_length > 0 && format[format_length - 1] == '\n';
    if (ends && length > 0)
        text[strlen(text) - 1] = '\0';
    terminal_clean(text);
    (void)fprintf(stream, ends ? "%s\n" : "%s", text);
    if (text != usual)
        free(text);
}

void terminal_print(FILE *stream, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    terminal_print_list(stream, format, list);
    va_end(list);
}
